//! From maps to colours: the geodesic view's second half, on maps with known ends.

use geodesic::map::Map;
use geodesic::surface::Sides;
use geodesic::trace::Status;
use image::{Rgba, RgbaImage};
use render::geodesic_view::{Paint, hatching, resolve};
use render::style;
use render::texture::Texture;

const UNIT: [[f64; 2]; 2] = [[0.0, 1.0], [0.0, 1.0]];

fn map(size: u32, end: impl Fn(u32, u32) -> ([f32; 2], Status)) -> Map {
    let pixels = (0..size).flat_map(|y| (0..size).map(move |x| (x, y)));
    let (offset, status) = pixels.map(|(x, y)| end(x, y)).unzip();
    Map {
        size: [size, size],
        offset,
        status,
        ..Map::default()
    }
}

fn paint(texture: &Texture) -> Paint<'_> {
    Paint {
        texture,
        colour: [1.0; 3],
        domain: UNIT,
        sides: Sides::default(),
        mark_centre: false,
    }
}

/// A colourful image that is different everywhere.
fn colourful(side: u32) -> RgbaImage {
    RgbaImage::from_fn(side, side, |x, y| {
        Rgba([(x * 37 + y) as u8, (y * 59) as u8, (x * y * 7) as u8, 255])
    })
}

#[test]
fn a_map_of_texel_centres_shows_the_image_itself() {
    let image = colourful(40);
    let texture = Texture::from_image(image.clone());
    let centres = map(40, |x, y| {
        (
            [(x as f32 + 0.5) / 40.0, (y as f32 + 0.5) / 40.0],
            Status::Complete,
        )
    });
    let seen = resolve(&centres, &paint(&texture));
    let off = seen
        .pixels()
        .zip(image.pixels())
        .filter(|(a, b)| (0..3).any(|k| a.0[k].abs_diff(b.0[k]) > 1));
    assert_eq!(off.count(), 0);
}

#[test]
fn the_domain_is_one_width_of_the_image_and_colours_multiply() {
    let texture = Texture::from_image(RgbaImage::from_fn(2, 1, |x, _| {
        if x == 0 {
            Rgba([0, 0, 0, 255])
        } else {
            Rgba([255; 4])
        }
    }));
    let ends = map(2, |x, _| {
        ([-3.0 + 8.0 * (x as f32 + 0.5) / 2.0, 7.0], Status::Complete)
    });
    let paint = Paint {
        colour: [1.0, 0.25, 0.0],
        domain: [[-3.0, 5.0], [0.0, 9.0]],
        ..paint(&texture)
    };
    let seen = resolve(&ends, &paint);
    assert_eq!(seen.get_pixel(1, 0).0, [255, style::encode(0.25), 0, 255]);
    assert_eq!(seen.get_pixel(0, 0).0, [0, 0, 0, 255]);
}

#[test]
fn a_seam_of_the_chart_is_no_edge_of_the_picture() {
    let texture = Texture::orientation();
    let shifted = |by: f32| {
        let ends = map(64, |x, y| {
            let u = (x as f32 + 0.5) / 640.0 + by;
            (
                [u.rem_euclid(1.0), 0.3 + y as f32 / 640.0],
                Status::Complete,
            )
        });
        resolve(&ends, &paint(&texture))
    };
    // The same stretch of the image across u = 1, once told by coordinates that jump and once by ones that do not.
    let jumping = shifted(0.96);
    let smooth = map(64, |x, y| {
        (
            [(x as f32 + 0.5) / 640.0 + 0.96, 0.3 + y as f32 / 640.0],
            Status::Complete,
        )
    });
    let smooth = resolve(&smooth, &paint(&texture));
    let differ = |(a, b): &(&Rgba<u8>, &Rgba<u8>)| (0..3).any(|k| a.0[k].abs_diff(b.0[k]) > 2);
    assert_eq!(
        jumping.pixels().zip(smooth.pixels()).filter(differ).count(),
        0
    );
}

#[test]
fn what_is_not_seen_is_hatched_in_light_tones_with_an_edge_line() {
    let texture = Texture::from_image(RgbaImage::from_pixel(1, 1, Rgba([0, 90, 0, 255])));
    let all = [
        Status::LeftDomain,
        Status::ConePoint,
        Status::Degenerate,
        Status::Undefined,
        Status::WorkLimit,
    ];
    for status in all {
        let ends = map(64, |x, _| {
            ([0.5; 2], if x < 32 { Status::Complete } else { status })
        });
        let seen = resolve(&ends, &paint(&texture));
        assert_eq!(seen.get_pixel(31, 5).0, [0, 90, 0, 255]);
        for y in 0..64 {
            let darkest = (33..64)
                .map(|x| seen.get_pixel(x, y).0[..3].iter().copied().min())
                .min()
                .flatten();
            assert!(darkest >= Some(160), "{status:?}: {darkest:?} in row {y}");
            let (edge, paper) = (seen.get_pixel(32, y).0[1], hatching(status)[0][1]);
            assert!(
                edge.saturating_add(50) < paper && edge > 90,
                "{status:?}: {edge} beside {paper}"
            );
        }
    }
    let mut papers: Vec<[u8; 3]> = all.iter().map(|&status| hatching(status)[0]).collect();
    papers.dedup();
    assert_eq!(papers.len(), all.len(), "each reason has its own tone");
}

#[test]
fn the_mark_is_an_open_ring_that_leaves_the_centre_as_it_is() {
    let texture = Texture::from_image(RgbaImage::from_pixel(1, 1, Rgba([40, 120, 200, 255])));
    for size in [64, 65, 512] {
        let ends = map(size, |_, _| ([0.5; 2], Status::Complete));
        let seen = resolve(
            &ends,
            &Paint {
                mark_centre: true,
                ..paint(&texture)
            },
        );
        let middle = size / 2;
        for (x, y) in [(middle, middle), (middle - 1, middle), (middle, middle - 1)] {
            assert_eq!(
                seen.get_pixel(x, y).0,
                [40, 120, 200, 255],
                "at {x}, {y} of {size}"
            );
        }
        let marked = seen
            .pixels()
            .filter(|pixel| pixel.0 != [40, 120, 200, 255])
            .count();
        assert!(
            marked > 20 && marked < (size * size / 20) as usize,
            "{marked} pixels are marked"
        );
        let lightest = (middle..size).map(|x| seen.get_pixel(x, middle).0[0]).max();
        assert!(lightest > Some(180), "{lightest:?}");
    }
}

#[test]
fn a_fine_pattern_far_away_is_averaged_and_does_not_flicker() {
    let checker = RgbaImage::from_fn(256, 256, |x, y| {
        if (x + y) % 2 == 0 {
            Rgba([255; 4])
        } else {
            Rgba([0, 0, 0, 255])
        }
    });
    let texture = Texture::from_image(checker);
    // 37 widths of the image in 64 pixels.
    let ends = map(64, |x, y| {
        (
            [
                (x as f32 * 37.0 / 64.0).fract(),
                (y as f32 * 37.0 / 64.0).fract(),
            ],
            Status::Complete,
        )
    });
    let seen = resolve(&ends, &paint(&texture));
    for pixel in seen.pixels() {
        assert!(pixel.0[0].abs_diff(style::encode(0.5)) <= 3, "{pixel:?}");
    }
}
