//! What is drawn over the geodesic view of a solid is what is drawn over that of the surface with parameters that it has.

use std::sync::Arc;

use image::{Rgba, RgbaImage};
use render::request::{Overlays, Spacing};
use render::texture::Texture;
use render::viewpoint::Pose;
use render::{Backend, RenderedImage};
use scene::{ObjectId, ParamValues};

use crate::scenes::{Wanted, scene};

const SIZE: u32 = 160;

/// A surface as a solid and with parameters, of one colour, with a place for a camera that has the same axes on both.
struct Twin {
    solid: &'static str,
    surface: &'static str,
    place: [f64; 3],
    uv: [f64; 2],
    zoom: f64,
}

const BALL: Twin = Twin {
    solid: "solid s(x, y, z) = x^2 + y^2 + z^2 - 1, color : (0.5 + x/10^9, 0.5, 0.5);",
    surface: "surface s(u,v) = (cosv cosu, cosv sinu, sinv), u : [-pi,pi], v : [-pi/2,pi/2];",
    place: [1.0, 0.0, 0.0],
    uv: [0.0, 0.0],
    zoom: 4.0,
};
const BAR: Twin = Twin {
    solid: "solid s(x, y, z) = x^2 + y^2 - 1, color : (0.5 + x/10^9, 0.5, 0.5);",
    surface: "surface s(u,v) = (cosu, sinu, v), u : [-pi,pi], v : [-20,20];",
    place: [1.0, 0.0, 0.0],
    uv: [0.0, 0.0],
    zoom: 5.0,
};
const RING: Twin = Twin {
    solid: "solid s(x, y, z) = (sqrt(x^2 + y^2) - 2)^2 + z^2 - 1, color : (0.5 + x/10^9, 0.5, 0.5);",
    surface: "surface s(u,v) = ((2 + cosv)cosu, (2 + cosv)sinu, sinv), u : [-pi,pi], v : [-pi,pi];",
    place: [3.0, 0.0, 0.0],
    uv: [0.0, 0.0],
    zoom: 6.0,
};

fn draw(source: &str, pose: Pose, zoom: f64, overlays: Overlays) -> RenderedImage<RgbaImage> {
    let scene = scene(source);
    let grey = Texture::from_image(RgbaImage::from_pixel(1, 1, Rgba([128, 128, 128, 255])));
    let mut request = Wanted {
        backend: Backend::Software,
        textures: vec![(ObjectId::new(0), Arc::new(grey))],
        overlays,
        ..Wanted::geodesic(ObjectId::new(0), [SIZE; 2])
    };
    let options = request.inside();
    options.camera.pose = pose;
    options.camera.zoom = Some(zoom);
    request
        .draw(&scene, &ParamValues::initial(&scene))
        .expect("a picture")
}

/// The pictures of both twins.
fn both(twin: &Twin, more: [&str; 2], overlays: Overlays) -> [RenderedImage<RgbaImage>; 2] {
    let on_solid = Pose::InSpace {
        at: Some(twin.place),
        angle: 0.0,
    };
    let on_surface = Pose::At {
        at: Some(twin.uv),
        angle: 0.0,
        mirrored: false,
    };
    [
        draw(
            &format!("{}{}", twin.solid, more[0]),
            on_solid,
            twin.zoom,
            overlays,
        ),
        draw(
            &format!("{}{}", twin.surface, more[1]),
            on_surface,
            twin.zoom,
            overlays,
        ),
    ]
}

/// The pixels that an overlay has changed.
fn changed(with: &RgbaImage, without: &RgbaImage) -> Vec<bool> {
    let pixels = with.pixels().zip(without.pixels());
    pixels
        .map(|(a, b)| (0..3).any(|k| a.0[k].abs_diff(b.0[k]) > 24))
        .collect()
}

/// The number of pixels of one set that have none of the other within so many pixels.
fn alone(set: &[bool], other: &[bool], within: i64) -> usize {
    let side = i64::from(SIZE);
    let is_near = |index: i64| {
        let (x, y) = (index % side, index / side);
        (-within..=within).any(|dy| {
            (-within..=within).any(|dx| {
                let inside = (0..side).contains(&(x + dx)) && (0..side).contains(&(y + dy));
                inside && other[(index + dy * side + dx) as usize]
            })
        })
    };
    let all = (0..side * side).filter(|index| set[*index as usize]);
    all.filter(|index| !is_near(*index)).count()
}

/// Compares what lies over both twins; `within` is in pixels. Returns both pictures.
fn assert_alike(
    twin: &Twin,
    more: [&str; 2],
    overlays: Overlays,
    within: i64,
) -> [RenderedImage<RgbaImage>; 2] {
    let with = both(twin, more, overlays);
    let without = both(twin, ["", ""], Overlays::default());
    assert_eq!(with[0].overlays, with[1].overlays);
    let [solid, surface] = [0, 1].map(|k| changed(&with[k].image, &without[k].image));
    let count = surface.iter().filter(|is_changed| **is_changed).count();
    assert!(count > 100, "{}: {count} pixels", twin.solid);
    let off = alone(&solid, &surface, within) + alone(&surface, &solid, within);
    assert!(
        off == 0,
        "{}: {off} of {count} pixels are elsewhere",
        twin.solid
    );
    with
}

