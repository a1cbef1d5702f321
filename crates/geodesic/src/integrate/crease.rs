//! Creases, where σ is continuous and its derivatives are not (|u|, max, min), or where the metric is continuous and its
//! derivatives are not: noticed by the smooth pieces of the surface or by a jump of the speed, located along the ray, and
//! crossed with the angle to the crease preserved (`crease/sides.rs`).
//!
//! ```text
//! a step into another piece ──crossing──▶ the length to the crease ──▶ a shorter step, as long as it is far
//!                                                                 └──▶ the passage, once it is near
//! ```
//!
//! Ahead of a ray the crossing is sought on a parabola, whose error is of third order in the distance: each shorter step
//! brings the ray much closer to the crease, and no step across it is needed.

mod sides;

use expr::interval::Interval;

use super::ray::{Attempt, Ray};
use super::stalled_at;
use super::step::RayStep;
use crate::chart::{Chart, Local, State};
use crate::jet::Jet;
use crate::metric::{Metric, acceleration};
use crate::point::TangentVector;
use crate::runge_kutta::StepParameter;
use crate::status::Status;
use crate::step_path::StepPath;
use crate::vector::{combine, dot, norm};
use sides::{BothSides, Passage};

/// The minimum change of the speed within a step that is investigated.
const NOTICED: f64 = 1e-9;
/// The same as a multiple of the error that the tolerance allows.
const NOTICED_BEYOND: f64 = 30.0;
/// The fraction of its change that a jump keeps while its bracket is halved.
const STAYS: f64 = 0.3;
/// A crease is located to this fraction of the ray's scale.
const SHARP: f64 = 1e-14;
/// A crease that is farther away than `NEAR` is located to this fraction of its distance.
const COARSE: f64 = 1e-3;
/// Within this fraction of its scale and of its radius of curvature in the chart, a ray is a parabola up to rounding.
const NEAR: f64 = 1e-5;
/// The same, within which the parabola shows where a crease is.
const TRUSTED: f64 = 1e-2;
/// A crease is sought on the parabola up to the length of the step times this.
const FARTHEST: f64 = 1.2;
/// A step to a crease ends at most at this fraction of the step that crossed it.
const SHORTER: f64 = 0.9;
/// The maximum gap between both sides of a crease, as a fraction of the ray's scale.
const TORN: f64 = 1e-6;

/// The minimum distance in a coordinate that counts as off a crease: at 0 coordinates are not rounded.
const LEAST_ROUNDING: f64 = 1e-280;

/// The maximum change of direction and speed in a step over a kink, which is 10⁻¹² of the scale long; at a singularity the
/// curvature would cause a larger one.
const HARDLY: f64 = 1e-9;

/// The cause of a change within a step.
enum Found {
    /// No localised cause: the surface is steep there, or the ray is not a parabola so far.
    Steep,
    /// A crease between two lengths ahead of the ray.
    Crease([f64; 2]),
    /// The ray leaves its piece by less than rounding, and returns to it.
    Grazed,
    /// The evaluations are used up.
    Nothing,
}

impl Ray<'_, '_> {
    /// Returns the outcome of an attempt at a step of size `h` where another smooth piece begins shortly ahead: that needs no
    /// step across.
    pub(super) fn nears_other_piece(&mut self, h: f64) -> Option<Attempt> {
        if !matches!(self.chart, Chart::Plain) {
            return None;
        }
        let reach = h.min(self.nearness() * (TRUSTED / NEAR));
        let piece = self.atlas.smooth_piece(self.state.at);
        if self.atlas.smooth_piece(self.ahead(reach).at) == piece {
            return None;
        }
        let side = |state: &State| Some(f64::from(self.atlas.smooth_piece(state.at) != piece));
        match self.crossing(reach, &side) {
            Found::Steep => None,
            found => self.approach(&found, [reach; 2], h),
        }
    }

    /// Returns the outcome of a step that ends in another smooth piece than it began; `None` where it did not, or where the
    /// ray begins on a crease or ends on an edge that is one.
    pub(super) fn enters_other_piece(&mut self, step: &RayStep, h: f64) -> Option<Attempt> {
        if !matches!(self.chart, Chart::Plain) {
            return None;
        }
        let piece = self.atlas.smooth_piece(self.state.at);
        let share = self.other_piece_on_way(step, piece)?;
        let side = |state: &State| Some(f64::from(self.atlas.smooth_piece(state.at) != piece));
        match self.crossing(share * step.length, &side) {
            // The parabola does not meet what the step does.
            Found::Steep if share < 1.0 => Some(Attempt::Again(SHORTER * share * h)),
            found => self.approach(&found, [step.length, h], h),
        }
    }

