//! Pictures and meshes for other programs: the dialogs for writing them.

use std::path::{Path, PathBuf};

use egui::{Grid, Ui};
use export::command_line;
use export::mesh::{self, MeshFormat};
use export::whole_file::write_whole;
use render::error::SCALES;
use render::style::Theme;
use render::{Backend, PictureRequest, ViewId, style};
use session::StatusMessage;

use super::Dialog;
use crate::channel::report_when_done;
use crate::io::files;
use crate::ui::number_field;
use crate::ui::window::Window;

/// The fields of the dialog for a picture.
#[derive(Clone, Debug)]
pub(crate) struct PictureDialog {
    pane: ViewId,
    size: [u32; 2],
    /// The factor from the size to pixels, in both directions.
    resolution: u32,
    /// The factor of the widths of lines and of words.
    scale: f32,
    theme: Theme,
    /// True for a transparent background; `None` for a view without a background.
    transparent: Option<bool>,
    pub(crate) path: String,
}

/// The available factors of the resolution.
const RESOLUTIONS: [u32; 3] = [1, 2, 4];

impl PictureDialog {
    /// Returns the size of the picture in pixels: with the sides in their ratio, also where there would be too many.
    fn pixels(&self) -> [u32; 2] {
        let pixels = self.size.map(|side| side.saturating_mul(self.resolution));
        let most = pixels[0].max(pixels[1]).max(1);
        let share = f64::from(render::MAX_SIDE.min(most)) / f64::from(most);
        pixels.map(|side| (share * f64::from(side)).round() as u32)
    }

    /// Returns the request for the picture, with the dialog's input.
    fn apply(&self, mut request: PictureRequest) -> PictureRequest {
        request.size = self.pixels();
        request.scale = self.scale;
        request.theme = self.theme;
        if let Some(space) = request.view.space_mut() {
            let [r, g, b] = style::PAPER;
            if self.transparent == Some(true) {
                space.background = Some([0; 4]);
            } else if self.theme == Theme::Print {
                space.background = Some([r, g, b, 255]);
            }
        }
        request
    }
}

/// The user's choice in a dialog.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Decision {
    Stay,
    Save,
    Choose,
    Cancel,
}

/// Opens the dialog for a picture of the active view.
pub(crate) fn ask_for_picture(window: &mut Window) {
    let Some(request) = window.kept(&window.focus.view) else {
        return;
    };
    window.dialogs.open = Some(Dialog::Picture(PictureDialog {
        pane: window.focus.view.clone(),
        size: request.size,
        resolution: 1,
        scale: request.scale,
        theme: request.theme,
        transparent: request.view.space().map(|_| false),
        path: in_folder(window, &file_name(window, &window.focus.view, "png")),
    }));
    window.dialogs.wants_name = true;
}

/// Opens the dialog for a mesh, whose default name is the program's.
pub(crate) fn ask_for_mesh(window: &mut Window) {
    let file = window.text.file();
    let name = match file.as_deref().and_then(Path::file_stem) {
        Some(program) => format!("{}.glb", program.display()),
        None => "scene.glb".to_owned(),
    };
    window.dialogs.open = Some(Dialog::Mesh(in_folder(window, &name)));
    window.dialogs.wants_name = true;
}

/// Returns the default file name for a picture of a view: `torus-3d.png`, or `torus-s.png` for a surface.
pub(crate) fn file_name(window: &Window, id: &ViewId, extension: &str) -> String {
    let view = id.object.as_ref().unwrap_or(&id.kind);
    let file = window.text.file();
    match file.as_deref().and_then(Path::file_stem) {
        Some(program) => format!("{}-{view}.{extension}", program.display()),
        None => format!("{view}.{extension}"),
    }
}

/// Returns the path of a name in the program's folder.
pub(crate) fn in_folder(window: &Window, name: &str) -> String {
    let folder = window.text.folder().unwrap_or_default();
    folder.join(name).display().to_string()
}

