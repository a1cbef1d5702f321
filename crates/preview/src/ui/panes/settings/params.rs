//! The params: a row for each component, with its name, its slider, its value, a button that animates it and a menu.

use std::sync::Arc;

use egui::{Align, Button, Color32, Grid, Layout, Slider, TextStyle, Ui};
use scene::{Param, ParamValues};
use session::{Model, Step};

use crate::ui::icons::{self, Icon};
use crate::ui::number_field;
use crate::ui::window::Window;

/// The minimum and maximum width of a slider, in points.
const SLIDER: [f32; 2] = [20.0, 300.0];
/// The width of the button that animates, the menu and the gaps between the columns, in points.
const BESIDE: f32 = 72.0;
/// The maximum width of names, as a fraction of the pane's.
const NAMES: f32 = 0.3;
/// The maximum width of the column of values, in points.
const WIDEST_VALUE: f32 = 120.0;

/// The widths of the columns, which all rows share.
#[derive(Clone, Copy, Debug)]
struct Columns {
    name: f32,
    slider: f32,
    value: f32,
}

/// The values of defines that depend on params.
#[derive(Debug)]
pub(crate) struct DefineValues {
    version: i32,
    params: Arc<ParamValues>,
    /// Names and values, in the order of the text.
    rows: Vec<(String, String)>,
}

/// Draws the tab.
pub(super) fn show(window: &mut Window, ui: &mut Ui) {
    let (Some(scene), Some(chosen)) = (window.model.scene.clone(), window.model.chosen_values())
    else {
        return;
    };
    if scene.params.is_empty() {
        ui.weak("A param of the program has a slider here: param a : [0, 1];");
        return;
    }
    let columns = Columns::new(ui, &scene.params);
    for param in &scene.params {
        let values = chosen.param(param).to_vec();
        for (k, value) in values.into_iter().enumerate() {
            row(window, ui, param, k, value, columns);
        }
    }
    defines(window, ui);
}

impl Columns {
    /// Returns columns with room for all names and values of some params, as far as the pane permits.
    fn new(ui: &Ui, params: &[Param]) -> Self {
        let (mut name, mut value) = (0.0_f32, ui.spacing().interact_size.x);
        for param in params {
            for (k, range) in param.ranges.iter().enumerate() {
                name = name.max(text_width(ui, name_of(param, k), TextStyle::Body));
                let decimals = decimals(range.max - range.min);
                for end in [range.min, range.max] {
                    let text = number_field::displayed(end, decimals..=decimals);
                    let field = text_width(ui, text, ui.style().drag_value_text_style.clone());
                    value = value.max(field + 2.0 * ui.spacing().button_padding.x);
                }
            }
        }
        let room = ui.available_width();
        let name = (name + 4.0).min(NAMES * room);
        // In a narrow pane the slider and the buttons take precedence over the longest value.
        let widest = (room - name - BESIDE - SLIDER[0]).min(WIDEST_VALUE);
        let value = value.min(widest).max(ui.spacing().interact_size.x);
        let slider = (room - name - value - BESIDE).clamp(SLIDER[0], SLIDER[1]);
        Self {
            name,
            slider,
            value,
        }
    }
}

/// Returns the width of a text in one line.
fn text_width(ui: &Ui, text: String, style: TextStyle) -> f32 {
    let font = style.resolve(ui.style());
    let galley = ui.painter().layout_no_wrap(text, font, Color32::WHITE);
    galley.size().x
}

/// Shows the defines that depend on params, with their values.
fn defines(window: &mut Window, ui: &mut Ui) {
    let Some(params) = window.model.param_values() else {
        return;
    };
    let version = window.model.program.version;
    let known = window.panes.defines.take();
    let known = known.filter(|it| it.version == version && it.params == params);
    let known = known.unwrap_or_else(|| DefineValues {
        version,
        rows: window.model.derived_values(),
        params,
    });
    if !known.rows.is_empty() {
        ui.separator();
        Grid::new("defines").num_columns(2).show(ui, |ui| {
            for (name, value) in &known.rows {
                ui.label(name);
                ui.label(value);
                ui.end_row();
            }
        });
    }
    window.panes.defines = Some(known);
}

/// Returns the name of a component, from 0: `r`, or `r_1` if there are several.
fn name_of(param: &Param, k: usize) -> String {
    match param.ranges.len() {
        1 => param.name.clone(),
        _ => format!("{}_{}", param.name, k + 1),
    }
}

