//! The buttons beside the menus, for the most frequent actions: each has an icon, and shows its name and key on hover.

use egui::{Align, Layout, Ui};
use session::Marks;

use super::dialogs::{picture, record};
use super::icons::{Icon, button};
use super::{key_names, measure, navigation};
use crate::ui::window::Window;

/// The width of a button with its spacing, in points.
const BUTTON: f32 = 28.0;

/// The action of a button.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Action {
    Undo,
    Redo,
    Frame,
    Orthographic,
    Traced,
    Labels,
    Axes,
    Legend,
    Measure,
    Picture,
    Record,
}

/// The buttons from left to right: action, icon, name, key.
const BUTTONS: [(Action, Icon, &str, &str); 11] = [
    (Action::Undo, Icon::Undo, "Undo the last step", "Ctrl+Z"),
    (Action::Redo, Icon::Redo, "Redo the next step", "Ctrl+Y"),
    (Action::Frame, Icon::Frame, "Frame everything", "F"),
    (
        Action::Orthographic,
        Icon::Parallel,
        "Orthographic, with parallel lines of sight",
        "5",
    ),
    (
        Action::Traced,
        Icon::Traced,
        "Traced, with lights, shadows and mirrors",
        "T",
    ),
    (Action::Labels, Icon::Labels, "Show labels", ""),
    (Action::Axes, Icon::Axes, "Show axes", ""),
    (Action::Legend, Icon::Legend, "Show the legend", ""),
    (Action::Measure, Icon::Measure, "Measure by clicks", "M"),
    (Action::Picture, Icon::Picture, "Save a picture", "Ctrl+E"),
    (
        Action::Record,
        Icon::Record,
        "Record an animation",
        "Ctrl+R",
    ),
];

/// Shows the buttons at the right end of a bar, if there is room for all of them.
pub(crate) fn show(window: &mut Window, ui: &mut Ui) {
    if window.panes.is_welcome || ui.available_width() < BUTTON * BUTTONS.len() as f32 {
        return;
    }
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for (action, icon, name, key) in BUTTONS.into_iter().rev() {
            let hint = match key {
                "" => name.to_owned(),
                key => format!("{name} ({})", key_names::named(ui.ctx(), key)),
            };
            let is_on = is_on(window, action);
            let is_possible = is_possible(window, action);
            let pressed = ui.add_enabled_ui(is_possible, |ui| {
                button(ui, icon, is_on, name, &hint).clicked()
            });
            if pressed.inner {
                run(window, ui, action);
            }
        }
    });
}

fn is_on(window: &Window, action: Action) -> bool {
    let preferences = &window.model.choices.preferences;
    match action {
        Action::Orthographic => preferences.orthographic,
        Action::Traced => preferences.traced,
        Action::Labels => preferences.marks.labels,
        Action::Axes => preferences.marks.axes,
        Action::Legend => preferences.marks.legend,
        Action::Measure => window.dialogs.measuring.is_open(),
        _ => false,
    }
}

fn is_possible(window: &Window, action: Action) -> bool {
    let has_picture = || window.pictures.sent(&window.focus.view).is_some();
    match action {
        Action::Undo => window.model.history.last().is_some(),
        Action::Redo => window.model.history.next().is_some(),
        Action::Picture => has_picture(),
        Action::Record => has_picture() && window.dialogs.recording.is_none(),
        _ => true,
    }
}

fn run(window: &mut Window, ui: &Ui, action: Action) {
    match action {
        Action::Undo => window.undo(),
        Action::Redo => window.redo(),
        Action::Frame => window.frame(None),
        Action::Orthographic => navigation::toggle_orthographic(window),
        Action::Traced => window.toggle_traced(),
        Action::Labels => mark(window, |marks| marks.labels = !marks.labels),
        Action::Axes => mark(window, |marks| marks.axes = !marks.axes),
        Action::Legend => mark(window, |marks| marks.legend = !marks.legend),
        Action::Measure => measure::toggle(window),
        Action::Picture => picture::ask_for_picture(window),
        Action::Record => record::ask(window),
    }
    ui.ctx().request_repaint();
}

fn mark(window: &mut Window, change: impl FnOnce(&mut Marks)) {
    let mut marks = window.model.choices.preferences.marks.clone();
    change(&mut marks);
    window.model.set_marks(marks);
}
