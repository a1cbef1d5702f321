//! Surfaces whose parameter runs unevenly across a seam: distances, triangles and pictures are those of evenly parametrised
//! twins.

use crate::near::near;
use crate::shapes::*;
use expr::NodeId;
use expr::ops::Unary;
use geodesic::ends::GeodesicWork;
use geodesic::frame::Frame;
use geodesic::map::{Map, MapOptions, exponential_map};
use geodesic::measure;
use geodesic::point::Uv;
use geodesic::reference::Reference;
use geodesic::reparametrised::Reparametrised;
use geodesic::status::Status;
use geodesic::surface::{Jet, JetBlock, LANES, ParametricSurface, Side, Surface};

/// A parameter in [0, 1] as an angle.
#[derive(Clone, Copy)]
enum Angle {
    /// 2πu.
    Even,
    /// πu(1 + u).
    Quadratic,
    /// 2π(eᵘ − 1)/(e − 1).
    Exponential,
}

impl Angle {
    fn node(self, m: &mut Maker, u: NodeId) -> NodeId {
        match self {
            Self::Even => m.scale(TAU, u),
            Self::Quadratic => {
                let more = m.plus(1.0, u);
                let both = m.mul(u, more);
                m.scale(PI, both)
            }
            Self::Exponential => {
                let e = m.f(Unary::Exp, u);
                let less = m.plus(-1.0, e);
                m.scale(TAU / (1.0_f64.exp() - 1.0), less)
            }
        }
    }

    fn value(self, u: f64) -> f64 {
        match self {
            Self::Even => TAU * u,
            Self::Quadratic => PI * u * (1.0 + u),
            Self::Exponential => TAU * u.exp_m1() / 1.0_f64.exp_m1(),
        }
    }
}

/// (cos a, sin a, v).
fn cylinder_by(angle: Angle) -> ParametricSurface {
    let mut m = Maker::new();
    let (u, v, one) = (m.u, m.v, m.c(1.0));
    let a = angle.node(&mut m, u);
    let p = m.around(one, a, v);
    m.done(p, [[0.0, 1.0], [-4.0, 4.0]])
}

/// Longitude a, latitude v.
fn sphere_by(angle: Angle) -> ParametricSurface {
    ellipsoid_by(angle, [1.0; 3])
}

/// The same, stretched along the axes: about its poles the angle in the tangent plane does not grow evenly with a.
fn ellipsoid_by(angle: Angle, axes: [f64; 3]) -> ParametricSurface {
    let mut m = Maker::new();
    let (cos, sin) = (m.f(Unary::Cos, m.v), m.f(Unary::Sin, m.v));
    let u = m.u;
    let a = angle.node(&mut m, u);
    let p = m.around(cos, a, sin);
    let p = [0, 1, 2].map(|k| m.scale(axes[k], p[k]));
    m.done(p, [[0.0, 1.0], [-PI / 2.0, PI / 2.0]])
}

/// The torus with the radii 2 and 1, longitude a, the other angle b.
fn torus_by(angle: Angle, other: Angle) -> ParametricSurface {
    let mut m = Maker::new();
    let (u, v) = (m.u, m.v);
    let (a, b) = (angle.node(&mut m, u), other.node(&mut m, v));
    let (cos, sin) = (m.f(Unary::Cos, b), m.f(Unary::Sin, b));
    let radius = m.plus(2.0, cos);
    let p = m.around(radius, a, sin);
    m.done(p, [[0.0, 1.0], [0.0, 1.0]])
}

/// The Möbius strip around a.
fn moebius_by(angle: Angle) -> ParametricSurface {
    let mut m = Maker::new();
    let (u, v) = (m.u, m.v);
    let a = angle.node(&mut m, u);
    let half = m.scale(0.5, a);
    let (cos, sin) = (m.f(Unary::Cos, half), m.f(Unary::Sin, half));
    let (out, z) = (m.mul(v, cos), m.mul(v, sin));
    let radius = m.plus(1.0, out);
    let p = m.around(radius, a, z);
    m.done(p, [[0.0, 1.0], [-0.4, 0.4]])
}

