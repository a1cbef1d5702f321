//! Solids that functions other than polynomials up to degree four bound.

use testing::draw::scene;

use crate::{BASE, assert_same, misfit, on_gpu, request};

const STAGE: &str = "
    solid ground(x, y, z) = z + 1.6, color : (0.6, 0.5, 0.4);
    light lamp = @ (2, -3, 4);
    camera eye = (-0.4, 4, -1.2) @ (0.4, -4.6, 1.4);
";
const FUNCTIONS: &str = "
    function gyroid(x, y, z) = sin x cos y + sin y cos z + sin z cos x;
    function ball(x, y, z) = x^2 + y^2 + z^2 - 1;
    function lean(x, y, z) = (x + 0.4z, y, z);
";

#[test]
fn solids_that_functions_bound_are_drawn_as_by_f64() {
    let mut gpu = on_gpu();
    for (name, solids, most) in [
        (
            "gyroids",
            "solid g(x, y, z) = gyroid(4x, 4y, 4z), x : [-1, 1], y : [-1, 1], z : [-1, 1], color : (0.8, 0.5, 0.3);
             solid block = g @ scale 0.8 @ (-1, 0, 0);
             param w = 0.2 : [0, 1];
             solid sheet(x, y, z) = abs(gyroid(5x, 5y, 5z)) - w, color : 0.5 + 0.4sin(5x), mirror : 0.2;
             solid s = (ball \\ ball @ scale 0.3 @ (0.4, -0.7, 0.5)) & sheet @ (1, 0, 0);",
            0.005,
        ),
        (
            "high degrees",
            "define f = (1 + sqrt 5)/2;
             solid gold(x, y, z) = 4(f^2 x^2 - y^2)(f^2 y^2 - z^2)(f^2 z^2 - x^2) - (1 + 2f)(x^2 + y^2 + z^2 - 1)^2,
                 color : (1, 0.76, 0.3), specular : 0.3;
             solid s = ball @ scale 1.6 \\ gold;
             solid six(x, y, z) = x^6 + y^6 + z^6 - 1;
             solid t = six @ scale 0.3 @ lean @ (1.5, -1, 0);",
            0.005,
        ),
        (
            "joined",
            "solid a(x, y, z) = max(min(x^2 + z^2 - 0.2exp(-y), y^2 + z^2 - 0.2exp(x)), sqrt(x^2 + y^2 + z^4) - 1.2);
             solid b = a @ rotate (0.5, 0, 0) @ (-1.4, 0, 0) | ball @ scale 0.4 @ (-1.4, 0, 0.6);
             solid wave(x, y, z) = z - 0.2sin(6x)sin(6y), x : [-1, 1], y : [-1, 1], z : [-0.8, 1];
             solid s = wave @ lean @ rotate (0, 0, 0.5) \\ ball @ scale 0.5 @ (0, -0.6, 0.1);
             solid tangle(x, y, z) = x^4 + y^4 + z^4 - x^2 - y^2 - z^2 + 0.4 + 0.05sin(12x), mirror : 0.3;
             solid t = tangle @ scale 0.7 @ (1.6, 0, 0);
             solid q(x, y, z) = (abs x)^2.5 + (abs y)^0.8 + (abs z)^2.5 - 1, color : (0.4, 0.6, 0.8);
             solid u = q @ scale 0.5 @ (0, 0, 1);",
            0.005,
        ),
        (
            "glass",
            "solid g(x, y, z) = x^6 + y^6 + z^6 - 1, glass : 0.9, color : (0.8, 1, 0.9);
             solid inner(x, y, z) = x^2 + y^2 + z^2 - 0.2 - 0.02sin(20z), color : (0.9, 0.3, 0.2);
             function wave(x, y, z) = z - 0.1sin(6x)sin(6y);
             function block(x, y, z) = max(abs(x - 1.6), abs y, abs z) - 0.5;
             solid left = wave & block, glass : 0.9;
             solid right = block \\ wave, glass : 0.8, ior : 1.3;",
            0.03,
        ),
        (
            "endless",
            "solid g(x, y, z) = gyroid(x, y, z) + 0.8; solid b = ball @ scale 0.5;",
            0.005,
        ),
    ] {
        let scene = scene(&format!("{FUNCTIONS}{solids}{STAGE}"));
        let retraced = assert_same(&mut gpu, name, &request(&scene, [160, 120], 2));
        assert!(retraced < most, "{name}: {retraced} of all samples by f64");
    }
}

