//! A cell of a parametric surface, near a parallelogram.
//!
//! Input: σ on a cell, as values near a linear function of u and v. Output: for a ray, whether it may meet the cell. With the
//! parallelogram c + x·a + y·b, x and y from −1 to 1, and an error e, a ray o + t·d passes the cell by if an axis n across d
//! separates them: |n·(o − c)| > |n·a| + |n·b| + |n|·e. The axes a×d and b×d are those of the parallelogram's sides.

use std::sync::OnceLock;

use expr::interval::{Affine, Interval};
use glam::DVec3;

use crate::bounds::BoundingBox;
use crate::sheet::slopes::{CellSlopes, MARGIN, ROUNDING, SheetRay};

/// The error of a cell that is due to rounding is at most so many times that of a sum.
const MOST_ROUNDED: f64 = 64.0;

/// A part of the rectangle.
#[derive(Debug)]
pub(super) struct Cell {
    pub(super) sides: [[f64; 2]; 2],
    /// The box of its image, empty if σ is undefined on it.
    pub(super) bounds: BoundingBox,
    plane: Option<CellPlane>,
    /// The number of times that it has been halved for rays.
    pub(super) depth: u32,
    /// The slopes, once a ray has asked for them.
    pub(super) slopes: OnceLock<Option<Box<CellSlopes>>>,
    /// The halves, once a ray has asked for them; `None` if they are not kept.
    pub(super) halves: OnceLock<Option<Box<[Cell; 2]>>>,
}

/// A parallelogram that the image of a cell is near.
#[derive(Clone, Copy, Debug)]
struct CellPlane {
    centre: DVec3,
    sides: [DVec3; 2],
    /// The most by which a place is off.
    error: DVec3,
}

/// The place of a cell's parallelogram that a ray meets.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Meeting {
    /// From −1 to 1 along each side.
    shares: [f64; 2],
    /// The changes of the shares, as products with a shift of the ray.
    steps: [DVec3; 2],
    /// For each side, true if it is shorter than the rounding of the way to it: a ray cannot tell its halves apart.
    pub(super) is_short: [bool; 2],
}

/// The place of a cell that is nearest to one outside of it.
pub(super) struct CellEdge {
    pub(super) at: [f64; 2],
    /// For u and v: 1 where that is beyond the cell's greatest, −1 where it is below its least, else 0.
    pub(super) beyond: [f64; 2],
}

impl Cell {
    /// The cell between these sides, on which σ is this.
    pub(super) fn new(sides: [[f64; 2]; 2], place: &[Affine; 3], depth: u32) -> Self {
        let sound = place
            .iter()
            .all(|it| it.error().is_finite() && !it.value().is_partial());
        let vector =
            |of: &dyn Fn(&Affine) -> f64| DVec3::from_array([0, 1, 2].map(|k| of(&place[k])));
        Self {
            sides,
            bounds: around(&place.map(|it| it.value())),
            plane: sound.then(|| CellPlane {
                centre: vector(&|it| it.middle()),
                sides: [0, 1].map(|k| vector(&|it| it.slopes()[k])),
                error: vector(&|it| it.error()),
            }),
            depth,
            slopes: OnceLock::new(),
            halves: OnceLock::new(),
        }
    }

    /// The place of the cell near which a ray may meet it with t up to `reach`; `None` if it passes it by.
    #[inline]
    pub(super) fn meeting(&self, ray: &SheetRay, reach: f64) -> Option<Meeting> {
        if let Some(plane) = &self.plane {
            return plane.meeting(ray, reach);
        }
        let [near, _] = self.bounds.met(ray.origin, ray.reciprocal)?;
        (!self.bounds.is_empty() && near < reach).then(Meeting::default)
    }

    /// The parameters near which a ray may meet the cell.
    #[inline]
    pub(super) fn start(&self, slopes: &CellSlopes, meeting: &Meeting) -> [f64; 2] {
        let [x, y] = meeting.shares;
        let bend = slopes.bend([x, y]);
        let shares = [0, 1].map(|k| meeting.shares[k] - meeting.steps[k].dot(bend));
        [0, 1].map(|k| {
            let [a, b] = self.sides[k];
            0.5 * (a + b) + 0.5 * (b - a) * shares[k].clamp(-1.0, 1.0)
        })
    }

