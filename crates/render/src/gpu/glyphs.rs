//! The painter of glyphs: the common code of points, vectors and curves. Each sample becomes a few triangles whose size
//! follows the distance; only the shader knows their form.

use crate::error::RenderError;
use crate::gpu::layout::Glyph;
use crate::gpu::pipelines::PipelineFactory;
use crate::gpu::samples::{SampleBuffer, instance_colours};
use crate::gpu::space::{Draw, Vertices};
use crate::style::{self, Look};

/// A kind of glyph.
#[derive(Debug)]
pub(crate) struct GlyphKind {
    /// The pipeline's name.
    pub(crate) label: &'static str,
    /// Its shader.
    pub(crate) shader: fn() -> Result<wgsl::Joined, wgsl::InternalError>,
    /// Half its width, or its radius.
    pub(crate) width: &'static style::Length,
    /// The minimum of it in pixels; thinner glyphs fade instead.
    pub(crate) least: f32,
    /// The number of corners that the shader generates from one sample.
    pub(crate) corners: u32,
}

/// The painter of one kind of glyph.
#[derive(Debug)]
pub(crate) struct Glyphs {
    kind: &'static GlyphKind,
    pipeline: wgpu::RenderPipeline,
}

impl Glyphs {
    pub(crate) fn new(
        factory: &mut PipelineFactory<'_>,
        kind: &'static GlyphKind,
    ) -> Result<Self, RenderError> {
        let joined = (kind.shader)()?;
        let pipeline = factory.draw_pipeline(kind.label, &joined);
        Ok(Self { kind, pipeline })
    }

    /// Returns the draw of all instances of one object.
    pub(crate) fn draw(
        &self,
        factory: &PipelineFactory<'_>,
        view: &wgpu::Buffer,
        samples: &SampleBuffer,
        look: &Look,
    ) -> Draw {
        let kind = self.kind;
        let glyph = Glyph::new(
            look,
            kind.width,
            kind.least,
            samples.count[0],
            samples.total,
            0,
        );
        let glyph = factory.gpu.uniform("glyph", &glyph);
        let colours = instance_colours(factory.gpu, look);
        let group = factory.bind(
            &self.pipeline.get_bind_group_layout(0),
            &[
                view.as_entire_binding(),
                glyph.as_entire_binding(),
                samples.buffer.as_entire_binding(),
                colours.as_entire_binding(),
            ],
        );
        Draw {
            pipeline: self.pipeline.clone(),
            group,
            vertices: Vertices::Plain(samples.total.saturating_mul(kind.corners)),
        }
    }
}
