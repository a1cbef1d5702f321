//! Measuring on surfaces: the user chooses a tool and clicks on points in any view; the answer appears in a small
//! window and is drawn on the surface. It follows the params and the text.
//!
//! ```text
//! click ──render thread──▶ add_place ──▶ Figure ──measure thread──▶ take ──▶ rows here, lines in the pictures
//! pointer ──render thread──▶ point ─────────────────────────┘
//! ```

use std::sync::Arc;
use std::time::Duration;

use egui::{Color32, Grid, Label, Rect, Response, Stroke, TextStyle, TextWrapMode, Ui};
use render::figure::{Figure, FigureKind};
use render::view::Hit;
use render::{PictureRequest, ViewId};
use session::camera_controller::Subject;
use session::clicks::ClickedObject;
use session::measuring::{Measured, PlacedFigure, Quantity, hint, title};
use session::motion::Motion;
use session::questions::{MeasureAnswer, MeasureQuestion, NO_WAY_BACK, OLD_WAY_BACK, PointedPlace};
use session::snapping::Snapping;
use session::{CameraPath, ChartCamera, InsideCamera, StatusMessage};

use crate::engine::measure_thread::MeasureThread;
use crate::ui::camera_input::pixel;
use crate::ui::window::Window;
use crate::ui::{key_names, number_field};

/// The time for which the pointer and the picture under it rest before the status line shows the point there, in seconds.
const POINTER_RESTS: f64 = 0.15;
/// The width of the window's content, and of its column of names, in points.
const WIDTH: f32 = 300.0;
const NAME_WIDTH: f32 = 96.0;
/// The gap between rows, in points.
const ROW_GAP: f32 = 2.0;
/// The width of a field for a parameter of a point, in points.
const FIELD_WIDTH: f32 = 112.0;
/// The number of lines for the point under the pointer: four quantities, one of which has a name of two lines.
const POINTER_LINES: f32 = 5.0;
/// The radius of the ring around the point to which a click would snap, in points.
const RING: f32 = 7.0;

/// The state of the window in which surfaces are measured.
#[derive(Debug, Default)]
pub(crate) struct Measuring {
    /// True while the window is open.
    is_open: bool,
    /// `None` until something has been measured.
    thread: Option<MeasureThread>,
    tool: FigureKind,
    figure: Option<PlacedFigure>,
    /// The figure that was last asked about, on its surface.
    asked: Option<(Subject, PlacedFigure)>,
    /// The answer for the last figure that has one.
    found: Option<Measured>,
    pointer: Pointer,
    /// The walk that was last asked about, with its answer.
    walk: Option<(Subject, Arc<CameraPath>, ChartCamera)>,
    walked: Vec<Quantity>,
}

/// The point under the pointer.
#[derive(Debug)]
struct Pointer {
    /// The request of the picture, the pixel and the snapping in the last question.
    asked: Option<(PictureRequest, [f64; 2], Snapping)>,
    /// The pixel to which a click there would snap.
    snapped: Option<[f64; 2]>,
    /// The rectangle of that picture on the screen.
    picture: Rect,
    /// The point that was found there, with its surface.
    found: Option<(Subject, PointedPlace)>,
    surface: String,
    /// The surface, and the part of a solid's set that was hit.
    title: String,
    rows: Vec<Quantity>,
    /// The object and the point, in short form.
    words: String,
}

impl Default for Pointer {
    fn default() -> Self {
        Self {
            asked: None,
            snapped: None,
            picture: Rect::NOTHING,
            found: None,
            surface: String::new(),
            title: String::new(),
            rows: Vec::new(),
            words: String::new(),
        }
    }
}

impl Measuring {
    /// Returns whether the window is open: then clicks on pictures add points to be measured.
    pub(crate) fn is_open(&self) -> bool {
        self.is_open
    }

    /// Returns the figure that is measured.
    pub(crate) fn figure(&self) -> Option<&PlacedFigure> {
        self.figure.as_ref()
    }

    /// Returns whether a click at the pointer would snap.
    pub(crate) fn snaps(&self) -> bool {
        self.is_open && self.pointer.snapped.is_some()
    }

    /// Returns the object and point under the pointer in short form, while it is over the picture of the question.
    pub(crate) fn under_pointer(&self, ui: &Ui) -> Option<&str> {
        let Pointer { picture, words, .. } = &self.pointer;
        let at = ui.input(|input| input.pointer.hover_pos());
        let shown = !words.is_empty() && at.is_some_and(|at| picture.contains(at));
        shown.then_some(words)
    }

