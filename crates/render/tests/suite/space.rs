//! The 3D view on the software path: what is seen is what the program says.

use std::sync::Arc;

use crate::scenes::{Wanted, scene};
use geometry::ManifoldError;
use image::{Rgba, RgbaImage};
use render::gpu::Pixels;
use render::request::part::SpaceOptions;
use render::texture::Texture;
use render::viewpoint::Viewpoint;
use render::{Backend, PictureRequest, RenderError, RenderedImage, Renderer, style};
use scene::ObjectId;
use scene::ParamValues;

fn picture(source: &str, request: Wanted) -> RenderedImage<RgbaImage> {
    let scene = scene(source);
    let request = Wanted {
        backend: Backend::Software,
        ..request
    };
    request
        .draw(&scene, &ParamValues::initial(&scene))
        .expect("a picture")
}

/// As [`picture`], all surfaces plain white.
fn plain(source: &str, mut request: Wanted) -> RgbaImage {
    let white = Arc::new(Texture::from_image(RgbaImage::from_pixel(
        1,
        1,
        Rgba([255; 4]),
    )));
    request.textures = (0..scene(source).objects.len())
        .map(|k| (ObjectId::new(k), white.clone()))
        .collect();
    picture(source, request).image
}

fn is_background(pixel: &Rgba<u8>) -> bool {
    pixel.0[..3] == style::BACKGROUND
}

const SPHERE: &str =
    "surface s(u,v) = (sin(piv)cos(2piu), sin(piv)sin(2piu), cos(piv)), u : [0,1], v : [0,1];";

#[test]
fn a_sphere_is_seen_without_holes_and_fills_the_picture() {
    let image = plain(SPHERE, Wanted::space([200, 200]));
    let mut rows = 0;
    for y in 0..200 {
        let seen: Vec<u32> = (0..200)
            .filter(|&x| !is_background(image.get_pixel(x, y)))
            .collect();
        if let (Some(first), Some(last)) = (seen.first(), seen.last()) {
            rows += 1;
            assert_eq!(seen.len() as u32, last - first + 1, "row {y} has a hole");
        }
    }
    // The margin is 8 % of the half picture on each side.
    assert!(
        (170..=192).contains(&rows),
        "{rows} rows of 200 show the sphere"
    );
}

#[test]
fn from_inside_a_closed_surface_no_background_is_seen() {
    let mut request = Wanted::space([96, 64]);
    request.in_space().camera = Viewpoint::new([0.3, 0.2, 0.1], [0.35, -0.4, 0.9]);
    let image = plain(SPHERE, request);
    assert_eq!(
        image.pixels().filter(|pixel| is_background(pixel)).count(),
        0
    );
}

#[test]
fn the_picture_does_not_depend_on_the_number_of_threads() {
    let source = format!("{SPHERE} curve c(t) = s(2t, t), t : [0,1];");
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        pool.install(|| picture(&source, Wanted::space([150, 100])).image)
    };
    let one = on(1);
    assert!(one == on(2) && one == on(5), "the pictures differ");
}

#[test]
fn size_and_place_in_space_do_not_change_the_picture() {
    let reference = picture(SPHERE, Wanted::space([120, 120])).image;
    for (factor, offset) in [
        (1e6, 0.0),
        (1e-6, 0.0),
        (1.0, 1e6),
        (1e-3, -1e3),
        (1e150, 0.0),
    ] {
        let source = format!(
            "function f(u,v) = {factor:e}(sin(piv)cos(2piu), sin(piv)sin(2piu), cos(piv)) + {offset:e}(1,1,1);
             surface s(u,v) = f(u,v), u : [0,1], v : [0,1];"
        );
        let image = picture(&source, Wanted::space([120, 120])).image;
        let differ = |(a, b): &(&Rgba<u8>, &Rgba<u8>)| (0..3).any(|k| a.0[k].abs_diff(b.0[k]) > 12);
        let count = reference
            .pixels()
            .zip(image.pixels())
            .filter(differ)
            .count();
        assert!(
            count <= 20,
            "{count} pixels differ at {factor:e}, {offset:e}"
        );
    }
}

#[test]
fn an_image_lies_upright_with_its_left_at_u_min_and_its_top_at_v_min() {
    let source = "surface s(u,v) = (u, -v, 0), u : [0,1], v : [0,1];";
    let quarters = [[200, 0, 0], [0, 200, 0], [0, 0, 200], [200, 200, 0]];
    let image = RgbaImage::from_fn(64, 64, |x, y| {
        let [r, g, b] = quarters[(x / 32 + 2 * (y / 32)) as usize];
        Rgba([r, g, b, 255])
    });
    let mut request = Wanted::space([100, 100]);
    request
        .textures
        .push((ObjectId::new(0), Arc::new(Texture::from_image(image))));
    let picture = picture(source, request).image;
    for (quarter, [x, y]) in quarters
        .iter()
        .zip([[25, 25], [75, 25], [25, 75], [75, 75]])
    {
        let seen = picture.get_pixel(x, y).0;
        for k in 0..3 {
            assert_eq!(
                quarter[k] > 0,
                seen[k] > 100,
                "{seen:?} at ({x}, {y}) for {quarter:?}"
            );
        }
    }
}

