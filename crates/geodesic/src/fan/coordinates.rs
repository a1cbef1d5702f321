//! The coordinates of a fan's rays.
//!
//! In the plain ones a ray is never brought back: (u,v) continues beyond sides that wrap, and only the evaluation
//! brings its point back. So neighbouring rays agree through wraps and flips without any search for periods. About an
//! apex the coordinates are (a,b), as in [`Coordinates::Apex`].

use crate::chart::{ApexChart, ChartLayout};
use crate::ends::Coordinates;

/// Coordinates with the value of the other parameter on the a-axis. It is the domain's minimum at a smooth pole, and a
/// ray's own value at the tip of a cone, which two rays need not share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FanChart {
    pub(crate) kind: Coordinates,
    pub(crate) reference: f64,
}

impl FanChart {
    pub(crate) const PLAIN: Self = Self {
        kind: Coordinates::Plain,
        reference: 0.0,
    };

    /// Returns the coordinates of an apex's chart.
    pub(super) fn of(chart: &ApexChart) -> Self {
        Self {
            kind: chart.coordinates(),
            reference: chart.reference,
        }
    }

    #[inline(always)]
    pub(super) fn is_plain(&self) -> bool {
        self.kind == Coordinates::Plain
    }

    /// Returns the apex's chart of these coordinates; `None` for the plain ones.
    pub(super) fn apex_chart(&self, layout: &ChartLayout) -> Option<ApexChart> {
        let chart = layout.apex_chart(self.kind)?;
        Some(chart.with_reference(self.reference))
    }

    /// Returns whether points in both may be compared directly.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        self.kind == other.kind && (self.is_plain() || self.reference == other.reference)
    }
}
