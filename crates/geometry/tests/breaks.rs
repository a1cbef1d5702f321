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
    let found = breaks.map(|breaks| breaks.along(&domain[0], &uniforms));
    (found.unwrap_or_default(), domain[0])
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

/// The pairs of samples between which a surface breaks off, sorted, the lesser place first.
fn between(position: &str) -> (Vec<[[u32; 2]; 2]>, Vec<Sampling>) {
    let scene = scene(&format!(
        "surface s(u, v) = (u, v, {position}), u : [-2, 2, 40], v : [-1, 3, 30];"
    ));
    let (breaks, domain, uniforms) = breaks(&scene);
    let mut found = breaks
        .expect("a divisor")
        .between(&[domain[0], domain[1]], &uniforms);
    for pair in &mut found {
        pair.sort_unstable();
    }
    found.sort_unstable();
    found.dedup();
    (found, domain)
}

#[test]
fn a_surface_breaks_off_where_its_divisor_changes_sign() {
    type Divisor = fn(f64, f64) -> f64;
    let cases: [(&str, Divisor); 4] = [
        ("1/(u + v)", |u, v| u + v),
        ("1/(u^2 + v^2 - 1.1)", |u, v| u * u + v * v - 1.1),
        ("atan(1/(u - v^2))", |u, v| u - v * v),
        ("tan u", |u, _| u.cos()),
    ];
    for (position, divisor) in cases {
        let (found, domain) = between(position);
        let at = |[i, j]: [u32; 2]| divisor(domain[0].value(i), domain[1].value(j));
        let mut expected = Vec::new();
        for i in 0..domain[0].count {
            for j in 0..domain[1].count {
                for next in [[i + 1, j], [i, j + 1]] {
                    let is_there = next[0] < domain[0].count && next[1] < domain[1].count;
                    if is_there && at([i, j]) * at(next) < 0.0 {
                        expected.push([[i, j], next]);
                    }
                }
            }
        }
        expected.sort_unstable();
        assert!(expected.len() > 20, "{position}");
        assert_eq!(found, expected, "{position}");
    }
    for position in ["u v/(1 + u^2 + v^2)", "sin(u + v)/(u + v)"] {
        assert!(between(position).0.is_empty(), "{position}");
    }
}
