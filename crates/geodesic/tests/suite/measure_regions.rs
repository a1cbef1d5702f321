//! Triangles against closed forms and Gauss and Bonnet's theorem; walks against what they run around.

use crate::near::near;
use crate::random::Random;
use crate::shapes::*;
use geodesic::frame::Frame;
use geodesic::measure::{self, NoRegion, Triangle, TriangleRegion};
use geodesic::status::Status;
use geodesic::surface::Surface;
use geodesic::trace::Options;

#[track_caller]
fn triangle(surface: &dyn Surface, corners: [[f64; 2]; 3]) -> Triangle {
    measure::triangle(surface, corners).expect("three places")
}

/// Angle excess and the integral of the curvature agree, within the estimate of the latter.
#[track_caller]
fn gauss_bonnet(what: &str, found: &Triangle) -> TriangleRegion {
    let region = found
        .region
        .unwrap_or_else(|error| panic!("{what}: {error}"));
    let excess = found.excess().expect("three angles");
    near(
        &format!("{what}: excess and ∫K"),
        excess,
        region.curvature,
        region.curvature_error,
    );
    assert!(
        region.area_error <= 1e-6 * region.area.max(1.0) && region.curvature_error <= 1e-6,
        "{what}: {region:?}"
    );
    region
}

#[test]
fn triangles_of_a_sphere_have_their_excess_as_area() {
    let sphere = spheroid(1.0, 1.0);
    let octant = triangle(
        &sphere,
        [[0.0, PI / 2.0], [0.3, 0.0], [0.3 + PI / 2.0, 0.0]],
    );
    for k in 0..3 {
        near(
            "side",
            octant.sides[k].expect("a side").length,
            PI / 2.0,
            1e-9,
        );
        near("angle", octant.angles[k].expect("an angle"), PI / 2.0, 1e-9);
    }
    let region = gauss_bonnet("octant", &octant);
    near("area", region.area, PI / 2.0, region.area_error);
    // The order of the corners does not matter.
    let turned = triangle(
        &sphere,
        [[0.3 + PI / 2.0, 0.0], [0.0, PI / 2.0], [0.3, 0.0]],
    );
    let region = gauss_bonnet("octant", &turned);
    near("area", region.area, PI / 2.0, region.area_error);
    let mut random = Random(3);
    for n in 0..12 {
        let mut place = || {
            [
                random.between(0.0, TAU),
                random.between(-0.9, 0.9_f64).asin(),
            ]
        };
        let found = triangle(&sphere, [place(), place(), place()]);
        let region = gauss_bonnet(&format!("sphere {n}"), &found);
        near(
            "area",
            region.area,
            found.excess().expect("angles"),
            region.area_error,
        );
    }
}

#[test]
fn triangles_of_flat_and_hyperbolic_planes_have_known_areas() {
    let found = triangle(&plane(), [[0.0, 0.0], [3.0, 0.0], [0.0, 2.0]]);
    let region = gauss_bonnet("plane", &found);
    near("area", region.area, 3.0, region.area_error);
    near(
        "side",
        found.sides[0].expect("a side").length,
        13.0_f64.sqrt(),
        1e-9,
    );
    let found = triangle(&half_plane(), [[0.0, 1.0], [1.0, 1.0], [0.3, 2.5]]);
    let region = gauss_bonnet("half-plane", &found);
    near("area", region.area, -region.curvature, region.area_error);
    let found = triangle(&poincare_disc(), [[0.1, 0.2], [-0.5, 0.3], [0.4, -0.6]]);
    let region = gauss_bonnet("disc", &found);
    near("area", region.area, -region.curvature, region.area_error);
    // Over the seam of a cylinder.
    let found = triangle(&cylinder(), [[TAU - 0.5, 0.0], [0.5, 0.0], [0.0, 1.0]]);
    let region = gauss_bonnet("cylinder", &found);
    near("area", region.area, 1.0, region.area_error);
}

#[test]
fn errors_of_areas_and_of_curvatures_scale_on_their_own() {
    let corners = [[0.3, 0.4], [2.0, -0.5], [1.5, 1.0]];
    let of_size = |size: f64| {
        let found = triangle(&triaxial(size, 1.3 * size, 0.7 * size), corners);
        gauss_bonnet(&format!("{size:e}"), &found)
    };
    let usual = of_size(1.0);
    for size in [1e-6, 1e6, 6_378_137.0] {
        let found = of_size(size);
        let area = size * size * usual.area;
        near("area", found.area / area, 1.0, 1e-8);
        let share = found.area_error / area / (usual.area_error / usual.area);
        assert!((0.5..2.0).contains(&share), "{found:?}");
        assert!(found.curvature_error < 1e-8, "{found:?}");
    }
}

