//! Geodesics and their Jacobi fields across creases that are curved in the surface, and across kinks of metrics.

use crate::shapes::{Maker, PI, creased, off_line, off_point};
use expr::NodeId;
use expr::ops::{Binary, Unary};
use geodesic::frame::trace_heading;
use geodesic::intrinsic::MetricSurface;
use geodesic::measure;
use geodesic::metric::Metric;
use geodesic::surface::{ParametricSurface, Surface};
use geodesic::trace::{Options, Status, Trace, trace};

fn noting() -> Options {
    Options {
        conjugates: true,
        ..Options::default()
    }
}

/// The polynomial a + b u² + c v² + d u v.
fn quadratic(m: &mut Maker, [a, b, c, d]: [f64; 4]) -> NodeId {
    let (u, v) = (m.u, m.v);
    let (uu, vv, uv) = (m.mul(u, u), m.mul(v, v), m.mul(u, v));
    let (uu, vv, uv) = (m.scale(b, uu), m.scale(c, vv), m.scale(d, uv));
    let sum = m.add(uu, vv);
    let sum = m.add(sum, uv);
    m.plus(a, sum)
}

/// max(0, w) + tilt u, with w a quadratic polynomial.
fn hat(w: [f64; 4], tilt: f64) -> ParametricSurface {
    let mut m = Maker::new();
    let w = quadratic(&mut m, w);
    let zero = m.c(0.0);
    let top = m.g.binary(Binary::Max, zero, w);
    let (u, v) = (m.u, m.v);
    let slope = m.scale(tilt, u);
    let z = m.add(top, slope);
    m.done([u, v, z], [[-3.0, 3.0]; 2])
}

/// A paraboloid on a plane: max(0, 1 − u² − v²).
fn round_hat() -> ParametricSurface {
    hat([1.0, -1.0, -1.0, 0.0], 0.0)
}

/// The metric of a [`hat`], as if it had no embedding: its coefficients jump.
fn hat_metric([a, b, c, d]: [f64; 4], tilt: f64) -> MetricSurface {
    let mut m = Maker::new();
    let w = quadratic(&mut m, [a, b, c, d]);
    let sign = m.f(Unary::Sign, w);
    let sign = m.plus(1.0, sign);
    let inside = m.scale(0.5, sign);
    let (u, v) = (m.u, m.v);
    let mut gradient = |x: NodeId, y: NodeId, k: f64, tilt: f64| {
        let (own, mixed) = (m.scale(2.0 * k, x), m.scale(d, y));
        let sum = m.add(own, mixed);
        let sum = m.mul(inside, sum);
        m.plus(tilt, sum)
    };
    let (x, y) = (gradient(u, v, b, tilt), gradient(v, u, c, 0.0));
    let (xx, yy) = (m.mul(x, x), m.mul(y, y));
    let form = [m.plus(1.0, xx), m.mul(x, y), m.plus(1.0, yy)];
    MetricSurface::new(&m.g, form, [[-3.0, 3.0]; 2], &[]).expect("small expressions")
}

/// min(0, 5 − 5r): a cone with a flat lid.
fn lid() -> ParametricSurface {
    let mut m = Maker::new();
    let (u, v) = (m.u, m.v);
    let square = quadratic(&mut m, [0.0, 1.0, 1.0, 0.0]);
    let r = m.f(Unary::Sqrt, square);
    let side = m.scale(-5.0, r);
    let side = m.plus(5.0, side);
    let zero = m.c(0.0);
    let z = m.g.binary(Binary::Min, zero, side);
    m.done([u, v, z], [[-4.0, 4.0]; 2])
}

/// du² + (1 + |u|)² dv²: two planes in polar coordinates, without their unit discs, glued along the circles.
fn two_planes() -> MetricSurface {
    let mut m = Maker::new();
    let u = m.u;
    let abs = m.f(Unary::Abs, u);
    let radius = m.plus(1.0, abs);
    let (one, zero, g) = (m.c(1.0), m.c(0.0), m.mul(radius, radius));
    MetricSurface::new(&m.g, [one, zero, g], [[-3.0, 3.0]; 2], &[]).expect("small expressions")
}