/// Copies the active view's picture.
pub(crate) fn copy_picture(window: &mut Window, ui: &Ui) {
    let Some(request) = window.kept(&window.focus.view) else {
        return;
    };
    let (context, views) = (ui.ctx().clone(), window.views.clone());
    report_when_done(window.events.status(), move || {
        let picture = render::render(&views, &request, Backend::Auto, &|_| {});
        let image = picture.map_err(|error| error.to_string())?.image;
        let size = [image.width() as usize, image.height() as usize];
        let image = egui::ColorImage::from_rgba_unmultiplied(size, image.as_raw());
        context.copy_image(image);
        Ok(format!(
            "A picture of {}×{} pixels was copied",
            size[0], size[1]
        ))
    });
}

/// Copies the command that draws the active view's picture.
pub(crate) fn copy_command(window: &mut Window, ui: &Ui) {
    let Some(request) = window.kept(&window.focus.view) else {
        return;
    };
    let name = file_name(window, &window.focus.view, "png");
    copy_command_of(window, ui, &request, Path::new(&name));
}

/// Copies the command that draws a picture, and reports what it leaves out.
fn copy_command_of(window: &mut Window, ui: &Ui, request: &PictureRequest, output: &Path) {
    let program = window.text.file().filter(|file| file.is_file());
    let Some(program) = program else {
        let sentence = "The command needs a file: save the program first";
        window.status_message = Some(StatusMessage::error(sentence));
        return;
    };
    let options = command_line::options(request, &window.views);
    let line = command_line::command(&program, output, &options);
    ui.ctx().copy_text(line);
    let mut sentence = "The command for this picture was copied".to_owned();
    if window.text.has_unsaved() {
        sentence.push_str("; it reads the file, but the program is not saved");
    }
    if !request
        .trails
        .iter()
        .all(|trail| command_line::has_option(trail))
    {
        sentence.push_str("; the path that was walked is too long for it, and is left out");
    }
    window.status_message = Some(StatusMessage::info(sentence));
}

/// Shows the dialog for a picture.
pub(super) fn show_picture(window: &mut Window, mut dialog: PictureDialog, ui: &Ui) {
    let (decision, copies) = picture(&mut dialog, ui);
    if copies && let Some(request) = window.kept(&dialog.pane) {
        let request = dialog.apply(request);
        copy_command_of(window, ui, &request, Path::new(&dialog.path));
    }
    match decision {
        Decision::Cancel => return,
        Decision::Save => return write_picture(window, &dialog),
        Decision::Choose => choose(window, "Save picture", &dialog.path),
        Decision::Stay => {}
    }
    window.dialogs.open = Some(Dialog::Picture(dialog));
}

/// Shows the dialog for a mesh.
pub(super) fn show_mesh(window: &mut Window, mut path: String, ui: &Ui) {
    match mesh(&mut path, ui) {
        Decision::Cancel => return,
        Decision::Save => return write_mesh(window, &path),
        Decision::Choose => choose(window, "Export mesh", &path),
        Decision::Stay => {}
    }
    window.dialogs.open = Some(Dialog::Mesh(path));
}

/// Shows the dialog. Returns the decision, and whether its command is to be copied.
fn picture(dialog: &mut PictureDialog, ui: &Ui) -> (Decision, bool) {
    let mut copies = false;
    let verb = verb(Path::new(&dialog.path));
    let decision = modal(ui, "Save picture", verb, |ui| {
        let mut choose = false;
        Grid::new("picture").num_columns(2).show(ui, |ui| {
            let sides = 1..=render::MAX_SIDE;
            for (side, name) in dialog.size.iter_mut().zip(["Width", "Height"]) {
                let label = ui.label(name);
                let field = number_field::field(ui, side).range(sides.clone());
                ui.add(field.suffix(" px")).labelled_by(label.id);
                ui.end_row();
            }
            appearance(dialog, ui);
            choose = file(ui, &mut dialog.path);
        });
        ui.label(
            "The extension determines the format: png, or svg and pdf, which have the lines and text of the 3D view as vectors.",
        );
        transparency(&mut dialog.transparent, ui);
        replaced(ui, Path::new(&dialog.path));
        let copy = ui.button("Copy as command");
        copies = copy
            .on_hover_text("Copies the command that draws this picture")
            .clicked();
        choose
    });
    (decision, copies)
}