#[test]
fn a_triangle_around_a_tip_may_have_an_angle_of_more_than_half_a_turn() {
    let cone = cone(3.0);
    let found = triangle(&cone, [[3.76, 1.03], [1.01, 0.82], [5.10, 0.37]]);
    let region = gauss_bonnet("cone", &found);
    near(
        "∫K",
        region.curvature,
        TAU - TAU / 10.0_f64.sqrt(),
        region.curvature_error,
    );
    assert!(found.angles[2].expect("an angle") > PI, "{found:?}");
    // A football: a sphere of which 0.6 of a turn remains.
    let football = metric([[0.0, PI], [0.0, TAU]], |m| {
        let (one, zero) = (m.c(1.0), m.c(0.0));
        let sin = m.f(expr::ops::Unary::Sin, m.u);
        let radius = m.scale(0.6, sin);
        [one, zero, m.mul(radius, radius)]
    });
    let mut random = Random(11);
    let mut reflex = 0;
    for n in 0..40 {
        let mut place = || [random.between(0.1, 3.0), random.between(0.0, TAU)];
        let found = triangle(&football, [place(), place(), place()]);
        if found.region.is_ok() {
            gauss_bonnet(&format!("football {n}"), &found);
            reflex += u32::from(found.angles.iter().flatten().any(|angle| *angle > PI));
        }
    }
    assert!(reflex > 2, "{reflex}");
}

#[test]
fn the_tip_of_a_cone_adds_its_deficit() {
    let cone = cone(1.0);
    let deficit = TAU - TAU / 2.0_f64.sqrt();
    let corners = [[0.0, 1.0], [2.0, 1.2], [4.2, 0.8]];
    let found = triangle(&cone, corners);
    let region = gauss_bonnet("around the tip", &found);
    near("deficit", region.curvature, deficit, region.curvature_error);
    // Unrolled, three triangles about the tip.
    let expected: f64 = (0..3)
        .map(|k| {
            let ([u, r], [w, s]) = (corners[k], corners[(k + 1) % 3]);
            let turn = (w - u).rem_euclid(TAU) / 2.0_f64.sqrt();
            0.5 * 2.0 * r * s * turn.sin()
        })
        .sum();
    near("area", region.area, expected, region.area_error);
    let beside = triangle(&cone, [[0.0, 1.0], [0.5, 1.2], [0.2, 2.0]]);
    let region = gauss_bonnet("beside the tip", &beside);
    near("∫K", region.curvature, 0.0, region.curvature_error);
}