/// A flat lid of radius 1 on a cylinder, by its arc length: both have the same metric at the rim.
fn can() -> ParametricSurface {
    let mut m = Maker::new();
    let (u, v, one) = (m.u, m.v, m.c(1.0));
    let rest = m.scale(-1.0, v);
    let rest = m.plus(2.0, rest);
    let (radius, height) = (
        m.g.binary(Binary::Min, one, rest),
        m.g.binary(Binary::Min, v, one),
    );
    let p = m.around(radius, u, height);
    m.done(p, [[0.0, 2.0 * PI], [0.0, 2.0]])
}

/// Four flat faces: −|u| − |v|.
fn pyramid() -> ParametricSurface {
    let mut m = Maker::new();
    let (u, v) = (m.u, m.v);
    let (a, b) = (m.f(Unary::Abs, u), m.f(Unary::Abs, v));
    let sum = m.add(a, b);
    let z = m.scale(-1.0, sum);
    m.done([u, v, z], [[-2.0, 2.0]; 2])
}

/// The end of the geodesic from (0, 0) in this direction over a cone of this radius and slope about (0.5, 0.13)
/// that it meets: the cone unrolled.
fn behind_bump([radius, slope]: [f64; 2], angle: f64, length: f64) -> [f64; 2] {
    let direction = [angle.cos(), angle.sin()];
    let [x, y] = [-0.5, -0.13];
    let along = -(x * direction[0] + y * direction[1]);
    let off = x * direction[1] - y * direction[0];
    // At the rim the angle to the circle is the same on both sides; the unrolled cone has a larger radius.
    let sine = off / radius;
    let before = along - (radius * radius - off * off).max(0.0).sqrt();
    let stretch = slope.hypot(1.0);
    let inside = radius * stretch;
    let cosine = (1.0 - sine * sine).max(0.0).sqrt();
    let chord = 2.0 * inside * cosine;
    // Half the angle of the chord, unrolled, and about the axis.
    let turn = 2.0 * cosine.atan2(sine.abs()) * stretch;
    let turn = turn.copysign(sine);
    let enters = [x + before * direction[0], y + before * direction[1]];
    let rest = length - before - chord;
    // The frame of the radius is turned about the axis, and the direction is mirrored in it.
    let start = enters[1].atan2(enters[0]);
    let leaves = start + turn;
    let at = [radius * leaves.cos(), radius * leaves.sin()];
    let inward = angle - start;
    let outward = leaves + (PI - inward);
    [
        0.5 + at[0] + rest * outward.cos(),
        0.13 + at[1] + rest * outward.sin(),
    ]
}

/// Returns m and the distance by which neighbouring rays are apart, per angle.
#[track_caller]
fn compare(surface: &dyn Surface, at: [f64; 2], degrees: f64, length: f64) -> [f64; 2] {
    const TURN: f64 = 1e-5;
    let options = Options {
        tolerance: 1e-12,
        ..noting()
    };
    let towards =
        |angle: f64| trace_heading(surface, at, angle, length, &options).expect("a start");
    let angle = degrees.to_radians();
    let ray = towards(angle);
    let [right, left] = [-TURN, TURN].map(|turn| towards(angle + turn));
    assert!(
        [&ray, &left, &right]
            .iter()
            .all(|it| it.status == Status::Complete),
        "{ray:?}"
    );
    let metric = Metric::of(&surface.jet(ray.uv));
    let across = metric.turn_left(ray.direction);
    let apart = left.uv - right.uv;
    [ray.jacobi[0], metric.inner(apart, across) / (2.0 * TURN)]
}

#[track_caller]
fn is(found: f64, expected: f64, tolerance: f64) {
    let off = (found / expected - 1.0).abs();
    assert!(off <= tolerance, "{found} instead of {expected}: {off:e}");
}

/// The length of a meridian of the paraboloid to its rim.
fn to_rim() -> f64 {
    let root = 5.0_f64.sqrt();
    (2.0 * root + 2.0_f64.asinh()) / 4.0
}

#[test]
fn the_field_grows_behind_a_rim_as_the_circles_do() {
    let length = 2.0;
    let radius = 1.0 + length - to_rim();
    for surface in [
        &round_hat() as &dyn Surface,
        &hat_metric([1.0, -1.0, -1.0, 0.0], 0.0),
    ] {
        for direction in [[1.0, 0.0], [0.3, -0.8]] {
            let end = trace(surface, [0.0, 0.0], direction, length, &noting()).expect("a start");
            is(end.jacobi[0], radius, 1e-9);
            is(end.jacobi[1], 1.0, 1e-9);
            assert_eq!((end.creases, end.status), (1, Status::Complete));
        }
    }
}

