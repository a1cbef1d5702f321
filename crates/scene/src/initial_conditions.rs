//! The start and the direction of a geodesic, or the reason why it cannot start and is not drawn.

use std::fmt;

use crate::range::Range;

/// The start and the direction of one instance of a geodesic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InitialConditions {
    /// The parameters (u, v) of the start, inside the domain of its surface or, within rounding, on the domain's sides.
    pub start: [f64; 2],
    /// The direction a σu + b σv as (a, b), finite and not zero; its length does not matter.
    pub direction: [f64; 2],
    /// The length of one unit of the parameter: 1 for a geodesic from a point in a direction, the distance for one between
    /// two points.
    pub unit: f64,
}

/// The reason why an instance of a geodesic cannot start. Its text is the end of a sentence: "its direction is zero".
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InitialConditionsError {
    /// No geodesic between its two endpoints has been found.
    NoConnection,
    /// Its two endpoints are the same.
    OnePlace,
    /// A component of the direction is not a finite number.
    UndefinedDirection,
    /// The direction is (0, 0).
    ZeroDirection,
    /// A parameter of the start is not a finite number.
    UndefinedStart,
    /// The start, or the other endpoint, is outside the surface's domain.
    Outside {
        /// The point.
        place: [f64; 2],
        /// The domain.
        domain: [Range; 2],
    },
}

/// The maximum distance of a start beyond a side, as a fraction of the domain's width.
const SLACK: f64 = 1e-12;

impl fmt::Display for InitialConditionsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoConnection => {
                write!(f, "no geodesic between its two points was found")
            }
            Self::OnePlace => write!(f, "its two points are the same"),
            Self::UndefinedDirection => write!(f, "its direction is undefined"),
            Self::ZeroDirection => write!(f, "its direction is zero"),
            Self::UndefinedStart => write!(f, "its start is undefined"),
            Self::Outside {
                place: [u, v],
                domain: [first, second],
            } => write!(
                f,
                "the point ({u}, {v}) lies outside the domain [{}, {}] × [{}, {}]",
                first.min, first.max, second.min, second.max
            ),
        }
    }
}

impl InitialConditions {
    /// Returns the initial conditions of a geodesic on a surface with this domain.
    ///
    /// # Errors
    /// If it cannot start.
    pub(crate) fn new(
        start: [f64; 2],
        direction: [f64; 2],
        unit: f64,
        domain: [Range; 2],
    ) -> Result<Self, InitialConditionsError> {
        if !direction.iter().all(|x| x.is_finite()) {
            return Err(InitialConditionsError::UndefinedDirection);
        }
        if direction == [0.0; 2] {
            return Err(InitialConditionsError::ZeroDirection);
        }
        if !start.iter().all(|x| x.is_finite()) {
            return Err(InitialConditionsError::UndefinedStart);
        }
        let inside = |(range, x): (&Range, &f64)| {
            // A point on a side may have been rounded to beyond it.
            let slack = SLACK * (range.max - range.min);
            (range.min - slack..=range.max + slack).contains(x)
        };
        if !domain.iter().zip(&start).all(inside) {
            return Err(InitialConditionsError::Outside {
                place: start,
                domain,
            });
        }
        Ok(Self {
            start,
            direction,
            unit,
        })
    }
}
