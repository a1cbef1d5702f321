//! From maps to colours: the geodesic view's second half, on maps with known ends.

use std::sync::Arc;

use geodesic::map::Map;
use geodesic::surface::{Side, Sides};
use geodesic::trace::Status;
use image::{Rgba, RgbaImage};
use render::geodesic_view::{Paint, hatching, resolve};
use render::style;
use render::texture::{Proportions, Texture};

const UNIT: [[f64; 2]; 2] = [[0.0, 1.0], [0.0, 1.0]];
const WRAPPED: Sides = Sides {
    u: [Side::Wrap; 2],
    v: [Side::Wrap; 2],
};

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

fn paint(texture: &Arc<Texture>) -> Paint<'_> {
    Paint {
        texture,
        colour: [1.0; 3],
        domain: UNIT,
        sides: WRAPPED,
        mark_centre: false,
        coarse: false,
    }
}

/// A texture of an image.
fn image_of(image: RgbaImage) -> Arc<Texture> {
    Arc::new(Texture::from_image(image))
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
    let texture = image_of(image.clone());
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
    let texture = image_of(RgbaImage::from_fn(2, 1, |x, _| {
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
    let texture = Texture::orientation(Proportions::Even, false);
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
    let texture = image_of(RgbaImage::from_pixel(1, 1, Rgba([0, 90, 0, 255])));
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
    let texture = image_of(RgbaImage::from_pixel(1, 1, Rgba([40, 120, 200, 255])));
    for size in [64, 65, 512] {
        let ends = map(size, |_, _| ([0.5; 2], Status::Complete));
        let seen = resolve(
            &ends,
            &Paint {
                mark_centre: true,
                coarse: false,
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
    let texture = image_of(checker);
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

#[test]
fn a_known_derivative_is_the_footprint_whatever_the_neighbours_are() {
    let checker = image_of(RgbaImage::from_fn(256, 256, |x, y| {
        if (x + y) % 2 == 0 {
            Rgba([255; 4])
        } else {
            Rgba([0, 0, 0, 255])
        }
    }));
    // All pixels end in one texel: by differences it is seen large, by the derivative far away.
    let mut ends = map(16, |_, _| ([0.5 / 256.0; 2], Status::Complete));
    assert_eq!(resolve(&ends, &paint(&checker)).get_pixel(8, 8).0, [255; 4]);
    ends.by_pixel = vec![[[0.06, 0.01], [-0.01, 0.07]]; 256];
    let seen = resolve(&ends, &paint(&checker)).get_pixel(8, 8).0;
    assert!(seen[0].abs_diff(style::encode(0.5)) <= 3, "{seen:?}");
    // What is not known (NaN) is taken from the neighbours.
    ends.by_pixel = vec![[[f32::NAN; 2]; 2]; 256];
    assert_eq!(resolve(&ends, &paint(&checker)).get_pixel(8, 8).0, [255; 4]);
}

#[test]
fn beyond_a_flip_the_image_is_upside_down_and_the_seam_is_no_edge() {
    let gradient = image_of(RgbaImage::from_fn(8, 64, |_, y| {
        Rgba([(4 * y) as u8, 0, 0, 255])
    }));
    let sides = Sides {
        u: [Side::WrapFlip; 2],
        v: [Side::Edge; 2],
    };
    let flipped = Paint {
        sides,
        ..paint(&gradient)
    };
    for (turns, mirrored) in [
        (0.0, false),
        (1.0, true),
        (2.0, false),
        (-1.0, true),
        (-2.0, false),
    ] {
        let ends = map(64, |x, y| {
            let (u, v) = ((x as f32 + 0.5) / 64.0, (y as f32 + 0.5) / 64.0);
            ([u + turns, v], Status::Complete)
        });
        let seen = resolve(&ends, &flipped);
        for y in 0..64 {
            let from = if mirrored { 63 - y } else { y };
            // The seam's own columns are between both sides.
            let off = seen.get_pixel(32, y).0[0].abs_diff((4 * from) as u8);
            assert!(off <= 4, "row {y} after {turns} turns");
        }
    }
}

#[test]
fn an_image_does_not_go_on_beyond_an_edge_or_a_pole() {
    let bands = image_of(RgbaImage::from_fn(4, 16, |_, y| {
        if y < 8 {
            Rgba([255; 4])
        } else {
            Rgba([0, 0, 0, 255])
        }
    }));
    for side in [Side::Edge, Side::Pole] {
        let sides = Sides {
            u: [Side::Wrap; 2],
            v: [side; 2],
        };
        let ends = map(16, |x, _| ([x as f32 / 16.0, 0.0], Status::Complete));
        let paint = Paint {
            sides,
            ..paint(&bands)
        };
        let seen = resolve(&ends, &paint);
        assert!(seen.pixels().all(|pixel| pixel.0 == [255; 4]), "{side:?}");
    }
}

#[test]
fn a_deep_zoom_sees_the_texel_that_it_stands_in_from_edge_to_edge() {
    let image = colourful(64);
    let texture = image_of(image);
    let steps = |size: f32| {
        let mut ends = map(64, |x, y| {
            let at = |x: u32| (x as f32 - 31.5) * size;
            ([at(x), at(y)], Status::Complete)
        });
        ends.origin = [20.5 / 64.0, 40.5 / 64.0];
        resolve(&ends, &paint(&texture))
    };
    // Pixels of a thousandth of a texel: the colours follow the offsets, not f32 coordinates.
    let (near, nearer) = (steps(1e-3 / 64.0), steps(1e-12));
    let row: Vec<u8> = (0..64).map(|x| near.get_pixel(x, 32).0[0]).collect();
    // From the middle of a texel to both sides, evenly: towards the darker neighbour hardly, towards the brighter one
    // by a shade or two a pixel.
    assert!(
        row.windows(2).all(|pair| pair[0].abs_diff(pair[1]) <= 3),
        "{row:?}"
    );
    assert!(
        row[..32].windows(2).all(|pair| pair[0] >= pair[1]),
        "{row:?}"
    );
    assert!(
        row[32..].windows(2).all(|pair| pair[0] <= pair[1]),
        "{row:?}"
    );
    assert!(row[0] > row[31] + 10, "{row:?}");
    let centre = nearer.get_pixel(0, 0);
    assert!(nearer.pixels().all(|pixel| pixel == centre));
}

#[test]
fn a_coarse_picture_takes_one_of_two_levels_as_often_as_a_fine_one_blends_them() {
    // Black and white on the first level, grey on all others.
    let checker = RgbaImage::from_fn(64, 64, |x, y| {
        let light = if (x + y) % 2 == 0 { 255 } else { 0 };
        Rgba([light, light, light, 255])
    });
    let texture = image_of(checker);
    for footprint in [1.1_f32, 1.3, 1.4, 1.5, 1.6, 1.9] {
        let texel = 1.0 / 64.0;
        let centres = map(64, |x, y| {
            let at = [x, y].map(|side| (side as f32 + 0.5) * texel);
            (at, Status::Complete)
        });
        let centres = Map {
            by_pixel: vec![[[footprint * texel, 0.0], [0.0, footprint * texel]]; 64 * 64],
            ..centres
        };
        // How far a pixel is from grey.
        let contrasts = |coarse| -> Vec<f32> {
            let paint = Paint {
                coarse,
                ..paint(&texture)
            };
            let picture = resolve(&centres, &paint);
            let contrast = |pixel: &Rgba<u8>| 2.0 * (style::decode(pixel.0[0]) - 0.5).abs();
            picture.pixels().map(contrast).collect()
        };
        let mean = |contrasts: &[f32]| contrasts.iter().sum::<f32>() / contrasts.len() as f32;
        let (fine, coarse) = (contrasts(false), contrasts(true));
        assert!(coarse.iter().all(|it| !(0.02..=0.98).contains(it)));
        let (fine, coarse) = (mean(&fine), mean(&coarse));
        assert!(
            (fine - coarse).abs() < 1.0 / 16.0,
            "{footprint}: {fine} and {coarse}"
        );
    }
}
