//! The camera at a pole: its frame there, the geodesics from it, and walks onto poles, through them and away.

use crate::shapes::*;
use expr::ops::Unary;
use geodesic::ends::Coordinates;
use geodesic::frame::Frame;
use geodesic::surface::{ParametricSurface, Side, Surface};
use geodesic::trace::{Options, Status};

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn at_both_poles_of_a_sphere_x_lies_along_the_first_meridian() {
    let s = spheroid(1.0, 1.0);
    for north in [1.0, -1.0] {
        for u in [0.0, 0.7, TAU] {
            let frame = Frame::new(&s, [u, north * PI / 2.0], 0.0, 0.5).expect("a frame");
            assert!(
                matches!(frame.coordinates, Coordinates::Apex { axis: 1, .. }),
                "{frame:?}"
            );
            let metric = frame.metric(&s);
            assert!(
                (metric.inner(frame.x, frame.x) - 0.25).abs() < 1e-14,
                "{frame:?}"
            );
            assert!(
                (metric.inner(frame.y, frame.y) - 0.25).abs() < 1e-14,
                "{frame:?}"
            );
            assert!(metric.inner(frame.x, frame.y).abs() < 1e-14, "{frame:?}");
            assert!(!frame.is_mirrored(&s));
            for (place, towards) in [
                ([1.0, 0.0], [1.0, 0.0, 0.0]),
                // σu×σv points outward everywhere: left is the other way about at the south pole.
                ([0.0, 1.0], [0.0, north, 0.0]),
                ([-0.6, 0.8], [-0.6, 0.8 * north, 0.0]),
            ] {
                for length in [1e-6, 0.3, 3.0, 6.0_f64] {
                    let end = frame
                        .trace(&s, place, length, &Options::default())
                        .expect("a start");
                    assert_eq!(end.status, Status::Complete);
                    let (sin, cos) = length.sin_cos();
                    let expected = [sin * towards[0], sin * towards[1], north * cos];
                    let error = distance(s.jet(end.uv).position, expected);
                    assert!(
                        error < 1e-11,
                        "{north} {u} {place:?} {length}: {error:e} {end:?}"
                    );
                }
            }
        }
    }
}

/// The frame's X and Y in space.
fn in_space(s: &dyn Surface, frame: &Frame) -> [[f64; 3]; 3] {
    let plain = frame.plain(s);
    let jet = s.jet(plain.uv);
    let vector = |a: [f64; 2]| [0, 1, 2].map(|k| a[0] * jet.du[k] + a[1] * jet.dv[k]);
    [jet.position, vector(plain.x.0), vector(plain.y.0)]
}

#[test]
fn walks_onto_a_pole_and_on_carry_the_frame_as_parallel_transport_does() {
    let s = spheroid(1.0, 1.0);
    let options = Options::default();
    for miss in [0.0, 1e-15, 1e-9, 1e-5, 1e-3] {
        for angle in [0.0, 0.4, PI / 2.0, 3.0] {
            let start = Frame::new(&s, [0.3, 1.0], angle, 0.5).expect("a frame");
            // Towards the pole, which is π/2 − 1 off: north is at the angle π/2 − `angle` in the frame.
            let heading = PI / 2.0 - angle + miss;
            let way = (PI / 2.0 - 1.0) / 0.5;
            let step = [way * heading.cos(), way * heading.sin()];
            let (at_pole, trace) = start.advance(&s, step, &options).expect("a way");
            assert_eq!(trace.status, Status::Complete);
            assert!(
                at_pole
                    .x
                    .0
                    .iter()
                    .chain(&at_pole.y.0)
                    .all(|x| x.abs() < 1.0),
                "{at_pole:?}"
            );
            assert!((at_pole.zoom(&s) - 0.5).abs() < 1e-11, "{at_pole:?}");
            // On by as much again, in the same direction of the frame: a great circle twice as long.
            let (beyond, _) = at_pole.advance(&s, step, &options).expect("a way");
            let twice = step.map(|x| 2.0 * x);
            let (direct, _) = start.advance(&s, twice, &options).expect("a way");
            for (a, b) in in_space(&s, &beyond).into_iter().zip(in_space(&s, &direct)) {
                let error = distance(a, b);
                assert!(
                    error < 1e-9,
                    "{miss:e} {angle}: {error:e} {beyond:?} {direct:?}"
                );
            }
            // And back to the start.
            let (back, _) = beyond
                .advance(&s, twice.map(|x| -x), &options)
                .expect("a way");
            for (a, b) in in_space(&s, &back).into_iter().zip(in_space(&s, &start)) {
                assert!(
                    distance(a, b) < 1e-9,
                    "{miss:e} {angle}: {back:?} {start:?}"
                );
            }
        }
    }
}

