//! Attributes that are expressions.

use render::view::traced::TracedOptions;
use render::{BackendUsed, PictureRequest, Renderer};
use testing::draw::scene;

use crate::{BASE, assert_same, drawn, on_gpu, request, wait_for};

/// A ball and a curve whose looks are expressions.
const VARIED: &str = "
    param w = 9 : [1, 20];
    solid ball(x, y, z) = x^2 + y^2 + z^2 - 1,
        color : (0.5 + 0.4sin(w x), 0.5 + 0.4cos(w y), exp(-z^2)),
        mirror : 0.2 + 0.2tanh(4z), specular : abs x, shininess : 20 + 10x;
    solid cube(x, y, z) = max(abs x, abs y, abs z) - 0.5;
    solid die = cube @ rotate (0, 0, 1) @ (1.6, 0.2, -0.5), color : (0.6, max(x - y, 0.2)/4, 0.3), bump : 0.02sin(30z);
    solid plate(x, y, z) = x^2 + y^2 - 9, z : [-1.2, -1], color : 0.5 + 0.3sin(5x)sin(5y), diffuse : 0.6 + 0.2sin x,
        bump : 0.03sin(6sqrt(x^2 + y^2));
    curve c(t) = (1.4cos t, 1.4sin t, 0.2t), t : [0, 6], color : (0.5 + 0.5sin t, t/6, 0.4);
    light lamp = @ (3, -4, 5);
    camera eye = (-0.2, 5, -2) @ (0.4, -6, 2);
";

#[test]
fn attributes_that_are_expressions_are_drawn_as_by_f64() {
    let mut gpu = on_gpu();
    let varied = request(&scene(VARIED), [160, 120], 2);
    let retraced = assert_same(&mut gpu, "varied", &varied);
    assert!(retraced < 0.01, "{retraced} of all samples by f64");
    // What lets light through differently from place to place is left to f64 where it is before a light.
    let glass = scene(
        "function unit(x, y, z) = x^2 + y^2 + z^2 - 1;
         solid a = unit @ scale 0.8 @ (-1.7, 0, 0), glass : 0.5 + 0.3sin(5z);
         solid b = unit @ scale 0.8, glass : 0.9, mirror : 0.3 + 0.3sin(5z);
         solid c = unit @ scale 0.8 @ (1.7, 0, 0), glass : 0.8, color : (0.5 + 0.4sin(9x), 1, 1), depth : 0.5;
         solid ground(x, y, z) = z + 1, color : 0.5 + 0.3sin(4x)sin(4y);
         light lamp = @ (2, -3, 4); camera eye = (0, 4, -1) @ (0, -4, 1);",
    );
    assert_same(&mut gpu, "varied glass", &request(&glass, [100, 75], 2));
}

#[test]
fn glass_that_bumps_roughen_is_drawn_as_by_f64() {
    let mut gpu = on_gpu();
    // A bump multiplies the error of a ray at each face that it comes to within the glass.
    let glass = scene(
        "solid a(x, y, z) = x^2 + y^2 + z^2 - 1, glass : 1, ior : 1.7, color : (0.99, 0.99, 0.9),
             bump : 0.1sin(12x)sin(12y);
         background b = 1; light lamp = @ (5, 5, 5), power : 0; camera eye = (0, 1, 0) @ (0, -4, 0);",
    );
    assert_same(&mut gpu, "bumped glass", &request(&glass, [120, 90], 2));
    // From water into a bubble, light may stay in the water.
    let bubble = scene(
        "solid water(x, y, z) = max(abs x, abs y, abs z) - 3, glass : 1, ior : 1.33;
         solid bubble(x, y, z) = x^2 + y^2 + z^2 - 1, glass : 1, ior : 1, color : (0.98, 0.98, 0.9),
             bump : 0.1sin(12x)sin(12y);
         background b = 1; light lamp = @ (5, 5, 5), power : 0; camera eye = (0, 1, 0) @ (0, -2.9, 0);",
    );
    assert_same(&mut gpu, "bumped bubble", &request(&bubble, [120, 90], 1));
}