    /// Returns a fraction of a step's length at which it is in another smooth piece, shortly behind the first crease; more than
    /// 1 if only the ends of the step are examined.
    fn other_piece_on_way(&mut self, step: &RayStep, piece: u64) -> Option<f64> {
        if !self.atlas.layout.has_creases {
            // No creases, or too many to be examined.
            return (self.atlas.smooth_piece(step.end.at) != piece).then_some(FARTHEST);
        }
        let local = self.local_after(step)?;
        let of = |state: &State, local: &Local| [state.at, state.velocity, local.acceleration];
        let path = StepPath::new(
            step.length,
            of(&self.state, &self.local),
            of(&step.end, &local),
        );
        let atlas = self.atlas;
        path.first_beyond(&|part| atlas.creases_along(part), &|at| {
            atlas.smooth_piece(at) != piece
        })
    }

    /// Returns the outcome of a step whose speed has jumped; `None` where the step may be accepted. `allowed` is the error
    /// that the tolerance allows on the way.
    pub(super) fn speed_jumps(
        &mut self,
        step: &RayStep,
        local: &Local,
        h: f64,
        allowed: f64,
    ) -> Option<Attempt> {
        if !matches!(self.chart, Chart::Plain) {
            return None;
        }
        let scale = self.atlas.layout.scale.size.min(self.s + step.length);
        let speed = self.speed();
        let jump = length(local.tangents, step.end.velocity) / speed - 1.0;
        if jump.abs() <= NOTICED + NOTICED_BEYOND * allowed / scale {
            return None;
        }
        let change = |state: &State| {
            let local = self.atlas.local(&self.chart, *state)?;
            Some(length(local.tangents, state.velocity) / speed - 1.0)
        };
        let found = match self.crossing(FARTHEST * step.length, &change) {
            // The speed at the step's end says that it does not return.
            Found::Grazed => Found::Steep,
            found => found,
        };
        self.approach(&found, [step.length, h], h)
    }

    /// Takes one short step whatever its error, and returns whether it did. Where the metric is continuous and its derivatives
    /// are not, as at the rim of two cones, no step across is short enough for a tight tolerance, and yet the direction hardly
    /// changes. The error counts.
    pub(super) fn leaps_over_kink(&mut self, h: f64) -> bool {
        if !matches!(self.chart, Chart::Plain) || !self.affords_step() {
            return false;
        }
        let pace = StepParameter::Coordinates;
        let Some(step) = self.step(h, pace) else {
            return false;
        };
        let Some(local) = self.local_after(&step) else {
            return false;
        };
        let change = [0, 1].map(|k| step.end.velocity[k] - self.state.velocity[k]);
        let speeds = [&self.state.velocity, &step.end.velocity]
            .map(|velocity| length(local.tangents, *velocity));
        let is_small = |change: f64| change <= HARDLY;
        let turns = length(self.local.tangents, change) / self.speed();
        let jumps = [
            speeds[0] / self.speed() - 1.0,
            speeds[1] / self.speed() - 1.0,
        ];
        let is_kink = is_small(turns) && jumps.iter().all(|jump| is_small(jump.abs()));
        if !is_kink || self.event(&step, h, pace, 0.0).is_some() || self.oversteps(&step) {
            return false;
        }
        let scale = self.atlas.layout.scale.size.min(self.s + h);
        let rounding = self.rounding();
        self.accept(&step, local, h, pace, rounding, scale);
        self.control.forget();
        self.enter_next_chart()
    }