/// (x, y, v) for a closed curve (x, y) in u, v.
fn wall(curve: impl FnOnce(&mut Maker) -> [NodeId; 2]) -> ParametricSurface {
    let mut m = Maker::new();
    let [x, y] = curve(&mut m);
    let v = m.v;
    m.done([x, y, v], [[0.0, 1.0], [-1.0, 1.0]])
}

#[track_caller]
fn distance(surface: &dyn Surface, from: [f64; 2], to: [f64; 2]) -> f64 {
    let found = measure::distance(surface, from, to).expect("places");
    found.expect("a geodesic").length
}

/// Turns of 2π, the shorter way round.
fn turn(angle: Angle, from: f64, to: f64) -> f64 {
    let turn = (angle.value(to) - angle.value(from)) / TAU;
    (turn - turn.round()).abs() * TAU
}

fn vectors(jet: &Jet) -> [[f64; 3]; 6] {
    [jet.position, jet.du, jet.dv, jet.duu, jet.duv, jet.dvv]
}

#[test]
fn even_parameters_are_those_of_the_twin() {
    const AXES: [f64; 3] = [1.2, 0.7, 0.9];
    let even = Angle::Even;
    for angle in [Angle::Quadratic, Angle::Exponential] {
        let pairs = [
            (cylinder_by(angle), cylinder_by(even)),
            (sphere_by(angle), sphere_by(even)),
            (ellipsoid_by(angle, AXES), ellipsoid_by(even, AXES)),
            (torus_by(angle, even), torus_by(even, even)),
            (torus_by(even, angle), torus_by(even, even)),
            (torus_by(angle, Angle::Quadratic), torus_by(even, even)),
            (moebius_by(angle), moebius_by(even)),
        ];
        for (n, (surface, twin)) in pairs.iter().enumerate() {
            let found = Reparametrised::of(surface).expect("an uneven seam");
            let what = |part: &str| format!("{part} of surface {n}");
            assert_eq!(found.domain(), surface.domain());
            assert_eq!(found.sides(), surface.sides());
            let mut block = JetBlock::default();
            let us: [f64; LANES] = std::array::from_fn(|k| k as f64 / (LANES - 1) as f64);
            let [low, high] = surface.domain()[1];
            let vs = us.map(|u| low + (high - low) * (0.1 + 0.7 * u));
            found.jets(&[us, vs], &mut block);
            for lane in 0..LANES {
                let at = Uv([us[lane], vs[lane]]);
                let jets = [twin.jet(at), found.jet(at), block.lane(lane)];
                let [expected, one, several] = jets.map(|jet| vectors(&jet));
                for k in 0..6 {
                    // Up to (2π)²·3 in size, with the rounding of a second derivative.
                    let bound = if k == 3 || k == 5 { 1e-9 } else { 1e-11 };
                    for i in 0..3 {
                        near(&what("the jet"), one[k][i], expected[k][i], bound);
                        near(&what("jets"), several[k][i], one[k][i], 1e-11);
                    }
                }
                // There and back, whole turns away too.
                for turns in [-2.0, 0.0, 3.0] {
                    let place = Uv([at[0] + turns, at[1]]);
                    let (own, slopes) = found.restored(place);
                    let (back, same) = found.changed(own);
                    near(&what("a place"), back[0], place[0], 1e-14);
                    near(&what("a place"), back[1], place[1], 1e-14);
                    near(&what("a slope"), slopes[0], same[0], 1e-12);
                }
            }
        }
    }
}

#[test]
fn poles_in_even_parameters_are_smooth_and_regular() {
    for axes in [[1.0; 3], [1.2, 0.7, 0.9]] {
        let surface = ellipsoid_by(Angle::Quadratic, axes);
        let twin = ellipsoid_by(Angle::Even, axes);
        let found = Reparametrised::of(&surface).expect("an uneven seam");
        for end in 0..2 {
            let [found, expected] =
                [found.apex(1, end), twin.apex(1, end)].map(|apex| apex.expect("a pole"));
            assert!(found.smooth && found.regular, "{found:?}");
            assert_eq!(
                (found.rate, found.power, found.reach),
                (expected.rate, expected.power, expected.reach)
            );
            near("bend", found.bend, expected.bend, 1e-9);
        }
    }
}