/// Shows the rows for the resolution, the width of lines, and the theme of a picture.
fn appearance(dialog: &mut PictureDialog, ui: &mut Ui) {
    ui.label("Resolution");
    ui.horizontal(|ui| {
        for resolution in RESOLUTIONS {
            let title = format!("{resolution}×");
            ui.selectable_value(&mut dialog.resolution, resolution, title);
        }
        let [width, height] = dialog.pixels();
        ui.weak(format!("{width}×{height} pixels"));
    });
    ui.end_row();
    let label = ui.label("Lines and text");
    let scale = number_field::field(ui, &mut dialog.scale).range(SCALES);
    ui.add(scale.speed(0.01).max_decimals(2).suffix("×"))
        .labelled_by(label.id);
    ui.end_row();
    if dialog.transparent.is_some() {
        ui.label("Theme");
        ui.horizontal(|ui| {
            ui.selectable_value(&mut dialog.theme, Theme::Screen, "As the window");
            ui.selectable_value(&mut dialog.theme, Theme::Print, "White, for print");
        });
        ui.end_row();
    }
}

fn mesh(path: &mut String, ui: &Ui) -> Decision {
    let verb = verb(Path::new(path));
    modal(ui, "Export mesh", verb, |ui| {
        let mut choose = false;
        Grid::new("mesh").num_columns(2).show(ui, |ui| {
            choose = file(ui, path);
        });
        ui.label("The extension determines the format: obj, ply, stl, gltf or glb.");
        replaced(ui, Path::new(path));
        choose
    })
}

/// Shows a box for a transparent background, if the view has a background.
pub(crate) fn transparency(transparent: &mut Option<bool>, ui: &mut Ui) {
    if let Some(transparent) = transparent {
        ui.checkbox(transparent, "Transparent background");
    }
}

/// Shows a field for a file. Returns whether it is to be chosen in the desktop's dialog.
pub(crate) fn file(ui: &mut Ui, path: &mut String) -> bool {
    let label = ui.label("File");
    let choose = ui
        .horizontal(|ui| {
            let edit = egui::TextEdit::singleline(path).id(path_field());
            ui.add(edit.desired_width(320.0)).labelled_by(label.id);
            let choose = egui::Button::new("Choose…");
            ui.add_enabled(crate::io::file_dialogs::has_dialogs(), choose)
                .clicked()
        })
        .inner;
    ui.end_row();
    if !crate::io::file_dialogs::has_dialogs() {
        ui.label("");
        ui.label(crate::io::file_dialogs::NO_DIALOG);
        ui.end_row();
    }
    choose
}

/// Returns the id of a dialog's file field.
pub(crate) fn path_field() -> egui::Id {
    egui::Id::unique("file of a dialog")
}

/// Gives the focus to the file field, with the file's name selected, so that typing replaces it.
pub(crate) fn take_keys(path: &str, ui: &Ui) {
    let field = path_field();
    ui.memory_mut(|memory| memory.request_focus(field));
    let name = path.rfind(['/', '\\']).map_or(0, |at| at + 1);
    let end = path
        .rfind('.')
        .filter(|dot| *dot > name)
        .unwrap_or(path.len());
    let [name, end] = [name, end].map(|at| path[..at].chars().count());
    let mut state = egui::text_edit::TextEditState::default();
    let marked = egui::text::CCursorRange::two(
        egui::text::CCursor::new(name),
        egui::text::CCursor::new(end),
    );
    state.cursor.set_char_range(Some(marked));
    state.store(ui.ctx(), field);
}

/// Returns the label of the button that writes a file.
pub(crate) fn verb(path: &Path) -> &'static str {
    if path.is_file() { "Replace" } else { "Save" }
}

