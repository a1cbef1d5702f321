//! Metrics without an embedding: closed forms of hyperbolic and flat geometry, and the same as their embedded twins.

use crate::shapes::*;
use geodesic::frame::Frame;
use geodesic::measure::{self, MeasureError};
use geodesic::metric::{Metric, christoffel, gaussian_curvature};
use geodesic::surface::{Side, Surface};
use geodesic::trace::{Options, Status, Trace, TraceError, TraceMethod, trace};

fn go(surface: &dyn Surface, from: [f64; 2], direction: [f64; 2], length: f64) -> Trace {
    trace(surface, from, direction, length, &Options::default()).expect("a start")
}

#[test]
fn jets_have_the_metric_the_christoffel_symbols_and_the_curvature_of_the_embedded_surface() {
    for (a, b, shear) in [(1.0, 1.0, 0.0), (1.0, 0.3, 0.0), (2.0, 3.0, 1.7)] {
        let intrinsic = spheroid_metric(a, b, shear);
        let mut m = Maker::new();
        let skew = m.scale(shear, m.v);
        let longitude = m.add(m.u, skew);
        let (cos, sin) = (
            m.f(expr::ops::Unary::Cos, m.v),
            m.f(expr::ops::Unary::Sin, m.v),
        );
        let [x, y, z] = m.around(cos, longitude, sin);
        let p = [m.scale(a, x), m.scale(a, y), m.scale(b, z)];
        let embedded = m.done(p, [[0.0, TAU], [-PI / 2.0, PI / 2.0]]);
        for at in [[0.3, 0.2], [2.0, -1.1], [5.0, 1.5]] {
            let (i, e) = (intrinsic.jet(at.into()), embedded.jet(at.into()));
            let (mi, me) = (Metric::of(&i), Metric::of(&e));
            for (x, y) in [(mi.e, me.e), (mi.f, me.f), (mi.g, me.g), (mi.r, me.r)] {
                assert!(
                    (x - y).abs() < 1e-13 * (1.0 + y.abs()),
                    "{at:?}: {mi:?} {me:?}"
                );
            }
            let (ki, ke) = (gaussian_curvature(&i), gaussian_curvature(&e));
            assert!((ki - ke).abs() < 1e-10 * ke.abs(), "{at:?}: {ki} {ke}");
            for (x, y) in christoffel(&i)
                .iter()
                .flatten()
                .zip(christoffel(&e).iter().flatten())
            {
                assert!((x - y).abs() < 1e-11 * (1.0 + y.abs()), "{at:?}: {x} {y}");
            }
        }
        assert_eq!(intrinsic.sides(), embedded.sides());
    }
}

#[test]
fn lines_of_the_half_plane_are_half_circles() {
    let s = half_plane();
    assert_eq!(s.sides().v, [Side::Edge; 2]);
    for (angle, length) in [
        (0.0, 5.0),
        (0.7, 5.0),
        (-1.2, 5.0),
        (0.3, 12.0),
        (PI / 2.0, 12.0_f64),
    ] {
        let end = go(&s, [0.0, 1.0], [angle.cos(), angle.sin()], length);
        assert_eq!(end.status, Status::Complete);
        assert_eq!(end.position, None);
        // From i in the direction e^{iα}: tanh-parametrised half-circle.
        let (u, v) = line_from_i(angle, length);
        let distance = ((end.uv[0] - u).hypot(end.uv[1] - v)) / v;
        assert!(
            distance < 1e-13 * length.exp() + 1e-11,
            "{angle} {length}: {distance:e} {end:?}"
        );
        assert!(
            distance < 3.0 * end.error_estimate + 1e-14,
            "{angle} {length}: {distance:e} {end:?}"
        );
        // The Jacobi field of curvature −1 is sinh s.
        assert!(
            (end.jacobi[0] / length.sinh() - 1.0).abs() < 1e-9,
            "{end:?}"
        );
        assert!(
            (end.jacobi[1] / length.cosh() - 1.0).abs() < 1e-9,
            "{end:?}"
        );
    }
}

