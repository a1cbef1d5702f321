//! The geodesic view on the software path, against surfaces whose geodesics are known.

use geodesic::map::Map;
use geodesic::trace::Status;
use glam::DVec3;
use render::geodesic_view::PlacedCamera;
use render::viewpoint::{GeodesicCamera, Pose};
use render::{Backend, RenderError};
use scene::ObjectId;
use scene::ParamValues;

use crate::scenes::{Wanted, scene};
use std::f64::consts::{PI, TAU};

const SPHERE: &str =
    "surface s(u,v) = (sin(piv)cos(2piu), sin(piv)sin(2piu), cos(piv)), u : [0,1], v : [0,1];";
const PLANE: &str = "surface s(u,v) = (u, v, 0), u : [0,4], v : [0,2];";

/// A software request for the first object, from `at`, turned by `angle`, with the zoom `zoom`.
fn request(size: [u32; 2], place: Option<[f64; 2]>, turned: f64, distance: Option<f64>) -> Wanted {
    let mut request = Wanted::geodesic(ObjectId::new(0), size);
    request.backend = Backend::Software;
    let camera = &mut request.inside().camera;
    camera.pose = Pose::At {
        at: place,
        angle: turned,
        mirrored: false,
    };
    camera.zoom = distance;
    request
}

fn map(source: &str, request: &Wanted) -> Map {
    let scene = scene(source);
    let inside = request
        .placed(&scene, &ParamValues::initial(&scene))
        .expect("a camera");
    inside.map(&|_| {})
}

/// The place of a pixel's centre, y upwards, in units of half the shorter side.
fn place(size: [u32; 2], index: usize) -> [f64; 2] {
    let [w, h] = size.map(f64::from);
    let (x, y) = (index % size[0] as usize, index / size[0] as usize);
    let shorter = w.min(h);
    [
        (2.0 * x as f64 + 1.0 - w) / shorter,
        (h - 1.0 - 2.0 * y as f64) / shorter,
    ]
}

#[test]
fn in_a_plane_x_runs_right_along_u_and_y_upwards_along_v() {
    let size = [60, 40];
    let map = map(PLANE, &request(size, Some([2.0, 1.0]), 0.0, Some(0.5)));
    for index in 0..map.offset.len() {
        let [x, y] = place(size, index);
        assert_eq!(map.status[index], Status::Complete);
        let [u, v] = map.uv(index).0;
        assert!(
            (u - 2.0 - 0.5 * x).abs() < 1e-4 && (v - 1.0 - 0.5 * y).abs() < 1e-4,
            "({u}, {v}) at {x}, {y}"
        );
    }
}

#[test]
fn an_angle_turns_from_u_towards_v() {
    let size = [16, 16];
    let map = map(PLANE, &request(size, Some([2.0, 1.0]), PI / 2.0, Some(0.5)));
    for index in 0..map.offset.len() {
        let [x, y] = place(size, index);
        let [u, v] = map.uv(index).0;
        assert!(
            (u - 2.0 + 0.5 * y).abs() < 1e-4 && (v - 1.0 - 0.5 * x).abs() < 1e-4,
            "({u}, {v}) at {x}, {y}"
        );
    }
}

#[test]
fn beyond_a_true_edge_nothing_is_seen() {
    let size = [50, 50];
    let map = map(PLANE, &request(size, Some([2.0, 1.0]), 0.0, Some(3.9)));
    for index in 0..map.offset.len() {
        let [x, y] = place(size, index);
        let inside = 3.9 * x.abs() < 2.0 && 3.9 * y.abs() < 1.0;
        assert_eq!(map.status[index] == Status::Complete, inside, "at {x}, {y}");
        assert!(inside || map.status[index] == Status::LeftDomain);
    }
}

#[test]
fn on_a_sphere_every_pixel_ends_where_its_great_circle_does() {
    let size = [64, 64];
    // Over both poles and around the back: the zoom is π, the corners see 1.4 times as far.
    for (at, zoom) in [([0.3, 0.45], 1.2), ([0.9, 0.2], PI), ([0.5, 0.5], PI)] {
        let map = map(SPHERE, &request(size, Some(at), 0.0, Some(zoom)));
        let point = |[u, v]: [f64; 2]| {
            let (s, c) = (TAU * u).sin_cos();
            DVec3::new((PI * v).sin() * c, (PI * v).sin() * s, (PI * v).cos())
        };
        let (s, c) = (TAU * at[0]).sin_cos();
        let east = DVec3::new(-s, c, 0.0);
        let along_v = DVec3::new(
            (PI * at[1]).cos() * c,
            (PI * at[1]).cos() * s,
            -(PI * at[1]).sin(),
        );
        let pixel = 2.0 * zoom / 64.0;
        for index in 0..map.offset.len() {
            let [x, y] = place(size, index);
            assert_eq!(map.status[index], Status::Complete, "at {x}, {y}");
            let w = (east * x + along_v * y) * zoom;
            let expected = point(at) * w.length().cos() + w.normalize() * w.length().sin();
            let off = (point(map.uv(index).0) - expected).length();
            assert!(
                off < 0.25 * pixel,
                "{} pixels off at {x}, {y} from {at:?}",
                off / pixel
            );
        }
    }
}

