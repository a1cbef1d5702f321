//! What a job needs and what is kept for the next one; a job in, an answer out.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::DVec3;
use render::camera::Camera;
use render::counters::Counters;
use render::gpu::Pixels;
use render::view::space;
use render::viewpoint::{PerspectiveCamera, ViewCamera};
use render::{RenderError, Renderer};
use scene::ParamValues;
use scene::{ObjectId, Scene};

use super::{Drawing, Painted, Purpose, RenderEvent};
use crate::engine::request::{Look, Order};
use crate::state::SpaceCamera;
use crate::state::pane::PaneKey;

/// The state of the render thread between two pictures.
pub(super) struct Worker {
    stage: Renderer,
    /// Set if the renderer draws on the window's own GPU.
    shares_gpu: bool,
    /// Where everything of a scene is seen from, at the settings and size where it was asked for.
    home: Option<Home>,
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

impl Worker {
    /// Draws on a stage. If that is on the window's own GPU, pictures stay there.
    pub(super) fn new(stage: Renderer) -> Self {
        Self {
            shares_gpu: stage.gpu().is_some(),
            stage,
            home: None,
            took: BTreeMap::new(),
        }
    }

    /// Draws on another stage from now on.
    pub(super) fn move_to(&mut self, stage: Renderer) {
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
            self.move_to(Renderer::software());
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
        let hit = self.stage.pick(&request, at);
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
        if let Look::Space { camera, .. } = &order.look {
            let seen_from = match camera {
                Some(camera) => *camera,
                None => self.home(order)?,
            };
            let camera = PerspectiveCamera::new(seen_from.eye, seen_from.target);
            request.view.set_camera(ViewCamera::Perspective(camera));
            space_camera = Some(seen_from);
        }
        let shot = self.stage.draw(&request)?;
        let pixels = match shot.image {
            Pixels::Texture(canvas) if self.shares_gpu => Painted::Canvas(canvas),
            pixels => Painted::Image(self.stage.read(pixels)?),
        };
        Ok(Drawing {
            pixels,
            notes: shot.notes,
            inside: shot.geodesics,
            space_camera,
            took: start.elapsed(),
        })
    }

    /// Where everything is seen from.
    fn home(&mut self, order: &Order) -> Result<SpaceCamera, RenderError> {
        let hidden_now = match &order.look {
            Look::Space { hidden, .. } => hidden.as_slice(),
            Look::Inside { .. } => &[],
        };
        if let Some((scene, settings, size, hidden, camera)) = &self.home
            && Arc::ptr_eq(scene, &order.scene)
            && *settings == order.settings
            && *size == order.size
            && *hidden == hidden_now
        {
            return Ok(*camera);
        }
        let bounds = space::bounds(&order.request());
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
            hidden_now.to_vec(),
            camera,
        ));
        Ok(camera)
    }
}