/// The point at the distance s from i on the line with the angle α there.
fn line_from_i(alpha: f64, s: f64) -> (f64, f64) {
    // x = sinh s cos α / d, y = 1/d with d = cosh s − sinh s sin α.
    let d = s.cosh() - s.sinh() * alpha.sin();
    if alpha.sin() > 0.99 {
        return (0.0, s.exp());
    }
    (s.sinh() * alpha.cos() / d, 1.0 / d)
}

#[test]
fn lines_through_the_middle_of_the_disc_are_straight() {
    let s = poincare_disc();
    for angle in [0.0, 0.4, 2.5_f64] {
        for length in [5.0, 15.0] {
            let end = go(&s, [0.0, 0.0], [angle.cos(), angle.sin()], length);
            assert_eq!(end.status, Status::Complete);
            let radius = end.uv[0].hypot(end.uv[1]);
            // 1 − tanh(L/2), with its digits.
            let rest = 2.0 / (length.exp() + 1.0);
            let error = ((1.0 - radius) / rest - 1.0).abs();
            assert!(
                error < if length < 10.0 { 1e-9 } else { 1e-6 },
                "{length}: {error:e}"
            );
        }
    }
}

#[test]
fn flat_rectangles_are_glued_to_tori_and_klein_bottles() {
    let flat = metric([[0.0, 2.0], [0.0, 1.0]], |m| {
        let (one, zero) = (m.c(1.0), m.c(0.0));
        [one, zero, one]
    });
    assert_eq!(flat.sides().u, [Side::Wrap; 2]);
    assert_eq!(flat.sides().v, [Side::Wrap; 2]);
    let end = go(&flat, [0.5, 0.5], [3.0, 4.0], 10.0);
    assert!(
        (end.uv[0] - 0.5).abs() < 1e-12 && (end.uv[1] - 0.5).abs() < 1e-12,
        "{end:?}"
    );
    // The metric 1, sin(2πv) cos(πu)/4, 1 changes the sign of F over u: even and odd under v → 1 − v.
    let bottle = metric([[0.0, 1.0], [0.0, 1.0]], |m| {
        let (one, angle) = (m.c(1.0), m.scale(TAU, m.v));
        let sin = m.f(expr::ops::Unary::Sin, angle);
        let f = m.scale(0.25, sin);
        let cos = m.f(expr::ops::Unary::Cos, angle);
        let g = m.scale(0.25, cos);
        let g = m.plus(1.0, g);
        let along = m.scale(TAU, m.u);
        let c = m.f(expr::ops::Unary::Cos, along);
        let f = m.mul(f, c);
        let _ = one;
        let e = m.c(1.0);
        [e, f, g]
    });
    assert_eq!(
        bottle.sides().u,
        [Side::Wrap; 2],
        "the plain gluing comes first"
    );
    let twisted = metric([[0.0, 1.0], [0.0, 1.0]], |m| {
        let angle = m.scale(TAU, m.v);
        let sin = m.f(expr::ops::Unary::Sin, angle);
        let f = m.scale(0.25, sin);
        let along = m.scale(PI, m.u);
        let c = m.f(expr::ops::Unary::Cos, along);
        let f = m.mul(f, c);
        let (e, g) = (m.c(1.0), m.c(1.0));
        [e, f, g]
    });
    // F(1,v) = −F(0,v) = F(0,1−v): plainly different, and turned over F is to be odd, which it is not.
    assert_eq!(twisted.sides().u, [Side::Edge; 2]);
    let flipped = metric([[0.0, 1.0], [0.0, 1.0]], |m| {
        let angle = m.scale(TAU, m.v);
        let sin = m.f(expr::ops::Unary::Sin, angle);
        let along = m.scale(PI, m.u);
        let c = m.f(expr::ops::Unary::Cos, along);
        // Even in the flip: sin 2πv changes its sign with v → 1 − v, cos πu with u → u + 1.
        let p = m.mul(sin, c);
        let p = m.scale(0.25, p);
        let e = m.plus(1.0, p);
        let (zero, one) = (m.c(0.0), m.c(1.0));
        [e, zero, one]
    });
    assert_eq!(flipped.sides().u, [Side::WrapFlip; 2]);
    assert_eq!(flipped.sides().v, [Side::Wrap; 2]);
    let there = go(&flipped, [0.5, 0.3], [1.0, 0.2], 3.2);
    assert!(there.flipped, "{there:?}");
    let back = go(&flipped, there.uv.0, (-there.direction).0, 3.2);
    assert!(
        (back.uv[0] - 0.5).hypot(back.uv[1] - 0.3) < 1e-10,
        "{back:?}"
    );
}

