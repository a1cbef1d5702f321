//! The key to a picture: only what the picture has, in the corner in which least is seen, as large as the picture is.

use geodesic::trace::Status;
use image::RgbaImage;

use super::lines::SCALE;
use super::{cover, text};
use crate::geodesic_view::stripes;
use crate::request::PictureRequest;
use crate::style::{self, Theme};
use crate::texture::CurvatureScale;

/// The width of a bar of colours, in heights of its words.
const BAR: f32 = 9.0;
/// The least factor of its lines and words, in a picture that is not magnified.
const LEAST_UNIT: f32 = 0.65;
/// The share of its pixels that may show something where a key is at its usual place.
const EMPTY: f64 = 0.05;
/// A corner is another's place if its pixels that show something are at most this share of the other's.
const MUCH_EMPTIER: f64 = 0.5;
/// The colour of words, in linear light.
const INK: [f32; 3] = [0.01; 3];

/// Entries of a key, as they come.
#[derive(Clone, Debug, Default)]
pub(super) struct Legend {
    /// The medium, for which the colours of its lines are chosen.
    theme: Theme,
    entries: Vec<(Mark, String)>,
}

/// The swatch before the words.
#[derive(Clone, Copy, Debug)]
enum Mark {
    Hatching(Status),
    Line([u8; 3]),
    Error,
    Curvature(CurvatureScale),
}

impl Mark {
    /// The number of lines that its entry takes.
    fn lines(self) -> f32 {
        match self {
            Self::Curvature(_) => 3.0,
            _ => 1.0,
        }
    }
}

/// The measures of a key, in pixels.
#[derive(Clone, Copy, Debug)]
struct LegendLayout {
    /// A pixel of a picture of the usual size.
    unit: f32,
    /// The height of words.
    text: f32,
    /// The height of a line of words.
    line: f32,
    /// The width that is left free at the edges.
    pad: f32,
    /// The width of a swatch.
    swatch: f32,
    /// The width of the widest entry.
    widest: f32,
    /// Width and height of all.
    size: [u32; 2],
}

impl Legend {
    /// Creates a key without entries.
    pub(super) fn new(theme: Theme) -> Self {
        Self {
            theme,
            entries: Vec::new(),
        }
    }

    /// A line of a colour (sRGB).
    pub(super) fn line(&mut self, colour: [u8; 3], words: &str) {
        self.entries.push((Mark::Line(colour), words.to_owned()));
    }

    /// A hatching.
    pub(super) fn hatching(&mut self, status: Status) {
        let words = match status {
            Status::Complete => return,
            Status::LeftDomain => "beyond the edge",
            Status::ConePoint => "ended at a cone's tip",
            Status::Degenerate => "no tangent plane",
            Status::Undefined => "undefined",
            Status::WorkLimit => "unresolved: work limit",
        };
        self.entries
            .push((Mark::Hatching(status), words.to_owned()));
    }

    /// The scale of errors.
    pub(super) fn error(&mut self) {
        let marks: Vec<String> = SCALE.iter().map(|(error, _)| error.to_string()).collect();
        let words = format!("error: {} px", marks.join(", "));
        self.entries.push((Mark::Error, words));
    }

    /// The scale of a surface's curvature.
    pub(super) fn curvature(&mut self, surface: &str, scale: CurvatureScale) {
        let words = format!("Gaussian curvature K of {surface}");
        self.entries.push((Mark::Curvature(scale), words));
    }

    /// Returns true if it has no entries.
    pub(super) fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Returns the place of the key in a picture: left, top, right and bottom in pixels; `None` if it has no entries or the
    /// picture no room for it. It is the lower left corner, unless another one is much emptier; `is_covered` returns true for
    /// pixels that show something.
    ///
    /// Lines and words are `unit` times as large as usual: see [`unit`].
    pub(super) fn place(
        &self,
        size: [u32; 2],
        unit: f32,
        is_covered: impl Fn([u32; 2]) -> bool,
    ) -> Option<[f32; 4]> {
        let [width, height] = self.layout(size, unit)?.size;
        let (right, bottom) = (size[0] - width, size[1] - height);
        let corners = [[0, bottom], [right, bottom], [0, 0], [right, 0]];
        let covered = |[left, top]: [u32; 2]| {
            let rows = top..top + height;
            let pixels = rows.flat_map(|y| (left..left + width).map(move |x| [x, y]));
            pixels.filter(|pixel| is_covered(*pixel)).count() as f64
        };
        let usual = covered(corners[0]);
        let least = EMPTY * f64::from(width) * f64::from(height);
        let mut best = ([0, bottom], usual);
        if usual > least {
            for corner in &corners[1..] {
                let here = covered(*corner);
                if here < best.1.min(MUCH_EMPTIER * usual) {
                    best = (*corner, here);
                }
            }
        }
        let [left, top] = best.0;
        Some([left, top, left + width, top + height].map(|side| side as f32))
    }

