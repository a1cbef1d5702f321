//! The state of the render thread: a request in, an event out.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::DVec3;
use render::counters::WorkCounters;
use render::gpu::Pixels;
use render::point::PixelPoint;
use render::rendered::RenderedImage;
use render::shared::Shared;
use render::view::Interrupt;
use render::view::space;
use render::viewpoint::{Projection, Viewpoint};
use render::{PictureRequest, RenderError, Renderer, ViewId};
use scene::{Object, ObjectId, ParamValues, Scene};

use super::{Purpose, RenderEvent, Snapping, VersionedRequest};
use crate::engine::snapping::{self, Snap, SnapTargets};
use crate::state::SpaceCamera;

/// The state of the render thread between two pictures.
pub(super) struct Worker {
    renderer: Renderer,
    /// Says whether a picture that takes long is to be given up.
    interrupt: Interrupt,
    /// Set if the renderer draws on the window's own GPU.
    shares_gpu: bool,
    /// The camera that sees everything.
    home: Option<Home>,
    /// The time that the last picture of each pane took.
    took: BTreeMap<ViewId, Duration>,
    /// The places to which clicks snap.
    targets: Option<SnapTargets>,
}

/// The target of a camera is not nearer than this, in radii of the scene.
const NEAREST_TARGET: f64 = 0.1;

/// Returns true if a place of an object can be measured at.
fn is_measurable(scene: &Scene, id: ObjectId) -> bool {
    scene
        .get(id)
        .is_some_and(|object| object.shape.manifold().is_some())
}

/// The request of a view in space without points, vectors and curves; `None` of another view.
fn without_lines(request: &PictureRequest) -> Option<PictureRequest> {
    let mut request = request.clone();
    let scene = request.scene.clone();
    let space = request.view.space_mut()?;
    let is_line = |object: &Object| !object.shape.is_surface() && object.shape.solid().is_none();
    let lines = scene.numbered().filter(|(_, object)| is_line(object));
    space.hidden.extend(lines.map(|(id, _)| id));
    Some(request)
}

/// The camera that sees everything, and all that it depends on.
struct Home {
    scene: Shared<Scene>,
    settings: Arc<ParamValues>,
    size: [u32; 2],
    hidden: Vec<ObjectId>,
    projection: Projection,
    has_axes: bool,
    declared: Option<String>,
    camera: SpaceCamera,
}

impl Worker {
    /// Draws with a renderer. If that is on the window's own GPU, pictures stay there.
    pub(super) fn new(renderer: Renderer, interrupt: Interrupt) -> Self {
        Self {
            shares_gpu: renderer.gpu().is_some(),
            renderer: renderer.with_interrupt(interrupt.clone()),
            interrupt,
            home: None,
            took: BTreeMap::new(),
            targets: None,
        }
    }

    /// Draws with another renderer from now on.
    pub(super) fn move_to(&mut self, renderer: Renderer) {
        self.shares_gpu = renderer.gpu().is_some();
        self.renderer = renderer.with_interrupt(self.interrupt.clone());
    }

    /// Draws by the processor, which is never lost, from now on.
    pub(super) fn leave_gpu(&mut self) {
        let views = self.renderer.views().clone();
        self.move_to(Renderer::software().with_views(views));
    }

    /// Returns the time that the last picture of a pane took.
    pub(super) fn took(&self, pane: &ViewId) -> Option<Duration> {
        self.took.get(pane).copied()
    }

    /// Returns the renderer's counters.
    pub(super) fn counters(&self) -> WorkCounters {
        self.renderer.counters()
    }

    /// Draws a pane's picture; returns nothing if it was given up for something newer.
    pub(super) fn draw(
        &mut self,
        pane: &ViewId,
        request: &VersionedRequest,
    ) -> Option<RenderEvent> {
        let start = Instant::now();
        let mut drawn = self.picture(&request.picture, start);
        if drawn.is_err() && self.renderer.is_lost() {
            self.leave_gpu();
            drawn = self.picture(&request.picture, start);
        }
        if matches!(drawn, Err(RenderError::Interrupted)) {
            return None;
        }
        self.took.insert(pane.clone(), start.elapsed());
        let (picture, space_camera) = match drawn {
            Ok((picture, camera)) => (Ok(Box::new(picture)), camera),
            Err(error) => (Err(error.to_string()), None),
        };
        Some(RenderEvent::Drawn {
            pane: pane.clone(),
            picture,
            space_camera,
            request: Box::new(request.clone()),
            counters: self.renderer.counters(),
        })
    }

