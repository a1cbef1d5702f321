//! What a view shows, and when it is drawn: objects that are hidden while what lies on them is seen, and pictures that are
//! there already. On a GPU, or software Vulkan (`mesa-vulkan-drivers` on Debian), as well as by the software path.

use std::sync::Arc;

use crate::scenes::Wanted;
use image::RgbaImage;
use render::gpu::Gpu;
use render::gpu::Pixels;
use render::point::{PixelPoint, WorldPoint};
use render::viewpoint::{GeodesicCamera, Projection, Viewpoint};
use render::{Backend, Renderer, style};
use scene::ParamValues;
use scene::{ObjectId, Scene};

const SIZE: [u32; 2] = [120, 90];
/// From above, x to the right and y up.
const ABOVE: Viewpoint = Viewpoint {
    eye: Some(WorldPoint([0.0, -0.01, 8.0])),
    target: Some(WorldPoint([0.0; 3])),
    projection: Projection::Perspective,
};
/// A floor, a way across it, and a point far from both.
const FLOOR: &str = "surface s(u, v) = (u, v, 0), u : [-1, 1, 9], v : [-1, 1, 9];
    geodesic g(t) : s = (1, 0) @ (-0.9, 0), t : [0, 1.8];
    point p = (1.5, 0, 0);";
const FLOOR_ID: ObjectId = ObjectId::new(0);

fn stages() -> [Renderer; 2] {
    let gpu = Gpu::shared().expect("a GPU or software Vulkan");
    [Renderer::software(), Renderer::on_gpu(gpu)]
}

fn drawn(
    renderer: &mut Renderer,
    scene: &Arc<Scene>,
    params: &ParamValues,
    of: &Wanted,
) -> RgbaImage {
    let drawn = renderer.draw(&of.of(scene, params)).expect("a picture");
    renderer.read(drawn.image).expect("the device is there")
}

fn is_background(image: &RgbaImage, x: u32, y: u32) -> bool {
    let [r, g, b, _] = image.get_pixel(x, y).0;
    [r, g, b] == style::BACKGROUND
}

fn compiled(text: &str) -> (Arc<Scene>, ParamValues) {
    let scene = crate::scenes::scene(text);
    let params = ParamValues::initial(&scene);
    (scene, params)
}

#[test]
fn a_surface_is_hidden_while_its_geodesics_and_cameras_are_seen() {
    let (scene, params) = compiled(FLOOR);
    let whole = Wanted::space(SIZE).with_space(|options| options.camera = ABOVE);
    let bare = whole
        .clone()
        .with_space(|options| options.hidden = vec![FLOOR_ID]);
    let with_camera = bare.clone().with_space(|options| {
        let camera = GeodesicCamera::new(FLOOR_ID);
        options.show_camera = Some(camera.at([0.5, 0.5]).zoomed(0.3));
    });
    for mut renderer in stages() {
        let full = drawn(&mut renderer, &scene, &params, &whole);
        let empty = drawn(&mut renderer, &scene, &params, &bare);
        let camera = drawn(&mut renderer, &scene, &params, &with_camera);
        // In the middle runs the geodesic; everything below it is floor.
        let seen = |y: &u32| !is_background(&empty, 60, *y);
        let middle = (30..60).find(seen).expect("a line");
        let redness = |image: &RgbaImage, y: u32| {
            let [r, g, _, _] = image.get_pixel(60, y).0;
            i32::from(r) - i32::from(g)
        };
        assert!(redness(&empty, middle) > 40, "{}", redness(&empty, middle));
        assert!(!is_background(&full, 60, middle + 10) && is_background(&empty, 60, middle + 10));
        let different = empty.pixels().zip(camera.pixels()).filter(|(a, b)| a != b);
        assert!(
            different.count() > 20,
            "the camera is seen without its floor"
        );
        // Objects keep their numbers, and what is not seen is not found.
        let at = |y: u32| [60.5, f64::from(y) + 0.5];
        let mut found = |request: &Wanted, y| {
            let hit = renderer.pick(&request.of(&scene, &params), PixelPoint(at(y)));
            hit.expect("a view of space").map(|hit| hit.object)
        };
        assert_eq!(found(&bare, middle), Some(ObjectId::new(1)));
        assert_eq!(found(&bare, middle + 12), None);
        assert_eq!(found(&whole, middle + 12), Some(FLOOR_ID));
    }
}

