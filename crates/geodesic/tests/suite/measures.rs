//! Measures against closed forms: curvatures, circles, all geodesics between two places.

use crate::near::near;
use crate::random::Random;
use crate::shapes::*;
use expr::NodeId;
use geodesic::intrinsic::MetricSurface;
use geodesic::measure::{self, Circle, Connections, MeasureError};
use geodesic::point::TangentVector;
use geodesic::status::Status;
use geodesic::surface::{ParametricSurface, Surface};
use geodesic::trace::{Options, trace};

/// du² + dv² on [0, a] × [0, b], whose sides are glued.
fn flat_torus(a: f64, b: f64) -> MetricSurface {
    metric([[0.0, a], [0.0, b]], |m| {
        let (one, zero): (NodeId, NodeId) = (m.c(1.0), m.c(0.0));
        [one, zero, one]
    })
}

/// The hyperbolic plane in polar coordinates: du² + sinh²u dv².
fn hyperbolic_polar() -> MetricSurface {
    metric([[0.0, 8.0], [0.0, TAU]], |m| {
        let (one, zero) = (m.c(1.0), m.c(0.0));
        let sinh = m.f(expr::ops::Unary::Sinh, m.u);
        let g = m.mul(sinh, sinh);
        [one, zero, g]
    })
}

#[track_caller]
fn circle_at(surface: &dyn Surface, uv: [f64; 2], radius: f64) -> Circle {
    let circle = measure::circle(surface, uv, radius);
    circle.expect("a place").expect("all rays arrive")
}

/// Within the estimate, which in turn is small.
#[track_caller]
fn check(what: &str, circle: Circle, expected: [f64; 2], overlaps: impl Into<Option<bool>>) {
    let [bound, of_area] = [circle.circumference_error, circle.area_error];
    let size = expected[0].max(expected[1]);
    near(
        &format!("{what}: circumference"),
        circle.circumference,
        expected[0],
        bound,
    );
    near(&format!("{what}: area"), circle.area, expected[1], of_area);
    assert!(
        bound.max(of_area) <= 1e-8 * size.max(1e-3),
        "{what}: {circle:?}"
    );
    assert_eq!(circle.overlaps, overlaps.into(), "{what}: {circle:?}");
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}

#[test]
fn curvatures_beside_a_cuspidal_edge_are_not_rounding() {
    // K = −1 everywhere on the pseudosphere, whose rim is such an edge.
    let surface = pseudosphere_to_rim();
    let mut known = 0;
    for power in 0..=20 {
        let v = 0.5 * PI - 10.0_f64.powi(-power);
        let found = measure::place(&surface, [1.0, v]).expect("a place");
        if let Some(k) = found.gaussian {
            known += 1;
            assert!((k + 1.0).abs() < 0.03, "{v}: {found:?}");
        }
    }
    assert!(known >= 4, "{known}");
    // About a smooth pole nothing is lost.
    for power in 1..=14 {
        let v = 0.5 * PI - 10.0_f64.powi(-power);
        let found = measure::place(&spheroid(1.0, 1.0), [1.0, v]).expect("a place");
        let k = found.gaussian.expect("K");
        assert!((k - 1.0).abs() < 1e-6, "{v}: {found:?}");
    }
}

#[test]
fn principal_directions_have_the_largest_and_the_smallest_curvature() {
    // Euler's theorem, on a surface whose chart is oblique: the curvatures of 360 directions lie between the two.
    let surface = triaxial(1.0, 2.0, 3.0);
    for uv in [[0.3, 0.2], [2.0, -1.0], [5.0, 1.2_f64]] {
        let found = measure::place(&surface, uv).expect("a place");
        let (k, h) = (found.gaussian.expect("K"), found.mean.expect("H"));
        let [most, least] = found.principal.expect("no umbilic");
        near("K", most.curvature * least.curvature, k, 1e-12);
        near("H", 0.5 * (most.curvature + least.curvature), h, 1e-12);
        let [e, f, g] = found.form;
        let inner =
            |[a, b]: [f64; 2], [c, d]: [f64; 2]| a * c * e + (a * d + b * c) * f + b * d * g;
        near("length", inner(most.direction, most.direction), 1.0, 1e-12);
        near(
            "right angle",
            inner(most.direction, least.direction),
            0.0,
            1e-12,
        );
        let jet = surface.jet(uv.into());
        let normal = cross(jet.du, jet.dv);
        let size = dot(normal, normal).sqrt();
        let bend = |[a, b]: [f64; 2]| {
            let second = [0, 1, 2]
                .map(|i| a * a * jet.duu[i] + 2.0 * a * b * jet.duv[i] + b * b * jet.dvv[i]);
            dot(second, normal) / size
        };
        near("most", bend(most.direction), most.curvature, 1e-12);
        near("least", bend(least.direction), least.curvature, 1e-12);
        for degree in 0..360 {
            let (sin, cos) = f64::from(degree).to_radians().sin_cos();
            let direction = [0, 1].map(|i| cos * most.direction[i] + sin * least.direction[i]);
            let bend = bend(direction);
            assert!(bend <= most.curvature + 1e-12 && bend >= least.curvature - 1e-12);
        }
    }
    let sphere = measure::place(&triaxial(2.0, 2.0, 2.0), [0.3, 0.4]).expect("a place");
    assert_eq!(
        sphere.principal, None,
        "every place of a sphere is an umbilic"
    );
    let metric = measure::place(&half_plane(), [0.5, 2.0]).expect("a place");
    assert_eq!(metric.principal, None);
    // Where the coordinate lines meet at a right angle, rounding leaves nothing of what is zero.
    for uv in [[0.3, 0.2], [2.0, -1.0], [5.0, 1.2]] {
        let found = measure::place(&triaxial(1.0, 1.0, 3.0), uv).expect("a place");
        let [most, least] = found.principal.expect("no umbilic");
        assert_eq!(found.form[1], 0.0);
        let products = [most, least].map(|it| it.direction[0] * it.direction[1]);
        assert_eq!(products, [0.0; 2], "{uv:?}");
    }
}

