//! What is drawn over a picture: nothing unless asked for, and then where closed forms say.

use image::{Rgba, RgbaImage};
use render::request::{Overlays, Spacing};
use render::sample::{Samples, sample};
use render::texture::Texture;
use render::trail::{PlaceMark, Trail, TrailKind};
use render::viewpoint::GeodesicCamera;
use render::{Backend, RenderedImage};
use scene::ObjectId;
use scene::ParamValues;

use crate::scenes::{Wanted, scene};
use std::f64::consts::PI;
use std::sync::Arc;

const PLANE: &str = "surface s(u,v) = (u, v, 0), u : [-9,9], v : [-9,9];";
const SPHERE: &str =
    "surface s(u,v) = (cosv cosu, cosv sinu, sinv), u : [-pi,pi], v : [-pi/2,pi/2];";
const CYLINDER: &str = "surface s(u,v) = (cosu, sinu, v), u : [-pi,pi], v : [-20,20];";

/// A grey picture of the first object from inside, on the software path.
fn draw(source: &str, at: [f64; 2], distance: f64, overlays: Overlays) -> RenderedImage<RgbaImage> {
    let scene = scene(source);
    let grey = Texture::from_image(RgbaImage::from_pixel(1, 1, Rgba([128, 128, 128, 255])));
    let mut request = Wanted {
        backend: Backend::Software,
        textures: vec![(ObjectId::new(0), Arc::new(grey))],
        overlays,
        ..Wanted::geodesic(ObjectId::new(0), [128, 128])
    };
    let options = request.inside();
    options.mark_centre = false;
    options.camera = options.camera.at(at).zoomed(distance);
    request
        .draw(&scene, &ParamValues::initial(&scene))
        .expect("a picture")
}

/// The distances from the centre, in units of half the picture, of pixels that are not grey.
fn marked(picture: &RenderedImage<RgbaImage>) -> Vec<f64> {
    let pixels = picture.image.enumerate_pixels();
    pixels
        .filter(|(.., pixel)| (0..3).any(|k| pixel.0[k].abs_diff(128) > 60))
        .map(|(x, y, _)| {
            let at = |n: u32| (f64::from(n) + 0.5) / 64.0 - 1.0;
            at(x).hypot(at(y))
        })
        .collect()
}

#[test]
fn nothing_is_drawn_that_was_not_asked_for() {
    let picture = draw(PLANE, [0.0; 2], 1.0, Overlays::default());
    assert_eq!(picture.overlays, Vec::<&str>::new());
    assert!(
        picture
            .image
            .pixels()
            .all(|pixel| pixel.0 == [128, 128, 128, 255])
    );
}

#[test]
fn wavefronts_are_circles_at_multiples_of_their_spacing() {
    let overlays = Overlays {
        wavefronts: Some(Spacing::Every(0.5)),
        ..Overlays::default()
    };
    let picture = draw(PLANE, [0.0; 2], 2.0, overlays);
    assert_eq!(picture.overlays, ["wavefronts"]);
    let found = marked(&picture);
    assert!(found.len() > 500, "{}", found.len());
    for distance in found {
        let s = 2.0 * distance / 0.5;
        assert!((s - s.round()).abs() * 0.5 < 3.0 * 2.0 / 64.0, "{s}");
    }
}

#[test]
fn a_legend_lists_conjugate_points_only_where_there_are_some() {
    let with = |conjugate_points| {
        let overlays = Overlays {
            conjugate_points,
            legend: true,
            ..Overlays::default()
        };
        draw(PLANE, [0.0; 2], 1.0, overlays).image
    };
    assert!(with(true) == with(false), "a plane has none");
}

#[test]
fn a_sphere_s_conjugate_points_are_half_a_turn_away() {
    let overlays = Overlays {
        conjugate_points: true,
        ..Overlays::default()
    };
    let found = marked(&draw(SPHERE, [0.3, 0.4], 4.0, overlays));
    assert!(found.len() > 100, "{}", found.len());
    for distance in found {
        assert!((4.0 * distance - PI).abs() < 3.5 * 4.0 / 64.0, "{distance}");
    }
    let plane = draw(PLANE, [0.0; 2], 4.0, overlays);
    assert_eq!(marked(&plane), Vec::<f64>::new());
}

