//! The window's own GPU: the one that draws its controls can draw its pictures too, and then they never leave it.

use std::sync::Arc;
use std::time::Duration;

use eframe::egui_wgpu::RenderState;
use render::gpu::wgpu::{Backend as Backends, DeviceType, FilterMode, PollType};
use render::gpu::{Canvas, Gpu};
use render::live::Stage;

use crate::Backend;

/// What the window is drawn with.
#[derive(Clone)]
pub(crate) struct Screen {
    state: RenderState,
    gpu: Arc<Gpu>,
}

impl Screen {
    /// Takes the device over: its errors and its loss no longer end the program.
    pub(crate) fn new(state: RenderState) -> Self {
        let name = state.adapter.get_info().name;
        let gpu = Gpu::adopt(state.device.clone(), state.queue.clone(), name);
        Self {
            state,
            gpu: Arc::new(gpu),
        }
    }

    /// The stage that a backend means here, and its name in words. A GPU that is a program on the processor is slower
    /// than the processor's own way, so it is taken only where it is asked for.
    pub(crate) fn stage(&self, backend: Backend) -> (Stage, String) {
        let adapter = self.state.adapter.get_info();
        // OpenGL can draw the controls, but lacks what the passes need.
        let is_real = adapter.device_type != DeviceType::Cpu && adapter.backend != Backends::Gl;
        match backend {
            Backend::Gpu => {}
            Backend::Auto if is_real => {}
            Backend::Auto => return (Stage::software(), "software".to_owned()),
            Backend::Software => return (Stage::software(), "software, as asked for".to_owned()),
        }
        (Stage::on(Arc::clone(&self.gpu)), self.gpu.name().to_owned())
    }

    /// For how long a frame of the window may wait for its pictures: less than a frame of the screen, or where frames are
    /// drawn by the processor, about as long as one takes.
    pub(crate) fn patience(&self) -> Duration {
        if self.state.adapter.get_info().device_type == DeviceType::Cpu {
            Duration::from_millis(100)
        } else {
            Duration::from_millis(12)
        }
    }

    /// Whether the device is gone.
    pub(crate) fn is_lost(&self) -> bool {
        // The device tells of its loss when it is looked after.
        let _ = self.state.device.poll(PollType::Poll);
        self.gpu.is_lost()
    }

    /// Has its driver refuse shaders of samples.
    pub(crate) fn refuse_samples(&self) {
        self.gpu.refuse_samples();
    }

    /// Gives the device up, as if it were lost.
    pub(crate) fn lose(&self) {
        self.gpu.destroy();
    }

    /// Hangs a canvas up in the window, in the place of another.
    pub(crate) fn hang(&self, canvas: &Canvas, place: Option<egui::TextureId>) -> egui::TextureId {
        let mut renderer = self.state.renderer.write();
        let (device, view) = (&self.state.device, canvas.view());
        match place {
            Some(id) => {
                renderer.update_egui_texture_from_wgpu_texture(
                    device,
                    view,
                    FilterMode::Linear,
                    id,
                );
                id
            }
            None => renderer.register_native_texture(device, view, FilterMode::Linear),
        }
    }

    /// Takes a canvas down.
    pub(crate) fn forget(&self, id: egui::TextureId) {
        self.state.renderer.write().free_texture(&id);
    }
}
