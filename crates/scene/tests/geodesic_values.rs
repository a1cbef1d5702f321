//! Geodesics as functions of their parameter, against closed forms.

use std::f64::consts::{FRAC_PI_2, PI};

use scene::geotrace::{Compilation, Document, compile};
use scene::{Outcome, ParamValues, Scene, Value};

/// A unit sphere by longitude and latitude, as a surface and as a metric.
const SPHERES: [&str; 2] = [
    "surface s(u, v) = (cos u cos v, sin u cos v, sin v), u : [-pi, pi], v : [-pi/2, pi/2];",
    "metric s(u, v) = (cos^2 v, 0, 1), u : [-pi, pi], v : [-pi/2, pi/2];",
];

fn compiled(source: &str) -> Compilation {
    let compilation = compile(source);
    assert!(!compilation.has_errors(), "{:#?}", compilation.diagnostics);
    compilation
}

fn values(compilation: &Compilation, params: &ParamValues, text: &str) -> Vec<f64> {
    let found = compilation.evaluate(text, params);
    let found = found.unwrap_or_else(|errors| panic!("{text}: {errors:#?}"));
    let number = |x: Option<f64>| x.unwrap_or(f64::NAN);
    match found.outcome {
        Outcome::Single(Value::Number(x)) => vec![number(x)],
        Outcome::Single(Value::Vector(xs)) => xs.into_iter().map(number).collect(),
        other => panic!("{text}: {other:?}"),
    }
}

fn initial(compilation: &Compilation) -> ParamValues {
    ParamValues::initial(compilation.scene.as_ref().expect("a scene"))
}

#[track_caller]
fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= tolerance, "{found:?}, not {expected:?}");
    }
}

#[test]
fn points_and_velocities_on_a_sphere_are_those_of_great_circles() {
    for sphere in SPHERES {
        let source = format!(
            "{sphere} param L : [0, 3];
             geodesic g(t) : s = (3, 3) @ (0, 0), t : [0, 1];
             function v(t) = (g(t))_2;"
        );
        let compilation = compiled(&source);
        let mut params = initial(&compilation);
        let scene = compilation.scene.as_ref().expect("a scene");
        params.set(scene, "L", &[1.25]).expect("in range");
        // At 45° from the equator: sin v = sin t/√2, tan u = tan t/√2.
        let place = |t: f64| {
            [
                (t.tan() / 2f64.sqrt()).atan(),
                (t.sin() / 2f64.sqrt()).asin(),
            ]
        };
        let close = |text: &str, expected: &[f64], tolerance: f64| {
            assert_close(&values(&compilation, &params, text), expected, tolerance);
        };
        close("g(1)", &place(1.0), 1e-11);
        close("g(L)", &place(1.25), 1e-11);
        close("g(-L/2)", &place(-0.625), 1e-11);
        let h = 1e-5;
        let slope = |t: f64| -> Vec<f64> {
            let (a, b) = (place(t - h), place(t + h));
            vec![(b[0] - a[0]) / (2.0 * h), (b[1] - a[1]) / (2.0 * h)]
        };
        close("g'(L)", &slope(1.25), 1e-9);
        close("g'(-1)", &slope(-1.0), 1e-9);
        // The second and third derivatives of sin v = sin t/√2, by the function that reads g.
        let (t, c) = (0.8f64, 0.5f64.sqrt());
        let v = (c * t.sin()).asin();
        let v1 = c * t.cos() / v.cos();
        let v2 = (-c * t.sin() + v.sin() * v1 * v1) / v.cos();
        let v3 = (-c * t.cos() + v.cos() * v1.powi(3) + 3.0 * v.sin() * v1 * v2) / v.cos();
        close("(g''0.8)_2", &[v2], 1e-10);
        close("v'0.8", &[v1], 1e-10);
        close("v''0.8", &[v2], 1e-10);
        close("v'''0.8", &[v3], 1e-9);
    }
}