/// The share of the pixels that lie beyond the cut locus, in per cent.
fn share_beyond(picture: &RenderedImage<RgbaImage>) -> f64 {
    let share = picture.notes.iter().find_map(|note| {
        let share = note
            .text()
            .split_once(" % of the pixels lie beyond the cut locus")?;
        share.0.parse::<f64>().ok()
    });
    share.unwrap_or_else(|| panic!("{:?}", picture.notes))
}

#[test]
fn the_hyperbolic_plane_has_no_cut_locus_however_coarse_the_picture_is() {
    let disc = "metric s(u, v) = 4(1, 0, 1)/(1 - u^2 - v^2)^2, u : [-0.7, 0.7], v : [-0.7, 0.7];";
    let strip = "metric s(u, v) = (1, 0.0001u, 1)/v^2, u : [-4, 4], v : [0.02, 8];";
    let overlays = Overlays {
        cut_locus: true,
        ..Overlays::default()
    };
    for (source, at) in [(disc, [0.1, 0.0]), (strip, [0.0, 0.5])] {
        for zoom in [2.0, 4.0, 6.0] {
            let share = share_beyond(&draw(source, at, zoom, overlays));
            assert!(share == 0.0, "{share} % at zoom {zoom} in {source}");
        }
    }
}

#[test]
fn nothing_but_what_lies_behind_it_is_cut_off_by_a_sphere_s_pole() {
    let source = "surface s(u, v) = (cos u sqrt(1 - v^2), sin u sqrt(1 - v^2), v), \
        u : [0, 2pi], v : [-1, 1];";
    let overlays = Overlays {
        cut_locus: true,
        ..Overlays::default()
    };
    let noted = share_beyond(&draw(source, [1.0, 0.7], 4.0, overlays));
    let share = 100.0 * (1.0 - PI.powi(3) / 64.0);
    assert!((noted - share).abs() < 0.5, "{noted} %, not {share} %");
}

#[test]
fn a_flat_torus_is_seen_once_however_many_of_its_copies_a_picture_shows() {
    let source = "metric s(u, v) = (1, 0, 1), u : [0, 1], v : [0, 1];";
    let overlays = Overlays {
        cut_locus: true,
        ..Overlays::default()
    };
    for zoom in [1.0, 2.0, 3.7, 6.0] {
        let share = share_beyond(&draw(source, [0.3, 0.6], zoom, overlays));
        // The rest is a square of one copy.
        let (side, expected) = (128.0 * (1.0 - share / 100.0).sqrt(), 64.0 / zoom);
        assert!(
            (side - expected).abs() < 1.01,
            "{side}, not {expected} pixels at zoom {zoom}"
        );
    }
}

#[test]
fn the_cut_locus_lies_nowhere_behind_the_first_conjugate_point() {
    // An oblate spheroid: along its equator the first conjugate point is πc away, and the cut locus begins there.
    let source = "surface s(u, v) = (cos u cos v, sin u cos v, 0.8 sin v), \
        u : [0, 2pi], v : [-pi/2, pi/2];";
    let overlays = Overlays {
        cut_locus: true,
        ..Overlays::default()
    };
    let picture = draw(source, [1.0, 0.0], 4.0, overlays);
    let mut ends = 0;
    for (x, y, pixel) in picture.image.enumerate_pixels() {
        if pixel.0[1] < 60 && (63..65).contains(&y) {
            let distance = 4.0 * ((f64::from(x) + 0.5) / 64.0 - 1.0).abs();
            let off = (distance - 0.8 * PI) / (4.0 / 64.0);
            assert!(off.abs() < 3.5, "{off} pixels off");
            ends += 1;
        }
    }
    assert!(ends > 1, "{ends}");
}

