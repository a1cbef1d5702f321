//! Where curves and surfaces break off, against poles and jumps that are known.

use std::f64::consts::FRAC_PI_2;

use geometry::Breaks;
use scene::{ParamValues, Sampling, Scene};

fn scene(text: &str) -> Scene {
    let compilation = scene::geotrace::compile(text);
    compilation
        .scene
        .unwrap_or_else(|| panic!("{text}: {:?}", compilation.diagnostics))
}

/// The first object's breaks, its sampling, and the numbers of its first instance.
fn breaks(scene: &Scene) -> (Option<Breaks>, Vec<Sampling>, Vec<f64>) {
    let object = &scene.objects[0];
    let params = ParamValues::initial(scene);
    let uniforms = params.first_instance(scene, object);
    (
        Breaks::of(scene, &params, object),
        object.shape.domain().to_vec(),
        uniforms,
    )
}

/// The samples behind which a curve breaks off; none for one that is known to be continuous.
fn along(position: &str, domain: &str) -> (Vec<u32>, Sampling) {
    let scene = scene(&format!(
        "param k = 1 : [-3, 3]; curve c(t) = {position}, t : {domain};"
    ));
    let (breaks, domain, uniforms) = breaks(&scene);
    let found = breaks.and_then(|breaks| breaks.find(&domain, &uniforms));
    let found = found.into_iter().flat_map(|found| found.breaks);
    let found = found.map(|it| it.first[0]);
    (found.collect(), domain[0])
}

/// The samples before some parameters.
fn before(domain: &Sampling, parameters: &[f64]) -> Vec<u32> {
    let pieces = 0..domain.count - 1;
    let holds = |i: &u32| {
        let inside = |p: &f64| domain.value(*i) < *p && *p < domain.value(i + 1);
        parameters.iter().any(inside)
    };
    pieces.filter(holds).collect()
}

#[test]
fn a_curve_breaks_off_at_poles_and_jumps_and_nowhere_else() {
    let cases: [(&str, &str, &[f64]); 16] = [
        ("(t, tan t, 0)", "[-4, 4, 200]", &[-FRAC_PI_2, FRAC_PI_2]),
        ("(t, 1/t, 0)", "[-1, 2, 50]", &[0.0]),
        ("(t, 1/t^2, 0)", "[-4, 4, 200]", &[0.0]),
        ("(t, t^(-3), 0)", "[-4, 4, 7002]", &[0.0]),
        ("(t, log(abs t), 0)", "[-4, 4, 200]", &[0.0]),
        ("(t, atan(1/t), 0)", "[-4, 4, 200]", &[0.0]),
        ("(t, 0, t/abs(t))", "[-4, 4, 200]", &[0.0]),
        ("(t, 1/(t - k), 1/(t + k))", "[-4, 4, 200]", &[-1.0, 1.0]),
        ("(t, 1/(t - k), 0)", "[-4, 4, 2]", &[1.0]),
        ("(t, tan t, 0)", "[0, 1.5, 50]", &[]),
        ("(t, sin t/t, 0)", "[-8, 8, 200]", &[]),
        ("(t, (1 - cos t)/t^2, t^2/t)", "[-8, 8, 200]", &[]),
        ("(t, 1/(1 + t^2), 0)", "[-8, 8, 200]", &[]),
        ("(t, 1/(t^2 + 0.000000000001), 0)", "[-8, 8, 200]", &[]),
        ("(t, sqrt t, log t)", "[-8, 8, 200]", &[]),
        ("(t, 1/k, t^3/2)", "[-8, 8, 200]", &[]),
    ];
    for (position, range, parameters) in cases {
        let (found, domain) = along(position, range);
        assert_eq!(found, before(&domain, parameters), "{position} on {range}");
    }
}

#[test]
fn what_is_continuous_by_its_formula_is_not_searched() {
    for position in ["(t, sqrt t, abs t)", "(cos t, max(t, 0), t^4/k)"] {
        let scene = scene(&format!(
            "param k = 1 : [1, 2]; curve c(t) = {position}, t : [0, 1];"
        ));
        assert!(breaks(&scene).0.is_none(), "{position}");
    }
}

#[test]
fn each_of_many_poles_is_found() {
    let mut seed = 1_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 33) as f64 / f64::from(1_u32 << 31)
    };
    for _ in 0..200 {
        let poles: Vec<f64> = (0..5).map(|_| 20.0 * random() - 10.0).collect();
        let factor = |(n, pole): (usize, &f64)| match n % 2 {
            0 => format!("(t - ({pole}))"),
            _ => format!("(t - ({pole}))^2"),
        };
        let factors: Vec<String> = poles.iter().enumerate().map(factor).collect();
        // Near poles of other factors the value is large, and far from all of them tiny.
        let position = format!("(t, 1/({}), 0)", factors.join(" "));
        let (found, domain) = along(&position, "[-10, 10, 777]");
        assert_eq!(found, before(&domain, &poles), "{position}");
    }
}

