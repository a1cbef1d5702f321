//! Views along the axes: the gizmo in the corner of a view in space, its entries of the menu *View*, and its keys.
//!
//! A click, an entry or a key turns the camera about its target, in a quarter of a second.

use egui::{Align2, Color32, FontId, Key, Modifiers, Pos2, Rect, Sense, Ui, Vec2, WidgetInfo};
use glam::DVec3;
use render::ViewId;

use crate::state::{SpaceCamera, Step};
use crate::ui::menu;
use crate::ui::window::Window;

/// A view along an axis.
#[derive(Debug)]
struct AxisView {
    /// Its name: "Top".
    title: &'static str,
    /// The key that turns the camera to it, with Ctrl for the views from behind.
    key: Key,
    command: bool,
    /// The keys in words.
    keys: &'static str,
    /// The axis, from 0, and the end of it that is nearest to the eye.
    axis: usize,
    sign: f64,
}

impl AxisView {
    const fn new(title: &'static str, key: Key, keys: &'static str, axis: usize) -> Self {
        Self {
            title,
            key,
            command: false,
            keys,
            axis,
            sign: 1.0,
        }
    }

    /// The view from the negative end.
    const fn negative(self) -> Self {
        Self { sign: -1.0, ..self }
    }

    const fn with_command(self) -> Self {
        Self {
            command: true,
            ..self
        }
    }

    /// The unit vector from the target to the eye.
    fn direction(&self) -> DVec3 {
        self.sign * [DVec3::X, DVec3::Y, DVec3::Z][self.axis]
    }

    /// The end of the axis: "+z". `axis` is that of the text.
    fn end(&self, axis: usize) -> String {
        let sign = if self.sign < 0.0 { '−' } else { '+' };
        format!("{sign}{}", ["x", "y", "z"][axis])
    }
}

/// The views, in the order of the menu.
const AXIS_VIEWS: [AxisView; 6] = [
    AxisView::new("Front", Key::Num1, "1", 1).negative(),
    AxisView::new("Back", Key::Num1, "Ctrl+1", 1).with_command(),
    AxisView::new("Right", Key::Num3, "3", 0),
    AxisView::new("Left", Key::Num3, "Ctrl+3", 0)
        .negative()
        .with_command(),
    AxisView::new("Top", Key::Num7, "7", 2),
    AxisView::new("Bottom", Key::Num7, "Ctrl+7", 2)
        .negative()
        .with_command(),
];

/// The name of the setting that makes lines of sight parallel.
const ORTHOGRAPHIC: &str = "Orthographic";
/// Seconds for a turn.
const TURN_TIME: f64 = 0.25;
/// The length of the gizmo's axes, in points.
const ARM: f32 = 34.0;
/// The radius of the ends of its axes, in points.
const END: f32 = 9.0;
/// Views that are smaller, in points, have no gizmo.
const LEAST_SIDE: f32 = 160.0;
/// The axes' colours.
const COLOURS: [Color32; 3] = [
    Color32::from_rgb(235, 80, 75),
    Color32::from_rgb(110, 190, 50),
    Color32::from_rgb(75, 135, 245),
];

/// A camera on its way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn {
    from: SpaceCamera,
    to: SpaceCamera,
    /// The camera that was put in place last.
    last: SpaceCamera,
    /// The time at which it began, in seconds.
    begun: f64,
}

impl Turn {
    /// Returns the camera at a share of the way, from 0 to 1.
    fn at(&self, share: f64) -> SpaceCamera {
        if share >= 1.0 {
            return self.to;
        }
        // Slow at both ends.
        let share = share * share * (3.0 - 2.0 * share);
        let [from, to] = [self.from, self.to].map(|camera| camera.axes()[2]);
        let angle = from.dot(to).clamp(-1.0, 1.0).acos();
        let across = (to - from * from.dot(to)).normalize_or(self.from.axes()[0]);
        let (sin, cos) = (share * angle).sin_cos();
        self.from.seen_from(from * cos + across * sin)
    }
}