#[test]
fn every_geodesic_of_the_zoll_metric_closes_at_a_full_turn() {
    let s = zoll();
    assert_eq!(s.sides().v, [Side::Wrap; 2]);
    for end in 0..2 {
        let apex = s.apex(0, end).expect("a tip");
        assert!(!apex.smooth && apex.regular, "{apex:?}");
        let rate = if end == 0 { 1.0 / 1.5 } else { 2.0 };
        assert!((apex.rate - rate).abs() < 1e-6, "{apex:?}");
    }
    for (u, angle) in [
        (1.0, 0.3),
        (0.4, 1.4),
        (2.0, 1.0),
        (PI / 2.0, 1.55),
        (1.2, PI / 2.0 - 1e-3_f64),
    ] {
        let direction = [angle.sin() / (1.0 + 0.5 * u.cos()), angle.cos() / u.sin()];
        let options = Options {
            conjugates: true,
            ..Options::default()
        };
        let end = trace(&s, [u, 1.0], direction, TAU, &options).expect("a start");
        assert_eq!(end.status, Status::Complete);
        let gap = (end.uv[0] - u).abs().max((end.uv[1] - 1.0).abs() * u.sin());
        assert!(gap < 1e-11, "{u} {angle}: {gap:e} {end:?}");
        assert!(
            end.jacobi[0].abs() < 1e-10 && (end.jacobi[1] - 1.0).abs() < 1e-9,
            "{end:?}"
        );
    }
}

#[test]
fn the_metric_of_a_sphere_is_traced_through_its_poles_and_its_frames_stand_on_them() {
    let s = spheroid_metric(1.0, 1.0, 0.0);
    let twin = spheroid(1.0, 1.0);
    assert_eq!(s.sides().v, [Side::Pole; 2]);
    for miss in [0.0, 1e-12, 1e-8, 1e-4, 1e-2, 0.1] {
        let from = [0.7, 0.5];
        let direction = [miss, 1.0];
        let (a, b) = (
            go(&s, from, direction, 2.5),
            go(&twin, from, direction, 2.5),
        );
        assert_eq!(a.status, Status::Complete);
        let gap = (a.uv[0] - b.uv[0]).hypot(a.uv[1] - b.uv[1]);
        assert!(gap < 1e-9, "{miss:e}: {gap:e} {a:?} {b:?}");
    }
    for north in [1.0, -1.0] {
        let (a, b) = (
            Frame::new(&s, [0.3, north * PI / 2.0], 0.4, 1.0).expect("a frame"),
            Frame::new(&twin, [0.3, north * PI / 2.0], 0.4, 1.0).expect("a frame"),
        );
        for place in [[1.0, 0.0], [0.3, -0.8]] {
            let trace = |s: &dyn Surface, f: &Frame| {
                f.trace(s, place, 1.3, &Options::default())
                    .expect("a start")
            };
            let (a, b) = (trace(&s, &a), trace(&twin, &b));
            let gap = (a.uv[0] - b.uv[0]).hypot(a.uv[1] - b.uv[1]);
            assert!(gap < 1e-10, "{gap:e} {a:?} {b:?}");
        }
        let step = [0.9, 0.4];
        let (a, _) = a.advance(&s, step, &Options::default()).expect("a way");
        let (back, _) = a
            .advance(&s, step.map(|x| -x), &Options::default())
            .expect("a way");
        assert!((back.uv[1] - north * PI / 2.0).abs() < 1e-9, "{back:?}");
    }
}