#[test]
fn a_circle_that_reaches_no_antipode_overlaps_nowhere_on_a_sphere() {
    let surface = metric([[-PI, PI], [-PI / 2.0, PI / 2.0]], |m| {
        let (one, zero) = (m.c(1.0), m.c(0.0));
        let cos = m.f(expr::ops::Unary::Cos, m.v);
        [m.mul(cos, cos), zero, one]
    });
    // The loops of no length at these centres are a little longer than zero.
    for uv in [
        [1.6423021070968638, -0.5222852005442326],
        [2.336467979843837, -0.5078998985759732],
        [2.955246403323663, -0.509675753383754],
    ] {
        for radius in [2.5, 3.1] {
            let circle = measure::circle(&surface, uv, radius).expect("a place");
            assert_eq!(circle.expect("a circle").overlaps, Some(false), "{uv:?}");
        }
        let found = measure::between(&surface, uv, uv, Some(6.0)).expect("a place");
        assert!(found.found.is_empty(), "{found:?}");
        // A point a few roundings away is the same point.
        let beside = [uv[0], uv[1] * (1.0 + f64::EPSILON)];
        let found = measure::between(&surface, uv, beside, Some(6.0)).expect("a place");
        assert!(found.found.is_empty(), "{found:?}");
    }
}

#[test]
fn curvatures_beside_a_pole_are_those_of_the_formulas() {
    // Surfaces of revolution z = a v² + b v³ + c v⁴, v being the distance from the axis.
    for [a, b, c] in [
        [0.0, 1.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 100.0, 0.0],
        [1.0, 0.0, 1000.0],
    ] {
        let mut m = Maker::new();
        let (u, v) = (m.u, m.v);
        let square = m.mul(v, v);
        let cube = m.mul(square, v);
        let fourth = m.mul(square, square);
        let terms = [m.scale(a, square), m.scale(b, cube), m.scale(c, fourth)];
        let sum = m.add(terms[0], terms[1]);
        let z = m.add(sum, terms[2]);
        let position = m.around(v, u, z);
        let surface = m.done(position, [[0.0, TAU], [0.0, 1.0]]);
        for r in [1e-6, 1e-5, 1e-4, 5e-4, 1e-3, 2e-3_f64] {
            let slope = 2.0 * a * r + 3.0 * b * r.powi(2) + 4.0 * c * r.powi(3);
            let second = 2.0 * a + 6.0 * b * r + 12.0 * c * r.powi(2);
            let along = 1.0 + slope * slope;
            let [bent, around] = [second / along.powf(1.5), slope / r / along.sqrt()];
            let found = measure::place(&surface, [0.3, r]).expect("a place");
            // With a term in v³ no derivative of K and H exists at the pole.
            let bound = 1e-6 + 1e-4 * b;
            // σu × σv points downwards.
            let told = format!("{a} {b} {c} at {r}");
            let (gaussian, mean) = (bent * around, -0.5 * (bent + around));
            near(
                &format!("K of {told}"),
                found.gaussian.expect("K"),
                gaussian,
                bound,
            );
            near(&format!("H of {told}"), found.mean.expect("H"), mean, bound);
        }
    }
}

#[test]
fn curvatures_are_those_of_the_formulas() {
    let [a, b, c] = [1.0, 2.0, 3.0];
    let surface = triaxial(a, b, c);
    for [u, v] in [[0.3, 0.2], [2.0, -1.0], [5.0, 1.4_f64]] {
        let found = measure::place(&surface, [u, v]).expect("a place");
        let [x, y, z] = surface.jet([u, v].into()).position;
        let h = (x * x / a.powi(4) + y * y / b.powi(4) + z * z / c.powi(4)).sqrt();
        let gaussian = 1.0 / (a * b * c * h * h).powi(2);
        near("K", found.gaussian.expect("K"), gaussian, 1e-13);
        // The normal σu × σv points outwards, so that H < 0.
        let mean = (x * x + y * y + z * z - a * a - b * b - c * c)
            / (2.0 * (a * b * c).powi(2) * h.powi(3));
        near("H", found.mean.expect("H"), mean, 1e-13);
    }
    // The third power of a size may be no number where the size is one.
    for size in [1e-120, 1e120] {
        let found = measure::place(&triaxial(size, size, 2.0 * size), [0.3, 0.4]).expect("a place");
        let unit = measure::place(&triaxial(1.0, 1.0, 2.0), [0.3, 0.4]).expect("a place");
        let [found, unit] =
            [found, unit].map(|it| [it.mean.expect("H"), it.principal.expect("two")[0].curvature]);
        for (found, unit) in found.into_iter().zip(unit) {
            near("a curvature", found * size, unit, 1e-12);
        }
    }
    // At a pole the formulas say 0/0.
    let pole = measure::place(&triaxial(1.0, 1.0, 2.0), [0.3, PI / 2.0]).expect("a place");
    near("K at a pole", pole.gaussian.expect("K"), 4.0, 1e-9);
    near("H at a pole", pole.mean.expect("H"), -2.0, 1e-9);
    let half = measure::place(&half_plane(), [0.5, 2.0]).expect("a place");
    assert_eq!(half.form, [0.25, 0.0, 0.25]);
    near("K", half.gaussian.expect("K"), -1.0, 1e-14);
    assert_eq!(half.mean, None);
    // sin π is no zero.
    for end in [0.0, PI] {
        let tip = measure::place(&zoll(), [end, 1.0]).expect("a place");
        assert_eq!(tip.gaussian, None);
    }
    let tip = measure::place(&cone(1.0), [0.3, 0.0]).expect("a place");
    assert_eq!((tip.gaussian, tip.mean), (None, None));
    assert_eq!(tip.principal, None);
    near("G at the tip", tip.form[2], 2.0, 1e-15);
}

#[test]
fn places_that_are_none_are_refused() {
    let surface = plane();
    let outside = measure::place(&surface, [5.0, 0.0]);
    assert!(
        matches!(outside, Err(MeasureError::Outside { .. })),
        "{outside:?}"
    );
    let outside = measure::between(&surface, [0.0, 0.0], [0.0, 4.0], None);
    assert!(
        matches!(outside, Err(MeasureError::Outside { .. })),
        "{outside:?}"
    );
    let radius = measure::circle(&surface, [0.0; 2], f64::NAN);
    assert!(
        matches!(radius, Err(MeasureError::BadLength { .. })),
        "{radius:?}"
    );
    let nowhere = measure::place(&surface, [f64::NAN, 0.0]);
    assert_eq!(nowhere, Err(MeasureError::NotFinite));
}

