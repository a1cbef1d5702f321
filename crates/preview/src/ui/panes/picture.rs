//! The pane of a view: a picture that fills it, with focus, a name, and a mark if it is stale.

use egui::{
    Align2, Color32, EventFilter, FontId, Id, Rect, Role, Sense, Stroke, StrokeKind, Ui, UiBuilder,
    WidgetInfo,
};
use render::{ViewId, Views};
use session::Model;
use syntax::text::capitalised;

use crate::ui::gpu_surface::TextureBinding;
use crate::ui::welcome;
use crate::ui::window::Window;

/// Returns the focus id of a pane's picture.
pub(crate) fn id(pane: &ViewId) -> Id {
    Id::unique(("picture", pane))
}

/// Draws a view's newest picture, sets the size of the next one, and moves the view's camera by the pointer.
pub(super) fn show(window: &mut Window, ui: &mut Ui, pane: &ViewId) {
    let room = ui.available_size().max(egui::vec2(16.0, 16.0));
    let (_, rect) = ui.allocate_space(room);
    let response = ui.interact(rect, id(pane), Sense::click_and_drag());
    let scale = ui.pixels_per_point();
    // The number of physical pixels between its edges.
    let [from, to] = [rect.min, rect.max].map(|corner| (corner.to_vec2() * scale).round());
    let pixels = [to.x - from.x, to.y - from.y].map(|side| side.max(1.0) as u32);
    window.make_room(pane, pixels);
    let name = words(window, pane);
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &name));
    if response.clicked() || response.drag_started() || response.gained_focus() {
        response.request_focus();
        window.activate(pane);
    }
    paint(window, ui, pane, rect);
    if pane.object.is_none() && window.text.is_blank() {
        begin(window, ui, rect);
    }
    if response.has_focus() {
        // The arrow keys move its camera instead of the focus.
        let arrows = EventFilter {
            horizontal_arrows: true,
            vertical_arrows: true,
            ..EventFilter::default()
        };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
        let stroke = Stroke::new(2.0, ui.visuals().selection.stroke.color);
        ui.painter()
            .rect_stroke(rect.shrink(1.0), 0.0, stroke, StrokeKind::Inside);
    }
    if is_set_off(&window.model, pane) {
        let [r, g, b] = render::style::EMPHASIS_COLOUR;
        let stroke = Stroke::new(3.0, Color32::from_rgb(r, g, b));
        ui.painter()
            .rect_stroke(rect.shrink(2.0), 0.0, stroke, StrokeKind::Inside);
    }
    let place = [rect.left(), rect.top(), rect.width(), rect.height()];
    let place = place.map(|x| x * scale);
    window
        .records
        .counters
        .panes
        .insert(pane.to_string(), place);
    window
        .camera_input(pane)
        .pointer(window, ui, pane, &response);
    if response.hovered() {
        let at = response.hover_pos();
        if std::mem::replace(&mut window.focus.pointer, at) != at {
            window.focus.pointed = Some(pane.clone());
        }
        crate::ui::measure::follow_pointer(window, ui, pane, &response);
        crate::ui::measure::paint_snap(window, ui, &response);
    }
}

/// Shows templates instead of the picture of a blank program.
fn begin(window: &mut Window, ui: &mut Ui, rect: Rect) {
    let room = Rect::from_center_size(rect.center(), egui::vec2(260.0, 70.0));
    let builder = UiBuilder::new().max_rect(room.intersect(rect));
    let chosen = ui.scope_builder(builder, |ui| {
        let frame = egui::Frame::popup(ui.style());
        let shown = frame.show(ui, |ui| {
            ui.label("The program is empty. Begin with a");
            ui.horizontal(welcome::templates).inner
        });
        shown.inner
    });
    if let Some(text) = chosen.inner {
        window.replace_text(text);
    }
}

fn paint(window: &mut Window, ui: &Ui, pane: &ViewId, rect: Rect) {
    let painter = ui.painter_at(rect);
    let stale = stale(&window.model, &window.views, pane);
    let mut error = None;
    let mut covered = false;
    let view = window.pictures.of_views.get_mut(pane);
    if let Some(picture) = view.and_then(|view| view.picture.as_mut()) {
        if let Some(painted) = picture.fresh.take() {
            let before = picture.binding.take();
            picture.binding =
                TextureBinding::new(painted, before, window.display.surface.as_ref(), ui.ctx());
        }
        if let Some(binding) = &picture.binding {
            binding.paint(&painter, rect);
            // Views of the scene dim only the objects that are out of date.
            if stale.is_some() && pane.object.is_some() {
                painter.rect_filled(rect, 0.0, Color32::from_black_alpha(65));
            }
            covered = true;
        }
        error.clone_from(&picture.error);
    }
    if !covered {
        let [r, g, b] = window.model.background();
        painter.rect_filled(rect, 0.0, Color32::from_rgb(r, g, b));
    }
    if let Some(words) = stale {
        badge(
            &painter,
            rect.left_top() + egui::vec2(8.0, 8.0),
            &capitalised(&words),
            Color32::from_rgb(176, 32, 24),
        );
    } else if let Some(words) = nothing(&window.model, &window.views, pane) {
        let place = rect.left_top() + egui::vec2(8.0, 8.0);
        badge(&painter, place, words, Color32::from_gray(70));
    }
    if let Some([done, all]) = refinement(window, pane)
        && error.is_none()
    {
        progress(&painter, rect, done, all);
    }
    if let Some(error) = error {
        let place = rect.left_bottom() + egui::vec2(8.0, -34.0);
        badge(&painter, place, &error, Color32::from_rgb(120, 60, 0));
    }
}