    fn clear(&mut self) {
        self.figure = None;
        self.asked = None;
        self.found = None;
    }
}

/// Opens the window, or closes it with everything that was measured.
pub(crate) fn toggle(window: &mut Window) {
    if window.dialogs.measuring.is_open() {
        close(window);
    } else {
        window.dialogs.measuring.is_open = true;
    }
}

/// Closes the window, with everything that was measured.
pub(crate) fn close(window: &mut Window) {
    window.dialogs.measuring = Measuring {
        tool: window.dialogs.measuring.tool,
        ..Measuring::default()
    };
    window.model.measured = None;
}

/// Adds a point to the figure. A figure that is complete, or on another surface, is replaced by a new one.
pub(crate) fn add_place(window: &mut Window, surface: &str, hit: &Hit) {
    let Some((_, object)) = window.model.object(surface) else {
        return;
    };
    if object.shape.manifold().is_none() {
        let text = format!("`{surface}` is not a surface: click on a surface or a metric.");
        window.status_message = Some(StatusMessage::info(text));
        return;
    }
    let camera = window.model.settle_camera(surface, false);
    let camera = camera.and_then(|camera| camera.chart().copied());
    let measuring = &mut window.dialogs.measuring;
    let tool = measuring.tool;
    let centre = camera.map(|camera| camera.at);
    let begun = measuring.figure.take();
    let placed = PlacedFigure::with_place(begun, tool, surface, centre, hit.parameters);
    measuring.figure = Some(placed);
    measuring.found = None;
}

/// Asks for the measures of the point that was found under the pointer; for an object without measures, shows its name.
pub(crate) fn point(window: &mut Window, clicked: &ClickedObject<'_>) {
    let surface = clicked.object.name.as_str();
    let camera = window.model.choices.inside.get(surface);
    let question = MeasureQuestion::pointer(clicked, camera);
    let pointer = &mut window.dialogs.measuring.pointer;
    let title = clicked.title();
    if question.is_none() || pointer.found.is_none() || pointer.title != title {
        pointer.words = clicked.words();
        pointer.rows.clear();
    }
    surface.clone_into(&mut pointer.surface);
    pointer.title = title;
    pointer.found = None;
    if let Some(MeasureQuestion::Pointer(place, _)) = question {
        pointer.found = Some((clicked.subject(), place));
    }
    if let Some(question) = question {
        ask(window, clicked.subject(), question);
    }
}

/// Notes that there is nothing under the pointer.
pub(crate) fn point_at_nothing(window: &mut Window) {
    let pointer = &mut window.dialogs.measuring.pointer;
    pointer.found = None;
    pointer.words.clear();
    pointer.rows.clear();
}

/// Sends a question to the thread that measures, which is started by the first one.
fn ask(window: &mut Window, subject: Subject, question: MeasureQuestion) {
    let events = &window.events;
    let thread = &mut window.dialogs.measuring.thread;
    let thread = match thread {
        Some(thread) => thread,
        None => match MeasureThread::start(events.measured()) {
            Ok(started) => thread.insert(started),
            Err(error) => {
                let sentence = format!("nothing can be measured: {error}");
                window.status_message = Some(StatusMessage::error(sentence));
                return;
            }
        },
    };
    thread.ask(subject, question);
}

