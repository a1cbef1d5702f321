//! Words in pictures.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, ScaleFont, point};
use image::RgbaImage;

use super::cover;

/// Hack, which the window's texts use too (MIT and Bitstream Vera licences).
static FONT: LazyLock<Option<FontRef<'static>>> =
    LazyLock::new(|| FontRef::try_from_slice(epaint_default_fonts::HACK_REGULAR).ok());

/// The width of a text in pixels; `height` is that of a line.
pub(super) fn width(text: &str, height: f32) -> f32 {
    let Some(font) = FONT.as_ref() else {
        return 0.0;
    };
    let font = font.as_scaled(height);
    text.chars()
        .map(|c| font.h_advance(font.scaled_glyph(c).id))
        .sum()
}

/// Writes a text with its upper left corner at `at`, in linear light.
pub(super) fn write(
    image: &mut RgbaImage,
    text: &str,
    at: [f32; 2],
    height: f32,
    colour: [f32; 3],
) {
    let Some(font) = FONT.as_ref() else {
        return;
    };
    let scaled = font.as_scaled(height);
    let mut x = at[0];
    for c in text.chars() {
        let mut glyph = scaled.scaled_glyph(c);
        glyph.position = point(x, at[1] + scaled.ascent());
        x += scaled.h_advance(glyph.id);
        let Some(outline) = font.outline_glyph(glyph) else {
            continue;
        };
        let corner = outline.px_bounds().min;
        outline.draw(|dx, dy, coverage| {
            let place = [corner.x + dx as f32, corner.y + dy as f32];
            let inside = place[0] >= 0.0
                && place[1] >= 0.0
                && place[0] < image.width() as f32
                && place[1] < image.height() as f32;
            if inside {
                let pixel = image.get_pixel_mut(place[0] as u32, place[1] as u32);
                cover(&mut pixel.0, colour, coverage.clamp(0.0, 1.0));
            }
        });
    }
}
