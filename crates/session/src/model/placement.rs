//! Geodesic cameras that are placed by other means than walking.
//!
//! A click places a camera at once, but may turn out to be the first half of a double click, which has another meaning.
//! Until that is known, the placement is not a step, and can be withdrawn without a trace.

use std::sync::Arc;

use super::Model;
use crate::difference::Difference;
use crate::history::EndedTrail;
use crate::{CameraPath, ChartCamera, InsideCamera, Step};

/// A placement that can be withdrawn.
#[derive(Debug)]
pub(super) struct Placement {
    surface: String,
    before: Option<InsideCamera>,
    /// The path that led to the previous position.
    path: Option<Arc<CameraPath>>,
}

impl Model {
    /// Returns the geodesic camera of a surface to its initial position.
    pub fn reset(&mut self, surface: &str) {
        self.keep_placement();
        let trails = [(surface.to_owned(), self.ended_trail(surface))].into();
        let before = self.choices.inside.get(surface).copied();
        self.put(surface, None, None);
        if before.is_some() {
            let step = Step::new("Reset the geodesic camera", surface);
            let replaced = Difference::camera(surface, before);
            self.history.record(step, replaced, trails);
        }
        self.history.settle();
    }

    /// Places the geodesic camera of a surface, until [`Model::keep_placement`] makes a step of it or
    /// [`Model::withdraw_placement`] reverts it.
    pub fn place(&mut self, surface: &str, camera: InsideCamera) {
        self.keep_placement();
        self.placing = Some(Placement {
            surface: surface.to_owned(),
            before: self.choices.inside.get(surface).copied(),
            path: self.paths.get(surface).cloned(),
        });
        self.put(surface, Some(camera), None);
    }

    /// Keeps a placed camera where it is: an undoable step.
    pub fn keep_placement(&mut self) {
        if let Some(Placement {
            surface,
            before,
            path,
        }) = self.placing.take()
        {
            self.history.settle();
            let replaced = Difference::camera(&surface, before);
            let param_values = self.param_values();
            let trail = path.zip(param_values);
            let trail = trail.map(|(path, param_values)| EndedTrail { path, param_values });
            let step = Step::new("Place the geodesic camera", surface.clone());
            self.history
                .record(step, replaced, [(surface, trail)].into());
            self.history.settle();
        }
    }

    /// Mirrors the geodesic view of a surface upside down without rotating it: the surface is seen from its other side.
    /// This puts north up on a surface where v increases southward.
    pub fn mirror(&mut self, surface: &str) {
        if let Some(InsideCamera::Chart(camera)) = self.settle_camera(surface, true) {
            let mirrored = ChartCamera {
                y: camera.y.map(|part| -part),
                moved: true,
                ..camera
            };
            self.place(surface, InsideCamera::Chart(mirrored));
            self.keep_placement();
        }
    }

    /// Returns a placed camera to its previous position, with the trail that led there.
    pub fn withdraw_placement(&mut self) {
        if let Some(Placement {
            surface,
            before,
            path,
        }) = self.placing.take()
        {
            self.put(&surface, before, path);
        }
    }

    fn put(&mut self, surface: &str, camera: Option<InsideCamera>, path: Option<Arc<CameraPath>>) {
        self.adjust(|choices| {
            match camera {
                Some(camera) => choices.inside.insert(surface.to_owned(), camera),
                None => choices.inside.remove(surface),
            };
        });
        self.put_path(surface, path);
    }
}