#[test]
fn a_cylinder_is_a_plane_that_repeats() {
    let source = "surface s(u,v) = (cosu, sinu, v), u : [0,2pi], v : [-20,20];";
    let size = [48, 48];
    let map = map(source, &request(size, Some([1.0, 0.0]), 0.3, Some(12.0)));
    let (sin, cos) = 0.3_f64.sin_cos();
    for index in 0..map.offset.len() {
        let [x, y] = place(size, index).map(|x| 12.0 * x);
        let [u, v] = map.uv(index).0;
        let turn = (u - 1.0 - (cos * x - sin * y)) / TAU;
        assert!((turn - turn.round()).abs() < 1e-3, "u = {u} at {x}, {y}");
        assert!(
            (v - (sin * x + cos * y)).abs() < 1e-2,
            "v = {v} at {x}, {y}"
        );
    }
}

#[test]
fn the_first_camera_stands_in_the_middle_and_sees_a_good_part() {
    let scene = scene(SPHERE);
    let inside = request([9, 9], None, 0.0, None)
        .placed(&scene, &ParamValues::initial(&scene))
        .expect("a camera");
    assert_eq!(inside.frame.uv, [0.5, 0.5]);
    assert!(inside.zoom > 1.0 && inside.zoom < PI, "{}", inside.zoom);
    // |σu| = 2π at the equator, |σv| = π.
    assert!((inside.frame.x[0] * TAU - inside.zoom).abs() < 1e-9 && inside.frame.x[1].abs() < 1e-9);
    assert!((inside.frame.y[1] * PI - inside.zoom).abs() < 1e-9 && inside.frame.y[0].abs() < 1e-9);
}

#[test]
fn where_the_middle_has_no_tangent_plane_the_first_camera_stands_beside_it() {
    let scene = scene("surface s(u,v) = (v cosu, v sinu, v), u : [0,2pi], v : [-1,1];");
    let inside = request([9, 9], None, 0.0, None)
        .placed(&scene, &ParamValues::initial(&scene))
        .expect("a camera");
    assert!(inside.frame.uv[1] != 0.0);
}

#[test]
fn a_camera_that_cannot_stand_there_is_refused_with_the_reason() {
    let scene = scene(SPHERE);
    let attempt = |at: [f64; 2]| {
        let request = request([8, 8], Some(at), 0.0, None);
        request
            .draw(&scene, &ParamValues::initial(&scene))
            .map(|_| ())
    };
    let name = || "s".to_owned();
    // A pole is a place like any other.
    assert_eq!(attempt([0.5, 0.0]), Ok(()));
    // Beyond a side that wraps is inside; beyond an edge is not.
    assert_eq!(attempt([1.25, 0.5]), Ok(()));
    assert_eq!(attempt([0.25, 0.5]), Ok(()));
    let scene = self::scene(PLANE);
    let request = request([8, 8], Some([5.0, 1.0]), 0.0, None);
    let outside = request
        .draw(&scene, &ParamValues::initial(&scene))
        .map(|_| ());
    assert_eq!(
        outside,
        Err(RenderError::CameraOutside {
            name: name(),
            at: [5.0, 1.0],
            domain: [[0.0, 4.0], [0.0, 2.0]]
        })
    );
    let tip = self::scene("surface s(u,v) = (v cosu, v sinu, v), u : [0,2pi], v : [0,1];");
    let request = self::request([8, 8], Some([0.5, 0.0]), 0.0, None);
    let undefined = request.draw(&tip, &ParamValues::initial(&tip)).map(|_| ());
    assert_eq!(
        undefined,
        Err(RenderError::UndefinedCamera {
            name: name(),
            at: [0.5, 0.0]
        })
    );
}

#[test]
fn one_pixel_shows_the_camera_s_own_place() {
    let map = map(
        SPHERE,
        &request([1, 1], Some([0.25, 0.375]), 1.0, Some(2.0)),
    );
    assert_eq!(map.uv(0), [0.25, 0.375]);
    assert_eq!(map.status, [Status::Complete]);
}

