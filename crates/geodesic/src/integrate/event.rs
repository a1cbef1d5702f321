//! Events within a step, detected and located: the crossing of an edge, the passing of a cone's tip.

use super::ray::{Attempt, Ray};
use super::stalled_at;
use super::step::RayStep;
use crate::chart::{Chart, State};
use crate::interpolate::{cubic, turning_points};
use crate::runge_kutta::StepParameter;
use crate::status::Status;
use crate::vector::{combine, norm};

/// An event within a step.
#[derive(Clone, Copy, Debug)]
pub(super) enum Event {
    /// The crossing of the edge at this end of this axis.
    Edge((usize, usize)),
    NearestToApex,
}

/// The place of an event in a step.
enum Located {
    /// At the end of this step, of this size.
    At(f64, RayStep),
    /// Beyond the step's end.
    Beyond,
    /// No step towards it succeeds.
    Nowhere,
}

impl Ray<'_, '_> {
    /// Returns an event that may be within a step, and a fraction of the step after which it has happened: for an edge, the
    /// first sample of the interpolated step later than `after` that is beyond it.
    pub(super) fn event(
        &self,
        step: &RayStep,
        h: f64,
        pace: StepParameter,
        after: f64,
    ) -> Option<(Event, f64)> {
        match &self.chart {
            Chart::Apex(chart) => {
                if chart.apex.smooth {
                    return None;
                }
                let outward = |state: &State| {
                    state.at[0] * state.velocity[0] + state.at[1] * state.velocity[1]
                };
                let passes = outward(&self.state) < 0.0 && outward(&step.end) >= 0.0;
                let arrives = chart.is_hit_at(step.end.at);
                (passes || arrives).then_some((Event::NearestToApex, 1.0))
            }
            Chart::Plain => {
                let ends = |k: usize| {
                    [&self.state, &step.end]
                        .map(|state| [state.at[k], self.pace(state, pace) * state.velocity[k]])
                };
                let between = |share: f64| {
                    [0, 1].map(|k| {
                        let [from, to] = ends(k);
                        cubic(share, h, from, to)
                    })
                };
                let turns = [0, 1].into_iter().flat_map(|k| {
                    let [from, to] = ends(k);
                    turning_points(h, from, to)
                });
                let layout = &self.atlas.layout;
                let (share, edge) = layout.edge_on_way(step.end.at, after, turns, between)?;
                Some((Event::Edge(edge), share))
            }
        }
    }

    /// Returns the arc length per unit of a step's size at a point of the step.
    fn pace(&self, state: &State, pace: StepParameter) -> f64 {
        match pace {
            StepParameter::Length => 1.0,
            StepParameter::Coordinates => {
                let [t, w] = self.local.tangents;
                let [x, y] = state.velocity;
                self.speed() / norm(combine(x, t, y, w))
            }
        }
    }

    /// Returns the signed distance to an event at a point, negative before it and positive after it, and its derivative by
    /// the step's size.
    fn measure(&self, event: Event, state: &State, pace: StepParameter) -> (f64, f64) {
        let (value, rate) = match event {
            Event::Edge(edge) => {
                let outward = if edge.1 == 0 { -1.0 } else { 1.0 };
                let beyond = self.atlas.layout.beyond(state.at, edge);
                (beyond, outward * state.velocity[edge.0])
            }
            Event::NearestToApex => {
                let ([a, b], [x, y]) = (state.at, state.velocity);
                (a * x + b * y, x * x + y * y)
            }
        };
        (value, rate * self.pace(state, pace))
    }

