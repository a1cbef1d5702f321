//! Error indicators between the rays of a fan, from the rays themselves. In: neighbouring sectors. Out: errors.
//!
//! Between two rays the end is a cubic in the angle. With the rays beyond them the polynomial has a degree of up to
//! seven, and the terms it adds to the cubic estimate the cubic's error: Newton's form with double nodes, from the fourth
//! divided difference on (Stoer, Bulirsch, *Introduction to Numerical Analysis*, sections 2.1.3 and 2.1.5).

use super::cell;
use super::ray::{Ray, Sample};
use super::sectors::{BINS, Sector};
use crate::chart::ChartLayout;

/// A neighbour is used if its width differs by at most this factor: a much narrower sector is next to the feature that
/// made it narrow.
const ALIKE: f64 = 2.5;
/// Errors are evaluated in every `STRIDE`-th range of radius.
const STRIDE: usize = 2;
/// Fractions of the way between the two rays: of the largest even error, and of the largest odd ones.
const SHARES: [f64; 3] = [0.276, 0.5, 0.724];

/// A ray at an arc length, relative to a sector's first ray: its angle in widths of the sector, its end and the end's
/// derivative by that angle.
#[derive(Clone, Copy, Debug)]
struct SupportPoint {
    x: f64,
    value: [f64; 2],
    slope: [f64; 2],
}

/// Returns the largest visible errors of each sector, in pixels; 0 where nothing is known. The sectors are in the order
/// of their angles, all around.
pub(super) fn between(
    layout: &ChartLayout,
    rays: &[Ray],
    sectors: &[&Sector],
    reach: f64,
    pixel: f64,
) -> Vec<f64> {
    let mut errors = vec![0.0_f64; sectors.len()];
    for range in (STRIDE / 2..BINS).step_by(STRIDE) {
        let s = reach * (range as f64 + 0.5) / BINS as f64;
        let known = |sector: &Sector| s < sector.border.min(sector.unknown_from);
        let ends: Vec<Option<(Sample, Sample)>> = sectors
            .iter()
            .map(|sector| {
                let pair = sector.rays.map(|ray| &rays[ray]);
                known(sector).then(|| cell::pair(layout, pair, sector.width, s))?
            })
            .collect();
        for n in 0..sectors.len() {
            let (Some((_, b)), Some(points)) = (ends[n], support(sectors, &ends, n)) else {
                continue;
            };
            let area = cell::determinant(b.along, b.normal);
            let share = f64::from(sectors[n].seen[0][range]);
            for off in added(&points) {
                let (x, y) = (
                    cell::determinant(off, b.normal),
                    cell::determinant(b.along, off),
                );
                let length = (x * x + y * y).sqrt() / area.abs();
                // (NaN is ignored by `max`.)
                errors[n] = errors[n].max(share * length / pixel);
            }
        }
    }
    errors
}

/// Returns a sector's two rays and those beyond them that are known in the same coordinates; `ends` are both rays of each
/// sector.
fn support(
    sectors: &[&Sector],
    ends: &[Option<(Sample, Sample)>],
    n: usize,
) -> Option<Vec<SupportPoint>> {
    let (a, b) = ends[n]?;
    let width = sectors[n].width;
    let point = |x: f64, from: [f64; 2], sample: &Sample, origin: &Sample| SupportPoint {
        x,
        value: [0, 1].map(|k| from[k] + sample.at[k] - origin.at[k]),
        slope: sample.jacobi[0].map(|slope| slope * width),
    };
    let beside = |m: usize| {
        let other = sectors[m].width;
        let (c, d) = ends[m]?;
        let alike = other < ALIKE * width && width < ALIKE * other && c.chart.is_same(&a.chart);
        alike.then_some((other / width, c, d))
    };
    let last = point(1.0, [0.0; 2], &b, &a);
    let mut points = vec![point(0.0, [0.0; 2], &a, &a), last];
    if let Some((w, c, d)) = beside((n + sectors.len() - 1) % sectors.len()) {
        points.push(point(-w, [0.0; 2], &c, &d));
    }
    if let Some((w, c, d)) = beside((n + 1) % sectors.len()) {
        points.push(point(1.0 + w, last.value, &d, &c));
    }
    Some(points)
}

/// Returns the terms that the points after the first two add to the cubic through these, at [`SHARES`] of the way
/// between them.
fn added(points: &[SupportPoint]) -> [[f64; 2]; 3] {
    let count = 2 * points.len();
    let mut table = [[0.0; 2]; 8];
    let x = |n: usize| points[n / 2].x;
    for (n, row) in table[..count].iter_mut().enumerate() {
        *row = points[n / 2].value;
    }
    for order in 1..count {
        for n in (order..count).rev() {
            table[n] = if order == 1 && n % 2 == 1 {
                points[n / 2].slope
            } else {
                let by = x(n) - x(n - order);
                [0, 1].map(|k| (table[n][k] - table[n - 1][k]) / by)
            };
        }
    }
    SHARES.map(|t| {
        let mut factor = 1.0;
        let mut sum = [0.0; 2];
        for (n, difference) in table[..count].iter().enumerate() {
            if n >= 4 {
                sum = [0, 1].map(|k| sum[k] + factor * difference[k]);
            }
            factor *= t - x(n);
        }
        sum
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A polynomial and its derivative, coefficients from the constant on.
    fn point(x: f64, coefficients: &[f64]) -> SupportPoint {
        let (mut value, mut slope) = (0.0, 0.0);
        for c in coefficients.iter().rev() {
            slope = slope * x + value;
            value = value * x + c;
        }
        SupportPoint {
            x,
            value: [value, -2.0 * value],
            slope: [slope, -2.0 * slope],
        }
    }

    #[test]
    fn the_rays_beyond_add_the_error_of_the_cubic() {
        let septic = [0.3, -1.0, 0.5, 2.0, -0.7, 0.9, 0.2, -0.4];
        let places = [0.0, 1.0, -1.7, 1.6];
        for (count, degree) in [(2, 3), (3, 5), (4, 7)] {
            let polynomial = &septic[..=degree];
            let points: Vec<SupportPoint> = (places[..count].iter())
                .map(|x| point(*x, polynomial))
                .collect();
            let [a, b] = [points[0], points[1]];
            for (t, added) in SHARES.into_iter().zip(added(&points)) {
                let cubic = crate::interpolate::cubic(
                    t,
                    1.0,
                    [a.value[0], a.slope[0]],
                    [b.value[0], b.slope[0]],
                );
                let error = point(t, polynomial).value[0] - cubic;
                assert!(
                    (added[0] - error).abs() < 1e-13,
                    "{count} at {t}: {added:?}"
                );
                assert!((added[1] + 2.0 * error).abs() < 1e-13, "{added:?}");
            }
        }
    }
}
