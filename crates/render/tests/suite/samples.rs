//! Samples and bounds against closed forms.

use crate::scenes::scene;
use glam::Vec3;
use render::bounds::Bounds;
use render::camera::Camera;
use render::placement::Placement;
use render::point::{PixelPoint, WorldPoint};
use render::sample::{PositionSample, Samples, sample};
use render::viewpoint::Viewpoint;
use scene::ObjectId;
use scene::ParamValues;

fn samples(source: &str) -> (Bounds, Samples) {
    let scene = scene(source);
    let params = ParamValues::initial(&scene);
    let bounds = Bounds::of(&scene, &params);
    let last = ObjectId::new(scene.objects.len() - 1);
    let samples = sample(&scene, &params, last, &bounds.placement);
    (bounds, samples)
}

#[test]
fn a_sphere_has_its_own_places_as_normals_even_at_the_poles() {
    let (bounds, samples) = samples(
        "surface s(u,v) = (2,3,5) + (sin(piv)cos(2piu), sin(piv)sin(2piu), cos(piv)), u : [0,1], v : [0,1];",
    );
    let Samples::Surfaces { count, samples } = samples else {
        panic!("a surface")
    };
    assert_eq!(count, [100, 100]);
    for (index, sample) in samples.iter().enumerate() {
        let local = Vec3::from(sample.position) * bounds.placement.radius as f32;
        let centre =
            Vec3::new(2.0, 3.0, 5.0) - glam::DVec3::from(bounds.placement.centre).as_vec3();
        // σu × σv points inwards here.
        let expected = -(local - centre);
        assert!((expected.length() - 1.0).abs() < 1e-5);
        let off = (Vec3::from(sample.normal) - expected).length();
        assert!(
            off < 5e-4,
            "normal {:?} of sample {index} is off by {off}",
            sample.normal
        );
    }
}

#[test]
fn samples_run_instance_by_instance_u_fastest_with_both_ends() {
    let (bounds, samples) =
        samples("grid k : [0, 10, 2]; surface s(u,v) = (u, v, k), u : [0,2,3], v : [0,3,4];");
    let Samples::Surfaces { count, samples } = samples else {
        panic!("a surface")
    };
    assert_eq!(count, [3, 4]);
    assert_eq!(samples.len(), 24);
    for (index, sample) in samples.iter().enumerate() {
        let (i, j, k) = (index % 3, index / 3 % 4, index / 12);
        let expected = bounds
            .placement
            .local(WorldPoint([i as f64, j as f64, 10.0 * k as f64]))
            .0
            .map(|x| x as f32);
        assert_eq!(sample.position, expected);
    }
}

#[test]
fn vectors_are_one_sample_per_combination_of_grid_values() {
    let (_, samples) = samples("grid g : [0,1,30],[0,1,20]; vector v = (1,0,0) @ (g_1,g_2,0);");
    let Samples::Vectors(samples) = samples else {
        panic!("vectors")
    };
    assert_eq!(samples.len(), 600);
    assert!(samples.iter().all(|sample| sample.defined == 1.0));
}

#[test]
fn bounds_are_those_of_the_defined_and_leave_outliers_out() {
    let scene = scene("curve c(t) = (t, 1/t, sqrt(t + 1/2)), t : [-1, 1, 2001];");
    let bounds = Bounds::of(&scene, &ParamValues::initial(&scene));
    assert!(bounds.placement.radius < 1000.0, "{:?}", bounds.placement);
    assert!(bounds.cloud.iter().flatten().all(|x| x.abs() <= 1.0 + 1e-9));
}

#[test]
fn a_distant_scene_keeps_its_digits() {
    let (_, samples) = samples("curve c(t) = (10^9 + t, 0, 0), t : [0, 1, 5];");
    let Samples::Curves { samples, .. } = samples else {
        panic!("a curve")
    };
    let places: Vec<f32> = samples.iter().map(|sample| sample.position[0]).collect();
    for (place, expected) in places.iter().zip([-1.0, -0.5, 0.0, 0.5, 1.0]) {
        assert!((place - expected).abs() < 1e-6, "{places:?}");
    }
}

