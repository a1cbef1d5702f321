//! What is under a pixel of the 3D view, against closed forms and against what the picture shows.

use std::sync::Arc;

use crate::scenes::Wanted;
use render::Renderer;
use render::gpu::Pixels;
use render::point::{DrawingPoint, PixelPoint};
use render::view::Hit;
use render::viewpoint::{GeodesicCamera, Viewpoint};
use scene::ParamValues;
use scene::{ObjectId, Scene};

const SIZE: [u32; 2] = [160, 120];

fn compiled(text: &str) -> (Arc<Scene>, ParamValues) {
    let scene = crate::scenes::scene(text);
    let params = ParamValues::initial(&scene);
    (scene, params)
}

fn from(eye: [f64; 3], target: [f64; 3]) -> Wanted {
    let mut request = Wanted::space(SIZE);
    request.in_space().camera = Viewpoint::new(eye, target);
    request
}

fn pick(scene: &Arc<Scene>, params: &ParamValues, request: &Wanted, at: [f64; 2]) -> Option<Hit> {
    Renderer::software()
        .pick(&request.of(scene, params), PixelPoint(at))
        .expect("a picture")
}

fn position(hit: &Hit) -> [f64; 3] {
    hit.position.expect("a place in space").0
}

/// Where the ray through a pixel place goes: its start and its direction in the scene's units.
fn ray(scene: &Arc<Scene>, params: &ParamValues, request: &Wanted, at: [f64; 2]) -> [[f64; 3]; 2] {
    let camera = Renderer::software()
        .camera(&request.of(scene, params))
        .expect("a camera");
    let [tx, ty] = camera.half_tangents();
    let x = (2.0 * at[0] / f64::from(SIZE[0]) - 1.0) * tx;
    let y = (1.0 - 2.0 * at[1] / f64::from(SIZE[1])) * ty;
    let [right, up, back] = camera.axes;
    let direction = right * x + up * y - back;
    [
        camera
            .placement
            .world(DrawingPoint(camera.eye.to_array()))
            .0,
        direction.to_array(),
    ]
}

#[test]
fn a_plane_is_hit_where_the_ray_meets_it() {
    let text = "surface s(u, v) = (u, 2 v, 0.5), u : [-4, 4, 9], v : [-2, 2, 7];";
    let (scene, params) = compiled(text);
    let request = from([3.0, -7.0, 5.0], [0.2, 0.1, 0.5]);
    let mut hits = 0;
    for k in 0..200 {
        let at = [0.37 + 0.797 * f64::from(k), 119.0 - 0.59 * f64::from(k)];
        let [start, direction] = ray(&scene, &params, &request, at);
        let t = (0.5 - start[2]) / direction[2];
        let place: [f64; 3] = std::array::from_fn(|n| start[n] + t * direction[n]);
        let [u, v] = [place[0], place[1] / 2.0];
        let inside = u.abs() < 3.9 && v.abs() < 1.95;
        let outside = u.abs() > 4.1 || v.abs() > 2.05;
        let hit = pick(&scene, &params, &request, at);
        if inside {
            let hit = hit.unwrap_or_else(|| panic!("{at:?} misses"));
            assert_eq!((hit.object, hit.instance), (ObjectId::new(0), 0));
            let off = [hit.parameters[0] - u, hit.parameters[1] - v];
            // Corners are drawn to 1/256 of a pixel.
            assert!(
                off.iter().all(|off| off.abs() < 2e-3),
                "{at:?}: {hit:?}, not {u} {v}"
            );
            let off = (0..3).map(|n| (position(&hit)[n] - place[n]).abs());
            assert!(
                off.fold(0.0, f64::max) < 4e-3,
                "{at:?}: {hit:?}, not {place:?}"
            );
            hits += 1;
        } else if outside {
            assert_eq!(hit, None, "{at:?}");
        }
    }
    assert!(hits > 50, "{hits}");
}

