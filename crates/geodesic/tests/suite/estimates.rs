//! The error estimate is one: over random scenes it is compared with the truth, followed far more exactly.

use crate::random::Random;
use crate::shapes::*;
use geodesic::intrinsic::MetricSurface;
use geodesic::surface::Surface;
use geodesic::trace::{Options, Status, TraceMethod, trace};

/// A surface, a start on it, and how far rays go.
fn scene(random: &mut Random, n: usize) -> (Box<dyn Surface>, [f64; 2], f64) {
    let anywhere = [random.between(0.3, 5.0), random.between(-1.2, 1.2)];
    let length = random.size(0.5, 20.0);
    match n % 8 {
        0 => (
            Box::new(torus(random.between(0.05, 0.95))),
            anywhere,
            length,
        ),
        1 => {
            let axes = [0, 1, 2].map(|_| random.between(0.5, 2.0));
            (
                Box::new(triaxial(axes[0], axes[1], axes[2])),
                anywhere,
                length,
            )
        }
        2 => {
            let waves: Vec<[f64; 3]> = (0..3)
                .map(|_| {
                    [
                        random.size(0.03, 0.5),
                        random.between(-5.0, 5.0),
                        random.between(-5.0, 5.0),
                    ]
                })
                .collect();
            (
                Box::new(waves_over_plane(&waves, false, 50.0)),
                anywhere,
                0.5 * length,
            )
        }
        3 => (
            Box::new(bumps()),
            [0.1 * anywhere[0], 0.1 * anywhere[1]],
            0.05 * length,
        ),
        4 => (Box::new(klein(TAU)), anywhere, length),
        5 => (Box::new(catenoid()), anywhere, 0.4 * length),
        6 => (
            Box::new(spheroid(1.0, random.size(0.1, 5.0))),
            anywhere,
            length,
        ),
        _ => (
            Box::new(half_plane()),
            [anywhere[0], anywhere[1].exp()],
            0.4 * length,
        ),
    }
}

fn gap(s: &dyn Surface, a: [f64; 2], b: [f64; 2]) -> f64 {
    let jet = s.jet(a.into());
    if s.is_embedded() {
        let other = s.jet(b.into()).position;
        return (0..3)
            .map(|k| (jet.position[k] - other[k]).powi(2))
            .sum::<f64>()
            .sqrt();
    }
    (0..3)
        .map(|k| ((b[0] - a[0]) * jet.du[k] + (b[1] - a[1]) * jet.dv[k]).powi(2))
        .sum::<f64>()
        .sqrt()
}

#[test]
fn the_truth_is_within_twice_the_estimate_and_half_of_it() {
    let mut random = Random(5);
    let (mut close, mut known) = (0, 0);
    let mut worst = 0.0_f64;
    let mut far = Vec::new();
    for n in 0..320 {
        let (surface, from, length) = scene(&mut random, n);
        let angle = random.between(0.0, TAU);
        let jet = surface.jet(from.into());
        let size = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let direction = [angle.cos() / size(jet.du), angle.sin() / size(jet.dv)];
        let options = Options {
            tolerance: random.size(1e-10, 1e-5),
            compare: true,
            ..Options::default()
        };
        let run = |options: &Options| {
            trace(surface.as_ref(), from, direction, length, options).expect("a start")
        };
        let end = run(&options);
        let truth = run(&Options {
            tolerance: 1e-13,
            max_evaluations: 400_000,
            compare: false,
            ..options
        });
        if end.status != Status::Complete || truth.status != Status::Complete {
            continue;
        }
        assert!(end.evaluations <= options.max_evaluations);
        let error = gap(surface.as_ref(), truth.uv.0, end.uv.0);
        // Where the truth is not known better than the error, nothing can be said.
        if error < 1e-12 * length || truth.error_estimate > 0.3 * error {
            continue;
        }
        known += 1;
        let ratio = error / end.error_estimate;
        worst = worst.max(ratio);
        if (0.5..=2.0).contains(&ratio) {
            close += 1;
        } else {
            far.push((n, n % 8, ratio, error, options.tolerance));
        }
    }
    println!("{close} of {known}, worst {worst}: {far:?}");
    assert!(known >= 200, "{known}");
    assert!(close * 100 >= known * 95, "{close} of {known}: {far:?}");
    assert!(worst <= 3.0, "{worst}: {far:?}");
}

