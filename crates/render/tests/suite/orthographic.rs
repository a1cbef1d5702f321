//! Orthographic pictures: sizes, places and what is under a pixel, against closed forms; both backends.

use std::sync::Arc;

use crate::scenes::Wanted;
use image::RgbaImage;
use render::point::{DrawingPoint, PixelPoint, WorldPoint};
use render::viewpoint::{Projection, Viewpoint};
use render::{Backend, Renderer, style};
use scene::{ObjectId, ParamValues, Scene};

const SIZE: [u32; 2] = [200, 150];
/// Three squares of the same size, far behind each other, seen from above.
const SQUARES: &str = "surface a(u, v) = (u - 3, v, 4), u : [-1, 1, 3], v : [-1, 1, 3];
    surface b(u, v) = (u, v, 0), u : [-1, 1, 3], v : [-1, 1, 3];
    surface c(u, v) = (u + 3, v, -20), u : [-1, 1, 3], v : [-1, 1, 3];";

fn compiled(text: &str) -> (Arc<Scene>, ParamValues) {
    let scene = crate::scenes::scene(text);
    let params = ParamValues::initial(&scene);
    (scene, params)
}

fn orthographic(eye: [f64; 3], target: [f64; 3]) -> Wanted {
    let camera = Viewpoint {
        projection: Projection::Orthographic,
        ..Viewpoint::new(eye, target)
    };
    Wanted::space(SIZE).with_space(|space| space.camera = camera)
}

fn draw(scene: &Arc<Scene>, params: &ParamValues, wanted: &Wanted, backend: Backend) -> RgbaImage {
    let mut wanted = wanted.clone();
    wanted.backend = backend;
    wanted.draw(scene, params).expect("a picture").image
}

/// The runs of pixels of a row that are not the background.
fn runs(image: &RgbaImage, row: u32) -> Vec<[u32; 2]> {
    let seen = |x: u32| image.get_pixel(x, row).0[..3] != style::BACKGROUND;
    let mut runs: Vec<[u32; 2]> = Vec::new();
    for x in (0..image.width()).filter(|&x| seen(x)) {
        match runs.last_mut() {
            Some([_, end]) if *end == x => *end = x + 1,
            _ => runs.push([x, x + 1]),
        }
    }
    runs
}

#[test]
fn equal_lengths_are_equal_in_the_picture_however_far_they_are() {
    let (scene, params) = compiled(SQUARES);
    let wanted = orthographic([0.0, 0.0, 12.0], [0.0; 3]);
    // The picture's shorter side covers 2·12·tan(fov/2) in the plane of the target.
    let tall = 24.0 * (0.5 * style::FIELD_OF_VIEW).tan();
    let pixels = 2.0 * f64::from(SIZE[1]) / tall;
    for backend in [Backend::Software, Backend::Gpu] {
        let image = draw(&scene, &params, &wanted, backend);
        let runs = runs(&image, SIZE[1] / 2);
        assert_eq!(runs.len(), 3, "{backend:?}: {runs:?}");
        for [from, to] in runs {
            let wide = f64::from(to - from);
            assert!(
                (wide - pixels).abs() < 2.0,
                "{backend:?}: {wide} of {pixels}"
            );
        }
    }
}

#[test]
fn what_lies_behind_the_eye_is_drawn_and_nearer_hides_farther() {
    let (scene, params) = compiled(
        "surface a(u, v) = (u, v, 9), u : [-1, 1, 3], v : [-1, 1, 3];
         surface b(u, v) = (u, v, 0), u : [-2, 2, 3], v : [-2, 2, 3];",
    );
    let mut wanted = orthographic([0.0, 0.0, 6.0], [0.0; 3]);
    wanted.colours = vec![
        (ObjectId::new(0), [255, 0, 0]),
        (ObjectId::new(1), [0, 0, 255]),
    ];
    for backend in [Backend::Software, Backend::Gpu] {
        let image = draw(&scene, &params, &wanted, backend);
        let [r, _, b, _] = image.get_pixel(SIZE[0] / 2 + 5, SIZE[1] / 2 + 5).0;
        assert!(r > 60 && b < 30, "{backend:?}: red before blue, {r} {b}");
    }
}