#[test]
fn circles_are_as_long_and_as_large_as_closed_forms_say() {
    let sphere = spheroid(1.0, 1.0);
    for uv in [[0.3, 0.2], [1.0, PI / 2.0], [4.0, 1.5]] {
        for r in [1e-3, 0.5, 1.0, 3.0_f64] {
            let expected = [TAU * r.sin(), TAU * (1.0 - r.cos())];
            check(
                &format!("sphere {r}"),
                circle_at(&sphere, uv, r),
                expected,
                false,
            );
        }
        // Beyond the opposite place, and beyond this one.
        let r = 4.0_f64;
        let expected = [-TAU * r.sin(), TAU * (2.0 + 1.0 + r.cos())];
        check("sphere, beyond", circle_at(&sphere, uv, r), expected, true);
    }
    check(
        "plane",
        circle_at(&plane(), [0.5, 0.25], 2.5),
        [TAU * 2.5, PI * 6.25],
        false,
    );
    let r = 6.0;
    let around = cylinder();
    check(
        "cylinder",
        circle_at(&around, [1.0, 3.0], r),
        [TAU * r, PI * r * r],
        false,
    );
    let r = 6.3;
    check(
        "cylinder, around",
        circle_at(&around, [1.0, 3.0], r),
        [TAU * r, PI * r * r],
        true,
    );
    for r in [0.5, 2.0, 5.0_f64] {
        let expected = [TAU * r.sinh(), TAU * (r.cosh() - 1.0)];
        // The search for loops of length 10 is too much work.
        let overlaps = (r < 5.0).then_some(false);
        check(
            &format!("half-plane {r}"),
            circle_at(&half_plane(), [0.5, 2.0], r),
            expected,
            overlaps,
        );
        check(
            &format!("polar {r}"),
            circle_at(&hyperbolic_polar(), [2.0, 1.0], r),
            expected,
            overlaps,
        );
    }
    let r = 2.0_f64;
    let expected = [TAU * r.sinh(), TAU * (r.cosh() - 1.0)];
    check(
        "disc",
        circle_at(&poincare_disc(), [0.3, 0.2], r),
        expected,
        false,
    );
    // Beside the tip of a cone, and around it: what rays sweep behind it overlaps.
    let cone = cone(1.0);
    let off = 2.0 * 2.0_f64.sqrt();
    for (r, overlaps) in [(2.0, false), (2.8, false), (2.9, true), (3.5, true)] {
        let found = circle_at(&cone, [0.3, 2.0], r);
        assert!((r < off) != overlaps);
        check(&format!("cone {r}"), found, [TAU * r, PI * r * r], overlaps);
    }
}

#[test]
fn a_circle_whose_rays_end_says_so() {
    let stop = measure::circle(&plane(), [3.5, 0.0], 1.0).expect("a place");
    let stop = stop.expect_err("an edge");
    assert_eq!(stop.status, Status::LeftDomain);
    assert!(stop.length >= 0.5 && stop.length < 1.0, "{stop:?}");
}

#[test]
fn wavefronts_behind_caustics_have_the_length_of_a_finer_sum() {
    // An ellipsoid's wavefront has four cusps behind the caustic: |m| has kinks.
    let surface = triaxial(1.0, 1.2, 0.8);
    let circle = circle_at(&surface, [0.3, 0.2], 3.4);
    assert_eq!(circle.overlaps, Some(true));
    let options = geodesic::trace::Options {
        conjugates: true,
        ..Default::default()
    };
    let count = 4000;
    let ray = |n: u32| {
        let angle = TAU * f64::from(n) / f64::from(count);
        let frame = geodesic::frame::Frame::new(&surface, [0.3, 0.2], angle, 1.0).expect("a place");
        let trace = frame
            .trace(&surface, [1.0, 0.0], 3.4, &options)
            .expect("a ray");
        trace.jacobi[0].abs()
    };
    let sum: f64 = (0..count).map(ray).sum::<f64>() * TAU / f64::from(count);
    near("circumference", circle.circumference, sum, 1e-6);
    assert!(circle.circumference_error < 1e-7, "{circle:?}");
}

#[track_caller]
fn between(
    surface: &dyn Surface,
    from: [f64; 2],
    to: [f64; 2],
    within: Option<f64>,
) -> Connections {
    measure::between(surface, from, to, within).expect("two places")
}

/// Each geodesic, followed by its direction, ends at the target.
#[track_caller]
fn arrives(surface: &dyn Surface, connections: &Connections, to: [f64; 2], bound: f64) {
    for it in &connections.found {
        let options = geodesic::trace::Options::default();
        let end = geodesic::trace::trace(surface, it.from, it.direction, it.length, &options);
        let end = end.expect("a start");
        let target = surface.jet(to.into()).position;
        let off = match end.position {
            Some(position) => (0..3)
                .map(|k| (position[k] - target[k]).powi(2))
                .sum::<f64>()
                .sqrt(),
            None => {
                let domain = surface.domain();
                let gap = |k: usize| {
                    let width = domain[k][1] - domain[k][0];
                    let off = end.uv[k] - to[k];
                    if surface.sides().of(k)[0] == geodesic::surface::Side::Wrap {
                        off - width * (off / width).round()
                    } else {
                        off
                    }
                };
                gap(0).hypot(gap(1))
            }
        };
        assert!(off <= bound, "{it:?} ends {off:e} off");
        let speed = geodesic::metric::speed(&surface.jet(it.from), it.direction);
        near("speed", speed, 1.0, 1e-12);
    }
}

fn lengths(connections: &Connections) -> Vec<f64> {
    connections.found.iter().map(|it| it.length).collect()
}

#[track_caller]
fn same_lengths(what: &str, found: &Connections, expected: &[f64], bound: f64) {
    let lengths = lengths(found);
    assert_eq!(
        lengths.len(),
        expected.len(),
        "{what}: {lengths:?} are not {expected:?}"
    );
    for (found, expected) in lengths.iter().zip(expected) {
        near(what, *found, *expected, bound);
    }
}