#[test]
fn an_octant_is_a_triangle_of_three_right_angles() {
    for sphere in SPHERES {
        let source = format!(
            "{sphere}
             define A = (0, 0); define B = (pi/2, 0); param c : [0.2, 1.5];
             geodesic a(t) : s = (A, B), t : [0, 1];
             geodesic b(t) : s = (1, 0) @ B, t : [0, 1];
             geodesic d(t) : s = (A, (0, c)), t : [0, 1];
             geodesic k(t) : s = (-(a'1)_2, (a'1)_1) @ a(1), t : [0, 1];"
        );
        let compilation = compiled(&source);
        let params = initial(&compilation);
        let close = |text: &str, expected: &[f64]| {
            assert_close(&values(&compilation, &params, text), expected, 1e-9);
        };
        close("a(0)", &[0.0, 0.0]);
        close("a(1)", &[FRAC_PI_2, 0.0]);
        close("a(0.5)", &[PI / 4.0, 0.0]);
        close("a'(0.25)", &[FRAC_PI_2, 0.0]);
        close("d(0.5)", &[0.0, 0.1]);
        close("k(1)", &[FRAC_PI_2, 1.0]);
        // Between a place and itself nothing moves.
        let same = compiled(&format!(
            "{sphere} geodesic a(t) : s = ((1, 1), (1, 1)), t : [0, 1];"
        ));
        assert_close(&values(&same, &initial(&same), "a(0.5)"), &[1.0, 1.0], 0.0);
    }
}

#[test]
fn a_slider_integrates_only_what_depends_on_it() {
    let compilation = compiled(
        "surface s(u, v) = (cos u cos v, sin u cos v, sin v), u : [-pi, pi], v : [-pi/2, pi/2];
         param a : [0, 1]; param b : [0, 1];
         geodesic g(t) : s = (1, 1) @ (a, 0), t : [0, 1];
         geodesic h(t) : s = (1, 1) @ (b, 0.25), t : [0, 1];
         point p = s(g(1)); point q = s(h(1)); point r = s(g(1)) + s(h(1)); point o = (1, 2, 3);",
    );
    let scene: &Scene = compilation.scene.as_ref().expect("a scene");
    let mut params = ParamValues::initial(scene);
    let draw = |params: &ParamValues| {
        for (_, object) in scene.numbered() {
            let _ = params.first_instance(scene, object);
        }
        scene.geodesic_cache.integrated()
    };
    assert_eq!(draw(&params), 2);
    assert_eq!(draw(&params), 2);
    params.set(scene, "a", &[0.5]).expect("in range");
    assert_eq!(draw(&params), 3);
    params.set(scene, "b", &[0.5]).expect("in range");
    assert_eq!(draw(&params), 4);
    params.set(scene, "a", &[0.0]).expect("in range");
    assert_eq!(draw(&params), 4);
    let (_, o) = scene.object("o").expect("an object");
    assert!(o.geodesic_values.is_empty());
}

#[test]
fn what_has_no_value_says_why() {
    let compilation = compiled(
        "surface s(u, v) = (u, v, 0), u : [0, 1], v : [0, 1];
         surface annulus(r, a) = (r cos a, r sin a, 0), r : [1, 2], a : [0, 1];
         param L : [0, 3];
         geodesic g(t) : s = (1, 0) @ (0.25, 0.5), t : [0, 1];
         geodesic h(t) : s = (1, 0) @ (L, 0), t : [0, 1];
         geodesic i(t) : s = ((0, 0), (L, 0.5)), t : [0, 1];
         point p = s(g(L)); point q = s(h(0)); point r = s(i(1)); point z = s(h((g(L))_1));",
    );
    let scene = compilation.scene.as_ref().expect("a scene");
    let mut params = ParamValues::initial(scene);
    params.set(scene, "L", &[2.0]).expect("in range");
    let reasons = |name: &str| -> Vec<String> {
        let (_, object) = scene.object(name).expect("an object");
        let uniforms = params.first_instance(scene, object);
        let faults = scene.geodesic_faults(object, &uniforms).into_iter();
        faults
            .map(|(name, fault)| format!("{name}: {fault}"))
            .collect()
    };
    assert_eq!(
        reasons("p"),
        ["g: it ends at 0.750000, before 2: it leaves the domain"]
    );
    assert_eq!(
        reasons("q"),
        ["h: the point (2, 0) lies outside the domain [0, 1] × [0, 1]"]
    );
    assert_eq!(
        reasons("r"),
        ["i: the point (2, 0.5) lies outside the domain [0, 1] × [0, 1]"]
    );
    let evaluation = compilation.evaluate("s(g(L))", &params).expect("no error");
    assert_eq!(
        evaluation.outcome,
        Outcome::Single(Value::Vector(vec![None, None, Some(0.0)]))
    );
    let warnings: Vec<&str> = evaluation.warnings.iter().map(|it| &*it.message).collect();
    assert_eq!(
        warnings,
        ["`g` has no value here: it ends at 0.750000, before 2: it leaves the domain"]
    );
}

