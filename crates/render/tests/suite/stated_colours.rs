//! Surfaces whose colour is stated as an expression: from inside and in space, on the software path.

use std::sync::Arc;

use image::RgbaImage;
use render::gpu::{Gpu, Pixels};
use render::point::WorldPoint;
use render::request::part::SpaceOptions;
use render::view::geodesic::GeodesicOptions;
use render::viewpoint::{GeodesicCamera, Pose};
use render::{PictureRequest, Renderer, Views};
use scene::{ObjectId, ParamValues};

const SIDE: u32 = 64;
const TEXT: &str = "param k = 1 : [0, 1];
    surface s(u,v) = (u, v, 0), u : [-1, 1], v : [-1, 1], color : (0.5 + u/2, k(0.5 - v/2), 0.25);
    surface plain(u,v) = (u, v, -9), u : [-1, 1], v : [-1, 1];";

fn image(renderer: &mut Renderer, request: &PictureRequest) -> RgbaImage {
    match renderer.draw(request).expect("a picture").image {
        Pixels::Image(image) => image,
        Pixels::Texture(_) => panic!("the software path draws in memory"),
    }
}

/// The view from the middle of the surface, half its side to each edge.
fn inside(k: f64) -> PictureRequest {
    let scene = crate::scenes::scene(TEXT);
    let mut params = ParamValues::initial(&scene);
    params.set(&scene, "k", &[k]).expect("in its interval");
    let camera = GeodesicCamera::new(ObjectId::new(0))
        .at([0.0, 0.0])
        .zoomed(0.5);
    let options = GeodesicOptions {
        mark_centre: false,
        ..camera.into()
    };
    PictureRequest::new(&scene, Arc::new(params), options, [SIDE; 2])
}

#[test]
fn each_place_has_the_colour_of_the_expression_from_inside() {
    let mut renderer = Renderer::software();
    for k in [1.0, 0.25, 1.0] {
        let image = image(&mut renderer, &inside(k));
        for (x, y, pixel) in image.enumerate_pixels() {
            let [right, down] = [x, y].map(|n| (f64::from(n) + 0.5) / f64::from(SIDE) - 0.5);
            let (u, v) = (right, -down);
            let expected = [0.5 + u / 2.0, k * (0.5 - v / 2.0), 0.25];
            for (found, expected) in pixel.0.iter().zip(expected) {
                let off = (f64::from(*found) - 255.0 * expected).abs();
                assert!(off <= 2.0, "{pixel:?} at {x}, {y}: {expected}");
            }
        }
    }
}

#[test]
fn the_expression_is_seen_in_space_and_a_chosen_image_wins() {
    let scene = crate::scenes::scene(TEXT);
    let eye = SpaceOptions::seen_from([0.0, 0.0, 4.0], [0.0, 0.0, 0.0]);
    let params = Arc::new(ParamValues::initial(&scene));
    let mut request = PictureRequest::new(&scene, params, eye, [SIDE; 2]);
    let mut renderer = Renderer::software();
    let seen = image(&mut renderer, &request);
    let middle = SIDE / 2;
    let [left, right] = [middle - 8, middle + 8].map(|x| seen.get_pixel(x, middle).0);
    assert!(left[0] + 20 < right[0], "{left:?}, {right:?}");
    let white = RgbaImage::from_pixel(2, 2, image::Rgba([255; 4]));
    let white = render::texture::Texture::from_image(white);
    request.textures = vec![(ObjectId::new(0), Arc::new(white).into())];
    let chosen = image(&mut renderer, &request);
    let [left, right] = [middle - 8, middle + 8].map(|x| chosen.get_pixel(x, middle).0);
    assert!(left[0].abs_diff(right[0]) < 8, "{left:?}, {right:?}");
}

/// Three instances of an object from left to right, red, green and blue, seen from above.
fn three(object: &str) -> PictureRequest {
    let text =
        format!("grid k : [-1, 1, 3];\n{object}, color : ((k(k-1))/2, 1 - k^2, (k(k+1))/2);");
    let scene = crate::scenes::scene(&text);
    let eye = SpaceOptions::seen_from([0.0, 0.0, 6.0], [0.0; 3]);
    let params = Arc::new(ParamValues::initial(&scene));
    PictureRequest::new(&scene, params, eye, [3 * SIDE, SIDE])
}

const OF_THREE: [&str; 6] = [
    "point p = (k, 0, 0)",
    "vector v = (0, 0.5, 0) @ (k, -0.25, 0)",
    "curve c(t) = (k, t, 0), t : [-0.5, 0.5, 9]",
    "surface s(u, v) = (k + u, v, 0), u : [-0.3, 0.3, 5], v : [-0.3, 0.3, 5]",
    "surface plane(u, v) = (u, v, 0), u : [-2, 2, 9], v : [-1, 1, 9], color : 0;
    geodesic g(t) : plane = (0, 1) @ (k, -0.5), t : [0, 1, 9]",
    "solid ball(x, y, z) = (x - k)^2 + y^2 + z^2 - 0.1",
];

