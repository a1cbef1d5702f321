//! Above the panes, banners; below them, the status line, which counts the errors.

use egui::{Panel, RichText, Ui};
use session::measuring::number;
use session::{MessageKind, StatusMessage};
use syntax::text::capitalised;

use crate::io::link::DisconnectReason;
use crate::ui::window::{Pictures, TextSource, Window};

/// Shows a banner above the panes when the server is gone.
pub(crate) fn banners(window: &mut Window, ui: &mut Ui) {
    let TextSource::Attached {
        disconnected: Some(reason),
        ..
    } = &window.text.source
    else {
        return;
    };
    let visuals = ui.visuals();
    let (colour, text) = match reason {
        DisconnectReason::Gone(reason) => {
            let gone = "The language server has exited; the picture shows its last text.";
            let because = reason.as_ref().map(|it| format!(" ({it})"));
            let text = format!("{gone}{}", because.unwrap_or_default());
            (visuals.warn_fg_color, text)
        }
        DisconnectReason::Refused(sentence) => (visuals.error_fg_color, sentence.clone()),
    };
    Panel::top("banner").show(ui, |ui| {
        ui.colored_label(colour, text);
    });
}

/// Shows the status line: a single row, so that no sentence moves the pictures; the full sentence is shown on hover.
pub(crate) fn line(window: &mut Window, ui: &mut Ui) {
    let height = ui.spacing().interact_size.y;
    let frame = egui::Frame::side_top_panel(ui.style()).fill(window.display.background(ui));
    let panel = Panel::bottom("status").frame(frame);
    panel.exact_size(height).show(ui, |ui| {
        ui.horizontal_centered(|ui| {
            ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Truncate);
            let colour = if window.model.is_stale() {
                ui.visuals().error_fg_color
            } else {
                ui.visuals().text_color()
            };
            let status = window.model.status();
            let link = ui.link(RichText::new(capitalised(&status)).color(colour));
            let took = window.model.program.took.as_secs_f64() * 1e3;
            let link = link.on_hover_text(format!("compiled in {took:.1} ms"));
            let link = link.accessible_name(format!("Status: {status}"));
            if link.clicked() {
                let faults = &window.model.faults;
                let first = faults.errors().next().or(faults.findings().first());
                if let Some(span) = first.map(|it| it.span) {
                    window.open_place(span);
                }
            }
            ui.separator();
            if window.model.choices.preferences.run_times {
                costs(window, ui);
                ui.label(&window.display.backend);
                ui.separator();
            }
            scale_bar(window, ui);
            trail(window, ui);
            if let Some(words) = window.dialogs.measuring.under_pointer(ui) {
                ui.separator();
                ui.label(words);
            }
            notes(&window.pictures, ui);
            expire(&mut window.status_message, ui);
            if let Some(StatusMessage { kind, text }) = &window.status_message {
                ui.separator();
                if *kind == MessageKind::Failed {
                    ui.colored_label(ui.visuals().error_fg_color, text);
                } else {
                    ui.label(text);
                }
            }
        });
    });
}

/// The time for which the line reports a completed action, in seconds.
const SHOWN: f64 = 10.0;

/// Removes the report of a completed action after a while.
fn expire(message: &mut Option<StatusMessage>, ui: &Ui) {
    let id = egui::Id::unique("sentence of the status line");
    let Some(shown) = message.clone().filter(|it| it.kind == MessageKind::Done) else {
        ui.data_mut(|data| data.remove::<(String, f64)>(id));
        return;
    };
    let now = ui.input(|input| input.time);
    let known = ui.data(|data| data.get_temp::<(String, f64)>(id));
    let since = known.filter(|(text, _)| *text == shown.text);
    let since = since.map_or(now, |(_, since)| since);
    let left = SHOWN - (now - since);
    if left > 0.0 {
        ui.data_mut(|data| data.insert_temp(id, (shown.text, since)));
        ui.ctx()
            .request_repaint_after(std::time::Duration::from_secs_f64(left));
    } else {
        ui.data_mut(|data| data.remove::<(String, f64)>(id));
        *message = None;
    }
}