#[test]
fn the_lid_of_a_cone_focuses() {
    let lid = lid();
    let slant = 26.0_f64.sqrt();
    let start = [-1.0 - 4.0 / slant, 0.0];
    // Each curvature of the rim is that in its plane, the cone unrolled.
    let rate = 1.0 - 4.0 * (1.0 - 1.0 / slant);
    let end = trace(&lid, start, [1.0, 0.0], 5.9, &noting()).expect("a start");
    is(end.jacobi[0], 4.0 + 1.9 * rate, 1e-9);
    is(end.jacobi[1], rate, 1e-9);
    assert_eq!(end.conjugates.len(), 1, "{end:?}");
    is(end.conjugates[0], 4.0 - 4.0 / rate, 1e-9);
    // A circle about the centre of the lid.
    let circle = measure::circle(&lid, [0.0, 0.0], 2.0)
        .expect("a place")
        .expect("a circle");
    is(circle.circumference, 2.0 * PI * (1.0 + 1.0 / slant), 1e-8);
}

/// The octahedron |x| + |y| + |z| = 1 by longitude and latitude.
fn octahedron() -> ParametricSurface {
    let mut m = Maker::new();
    let (cos, sin) = (m.f(Unary::Cos, m.v), m.f(Unary::Sin, m.v));
    let u = m.u;
    let p = m.around(cos, u, sin);
    let sizes = p.map(|x| m.f(Unary::Abs, x));
    let sum = m.add(sizes[0], sizes[1]);
    let sum = m.add(sum, sizes[2]);
    let p = p.map(|x| m.g.div(x, sum));
    m.done(p, [[0.0, 2.0 * PI], [-0.5 * PI, 0.5 * PI]])
}

#[test]
fn nothing_is_said_of_overlaps_behind_a_corner() {
    // Behind the corner (1, 0, 0), whose angle is 4π/3, rays to its left and to its right meet.
    let circle = measure::circle(&octahedron(), [0.7, 0.5], 1.0).expect("a place");
    assert_ne!(circle.expect("a circle").overlaps, Some(false));
    // The circle about the centre of the lid of a cone has no corner.
    let circle = measure::circle(&lid(), [0.0, 0.0], 2.0).expect("a place");
    assert_eq!(circle.expect("a circle").overlaps, Some(false));
}

#[test]
fn circles_behind_a_rim_have_their_lengths() {
    let outer = 1.0 + 2.0 - to_rim();
    let circle = measure::circle(&round_hat(), [0.0, 0.0], 2.0)
        .expect("a place")
        .expect("a circle");
    is(circle.circumference, 2.0 * PI * outer, 1e-8);
    let paraboloid = PI / 6.0 * (5.0 * 5.0_f64.sqrt() - 1.0);
    is(circle.area, paraboloid + PI * (outer * outer - 1.0), 1e-8);
}

#[test]
fn a_kink_of_a_metric_turns_neighbours_even_where_the_ray_crosses_it_at_a_right_angle() {
    let planes = two_planes();
    let end = trace(&planes, [-1.0, 0.3], [1.0, 0.0], 2.0, &noting()).expect("a start");
    is(end.jacobi[0], 4.0, 1e-9);
    is(end.jacobi[1], 3.0, 1e-9);
    assert_eq!(end.creases, 1);
    // The rim of a can, from the cylinder's side and from the lid's.
    let can = can();
    let end = trace(&can, [1.0, 0.2], [0.0, 1.0], 1.5, &noting()).expect("a start");
    is(end.jacobi[1], 1.0 - 0.8, 1e-9);
    is(end.jacobi[0], 0.8 + 0.7 * 0.2, 1e-9);
    let end = trace(&can, [1.0, 1.9], [0.0, -1.0], 1.5, &noting()).expect("a start");
    is(end.jacobi[1], 1.0 - 0.9, 1e-9);
}

