//! Views along the axes: the gizmo in the corner of a view in space, the entries of the menu *View*, and the keys.
//!
//! A click, an entry or a key turns the camera about its target, in a quarter of a second.

use egui::{Align2, Color32, FontId, Key, Modifiers, Pos2, Rect, Sense, Ui, Vec2, WidgetInfo};
use glam::DVec3;
use render::ViewId;
use session::camera_input::axis_views::{AXIS_VIEWS, AxisEnd, AxisView, Turn};

use crate::ui::window::Window;
use crate::ui::{key_names, menu};

/// The name of the setting that makes lines of sight parallel.
const ORTHOGRAPHIC: &str = "Orthographic";
/// The length of the gizmo's axes, in points.
const ARM: f32 = 34.0;
/// The radius of the ends of its axes, in points.
const END: f32 = 9.0;
/// The minimum side of a view with a gizmo, in points.
const LEAST_SIDE: f32 = 160.0;
/// The axes' colours.
const COLOURS: [Color32; 3] = [
    Color32::from_rgb(235, 80, 75),
    Color32::from_rgb(110, 190, 50),
    Color32::from_rgb(75, 135, 245),
];

/// Advances a turn of the camera.
pub(crate) fn advance(window: &mut Window, ui: &Ui) {
    let now = ui.input(|input| input.time);
    if Turn::advance(&mut window.input.turn, &mut window.model, now) {
        window.has_moved(ui);
        ui.ctx().request_repaint();
    }
}

/// Turns the camera in space until its eye is in a direction.
fn turn_to(window: &mut Window, direction: DVec3, ui: &Ui) {
    let now = ui.input(|input| input.time);
    if let Some(turn) = Turn::begin(&mut window.model, direction, now) {
        window.input.turn = Some(turn);
        ui.ctx().request_repaint();
    }
}

/// Makes the lines of sight parallel, or perspective again.
pub(crate) fn toggle_orthographic(window: &mut Window) {
    let on = window.model.choices.preferences.orthographic;
    window.model.set_orthographic(!on);
}

/// Returns the key of a view along an axis.
fn key(view: &AxisView) -> Option<Key> {
    Key::from_name(&view.digit.to_string())
}

/// Handles the keys of the views along the axes.
pub(crate) fn keys(window: &mut Window, ui: &Ui) {
    let pressed = |modifiers: Modifiers, key: Key| {
        ui.input(|input| input.key_pressed(key) && input.modifiers.matches_exact(modifiers))
    };
    for view in &AXIS_VIEWS {
        let modifiers = match view.command {
            true => Modifiers::COMMAND,
            false => Modifiers::NONE,
        };
        if key(view).is_some_and(|key| pressed(modifiers, key)) {
            turn_to(window, view.direction(), ui);
        }
    }
    if pressed(Modifiers::NONE, Key::Num5) {
        toggle_orthographic(window);
    }
}

/// Shows the entries of the menu *View*.
pub(crate) fn entries(window: &mut Window, ui: &mut Ui) {
    ui.menu_button("Axis views", |ui| {
        for view in &AXIS_VIEWS {
            let keys = key_names::named(ui.ctx(), view.keys);
            let button = egui::Button::new(view.title).shortcut_text(keys);
            if ui.add(button).clicked() {
                turn_to(window, view.direction(), ui);
            }
        }
    });
    let mut on = window.model.choices.preferences.orthographic;
    let hint = "Parallel lines of sight: equal lengths are equal in the picture";
    let tick = menu::tick(ui, &mut on, ORTHOGRAPHIC, "5");
    if tick.on_hover_text(hint).changed() {
        window.model.set_orthographic(on);
    }
}

/// Shows the gizmo of a view in its upper right corner: the axes as the camera sees them, with ends that turn it.
pub(crate) fn gizmo(window: &mut Window, ui: &Ui, id: &ViewId, rect: Rect) {
    let Some(camera) = window.model.choices.space else {
        return;
    };
    if rect.width().min(rect.height()) < LEAST_SIDE {
        return;
    }
    let reach = ARM + END + 6.0;
    let middle = rect.right_top() + Vec2::new(-reach, reach);
    let scene = window.model.scene.as_ref();
    let axes = scene.map_or([0, 1, 2], |scene| scene.stated_axes());
    for end in AxisEnd::all(&camera) {
        let AxisEnd { view, depth, .. } = end;
        let at = middle + ARM * Vec2::from(end.at.map(|x| x as f32));
        let place = Rect::from_center_size(at, Vec2::splat(2.0 * END));
        let name = egui::Id::unique(("gizmo", id, view.title));
        let response = ui.interact(place, name, Sense::CLICK);
        let axis = axes[view.axis];
        let title = view.title.to_lowercase();
        let title = format!("Look from {} ({title})", view.end(axis));
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &title));
        draw_end(ui, [middle, at], view, axis, depth, response.hovered());
        if response.clicked() {
            window.activate(id);
            turn_to(window, end.leads_to(), ui);
        }
        let keys = key_names::named(ui.ctx(), view.keys);
        response.on_hover_text(format!("{} ({keys})", view.title));
    }
}

/// Draws the end of an axis: positive ends with a line and a letter, negative ones only while the pointer is over them.
fn draw_end(
    ui: &Ui,
    [middle, at]: [Pos2; 2],
    view: &AxisView,
    axis: usize,
    depth: f64,
    hovered: bool,
) {
    let painter = ui.painter();
    // An end that points away is dimmer.
    let share = if hovered {
        1.0
    } else {
        0.8 + 0.2 * depth as f32
    };
    let colour = COLOURS[axis].gamma_multiply(share);
    let is_positive = view.sign > 0.0;
    if is_positive {
        painter.line_segment([middle, at], (2.0, colour));
        painter.circle_filled(at, END, colour);
    } else {
        painter.circle_filled(at, END - 1.0, Color32::from_black_alpha(150));
        painter.circle_stroke(at, END - 1.0, (1.5, colour));
    }
    if is_positive || hovered {
        let end = view.end(axis);
        let letter = if is_positive {
            end.trim_start_matches('+')
        } else {
            &end
        };
        let ink = if is_positive {
            Color32::BLACK
        } else {
            Color32::WHITE
        };
        let font = FontId::proportional(12.0);
        painter.text(at, Align2::CENTER_CENTER, letter, font, ink);
    }
}
