//! Creases, where σ is continuous and its derivatives are not (|u|, max, min): detected by a jump of the speed, located
//! by bisection, and crossed with the angle to the crease preserved.
//!
//! Unfolded about the crease both sides are one plane to first order, and a geodesic is a straight line in it: the
//! components of the velocity along and across the crease keep their lengths. This is the rule for the edges of a polyhedron
//! (Mitchell, Mount, Papadimitriou, *The discrete geodesic problem*, SIAM J. Comput. 16, 1987, pages 647–668).

use super::ray::{Attempt, Ray};
use super::stalled_at;
use super::step::RayStep;
use crate::chart::{Chart, Local, State};
use crate::runge_kutta::StepParameter;
use crate::status::Status;
use crate::vector::{combine, dot, norm};

/// The minimum change of the speed within a step that is investigated.
const NOTICED: f64 = 1e-9;
/// The same as a multiple of the error that the tolerance allows.
const NOTICED_BEYOND: f64 = 30.0;
/// The fraction of its change of the speed that a jump keeps while its bracket is halved.
const STAYS: f64 = 0.3;
/// A crease is located to this fraction of the ray's scale.
const SHARP: f64 = 1e-14;
/// The maximum relative difference of the quantities that both sides must have in common.
const COMMON: f64 = 1e-6;

/// The maximum change of direction and speed in a step over a kink, which is 10⁻¹² of the scale long; at a singularity the
/// curvature would cause a larger one.
const HARDLY: f64 = 1e-9;

/// The cause of a change of the speed.
enum Found {
    /// No localised cause: the surface is steep there.
    Steep,
    /// A crease between two step sizes, with the rays' ends there.
    Jump(Box<[(RayStep, Local); 2]>),
    /// The evaluations are used up.
    Nothing,
}