#[test]
fn a_frame_beside_a_pole_is_the_one_along_its_own_meridian() {
    let s = spheroid(1.0, 1.0);
    for off in [1e-12, 1e-8, 1e-5, 1e-3, 0.1] {
        for (north, u) in [(1.0, 0.9), (-1.0, 2.5)] {
            let frame = Frame::new(&s, [u, north * (PI / 2.0 - off)], 0.0, 1.0).expect("a frame");
            let [_, x, y] = in_space(&s, &frame);
            let east = [-f64::sin(u), f64::cos(u), 0.0];
            let tilt = f64::sin(off) * north;
            let up = [
                -north * f64::cos(off) * f64::cos(u),
                -north * f64::cos(off) * f64::sin(u),
                tilt.abs(),
            ];
            assert!(distance(x, east) < 1e-9, "{off:e}: {x:?} {east:?}");
            assert!(distance(y, up) < 1e-9, "{off:e}: {y:?} {up:?}");
        }
    }
}

#[test]
fn lines_that_wind_about_a_tip_are_straight_over_a_share_of_the_domain() {
    // The plane, whose lines of constant u turn about the tip by v (1 + cos(u)/2) times `turn`: as fast as `turn` on the
    // average. They may turn by half a radian.
    for (turn, width, reach) in [(1.0, 2.0, 0.25), (-0.5, 4.0, 0.25), (0.1, 2.0, 1.0)] {
        let mut m = Maker::new();
        let (u, v) = (m.u, m.v);
        let cos = m.f(Unary::Cos, u);
        let uneven = m.scale(0.5 * turn, cos);
        let rate = m.plus(turn, uneven);
        let turned = m.mul(v, rate);
        let angle = m.add(u, turned);
        let zero = m.c(0.0);
        let position = m.around(v, angle, zero);
        let surface = m.done(position, [[0.0, TAU], [0.0, width]]);
        let found = surface.apex(1, 0).expect("a tip").reach;
        assert!((found - reach).abs() < 1e-4, "{turn} {width}: {found}");
    }
}

#[test]
fn a_cone_has_the_angle_of_its_unrolled_plane() {
    for slope in [0.2, 1.0, 5.0_f64] {
        let tip = cone(slope).apex(1, 0).expect("a tip");
        // A circle at distance v √(1 + slope²) from the tip has the circumference 2π v.
        let rate = 1.0 / slope.hypot(1.0);
        assert!((tip.rate - rate).abs() < 1e-9, "{slope}: {tip:?}");
        assert!(!tip.smooth && tip.regular, "{slope}: {tip:?}");
    }
}

/// The end of a ray that starts at a distance from the pole and passes it by a share of that, and where it is in the plane, in
/// which it is straight.
fn past_the_pole(
    surface: &dyn Surface,
    from: [f64; 2],
    direction: [f64; 2],
    length: f64,
    in_plane: impl Fn([f64; 2]) -> [f64; 2],
    expected: [f64; 2],
) -> f64 {
    let end = geodesic::trace::trace(surface, from, direction, length, &Options::default());
    let end = end.expect("a start");
    assert_eq!(end.status, Status::Complete, "{end:?}");
    let found = in_plane(end.uv.0);
    (found[0] - expected[0]).hypot(found[1] - expected[1])
}

