//! The pictures of views, and the preferences of the window.

use egui::{ComboBox, Grid, Slider, Ui};
use session::{MOST_SAMPLES, Model, Preferences, SCALES, Step, Theme};

use crate::ui::colour;
use crate::ui::number_field;
use crate::ui::window::Window;

/// The minimum and maximum width of a slider, in points.
const SLIDER: [f32; 2] = [40.0, 150.0];

/// Draws the tab of the views.
pub(super) fn show(model: &mut Model, ui: &mut Ui) {
    // The slider has its name and its number beside it.
    ui.spacing_mut().slider_width = (ui.available_width() - 195.0).clamp(SLIDER[0], SLIDER[1]);
    let shown = model.background();
    edit(model, ui, "views", |preferences, ui| {
        let label = ui.label("Camera speed");
        let slider = Slider::new(&mut preferences.camera_speed, 0.05..=10.0).logarithmic(true);
        ui.add(number_field::of_slider(ui, slider, number_field::displayed))
            .labelled_by(label.id);
        ui.end_row();
        background(preferences, shown, ui);
        ui.end_row();
        side(ui, "3D pictures", &mut preferences.space_size);
        ui.end_row();
        let label = ui.label("Samples when traced");
        let hint =
            "The number of samples to which each pixel of a traced picture at rest is refined";
        let samples = number_field::field(ui, &mut preferences.samples).range(1..=MOST_SAMPLES);
        ui.add(samples).on_hover_text(hint).labelled_by(label.id);
        ui.end_row();
        side(ui, "Geodesic pictures", &mut preferences.inside_size);
        ui.end_row();
    });
}

/// Draws the tab of the preferences.
pub(super) fn preferences(model: &mut Model, ui: &mut Ui) {
    edit(model, ui, "preferences", |preferences, ui| {
        let label = ui.label("Theme");
        let named = |theme| match theme {
            Theme::System => "System",
            Theme::Light => "Light",
            Theme::Dark => "Dark",
        };
        ComboBox::from_id_salt("theme")
            .selected_text(named(preferences.theme))
            .show_ui(ui, |ui| {
                for theme in [Theme::System, Theme::Light, Theme::Dark] {
                    ui.selectable_value(&mut preferences.theme, theme, named(theme));
                }
            })
            .response
            .labelled_by(label.id);
        ui.end_row();
        let label = ui.label("Interface scale");
        let percent = |scale: f32| format!("{:.0} %", 100.0 * scale);
        ComboBox::from_id_salt("scale")
            .selected_text(percent(preferences.scale))
            .show_ui(ui, |ui| {
                for scale in SCALES {
                    ui.selectable_value(&mut preferences.scale, scale, percent(scale));
                }
            })
            .response
            .labelled_by(label.id);
        ui.end_row();
    });
    let mut write = model.choices.preferences.write_on_release;
    let text = "Update the program when a slider is released";
    if ui.checkbox(&mut write, text).changed() {
        model.change(Step::new("Change a setting", "write"), |choices| {
            choices.preferences.write_on_release = write;
        });
    }
    let mut run_times = model.choices.preferences.run_times;
    let hint = "In the status line: the renderer, the time for each picture, and its error";
    let tick = ui.checkbox(&mut run_times, "Show run times");
    if tick.on_hover_text(hint).changed() {
        model.change(Step::new("Change a setting", "run times"), |choices| {
            choices.preferences.run_times = run_times;
        });
    }
}

/// Draws the switch for saving the choices for all programs.
pub(super) fn memory(window: &mut Window, ui: &mut Ui) {
    let mut remembers = window.remembers_views();
    let hint = "In a hidden file, .NAME.gtr.geotrace.json: cameras, sliders, colours, panes";
    let tick = ui.checkbox(&mut remembers, "Remember views beside programs");
    if tick.on_hover_text(hint).changed() {
        window.remember_views(remembers);
    }
}

/// Shows preferences for editing in rows of two columns: a change is an undoable step.
fn edit(model: &mut Model, ui: &mut Ui, name: &str, show: impl FnOnce(&mut Preferences, &mut Ui)) {
    let mut preferences = model.choices.preferences.clone();
    let before = preferences.clone();
    Grid::new(name)
        .num_columns(2)
        .spacing([8.0, 6.0])
        .show(ui, |ui| show(&mut preferences, ui));
    if preferences != before {
        let step = Step::new("Change a setting", name);
        model.change(step, |choices| choices.preferences = preferences);
    }
}

fn background(preferences: &mut Preferences, shown: [u8; 3], ui: &mut Ui) {
    let label = ui.label("Background");
    let mut colour = shown;
    ui.horizontal(|ui| {
        let picker = colour::button(ui, &mut colour);
        if picker.labelled_by(label.id).changed() {
            preferences.background = Some(colour);
        }
        if preferences.background.is_some() && ui.small_button("As the theme").clicked() {
            preferences.background = None;
        }
    });
}

/// Shows the side of a picture: that of its pane, or a number of pixels.
fn side(ui: &mut Ui, name: &str, side: &mut Option<u32>) {
    let label = ui.label(name);
    ui.horizontal(|ui| {
        let mut fits = side.is_none();
        let fit = ui.checkbox(&mut fits, "match pane");
        if fit
            .accessible_name(format!("{name} match their pane"))
            .changed()
        {
            *side = (!fits).then_some(512);
        }
        if let Some(side) = side {
            let field = number_field::field(ui, side).range(16..=4096).suffix(" px");
            ui.add(field).labelled_by(label.id);
        }
    });
}
