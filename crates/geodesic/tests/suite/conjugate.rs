//! Jacobi fields and conjugate points, and the Earth's lines against an independent program.

use std::f64::consts::PI;

use crate::stiff_list::shapes::*;
use crate::stiff_list::spheroids::{Starts, lines};
use geodesic::surface::Surface;
use geodesic::trace::{Options, Status, trace};

/// With conjugate points looked for.
fn noting() -> Options {
    Options {
        conjugates: true,
        ..Options::default()
    }
}

#[test]
fn conjugate_points_of_spheres_lie_half_a_turn_apart() {
    for radius in [1.0, 1e-3, 1e4] {
        let s = spheroid(radius, radius);
        let end = trace(&s, [0.3, 0.2], [1.0, 0.5], 10.0 * radius, &noting()).expect("a start");
        assert_eq!(end.conjugates.len(), 3, "{end:?}");
        for (n, at) in (1..).zip(&end.conjugates) {
            let error = (at / radius - f64::from(n) * PI).abs();
            assert!(error < 1e-9, "{n}: {error:e}");
        }
        let [m, rate] = end.jacobi;
        assert!((m / radius - 10.0_f64.sin()).abs() < 1e-8, "{end:?}");
        assert!((rate - 10.0_f64.cos()).abs() < 1e-8, "{end:?}");
    }
}

#[test]
fn conjugate_points_are_passed_through_poles_too() {
    let s = spheroid(1.0, 1.0);
    for miss in [0.0, 1e-9, 1e-3, 0.1] {
        let end = trace(&s, [0.3, 1.0], [miss, 1.0], 7.0, &noting()).expect("a start");
        assert_eq!(end.conjugates.len(), 2, "{end:?}");
        for (n, at) in (1..).zip(&end.conjugates) {
            assert!((at - f64::from(n) * PI).abs() < 1e-8, "{miss:e}: {at}");
        }
    }
}

#[test]
fn there_are_none_where_the_curvature_is_not_positive_nor_where_none_are_asked_for() {
    for s in [&catenoid() as &dyn Surface, &cylinder(), &half_plane()] {
        let end = trace(s, [1.0, 1.0], [1.0, 0.3], 5.0, &noting()).expect("a start");
        assert_eq!(end.status, Status::Complete);
        assert!(end.conjugates.is_empty() && end.jacobi[0] > 0.0, "{end:?}");
    }
    let s = spheroid(1.0, 1.0);
    let end = trace(&s, [0.3, 0.2], [1.0, 0.5], 10.0, &Options::default()).expect("a start");
    assert!(end.conjugates.is_empty());
}

#[test]
fn the_outer_equator_of_a_torus_has_its_first_at_the_known_place() {
    for r in [0.01, 0.1, 0.4, 0.9, 0.999] {
        let expected = PI * f64::sqrt(r * (1.0 + r));
        for stretch in [1.5, 2.5] {
            let end = trace(
                &torus(r),
                [1.0, 0.0],
                [1.0, 0.0],
                stretch * expected,
                &noting(),
            )
            .expect("a start");
            assert_eq!(end.conjugates.len(), stretch as usize, "{end:?}");
            let error = (end.conjugates[0] - expected).abs();
            assert!(error < 1e-9 * expected, "{r}: {error:e}");
        }
    }
}

#[test]
fn a_change_of_direction_moves_the_end_by_m() {
    let s = triaxial(1.0, 1.3, 0.7);
    let turn = |angle: f64| {
        geodesic::frame::trace_heading(
            &s,
            [0.4, 0.3],
            angle,
            6.0,
            &Options {
                tolerance: 1e-13,
                ..noting()
            },
        )
        .expect("a start")
    };
    let (end, other) = (turn(0.7), turn(0.7 + 1e-6));
    let (a, b) = (s.jet(end.uv).position, s.jet(other.uv).position);
    let moved = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    assert!(
        (moved / 1e-6 - end.jacobi[0].abs()).abs() < 1e-5,
        "{moved:e} {end:?}"
    );
}

#[test]
fn thousands_of_lines_of_the_earth_are_the_independent_programs() {
    for (starts, count, bound) in [(Starts::OffPoles, 2000, 1e-6), (Starts::Poles, 1000, 1e-3)] {
        let lines = lines(starts, count, 12, &Options::default());
        let worst = lines
            .iter()
            .fold(0.0_f64, |worst, line| worst.max(line.end));
        let jacobi = lines
            .iter()
            .fold(0.0_f64, |worst, line| worst.max(line.jacobi));
        println!("{starts:?}: endpoint {worst:e} m, m {jacobi:e} m");
        assert!(
            lines.iter().all(|line| line.end <= bound),
            "{starts:?}: {worst:e}"
        );
        assert!(
            lines.iter().all(|line| line.jacobi <= bound),
            "{starts:?}: {jacobi:e}"
        );
        assert!(
            lines
                .iter()
                .all(|line| line.end <= 3.0 * line.estimate + 1e-8),
            "{starts:?}"
        );
    }
}
