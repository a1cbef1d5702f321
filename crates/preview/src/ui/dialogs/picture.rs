//! Pictures and meshes for other programs: the dialogs before they are written.

use std::path::{Path, PathBuf};

use egui::{DragValue, Grid, Ui};
use export::mesh::{self, MeshFormat};
use export::whole_file::write_whole;
use render::{Backend, PictureRequest, ViewId};

use crate::channel::report_when_done;
use crate::engine::request::with_curvatures;
use crate::io::files;
use crate::ui::window::Window;

/// The fields of the dialog for a picture.
#[derive(Clone, Debug)]
pub(crate) struct PictureDialog {
    pane: ViewId,
    size: [u32; 2],
    /// Set to true for a transparent background; none of a view without a background.
    transparent: Option<bool>,
    pub(crate) path: String,
}

/// The button by which a dialog was left.
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
    window.dialogs.picture = Some(PictureDialog {
        pane: window.focus.view.clone(),
        size: request.size,
        transparent: request.view.space().map(|_| false),
        path: in_folder(window, &file_name(&window.focus.view, "png")),
    });
}

/// Opens the dialog for a mesh.
pub(crate) fn ask_for_mesh(window: &mut Window) {
    window.dialogs.mesh = Some(in_folder(window, "scene.glb"));
}

/// The first name of a file for a picture of a view.
pub(crate) fn file_name(id: &ViewId, extension: &str) -> String {
    format!("{}.{extension}", id.object.as_ref().unwrap_or(&id.kind))
}

/// A name in the program's folder.
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

/// The dialogs that are open.
pub(crate) fn show(window: &mut Window, ui: &Ui) {
    if let Some(mut dialog) = window.dialogs.picture.take() {
        match picture(&mut dialog, ui) {
            Decision::Stay => window.dialogs.picture = Some(dialog),
            Decision::Cancel => {}
            Decision::Choose => {
                choose(window, "Save picture", &dialog.path);
                window.dialogs.picture = Some(dialog);
            }
            Decision::Save => write_picture(window, &dialog),
        }
    }
    if let Some(mut path) = window.dialogs.mesh.take() {
        match mesh(&mut path, ui) {
            Decision::Stay => window.dialogs.mesh = Some(path),
            Decision::Cancel => {}
            Decision::Choose => {
                choose(window, "Export mesh", &path);
                window.dialogs.mesh = Some(path);
            }
            Decision::Save => write_mesh(window, &path),
        }
    }
}

fn picture(dialog: &mut PictureDialog, ui: &Ui) -> Decision {
    modal(ui, "Save picture", "Save", |ui| {
        let mut choose = false;
        Grid::new("picture").num_columns(2).show(ui, |ui| {
            let sides = 1..=render::MAX_SIDE;
            for (side, name) in dialog.size.iter_mut().zip(["Width", "Height"]) {
                let label = ui.label(name);
                ui.add(DragValue::new(side).range(sides.clone()).suffix(" px"))
                    .labelled_by(label.id);
                ui.end_row();
            }
            choose = file(ui, &mut dialog.path);
        });
        transparency(&mut dialog.transparent, ui);
        replaced(ui, Path::new(&dialog.path));
        choose
    })
}

fn mesh(path: &mut String, ui: &Ui) -> Decision {
    modal(ui, "Export mesh", "Save", |ui| {
        let mut choose = false;
        Grid::new("mesh").num_columns(2).show(ui, |ui| {
            choose = file(ui, path);
        });
        ui.label("The extension says which format: obj, ply, stl, gltf or glb.");
        replaced(ui, Path::new(path));
        choose
    })
}

/// A box for a transparent background, of a view that has one.
pub(crate) fn transparency(transparent: &mut Option<bool>, ui: &mut Ui) {
    if let Some(transparent) = transparent {
        ui.checkbox(transparent, "Transparent background");
    }
}

/// A field for a file; whether it is to be chosen in the desktop's dialog.
pub(crate) fn file(ui: &mut Ui, path: &mut String) -> bool {
    let label = ui.label("File");
    let choose = ui
        .horizontal(|ui| {
            let edit = egui::TextEdit::singleline(path).desired_width(320.0);
            ui.add(edit).labelled_by(label.id);
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

/// Says that a file will be replaced, if there is one.
pub(crate) fn replaced(ui: &mut Ui, path: &Path) {
    if path.is_file() {
        ui.colored_label(
            ui.visuals().warn_fg_color,
            "There is such a file: it will be replaced.",
        );
    }
}

/// A dialog with `content`, which says whether a file is to be chosen, and a button that does what `verb` says.
pub(crate) fn modal(
    ui: &Ui,
    title: &str,
    verb: &str,
    content: impl FnOnce(&mut Ui) -> bool,
) -> Decision {
    let mut decision = Decision::Stay;
    let modal = egui::Modal::new(egui::Id::unique(title)).show(ui.ctx(), |ui| {
        ui.heading(title);
        if content(ui) {
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
    if modal.should_close() {
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
    let Some(mut request) = window.kept(&dialog.pane) else {
        return;
    };
    request.size = dialog.size;
    if let Some(space) = request.view.space_mut()
        && dialog.transparent == Some(true)
    {
        space.background = Some([0; 4]);
    }
    let (path, views) = (PathBuf::from(&dialog.path), window.views.clone());
    report_when_done(window.events.status(), move || {
        files::save_picture(&path, &views, &request)
    });
}

fn write_mesh(window: &Window, path: &str) {
    // Colours and textures are those of the first view.
    let first = ViewId::of_scene(window.views.first().name());
    let request = window
        .pictures
        .sent(&first)
        .or_else(|| window.pictures.sent(&window.focus.view));
    let Some(request) = request.cloned() else {
        return;
    };
    let path = PathBuf::from(path);
    report_when_done(window.events.status(), move || {
        save_mesh(&path, &with_curvatures(request))
    });
}

fn save_mesh(path: &Path, request: &PictureRequest) -> Result<String, String> {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let format = MeshFormat::from_extension(&extension).ok_or_else(|| {
        let known = MeshFormat::ALL.map(MeshFormat::extension).join(", ");
        format!("`{}` does not end in one of {known}", path.display())
    })?;
    let model = mesh::model(request, None);
    let mut bytes = Vec::new();
    let told = model.write(format, &mut bytes);
    let told = told.map_err(|error| error.to_string())?;
    write_whole(path, &bytes)
        .map_err(|error| format!("cannot write `{}`: {error}", path.display()))?;
    let triangles: usize = model.parts.iter().map(|part| part.triangles()).sum();
    let notes = model.notes.iter().chain(&told).cloned();
    let sentence = format!("{triangles} triangles are in `{}`", path.display());
    Ok(std::iter::once(sentence)
        .chain(notes)
        .collect::<Vec<_>>()
        .join("; "))
}
