//! The renderer: draws views of a scene repeatedly, while the scene is edited and its params and cameras move. A picture for
//! a file is drawn by a renderer that draws one picture.
//!
//! ```text
//! PictureRequest ──Views──▶ ViewRenderer (view/*.rs) ──▶ RenderedImage
//!                              │ samples, framing, GPU: view::SharedState
//! ```
//!
//! A [`Renderer`] keeps from one picture to the next what both need: samples, pipelines, textures, geodesics. Their keys are
//! their contents, so that an edit of one object does not affect those of other objects. One thread at a time uses a
//! renderer; it never draws a picture on its own initiative.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use image::RgbaImage;
use scene::ParamValues;
use scene::{ObjectId, Scene};
use web_time::Instant;

use crate::bounds::Bounds;
use crate::camera::Camera;
use crate::counters::WorkCounters;
use crate::error::RenderError;
use crate::gpu::renderer::GpuRenderer;
use crate::gpu::{Gpu, Pixels};
use crate::layers::Layers;
use crate::plan::Built;
use crate::point::PixelPoint;
use crate::rendered::{BackendUsed, RenderedImage};
use crate::request::{Backend, PictureRequest};
use crate::shared::Shared;
use crate::texture::Texture;
use crate::view::{Hit, Interrupt, SharedState, ViewId, ViewRenderer, Views};

/// The number of pictures that are kept, each of a different view.
const KEPT: usize = 6;

/// Draws the views of one window, or a picture for a file.
#[derive(Debug, Default)]
pub struct Renderer {
    views: Views,
    /// The state of each view that has been drawn, by its name.
    renderers: BTreeMap<&'static str, Box<dyn ViewRenderer>>,
    shared: SharedState,
    /// The last picture of each view; the most recently drawn one is last.
    kept: Vec<(ViewId, KeptImage)>,
    curvatures: Option<Curvatures>,
    pictures: u64,
}

/// A picture that has been drawn, with everything on which it depends.
#[derive(Debug)]
struct KeptImage {
    request: PictureRequest,
    bounds: Option<Arc<Bounds>>,
    image: RenderedImage,
}

/// The textures of curvature of a scene with its params.
#[derive(Debug)]
struct Curvatures {
    scene: Shared<Scene>,
    params: Arc<ParamValues>,
    textures: Vec<(ObjectId, Shared<Texture>)>,
}