#[test]
fn a_sphere_is_hit_on_its_near_side() {
    let text = "surface s(u, v) = 2 (cos u cos v, sin u cos v, sin v),
        u : [0, 2pi, 241], v : [-pi/2, pi/2, 121];";
    let (scene, params) = compiled(text);
    let eye = [6.0, 5.0, 4.0];
    let request = from(eye, [0.0; 3]);
    let mut hits = 0;
    for k in 0..40 {
        let angle = 2.4 * f64::from(k);
        let away = 44.0 * (f64::from(k) / 40.0).sqrt();
        let at = [80.0 + away * angle.cos(), 60.0 + away * angle.sin()];
        let [start, d] = ray(&scene, &params, &request, at);
        let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (a, b, c) = (dot(d, d), dot(start, d), dot(start, start) - 4.0);
        let root = b * b - a * c;
        let hit = pick(&scene, &params, &request, at);
        if root < 0.3 {
            continue;
        }
        let t = (-b - root.sqrt()) / a;
        let place: [f64; 3] = std::array::from_fn(|n| start[n] + t * d[n]);
        let u = place[1].atan2(place[0]).rem_euclid(std::f64::consts::TAU);
        let v = (place[2] / 2.0).asin();
        let hit = hit.unwrap_or_else(|| panic!("{at:?} misses"));
        let [du, dv] = [hit.parameters[0] - u, hit.parameters[1] - v];
        assert!(
            du.abs() * v.cos() < 4e-3 && dv.abs() < 4e-3,
            "{at:?}: {hit:?}, not {u} {v}"
        );
        assert!((dot(position(&hit), position(&hit)).sqrt() - 2.0).abs() < 5e-3);
        hits += 1;
    }
    assert!(hits > 25, "{hits}");
}

#[test]
fn curves_points_and_vectors_are_picked_within_four_pixels() {
    let text = "curve c(t) = (t, 0, 0), t : [-2, 6, 3];
        point p = (0, 1, 0); vector w = (1, 0, 0) @ (-1, -1, 0);";
    let (scene, params) = compiled(text);
    // From straight above: x to the right, y up.
    let request = from([0.0, 0.0, 6.0], [0.0; 3]);
    let mut renderer = Renderer::software();
    let camera = renderer
        .camera(&request.of(&scene, &params))
        .expect("a camera");
    let pixel = f64::from(camera.pixels_per_unit()) / (6.0);
    let at = |x: f64, y: f64| [80.0 + x * pixel, 60.0 - y * pixel];
    let mut pick = |[x, y]: [f64; 2]| {
        renderer
            .pick(&request.of(&scene, &params), PixelPoint([x, y]))
            .expect("a picture")
    };
    let [x, y] = at(0.5, 0.0);
    for off in [-4.0, 0.0, 3.0] {
        let hit = pick([x, y + off]).expect("the curve");
        assert_eq!(hit.object, ObjectId::new(0));
        assert!((hit.parameters[0] - 0.5).abs() < 0.03, "{hit:?}");
        assert!(
            position(&hit)[0].abs() < 0.6 && position(&hit)[1].abs() < 0.05,
            "{hit:?}"
        );
    }
    assert_eq!(pick([x, y + 9.0]), None);
    let [x, y] = at(0.0, 1.0);
    let hit = pick([x + 4.0, y]).expect("the point");
    assert_eq!(hit.object, ObjectId::new(1));
    assert!(
        position(&hit)
            .iter()
            .zip([0.0, 1.0, 0.0])
            .all(|(a, b)| (a - b).abs() < 1e-6)
    );
    let hit = pick(at(-0.6, -1.0)).expect("the vector");
    assert_eq!(hit.object, ObjectId::new(2));
    assert!((position(&hit)[0] + 0.6).abs() < 0.03, "{hit:?}");
}

#[test]
fn perspective_does_not_bend_a_curves_parameter() {
    let text = "curve c(t) = (0, t, 0), t : [0, 10, 2]; point p = (0, 5, 0);";
    let (scene, params) = compiled(text);
    let request = from([1.0, -3.0, 2.0], [0.0, 4.0, 0.0]);
    let mut renderer = Renderer::software();
    let mut hits = 0;
    for k in 0..160 {
        for j in (0..120).step_by(7) {
            let at = [f64::from(k) + 0.5, f64::from(j) + 0.5];
            let hit = renderer
                .pick(&request.of(&scene, &params), PixelPoint(at))
                .expect("a picture");
            if let Some(hit) = hit.filter(|hit| hit.object == ObjectId::new(0)) {
                assert!(
                    (hit.parameters[0] - position(&hit)[1]).abs() < 0.12,
                    "{at:?}: {hit:?}"
                );
                hits += 1;
            }
        }
    }
    assert!(hits > 20, "{hits}");
}