/// The channel that is the brightest one at an instance's place.
fn channel(image: &RgbaImage, request: &PictureRequest, at: [f64; 3]) -> Option<usize> {
    let camera = Renderer::software().camera(request).expect("a camera");
    let place = camera.placement.local(WorldPoint(at));
    let [x, y] = camera.pixel_of(place).expect("in front").0;
    let [r, g, b, _] = image.get_pixel(x as u32, y as u32).0;
    let least = r.min(g).min(b);
    (0..3).find(|&k| [r, g, b][k] > 100 && least < 40)
}

#[test]
fn each_instance_has_the_colour_of_its_grid_value() {
    let gpu = Gpu::shared().expect("a GPU or software Vulkan");
    for object in OF_THREE {
        let request = three(object);
        for mut renderer in [Renderer::software(), Renderer::on_gpu(gpu.clone())] {
            let drawn = renderer.draw(&request).expect("a picture");
            assert_eq!(drawn.notes, []);
            let image = renderer.read(drawn.image).expect("the device is there");
            for (x, expected) in [-1.0, 0.0, 1.0].into_iter().zip(0..3) {
                let found = channel(&image, &request, [x, 0.0, 0.0]);
                assert_eq!(found, Some(expected), "{object} at {x}");
            }
        }
    }
}

#[test]
fn geodesics_have_the_colours_of_their_instances_from_inside() {
    let chart = "surface plane(u, v) = (u, v, 0), u : [-2, 2, 9], v : [-1, 1, 9], color : 0;
        geodesic g(t) : plane = (0, 1) @ (k, -0.5), t : [0, 1, 9]";
    let solid = "solid plane(x, y, z) = max(abs z - 1, abs x - 2, abs y - 1), color : 0;
        geodesic g(t) : plane = (0, 1, 0) @ (k, -0.5, 1), t : [0, 1, 9]";
    let camera = GeodesicCamera::new(ObjectId::new(0)).zoomed(1.0);
    let on_top = Pose::InSpace {
        at: Some([0.0, 0.0, 1.0]),
        angle: 0.0,
    };
    let poses = [camera.at([0.0, 0.0]).pose, on_top];
    for (object, pose) in [chart, solid].into_iter().zip(poses) {
        let mut request = three(object);
        request.view = GeodesicOptions::from(GeodesicCamera { pose, ..camera }).into();
        request.overlays.legend = true;
        let mut renderer = Renderer::software();
        let drawn = renderer.draw(&request).expect("a picture");
        let image = renderer.read(drawn.image).expect("in memory");
        for expected in 0..3 {
            let seen = image.pixels().filter(|pixel| {
                let others = (0..3).filter(|k| *k != expected);
                pixel.0[expected] > 200 && others.map(|k| pixel.0[k]).all(|part| part < 40)
            });
            assert!(seen.count() > 10, "{object}: {expected}");
        }
    }
}

#[test]
fn strokes_have_the_colours_of_their_instances() {
    for object in &OF_THREE[2..] {
        let request = three(object);
        let layers = render::render_layers(&Views::standard(), &request, &|_| {});
        let strokes = layers.expect("a picture").strokes;
        let colours: Vec<[u8; 3]> = strokes.iter().map(|it| it.colour).collect();
        if object.starts_with("surface s") || object.starts_with("solid") {
            assert_eq!(colours, [[0; 3]; 0]);
            continue;
        }
        for colour in [[255, 0, 0], [0, 255, 0], [0, 0, 255]] {
            assert!(colours.contains(&colour), "{object}: {colours:?}");
        }
    }
}

#[test]
fn an_instance_is_picked_by_its_number_whatever_its_colour() {
    for object in OF_THREE {
        let request = three(object);
        let mut renderer = Renderer::software();
        let camera = renderer.camera(&request).expect("a camera");
        for (x, expected) in [-1.0, 0.0, 1.0].into_iter().zip(0..3) {
            let place = camera.placement.local(WorldPoint([x, 0.0, 0.0]));
            let at = camera.pixel_of(place).expect("in front");
            let hit = renderer.pick(&request, at).expect("picked");
            assert_eq!(hit.map(|hit| hit.instance), Some(expected), "{object}");
        }
    }
}