/// The box of a scene in its units: its lower and its upper corner.
fn corners(bounds: &Bounds) -> [[f64; 3]; 2] {
    let Placement { centre, radius } = bounds.placement;
    [-1.0, 1.0].map(|side| [0, 1, 2].map(|k| centre[k] + side * bounds.half[k] * radius))
}

#[test]
fn the_box_contains_each_branch_of_an_object_with_poles() {
    // The places at the ends of the branches, and the size of the box across the pole.
    let cases = [
        (
            "curve c(x) = (x, 1/(x - 1), 0), x : [-2, 2];",
            1,
            vec![[-2.0, -1.0 / 3.0, 0.0], [2.0, 1.0, 0.0]],
        ),
        (
            "curve c(x) = (x, 1/x, 0), x : [-1, 2];",
            1,
            vec![[-1.0, -1.0, 0.0], [2.0, 0.5, 0.0]],
        ),
        (
            "curve c(x) = (x, (x^2 + 1)/(x - 2), 0), x : [-4, 4];",
            1,
            vec![[-4.0, -17.0 / 6.0, 0.0], [4.0, 8.5, 0.0]],
        ),
        (
            "curve c(x) = (x, 0, 1/sin x), x : [0.1, 4];",
            2,
            vec![[0.5, 0.0, 2.0], [4.0, 0.0, -1.33]],
        ),
        (
            "surface s(u, v) = (u, v, 1/(u - 0.5)), u : [-1, 1], v : [-1, 1];",
            2,
            vec![[-1.0, 1.0, -2.0 / 3.0], [1.0, -1.0, 2.0]],
        ),
        (
            "surface s(u, v) = (u, v, 1/(u - v)), u : [-1, 3], v : [-1, 1];",
            2,
            vec![[-1.0, 1.0, -0.5], [3.0, -1.0, 0.25], [3.0, 1.0, 0.5]],
        ),
        (
            "grid k : [1, 3, 3]; curve c(x) = (x, k/(x - k), 0), x : [-4, 4];",
            1,
            vec![[-4.0, -0.2, 0.0], [4.0, 3.0, 0.0]],
        ),
        // The loop of a folium is no slope, although most of its samples are near the origin.
        (
            "curve c(t) = (3t/(1 + t^3), 3t^2/(1 + t^3), 0), t : [-10, 10, 400];",
            1,
            vec![[0.0; 3], [1.587, 1.26, 0.0], [1.26, 1.587, 0.0]],
        ),
        (
            "curve c(t) = (3t/(1 + t^3), 3t^2/(1 + t^3), 0), t : [-5, 20];",
            0,
            vec![[0.0; 3], [1.587, 1.26, 0.0], [1.26, 1.587, 0.0]],
        ),
    ];
    for (text, axis, places) in cases {
        let [low, high] = corners(&samples(text).0);
        for place in places {
            let is_within = (0..3).all(|k| low[k] - 0.01 <= place[k] && place[k] <= high[k] + 0.01);
            assert!(is_within, "{text}: {place:?} in {low:?} {high:?}");
        }
        assert!(high[axis] - low[axis] < 30.0, "{text}: {low:?} {high:?}");
    }
    // Nothing of these is far from the rest, or it is no pole.
    for (text, axis, ends) in [
        (
            "curve c(t) = (t, exp(-100 t^2), 0), t : [-4, 4, 101];",
            1,
            [0.0, 1.0],
        ),
        ("curve c(t) = (t, t^9, 0), t : [-2, 2];", 1, [-512.0, 512.0]),
        (
            "curve c(t) = (t, (sin t)/t, 0), t : [-10, 10, 101];",
            0,
            [-10.0, 10.0],
        ),
        (
            "curve c(t) = (t, log t, 0), t : [0, 5, 101];",
            1,
            [-3.0, 5.0_f64.ln()],
        ),
        (
            "curve c(t) = (sin(3t), sin(4t), 0), t : [0, 2 pi, 201];",
            1,
            [-1.0, 1.0],
        ),
    ] {
        let [low, high] = corners(&samples(text).0).map(|corner| corner[axis]);
        assert!(
            (low - ends[0]).abs() < 0.01 && (high - ends[1]).abs() < 0.01,
            "{text}: {low} {high}"
        );
    }
}

