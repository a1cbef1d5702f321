//! Where geodesics end that cannot go on: with the right status, at the right place, without wasting work.

use crate::shapes::*;
use expr::ops::Unary;
use geodesic::surface::Surface;
use geodesic::trace::{Options, Status, Trace, TraceMethod, trace};

fn go(surface: &dyn Surface, from: [f64; 2], direction: [f64; 2], length: f64) -> Trace {
    trace(surface, from, direction, length, &Options::default()).expect("a start")
}

#[test]
fn a_cuspidal_edge_ends_a_ray_within_two_thousand_evaluations() {
    let s = cuspidal();
    // (u², u³) unrolls to a line with this coordinate.
    let arc = |u: f64| (f64::powf(4.0 + 9.0 * u * u, 1.5) - 8.0) / 27.0;
    for start in [0.5, -0.5, 0.2] {
        for across in [0.0, 0.1, 1.0, 1.5_f64] {
            let along = start * f64::sqrt(4.0 + 9.0 * start * start);
            let v = -0.5 * across.signum();
            let end = go(&s, [start, v], [-start.signum(), across * along.abs()], 3.0);
            let expected = arc(start) * across.hypot(1.0);
            assert_eq!(end.status, Status::Degenerate, "{end:?}");
            assert!(
                end.length <= expected && end.length > expected - 2e-6,
                "{end:?} {expected}"
            );
            assert!(end.evaluations <= 2_000, "{end:?}");
            // Exact as far as it went.
            let error = ((arc(start) - arc(end.uv[0])) * across.hypot(1.0) - end.length).abs();
            assert!(
                error <= 3.0 * end.error_estimate + 1e-15,
                "{error:e} {end:?}"
            );
        }
    }
}

#[test]
fn a_flat_rim_is_not_taken_for_a_loss_of_rank() {
    for b in [0.1, 0.01, 0.001] {
        let end = go(&spheroid(1.0, b), [0.3, 0.2], [0.3, 1.0], 1.5);
        assert_eq!(end.status, Status::Complete, "{b} {end:?}");
        let clairaut = |uv: [f64; 2], d: [f64; 2]| uv[1].cos().powi(2) * d[0];
        let start = go(&spheroid(1.0, b), [0.3, 0.2], [0.3, 1.0], 0.0);
        let drift = clairaut(end.uv.0, end.direction.0) - clairaut(start.uv.0, start.direction.0);
        assert!(drift.abs() < 1e-10, "{b} {drift:e} {end:?}");
    }
}

#[test]
fn the_rim_of_a_dome_costs_less_than_the_limit() {
    for (from, direction) in [
        ([0.0, 0.0], [1.0, 0.5]),
        ([0.5, 0.1], [1.0, 0.0]),
        ([0.0, 0.0], [1.0, 1.0]),
        ([0.3, -0.2], [0.3, 1.0]),
    ] {
        let end = go(&dome(), from, direction, 3.0);
        assert_eq!(end.status, Status::Degenerate, "{end:?}");
        assert!(end.evaluations <= 12_000, "{end:?}");
        let height = (1.0 - end.uv[0].powi(2) - end.uv[1].powi(2)).sqrt();
        assert!(height < 1e-3, "{end:?}");
    }
}

#[test]
fn an_edge_is_met_exactly_where_the_formula_ends_there() {
    // A half plane as (√u, v), undefined for u < 0, and singular on the edge itself; a cut-off one beside it.
    for low in [1e-3, 0.25] {
        let s = root_plane(low);
        for (from, direction) in [([1.0, 0.0], [-1.0, 0.2]), ([2.0, 1.0], [-1.0, -0.7])] {
            let end = go(&s, from, direction, 100.0);
            assert_eq!(end.status, Status::LeftDomain, "{end:?}");
            // Straight in x = √u.
            let (x, slope) = (
                f64::sqrt(from[0]),
                direction[0] / (2.0 * f64::sqrt(from[0])),
            );
            let time = (f64::sqrt(low) - x) / slope;
            let expected = time * slope.hypot(direction[1]);
            assert!((end.length - expected).abs() < 1e-12, "{end:?} {expected}");
            assert_eq!(end.uv[0], low);
            assert!(
                (end.uv[1] - (from[1] + time * direction[1])).abs() < 1e-12,
                "{end:?}"
            );
        }
    }
    // Defined on the edge and nowhere beyond: ln and √ give NaN there.
    let s = walled_plane();
    for direction in [[-1.0, 0.3], [-1.0, 0.0], [-1.0, -3.0]] {
        let end = go(&s, [0.8, 0.0], direction, 50.0);
        assert_eq!(end.status, Status::LeftDomain, "{end:?}");
        let expected = 0.8 * f64::hypot(direction[0], direction[1]);
        assert!((end.length - expected).abs() < 1e-12, "{end:?} {expected}");
        assert_eq!(end.uv[0], 0.0);
        assert!((end.uv[1] - 0.8 * direction[1]).abs() < 1e-12, "{end:?}");
    }
}