#[test]
fn a_cylinder_s_cut_locus_is_the_line_on_its_other_side() {
    let overlays = Overlays {
        cut_locus: true,
        ..Overlays::default()
    };
    let picture = draw(CYLINDER, [0.5, 0.0], 5.0, overlays);
    let share = 100.0 * (1.0 - PI / 5.0);
    let noted = share_beyond(&picture);
    assert!((noted - share).abs() < 2.0, "{noted} %, not {share} %");
    for (x, _, pixel) in picture.image.enumerate_pixels() {
        if pixel.0[1] < 60 {
            let off = 5.0 * ((f64::from(x) + 0.5) / 64.0 - 1.0).abs() - PI;
            assert!(off.abs() < 4.0 * 5.0 / 64.0, "a line {off} off");
        }
    }
}

#[test]
fn a_cut_locus_is_exact_on_a_small_part_of_a_large_surface() {
    let source = "surface s(u, v) = (cos(u)/4, sin(u)/4, v), u : [0, 2pi], v : [-50, 50];";
    let overlays = Overlays {
        cut_locus: true,
        ..Overlays::default()
    };
    let picture = draw(source, [0.5, 0.0], 1.0, overlays);
    let mut marked = 0;
    for (x, _, pixel) in picture.image.enumerate_pixels() {
        if pixel.0[1] < 60 {
            let off = 64.0 * (((f64::from(x) + 0.5) / 64.0 - 1.0).abs() - PI / 4.0);
            assert!(off.abs() < 2.5, "{off} pixels off");
            marked += 1;
        }
    }
    assert!(marked > 200, "{marked}");
}

#[test]
fn a_surface_wears_its_geodesics() {
    let source = format!("{PLANE} geodesic g(t) : s = (1, 0) @ (0, 0.25), t : [-0.5, 0.5];");
    let picture = draw(&source, [0.0; 2], 1.0, Overlays::default());
    assert_eq!(picture.overlays, ["geodesics"]);
    let red = |x: u32, y: u32| picture.image.get_pixel(x, y).0[1] < 90;
    // v = 0.25 is row 47.5 from the top, and the line reaches half of the way to both sides.
    for x in 0..128 {
        let inside = (34..94).contains(&x);
        assert_eq!(
            red(x, 47) || red(x, 48),
            inside || (29..99).contains(&x) && (red(x, 47) || red(x, 48))
        );
        assert!(!red(x, 40) && !red(x, 55), "column {x}");
    }
}

#[test]
fn a_geodesic_too_long_to_be_drawn_is_drawn_in_part_with_a_note() {
    let drawn = |length: &str| {
        let source = format!("{SPHERE}geodesic g(t) : s = (1, 1) @ (0, 0), t : [0, {length}];\n");
        draw(&source, [0.0, 0.0], 2.0, Overlays::default())
    };
    let noted = |length: &str| {
        let mut notes = drawn(length).notes;
        notes.retain(|note| note.text().contains("`g`"));
        notes
    };
    assert_eq!(noted("100"), []);
    let [note] = &noted("1e9")[..] else {
        panic!("{:?}", noted("1e9"));
    };
    assert!(
        note.text().starts_with("`g` is not drawn to its end"),
        "{note}"
    );
}

#[test]
fn declared_geodesics_are_curves_in_space_at_equal_arc_lengths() {
    let source = format!(
        "{SPHERE} grid k : [0, 1, 3]; geodesic g(t) : s = (1, k) @ (0, 0), t : [-1, 2, 31];"
    );
    let scene = scene(&source);
    let params = ParamValues::initial(&scene);
    let bounds = render::bounds::Bounds::of(&scene, &params);
    let Samples::Curves { count, samples } =
        sample(&scene, &params, ObjectId::new(1), &bounds.placement)
    else {
        panic!("no curves")
    };
    assert_eq!((count, samples.len()), (31, 93));
    let radius = bounds.placement.radius;
    for line in samples.chunks(31) {
        for pair in line.windows(2) {
            let [a, b] = [pair[0].position, pair[1].position];
            let chord = (0..3)
                .map(|k| f64::from(a[k] - b[k]).powi(2))
                .sum::<f64>()
                .sqrt();
            let expected = 2.0 * 0.05_f64.sin() / radius;
            assert!((chord - expected).abs() < 1e-5, "{chord}, not {expected}");
        }
    }
    let planned = Wanted::space([8, 8]).plan(&scene, &params);
    assert_eq!(planned.objects.len(), 2);
}