#[test]
fn every_operation_is_drawn_as_by_f64() {
    let heights = [
        "tan x",
        "asin(0.9x)",
        "acos(0.9x)/2",
        "atan(3x)",
        "sinh x",
        "cosh(2y) - 2",
        "tanh(3x)",
        "exp(x)sin(3y)",
        "log(x + 1.5)",
        "sqrt(1.1 + sin(3x))",
        "1/(1.5 + sin(3x)cos(3y))",
        "(1.1 + sin(3x))^1.7",
        "(1.1 + sin(3x))^y",
        "abs sin(3x) - abs cos(3y)",
        "max(sin(3x), cos(3y)) + min(x, sin(3y))",
        "sin(3x)^3 + (2 + cos(3y))^(-2)",
    ];
    let mut text = String::new();
    for (k, height) in heights.iter().enumerate() {
        let (x, y) = (k % 4, k / 4);
        text.push_str(&format!(
            "solid p{k}(x, y, z) = z - 0.4({height}), x : [-1, 1], y : [-1, 1], z : [-1, 1];
             solid q{k} = p{k} @ scale 0.45 @ ({x} - 1.5, {y} - 1.5, 0);"
        ));
    }
    text.push_str("light lamp = @ (-2, -3, 5); camera eye = (0, 3, -3) @ (0, -4, 4), fov : 0.7;");
    let request = request(&scene(&text), [160, 120], 2);
    let retraced = assert_same(&mut on_gpu(), "operations", &request);
    assert!(retraced < 0.02, "{retraced} of all samples by f64");
}

#[test]
fn an_edit_of_numbers_builds_no_pipeline_and_one_of_a_function_does() {
    const TEXT: &str = "
        param w = 0.2 : [0, 1];
        function wave(x, y, z) = sin(4x)cos(4y) + sin(4y)cos(4z) - w;
        function ball(x, y, z) = x^2 + y^2 + z^2 - 1;
        solid s = wave & ball \\ ball @ scale 0.5;
        light lamp = @ (3, -4, 5);
        camera eye = (-0.2, 5, -2) @ (0.4, -6, 2);
    ";
    let mut renderer = on_gpu();
    let base = request(&scene(TEXT), [40, 30], 1);
    let by_base = assert_same(&mut renderer, "edited", &base);
    let built = renderer.counters().pipelines;
    assert_eq!(built, 2, "the fixed pass, and the one of the function");
    assert!(by_base < 0.02, "{by_base} of all samples by f64");
    let mut moved = base.clone();
    let mut params = (*base.params).clone();
    params.set(&base.scene, "w", &[0.5]).expect("a param");
    moved.params = params.into();
    assert_same(&mut renderer, "a param", &moved);
    for (old, new) in [
        // Constants of the function, another map, one more leaf with the function, another polynomial.
        ("sin(4x)", "sin(5x)"),
        ("scale 0.5", "scale 0.7 @ (0.2, 0, 0)"),
        ("wave & ball", "wave & wave @ rotate (1, 0, 0) & ball"),
        ("x^2 + y^2 + z^2 - 1", "x^4 + y^4 + z^4 - 0.6"),
    ] {
        let edited = TEXT.replace(old, new);
        assert_ne!(edited, TEXT, "{old}");
        let edited = request(&scene(&edited), [40, 30], 1);
        assert_same(&mut renderer, new, &edited);
        assert_eq!(renderer.counters().pipelines, built, "{new}");
    }
    let edited = TEXT.replace("cos(4z)", "exp(-z^2)");
    assert_same(
        &mut renderer,
        "another function",
        &request(&scene(&edited), [40, 30], 1),
    );
    assert_eq!(renderer.counters().pipelines, built + 1);
    assert_same(
        &mut renderer,
        "no function",
        &request(&scene(BASE), [40, 30], 1),
    );
    assert_eq!(renderer.counters().pipelines, built + 1);
}

#[test]
fn what_f32_does_not_know_of_a_surface_is_left_to_f64() {
    let mut gpu = on_gpu();
    // The ball's part of the picture.
    let (radius, half) = (6f64.recip().asin().tan(), 0.3f64.tan());
    let share = std::f64::consts::PI * radius * radius / (4.0 * half * half * 4.0 / 3.0);
    // Ripples finer than places are known, and a sum that cancels, of which f32 does not know whether rays beside it meet it.
    for (name, function, most) in [
        ("fine", "0.0001sin(100000000x)", share + 0.02),
        (
            "cancelled",
            "((sin x + 1000000) - 1000000 - sin x)",
            2.0 * share,
        ),
    ] {
        let ball = scene(&format!(
            "solid ball(x, y, z) = x^2 + y^2 + z^2 - 1 + {function};
             camera eye = (0, 6, 0) @ (0, -6, 0), fov : 0.6;"
        ));
        let retraced = assert_same(&mut gpu, name, &request(&ball, [80, 60], 1));
        assert!(
            retraced > share - 0.02 && retraced < most,
            "{name}: {retraced}, not {share}"
        );
    }
}

#[test]
fn a_function_that_is_too_large_is_drawn_by_f64() {
    let terms: Vec<String> = (1..700).map(|k| format!("sin({k}x + {k}y)")).collect();
    let text = format!(
        "solid s(x, y, z) = z + {}/100, z : [-1, 1], x : [-1, 1], y : [-1, 1];",
        terms.join(" + ")
    );
    let clause = misfit(&request(&scene(&text), [8, 8], 1)).expect("too large");
    assert!(
        clause.starts_with("`s` is bounded by a function of which")
            && clause.contains("operations are too many"),
        "{clause}"
    );
}