#[test]
fn an_unchecked_estimate_counts_the_drift_of_a_long_geodesic() {
    // On the unit sphere, round and round. The work suffices for one run, and for no comparison.
    let sphere = spheroid(1.0, 1.0);
    let (from, direction, length) = ([0.3, 0.4], [0.7, 0.5], 4_000.0);
    let options = Options {
        max_evaluations: 400_000,
        compare: true,
        ..Options::default()
    };
    let end = trace(&sphere, from, direction, length, &options).expect("a start");
    assert_eq!(end.status, Status::Complete);
    let jet = sphere.jet(from.into());
    let along = [0, 1, 2].map(|k| direction[0] * jet.du[k] + direction[1] * jet.dv[k]);
    let size = along.iter().map(|x| x * x).sum::<f64>().sqrt();
    let (sin, cos) = length.sin_cos();
    let expected = [0, 1, 2].map(|k| cos * jet.position[k] + sin * along[k] / size);
    let position = end.position.expect("in space");
    let error = (0..3)
        .map(|k| (position[k] - expected[k]).powi(2))
        .sum::<f64>()
        .sqrt();
    assert!(error > 1e-7, "too exact to tell anything: {error:e}");
    assert!(
        error < end.error_estimate,
        "{error:e}, {}",
        end.error_estimate
    );
}

#[test]
fn the_estimate_of_a_run_that_is_cut_off_is_a_bound() {
    let sphere = sphere_in_units(1.0, 1.0, 0.0);
    for (heading, max_evaluations) in [(70.0_f64, 20_000), (70.0, 1_000_000), (40.0, 100_000)] {
        let (sin, cos) = heading.to_radians().sin_cos();
        let options = Options {
            max_evaluations,
            compare: true,
            ..Options::default()
        };
        let end = trace(&sphere, [0.0; 2], [cos, sin], 1e6, &options).expect("a start");
        assert_eq!(end.status, Status::WorkLimit);
        // The great circle.
        let (far, near) = end.length.sin_cos();
        let expected = [near, far * cos, far * sin];
        let found = end.position.expect("a place in space");
        let error = (0..3)
            .map(|k| (found[k] - expected[k]).powi(2))
            .sum::<f64>()
            .sqrt();
        let estimate = end.error_estimate;
        assert!(
            (error..100.0 * error).contains(&estimate),
            "{error}, not {estimate}, of {}",
            end.length
        );
    }
}

#[test]
fn an_estimate_that_cannot_be_checked_is_a_bound() {
    let mut random = Random(7);
    let (mut worst, mut known) = (0.0_f64, 0);
    for n in 0..320 {
        let (surface, from, length) = scene(&mut random, n);
        let angle = random.between(0.0, TAU);
        let run = |options: &Options| {
            trace(
                surface.as_ref(),
                from,
                [angle.cos(), angle.sin()],
                length,
                options,
            )
            .expect("a start")
        };
        let single = Options {
            tolerance: random.size(1e-10, 1e-5),
            max_evaluations: 400_000,
            ..Options::default()
        };
        // The comparison is begun, or not even that.
        let used = run(&single).evaluations;
        let end = run(&Options {
            max_evaluations: used * [2, 4][n % 2],
            compare: true,
            ..single
        });
        let truth = run(&Options {
            tolerance: 1e-13,
            ..single
        });
        let error = gap(surface.as_ref(), truth.uv.0, end.uv.0);
        let is_known = end.status == Status::Complete
            && truth.status == Status::Complete
            && error > 1e-12 * length
            && truth.error_estimate < 0.3 * error;
        if is_known {
            known += 1;
            worst = worst.max(error / end.error_estimate);
        }
    }
    println!("{known}, worst {worst}");
    assert!(known >= 200, "{known}");
    assert!(worst <= 2.0, "{worst}");
}

/// A part of the half-plane of curvature −1, whose sides u = ±4 are glued.
fn part_of_the_half_plane() -> MetricSurface {
    metric([[-4.0, 4.0], [0.02, 8.0]], |m| {
        let one = m.c(1.0);
        let square = m.mul(m.v, m.v);
        let e = m.g.div(one, square);
        let zero = m.c(0.0);
        [e, zero, e]
    })
}

/// The length to the edge of that part: geodesics are half circles about (c, 0), along which s = ln tan(θ/2).
fn to_the_edge([x, y]: [f64; 2], heading: f64) -> f64 {
    let centre = x + y * heading.tan();
    let radius = y.hypot(x - centre);
    let angle = y.atan2(x - centre);
    let clockwise = heading.cos() > 0.0;
    let low = (0.02 / radius).asin();
    let high = (8.0 / radius).min(1.0).asin();
    let crossings = [low, PI - low, high, PI - high];
    let passed = |a: f64| if clockwise { angle - a } else { a - angle };
    // Also of a touch from within, where `high` is the highest point.
    let ahead = (crossings.into_iter()).filter(|&a| passed(a) > 0.0 && a != 0.5 * PI);
    let s = |a: f64| (0.5 * a).tan().ln();
    let lengths = ahead.map(|a| (s(a) - s(angle)).abs());
    lengths.fold(f64::INFINITY, f64::min)
}