#[test]
fn two_places_of_a_sphere_have_the_two_arcs_of_a_great_circle() {
    let sphere = spheroid(1.0, 1.0);
    let mut random = Random(7);
    for n in 0..40 {
        let place = |random: &mut Random| {
            [
                random.between(0.0, TAU),
                random.between(-1.0, 1.0_f64).asin(),
            ]
        };
        let (p, q) = (place(&mut random), place(&mut random));
        let [a, b] = [p, q].map(|uv| sphere.jet(uv.into()).position);
        let dot: f64 = (0..3).map(|k| a[k] * b[k]).sum();
        let angle = dot.clamp(-1.0, 1.0).acos();
        let found = between(&sphere, p, q, Some(TAU));
        same_lengths(&format!("sphere {n}"), &found, &[angle, TAU - angle], 2e-9);
        assert!(found.complete);
        arrives(&sphere, &found, q, 1e-8);
    }
}

#[test]
fn conjugate_places_have_one_member_of_their_family() {
    let sphere = spheroid(1.0, 1.0);
    for (p, q) in [
        ([0.3, 0.2], [0.3 + PI, -0.2]),
        ([1.0, PI / 2.0], [0.0, -PI / 2.0]),
    ] {
        let found = between(&sphere, p, q, None);
        same_lengths("opposite", &found, &[PI], 1e-8);
        assert!(found.found[0].conjugate);
    }
    let found = between(&sphere, [0.3, 0.2], [0.3 + PI, -0.2], Some(10.0));
    same_lengths("opposite", &found, &[PI, 3.0 * PI], 1e-8);
    // A hair beside the opposite place there are two.
    for off in [1e-2, 1e-4, 1e-6] {
        let found = between(&sphere, [0.3, 0.2], [0.3 + PI, -0.2 + off], Some(4.0));
        same_lengths("beside", &found, &[PI - off, PI + off], 1e-8);
        assert!(
            found.found.iter().all(|it| !it.conjugate),
            "{off}: {found:?}"
        );
    }
    let zoll = zoll();
    let found = between(&zoll, [1.0, 1.0], [1.0, 1.0], Some(7.0));
    same_lengths("Zoll", &found, &[TAU], 1e-8);
    assert!(found.found[0].conjugate);
}

#[test]
fn a_flat_torus_has_a_geodesic_for_each_vector_of_its_lattice() {
    let (a, b) = (1.0, 1.3);
    let torus = flat_torus(a, b);
    for (p, q, within) in [
        ([0.2, 0.3], [0.7, 0.5], 3.0),
        ([0.9, 1.2], [0.1, 0.1], 2.5),
        ([0.5, 0.5], [0.5, 0.5], 2.2),
    ] {
        let mut expected: Vec<f64> = Vec::new();
        for i in -6..=6_i32 {
            for j in -6..=6_i32 {
                let way = [
                    q[0] - p[0] + a * f64::from(i),
                    q[1] - p[1] + b * f64::from(j),
                ];
                expected.push(way[0].hypot(way[1]));
            }
        }
        expected.retain(|length| *length > 0.0 && *length <= within);
        expected.sort_by(f64::total_cmp);
        expected.truncate(measure::MOST_CONNECTIONS);
        let found = between(&torus, p, q, Some(within));
        same_lengths(&format!("{p:?} {q:?}"), &found, &expected, 1e-9);
        assert!(found.complete);
        arrives(&torus, &found, q, 1e-9);
    }
}

#[test]
fn a_cylinder_is_wound_around_both_ways() {
    let found = between(&cylinder(), [1.0, 0.0], [2.0, 3.0], Some(30.0));
    let mut expected: Vec<f64> = (-5..=5_i32)
        .map(|n| (2.0 * (1.0 + TAU * f64::from(n))).hypot(3.0))
        .filter(|length| *length <= 30.0)
        .collect();
    expected.sort_by(f64::total_cmp);
    same_lengths("cylinder", &found, &expected, 1e-8);
}

#[test]
fn the_hyperbolic_plane_has_one_geodesic_of_the_known_length() {
    let half = half_plane();
    for (p, q) in [
        ([0.0, 1.0], [0.0, 5.0]),
        ([-5.0, 0.1], [5.0, 0.1]),
        ([0.3, 2.0], [4.0, 0.5]),
    ] {
        let square = f64::powi(q[0] - p[0], 2) + f64::powi(q[1] - p[1], 2);
        let expected = (1.0 + square / (2.0 * p[1] * q[1])).acosh();
        let found = between(&half, p, q, None);
        same_lengths(&format!("{p:?} {q:?}"), &found, &[expected], 1e-8);
        arrives(&half, &found, q, 1e-6);
    }
    let disc = poincare_disc();
    let (p, q) = ([0.5, 0.3], [-0.6, 0.5_f64]);
    let square = |[x, y]: [f64; 2]| x * x + y * y;
    let delta = 2.0 * square([p[0] - q[0], p[1] - q[1]]) / (1.0 - square(p)) / (1.0 - square(q));
    let found = between(&disc, p, q, None);
    same_lengths("disc", &found, &[(1.0 + delta).acosh()], 1e-8);
    // Across the pole of polar coordinates.
    let polar = hyperbolic_polar();
    for turn in [0.5, 3.0, PI] {
        let (r, s) = (1.5_f64, 0.7_f64);
        let expected = (r.cosh() * s.cosh() - r.sinh() * s.sinh() * f64::cos(turn)).acosh();
        let found = between(&polar, [r, 6.0], [s, 6.0 + turn - TAU], None);
        same_lengths("polar", &found, &[expected], 1e-8);
    }
}

#[test]
fn a_cone_has_a_straight_line_on_each_side_of_its_tip() {
    let cone = cone(1.0);
    // Unrolled, an angle is 1/√2 of itself.
    let stretch = 2.0_f64.sqrt();
    for turn in [0.5, 2.0, PI, 4.0] {
        let (r, s) = (2.0 * stretch, 1.5 * stretch);
        let mut expected: Vec<f64> = [turn, TAU - turn]
            .into_iter()
            .map(|turn| turn / stretch)
            .filter(|angle| *angle < PI)
            .map(|angle: f64| (r * r + s * s - 2.0 * r * s * angle.cos()).sqrt())
            .collect();
        expected.sort_by(f64::total_cmp);
        let found = between(&cone, [1.0, 2.0], [1.0 + turn, 1.5], Some(20.0));
        same_lengths(&format!("cone {turn}"), &found, &expected, 1e-8);
        arrives(&cone, &found, [1.0 + turn, 1.5], 1e-8);
    }
    let to_tip = between(&cone, [1.0, 2.0], [0.0, 0.0], None);
    same_lengths("to the tip", &to_tip, &[2.0 * stretch], 1e-8);
}