    fn layout(&self, size: [u32; 2], unit: f32) -> Option<LegendLayout> {
        let (text, line, pad, swatch) = (16.0 * unit, 22.0 * unit, 8.0 * unit, 28.0 * unit);
        let width_of = |(mark, words): &(Mark, String)| match mark {
            // A bar with its numbers lies under its words.
            Mark::Curvature(_) => text::width(words, text).max(BAR * text) + pad,
            _ => swatch + pad + text::width(words, text),
        };
        let widest = self.entries.iter().map(width_of).fold(0.0, f32::max);
        let lines: f32 = self.entries.iter().map(|(mark, _)| mark.lines()).sum();
        let width = (2.0 * pad + widest).ceil() as u32;
        let height = (2.0 * pad + line * lines).ceil() as u32;
        let has_room = width <= size[0] && height <= size[1];
        (!self.entries.is_empty() && has_room).then_some(LegendLayout {
            unit,
            text,
            line,
            pad,
            swatch,
            widest,
            size: [width, height],
        })
    }

    /// Draws the key at its [place](Self::place), if it has one.
    ///
    /// Lines and words are `unit` times as large as usual.
    pub(super) fn draw(&self, image: &mut RgbaImage, unit: f32, place: Option<[f32; 4]>) {
        let size = [image.width(), image.height()];
        let (Some(layout), Some([left, top, ..])) = (self.layout(size, unit), place) else {
            return;
        };
        let LegendLayout {
            unit,
            text,
            line,
            pad,
            swatch,
            widest,
            size: [width, height],
        } = layout;
        for y in top as u32..top as u32 + height {
            for x in left as u32..left as u32 + width {
                cover(&mut image.get_pixel_mut(x, y).0, [0.92; 3], 0.9);
            }
        }
        let (left, mut y) = (left + pad, top + pad);
        for (mark, words) in &self.entries {
            let tall = 0.75 * line;
            if let Mark::Curvature(scale) = mark {
                text::write(image, words, [left, y], text, INK);
                let bar = [widest - pad, tall];
                self.swatch(image, *mark, [left, y + line], bar, unit);
                let places = [0.0, 0.5, 1.0];
                for (share, words) in places.into_iter().zip(bar_numbers(*scale)) {
                    let x = left + share * (bar[0] - text::width(&words, text));
                    text::write(image, &words, [x, y + 1.8 * line], text, INK);
                }
            } else {
                self.swatch(image, *mark, [left, y], [swatch, tall], unit);
                let at = [left + pad + swatch, y + 0.5 * (tall - text)];
                text::write(image, words, at, text, INK);
            }
            y += line * mark.lines();
        }
    }

    /// Returns the colour behind lines, in linear light.
    fn ground(&self) -> [f32; 3] {
        match self.theme {
            Theme::Screen => [0.12; 3],
            Theme::Print => style::linear(style::PAPER),
        }
    }

    fn swatch(&self, image: &mut RgbaImage, mark: Mark, at: [f32; 2], size: [f32; 2], unit: f32) {
        let half = (1.1 * unit).max(0.7);
        let middle = at[1] + 0.5 * size[1];
        for y in at[1] as u32..(at[1] + size[1]) as u32 {
            for x in at[0] as u32..(at[0] + size[0]) as u32 {
                let pixel = &mut image.get_pixel_mut(x, y).0;
                match mark {
                    Mark::Hatching(status) => {
                        cover(pixel, stripes(status, (x + y) as f32 + 1.0, unit), 1.0);
                    }
                    Mark::Line(colour) => {
                        cover(pixel, self.ground(), 1.0);
                        let off = (y as f32 + 0.5 - middle).abs();
                        let share = (half - off + 0.5).clamp(0.0, 1.0);
                        cover(pixel, style::linear(colour), share);
                    }
                    Mark::Curvature(scale) => {
                        let share = (x as f32 + 0.5 - at[0]) / size[0];
                        let curvature = f64::from(2.0 * share - 1.0) * scale.most;
                        cover(pixel, style::linear(scale.colour(curvature)), 1.0);
                    }
                    Mark::Error => {
                        let share = (x as f32 - at[0]) / size[0];
                        let step = ((share * SCALE.len() as f32) as usize).min(SCALE.len() - 1);
                        cover(pixel, style::linear(SCALE[step].1), 1.0);
                    }
                }
            }
        }
    }
}