    /// Ends a step of size `h` at an event. `None` if the step does not in fact reach the edge: only the interpolation crossed
    /// it.
    pub(super) fn end_at(
        &mut self,
        mut event: Event,
        h: f64,
        pace: StepParameter,
        length: f64,
    ) -> Option<Attempt> {
        let mut most = h;
        loop {
            let (at, step) = match self.locate_event(event, most, pace) {
                Located::At(at, step) => (at, step),
                Located::Beyond => return None,
                Located::Nowhere => {
                    return Some(Attempt::Ended(stalled_at(self.atlas, self.plain().at)));
                }
            };
            if let Event::Edge(edge) = event
                && let Some(earlier) = self.atlas.layout.beyond_edge(step.end.at)
                && earlier != edge
            {
                // Near a corner both edges are crossed between two samples.
                (event, most) = (Event::Edge(earlier), at);
                continue;
            }
            return Some(self.arrive(event, (at, &step), h, pace, length));
        }
    }

    /// Locates an event by bracketed Newton's method on the step's size, as accurately as the steps.
    fn locate_event(&mut self, event: Event, h: f64, pace: StepParameter) -> Located {
        let (mut low, mut high) = (0.0, h);
        // True if the event is known to be within the bracket: at first only the interpolated step suggests it.
        let mut is_sure = matches!(event, Event::NearestToApex);
        let (value, rate) = self.measure(event, &self.state, pace);
        let mut at = if rate > 0.0 {
            (-value / rate).clamp(0.0, h)
        } else {
            0.5 * h
        };
        let mut best = None;
        for _ in 0..60 {
            let Some(step) = self.step(at, pace) else {
                (high, is_sure) = (at, true);
                at = 0.5 * (low + high);
                continue;
            };
            let (value, rate) = self.measure(event, &step.end, pace);
            best = Some((at, step));
            if value > 0.0 {
                (high, is_sure) = (at, true);
            } else if at >= high && !is_sure {
                return Located::Beyond;
            } else {
                low = at;
            }
            let newton = at - value / rate;
            let next = if newton > low && newton < high {
                newton
            } else if !is_sure {
                high
            } else {
                0.5 * (low + high)
            };
            if (next - at).abs() <= 1e-15 * h || value == 0.0 {
                break;
            }
            at = next;
            if !self.affords_step() {
                break;
            }
        }
        best.map_or(Located::Nowhere, |(at, step)| Located::At(at, step))
    }

    /// Takes a step of size `at` to an event; `h` is the size of the step that was attempted.
    fn arrive(
        &mut self,
        event: Event,
        (at, step): (f64, &RayStep),
        h: f64,
        pace: StepParameter,
        length: f64,
    ) -> Attempt {
        let rounding = self.rounding();
        let scale = self.atlas.layout.scale.size.min(length);
        // At the very end only the direction is needed: the last local data suffice at a tip.
        let local = self.local_after(step).unwrap_or(self.local);
        if let (Event::NearestToApex, Chart::Apex(chart)) = (event, &self.chart)
            && !chart.is_hit_at(step.end.at)
        {
            // A near miss: the step ends at the nearest point, from which the next step leads away.
            self.accept(step, local, at, pace, rounding, scale);
            // Slightly past the nearest point, so that it is not met again.
            let ([a, b], [x, y]) = (self.state.at, self.state.velocity);
            if a * x + b * y < 0.0 {
                let along = (a * x + b * y) / (x * x + y * y);
                self.state.at = [a - along * x, b - along * y];
            }
            return if self.enter_next_chart() {
                Attempt::Accepted(Some(h))
            } else {
                Attempt::Ended(stalled_at(self.atlas, self.plain().at))
            };
        }
        self.accept(step, local, at, pace, rounding, scale);
        Attempt::Ended(match event {
            Event::NearestToApex => Status::ConePoint,
            Event::Edge(edge) if !self.atlas.layout.is_on(self.state.at, edge) => {
                if self.affords_step() {
                    stalled_at(self.atlas, self.state.at)
                } else {
                    Status::WorkLimit
                }
            }
            Event::Edge((axis, end)) => {
                self.state.at[axis] = self.atlas.layout.domain[axis][end];
                match self.atlas.layout.apexes[axis][end] {
                    Some(_) => Status::ConePoint,
                    None => Status::LeftDomain,
                }
            }
        })
    }
}
