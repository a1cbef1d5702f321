//! What a job needs and what is kept for the next one; a job in, an answer out.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::DVec3;
use render::bounds::Bounds;
use render::camera::Camera;
use render::live::{Counters, Pixels, Shot, Stage};
use render::texture::Texture;
use render::{RenderError, View};
use scene::ParamValues;
use scene::{ObjectId, Scene};

use super::{Drawing, Painted, Purpose, RenderEvent};
use crate::engine::request::{Look, Order};
use crate::state::SpaceCamera;
use crate::state::pane::PaneKey;

/// The state of the render thread between two pictures.
pub(super) struct Worker {
    stage: Stage,
    /// Set if the renderer draws on the window's own GPU.
    shares_gpu: bool,
    /// Where everything of a scene is seen from, at the settings and size where it was asked for.
    home: Option<Home>,
    curvatures: Option<Curvatures>,
    /// The time that the last picture of each pane took.
    took: BTreeMap<PaneKey, Duration>,
}

/// A scene with its params, the size of its picture, what is hidden, and the place from which all of the rest is seen.
type Home = (
    Arc<Scene>,
    Arc<ParamValues>,
    [u32; 2],
    Vec<ObjectId>,
    SpaceCamera,
);

/// Textures of curvature, of a scene with its params.
type Curvatures = (Arc<Scene>, Arc<ParamValues>, Vec<(ObjectId, Arc<Texture>)>);

impl Worker {
    /// Draws on a stage. If that is on the window's own GPU, pictures stay there.
    pub(super) fn new(stage: Stage) -> Self {
        Self {
            shares_gpu: stage.gpu().is_some(),
            stage,
            home: None,
            curvatures: None,
            took: BTreeMap::new(),
        }
    }

    /// Draws on another stage from now on.
    pub(super) fn move_to(&mut self, stage: Stage) {
        self.shares_gpu = stage.gpu().is_some();
        self.stage = stage;
    }

    /// Returns the time that the last picture of a pane took.
    pub(super) fn took(&self, pane: &PaneKey) -> Option<Duration> {
        self.took.get(pane).copied()
    }

    /// Returns the renderer's counters.
    pub(super) fn counters(&self) -> Counters {
        self.stage.counters()
    }

    /// Draws a pane's picture.
    pub(super) fn draw(&mut self, pane: &PaneKey, order: &Order) -> RenderEvent {
        let start = Instant::now();
        let mut picture = self.picture(order, start);
        if picture.is_err() && self.stage.is_lost() {
            // The processor is never lost.
            self.move_to(Stage::software());
            picture = self.picture(order, start);
        }
        self.took.insert(pane.clone(), start.elapsed());
        RenderEvent::Drawn {
            pane: pane.clone(),
            picture: picture.map(Box::new).map_err(|error| error.to_string()),
            order: Box::new(order.clone()),
            counters: self.stage.counters(),
        }
    }

    /// Finds what is under a pixel.
    pub(super) fn pick(&mut self, order: &Order, at: [f64; 2], purpose: Purpose) -> RenderEvent {
        let request = order.request();
        let hit = self.stage.pick(&order.scene, &order.settings, &request, at);
        let hit = hit.ok().flatten();
        RenderEvent::Picked {
            order: Box::new(order.clone()),
            hit,
            purpose,
        }
    }

    /// Finds the camera that sees everything.
    pub(super) fn frame(&mut self, order: &Order) -> Option<RenderEvent> {
        Some(RenderEvent::Framed(self.home(order).ok()?))
    }

    fn picture(&mut self, order: &Order, start: Instant) -> Result<Drawing, RenderError> {
        let mut space_camera = None;
        let mut request = order.request();
        if let (Look::Space { camera, .. }, View::Space { eye, target }) =
            (&order.look, &mut request.view)
        {
            let seen_from = match camera {
                Some(camera) => *camera,
                None => self.home(order)?,
            };
            (*eye, *target) = (Some(seen_from.eye), Some(seen_from.target));
            space_camera = Some(seen_from);
        }
        request.textures.extend(self.curvatures(order));
        let shot: Shot = self.stage.draw(&order.scene, &order.settings, &request)?;
        let pixels = match shot.pixels {
            Pixels::Texture(canvas) if self.shares_gpu => Painted::Canvas(canvas),
            pixels => Painted::Image(self.stage.read(pixels)?),
        };
        Ok(Drawing {
            pixels,
            notes: shot.notes,
            inside: shot.inside,
            space_camera,
            took: start.elapsed(),
        })
    }

    /// Where everything is seen from.
    fn home(&mut self, order: &Order) -> Result<SpaceCamera, RenderError> {
        let request = order.request();
        if let Some((scene, settings, size, hidden, camera)) = &self.home
            && Arc::ptr_eq(scene, &order.scene)
            && *settings == order.settings
            && *size == order.size
            && *hidden == request.hidden
        {
            return Ok(*camera);
        }
        let bounds = Bounds::shown(&order.scene, &order.settings, &request);
        let camera = Camera::new(&bounds, None, None, order.size)?;
        let (centre, radius) = (
            DVec3::from(bounds.placement.centre),
            bounds.placement.radius,
        );
        let world = |place: DVec3| (centre + radius * place).to_array();
        let ahead = camera.eye.dot(camera.axes[2]);
        let camera = SpaceCamera {
            eye: world(camera.eye),
            target: world(camera.eye - camera.axes[2] * ahead),
            radius,
            moved: false,
        };
        self.home = Some((
            Arc::clone(&order.scene),
            Arc::clone(&order.settings),
            order.size,
            request.hidden,
            camera,
        ));
        Ok(camera)
    }

    /// The textures of curvature, made anew only where the scene or its params are others.
    fn curvatures(&mut self, order: &Order) -> Vec<(ObjectId, Arc<Texture>)> {
        if order.curved.is_empty() {
            return Vec::new();
        }
        if let Some((scene, settings, textures)) = &self.curvatures
            && Arc::ptr_eq(scene, &order.scene)
            && *settings == order.settings
            && order
                .curved
                .iter()
                .all(|id| textures.iter().any(|(it, _)| it == id))
        {
            let wanted = textures.iter().filter(|(id, _)| order.curved.contains(id));
            return wanted.cloned().collect();
        }
        let textures = order.curvatures();
        let (scene, settings) = (Arc::clone(&order.scene), Arc::clone(&order.settings));
        self.curvatures = Some((scene, settings, textures.clone()));
        textures
    }
}