/// Rays of that part, with the lengths to its edge.
fn rays_to_the_edge(seed: u64, count: usize) -> Vec<([f64; 2], [f64; 2], f64)> {
    let mut random = Random(seed);
    let ray = |_| {
        let from = [random.between(-3.5, 3.5), random.between(0.5, 6.0)];
        let heading = random.between(0.0, TAU);
        (
            from,
            [heading.cos(), heading.sin()],
            to_the_edge(from, heading),
        )
    };
    (0..count).map(ray).collect()
}

#[test]
fn a_ray_ends_on_the_edge_that_it_meets() {
    let surface = part_of_the_half_plane();
    let heading = 321.0_f64.to_radians();
    let named = [2.42, 3.31];
    let mut rays = rays_to_the_edge(41, 400);
    rays.push((named, [heading.cos(), heading.sin()], 5.313_949_872_954_259));
    for tolerance in [1.5e-10, 2e-14] {
        let options = Options {
            tolerance,
            ..Options::default()
        };
        for (from, direction, expected) in &rays {
            let end = trace(&surface, *from, *direction, 40.0, &options).expect("a start");
            assert_eq!(end.status, Status::LeftDomain, "{end:?}");
            let error = (end.length - expected).abs();
            assert!(
                error < 1e-7,
                "{from:?} {direction:?} {expected} {error:e} {end:?}"
            );
        }
    }
}

#[test]
fn the_length_of_a_ray_that_left_is_within_its_estimate() {
    let surface = part_of_the_half_plane();
    let mut random = Random(42);
    for (from, direction, expected) in rays_to_the_edge(43, 300) {
        let options = Options {
            tolerance: random.size(1e-9, 1e-2),
            compare: true,
            ..Options::default()
        };
        let end = trace(&surface, from, direction, 40.0, &options).expect("a start");
        assert_eq!(end.status, Status::LeftDomain, "{end:?}");
        let error = (end.length - expected).abs();
        assert!(
            error <= 2.0 * end.error_estimate,
            "{from:?} {direction:?} {expected} {error:e} {end:?}"
        );
    }
}

#[test]
fn steps_that_are_too_long_to_converge_claim_little() {
    let pancake = spheroid(1.0, 0.05);
    let mut compared = 0;
    for n in 0..40 {
        let heading = 0.15 * f64::from(n);
        let (from, direction) = ([0.8, -0.3], [heading.cos(), heading.sin()]);
        let run = |options: &Options| trace(&pancake, from, direction, 5.0, options);
        let truth = run(&Options::default()).expect("a start");
        for steps in [64, 512] {
            let end = run(&Options {
                method: TraceMethod::Rk4 { steps },
                ..Options::default()
            });
            let end = end.expect("a start");
            let error = gap(&pancake, truth.uv.0, end.uv.0);
            if end.status == Status::Complete && end.error_estimate > 1e-3 {
                assert!(error <= 5.0 * end.error_estimate, "{error:e} {end:?}");
                compared += 1;
            }
        }
    }
    assert!(compared > 10, "{compared}");
}

#[test]
fn a_length_without_digits_takes_no_work() {
    let end = trace(
        &torus(0.4),
        [0.3, 0.2],
        [1.0, 0.5],
        1e-320,
        &Options::default(),
    );
    let end = end.expect("a start");
    assert_eq!((end.status, end.length), (Status::Complete, 0.0));
    assert!(end.evaluations < 100, "{}", end.evaluations);
}

#[test]
fn without_comparison_the_estimate_is_a_bound() {
    let mut random = Random(6);
    let mut compared = 0;
    for n in 0..160 {
        let (surface, from, length) = scene(&mut random, n);
        let angle = random.between(0.0, TAU);
        let jet = surface.jet(from.into());
        let size = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let direction = [angle.cos() / size(jet.du), angle.sin() / size(jet.dv)];
        let run = |options: &Options| {
            trace(surface.as_ref(), from, direction, length, options).expect("a start")
        };
        let end = run(&Options::default());
        let truth = run(&Options {
            tolerance: 1e-13,
            max_evaluations: 400_000,
            ..Options::default()
        });
        if end.status != Status::Complete || truth.status != Status::Complete {
            continue;
        }
        let error = gap(surface.as_ref(), truth.uv.0, end.uv.0);
        if truth.error_estimate > 0.3 * error {
            continue;
        }
        assert!(
            error <= 3.0 * end.error_estimate + 1e-14 * length,
            "{n}: {error:e} {end:?}"
        );
        compared += 1;
    }
    assert!(compared > 50, "{compared}");
}
