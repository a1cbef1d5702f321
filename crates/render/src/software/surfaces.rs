//! Surfaces as triangles, two for each quad of samples.

use glam::{Vec2, Vec3};

use super::mesh::{Eye, Mesh, MeshBuilder, Vertex, VertexId};
use crate::sample::SurfaceSample;

/// Returns the number of rows or columns of quads for `samples` rows or columns, of which every `stride`th and the last one
/// are drawn.
pub(super) fn quads(samples: u32, stride: usize) -> usize {
    (samples as usize - 1).div_ceil(stride)
}

/// Returns the triangles of the quad rows `rows`, numbered over all instances, with [`quads`] for each. Every `stride`th
/// column and row of samples is drawn, and the last one.
///
/// A triangle with an undefined corner is left out. Seen from the side that σu×σv points to, triangles run counterclockwise.
pub(super) fn mesh(
    eye: &Eye,
    material: u32,
    count: [u32; 2],
    stride: usize,
    samples: &[SurfaceSample],
    rows: std::ops::Range<usize>,
) -> Mesh {
    let mut builder = MeshBuilder::new(eye, material);
    let [columns, lines] = count.map(|n| n as usize);
    let [quad_columns, quad_rows] = count.map(|n| quads(n, stride));
    // The lower row of samples of a quad row is the upper row of the next.
    let mut last: Option<(usize, Vec<Option<VertexId>>)> = None;
    for row in rows {
        let (instance, j) = (row / quad_rows, row % quad_rows);
        let line = |builder: &mut MeshBuilder, j: usize| -> Vec<Option<VertexId>> {
            let j = (j * stride).min(lines - 1);
            let first = (instance * lines + j) * columns;
            let v = j as f32 / (lines - 1) as f32;
            (0..=quad_columns)
                .map(|i| {
                    let i = (i * stride).min(columns - 1);
                    let sample = &samples[first + i];
                    (sample.defined != 0.0).then(|| {
                        builder.vertex(Vertex {
                            clip: eye.clip(eye.see(sample.position), 0.0),
                            normal: eye.view.transform_vector3(Vec3::from(sample.normal)),
                            uv: Vec2::new(i as f32 / (columns - 1) as f32, v),
                        })
                    })
                })
                .collect()
        };
        let near = match last.take() {
            Some((at, vertices)) if at == row && j > 0 => vertices,
            _ => line(&mut builder, j),
        };
        let far = line(&mut builder, j + 1);
        for i in 0..quad_columns {
            let (a, b, c, d) = (near[i], near[i + 1], far[i + 1], far[i]);
            // Thinning never skips an open cell.
            let first = (instance * lines + j * stride) * columns + i * stride;
            if samples[first].is_last() {
                continue;
            }
            if let (Some(a), Some(b), Some(c)) = (a, b, c) {
                builder.triangle(a, b, c);
            }
            if let (Some(a), Some(c), Some(d)) = (a, c, d) {
                builder.triangle(a, c, d);
            }
        }
        last = Some((row + 1, far));
    }
    builder.finish()
}
