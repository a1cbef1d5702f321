//! Geodesics that are known in closed form, or by a conserved quantity; bounds on error and on work.

use crate::shapes::*;
use geodesic::surface::{Side, Surface};
use geodesic::trace::{Options, Status, Trace, TraceError, TraceMethod, trace};

fn go(surface: &dyn Surface, from: [f64; 2], direction: [f64; 2], length: f64) -> Trace {
    trace(surface, from, direction, length, &Options::default()).expect("a start")
}

/// The position of an end in space.
fn place(end: &Trace) -> [f64; 3] {
    end.position.expect("an embedded surface")
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// The end of a great circle of the unit sphere.
fn great_circle(from: [f64; 2], direction: [f64; 2], length: f64) -> [f64; 3] {
    let ((su, cu), (sv, cv)) = (from[0].sin_cos(), from[1].sin_cos());
    let [a, b] = direction;
    let tangent = [
        -a * cv * su - b * sv * cu,
        a * cv * cu - b * sv * su,
        b * cv,
    ];
    let norm = (a * a * cv * cv + b * b).sqrt();
    let (sin, cos) = length.sin_cos();
    let p = [cv * cu, cv * su, sv];
    [0, 1, 2].map(|k| p[k] * cos + tangent[k] / norm * sin)
}

#[track_caller]
fn report(what: &str, error: f64, bound: f64, t: &Trace) {
    assert!(error <= bound, "{what}: {error:e} > {bound:e}: {t:?}");
    assert!(
        error <= 10.0 * t.error_estimate.max(1e-13),
        "{what}: the error {error:e} was estimated as {:e}",
        t.error_estimate
    );
}

#[test]
fn sixteen_turns_of_a_great_circle_end_where_they_should() {
    let s = spheroid(1.0, 1.0);
    let (from, direction) = ([0.3, 0.2], [1.0, 0.5]);
    let end = go(&s, from, direction, 100.0);
    assert_eq!(end.status, Status::Complete);
    let error = distance(place(&end), great_circle(from, direction, 100.0));
    report("S1", error, 1e-8, &end);
}

#[test]
fn poles_are_missed_by_any_distance_and_hit() {
    for sphere in [spheroid(1.0, 1.0), sphere_by_height()] {
        assert_eq!(sphere.sides().v, [Side::Pole; 2]);
        assert_eq!(sphere.sides().u, [Side::Wrap; 2]);
    }
    let s = spheroid(1.0, 1.0);
    for miss in [
        0.0, 1e-16, 1e-12, 1e-8, 1e-7, 1e-6, 1e-4, 1e-3, 1e-2, 1e-1_f64,
    ] {
        for back in [1.0, 0.3, 1e-3] {
            let from = [0.7, PI / 2.0 - back];
            let sine = miss.sin() / f64::sin(back);
            if sine > 0.9 {
                continue;
            }
            let direction = [sine / from[1].cos(), (1.0 - sine * sine).sqrt()];
            let end = go(&s, from, direction, 2.5);
            assert_eq!(end.status, Status::Complete, "{miss:e}");
            let error = distance(place(&end), great_circle(from, direction, 2.5));
            report(&format!("S2 {miss:e} from {back}"), error, 1e-9, &end);
            // Starting nearer, a ray also crosses from chart to chart.
            let most = if back == 1.0 { 200 } else { 250 };
            assert!(end.evaluations <= most, "{miss:e}: {}", end.evaluations);
        }
    }
}

#[test]
fn a_sphere_given_by_height_is_traced_through_its_poles() {
    let s = sphere_by_height();
    for miss in [0.0, 1e-8, 1e-4, 1e-2, 0.1_f64] {
        let from = [0.7, (PI / 2.0 - 1.0).sin()];
        let latitude = PI / 2.0 - 1.0;
        let sine = miss.sin() / 1.0_f64.sin();
        let west = sine / latitude.cos();
        let north = (1.0 - sine * sine).sqrt();
        // v = sin(latitude).
        let end = go(&s, from, [west, north * latitude.cos()], 2.5);
        assert_eq!(end.status, Status::Complete, "{miss:e}");
        let expected = great_circle([0.7, latitude], [west, north], 2.5);
        report(
            &format!("height {miss:e}"),
            distance(place(&end), expected),
            1e-9,
            &end,
        );
    }
}

#[test]
fn rays_pass_the_tip_of_a_cone_straight_when_it_is_unrolled() {
    for slope in [1.0, 0.3, 3.0, 0.0] {
        let s = cone(slope);
        let root = (1.0 + slope * slope).sqrt();
        for miss in [1e-1, 1e-3, 1e-6, 1e-8] {
            // In the unrolled plane: from distance 1 straight past the tip at this distance.
            let (radial, sine): (f64, f64) = (1.0, miss);
            let v = radial / root;
            let direction = [sine / v, -(1.0 - sine * sine).sqrt() / root];
            let end = go(&s, [1.0, v], direction, 2.5);
            assert_eq!(end.status, Status::Complete, "{miss:e}");
            // The unrolled end relative to the start's direction.
            let x = radial - 2.5 * (1.0 - sine * sine).sqrt();
            let y = 2.5 * sine;
            let u = 1.0 + y.atan2(x) * root;
            let r = x.hypot(y) / root;
            let expected = [r * u.cos(), r * u.sin(), slope * r];
            report(
                &format!("C1 {slope} {miss:e}"),
                distance(place(&end), expected),
                1e-11,
                &end,
            );
        }
        let end = go(&s, [1.0, 2.0], [0.0, -1.0], 10.0);
        if slope == 0.0 {
            assert_eq!(end.status, Status::Complete);
            assert!(distance(place(&end), [-8.0 + 2.0 * 0.0, 0.0, 0.0]) < 20.0);
            let expected = [-8.0 * 1.0_f64.cos(), -8.0 * 1.0_f64.sin(), 0.0];
            report(
                "C2 through the origin",
                distance(place(&end), expected),
                1e-11,
                &end,
            );
        } else {
            assert_eq!(end.status, Status::ConePoint, "slope {slope}: {end:?}");
            assert!((end.length - 2.0 * root).abs() < 1e-10, "{end:?}");
        }
    }
}

fn clairaut(r: f64, uv: [f64; 2], [a, b]: [f64; 2]) -> f64 {
    let radius = 1.0 + r * uv[1].cos();
    radius * radius * a / (radius * a).hypot(r * b)
}

#[test]
fn clairauts_relation_holds_on_tori() {
    for (what, r, from, direction, length, bound) in [
        ("T1", 0.4, [0.0, 0.0], [1.0, 1.0], 50.0, 1e-10),
        ("T1b", 0.4, [1.0, 2.0], [0.2, 1.0], 50.0, 1e-10),
        ("T3", 0.4, [1.0, PI + 1e-6], [1.0, 0.0], 10.0, 1e-11),
        ("T4", 0.02, [0.0, 0.0], [0.1, 1.0], 9.0, 1e-10),
        ("T5", 0.999, [0.0, 0.0], [0.3, 1.0], 20.0, 1e-10),
    ] {
        let s = torus(r);
        assert_eq!(
            (s.sides().u, s.sides().v),
            ([Side::Wrap; 2], [Side::Wrap; 2])
        );
        let end = go(&s, from, direction, length);
        assert_eq!(end.status, Status::Complete, "{what}: {end:?}");
        let drift = (clairaut(r, end.uv.0, end.direction.0) - clairaut(r, from, direction)).abs();
        report(what, drift, bound, &end);
    }
    // Exactly along the inner equator, where all errors grow like e^{2.04 L}.
    let end = go(&torus(0.4), [0.0, PI], [1.0, 0.0], 10.0);
    let bound = 1e-14 * (2.04_f64 * 10.0).exp();
    assert!((end.uv[1] - PI).abs() < bound, "{end:?}");
}

#[test]
fn a_line_up_the_pseudosphere_returns() {
    let s = pseudosphere();
    let constant = |uv: [f64; 2], d: [f64; 2]| d[0] / uv[1].cosh().powi(2);
    let (from, direction) = ([1.0, 1.0_f64], [1.0, 0.3]);
    let end = go(&s, from, direction, 0.5);
    let speed = (1.0 / from[1].cosh()).hypot(0.3 * from[1].tanh());
    let before = constant(from, direction) / speed;
    let drift = (constant(end.uv.0, end.direction.0) / before - 1.0).abs();
    report("H3", drift, 1e-10, &end);
}

#[test]
fn ellipsoids_keep_joachimsthals_constant() {
    let axes = [1.0, 2.0, 3.0];
    let s = triaxial(1.0, 2.0, 3.0);
    let constant = |uv: [f64; 2], d: [f64; 2]| {
        let jet = s.jet(uv.into());
        let velocity = [0, 1, 2].map(|k| jet.du[k] * d[0] + jet.dv[k] * d[1]);
        let sum = |x: [f64; 3], power: i32| -> f64 {
            (0..3)
                .map(|k| x[k] * x[k] / f64::powi(axes[k], power))
                .sum()
        };
        let square: f64 = velocity.iter().map(|x| x * x).sum();
        sum(jet.position, 4) * sum(velocity, 2) / square
    };
    for (from, direction) in [
        ([0.3, 0.2], [1.0, 0.5]),
        ([0.3, 0.2], [0.05, 1.0]),
        ([0.0, 0.5], [0.0, 1.0]),
    ] {
        let end = go(&s, from, direction, 100.0);
        assert_eq!(end.status, Status::Complete, "{end:?}");
        let drift = (constant(end.uv.0, end.direction.0) / constant(from, direction) - 1.0).abs();
        report("E2", drift, 1e-9, &end);
    }
    for (b, length, bound) in [(0.01, 6.0, 1e-10), (100.0, 300.0, 1e-11)] {
        let s = spheroid(1.0, b);
        let clairaut = |uv: [f64; 2], d: [f64; 2]| uv[1].cos().powi(2) * d[0];
        let from = [0.3, 0.2];
        let start = go(&s, from, [0.3, 1.0], 0.0);
        let end = go(&s, from, [0.3, 1.0], length);
        assert_eq!(end.status, Status::Complete, "{end:?}");
        let drift = (clairaut(end.uv.0, end.direction.0) - clairaut(from, start.direction.0)).abs();
        report(&format!("E1 {b}"), drift, bound, &end);
    }
}

#[test]
fn tracing_back_returns() {
    let check = |what: &str, s: &dyn Surface, from: [f64; 2], direction: [f64; 2], length: f64| {
        let options = Options::default();
        let there = trace(s, from, direction, length, &options).expect("a start");
        assert_eq!(there.status, Status::Complete, "{what}");
        let turned = there.direction.map(|x| -x);
        let back = trace(s, there.uv, turned, length, &options).expect("a start");
        let error = distance(place(&back), s.jet(from.into()).position);
        report(what, error, 1e-9, &back);
        assert!(there.speed_drift.abs() < 1e-9, "{there:?}");
    };
    check("sphere", &spheroid(1.0, 1.0), [1.0, 0.3], [1.0, 0.4], 5.0);
    check("cone", &cone(1.0), [1.0, 5.0], [0.3, -1.0], 12.0);
    check("torus", &torus(0.4), [1.0, 0.3], [1.0, 0.4], 10.0);
    check("pseudosphere", &pseudosphere(), [3.0, 1.0], [1.0, 0.4], 0.5);
    check("Möbius", &moebius(0.0), [0.5, 0.1], [-1.0, 0.1], 1.0);
}

#[test]
fn sides_in_which_a_surface_meets_itself_join_where_it_continues() {
    // Both sides are one segment, which is run through to and fro.
    let (seam, plain) = (cross_cap(0.0), cross_cap(-0.5 * PI));
    assert_eq!(seam.sides().u, [Side::WrapFlip; 2]);
    for (from, direction) in [([0.7, 0.6], [-1.0, 0.0]), ([0.4, -0.3], [-1.0, 0.2])] {
        let through = go(&seam, from, direction, 1.6);
        let beside = go(&plain, from, direction, 1.6);
        assert_eq!(through.status, Status::Complete);
        let error = distance(place(&through), place(&beside));
        assert!(error < 1e-9, "{error:e}");
    }
}

#[test]
fn a_moebius_strip_is_passed_through_its_seam_turned_over() {
    let (seam, plain) = (moebius(0.0), moebius(-PI));
    assert_eq!(seam.sides().u, [Side::WrapFlip; 2]);
    assert_eq!(seam.sides().v, [Side::Edge; 2]);
    for (from, direction) in [([0.5, 0.1], [-1.0, 0.1]), ([0.3, -0.2], [-1.0, -0.3])] {
        let through = go(&seam, from, direction, 1.0);
        let beside = go(&plain, from, direction, 1.0);
        assert_eq!(through.status, Status::Complete);
        assert!(through.flipped && !beside.flipped);
        assert!(distance(place(&through), place(&beside)) < 1e-11);
        assert!((through.uv[0] - beside.uv[0] - TAU).abs() < 1e-10);
        assert!((through.uv[1] + beside.uv[1]).abs() < 1e-10);
        assert!((through.direction[1] + beside.direction[1]).abs() < 1e-9);
    }
}

#[test]
fn true_edges_end_a_ray_where_it_crosses_them() {
    let end = go(&cylinder(), [1.0, 95.0], [0.3, 1.0], 100.0);
    assert_eq!(end.status, Status::LeftDomain);
    let speed = 0.6_f64.hypot(1.0);
    assert!((end.length - 5.0 * speed).abs() < 1e-11, "{end:?}");
    assert_eq!(end.uv[1], 100.0);
    assert!((end.uv[0] - 2.5).abs() < 1e-11, "{end:?}");
}

#[test]
fn a_cuspidal_edge_stops_a_ray_as_degenerate_without_wasting_work() {
    let s = cuspidal();
    let end = go(&s, [0.5, 0.0], [-1.0, 0.1], 3.0);
    assert_eq!(end.status, Status::Degenerate, "{end:?}");
    assert!(end.evaluations <= 5_000, "{end:?}");
    // The arc length of (u², u³) from 0.5 to 0, at the slope of the line in the unrolled plane.
    let arc = (f64::powf(4.0 + 9.0 * 0.25, 1.5) - 8.0) / 27.0;
    let across = 0.1 / (0.5_f64 * (4.0_f64 + 9.0 * 0.25).sqrt());
    let expected = arc * (1.0 + across * across).sqrt();
    assert!((end.length - expected).abs() < 1e-6, "{end:?} {expected}");
}

#[test]
fn a_surface_of_any_size_is_traced_alike() {
    let unit = go(&spheroid(1.0, 1.0), [0.3, 0.2], [1.0, 1.5], 2.0);
    for size in [1e-6, 1e6] {
        let s = spheroid(size, size);
        let end = go(&s, [0.3, 0.2], [1.0, 1.5], 2.0 * size);
        assert!(
            (0..2).all(|k| (end.uv[k] - unit.uv[k]).abs() < 1e-12),
            "{end:?}"
        );
        assert_eq!(end.steps, unit.steps);
    }
}

#[test]
fn a_bad_start_is_refused_and_says_why() {
    let s = cylinder();
    let attempt = |from, direction, length| trace(&s, from, direction, length, &Options::default());
    let nan = f64::NAN;
    assert_eq!(
        attempt([nan, 0.0], [1.0, 0.0], 1.0),
        Err(TraceError::StartNotFinite)
    );
    assert_eq!(
        attempt([0.0, 0.0], [nan, 0.0], 1.0),
        Err(TraceError::DirectionNotFinite)
    );
    assert_eq!(
        attempt([0.0, 0.0], [0.0, 0.0], 1.0),
        Err(TraceError::ZeroDirection)
    );
    assert!(matches!(
        attempt([0.0, 0.0], [1.0, 0.0], nan),
        Err(TraceError::BadLength { .. })
    ));
    assert!(matches!(
        attempt([0.0, 0.0], [1.0, 0.0], -1.0),
        Err(TraceError::BadLength { .. })
    ));
    assert!(matches!(
        attempt([0.0, 101.0], [1.0, 0.0], 1.0),
        Err(TraceError::OutsideDomain { .. })
    ));
    assert!(matches!(
        trace(
            &cuspidal(),
            [0.0, 0.0],
            [0.0, 1.0],
            1.0,
            &Options::default()
        ),
        Err(TraceError::DegenerateStart { .. })
    ));
    // Beyond a side that wraps is inside.
    let end = attempt([7.0, 0.0], [0.0, 1.0], 1.0).expect("a start");
    assert!((end.uv[0] - (7.0 - TAU)).abs() < 1e-12);
    // No length: it stays, with its direction at unit speed.
    let end = attempt([1.0, 2.0], [0.0, -5.0], 0.0).expect("a start");
    assert_eq!(
        (end.uv, end.direction, end.status),
        ([1.0, 2.0].into(), [0.0, -1.0].into(), Status::Complete)
    );
}

#[test]
fn the_limit_on_evaluations_holds() {
    let options = Options {
        max_evaluations: 100,
        ..Options::default()
    };
    let end = trace(&spheroid(1.0, 1.0), [0.3, 0.2], [1.0, 0.5], 100.0, &options).expect("a start");
    assert_eq!(end.status, Status::WorkLimit);
    assert!(
        end.evaluations <= 100 && end.length > 0.0 && end.length < 100.0,
        "{end:?}"
    );
}

#[test]
fn the_method_of_the_thesis_converges_with_order_four() {
    let s = torus(0.4);
    let run = |steps| {
        let options = Options {
            method: TraceMethod::Rk4 { steps },
            ..Options::default()
        };
        trace(&s, [0.3, 0.2], [1.0, 0.5], 5.0, &options).expect("a start")
    };
    let exact = go(&s, [0.3, 0.2], [1.0, 0.5], 5.0);
    let errors = [100, 200].map(|steps| distance(place(&run(steps)), place(&exact)));
    assert!(
        (12.0..20.0).contains(&(errors[0] / errors[1])),
        "{errors:?}"
    );
    let estimate = run(200).error_estimate;
    assert!(
        (0.5..2.0).contains(&(estimate / errors[1])),
        "{estimate:e} {errors:?}"
    );
}

#[test]
fn a_single_step_of_the_method_of_the_thesis_has_an_estimate() {
    let sphere = spheroid(1.0, 1.0);
    let exact = go(&sphere, [1.0, 1.0], [1.0, 1.0], 1.0);
    for steps in [1, 2] {
        let options = Options {
            method: TraceMethod::Rk4 { steps },
            ..Options::default()
        };
        let end = trace(&sphere, [1.0, 1.0], [1.0, 1.0], 1.0, &options).expect("a start");
        let error = distance(place(&end), place(&exact));
        assert!(
            error > 1e-3 && error < 3.0 * end.error_estimate,
            "{error} {end:?}"
        );
    }
}

/// Steps and evaluations as exact numbers: a change here is a change of what tracing costs.
#[test]
fn the_work_is_what_it_was() {
    let count = |s: &dyn Surface, from, direction, length| {
        let end = trace(s, from, direction, length, &Options::default()).expect("a start");
        (end.steps, end.rejected, end.evaluations)
    };
    let sphere = spheroid(1.0, 1.0);
    let work = [
        ("sphere", count(&sphere, [0.3, 0.2], [1.0, 0.5], 2.0)),
        (
            "through the pole",
            count(&sphere, [0.5, 1.0], [0.0, 1.0], 2.0),
        ),
        ("cylinder", count(&cylinder(), [0.0, 0.0], [1.0, 1.0], 10.0)),
        ("torus", count(&torus(0.4), [0.0, 0.0], [1.0, 1.0], 10.0)),
        ("cone", count(&cone(1.0), [1.0, 5.0], [1.0, -2.0], 8.0)),
    ];
    let expected = [
        ("sphere", (13, 0, 160)),
        ("through the pole", (3, 0, 40)),
        ("cylinder", (2, 0, 27)),
        ("torus", (59, 0, 711)),
        ("cone", (2, 0, 38)),
    ];
    assert_eq!(work, expected);
}

#[test]
fn a_ray_stops_as_degenerate_where_the_chart_of_a_dome_ends() {
    let end = go(&dome(), [0.0, 0.0], [1.0, 0.5], 3.0);
    assert_eq!(end.status, Status::Degenerate, "{end:?}");
    // Not farther than the rim, a quarter of a great circle off, and right up to where it stopped.
    assert!(
        end.length < PI / 2.0 && end.length > PI / 2.0 - 1e-3,
        "{end:?}"
    );
    let error = (end.uv[0].hypot(end.uv[1]).asin() - end.length).abs();
    report("rim", error, 1e-7, &end);
}

#[test]
fn a_ray_that_ends_at_a_pole_can_be_traced_back() {
    let s = spheroid(1.0, 1.0);
    let there = go(&s, [1.0, 0.0], [0.0, 1.0], PI / 2.0);
    assert_eq!(there.status, Status::Complete);
    let back = go(&s, there.uv.0, (-there.direction).0, PI / 2.0);
    assert!(
        distance(place(&back), s.jet([1.0, 0.0].into()).position) < 1e-12,
        "{there:?} {back:?}"
    );
}
