//! The numbers of a script's settings: a row for each, whose value is written into the text.

use egui::{Grid, Ui};
use scene::StatedSetting;

use crate::ui::number_field;
use crate::ui::window::Window;

/// Draws the rows of a program that states its picture.
pub(super) fn show(window: &mut Window, ui: &mut Ui) {
    let scene = window.model.scene.clone();
    let Some(picture) = scene.as_ref().and_then(|scene| scene.picture.as_ref()) else {
        return;
    };
    ui.separator();
    ui.strong("Settings of the script");
    Grid::new("settings of the script")
        .num_columns(2)
        .show(ui, |ui| {
            for setting in picture.settings() {
                let label = ui.label(setting.word).on_hover_text(setting.purpose);
                if let Some(value) = edited(ui, &setting, label.id) {
                    window.write_numbers(setting.word, vec![value]);
                }
                ui.end_row();
            }
        });
}

/// Shows a field for a number. Returns the new value when the user has finished editing.
fn edited(ui: &mut Ui, setting: &StatedSetting, label: egui::Id) -> Option<f64> {
    // While it is dragged or typed, the number is not yet a value of the text.
    let id = ui.scope_id().with(setting.word);
    let mut value = ui.data(|data| data.get_temp(id)).unwrap_or(setting.value);
    let [min, max] = setting.range;
    let field = number_field::field(ui, &mut value).range(min..=max);
    let field = match setting.is_whole {
        true => field.speed(0.1).fixed_decimals(0),
        false => field.speed(0.01).max_decimals(3),
    };
    let field = ui.add(field).labelled_by(label);
    if field.changed() {
        ui.data_mut(|data| data.insert_temp(id, value));
    }
    let is_held = field.dragged() || field.has_focus();
    if is_held && !field.lost_focus() {
        return None;
    }
    let kept: Option<f64> = ui.data_mut(|data| data.remove_temp(id));
    kept.filter(|kept| *kept != setting.value)
}
