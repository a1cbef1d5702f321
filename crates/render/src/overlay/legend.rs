//! The key to a picture: only what the picture has, in its lower left corner.

use geodesic::trace::Status;
use image::RgbaImage;

use super::lines::SCALE;
use super::{StrokeStyle, cover, text};
use crate::geodesic_view::stripes;
use crate::style;
use crate::texture::CurvatureScale;

/// Entries of a key, as they come.
#[derive(Clone, Debug, Default)]
pub(super) struct Legend {
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

impl Legend {
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
            Status::WorkLimit => "unresolved: limit of work",
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
        let most = digits(scale.most);
        let words = format!("{surface}: K = \u{2212}{most}, 0, {most}");
        self.entries.push((Mark::Curvature(scale), words));
    }

    /// Returns true if it has no entries.
    pub(super) fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Draws the key, if it has entries and the picture room for it.
    pub(super) fn draw(&self, image: &mut RgbaImage) {
        let size = [image.width(), image.height()];
        let unit = style::pixel_unit(size).clamp(0.65, 8.0);
        let (text, line, pad, swatch) = (13.0 * unit, 19.0 * unit, 7.0 * unit, 26.0 * unit);
        let words = self.entries.iter().map(|(_, words)| words);
        let widest = words
            .map(|words| text::width(words, text))
            .fold(0.0, f32::max);
        let width = (3.0 * pad + swatch + widest).ceil() as u32;
        let height = (2.0 * pad + line * self.entries.len() as f32).ceil() as u32;
        if self.entries.is_empty() || width > size[0] || height > size[1] {
            return;
        }
        let top = size[1] - height;
        for y in top..size[1] {
            for x in 0..width {
                cover(&mut image.get_pixel_mut(x, y).0, [0.92; 3], 0.9);
            }
        }
        for (number, (mark, words)) in self.entries.iter().enumerate() {
            let y = top as f32 + pad + line * number as f32;
            self.swatch(image, *mark, [pad, y], [swatch, 0.75 * line], unit);
            let at = [2.0 * pad + swatch, y + 0.5 * (0.75 * line - text)];
            text::write(image, words, at, text, [0.01; 3]);
        }
    }

    fn swatch(&self, image: &mut RgbaImage, mark: Mark, at: [f32; 2], size: [f32; 2], unit: f32) {
        let half = StrokeStyle::for_size([image.width(), image.height()]).half;
        let middle = at[1] + 0.5 * size[1];
        for y in at[1] as u32..(at[1] + size[1]) as u32 {
            for x in at[0] as u32..(at[0] + size[0]) as u32 {
                let pixel = &mut image.get_pixel_mut(x, y).0;
                match mark {
                    Mark::Hatching(status) => {
                        cover(pixel, stripes(status, (x + y) as f32 + 1.0, unit), 1.0);
                    }
                    Mark::Line(colour) => {
                        cover(pixel, [0.12; 3], 1.0);
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

/// A positive number to three digits.
pub(super) fn digits(number: f64) -> String {
    let exponent = number.log10().floor();
    if !(-4.0..6.0).contains(&exponent) {
        return format!("{number:.2e}");
    }
    let places = (2.0 - exponent).max(0.0) as usize;
    let text = format!("{number:.places$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::digits;

    #[test]
    fn numbers_of_legends_have_three_digits() {
        let shown = [0.25, 1.0, 1.5, 123.456, 0.012_345, 99_999.0, 1e-7, 2.5e9].map(digits);
        assert_eq!(
            shown,
            [
                "0.25", "1", "1.5", "123", "0.0123", "99999", "1.00e-7", "2.50e9"
            ]
        );
    }
}
