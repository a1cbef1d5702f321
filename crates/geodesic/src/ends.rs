//! The ends of geodesics as a function of the pixel: every method gives them, and every picture is made of them.
//!
//! An end has two coordinates in a chart, or three where geodesics run on a surface in space that has no chart: all that
//! interpolates ends is generic over their number.

use std::array::from_fn;

use crate::point::PicturePoint;
use crate::status::Status;

/// The coordinates that an [`Ends`] speaks in.
#[derive(Clone, Copy, Debug, Default, Eq, Ord, PartialEq, PartialOrd)]
pub enum Coordinates {
    /// (u, v), going on beyond sides that wrap: a neighbouring pixel's are near by, whatever lies between. A picture
    /// brings them back into the domain.
    #[default]
    Plain,
    /// (a, b) = r (cos kt, sin kt) about the apex at an end of `axis` (0 u, 1 v; `end` 0 its minimum, 1 its maximum),
    /// where r is the distance in the parameter (to the power 1/[`power`](crate::topology::Apex::power)) and t the
    /// other parameter less its minimum, k the apex's [`rate`](crate::topology::Apex::rate).
    Apex {
        /// 0 for u, 1 for v.
        axis: u8,
        /// 0 for the minimum, 1 for the maximum.
        end: u8,
    },
}

/// The end of the geodesic of one place in the picture: a place with `N` coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End<const N: usize = 2> {
    /// The coordinates of `at`.
    pub coordinates: Coordinates,
    /// Its end.
    pub at: [f64; N],
    /// The ray's unit tangent there, in these coordinates.
    pub along: [f64; N],
    /// The unit normal to it, towards the side on which the frame's Y lies of X at the start.
    pub across: [f64; N],
    /// m/s, the Jacobi field over the arc length (1 at the centre): along the ray the surface is seen at its own
    /// scale, across it at this one, negative behind a conjugate point. NaN where it is not known.
    pub stretch: f64,
    /// The reason of its end. The fields above have a meaning for [`Status::Complete`], and where it is finite for
    /// [`Status::LeftDomain`]: where the geodesic would be had the surface gone on.
    pub status: Status,
    /// The estimated error in pixels.
    pub error: f64,
}

impl<const N: usize> End<N> {
    /// ∂at/∂x and ∂at/∂y at a place of the picture, whose unit is `zoom` long on the surface.
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

    /// The length on the surface of a small difference in the coordinates: in a chart by its components along the unit
    /// tangent and normal, in space as it is.
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

/// The change of the coordinates about an apex, (a, b) = r (cos kt, sin kt), into (u,v): the parameter along the axis is
/// `base` + `sign` r^`power`, the other one `low` + t, where t = angle/`rate`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Polar {
    /// The parameter at the apex.
    pub base: f64,
    /// +1 where the domain lies above `base`, −1 where below.
    pub sign: f64,
    /// The other parameter where the a-axis points.
    pub low: f64,
    /// k.
    pub rate: f64,
    /// 1, 2 or ½.
    pub power: f64,
}

/// The exponential map of a camera, by any method.
pub trait Ends<const N: usize = 2>: Sync {
    /// Returns the end of the geodesic of a place (x, y) of the picture; the coordinates are the method's choice.
    fn end(&self, place: PicturePoint) -> End<N>;
    /// Appends the ends of several places: the same as [`Ends::end`] of each, for less.
    fn ends(&self, places: &[PicturePoint], out: &mut Vec<End<N>>) {
        out.extend(places.iter().map(|place| self.end(*place)));
    }
    /// The camera's zoom: the length on the surface of the picture's unit.
    fn zoom(&self) -> f64;
    /// The camera's place, in the plain coordinates.
    fn origin(&self) -> [f64; N];
    /// An end in other coordinates, for a common polynomial with its neighbours; `None` where those are of no use.
    fn in_coordinates(&self, end: &End<N>, coordinates: Coordinates) -> Option<End<N>> {
        (end.coordinates == coordinates).then_some(*end)
    }
    /// The coordinate periods that an end may be off its neighbour by, behind a pole: 0 where the axis has none.
    fn periods(&self) -> [f64; N] {
        [0.0; N]
    }
    /// The least and the largest of each coordinate, such as `[[u min, u max], [v min, v max]]`: a geodesic whose end would
    /// lie beyond has left the domain. Infinite where no edge is.
    fn bounds(&self) -> [[f64; 2]; N] {
        [[f64::NEG_INFINITY, f64::INFINITY]; N]
    }
    /// The coordinates about the apex at an end of an axis, if any end may be in them.
    fn polar(&self, axis: u8, end: u8) -> Option<Polar> {
        let _ = (axis, end);
        None
    }
}

/// The work that a picture took.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct GeodesicWork {
    /// Rays of a fan.
    pub rays: u64,
    /// Steps taken, of all rays.
    pub steps: u64,
    /// Steps tried and not taken.
    pub rejected: u64,
    /// Evaluations of the surface and its derivatives, each point of a block counted, whatever they were for.
    pub evaluations: u64,
    /// Pixels whose geodesics were followed one by one.
    pub followed: u64,
}

/// The estimated errors of a picture, in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// The largest error.
    pub max: f64,
    /// The error that 99 % of the pixels stay below.
    pub p99: f64,
}

impl Estimate {
    /// The estimate for the sum of these errors and others that know nothing of them: neither lie their maxima at one
    /// place, nor do they point in one direction.
    pub fn with(self, other: Self) -> Self {
        Self {
            max: self.max.hypot(other.max),
            p99: self.p99.hypot(other.p99),
        }
    }

    /// The estimate for pixels with these errors; `None` where there are none. A NaN is passed over.
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