#[test]
fn surfaces_without_a_seam_that_even_parameters_would_smooth_have_none() {
    let even = Angle::Even;
    // The curve leaves its seam in one direction and comes back to it in another, at other speeds.
    let corner = wall(|m| {
        let less = m.scale(-1.0, m.u);
        let (rest, more) = (m.plus(1.0, less), m.plus(1.0, m.u));
        let x = m.mul(m.u, rest);
        let x = m.mul(x, more);
        let off = m.plus(-0.5, m.u);
        [x, m.mul(x, off)]
    });
    // The speeds' ratio changes along the seam: 2π(u + vu(1−u)/4).
    let sheared = wall(|m| {
        let less = m.scale(-1.0, m.u);
        let rest = m.plus(1.0, less);
        let bump = m.mul(m.u, rest);
        let bump = m.mul(bump, m.v);
        let bump = m.scale(0.25, bump);
        let a = m.add(m.u, bump);
        let a = m.scale(TAU, a);
        [m.f(Unary::Cos, a), m.f(Unary::Sin, a)]
    });
    // The parameter has a kink within: 2π(3u + |u − 0.4| − 0.4)/3.2.
    let kinked = wall(|m| {
        let off = m.plus(-0.4, m.u);
        let abs = m.f(Unary::Abs, off);
        let three = m.scale(3.0, m.u);
        let a = m.add(three, abs);
        let a = m.plus(-0.4, a);
        let a = m.scale(TAU / 3.2, a);
        [m.f(Unary::Cos, a), m.f(Unary::Sin, a)]
    });
    for surface in [&corner, &sheared, &kinked] {
        assert_eq!(surface.sides().u, [Side::Wrap; 2]);
    }
    let others: [&dyn Surface; 12] = [
        &corner,
        &sheared,
        &kinked,
        &cylinder_by(even),
        &sphere_by(even),
        &torus_by(even, even),
        &moebius_by(even),
        &plane(),
        &cone(1.0),
        &klein(TAU),
        &sphere_by_height(),
        &spheroid_metric(1.0, 0.8, 0.0),
    ];
    for (n, surface) in others.into_iter().enumerate() {
        assert!(Reparametrised::of(surface).is_none(), "surface {n}");
    }
}

#[test]
fn distances_over_the_seam_are_those_of_closed_forms() {
    for angle in [Angle::Quadratic, Angle::Exponential] {
        let cylinder = cylinder_by(angle);
        let sphere = sphere_by(angle);
        let torus = torus_by(angle, Angle::Even);
        let both = torus_by(angle, Angle::Quadratic);
        let twin = torus_by(Angle::Even, Angle::Even);
        let share = |angle: Angle, u: f64| angle.value(u) / TAU;
        for (from, to) in [
            ([0.05, 0.0], [0.98, 0.0]),
            ([0.05, 0.3], [0.93, 0.1]),
            ([0.9, 0.2], [0.3, 0.4]),
            ([0.0, 0.2], [0.02, 0.4]),
            ([0.4, 0.1], [0.6, 0.9]),
        ] {
            let around = turn(angle, from[0], to[0]);
            near(
                "cylinder",
                distance(&cylinder, from, to),
                around.hypot(to[1] - from[1]),
                1e-9,
            );
            let (s, t) = (from[1], to[1]);
            // By half the chord.
            let half = |x: f64| (0.5 * x).sin().powi(2);
            let square = half(s - t) + s.cos() * t.cos() * half(around);
            near(
                "sphere",
                distance(&sphere, from, to),
                2.0 * square.sqrt().asin(),
                1e-9,
            );
            let expected = |other: Angle| {
                let [from, to] = [from, to].map(|[u, v]| [share(angle, u), share(other, v)]);
                distance(&twin, from, to)
            };
            near(
                "torus",
                distance(&torus, from, to),
                expected(Angle::Even),
                1e-9,
            );
            near(
                "torus, both angles",
                distance(&both, from, to),
                expected(Angle::Quadratic),
                1e-9,
            );
        }
    }
}