#[test]
fn a_surface_hides_what_lies_behind_it_and_lets_a_curve_on_it_be_seen() {
    let plane = "surface s(u,v) = (u, v, 0), u : [-1,1], v : [-1,1];";
    let request = || {
        Wanted::space([101, 101]).with_space(|options| {
            options.camera = Viewpoint::new([0.0, 0.0, 4.0], [0.0; 3]);
        })
    };
    let behind = plain(&format!("{plane} point p = (0, 0, -1/5);"), request());
    let [r, _, b, _] = behind.get_pixel(50, 50).0;
    assert!(
        r.abs_diff(b) < 8,
        "the point shines through: {:?}",
        behind.get_pixel(50, 50)
    );
    let on = plain(
        &format!("{plane} curve c(t) = (t, 0, 0), t : [-1,1];"),
        request(),
    );
    for x in 20..80 {
        let [r, g, b, _] = on.get_pixel(x, 50).0;
        assert!(
            r > 150 && g < 100 && b < 100,
            "no curve at x = {x}: {r} {g} {b}"
        );
    }
}

#[test]
fn kinds_have_the_colours_of_the_style() {
    let source = "point p = (0,0,0); vector v = (1,0,0) @ (0,0,0); curve c(t) = (cost, sint, 0), t : [0,2pi];";
    let image = picture(source, Wanted::space([256, 256])).image;
    let near = |colour: [u8; 3]| {
        image
            .pixels()
            .any(|pixel| (0..3).all(|k| pixel.0[k].abs_diff(colour[k]) < 24))
    };
    for colour in [
        style::POINT_COLOUR,
        style::VECTOR_COLOURS[0],
        style::CURVE_COLOURS[0],
    ] {
        assert!(near(colour), "{colour:?} is not seen");
    }
}

#[test]
fn a_thin_curve_has_no_gaps_even_in_a_small_picture() {
    let image = picture(
        "curve c(t) = (cost, sint, 0), t : [0,2pi];",
        Wanted::space([48, 48]),
    )
    .image;
    // The first camera is centred and face on.
    let radius = (24..48)
        .rev()
        .find(|&x| image.get_pixel(x, 24).0[0] > 80)
        .expect("the curve") as f64
        - 23.5;
    for step in 0..180 {
        let (sin, cos) = (f64::from(step) * std::f64::consts::TAU / 180.0).sin_cos();
        let brightest = (-1..=1)
            .map(|d| {
                let r = radius + f64::from(d);
                image
                    .get_pixel((24.0 + r * cos) as u32, (24.0 + r * sin) as u32)
                    .0[0]
            })
            .max();
        assert!(
            brightest > Some(110),
            "the curve breaks at step {step}: {brightest:?}"
        );
    }
}

#[test]
fn what_is_undefined_is_not_drawn_and_is_reported() {
    let source = "param U : [0,1]; point p = (1,1,1)/U; curve c(t) = (t, sqrtt, 0), t : [-1,1];";
    let picture = picture(source, Wanted::space([64, 64]));
    assert_eq!(picture.notes.len(), 2);
    assert_eq!(
        picture.notes[0].text(),
        "`p` is undefined at the current params and is not drawn"
    );
    assert_eq!(
        picture.notes[1].text(),
        "`c` is undefined at 50 of its 100 samples and has holes there"
    );
    assert!(picture.image.pixels().any(|pixel| !is_background(pixel)));
}

#[test]
fn a_scene_with_nothing_in_it_is_background() {
    let picture = picture("", Wanted::space([7, 5]));
    assert!(picture.image.pixels().all(is_background));
    assert!(picture.notes.is_empty());
}

#[test]
fn outliers_do_not_shrink_the_rest() {
    // 1/t reaches 10⁹; what matters is the part around the origin.
    let image = picture(
        "curve c(t) = (t, 1/t^3, 0), t : [1/1000, 2, 400];",
        Wanted::space([128, 128]),
    )
    .image;
    let red = image.pixels().filter(|pixel| pixel.0[0] > 120).count();
    assert!(red > 100, "{red} pixels of the curve");
}