#[test]
fn a_torus_has_its_equators_and_loops() {
    let torus = torus(0.4);
    // Loops at a place of the outer equator: around the tube, and along the equator.
    let found = between(&torus, [0.0, 0.0], [0.0, 0.0], Some(2.6));
    near("around the tube", found.found[0].length, 0.8 * PI, 1e-9);
    let found = between(&torus, [0.0, PI], [1.0, PI], None);
    near("inner equator", found.found[0].length, 0.6, 1e-9);
    near("direction", found.found[0].direction[1], 0.0, 1e-9);
    arrives(&torus, &found, [1.0, PI], 1e-7);
}

#[test]
fn the_other_way_round_lengths_are_the_same() {
    let mut random = Random(11);
    for n in 0..12 {
        let waves: Vec<[f64; 3]> = (0..3)
            .map(|_| {
                [
                    random.between(0.05, 0.3),
                    random.between(-2.0, 2.0),
                    random.between(-2.0, 2.0),
                ]
            })
            .collect();
        let surface = waves_over_plane(&waves, false, 50.0);
        let place = |random: &mut Random| [random.between(-2.0, 2.0), random.between(-2.0, 2.0)];
        let (p, q) = (place(&mut random), place(&mut random));
        let there = between(&surface, p, q, None);
        let back = between(&surface, q, p, None);
        assert!(!there.found.is_empty(), "{n}");
        same_lengths(&format!("{n}: {waves:?}"), &there, &lengths(&back), 1e-8);
        arrives(&surface, &there, q, 1e-7);
    }
}

#[test]
fn places_that_are_near_each_other_are_joined_as_others_are() {
    let surfaces: [(&str, Box<dyn Surface>, [f64; 2]); 3] = [
        ("a sphere", Box::new(spheroid(1.0, 1.0)), [1.0, 0.3]),
        ("a torus", Box::new(torus(0.4)), [0.5, 1.0]),
        ("a half-plane", Box::new(half_plane()), [0.5, 1.0]),
    ];
    for (name, s, from) in &surfaces {
        for apart in [1e-3, 1e-6, 1e-8, 1e-10, 1e-12] {
            // What the numbers are apart after rounding.
            let to = [from[0], from[1] + apart];
            let apart = to[1] - from[1];
            let jet = s.jet((*from).into());
            let speed = jet.dv.iter().map(|x| x * x).sum::<f64>().sqrt();
            let all = measure::between(s.as_ref(), *from, to, Some(2.0 * speed * apart));
            let all = all.expect("places");
            let [one] = all.found[..] else {
                panic!("{name}, {apart}: {all:?}");
            };
            let expected = speed * apart;
            let off = (one.length - expected).abs() / expected;
            assert!(
                off < 1e-3 + 1e-15 / apart,
                "{name}, {apart}: {}",
                one.length
            );
            assert!(!one.conjugate, "{name}, {apart}");
            let m = (one.m / one.length - 1.0).abs();
            assert!(m < 1e-3 + 1e-15 / apart, "{name}, {apart}: {}", one.m);
        }
    }
}

#[test]
fn a_triangle_with_two_equal_corners_lacks_a_side() {
    let s = spheroid(1.0, 1.0);
    let triangle = measure::triangle(&s, [[1.0, 0.3], [1.0, 0.3], [1.5, 0.5]]);
    let triangle = triangle.expect("places");
    let known = triangle.sides.iter().filter(|side| side.is_some()).count();
    assert_eq!(known, 2, "{:?}", triangle.sides);
}

#[test]
fn a_place_with_two_names_is_one_place() {
    let torus = torus(0.4);
    let strip = moebius(0.0);
    let sphere = spheroid(1.0, 1.0);
    let glued = flat_torus(1.0, 1.0);
    let pole = 0.5 * PI;
    let cases: [(&dyn Surface, [f64; 2], [f64; 2]); 7] = [
        (&torus, [0.0, 1.0], [TAU, 1.0]),
        (&torus, [0.3, 0.0], [0.3, TAU]),
        (&torus, [0.0, 0.0], [TAU, TAU]),
        (&strip, [0.0, 0.3], [TAU, -0.3]),
        (&glued, [0.0, 0.25], [1.0, 0.25]),
        (&sphere, [0.0, pole], [1.0, pole]),
        (&sphere, [0.5, -pole], [4.0, -pole]),
    ];
    for (n, (surface, a, b)) in cases.into_iter().enumerate() {
        assert!(measure::is_one_place(surface, a, b), "{n}");
        assert!(measure::is_one_place(surface, b, a), "{n}");
        let loops = measure::between(surface, a, a, None).expect("places");
        let named = measure::between(surface, a, b, None).expect("places");
        assert_eq!(lengths(&named), lengths(&loops), "{n}");
        assert!(!loops.found.is_empty(), "{n}");
        arrives(surface, &named, b, 1e-6);
        assert!(lengths(&loops).iter().all(|it| *it > 0.1), "{n}: {loops:?}");
    }
    let others: [(&dyn Surface, [f64; 2], [f64; 2]); 4] = [
        (&torus, [0.0, 1.0], [TAU - 1e-9, 1.0]),
        (&strip, [0.0, 0.3], [TAU, 0.3]),
        (&sphere, [0.0, pole], [1.0, -pole]),
        (&sphere, [0.0, pole], [0.0, pole - 1e-9]),
    ];
    for (n, (surface, a, b)) in others.into_iter().enumerate() {
        assert!(!measure::is_one_place(surface, a, b), "{n}");
    }
}

#[test]
fn the_shortest_step_passes_sides_that_are_glued() {
    let check = |surface: &dyn Surface, from: [f64; 2], to: [f64; 2], expected: [f64; 2]| {
        let step = measure::shortest_step(surface, from, to);
        let is_near = |k: usize| (step[k] - expected[k]).abs() < 1e-12;
        assert!((0..2).all(is_near), "{step:?}");
    };
    let (torus, strip) = (torus(0.4), moebius(0.0));
    check(&torus, [0.01, 1.0], [TAU - 0.01, 1.1], [-0.02, 0.1]);
    check(&torus, [1.0, 2.0], [1.5, 2.25], [0.5, 0.25]);
    check(&strip, [TAU - 0.01, 0.2], [0.01, -0.21], [0.02, 0.01]);
    check(&strip, [0.01, -0.21], [TAU - 0.01, 0.2], [-0.02, 0.01]);
}