#[test]
fn a_connection_begins_and_ends_at_the_places_given_at_unit_speed() {
    let s = cylinder_by(Angle::Exponential);
    let found = measure::between(&s, [0.05, 0.0], [0.98, 0.3], Some(7.0)).expect("places");
    assert!(found.complete);
    // Both ways round, and once more.
    let around = turn(Angle::Exponential, 0.05, 0.98);
    let expected = [around, TAU - around, TAU + around].map(|way| way.hypot(0.3));
    assert_eq!(found.found.len(), 3, "{found:?}");
    for (it, expected) in found.found.iter().zip(expected) {
        near("length", it.length, expected, 1e-9);
        for (at, given) in [(it.from, [0.05, 0.0]), (it.to, [0.98, 0.3])] {
            near("u", at[0], given[0], 1e-10);
            near("v", at[1], given[1], 1e-10);
        }
        for (at, way) in [(it.from, it.direction), (it.to, it.arrival)] {
            let jet = s.jet(at);
            let speed = (0..3).map(|k| (jet.du[k] * way[0] + jet.dv[k] * way[1]).powi(2));
            near("speed", speed.sum::<f64>(), 1.0, 1e-9);
        }
    }
    let outside = measure::distance(&s, [0.25, 4.5], [0.5, 0.0]).expect_err("no place");
    let measure::MeasureError::Outside { at, .. } = outside else {
        panic!("{outside:?}");
    };
    near("u", at[0], 0.25, 1e-14);
}

#[test]
fn triangles_over_the_seam_have_the_angles_of_their_twins() {
    let corners = [[0.93, 0.1], [0.06, 0.05], [0.02, 0.3]];
    let pairs: [(ParametricSurface, ParametricSurface); 3] = [
        (cylinder_by(Angle::Quadratic), cylinder_by(Angle::Even)),
        (sphere_by(Angle::Quadratic), sphere_by(Angle::Even)),
        (
            torus_by(Angle::Quadratic, Angle::Even),
            torus_by(Angle::Even, Angle::Even),
        ),
    ];
    for (surface, twin) in pairs {
        let found = measure::triangle(&surface, corners).expect("corners");
        let even = corners.map(|[u, v]| [Angle::Quadratic.value(u) / TAU, v]);
        let expected = measure::triangle(&twin, even).expect("corners");
        for k in 0..3 {
            let angles = [&found, &expected].map(|it| it.angles[k].expect("an angle"));
            near("angle", angles[0], angles[1], 1e-9);
            let sides = [&found, &expected].map(|it| it.sides[k].expect("a side"));
            near("side", sides[0].length, sides[1].length, 1e-9);
            let [u, v] = sides[0].to.0;
            near("u", Angle::Quadratic.value(u) / TAU, sides[1].to[0], 1e-9);
            near("v", v, sides[1].to[1], 1e-9);
        }
        let regions = [&found, &expected].map(|it| it.region.expect("a region"));
        near("area", regions[0].area, regions[1].area, 1e-9);
        near(
            "curvature",
            regions[0].curvature,
            regions[1].curvature,
            1e-8,
        );
    }
}

/// A picture with the work that it took.
fn picture(surface: &dyn Surface, frame: &Frame) -> (Map, GeodesicWork) {
    let map = exponential_map(surface, frame, [400; 2], &MapOptions::default(), &|_| {});
    let work = map.work;
    (map, work)
}

