//! Surfaces whose colour is stated as an expression: from inside and in space, on the software path.

mod scenes;

use std::sync::Arc;

use image::RgbaImage;
use render::gpu::Pixels;
use render::request::part::SpaceOptions;
use render::view::geodesic::GeodesicOptions;
use render::viewpoint::GeodesicCamera;
use render::{PictureRequest, Renderer};
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
    let scene = scenes::scene(TEXT);
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
    let scene = scenes::scene(TEXT);
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
