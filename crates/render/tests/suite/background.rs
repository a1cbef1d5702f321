//! What lies behind the objects of the 3D view, and what sets one of them off, on both backends.

use std::sync::Arc;

use crate::scenes::Wanted;
use image::RgbaImage;
use render::{Backend, style};
use scene::ParamValues;
use scene::{ObjectId, Scene};

const SCENE: &str = "
    curve c(t) = (cos t, sin t, 0.3 t), t : [0, 2pi, 80];
    surface s(u, v) = (u, v, u v), u : [-1, 1, 20], v : [-1, 1, 20];
    vector w = (0, 0, 1) @ (0, 0, 0);
    point p = (1, 1, 1);
";
const BACKENDS: [Backend; 2] = [Backend::Software, Backend::Gpu];

fn compiled(text: &str) -> (Arc<Scene>, ParamValues) {
    let scene = crate::scenes::scene(text);
    let params = ParamValues::initial(&scene);
    (scene, params)
}

fn drawn(backend: Backend, change: impl FnOnce(&mut Wanted)) -> RgbaImage {
    let (scene, params) = compiled(SCENE);
    let mut request = Wanted::space([320, 240]);
    request.backend = backend;
    change(&mut request);
    request
        .draw(&scene, &params)
        .expect("a picture; the GPU or software Vulkan")
        .image
}

/// A picture over a colour, composited in linear light.
fn over(picture: &RgbaImage, behind: [u8; 3]) -> RgbaImage {
    let mut picture = picture.clone();
    for pixel in picture.pixels_mut() {
        let alpha = f32::from(pixel.0[3]) / 255.0;
        for (byte, behind) in pixel.0.iter_mut().zip(behind) {
            let (front, back) = (style::decode(*byte), style::decode(behind));
            *byte = style::encode(back + alpha * (front - back));
        }
        pixel.0[3] = 255;
    }
    picture
}

fn farthest(a: &RgbaImage, b: &RgbaImage) -> u8 {
    let pairs = a.as_raw().iter().zip(b.as_raw());
    pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
}

#[test]
fn a_background_takes_the_place_of_the_usual_one() {
    for backend in BACKENDS {
        let usual = drawn(backend, |_| {});
        let [r, g, b] = style::BACKGROUND;
        assert_eq!(
            usual,
            drawn(backend, |request| request.in_space().background =
                Some([r, g, b, 255]))
        );
        let white = drawn(backend, |request| {
            request.in_space().background = Some([255; 4])
        });
        assert_eq!(white.get_pixel(0, 0).0, [255; 4]);
        assert!(white.pixels().all(|pixel| pixel.0[3] == 255));
        assert_ne!(usual, white);
    }
}

#[test]
fn a_transparent_picture_over_the_usual_background_is_the_usual_picture() {
    for (backend, bound) in [(Backend::Software, 2), (Backend::Gpu, 5)] {
        let usual = drawn(backend, |_| {});
        let clear = drawn(backend, |request| {
            request.in_space().background = Some([0; 4])
        });
        assert_eq!(clear.get_pixel(0, 0).0, [0; 4]);
        let partly = clear
            .pixels()
            .filter(|p| (1..255).contains(&p.0[3]))
            .count();
        assert!(partly > 50, "{backend:?}: {partly} pixels on edges");
        let off = farthest(&over(&clear, style::BACKGROUND), &usual);
        assert!(off <= bound, "{backend:?}: {off} of 255");
    }
}

#[test]
fn a_half_transparent_background_keeps_its_colour() {
    for backend in BACKENDS {
        let picture = drawn(backend, |request| {
            request.in_space().background = Some([200, 100, 50, 128])
        });
        let [r, g, b, a] = picture.get_pixel(0, 0).0;
        let off = [r.abs_diff(200), g.abs_diff(100), b.abs_diff(50)];
        assert_eq!(a, 128, "{backend:?}");
        assert!(off.iter().all(|&off| off <= 2), "{backend:?}: {r} {g} {b}");
    }
}

#[test]
fn a_highlight_changes_its_object_and_nothing_else() {
    let apart = |a: &RgbaImage, b: &RgbaImage| -> Vec<bool> {
        a.pixels().zip(b.pixels()).map(|(a, b)| a != b).collect()
    };
    for backend in BACKENDS {
        let usual = drawn(backend, |_| {});
        for object in (0..4).map(ObjectId::new) {
            // An object is seen where the picture depends on its colour.
            let [black, white] = [[0; 3], [255; 3]]
                .map(|colour| drawn(backend, |request| request.colours = vec![(object, colour)]));
            let seen = apart(&black, &white);
            let highlit = drawn(backend, |request| {
                request.in_space().highlight = Some(object)
            });
            let changed = apart(&usual, &highlit);
            let count = changed.iter().filter(|&&changed| changed).count();
            let elsewhere = changed.iter().zip(&seen).filter(|(c, s)| **c && !**s);
            assert_eq!(elsewhere.count(), 0, "{backend:?}: {object:?}");
            let all = seen.iter().filter(|&&seen| seen).count();
            assert!(
                count >= 8 && 20 * count > 19 * all,
                "{backend:?}: {object:?}: {count} of {all}"
            );
        }
        let nobody = drawn(backend, |request| {
            request.in_space().highlight = Some(ObjectId::new(77))
        });
        assert_eq!(usual, nobody);
    }
}