#[test]
fn a_metric_has_a_note_in_space_and_its_geodesics_no_place() {
    let source = "metric h(u,v) = (1/v^2, 0, 1/v^2), u : [-2,2], v : [0.1,4];
        geodesic g(t) : h = (1, 0) @ (0, 1), t : [0, 1];";
    let scene = scene(source);
    let request = Wanted {
        backend: Backend::Software,
        ..Wanted::space([32, 32])
    };
    let picture = request
        .draw(&scene, &ParamValues::initial(&scene))
        .expect("a picture");
    assert_eq!(picture.notes.len(), 1, "{:?}", picture.notes);
    assert!(picture.notes[0].text().starts_with("`h` is a metric"));
    let seen = draw(source, [0.0, 1.0], 1.0, Overlays::default());
    assert_eq!(seen.overlays, ["geodesics"]);
}

#[test]
fn a_geodesic_camera_is_shown_in_space_when_asked_for() {
    let scene = scene(SPHERE);
    let params = ParamValues::initial(&scene);
    let picture = |show_camera| {
        let request = Wanted {
            backend: Backend::Software,
            ..Wanted::space([64, 64]).with_space(|options| options.show_camera = show_camera)
        };
        let drawn = request.draw(&scene, &params).expect("a picture");
        (request.plan(&scene, &params).painters().len(), drawn)
    };
    let (plain_painters, plain) = picture(None);
    let (painters, shown) = picture(Some(
        GeodesicCamera::new(ObjectId::new(0))
            .at([-1.0, 0.3])
            .zoomed(0.5),
    ));
    assert_eq!((plain_painters, painters), (1, 3));
    assert_eq!(plain.overlays, Vec::<&str>::new());
    assert_eq!(shown.overlays, ["camera"]);
    assert_ne!(plain.image, shown.image);
}

#[test]
fn a_trail_is_drawn_in_both_views_with_its_length_and_costs_nothing_when_absent() {
    let scene = scene(SPHERE);
    let params = ParamValues::initial(&scene);
    let points = (0..=40)
        .map(|k| [0.0, -0.4 + 0.02 * f64::from(k)])
        .collect();
    let trail = Trail {
        kind: TrailKind::Walked,
        surface: ObjectId::new(0),
        points,
        length: 0.8,
        mark: None,
    };
    let grey = Texture::from_image(RgbaImage::from_pixel(1, 1, Rgba([128, 128, 128, 255])));
    let grey = Arc::new(grey);
    let draw = |space: bool, trails: Vec<Arc<Trail>>| {
        let base = if space {
            Wanted::space([128, 128])
                .with_space(|options| options.camera.eye = Some([4.0, 0.5, 0.0].into()))
        } else {
            Wanted::geodesic(ObjectId::new(0), [128, 128]).with_inside(|options| {
                options.mark_centre = false;
                options.camera = options.camera.at([0.0; 2]).zoomed(1.0);
            })
        };
        let request = Wanted {
            backend: Backend::Software,
            textures: vec![(ObjectId::new(0), grey.clone())],
            trails,
            ..base
        };
        let painters = request.plan(&scene, &params).painters().len();
        let picture = request.draw(&scene, &params).expect("a picture");
        (picture, painters)
    };
    for space in [false, true] {
        let (plain, few) = draw(space, Vec::new());
        let (with, more) = draw(space, vec![Arc::new(trail.clone())]);
        assert_eq!(plain.overlays, Vec::<&str>::new());
        assert_eq!(with.overlays, ["trail"]);
        assert_eq!(more - few, usize::from(space));
        let changed: Vec<(u32, u32)> = with
            .image
            .enumerate_pixels()
            .filter(|(x, y, pixel)| *pixel != plain.image.get_pixel(*x, *y))
            .map(|(x, y, _)| (x, y))
            .collect();
        // The line, upright in the middle, and the words in the corner.
        let line = changed.iter().filter(|(_, y)| *y < 90).count();
        let words = changed.iter().filter(|(_, y)| *y > 105).count();
        assert!(line > 30 && words > 100, "{line}, {words}");
        if !space {
            // From 0.4 of the zoom below the centre to as far above it.
            let above = changed.iter().map(|(_, y)| *y).min();
            assert!(above.is_some_and(|y| (36..=40).contains(&y)), "{above:?}");
            let middle = |(x, y): &&(u32, u32)| *y < 90 && x.abs_diff(64) <= 4;
            assert_eq!(changed.iter().filter(middle).count(), line);
        }
    }
}

