//! The model's camera in space, which all views in space share.

use scene::{Object, Shape};

use super::Model;
use crate::camera::SpaceCamera;
use crate::history::Step;

/// The names for a new camera in the text: the first free one is used.
const NEW_CAMERAS: [&str; 3] = ["eye", "lens", "observer"];

impl Model {
    /// Places the 3D camera anew where it sees everything, unless the user has moved it.
    pub fn reframe(&mut self) {
        if self.choices.space.is_some_and(|camera| !camera.moved) {
            self.adjust(|choices| choices.space = None);
        }
        self.history.reframe();
    }

    /// Returns the cameras that the program declares, in order.
    pub fn declared_cameras(&self) -> impl Iterator<Item = &Object> {
        let stage = self.scene.iter().flat_map(|scene| &scene.stage);
        stage.filter(|object| matches!(object.shape, Shape::Camera(_)))
    }

    /// Returns the declared camera from which the views in space open.
    pub fn declared_camera(&self) -> Option<&Object> {
        let chosen = self.choices.preferences.camera.as_deref();
        let chosen = chosen.and_then(|name| self.declared_cameras().find(|it| it.name == name));
        chosen.or_else(|| self.declared_cameras().next())
    }

    /// Returns a name for a new camera that the text does not declare.
    pub fn free_camera_name(&self) -> String {
        let more = (2_u32..).map(|number| format!("eye{number}"));
        let mut names = NEW_CAMERAS.into_iter().map(str::to_owned).chain(more);
        let free = names.find(|name| self.place_of(name).is_none());
        free.unwrap_or_default()
    }

    /// Opens the views in space from a declared camera.
    pub fn look_through(&mut self, camera: &str) {
        let current = self.declared_camera().filter(|it| it.name == camera);
        let is_there = current.is_some() && self.is_at_declared_camera();
        self.change(Step::new("Look through a camera", ""), |choices| {
            choices.preferences.camera = Some(camera.to_owned());
            if !is_there {
                choices.space = None;
            }
        });
        self.history.settle();
    }

    /// Returns whether the views in space are seen from a declared camera: the user has not moved away.
    pub fn follows_declared_camera(&self) -> bool {
        self.choices.space.is_none_or(|camera| !camera.moved) && self.declared_camera().is_some()
    }

    /// Returns true if the camera in space is known to be where the declared one is. It must not be forgotten then: no
    /// picture would tell it anew.
    fn is_at_declared_camera(&self) -> bool {
        self.choices.space.is_some() && self.follows_declared_camera()
    }

    /// Moves the camera in space: a step that is joined with the earlier ones of the same `gesture`.
    pub fn move_space(&mut self, gesture: &str, camera: SpaceCamera) {
        let step = Step::new("Move the 3D camera", gesture);
        self.change(step, |choices| choices.space = Some(camera));
    }

    /// Returns the camera in space to its initial direction, where it sees everything.
    pub fn reset_space(&mut self) {
        if self.is_at_declared_camera() {
            return;
        }
        let step = Step::new("Reset the 3D camera", "");
        self.change(step, |choices| choices.space = None);
        self.history.settle();
    }

    /// Moves the camera in space until it sees everything, in its current direction. `home` is a camera that sees
    /// everything: see [`crate::framing::Framing::of_everything`].
    pub fn frame_everything(&mut self, home: &SpaceCamera) {
        if let Some(camera) = self.choices.space {
            let step = Step::new("Frame everything", "");
            let framed = camera.framed(home);
            self.change(step, |choices| choices.space = Some(framed));
            self.history.settle();
        }
    }

    /// Takes over the camera of a picture whose request had none. From then on it stays, whatever the params do. A
    /// camera of the program is taken over each time, since it may depend on params.
    pub fn take_first_camera(&mut self, first: SpaceCamera) {
        let is_open = self.choices.space.is_none() || self.follows_declared_camera();
        if is_open && self.choices.space != Some(first) {
            self.adjust(|choices| choices.space = Some(first));
        }
    }

    /// Makes the lines of sight of the views in space parallel, or not.
    pub fn set_orthographic(&mut self, on: bool) {
        let step = Step::new("Change the projection", "");
        self.change(step, |choices| choices.preferences.orthographic = on);
        self.history.settle();
    }

    /// Shows the whole scene ray-traced, or not.
    pub fn set_traced(&mut self, traced: bool) {
        if self.choices.preferences.traced != traced {
            let step = Step::new("Change a setting", "traced");
            self.change(step, |choices| choices.preferences.traced = traced);
            self.history.settle();
        }
    }
}