/// The length of the shortest path along the lines of a grid of places, between two of them: no less than the distance, and
/// little more.
fn grid_distances(surface: &dyn Surface, cells: usize, from: [usize; 2]) -> Vec<f64> {
    const REACH: isize = 3;
    const PARTS: u32 = 3;
    let domain = surface.domain();
    let n = cells + 1;
    let place = |at: [f64; 2]| {
        [0, 1].map(|k| domain[k][0] + (domain[k][1] - domain[k][0]) * at[k] / cells as f64)
    };
    let mut best = vec![f64::INFINITY; n * n];
    let mut done = vec![false; n * n];
    best[from[0] * n + from[1]] = 0.0;
    let mut queue = std::collections::BinaryHeap::new();
    queue.push((std::cmp::Reverse(0), from));
    while let Some((_, at)) = queue.pop() {
        if std::mem::replace(&mut done[at[0] * n + at[1]], true) {
            continue;
        }
        for i in -REACH..=REACH {
            for j in -REACH..=REACH {
                let to = [at[0].checked_add_signed(i), at[1].checked_add_signed(j)];
                let [Some(a), Some(b)] = to else { continue };
                if a >= n || b >= n || (i, j) == (0, 0) || done[a * n + b] {
                    continue;
                }
                let here = place(at.map(|x| x as f64));
                let there = place([a as f64, b as f64]);
                let way = [there[0] - here[0], there[1] - here[1]];
                let length = |k: u32| {
                    let share = (f64::from(k) + 0.5) / f64::from(PARTS);
                    let at = [here[0] + share * way[0], here[1] + share * way[1]];
                    geodesic::metric::speed(&surface.jet(at.into()), TangentVector(way))
                };
                let length: f64 = (0..PARTS).map(length).sum::<f64>() / f64::from(PARTS);
                let total = best[at[0] * n + at[1]] + length;
                if total < best[a * n + b] {
                    best[a * n + b] = total;
                    queue.push((std::cmp::Reverse(total.to_bits()), [a, b]));
                }
            }
        }
    }
    best
}

#[test]
fn the_shortest_is_no_longer_than_paths_on_a_grid() {
    const CELLS: usize = 60;
    let mut random = Random(5);
    let mut unsure = 0;
    for amplitude in [0.05, 0.1, 0.15, 0.25] {
        // sin 4u cos 4v, up to half as high as its waves are long: with curvatures up to 64, geodesics are chaotic.
        let waves = [4.0, -4.0].map(|other| [amplitude, 4.0, other]);
        let surface = waves_over_plane(&waves, false, 2.0);
        let node = |random: &mut Random| [0, 1].map(|_| 6 + (random.unit() * 48.0) as usize);
        let place = |at: [usize; 2]| at.map(|k| 4.0 * (k as f64 / CELLS as f64) - 2.0);
        let start = node(&mut random);
        let grid = grid_distances(&surface, CELLS, start);
        for _ in 0..6 {
            let end = node(&mut random);
            let along = grid[end[0] * (CELLS + 1) + end[1]];
            for (p, q) in [(start, end), (end, start)] {
                let all = between(&surface, place(p), place(q), None);
                let first = all.found.first().map_or(f64::INFINITY, |it| it.length);
                assert!(
                    !all.complete || first <= along,
                    "{amplitude}: {first} from {p:?} to {q:?}, where a path is {along} long"
                );
                unsure += usize::from(first > along);
            }
        }
    }
    assert!(unsure <= 4, "{unsure} of 48 are not known");
}

#[test]
fn a_search_whose_rays_take_too_much_work_does_not_say_that_there_is_nothing() {
    // Two hundred waves a unit: each ray is given up long before its end.
    let waves = [200.0, -200.0].map(|other| [0.01, 200.0, other]);
    let surface = waves_over_plane(&waves, false, 5.0);
    let found = between(&surface, [0.1, 0.2], [4.0, -4.1], None);
    assert!(!found.complete, "{found:?}");
}

#[test]
fn the_corners_of_a_domain_are_reached() {
    let flat = waves_over_plane(&[], false, 1.0);
    let mut places = vec![
        [1.0, 1.0],
        [-1.0, 1.0],
        [1.0, -1.0],
        [0.0, 1.0],
        [-1.0, 0.3],
    ];
    places.extend([[0.999999, 0.999999], [1.0, 0.9981332886798686], [0.0, 0.0]]);
    let mut random = Random(11);
    places.extend((0..20).map(|_| [0, 1].map(|_| 2.0 * random.unit() - 1.0)));
    let saddle = {
        let mut m = Maker::new();
        let (u, v) = (m.u, m.v);
        let [uu, vv] = [u, v].map(|x| m.mul(x, x));
        let vv = m.scale(-1.0, vv);
        let z = m.add(uu, vv);
        m.done([u, v, z], [[-1.0, 1.0]; 2])
    };
    let first = |surface: &dyn Surface, from, to| {
        let all = between(surface, from, to, None);
        all.found.first().map(|it| it.length)
    };
    let mut missed = Vec::new();
    for (n, &from) in places.iter().enumerate() {
        for &to in &places[..n.min(8)] {
            let straight = (to[0] - from[0]).hypot(to[1] - from[1]);
            for (from, to) in [(from, to), (to, from)] {
                match first(&flat, from, to) {
                    Some(length) => near("distance", length, straight, 1e-9),
                    None => missed.push((from, to)),
                }
            }
            let ways = [first(&saddle, from, to), first(&saddle, to, from)];
            match ways {
                [Some(one), Some(other)] => near("the way back", one, other, 1e-9),
                _ => missed.push((from, to)),
            }
        }
    }
    assert!(missed.is_empty(), "{} missed: {missed:?}", missed.len());
}

/// v(cos u, sin u, slope), v ∈ [0, 2].
fn short_cone(slope: f64) -> ParametricSurface {
    let mut m = Maker::new();
    let z = m.scale(slope, m.v);
    let (u, v) = (m.u, m.v);
    let p = m.around(v, u, z);
    m.done(p, [[0.0, TAU], [0.0, 2.0]])
}

