//! The state that the views of one renderer share: the samples and the bounds of the scene, the GPU, the counters.

use std::sync::Arc;

use image::RgbaImage;

use crate::bounds::Bounds;
use crate::content::Structures;
use crate::counters::{PixelCounters, WorkCounters};
use crate::error::RenderError;
use crate::framing::KeptBounds;
use crate::gpu::renderer::GpuRenderer;
use crate::gpu::{Gpu, Pixels};
use crate::plan::Built;
use crate::rendered::BackendUsed;
use crate::sample_store::SampleStore;
use crate::solids::SolidStore;
use crate::stated_colours::StatedColours;

/// A callback that decides whether a long picture is to be abandoned; any thread may call it during drawing.
#[derive(Clone, Default)]
pub struct Interrupt(Option<Arc<dyn Fn() -> bool + Send + Sync>>);

impl Interrupt {
    /// Creates an interrupt with this answer.
    pub fn new(answer: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(answer)))
    }

    /// Returns true if the picture is to be abandoned; false without a callback.
    pub fn is_wanted(&self) -> bool {
        self.0.as_ref().is_some_and(|answer| answer())
    }
}

impl std::fmt::Debug for Interrupt {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Interrupt")
    }
}

/// The state that the views of one renderer share.
#[derive(Debug, Default)]
pub struct SharedState {
    /// The solids of the last pictures.
    pub(crate) solids: SolidStore,
    pub(crate) interrupt: Interrupt,
    pub(crate) structures: Structures,
    pub(crate) kept_bounds: KeptBounds,
    pub(crate) samples: SampleStore,
    pub(crate) stated_colours: StatedColours,
    /// The number of geodesic views whose geodesics were followed.
    pub(crate) followed: u64,
    pub(crate) pixels: Arc<PixelCounters>,
    /// The GPU part of the renderer; without it the software path draws.
    pub(crate) gpu: Option<Box<GpuRenderer>>,
    /// True if a single picture is drawn, for a file: in memory, in parts if it is large, and after its kernels are ready.
    pub(crate) is_single: bool,
    /// True if an abandoned picture is returned with the samples that all its pixels have.
    pub(crate) keeps_partial: bool,
}

impl SharedState {
    /// Returns the GPU that pictures are drawn on; `None` on the software path.
    pub fn gpu(&self) -> Option<&Arc<Gpu>> {
        self.gpu.as_ref().map(|renderer| &renderer.gpu)
    }

    /// Returns the backend for pictures that are drawn on the GPU if there is one.
    pub(crate) fn backend(&self) -> BackendUsed {
        self.gpu().map_or(BackendUsed::SOFTWARE, |gpu| {
            BackendUsed::Gpu(gpu.name().to_owned())
        })
    }

    /// Copies a picture into memory. Waits for the GPU if it is there.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device is lost, or the picture belongs to another renderer.
    pub fn read(&self, pixels: Pixels) -> Result<RgbaImage, RenderError> {
        match (pixels, self.gpu()) {
            (Pixels::Image(image), _) => Ok(image),
            (Pixels::Texture(canvas), Some(gpu)) => canvas.read(gpu),
            (Pixels::Texture(_), None) => Err(RenderError::Gpu(
                "the picture belongs to another renderer".to_owned(),
            )),
        }
    }

    /// Returns the bounds in which views in space are drawn: those of the first scene, until a scene no longer fits them. A
    /// camera without a given position frames them.
    pub fn bounds(&self) -> Option<Arc<Bounds>> {
        self.kept_bounds.get().cloned()
    }

    /// Writes the counts of the work so far to counters.
    pub(crate) fn count(&self, counters: &mut WorkCounters) {
        let gpu = self.gpu.as_ref();
        counters.pipelines = gpu.map_or(0, |gpu| gpu.pipelines());
        counters.sampled = self.samples.sampled + gpu.map_or(0, |gpu| gpu.sampled());
        counters.followed = self.followed;
        counters.worlds = self.solids.built;
        self.pixels.write(counters);
    }

    /// Returns the counts of everything that has been built on the GPU so far.
    pub(crate) fn built(&self) -> Built {
        let gpu = self.gpu.as_ref();
        gpu.map_or_else(Built::default, |gpu| gpu.built())
    }
}
