//! The settings: params, how objects look, textures, cameras and pictures.

use std::path::{Path, PathBuf};

use egui::{ComboBox, DragValue, Grid, ScrollArea, Slider, Ui};
use scene::{Object, Param};

use crate::state::{Choice, Model, SCALES, Step, Theme};
use crate::ui::window::Window;

/// The width of the box that animates a param, with its word.
const ANIMATE: f32 = 75.0;
/// The least and the greatest width of a slider.
const SLIDER: [f32; 2] = [50.0, 150.0];

/// Draws the pane.
pub(super) fn show(window: &mut Window, ui: &mut Ui) {
    let margin = egui::Frame::new().inner_margin(8.0);
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        margin.show(ui, |ui| {
            // What has no room in one part makes no other part wider.
            let room = ui.available_width();
            for part in [params, objects, textures] {
                ui.scope(|ui| {
                    ui.set_max_width(room);
                    part(window, ui);
                });
            }
            ui.scope(|ui| {
                ui.set_max_width(room);
                views(&mut window.model, ui);
            });
            write_released(window, ui);
        });
    });
}

fn params(window: &mut Window, ui: &mut Ui) {
    let (Some(scene), Some(settings)) = (window.model.scene.clone(), window.model.settings())
    else {
        return;
    };
    if scene.params.is_empty() {
        return;
    }
    ui.heading("Params");
    for param in &scene.params {
        let values = settings.param(param).to_vec();
        for k in 0..param.ranges.len() {
            slider(window, ui, param, k, &values);
        }
        let any = window
            .model
            .view
            .animations
            .get(&param.name)
            .is_some_and(|it| it.on.iter().any(|on| *on));
        ui.horizontal(|ui| {
            if any {
                let mut speed = window.model.view.animations[&param.name].speed;
                let label = ui.label("Units a second");
                let drag = DragValue::new(&mut speed).speed(0.01).range(-1e6..=1e6);
                if ui.add(drag).labelled_by(label.id).changed() {
                    window.model.adjust(|view| {
                        view.animations.entry(param.name.clone()).or_default().speed = speed;
                    });
                }
            }
            let hint = "Write the value into the program's text";
            let button = ui.button(format!("Write {} into the text", param.name));
            if button.on_hover_text(hint).clicked() {
                window.write_param(&param.name);
            }
        });
        ui.add_space(4.0);
    }
    let mut write = window.model.view.preferences.write_on_release;
    let text = "Write values when a slider is let go";
    if ui.checkbox(&mut write, text).changed() {
        window
            .model
            .change(Step::new("Change a setting", "write"), |view| {
                view.preferences.write_on_release = write;
            });
    }
    ui.separator();
}

fn slider(window: &mut Window, ui: &mut Ui, param: &Param, k: usize, values: &[f64]) {
    let name = match param.ranges.len() {
        1 => param.name.clone(),
        _ => format!("{}_{}", param.name, k + 1),
    };
    let range = param.ranges[k];
    let mut value = values[k];
    // Beside the slider stand its number and its name, and where there is room the box that animates.
    let beside = 90.0 + 8.0 * name.chars().count() as f32;
    let is_wide = ui.available_width() >= ANIMATE + beside + SLIDER[0];
    let room = ui.available_width() - beside - if is_wide { ANIMATE } else { 0.0 };
    ui.spacing_mut().slider_width = room.clamp(SLIDER[0], SLIDER[1]);
    let mut both = |ui: &mut Ui| {
        animated(&mut window.model, ui, param, k, &name);
        // Only what is written is rounded: a slider of few decimals would round the value itself, in each frame.
        let decimals = decimals(range.max - range.min);
        let slider = Slider::new(&mut value, range.min..=range.max)
            .text(&name)
            .custom_formatter(move |value, _| {
                egui::emath::format_with_decimals_in_range(value, 0..=decimals)
            })
            .smart_aim(false);
        ui.add(slider)
    };
    let response = if is_wide {
        ui.horizontal(both).inner
    } else {
        both(ui)
    };
    if response.changed() {
        window
            .model
            .change(Step::new("Move a param", name.as_str()), |view| {
                view.choose(&param.name, k, Some(value));
            });
        window.has_moved(ui);
    }
    if window.model.view.preferences.write_on_release {
        // What keys change is let go of with the last key, and what is typed when the field is left.
        if response.changed() && !response.dragged() {
            window.input.unwritten_param = Some(param.name.clone());
        }
        if response.drag_stopped() {
            window.write_param(&param.name);
        }
    }
}