    /// Locates a crease on the parabola ahead of the ray, up to a length. `change` is 0 at the ray's point, is continuous on
    /// both sides of the crease and jumps there.
    fn crossing(&self, reach: f64, change: &dyn Fn(&State) -> Option<f64>) -> Found {
        let sharp = self.sharpness(reach);
        let near = self.nearness();
        let reach = reach + 8.0 * sharp;
        let Some(jump) = change(&self.ahead(reach)) else {
            return Found::Steep;
        };
        let (mut low, mut high) = ((0.0, 0.0), (reach, jump));
        while jump != 0.0
            && high.0 - low.0 > sharp.max(if high.0 > near { COARSE * high.0 } else { 0.0 })
        {
            let middle = 0.5 * (low.0 + high.0);
            if middle <= low.0 || middle >= high.0 {
                break;
            }
            if !self.affords_step() {
                return Found::Nothing;
            }
            let Some(there) = change(&self.ahead(middle)) else {
                return Found::Steep;
            };
            if (there - low.1).abs() > (there - high.1).abs() {
                high = (middle, there);
            } else {
                low = (middle, there);
            }
            if (high.1 - low.1).abs() < STAYS * jump.abs() {
                return Found::Steep;
            }
        }
        if jump == 0.0 {
            return Found::Steep;
        }
        // Both ends are at a distance from the crease at which rounding does not matter: a ray may meet it at a small angle.
        let (mut before, mut behind) = (low.0 - sharp, high.0 + sharp);
        let is_behind = |length: f64| {
            let there = change(&self.ahead(length));
            there.is_some_and(|it| (it - low.1).abs() > (it - high.1).abs())
        };
        for _ in 0..30 {
            if is_behind(behind) && self.is_off_crease(behind) {
                break;
            }
            behind = high.0 + 2.0 * (behind - high.0);
        }
        if !is_behind(behind) {
            return Found::Grazed;
        }
        for _ in 0..30 {
            if before <= 0.0 || self.is_off_crease(before) {
                break;
            }
            before = low.0 + 2.0 * (before - low.0);
        }
        Found::Crease([before.max(0.0), behind])
    }

    /// Returns true if the ray is off every crease at a length ahead, whatever the rounding of its coordinates.
    fn is_off_crease(&self, length: f64) -> bool {
        let around = self.ahead(length).at.map(|x| {
            let rounding = (8.0 * f64::EPSILON * x.abs()).max(LEAST_ROUNDING);
            Interval::new(x - rounding, x + rounding)
        });
        self.atlas.is_one_piece(around)
    }

    /// Shortens a step of this length and size so that it ends before a crease, or passes the crease if it is near and
    /// continues with steps of size `h`.
    fn approach(&mut self, found: &Found, [step, size]: [f64; 2], h: f64) -> Option<Attempt> {
        let [before, behind] = match found {
            Found::Steep => return Some(Attempt::Again(0.3 * size)),
            Found::Grazed => return None,
            Found::Nothing => return Some(Attempt::Ended(Status::WorkLimit)),
            Found::Crease(ends) => *ends,
        };
        let begins_there = self.s + before <= self.sharpness(step);
        let is_edge = self.atlas.layout.beyond_edge(self.ahead(behind).at);
        if begins_there || is_edge.is_some() {
            return None;
        }
        if behind <= self.nearness() {
            return Some(self.pass_crease([before, behind], h));
        }
        let share = (before * (1.0 - COARSE) / step).min(SHORTER);
        Some(Attempt::Again(share * size))
    }

    /// Returns the length to which a crease within a step of this length is located.
    fn sharpness(&self, step: f64) -> f64 {
        let scale = self.atlas.layout.scale.size.min(self.s + step);
        (SHARP * scale).max(2.0 * self.rounding())
    }

    /// Returns the length along which the ray is a parabola up to rounding.
    fn nearness(&self) -> f64 {
        let radius = 1.0 / length(self.local.tangents, self.local.acceleration);
        NEAR * self.atlas.layout.scale.size.min(radius)
    }

    /// Returns the state at a length ahead, on the parabola.
    fn ahead(&self, length: f64) -> State {
        let State { at, velocity } = self.state;
        let a = self.local.acceleration;
        State {
            at: [0, 1].map(|k| at[k] + length * (velocity[k] + 0.5 * length * a[k])),
            velocity: [0, 1].map(|k| velocity[k] + length * a[k]),
        }
    }

