//! Indicators of the errors between the rays of a fan, from the rays themselves: neighbouring sectors in, errors out.
//!
//! Between two rays the end is a cubic in the angle, whose third derivative is a constant. From one sector to the next it
//! jumps, by the fourth derivative of the true end times the distance of the sectors' middles; and that derivative makes
//! the cubic's error, w⁴/384 times it in the middle of a sector of the width w: the remainder of Hermite's interpolation,
//! f⁗/4! (w/2)⁴ (Stoer, Bulirsch, *Introduction to Numerical Analysis*, section 2.1.5).

use super::cell;
use super::ray::Ray;
use super::sectors::{BINS, Sector};
use crate::chart::ChartLayout;
use crate::ends::Coordinates;

/// Sectors are compared whose widths differ by no more than this factor: beside a much narrower one lies what made that
/// one narrow.
const ALIKE: f64 = 2.5;
/// In how many ranges of radius each.
const STRIDE: usize = 2;

/// The third derivatives by the angle of a sector's cubic.
#[derive(Clone, Copy, Debug)]
struct Third {
    kind: Coordinates,
    value: [f64; 2],
    /// The unit tangent and normal of its second ray.
    axes: [[f64; 2]; 2],
}

/// The largest errors that the picture shows of each sector, in pixels; 0 where nothing is known. The sectors are
/// given in the order of their angles, all around.
pub(super) fn between(
    layout: &ChartLayout,
    rays: &[Ray],
    sectors: &[&Sector],
    reach: f64,
    pixel: f64,
) -> Vec<f64> {
    let third = |sector: &Sector, s: f64| {
        let pair = sector.rays.map(|ray| &rays[ray]);
        let (a, b) = cell::pair(layout, pair, sector.width, s)?;
        let w = sector.width;
        let value = [0, 1].map(|k| {
            let (chord, slopes) = (a.at[k] - b.at[k], a.jacobi[0][k] + b.jacobi[0][k]);
            (12.0 * chord / w + 6.0 * slopes) / (w * w)
        });
        Some(Third {
            kind: b.chart.kind,
            value,
            axes: [b.along, b.normal],
        })
    };
    let mut errors = vec![0.0_f64; sectors.len()];
    for range in (STRIDE / 2..BINS).step_by(STRIDE) {
        let s = reach * (range as f64 + 0.5) / BINS as f64;
        let known = |sector: &Sector| s < sector.border.min(sector.unknown_from);
        let thirds: Vec<Option<Third>> = sectors
            .iter()
            .map(|sector| known(sector).then(|| third(sector, s))?)
            .collect();
        for (n, a) in thirds.iter().enumerate() {
            let next = (n + 1) % sectors.len();
            let (Some(a), Some(b)) = (a, &thirds[next]) else {
                continue;
            };
            let [v, w] = [n, next].map(|n| sectors[n].width);
            if a.kind != b.kind || v > ALIKE * w || w > ALIKE * v {
                continue;
            }
            let jump = [0, 1].map(|k| b.value[k] - a.value[k]);
            let [along, normal] = a.axes;
            let area = cell::determinant(along, normal);
            let (x, y) = (
                cell::determinant(jump, normal),
                cell::determinant(along, jump),
            );
            let fourth = (x * x + y * y).sqrt() / area.abs() / (0.5 * (v + w)) / pixel;
            for (m, width) in [(n, v), (next, w)] {
                let share = f64::from(sectors[m].seen[0][range]);
                // (A NaN is no larger.)
                errors[m] = errors[m].max(share * fourth * width.powi(4) / 384.0);
            }
        }
    }
    errors
}