#[test]
fn lines_beside_a_pole_whose_meridians_are_run_unevenly_are_straight() {
    // The radius v + v².
    let mut m = Maker::new();
    let square = m.mul(m.v, m.v);
    let (u, radius, zero) = (m.u, m.add(m.v, square), m.c(0.0));
    let position = m.around(radius, u, zero);
    let disc = m.done(position, [[0.0, TAU], [0.0, 1.0]]);
    let in_plane = |[u, v]: [f64; 2]| [(v + v * v) * u.cos(), (v + v * v) * u.sin()];
    for off in [1e-1, 1e-2, 1e-3, 1e-4, 1e-6] {
        // From (0.75, 0) in the plane, where r' = 2 and the angle turns by 1/r.
        let way: [f64; 2] = [-1.0, off];
        let size = way[0].hypot(way[1]);
        let [x, y] = way.map(|x| x / size);
        let expected = [0.75 + 1.5 * x, 1.5 * y];
        let direction = [y / 0.75, x / 2.0];
        let error = past_the_pole(&disc, [0.0, 0.5], direction, 1.5, in_plane, expected);
        assert!(error < 1e-8, "{off}: {error:e}");
    }
}

#[test]
fn lines_beside_a_pole_of_a_metric_with_uneven_angles_are_straight() {
    // The plane, with the angle v + sin v / 2.
    let metric = metric([[0.0, 3.0], [0.0, TAU]], |m| {
        let cos = m.f(Unary::Cos, m.v);
        let half = m.scale(0.5, cos);
        let rate = m.plus(1.0, half);
        let speed = m.mul(m.u, rate);
        [m.c(1.0), m.c(0.0), m.mul(speed, speed)]
    });
    let angle = |v: f64| v + 0.5 * v.sin();
    let in_plane = |[u, v]: [f64; 2]| [u * angle(v).cos(), u * angle(v).sin()];
    let from: [f64; 2] = [0.7, 1.0];
    let rate = 1.0 + 0.5 * from[1].cos();
    let [p, q] = in_plane(from);
    for off in [1e-1, 1e-2, 1e-3, 1e-4] {
        let size = 1.0_f64.hypot(off);
        let [inward, aside] = [-1.0 / size, off / size];
        let direction = [inward, aside / (from[0] * rate)];
        let (sin, cos) = angle(from[1]).sin_cos();
        let expected = [
            p + 1.5 * (inward * cos - aside * sin),
            q + 1.5 * (inward * sin + aside * cos),
        ];
        let error = past_the_pole(&metric, from, direction, 1.5, in_plane, expected);
        assert!(error < 1e-8, "{off}: {error:e}");
    }
    let through = geodesic::trace::trace(&metric, from, [-1.0, 0.0], 1.5, &Options::default());
    assert_eq!(through.expect("a start").status, Status::ConePoint);
}

#[test]
fn rays_pass_the_rim_of_a_flat_spheroid() {
    for flatness in [1e-3, 3e-4, 1e-4] {
        let surface = spheroid(1.0, flatness);
        for n in 0..8 {
            let heading = 0.3 + 0.7 * f64::from(n);
            let from = [0.2, -0.5];
            let jet = surface.jet(from.into());
            let size = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
            let direction = [heading.cos() / size(jet.du), heading.sin() / size(jet.dv)];
            let options = Options {
                max_evaluations: 10_000_000,
                ..Options::default()
            };
            let end = geodesic::trace::trace(&surface, from, direction, 4.0, &options);
            let end = end.expect("a start");
            assert_eq!(end.status, Status::Complete, "{flatness} {n}: {end:?}");
        }
    }
}

/// (√v cos u, √v sin u, v), v ∈ [0, 9].
fn paraboloid_by_height() -> ParametricSurface {
    let mut m = Maker::new();
    let r = m.f(Unary::Sqrt, m.v);
    let (u, v) = (m.u, m.v);
    let p = m.around(r, u, v);
    m.done(p, [[-PI, PI], [0.0, 9.0]])
}

