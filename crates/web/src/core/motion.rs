//! Cameras that move: by the pointer, by held keys, and by themselves.

use render::ViewId;
use session::camera_input::axis_views::Turn;
use session::camera_input::{
    CameraKey, CameraKind, Held, MAX_STEP, MOTION_PAUSE, Modifiers, geodesic, space,
};
use session::motion::Motion;

use super::Core;
use crate::message::{CameraMove, Grip};

/// The duration of a frame, in seconds: of the first one of a motion, too, since the pause before it may have any length.
pub(super) const FRAME: f64 = 1.0 / 60.0;
/// The minimum time between two steps of a motion, in seconds.
const STEP: f64 = 0.004;

/// The state of moving cameras.
#[derive(Debug, Default)]
pub(super) struct Motions {
    /// Something counts as moving until this time.
    until: f64,
    /// The held keys, with the view whose camera they move.
    held: Option<HeldKeys>,
    /// The turn of the camera in space to an axis.
    turn: Option<Turn>,
    /// The time of the last step of the automatic motions.
    last: Option<f64>,
    /// True if input extends the current undo step.
    is_gesture: bool,
}

#[derive(Debug)]
struct HeldKeys {
    view: ViewId,
    keys: Vec<CameraKey>,
    modifiers: Modifiers,
}

impl Core {
    /// Notes that something moves: pictures may be coarse for a while.
    pub(super) fn note_motion(&mut self) {
        self.motions.until = self.now + MOTION_PAUSE;
    }

    pub(super) fn is_moving(&self) -> bool {
        self.now < self.motions.until
    }

    /// Returns the time until which something counts as moving, if it does.
    pub(super) fn moving_until(&self) -> Option<f64> {
        self.is_moving().then_some(self.motions.until)
    }

    fn note_gesture(&mut self) {
        self.motions.is_gesture = true;
        self.note_motion();
    }

    /// Returns whether something moves by itself: a param, a turning camera, or one that keys move.
    pub(super) fn moves_by_itself(&self) -> bool {
        self.motions.held.is_some() || self.motions.turn.is_some() || self.model.is_animated()
    }

    pub(super) fn camera_kind(&self, id: &ViewId) -> CameraKind {
        CameraKind::of(self.views.get(&id.kind))
    }

    fn surface(id: &ViewId) -> &str {
        id.object.as_deref().unwrap_or_default()
    }

    /// Moves the camera by a drag in pixels of the pane.
    pub(super) fn drag(&mut self, id: &ViewId, grip: Grip, by: [f64; 2]) {
        if !by.iter().all(|way| way.is_finite()) {
            return;
        }
        let side = self.pictures.side(id);
        match self.camera_kind(id) {
            CameraKind::Space => {
                let grip = match grip {
                    Grip::Orbit => space::Grip::Orbit,
                    Grip::Look => space::Grip::Turn,
                    Grip::Pan => space::Grip::Pan,
                };
                if let Some(camera) = self.model.choices.space {
                    let camera = space::dragged(camera, grip, by, side);
                    self.model.move_space("drag", camera);
                }
            }
            CameraKind::Geodesic => {
                self.walk(id, geodesic::dragged(by, side));
            }
            CameraKind::Fixed => {}
        }
        self.note_gesture();
    }

    fn walk(&mut self, id: &ViewId, motion: Motion) {
        self.model.move_camera(Self::surface(id), motion);
    }

    /// Moves nearer by a factor below 1, towards a point of the picture in a view in space.
    pub(super) fn zoom(&mut self, id: &ViewId, at: [f64; 2], factor: f64) {
        if !(factor > 0.0 && factor.is_finite()) {
            return;
        }
        match self.camera_kind(id) {
            CameraKind::Space => {
                if let Some(camera) = self.model.choices.space {
                    let about = self.pictures.way_from_middle(id, at);
                    let side = self.pictures.side(id);
                    let camera = space::neared(camera, factor, about, side);
                    self.model.move_space("wheel", camera);
                }
            }
            // About the centre: the observer stays.
            CameraKind::Geodesic => self.walk(id, Motion::Zoom(factor)),
            CameraKind::Fixed => {}
        }
        self.note_gesture();
    }