/// Shows the row of a component with a value.
fn row(window: &mut Window, ui: &mut Ui, param: &Param, k: usize, value: f64, columns: Columns) {
    let name = name_of(param, k);
    let range = param.ranges[k];
    let mut moved = value;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let height = ui.spacing().interact_size.y;
        let size = egui::vec2(columns.name, height);
        ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
            ui.set_width(columns.name);
            // A name that is longer than its column is truncated, and then shown on hover.
            ui.add(egui::Label::new(&name).truncate());
        });
        let before = ui.spacing().interact_size.x;
        ui.spacing_mut().slider_width = columns.slider;
        ui.spacing_mut().interact_size.x = columns.value;
        // Only the displayed number is rounded, and below one that is dragged: a slider with few decimals would round the
        // value itself in each frame.
        let decimals = decimals(range.max - range.min);
        let slider = Slider::new(&mut moved, range.min..=range.max).smart_aim(false);
        let displayed = move |value, _| number_field::displayed(value, 0..=decimals);
        let slider = number_field::of_slider(ui, slider, displayed);
        let slider = ui.add(slider).accessible_name(&name);
        if moved != value && !number_field::is_typed(ui) {
            moved = range.rounded(moved);
        }
        ui.spacing_mut().interact_size.x = before;
        take_value(window, ui, param, k, moved, &slider);
        animated(&mut window.model, ui, param, k, &name);
        menu(window, ui, param, k, &name);
    });
}

/// Takes over a component's value that the user has set by its slider.
fn take_value(
    window: &mut Window,
    ui: &Ui,
    param: &Param,
    k: usize,
    value: f64,
    slider: &egui::Response,
) {
    if slider.changed() {
        number_field::withdraw(&mut window.status_message);
        let step = Step::new("Move a param", name_of(param, k));
        window.model.change(step, |choices| {
            choices.choose(&param.name, k, Some(value));
        });
        window.has_moved(ui);
    }
    if window.model.choices.preferences.write_on_release {
        // A change by keys ends when the last one is released, typing when the field loses the focus.
        if slider.changed() && !slider.dragged() {
            window.input.unwritten_param = Some(param.name.clone());
        }
        if slider.drag_stopped() {
            window.write_param(&param.name);
        }
    }
}

/// Shows the button that animates a component, or stops it.
fn animated(model: &mut Model, ui: &mut Ui, param: &Param, k: usize, name: &str) {
    let animation = model.choices.animations.get(&param.name);
    let on = animation.is_some_and(|it| it.on.get(k).copied().unwrap_or(false));
    let (icon, hint) = match on {
        true => (Icon::Pause, "Stop"),
        false => (Icon::Play, "Animate"),
    };
    if icons::button(ui, icon, on, format!("Animate {name}"), hint).clicked() {
        model.change(Step::new("Animate", name), |choices| {
            choices.animate(&param.name, k, !on);
        });
    }
}

/// Shows the menu of a component.
fn menu(window: &mut Window, ui: &mut Ui, param: &Param, k: usize, name: &str) {
    let menu = ui.menu_button("…", |ui| {
        let hint = "Write this value into the program";
        if ui.button("Update the text").on_hover_text(hint).clicked() {
            window.write_param(&param.name);
        }
        let chosen = window.model.choices.params.get(&param.name);
        let is_chosen = chosen.is_some_and(|it| it.get(k).is_some_and(Option::is_some));
        let hint = "Take the value that the program gives it";
        let reset = ui.add_enabled(is_chosen, Button::new("Reset"));
        if reset.on_hover_text(hint).clicked() {
            let step = Step::new("Reset a param", name);
            window
                .model
                .change(step, |choices| choices.choose(&param.name, k, None));
        }
        ui.separator();
        let animation = window.model.choices.animations.get(&param.name);
        let mut speed = animation.map_or(1.0, |it| it.speed);
        ui.horizontal(|ui| {
            let label = ui.label("Units per second");
            let drag = number_field::field(ui, &mut speed)
                .speed(0.01)
                .range(-1e6..=1e6);
            if ui.add(drag).labelled_by(label.id).changed() {
                window.model.adjust(|choices| {
                    choices
                        .animations
                        .entry(param.name.clone())
                        .or_default()
                        .speed = speed;
                });
            }
        });
    });
    let hint = "More for this param";
    let button = menu.response.on_hover_text(hint);
    button.accessible_name(format!("More for {name}"));
}

/// Writes a value that keys have changed into the text, once they are released.
pub(super) fn write_released(window: &mut Window, ui: &Ui) {
    if !window.input.held.any()
        && !ui.ctx().text_edit_focused()
        && let Some(name) = window.input.unwritten_param.take()
    {
        window.write_param(&name);
    }
}

/// Returns the number of decimals at which a slider's steps are fine enough.
fn decimals(width: f64) -> usize {
    let digits = 3.0 - width.log10().floor();
    if digits.is_finite() {
        digits.clamp(0.0, 12.0) as usize
    } else {
        6
    }
}
