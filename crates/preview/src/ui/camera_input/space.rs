//! The camera in space: keys, drags and the wheel move it; clicks pick objects.

use egui::{Color32, FontId, Key, PointerButton, Pos2, Rect, Response, Ui, Vec2};
use render::ViewId;
use session::Model;
use session::camera_input::space::{Grip, dragged, moved_by_keys, neared, place};

use super::{CameraInput, held, modifiers, numbers, pixel, scroll, shorter_side};
use crate::engine::render_thread::Purpose;
use crate::ui::navigation;
use crate::ui::window::Window;

/// The margin between the hint and the edges of its picture, in points.
const HINT_MARGIN: f32 = 8.0;
/// The minimum width of a hint beside a legend, in points.
const LEAST_HINT: f32 = 110.0;

/// Keys and pointer of the camera in space.
pub(super) struct SpaceInput;

impl CameraInput for SpaceInput {
    fn keys(&self, window: &mut Window, ui: &Ui, _id: &ViewId, arrows: bool) {
        if ui.input(|input| input.key_pressed(Key::F) && input.modifiers.is_none()) {
            window.frame(None);
        }
        if ui.input(|input| input.key_pressed(Key::T) && input.modifiers.is_none()) {
            window.toggle_traced();
        }
        navigation::keys(window, ui);
        let Some(camera) = window.model.choices.space else {
            return;
        };
        let speed = window.model.choices.preferences.camera_speed;
        let keys = &window.input.held;
        let is_parallel = window.model.choices.preferences.orthographic;
        let held = ui.input(|input| held(input, keys, arrows));
        let next = moved_by_keys(camera, held, speed, is_parallel);
        if next != camera {
            window.move_space("keys", next, ui);
        }
    }

    fn pointer(&self, window: &mut Window, ui: &Ui, id: &ViewId, response: &Response) {
        let side = shorter_side(response.rect);
        let fly = window.model.choices.preferences.fly;
        if let Some(mut camera) = window.model.choices.space {
            if !camera.moved {
                let scene = window.model.scene.as_ref();
                let mut objects = scene.iter().flat_map(|scene| &scene.objects);
                let has_surface = objects.any(|object| object.shape.manifold().is_some());
                let picture = window.pictures.shown(id);
                let legend = picture.and_then(|picture| picture.legend);
                hint(ui, response.rect, legend, fly, has_surface);
            }
            let by = response.drag_delta();
            if let Some(grip) = grip(ui, response, fly)
                && by != egui::Vec2::ZERO
            {
                camera = dragged(camera, grip, numbers(by), side);
                window.move_space("drag", camera, ui);
            }
            if let Some(pointer) = response.hover_pos() {
                let scroll = ui.input(|input| scroll(input, window.input.fingers));
                if let Some(by) = scroll.carried() {
                    camera = dragged(camera, Grip::Pan, by, side);
                    window.move_space("wheel", camera, ui);
                }
                if let Some(factor) = scroll.nearing() {
                    let at = numbers(pointer - response.rect.center());
                    camera = neared(camera, factor, at, side);
                    window.move_space("wheel", camera, ui);
                }
            }
        }
        if response.clicked()
            && let Some(request) = window.pictures.sent(id).cloned()
        {
            let pointed = response.interact_pointer_pos();
            // A key press applies to the centre of the focused view.
            let at = pointed.unwrap_or_else(|| response.rect.center());
            let pixel = pixel(&request, response.rect, at);
            // egui also counts clicks elsewhere: its third click may be the second one here.
            let is_second = window.clicked_until().is_some() && response.triple_clicked();
            if response.double_clicked() || is_second {
                window.double_click(request, pixel);
            } else if ui.input(|input| input.modifiers.command) {
                window
                    .pictures
                    .render_thread
                    .pick(request, pixel, Purpose::Open);
            } else if !response.triple_clicked() {
                // The third of three clicks has no effect of its own.
                window.click(request, pixel, pointed.is_none(), ui);
            }
        }
        if response.has_focus() && window.input.by_keys {
            aim(ui, response.rect.center());
        }
        navigation::gizmo(window, ui, id, response.rect);
    }