    /// Continues behind a crease that is between two lengths ahead, both within the parabola.
    fn pass_crease(&mut self, [before, behind]: [f64; 2], h: f64) -> Attempt {
        let [mut near, far] = [before, behind].map(|length| self.ahead(length));
        let jets = [near, far].map(|state| self.atlas.jet(state.at));
        // By the mean of the accelerations at both ends the velocity is as accurate as the position.
        let last = acceleration(&jets[0], near.velocity);
        for (k, velocity) in near.velocity.iter_mut().enumerate() {
            *velocity += 0.5 * before * (last[k] - self.local.acceleration[k]);
        }
        let sides = BothSides::new(&jets, self.atlas.embedded);
        let gap = [0, 1].map(|k| far.at[k] - near.at[k]);
        if sides.are_steep(gap) {
            // A pole of the metric.
            return Attempt::Ended(stalled_at(self.atlas, self.plain().at));
        }
        let scale = self.atlas.layout.scale.size.min(self.s + h);
        let passage = self.passage(&sides, &near, &far, scale);
        let rounding = self.rounding();
        let curvature = self.local.curvature;
        let drift = |length: f64| {
            let falls = curvature * length;
            [[1.0 - 0.5 * length * falls, length], [-falls, 1.0]]
        };
        self.advance(before, drift(before), rounding);
        self.state = near;
        self.local.tangents = [jets[0].du, jets[0].dv];
        let Some(passage) = passage else {
            // Not a crease but a tear, or a pole: the ray's continuation is undetermined.
            return Attempt::Ended(match stalled_at(self.atlas, self.plain().at) {
                Status::ConePoint => Status::ConePoint,
                _ => Status::Undefined,
            });
        };
        self.note_field();
        self.cost.steps += 1;
        let bends = (scale * passage.field_change).abs() > NOTICED;
        self.creases += usize::from(passage.refracts || bends);
        self.advance(
            behind - before,
            [[1.0, behind - before], [passage.field_change, 1.0]],
            0.0,
        );
        self.state = State {
            at: far.at,
            velocity: passage.velocity,
        };
        let Some(local) = self.atlas.local(&self.chart, self.state) else {
            return Attempt::Ended(stalled_at(self.atlas, self.plain().at));
        };
        self.local = local;
        // Earlier steps do not predict the steps behind the crease.
        self.control.forget();
        if self.enter_next_chart() {
            Attempt::Accepted(Some(h))
        } else {
            Attempt::Ended(stalled_at(self.atlas, self.plain().at))
        }
    }

    /// Adds a short length to the ray's own, and propagates its field and its errors.
    fn advance(&mut self, length: f64, propagator: [[f64; 2]; 2], rounding: f64) {
        let [m, rate] = self.field;
        self.field = propagator.map(|[n, k]| n * m + k * rate);
        if let Some(conjugates) = &mut self.observers.conjugates
            && m * self.field[0] < 0.0
        {
            conjugates.push(self.s + length * m / (m - self.field[0]));
        }
        self.s += length;
        self.errors.add(propagator, rounding, 0.0);
    }

    /// Returns the continuation behind a crease; `None` where the two sides do not have a direction in common.
    fn passage(
        &self,
        sides: &BothSides<'_>,
        near: &State,
        far: &State,
        scale: f64,
    ) -> Option<Passage> {
        let jets = sides.jets;
        let gap = norm(combine(1.0, jets[1].position, -1.0, jets[0].position));
        if self.atlas.embedded && gap > TORN * scale {
            return None;
        }
        let (first, second) = sides.common_directions()?;
        // Of two directions in which metrics agree, one is the crease's.
        let along = match second {
            None => first,
            Some(_) if self.is_along(near, far, jets, first) => first,
            Some(second) if self.is_along(near, far, jets, second) => second,
            Some(_) => return None,
        };
        sides.passage(near.velocity, along)
    }

    /// Returns whether both sides continue along a direction, slightly off the crease.
    fn is_along(&self, near: &State, far: &State, jets: &[Jet; 2], along: [f64; 2]) -> bool {
        let scale = self.atlas.layout.scale.size;
        let way = 1e-4 * scale / length([jets[0].du, jets[0].dv], along);
        let off = 1e-6 * scale;
        // Off the crease at a right angle, to the side to which the ray goes: it may cross the crease at a small angle.
        let metric = Metric::of(&jets[0]);
        let left = metric.turn_left(TangentVector(along)).0;
        let goes_left = along[0] * near.velocity[1] - along[1] * near.velocity[0] > 0.0;
        let turned = along[0] * left[1] - along[1] * left[0] > 0.0;
        let side = if goes_left == turned { 1.0 } else { -1.0 };
        let across = side / length([jets[0].du, jets[0].dv], left);
        let form = |jet: &Jet| {
            [
                dot(jet.du, jet.du),
                dot(jet.du, jet.dv),
                dot(jet.dv, jet.dv),
            ]
        };
        let [before, after] = [&jets[0], &jets[1]].map(form);
        let gap = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).abs()).sum::<f64>();
        [-way, way].into_iter().all(|way| {
            [(near, -off), (far, off)].into_iter().all(|(state, off)| {
                let at = [0, 1].map(|k| state.at[k] + way * along[k] + off * across * left[k]);
                let found = form(&self.atlas.jet(at));
                (gap(found, before) < gap(found, after)) == (off < 0.0)
            })
        })
    }
}

fn length(tangents: [[f64; 3]; 2], a: [f64; 2]) -> f64 {
    norm(combine(a[0], tangents[0], a[1], tangents[1]))
}
