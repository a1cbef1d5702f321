//! Fields for numbers. The input is a constant expression of the language, and is taken over when the field loses the
//! focus; a text that is not a number, and the displayed text, leave the old value.

use std::cell::RefCell;
use std::ops::RangeInclusive;
use std::rc::Rc;

use egui::emath::Numeric;
use egui::{DragValue, Id, Slider, Ui};
use session::StatusMessage;
use session::constant::{self, REFUSAL};
use session::measuring::{PLAIN, number};

/// The number of decimals up to which small numbers are displayed without an exponent.
const MOST_DECIMALS: usize = 9;

/// Returns a field for a number.
pub(crate) fn field<'a>(ui: &Ui, value: &'a mut impl Numeric) -> DragValue<'a> {
    let text = DisplayedText::default();
    DragValue::new(value)
        .update_while_editing(false)
        .custom_formatter(text.formatter(displayed))
        .custom_parser(text.parser(ui))
}

/// Gives a slider's field the same behaviour; `displayed` formats its number.
pub(crate) fn of_slider<'a>(
    ui: &Ui,
    slider: Slider<'a>,
    displayed: impl Fn(f64, RangeInclusive<usize>) -> String + 'static,
) -> Slider<'a> {
    let text = DisplayedText::default();
    slider
        .update_while_editing(false)
        .custom_formatter(text.formatter(displayed))
        .custom_parser(text.parser(ui))
}

/// Formats a number with as many decimals as it needs, within a range of their number.
pub(crate) fn displayed(value: f64, decimals: RangeInclusive<usize>) -> String {
    let (least, most) = decimals.into_inner();
    let size = value.abs();
    if size >= PLAIN.end || (most > MOST_DECIMALS && size > 0.0 && size < PLAIN.start) {
        return number(value);
    }
    let text = format!("{value:.most$}");
    let text = match text.find('.') {
        Some(dot) => {
            let end = text.trim_end_matches('0').len().max(dot + 1 + least);
            text[..end].trim_end_matches('.')
        }
        None => &text,
    };
    let is_zero = !text.contains(|c: char| ('1'..='9').contains(&c));
    let unsigned = text.strip_prefix('-').filter(|_| is_zero);
    unsigned.unwrap_or(text).to_owned()
}

/// Shows in the status line why a text was refused, until a later one is a number.
pub(crate) fn report(message: &mut Option<StatusMessage>, ui: &Ui) {
    match ui.data_mut(|data| data.remove_temp::<Option<String>>(typed())) {
        Some(Some(sentence)) => *message = Some(StatusMessage::error(sentence)),
        Some(None) => withdraw(message),
        None => {}
    }
}

/// Returns whether a number has been typed into a field in this frame.
pub(crate) fn is_typed(ui: &Ui) -> bool {
    ui.data(|data| data.get_temp::<Option<String>>(typed()).is_some())
}

/// Removes the sentence about a refused text.
pub(crate) fn withdraw(message: &mut Option<StatusMessage>) {
    message.take_if(|it| it.text.contains(REFUSAL));
}

/// The text that a field displays, with its number. A field that loses the focus without an edit has this text, which may
/// be rounded: it stands for the number that was displayed.
#[derive(Clone, Default)]
struct DisplayedText(Rc<RefCell<Option<(String, f64)>>>);

impl DisplayedText {
    /// Returns the conversion from a number to the text of the field.
    fn formatter(
        &self,
        displayed: impl Fn(f64, RangeInclusive<usize>) -> String + 'static,
    ) -> impl Fn(f64, RangeInclusive<usize>) -> String + 'static {
        let last = self.clone();
        move |value, decimals| {
            let text = displayed(value, decimals);
            last.0.replace(Some((text.clone(), value)));
            text
        }
    }

    /// Returns the conversion from the text of the field to a number.
    fn parser(self, ui: &Ui) -> impl Fn(&str) -> Option<f64> + 'static {
        let context = ui.ctx().clone();
        move |text| {
            let unchanged = self.0.borrow().clone();
            let unchanged = unchanged.filter(|(shown, _)| shown == text);
            let value = unchanged.map_or_else(|| constant::value(text), |(_, value)| Ok(value));
            let refused = value.as_ref().err().cloned();
            context.data_mut(|data| data.insert_temp(typed(), refused));
            context.request_repaint();
            value.ok()
        }
    }
}

/// Returns the id under which the sentence about the last typed text waits for [`report`]; none is stored if the text
/// is a number.
fn typed() -> Id {
    Id::unique("text of a field for a number")
}

#[cfg(test)]
mod tests {
    use super::displayed;

    #[test]
    fn numbers_are_displayed_with_the_decimals_that_they_need() {
        for (value, decimals, wanted) in [
            (1.0 / 3.0, 0..=3, "0.333"),
            (0.5, 0..=3, "0.5"),
            (2.0, 0..=3, "2"),
            (2.0, 1..=3, "2.0"),
            (20.0, 0..=0, "20"),
            (100.0, 0..=2, "100"),
            (5e-7, 0..=9, "0.0000005"),
            (-5.46e-10, 0..=12, "-5.46e-10"),
            (-1e-5, 0..=3, "0"),
            (0.0, 0..=12, "0"),
            (1.000_000_226_85, 0..=9, "1.000000227"),
            (-1e300, 0..=0, "-1e300"),
            (1.25e20, 0..=0, "1.25e20"),
        ] {
            assert_eq!(displayed(value, decimals), wanted);
        }
    }
}