/// Draws one picture for print in [layers](crate::layers), on the software path, which knows the hidden parts of lines.
/// `progress` receives the completed fraction, from 0 to 1, from any thread.
///
/// # Errors
/// As [`render`].
pub fn render_layers(
    views: &Views,
    request: &PictureRequest,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<Layers, RenderError> {
    let renderer = Renderer::software().with_views(views.clone());
    renderer.draw_layers(request, progress)
}

/// Draws one picture for a file. `progress` receives the completed fraction, from 0 to 1, from any thread.
///
/// [`Backend::Auto`] uses a real GPU if there is one and the software path otherwise; [`RenderedImage::backend`] reports
/// which and why.
///
/// # Errors
/// See [`RenderError`]; no scene and no request causes a panic.
pub fn render(
    views: &Views,
    request: &PictureRequest,
    backend: Backend,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<RenderedImage<RgbaImage>, RenderError> {
    draw_for_file(views, request, backend, progress, |renderer| renderer)
}

/// Draws one picture for a file as [`render`] does, until it is complete or `interrupt` asks to stop. A view with
/// progressive sampling then returns the samples that all pixels have, with a note of their number.
///
/// # Errors
/// As [`render`]; [`RenderError::Interrupted`] if no sample of all pixels was complete.
pub fn render_until(
    views: &Views,
    request: &PictureRequest,
    backend: Backend,
    progress: &(dyn Fn(f32) + Sync),
    interrupt: &Interrupt,
) -> Result<RenderedImage<RgbaImage>, RenderError> {
    draw_for_file(views, request, backend, progress, |renderer| {
        let mut renderer = renderer.with_interrupt(interrupt.clone());
        renderer.shared.keeps_partial = true;
        renderer
    })
}

fn draw_for_file(
    views: &Views,
    request: &PictureRequest,
    backend: Backend,
    progress: &(dyn Fn(f32) + Sync),
    prepared: impl Fn(Renderer) -> Renderer,
) -> Result<RenderedImage<RgbaImage>, RenderError> {
    request.check()?;
    let on = |gpu: Arc<Gpu>| {
        let renderer = prepared(Renderer::on_gpu(gpu).with_views(views.clone()));
        renderer.draw_once(request, progress)
    };
    let by_software = |why: String| {
        let renderer = prepared(Renderer::software().with_views(views.clone()));
        let mut image = renderer.draw_once(request, progress)?;
        image.backend = BackendUsed::Software { reason: Some(why) };
        Ok(image)
    };
    match backend {
        Backend::Gpu => Gpu::shared().and_then(on),
        Backend::Software => by_software("as requested".to_owned()),
        Backend::Auto => match Gpu::shared_real().and_then(on) {
            Err(RenderError::NoGpu { reason }) => by_software(format!("because {reason}")),
            // If a driver fails, the software path still draws the picture, and the message is reported.
            Err(RenderError::Gpu(message)) => {
                by_software(format!("because the GPU failed: {message}"))
            }
            other => other,
        },
    }
}

impl Renderer {
    /// Creates a renderer on the software path.
    pub fn software() -> Self {
        Self::default()
    }

    /// Creates a renderer on a GPU. If the device is a window's own, [`Pixels::Texture`] can be displayed directly.
    pub fn on_gpu(gpu: Arc<Gpu>) -> Self {
        let mut renderer = Self::default();
        renderer.shared.gpu = Some(Box::new(GpuRenderer::new(gpu)));
        renderer
    }

    /// Returns the renderer with other views than [`Views::standard`].
    #[must_use]
    pub fn with_views(mut self, views: Views) -> Self {
        self.views = views;
        self.renderers.clear();
        self
    }

    /// Returns the renderer with kernels for samples from this number of operations on, instead of
    /// [`crate::plan::KERNEL_PAYS`]: for tests, which do not have time for objects of that size.
    #[must_use]
    pub fn with_kernels_from(mut self, operations: u64) -> Self {
        if let Some(gpu) = &mut self.shared.gpu {
            gpu.kernels_pay_from(operations);
        }
        self
    }

    /// Returns the renderer with a callback that it asks during a long picture whether to abandon it, with
    /// [`RenderError::Interrupted`]. Partial results are kept for the next picture.
    #[must_use]
    pub fn with_interrupt(mut self, interrupt: Interrupt) -> Self {
        self.shared.interrupt = interrupt;
        self
    }

    /// Returns the views that it draws.
    pub fn views(&self) -> &Views {
        &self.views
    }

    /// Returns true if kernels or the pass of traced pictures are being built in the background.
    pub fn is_building(&self) -> bool {
        let gpu = self.shared.gpu.as_ref();
        gpu.is_some_and(|gpu| gpu.is_building())
    }

    /// Returns the GPU that it draws on, if any.
    pub fn gpu(&self) -> Option<&Arc<Gpu>> {
        self.shared.gpu()
    }

    /// Returns true if its GPU is lost for good: then a new renderer is needed, on another device or on the software path.
    pub fn is_lost(&self) -> bool {
        self.gpu().is_some_and(|gpu| gpu.is_lost())
    }

    /// Draws a view.
    ///
    /// Unlike [`render`], which measures each scene anew, a renderer keeps the bounds of the first scene until a scene
    /// exceeds them (see [`Renderer::bounds`]): while params move and declarations change, the initial camera does not move.
    ///
    /// The last picture of each view is not drawn again: an equal request returns the same pixels.
    ///
    /// # Errors
    /// As [`render`].
    pub fn draw(&mut self, request: &PictureRequest) -> Result<RenderedImage, RenderError> {
        let start = Instant::now();
        request.check()?;
        if self.is_lost() {
            return Err(RenderError::Gpu("the device was lost".to_owned()));
        }
        let id = ViewId::from_request(request);
        let before = self.kept.iter().position(|(known, _)| *known == id);
        let before = before.map(|at| self.kept.remove(at).1);
        let mut kept = match before {
            Some(before) if before.is_for(request, self.bounds().as_ref()) => {
                let answers = self.gpu().map_or(Ok(()), |gpu| gpu.answers());
                let mut image = before.image.clone();
                self.kept.push((id, before));
                answers?;
                image.took = start.elapsed();
                return Ok(image);
            }
            before => before,
        };
        let drawn = self.draw_anew(request, &|_| {});
        let mut image = match drawn {
            Ok(image) => image,
            Err(error) => {
                self.kept.extend(kept.map(|kept| (id, kept)));
                return Err(error);
            }
        };
        if self.kept.len() >= KEPT {
            self.kept.remove(0);
        }
        let copy = KeptImage {
            request: request.clone(),
            bounds: self.bounds(),
            image: copied(&image, kept.take()),
        };
        self.kept.push((id, copy));
        image.took = start.elapsed();
        Ok(image)
    }

    /// Draws a picture for a file: in memory, in parts if it is large, and with all its planned kernels. `progress` receives
    /// the completed fraction, from 0 to 1, from any thread.
    ///
    /// # Errors
    /// As [`render`].
    pub fn draw_once(
        mut self,
        request: &PictureRequest,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<RenderedImage<RgbaImage>, RenderError> {
        self.draw_counted(request, progress).map(|(image, _)| image)
    }

    /// Draws as [`Renderer::draw_once`] does, and also returns the counts of what was built.
    ///
    /// # Errors
    /// As [`render`].
    pub fn draw_counted(
        &mut self,
        request: &PictureRequest,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<(RenderedImage<RgbaImage>, Built), RenderError> {
        let start = Instant::now();
        request.check()?;
        self.shared.is_single = true;
        let image = self.draw_anew(request, progress);
        self.shared.is_single = false;
        let mut image = image?;
        image.took = start.elapsed();
        let pixels = std::mem::replace(&mut image.image, Pixels::Image(RgbaImage::default()));
        let pixels = self.shared.read(pixels)?;
        Ok((image.with_pixels(pixels), self.shared.built()))
    }

    /// Draws a picture for a file in layers, on the software path.
    ///
    /// # Errors
    /// As [`render`].
    pub(crate) fn draw_layers(
        mut self,
        request: &PictureRequest,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<Layers, RenderError> {
        request.check()?;
        let request = request.with_scene_of_params();
        let request = self.with_curvatures(&request);
        let (renderer, shared) = self.renderer(&request)?;
        renderer.layers(shared, &request, progress)
    }

    fn draw_anew(
        &mut self,
        request: &PictureRequest,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<RenderedImage, RenderError> {
        let request = request.with_scene_of_params();
        let request = self.with_curvatures(&request);
        let (renderer, shared) = self.renderer(&request)?;
        let image = renderer.draw(shared, &request, progress)?;
        self.pictures += 1;
        Ok(image)
    }

    /// Returns the renderer of a request's view, and the state that views share.
    ///
    /// # Errors
    /// [`RenderError::NoView`].
    fn renderer(
        &mut self,
        request: &PictureRequest,
    ) -> Result<(&mut dyn ViewRenderer, &mut SharedState), RenderError> {
        let name = request.view.name();
        let view = self.views.get(name).ok_or_else(|| RenderError::NoView {
            name: name.to_owned(),
        })?;
        let renderer = self
            .renderers
            .entry(name)
            .or_insert_with(|| view.renderer());
        Ok((&mut **renderer, &mut self.shared))
    }

    /// Returns the request with the textures of the surfaces that show their curvature; they are made anew only if the scene
    /// or its params have changed.
    fn with_curvatures<'r>(&mut self, request: &'r PictureRequest) -> Cow<'r, PictureRequest> {
        if request.curved.is_empty() {
            return Cow::Borrowed(request);
        }
        let mut known = match self.curvatures.take() {
            Some(known) if known.is_for(request) => known,
            _ => Curvatures {
                scene: request.scene.clone(),
                params: request.params.clone(),
                textures: Vec::new(),
            },
        };
        let whole = request.clone().with_curvatures_from(|id| known.texture(id));
        self.curvatures = Some(known);
        Cow::Owned(whole)
    }

    /// Returns a picture of this renderer in memory. Waits for the GPU if it is there.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device is lost, or the picture belongs to another renderer.
    pub fn read(&self, pixels: Pixels) -> Result<RgbaImage, RenderError> {
        self.shared.read(pixels)
    }

    /// Returns the object and point that a view shows at a pixel; `None` if it shows nothing there, or does not support
    /// picking.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn pick(
        &mut self,
        request: &PictureRequest,
        at: PixelPoint,
    ) -> Result<Option<Hit>, RenderError> {
        request.check()?;
        let made = request.with_scene_of_params();
        let (renderer, shared) = self.renderer(&made)?;
        let hit = renderer.pick(shared, &made, at)?;
        Ok(hit.and_then(|hit| {
            let object = made.scene.number_in(&request.scene, hit.object)?;
            Some(Hit { object, ..hit })
        }))
    }

    /// Returns the camera in space of a request, in the drawing units of the renderer's bounds.
    ///
    /// # Errors
    /// [`RenderError::Camera`], also for a view that has no such camera.
    pub fn camera(&mut self, request: &PictureRequest) -> Result<Camera, RenderError> {
        request.check()?;
        let request = request.with_scene_of_params();
        let (renderer, shared) = self.renderer(&request)?;
        let camera = renderer.camera(shared, &request)?;
        camera.ok_or_else(|| {
            let name = request.view.name();
            RenderError::Camera(format!("the view `{name}` has no camera in space"))
        })
    }

    /// Returns the bounds in which views in space are drawn: those of the first scene, until a scene no longer fits them. A
    /// camera without a given position frames them.
    pub fn bounds(&self) -> Option<Arc<Bounds>> {
        self.shared.bounds()
    }

    /// Sets other bounds for the next pictures; with `None`, those of the next scene are used, for example to show all of
    /// it.
    pub fn set_bounds(&mut self, bounds: Option<Arc<Bounds>>) {
        self.shared.kept_bounds.set(bounds);
    }

    /// Returns the counters of the work so far.
    pub fn counters(&self) -> WorkCounters {
        let mut counters = WorkCounters {
            pictures: self.pictures,
            ..WorkCounters::default()
        };
        self.shared.count(&mut counters);
        counters
    }
}

impl KeptImage {
    /// Returns true if a request in these bounds would produce the same picture.
    fn is_for(&self, request: &PictureRequest, bounds: Option<&Arc<Bounds>>) -> bool {
        let same_bounds = match (&self.bounds, bounds) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (None, None) => true,
            _ => false,
        };
        same_bounds && self.request == *request
    }
}

impl Curvatures {
    /// Returns true if the textures belong to a request's scene and params.
    fn is_for(&self, request: &PictureRequest) -> bool {
        self.scene == request.scene && self.params == request.params
    }

    /// Returns the texture of a surface, which is made on first use; `None` if its derivatives are too large.
    fn texture(&mut self, id: ObjectId) -> Option<Shared<Texture>> {
        if let Some((_, texture)) = self.textures.iter().find(|(it, _)| *it == id) {
            return Some(texture.clone());
        }
        let texture = Texture::curvature(&self.scene, &self.params, id).ok()?;
        let texture: Shared<Texture> = texture.into();
        self.textures.push((id, texture.clone()));
        Some(texture)
    }
}

/// Copies a picture, into the memory of the previously kept one if possible.
fn copied(image: &RenderedImage, before: Option<KeptImage>) -> RenderedImage {
    let before = before.map(|kept| kept.image.image);
    let pixels = match (before, &image.image) {
        (Some(Pixels::Image(mut before)), Pixels::Image(image))
            if before.dimensions() == image.dimensions() =>
        {
            before.copy_from_slice(image);
            Pixels::Image(before)
        }
        (_, pixels) => pixels.clone(),
    };
    RenderedImage {
        image: pixels,
        backend: image.backend.clone(),
        notes: image.notes.clone(),
        overlays: image.overlays.clone(),
        ..*image
    }
}
