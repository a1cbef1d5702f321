//! Animations for papers and lectures: the dialog for recording one, and its progress.

use std::path::{Path, PathBuf};

use egui::{Align2, ComboBox, Grid, ProgressBar, Ui};
use export::animation::{self, Clip, Course, ParamChange};
use export::animation_file::AnimationFile;
use render::ViewId;
use session::motion::Motion;
use session::{InsideCamera, StatusMessage};

use super::Dialog;
use super::picture::{self, Decision};
use crate::engine::recording::Recording;
use crate::engine::recording::film::Film;
use crate::ui::number_field;
use crate::ui::window::Window;

/// The fields of the dialog for a recording.
#[derive(Clone, Debug)]
pub(crate) struct RecordDialog {
    pane: ViewId,
    /// The available motions, and the chosen one.
    moves: Vec<Moves>,
    chosen: usize,
    /// The course from the first picture to the last, for a param.
    course: Course,
    /// The geodesic camera that may walk, and its surface.
    camera: Option<(String, InsideCamera)>,
    /// The arc length of its walk, in the surface's units; backwards if negative.
    length: f64,
    trail: bool,
    /// True for a transparent background; `None` for a view without a background.
    transparent: Option<bool>,
    clip: Clip,
    pub(crate) path: String,
}

impl RecordDialog {
    /// Returns true if something can move, and the file is that of an animation.
    fn can_begin(&self) -> bool {
        let format = AnimationFile::of_path(Path::new(&self.path));
        !self.moves.is_empty() && format.is_some()
    }
}

/// A motion that can be recorded.
#[derive(Clone, Debug, PartialEq)]
enum Moves {
    /// The camera of the 3D view, once about the vertical line through its target.
    Turntable,
    /// A param, between two values.
    Param(ParamChange),
    /// The geodesic camera, in a direction with coordinates along X and Y.
    Walk(&'static str, [f64; 2]),
    /// The geodesic camera, along the walk whose trail is shown.
    Again(InsideCamera, Vec<Motion>),
}

impl Moves {
    fn is_walk(&self) -> bool {
        matches!(self, Self::Walk(..) | Self::Again(..))
    }

