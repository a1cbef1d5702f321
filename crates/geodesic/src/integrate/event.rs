//! Events within a step: the crossing of an edge, the passing of a cone's tip. Found and located here.

use super::ray::{Attempt, Ray};
use super::stalled_at;
use super::step::RayStep;
use crate::chart::{Chart, State};
use crate::interpolate::cubic;
use crate::runge_kutta::StepParameter;
use crate::status::Status;

/// An event within a step.
#[derive(Clone, Copy, Debug)]
pub(super) enum Event {
    /// The crossing of the edge at this end of this axis.
    Edge((usize, usize)),
    NearestToApex,
}

impl Ray<'_, '_> {
    /// Returns the event within a step, and a length of the step by which it has happened.
    pub(super) fn event(&self, step: &RayStep, h: f64) -> Option<(Event, f64)> {
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
                (passes || arrives).then_some((Event::NearestToApex, h))
            }
            Chart::Plain => {
                let between = |share: f64| {
                    let ends = |k: usize| {
                        [&self.state, &step.end].map(|state| [state.at[k], state.velocity[k]])
                    };
                    [0, 1].map(|k| {
                        let [from, to] = ends(k);
                        cubic(share, h, from, to)
                    })
                };
                let (share, edge) = self.atlas.layout.edge_on_way(step.end.at, between)?;
                Some((Event::Edge(edge), share * h))
            }
        }
    }

    /// The distance by which an event is ahead (negative) or behind (positive) at a point, and its rate.
    fn measure(&self, event: Event, state: &State) -> (f64, f64) {
        match event {
            Event::Edge(edge) => {
                let outward = if edge.1 == 0 { -1.0 } else { 1.0 };
                let beyond = self.atlas.layout.beyond(state.at, edge);
                (beyond, outward * state.velocity[edge.0])
            }
            Event::NearestToApex => {
                let ([a, b], [x, y]) = (state.at, state.velocity);
                (a * x + b * y, x * x + y * y)
            }
        }
    }

    /// Locates an event by Newton's method on the step's length, kept within a bracket: as exact as the steps are.
    pub(super) fn end_at(
        &mut self,
        event: Event,
        h: f64,
        pace: StepParameter,
        length: f64,
    ) -> Attempt {
        let scale = self.atlas.layout.scale.size.min(length);
        let rounding = self.rounding();
        let (mut low, mut high) = (0.0, h);
        let (value, rate) = self.measure(event, &self.state);
        let mut at = if rate > 0.0 {
            (-value / rate).clamp(0.0, h)
        } else {
            0.5 * h
        };
        let mut best = None;
        for _ in 0..60 {
            let Some(step) = self.step(at, pace) else {
                high = at;
                at = 0.5 * (low + high);
                continue;
            };
            let (value, rate) = self.measure(event, &step.end);
            best = Some((at, step));
            if value > 0.0 {
                high = at;
            } else {
                low = at;
            }
            let newton = at - value / rate;
            let next = if newton > low && newton < high {
                newton
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
        let stalled = |ray: &Self| Attempt::Ended(stalled_at(ray.atlas, ray.plain().at));
        let Some((at, step)) = best else {
            return stalled(self);
        };
        // At the very end nothing but the direction is needed: the last local data serve at a tip.
        let local = self.local_after(&step).unwrap_or(self.local);
        if let (Event::NearestToApex, Chart::Apex(chart)) = (event, &self.chart)
            && !chart.is_hit_at(step.end.at)
        {
            // A near miss: the step ends at the nearest point, from where the next one leads away.
            self.accept(&step, local, at, pace, rounding, scale);
            // Past the nearest point by a hair, so that it is not met again.
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
        self.accept(&step, local, at, pace, rounding, scale);
        Attempt::Ended(match event {
            Event::NearestToApex => Status::ConePoint,
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