    fn reset(&self, window: &mut Window, _id: &ViewId) {
        window.model.reset_space();
    }

    fn place(&self, model: &Model, _id: &ViewId) -> Option<String> {
        place(model)
    }
}

/// Returns the effect of a drag; `fly` swaps the effects with and without Alt.
fn grip(ui: &Ui, response: &Response, fly: bool) -> Option<Grip> {
    let dragged = |button| response.dragged_by(button);
    let others = dragged(PointerButton::Secondary) || dragged(PointerButton::Middle);
    let is_dragged = others || dragged(PointerButton::Primary);
    is_dragged.then(|| Grip::of(!others, ui.input(modifiers), fly))
}

/// Shows a faint hint about the pointer's effects until the user has moved the camera. `legend` is the rectangle of the
/// legend in the picture, which fills `rect`, in fractions of its sides.
fn hint(ui: &Ui, rect: Rect, legend: Option<Rect>, fly: bool, has_surface: bool) {
    let verb = if fly { "look around" } else { "turn" };
    let last = match has_surface {
        true => "click a surface to stand there",
        false => "F to fit",
    };
    let text = format!("drag to {verb}, wheel to zoom, {last}");
    let (font, colour) = (FontId::proportional(12.0), Color32::from_gray(128));
    let painter = ui.painter_at(rect);
    let layout = |width| painter.layout(text.clone(), font.clone(), colour, width);
    let size = layout(rect.width() - 2.0 * HINT_MARGIN).size();
    let room = hint_room(rect, size, legend);
    let galley = layout(room.width());
    painter.galley(room.right_bottom() - galley.size(), galley, colour);
}

/// Returns the room with the hint in its lower right corner. `size` is the hint's size in lines as wide as the picture.
/// The room is the picture, or, if the legend would cover the hint, the part beside the legend or above it.
fn hint_room(rect: Rect, size: Vec2, legend: Option<Rect>) -> Rect {
    let room = rect.shrink(HINT_MARGIN);
    let place = Rect::from_min_max(room.max - size, room.max);
    let legend = legend.map(|legend| {
        let on_screen = |share: Pos2| rect.lerp_inside(share.to_vec2());
        Rect::from_min_max(on_screen(legend.min), on_screen(legend.max)).expand(HINT_MARGIN)
    });
    match legend {
        Some(legend) if legend.intersects(place) => {
            if room.right() - legend.right() >= LEAST_HINT {
                room.with_min_x(legend.right())
            } else {
                room.with_max_y(legend.top())
            }
        }
        _ => room,
    }
}

/// Draws a ring around the point to which Enter applies.
fn aim(ui: &Ui, at: Pos2) {
    for (width, colour) in [(3.0, Color32::BLACK), (1.5, Color32::WHITE)] {
        ui.painter().circle_stroke(at, 6.0, (width, colour));
    }
}

#[cfg(test)]
mod tests {
    use egui::{Rect, pos2, vec2};

    use super::hint_room;

    #[test]
    fn a_hint_stands_beside_the_legend_or_above_it() {
        let (size, legend) = (vec2(280.0, 15.0), vec2(140.0, 60.0));
        for width in [200.0, 300.0, 400.0, 900.0] {
            let rect = Rect::from_min_size(pos2(20.0, 50.0), vec2(width, 200.0));
            let least = pos2(0.0, 1.0 - legend.y / 200.0);
            let shares = Rect::from_min_max(least, pos2(legend.x / width, 1.0));
            let legend = Rect::from_min_size(pos2(20.0, 190.0), legend);
            let [with, without] = [Some(shares), None].map(|it| hint_room(rect, size, it));
            assert!(rect.contains_rect(with) && rect.contains_rect(without));
            let place = Rect::from_min_max(without.max - size.min(without.size()), without.max);
            assert_eq!(place.intersects(legend), width < 900.0);
            assert_eq!(with == without, width == 900.0);
            let is_clear = with == without || !with.intersects(legend);
            assert!(is_clear, "{legend} under {with}");
        }
    }
}
