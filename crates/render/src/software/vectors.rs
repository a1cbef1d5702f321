//! Vectors as arrows: a strip for the shaft, a cone for the head.

use glam::{Vec2, Vec3};

use super::mesh::{Eye, Mesh, MeshBuilder, Vertex};
use super::{curves, points};
use crate::sample::VectorSample;
use crate::style;

/// Returns the meshes of shafts (glyphs) and heads (cones), in this order.
pub(super) fn meshes(eye: &Eye, materials: [u32; 2], samples: &[VectorSample]) -> [Mesh; 2] {
    let [mut shafts, mut heads] = materials.map(|material| MeshBuilder::new(eye, material));
    for sample in samples.iter().filter(|sample| sample.defined != 0.0) {
        let origin = eye.see(sample.origin);
        let along = eye.view.transform_vector3(Vec3::from(sample.direction));
        arrow(&mut shafts, &mut heads, eye, origin, along);
    }
    [shafts.finish(), heads.finish()]
}

fn arrow(shafts: &mut MeshBuilder, heads: &mut MeshBuilder, eye: &Eye, origin: Vec3, along: Vec3) {
    let tip = origin + along;
    let length = along.length();
    let half = [eye.half_width(origin), eye.half_width(tip)];
    if length < 1e-3 * half[0] {
        // A zero vector has no direction, but is drawn.
        points::disc(
            shafts,
            eye,
            origin,
            half[0],
            eye.lift * half[0],
            style::JOIN_SEGMENTS,
        );
        return;
    }
    let axis = along / length;
    let full = style::HEAD_LENGTH * half[1];
    let scale = (style::HEAD_SHARE * length / full).min(1.0);
    let base = tip - axis * (full * scale);
    // A scaled shaft keeps a width that four samples per pixel can resolve.
    let least = [origin, tip].map(|at| style::LEAST_HALF_WIDTH * eye.pixel(at));
    let shaft = [0, 1].map(|k| (half[k] * scale).max(least[k].min(half[k])));
    if let Some((ends, shaft)) = in_front(eye, [origin, base], shaft) {
        curves::piece(shafts, eye, ends, shaft);
        points::disc(
            shafts,
            eye,
            ends[0],
            shaft[0],
            eye.join_lift * shaft[0],
            style::JOIN_SEGMENTS,
        );
    }
    let lift = eye.lift * half[1] * scale;
    cone(
        heads,
        eye,
        tip,
        axis,
        full * scale,
        style::HEAD_RADIUS * half[1] * scale,
        lift,
    );
}

/// Returns the part of a shaft in front of the near plane.
fn in_front(eye: &Eye, ends: [Vec3; 2], half: [f32; 2]) -> Option<([Vec3; 2], [f32; 2])> {
    let beyond = ends.map(|at| eye.distance(at) - eye.near);
    match beyond.map(|b| b >= 0.0) {
        [true, true] => Some((ends, half)),
        [false, false] => None,
        [first, _] => {
            let t = beyond[0] / (beyond[0] - beyond[1]);
            let edge = ends[0].lerp(ends[1], t).with_z(-eye.near);
            Some(if first {
                ([ends[0], edge], half)
            } else {
                ([edge, ends[1]], half)
            })
        }
    }
}

fn cone(
    builder: &mut MeshBuilder,
    eye: &Eye,
    tip: Vec3,
    axis: Vec3,
    length: f32,
    radius: f32,
    lift: f32,
) {
    let (right, up) = axis.any_orthonormal_pair();
    let base = tip - axis * length;
    let turn = std::f32::consts::TAU / style::HEAD_SEGMENTS as f32;
    let radial = |k: f32| {
        let (sin, cos) = (turn * k).sin_cos();
        right * cos + up * sin
    };
    let mut vertex = |at: Vec3, normal: Vec3| {
        builder.vertex(Vertex {
            clip: eye.clip(at, lift),
            normal,
            uv: Vec2::ZERO,
        })
    };
    // The normal of the side leans forward by the slope of the cone.
    let slope = |radial: Vec3| radial * length + axis * radius;
    let mut triangles = Vec::with_capacity(2 * style::HEAD_SEGMENTS as usize);
    let middle = vertex(base, -axis);
    for k in 0..style::HEAD_SEGMENTS {
        let k = k as f32;
        let [a, b] = [radial(k), radial(k + 1.0)];
        let side = [
            vertex(base + a * radius, slope(a)),
            vertex(base + b * radius, slope(b)),
            vertex(tip, slope(radial(k + 0.5))),
        ];
        let bottom = [
            vertex(base + b * radius, -axis),
            vertex(base + a * radius, -axis),
            middle,
        ];
        triangles.extend([side, bottom]);
    }
    for [a, b, c] in triangles {
        builder.triangle(a, b, c);
    }
}