/// Returns the factor of the lines and words of a key in a picture.
pub(super) fn unit(request: &PictureRequest) -> f32 {
    (style::pixel_unit(request.size) * request.scale).max(LEAST_UNIT / request.magnification)
}

/// The numbers under the bar of a scale; where the surface is more curved than its ends, they say so.
fn bar_numbers(scale: CurvatureScale) -> [String; 3] {
    if scale.is_flat {
        return ["", "0", ""].map(str::to_owned);
    }
    let end = digits(scale.most);
    let [at_most, at_least] = match scale.is_clipped {
        true => ["\u{2264} ", "\u{2265} "],
        false => ["", ""],
    };
    let low = format!("{at_most}\u{2212}{end}");
    [low, "0".to_owned(), format!("{at_least}{end}")]
}

/// A number that is not negative, to three digits; it has all of them, so that it is as long when it changes.
pub(super) fn fixed_digits(number: f64) -> String {
    let exponent = if number > 0.0 {
        number.log10().floor()
    } else {
        0.0
    };
    if !(-4.0..6.0).contains(&exponent) {
        return format!("{number:.2e}");
    }
    let places = (2.0 - exponent).max(0.0) as usize;
    format!("{number:.places$}")
}

/// A number that is not negative, to three digits at most.
pub(super) fn digits(number: f64) -> String {
    if number == 0.0 {
        return "0".to_owned();
    }
    let text = fixed_digits(number);
    if text.contains('e') {
        return text;
    }
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::{Legend, bar_numbers, digits, fixed_digits};
    use crate::texture::CurvatureScale;

    #[test]
    fn a_length_that_grows_keeps_its_digits() {
        let shown = [0.0, 0.5, 1.2, 99.96].map(fixed_digits);
        assert_eq!(shown, ["0.00", "0.500", "1.20", "100.0"]);
    }

    #[test]
    fn a_key_is_in_an_emptier_corner_if_there_is_one() {
        let mut key = Legend::default();
        key.line([255; 3], "a line");
        let size = [400, 300];
        let at = |is_covered: &dyn Fn([u32; 2]) -> bool| {
            let place = key.place(size, 1.0, is_covered).expect("room");
            [place[0] > 0.0, place[1] > 0.0]
        };
        let (lower_left, lower_right, upper_left) = ([false, true], [true, true], [false, false]);
        assert_eq!(at(&|_| false), lower_left);
        assert_eq!(at(&|_| true), lower_left);
        assert_eq!(at(&|[x, y]| x == 0 && y > 295), lower_left);
        assert_eq!(at(&|[x, _]| x < 200), lower_right);
        assert_eq!(at(&|[_, y]| y >= 150), upper_left);
        assert_eq!(at(&|[x, y]| y >= 150 || x < 200), [true, false]);
    }

    #[test]
    fn numbers_of_legends_have_three_digits() {
        let shown = [
            0.0, 0.25, 1.0, 1.5, 123.456, 0.012_345, 99_999.0, 1e-7, 2.5e9,
        ]
        .map(digits);
        assert_eq!(
            shown,
            [
                "0", "0.25", "1", "1.5", "123", "0.0123", "99999", "1.00e-7", "2.50e9"
            ]
        );
    }

    #[test]
    fn the_numbers_of_a_scale_say_where_the_surface_is_more_curved() {
        let numbers = |is_clipped| {
            bar_numbers(CurvatureScale {
                most: 25.0 / 6.0,
                is_clipped,
                is_flat: false,
            })
        };
        assert_eq!(numbers(false), ["−4.17", "0", "4.17"]);
        assert_eq!(numbers(true), ["≤ −4.17", "0", "≥ 4.17"]);
    }
}