/// Asks for the point under the pointer if it has moved over a picture, or the picture under it has changed: at once
/// while the window is open, otherwise when both rest, because the search for the shortest geodesic to that point would
/// take a processor from the next picture.
pub(crate) fn follow_pointer(window: &mut Window, ui: &Ui, pane: &ViewId, response: &Response) {
    if ui.input(|input| input.pointer.any_down()) {
        return;
    }
    let Some(at) = response.hover_pos() else {
        return;
    };
    let Some(request) = window.pictures.sent(pane) else {
        return;
    };
    let is_open = window.dialogs.measuring.is_open();
    if request.moving {
        if !is_open {
            // What was there is no longer under the pointer.
            let pointer = &mut window.dialogs.measuring.pointer;
            pointer.words.clear();
            pointer.asked = None;
        }
        return;
    }
    let now = pixel(request, response.rect, at);
    let snapping = match is_open {
        true => snapping(ui),
        false => Snapping::Off,
    };
    let known = &window.dialogs.measuring.pointer.asked;
    if known.as_ref().is_some_and(|(before, pixel, known)| {
        (*pixel, *known) == (now, snapping) && before == request
    }) {
        return;
    }
    if !is_open {
        let (pointer, time) =
            ui.input(|input| (input.pointer.time_since_last_movement(), input.time));
        let rested = f64::from(pointer).min(time - window.pictures.changed_at(pane));
        if rested < POINTER_RESTS {
            let left = Duration::from_secs_f64(POINTER_RESTS - rested);
            ui.ctx().request_repaint_after(left);
            return;
        }
    }
    let request = request.clone();
    let thread = &window.pictures.render_thread;
    thread.point(request.clone(), now, snapping);
    let pointer = &mut window.dialogs.measuring.pointer;
    pointer.asked = Some((request, now, snapping));
    pointer.picture = response.rect;
}

/// Returns the snapping of clicks: Alt turns it off.
pub(crate) fn snapping(ui: &Ui) -> Snapping {
    match ui.input(|input| input.modifiers.alt) {
        true => Snapping::Off,
        false => Snapping::On,
    }
}

/// Takes over the pixel to which a click at the pointer would snap.
pub(crate) fn take_snap(window: &mut Window, snapped: Option<[f64; 2]>) {
    window.dialogs.measuring.pointer.snapped = snapped;
}

/// Draws a ring around the point to which a click at the pointer would snap.
pub(crate) fn paint_snap(window: &Window, ui: &Ui, response: &Response) {
    let measuring = &window.dialogs.measuring;
    let Pointer {
        snapped: Some([x, y]),
        asked: Some((request, _, Snapping::On)),
        picture,
        ..
    } = &measuring.pointer
    else {
        return;
    };
    if !measuring.is_open() || !response.hovered() || *picture != response.rect {
        return;
    }
    let share = |at: f64, side: u32| (at / f64::from(side)) as f32;
    let [width, height] = request.size;
    let offset = egui::vec2(share(*x, width), share(*y, height)) * picture.size();
    let painter = ui.painter_at(*picture);
    let at = picture.left_top() + offset;
    painter.circle_stroke(at, RING, Stroke::new(4.0, Color32::from_black_alpha(160)));
    painter.circle_stroke(at, RING, Stroke::new(2.0, Color32::WHITE));
}

/// Measures the last point under the pointer again if its surface has changed. A point on a solid is dropped, since the
/// solid's surface may no longer contain it.
fn ask_pointer(window: &mut Window) {
    let pointer = &window.dialogs.measuring.pointer;
    let Some((before, place)) = &pointer.found else {
        return;
    };
    let Some(subject) = window.model.subject(&pointer.surface) else {
        return;
    };
    if before.is_same(&subject) {
        return;
    }
    let camera = window.model.choices.inside.get(&pointer.surface);
    let camera = camera.and_then(InsideCamera::chart);
    let place = match *place {
        PointedPlace::InChart(uv, _) => PointedPlace::InChart(uv, camera.map(ChartCamera::frame)),
        PointedPlace::InSpace(_) => return point_at_nothing(window),
    };
    window.dialogs.measuring.pointer.found = Some((subject.clone(), place));
    ask(window, subject, MeasureQuestion::Pointer(place, None));
}

/// Takes over an answer. An answer for a figure that has changed since is not shown.
pub(crate) fn take(window: &mut Window, answer: MeasureAnswer) {
    let measuring = &mut window.dialogs.measuring;
    if let MeasureAnswer::Pointer(rows, words) = answer {
        // The object under the pointer may no longer be a surface.
        if measuring.pointer.found.is_some() {
            measuring.pointer.words = format!("{} at {words}", measuring.pointer.title);
            measuring.pointer.rows = rows;
        }
        return;
    }
    if !measuring.is_open() {
        return;
    }
    match answer {
        MeasureAnswer::Pointer(..) => {}
        MeasureAnswer::Figure(figure, measured) => {
            if measuring.figure.as_ref() == Some(&figure) {
                window.model.measured = Some((figure.surface, measured.lines.clone()));
                measuring.found = Some(measured);
            }
        }
        MeasureAnswer::Walk(rows) => measuring.walked = rows,
        MeasureAnswer::WayBack {
            surface,
            from,
            step,
        } => {
            let camera = window.model.choices.inside.get(&surface);
            let camera = camera.and_then(InsideCamera::chart);
            let is_there = camera.is_some_and(|camera| camera.frame() == from);
            let sentence = match step {
                Some(step) if is_there => {
                    window.model.move_camera(&surface, Motion::Walk(step));
                    window.model.history.settle();
                    return;
                }
                Some(_) => OLD_WAY_BACK,
                None => NO_WAY_BACK,
            };
            window.status_message = Some(StatusMessage::info(sentence));
        }
    }
}

