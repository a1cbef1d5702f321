//! Geodesic cameras that are put somewhere, by other means than walking.
//!
//! A click puts one somewhere at once, and may turn out to be the first half of a double click, which means something
//! else: until that is known it is no step, and can be withdrawn as though it had never been.

use std::sync::Arc;

use super::Model;
use crate::difference::Difference;
use crate::history::EndedTrail;
use crate::{CameraPath, ChartCamera, InsideCamera, Step};

/// A placing that can be withdrawn.
#[derive(Debug)]
pub(super) struct Placement {
    surface: String,
    before: Option<InsideCamera>,
    /// The path that led to where the camera was.
    path: Option<Arc<CameraPath>>,
}

impl Model {
    /// Puts the geodesic camera of a surface at its first place.
    pub fn reset(&mut self, surface: &str) {
        self.keep_placement();
        let trails = [(surface.to_owned(), self.ended_trail(surface))].into();
        let before = self.view.inside.get(surface).copied();
        self.put(surface, None, None);
        if before.is_some() {
            let step = Step::new("Reset the geodesic camera", surface);
            let replaced = Difference::camera(surface, before);
            self.history.record(step, replaced, trails);
        }
        self.history.settle();
    }

    /// Puts the geodesic camera of a surface somewhere, until [`Model::keep_placement`] makes a step of it or
    /// [`Model::withdraw_placement`] undoes it.
    pub fn place(&mut self, surface: &str, camera: InsideCamera) {
        self.keep_placement();
        self.placing = Some(Placement {
            surface: surface.to_owned(),
            before: self.view.inside.get(surface).copied(),
            path: self.paths.get(surface).cloned(),
        });
        self.put(surface, Some(camera), None);
    }

    /// A camera that was put somewhere stays there: a step of its own.
    pub fn keep_placement(&mut self) {
        if let Some(Placement {
            surface,
            before,
            path,
        }) = self.placing.take()
        {
            self.history.settle();
            let replaced = Difference::camera(&surface, before);
            let settings = self.settings();
            let trail = path.zip(settings);
            let trail = trail.map(|(path, settings)| EndedTrail { path, settings });
            let step = Step::new("Place the geodesic camera", surface.clone());
            self.history
                .record(step, replaced, [(surface, trail)].into());
            self.history.settle();
        }
    }

    /// Turns what is seen in the geodesic view of a surface upside down without turning it around: the surface is seen from
    /// its other side. Such a view has north up where v grows southward.
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

    /// Puts a camera back where it was before it was put somewhere, with the trail that led there.
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
        self.adjust(|view| {
            match camera {
                Some(camera) => view.inside.insert(surface.to_owned(), camera),
                None => view.inside.remove(surface),
            };
        });
        self.put_path(surface, path);
    }
}