    /// Turns a geodesic camera so that the picture turns clockwise.
    pub(super) fn twist(&mut self, id: &ViewId, angle: f64) {
        if angle.is_finite() && self.camera_kind(id) == CameraKind::Geodesic {
            self.walk(id, Motion::Turn(angle));
            self.note_gesture();
        }
    }

    /// Starts to move a camera while keys are held.
    pub(super) fn hold(&mut self, view: ViewId, keys: Vec<CameraKey>, [shift, alt]: [bool; 2]) {
        let held = self.motions.held.take();
        let was_held = held.is_some();
        if keys.is_empty() {
            if let Some(keys) = held {
                // A key that is tapped between two frames moves the camera too.
                if self.motions.last.is_none() {
                    self.move_by_keys(&keys, FRAME);
                    self.note_motion();
                }
                self.model.history.settle();
            }
            return;
        }
        if !was_held {
            self.motions.last = None;
        }
        self.motions.held = Some(HeldKeys {
            view,
            keys,
            modifiers: Modifiers {
                shift,
                alt,
                command: false,
            },
        });
    }

    /// Moves a camera to a preset position.
    pub(super) fn put_camera(&mut self, id: &ViewId, to: CameraMove) {
        self.motions.turn = None;
        let direction = match to {
            CameraMove::Reset => {
                match self.camera_kind(id) {
                    CameraKind::Space => self.model.reset_space(),
                    CameraKind::Geodesic => self.model.reset(Self::surface(id)),
                    CameraKind::Fixed => {}
                }
                return;
            }
            CameraMove::Frame => {
                let request = self.pictures.sent(id).cloned();
                let home = request.and_then(|request| self.framing.of_everything(&request));
                if let Some(home) = home {
                    // The bounds of the current scene, not of the previous one.
                    self.renderer.set_bounds(None);
                    self.model.frame_everything(&home);
                }
                return;
            }
            CameraMove::Axis(view) => view.direction(),
        };
        self.motions.turn = Turn::begin(&mut self.model, direction, self.now);
    }

    /// Advances the automatic motions to the present time, and ends gestures that have paused.
    pub(super) fn advance(&mut self) {
        let now = self.now;
        if !self.is_moving() && std::mem::take(&mut self.motions.is_gesture) {
            self.model.history.settle();
        }
        if !self.moves_by_itself() {
            self.motions.last = None;
            return;
        }
        let elapsed = self.motions.last.map_or(FRAME, |last| now - last);
        if elapsed < STEP {
            return;
        }
        self.motions.last = Some(now);
        let mut turn = self.motions.turn.take();
        Turn::advance(&mut turn, &mut self.model, now);
        self.motions.turn = turn;
        self.sent.is_stale |= self.model.animate(elapsed.min(MAX_STEP));
        if let Some(keys) = self.motions.held.take() {
            self.move_by_keys(&keys, elapsed);
            self.motions.held = Some(keys);
        }
        self.note_motion();
    }

    fn move_by_keys(&mut self, keys: &HeldKeys, elapsed: f64) {
        let is_held = |key| keys.keys.contains(&key);
        let held = Held::new(is_held, true, keys.modifiers, elapsed);
        let preferences = &self.model.choices.preferences;
        let speed = preferences.camera_speed;
        match self.camera_kind(&keys.view) {
            CameraKind::Space => {
                let is_parallel = preferences.orthographic;
                if let Some(camera) = self.model.choices.space {
                    let next = space::moved_by_keys(camera, held, speed, is_parallel);
                    if next != camera {
                        self.model.move_space("keys", next);
                    }
                }
            }
            CameraKind::Geodesic => {
                for motion in geodesic::motions_of_keys(held, speed) {
                    self.walk(&keys.view, motion);
                }
            }
            CameraKind::Fixed => {}
        }
    }
}
