//! Textures: mip chains, filtering, files.

use std::sync::Arc;

use image::{Rgba, RgbaImage};
use render::PictureRequest;
use render::request::part::SpaceOptions;
use render::style;
use render::texture::{Proportions, TexelBudget, Texture, TextureError};
use scene::{ObjectId, ParamValues};

#[test]
fn a_fine_checkerboard_keeps_its_brightness_in_every_level() {
    let checker = RgbaImage::from_fn(64, 48, |x, y| {
        if (x + y) % 2 == 0 {
            Rgba([255; 4])
        } else {
            Rgba([0, 0, 0, 255])
        }
    });
    let texture = Texture::from_image(checker);
    let sizes: Vec<[u32; 2]> = texture.levels().iter().map(|level| level.size).collect();
    assert_eq!(
        sizes,
        [[64, 48], [32, 24], [16, 12], [8, 6], [4, 3], [2, 1], [1, 1]]
    );
    for level in &texture.levels()[1..] {
        for texel in &level.texels {
            let light = style::decode(texel[0]);
            assert!((light - 0.5).abs() < 0.01, "{texel:?} in {:?}", level.size);
        }
    }
}

#[test]
fn odd_sides_are_averaged_without_loss() {
    let image = RgbaImage::from_fn(5, 1, |x, _| {
        if x == 2 {
            Rgba([255; 4])
        } else {
            Rgba([0, 0, 0, 255])
        }
    });
    let texture = Texture::from_image(image);
    let light: Vec<f32> = texture.levels()[1]
        .texels
        .iter()
        .map(|texel| style::decode(texel[0]))
        .collect();
    // Each of the two texels covers 2.5 of the five, and half of the middle one.
    for light in light {
        assert!((light - 0.2).abs() < 0.005, "{light}");
    }
}

#[test]
fn a_large_image_is_reduced_in_linear_light() {
    let checker = |width, height| {
        RgbaImage::from_fn(width, height, |x, y| {
            let byte = if (x + y) % 2 == 0 { 255 } else { 0 };
            Rgba([byte, byte, byte, 255])
        })
    };
    // By the longest side, and by the number of texels: 33,554,432.
    for (size, reduced) in [([16_384, 6], [8_192, 3]), ([8_192, 8_192], [5_793, 5_793])] {
        let texture = Texture::from_image(checker(size[0], size[1]));
        let level = &texture.levels()[0];
        assert_eq!(level.size, reduced);
        let light = level
            .texels
            .iter()
            .map(|texel| f64::from(style::decode(texel[0])));
        let mean = light.sum::<f64>() / level.texels.len() as f64;
        assert!((mean - 0.5).abs() < 0.01, "{size:?}: {mean}");
    }
}

#[test]
fn an_image_of_the_earth_keeps_as_much_as_a_texture_holds() {
    let texture = Texture::from_image(RgbaImage::new(10_800, 5_400));
    assert_eq!(texture.levels()[0].size, [8_192, 4_096]);
    // Turned over beyond a side, it has twice the width: so it is halved first.
    let cover = Arc::new(texture).cover([true, false]);
    assert_eq!(cover.levels()[0].size, [8_192, 2_048]);
    // One that has room for that stays as sharp, however long it becomes.
    let texture = Texture::from_image(RgbaImage::new(6_000, 2_000));
    let cover = Arc::new(texture).cover([true, false]);
    assert_eq!(cover.levels()[0].size, [12_000, 2_000]);
}

#[test]
fn an_image_repeats_and_interpolates_between_texel_centres() {
    let image = RgbaImage::from_fn(2, 1, |x, _| {
        if x == 0 {
            Rgba([0, 0, 0, 255])
        } else {
            Rgba([255; 4])
        }
    });
    let texture = Texture::from_image(image);
    let light = |u: f32| texture.sample([u, 0.5], [0.0; 2], [0.0; 2])[0];
    for (u, expected) in [
        (0.25, 0.0),
        (0.75, 1.0),
        (0.5, 0.5),
        (0.0, 0.5),
        (1.0, 0.5),
        (0.625, 0.75),
    ] {
        for shift in [0.0, 1.0, -3.0, 64.0] {
            let seen = light(u + shift);
            assert!(
                (seen - expected).abs() < 1e-4,
                "{seen} at {u} + {shift}, not {expected}"
            );
        }
    }
}

#[test]
fn a_large_footprint_gives_the_mean_and_a_long_one_is_not_blurred_across() {
    let stripes = RgbaImage::from_fn(64, 64, |x, _| {
        if x < 32 {
            Rgba([0, 0, 0, 255])
        } else {
            Rgba([255; 4])
        }
    });
    let texture = Texture::from_image(stripes);
    let mean = texture.sample([0.3, 0.3], [1.0, 0.0], [0.0, 1.0])[0];
    assert!((mean - 0.5).abs() < 0.03, "{mean}");
    let along = texture.sample([0.4, 0.3], [0.0, 0.1], [1e-4, 0.0])[0];
    assert!(along < 0.01, "{along}: blurred over the edge at u = 1/2");
    let endless = texture.sample([0.4, 0.3], [f32::INFINITY, 0.0], [0.0, 1.0])[0];
    assert!((endless - 0.5).abs() < 0.03, "{endless}");
}

