//! A chart as a whole: the domain with its sides and what lies beyond them, and the charts about its apexes.

use super::{ApexChart, State};
use crate::ends::Coordinates;
use crate::scale::Scale;
use crate::sides::{Crossing, Side, Sides};
use crate::surface::Surface;
use crate::topology::Apex;

/// The distance beyond an edge, as a share of the domain's width, within which a point is still on it.
const EDGE_SLACK: f64 = 1e-12;
/// The shares of a step at which it is looked for an edge.
const LOOKS: [f64; 4] = [0.25, 0.5, 0.75, 1.0];

/// The domain of a surface with its sides, and the charts about its apexes.
#[derive(Clone, Debug)]
pub(crate) struct ChartLayout {
    pub(crate) domain: [[f64; 2]; 2],
    pub(crate) sides: Sides,
    /// `[axis][end]`: the sides that are one point.
    pub(crate) apexes: [[Option<Apex>; 2]; 2],
    /// `[axis][end]`: the charts about those where one is of use, with their a-axes along the minimum of the other
    /// parameter, as [`Coordinates`] has them.
    charts: [[Option<ApexChart>; 2]; 2],
    pub(crate) scale: Scale,
    any_chart: bool,
    any_edge: bool,
}

impl ChartLayout {
    pub(crate) fn of(surface: &dyn Surface) -> Self {
        let (domain, mut sides) = (surface.domain(), surface.sides());
        let apexes = [0, 1].map(|axis| [0, 1].map(|end| surface.apex(axis, end)));
        for (sides, apexes) in [&mut sides.u, &mut sides.v].into_iter().zip(&apexes) {
            for (side, apex) in sides.iter_mut().zip(apexes) {
                // A ray through a pole goes on along the meridian half a period away only where directions are even.
                if apex.is_some_and(|apex| apex.smooth && !apex.regular) {
                    *side = Side::Edge;
                }
            }
        }
        let charts = [0, 1].map(|axis| {
            [0, 1].map(|end| {
                let apex = apexes[axis][end].filter(|apex: &Apex| apex.regular)?;
                Some(ApexChart::new(domain, axis, end, apex))
            })
        });
        Self {
            domain,
            sides,
            any_chart: charts.iter().flatten().any(Option::is_some),
            any_edge: [sides.u, sides.v].as_flattened().contains(&Side::Edge),
            apexes,
            charts,
            scale: surface.scale(),
        }
    }

    /// The same with charts as a single ray uses them.
    pub(super) fn for_one_ray(mut self) -> Self {
        self.charts = (self.charts).map(|ends| ends.map(|chart| Some(chart?.for_one_ray())));
        self
    }

    pub(crate) fn width(&self, axis: usize) -> f64 {
        self.domain[axis][1] - self.domain[axis][0]
    }

    /// The chart that these coordinates are; `None` for (u,v), and where there is none.
    #[inline(always)]
    pub(crate) fn apex_chart(&self, coordinates: Coordinates) -> Option<&ApexChart> {
        match coordinates {
            Coordinates::Plain => None,
            Coordinates::Apex { axis, end } => self
                .charts
                .get(usize::from(axis))?
                .get(usize::from(end))?
                .as_ref(),
        }
    }

    /// The same where it is about a smooth pole.
    pub(crate) fn pole_chart(&self, coordinates: Coordinates) -> Option<&ApexChart> {
        self.apex_chart(coordinates)
            .filter(|chart| chart.apex.smooth)
    }

    fn apex_charts(&self) -> impl Iterator<Item = &ApexChart> {
        self.charts.iter().flatten().flatten()
    }

    /// The chart to enter at a point in (u,v), if one is near: about a smooth pole as it is, about the tip of a cone with
    /// the point on its a-axis.
    pub(crate) fn chart_near(&self, at: [f64; 2]) -> Option<ApexChart> {
        if !self.any_chart {
            return None;
        }
        let chart = self
            .apex_charts()
            .find(|chart| chart.is_entered_at(at))
            .copied()?;
        Some(if chart.apex.smooth {
            chart
        } else {
            chart.with_reference(at[1 - chart.axis])
        })
    }

    /// Returns whether a point in (u,v) is too near an apex for the plain chart, or beyond it.
    pub(crate) fn needs_apex_chart(&self, at: [f64; 2]) -> bool {
        self.any_chart && self.apex_charts().any(|chart| chart.is_needed_at(at))
    }