#[test]
fn both_backends_draw_the_same_picture() {
    let (scene, params) = compiled(
        "curve c(t) = (cos t, sin t, 0.2 t), t : [0, 6, 80];
         vector w = (0.4, 0.3, 0.5) @ (0, 0, 0.5);
         point p = (0.5, -0.5, 1);
         surface s(u, v) = (u, v, 0.3 sin(3 u) cos(2 v)), u : [-1, 1, 40], v : [-1, 1, 40];",
    );
    let wanted =
        Wanted::space(SIZE).with_space(|space| space.camera.projection = Projection::Orthographic);
    let [gpu, software] =
        [Backend::Gpu, Backend::Software].map(|it| draw(&scene, &params, &wanted, it));
    let far = gpu
        .pixels()
        .zip(software.pixels())
        .filter(|(a, b)| (0..3).any(|k| a.0[k].abs_diff(b.0[k]) > 24));
    let share = far.count() as f64 / f64::from(SIZE[0] * SIZE[1]);
    assert!(share < 0.02, "{share}");
    let seen = software
        .pixels()
        .filter(|pixel| pixel.0[..3] != style::BACKGROUND);
    assert!(seen.count() > 5000);
}

#[test]
fn the_first_camera_leaves_the_margin_around_the_scene() {
    let (scene, params) = compiled("curve c(t) = (cos t, sin t, 0), t : [0, 2 pi, 200];");
    let wanted = Wanted::space([200, 200])
        .with_space(|space| space.camera.projection = Projection::Orthographic);
    let image = draw(&scene, &params, &wanted, Backend::Software);
    let rows: Vec<u32> = (0..200)
        .filter(|&row| !runs(&image, row).is_empty())
        .collect();
    // 8 % of the half picture, less half the width of the line.
    assert!((5..=9).contains(&rows[0]), "{rows:?}");
    assert!((190..=194).contains(&rows[rows.len() - 1]), "{rows:?}");
}

#[test]
fn a_plane_is_hit_where_the_parallel_ray_meets_it() {
    let (scene, params) =
        compiled("surface s(u, v) = (u, v, 0.5), u : [-4, 4, 9], v : [-4, 4, 7];");
    let wanted = orthographic([3.0, -7.0, 5.0], [0.2, 0.1, 0.5]);
    let request = wanted.of(&scene, &params);
    let mut renderer = Renderer::software();
    let camera = renderer.camera(&request).expect("a camera");
    for k in 0..20 {
        let at = [70.3 + 3.1 * f64::from(k), 60.7 + 1.7 * f64::from(k)];
        let hit = renderer.pick(&request, PixelPoint(at)).expect("a picture");
        let hit = hit.unwrap_or_else(|| panic!("{at:?} misses"));
        // The place that was hit is seen at the pixel, and has the parameters that are said.
        let [u, v] = hit.parameters;
        let place = camera.placement.local(WorldPoint([u, v, 0.5]));
        let seen = camera.pixel_of(place).expect("in front").0;
        let off = (seen[0] - at[0]).hypot(seen[1] - at[1]);
        assert!(off < 0.05, "{at:?}: seen at {seen:?}");
        let hit = camera.placement.local(hit.position.expect("a place"));
        let away: f64 = (0..3).map(|n| (hit.0[n] - place.0[n]).powi(2)).sum();
        assert!(away.sqrt() < 1e-3, "{hit:?} is not {place:?}");
    }
}

#[test]
fn places_are_seen_where_both_projections_put_them() {
    let (scene, params) = compiled("point p = (0.3, -0.2, 0.4); point q = (-1, 1, 1);");
    for projection in [Projection::Perspective, Projection::Orthographic] {
        let mut wanted = orthographic([2.0, -3.0, 2.0], [0.0; 3]);
        wanted.in_space().camera.projection = projection;
        wanted.colours = vec![(ObjectId::new(0), [0, 255, 0])];
        let camera = Renderer::software().camera(&wanted.of(&scene, &params));
        let camera = camera.expect("a camera");
        let place: DrawingPoint = camera.placement.local(WorldPoint([0.3, -0.2, 0.4]));
        let [x, y] = camera.pixel_of(place).expect("in front").0;
        for backend in [Backend::Software, Backend::Gpu] {
            let image = draw(&scene, &params, &wanted, backend);
            let [r, g, b, _] = image.get_pixel(x as u32, y as u32).0;
            assert!(
                g > 150 && r < 60 && b < 60,
                "{projection:?}, {backend:?}: {r} {g} {b}"
            );
        }
    }
}