#[test]
fn a_flat_cone_has_a_tip_with_a_geodesic_on_either_side() {
    for slope in [0.005, 0.02, 0.1_f64] {
        let s = short_cone(slope);
        let tip = measure::place(&s, [0.0, 0.0]).expect("a place");
        assert_eq!((tip.gaussian, tip.mean), (None, None), "{slope}: {tip:?}");
        let slant = slope.hypot(1.0);
        let end = trace(&s, [0.3, 1.0], [0.0, -1.0], 1.5, &Options::default()).expect("a start");
        assert_eq!(end.status, Status::ConePoint, "{slope}: {end:?}");
        near("to the tip", end.length, slant, 1e-12);
        // Unrolled, the cone is a sector of 2π/slant.
        let expected = 2.0 * slant * (PI / (2.0 * slant)).sin();
        let all = measure::between(&s, [0.0, 1.0], [PI, 1.0], None).expect("places");
        assert_eq!(all.found.len(), 2, "{slope}: {all:?}");
        for it in &all.found {
            near("around the tip", it.length, expected, 1e-9);
        }
        let aside = [0, 1].map(|k| all.found[k].direction[0]);
        near("mirrored", aside[0], -aside[1], 1e-6);
    }
}

/// du² + 2F du dv + G dv² on the unit square, whose sides are glued.
fn skewed_torus(f: f64, g: f64) -> MetricSurface {
    metric([[0.0, 1.0], [0.0, 1.0]], |m| [1.0, f, g].map(|x| m.c(x)))
}

#[test]
fn on_a_skewed_torus_the_distance_is_that_of_the_nearest_copy() {
    let mut random = Random(44);
    for (f, g) in [
        (20.3, 412.5),
        (50.4, 2541.0),
        (100.5, 10101.0),
        (9.9, 100.0),
        (-9.9, 100.0),
    ] {
        let s = skewed_torus(f, g);
        let mut pairs = vec![
            [[0.707, 0.738], [0.022, 0.061]],
            [[0.259, 0.234], [0.996, 0.47]],
        ];
        let mut place = || [random.unit(), random.unit()];
        pairs.extend((0..4).map(|_| [place(), place()]));
        for [from, to] in pairs {
            let way = [to[0] - from[0], to[1] - from[1]];
            let length = |i: i32, j: i32| {
                let [x, y] = [way[0] + f64::from(i), way[1] + f64::from(j)];
                (x * x + 2.0 * f * x * y + g * y * y).sqrt()
            };
            let lattice = (-700..=700).flat_map(|i| (-6..=6).map(move |j| (i, j)));
            let mut lengths: Vec<f64> = lattice.map(|(i, j)| length(i, j)).collect();
            lengths.sort_by(f64::total_cmp);
            let what = format!("({f}, {g}) {from:?} {to:?}");
            let shortest = measure::distance(&s, from, to).expect("places");
            let shortest = shortest.unwrap_or_else(|| panic!("{what}: none")).length;
            near(&what, shortest, lengths[0], 1e-8);
            let all = measure::between(&s, from, to, None).expect("places");
            near(&what, all.within, 2.0 * lengths[0], 1e-7);
            assert!(all.complete, "{what}: {all:?}");
            let within = lengths.iter().filter(|it| **it <= all.within);
            let expected: Vec<f64> = within.copied().collect();
            assert_eq!(
                all.found.len(),
                expected.len(),
                "{what}: {all:?} {expected:?}"
            );
            for (it, expected) in all.found.iter().zip(expected) {
                near(&what, it.length, expected, 1e-8);
            }
        }
    }
}

#[test]
fn curvatures_of_extreme_sizes_are_exact() {
    for size in [1e-160, 1e-150, 1.0, 1e150, 1e160] {
        let found = measure::place(&sphere_in_units(1.0, size, 0.0), [1.0, 0.3]).expect("a place");
        let mean = found.mean.expect("a mean curvature");
        near(&format!("{size:e}"), mean * size, -1.0, 1e-12);
        let area = found.form[0] * found.form[2];
        assert!(area.is_nan() || found.form[1] == 0.0, "{size:e}: {found:?}");
    }
}

#[test]
fn distances_of_extreme_sizes_are_found() {
    let sphere = |size: f64| sphere_in_units(1.0, size, 0.0);
    let [from, to] = [[0.3, 0.2], [1.0, -0.4_f64]];
    let turn: f64 = to[0] - from[0];
    let cosine = from[1].sin() * to[1].sin() + from[1].cos() * to[1].cos() * turn.cos();
    let expected = cosine.acos();
    for size in [1e-150, 1e-100, 1e-30, 1.0, 1e30, 1e100, 1e150] {
        let all = measure::between(&sphere(size), from, to, Some(4.0 * size)).expect("places");
        assert_eq!(all.found.len(), 1, "{size:e}: {all:?}");
        near(
            "the shorter arc",
            all.found[0].length / size,
            expected,
            1e-9,
        );
        let metric = metric([[-PI, PI], [-1.0, 1.0]], |m| {
            let cos = m.f(expr::ops::Unary::Cos, m.v);
            let square = m.mul(cos, cos);
            let unit = m.c(size);
            [m.mul(unit, square), m.c(0.0), unit]
        });
        let found = measure::distance(&metric, from, to).expect("places");
        let found = found.unwrap_or_else(|| panic!("{size:e}: none")).length;
        near("by the metric", found / size.sqrt(), expected, 1e-9);
    }
}

#[test]
fn the_distance_is_the_same_from_both_places() {
    // 2 sin 2x cos 2y: from one of the places the search misses the shortest, or all.
    let wavy = waves_over_plane(&[[1.0, 2.0, 2.0], [1.0, 2.0, -2.0]], false, 3.0);
    for (a, b, expected) in [
        ([1.22, 0.02], [-0.89, 1.55], 4.458_902_119_87),
        ([1.75, -0.84], [-1.13, 0.11], 4.051_073_667_22),
    ] {
        for (from, to) in [(a, b), (b, a)] {
            let what = format!("{from:?} {to:?}");
            let found = measure::distance(&wavy, from, to).expect("places");
            let length = found.unwrap_or_else(|| panic!("{what}: none")).length;
            near(&what, length, expected, 1e-8);
        }
    }
}

