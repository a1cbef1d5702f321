//! Typical lengths of a surface, measured on a sample of its points: tolerances are relative to them.

use crate::jet::Jet;
use crate::point::Uv;
use crate::vector::norm;

/// Typical lengths of a surface, relative to which others are small. All finite and positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// The extent in space of a sample of its points.
    pub size: f64,
    /// The median of |σu| and of |σv| over the sample.
    pub stretch: [f64; 2],
}

impl Scale {
    /// Measures on a lattice of interior points; undefined points are ignored.
    pub fn measure(jet: &dyn Fn(Uv) -> Jet, domain: [[f64; 2]; 2]) -> Self {
        const LATTICE: u32 = 5;
        let mut positions: Vec<[f64; 3]> = Vec::new();
        let mut stretches: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
        for i in 0..LATTICE {
            for j in 0..LATTICE {
                // Asymmetric, so that no special line of the surface is favoured.
                let share = [
                    (f64::from(i) + 0.43) / f64::from(LATTICE),
                    (f64::from(j) + 0.61) / f64::from(LATTICE),
                ];
                let at = jet(at(domain, share));
                if at.position.iter().all(|x| x.is_finite()) {
                    positions.push(at.position);
                }
                for (stretch, d) in stretches.iter_mut().zip([at.du, at.dv]) {
                    let length = norm(d);
                    if length.is_finite() && length > 0.0 {
                        stretch.push(length);
                    }
                }
            }
        }
        let extent = (0..3).map(|k| {
            let (low, high) = positions
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
                    (low.min(p[k]), high.max(p[k]))
                });
            high - low
        });
        let size = extent.fold(0.0, f64::max);
        let median = |values: &mut Vec<f64>| {
            values.sort_unstable_by(f64::total_cmp);
            values.get(values.len() / 2).copied().unwrap_or(1.0)
        };
        let [us, vs] = &mut stretches;
        Self {
            size: if size > 0.0 && size.is_finite() {
                size
            } else {
                1.0
            },
            stretch: [median(us), median(vs)],
        }
    }
}

/// Returns the point of the domain at these fractions of its widths.
pub(crate) fn at(domain: [[f64; 2]; 2], share: [f64; 2]) -> Uv {
    Uv([0, 1].map(|k| {
        let [low, high] = domain[k];
        // The ends must be exact.
        if share[k] == 1.0 {
            high
        } else {
            low + share[k] * (high - low)
        }
    }))
}
