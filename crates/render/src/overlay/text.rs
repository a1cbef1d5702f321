//! Words in pictures.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, Glyph, OutlineCurve, ScaleFont, point};
use image::RgbaImage;

use super::cover;
use crate::style::encode;

/// Ubuntu Light, which the window's texts use too (Ubuntu font licence), and for letters that it lacks Hack (MIT and
/// Bitstream Vera licences).
#[cfg(not(reduced_fonts))]
const FONT_FILES: [&[u8]; 2] = [
    epaint_default_fonts::UBUNTU_LIGHT,
    epaint_default_fonts::HACK_REGULAR,
];

/// The same outlines in less than half as many bytes, which `web/fonts.mjs` makes for the page.
#[cfg(reduced_fonts)]
const FONT_FILES: [&[u8]; 2] = [
    include_bytes!(concat!(env!("GEOTRACE_FONTS"), "/Ubuntu-Light.ttf")),
    include_bytes!(concat!(env!("GEOTRACE_FONTS"), "/Hack-Regular.ttf")),
];

static FONTS: LazyLock<Vec<FontRef<'static>>> = LazyLock::new(|| {
    let fonts = FONT_FILES.into_iter();
    fonts
        .filter_map(|file| FontRef::try_from_slice(file).ok())
        .collect()
});

/// The thickness of an outline, as a share of the text's height.
const OUTLINE: f32 = 0.16;
/// The factor of the coverage of letters that have an outline.
const STRENGTH: f32 = 1.7;

/// The colours of words and of the outline around them, in linear light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ink {
    words: [f32; 3],
    outline: [f32; 3],
    /// The share of the picture that it covers, from 0 to 1.
    share: f32,
}

impl Ink {
    /// Light words over a dark ground (sRGB), and dark ones over a light ground.
    pub(super) fn over([r, g, b]: [u8; 3]) -> Self {
        let is_dark = 3 * u32::from(r) + 6 * u32::from(g) + u32::from(b) < 1280;
        let (light, dark) = ([0.92; 3], [0.008; 3]);
        let [words, outline] = if is_dark {
            [light, dark]
        } else {
            [dark, light]
        };
        Self {
            words,
            outline,
            share: 1.0,
        }
    }

    /// Returns the ink that covers a share of what is under it.
    #[must_use]
    pub(super) fn thinned(self, share: f32) -> Self {
        Self { share, ..self }
    }

    /// The colour of words, sRGB.
    pub(super) fn words_colour(self) -> [u8; 3] {
        self.words.map(encode)
    }

    /// The colour around them, sRGB.
    pub(super) fn rim_colour(self) -> [u8; 3] {
        self.outline.map(encode)
    }
}

/// The width of the rim around words; `height` is that of a line.
pub(super) fn rim(height: f32) -> f32 {
    (OUTLINE * height).max(1.0)
}

/// The size of the font's em square; `height` is that of a line.
pub(super) fn em(height: f32) -> f32 {
    let font = FONTS.first();
    let em = font.and_then(|font| Some(font.units_per_em()? / font.height_unscaled()));
    height * em.unwrap_or(1.0)
}

/// The left end of the line on which words stand whose upper left corner is at `at`.
pub(super) fn baseline(words: &str, at: [f32; 2], height: f32) -> [f32; 2] {
    let first = glyphs(words, at, height).into_iter().next();
    first.map_or(at, |(_, glyph)| [glyph.position.x, glyph.position.y])
}

/// A closed line around a part of a letter: where it begins, and cubic pieces with their two control points and their ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Contour {
    /// The beginning.
    pub start: [f32; 2],
    /// The pieces.
    pub pieces: Vec<[[f32; 2]; 3]>,
}

/// The letters of some words as contours; what is inside an odd number of them, or by the winding rule, is the letter.
pub fn outlines(placed: &super::PlacedWords) -> Vec<Contour> {
    let mut contours: Vec<Contour> = Vec::new();
    for (font, glyph) in glyphs(&placed.words, placed.corner, placed.height) {
        let Some(outline) = font.outline(glyph.id) else {
            continue;
        };
        let scaled = font.as_scaled(placed.height);
        let [across, down] = [scaled.h_scale_factor(), -scaled.v_scale_factor()];
        let on_picture = |place: ab_glyph::Point| {
            [
                glyph.position.x + across * place.x,
                glyph.position.y + down * place.y,
            ]
        };
        let mut end = None;
        for curve in &outline.curves {
            let points = match *curve {
                OutlineCurve::Line(a, b) => [a, a, b, b],
                // A parabola as a cubic.
                OutlineCurve::Quad(a, b, c) => {
                    let towards = |from: ab_glyph::Point| {
                        point(
                            from.x + 2.0 / 3.0 * (b.x - from.x),
                            from.y + 2.0 / 3.0 * (b.y - from.y),
                        )
                    };
                    [a, towards(a), towards(c), c]
                }
                OutlineCurve::Cubic(a, b, c, d) => [a, b, c, d],
            };
            let [start, first, second, last] = points.map(on_picture);
            if end != Some(start) {
                let pieces = Vec::new();
                contours.push(Contour { start, pieces });
            }
            if let Some(contour) = contours.last_mut() {
                contour.pieces.push([first, second, last]);
            }
            end = Some(last);
        }
    }
    contours
}

