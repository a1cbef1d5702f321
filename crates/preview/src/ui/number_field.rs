//! Fields for numbers. The input is a constant expression of the language, and is taken over when the field loses the
//! focus; a text that is not a number leaves the old value.

use egui::emath::Numeric;
use egui::{DragValue, Id, Slider, Ui};
use session::StatusMessage;
use session::constant::{self, REFUSAL};

/// Returns a field for a number.
pub(crate) fn field<'a>(ui: &Ui, value: &'a mut impl Numeric) -> DragValue<'a> {
    DragValue::new(value)
        .update_while_editing(false)
        .custom_parser(parser(ui))
}

/// Gives a slider's field the same behaviour.
pub(crate) fn of_slider<'a>(ui: &Ui, slider: Slider<'a>) -> Slider<'a> {
    slider.update_while_editing(false).custom_parser(parser(ui))
}

/// Shows in the status line why a text was refused, until a later one is a number.
pub(crate) fn report(message: &mut Option<StatusMessage>, ui: &Ui) {
    match ui.data_mut(|data| data.remove_temp::<Option<String>>(typed())) {
        Some(Some(sentence)) => *message = Some(StatusMessage::error(sentence)),
        Some(None) => {
            message.take_if(|it| it.text.contains(REFUSAL));
        }
        None => {}
    }
}

fn parser(ui: &Ui) -> impl Fn(&str) -> Option<f64> + 'static {
    let context = ui.ctx().clone();
    move |text| {
        let value = constant::value(text);
        let refused = value.as_ref().err().cloned();
        context.data_mut(|data| data.insert_temp(typed(), refused));
        context.request_repaint();
        value.ok()
    }
}

/// Returns the id under which the sentence about the last typed text waits for [`report`]; none is stored if the text
/// is a number.
fn typed() -> Id {
    Id::unique("text of a field for a number")
}