#[test]
fn what_is_transparent_shows_white() {
    let texture = Texture::from_image(RgbaImage::from_pixel(1, 1, Rgba([0, 0, 0, 0])));
    assert_eq!(texture.levels()[0].texels, [[255; 4]]);
}

#[test]
fn the_default_texture_distinguishes_left_from_right_and_up_from_down() {
    let texture = Texture::orientation(Proportions::Even, false);
    let level = &texture.levels()[0];
    let [width, height] = level.size.map(|side| side as usize);
    let at = |x: usize, y: usize| level.texels[y * width + x];
    let count = |map: &dyn Fn(usize, usize) -> [u8; 4]| {
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        places.filter(|&(x, y)| at(x, y) != map(x, y)).count()
    };
    let most = width * height * 9 / 10;
    assert!(count(&|x, y| at(width - 1 - x, y)) > most);
    assert!(count(&|x, y| at(x, height - 1 - y)) > most);
    assert!(count(&|x, y| at(width - 1 - x, height - 1 - y)) > most);
    assert!(count(&|x, y| at(y, x)) > most);
}

#[test]
fn colours_survive_the_way_to_light_and_back() {
    for byte in 0..=255 {
        assert_eq!(style::encode(style::decode(byte)), byte);
    }
}

#[test]
fn files_that_give_no_image_are_refused_by_name() {
    let missing = Texture::load("no/such/file.png".as_ref(), &TexelBudget::default());
    assert!(
        matches!(&missing, Err(TextureError::Unreadable { .. })),
        "{missing:?}"
    );
    assert!(missing.is_err_and(|error| error.to_string().contains("no/such/file.png")));
    let text = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml").as_ref();
    let text = Texture::load(text, &TexelBudget::default());
    assert!(
        matches!(&text, Err(TextureError::NotAnImage { message, .. }) if message.contains("first bytes")),
        "{text:?}"
    );
    // Pictures that are written may be GIFs, those that are read may not.
    let mut gif = std::io::Cursor::new(Vec::new());
    let image = image::RgbaImage::new(2, 2);
    let written = image.write_to(&mut gif, image::ImageFormat::Gif);
    written.expect("a GIF");
    let read = Texture::decode(gif.get_ref(), "a.gif".as_ref(), &TexelBudget::default());
    let message = read.map(drop).expect_err("refused").to_string();
    assert!(
        message.ends_with("is not a PNG or JPEG image that can be read: it is a GIF file"),
        "{message}"
    );
}

#[test]
fn a_long_surface_has_more_cells_along_its_length() {
    let cells = |text: &str| {
        let scene = scene::geotrace::compile(text).scene.expect("no errors");
        let params = ParamValues::initial(&scene);
        let wanted = SpaceOptions::default();
        let request = PictureRequest::new(scene, params, wanted, [8, 8]);
        let size = request.texture(ObjectId::new(0)).levels()[0].size;
        size.map(|side| side / 128)
    };
    let tube = "(cos(v)/2, sin(v)/2, u)";
    for (text, expected) in [
        (
            "surface s(u, v) = (u, v, 0), u : [0, 1], v : [0, 1];",
            [8, 8],
        ),
        (
            "surface s(u, v) = (u, v, 0), u : [0, 8], v : [0, 1];",
            [8, 8],
        ),
        (
            "surface s(u, v) = (u, v, 0), u : [0, 1], v : [0, 8];",
            [8, 8],
        ),
        (
            "surface s(u, v) = (u, v, 0), u : [0, 10], v : [0, 1];",
            [24, 3],
        ),
        (
            "surface s(u, v) = (u, v, 0), u : [0, 1], v : [0, 10];",
            [3, 24],
        ),
        (
            &format!("surface s(u, v) = {tube}, u : [0, 30], v : [0, 2pi];"),
            [24, 3],
        ),
        (
            "metric h(u, v) = (100, 0, 1), u : [0, 1], v : [0, 1];",
            [24, 3],
        ),
        (
            "metric h(u, v) = (1, 0, 1)/v^2, u : [0, 1], v : [1, 12];",
            [3, 24],
        ),
        // The lines that shrink to a pole do not count.
        (
            "metric h(r, a) = 4(1, 0, r^2)/(1 - r^2)^2, r : [0, 0.995], a : [0, 2pi];",
            [8, 8],
        ),
        // What a slider does not change.
        (
            "param a = 1 : [1, 20]; surface s(u, v) = (a u, v, 0), u : [0, 1], v : [0, 1];",
            [8, 8],
        ),
        (
            "surface s(u, v) = (sqrt(-1), v, 0), u : [0, 1], v : [0, 1];",
            [8, 8],
        ),
    ] {
        assert_eq!(cells(text), expected, "{text}");
    }
}