    /// Finds what is under a pixel.
    pub(super) fn pick(
        &mut self,
        request: &PictureRequest,
        at: [f64; 2],
        purpose: Purpose,
    ) -> RenderEvent {
        let at = PixelPoint(at);
        if purpose.snapping() == Some(Snapping::On)
            && let Some(Snap { hit, at }) =
                snapping::snap(&mut self.renderer, &mut self.targets, request, at)
        {
            return RenderEvent::Picked {
                request: Box::new(request.clone()),
                hit: Some(hit),
                snapped: Some(at.0),
                purpose,
            };
        }
        let mut hit = self.renderer.pick(request, at);
        if purpose.snapping().is_some()
            && let Ok(Some(found)) = &hit
            && !is_measurable(&request.scene, found.object)
            && let Some(beneath) = without_lines(request)
            && let Ok(Some(below)) = self.renderer.pick(&beneath, at)
        {
            hit = Ok(Some(below));
        }
        RenderEvent::Picked {
            request: Box::new(request.clone()),
            hit: hit.ok().flatten(),
            snapped: None,
            purpose,
        }
    }

    /// Finds the camera that sees everything.
    pub(super) fn frame(&mut self, request: &PictureRequest) -> Option<SpaceCamera> {
        let mut request = request.clone();
        if !request.scene.stage.is_empty() {
            // A declared camera need not see everything.
            let mut scene = Scene::clone(&request.scene);
            scene.stage.clear();
            request.scene = scene.into();
        }
        let space = request.view.space_mut()?;
        space.declared = None;
        (space.camera.eye, space.camera.target) = (None, None);
        self.home(&request).ok()
    }

    /// Draws a picture; returns it with the camera that everything is seen from, where the request leaves that open.
    fn picture(
        &mut self,
        request: &PictureRequest,
        start: Instant,
    ) -> Result<(RenderedImage, Option<SpaceCamera>), RenderError> {
        let mut request = request.clone();
        let space = request.view.space();
        let is_open = space.is_some_and(|space| space.camera.eye.is_none());
        let home = if is_open {
            Some(self.home(&request)?)
        } else {
            None
        };
        if let (Some(home), Some(space)) = (home, request.view.space_mut()) {
            space.camera = Viewpoint {
                projection: space.camera.projection,
                ..Viewpoint::new(home.eye, home.target)
            };
        }
        let mut drawn = self.renderer.draw(&request)?;
        let pixels = match drawn.image {
            Pixels::Texture(canvas) if self.shares_gpu => Pixels::Texture(canvas),
            pixels => Pixels::Image(self.renderer.read(pixels)?),
        };
        drawn.image = pixels;
        drawn.took = start.elapsed();
        Ok((drawn, home))
    }

    /// Returns the camera that sees everything that a request of a view in space shows.
    fn home(&mut self, request: &PictureRequest) -> Result<SpaceCamera, RenderError> {
        let space = request.view.space();
        let hidden = space.map_or(Vec::new(), |space| space.hidden.clone());
        let declared = space.and_then(|space| space.declared.clone());
        let projection = space.map_or(Projection::default(), |space| space.camera.projection);
        if let Some(home) = &self.home
            && home.scene == request.scene
            && home.settings == request.params
            && home.size == request.size
            && home.hidden == hidden
            && home.projection == projection
            && home.has_axes == request.overlays.axes
            && home.declared == declared
        {
            return Ok(home.camera);
        }
        let bounds = space::bounds(request);
        let viewpoint = Viewpoint {
            projection,
            ..Viewpoint::default()
        };
        let camera = space::first_camera(&bounds, &viewpoint, request)?;
        let (centre, radius) = (
            DVec3::from(bounds.placement.centre),
            bounds.placement.radius,
        );
        let world = |place: DVec3| (centre + radius * place).to_array();
        let ahead = camera.eye.dot(camera.axes[2]);
        // A declared camera may look away from the middle of the scene.
        let ahead = if ahead > NEAREST_TARGET { ahead } else { 1.0 };
        let [across, upward] = camera.half_tangents();
        let camera = SpaceCamera {
            eye: world(camera.eye),
            target: world(camera.eye - camera.axes[2] * ahead),
            radius,
            moved: false,
            tangent: across.min(upward),
        };
        self.home = Some(Home {
            scene: request.scene.clone(),
            settings: Arc::clone(&request.params),
            size: request.size,
            hidden,
            projection,
            has_axes: request.overlays.axes,
            declared,
            camera,
        });
        Ok(camera)
    }
}