#[test]
fn gauss_and_bonnet_hold_on_ellipsoids_tori_and_graphs() {
    let mut random = Random(5);
    let ellipsoid = triaxial(1.0, 1.3, 0.7);
    for n in 0..8 {
        let mut place = || [random.between(0.0, 2.0), random.between(-0.5, 1.2)];
        let found = triangle(&ellipsoid, [place(), place(), place()]);
        gauss_bonnet(&format!("ellipsoid {n}"), &found);
    }
    let torus = torus(0.4);
    for n in 0..8 {
        let mut place = || [random.between(0.0, 1.0), random.between(-1.2, 1.2)];
        let found = triangle(&torus, [place(), place(), place()]);
        gauss_bonnet(&format!("torus {n}"), &found);
    }
    for n in 0..10 {
        let waves: Vec<[f64; 3]> = (0..3)
            .map(|_| {
                [
                    random.between(0.05, 0.3),
                    random.between(-1.5, 1.5),
                    random.between(-1.5, 1.5),
                ]
            })
            .collect();
        let mut place = || [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
        let corners = [place(), place(), place()];
        let found = triangle(&waves_over_plane(&waves, false, 50.0), corners);
        gauss_bonnet(&format!("waves {n}"), &found);
    }
}

#[test]
fn a_triangle_around_a_handle_has_no_region() {
    // Three sides that go around the tube.
    let third = TAU / 3.0;
    let found = triangle(&torus(0.2), [[0.0, 0.0], [0.0, third], [0.0, 2.0 * third]]);
    assert_eq!(found.region, Err(NoRegion::NotSwept), "{found:?}");
    assert!(found.angles.iter().all(Option::is_some));
    // And around a cylinder.
    let found = triangle(&cylinder(), [[0.0, 0.0], [third, 0.1], [2.0 * third, 0.0]]);
    assert_eq!(found.region, Err(NoRegion::NotSwept), "{found:?}");
}

#[test]
fn a_triangle_whose_corners_are_one_place_says_so() {
    let sphere = spheroid(1.0, 1.0);
    let found = triangle(&sphere, [[0.0, 0.0], [TAU, 0.0], [1.0, 1.0]]);
    assert_eq!(
        found.region,
        Err(NoRegion::OnePlace { corners: [0, 1] }),
        "{found:?}"
    );
}

/// The difference of two angles, but for whole turns.
fn turn_between(a: f64, b: f64) -> f64 {
    let turns = (a - b) / TAU;
    (turns - turns.round()).abs() * TAU
}

#[test]
fn circles_of_latitude_turn_vectors_by_what_they_run_around() {
    let sphere = spheroid(1.0, 1.0);
    for colatitude in [0.1, 0.7, PI / 2.0, 2.0_f64] {
        let latitude = PI / 2.0 - colatitude;
        let curve = |t: f64| ([t, latitude].into(), [1.0, 0.0].into());
        let found = measure::transport(&sphere, &curve, &[0.3, 0.3 + TAU]).expect("a curve");
        near("length", found.length, TAU * colatitude.sin(), 1e-10);
        let expected = TAU * (1.0 - colatitude.cos());
        let off = turn_between(found.angle, expected);
        assert!(
            off <= found.angle_error + 1e-12,
            "{colatitude}: {found:?}, off {off:e}"
        );
        assert!(
            found.length_error.max(found.angle_error) < 1e-9,
            "{found:?}"
        );
    }
    // On a metric: a horocycle of the half-plane, 1/v long for each unit of u, turns by its length.
    let curve = |t: f64| ([t, 2.0].into(), [1.0, 0.0].into());
    let found = measure::transport(&half_plane(), &curve, &[0.0, 3.0]).expect("a curve");
    near("horocycle", found.length, 1.5, 1e-12);
    near("turn", found.angle.abs(), 1.5, 1e-12);
}

#[test]
fn a_walk_around_a_triangle_turns_by_the_curvature_inside() {
    let options = Options {
        tolerance: 1e-12,
        ..Options::default()
    };
    let sphere = spheroid(1.0, 1.0);
    let ellipsoid = triaxial(1.0, 1.3, 0.7);
    let torus = torus(0.4);
    let half = half_plane();
    let cases: [(&dyn Surface, [[f64; 2]; 3]); 5] = [
        (&sphere, [[0.0, 0.0], [1.2, 0.1], [0.5, 1.0]]),
        // Over the seam and around the pole.
        (&sphere, [[0.2, 1.2], [2.3, 1.1], [4.4, 1.25]]),
        (&ellipsoid, [[0.0, 0.0], [1.2, 0.1], [0.5, 1.0]]),
        (&torus, [[0.0, 0.0], [0.9, 0.2], [0.5, 1.1]]),
        (&half, [[0.0, 1.0], [1.0, 1.0], [0.3, 2.5]]),
    ];
    for (n, (surface, corners)) in cases.into_iter().enumerate() {
        let found = triangle(surface, corners);
        let region = gauss_bonnet(&n.to_string(), &found);
        let start = Frame::new(surface, corners[0], 0.4, 1.0).expect("a place");
        let mut camera = start;
        let mut turned = 0.0;
        for k in 0..3 {
            let side = measure::between(surface, corners[k], corners[(k + 1) % 3], None);
            let side = side.expect("two places").found[0];
            // Turned until X lies along the side.
            let metric = camera.metric(surface);
            let [x, y] = [camera.x, camera.y].map(|axis| metric.inner(side.direction, axis));
            let turn = y.atan2(x);
            turned += turn;
            let moved = camera
                .turned(turn)
                .advance(surface, [side.length, 0.0], &options);
            camera = moved.expect("a walk").0;
        }
        let closing = measure::closing(surface, &start, &camera, turned, 1e-6).expect("a start");
        assert!(closing.gap < 1e-8 && !closing.mirrored, "{n}: {closing:?}");
        let holonomy = closing.holonomy.expect("closed");
        let off = turn_between(holonomy.abs(), region.curvature.abs());
        assert!(
            off <= 2.0 * region.curvature_error,
            "{n}: {holonomy} against {region:?}"
        );
    }
}

#[test]
fn a_walk_around_a_moebius_strip_comes_back_mirrored() {
    // du² + (1 + v cos(πu)/5) dv²: the sides u = 0 and u = 1 agree with one of them turned over.
    let strip = metric([[0.0, 1.0], [-1.0, 1.0]], |m| {
        let turn = m.scale(PI, m.u);
        let cos = m.f(expr::ops::Unary::Cos, turn);
        let wave = m.mul(cos, m.v);
        let wave = m.scale(0.2, wave);
        let g = m.plus(1.0, wave);
        let (one, zero) = (m.c(1.0), m.c(0.0));
        [one, zero, g]
    });
    let start = Frame::new(&strip, [0.3, 0.0], 0.0, 1.0).expect("a place");
    // The middle is a geodesic; it closes after one turn.
    let (end, trace) = start
        .advance(&strip, [1.0, 0.0], &Options::default())
        .expect("a walk");
    assert_eq!(trace.status, Status::Complete);
    let closing = measure::closing(&strip, &start, &end, 0.0, 1e-6).expect("a start");
    assert!(closing.gap < 1e-6 && closing.mirrored, "{closing:?}");
    assert_eq!(closing.holonomy, None);
    // And a walk that has not come back is not closed.
    let (end, _) = start
        .advance(&strip, [0.3, 0.0], &Options::default())
        .expect("a walk");
    let closing = measure::closing(&strip, &start, &end, 0.0, 1e-6).expect("a start");
    assert!(
        closing.gap > 0.2 && closing.holonomy.is_none(),
        "{closing:?}"
    );
}
