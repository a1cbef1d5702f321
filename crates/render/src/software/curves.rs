//! Curves as strips that face the eye, with round joins and ends.

use glam::{Vec2, Vec3};

use super::mesh::{Eye, Mesh, MeshBuilder, Vertex};
use super::points;
use crate::sample::PositionSample;
use crate::style;

/// The cosine of the turn up to which two pieces share their end (a mitre); sharper turns have a round join.
const MITRE: f32 = 0.8;

/// Returns the strips of the instances in `instances`, `count` samples each. Undefined samples and breaks leave gaps.
pub(super) fn mesh(
    eye: &Eye,
    material: u32,
    count: u32,
    samples: &[PositionSample],
    instances: std::ops::Range<usize>,
) -> Mesh {
    let mut builder = MeshBuilder::new(eye, material);
    let count = count as usize;
    for instance in instances {
        for run in runs(eye, &samples[instance * count..(instance + 1) * count]) {
            polyline(&mut builder, eye, &run);
        }
    }
    builder.finish()
}

/// Returns the unbroken parts of a curve in view space. The last point of a part may be behind the near plane.
pub(super) fn runs(eye: &Eye, samples: &[PositionSample]) -> Vec<Vec<Vec3>> {
    let mut runs = Vec::new();
    let mut run: Vec<Vec3> = Vec::with_capacity(samples.len());
    for sample in samples {
        if sample.defined == 0.0 {
            runs.push(std::mem::take(&mut run));
            continue;
        }
        let at = eye.see(sample.position);
        let in_front = eye.is_in_front(at);
        match run.last().copied() {
            // Cut off the part behind the near plane: its points cannot be projected.
            Some(last) if in_front != eye.is_in_front(last) => {
                let t = (eye.near + last.z) / (last.z - at.z);
                let edge = last.lerp(at, t).with_z(-eye.near);
                if in_front {
                    run.clear();
                    run.extend([edge, at]);
                } else {
                    run.push(edge);
                    runs.push(std::mem::take(&mut run));
                    run.push(at);
                }
            }
            _ if in_front => run.push(at),
            _ => {
                run.clear();
                run.push(at);
            }
        }
        if sample.is_last() {
            runs.push(std::mem::take(&mut run));
        }
    }
    runs.push(run);
    runs
}

/// Returns the points of a run in front of the eye, without those that coincide in the picture: they give a piece no
/// direction.
pub(super) fn distinct(eye: &Eye, places: &[Vec3]) -> Vec<Vec3> {
    let mut places = places.to_vec();
    places.retain(|at| eye.distance(*at) >= 0.999 * eye.near);
    places.dedup_by(|b, a| (*b - *a).length() < 0.02 * eye.pixel(*a));
    places
}

/// Adds one unbroken strip through points in front of the eye, in view space.
fn polyline(builder: &mut MeshBuilder, eye: &Eye, places: &[Vec3]) {
    let places = distinct(eye, places);
    let Some((&first, &last)) = places.first().zip(places.last()) else {
        return;
    };
    cap(builder, eye, first, eye.lift);
    if places.len() < 2 {
        return;
    }
    cap(builder, eye, last, eye.lift);
    let sides: Vec<Vec2> = places
        .windows(2)
        .map(|pair| side(eye, pair[0], pair[1]))
        .collect();
    let mut before = edge(builder, eye, places[0], sides[0], eye.half_width(places[0]));
    for (k, &side) in sides.iter().enumerate() {
        let end = places[k + 1];
        let half = eye.half_width(end);
        let next = sides.get(k + 1).copied().unwrap_or(side);
        let cosine = side.dot(next);
        let (at_end, after) = if cosine >= MITRE {
            // (a + b) / (1 + a·b) has component 1 along both a and b.
            let shared = edge(builder, eye, end, (side + next) / (1.0 + cosine), half);
            (shared, shared)
        } else {
            cap(builder, eye, end, eye.join_lift);
            (
                edge(builder, eye, end, side, half),
                edge(builder, eye, end, next, half),
            )
        };
        builder.triangle(before[0], at_end[0], at_end[1]);
        builder.triangle(before[0], at_end[1], before[1]);
        before = after;
    }
}

/// Adds one straight piece between points in view space, with the given half widths, for the shafts of vectors.
pub(super) fn piece(builder: &mut MeshBuilder, eye: &Eye, ends: [Vec3; 2], half: [f32; 2]) {
    let side = side(eye, ends[0], ends[1]);
    let [a, b] = [0, 1].map(|k| edge(builder, eye, ends[k], side, half[k]));
    builder.triangle(a[0], b[0], b[1]);
    builder.triangle(a[0], b[1], a[1]);
}

/// Returns the unit vector across a piece, in the picture.
fn side(eye: &Eye, a: Vec3, b: Vec3) -> Vec2 {
    let along = (eye.project(b) - eye.project(a)).normalize_or_zero();
    if along == Vec2::ZERO {
        Vec2::X
    } else {
        along.perp()
    }
}

/// Adds the two corners of a strip at a point.
fn edge(
    builder: &mut MeshBuilder,
    eye: &Eye,
    at: Vec3,
    side: Vec2,
    half: f32,
) -> [super::mesh::VertexId; 2] {
    [1.0, -1.0].map(|sign: f32| {
        builder.vertex(Vertex {
            clip: eye.clip(at + (sign * half * side).extend(0.0), eye.lift * half),
            normal: Vec3::ZERO,
            uv: Vec2::new(0.0, sign),
        })
    })
}

fn cap(builder: &mut MeshBuilder, eye: &Eye, at: Vec3, lift: f32) {
    let half = eye.half_width(at);
    points::disc(builder, eye, at, half, lift * half, style::JOIN_SEGMENTS);
}
