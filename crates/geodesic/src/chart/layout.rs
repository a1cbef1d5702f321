//! A chart as a whole: the domain, its sides and the continuation beyond them, and the charts about its apexes.

use expr::interval::Interval;

use super::{ApexChart, State};
use crate::ends::Coordinates;
use crate::point::Uv;
use crate::scale::Scale;
use crate::sides::{Crossing, Side, Sides};
use crate::step_path::{Borders, PathPart};
use crate::surface::Surface;
use crate::topology::Apex;

/// A point beyond an edge by at most this fraction of the domain's width is still on the edge.
const EDGE_SLACK: f64 = 1e-12;
/// A start on a crease is moved off it by this fraction of the domain, and by this fraction of its own coordinates.
const OFF_CREASE: f64 = 1e-11;
const DIGITS: f64 = 1e-14;
/// The tangent of the angle by which a direction is turned that leads from a corner along a crease.
const ASKEW: f64 = 0.6;
/// The fractions of a step at which edges are checked.
const LOOKS: [f64; 4] = [0.25, 0.5, 0.75, 1.0];

/// The domain of a surface with its sides, and the charts about its apexes.
#[derive(Clone, Debug)]
pub(crate) struct ChartLayout {
    pub(crate) domain: [[f64; 2]; 2],
    pub(crate) sides: Sides,
    /// `[axis][end]`: the sides that collapse to one point.
    pub(crate) apexes: [[Option<Apex>; 2]; 2],
    /// `[axis][end]`: the charts about the apexes where one is useful, with their a-axes at the minimum of the other
    /// parameter, as in [`Coordinates`].
    charts: [[Option<ApexChart>; 2]; 2],
    pub(crate) scale: Scale,
    /// True if points of the domain belong, or may belong, to different smooth pieces.
    pub(crate) has_creases: bool,
    any_chart: bool,
    any_edge: bool,
}

