//! Painter of vectors: a strip, a disc and a cone each.

use crate::gpu::layout::Glyph;
use crate::gpu::samples::SampleBuffer;
use crate::gpu::space::{Draw, Vertices};
use crate::gpu::workshop::Workshop;
use crate::request::RenderError;
use crate::style;

/// Corners that the shader makes of one arrow.
const CORNERS: u32 = 6 + 3 * style::JOIN_SEGMENTS + 6 * style::HEAD_SEGMENTS;

/// The painter.
pub(crate) struct Vectors {
    pipeline: wgpu::RenderPipeline,
}

impl Vectors {
    pub(crate) fn new(workshop: &mut Workshop<'_>) -> Result<Self, RenderError> {
        let joined = wgsl::painter::vectors()?;
        Ok(Self {
            pipeline: workshop.draw_pipeline("vectors", &joined),
        })
    }

    /// The draw of all instances of one object, in linear light.
    pub(crate) fn draw(
        &self,
        workshop: &Workshop<'_>,
        view: &wgpu::Buffer,
        samples: &SampleBuffer,
        colour: [f32; 3],
    ) -> Draw {
        let glyph = Glyph::new(
            colour,
            &style::LINE_HALF_WIDTH,
            style::LEAST_HALF_WIDTH,
            samples.count[0],
            samples.total,
            0,
        );
        let glyph = workshop.gpu.uniform("glyph", &glyph);
        let group = workshop.bind(
            &self.pipeline.get_bind_group_layout(0),
            &[
                view.as_entire_binding(),
                glyph.as_entire_binding(),
                samples.buffer.as_entire_binding(),
            ],
        );
        let vertices = Vertices::Plain(samples.total.saturating_mul(CORNERS));
        Draw {
            pipeline: self.pipeline.clone(),
            group,
            vertices,
        }
    }
}
