//! The geodesic cameras of the model: each is settled on its surface in its current form, and moved there.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use super::Model;
use crate::camera_controller::{CameraController, Subject};
use crate::difference::Difference;
use crate::history::{EndedTrail, Trails};
use crate::motion::Motion;
use crate::{CameraPath, InsideCamera, Step};

impl Model {
    /// Settles the geodesic camera of a surface on the surface in its current form, and returns it; `None` if no camera
    /// can be there. In the surface's own view (`is_own_view`) it leaves a trail, if trails are shown.
    pub fn settle_camera(&mut self, surface: &str, is_own_view: bool) -> Option<InsideCamera> {
        let subject = self.subject(surface)?;
        let before = self.choices.inside.get(surface).copied();
        let mut path = self.paths.remove(surface);
        let settled = self.control(surface, |controller| {
            controller.settle(&subject, before, &mut path).ok()
        });
        let Some(camera) = settled.flatten() else {
            self.put_path(surface, path);
            return None;
        };
        if before != Some(camera) {
            self.choices.inside.insert(surface.to_owned(), camera);
        }
        let leaves_trail = self.choices.preferences.marks.trail;
        let path = camera.chart().and_then(|camera| {
            let path = path.filter(|path| path.ends_at(camera.at));
            match (is_own_view, leaves_trail) {
                (true, true) => Some(
                    path.unwrap_or_else(|| Arc::new(CameraPath::begin(subject.surface, *camera))),
                ),
                (true, false) => None,
                (false, _) => path,
            }
        });
        self.put_path(surface, path);
        Some(camera)
    }

    /// Moves the geodesic camera of a surface: a step that is joined with the earlier ones of the same gesture.
    pub fn move_camera(&mut self, surface: &str, motion: Motion) {
        self.keep_placement();
        let Some(camera) = self.settle_camera(surface, true) else {
            return;
        };
        let step = Step::new("Move the geodesic camera", surface);
        // Only the first motion of a step needs the path before it, which is copied then.
        let trails = match self.history.joins(&step) {
            true => Trails::default(),
            false => [(surface.to_owned(), self.ended_trail(surface))].into(),
        };
        let mut path = self.paths.remove(surface);
        let moved = self.control(surface, |controller| {
            controller.apply(camera, motion, path.as_mut())
        });
        self.put_path(surface, path);
        if let Some(moved) = moved.filter(|moved| *moved != camera) {
            let replaced = Difference::camera(surface, Some(camera));
            self.history.record(step, replaced, trails);
            self.choices.inside.insert(surface.to_owned(), moved);
        }
    }

    /// Restarts the trails of all cameras: an undoable step.
    pub fn clear_trails(&mut self) {
        self.keep_placement();
        let names: Vec<String> = self.paths.keys().cloned().collect();
        let trails = names.into_iter().map(|name| {
            let trail = self.ended_trail(&name);
            (name, trail)
        });
        let trails: Trails = trails.collect();
        self.history.settle();
        let step = Step::new("Clear the trail", "");
        self.history.record(step, Difference::default(), trails);
        self.history.settle();
        self.paths.clear();
    }

    /// Returns the path of a surface's camera, if it is more than its start.
    pub(super) fn ended_trail(&mut self, surface: &str) -> Option<EndedTrail> {
        let path = self.paths.get(surface)?;
        if path.trail.points.len() < 2 {
            return None;
        }
        let path = Arc::clone(path);
        let param_values = self.param_values()?;
        Some(EndedTrail { path, param_values })
    }

    /// Returns a surface, metric or solid with the params' values.
    pub fn subject(&mut self, surface: &str) -> Option<Subject> {
        Some(Subject {
            surface: self.object(surface)?.0,
            param_values: self.param_values()?,
            scene: self.scene.clone()?,
        })
    }

    /// Runs `work` with the camera controller of a surface. After a panic, the controller is dropped, but the session
    /// continues: the surface's picture reports the fault.
    fn control<T>(
        &mut self,
        surface: &str,
        work: impl FnOnce(&mut CameraController) -> T,
    ) -> Option<T> {
        let mut controller = self.controllers.remove(surface).unwrap_or_default();
        let done = catch_unwind(AssertUnwindSafe(|| work(&mut controller))).ok()?;
        self.controllers.insert(surface.to_owned(), controller);
        Some(done)
    }

    pub(super) fn put_path(&mut self, surface: &str, path: Option<Arc<CameraPath>>) {
        match path {
            Some(path) => self.paths.insert(surface.to_owned(), path),
            None => self.paths.remove(surface),
        };
    }

    /// Updates the object number of each path's surface: declarations before it may have been added or removed.
    pub(super) fn renumber_paths(&mut self) {
        let Some(scene) = &self.scene else {
            return;
        };
        if let Some((name, lines)) = &mut self.measured {
            match scene.object(name) {
                Some((id, _)) => {
                    for line in lines.iter_mut().filter(|line| line.surface != id) {
                        Arc::make_mut(line).surface = id;
                    }
                }
                None => self.measured = None,
            }
        }
        for (name, path) in &mut self.paths {
            if let Some((id, _)) = scene.object(name)
                && path.trail.surface != id
            {
                Arc::make_mut(&mut Arc::make_mut(path).trail).surface = id;
            }
        }
    }
}
