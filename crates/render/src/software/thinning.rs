//! Fewer triangles of a surface during motion, where the difference is hardly visible.
//!
//! Thinning draws every other column and row of samples, and the last ones. Its effect is known exactly: an omitted sample
//! moves to the midpoint of the edge that passes it.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::mesh::Eye;
use crate::camera::Camera;
use crate::sample::{Samples, SurfaceSample};

/// Thinning draws every `STRIDE`th column and row of samples.
const STRIDE: usize = 2;
/// The maximum number of pixels by which thinning may move a sample.
const MOST_PIXELS: f32 = 1.0;
/// The maximum difference between a unit normal and its replacement; brightness then changes by at most about this fraction.
const MOST_TURN: f32 = 0.02;

/// Returns the stride of the columns and rows of samples that a picture draws during motion.
pub(crate) fn moving_stride(camera: &Camera, samples: &Samples) -> usize {
    let Samples::Surfaces { count, samples } = samples else {
        return 1;
    };
    let eye = Eye::new(camera);
    let [columns, rows] = count.map(|n| n as usize);
    let is_alike = |row: usize| {
        let instance = &samples[row / rows * rows * columns..][..rows * columns];
        let [j, [j0, j1]] = [[row % rows; 2], neighbours(row % rows, rows)];
        (0..columns).all(|i| {
            let [i0, i1] = neighbours(i, columns);
            let at = |i: usize, j: usize| &instance[j * columns + i];
            (i0 == i1 && j0 == j1) || is_between(&eye, at(i, j[0]), [at(i0, j0), at(i1, j1)])
        })
    };
    let all = (0..samples.len() / columns).into_par_iter().all(is_alike);
    if all { STRIDE } else { 1 }
}

/// Returns the indices of the drawn samples before and after the `k`th of `all`: its own index if it is drawn.
fn neighbours(k: usize, all: usize) -> [usize; 2] {
    let before = k - k % STRIDE;
    if k == before || k + 1 == all {
        [k; 2]
    } else {
        [before, (before + STRIDE).min(all - 1)]
    }
}

/// Returns true if moving a sample to the midpoint of two others is invisible.
fn is_between(eye: &Eye, sample: &SurfaceSample, ends: [&SurfaceSample; 2]) -> bool {
    let [a, b] = ends;
    if [sample, a, b].iter().any(|it| it.defined != 1.0) {
        return false;
    }
    let turn = Vec3::from(sample.normal) - Vec3::from(a.normal).midpoint(b.normal.into());
    let [at, a, b] = [sample, a, b].map(|it| eye.see(it.position));
    let is_seen = [at, a, b].iter().all(|at| eye.is_in_front(*at));
    let pixel = |at: Vec3| -> Vec2 { eye.project(at) * eye.pixels_per_unit };
    is_seen
        && turn.length_squared() <= MOST_TURN * MOST_TURN
        && pixel(at).distance_squared(pixel(a.midpoint(b))) <= MOST_PIXELS * MOST_PIXELS
}

#[cfg(test)]
mod tests {
    use std::f32::consts::TAU;

    use super::*;
    use crate::bounds::Bounds;
    use crate::placement::Placement;
    use crate::viewpoint::Viewpoint;

    /// The samples of a ring of radius 1 about the z axis.
    fn ring(count: [u32; 2]) -> Vec<SurfaceSample> {
        let [columns, rows] = count;
        let sample = |k: u32| {
            let (sin, cos) = (TAU * (k % columns) as f32 / (columns - 1) as f32).sin_cos();
            SurfaceSample {
                position: [cos, sin, 1e-3 * (k / columns) as f32],
                defined: 1.0,
                normal: [cos, sin, 0.0],
                padding: 0.0,
            }
        };
        (0..columns * rows).map(sample).collect()
    }

    /// A camera that looks along the z axis from this distance.
    fn camera(distance: f64) -> Camera {
        let bounds = Bounds {
            placement: Placement {
                centre: [0.0; 3],
                radius: 1.0,
            },
            half: [1.0; 3],
            cloud: Vec::new(),
            facing: None,
        };
        let viewpoint = Viewpoint::new([0.0, 0.0, distance], [0.0; 3]);
        Camera::new(&bounds, &viewpoint, [800, 600]).expect("a camera")
    }

    fn stride(count: [u32; 2], samples: Vec<SurfaceSample>, distance: f64) -> usize {
        moving_stride(&camera(distance), &Samples::Surfaces { count, samples })
    }

    #[test]
    fn a_ring_is_thinned_where_its_arcs_are_no_higher_than_a_pixel() {
        for count in [[81, 2], [80, 3], [80, 4]] {
            let height = 1.0 - (TAU / (count[0] - 1) as f32).cos();
            let farthest = f64::from(camera(9.0).pixels_per_unit() * height);
            assert_eq!(
                stride(count, ring(count), 1.02 * farthest),
                STRIDE,
                "{count:?}"
            );
            assert_eq!(stride(count, ring(count), 0.98 * farthest), 1, "{count:?}");
        }
    }

    #[test]
    fn what_light_or_a_border_shows_is_not_thinned() {
        let few = [21, 3];
        assert_eq!(stride(few, ring(few), 100.0), 1, "the light changes");
        let count = [81, 3];
        for left_out in [0, 40, 81, 122] {
            let mut samples = ring(count);
            samples[left_out].defined = 0.0;
            assert_eq!(stride(count, samples, 100.0), 1, "sample {left_out}");
        }
        let nothing = Samples::Points(Vec::new());
        assert_eq!(moving_stride(&camera(100.0), &nothing), 1);
    }
}