#[test]
fn each_instance_is_distinguished() {
    let text = "grid k : [0, 3, 4], [0, 1, 2];
        surface s(u, v) = (u + 2 k_1, v + 2 k_2, 0), u : [0, 1, 5], v : [0, 1, 5];
        point p = (2 k_1 + 1.5, 2 k_2 + 1.5, 0);
        curve c(t) = (2 k_1 + t, 2 k_2 + 1.5, 0), t : [0, 1, 9];";
    let (scene, params) = compiled(text);
    let request = from([3.5, 1.5, 20.0], [3.5, 1.5, 0.0]);
    let mut renderer = Renderer::software();
    let camera = renderer
        .camera(&request.of(&scene, &params))
        .expect("a camera");
    let pixel = f64::from(camera.pixels_per_unit()) / 20.0;
    for i in 0..4 {
        for j in 0..2 {
            let [x, y] = [2.0 * f64::from(i), 2.0 * f64::from(j)];
            for (object, place) in [(0, [0.3, 0.6]), (1, [1.5, 1.5]), (2, [0.5, 1.5])] {
                let at = [
                    80.0 + (x + place[0] - 3.5) * pixel,
                    60.0 - (y + place[1] - 1.5) * pixel,
                ];
                let hit = renderer
                    .pick(&request.of(&scene, &params), PixelPoint(at))
                    .expect("a picture");
                let hit = hit.unwrap_or_else(|| panic!("{object} at {at:?}"));
                assert_eq!(
                    (hit.object.index(), hit.instance),
                    (object, 2 * i as u64 + j as u64)
                );
            }
        }
    }
}

#[test]
fn what_is_picked_is_what_the_picture_shows() {
    let text = "grid k : [-1, 1, 3];
        surface s(u, v) = (cos u cos v, sin u cos v, sin v), u : [0, 2pi, 40], v : [-1.2, 1.2, 30];
        surface r(u, v) = (u, v, 0.3 u v), u : [-1.5, 1.5, 20], v : [-1.5, 1.5, 20];
        curve c(t) = (1.2 cos t, 1.2 sin t, 0.2 t), t : [-6, 6, 80];
        point p = (k, -1, 0.5); vector w = (0, 0, 1) @ (k, k, 0);
        metric h(x, y) = (1, 0, 1) / y^2, x : [-1, 1], y : [0.5, 1];";
    let (scene, params) = compiled(text);
    let request = from([4.0, -5.0, 3.0], [0.0; 3]);
    let mut renderer = Renderer::software();
    let mut drawn = |object: usize, colour: [u8; 3]| {
        let mut request = request.clone();
        request.colours = vec![(ObjectId::new(object), colour)];
        match renderer
            .draw(&request.of(&scene, &params))
            .expect("a picture")
            .image
        {
            Pixels::Image(image) => image,
            Pixels::Texture(_) => panic!("a software renderer draws images"),
        }
    };
    // An object is seen where the picture depends on its colour.
    let seen: Vec<Vec<bool>> = (0..6)
        .map(|object| {
            let (black, white) = (drawn(object, [0; 3]), drawn(object, [255; 3]));
            black
                .pixels()
                .zip(white.pixels())
                .map(|(a, b)| a != b)
                .collect()
        })
        .collect();
    assert!(seen[5].iter().all(|&seen| !seen), "a metric is not seen");
    let [width, height] = SIZE.map(|side| side as i32);
    let visible = |object: usize, x: i32, y: i32| {
        (0..width).contains(&x)
            && (0..height).contains(&y)
            && seen[object][(y * width + x) as usize]
    };
    let near = |object: usize, x: i32, y: i32| {
        (-4..=4).any(|j| (-4..=4).any(|i| i * i + j * j <= 16 && visible(object, x + i, y + j)))
    };
    let mut counts = [0; 6];
    for y in 0..height {
        for x in 0..width {
            let at = [f64::from(x) + 0.5, f64::from(y) + 0.5];
            let hit = renderer
                .pick(&request.of(&scene, &params), PixelPoint(at))
                .expect("a picture");
            let glyphs: Vec<usize> = (2..5).filter(|&object| near(object, x, y)).collect();
            let here: Vec<usize> = (0..2).filter(|&object| visible(object, x, y)).collect();
            match hit.map(|hit| hit.object.index()) {
                Some(object) if object >= 2 => {
                    assert!(glyphs.contains(&object), "({x}, {y}): {object}")
                }
                Some(object) => assert!(
                    glyphs.is_empty() && here.contains(&object),
                    "({x}, {y}): {object}, not {glyphs:?} {here:?}"
                ),
                None => assert!(glyphs.is_empty() && here.is_empty(), "({x}, {y})"),
            }
            if let Some(hit) = hit {
                counts[hit.object.index()] += 1;
            }
        }
    }
    assert!(counts[..5].iter().all(|&count| count > 50), "{counts:?}");
    assert_eq!(renderer.counters().sampled, 5);
}

