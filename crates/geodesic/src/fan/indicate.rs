//! What the rays of a fan say by themselves about the errors between them: neighbouring sectors in, errors out.
//!
//! Between two rays the end is a cubic in the angle, whose third derivative is a constant. From one sector to the next it
//! jumps, by the fourth derivative of the true end times the distance of the sectors' middles; and that derivative makes
//! the cubic's error, w⁴/384 times it in the middle of a sector of the width w.

use super::cell;
use super::coordinates::{Kind, Space};
use super::ray::Ray;
use super::sectors::{BINS, Profile, Sector};

/// Sectors are compared whose widths differ by no more than this factor: beside a much narrower one lies what made that
/// one narrow.
const ALIKE: f64 = 2.5;

/// The third derivatives by the angle of the cubics of a sector, at the middle of each range of radius, with their
/// lengths' measure; NaN where there is none.
#[derive(Clone, Copy, Debug)]
struct Third {
    kind: Kind,
    value: [f64; 2],
    /// Unit tangent and normal.
    axes: [[f64; 2]; 2],
}

/// The errors in the middle of each sector, in pixels, of sectors in the order of their angles, all around; 0 where
/// nothing can be told.
pub(super) fn between(
    space: &Space,
    rays: &[Ray],
    sectors: &[&Sector],
    reach: f64,
    pixel: f64,
) -> Vec<Profile> {
    let radius = |n: usize| reach * (n as f64 + 0.5) / BINS as f64;
    let thirds: Vec<[Option<Third>; BINS]> = sectors
        .iter()
        .map(|sector| {
            let pair = sector.rays.map(|ray| &rays[ray]);
            std::array::from_fn(|n| {
                let s = radius(n);
                if s > sector.border || s > sector.unknown_from {
                    return None;
                }
                let (a, b) = cell::pair(space, pair, sector.width, s)?;
                let w = sector.width;
                let value = [0, 1].map(|k| {
                    (12.0 * (a.at[k] - b.at[k]) / w + 6.0 * (a.jacobi[0][k] + b.jacobi[0][k]))
                        / (w * w)
                });
                Some(Third {
                    kind: a.chart.kind,
                    value,
                    axes: [a.along, a.normal],
                })
            })
        })
        .collect();
    let mut errors = vec![[0.0_f32; BINS]; sectors.len()];
    for n in 0..sectors.len() {
        let next = (n + 1) % sectors.len();
        let [v, w] = [n, next].map(|n| sectors[n].width);
        for k in 0..BINS {
            let (Some(a), Some(b)) = (&thirds[n][k], &thirds[next][k]) else {
                continue;
            };
            if a.kind != b.kind {
                continue;
            }
            let jump = [0, 1].map(|k| b.value[k] - a.value[k]);
            let [along, normal] = b.axes;
            let area = cell::determinant(along, normal);
            let length =
                cell::determinant(jump, normal).hypot(cell::determinant(along, jump)) / area.abs();
            let fourth = length / (0.5 * (v + w)) / pixel;
            for (m, width, other) in [(n, v, w), (next, w, v)] {
                if other > ALIKE * width || width > ALIKE * other {
                    continue;
                }
                let error = (fourth * width.powi(4) / 384.0) as f32;
                // (A NaN is no larger.)
                if error > errors[m][k] {
                    errors[m][k] = error;
                }
            }
        }
    }
    errors
}
