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
    OUTLINE * height
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
    // The stems of small letters cover no pixel whole: stronger, they and their outline are solid.
    for coverage in &mut mask {
        *coverage = (STRENGTH * *coverage).min(1.0);
    }
    let around = grown(&mask, size, reach);
    for (k, (around, coverage)) in around.into_iter().zip(mask).enumerate() {
        if around > 0.0 {
            let [x, y] = [k % size[0], k / size[0]];
            let place = [corner[0] + x as f32, corner[1] + y as f32];
            lay(image, place, ink.outline, ink.share * around);
            lay(image, place, ink.words, ink.share * coverage);
        }
    }
}

/// Returns a mask of a width and height with a rim around it: at each pixel the greatest coverage within reach, less of it
/// over the last pixel of the way.
fn grown(mask: &[f32], size: [usize; 2], reach: f32) -> Vec<f32> {
    let steps = reach.ceil() as isize + 1;
    // The steps from a pixel with the squares of their lengths, and the share of the coverage there.
    let mut near: Vec<([isize; 2], usize, f32)> = (-steps..=steps)
        .flat_map(|dy| (-steps..=steps).map(move |dx| [dx, dy]))
        .map(|step| {
            let [dx, dy] = step;
            let share = reach + 0.5 - (dx as f32).hypot(dy as f32);
            (step, (dx * dx + dy * dy) as usize, share.min(1.0))
        })
        .filter(|(_, _, share)| *share > 0.0)
        .collect();
    near.sort_by_key(|(_, square, _)| *square);
    let whole = near.partition_point(|(_, _, share)| *share >= 1.0);
    let whole = near[..whole].last().map_or(0, |(_, square, _)| *square);
    let to_covered = squared_distances(mask, size, steps as usize, |it| it > 0.0);
    let to_solid = squared_distances(mask, size, steps as usize, |it| it >= 1.0);
    let at = |k: usize, [dx, dy]: [isize; 2]| {
        let x = (k % size[0]).checked_add_signed(dx)?;
        let y = (k / size[0]).checked_add_signed(dy)?;
        let inside = x < size[0] && y < size[1];
        inside.then(|| mask[y * size[0] + x])
    };
    let rim = |(k, (covered, solid)): (usize, (&usize, &usize))| {
        if *solid <= whole {
            return 1.0;
        }
        let first = near.partition_point(|(_, square, _)| square < covered);
        let mut greatest = 0.0_f32;
        for (step, _, share) in &near[first..] {
            // What is farther counts no more than its share.
            if *share <= greatest {
                break;
            }
            greatest = greatest.max(share * at(k, *step).unwrap_or(0.0));
        }
        greatest
    };
    let distances = to_covered.iter().zip(&to_solid);
    distances.enumerate().map(rim).collect()
}

/// Returns the square of each pixel's distance from the nearest one whose coverage counts; beyond `reach` it is only known to
/// be greater than that.
fn squared_distances(
    mask: &[f32],
    [width, _]: [usize; 2],
    reach: usize,
    counts: impl Fn(f32) -> bool,
) -> Vec<usize> {
    let far = reach + 1;
    // Within a column first, then over the columns.
    let mut within = vec![far; mask.len()];
    for k in 0..mask.len() {
        let above = k.checked_sub(width).map_or(far, |above| within[above]);
        within[k] = if counts(mask[k]) {
            0
        } else {
            far.min(above + 1)
        };
    }
    for k in (0..mask.len().saturating_sub(width)).rev() {
        within[k] = within[k].min(within[k + width] + 1);
    }
    let rows = within.chunks(width.max(1));
    let nearest = |row: &[usize], x: usize| {
        let mut least = row[x] * row[x];
        for across in 1..=far {
            if across * across >= least {
                break;
            }
            let sides = [x.checked_sub(across), Some(x + across)];
            let columns = sides.into_iter().flatten().filter_map(|x| row.get(x));
            for column in columns {
                least = least.min(across * across + column * column);
            }
        }
        least
    };
    rows.flat_map(|row| (0..row.len()).map(move |x| nearest(row, x)))
        .collect()
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

#[cfg(test)]
mod tests {
    use super::{grown, squared_distances};

    /// A disc with a soft edge, a thin line that is nowhere solid, and single pixels at the border.
    fn mask([width, height]: [usize; 2]) -> Vec<f32> {
        let coverage = |k: usize| {
            let [x, y] = [k % width, k / width].map(|part| part as f32);
            let disc = (6.3 - (x - 14.0).hypot(y - 12.0)).clamp(0.0, 1.0);
            let line = if (x - y - 9.0).abs() < 1.0 { 0.4 } else { 0.0 };
            let border = if k.is_multiple_of(97) { 0.7 } else { 0.0 };
            disc.max(line).max(border)
        };
        (0..width * height).map(coverage).collect()
    }

    #[test]
    fn a_rim_is_the_greatest_coverage_within_reach() {
        let size = [61, 40];
        let mask = mask(size);
        let pixels = || (0..mask.len()).map(|k| [k % size[0], k / size[0]].map(|part| part as f32));
        for reach in [1.0, 2.4, 7.0, 13.3] {
            let grown = grown(&mask, size, reach);
            for (k, [x, y]) in pixels().enumerate() {
                let shares = pixels().zip(&mask).map(|([a, b], coverage)| {
                    coverage * (reach + 0.5 - (x - a).hypot(y - b)).clamp(0.0, 1.0)
                });
                let expected = shares.fold(0.0, f32::max);
                let found = grown[k];
                assert!(
                    (found - expected).abs() < 1e-6,
                    "reach {reach}, ({x}, {y}): {found} instead of {expected}"
                );
            }
        }
    }

    #[test]
    fn distances_beyond_the_reach_are_only_known_to_be_greater() {
        let size = [30, 20];
        let mut mask = vec![0.0; 600];
        mask[5 * 30 + 7] = 1.0;
        let squares = squared_distances(&mask, size, 6, |it| it > 0.0);
        for (k, square) in squares.into_iter().enumerate() {
            let (x, y) = ((k % 30).abs_diff(7), (k / 30).abs_diff(5));
            let expected = x * x + y * y;
            assert!(
                square == expected || square.min(expected) > 36,
                "{k}: {square}"
            );
        }
    }
}