/// Returns whether the view is of the object that is declared at the cursor. Views of the scene highlight the object
/// instead.
fn is_set_off(model: &Model, pane: &ViewId) -> bool {
    pane.object.is_some() && pane.object == model.highlighted
}

/// Returns the reason why a view shows an object in a form that the text no longer declares, if it does.
fn stale(model: &Model, views: &Views, pane: &ViewId) -> Option<String> {
    let is_stale = match (&pane.object, views.get(&pane.kind)) {
        (Some(name), _) => model.is_stale_on(name),
        (None, Some(view)) => model.is_stale_in(view),
        (None, None) => false,
    };
    let gone = pane
        .object
        .as_ref()
        .filter(|name| model.place_of(name).is_none());
    let errors = match model.faults.errors().count() {
        1 => "error is",
        _ => "errors are",
    };
    is_stale.then(|| match gone {
        Some(name) => format!("the program no longer declares {name}"),
        None => format!("out of date until the {errors} fixed"),
    })
}

/// Returns the reason why a view is empty, if it is.
fn nothing(model: &Model, views: &Views, pane: &ViewId) -> Option<&'static str> {
    let scene = model.scene.as_ref();
    if model.read && scene.is_none_or(|scene| scene.objects.is_empty()) {
        return Some("Nothing to show");
    }
    let view = views.get(&pane.kind)?;
    (!view.is_of_object() && model.is_unseen_in(view)).then(|| view.nothing())
}

/// Draws a sentence on a plate, readable over any picture.
fn badge(painter: &egui::Painter, at: egui::Pos2, text: &str, colour: Color32) {
    let width = (painter.clip_rect().right() - at.x - 24.0).max(60.0);
    let galley = painter.layout(
        text.to_owned(),
        FontId::proportional(14.0),
        Color32::WHITE,
        width,
    );
    let plate = Rect::from_min_size(at, galley.size() + egui::vec2(16.0, 8.0));
    painter.rect_filled(plate, 4.0, colour);
    let place = Align2::CENTER_CENTER
        .align_size_within_rect(galley.size(), plate)
        .min;
    painter.galley(place, galley, Color32::WHITE);
}

/// Returns the current and the final number of samples per pixel of a pane's traced picture.
fn refinement(window: &Window, pane: &ViewId) -> Option<[u32; 2]> {
    if !window.shows_traced(pane) {
        return None;
    }
    let done = window.pictures.shown(pane)?.detail.samples?;
    Some([done, window.model.choices.preferences.samples])
}

/// Shows the progress of a picture's refinement: a line along its lower edge, and a number.
fn progress(painter: &egui::Painter, rect: Rect, done: u32, all: u32) {
    if done >= all {
        return;
    }
    let share = done as f32 / all.max(1) as f32;
    let line = Rect::from_min_max(
        rect.left_bottom() - egui::vec2(0.0, 2.0),
        rect.left_bottom() + egui::vec2(share * rect.width(), 0.0),
    );
    painter.rect_filled(line, 0.0, Color32::from_gray(150));
    let at = rect.left_bottom() + egui::vec2(8.0, -8.0);
    let text = format!("{done} of {all} samples");
    let font = FontId::proportional(12.0);
    // The picture may have any brightness there.
    let below = (at + egui::vec2(1.0, 1.0), Color32::from_black_alpha(200));
    for (at, colour) in [below, (at, Color32::from_gray(230))] {
        painter.text(at, Align2::LEFT_BOTTOM, &text, font.clone(), colour);
    }
}

/// Describes the picture in words.
fn words(window: &Window, pane: &ViewId) -> String {
    let mut words = window.views.title(pane, " of ");
    if pane.object.is_none() {
        let scene = window.model.scene.as_ref();
        let objects = scene.map_or(0, |scene| scene.objects.len());
        let some = if objects == 1 { "object" } else { "objects" };
        words.push_str(&format!(" of {objects} {some}"));
    }
    words.extend(window.camera_input(pane).place(&window.model, pane));
    if let Some([done, all]) = refinement(window, pane) {
        words.push_str(&format!("; traced, {done} of {all} samples"));
    }
    if is_set_off(&window.model, pane) {
        words.push_str("; declared at the cursor");
    }
    if let Some(nothing) = nothing(&window.model, &window.views, pane) {
        words.push_str("; ");
        words.push_str(nothing);
    }
    if let Some(stale) = stale(&window.model, &window.views, pane) {
        words.push_str("; ");
        words.push_str(&stale);
    }
    if let Some(error) = window.pictures.shown(pane).and_then(|it| it.error.as_ref()) {
        words.push_str("; ");
        words.push_str(error);
    }
    words
}
