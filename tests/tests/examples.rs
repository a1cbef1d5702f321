//! Every example says what to look for, compiles without a word, and can be seen in both views.

use render::Backend;
use scene::ParamValues;
use scene::Shape;
use scene::geotrace::compile;
use testing::draw::{draw, drawn_share, middle, scene, surfaces};
use testing::examples;
use testing::wanted::Wanted;

#[test]
fn every_example_opens_with_what_to_look_for() {
    for example in examples::all() {
        let comment: Vec<&str> = example
            .source
            .lines()
            .take_while(|line| line.starts_with('#'))
            .collect();
        assert!(comment.len() >= 3, "{} opens with no comment", example.name);
        let comment = comment.join("\n");
        assert!(comment.contains("Look for:"), "{}: {comment}", example.name);
    }
}

#[test]
fn every_example_compiles_without_any_diagnostic() {
    for example in examples::all() {
        let compilation = compile(&example.source);
        assert!(
            compilation.diagnostics.is_empty(),
            "{}: {:#?}",
            example.name,
            compilation.diagnostics
        );
        let scene = compilation.scene.expect("a scene without diagnostics");
        assert!(!scene.objects.is_empty(), "{} draws nothing", example.name);
    }
}

#[test]
fn the_examples_of_the_thesis_are_the_thesis_programs() {
    // Up to white space and comments, as they stand in the thesis (3.1 and 3.2).
    let strip = |text: &str| -> String {
        let code = text
            .lines()
            .map(|line| line.split('#').next().unwrap_or(""));
        code.flat_map(str::chars)
            .filter(|c| !c.is_whitespace())
            .collect()
    };
    let circle =
        "param r : [/2, 1]; param o : [0, 2pi]; curve c(t) = r(cost, sint, 0), t : [0, 2pi];
        grid k : [0, 2pi, 8]; define k2 = k + o; point p = ck2; vector v = c'k2 @ p;";
    assert_eq!(strip(&examples::one("circle").source), strip(circle));
    let sphere = "function f(u,v) = (sin(piv)cos(2piu), sin(piv)sin(2piu), cos(piv));
        param U : [0, 1]; param V : [0, 1]; point p = f(U,V);
        curve cu(t) = f(t, V), t : [0, 1]; curve cv(t) = f(U, t), t : [0, 1];
        function N(x) = x/sqrt*x; vector vu = Nf_u(U,V) @ p; vector vv = Nf_v(U,V) @ p;
        surface s(u,v) = f(u,v)*0.99, u : [0, 1], v : [0, 1];";
    assert_eq!(strip(&examples::one("sphere").source), strip(sphere));
}

/// Draws every example, and every surface from inside; asserts that something is seen.
fn see_all(backend: Backend) {
    for example in examples::all() {
        let scene = scene(&example.source);
        // A metric, and a geodesic on one, have no place in space.
        let in_space = scene
            .objects
            .iter()
            .any(|object| !matches!(object.shape, Shape::Metric { .. } | Shape::Geodesic { .. }));
        for (what, settings) in [
            ("opening", ParamValues::initial(&scene)),
            ("middle", middle(&scene)),
        ] {
            if !in_space {
                break;
            }
            let request = Wanted {
                backend,
                ..Wanted::space([96, 72])
            };
            let picture = draw(&scene, &settings, &request);
            let share = drawn_share(&picture.image);
            assert!(
                (0.01..0.98).contains(&share),
                "{} ({what}): {:.1} % of the 3D picture is drawn",
                example.name,
                100.0 * share
            );
        }
        for surface in surfaces(&scene) {
            let request = Wanted {
                backend,
                ..Wanted::geodesic(surface, [48, 48])
            };
            let picture = draw(&scene, &ParamValues::initial(&scene), &request);
            let colours: std::collections::BTreeSet<_> =
                picture.image.pixels().map(|pixel| pixel.0).collect();
            assert!(
                colours.len() > 20,
                "{}: the geodesic view has {} colours: {:?}",
                example.name,
                colours.len(),
                picture.notes
            );
        }
    }
}

#[test]
fn every_example_is_seen_in_software() {
    see_all(Backend::Software);
}

#[test]
fn every_example_is_seen_on_the_gpu() {
    see_all(Backend::Gpu);
}

#[test]
fn what_is_undefined_at_the_opening_is_reported_and_not_drawn() {
    let scene = scene(&examples::one("sphere").source);
    let request = Wanted {
        backend: Backend::Software,
        ..Wanted::space([32, 32])
    };
    let opening = draw(&scene, &ParamValues::initial(&scene), &request);
    assert!(
        opening
            .notes
            .iter()
            .any(|note| note.text().contains("`vu`")),
        "{:?}",
        opening.notes
    );
    assert!(
        !opening
            .notes
            .iter()
            .any(|note| note.text().contains("`vv`")),
        "{:?}",
        opening.notes
    );
    let elsewhere = draw(&scene, &middle(&scene), &request);
    assert!(elsewhere.notes.is_empty(), "{:?}", elsewhere.notes);
}
