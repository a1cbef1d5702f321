//! The renderer: draws views of a scene again and again, while the scene is edited, its params move and its cameras walk.
//! A picture for a file is a renderer that draws one picture.
//!
//! ```text
//! PictureRequest ──Views──▶ ViewRenderer (view/*.rs) ──▶ RenderedImage
//!                              │ samples, framing, GPU: view::SharedState
//! ```
//!
//! A [`Renderer`] keeps from one picture to the next what both need: samples, pipelines, textures, geodesics. They are
//! looked up by their content, so that an edit of one object leaves those of all others alone. A renderer belongs to one
//! thread at a time; it never draws a picture by itself.

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

/// Pictures that are kept, each of another view.
const KEPT: usize = 6;

/// Draws the views of one window, or a picture for a file.
#[derive(Debug, Default)]
pub struct Renderer {
    views: Views,
    /// The state of each view that has been drawn, by its name.
    renderers: BTreeMap<&'static str, Box<dyn ViewRenderer>>,
    shared: SharedState,
    /// The last picture of each view; the one that was drawn last is the last one.
    kept: Vec<(ViewId, KeptImage)>,
    curvatures: Option<Curvatures>,
    pictures: u64,
}

/// A picture that has been drawn, with all that it depends on.
#[derive(Debug)]
struct KeptImage {
    request: PictureRequest,
    bounds: Option<Arc<Bounds>>,
    image: RenderedImage,
}

/// Textures of curvature, of a scene with its params.
#[derive(Debug)]
struct Curvatures {
    scene: Shared<Scene>,
    params: Arc<ParamValues>,
    textures: Vec<(ObjectId, Shared<Texture>)>,
}

/// Draws one picture for print in [layers](crate::layers), on the software path, which knows what hides what. `progress`
/// receives the share that is done, from 0 to 1, from any thread.
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

/// Draws one picture for a file. `progress` receives the share that is done, from 0 to 1, from any thread.
///
/// [`Backend::Auto`] takes a real GPU where there is one and the software path otherwise; [`RenderedImage::backend`] says
/// which and why.
///
/// # Errors
/// See [`RenderError`]; nothing a scene or a request holds leads to a panic.
pub fn render(
    views: &Views,
    request: &PictureRequest,
    backend: Backend,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<RenderedImage<RgbaImage>, RenderError> {
    draw_for_file(views, request, backend, progress, |renderer| renderer)
}

/// Draws one picture for a file as [`render`] does, until it is done or `interrupt` answers. What a view refines sample by
/// sample is returned with the samples that all pixels have then, and a note that says how many.
///
/// # Errors
/// As [`render`]; [`RenderError::Interrupted`] if no sample of all pixels was done.
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
            // A driver that fails must not cost the picture; its message is not lost.
            Err(RenderError::Gpu(message)) => {
                by_software(format!("because the GPU failed: {message}"))
            }
            other => other,
        },
    }
}

/// The request with the scene that the values of its params make, where they change more than numbers.
fn with_scene_of_params(request: &PictureRequest) -> Cow<'_, PictureRequest> {
    if request.scene.rerun.is_none() {
        return Cow::Borrowed(request);
    }
    let scene = request.scene.arc().at(&request.params);
    Cow::Owned(PictureRequest {
        scene: scene.into(),
        ..request.clone()
    })
}

impl Renderer {
    /// A renderer on the software path.
    pub fn software() -> Self {
        Self::default()
    }

    /// A renderer on a GPU. The device may be a window's own: then [`Pixels::Texture`] can be shown as it is.
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

    /// Returns the renderer with a kernel for an object's samples from this number of operations on, instead of
    /// [`crate::plan::KERNEL_PAYS`]: for tests, which have no time for objects as large as that.
    #[must_use]
    pub fn with_kernels_from(mut self, operations: u64) -> Self {
        if let Some(gpu) = &mut self.shared.gpu {
            gpu.kernels_pay_from(operations);
        }
        self
    }

    /// Returns the renderer with a question that it asks while a picture that takes long is drawn: whether to give it up,
    /// with [`RenderError::Interrupted`]. What has been found of it is kept for the next picture.
    #[must_use]
    pub fn with_interrupt(mut self, interrupt: Interrupt) -> Self {
        self.shared.interrupt = interrupt;
        self
    }

