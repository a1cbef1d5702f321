//! What may happen within a step: the crossing of an edge, the passing of a cone's tip. Found and located here.

use super::ray::{Attempt, Ray};
use super::stalled_at;
use crate::chart::{Chart, State};
use crate::runge_kutta::{Step, StepParameter};
use crate::status::Status;
use crate::surface::{Side, Surface};

/// A tip of a cone is hit by what passes it within this share of its chart's radius.
const HIT: f64 = 1e-12;
/// How far beyond an edge a ray may stray, as a share of the domain's width, and still be on it.
const EDGE_SLACK: f64 = 1e-12;
/// Where within a step something happens.
#[derive(Clone, Copy, Debug)]
pub(super) enum Event {
    Edge { axis: usize, end: usize },
    NearestToApex,
}

impl<S: Surface + ?Sized> Ray<'_, '_, S> {
    /// What happens within a step, and a length of the step by which it has happened.
    pub(super) fn event(&self, step: &Step, h: f64) -> Option<(Event, f64)> {
        match &self.chart {
            Chart::Apex(chart) => {
                if chart.apex.smooth {
                    return None;
                }
                let outward = |state: &State| {
                    state.at[0] * state.velocity[0] + state.at[1] * state.velocity[1]
                };
                let passes = outward(&self.state) < 0.0 && outward(&step.end) >= 0.0;
                let arrives = step.end.at[0].hypot(step.end.at[1]) <= HIT * chart.radius();
                (passes || arrives).then_some((Event::NearestToApex, h))
            }
            Chart::Plain => {
                // The earliest of a few looks at the step, the last one at its end.
                [0.25, 0.5, 0.75, 1.0].into_iter().find_map(|share| {
                    let at = if share == 1.0 {
                        step.end.at
                    } else {
                        hermite(&self.state, &step.end, h, share)
                    };
                    (0..2).find_map(|axis| {
                        let [low, high] = self.atlas.domain[axis];
                        let slack = EDGE_SLACK * (high - low);
                        [low - at[axis], at[axis] - high]
                            .into_iter()
                            .enumerate()
                            .find_map(|(end, beyond)| {
                                let ends =
                                    self.atlas.sides.of(axis)[end] == Side::Edge && beyond > slack;
                                ends.then_some((Event::Edge { axis, end }, share * h))
                            })
                    })
                })
            }
        }
    }

    /// How far an event is ahead (negative) or behind (positive) at a point, and its rate.
    fn measure(&self, event: Event, state: &State) -> (f64, f64) {
        match event {
            Event::Edge { axis, end } => {
                let sign = if end == 0 { -1.0 } else { 1.0 };
                (
                    sign * (state.at[axis] - self.atlas.domain[axis][end]),
                    sign * state.velocity[axis],
                )
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
        let scale = self.atlas.scale.size.min(length);
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
        if let (Event::NearestToApex, Chart::Apex(chart)) = (event, &self.chart) {
            let miss = step.end.at[0].hypot(step.end.at[1]);
            let hit = miss <= HIT * chart.radius();
            if !hit {
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
        }
        self.accept(&step, local, at, pace, rounding, scale);
        Attempt::Ended(match event {
            Event::NearestToApex => Status::ConePoint,
            Event::Edge { axis, end } => {
                self.state.at[axis] = self.atlas.domain[axis][end];
                match self.atlas.apexes[axis][end] {
                    Some(_) => Status::ConePoint,
                    None => Status::LeftDomain,
                }
            }
        })
    }
}

/// A point of the cubic through both ends with their velocities.
fn hermite(from: &State, to: &State, h: f64, share: f64) -> [f64; 2] {
    let t = share;
    let (h00, h10) = (
        (1.0 + 2.0 * t) * (1.0 - t) * (1.0 - t),
        t * (1.0 - t) * (1.0 - t),
    );
    let (h01, h11) = (t * t * (3.0 - 2.0 * t), t * t * (t - 1.0));
    [0, 1].map(|k| {
        h00 * from.at[k] + h10 * h * from.velocity[k] + h01 * to.at[k] + h11 * h * to.velocity[k]
    })
}
