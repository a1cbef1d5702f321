//! A few small pictures against goldens, and both backends against each other.

use std::fmt::Write as _;

use render::Backend;
use scene::{ParamValues, Scene};
use testing::draw::{draw, middle, scene, surfaces};
use testing::examples;
use testing::pictures::{assert_golden, difference};
use testing::wanted::Wanted;

/// Of a golden picture this share may differ: rounding may move the edge of a line.
const GOLDEN_SHARE: f64 = 0.005;

#[track_caller]
fn golden(example: &str, inside: bool) {
    let scene = scene(&examples::one(example).source);
    let settings = middle(&scene);
    let request = match surfaces(&scene).first() {
        Some(surface) if inside => Wanted::geodesic(*surface, [96, 96]),
        _ => Wanted::space([96, 96]),
    };
    let request = Wanted {
        backend: Backend::Software,
        ..request
    };
    let name = format!("{example}-{}", if inside { "inside" } else { "space" });
    assert_golden(
        &name,
        &draw(&scene, &settings, &request).image,
        GOLDEN_SHARE,
    );
}

#[test]
fn a_circle_and_its_tangents() {
    golden("circle", false);
}

#[test]
fn a_sphere_in_space() {
    golden("sphere", false);
}

#[test]
fn a_sphere_from_inside() {
    golden("sphere", true);
}

#[test]
fn a_klein_bottle_in_space() {
    golden("klein", false);
}

#[test]
fn a_torus_from_inside() {
    golden("torus", true);
}

#[test]
fn software_pictures_are_the_same_to_the_last_bit_every_time() {
    for (example, inside) in [("sphere", true), ("field", false)] {
        let scene = scene(&examples::one(example).source);
        let request = match surfaces(&scene).first() {
            Some(surface) if inside => Wanted::geodesic(*surface, [40, 30]),
            _ => Wanted::space([40, 30]),
        };
        let request = Wanted {
            backend: Backend::Software,
            ..request
        };
        let first = draw(&scene, &ParamValues::initial(&scene), &request).image;
        for _ in 0..3 {
            assert_eq!(
                draw(&scene, &ParamValues::initial(&scene), &request).image,
                first
            );
        }
    }
}

/// Draws every example on both backends, in each of the views that `requests` gives for its scene, and holds the
/// share of pixels in which a channel differs by more than 32 of 255 to `most`, printed for each.
#[track_caller]
fn both_backends_agree(most: f64, requests: impl Fn(&Scene) -> Vec<Wanted>) {
    let mut table = String::new();
    let mut worst: f64 = 0.0;
    for example in examples::all() {
        let scene = scene(&example.source);
        let settings = middle(&scene);
        for request in requests(&scene) {
            let picture = |backend| {
                let request = Wanted {
                    backend,
                    ..request.clone()
                };
                draw(&scene, &settings, &request).image
            };
            let found = difference(&picture(Backend::Gpu), &picture(Backend::Software), 32);
            let _ = writeln!(
                table,
                "{:14} {:6.2} % of the pixels differ, mean difference {:.2} of 255",
                example.name,
                100.0 * found.share,
                found.mean
            );
            worst = worst.max(found.share);
        }
    }
    println!("{table}");
    assert!(
        worst <= most,
        "more than {:.0} % differ:\n{table}",
        100.0 * most
    );
}

/// The 3D pictures: edges of lines and triangles are sampled at other places within a pixel.
#[test]
fn both_backends_draw_the_same_in_space() {
    both_backends_agree(0.04, |_| vec![Wanted::space([160, 160])]);
}

/// The geodesic pictures: the kernel of the GPU in f32 against adaptive f64.
#[test]
fn both_backends_see_the_same_from_inside() {
    both_backends_agree(0.01, |scene| {
        let unmarked = |surface| {
            Wanted::geodesic(surface, [128, 128]).with_inside(|options| options.mark_centre = false)
        };
        surfaces(scene).into_iter().map(unmarked).collect()
    });
}
