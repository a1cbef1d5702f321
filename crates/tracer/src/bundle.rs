//! Rays that go nearly the same way, and the boxes that any of them may meet.
//!
//! Input: rays, and how far they reach. Output: for a box, false only if none of them meets it. All starts and all directions
//! lie between bounds; along each axis they say from which parameter on a ray may be in the box, and up to which one.

use glam::DVec3;

use crate::bounds::BoundingBox;
use crate::line::Ray;

/// Bounds of rays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayBundle {
    origins: BoundingBox,
    directions: BoundingBox,
    reach: f64,
}

/// The share of a parameter by which rounding may move it, with room to spare.
const SLACK: f64 = 1e-12;

impl RayBundle {
    /// The rays, up to the parameter `reach`; those that are not finite meet nothing.
    pub(crate) fn new(rays: impl Iterator<Item = Ray>, reach: f64) -> Self {
        let (mut origins, mut directions) = (BoundingBox::EMPTY, BoundingBox::EMPTY);
        for ray in rays {
            if ray.origin.is_finite() && ray.direction.is_finite() {
                origins.include(ray.origin);
                directions.include(ray.direction);
            }
        }
        Self {
            origins,
            directions,
            reach,
        }
    }

    /// The parameter up to which rays count.
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }

    /// The middle of the starts, and their greatest distance from it along each axis.
    pub(crate) fn origins(&self) -> [DVec3; 2] {
        self.origins.middle()
    }

    /// The middle of the directions, and their greatest distance from it along each axis.
    pub(crate) fn directions(&self) -> [DVec3; 2] {
        self.directions.middle()
    }

    /// False only if no ray meets the box from its start on.
    #[inline]
    pub(crate) fn may_meet(&self, bounds: &BoundingBox) -> bool {
        let (mut from, mut to) = (0.0, self.reach);
        for k in 0..3 {
            // At t, the coordinates lie from the least start + t times the least direction to the same of the greatest.
            let (low, high) = (self.directions.lower[k], self.directions.upper[k]);
            let above = bounds.lower[k] - self.origins.upper[k];
            let below = bounds.upper[k] - self.origins.lower[k];
            // t·high ≥ above and t·low ≤ below.
            for (slope, limit) in [(high, above), (-low, -below)] {
                let t = limit / slope;
                if slope > 0.0 {
                    from = if t > from { t } else { from };
                } else if slope < 0.0 {
                    to = if t < to { t } else { to };
                } else if limit > 0.0 {
                    return false;
                }
            }
        }
        from <= to + SLACK * (from + to.abs())
    }
}