#[test]
fn what_is_hidden_is_neither_sampled_nor_planned_and_both_ways_of_drawing_agree() {
    let (scene, params) = compiled(FLOOR);
    for (mut renderer, backend) in stages().into_iter().zip([Backend::Software, Backend::Gpu]) {
        let request = Wanted {
            backend,
            ..Wanted::space(SIZE).with_space(|options| options.hidden = vec![FLOOR_ID])
        };
        let live = drawn(&mut renderer, &scene, &params, &request);
        assert_eq!(renderer.counters().sampled, 2, "the geodesic and the point");
        let alone = request.draw(&scene, &params).expect("a picture");
        assert!(live == alone.image, "{backend:?}");
        let plan = request.plan(&scene, &params);
        let planned: Vec<usize> = plan
            .objects
            .iter()
            .map(|object| object.object.index())
            .collect();
        assert_eq!((planned, plan.textures), (vec![1, 2], 0));
    }
}

#[test]
fn a_hidden_object_takes_room_only_where_something_lies_on_it() {
    let (scene, params) = compiled(FLOOR);
    let centre = |hidden: &[usize]| {
        let request = Wanted::space(SIZE).with_space(|options| {
            options.hidden = hidden.iter().map(|&id| ObjectId::new(id)).collect();
        });
        let mut renderer = Renderer::software();
        let camera = renderer.camera(&request.of(&scene, &params));
        camera.expect("a view of space").placement.centre[0]
    };
    assert_eq!(centre(&[]), 0.25, "from the floor's left to the point");
    assert_eq!(centre(&[0]), 0.25, "the geodesic still lies on the floor");
    assert_eq!(centre(&[0, 1]), 1.5, "the point alone");
    assert_eq!(centre(&[2]), 0.0, "the floor alone");
}

#[test]
fn the_same_request_again_draws_nothing_and_gives_the_same_pixels() {
    let (scene, params) = compiled(FLOOR);
    for mut renderer in stages() {
        let space = Wanted::space(SIZE);
        let inside = Wanted::geodesic(FLOOR_ID, [40, 30]);
        let first = [&space, &inside].map(|it| drawn(&mut renderer, &scene, &params, it));
        let before = renderer.counters();
        assert_eq!(before.pictures, 2);
        for _ in 0..3 {
            let again = [&space, &inside].map(|it| drawn(&mut renderer, &scene, &params, it));
            assert!(again == first);
        }
        assert_eq!(renderer.counters(), before);
        // Whatever a picture depends on has it drawn again.
        let highlighted = space
            .clone()
            .with_space(|options| options.highlight = Some(FLOOR_ID));
        let picture = drawn(&mut renderer, &scene, &params, &highlighted);
        assert!(picture != first[0]);
        assert_eq!(renderer.counters().pictures, 3);
        assert!(drawn(&mut renderer, &scene, &params, &space) == first[0]);
        assert_eq!(renderer.counters().pictures, 4);
        let (other, _) = compiled(FLOOR);
        assert!(drawn(&mut renderer, &other, &params, &space) == first[0]);
        assert_eq!(renderer.counters().pictures, 5);
        renderer.set_bounds(None);
        assert!(drawn(&mut renderer, &other, &params, &space) == first[0]);
        assert_eq!(renderer.counters().pictures, 6);
    }
}

#[test]
fn a_picture_that_is_given_again_is_its_own() {
    let (scene, params) = compiled(FLOOR);
    let mut renderer = Renderer::software();
    let request = Wanted::space(SIZE);
    let first = drawn(&mut renderer, &scene, &params, &request);
    let picture = renderer
        .draw(&request.of(&scene, &params))
        .expect("a picture");
    let Pixels::Image(mut image) = picture.image else {
        panic!("the software path draws into memory");
    };
    image.fill(7);
    assert!(drawn(&mut renderer, &scene, &params, &request) == first);
}