impl Ray<'_, '_> {
    /// Returns the outcome of a step that has crossed a crease; `None` where the step may be accepted. `allowed` is the
    /// error that the tolerance allows on the way.
    pub(super) fn crease(
        &mut self,
        step: &RayStep,
        local: &Local,
        h: f64,
        pace: StepParameter,
        allowed: f64,
    ) -> Option<Attempt> {
        if !matches!(self.chart, Chart::Plain) {
            return None;
        }
        let scale = self.atlas.layout.scale.size.min(self.s + step.length);
        let speed = self.speed();
        let change =
            |state: &State, local: &Local| length(local.tangents, state.velocity) / speed - 1.0;
        let jump = change(&step.end, local);
        if jump.abs() <= NOTICED + NOTICED_BEYOND * allowed / scale {
            return None;
        }
        match self.locate(step, *local, h, pace, &|state, local| change(state, local)) {
            Found::Steep => Some(Attempt::Again(0.3 * h)),
            Found::Nothing => Some(Attempt::Ended(Status::WorkLimit)),
            Found::Jump(ends) => {
                let [before, after] = *ends;
                if before.0.position_error > allowed {
                    return Some(Attempt::Again(0.5 * h));
                }
                Some(self.pass_crease(before, after, pace, h))
            }
        }
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

    fn locate(
        &mut self,
        step: &RayStep,
        local: Local,
        h: f64,
        pace: StepParameter,
        change: &dyn Fn(&State, &Local) -> f64,
    ) -> Found {
        let jump = change(&step.end, &local);
        let (mut low, mut high) = (0.0, h);
        let start = RayStep {
            end: self.state,
            length: 0.0,
            position_error: 0.0,
            direction_error: 0.0,
            field_error: 0.0,
            propagator: [[1.0, 0.0], [0.0, 1.0]],
            end_local: Some(self.local),
        };
        let mut before = (start, self.local, 0.0);
        let mut after = (*step, local, jump);
        while high - low > SHARP * self.atlas.layout.scale.size.min(h.max(1e-3 * self.s)) {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if !self.affords_step() {
                return Found::Nothing;
            }
            let Some(part) = self.step(middle, pace) else {
                return Found::Steep;
            };
            let Some(local) = self.local_after(&part) else {
                return Found::Steep;
            };
            let there = change(&part.end, &local);
            if (there - before.2).abs() > (there - after.2).abs() {
                high = middle;
                after = (part, local, there);
            } else {
                low = middle;
                before = (part, local, there);
            }
            if (after.2 - before.2).abs() < STAYS * jump.abs() {
                return Found::Steep;
            }
        }
        Found::Jump(Box::new([(before.0, before.1), (after.0, after.1)]))
    }

    /// Takes the step up to a crease and continues behind it.
    fn pass_crease(
        &mut self,
        before: (RayStep, Local),
        after: (RayStep, Local),
        pace: StepParameter,
        h: f64,
    ) -> Attempt {
        let rounding = self.rounding();
        let scale = self.atlas.layout.scale.size.min(self.s + h);
        let (near, here) = before;
        let (far, there) = after;
        let torn = self.atlas.embedded && {
            let gap = self.atlas.gap(near.end.at, far.end.at);
            gap > COMMON * scale
        };
        let behind = if torn {
            None
        } else {
            self.refracted(&near.end, here.tangents, &far.end, there.tangents)
        };
        self.accept(&near, here, near.length.min(h), pace, rounding, scale);
        let Some(velocity) = behind else {
            // Not a crease but a tear, or a pole: the ray's continuation is undetermined.
            return Attempt::Ended(match stalled_at(self.atlas, self.plain().at) {
                Status::ConePoint => Status::ConePoint,
                _ => Status::Undefined,
            });
        };
        self.creases += 1;
        self.s += far.length - near.length;
        self.state = State {
            at: far.end.at,
            velocity,
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

    /// Returns the velocity behind a crease: the components along and across it keep their lengths. `None` where the
    /// two sides do not have a direction in common.
    fn refracted(
        &self,
        near: &State,
        here: [[f64; 3]; 2],
        far: &State,
        there: [[f64; 3]; 2],
    ) -> Option<[f64; 2]> {
        let candidates = if self.atlas.embedded {
            [Some(common_direction(here, there)?), None]
        } else {
            common_lengths(here, there)?
        };
        let along = candidates
            .into_iter()
            .flatten()
            .find(|&along| self.atlas.embedded || self.is_along(near, here, far, there, along))?;
        let size = length(here, along);
        if (length(there, along) / size - 1.0).abs() > COMMON {
            return None;
        }
        let along = along.map(|x| x / size);
        let v = near.velocity;
        let share = inner(here, v, along);
        let across = [0, 1].map(|k| v[k] - share * along[k]);
        let height = length(here, across);
        let tilt = inner(there, across, along);
        let upright = [0, 1].map(|k| across[k] - tilt * along[k]);
        let size = length(there, upright);
        if !(size > 0.0 && size.is_finite()) {
            return None;
        }
        Some([0, 1].map(|k| share * along[k] + height / size * upright[k]))
    }

    /// Returns whether both sides continue along a direction, slightly off the crease: of the two directions in which
    /// metrics agree, one is the crease's.
    fn is_along(
        &self,
        near: &State,
        here: [[f64; 3]; 2],
        far: &State,
        there: [[f64; 3]; 2],
        along: [f64; 2],
    ) -> bool {
        let scale = self.atlas.layout.scale.size;
        let (way, off) = (1e-4 * scale / length(here, along), 1e-6 * scale);
        let form = |t: [[f64; 3]; 2]| [dot(t[0], t[0]), dot(t[0], t[1]), dot(t[1], t[1])];
        let (before, after) = (form(here), form(there));
        let gap = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).abs()).sum::<f64>();
        [-way, way].into_iter().all(|way| {
            [(near, -off), (far, off)].into_iter().all(|(state, off)| {
                let at = [0, 1].map(|k| state.at[k] + way * along[k] + off * near.velocity[k]);
                let jet = self.atlas.jet(at);
                let found = form([jet.du, jet.dv]);
                (gap(found, before) < gap(found, after)) == (off < 0.0)
            })
        })
    }
}

fn inner(tangents: [[f64; 3]; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let vector = |x: [f64; 2]| combine(x[0], tangents[0], x[1], tangents[1]);
    dot(vector(a), vector(b))
}

fn length(tangents: [[f64; 3]; 2], a: [f64; 2]) -> f64 {
    norm(combine(a[0], tangents[0], a[1], tangents[1]))
}

/// Returns the direction in (u,v) in which both sides have the same derivative of σ.
fn common_direction(here: [[f64; 3]; 2], there: [[f64; 3]; 2]) -> Option<[f64; 2]> {
    let [u, v] = [0, 1].map(|k| combine(1.0, there[k], -1.0, here[k]));
    let (largest, size) = if norm(u) >= norm(v) {
        (u, norm(u))
    } else {
        (v, norm(v))
    };
    let unit = largest.map(|x| x / size);
    let (a, b) = (dot(u, unit), dot(v, unit));
    // The difference must have rank one.
    let rest = norm(combine(1.0, u, -a, unit)).max(norm(combine(1.0, v, -b, unit)));
    let typical = norm(here[0]).max(norm(here[1])).max(size);
    (size > 0.0 && rest <= COMMON * typical).then_some([b, -a])
}

/// Returns the directions in (u,v) to which both sides assign the same length.
fn common_lengths(here: [[f64; 3]; 2], there: [[f64; 3]; 2]) -> Option<[Option<[f64; 2]>; 2]> {
    let form = |t: [[f64; 3]; 2]| [dot(t[0], t[0]), dot(t[0], t[1]), dot(t[1], t[1])];
    let (before, after) = (form(here), form(there));
    let [e, f, g] = [0, 1, 2].map(|k| after[k] - before[k]);
    let square = f * f - e * g;
    let size = (f * f).max((e * g).abs());
    if square < -COMMON * size {
        return None;
    }
    let root = square.max(0.0).sqrt();
    let pair = |sign: f64| {
        if e.abs() >= g.abs() {
            [-f + sign * root, e]
        } else {
            [g, -f + sign * root]
        }
    };
    Some([Some(pair(1.0)), (root > 0.0).then(|| pair(-1.0))])
}

#[cfg(test)]
mod tests {
    use super::{common_lengths, length};

    #[test]
    fn both_sides_give_the_same_length_to_the_common_directions() {
        let here = [[1.0, 0.0, 0.0], [0.2, 1.0, 0.0]];
        for there in [
            [[0.7, 0.0, 0.1], [0.4, 1.3, 0.0]],
            [[1.3, 0.0, 0.1], [0.4, 0.8, 0.0]],
            [[0.9, 0.0, 0.1], [0.4, 1.8, 0.0]],
        ] {
            let found = common_lengths(here, there).expect("lengths that agree somewhere");
            let directions: Vec<[f64; 2]> = found.into_iter().flatten().collect();
            assert_eq!(directions.len(), 2);
            for direction in directions {
                let lengths = [here, there].map(|tangents| length(tangents, direction));
                assert!(lengths[0] > 0.1, "{direction:?}");
                assert!((lengths[1] / lengths[0] - 1.0).abs() < 1e-12, "{lengths:?}");
            }
        }
        // Longer in every direction.
        let there = here.map(|tangent| tangent.map(|x| 2.0 * x));
        assert_eq!(common_lengths(here, there), None);
    }
}