#[test]
fn things_beside_and_behind_the_camera_are_cut_off_cleanly() {
    let source = format!(
        "{SPHERE} curve c(t) = (cost, sint, t/10), t : [0, 20pi, 2000]; grid k : [-1,1,5];
         vector v = (0,0,3) @ (k,k/2,-3/2); point p = (k,0,0);"
    );
    for eye in [
        [0.0, 0.0, 0.0],
        [0.5, 0.25, 0.0],
        [1.0, 0.0, 0.0],
        [0.9999, 0.0, 0.0],
    ] {
        let mut request = Wanted::space([80, 60]);
        request.in_space().camera = Viewpoint::new(eye, [0.2, 0.9, 0.1]);
        picture(&source, request);
    }
}

#[test]
fn wrong_requests_are_refused_with_a_sentence() {
    let scene = scene("point p = (0,0,0);");
    let params = ParamValues::initial(&scene);
    let attempt = |request: Wanted| {
        let request = Wanted {
            backend: Backend::Software,
            ..request
        };
        request
            .draw(&scene, &params)
            .map(|_| ())
            .map_err(|error| error.to_string())
    };
    assert!(attempt(Wanted::space([1, 1])).is_ok());
    assert!(attempt(Wanted::space([0, 8])).is_err_and(|e| e.contains("0x8")));
    assert!(attempt(Wanted::space([8, 16_385])).is_err_and(|e| e.contains("16384")));
    assert!(
        attempt(Wanted::geodesic(ObjectId::new(0), [8, 8]))
            .is_err_and(|e| e.contains("`p` is not a surface"))
    );
    let missing = Wanted::geodesic(ObjectId::new(9), [8, 8]);
    assert_eq!(
        missing.draw(&scene, &params).err(),
        Some(RenderError::Manifold(ManifoldError::NoSurface {
            name: None
        }))
    );
    let mut stuck = Wanted::space([8, 8]);
    stuck.in_space().camera = Viewpoint::new([1.0; 3], [1.0; 3]);
    assert!(attempt(stuck).is_err_and(|e| e.contains("direction")));
}

/// The 3D views of a program while something moves, and at rest.
fn moving_and_at_rest(source: &str) -> [RgbaImage; 2] {
    let scene = scene(source);
    [true, false].map(|moving| {
        let params = ParamValues::initial(&scene);
        let mut request = PictureRequest::new(&scene, params, SpaceOptions::default(), [400, 300]);
        request.moving = moving;
        let drawn = Renderer::software().draw(&request).expect("a picture");
        match drawn.image {
            Pixels::Image(image) => image,
            Pixels::Texture(_) => panic!("the software path draws in memory"),
        }
    })
}

#[test]
fn a_smooth_surface_has_fewer_triangles_while_something_moves_and_looks_the_same() {
    let torus = "surface s(u,v) = ((2 + cos v)cos u, (2 + cos v)sin u, sin v), \
                 u : [0, 2pi, 120], v : [0, 2pi, 80];";
    let [moving, rest] = moving_and_at_rest(torus);
    assert!(moving != rest, "nothing was left out");
    let pixels = moving.pixels().zip(rest.pixels());
    let differences =
        pixels.map(|(a, b)| (0..3).map(|k| a.0[k].abs_diff(b.0[k])).max().unwrap_or(0));
    let differences: Vec<u8> = differences.collect();
    let seen = differences.iter().filter(|it| **it > 16).count();
    assert!(seen * 50 < differences.len(), "{seen} pixels differ");
}

#[test]
fn the_image_of_a_surface_seen_aslant_is_hardly_blurred_while_something_moves() {
    let strip = "surface s(u,v) = (u, v, 0), u : [-3, 3, 3], v : [-1, 1, 3]; \
                 camera eye = (0, 3, -1) @ (0, -3, 1);";
    let [moving, rest] = moving_and_at_rest(strip);
    assert!(moving != rest, "images are sampled as at rest");
    let pairs = moving.pixels().zip(rest.pixels());
    let squares = pairs.map(|(a, b)| f64::from(a.0[1].abs_diff(b.0[1])).powi(2));
    let error = (squares.sum::<f64>() / f64::from(moving.width() * moving.height())).sqrt();
    assert!(error < 3.0, "{error}");
}

#[test]
fn what_fewer_triangles_would_change_is_drawn_as_at_rest() {
    let rough = "(u, v, 0.1 sin(40u) sin(40v))";
    let holed = "(u, v, sqrt(0.8 - u^2 - v^2))";
    for point in [rough, holed] {
        // One colour: images are sampled coarsely during motion.
        let source = format!(
            "surface s(u,v) = {point}, u : [-1, 1, 90], v : [-1, 1, 90], color : (1, 0, 0);"
        );
        let [moving, rest] = moving_and_at_rest(&source);
        assert!(moving == rest, "{source}");
    }
}