    /// The views that it draws.
    pub fn views(&self) -> &Views {
        &self.views
    }

    /// Returns true if kernels or the pass of traced pictures are being built, behind the pictures.
    pub fn is_building(&self) -> bool {
        let gpu = self.shared.gpu.as_ref();
        gpu.is_some_and(|gpu| gpu.is_building())
    }

    /// The GPU that it draws on, if it does.
    pub fn gpu(&self) -> Option<&Arc<Gpu>> {
        self.shared.gpu()
    }

    /// Returns true if its GPU is gone for good: then a new renderer is needed, on another device or on the software
    /// path.
    pub fn is_lost(&self) -> bool {
        self.gpu().is_some_and(|gpu| gpu.is_lost())
    }

    /// Draws a view.
    ///
    /// Unlike [`render`], which measures each scene anew, a renderer draws in the bounds of the first scene that it was
    /// given until a scene has outgrown them (see [`Renderer::bounds`]): while params move and declarations change, the
    /// first camera stays where it is.
    ///
    /// The last picture of each view is not drawn again: an equal request gets the same pixels.
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

    /// Draws a picture for a file: in memory, in parts where it is large, and with all kernels that it is planned with.
    /// `progress` receives the share that is done, from 0 to 1, from any thread.
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

    /// Draws as [`Renderer::draw_once`] does, and returns the counts of what was built too.
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
        let request = with_scene_of_params(request);
        let request = self.with_curvatures(&request);
        let (renderer, shared) = self.renderer(&request)?;
        renderer.layers(shared, &request, progress)
    }

    fn draw_anew(
        &mut self,
        request: &PictureRequest,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<RenderedImage, RenderError> {
        let request = with_scene_of_params(request);
        let request = self.with_curvatures(&request);
        let (renderer, shared) = self.renderer(&request)?;
        let image = renderer.draw(shared, &request, progress)?;
        self.pictures += 1;
        Ok(image)
    }

    /// Returns the renderer of a request's view, and the state that it shares with others.
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

    /// The request with the textures of the surfaces that show their curvature; they are made anew only where the scene
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

    /// A picture of this renderer in memory. Waits for the GPU if it is there.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device is lost, or the picture is another renderer's.
    pub fn read(&self, pixels: Pixels) -> Result<RgbaImage, RenderError> {
        self.shared.read(pixels)
    }

    /// Returns the object and place that a view shows at a pixel; `None` where it shows nothing, or does not support
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
        let request = with_scene_of_params(request);
        let (renderer, shared) = self.renderer(&request)?;
        renderer.pick(shared, &request, at)
    }

    /// The camera in space that a request has, in the drawing units of the renderer's bounds.
    ///
    /// # Errors
    /// [`RenderError::Camera`], also for a view that has no such camera.
    pub fn camera(&mut self, request: &PictureRequest) -> Result<Camera, RenderError> {
        request.check()?;
        let request = with_scene_of_params(request);
        let (renderer, shared) = self.renderer(&request)?;
        let camera = renderer.camera(shared, &request)?;
        camera.ok_or_else(|| {
            let name = request.view.name();
            RenderError::Camera(format!("the view `{name}` has no camera in space"))
        })
    }

    /// The bounds in which views in space are drawn: those of the first scene, until a scene no longer fits them. A
    /// camera without a place of its own frames them.
    pub fn bounds(&self) -> Option<Arc<Bounds>> {
        self.shared.bounds()
    }

    /// Draws in other bounds from now on; `None` stands for those of the scene that is drawn next, as when all of it is
    /// to be seen.
    pub fn set_bounds(&mut self, bounds: Option<Arc<Bounds>>) {
        self.shared.framing.keep(bounds);
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
    /// Returns true if a request in these bounds would give the same picture.
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
    /// Returns true if the textures are those of a request's scene and params.
    fn is_for(&self, request: &PictureRequest) -> bool {
        self.scene == request.scene && self.params == request.params
    }

    /// Returns the texture of a surface, which is made the first time; `None` if its derivatives are too large.
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

/// A copy of a picture, in the memory of the one that was kept before.
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