/// Shows the cost of the active pane's picture, and of the window's last frame without it.
fn costs(window: &Window, ui: &mut Ui) {
    let Some(picture) = window.pictures.shown(&window.focus.view) else {
        return;
    };
    let [picture_took, frame_took] =
        [picture.took, window.display.clock.painting].map(|time| time.as_secs_f64() * 1e3);
    ui.label(format!(
        "picture {picture_took:.1} ms, frame {frame_took:.1} ms"
    ));
    if let Some((work, estimate)) = picture.geodesics {
        ui.separator();
        let error = estimate.map_or(String::new(), |it| format!(", error ≤ {:.2} px", it.max));
        ui.label(format!(
            "{} steps, {} evaluations{error}",
            work.steps, work.evaluations
        ));
    }
    ui.separator();
}

/// Shows a scale bar for the centre of the active view: a round distance and its length.
fn scale_bar(window: &Window, ui: &mut Ui) {
    let Some(unit) = point_in_view(window, ui) else {
        return;
    };
    let distance = round_distance(BAR * unit);
    let length = (distance / unit) as f32;
    let (place, _) = ui.allocate_exact_size(egui::vec2(length, 10.0), egui::Sense::hover());
    let stroke = egui::Stroke::new(1.5, ui.visuals().text_color());
    let painter = ui.painter();
    painter.hline(place.x_range(), place.center().y, stroke);
    for x in [place.left(), place.right()] {
        painter.vline(x, place.y_range(), stroke);
    }
    let hint = "The length of the bar in the middle of the view in use";
    let words = number(distance);
    let label = ui.label(&words).on_hover_text(hint);
    label.accessible_name(format!("Scale: {words}"));
}

/// The approximate length of the scale bar in points.
const BAR: f64 = 60.0;

/// Returns the distance that corresponds to one point of the screen at the centre of the active view.
fn point_in_view(window: &Window, ui: &Ui) -> Option<f64> {
    let id = &window.focus.view;
    let room = window.pictures.of_views.get(id)?.room?;
    let shorter = f64::from(room[0].min(room[1])) / f64::from(ui.ctx().pixels_per_point());
    let side = match &id.object {
        Some(surface) => 2.0 * window.model.choices.inside.get(surface)?.zoom(),
        None => window.model.choices.space?.side_seen(),
    };
    let unit = side / shorter;
    (unit > 0.0 && unit.is_finite()).then_some(unit)
}

/// Returns the greatest number of the form 1, 2 or 5 times a power of ten that is at most `most`.
fn round_distance(most: f64) -> f64 {
    let power = 10_f64.powf(most.log10().floor());
    let steps = [5.0, 2.0].map(|step| step * power);
    steps
        .into_iter()
        .find(|step| *step <= most)
        .unwrap_or(power)
}

/// Shows the length of the trail that is drawn.
fn trail(window: &Window, ui: &mut Ui) {
    let surface = window.focus.view.object.as_ref();
    let surface = surface.or(window.focus.surface.as_ref());
    let leaves = window.model.choices.preferences.marks.trail;
    let path = surface.and_then(|name| window.model.paths.get(name));
    if let Some(path) = path.filter(|_| leaves) {
        ui.separator();
        ui.label(format!("trail of length {:.4}", path.trail.length));
    }
}

/// Shows the notes of the visible pictures.
fn notes(pictures: &Pictures, ui: &mut Ui) {
    let mut notes: Vec<&str> = Vec::new();
    let seen = pictures.of_views.values().filter(|view| view.on_screen);
    for picture in seen.filter_map(|view| view.picture.as_ref()) {
        // The time that a picture took is in the status line itself.
        for note in &picture.notes {
            if !notes.contains(&note.as_str()) {
                notes.push(note);
            }
        }
    }
    if notes.is_empty() {
        return;
    }
    ui.separator();
    let first = match notes.len() {
        1 => notes[0].to_owned(),
        n => format!("{} (and {} more)", notes[0], n - 1),
    };
    ui.weak(first).on_hover_text(notes.join("\n"));
}
