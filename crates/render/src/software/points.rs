//! Points as discs that face the eye.

use glam::{Vec2, Vec3};

use super::mesh::{Eye, Mesh, MeshBuilder, Vertex};
use crate::sample::PositionSample;
use crate::style;

/// Returns one disc for each defined sample.
pub(super) fn mesh(eye: &Eye, material: u32, samples: &[PositionSample]) -> Mesh {
    let mut builder = MeshBuilder::new(eye, material);
    for sample in samples.iter().filter(|sample| sample.defined != 0.0) {
        let at = eye.see(sample.position);
        let w = eye.distance(at).max(eye.near);
        let radius = eye
            .point
            .at(w, eye.pixels_per_unit, eye.unit, style::LEAST_POINT_RADIUS);
        disc(
            &mut builder,
            eye,
            at,
            radius,
            eye.lift * radius,
            style::POINT_SEGMENTS,
        );
    }
    builder.finish()
}

/// Adds a disc at a point in view space: a regular polygon of the disc's area, shaded like a ball.
pub(super) fn disc(
    builder: &mut MeshBuilder,
    eye: &Eye,
    at: Vec3,
    radius: f32,
    lift: f32,
    segments: u32,
) {
    let turn = std::f32::consts::TAU / segments as f32;
    let radius = radius * (turn / turn.sin()).sqrt();
    let mut vertex = |offset: Vec2| {
        builder.vertex(Vertex {
            clip: eye.clip(at + (radius * offset).extend(0.0), lift),
            normal: Vec3::ZERO,
            uv: offset,
        })
    };
    let centre = vertex(Vec2::ZERO);
    let rim: Vec<_> = (0..segments)
        .map(|k| vertex(Vec2::from_angle(turn * k as f32)))
        .collect();
    for (k, &corner) in rim.iter().enumerate() {
        builder.triangle(centre, corner, rim[(k + 1) % rim.len()]);
    }
}
