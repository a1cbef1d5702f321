//! The ends of geodesics as a function of the pixel: every method computes them, and every picture is made from them.
//!
//! An end has two coordinates in a chart, or three where geodesics run on a surface in space that has no chart:
//! everything that interpolates ends is generic over their number.

use std::array::from_fn;

use crate::point::PicturePoint;
use crate::status::Status;

/// The coordinates of an [`End`].
#[derive(Clone, Copy, Debug, Default, Eq, Ord, PartialEq, PartialOrd)]
pub enum Coordinates {
    /// (u, v), continued beyond sides that wrap: neighbouring pixels have nearby coordinates, whatever side is between
    /// them. A picture brings them back into the domain.
    #[default]
    Plain,
    /// (a, b) = r (cos kt, sin kt) about the apex at one end of `axis`, where r is the distance in the parameter (to
    /// the power 1/[`power`](crate::topology::Apex::power)), t the other parameter less its minimum, and k the apex's
    /// [`rate`](crate::topology::Apex::rate).
    Apex {
        /// 0 for u, 1 for v.
        axis: u8,
        /// 0 for the minimum, 1 for the maximum.
        end: u8,
    },
}

/// The end of the geodesic of one point of the picture, with `N` coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End<const N: usize = 2> {
    /// The coordinates of `at`.
    pub coordinates: Coordinates,
    /// The geodesic's end point.
    pub at: [f64; N],
    /// The ray's unit tangent there, in these coordinates.
    pub along: [f64; N],
    /// The unit normal to it, on the side where the frame's Y is relative to X at the start.
    pub across: [f64; N],
    /// m/s, the Jacobi field over the arc length (1 at the centre): the surface is seen at its own scale along the ray, and
    /// at this scale across it; negative behind a conjugate point. NaN where unknown.
    pub stretch: f64,
    /// The reason why the geodesic ended. The fields above are meaningful for [`Status::Complete`], and, where `at` is
    /// finite, for [`Status::LeftDomain`]: then they describe the geodesic as if the surface continued.
    pub status: Status,
    /// The estimated error in pixels.
    pub error: f64,
}

impl<const N: usize> End<N> {
    /// Returns ∂at/∂x and ∂at/∂y at a point of the picture whose unit has length `zoom` on the surface.
    pub fn by_place(&self, place: impl Into<PicturePoint>, zoom: f64) -> [[f64; N]; 2] {
        let PicturePoint(place) = place.into();
        let radius = (place[0] * place[0] + place[1] * place[1]).sqrt();
        let [cos, sin] = if radius > 0.0 {
            place.map(|x| x / radius)
        } else {
            [1.0, 0.0]
        };
        let (along, across) = (self.along, self.across);
        let m = self.stretch;
        [
            from_fn(|k| zoom * (along[k] * cos - m * across[k] * sin)),
            from_fn(|k| zoom * (along[k] * sin + m * across[k] * cos)),
        ]
    }

    /// Returns the length on the surface of a small difference in the coordinates: in a chart by its components along
    /// the unit tangent and normal, in space its Euclidean length.
    pub fn length(&self, difference: [f64; N]) -> f64 {
        match (&self.along[..], &self.across[..], &difference[..]) {
            (&[a, b], &[c, d], &[x, y]) => {
                let determinant = a * d - b * c;
                ((x * d - y * c) / determinant).hypot((a * y - b * x) / determinant)
            }
            _ => difference.iter().map(|x| x * x).sum::<f64>().sqrt(),
        }
    }
}

/// The change of the coordinates about an apex, (a, b) = r (cos kt, sin kt), to (u,v): the parameter along the axis is
/// `base` + `sign` r^`power`, the other one `low` + t, where t = angle/`rate`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Polar {
    /// The parameter at the apex.
    pub base: f64,
    /// +1 where the domain is above `base`, −1 where below.
    pub sign: f64,
    /// The value of the other parameter along the a-axis.
    pub low: f64,
    /// k.
    pub rate: f64,
    /// 1, 2 or ½.
    pub power: f64,
}

/// The exponential map of a camera, by any method.
pub trait Ends<const N: usize = 2>: Sync {
    /// Returns the end of the geodesic of a point (x, y) of the picture, in coordinates of the method's choice.
    fn end(&self, place: PicturePoint) -> End<N>;
    /// Appends the ends of several points: equal to [`Ends::end`] of each, at lower cost.
    fn ends(&self, places: &[PicturePoint], out: &mut Vec<End<N>>) {
        out.extend(places.iter().map(|place| self.end(*place)));
    }
    /// The camera's zoom: the length on the surface of the picture's unit.
    fn zoom(&self) -> f64;
    /// The camera's position, in the plain coordinates.
    fn origin(&self) -> [f64; N];
    /// Converts an end to other coordinates, for a common polynomial with its neighbours; `None` where those are
    /// unsuitable.
    fn in_coordinates(&self, end: &End<N>, coordinates: Coordinates) -> Option<End<N>> {
        (end.coordinates == coordinates).then_some(*end)
    }
    /// The periods by which an end may differ from its neighbour, behind a pole: 0 for an axis without one.
    fn periods(&self) -> [f64; N] {
        [0.0; N]
    }
    /// The minimum and maximum of each coordinate, such as `[[u min, u max], [v min, v max]]`: a geodesic whose end would
    /// be beyond them has left the domain. Infinite where there is no edge.
    fn bounds(&self) -> [[f64; 2]; N] {
        [[f64::NEG_INFINITY, f64::INFINITY]; N]
    }
    /// The coordinates about the apex at an end of an axis, if any end may use them.
    fn polar(&self, axis: u8, end: u8) -> Option<Polar> {
        let _ = (axis, end);
        None
    }
}

/// The work spent on a picture.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct GeodesicWork {
    /// Rays of a fan.
    pub rays: u64,
    /// Accepted steps of all rays.
    pub steps: u64,
    /// Rejected steps.
    pub rejected: u64,
    /// Evaluations of the surface and its derivatives for any purpose; each point of a block counts.
    pub evaluations: u64,
    /// Pixels whose geodesics were integrated one by one.
    pub followed: u64,
}

/// The estimated errors of a picture, in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// The largest error.
    pub max: f64,
    /// The error that 99 % of the pixels do not exceed.
    pub p99: f64,
}

impl Estimate {
    /// Combines this estimate with one of independent errors: neither do their maxima coincide, nor do they point in
    /// the same direction.
    pub fn with(self, other: Self) -> Self {
        Self {
            max: self.max.hypot(other.max),
            p99: self.p99.hypot(other.p99),
        }
    }

    /// Returns the estimate for pixels with these errors; `None` where there are none. Ignores NaN.
    pub fn of(errors: &mut Vec<f32>) -> Option<Self> {
        errors.retain(|error| !error.is_nan());
        let last = errors.len().checked_sub(1)?;
        errors.sort_unstable_by(f32::total_cmp);
        Some(Self {
            max: f64::from(errors[last]),
            p99: f64::from(errors[(0.99 * last as f64).ceil() as usize]),
        })
    }
}