#[test]
fn inside_a_solid_a_stated_colour_wins_and_else_the_last_chosen_one() {
    let scene = crate::scenes::scene(
        "solid green(x, y, z) = x^2 + y^2 + z^2 - 1, color : (0.1, 0.8, 0.1);
        solid plain(x, y, z) = (x - 5)^2 + y^2 + z^2 - 1;",
    );
    let params = Arc::new(ParamValues::initial(&scene));
    let [green, plain] = [0, 1].map(ObjectId::new);
    let seen = |object: ObjectId, colours: &[(ObjectId, [u8; 3])]| {
        let options = GeodesicOptions::from(GeodesicCamera::new(object));
        let mut request = PictureRequest::new(&scene, params.clone(), options, [SIDE; 2]);
        request.colours = colours.to_vec();
        image(&mut Renderer::software(), &request)
    };
    let [red, blue] = [[255, 0, 0], [0, 0, 255]];
    assert_eq!(seen(green, &[(green, red)]), seen(green, &[]));
    assert_eq!(
        seen(plain, &[(plain, red), (plain, blue)]),
        seen(plain, &[(plain, blue)])
    );
    assert_ne!(seen(plain, &[(plain, blue)]), seen(plain, &[]));
}

#[test]
fn each_instance_has_the_colours_of_its_places_and_its_grid_value() {
    let gpu = Gpu::shared().expect("a GPU or software Vulkan");
    let text = "grid k : [-1, 1, 3];
        surface s(u, v) = (k + u, v, 0), u : [-0.3, 0.3], v : [-0.3, 0.3],
            color : ((k(k-1))/2, 1 - k^2, 0.9(k(k+1))/2 + (u + 0.3)/9);";
    let scene = crate::scenes::scene(text);
    let eye = SpaceOptions::seen_from([0.0, 0.0, 6.0], [0.0; 3]);
    let params = Arc::new(ParamValues::initial(&scene));
    let request = PictureRequest::new(&scene, params, eye, [3 * SIDE, SIDE]);
    for mut renderer in [Renderer::software(), Renderer::on_gpu(gpu)] {
        let drawn = renderer.draw(&request).expect("a picture");
        assert_eq!(drawn.notes, []);
        let image = renderer.read(drawn.image).expect("the device is there");
        for (x, expected) in [-1.0, 0.0, 1.0].into_iter().zip(0..3) {
            let found = channel(&image, &request, [x, 0.0, 0.0]);
            assert_eq!(found, Some(expected), "at {x}");
        }
    }
}

#[test]
fn instances_beyond_the_last_image_are_noted() {
    let text = "grid k : [0, 1, 5000];
        surface s(u, v) = (u, v, k), u : [0, 1, 2], v : [0, 1, 2], color : (u, k, 0);";
    let scene = crate::scenes::scene(text);
    let eye = SpaceOptions::seen_from([0.0, 0.0, 6.0], [0.0; 3]);
    let params = Arc::new(ParamValues::initial(&scene));
    let request = PictureRequest::new(&scene, params, eye, [SIDE; 2]);
    let (_, notes) = request.with_stated_colours();
    assert!(notes.len() == 1 && notes[0].contains("`s`"), "{notes:?}");
}

#[test]
fn clamped_and_undefined_colours_are_noted_in_space_and_from_inside() {
    let clamped = "`color` of `s` is out of range somewhere: it is clamped there";
    let undefined = "`color` of `s` is undefined somewhere: its default is used there";
    let surface = "surface s(u, v) = (u, v, 0), u : [-1, 1], v : [-1, 1], color :";
    let solid = "solid s(x, y, z) = x^2 + y^2 + z^2 - 1, color :";
    for (object, colour, expected) in [
        ("point s = (0, 0, 0), color :", "(k, 0, 0)", vec![clamped]),
        (
            "point s = (0, 0, 0), color :",
            "(1/(k - 2), 0, 0)",
            vec![undefined],
        ),
        (
            "point s = (0, 0, 0), color :",
            "(k/2 + 1e-12, 0, 0)",
            vec![],
        ),
        (surface, "(k, 0, 0)", vec![clamped]),
        (surface, "(u, 0, 0)", vec![clamped]),
        (surface, "(sqrt u, 0, k)", vec![undefined, clamped]),
        (surface, "(u^2, 0, k/2)", vec![]),
        (solid, "(k, 0, 0)", vec![clamped]),
    ] {
        let scene = crate::scenes::scene(&format!("param k = 2 : [0, 3]; {object} {colour};"));
        let params = Arc::new(ParamValues::initial(&scene));
        let s = ObjectId::new(0);
        let mut views = vec![SpaceOptions::seen_from([0.0, 0.0, 4.0], [0.0; 3]).into()];
        if !object.starts_with("point") {
            let inside = GeodesicCamera::new(s).zoomed(0.5);
            views.push(GeodesicOptions::from(inside).into());
        }
        let mut renderer = Renderer::software();
        for view in views {
            let view: render::request::ViewPart = view;
            let request = PictureRequest::new(&scene, params.clone(), view, [SIDE; 2]);
            let drawn = renderer
                .draw(&request)
                .expect("a picture")
                .notes
                .into_iter();
            let remarks = drawn.filter_map(|note| match note {
                render::Note::Remark(text) => Some(text),
                render::Note::Cost(_) => None,
            });
            assert_eq!(remarks.collect::<Vec<_>>(), expected, "{object} {colour}");
        }
    }
}