#[test]
fn a_crease_has_no_tangent_plane() {
    let s = roof(1.0);
    let found = measure::place(&s, [0.0, 0.3]);
    assert_eq!(found, Err(MeasureError::Crease { at: [0.0, 0.3] }));
    let beside = measure::place(&s, [1e-3, 0.3]).expect("a place");
    assert_eq!(beside.form, [2.0, 0.0, 1.0]);
    // Beside the tip of a cone, and where a hyperboloid bends within a billionth of its domain, there is none.
    for (half, height, at) in [(2.0, 0.0, 1e-9), (1e6, 1e-8, 0.0)] {
        let mut m = Maker::new();
        let (u, v) = (m.u, m.v);
        let (uu, vv) = (m.mul(u, u), m.mul(v, v));
        let sum = m.add(uu, vv);
        let sum = m.plus(height, sum);
        let z = m.f(expr::ops::Unary::Sqrt, sum);
        let hyperboloid = m.done([u, v, z], [[-half, half]; 2]);
        assert!(measure::place(&hyperboloid, [at, 0.0]).is_ok(), "{half}");
    }
    // At a cone's tip σu and σv are undefined, but the place is defined.
    let mut m = Maker::new();
    let (u, v) = (m.u, m.v);
    let (uu, vv) = (m.mul(u, u), m.mul(v, v));
    let sum = m.add(uu, vv);
    let z = m.f(expr::ops::Unary::Sqrt, sum);
    let cone = m.done([u, v, z], [[-2.0, 2.0]; 2]);
    let found = measure::place(&cone, [0.0, 0.0]);
    assert_eq!(found, Err(MeasureError::Degenerate { at: [0.0, 0.0] }));
}

#[test]
fn where_the_curvature_jumps_there_is_none() {
    let mut m = Maker::new();
    let (u, v) = (m.u, m.v);
    let abs = m.f(expr::ops::Unary::Abs, u);
    let z = m.mul(u, abs);
    let surface = m.done([u, v, z], [[-2.0, 2.0]; 2]);
    let found = measure::place(&surface, [0.0, 0.5]).expect("a tangent plane");
    assert_eq!(
        (found.gaussian, found.mean, found.principal),
        (None, None, None)
    );
    let beside = measure::place(&surface, [0.25, 0.5]).expect("a place");
    let expected = 1.0 / 1.25_f64.powf(1.5);
    near("H", beside.mean.expect("H"), expected, 1e-12);
    // A plane has no jump, however its rounding goes.
    let plane = measure::place(&roof(0.3), [1.7, -0.2]).expect("a place");
    assert_eq!((plane.gaussian, plane.mean), (Some(0.0), Some(0.0)));
}

#[test]
fn the_smaller_principal_curvature_keeps_its_digits() {
    // The pseudosphere: 1/sinh v and −sinh v.
    let mut m = Maker::new();
    let (u, v) = (m.u, m.v);
    let cosh = m.f(expr::ops::Unary::Cosh, v);
    let one = m.c(1.0);
    let radius = m.g.div(one, cosh);
    let tanh = m.f(expr::ops::Unary::Tanh, v);
    let z = m.g.sub(v, tanh);
    let position = m.around(radius, u, z);
    let surface = m.done(position, [[0.0, TAU], [0.0, 20.0]]);
    for v in [3.0, 15.0, 18.0_f64] {
        let found = measure::place(&surface, [1.0, v]).expect("a place");
        let mut curvatures = found.principal.expect("no umbilic").map(|it| it.curvature);
        curvatures.sort_by(f64::total_cmp);
        let expected = [-v.sinh(), 1.0 / v.sinh()];
        for (found, expected) in curvatures.into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-9, "{v}: {found}");
        }
    }
}

#[test]
fn at_a_pole_rounding_is_left_out() {
    let pole = measure::place(&triaxial(1.0, 2.0, 3.0), [0.0, PI / 2.0]).expect("a pole");
    assert_eq!(
        (pole.form[0], pole.form[1], pole.principal),
        (0.0, 0.0, None),
        "{pole:?}"
    );
    let round = metric([[0.0, PI], [0.0, TAU]], |m| {
        let sin = m.f(expr::ops::Unary::Sin, m.u);
        [m.c(1.0), m.c(0.0), m.mul(sin, sin)]
    });
    let found = measure::distance(&round, [0.0, 0.0], [1.0, 2.0]).expect("places");
    let found = found.expect("a meridian");
    near("length", found.length, 1.0, 1e-9);
    assert_eq!((found.from[0], found.direction[1]), (0.0, 0.0), "{found:?}");
    near("meridian", found.from[1], 2.0, 1e-9);
    near("along it", found.direction[0], 1.0, 1e-12);
}

#[test]
fn circles_of_any_size_are_equally_reliable() {
    let of_size = |size: f64| {
        let surface = triaxial(size, 1.3 * size, 0.7 * size);
        circle_at(&surface, [1.0, 0.3], 0.5 * size)
    };
    let usual = of_size(1.0);
    for size in [1e-12, 1e-6, 1e6, 1e12_f64] {
        let found = of_size(size);
        near(
            "length",
            found.circumference / size / usual.circumference,
            1.0,
            1e-9,
        );
        near("area", found.area / size / size / usual.area, 1.0, 1e-9);
        assert!(
            found.circumference_error <= 1e-8 * found.circumference,
            "{found:?}"
        );
        assert!(found.area_error <= 1e-8 * found.area, "{found:?}");
    }
}

#[test]
fn triangles_and_circles_of_extreme_sizes_have_their_measures() {
    let corners = [[0.3, 0.4], [2.0, -0.5], [1.5, 1.0]];
    let of_size = |size: f64| {
        let surface = triaxial(size, 1.3 * size, 0.7 * size);
        let triangle = measure::triangle(&surface, corners).expect("three places");
        let circle = circle_at(&surface, [1.0, 0.3], 0.5 * size);
        (triangle.region.expect("a region"), circle)
    };
    let (usual, usual_circle) = of_size(1.0);
    for size in [1e100, 1e-100_f64] {
        let (found, circle) = of_size(size);
        near("∫K", found.curvature, usual.curvature, 1e-8);
        near("area", found.area / size / size / usual.area, 1.0, 1e-8);
        near(
            "length",
            circle.circumference / size / usual_circle.circumference,
            1.0,
            1e-9,
        );
        assert_eq!(circle.overlaps, usual_circle.overlaps);
    }
}