#[test]
fn a_curve_along_a_geodesic_is_followed_at_its_own_parameter() {
    let compilation = compiled(
        "surface s(u, v) = (cos u cos v, sin u cos v, sin v), u : [-pi, pi], v : [-pi/2, pi/2];
         geodesic g(t) : s = (1, 1) @ (0, 0), t : [0, 1];
         geodesic h(t) : s = (1, 0) @ (0, 0), t : [0, 1];
         curve c(t) = s(g(2t)) + (0, 0, (h((g(t))_1))_1), t : [0, 0.5];",
    );
    let scene = compilation.scene.as_ref().expect("a scene");
    let (_, object) = scene.object("c").expect("a curve");
    assert_eq!(object.shape.followed().len(), 3);
    let params = ParamValues::initial(scene);
    let uniforms = params.first_instance(scene, object);
    let variables = scene.curve_variables(&object.shape, &uniforms, 0.25);
    assert_eq!(variables.len(), 13);
    let position = object.shape.position().expect("a position");
    let tape = expr::tape::Tape::new(&scene.graph, position);
    let inputs = tape.inputs().iter().map(|input| match *input {
        expr::Input::Variable(k) => variables[k as usize],
        expr::Input::Uniform(k) => uniforms[k as usize],
    });
    let inputs: Vec<f64> = inputs.collect();
    let mut found = [f64::NAN; 3];
    tape.eval(&mut expr::tape::Registers::default(), &inputs, &mut found);
    let expected = values(&compilation, &params, "c(0.25)");
    assert_close(&found, &expected, 0.0);
}

#[test]
fn an_edit_of_what_a_geodesic_reads_reaches_its_readers() {
    let text = "surface s(u, v) = (u, v, 0), u : [0, 4], v : [0, 4];
define a = 1;
geodesic g(t) : s = (a, 0) @ (0, 1), t : [0, 1];
point p = s(g(1));
param L : [(g(1))_1, 9];
";
    let mut document = Document::new(text).expect("a text");
    assert!(document.compilation().scene.is_some());
    let at = text.find("(a, 0)").expect("a direction") as u32 + 4;
    let span = syntax::span::Span::new(at, at + 1);
    document.edit(span, "1").expect("an edit");
    let scene = document.compilation().scene.clone().expect("a scene");
    let least = scene.params[0].ranges[0].min;
    assert!((least - 0.5f64.sqrt()).abs() < 1e-12, "{least}");
}

#[test]
fn a_point_far_along_a_geodesic_is_as_exact_as_a_near_one() {
    let compilation = compiled(
        "surface s(u, v) = (cos u cos v, sin u cos v, sin v), u : [-pi, pi], v : [-pi/2, pi/2];
         geodesic g(t) : s = (3, 3) @ (0, 0), t : [0, 1];",
    );
    let params = initial(&compilation);
    for t in [150.0_f64, 300.0, 600.0] {
        let found = values(&compilation, &params, &format!("g({t})"));
        let latitude = (t.sin() / 2f64.sqrt()).asin();
        assert_close(&found[1..2], &[latitude], 1e-9);
    }
}

#[test]
fn a_geodesic_on_a_solid_may_begin_at_the_origin() {
    let compilation = compiled(
        "solid ball(x, y, z) = x^2 + y^2 + (z - sqrt 2)^2 - 2;
         geodesic c(t) : ball = (1, 0, 0) @ (0, 0, 0), t : [0, 2];",
    );
    let r = 2f64.sqrt();
    let found = values(&compilation, &initial(&compilation), "c(1)");
    let expected = [r * (1.0 / r).sin(), 0.0, r * (1.0 - (1.0 / r).cos())];
    assert_close(&found, &expected, 1e-10);
}
