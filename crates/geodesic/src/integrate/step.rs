//! One step of one ray, in its chart.

use super::ray::Ray;
use crate::chart::{Atlas, Chart, Local, State};
use crate::runge_kutta::{self, GeodesicEquation, RatesOfChange, States, StepParameter};
use crate::vector::{combine, norm};

/// The maximum number of a pair's evaluations in a step, including the one at its start.
const SLOPES: usize = 13;

/// The surface is undefined at a stage of a step.
struct Undefined;

/// The geodesic equation of one ray.
struct Equation<'a, 's> {
    atlas: &'a Atlas<'s>,
    chart: &'a Chart,
}

impl GeodesicEquation<1> for Equation<'_, '_> {
    type Local = Local;
    type Undefined = Undefined;

    #[inline(always)]
    fn evaluate(&self, states: &States<1>, local: &mut Local) -> Result<(), Undefined> {
        *local = (self.atlas.local(self.chart, state(states))).ok_or(Undefined)?;
        Ok(())
    }
}

impl RatesOfChange<1> for Local {
    #[inline(always)]
    fn slope(&self, states: &States<1>) -> States<1> {
        let acceleration = self.acceleration.map(|x| [x]);
        runge_kutta::chart_slope(states, acceleration, [self.curvature])
    }

    #[inline(always)]
    fn way(&self, [[x], [y], ..]: &States<1>) -> [f64; 1] {
        [norm(combine(*x, self.tangents[0], *y, self.tangents[1]))]
    }

    #[inline(always)]
    fn speed(&self, [_, _, [x], [y], ..]: &States<1>) -> [f64; 1] {
        [norm(combine(*x, self.tangents[0], *y, self.tangents[1]))]
    }
}

/// The result of a ray's step.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayStep {
    /// Its end, in the same chart.
    pub(super) end: State,
    /// Its arc length.
    pub(super) length: f64,
    /// The estimated error of the point, in the surface's units.
    pub(super) position_error: f64,
    /// The estimated error of the unit velocity.
    pub(super) direction_error: f64,
    /// The estimated relative error of the Jacobi fields.
    pub(super) field_error: f64,
    /// [[n, m], [n', m']] over the step.
    pub(super) propagator: [[f64; 2]; 2],
    /// The local data at the end, if the pair evaluated them.
    pub(super) end_local: Option<Local>,
}

impl Ray<'_, '_> {
    /// Computes a step without changing the ray. `None` where a stage is undefined, or the end is not finite.
    pub(super) fn step(&self, h: f64, pace: StepParameter) -> Option<RayStep> {
        let equation = Equation {
            atlas: self.atlas,
            chart: &self.chart,
        };
        let State { at, velocity } = self.state;
        let start = [at[0], at[1], velocity[0], velocity[1], 0.0, 1.0, 1.0, 0.0].map(|x| [x]);
        let pace = match self.chart {
            Chart::Plain => pace,
            Chart::Apex(_) => StepParameter::Length,
        };
        let step = runge_kutta::step::<1, 8, SLOPES, _>(
            &equation,
            self.plan.tableau,
            &start,
            &self.local,
            h,
            pace,
        )
        .ok()?;
        if !(step.end.as_flattened().iter().all(|x| x.is_finite()) && step.length[0].is_finite()) {
            return None;
        }
        let [.., [m], [m1], [n], [n1]] = step.end;
        Some(RayStep {
            end: state(&step.end),
            length: step.length[0],
            position_error: step.position_error[0],
            direction_error: step.direction_error[0],
            field_error: step.field_error(h),
            propagator: [[n, m], [n1, m1]],
            end_local: step.evaluated_end.then_some(step.local),
        })
    }
}

/// Returns the point and the velocity of one ray.
#[inline(always)]
fn state([[a], [b], [x], [y], ..]: &States<1>) -> State {
    State {
        at: [*a, *b],
        velocity: [*x, *y],
    }
}
