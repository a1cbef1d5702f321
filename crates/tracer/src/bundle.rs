//! Bundles of rays with similar directions, and the boxes that any of their rays may meet.
//!
//! In: rays and the parameter that they reach. Out: for a box, false only if no ray meets it. The bounds of all starts and
//! all directions give, for each axis, the interval of parameters in which a ray may be inside the box.

use expr::processor::Processor;
use expr::vectors::{Instructions, Lanes, MOST_LANES, Mask, Vector, VectorWork};
use glam::DVec3;

use crate::bounds::BoundingBox;
use crate::line::{Ray, SurfaceId};

/// The rays of a bundle, coordinate by coordinate.
#[derive(Clone, Debug, Default)]
pub(crate) struct RayBlocks {
    /// The coordinates of the starts, then of the directions. In the last block, the lanes behind the last ray repeat the
    /// block's first ray; blocks after it are left over from earlier bundles.
    blocks: Vec<RayBlock>,
    count: usize,
    /// The surface that all rays leave.
    pub(crate) leaving: Option<SurfaceId>,
}

/// The coordinates of one ray for each lane of the widest vectors.
pub(crate) type RayBlock = [[f64; MOST_LANES]; 6];

impl RayBlocks {
    /// Clears the rays.
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

    /// Adds a block of rays; its unused lanes repeat another ray. All blocks before it must be full.
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

    /// Returns the block that receives the next ray.
    #[inline]
    fn last_block(&mut self) -> &mut RayBlock {
        let index = self.count / MOST_LANES;
        if index == self.blocks.len() {
            self.blocks.push([[0.0; MOST_LANES]; 6]);
        }
        &mut self.blocks[index]
    }

    /// Returns the number of rays.
    pub(crate) fn len(&self) -> usize {
        self.count
    }

    /// Returns all blocks.
    pub(crate) fn blocks(&self) -> &[RayBlock] {
        &self.blocks[..self.count.div_ceil(MOST_LANES)]
    }

    /// Returns the ray with this index.
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

    /// Returns an iterator over the rays.
    pub(crate) fn iter(&self) -> impl Iterator<Item = Ray> + Clone {
        (0..self.count).map(|index| self.ray(index))
    }
}

/// The smallest and the largest value of each coordinate, and false for a coordinate that is not finite.
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

/// The relative error of a parameter due to rounding, with a margin.
const SLACK: f64 = 1e-12;

impl RayBundle {
    /// Returns the bounds of the rays up to the parameter `reach`; if they are not finite, the rays meet nothing.
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

    /// Returns the parameter up to which rays are followed.
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }

    /// Returns the centre of the starts, and their maximum distance from it along each axis.
    pub(crate) fn origins(&self) -> [DVec3; 2] {
        self.origins.middle()
    }

    /// Returns the centre of the directions, and their maximum distance from it along each axis.
    pub(crate) fn directions(&self) -> [DVec3; 2] {
        self.directions.middle()
    }

    /// Returns false only if no ray meets the box from its start on.
    #[inline]
    pub(crate) fn may_meet(&self, bounds: &BoundingBox) -> bool {
        let (mut from, mut to) = (0.0, self.reach);
        for k in 0..3 {
            // At t, the coordinates are between the smallest start + t times the smallest direction and the same of the
            // largest.
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