#[test]
fn fields_behind_curved_creases_are_the_differences_of_neighbours() {
    let oblique = [1.0, -1.0, -2.0, 0.3];
    let cases: [(&dyn Surface, [f64; 2], f64, f64); 8] = [
        (&round_hat(), [2.0, 0.3], 170.0, 3.0),
        (&lid(), [-1.784, 0.0], 8.0, 5.5),
        (&two_planes(), [1.0, 0.3], 170.0, 2.0),
        (&can(), [1.0, 0.2], 70.0, 1.5),
        (&hat(oblique, 0.0), [1.5, 0.3], 190.0, 2.5),
        (&hat(oblique, 0.7), [1.5, 0.3], 190.0, 2.5),
        (&hat_metric(oblique, 0.0), [1.5, 0.3], 190.0, 2.5),
        (&hat_metric(oblique, 0.7), [1.5, 0.3], 190.0, 2.5),
    ];
    for (n, (surface, at, degrees, length)) in cases.into_iter().enumerate() {
        let [m, apart] = compare(surface, at, degrees, length);
        let off = (m - apart).abs() / (1.0 + apart.abs());
        assert!(off < 1e-6, "{n}: {m} instead of {apart}");
    }
}

#[test]
fn a_metric_with_a_jump_has_the_geodesics_of_its_surface() {
    let oblique = [1.0, -1.0, -2.0, 0.3];
    let [surface, metric] = [
        &hat(oblique, 0.7) as &dyn Surface,
        &hat_metric(oblique, 0.7),
    ]
    .map(|surface| trace_heading(surface, [1.5, 0.3], 3.3, 4.0, &noting()).expect("a start"));
    let off = |a: &Trace, b: &Trace| (0..2).map(|k| (a.uv[k] - b.uv[k]).abs()).sum::<f64>();
    assert!(off(&surface, &metric) < 1e-9, "{surface:?} {metric:?}");
    assert_eq!((surface.creases, metric.creases), (2, 2));
    is(metric.jacobi[0], surface.jacobi[0], 1e-8);
}

#[test]
fn where_only_second_derivatives_jump_nothing_else_does() {
    // (u, v, u|u|).
    let mut m = Maker::new();
    let (u, v) = (m.u, m.v);
    let abs = m.f(Unary::Abs, u);
    let z = m.mul(u, abs);
    let s = m.done([u, v, z], [[-2.0, 2.0]; 2]);
    let end = trace(&s, [-0.5, 0.1], [1.0, 0.4], 1.5, &noting()).expect("a start");
    assert_eq!((end.creases, end.status), (0, Status::Complete));
    // A surface of translation is flat.
    is(end.jacobi[0], 1.5, 1e-9);
}

#[test]
fn tight_tolerances_cross_creases() {
    for tolerance in [1e-9, 1e-11, 1e-12, 1e-13] {
        let options = Options {
            tolerance,
            ..Options::default()
        };
        for (surface, from) in [
            (&round_hat() as &dyn Surface, [0.0, 0.0]),
            (&hat([1.0, -1.0, -2.0, 0.3], 0.0), [0.1, -0.2]),
        ] {
            for n in 0..40 {
                let end = trace_heading(surface, from, 0.157 * f64::from(n), 2.0, &options)
                    .expect("a start");
                assert_eq!(end.status, Status::Complete, "{tolerance:e}, {n}: {end:?}");
                assert_eq!(end.creases, 1);
            }
        }
    }
}

#[test]
fn a_crease_costs_a_few_steps() {
    let options = Options {
        compare: false,
        ..Options::default()
    };
    let end = trace(&pyramid(), [1.0, 0.2], [-1.0, 0.55], 2.4536, &options).expect("a start");
    assert_eq!((end.creases, end.status), (1, Status::Complete));
    assert!(end.evaluations <= 150, "{}", end.evaluations);
}

#[test]
fn geodesics_between_points_of_two_faces_are_found() {
    let found = measure::between(&pyramid(), [1.0, 0.2], [-1.0, 0.3], None).expect("two points");
    // By unfolding the faces: through (0, 0.75).
    is(found.found[0].length, 6.02_f64.sqrt(), 1e-9);
    assert!(found.complete, "{found:?}");
}

#[test]
fn geodesics_across_rims_are_found() {
    for (surface, from, to) in [
        (&lid() as &dyn Surface, [-1.784, 0.0], [0.9, 0.0]),
        (&round_hat(), [-2.0, 0.1], [2.0, 0.0]),
        (&two_planes(), [-1.0, -1.0], [1.0, 1.0]),
    ] {
        let found = measure::between(surface, from, to, None).expect("two points");
        let first = found.found.first().expect("a geodesic");
        let end = trace(
            surface,
            first.from,
            first.direction,
            first.length,
            &noting(),
        );
        let end = end.expect("a start").uv;
        let off = (end[0] - to[0]).hypot(end[1] - to[1]);
        assert!(off < 1e-8, "{found:?}");
    }
}