/// Shows the window, and asks again if the figure, its surface or the walk has changed.
pub(crate) fn show(window: &mut Window, ui: &mut Ui) {
    if !window.dialogs.measuring.is_open() {
        return;
    }
    ask_pointer(window);
    ask_figure(window);
    ask_walk(window);
    let mut open = true;
    let screen = ui.ctx().content_rect();
    // It grows upwards from the lower left corner of the active view, beside the program and the settings.
    let place = window.panes.place_of(&window.focus.view);
    let place = place.unwrap_or(screen);
    let width = WIDTH.min(screen.width() - 48.0);
    egui::Window::new("Measure")
        .open(&mut open)
        .resizable(false)
        .pivot(egui::Align2::LEFT_BOTTOM)
        .default_pos(place.left_bottom() + egui::vec2(8.0, -8.0))
        // Otherwise it would be as wide as the screen before it is first shown, and be positioned for that width.
        .default_size([width, 0.0])
        .show(ui.ctx(), |ui| {
            // A changing value does not make it wider.
            ui.set_width(width);
            contents(window, ui);
        });
    if !open {
        close(window);
    }
}

fn contents(window: &mut Window, ui: &mut Ui) {
    answers(window, ui);
    ui.separator();
    tools(window, ui);
}

/// Shows the kinds of figures, at the lower edge of the window, which stays where it is.
fn tools(window: &mut Window, ui: &mut Ui) {
    let measuring = &mut window.dialogs.measuring;
    ui.horizontal_wrapped(|ui| {
        for tool in FigureKind::ALL {
            let chosen = ui.selectable_label(measuring.tool == tool, title(tool));
            if chosen.clicked() && measuring.tool != tool {
                measuring.tool = tool;
                measuring.clear();
                window.model.measured = None;
            }
        }
    });
}

fn answers(window: &mut Window, ui: &mut Ui) {
    let measuring = &mut window.dialogs.measuring;
    // The answer takes the place of the hints, so that the window covers less of the view. The scope uses one of egui's
    // automatic ids with and without them, so that the fields below keep theirs, and the focus.
    let is_asking = measuring.found.is_none();
    ui.scope(|ui| {
        if is_asking {
            ui.weak(hint(measuring.tool));
            let snapping =
                "A ring shows the point, end or corner to which a click snaps; Alt turns this off.";
            ui.weak(key_names::named(ui.ctx(), snapping));
        }
    });
    if let Some(PlacedFigure { surface, figure }) = &mut measuring.figure {
        ui.separator();
        ui.strong(format!("{} on {surface}", title(figure.kind)));
        places(ui, figure);
        if let Some(found) = &measuring.found {
            rows(ui, "figure", &found.rows, TextWrapMode::Wrap);
            if let Some(note) = &found.note {
                ui.label(note);
            }
            if let Some(mut radius) = found.radius {
                ui.horizontal(|ui| {
                    ui.label("another radius");
                    let speed = 0.01 * radius;
                    let drag = number_field::field(ui, &mut radius)
                        .speed(speed)
                        .range(0.0..=1e12);
                    if ui.add(drag).changed() {
                        figure.radius = Some(radius);
                    }
                });
            }
        } else {
            ui.weak("measuring …");
        }
        if ui.button("Clear").clicked() {
            measuring.clear();
            window.model.measured = None;
        }
    }
    let measuring = &window.dialogs.measuring;
    ui.separator();
    pointer(ui, &measuring.pointer);
    if measuring.walk.is_some() && !measuring.walked.is_empty() {
        ui.separator();
        ui.strong("Walk");
        rows(ui, "walk", &measuring.walked, TextWrapMode::Wrap);
        let hint = "Walks along the shortest geodesic to the start of the trail";
        if ui.button("Close the walk").on_hover_text(hint).clicked() {
            walk_back(window);
        }
    }
}