    /// The smooth pole so near to a point in (u,v) that directions have a meaning only in its chart.
    pub(crate) fn pole_near(&self, at: [f64; 2]) -> Option<&ApexChart> {
        self.apex_charts()
            .find(|chart| chart.is_inner(chart.point(at)))
    }

    /// A point at a pole is moved off it by as little as tells the meridians apart, so that its σu and σv span the
    /// tangent plane there. Gives the point otherwise as it is.
    pub(crate) fn off_pole(&self, mut at: [f64; 2]) -> [f64; 2] {
        if let Some(chart) = self.chart_near(at)
            && chart.apex.smooth
        {
            let nearest = chart.plain_polar(chart.nearest(), 0.0)[chart.axis];
            if (at[chart.axis] - chart.base).abs() < (nearest - chart.base).abs() {
                at[chart.axis] = nearest;
            }
        }
        at
    }

    /// The periods by which neighbours behind a smooth pole may differ.
    pub(crate) fn periods(&self) -> [f64; 2] {
        [0, 1].map(|axis| {
            let mut charts = self.charts[1 - axis].iter().flatten();
            if charts.any(|chart| chart.apex.smooth) {
                self.width(axis)
            } else {
                0.0
            }
        })
    }

    /// Brings a point back through the sides that wrap, and through poles.
    #[inline(always)]
    pub(crate) fn bring_back(&self, at: &mut [f64; 2]) -> Crossing {
        self.sides.bring_back(self.domain, at)
    }

    /// The same for a point with its velocity.
    pub(crate) fn bring_state_back(&self, state: &mut State) -> Crossing {
        let crossing = self.bring_back(&mut state.at);
        state.velocity = [0, 1].map(|k| crossing.signs[k] * state.velocity[k]);
        crossing
    }

    /// Returns whether a point lies within the domain itself.
    #[inline(always)]
    pub(crate) fn contains(&self, [u, v]: [f64; 2]) -> bool {
        let [[a, b], [c, d]] = self.domain;
        (u >= a) & (u <= b) & (v >= c) & (v <= d)
    }

    /// The edge that a point in (u,v) lies beyond, if any: its axis and end.
    #[inline(always)]
    pub(crate) fn beyond_edge(&self, at: [f64; 2]) -> Option<(usize, usize)> {
        if !self.any_edge || self.contains(at) {
            return None;
        }
        (0..2).find_map(|axis| {
            let [low, high] = self.domain[axis];
            let slack = EDGE_SLACK * (high - low);
            let sides = self.sides.of(axis);
            if sides[0] == Side::Edge && at[axis] < low - slack {
                Some((axis, 0))
            } else if sides[1] == Side::Edge && at[axis] > high + slack {
                Some((axis, 1))
            } else {
                None
            }
        })
    }

    /// The edge that a step to `end` leaves through, and a share of the step by which it has: the earliest of a few
    /// looks at it that are later than `after`.
    pub(crate) fn edge_on_way(
        &self,
        end: [f64; 2],
        after: f64,
        between: impl Fn(f64) -> [f64; 2],
    ) -> Option<(f64, (usize, usize))> {
        if !self.any_edge {
            return None;
        }
        let mut looks = LOOKS.into_iter().filter(|share| *share > after);
        looks.find_map(|share| {
            let at = if share == 1.0 { end } else { between(share) };
            Some((share, self.beyond_edge(at)?))
        })
    }

    /// Returns whether a point in (u,v) lies on a side, but for rounding.
    pub(crate) fn is_on(&self, at: [f64; 2], side: (usize, usize)) -> bool {
        self.beyond(at, side).abs() <= EDGE_SLACK * self.width(side.0)
    }

    /// The distance in its parameter by which a point in (u,v) lies beyond a side; negative inside.
    pub(crate) fn beyond(&self, at: [f64; 2], (axis, end): (usize, usize)) -> f64 {
        let outward = if end == 0 { -1.0 } else { 1.0 };
        outward * (at[axis] - self.domain[axis][end])
    }

    /// The bounds within which no edge is crossed: infinite where there is none.
    pub(crate) fn bounds(&self) -> [[f64; 2]; 2] {
        [0, 1].map(|axis| {
            let sides = self.sides.of(axis);
            [(0, f64::NEG_INFINITY), (1, f64::INFINITY)].map(|(end, none)| {
                let edge = sides[end] == Side::Edge && self.apexes[axis][end].is_none();
                if edge { self.domain[axis][end] } else { none }
            })
        })
    }
}
