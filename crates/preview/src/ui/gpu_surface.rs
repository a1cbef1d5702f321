//! The window's own GPU: the GPU that draws the controls can also draw the pictures, which then never leave it.

use std::sync::Arc;
use std::time::Duration;

use eframe::egui_wgpu::{Callback, CallbackResources, CallbackTrait, RenderState};
use egui::{
    Color32, ColorImage, Context, PaintCallbackInfo, Painter, Rect, TextureHandle, TextureOptions,
};
use render::Renderer;
use render::gpu::{Blit, Blitter, Canvas, Gpu, Pixels};
use render::gpu::{DeviceType, GraphicsApi, PollType, RenderPass};

use crate::Backend;

/// The GPU that draws the window.
#[derive(Clone)]
pub(crate) struct GpuSurface {
    state: RenderState,
    gpu: Arc<Gpu>,
    /// Copies pictures; `None` on OpenGL, or if the GPU is already lost.
    blitter: Option<Arc<Blitter>>,
}

impl GpuSurface {
    /// Takes over the device: its errors and its loss no longer end the program.
    pub(crate) fn new(state: RenderState, context: &Context) -> Self {
        let adapter = state.adapter.get_info();
        let name = adapter.name;
        let waker = context.clone();
        // Nothing else may wake a window that can no longer be drawn.
        let lost = move || waker.request_repaint();
        let gpu = Gpu::adopt(state.device.clone(), state.queue.clone(), name, lost);
        // OpenGL has no views of a texture in another format.
        let can_blit = adapter.backend != GraphicsApi::Gl;
        let blitter = can_blit.then(|| Blitter::new(&gpu, state.target_format).ok());
        Self {
            state,
            gpu: Arc::new(gpu),
            blitter: blitter.flatten().map(Arc::new),
        }
    }

    /// Returns the renderer for a backend on this GPU, and its name in words. A GPU that is emulated by the processor
    /// is slower than the software path, so it is used only on request.
    pub(crate) fn renderer(&self, backend: Backend) -> (Renderer, String) {
        let adapter = self.state.adapter.get_info();
        // OpenGL can draw the controls, but lacks features that the passes need.
        let is_real = adapter.device_type != DeviceType::Cpu && adapter.backend != GraphicsApi::Gl;
        match backend {
            Backend::Gpu => {}
            Backend::Auto if is_real => {}
            Backend::Auto => return (Renderer::software(), "software".to_owned()),
            Backend::Software => {
                return (Renderer::software(), "software, as requested".to_owned());
            }
        }
        (
            Renderer::on_gpu(Arc::clone(&self.gpu)),
            self.gpu.name().to_owned(),
        )
    }

    /// Returns the maximum time that a frame of the window waits for its pictures: less than a frame of the screen, or,
    /// if the processor draws the frames, about the time that one takes.
    pub(crate) fn frame_wait_budget(&self) -> Duration {
        if self.state.adapter.get_info().device_type == DeviceType::Cpu {
            Duration::from_millis(100)
        } else {
            Duration::from_millis(12)
        }
    }

    /// Returns whether the device is lost.
    pub(crate) fn is_lost(&self) -> bool {
        // The device reports its loss when it is polled.
        let _ = self.state.device.poll(PollType::Poll);
        self.gpu.is_lost()
    }

    /// Makes the driver refuse the shaders that compute samples, for a test.
    pub(crate) fn refuse_samples(&self) {
        self.gpu.refuse_samples();
    }

    /// Gives up the device, as if it were lost.
    pub(crate) fn lose(&self) {
        self.gpu.destroy();
    }
}

/// The source from which the window paints a picture.
pub(crate) enum TextureBinding {
    /// A texture of egui's: if canvases cannot be copied, as on OpenGL, or there is no screen, as in tests.
    Texture(TextureHandle),
    /// A canvas on the screen's GPU.
    Canvas {
        blit: Arc<Blit>,
        blitter: Arc<Blitter>,
        /// True if the canvas is the window's own.
        is_own: bool,
    },
}

impl TextureBinding {
    /// Binds a picture, in place of another one. Has no effect if the GPU is lost: then another one is opened.
    pub(crate) fn new(
        painted: Pixels,
        before: Option<Self>,
        screen: Option<&GpuSurface>,
        context: &Context,
    ) -> Option<Self> {
        let copying =
            screen.and_then(|screen| Some((screen, Arc::clone(screen.blitter.as_ref()?))));
        let Some((screen, blitter)) = copying else {
            let Pixels::Image(image) = painted else {
                return None;
            };
            let size = [image.width() as usize, image.height() as usize];
            // It is opaque, so premultiplication makes no difference; this function is the fast one.
            let image = ColorImage::from_rgba_premultiplied(size, image.as_raw());
            let options = TextureOptions::LINEAR;
            let Some(Self::Texture(mut texture)) = before else {
                return Some(Self::Texture(
                    context.load_texture("picture", image, options),
                ));
            };
            texture.set(image, options);
            return Some(Self::Texture(texture));
        };
        let (canvas, is_own) = match painted {
            Pixels::Texture(canvas) => (canvas, false),
            Pixels::Image(image) => {
                let size = [image.width(), image.height()];
                if let Some(Self::Canvas { blit, is_own, .. }) = &before
                    && *is_own
                    && blit.canvas().size() == size
                {
                    blit.canvas().write(&screen.gpu, &image).ok()?;
                    return before;
                }
                (Canvas::with_pixels(&screen.gpu, size, &image).ok()?, true)
            }
        };
        Some(Self::Canvas {
            blit: Arc::new(blitter.ready(&screen.gpu, canvas)),
            blitter,
            is_own,
        })
    }

    /// Paints it over a rectangle.
    pub(crate) fn paint(&self, painter: &Painter, rect: Rect) {
        match self {
            Self::Texture(texture) => {
                let all = Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
                painter.image(texture.id(), rect, all, Color32::WHITE);
            }
            Self::Canvas { blit, blitter, .. } => {
                let copy = Copy {
                    blit: Arc::clone(blit),
                    blitter: Arc::clone(blitter),
                };
                painter.add(Callback::new_paint_callback(rect, copy));
            }
        }
    }
}

/// Copies a picture while the window is painted.
struct Copy {
    blit: Arc<Blit>,
    blitter: Arc<Blitter>,
}

impl CallbackTrait for Copy {
    fn paint(
        &self,
        info: PaintCallbackInfo,
        pass: &mut RenderPass<'static>,
        _resources: &CallbackResources,
    ) {
        let place = info.viewport_in_pixels();
        let rectangle = [place.left_px, place.top_px, place.width_px, place.height_px];
        self.blitter
            .copy(pass, &self.blit, rectangle.map(|it| it as f32));
    }
}