#[test]
fn a_long_step_of_a_trail_is_a_line_where_no_side_turns_over() {
    let scene = scene("surface s(u,v) = (u, v, 0), u : [0,1], v : [0,1];");
    let params = ParamValues::initial(&scene);
    let grey = Texture::from_image(RgbaImage::from_pixel(1, 1, Rgba([128, 128, 128, 255])));
    let trail = Trail {
        kind: TrailKind::Measured(Arc::default()),
        surface: ObjectId::new(0),
        points: vec![[0.1, 0.1], [0.9, 0.9]],
        length: 1.13,
        mark: None,
    };
    let mut request = Wanted {
        backend: Backend::Software,
        textures: vec![(ObjectId::new(0), Arc::new(grey))],
        trails: vec![Arc::new(trail)],
        ..Wanted::geodesic(ObjectId::new(0), [128, 128])
    };
    let options = request.inside();
    options.mark_centre = false;
    options.camera = options.camera.at([0.5; 2]).zoomed(0.4);
    let picture = request.draw(&scene, &params).expect("a picture").image;
    // From corner to corner.
    let grey = Rgba([128, 128, 128, 255]);
    let on = (4..124).filter(|k| *picture.get_pixel(*k, 127 - *k) != grey);
    assert_eq!(on.count(), 120);
}

#[test]
fn a_marked_place_has_its_letter_in_both_views() {
    let scene = scene("surface s(u,v) = (u, v, 0), u : [-1,1], v : [-1,1];");
    let params = ParamValues::initial(&scene);
    let grey = Texture::from_image(RgbaImage::from_pixel(1, 1, Rgba([128, 128, 128, 255])));
    let grey = Arc::new(grey);
    // To the right of the middle, and above it.
    let at = [0.5, 0.5];
    let ring = (0..=40).map(|k| {
        let (sin, cos) = (f64::from(k) * PI / 20.0).sin_cos();
        [at[0] + 0.03 * cos, at[1] + 0.03 * sin]
    });
    let ring = Trail {
        kind: TrailKind::Measured(Arc::default()),
        surface: ObjectId::new(0),
        points: ring.collect(),
        length: 0.06 * PI,
        mark: None,
    };
    for space in [false, true] {
        let draw = |mark: Option<PlaceMark>| {
            let base = if space {
                Wanted::space([200, 200])
                    .with_space(|options| options.camera.eye = Some([0.0, -0.1, 4.0].into()))
            } else {
                Wanted::geodesic(ObjectId::new(0), [200, 200]).with_inside(|options| {
                    options.mark_centre = false;
                    options.camera = options.camera.at([0.0; 2]).zoomed(1.0);
                })
            };
            let request = Wanted {
                backend: Backend::Software,
                textures: vec![(ObjectId::new(0), grey.clone())],
                trails: vec![Arc::new(Trail {
                    mark,
                    ..ring.clone()
                })],
                ..base
            };
            request.draw(&scene, &params).expect("a picture").image
        };
        let plain = draw(None);
        let lettered = draw(Some(PlaceMark { letter: 'B', at }));
        let changed: Vec<(u32, u32)> = lettered
            .enumerate_pixels()
            .filter(|(x, y, pixel)| *pixel != plain.get_pixel(*x, *y))
            .map(|(x, y, _)| (x, y))
            .collect();
        assert!(changed.len() > 30, "{}", changed.len());
        // A letter is small, and beside its ring.
        let is_near = |(x, y): &(u32, u32)| (110..190).contains(x) && (20..90).contains(y);
        assert!(changed.iter().all(is_near), "{space}: {changed:?}");
        assert!(changed.len() < 400, "{}", changed.len());
    }
}