#[test]
fn a_place_outside_the_picture_is_no_place_to_pick() {
    let (scene, params) = compiled("surface s(u, v) = (u, v, 0), u : [0, 1], v : [0, 1];");
    for at in [[-1.0, 5.0], [5.0, 120.0], [f64::NAN, 1.0]] {
        assert_eq!(pick(&scene, &params, &Wanted::space(SIZE), at), None);
    }
    let inside = Wanted::geodesic(ObjectId::new(0), SIZE);
    assert_eq!(pick(&scene, &params, &inside, [f64::NAN, 1.0]), None);
}

#[test]
fn a_pixel_of_a_geodesic_view_is_at_the_end_of_its_geodesic() {
    let text =
        "surface s(u, v) = (cos v cos u, cos v sin u, sin v), u : [-pi, pi], v : [-pi/2, pi/2];
        metric h(u, v) = (1, 0, 2 + u), u : [-1, 1], v : [-1, 1];";
    let (scene, params) = compiled(text);
    let zoom = 2.0;
    let seen = |id: usize, at: [f64; 2]| {
        let camera = GeodesicCamera::new(ObjectId::new(id)).at([0.0, 0.0]);
        let request = Wanted::geodesic(ObjectId::new(id), SIZE)
            .with_inside(|options| options.camera = camera.zoomed(zoom));
        pick(&scene, &params, &request, at)
    };
    // Along the equator, along the meridian, and aslant: by spherical trigonometry sin v = sin d sin a.
    for (x, y) in [(0.4, 0.0), (-0.7, 0.0), (0.0, 0.5), (0.3, -0.4), (0.0, 0.0)] {
        let pixel = [80.0 + 60.0 * x, 60.0 - 60.0 * y];
        let hit = seen(0, pixel).expect("a place");
        let [distance, angle] = hit.polar.expect("polar coordinates");
        let (wanted, towards) = (zoom * f64::hypot(x, y), f64::atan2(y, x));
        assert!((distance - wanted).abs() < 1e-12 && (angle - towards).abs() < 1e-12);
        let v = (distance.sin() * angle.sin()).asin();
        let u = (distance.sin() * angle.cos()).atan2(distance.cos());
        let off = [hit.parameters[0] - u, hit.parameters[1] - v];
        assert!(
            off.iter().all(|off| off.abs() < 1e-9),
            "{hit:?}, not {u} {v}"
        );
        let p = [v.cos() * u.cos(), v.cos() * u.sin(), v.sin()];
        let off = (0..3).map(|n| (position(&hit)[n] - p[n]).abs());
        assert!(off.into_iter().all(|off| off < 1e-9), "{hit:?}");
    }
    let flat = seen(1, [80.0 + 60.0 * 0.25, 60.0]).expect("a place");
    assert_eq!(flat.position, None);
    assert!((flat.parameters[0] - 0.5).abs() < 1e-9, "{flat:?}");
    assert_eq!(
        seen(1, [80.0 + 60.0 * 0.9, 60.0]),
        None,
        "outside the domain"
    );
}