#[test]
fn a_pole_ends_a_curve_and_opens_a_surface() {
    let (bounds, found) = samples("curve c(t) = (t, tan t, 0), t : [-4, 4, 200];");
    let Samples::Curves { samples: curve, .. } = found else {
        panic!("a curve")
    };
    let is_last = |(index, sample): (usize, &PositionSample)| sample.is_last().then_some(index);
    let last: Vec<usize> = curve.iter().enumerate().filter_map(is_last).collect();
    // The poles are at ±π/2, and samples 8/199 apart.
    assert_eq!(last, [60, 138]);
    // The slopes that lead to a pole do not make the rest of the picture small: its box is that of |y| < 10.
    let reach = bounds.half.map(|half| half * bounds.placement.radius);
    assert!(
        reach[0] > 3.9 && 2.0 < reach[1] && reach[1] < 10.0,
        "{reach:?}"
    );

    // A pole at a sample, as here at number 50, is one as well.
    let (at_a_sample, _) = samples("curve c(t) = (t, 1/t, 0), t : [-2, 2, 101];");
    let (between, _) = samples("curve c(t) = (t, 1/t, 0), t : [-2, 2, 100];");
    for bounds in [at_a_sample, between] {
        let reach = bounds.half.map(|half| half * bounds.placement.radius);
        assert!(
            reach[0] == 2.0 && 2.0 < reach[1] && reach[1] < 5.0,
            "{reach:?}"
        );
    }

    let (_, found) = samples("surface s(u,v) = (u, v, 1/u), u : [-1, 1, 40], v : [0, 1, 10];");
    let Samples::Surfaces {
        samples: surface, ..
    } = found
    else {
        panic!("a surface")
    };
    for (index, sample) in surface.iter().enumerate() {
        assert!(sample.defined != 0.0, "sample {index}");
        let is_open = index % 40 == 19 && index / 40 < 9;
        assert_eq!(sample.is_last(), is_open, "sample {index}");
    }
}

#[test]
fn a_curve_ends_before_a_pole_at_the_end_of_its_range() {
    // f64 has a value at π/2: 1.6e16, and at π: log sin π = −36.7.
    for (text, axis, undefined) in [
        (
            "curve c(t) = (t, tan t, 0), t : [-pi/2, pi/2, 20];",
            1,
            [0, 19],
        ),
        ("curve c(t) = (t, tan t, 0), t : [-pi/2, pi/2];", 1, [0, 99]),
        (
            "curve c(t) = (log(sin t), t, 0), t : [pi/2, pi];",
            0,
            [99, 99],
        ),
    ] {
        let (bounds, found) = samples(text);
        let reach = bounds.half.map(|half| half * bounds.placement.radius);
        assert!(1.0 < reach[axis] && reach[axis] < 7.0, "{text}: {reach:?}");
        let Samples::Curves { samples: curve, .. } = found else {
            panic!("a curve")
        };
        for (index, sample) in curve.iter().enumerate() {
            let is_pole = undefined.contains(&index);
            assert_eq!(sample.defined == 0.0, is_pole, "{text}: {index}");
        }
    }
    let (_, found) = samples(
        "surface s(u, v) = (cos v/cos u, sin v/cos u, tan u), u : [-pi/2, pi/2, 10], v : [0, 2pi, 9];",
    );
    let Samples::Surfaces { samples, .. } = found else {
        panic!("a surface")
    };
    for (index, sample) in samples.iter().enumerate() {
        let is_pole = [0, 9].contains(&(index % 10));
        assert_eq!(sample.defined == 0.0, is_pole, "{index}");
    }
}

#[test]
fn a_curve_along_a_geodesic_breaks_off_where_its_coordinates_jump() {
    let scene = "surface s(u, v) = (cos u, sin u, v), u : [0, 2pi], v : [0, 4];
        geodesic g(t) : s = (1, 0.3) @ (1, 1), t : [-3, 3];";
    for (position, expected) in [("((g(t))_1, (g(t))_2, 0)", 1), ("s(g(t))", 0)] {
        let (_, found) = samples(&format!("{scene} curve c(t) = {position}, t : [-3, 3];"));
        let Samples::Curves { samples, .. } = found else {
            panic!("a curve")
        };
        let breaks = samples[..samples.len() - 1].iter();
        let breaks = breaks.filter(|it| it.is_last()).count();
        assert_eq!(breaks, expected, "{position}");
    }
}