/// The box that animates a component of a param.
fn animated(model: &mut Model, ui: &mut Ui, param: &Param, k: usize, name: &str) {
    let animation = model.view.animations.get(&param.name);
    let mut on = animation.is_some_and(|it| it.on.get(k).copied().unwrap_or(false));
    let animate = ui.checkbox(&mut on, "Animate");
    if animate.accessible_name(format!("Animate {name}")).changed() {
        model.change(Step::new("Animate", name), |view| {
            view.animate(&param.name, k, on);
        });
    }
}

/// Writes a value that keys have changed, once they are let go.
fn write_released(window: &mut Window, ui: &Ui) {
    if !window.input.held.any()
        && !ui.ctx().text_edit_focused()
        && let Some(name) = window.input.unwritten_param.take()
    {
        window.write_param(&name);
    }
}

/// Returns the number of decimals with which a slider's steps are fine.
fn decimals(width: f64) -> usize {
    let digits = 3.0 - width.log10().floor();
    if digits.is_finite() {
        digits.clamp(0.0, 12.0) as usize
    } else {
        6
    }
}

fn objects(window: &mut Window, ui: &mut Ui) {
    let Some(scene) = window.model.scene.clone() else {
        return;
    };
    if scene.objects.is_empty() {
        return;
    }
    ui.heading("Objects");
    Grid::new("objects")
        .num_columns(4)
        .min_col_width(0.0)
        .spacing([8.0, 4.0])
        .show(ui, |ui| {
            for object in &scene.objects {
                row(window, ui, object);
                ui.end_row();
            }
        });
    ui.separator();
}

fn row(window: &mut Window, ui: &mut Ui, object: &Object) {
    let name = &object.name;
    let look = window.model.view.look(name);
    let drawn = !object.shape.is_metric();
    let mut shown = !look.hidden;
    let show = ui.add_enabled(drawn, egui::Checkbox::without_text(&mut shown));
    let show = show.on_disabled_hover_text("A metric has no place in space");
    if show.accessible_name(format!("Show {name}")).changed() {
        window
            .model
            .change(Step::new("Show or hide", name.as_str()), |view| {
                view.looks.entry(name.clone()).or_default().hidden = !shown;
            });
    }
    let mut colour = look
        .colour
        .unwrap_or_else(|| render::style::colour(&object.shape));
    let picker = ui.color_edit_button_srgb(&mut colour);
    if picker
        .accessible_name(format!("Colour of {name}"))
        .changed()
    {
        window
            .model
            .change(Step::new("Change a colour", name.as_str()), |view| {
                view.looks.entry(name.clone()).or_default().colour = Some(colour);
            });
    }
    let stale = if window.model.stale.contains(name) {
        " (stale)"
    } else {
        ""
    };
    let link = ui.link(format!("{name}{stale}"));
    if link.on_hover_text("Show its declaration").clicked() {
        window.open_declaration(name);
    }
    if object.shape.manifold().is_some() {
        let mut texture = look.texture.clone();
        if choose(
            &window.model.view.textures,
            ui,
            &format!("Texture of {name}"),
            &mut texture,
            true,
        ) {
            window
                .model
                .change(Step::new("Choose a texture", name.as_str()), |view| {
                    view.looks.entry(name.clone()).or_default().texture = texture;
                });
        }
    } else {
        ui.label("");
    }
}

/// A list of all textures; whether another one was chosen.
fn choose(
    images: &[PathBuf],
    ui: &mut Ui,
    label: &str,
    choice: &mut Choice,
    of_object: bool,
) -> bool {
    let before = choice.clone();
    let combo = ComboBox::from_id_salt(label)
        .selected_text(title(choice, of_object))
        .width(ui.available_width().clamp(60.0, 110.0))
        .truncate()
        .show_ui(ui, |ui| {
            let mut option = |other: Choice| {
                let title = title(&other, of_object);
                ui.selectable_value(choice, other, title);
            };
            option(Choice::Default);
            option(Choice::Plain);
            option(Choice::Curvature);
            for path in images {
                option(Choice::Image(path.clone()));
            }
        });
    combo.response.accessible_name(label);
    *choice != before
}

fn title(choice: &Choice, of_object: bool) -> String {
    match choice {
        Choice::Default if of_object => "Default".to_owned(),
        Choice::Default => "Orientation".to_owned(),
        Choice::Plain => "Plain colour".to_owned(),
        Choice::Curvature => "Gaussian curvature".to_owned(),
        Choice::Image(path) => file_name(path),
    }
}