#[test]
fn wavefronts_and_conjugate_points_are_those_of_the_surface() {
    for twin in [BALL, RING] {
        let wavefronts = Overlays {
            wavefronts: Some(Spacing::Every(1.0)),
            ..Overlays::default()
        };
        assert_alike(&twin, ["", ""], wavefronts, 1);
        let conjugate_points = Overlays {
            conjugate_points: true,
            ..Overlays::default()
        };
        assert_alike(&twin, ["", ""], conjugate_points, 2);
    }
}

#[test]
fn the_error_is_painted_without_a_note_that_it_is_not() {
    let error = Overlays {
        error: true,
        ..Overlays::default()
    };
    let [solid, _] = both(&RING, ["", ""], error);
    assert_eq!(
        (
            solid.overlays,
            solid
                .notes
                .iter()
                .any(|note| note.text().contains("painted"))
        ),
        (vec!["error"], false)
    );
}

#[test]
fn a_line_longer_than_what_is_drawn_is_noted_as_on_the_surface() {
    let on_solid = "geodesic g(t) : s = (0, 1, 0.3) @ (3, 0, 0), t : [0, 10^6];";
    let on_surface = "geodesic g(t) : s = (1/3, 0.3) @ (0, 0), t : [0, 10^6];";
    let pictures = both(&RING, [on_solid, on_surface], Overlays::default());
    let cut = pictures.map(|picture| {
        let notes = picture.notes.into_iter();
        let cut = notes.filter(|note| note.text().starts_with("`g` is not drawn to its end"));
        cut.collect::<Vec<_>>()
    });
    assert_eq!(cut[0].len(), 1);
    assert_eq!(cut[0], cut[1]);
}

#[test]
fn the_cut_locus_is_that_of_the_surface() {
    let cut_locus = Overlays {
        cut_locus: true,
        ..Overlays::default()
    };
    for twin in [BAR, RING] {
        let pictures = assert_alike(&twin, ["", ""], cut_locus, 3);
        let [solid, surface] = pictures.map(|picture| {
            let share = picture.notes.iter().find_map(|note| {
                let share = note
                    .text()
                    .split_once(" % of the pixels lie beyond the cut locus")?;
                share.0.parse::<f64>().ok()
            });
            share.unwrap_or_else(|| panic!("{:?}", picture.notes))
        });
        assert!(
            surface > 10.0 && (solid - surface).abs() < 1.0,
            "{solid} %, not {surface} %"
        );
    }
}

#[test]
fn declared_geodesics_are_drawn_in_all_their_images() {
    let on_solid =
        "grid k : [0, 2, 3]; geodesic g(t) : s = (0, cos k, sin k) @ (1, 0, 0), t : [-4, 9];";
    let on_surface =
        "grid k : [0, 2, 3]; geodesic g(t) : s = (cos k, sin k) @ (0, 0), t : [-4, 9];";
    assert_alike(&BALL, [on_solid, on_surface], Overlays::default(), 1);
    let on_solid = "geodesic g(t) : s = (0, 1, 0.3) @ (3, 0, 0), t : [-7, 20];";
    let on_surface = "geodesic g(t) : s = (1/3, 0.3) @ (0, 0), t : [-7, 20];";
    assert_alike(&RING, [on_solid, on_surface], Overlays::default(), 1);
}

#[test]
fn a_geodesic_on_the_other_side_of_a_plate_is_not_seen() {
    let plate = "solid s(x, y, z) = x^2 + y^2 + (40z)^2 - 1;";
    let pose = Pose::InSpace {
        at: Some([0.0, 0.0, 1.0]),
        angle: 0.0,
    };
    let picture = |geodesic: &str| {
        let source = format!("{plate}{geodesic}");
        draw(&source, pose, 0.5, Overlays::default()).image
    };
    let without = picture("");
    let line =
        |side: &str| format!("geodesic g(t) : s = (1, 0, 0) @ (0, 0.2, {side}1), t : [-0.3, 0.3];");
    for (side, count) in [("", 100..2_000), ("-", 0..1)] {
        let changed = changed(&picture(&line(side)), &without);
        let found = changed.into_iter().filter(|is_changed| *is_changed).count();
        assert!(count.contains(&found), "{side}z: {found} pixels");
    }
}

#[test]
fn names_and_the_key_are_written_over_a_solid_too() {
    let overlays = Overlays {
        labels: true,
        legend: true,
        ..Overlays::default()
    };
    let more = "geodesic g(t) : s = (0, 1, 0.2) @ (1, 0, 0), t : [0, 3];";
    let [solid, _] = both(&BALL, [more, ""], overlays);
    assert_eq!(solid.overlays, ["geodesics", "legend", "labels"]);
}