#[test]
fn what_changes_faster_than_its_samples_breaks_off_nowhere() {
    let (found, _) = along("(t, tan(1000000 t), 0)", "[0, 1, 100000]");
    assert!(found.is_empty(), "{}", found.len());
    let (found, domain) = along("(t, tan(1000 t), 0)", "[0, 1, 100000]");
    let pole = |n: i32| (f64::from(n) + 0.5) * 2.0 * FRAC_PI_2 / 1000.0;
    let poles: Vec<f64> = (0..400).map(pole).collect();
    assert_eq!(found, before(&domain, &poles));
}

/// The cells in which a surface breaks off, sorted.
fn cells(position: &str) -> (Vec<[u32; 2]>, Vec<Sampling>) {
    let scene = scene(&format!(
        "surface s(u, v) = (u, v, {position}), u : [-2, 2, 40], v : [-1, 3, 30];"
    ));
    let (breaks, domain, uniforms) = breaks(&scene);
    let found = breaks.and_then(|breaks| breaks.find(&domain, &uniforms));
    let mut found: Vec<[u32; 2]> = found
        .expect("a divisor")
        .breaks
        .iter()
        .map(|it| it.first)
        .collect();
    found.sort_unstable();
    (found, domain)
}

#[test]
fn a_surface_breaks_off_where_its_divisor_changes_sign() {
    type Divisor = fn(f64, f64) -> f64;
    let cases: [(&str, Divisor); 5] = [
        ("1/(u + v)", |u, v| u + v),
        ("1/(u^2 + v^2 - 1.1)", |u, v| u * u + v * v - 1.1),
        ("atan(1/(u - v^2))", |u, v| u - v * v),
        ("tan u", |u, _| u.cos()),
        ("u/abs u", |u, _| u),
    ];
    for (position, divisor) in cases {
        let (found, domain) = cells(position);
        let at = |[i, j]: [u32; 2]| divisor(domain[0].value(i), domain[1].value(j));
        let mut expected = Vec::new();
        for i in 0..domain[0].count - 1 {
            for j in 0..domain[1].count - 1 {
                let corners = [[i, j], [i + 1, j], [i, j + 1], [i + 1, j + 1]].map(at);
                let [least, most] = [f64::min, f64::max].map(|of| corners.into_iter().reduce(of));
                if least < Some(0.0) && most > Some(0.0) {
                    expected.push([i, j]);
                }
            }
        }
        assert!(expected.len() > 20, "{position}");
        assert_eq!(found, expected, "{position}");
    }
    for position in ["u v/(1 + u^2 + v^2)", "sin(u + v)/(u + v)"] {
        assert!(cells(position).0.is_empty(), "{position}");
    }
}

#[test]
fn a_surface_breaks_off_at_a_pole_within_a_cell() {
    let poles = [
        "1/(u^2 + v^2)",
        "log((u - 0.31)^2 + (v - 1.7)^2)",
        "(u - 1)(v + 0.5)/((u - 1)^2 + (v + 0.5)^2)^2",
        "((u + 1)^2 + v^2)^(-0.1)",
    ];
    for (position, pole) in
        poles
            .into_iter()
            .zip([[0.0, 0.0], [0.31, 1.7], [1.0, -0.5], [-1.0, 0.0]])
    {
        let (found, domain) = cells(position);
        assert!(!found.is_empty(), "{position}");
        for [i, j] in found {
            let is_near = [(0, i), (1, j)].into_iter().all(|(k, n): (usize, u32)| {
                let ends = [n, n + 1].map(|n| domain[k].value(n));
                ends[0] - 1e-9 <= pole[k] && pole[k] <= ends[1] + 1e-9
            });
            assert!(is_near, "{position}: {i}, {j}");
        }
    }
    for position in [
        "u v/(u^2 + v^2)",
        "sin(u^2 + v^2)/(u^2 + v^2)",
        "(u^2 + v^2)^0.1",
        "u^3/(u^2 + v^2)",
    ] {
        assert!(cells(position).0.is_empty(), "{position}");
    }
}

#[test]
fn a_pole_is_known_from_a_jump_and_a_cusp_is_no_break() {
    let kinds = |position: &str| -> Vec<bool> {
        let scene = scene(&format!("curve c(t) = (t, {position}, 0), t : [-3, 2.6];"));
        let (breaks, domain, uniforms) = breaks(&scene);
        let found = breaks.expect("a divisor").find(&domain, &uniforms);
        let breaks = found.expect("few").breaks;
        breaks.iter().map(|it| it.is_pole).collect()
    };
    for position in [
        "1/t",
        "1/t^2",
        "log(abs t)",
        "tan(t - pi/2)",
        "(abs t)^(-0.3)",
    ] {
        assert_eq!(kinds(position), [true], "{position}");
    }
    for position in ["t/abs t", "atan(1/t)", "3t + 0.2t/abs t"] {
        assert_eq!(kinds(position), [false], "{position}");
    }
    for position in [
        "(abs t)^0.1",
        "t/(abs t)^0.95",
        "t/(abs t)^(2/3)",
        "t sin(1/t)",
        "(1 - cos t)/t^2",
    ] {
        assert!(kinds(position).is_empty(), "{position}");
    }
}

