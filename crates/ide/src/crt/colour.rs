//! Colours that a script states as `rgb(…)` with numbers.

use super::CrtAnalysis;
use crate::colour::WrittenColour;

/// Returns the stated colours, in the order of the text.
pub(super) fn colours(analysis: &CrtAnalysis) -> Vec<WrittenColour> {
    let mut colours: Vec<WrittenColour> = analysis
        .names()
        .colours
        .iter()
        .map(|(span, rgb)| WrittenColour {
            span: *span,
            rgb: rgb.map(|part| part.clamp(0.0, 1.0)),
        })
        .collect();
    colours.sort_by_key(|colour| colour.span);
    colours
}

/// Returns the texts that denote a colour.
pub(super) fn colour_texts(rgb: [f64; 3]) -> Vec<String> {
    let [red, green, blue] = rgb.map(|part| (part * 1000.0).round() / 1000.0);
    vec![format!("rgb({red}, {green}, {blue})")]
}