    fn words(&self, surface: &str) -> String {
        match self {
            Self::Turntable => "Turntable: the camera, once around".to_owned(),
            Self::Param(change) => format!("Param {}", change.name),
            Self::Walk(direction, _) => format!("Walk on {surface}, {direction}"),
            Self::Again(..) => format!("Walk on {surface}, the way just walked"),
        }
    }
}

/// Opens the dialog for a recording of the active view.
pub(crate) fn ask(window: &mut Window) {
    let pane = window.focus.view.clone();
    let Some(request) = window.kept(&pane) else {
        return;
    };
    let mut moves = Vec::new();
    moves.extend(request.view.space().map(|_| Moves::Turntable));
    for param in window.model.scene.iter().flat_map(|scene| &scene.params) {
        let ranges = param.ranges.iter();
        let (from, to) = ranges.map(|range| (range.min, range.max)).unzip();
        let name = param.name.clone();
        moves.push(Moves::Param(ParamChange { name, from, to }));
    }
    let surface = pane.object.clone();
    let surface = surface.or_else(|| window.focus.surface.clone());
    let choices = &window.model.choices;
    let camera = surface.and_then(|name| Some((name.clone(), *choices.inside.get(&name)?)));
    if let Some((name, _)) = &camera {
        let way = window.model.paths.get(name);
        let way = way.filter(|way| choices.preferences.marks.trail && !way.motions().is_empty());
        moves.extend(
            way.map(|way| Moves::Again(InsideCamera::Chart(way.start), way.motions().to_vec())),
        );
        moves.push(Moves::Walk("forward", [0.0, 1.0]));
        moves.push(Moves::Walk("to the right", [1.0, 0.0]));
    }
    let path = picture::in_folder(window, &picture::file_name(window, &pane, "gif"));
    // If nothing can move, there is no field for a file.
    let has_file = !moves.is_empty();
    window.dialogs.open = Some(Dialog::Record(RecordDialog {
        // Twice as far as the picture shows.
        length: camera
            .as_ref()
            .map_or(1.0, |(_, it)| rounded(2.0 * it.zoom())),
        camera,
        pane,
        moves,
        chosen: 0,
        course: Course::default(),
        trail: true,
        transparent: request.view.space().map(|_| false),
        clip: Clip {
            frames: animation::FRAMES,
            size: request.size,
            rate: animation::RATE,
        },
        path,
    }));
    window.dialogs.wants_name = has_file;
}

/// Rounds a number to two digits.
fn rounded(x: f64) -> f64 {
    let unit = 10f64.powf(x.abs().log10().floor() - 1.0);
    let near = (x / unit).round() * unit;
    if near.is_finite() { near } else { x }
}

/// Shows the progress of the running recording.
pub(super) fn show_recording(window: &mut Window, ui: &Ui) {
    if window
        .dialogs
        .recording
        .as_ref()
        .is_some_and(Recording::has_ended)
    {
        window.dialogs.recording = None;
    }
    if let Some(recording) = &window.dialogs.recording {
        progress(recording, ui);
    }
}

/// Shows the dialog.
pub(super) fn show(window: &mut Window, mut dialog: RecordDialog, ui: &Ui) {
    match picture::modal(ui, "Record", "Record", |ui| fields(&mut dialog, ui)) {
        Decision::Cancel => return,
        Decision::Save if dialog.can_begin() => return begin(window, &dialog),
        Decision::Choose => picture::choose(window, "Record", &dialog.path),
        Decision::Save | Decision::Stay => {}
    }
    window.dialogs.open = Some(Dialog::Record(dialog));
}

/// Shows the fields of the dialog. Returns whether the file is to be chosen in the desktop's dialog.
fn fields(dialog: &mut RecordDialog, ui: &mut Ui) -> bool {
    if dialog.moves.is_empty() {
        ui.label("Nothing to animate: the program needs a param, or a surface to walk on.");
        return false;
    }
    let mut choose = false;
    Grid::new("record").num_columns(2).show(ui, |ui| {
        what_moves(dialog, ui);
        motion(dialog, ui);
        clip(&mut dialog.clip, ui);
        format(&mut dialog.path, ui);
        choose = picture::file(ui, &mut dialog.path);
    });
    if dialog.moves[dialog.chosen].is_walk() {
        ui.checkbox(&mut dialog.trail, "Draw the trail");
    }
    picture::transparency(&mut dialog.transparent, ui);
    let path = Path::new(&dialog.path);
    let first = match AnimationFile::of_path(path) {
        Some(AnimationFile::Series) => animation::numbered(path, 0, dialog.clip.frames),
        _ => path.to_owned(),
    };
    if AnimationFile::of_path(path).is_none() {
        ui.colored_label(
            ui.visuals().error_fg_color,
            "The file's name must end in gif, apng, mp4, webm or png.",
        );
    } else {
        picture::replaced(ui, &first);
    }
    choose
}

/// Shows the row that chooses what moves.
fn what_moves(dialog: &mut RecordDialog, ui: &mut Ui) {
    let surface = dialog.camera.as_ref().map_or("", |(name, _)| name);
    let label = ui.label("What moves");
    let words = |k: usize| dialog.moves[k].words(surface);
    ComboBox::from_id_salt("what moves")
        .selected_text(words(dialog.chosen))
        .width(240.0)
        .show_ui(ui, |ui| {
            for k in 0..dialog.moves.len() {
                ui.selectable_value(&mut dialog.chosen, k, words(k));
            }
        })
        .response
        .labelled_by(label.id);
    ui.end_row();
}

/// Shows the rows of the chosen motion.
fn motion(dialog: &mut RecordDialog, ui: &mut Ui) {
    match &mut dialog.moves[dialog.chosen] {
        Moves::Param(change) => {
            for (title, values) in [("From", &mut change.from), ("To", &mut change.to)] {
                let label = ui.label(title);
                ui.horizontal(|ui| {
                    for value in values.iter_mut() {
                        let field = number_field::field(ui, value).speed(0.01);
                        ui.add(field).labelled_by(label.id);
                    }
                });
                ui.end_row();
            }
            let label = ui.label("Course");
            ui.horizontal(|ui| {
                for (course, name) in Course::ALL {
                    ui.selectable_value(&mut dialog.course, course, name);
                }
            })
            .response
            .labelled_by(label.id);
            ui.end_row();
        }
        Moves::Walk(..) => {
            let label = ui.label("Arc length");
            let speed = 0.01 * dialog.length.abs().max(1e-3);
            ui.add(number_field::field(ui, &mut dialog.length).speed(speed))
                .labelled_by(label.id);
            ui.end_row();
        }
        Moves::Turntable | Moves::Again(..) => {}
    }
}

/// Shows the rows of the number, the rate and the size of the frames.
fn clip(clip: &mut Clip, ui: &mut Ui) {
    let label = ui.label("Frames");
    ui.add(number_field::field(ui, &mut clip.frames).range(2..=animation::MOST_FRAMES))
        .labelled_by(label.id);
    ui.end_row();
    let label = ui.label("Frames per second");
    ui.add(number_field::field(ui, &mut clip.rate).range(animation::RATES))
        .labelled_by(label.id);
    ui.end_row();
    let sides = 1..=render::MAX_SIDE;
    for (side, name) in clip.size.iter_mut().zip(["Width", "Height"]) {
        let label = ui.label(name);
        let field = number_field::field(ui, side).range(sides.clone());
        ui.add(field.suffix(" px")).labelled_by(label.id);
        ui.end_row();
    }
}

/// Shows the row that chooses the format by the file's extension.
fn format(path: &mut String, ui: &mut Ui) {
    let label = ui.label("Format");
    ui.horizontal(|ui| {
        let now = AnimationFile::of_path(Path::new(path));
        for (kind, name, extension) in AnimationFile::ALL {
            if ui.selectable_label(now == Some(kind), name).clicked() {
                *path = Path::new(path)
                    .with_extension(extension)
                    .display()
                    .to_string();
            }
        }
    })
    .response
    .labelled_by(label.id);
    ui.end_row();
}

/// Starts a recording with the dialog's input.
fn begin(window: &mut Window, dialog: &RecordDialog) {
    let Some(request) = window.kept(&dialog.pane) else {
        return;
    };
    let id_of = |name: &str| request.scene.object(name).map(|(id, _)| id);
    let mut camera = dialog
        .camera
        .as_ref()
        .and_then(|(name, camera)| Some((id_of(name)?, *camera)));
    let mut change = None;
    let mut motions = Vec::new();
    let chosen = &dialog.moves[dialog.chosen];
    let course = match chosen {
        Moves::Turntable => Course::Loop,
        Moves::Param(_) => dialog.course,
        Moves::Walk(..) | Moves::Again(..) => Course::Once,
    };
    match chosen {
        Moves::Turntable => {}
        Moves::Param(it) => change = Some(it.clone()),
        Moves::Walk(_, [x, y]) => {
            let zoom = camera.map_or(1.0, |(_, camera)| camera.zoom());
            let way = dialog.length / zoom;
            motions.push(Motion::Walk([x * way, y * way]));
        }
        Moves::Again(start, way) => {
            camera = camera.map(|(id, _)| (id, *start));
            motions.clone_from(way);
        }
    }
    if chosen.is_walk() && camera.is_none() {
        let sentence = "the surface is not shown in the 3D view, so a walk on it is not visible";
        window.status_message = Some(StatusMessage::error(sentence));
        return;
    }
    // A param and a turntable are recorded with everything that the view shows, a walk with the camera that walks.
    if !chosen.is_walk() && request.view.shown_camera().is_none() {
        camera = None;
    }
    // In a view from inside, those on its own surface are shown.
    let own = request.view.geodesic_camera().map(|camera| camera.surface);
    let figure = window.dialogs.measuring.figure().and_then(|placed| {
        let id = id_of(&placed.surface)?;
        (own.is_none_or(|own| own == id)).then(|| (id, placed.figure.clone()))
    });
    let film = Film {
        figure,
        request,
        views: window.views.clone(),
        camera,
        trail: dialog.trail && chosen.is_walk(),
        change,
        turntable: *chosen == Moves::Turntable,
        course,
        motions,
        transparent: dialog.transparent == Some(true),
        clip: dialog.clip,
    };
    let path = PathBuf::from(&dialog.path);
    match Recording::start(window.events.status(), film, path) {
        Ok(recording) => window.dialogs.recording = Some(recording),
        Err(error) => {
            let sentence = format!("the recording cannot start: {error}");
            window.status_message = Some(StatusMessage::error(sentence));
        }
    }
}

/// Shows the progress of a recording, and the button that cancels it.
fn progress(recording: &Recording, ui: &Ui) {
    egui::Window::new("Recording")
        .anchor(Align2::RIGHT_BOTTOM, [-12.0, -36.0])
        .collapsible(false)
        .resizable(false)
        .show(ui.ctx(), |ui| {
            let (now, frames) = recording.progress();
            let done = now.saturating_sub(1) as f32 / frames.max(1) as f32;
            let words = format!("picture {} of {frames}", now.max(1));
            ui.add(ProgressBar::new(done).desired_width(220.0).text(words));
            if ui.button("Cancel the recording").clicked() {
                recording.cancel();
            }
        });
}
