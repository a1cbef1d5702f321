//! The painter of solids: the results of rays on the CPU, composed with other objects by their depth.

use rayon::prelude::*;

use crate::error::RenderError;
use crate::gpu::layout::SolidExtent;
use crate::gpu::pipelines::PipelineFactory;
use crate::gpu::space::{Draw, Vertices};
use crate::solids::{SolidPainter, SolidSample, TILE};
use crate::style;

/// The depth word of a pixel whose samples differ; no depth has these bits.
const SPLIT: u32 = u32::MAX;

/// The painter.
#[derive(Debug)]
pub(crate) struct Solids {
    pipeline: wgpu::RenderPipeline,
}

impl Solids {
    pub(crate) fn new(factory: &mut PipelineFactory<'_>) -> Result<Self, RenderError> {
        let joined = wgsl::painter::solids()?;
        let pipeline = factory.draw_pipeline("solids", &joined);
        Ok(Self { pipeline })
    }

    /// Returns the draw of all solids into a target of this size that begins at a pixel of the picture.
    pub(crate) fn draw(
        &self,
        factory: &PipelineFactory<'_>,
        painter: &SolidPainter<'_>,
        first: [u32; 2],
        size: [u32; 2],
    ) -> Draw {
        let Words { pixels, mut splits } = Words::of(painter, first, size);
        // An empty binding is refused.
        splits.push([0; 2]);
        let extent = SolidExtent { columns: size[0] };
        let extent = factory.gpu.uniform("extent", &extent);
        let storage = |label, words: &[[u32; 2]]| {
            let bytes = bytemuck::cast_slice(words);
            factory
                .gpu
                .buffer(label, wgpu::BufferUsages::STORAGE, bytes)
        };
        let [pixels, splits] = [
            storage("pixels of solids", &pixels),
            storage("samples of solids", &splits),
        ];
        let group = factory.bind(
            &self.pipeline.get_bind_group_layout(0),
            &[
                extent.as_entire_binding(),
                pixels.as_entire_binding(),
                splits.as_entire_binding(),
            ],
        );
        Draw {
            pipeline: self.pipeline.clone(),
            group,
            vertices: Vertices::Plain(3),
        }
    }
}

/// The samples of solids, in the format of the shader.
struct Words {
    pixels: Vec<[u32; 2]>,
    splits: Vec<[u32; 2]>,
}

impl Words {
    fn of(painter: &SolidPainter<'_>, first: [u32; 2], size: [u32; 2]) -> Self {
        let [left, top] = first.map(|side| side as usize);
        let [width, height] = size.map(|side| side as usize);
        let across = width.div_ceil(TILE);
        let corner = |k: usize| [k % across * TILE, k / across * TILE];
        let tiles: Vec<_> = (0..across * height.div_ceil(TILE))
            .into_par_iter()
            .map(|k| painter.tile([left + corner(k)[0], top + corner(k)[1]]))
            .collect();
        let mut words = Self {
            pixels: vec![[0; 2]; width * height],
            splits: Vec::new(),
        };
        for (k, tile) in tiles.into_iter().enumerate() {
            let Some(tile) = tile else { continue };
            let [x, y] = corner(k);
            let place = |index: usize| (y + index / TILE) * width + x + index % TILE;
            let inside = |index: usize| x + index % TILE < width && y + index / TILE < height;
            for (index, pixel) in tile.pixels.iter().enumerate() {
                if pixel.depth > 0.0 && inside(index) {
                    words.pixels[place(index)] = word(pixel);
                }
            }
            for (index, samples) in &tile.splits {
                let index = usize::from(*index);
                if inside(index) {
                    words.pixels[place(index)] = [SPLIT, words.splits.len() as u32];
                    words.splits.extend(samples.iter().map(word));
                }
            }
        }
        words
    }
}

fn word(sample: &SolidSample) -> [u32; 2] {
    if sample.depth <= 0.0 {
        return [0; 2];
    }
    let [r, g, b] = sample.light.map(style::encode);
    [
        sample.depth.to_bits(),
        u32::from_le_bytes([r, g, b, u8::MAX]),
    ]
}