    /// The place of the cell that is nearest to one outside of it.
    pub(super) fn edge(&self, uv: [f64; 2]) -> CellEdge {
        let beyond = [0, 1].map(|k| {
            let [a, b] = self.sides[k];
            f64::from(u8::from(uv[k] > b)) - f64::from(u8::from(uv[k] < a))
        });
        let at = [0, 1].map(|k| uv[k].clamp(self.sides[k][0], self.sides[k][1]));
        CellEdge { at, beyond }
    }

    /// True if the parameters lie in the cell, or on its edge.
    pub(super) fn contains(&self, uv: [f64; 2]) -> bool {
        self.sides.iter().zip(uv).all(|(&[a, b], x)| {
            let margin = MARGIN * (b - a);
            a - margin <= x && x <= b + margin
        })
    }

    /// The side along which the image is longer; `None` where the error hides that.
    pub(super) fn longer(&self) -> Option<usize> {
        let plane = self.plane.as_ref()?;
        let [u, v] = plane.sides.map(|side| side.length_squared());
        (u != v && u.max(v) > plane.error.length_squared()).then(|| usize::from(v > u))
    }

    /// The sides of the halves.
    pub(super) fn halves_along(&self, side: usize) -> [[[f64; 2]; 2]; 2] {
        let [a, b] = self.sides[side];
        let middle = 0.5 * (a + b);
        [[a, middle], [middle, b]].map(|half| {
            let mut sides = self.sides;
            sides[side] = half;
            sides
        })
    }
}

impl CellPlane {
    #[inline]
    fn meeting(&self, ray: &SheetRay, reach: f64) -> Option<Meeting> {
        let Self {
            centre,
            sides: [a, b],
            error,
        } = *self;
        let direction = ray.direction;
        let offset = ray.origin - centre;
        let size = offset.abs();
        let rounding = ROUNDING * (ray.origin.abs() + centre.abs() + size);
        let own = error;
        let error = own + rounding;
        // Where the axis and the products with it have been rounded.
        let rounded = ROUNDING * size.element_sum() * ray.sum;
        // Along the ray.
        let along = -offset.dot(direction);
        let half = a.dot(direction).abs() + b.dot(direction).abs() + error.dot(ray.sizes);
        let half = (1.0 + MARGIN) * half + rounded;
        if along + half < 0.0 || along - half > reach * ray.square() {
            return None;
        }
        let [p, q] = [b.cross(direction), a.cross(direction)];
        let area = a.dot(p);
        let limit = (1.0 + MARGIN) * area.abs();
        let [x, y] = [offset.dot(p), -offset.dot(q)];
        let [sum_a, sum_b] = [a, b].map(|side| side.abs().element_sum());
        if x.abs() > limit + (1.0 + MARGIN) * p.abs().dot(error) + rounded * sum_b
            || y.abs() > limit + (1.0 + MARGIN) * q.abs().dot(error) + rounded * sum_a
        {
            return None;
        }
        // The axis through the centre of the parallelogram. Where the ray passes near that, the first difference is mostly
        // rounding, and not across the ray.
        let across = offset + (along / ray.square()) * direction;
        let across = across - (across.dot(direction) / ray.square()) * direction;
        let reached = across.dot(a).abs() + across.dot(b).abs() + across.abs().dot(error);
        if across.dot(offset)
            > (1.0 + MARGIN) * reached + ROUNDING * size.element_sum() * across.abs().element_sum()
        {
            return None;
        }
        let [own, least] = [own, rounding].map(DVec3::element_sum);
        let is_short = [sum_a, sum_b].map(|sum| sum <= least && own <= MOST_ROUNDED * least);
        if area == 0.0 {
            return Some(Meeting {
                is_short,
                ..Meeting::default()
            });
        }
        Some(Meeting {
            is_short,
            shares: [x, y].map(|x| (x / area).clamp(-1.0, 1.0)),
            steps: [p / area, -q / area],
        })
    }
}

/// The box of three sides, empty if one of them is. It is larger than they are: where a surface closes, as at the angles 0 and
/// 2π, the rounding of the angle leaves a gap that no ray may pass.
fn around(sides: &[Interval; 3]) -> BoundingBox {
    if sides.iter().any(|side| side.is_empty()) {
        return BoundingBox::EMPTY;
    }
    BoundingBox::of_ranges(sides.map(|side| {
        let [lower, upper] = [side.lower(), side.upper()];
        let room = MARGIN * (upper - lower) + ROUNDING * lower.abs().max(upper.abs());
        if room.is_finite() {
            [lower - room, upper + room]
        } else {
            [lower, upper]
        }
    }))
}
