//! Surfaces as triangles, two to a quad of samples.

use glam::{Vec2, Vec3};

use super::mesh::{Eye, Mesh, MeshBuilder, Vertex, VertexId};
use crate::sample::SurfaceSample;

/// The triangles of the quad rows `rows` (numbered over all instances, `count[1] − 1` to each).
///
/// A triangle with an undefined corner is left out. RayEnds from the side that σu×σv points to, triangles run
/// counterclockwise.
pub(super) fn mesh(
    eye: &Eye,
    material: u32,
    count: [u32; 2],
    samples: &[SurfaceSample],
    rows: std::ops::Range<usize>,
) -> Mesh {
    let mut builder = MeshBuilder::new(eye, material);
    let [columns, lines] = count.map(|n| n as usize);
    let quad_rows = lines - 1;
    // The lower row of samples of one quad row is the upper one of the next.
    let mut last: Option<(usize, Vec<Option<VertexId>>)> = None;
    for row in rows {
        let (instance, j) = (row / quad_rows, row % quad_rows);
        let line = |builder: &mut MeshBuilder, j: usize| -> Vec<Option<VertexId>> {
            let first = (instance * lines + j) * columns;
            let v = j as f32 / quad_rows as f32;
            (0..columns)
                .map(|i| {
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
        for i in 0..columns - 1 {
            let (a, b, c, d) = (near[i], near[i + 1], far[i + 1], far[i]);
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