#[test]
fn a_rim_across_which_the_metric_is_continuous_is_passed() {
    // Two cones, ((1 − |v|/2) cos u, (1 − |v|/2) sin u, v).
    let mut m = Maker::new();
    let abs = m.f(Unary::Abs, m.v);
    let part = m.scale(-0.5, abs);
    let r = m.plus(1.0, part);
    let (u, v) = (m.u, m.v);
    let p = m.around(r, u, v);
    let s = m.done(p, [[-PI, PI], [-1.9, 1.9]]);
    let clairaut = |at: [f64; 2], d: [f64; 2]| (1.0 - 0.5 * at[1].abs()).powi(2) * d[0];
    for n in 0..60 {
        let n = f64::from(n);
        let (from, heading) = ([0.1 * n - 3.0, -0.2 - 0.012 * n], 0.9 + 0.02 * n);
        let direction = [
            heading.cos() / (1.0 + 0.5 * from[1]),
            heading.sin() / 1.25_f64.sqrt(),
        ];
        for tolerance in [1e-12, 1e-13, 1e-14] {
            let options = Options {
                tolerance,
                ..Options::default()
            };
            let end = trace(&s, from, direction, 1.5, &options).expect("a start");
            assert_eq!(end.status, Status::Complete, "{end:?}");
            let drift = clairaut(end.uv.0, end.direction.0) - clairaut(from, direction);
            assert!(drift.abs() < 1e-11, "{drift:e} {end:?}");
            assert!(end.error_estimate < 1e-9, "{end:?}");
        }
    }
}

#[test]
fn beside_a_corner_a_ray_leaves_through_the_side_that_it_meets_first() {
    for degree in 0..720 {
        let (sin, cos) = (0.5 * f64::from(degree)).to_radians().sin_cos();
        let end = go(&plane(), [0.0, 0.0], [cos, sin], 40.0);
        assert_eq!(end.status, Status::LeftDomain, "{end:?}");
        let expected = (4.0 / cos.abs()).min(3.0 / sin.abs());
        assert!((end.length - expected).abs() < 1e-12, "{end:?} {expected}");
    }
}

#[test]
fn a_ray_that_grazes_an_edge_leaves_through_it() {
    // The unit sphere up to the latitude 1, by longitude and latitude: sin v = sin i sin s.
    let mut m = Maker::new();
    let (sin, cos) = (m.f(Unary::Sin, m.v), m.f(Unary::Cos, m.v));
    let u = m.u;
    let p = m.around(cos, u, sin);
    let band = m.done(p, [[0.0, TAU], [-1.0, 1.0]]);
    for over in [1e-8, 1e-6, 1e-5, 2e-5, 1e-4, 1e-3] {
        for longitude in [0.1, 1.0, 2.5] {
            let (sin, cos) = (1.0_f64 + over).sin_cos();
            let end = go(&band, [longitude, 0.0], [cos, sin], 10.0);
            assert_eq!(end.status, Status::LeftDomain, "{over}: {end:?}");
            let expected = (1.0_f64.sin() / sin).asin();
            assert!(
                (end.length - expected).abs() < 1e-7,
                "{over}: {end:?} {expected}"
            );
        }
        let (sin, cos) = (1.0_f64 - over).sin_cos();
        let end = go(&band, [0.1, 0.0], [cos, sin], 10.0);
        assert_eq!(end.status, Status::Complete, "{over}: {end:?}");
    }
}

#[test]
fn the_limit_on_evaluations_bounds_every_method() {
    let s = torus(0.4);
    for method in [TraceMethod::Adaptive, TraceMethod::Rk4 { steps: 1_000_000 }] {
        for max_evaluations in [0, 1, 50, 1000, 20_000] {
            let options = Options {
                method,
                max_evaluations,
                ..Options::default()
            };
            let end = trace(&s, [0.3, 0.2], [1.0, 0.5], 1e5, &options).expect("a start");
            assert_eq!(end.status, Status::WorkLimit);
            // A start and an end are evaluated in any case.
            assert!(end.evaluations <= max_evaluations.max(10), "{end:?}");
            assert!(end.length < 1e5);
        }
    }
}