/// Warns that a file will be replaced, if it exists.
pub(crate) fn replaced(ui: &mut Ui, path: &Path) {
    if path.is_file() {
        ui.colored_label(
            ui.visuals().warn_fg_color,
            "This file exists and will be replaced.",
        );
    }
}

/// The width and height of a dialog beside its content, with some of the background, in points.
const AROUND: egui::Vec2 = egui::vec2(60.0, 110.0);
/// The width of the widest dialog, in points.
const WIDEST: f32 = 560.0;

/// Shows a dialog with `content`, which returns whether a file is to be chosen, and a button with the label `verb`. In a
/// small window the content scrolls; the buttons are always visible.
pub(crate) fn modal(
    ui: &Ui,
    title: &str,
    verb: &str,
    content: impl FnOnce(&mut Ui) -> bool,
) -> Decision {
    let mut decision = Decision::Stay;
    let is_typed = ui.memory(|memory| memory.has_focus(path_field()));
    let is_entered = is_typed && ui.input(|input| input.key_pressed(egui::Key::Enter));
    let screen = ui.ctx().content_rect().size();
    let room = (screen - AROUND).max(egui::vec2(40.0, 40.0));
    let modal = egui::Modal::new(egui::Id::unique(title)).show(ui.ctx(), |ui| {
        ui.heading(title);
        let area = egui::ScrollArea::new([screen.x < WIDEST, true]);
        let area = area.max_width(room.x).max_height(room.y);
        if area.show(ui, content).inner {
            decision = Decision::Choose;
        }
        ui.horizontal(|ui| {
            if ui.button(verb).clicked() {
                decision = Decision::Save;
            }
            if ui.button("Cancel").clicked() {
                decision = Decision::Cancel;
            }
        });
    });
    if is_entered {
        decision = Decision::Save;
    }
    // A click beside it would lose the input.
    let is_left = modal.is_top_modal && !modal.any_popup_open;
    if is_left && ui.input(|input| input.key_pressed(egui::Key::Escape)) {
        decision = Decision::Cancel;
    }
    decision
}

/// Lets the user choose the file in the desktop's dialog.
pub(crate) fn choose(window: &Window, title: &str, path: &str) {
    crate::io::file_dialogs::choose_target(
        window.events.file_choices(),
        title.to_owned(),
        PathBuf::from(path),
    );
}

fn write_picture(window: &Window, dialog: &PictureDialog) {
    let Some(request) = window.kept(&dialog.pane) else {
        return;
    };
    let request = dialog.apply(request);
    let (path, views) = (PathBuf::from(&dialog.path), window.views.clone());
    report_when_done(window.events.status(), move || {
        files::save_picture(&path, &views, &request)
    });
}

fn write_mesh(window: &Window, path: &str) {
    // Colours and textures are those of the first view.
    let first = ViewId::of_scene(window.views.first().name());
    let request = window
        .kept(&first)
        .or_else(|| window.kept(&window.focus.view));
    let Some(request) = request else {
        return;
    };
    let path = PathBuf::from(path);
    report_when_done(window.events.status(), move || save_mesh(&path, &request));
}

fn save_mesh(path: &Path, request: &PictureRequest) -> Result<String, String> {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let format = MeshFormat::from_extension(&extension).ok_or_else(|| {
        let known = MeshFormat::ALL.map(MeshFormat::extension).join(", ");
        format!("`{}` does not end in one of {known}", path.display())
    })?;
    let model = mesh::model(request, None);
    let mut bytes = Vec::new();
    let file_notes = model.write(format, &mut bytes);
    let file_notes = file_notes.map_err(|error| error.to_string())?;
    write_whole(path, &bytes)
        .map_err(|error| format!("cannot write `{}`: {error}", path.display()))?;
    let triangles = model.triangles(format);
    let notes = model.notes.iter().chain(&file_notes).cloned();
    let sentence = format!("{triangles} triangles were saved in `{}`", path.display());
    Ok(std::iter::once(sentence)
        .chain(notes)
        .collect::<Vec<_>>()
        .join("; "))
}
