//! The camera in space: it goes, looks, and is carried around its target; clicks find what is under them.

use egui::{Color32, FontId, Key, Modifiers, PointerButton, Pos2, Rect, Response, Ui};
use glam::DVec2;
use render::ViewId;

use super::{CameraInput, Held, TURN_SPEED, ZOOM_SPEED, carried, nearing, pixel};
use crate::engine::render_thread::Purpose;
use crate::state::{Model, SpaceCamera};
use crate::ui::navigation;
use crate::ui::window::Window;

/// Radii of the scene a second, at the camera speed 1.
const SPEED: f64 = 1.0;
/// Distances to the target a second.
const PAN_SPEED: f64 = 0.8;
/// Radians for a drag across a picture's shorter side.
const TURN_DRAG: f64 = 1.2;
/// Radians around the target for a drag across a picture's shorter side: what was in front is behind.
const ORBIT_DRAG: f64 = std::f64::consts::PI;

/// Keys and pointer of the camera in space.
pub(super) struct SpaceInput;

impl CameraInput for SpaceInput {
    fn keys(&self, window: &mut Window, ui: &Ui, _id: &ViewId, arrows: bool) {
        if ui.input(|input| input.key_pressed(Key::F) && input.modifiers.is_none()) {
            window.frame_all();
        }
        if ui.input(|input| input.key_pressed(Key::T) && input.modifiers.is_none()) {
            window.toggle_traced();
        }
        navigation::keys(window, ui);
        let Some(camera) = window.model.view.space else {
            return;
        };
        let speed = window.model.view.preferences.camera_speed;
        let keys = &window.input.held;
        let is_parallel = window.model.view.preferences.orthographic;
        let next = ui.input(|input| {
            moved_by_keys(Held::new(input, keys, arrows), camera, speed, is_parallel)
        });
        if next != camera {
            window.move_space("keys", next, ui);
        }
    }

    fn pointer(&self, window: &mut Window, ui: &Ui, id: &ViewId, response: &Response) {
        let side = response.rect.width().min(response.rect.height());
        let fly = window.model.view.preferences.fly;
        if let Some(mut camera) = window.model.view.space {
            if !camera.moved {
                hint(ui, response.rect, fly);
            }
            let by = response.drag_delta();
            if let Some(grip) = grip(ui, response, fly)
                && by != egui::Vec2::ZERO
            {
                camera = dragged(camera, grip, by, side);
                window.move_space("drag", camera, ui);
            }
            if let Some(pointer) = response.hover_pos() {
                let fingers = window.input.fingers;
                if let Some(by) = ui.input(|input| carried(input, fingers)) {
                    camera = dragged(camera, Grip::Pan, by, side);
                    window.move_space("wheel", camera, ui);
                }
                if let Some(factor) = ui.input(|input| nearing(input, fingers)) {
                    let towards = in_plane(pointer - response.rect.center(), side, &camera);
                    window.move_space("wheel", camera.neared(factor, towards), ui);
                }
            }
        }
        if response.clicked()
            && let Some(request) = window.pictures.sent(id).cloned()
        {
            let pointed = response.interact_pointer_pos();
            // A key presses what has the focus, in its middle.
            let at = pointed.unwrap_or_else(|| response.rect.center());
            let pixel = pixel(&request, response.rect, at);
            // egui counts clicks elsewhere too: the third of them may be the second one here.
            let is_second = window.clicked_until().is_some() && response.triple_clicked();
            if response.double_clicked() || is_second {
                window.double_click(request, pixel);
            } else if ui.input(|input| input.modifiers.command) {
                window
                    .pictures
                    .render_thread
                    .pick(request, pixel, Purpose::Open);
            } else if !response.triple_clicked() {
                // The third of three clicks means nothing by itself.
                window.click(request, pixel, pointed.is_none(), ui);
            }
        }
        if response.has_focus() && window.input.by_keys {
            aim(ui, response.rect.center());
        }
        navigation::gizmo(window, ui, id, response.rect);
    }

    fn reset(&self, window: &mut Window, _id: &ViewId) {
        window.reset_space();
    }

    fn place(&self, model: &Model, _id: &ViewId) -> Option<String> {
        let eye = model.view.space?.eye;
        let [x, y, z] = model.scene.as_ref()?.stated(eye);
        Some(format!(", seen from ({x:.2}, {y:.2}, {z:.2})"))
    }
}

