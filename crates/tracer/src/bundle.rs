//! Rays that go nearly the same way, and the boxes that any of them may meet.
//!
//! Input: rays, and how far they reach. Output: for a box, false only if none of them meets it. All starts and all directions
//! lie between bounds; along each axis they say from which parameter on a ray may be in the box, and up to which one.

use expr::processor::Processor;
use expr::vectors::{Instructions, Lanes, MOST_LANES, Mask, Vector, VectorWork};
use glam::DVec3;

use crate::bounds::BoundingBox;
use crate::line::{Ray, SurfaceId};

/// Rays that are read together, coordinate by coordinate.
#[derive(Clone, Debug, Default)]
pub(crate) struct RayBlocks {
    /// Coordinates of the starts, then of the directions. What is behind the last ray in its block repeats the first one
    /// there; what is in blocks behind it was there before.
    blocks: Vec<RayBlock>,
    count: usize,
    /// The surface that all of them leave.
    pub(crate) leaving: Option<SurfaceId>,
}

/// The coordinates of as many rays as the widest vectors have lanes.
pub(crate) type RayBlock = [[f64; MOST_LANES]; 6];

impl RayBlocks {
    /// Begins with no rays.
    pub(crate) fn begin(&mut self, leaving: Option<SurfaceId>) {
        self.count = 0;
        self.leaving = leaving;
    }

    /// Adds a ray.
    #[inline]
    pub(crate) fn push(&mut self, origin: DVec3, direction: DVec3) {
        let (o, d) = (origin, direction);
        let lane = self.count % MOST_LANES;
        let [x, y, z, dx, dy, dz] = self.last_block();
        if lane == 0 {
            (*x, *y, *z) = ([o.x; MOST_LANES], [o.y; MOST_LANES], [o.z; MOST_LANES]);
            (*dx, *dy, *dz) = ([d.x; MOST_LANES], [d.y; MOST_LANES], [d.z; MOST_LANES]);
        } else {
            (x[lane], y[lane], z[lane]) = (o.x, o.y, o.z);
            (dx[lane], dy[lane], dz[lane]) = (d.x, d.y, d.z);
        }
        self.count += 1;
    }

    /// Adds a block of rays, of which the lanes without one repeat another, to whole blocks.
    #[inline]
    pub(crate) fn push_block(
        &mut self,
        origins: &[[f64; MOST_LANES]; 3],
        directions: &[[f64; MOST_LANES]; 3],
        lanes: Lanes,
    ) {
        let first = lanes.each().next().unwrap_or(0);
        let from = origins.iter().chain(directions);
        for (numbers, from) in self.last_block().iter_mut().zip(from) {
            for lane in 0..MOST_LANES {
                numbers[lane] = if lanes.has(lane) {
                    from[lane]
                } else {
                    from[first]
                };
            }
        }
        self.count += MOST_LANES;
    }

    /// The block of the ray that comes next.
    #[inline]
    fn last_block(&mut self) -> &mut RayBlock {
        let index = self.count / MOST_LANES;
        if index == self.blocks.len() {
            self.blocks.push([[0.0; MOST_LANES]; 6]);
        }
        &mut self.blocks[index]
    }

    /// The number of rays.
    pub(crate) fn len(&self) -> usize {
        self.count
    }

    /// All blocks.
    pub(crate) fn blocks(&self) -> &[RayBlock] {
        &self.blocks[..self.count.div_ceil(MOST_LANES)]
    }

    /// The ray with this index.
    #[inline]
    pub(crate) fn ray(&self, index: usize) -> Ray {
        let (block, lane) = (&self.blocks[index / MOST_LANES], index % MOST_LANES);
        let at = |k: usize| block[k][lane];
        Ray {
            origin: DVec3::new(at(0), at(1), at(2)),
            direction: DVec3::new(at(3), at(4), at(5)),
            leaving: self.leaving,
        }
    }

    /// The rays.
    pub(crate) fn iter(&self) -> impl Iterator<Item = Ray> + Clone {
        (0..self.count).map(|index| self.ray(index))
    }
}

/// The least and the greatest of each coordinate, and false where one of them is not finite.
struct Ranges<'a>(&'a [RayBlock]);

impl VectorWork for Ranges<'_> {
    type Output = ([[f64; 2]; 6], bool);

    #[inline(always)]
    fn run<S: Instructions>(self, s: S) -> Self::Output {
        let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 6];
        let mut are_finite = Mask::splat(s, true);
        for (k, range) in ranges.iter_mut().enumerate() {
            let mut least = Vector::splat(s, range[0]);
            let mut greatest = Vector::splat(s, range[1]);
            for block in self.0 {
                for part in 0..Vector::<S>::PARTS {
                    let x = Vector::load(s, &block[k], part);
                    least = x.least(least);
                    greatest = x.greatest(greatest);
                    are_finite = are_finite & x.is_finite();
                }
            }
            *range = [least.least_lane(), greatest.greatest_lane()];
        }
        (ranges, !(!are_finite).any())
    }
}

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
    pub(crate) fn new(processor: Processor, rays: &RayBlocks, reach: f64) -> Self {
        let (ranges, are_finite) = processor.run_vectors(Ranges(rays.blocks()));
        let [x, y, z, dx, dy, dz] = ranges;
        let (mut origins, mut directions) = (
            BoundingBox::of_ranges([x, y, z]),
            BoundingBox::of_ranges([dx, dy, dz]),
        );
        if !are_finite {
            (origins, directions) = (BoundingBox::EMPTY, BoundingBox::EMPTY);
            for ray in rays.iter() {
                if ray.origin.is_finite() && ray.direction.is_finite() {
                    origins.include(ray.origin);
                    directions.include(ray.direction);
                }
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