/// Moves a camera that is on its way; one that was moved otherwise has arrived.
pub(crate) fn advance(window: &mut Window, ui: &Ui) {
    let Some(turn) = window.input.turn else {
        return;
    };
    if window.model.view.space != Some(turn.last) {
        window.input.turn = None;
        return;
    }
    let elapsed = ui.input(|input| input.time) - turn.begun;
    let next = turn.at(elapsed / TURN_TIME);
    window.model.adjust(|view| view.space = Some(next));
    window.has_moved(ui);
    let arrived = elapsed >= TURN_TIME;
    window.input.turn = (!arrived).then_some(Turn { last: next, ..turn });
    ui.ctx().request_repaint();
}

/// Turns the camera in space so that it looks against a direction.
fn turn_to(window: &mut Window, direction: DVec3, ui: &Ui) {
    let Some(from) = window.model.view.space else {
        return;
    };
    let to = from.seen_from(direction);
    let step = Step::new("Turn the 3D camera", "");
    window.model.change(step, |view| view.space = Some(to));
    window.model.history.settle();
    // The step leads to the end of the way; what is seen until then is none.
    window.model.adjust(|view| view.space = Some(from));
    let begun = ui.input(|input| input.time);
    window.input.turn = Some(Turn {
        from,
        to,
        last: from,
        begun,
    });
    ui.ctx().request_repaint();
}

fn set_orthographic(window: &mut Window, on: bool) {
    let step = Step::new("Change the projection", "");
    window
        .model
        .change(step, |view| view.preferences.orthographic = on);
    window.model.history.settle();
}

/// Makes the lines of sight parallel, or no longer.
pub(crate) fn toggle_orthographic(window: &mut Window) {
    let on = window.model.view.preferences.orthographic;
    set_orthographic(window, !on);
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
        if pressed(modifiers, view.key) {
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
            let button = egui::Button::new(view.title).shortcut_text(view.keys);
            if ui.add(button).clicked() {
                turn_to(window, view.direction(), ui);
            }
        }
    });
    let mut on = window.model.view.preferences.orthographic;
    let hint = "Parallel lines of sight: equal lengths are equal in the picture";
    let tick = menu::tick(ui, &mut on, ORTHOGRAPHIC, "5");
    if tick.on_hover_text(hint).changed() {
        set_orthographic(window, on);
    }
}

/// Shows the gizmo of a view in its upper right corner: the axes as the camera sees them, with ends that turn it.
pub(crate) fn gizmo(window: &mut Window, ui: &Ui, id: &ViewId, rect: Rect) {
    let Some(camera) = window.model.view.space else {
        return;
    };
    if rect.width().min(rect.height()) < LEAST_SIDE {
        return;
    }
    let reach = ARM + END + 6.0;
    let middle = rect.right_top() + Vec2::new(-reach, reach);
    let scene = window.model.scene.as_ref();
    let axes = scene.map_or([0, 1, 2], |scene| scene.stated_axes());
    let [right, up, back] = camera.axes();
    let mut ends: Vec<(f64, Pos2, &AxisView)> = AXIS_VIEWS
        .iter()
        .map(|view| {
            let way = view.direction();
            let by = Vec2::new(way.dot(right) as f32, -way.dot(up) as f32) * ARM;
            (way.dot(back), middle + by, view)
        })
        .collect();
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (depth, at, view) in ends {
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
            // The end that faces the eye leads to the other side.
            let sign = if depth > 0.999 { -1.0 } else { 1.0 };
            turn_to(window, sign * view.direction(), ui);
        }
        response.on_hover_text(format!("{} ({})", view.title, view.keys));
    }
}

/// Draws the end of an axis; positive ends have a line and a letter, and negative ones when the pointer is over them.
fn draw_end(
    ui: &Ui,
    [middle, at]: [Pos2; 2],
    view: &AxisView,
    axis: usize,
    depth: f64,
    hovered: bool,
) {
    let painter = ui.painter();
    // What points away is dimmer.
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