/// Draws both, compares places in space pixel by pixel, and with geodesics of the twin that are followed by themselves; gives
/// the work.
#[track_caller]
fn compare(
    what: &str,
    (surface, angle): (&dyn Surface, Angle),
    twin: &dyn Surface,
    at: [f64; 2],
    zoom: f64,
) -> [GeodesicWork; 2] {
    let frame = Frame::new(surface, at, 0.5, zoom).expect("a frame");
    let (map, work) = picture(surface, &frame);
    let even = [angle.value(at[0]) / TAU, at[1]];
    let even_frame = Frame::new(twin, even, 0.5, zoom).expect("a frame");
    let (other, other_work) = picture(twin, &even_frame);
    let pixel = 2.0 * zoom / 400.0;
    let back = |surface: &dyn Surface, uv: Uv| {
        let mut at = uv.0;
        surface.sides().bring_back(surface.domain(), &mut at);
        surface.jet(Uv(at)).position
    };
    let mut worst = 0.0_f64;
    let mut compared = 0;
    for index in 0..map.offset.len() {
        if [map.status[index], other.status[index]] != [Status::Complete; 2] {
            continue;
        }
        let a = back(surface, map.uv(index));
        let b = back(twin, other.uv(index));
        let gap = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
        worst = worst.max(gap / pixel);
        compared += 1;
    }
    let unlike = (map.status.iter().zip(&other.status))
        .filter(|(a, b)| a != b)
        .count();
    assert!(
        worst <= 0.25 && compared > 60_000 && unlike <= 20,
        "{what}: {worst} px of {compared}, {unlike} unlike"
    );
    let mut reference = Reference::new(twin, &even_frame, [400; 2], 2500);
    let errors = reference.errors(&|index| {
        let Uv([u, v]) = map.uv(index);
        let turns = u.floor();
        let u = turns + angle.value(u - turns) / TAU;
        (Uv([u, v]), map.status[index])
    });
    assert!(errors.max <= 0.25 && errors.unlike == 0, "{what}: {errors}");
    [work, other_work]
}

#[test]
fn pictures_over_the_seam_are_those_of_the_twins_for_as_little_work() {
    let q = Angle::Quadratic;
    let (cylinder, sphere) = (cylinder_by(q), sphere_by(q));
    let torus = torus_by(q, Angle::Even);
    let (even_cylinder, even_sphere) = (cylinder_by(Angle::Even), sphere_by(Angle::Even));
    let even_torus = torus_by(Angle::Even, Angle::Even);
    let works = [
        compare("cylinder", (&cylinder, q), &even_cylinder, [0.9, 0.1], 3.0),
        compare("sphere", (&sphere, q), &even_sphere, [0.9, 0.3], 3.0),
        compare("torus", (&torus, q), &even_torus, [0.9, 0.1], 6.0),
        // The camera stands on the seam itself.
        compare("seam", (&torus, q), &even_torus, [0.0, 0.1], 6.0),
    ];
    for [work, twin] in works {
        assert_eq!(work.followed, 0, "{work:?} {twin:?}");
        assert!(
            work.evaluations <= 3 * twin.evaluations,
            "{work:?} {twin:?}"
        );
    }
}

/// The unit disc in coordinates about a place beside its middle, ((1 − u)a + u cos v, u sin v): smooth at u = 0, where it has
/// no linear map to polar coordinates.
fn eccentric_disc(a: f64) -> ParametricSurface {
    let mut m = Maker::new();
    let (u, v, zero) = (m.u, m.v, m.c(0.0));
    let [x, y, _] = m.around(u, v, zero);
    let shift = m.scale(-a, u);
    let x = m.add(x, shift);
    let x = m.plus(a, x);
    m.done([x, y, zero], [[0.0, 1.0], [0.0, TAU]])
}

/// A sphere whose longitude is u + a sin u.
fn sphere_by_uneven_longitude(a: f64) -> ParametricSurface {
    let mut m = Maker::new();
    let (cos, sin) = (m.f(Unary::Cos, m.v), m.f(Unary::Sin, m.v));
    let wave = m.f(Unary::Sin, m.u);
    let wave = m.scale(a, wave);
    let longitude = m.add(m.u, wave);
    let p = m.around(cos, longitude, sin);
    m.done(p, [[0.0, TAU], [-PI / 2.0, PI / 2.0]])
}

