//! One square of the picture: its samples, the coordinates and edges that they share, and the polynomials through them.

use std::array::from_fn;

use super::fit::{Grid, value};
use crate::ends::{Coordinates, End};
use crate::point::PicturePoint;
use crate::status::Status;

/// From this multiple of the patch's extent, an apex is so far away that (u,v) is as smooth as its own coordinates.
const FAR_APEX: f64 = 4.0;
/// The corners are sampled before all else, as the first check points.
pub(super) const CORNERS: usize = 4;

/// The coordinates and the edge that all ends of a square seen so far share.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Agreement {
    /// All have this status.
    Alike(Status),
    /// Some have left the domain, the others are complete, and all have known positions: an edge crosses the square.
    Edge,
}

/// The ends of a square that its polynomial is made from.
pub(super) struct SquareSamples<const N: usize> {
    pub(super) agreement: Agreement,
    pub(super) corners: [End<N>; CORNERS],
    /// At the nodes, row by row.
    pub(super) nodes: Vec<(Place, End<N>)>,
}

/// A polynomial for each coordinate, as offsets from one end.
pub(super) struct Polynomials<const N: usize> {
    pub(super) coordinates: Coordinates,
    pub(super) periods: [f64; N],
    pub(super) reference: End<N>,
    pub(super) powers: [Grid; N],
    /// The largest expected error, in pixels.
    pub(super) worst: f64,
}

impl<const N: usize> Polynomials<N> {
    /// Returns the value of a coordinate at (X, Y) in the square.
    pub(super) fn value(&self, k: usize, at: [f64; 2]) -> f64 {
        self.reference.at[k] + value(&self.powers[k], at)
    }
}

impl Agreement {
    /// Returns the coordinates and the edge that these ends share with the earlier ones, of which `first` was the first;
    /// `None` where they share none.
    pub(super) fn with<const N: usize>(self, first: &End<N>, ends: &[End<N>]) -> Option<Self> {
        let alike = |status: Status| ends.iter().all(|end| end.status == status);
        match self {
            Self::Alike(status) if alike(status) => Some(self),
            _ => (goes_on(first) && ends.iter().all(goes_on)).then_some(Self::Edge),
        }
    }
}

/// Returns whether an end has a known position, even if its geodesic has left the domain.
pub(super) fn goes_on<const N: usize>(end: &End<N>) -> bool {
    let left = end.status == Status::LeftDomain && end.coordinates == Coordinates::Plain;
    end.status == Status::Complete || left && end.at[0].is_finite()
}

/// Returns the unit vector along an axis.
pub(super) fn unit<const N: usize>(axis: usize) -> [f64; N] {
    from_fn(|k| if k == axis { 1.0 } else { 0.0 })
}

pub(super) type Place = PicturePoint;

/// Returns whether an apex is so near to ends about it that their polar coordinates would bend.
pub(super) fn is_near<const N: usize>(ends: &[End<N>]) -> bool {
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    let mut nearest = f64::INFINITY;
    for end in ends {
        nearest = nearest.min(end.at[0].hypot(end.at[1]));
        for k in 0..2 {
            low[k] = low[k].min(end.at[k]);
            high[k] = high[k].max(end.at[k]);
        }
    }
    nearest < FAR_APEX * (high[0] - low[0]).max(high[1] - low[1])
}