#[test]
fn what_f32_does_not_know_of_a_colour_is_left_to_f64() {
    let mut gpu = on_gpu();
    // Finer than places are known, undefined on one side, out of range on one side.
    let scene = scene(
        "function unit(x, y, z) = x^2 + y^2 + z^2 - 1;
         solid fine = unit, color : 0.5 + 0.5sin(1000000x);
         solid undefined = unit @ (2, 0, 0), color : sqrt(x - 2);
         solid dark = unit @ (-2, 0, 0), color : x + 2;
         light lamp = @ (2, -3, 4); camera eye = (0, 6, 0) @ (0, -6, 0);",
    );
    let request = request(&scene, [60, 45], 1);
    let by_gpu = assert_same(&mut gpu, "unknown", &request);
    let names = ["fine", "undefined", "dark"];
    let picture = |shown: &[&str]| {
        let mut request = request.clone();
        let options = request
            .view
            .get_mut::<TracedOptions>()
            .expect("its options");
        let hidden = scene
            .numbered()
            .filter(|(_, it)| names.contains(&&*it.name) && !shown.contains(&&*it.name));
        options.space.hidden = hidden.map(|(id, _)| id).collect();
        drawn(&mut Renderer::software(), &request).image
    };
    let sky = picture(&[]);
    let on_faces = |shown: &[&str]| {
        let seen = picture(shown);
        let differing = seen.pixels().zip(sky.pixels()).filter(|(a, b)| a != b);
        differing.count() as f64 / (60.0 * 45.0)
    };
    let all = on_faces(&names);
    let whole = on_faces(&["fine"]);
    let expected = whole + 0.5 * (all - whole);
    assert!(
        (by_gpu - expected).abs() < 0.02,
        "{by_gpu} of all samples by f64, not {expected}"
    );
    let notes = drawn(&mut gpu, &request).notes;
    assert_eq!(notes, drawn(&mut Renderer::software(), &request).notes);
    assert_eq!(notes.len(), 2, "{notes:?}");
}

#[test]
fn an_edit_that_leaves_the_functions_builds_no_pipeline() {
    let mut renderer = on_gpu();
    let base = request(&scene(VARIED), [40, 30], 1);
    wait_for(&mut renderer, &base);
    let built = renderer.counters().pipelines;
    assert_eq!(
        built, 2,
        "the fixed pass, and the one of the scene's functions"
    );
    let mut moved = base.clone();
    let mut params = (*base.params).clone();
    params.set(&base.scene, "w", &[7.0]).expect("a param");
    moved.params = params.into();
    let is_drawn = |renderer: &mut Renderer, request: &PictureRequest, what: &str| {
        let drawn = drawn(renderer, request);
        assert!(
            matches!(drawn.backend, BackendUsed::Gpu(_)),
            "{what}: {}",
            drawn.backend
        );
        assert_eq!(renderer.counters().pipelines, built, "{what}");
    };
    is_drawn(&mut renderer, &moved, "a param");
    for (old, new) in [
        // A constant of an expression, another shape, a solid more with an expression that is known, a scene without any.
        ("tanh(4z)", "tanh(3z)"),
        ("max(abs x, abs y, abs z) - 0.5", "x^4 + y^4 + z^4 - 0.2"),
        (
            "light lamp",
            "solid more = cube @ (0, 2, 0), color : (0.1, max(x - y, 0.3)/4, 0.35), bump : 0.05sin(9z); light lamp",
        ),
    ] {
        let edited = VARIED.replace(old, new);
        assert_ne!(edited, VARIED, "{old}");
        is_drawn(&mut renderer, &request(&scene(&edited), [40, 30], 1), new);
    }
    is_drawn(
        &mut renderer,
        &request(&scene(BASE), [40, 30], 1),
        "no functions",
    );
    is_drawn(&mut renderer, &base, "the functions again");
}