#[test]
fn lines_beside_a_pole_of_uneven_directions_are_straight() {
    let surface = eccentric_disc(0.3);
    let mut arrived = 0;
    for from in [[0.5, 0.2], [0.5, 1.2], [0.2, 3.0]] {
        let jet = surface.jet(from.into());
        let p = jet.position;
        let to_pole = [0.3 - p[0], -p[1]];
        for off in [0.0, 1e-12, 1e-6, 1e-4, 1e-3, 1e-2] {
            let way = [to_pole[0] - off * to_pole[1], to_pole[1] + off * to_pole[0]];
            let way = way.map(|x| 1.3 * x);
            let determinant = jet.du[0] * jet.dv[1] - jet.dv[0] * jet.du[1];
            let direction = [
                (way[0] * jet.dv[1] - way[1] * jet.dv[0]) / determinant,
                (jet.du[0] * way[1] - jet.du[1] * way[0]) / determinant,
            ];
            let length = way[0].hypot(way[1]);
            let options = geodesic::trace::Options::default();
            let trace = geodesic::trace::trace(&surface, from, direction, length, &options);
            let trace = trace.expect("a start");
            let end = trace.position.expect("a place in space");
            let gone = trace.length / length;
            let error = (end[0] - p[0] - gone * way[0]).hypot(end[1] - p[1] - gone * way[1]);
            // A line through the pole itself ends there.
            assert!(
                error <= 1e-9,
                "{from:?}, {off}: {error} off, {:?}",
                trace.status
            );
            assert!(
                trace.status == Status::Complete || trace.status == Status::ConePoint && off < 1e-4,
                "{off}: {:?}",
                trace.status
            );
            arrived += usize::from(trace.status == Status::Complete);
        }
    }
    assert!(arrived >= 9, "{arrived}");
}

#[test]
fn places_about_a_pole_of_uneven_longitude_are_as_far_apart_as_on_the_sphere() {
    let surface = sphere_by_uneven_longitude(0.4);
    for (from, to) in [
        ([1.0, 1.2], [3.5, 1.3]),
        ([0.3, 1.45], [0.3 + PI, 1.5]),
        ([2.0, -1.3], [5.1, -1.4]),
        ([0.2, 0.4], [1.2, -0.3]),
    ] {
        let [p, q] = [from, to].map(|uv| surface.jet(uv.into()).position);
        let cos: f64 = (0..3).map(|k| p[k] * q[k]).sum();
        let found = measure::distance(&surface, from, to).expect("places");
        let found = found.expect("a geodesic");
        near(&format!("{from:?} {to:?}"), found.length, cos.acos(), 1e-9);
    }
}

#[test]
fn a_ray_through_a_pole_of_uneven_longitude_ends_there() {
    // The meridian behind the pole is not the one half a period away.
    let surface = sphere_by_uneven_longitude(0.3);
    let pole_after = |heading: f64| {
        let from = [1.0, 0.4];
        let jet = surface.jet(from.into());
        let direction = [heading.cos() / jet.du[0].hypot(jet.du[1]), heading.sin()];
        let options = geodesic::trace::Options::default();
        geodesic::trace::trace(&surface, from, direction, 3.0, &options).expect("a start")
    };
    let through = pole_after(PI / 2.0);
    assert_eq!(through.status, Status::ConePoint);
    near("length", through.length, PI / 2.0 - 0.4, 1e-9);
    assert_eq!(pole_after(PI / 2.0 - 0.01).status, Status::Complete);
}

#[test]
fn geodesics_through_a_pole_of_uneven_directions_may_be_missed() {
    let surface = eccentric_disc(0.3);
    let (from, to) = ([0.5, 0.2], [0.6, 0.9]);
    let found = measure::between(&surface, from, to, None).expect("places");
    assert!(!found.complete);
    let [p, q] = [from, to].map(|at| surface.jet(at.into()).position);
    let apart = (p[0] - q[0]).hypot(p[1] - q[1]);
    near("length", found.found[0].length, apart, 1e-9);
}

#[test]
fn a_circle_over_the_seam_is_that_of_the_twin() {
    let [even, uneven] = [Angle::Even, Angle::Exponential].map(cylinder_by);
    for radius in [0.7, 0.99, 1.02] {
        let [even, uneven] = [&even, &uneven].map(|surface| {
            let circle = measure::circle(surface, [0.5, 0.0], PI * radius).expect("a place");
            circle.map(|it| it.overlaps)
        });
        assert_eq!(even, Ok(Some(radius > 1.0)));
        assert_eq!(uneven, even, "{radius}");
    }
}