impl ChartLayout {
    pub(crate) fn of(surface: &dyn Surface) -> Self {
        let (domain, mut sides) = (surface.domain(), surface.sides());
        let apexes = [0, 1].map(|axis| [0, 1].map(|end| surface.apex(axis, end)));
        for (sides, apexes) in [&mut sides.u, &mut sides.v].into_iter().zip(&apexes) {
            for (side, apex) in sides.iter_mut().zip(apexes) {
                // A ray through a pole continues on the meridian half a period away only where directions are evenly
                // spaced.
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
            has_creases: !surface.is_one_piece(domain.map(|[low, high]| Interval::new(low, high))),
            any_chart: charts.iter().flatten().any(Option::is_some),
            any_edge: [sides.u, sides.v].as_flattened().contains(&Side::Edge),
            apexes,
            charts,
            scale: surface.scale(),
        }
    }

    /// Returns the layout with the charts as a single ray uses them.
    pub(super) fn for_one_ray(mut self) -> Self {
        self.charts = (self.charts).map(|ends| ends.map(|chart| Some(chart?.for_one_ray())));
        self
    }

    pub(crate) fn width(&self, axis: usize) -> f64 {
        self.domain[axis][1] - self.domain[axis][0]
    }

    /// Returns the apex's chart of these coordinates; `None` for (u,v), and where there is no such chart.
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

    /// Returns the chart of these coordinates if it is about a smooth pole.
    pub(crate) fn pole_chart(&self, coordinates: Coordinates) -> Option<&ApexChart> {
        self.apex_chart(coordinates)
            .filter(|chart| chart.apex.smooth)
    }

    fn apex_charts(&self) -> impl Iterator<Item = &ApexChart> {
        self.charts.iter().flatten().flatten()
    }

    /// Returns the chart to enter at a point in (u,v), if one is near: unchanged about a smooth pole; with the point on
    /// its a-axis about the tip of a cone.
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

    /// Returns the smooth pole so near to a point in (u,v) that directions are meaningful only in the pole's chart.
    pub(crate) fn pole_near(&self, at: [f64; 2]) -> Option<&ApexChart> {
        self.apex_charts()
            .find(|chart| chart.is_inner(chart.point(at)))
    }

    /// Moves a point at a pole off it by the smallest distance that distinguishes the meridians, so that its σu and σv
    /// span the tangent plane there. Returns any other point unchanged.
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

    /// Moves a point on a crease off it, in a direction if that leaves the crease: on the crease there is no tangent plane.
    /// Returns any other point unchanged.
    pub(crate) fn off_crease(
        &self,
        surface: &dyn Surface,
        at: [f64; 2],
        [x, y]: [f64; 2],
    ) -> [f64; 2] {
        if !self.has_creases {
            return at;
        }
        let step = [0, 1].map(|k| (OFF_CREASE * self.width(k)).max(DIGITS * at[k].abs()));
        let is_beside = |at: [f64; 2]| {
            let around = [0, 1].map(|k| {
                let reach = 0.2 * step[k];
                Interval::new(at[k] - reach, at[k] + reach)
            });
            self.is_one_piece(surface, around)
        };
        let scale = 1.0 / x.abs().max(y.abs());
        let turned = |turn: f64| {
            let d = [x - turn * y, y + turn * x].map(|x| x * scale);
            [[d[0], d[1]], [-d[1], d[0]], [d[1], -d[0]], [-d[0], -d[1]]]
        };
        let moved = (turned(0.0).into_iter())
            .chain(turned(ASKEW))
            .map(|d| [0, 1].map(|k| at[k] + step[k] * d[k]));
        let mut places = [at].into_iter().chain(moved);
        let beside = places.find(|at| self.contains(*at) && is_beside(*at));
        beside.unwrap_or(at)
    }

    /// Returns the periods by which neighbouring ends may differ behind a smooth pole.
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

    /// Brings a point back into the domain through the sides that wrap, and through poles.
    #[inline(always)]
    pub(crate) fn bring_back(&self, at: &mut [f64; 2]) -> Crossing {
        self.sides.bring_back(self.domain, at)
    }

    /// Returns the smooth piece of a point that may be beyond sides that wrap.
    pub(crate) fn smooth_piece(&self, surface: &dyn Surface, mut at: [f64; 2]) -> u64 {
        self.bring_back(&mut at);
        surface.smooth_piece(Uv(at))
    }

    /// Returns true if all points of a box that may reach beyond sides that wrap have one smooth piece; false where that
    /// cannot be decided. Points beyond edges do not count.
    pub(crate) fn is_one_piece(&self, surface: &dyn Surface, within: [Interval; 2]) -> bool {
        if self.contains_box(within) {
            return surface.is_one_piece(within);
        }
        // Each part of the box between two sides lies in one copy of the domain.
        let [us, vs] = [0, 1].map(|axis| self.parts(axis, within[axis]));
        us.windows(2).all(|u| {
            vs.windows(2).all(|v| {
                let part = [[u[0], u[1]], [v[0], v[1]]];
                surface.is_one_piece(self.part_in_domain(part))
            })
        })
    }

    /// Returns what is known of the creases along a part of a path that may reach beyond sides that wrap; those beyond edges do
    /// not count.
    pub(crate) fn creases_along(&self, surface: &dyn Surface, part: &PathPart<2>) -> Borders {
        let within = part.within();
        if self.contains_box(within) {
            surface.creases_along(part)
        } else {
            Borders::none_if(self.is_one_piece(surface, within))
        }
    }

    fn contains_box(&self, within: [Interval; 2]) -> bool {
        self.contains(within.map(Interval::lower)) && self.contains(within.map(Interval::upper))
    }

    /// Returns the ends of the parts into which the sides of an axis divide an interval, without what is beyond edges.
    fn parts(&self, axis: usize, within: Interval) -> Vec<f64> {
        let [low, high] = self.domain[axis];
        let [ends_low, ends_high] = self.sides.of(axis).map(|side| side == Side::Edge);
        let (from, to) = (within.lower(), within.upper());
        let from = if ends_low { from.max(low) } else { from };
        let to = if ends_high { to.min(high) } else { to };
        let inside = [low, high]
            .into_iter()
            .filter(|end| from < *end && *end < to);
        [from].into_iter().chain(inside).chain([to]).collect()
    }

    /// Brings a box in one copy of the domain back into the domain.
    fn part_in_domain(&self, part: [[f64; 2]; 2]) -> [Interval; 2] {
        let mut middle = part.map(|[from, to]| 0.5 * (from + to));
        self.bring_back(&mut middle);
        [0, 1].map(|k| {
            let ([from, to], [low, high]) = (part[k], self.domain[k]);
            let rounding = 8.0 * f64::EPSILON * (middle[k].abs() + from.abs() + to.abs());
            let reach = 0.5 * (to - from) + rounding;
            Interval::new(
                (middle[k] - reach).max(low.min(middle[k])),
                (middle[k] + reach).min(high.max(middle[k])),
            )
        })
    }

    /// Brings a point with its velocity back into the domain.
    pub(crate) fn bring_state_back(&self, state: &mut State) -> Crossing {
        let crossing = self.bring_back(&mut state.at);
        state.velocity = [0, 1].map(|k| crossing.signs[k] * state.velocity[k]);
        crossing
    }

    /// Returns whether a point is in the domain itself.
    #[inline(always)]
    pub(crate) fn contains(&self, [u, v]: [f64; 2]) -> bool {
        let [[a, b], [c, d]] = self.domain;
        (u >= a) & (u <= b) & (v >= c) & (v <= d)
    }

    /// Returns the edge that a point in (u,v) is beyond, if any: its axis and end.
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

    /// Returns the edge through which a step to `end` leaves, and a fraction of the step after which it is outside: the
    /// earliest of a few samples later than `after`, and of the fractions at which the step turns back in a coordinate.
    pub(crate) fn edge_on_way(
        &self,
        end: [f64; 2],
        after: f64,
        turns: impl IntoIterator<Item = f64>,
        between: impl Fn(f64) -> [f64; 2],
    ) -> Option<(f64, (usize, usize))> {
        if !self.any_edge {
            return None;
        }
        let mut looks = [f64::INFINITY; 8];
        for (look, share) in looks.iter_mut().zip(LOOKS.into_iter().chain(turns)) {
            *look = share;
        }
        looks.sort_by(f64::total_cmp);
        let mut looks = looks
            .into_iter()
            .filter(|share| *share > after && *share <= 1.0);
        looks.find_map(|share| {
            let at = if share == 1.0 { end } else { between(share) };
            Some((share, self.beyond_edge(at)?))
        })
    }

    /// Returns whether a point in (u,v) is on a side, up to rounding.
    pub(crate) fn is_on(&self, at: [f64; 2], side: (usize, usize)) -> bool {
        self.beyond(at, side).abs() <= EDGE_SLACK * self.width(side.0)
    }

    /// Returns the distance in its parameter by which a point in (u,v) is beyond a side; negative inside.
    pub(crate) fn beyond(&self, at: [f64; 2], (axis, end): (usize, usize)) -> f64 {
        let outward = if end == 0 { -1.0 } else { 1.0 };
        outward * (at[axis] - self.domain[axis][end])
    }

    /// Returns the bounds within which no edge is crossed: infinite where there is no edge.
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