/// Returns the font that has a letter.
fn font_of(letter: char) -> Option<&'static FontRef<'static>> {
    let mut fonts = FONTS.iter();
    let has = |font: &&FontRef<'static>| font.glyph_id(letter).0 != 0;
    fonts.find(has).or(FONTS.first())
}

/// The letters of a text whose upper left corner is at `at`; `height` is that of a line.
fn glyphs(text: &str, at: [f32; 2], height: f32) -> Vec<(&'static FontRef<'static>, Glyph)> {
    let mut x = at[0];
    let mut baseline = None;
    let letters = text.chars().filter_map(|letter| {
        let font = font_of(letter)?;
        let scaled = font.as_scaled(height);
        let baseline = *baseline.get_or_insert(at[1] + scaled.ascent());
        let mut glyph = scaled.scaled_glyph(letter);
        glyph.position = point(x, baseline);
        x += scaled.h_advance(glyph.id);
        Some((font, glyph))
    });
    letters.collect()
}

/// The width of a text in pixels; `height` is that of a line.
pub(super) fn width(text: &str, height: f32) -> f32 {
    let advance = |letter: char| {
        let font = font_of(letter)?.as_scaled(height);
        Some(font.h_advance(font.glyph_id(letter)))
    };
    text.chars().filter_map(advance).sum()
}

/// Writes a text with its upper left corner at `at`, in linear light.
pub(super) fn write(
    image: &mut RgbaImage,
    text: &str,
    at: [f32; 2],
    height: f32,
    colour: [f32; 3],
) {
    for (font, glyph) in glyphs(text, at, height) {
        let Some(outline) = font.outline_glyph(glyph) else {
            continue;
        };
        let corner = outline.px_bounds().min;
        outline.draw(|dx, dy, coverage| {
            let place = [corner.x + dx as f32, corner.y + dy as f32];
            lay(image, place, colour, coverage);
        });
    }
}

/// Writes a text with an outline, so that it can be read on anything.
pub(super) fn write_outlined(
    image: &mut RgbaImage,
    text: &str,
    at: [f32; 2],
    height: f32,
    ink: Ink,
) {
    let reach = rim(height);
    let pad = reach.ceil() + 1.0;
    let size = [width(text, height) + 2.0 * pad, 1.3 * height + 2.0 * pad].map(f32::ceil);
    let size = size.map(|side| side as usize);
    let corner = at.map(|x| x.floor() - pad);
    // The text's own pixels, from its corner.
    let mut mask = vec![0.0_f32; size[0] * size[1]];
    for (font, glyph) in glyphs(text, [at[0] - corner[0], at[1] - corner[1]], height) {
        let Some(outline) = font.outline_glyph(glyph) else {
            continue;
        };
        let first = outline.px_bounds().min;
        outline.draw(|dx, dy, coverage| {
            let (x, y) = (first.x + dx as f32, first.y + dy as f32);
            let inside = x >= 0.0 && y >= 0.0 && x < size[0] as f32 && y < size[1] as f32;
            if inside {
                let pixel = &mut mask[y as usize * size[0] + x as usize];
                *pixel = pixel.max(coverage);
            }
        });
    }
    let steps = pad as isize;
    let near: Vec<(isize, isize, f32)> = (-steps..=steps)
        .flat_map(|dy| (-steps..=steps).map(move |dx| (dx, dy)))
        .map(|(dx, dy)| (dx, dy, reach + 0.5 - (dx as f32).hypot(dy as f32)))
        .filter(|(_, _, share)| *share > 0.0)
        .collect();
    // The stems of small letters cover no pixel whole: stronger, they and their outline are solid.
    for coverage in &mut mask {
        *coverage = (STRENGTH * *coverage).min(1.0);
    }
    let at_pixel = |x: isize, y: isize| {
        let inside = x >= 0 && y >= 0 && x < size[0] as isize && y < size[1] as isize;
        if inside {
            mask[y as usize * size[0] + x as usize]
        } else {
            0.0
        }
    };
    for y in 0..size[1] as isize {
        for x in 0..size[0] as isize {
            let around = near
                .iter()
                .map(|&(dx, dy, share)| share.min(1.0) * at_pixel(x + dx, y + dy));
            let around = around.fold(0.0, f32::max);
            if around > 0.0 {
                let place = [corner[0] + x as f32, corner[1] + y as f32];
                lay(image, place, ink.outline, ink.share * around);
                lay(image, place, ink.words, ink.share * at_pixel(x, y));
            }
        }
    }
}

/// Lays a colour over the pixel at a place, if it lies in the picture.
fn lay(image: &mut RgbaImage, place: [f32; 2], colour: [f32; 3], share: f32) {
    let [x, y] = place;
    let (width, height) = (image.width() as f32, image.height() as f32);
    if x >= 0.0 && y >= 0.0 && x < width && y < height && share > 0.0 {
        let pixel = image.get_pixel_mut(x as u32, y as u32);
        cover(&mut pixel.0, colour, share.clamp(0.0, 1.0));
    }
}