fn file_name(path: &Path) -> String {
    path.file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}

fn textures(window: &mut Window, ui: &mut Ui) {
    if window.model.surfaces().is_empty() {
        return;
    }
    ui.heading("Textures");
    ui.horizontal_wrapped(|ui| {
        ui.label("Default");
        let mut choice = window.model.view.default_texture.clone();
        if choose(
            &window.model.view.textures,
            ui,
            "Default texture",
            &mut choice,
            false,
        ) {
            let step = Step::new("Choose the default texture", "");
            window
                .model
                .change(step, |view| view.default_texture = choice);
        }
        if ui.button("Open Texture…").clicked() {
            let folder = window.text.folder();
            crate::io::file_dialogs::choose_images(window.events.file_choices(), folder);
        }
    });
    ui.horizontal(|ui| {
        let label = ui.label("Image file");
        let path = &mut window.dialogs.texture_path;
        let room = (ui.available_width() - 50.0).clamp(60.0, 150.0);
        let edit = egui::TextEdit::singleline(path).desired_width(room);
        let edit = ui.add(edit).labelled_by(label.id);
        if std::mem::take(&mut window.dialogs.wants_image) {
            edit.request_focus();
            edit.scroll_to_me(None);
        }
        let entered = edit.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        if ui.button("Add").clicked() || entered {
            let given = std::mem::take(&mut window.dialogs.texture_path);
            if !given.trim().is_empty() {
                let folder = window.text.folder().unwrap_or_default();
                window.open_images(vec![folder.join(given.trim())]);
            }
        }
    });
    let mut removed = None;
    for path in &window.model.view.textures {
        ui.horizontal(|ui| {
            let name = file_name(path);
            match window.pictures.library.trouble(path) {
                Some(trouble) => {
                    ui.colored_label(ui.visuals().error_fg_color, &name)
                        .on_hover_text(trouble);
                }
                None => {
                    ui.label(&name).on_hover_text(path.display().to_string());
                }
            }
            let button = ui
                .small_button("Remove")
                .accessible_name(format!("Remove {name}"));
            if button.clicked() {
                removed = Some(path.clone());
            }
        });
    }
    if let Some(path) = removed {
        window
            .model
            .change(Step::new("Remove a texture", ""), |view| {
                view.textures.retain(|it| *it != path);
            });
    }
    ui.weak("Images can also be dropped onto the window: the surface in use shows them.");
    ui.separator();
}

fn views(model: &mut Model, ui: &mut Ui) {
    ui.heading("Views");
    // Beside the slider stand its name and its number.
    ui.spacing_mut().slider_width = (ui.available_width() - 165.0).clamp(SLIDER[0], SLIDER[1]);
    let mut preferences = model.view.preferences.clone();
    let before = preferences.clone();
    Grid::new("views")
        .num_columns(2)
        .spacing([8.0, 6.0])
        .show(ui, |ui| {
            let label = ui.label("Camera speed");
            let slider = Slider::new(&mut preferences.camera_speed, 0.05..=10.0).logarithmic(true);
            ui.add(slider).labelled_by(label.id);
            ui.end_row();
            let label = ui.label("Background");
            let default = render::style::BACKGROUND;
            let mut colour = preferences.background.unwrap_or(default);
            ui.horizontal(|ui| {
                if ui
                    .color_edit_button_srgb(&mut colour)
                    .labelled_by(label.id)
                    .changed()
                {
                    preferences.background = Some(colour);
                }
                if preferences.background.is_some() && ui.small_button("Reset").clicked() {
                    preferences.background = None;
                }
            });
            ui.end_row();
            side(ui, "Frame size", &mut preferences.space_size);
            ui.end_row();
            side(ui, "Geo size", &mut preferences.inside_size);
            ui.end_row();
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
            let label = ui.label("Size of controls");
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
    if preferences != before {
        let step = Step::new("Change a setting", "views");
        model.change(step, |view| view.preferences = preferences);
    }
}

/// The side of a picture: as its pane has it, or a number of pixels.
fn side(ui: &mut Ui, name: &str, side: &mut Option<u32>) {
    let label = ui.label(name);
    ui.horizontal(|ui| {
        let mut fits = side.is_none();
        let fit = ui.checkbox(&mut fits, "as the pane");
        if fit.accessible_name(format!("{name} as the pane")).changed() {
            *side = (!fits).then_some(512);
        }
        if let Some(side) = side {
            ui.add(DragValue::new(side).range(16..=4096).suffix(" px"))
                .labelled_by(label.id);
        }
    });
}
