//! The objects: their visibility, their colours, and the textures of surfaces.

use std::path::{Path, PathBuf};

use egui::{ComboBox, Grid, Ui};
use scene::Object;
use session::stated_colour::StatedColour;
use session::{Step, TextureChoice};

use crate::ui::colour;
use crate::ui::window::Window;

/// The minimum and maximum width of a list of textures, in points.
const LIST: [f32; 2] = [90.0, 160.0];
/// The number of letters of the heading above the names.
const HEADING: f32 = 6.0;
/// The width of the other cells of an object's row, without its name, in points.
const BESIDE: f32 = 150.0;

/// Draws the tab.
pub(super) fn show(window: &mut Window, ui: &mut Ui) {
    // The width is fixed, so that a wide part does not make the others wider.
    let room = ui.available_width();
    for part in [objects, textures] {
        ui.scope(|ui| {
            ui.set_max_width(room);
            part(window, ui);
        });
    }
}

fn objects(window: &mut Window, ui: &mut Ui) {
    let Some(scene) = window.model.scene.clone() else {
        return;
    };
    if scene.objects.is_empty() {
        ui.weak("The program declares no objects yet.");
        return;
    }
    // A grid does not tell its cells the available width: a list of textures gets what the other cells leave.
    let names = scene.objects.iter().map(|it| it.name.chars().count());
    let longest = names.max().unwrap_or(1) as f32;
    let room = ui.available_width() - BESIDE - 8.0 * longest.max(HEADING);
    Grid::new("objects")
        .num_columns(5)
        .min_col_width(0.0)
        .spacing([8.0, 4.0])
        .show(ui, |ui| {
            if !window.model.surfaces().is_empty() {
                for title in ["", "", "Object", "Texture", ""] {
                    ui.weak(title);
                }
                ui.end_row();
            }
            for object in &scene.objects {
                row(window, ui, object, room);
                ui.end_row();
            }
        });
    ui.separator();
}

/// Shows the row of an object; `room` is the width for its list of textures.
fn row(window: &mut Window, ui: &mut Ui, object: &Object, room: f32) {
    let name = &object.name;
    let look = window.model.choices.look(name);
    let drawn = !object.shape.is_metric();
    let mut shown = !look.hidden;
    let show = ui.add_enabled(drawn, egui::Checkbox::without_text(&mut shown));
    let show = show.on_disabled_hover_text("A metric has no embedding");
    if show.accessible_name(format!("Show {name}")).changed() {
        window
            .model
            .change(Step::new("Show or hide", name.as_str()), |choices| {
                choices.looks.entry(name.clone()).or_default().hidden = !shown;
            });
    }
    let stated = window.model.scene.as_ref();
    match stated.and_then(|scene| StatedColour::of(scene, object)) {
        Some(stated) => written_colour(window, ui, name, stated),
        None => chosen_colour(window, ui, name, look.colour),
    }
    let stale = if window.model.faults.stale().contains(name) {
        " (out of date)"
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
            &window.model.choices.textures,
            ui,
            &format!("Texture of {name}"),
            &mut texture,
            (true, room),
        ) {
            window
                .model
                .change(Step::new("Choose a texture", name.as_str()), |choices| {
                    choices.looks.entry(name.clone()).or_default().texture = texture;
                });
        }
        let mut flipped = look.flipped;
        let hint = "Flips the image on the surface upside down";
        let flip = ui.checkbox(&mut flipped, "Flip").on_hover_text(hint);
        if flip
            .accessible_name(format!("Flip the image of {name}"))
            .changed()
        {
            window
                .model
                .change(Step::new("Flip an image", name.as_str()), |choices| {
                    choices.looks.entry(name.clone()).or_default().flipped = flipped;
                });
        }
    } else {
        ui.label("");
        ui.label("");
    }
}

/// Shows the colour of an object that states none: a choice of the window.
fn chosen_colour(window: &mut Window, ui: &mut Ui, name: &str, chosen: Option<[u8; 3]>) {
    let mut colour = chosen.unwrap_or_else(|| window.model.default_colour(name));
    let picker = colour::button(ui, &mut colour);
    if picker
        .accessible_name(format!("Colour of {name}"))
        .changed()
    {
        let step = Step::new("Change a colour", name);
        window.model.change(step, |choices| {
            choices.looks.entry(name.to_owned()).or_default().colour = Some(colour);
        });
    }
}

/// Shows the colour that an object states. A new colour is written into the text when the pointer is released.
fn written_colour(window: &mut Window, ui: &mut Ui, name: &str, stated: StatedColour) {
    let label = format!("Colour of {name}");
    let Some(stated) = stated.rgb() else {
        ui.add_enabled_ui(false, |ui| {
            let mut grey = [128; 3];
            colour::button(ui, &mut grey)
                .on_disabled_hover_text("The text states its colour as an expression")
                .accessible_name(label);
        });
        return;
    };
    let id = ui.scope_id().with(("stated colour", name));
    let picked: Option<[u8; 3]> = ui.data(|data| data.get_temp(id));
    let mut colour = picked.unwrap_or(stated);
    if colour::button(ui, &mut colour)
        .on_hover_text("Writes the colour into the text")
        .accessible_name(label)
        .changed()
    {
        ui.data_mut(|data| data.insert_temp(id, colour));
    }
    let is_held = ui.input(|input| input.pointer.any_down());
    if !is_held && colour != stated {
        ui.data_mut(|data| data.remove_temp::<[u8; 3]>(id));
        window.write_colour(name, colour.map(|part| f64::from(part) / 255.0));
    }
}

/// Shows a list of all textures, in a given width. Returns whether another one was chosen.
fn choose(
    images: &[PathBuf],
    ui: &mut Ui,
    label: &str,
    choice: &mut TextureChoice,
    (of_object, room): (bool, f32),
) -> bool {
    let before = choice.clone();
    let combo = ComboBox::from_id_salt(label)
        .selected_text(title(choice, of_object))
        .width(room.clamp(LIST[0], LIST[1]))
        .truncate()
        .show_ui(ui, |ui| {
            let mut option = |other: TextureChoice| {
                let title = title(&other, of_object);
                ui.selectable_value(choice, other, title);
            };
            option(TextureChoice::Default);
            option(TextureChoice::Plain);
            option(TextureChoice::Curvature);
            for path in images {
                option(TextureChoice::Image(path.clone()));
            }
        });
    combo.response.accessible_name(label);
    *choice != before
}

fn title(choice: &TextureChoice, of_object: bool) -> String {
    match choice {
        TextureChoice::Default if of_object => "Default".to_owned(),
        TextureChoice::Default => "Letters".to_owned(),
        TextureChoice::Plain => "Plain colour".to_owned(),
        TextureChoice::Curvature => "Gaussian curvature".to_owned(),
        TextureChoice::Image(path) => file_name(path),
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
        let mut choice = window.model.choices.default_texture.clone();
        let room = ui.available_width();
        if choose(
            &window.model.choices.textures,
            ui,
            "Default texture",
            &mut choice,
            (false, room),
        ) {
            let step = Step::new("Choose the default texture", "");
            window
                .model
                .change(step, |choices| choices.default_texture = choice);
        }
        if ui.button("Open textures…").clicked() {
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
    for path in &window.model.choices.textures {
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
            .change(Step::new("Remove a texture", ""), |choices| {
                choices.textures.retain(|it| *it != path);
            });
    }
    ui.weak("Images that are added or dropped onto the window are shown on the surface in use.");
}