/// Returns what a drag does; `fly` exchanges what it does with Alt and without.
fn grip(ui: &Ui, response: &Response, fly: bool) -> Option<Grip> {
    let Modifiers { shift, alt, .. } = ui.input(|input| input.modifiers);
    let dragged = |button| response.dragged_by(button);
    let primary = dragged(PointerButton::Primary);
    let others = dragged(PointerButton::Secondary) || dragged(PointerButton::Middle);
    if others || primary && shift {
        return Some(Grip::Pan);
    }
    let grip = if alt == fly { Grip::Orbit } else { Grip::Turn };
    primary.then_some(grip)
}

/// Says faintly what the pointer does, to those who have not moved the camera yet.
fn hint(ui: &Ui, rect: Rect, fly: bool) {
    let verb = if fly { "look around" } else { "turn" };
    let text = format!("drag to {verb}, wheel to zoom, F to fit");
    // The legend is in the other corner.
    let (font, colour) = (FontId::proportional(12.0), Color32::from_gray(128));
    let painter = ui.painter_at(rect);
    let galley = painter.layout(text, font, colour, rect.width() - 16.0);
    let at = rect.right_bottom() - egui::vec2(8.0, 8.0) - galley.size();
    painter.galley(at, galley, colour);
}

/// Moves the camera by the held keys: it goes, or looks, in the direction of the letters and arrows. Where lines of sight
/// are parallel, going forward would change nothing: it comes nearer instead.
fn moved_by_keys(
    held: Held<'_>,
    mut camera: SpaceCamera,
    speed: f64,
    is_parallel: bool,
) -> SpaceCamera {
    if !held.any() {
        return camera;
    }
    let step = held.seconds() * speed;
    let Modifiers { alt, shift, .. } = held.input.modifiers;
    let mut way = [
        held.letters(Key::D, Key::A),
        held.letters(Key::W, Key::S),
        held.letters(Key::Q, Key::E),
    ];
    if is_parallel && way[1] != 0.0 {
        let factor = (-way[1] * step * ZOOM_SPEED).exp();
        camera = camera.neared(factor, DVec2::ZERO);
        way[1] = 0.0;
    }
    if way != [0.0; 3] {
        camera = camera.moved(way.map(|x| x * step * SPEED));
    }
    let [x, y] = held.arrows().map(|x| x * step);
    if [x, y] != [0.0; 2] {
        camera = if alt {
            camera.orbited(-x * TURN_SPEED, -y * TURN_SPEED)
        } else if shift {
            camera.panned(DVec2::new(-x, -y) * PAN_SPEED)
        } else {
            camera.turned(x * TURN_SPEED, y * TURN_SPEED)
        };
    }
    let nearer = held.nearer();
    if nearer != 0.0 {
        camera = camera.neared((-nearer * step * ZOOM_SPEED).exp(), DVec2::ZERO);
    }
    camera
}

/// A use of the pointer on a view in space.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Grip {
    /// The camera turns where it stands.
    Turn,
    /// The camera is carried around its target.
    Orbit,
    /// The camera is moved in the picture's plane.
    Pan,
}

/// Moves the camera by a drag in points; `side` is the picture's shorter side in points.
fn dragged(camera: SpaceCamera, grip: Grip, by: egui::Vec2, side: f32) -> SpaceCamera {
    let [x, y] = [by.x, by.y].map(|x| f64::from(x / side.max(1.0)));
    match grip {
        // As the thesis has it: the camera looks where the pointer goes.
        Grip::Turn => camera.turned(x * TURN_DRAG, -y * TURN_DRAG),
        Grip::Orbit => camera.orbited(x * ORBIT_DRAG, -y * ORBIT_DRAG),
        Grip::Pan => camera.panned(in_plane(by, side, &camera)),
    }
}

/// A way in points in the plane of the target, to the right and up, in shares of the distance.
fn in_plane(by: egui::Vec2, side: f32, camera: &SpaceCamera) -> DVec2 {
    let across = 2.0 * camera.tangent;
    DVec2::new(f64::from(by.x), -f64::from(by.y)) * across / f64::from(side.max(1.0))
}

/// A ring about the place that Enter means.
fn aim(ui: &Ui, at: Pos2) {
    for (width, colour) in [(3.0, Color32::BLACK), (1.5, Color32::WHITE)] {
        ui.painter().circle_stroke(at, 6.0, (width, colour));
    }
}
