//! The coordinates that a fan's rays run in.
//!
//! In the plain ones a ray is never brought back: (u,v) goes on beyond sides that wrap, only the evaluation brings its
//! point back. So neighbouring rays agree, through wraps and flips, with no guessing of periods. About an apex they
//! are (a,b), as [`Coordinates::Apex`] has them.

use crate::chart::{ApexChart, ChartLayout};
use crate::ends::Coordinates;

/// Coordinates with what the a-axis points at: the other parameter's value there. It is the domain's minimum at a
/// smooth pole, and a ray's own at the tip of a cone, which no two rays need share.
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

    /// The coordinates of an apex's chart.
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

    /// The apex's chart that they are; `None` for the plain ones.
    pub(super) fn apex_chart(&self, layout: &ChartLayout) -> Option<ApexChart> {
        let chart = layout.apex_chart(self.kind)?;
        Some(chart.with_reference(self.reference))
    }

    /// Returns whether points in both may be compared as they are.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        self.kind == other.kind && (self.is_plain() || self.reference == other.reference)
    }
}