#[test]
fn a_metric_is_degenerate_where_it_is_not_positive() {
    // du² + v dv²: positive for v > 0.
    let s = metric([[0.0, 1.0], [-1.0, 1.0]], |m| {
        let (one, zero) = (m.c(1.0), m.c(0.0));
        [one, zero, m.v]
    });
    let end = go(&s, [0.5, 0.5], [0.1, -1.0], 3.0);
    assert_eq!(end.status, Status::Degenerate, "{end:?}");
    assert!(end.evaluations < 5_000, "{end:?}");
    let start = trace(&s, [0.5, -0.5], [1.0, 0.3], 1.0, &Options::default());
    assert!(
        matches!(start, Err(TraceError::DegenerateStart { .. })),
        "{start:?}"
    );
    // Lorentzian everywhere.
    let s = metric([[0.0, 1.0], [0.0, 1.0]], |m| {
        let (one, zero, minus) = (m.c(1.0), m.c(0.0), m.c(-1.0));
        [one, zero, minus]
    });
    let start = trace(&s, [0.5, 0.5], [1.0, 0.0], 1.0, &Options::default());
    assert!(
        matches!(start, Err(TraceError::DegenerateStart { .. })),
        "{start:?}"
    );
}

#[test]
fn the_first_form_of_a_metric_is_its_own_or_none_where_it_is_not_semidefinite() {
    let at = [0.5, 0.5];
    for form in [
        [1.0, -2.0, 1.0],
        [1.0, 2.0, 1.0],
        [1.0, 0.0, -1.0],
        [-1.0, 0.0, 1.0],
    ] {
        let s = metric([[0.0, 1.0]; 2], |m| form.map(|x| m.c(x)));
        let found = measure::place(&s, at);
        assert_eq!(found, Err(MeasureError::Degenerate { at }), "{form:?}");
    }
    // (du − dv/2)²
    let form = [1.0, -0.5, 0.25];
    let s = metric([[0.0, 1.0]; 2], |m| form.map(|x| m.c(x)));
    let found = measure::place(&s, at).expect("a semidefinite form");
    assert_eq!((found.form, found.gaussian), (form, None));
}

#[test]
fn the_fixed_method_estimates_its_error_without_positions() {
    let s = half_plane();
    let options = Options {
        method: TraceMethod::Rk4 { steps: 64 },
        ..Options::default()
    };
    let end = trace(&s, [0.0, 1.0], [1.0, 0.5], 2.0, &options).expect("a start");
    let (u, v) = line_from_i(0.5_f64.atan2(1.0), 2.0);
    let error = (end.uv[0] - u).hypot(end.uv[1] - v) / v;
    assert!(
        error > 1e-9 && error < 3.0 * end.error_estimate && end.error_estimate < 10.0 * error,
        "{error:e} {end:?}"
    );
}

#[test]
fn jets_at_several_points_are_those_at_each() {
    use geodesic::surface::{JetBlock, LANES, Surface};
    let surface = crate::shapes::spheroid_metric(1.0, 0.7, 0.3);
    let [[a, b], [c, d]] = surface.domain();
    let share = |n: usize| (n as f64 + 0.7) / LANES as f64;
    let at: [[f64; LANES]; 2] = [
        std::array::from_fn(|n| a + (b - a) * share(n)),
        std::array::from_fn(|n| c + (d - c) * share(LANES - 1 - n) * 0.9),
    ];
    let mut block = JetBlock::default();
    surface.jets(&at, &mut block);
    for lane in 0..LANES {
        let jet = surface.jet([at[0][lane], at[1][lane]].into());
        let pairs = [
            (block.du, jet.du),
            (block.dv, jet.dv),
            (block.duu, jet.duu),
            (block.duv, jet.duv),
            (block.dvv, jet.dvv),
        ];
        for (several, one) in pairs {
            for k in 0..3 {
                let off = (several[k][lane] - one[k]).abs();
                assert!(off < 1e-7, "{off} in component {k} of {jet:?}");
            }
        }
    }
}

#[test]
fn the_curvature_of_a_sphere_of_any_size_is_found() {
    for size in [1e-150, 1e-90, 1e90, 1e150] {
        let surfaces: [&dyn Surface; 2] = [
            &spheroid_metric(size, size, 0.0),
            &sphere_in_units(1.0, size, 0.0),
        ];
        for s in surfaces {
            let found = gaussian_curvature(&s.jet([0.4, 0.3].into())) * size * size;
            assert!((found - 1.0).abs() < 1e-9, "{found} for {size}");
        }
    }
}