/// Shows the points of a figure, each with fields for its parameters.
fn places(ui: &mut Ui, figure: &mut Figure) {
    Grid::new("places").num_columns(3).show(ui, |ui| {
        ui.spacing_mut().interact_size.x = FIELD_WIDTH;
        for (letter, place) in ('A'..='Z').zip(&mut figure.places) {
            ui.label(letter.to_string());
            for (name, value) in ["u", "v"].into_iter().zip(place) {
                let field = number_field::field(ui, value).speed(0.01).max_decimals(6);
                let field = ui.add(field.prefix(format!("{name} = ")));
                field.accessible_name(format!("{name} of {letter}"));
            }
            ui.end_row();
        }
    });
}

/// Shows the point under the pointer, in the same room whatever is known of it.
fn pointer(ui: &mut Ui, pointer: &Pointer) {
    match pointer.rows.is_empty() {
        true => ui.weak("The pointer is on no surface."),
        false => ui.strong(format!("Pointer on {}", pointer.surface)),
    };
    let height = POINTER_LINES * (ui.text_style_height(&TextStyle::Body) + ROW_GAP);
    ui.scope(|ui| {
        ui.set_min_height(height);
        rows(ui, "pointer", &pointer.rows, TextWrapMode::Truncate);
    });
}

/// Shows quantities in a column of names and one of values; `wrap_mode` applies to values that are too wide.
fn rows(ui: &mut Ui, id: &str, rows: &[Quantity], wrap_mode: TextWrapMode) {
    let value_width = ui.available_width() - NAME_WIDTH - ui.spacing().item_spacing.x;
    // Rows of text are as high as their text.
    let grid = Grid::new(id).num_columns(2).min_row_height(0.0);
    let grid = grid.spacing([ui.spacing().item_spacing.x, ROW_GAP]);
    grid.show(ui, |ui| {
        for Quantity { name, value } in rows {
            cell(ui, NAME_WIDTH, Label::new(name).wrap().selectable(false));
            cell(ui, value_width, Label::new(value).wrap_mode(wrap_mode));
            ui.end_row();
        }
    });
}

/// Shows a label in a cell of a grid, with the same width whatever it contains.
fn cell(ui: &mut Ui, width: f32, label: Label) {
    ui.vertical(|ui| {
        ui.set_width(width);
        ui.add(label);
    });
}

fn ask_figure(window: &mut Window) {
    let Some(figure) = window.dialogs.measuring.figure.clone() else {
        return;
    };
    let Some(subject) = window.model.subject(&figure.surface) else {
        return;
    };
    let measuring = &mut window.dialogs.measuring;
    let is_known =
        |(before, known): &(Subject, PlacedFigure)| before.is_same(&subject) && *known == figure;
    if measuring.asked.as_ref().is_some_and(is_known) {
        return;
    }
    measuring.asked = Some((subject.clone(), figure.clone()));
    ask(window, subject, MeasureQuestion::Figure(figure));
}

/// Asks for the measures of the active surface's trail.
fn ask_walk(window: &mut Window) {
    let walk = trail(window);
    let measuring = &mut window.dialogs.measuring;
    let Some((subject, path, camera)) = walk else {
        measuring.walk = None;
        return;
    };
    let is_known = measuring.walk.as_ref().is_some_and(|(before, known, end)| {
        before.is_same(&subject) && Arc::ptr_eq(known, &path) && *end == camera
    });
    if !is_known {
        let question = MeasureQuestion::walk(&path, &camera);
        measuring.walk = Some((subject.clone(), path, camera));
        ask(window, subject, question);
    }
}

/// Returns the active surface's trail, with its camera.
fn trail(window: &mut Window) -> Option<(Subject, Arc<CameraPath>, ChartCamera)> {
    let surface = window.focus.surface.clone()?;
    let path = window.model.paths.get(&surface)?.clone();
    let camera = *window.model.choices.inside.get(&surface)?.chart()?;
    Some((window.model.subject(&surface)?, path, camera))
}

fn walk_back(window: &mut Window) {
    let measuring = &window.dialogs.measuring;
    if let Some((subject, path, camera)) = &measuring.walk {
        let question = MeasureQuestion::way_back(path, camera);
        ask(window, subject.clone(), question);
    }
}