#[test]
fn the_first_instance_of_a_surface_with_grids_is_seen() {
    let scene =
        scene("grid r : [1, 3, 3]; surface s(u,v) = r(cosu, sinu, v), u : [0,2pi], v : [-1,1];");
    let mut params = ParamValues::initial(&scene);
    let zoom = |params: &ParamValues| {
        request([8, 8], None, 0.0, None)
            .placed(&scene, params)
            .expect("a camera")
            .zoom
    };
    let first = zoom(&params);
    params.set(&scene, "r", &[3.0]).expect("in range");
    assert!((zoom(&params) - 3.0 * first).abs() < 1e-9);
}

#[test]
fn a_view_of_a_million_turns_ends_and_says_so() {
    let size = [48, 1];
    let far = request(size, Some([0.3, 0.4]), 0.0, Some(1e6));
    let map = map(SPHERE, &far);
    assert!(map.work.evaluations <= 48 * 20_100, "{:?}", map.work);
    let limited = map
        .status
        .iter()
        .filter(|&&status| status == Status::WorkLimit)
        .count();
    assert!(limited > 40, "{limited} of 48");
}

#[test]
fn beside_a_pole_geodesics_end_where_great_circles_do() {
    const WHOLE: &str =
        "surface s(u, v) = (cos u cos v, sin u cos v, sin v), u : [-pi, pi], v : [-pi/2, pi/2];";
    let (size, zoom) = ([64, 64], 1.2f64);
    // From the equator to a hundredth of the radius beside a pole, where the chart is nearly polar.
    for latitude in [0.0, 0.9, 1.4, 1.51, 1.56] {
        let map = map(
            WHOLE,
            &request(size, Some([0.0, latitude]), 0.0, Some(zoom)),
        );
        let (sin, cos) = latitude.sin_cos();
        let mut worst = 0.0f64;
        for index in 0..map.offset.len() {
            let [x, y] = [index % 64, index / 64].map(|k| (k as f64 + 0.5) / 32.0 - 1.0);
            let (x, y) = (zoom * x, -zoom * y);
            // From (cos, 0, sin) by the arc r in the direction x east + y north.
            let r = x.hypot(y);
            let (east, north) = (x / r * r.sin(), y / r * r.sin());
            let expected = [
                cos * r.cos() - sin * north,
                east,
                sin * r.cos() + cos * north,
            ];
            let [u, v] = map.uv(index).0;
            let found = [u.cos() * v.cos(), u.sin() * v.cos(), v.sin()];
            let off = found
                .iter()
                .zip(expected)
                .map(|(a, b)| (a - b).powi(2))
                .sum::<f64>()
                .sqrt();
            worst = worst.max(off);
        }
        // A tenth of a pixel.
        let pixel = zoom / 32.0;
        println!("latitude {latitude}: worst {:.4} pixels", worst / pixel);
        assert!(
            worst < 0.1 * pixel,
            "latitude {latitude}: {} pixels",
            worst / pixel
        );
    }
}

#[test]
fn a_camera_that_was_moved_is_placed_again_by_an_angle() {
    let scene = scene(SPHERE);
    let params = ParamValues::initial(&scene);
    let size = [60, 40];
    // In the chart, close to a pole, and on it.
    for at in [[0.3, 0.4], [0.3, 1e-9], [0.3, 0.0], [0.8, 1.0]] {
        for angle in [0.0, 0.5, -2.9, PI] {
            for mirrored in [false, true] {
                let first = request(size, Some(at), angle, Some(0.7));
                let first = first.placed(&scene, &params).expect("a camera");
                let mut frame = first.frame.turned(0.25).zoomed(1.5);
                if mirrored {
                    frame.y = frame.y.map(|y| -y);
                }
                let camera = GeodesicCamera::new(ObjectId::new(0)).with_frame(frame);
                let moved = PlacedCamera::new(&scene, &params, &camera, size).expect("placed");
                let again = moved.by_angle();
                let again = PlacedCamera::new(&scene, &params, &again, size).expect("placed");
                assert_eq!(again.frame.coordinates, frame.coordinates, "{at:?}");
                for (a, b) in [(again.frame.x, frame.x), (again.frame.y, frame.y)] {
                    let length = b[0].hypot(b[1]);
                    let off = (a[0] - b[0]).hypot(a[1] - b[1]) / length;
                    assert!(off < 1e-9, "{at:?}, {angle}, {mirrored}: {a:?}, {b:?}");
                }
            }
        }
    }
}