#[test]
fn a_gap_in_a_formula_is_filled_with_its_limit() {
    let (bounds, found) = samples("curve c(t) = (t, sin t/t, 0), t : [-10, 10, 101];");
    let Samples::Curves { samples: curve, .. } = found else {
        panic!("a curve")
    };
    let top = bounds.placement.local(WorldPoint([0.0, 1.0, 0.0])).0[1];
    assert_eq!(curve[50].defined, 1.0);
    assert!((f64::from(curve[50].position[1]) - top).abs() < 1e-6);
    let source = "surface s(u,v) = (u, v, (u^3 - v^3)/(u - v)), u : [-2, 2, 21], v : [-2, 2, 21];";
    let (_, found) = samples(source);
    let Samples::Surfaces {
        samples: surface, ..
    } = found
    else {
        panic!("a surface")
    };
    for (index, sample) in surface.iter().enumerate() {
        let length = Vec3::from(sample.normal).length();
        assert!(sample.defined == 1.0 && length > 0.99, "sample {index}");
    }
}

#[test]
fn a_continuous_curve_is_framed_as_a_whole() {
    for position in ["100exp(-1000t^2)", "1/(t^2 + 0.0001)", "sin(20t)/t"] {
        let (bounds, found) = samples(&format!(
            "curve c(t) = (t, {position}, 0), t : [-3, 3, 401];"
        ));
        let Samples::Curves { samples, .. } = found else {
            panic!("a curve")
        };
        // The box is that of fewer samples, which may miss the very top.
        for sample in samples {
            for (x, half) in sample.position.iter().zip(bounds.half) {
                assert!(
                    f64::from(x.abs()) <= 1.12 * half + 1e-6,
                    "{position}: {sample:?}"
                );
            }
        }
    }
}

#[test]
fn the_first_camera_sees_the_tips_of_solids() {
    let third = 1.0 / 3.0;
    for (text, tips, count_without_tips) in [
        (
            "abs x + abs y + abs z - 1",
            [[0.0, 0.0, 1.0], [0.0, -1.0, 0.0]],
            None,
        ),
        (
            "x^2 + y^2 - (1 - z)^2/9, z : [-2, 1]",
            [[0.0, 0.0, 1.0], [0.0, -1.0, -2.0]],
            None,
        ),
        (
            "max(-x, -y, -z, x + y + z - 1)",
            [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
            None,
        ),
        (
            "abs x + 2abs(y - 1/3) + abs(z)/2 - 1",
            [[0.0, third, 2.0], [-1.0, third, 0.0]],
            None,
        ),
        (
            "sqrt(abs x) + sqrt(abs y) + sqrt(abs z) - 1",
            [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
            None,
        ),
        (
            "(x^2)^(1/3) + (y^2)^(1/3) + (z^2)^(1/3) - 1",
            [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
            None,
        ),
        (
            "x^2 + y^2 + z^2 - 1",
            [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
            Some(1896),
        ),
        (
            "max(abs x, abs y, abs z) - 1",
            [[1.0, -1.0, 1.0], [-1.0, -1.0, 1.0]],
            Some(2400),
        ),
        (
            "max(x^2 + y^2 - 1, abs z - 2)",
            [[0.0, -1.0, 2.0], [1.0, 0.0, -2.0]],
            Some(2228),
        ),
    ] {
        let scene = scene(&format!("solid a(x,y,z) = {text};"));
        let bounds = Bounds::of(&scene, &ParamValues::initial(&scene));
        for size in [[300, 300], [200, 500], [500, 200]] {
            let camera = Camera::new(&bounds, &Viewpoint::default(), size).expect("a camera");
            for tip in tips {
                let at = camera.pixel_of(bounds.placement.local(WorldPoint(tip)));
                let PixelPoint(at) = at.expect("before the eye");
                let is_inside = |k: usize| (0.0..=f64::from(size[k])).contains(&at[k]);
                assert!(
                    is_inside(0) && is_inside(1),
                    "{text} in {size:?}: {tip:?} at {at:?}"
                );
            }
        }
        // No tip of these is far from the places that rays meet.
        if let Some(count) = count_without_tips {
            assert_eq!(bounds.cloud.len(), count, "{text}");
        }
    }
}