#[test]
fn a_pole_at_a_sample_is_known() {
    let poles = |object: &str| {
        let scene = scene(object);
        let (breaks, domain, uniforms) = breaks(&scene);
        let found = breaks.expect("a divisor").find(&domain, &uniforms);
        found.expect("few").poles
    };
    let curve = |y: &str| poles(&format!("curve c(t) = (t, {y}, 0), t : [-1, 2, 31];"));
    for position in [
        "1/t",
        "1/t - 1/t^2",
        "log(abs t)",
        "log t",
        "1/sqrt(-t)",
        "exp(1/t)",
        "(cos t)/sin t",
    ] {
        assert_eq!(curve(position), [[10, 0]], "{position}");
    }
    assert_eq!(curve("1/(t + 1) + 1/(t - 2)"), [[0, 0], [30, 0]]);
    for position in [
        "sin t/t",
        "t/abs t",
        "atan(1/t)",
        "sqrt t/(abs t)^0.2",
        "sin(1/t)",
        "1/(t - 0.05)",
    ] {
        assert!(curve(position).is_empty(), "{position}");
    }
    let surface = |z: &str| {
        poles(&format!(
            "surface s(u, v) = (u, v, {z}), u : [-1, 1, 5], v : [-1, 1, 3];"
        ))
    };
    assert_eq!(surface("1/u"), [[2, 0], [2, 1], [2, 2]]);
    assert_eq!(surface("1/(u^2 + v^2)"), [[2, 1]]);
    assert_eq!(surface("1/(u - v)"), [[0, 0], [2, 1], [4, 2]]);
    assert!(surface("u v/(u^2 + v^2)").is_empty());
}

#[test]
fn a_pole_next_to_a_number_is_a_pole_at_it() {
    let poles = |y: &str, t: &str| -> Vec<u32> {
        let scene = scene(&format!("curve c(t) = (t, {y}, 0), t : {t};"));
        let (breaks, domain, uniforms) = breaks(&scene);
        let found = breaks.expect("a divisor").find(&domain, &uniforms);
        let poles = found.expect("few").poles;
        poles.iter().map(|[i, _]| *i).collect()
    };
    // At these ends f64 has a value, because no number is π or π/2.
    assert_eq!(poles("tan t", "[-pi/2, pi/2, 40]"), [0, 39]);
    assert_eq!(poles("tan t", "[0, pi, 101]"), [50]);
    assert_eq!(poles("1/sin t", "[0.5, pi]"), [99]);
    assert_eq!(poles("log(sin t)", "[pi/2, pi, 30]"), [29]);
    assert_eq!(poles("1/(1 - t)", "[0, 0.9999999999999999, 11]"), [10]);
    // Large values at ends that are farther from a pole are values.
    for (position, range) in [
        ("tan t", "[-1.5707, 1.5707]"),
        ("tan t", "[0, 1.570796326794]"),
        ("1/(1 - t)", "[0, 0.999999999999]"),
        ("log(t + 0.00000000000000001)", "[0, 1]"),
        ("1/(t^2 + 0.000000000000000000000000000001)", "[0, 1]"),
        ("(sin t)/(pi - t)", "[0, pi]"),
        ("(sin t)/abs(sin t)", "[1, pi]"),
        ("(sin t)^0.3", "[1, pi]"),
    ] {
        assert!(poles(position, range).is_empty(), "{position} on {range}");
    }
}

#[test]
fn a_gap_in_a_formula_has_its_limit() {
    let limit = |position: &str, at: [f64; 2]| {
        let scene = scene(&format!(
            "surface s(u, v) = (u, v, {position}), u : [-1, 1, 41], v : [-1, 1, 41];"
        ));
        let (breaks, domain, uniforms) = breaks(&scene);
        let limit = breaks.expect("a divisor").limit(&domain, &uniforms, at);
        limit.map(|limit| limit[2])
    };
    let cases = [
        ("sin u/u", [0.0, 0.3], 1.0),
        ("(1 - cos u)/u^2", [0.0, 0.0], 0.5),
        ("(u^3 - v^3)/(u - v)", [0.5, 0.5], 0.75),
        ("sin(3sqrt(u^2 + v^2))/sqrt(u^2 + v^2)", [0.0, 0.0], 3.0),
        ("u v/sqrt(u^2 + v^2)", [0.0, 0.0], 0.0),
    ];
    for (position, at, expected) in cases {
        let found = limit(position, at).unwrap_or_else(|| panic!("{position}"));
        assert!((found - expected).abs() < 1e-5, "{position}: {found}");
    }
    for position in [
        "1/u",
        "1/u^2",
        "log(abs u)",
        "u/abs u",
        "(u^2 - v^2)/(u^2 + v^2)",
    ] {
        assert_eq!(limit(position, [0.0; 2]), None, "{position}");
    }
    assert_eq!(limit("sqrt(u - 2)/(1 + u)", [0.0; 2]), None);
}