/// (v cos u, v sin u, v²), v ∈ [0, far].
fn paraboloid(far: f64) -> ParametricSurface {
    let mut m = Maker::new();
    let square = m.mul(m.v, m.v);
    let (u, v) = (m.u, m.v);
    let p = m.around(v, u, square);
    m.done(p, [[-PI, PI], [0.0, far]])
}

#[test]
fn a_bent_pole_of_a_wide_domain_is_smooth() {
    // The metric of the first, by the height.
    let by_metric = metric([[0.0, 8.0], [0.0, TAU]], |m| {
        let one = m.c(1.0);
        let four = m.scale(4.0, m.u);
        let share = m.g.div(one, four);
        [m.plus(1.0, share), m.c(0.0), m.u]
    });
    let by_height = paraboloid_by_height();
    let wide = paraboloid(1e4);
    let cases = [
        (&by_height as &dyn Surface, [0.3, 2.0], [0.0, -1.0], 1),
        (&by_metric as &dyn Surface, [2.0, 0.3], [-1.0, 0.0], 0),
        (&wide as &dyn Surface, [0.3, 2.0_f64.sqrt()], [0.0, -1.0], 1),
    ];
    // Along the parabola z = x².
    let arc = |x: f64| 0.5 * x * (1.0 + 4.0 * x * x).sqrt() + 0.25 * (2.0 * x).asinh();
    for (n, (surface, from, direction, axis)) in cases.into_iter().enumerate() {
        let end = geodesic::trace::trace(surface, from, direction, 3.0, &Options::default());
        let end = end.expect("a start");
        assert_eq!(end.status, Status::Complete, "{n}: {end:?}");
        let x = match n {
            2 => end.uv[axis],
            _ => end.uv[axis].sqrt(),
        };
        assert!(
            (arc(2.0_f64.sqrt()) + arc(x) - 3.0).abs() < 1e-9,
            "{n}: {end:?}"
        );
        assert!((end.uv[1 - axis] - 0.3).abs() > 3.0, "{n}: {end:?}");
    }
    let found = geodesic::measure::place(&by_height, [0.0, 0.0]).expect("a pole");
    assert!((found.gaussian.expect("K") - 4.0).abs() < 1e-6, "{found:?}");
}

#[test]
fn the_pole_of_a_slender_spheroid_is_passed_and_started_from() {
    for slenderness in [10.0, 64.0, 70.0, 100.0, 1000.0] {
        let surface = spheroid(1.0, slenderness);
        let beside = 0.5 * PI - 0.01;
        // The arc length of the meridian from there to the pole, by Simpson's rule.
        let speed = |off: f64| off.cos().hypot(slenderness * off.sin());
        let pieces = 4000;
        let step = 0.01 / f64::from(pieces);
        let arc: f64 = (0..pieces)
            .map(|k| {
                let off = step * f64::from(k);
                (speed(off) + 4.0 * speed(off + 0.5 * step) + speed(off + step)) * step / 6.0
            })
            .sum();
        let options = Options::default();
        let over = geodesic::trace::trace(&surface, [0.0, beside], [0.0, 1.0], 2.0 * arc, &options);
        let up = geodesic::trace::trace(&surface, [0.0, 0.5 * PI], [0.0, 1.0], arc, &options);
        let expected = surface.jet([-PI, beside].into()).position;
        for end in [over, up] {
            let end = end.expect("a start");
            assert_eq!(end.status, Status::Complete, "{slenderness}: {end:?}");
            let off = distance(end.position.expect("embedded"), expected);
            assert!(
                off < 1e-9 && off < 10.0 * end.error_estimate + 1e-12,
                "{slenderness}: {off} {end:?}"
            );
        }
    }
}

#[test]
fn the_pole_of_an_ellipsoid_with_slender_sections_is_smooth() {
    for ratio in [5.0, 6.0, 8.0, 12.0, 20.0, 40.0] {
        for (a, b) in [(1.0, ratio), (ratio, 1.0)] {
            let s = triaxial(a, b, 1.0);
            assert_eq!(s.sides().v, [Side::Pole; 2], "{a} {b}");
        }
    }
}
