//! Colours that a script states as `rgb(…)` with numbers.

use super::CrtAnalysis;
use crate::color::StatedColor;

/// Returns the stated colours, in the order of the text.
pub(super) fn colors(analysis: &CrtAnalysis) -> Vec<StatedColor> {
    let mut colors: Vec<StatedColor> = analysis
        .names()
        .colors
        .iter()
        .map(|(span, rgb)| StatedColor {
            span: *span,
            rgb: rgb.map(|part| part.clamp(0.0, 1.0)),
        })
        .collect();
    colors.sort_by_key(|color| color.span);
    colors
}

/// Returns the texts that denote a colour.
pub(super) fn color_texts(rgb: [f64; 3]) -> Vec<String> {
    let [red, green, blue] = rgb.map(|part| (part * 1000.0).round() / 1000.0);
    vec![format!("rgb({red}, {green}, {blue})")]
}