#[test]
fn narrow_ridges_are_not_leapt_over() {
    let options = Options {
        compare: false,
        ..Options::default()
    };
    for width in [0.1, 0.02, 0.004, 1e-4] {
        let surface = creased(width, 1.0, off_line);
        for n in -9..=9 {
            let angle = 0.1 * f64::from(n);
            let end = trace_heading(&surface, [0.0, 0.0], angle, 1.6, &options).expect("a start");
            let (sin, cos) = angle.sin_cos();
            // The ridge is a strip of the plane, √2 times as wide.
            let u = 1.6 * cos - 2.0 * width * (2.0_f64.sqrt() - 1.0);
            if u < 0.5 + 1.1 * width {
                continue;
            }
            assert_eq!(
                (end.creases, end.status),
                (3, Status::Complete),
                "{width}, {n}"
            );
            let off = (end.uv[0] - u).hypot(end.uv[1] - 1.6 * sin);
            assert!(off < 1e-9, "{width}, {n}: {off:e}");
        }
    }
}

#[test]
fn a_small_bump_on_the_way_is_met() {
    for [radius, slope] in [[0.2, 2.0], [0.05, 2.0], [0.02, 1.0], [0.003, 0.5]] {
        let surface = creased(radius, slope, off_point);
        let centre = 0.13_f64.atan2(0.5);
        let reach = (radius / 0.5_f64.hypot(0.13)).asin();
        for share in [-0.95, -0.6, -0.3, 0.2, 0.5, 0.9] {
            let angle = centre + share * reach;
            let end = trace_heading(&surface, [0.0, 0.0], angle, 1.7, &Options::default());
            let end = end.expect("a start");
            assert_eq!(end.status, Status::Complete, "{radius}, {share}: {end:?}");
            let expected = behind_bump([radius, slope], angle, 1.7);
            let off = (end.uv[0] - expected[0]).hypot(end.uv[1] - expected[1]);
            assert!(
                off < 1e-7,
                "{radius}, {share}: {off:e}, {end:?}, {expected:?}"
            );
        }
    }
}

#[test]
fn a_circle_knows_of_the_bump_in_it() {
    for [radius, slope] in [[0.05, 2.0], [0.2, 1.0], [0.01, 0.7]] {
        circle_over_bump([radius, slope]);
    }
}

#[track_caller]
fn circle_over_bump([radius, slope]: [f64; 2]) {
    let surface = creased(radius, slope, off_point);
    let circle = measure::circle(&surface, [0.0, 0.0], 0.9)
        .expect("a place")
        .expect("no edge");
    // The rays beside the bump are straight. For those over it m is the derivative of the end by the angle, found from the
    // closed form.
    let centre = 0.13_f64.atan2(0.5);
    let reach = (radius / 0.5_f64.hypot(0.13)).asin();
    let mut expected = 0.9 * (2.0 * PI - 2.0 * reach);
    let count = 40_000;
    for n in 0..count {
        // At the tip the ends jump: the parts beside it are as long as their neighbours.
        let n = match 2 * n - count {
            0 => n + 1,
            -2 => n - 1,
            _ => n,
        };
        // Denser towards the rim, where m grows.
        let share = |n: f64| (PI * (n / f64::from(count) - 0.5)).sin();
        let [from, to] = [n, n + 1].map(|n| centre + reach * share(f64::from(n)));
        let [a, b] = [from, to].map(|angle| behind_bump([radius, slope], angle, 0.9));
        expected += (a[0] - b[0]).hypot(a[1] - b[1]);
    }
    let off = (circle.circumference - expected).abs();
    // On the plane alone the circle is 5.65 long.
    assert!(
        off < circle.circumference_error,
        "{off:e}, {circle:?}, {expected}"
    );
    assert!(
        circle.circumference_error < 2e-3,
        "{off:e}, {circle:?}, {expected}"
    );
    assert_eq!(circle.overlaps.filter(|overlaps| !overlaps), None);
}
