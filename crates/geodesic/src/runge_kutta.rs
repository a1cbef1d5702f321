//! One step of an explicit Runge–Kutta pair along a geodesic: state and step length in, state and error out.
//!
//! Beside the geodesic the step carries two Jacobi fields y'' = −K y, the fundamental solution over this step: how
//! an error sideways, or one in direction, at its start becomes an error at its end. They cost no evaluation. The Jacobi
//! equation: do Carmo, *Differential Geometry of Curves and Surfaces*, 1976, section 5-5.

mod tableau;

pub(crate) use tableau::{DOP853, DOPRI5, RK4, Tableau};

use crate::chart::{Atlas, Chart, Local, State};
use crate::metric::{combine, norm};
use crate::surface::Surface;

/// Point, velocity, the fields (m, m'), (n, n') with m(0) = 0, m'(0) = 1, n(0) = 1, n'(0) = 0, and the arc length.
type StateVector = [f64; 9];

/// The parameter in which a step's size is measured.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum StepParameter {
    /// Arc length.
    Length,
    /// In (u,v), the way in the coordinates, measured by the metric that the step starts with: where a metric all but
    /// degenerates, as on the rim of a flat ellipsoid, coordinates are smooth functions of this when they are none of
    /// arc length.
    Coordinates,
}

const MOST_STAGES: usize = 13;

/// The result of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    /// Where it ends, in the same chart.
    pub(crate) end: State,
    /// The estimated error of the point, in the surface's units.
    pub(crate) position_error: f64,
    /// The estimated error of the unit velocity.
    pub(crate) direction_error: f64,
    /// [[n, m], [n', m']] over the step.
    pub(crate) propagator: [[f64; 2]; 2],
    /// Its arc length.
    pub(crate) length: f64,
    /// The estimated relative error of the Jacobi fields.
    pub(crate) field_error: f64,
    /// The local data at the end, where the pair evaluated them.
    pub(crate) end_local: Option<Local>,
}

/// Takes one step of size `h`, as `pace` measures it, from a point with its local data. `None` where a stage is undefined.
pub(crate) fn step<S: Surface + ?Sized>(
    atlas: &Atlas<'_, S>,
    chart: &Chart,
    tableau: &Tableau,
    start: State,
    local: &Local,
    h: f64,
    pace: StepParameter,
) -> Option<Step> {
    let [along_u, along_v] = local.tangents;
    let way = |state: &StateVector| norm(combine(state[2], along_u, state[3], along_v));
    let state: StateVector = [
        start.at[0],
        start.at[1],
        start.velocity[0],
        start.velocity[1],
        0.0,
        1.0,
        1.0,
        0.0,
        0.0,
    ];
    let start_way = way(&state);
    let even = pace == StepParameter::Length || !matches!(chart, Chart::Plain);
    let derivative = |state: &StateVector, local: &Local| {
        let rate = if even { 1.0 } else { start_way / way(state) };
        derivative(state, local).map(|x| rate * x)
    };
    let mut stages = [[0.0; 9]; MOST_STAGES];
    stages[0] = derivative(&state, local);
    let mut count = 1;
    for row in tableau.stages {
        let at = advance(&state, h, row, &stages);
        let local = atlas.local(chart, state_from(&at))?;
        stages[count] = derivative(&at, &local);
        count += 1;
    }
    let end = advance(&state, h, tableau.weights, &stages);
    if !end.iter().all(|x| x.is_finite()) {
        return None;
    }
    let mut end_local = None;
    if tableau.error.len() > count {
        let local = atlas.local(chart, state_from(&end))?;
        stages[count] = derivative(&end, &local);
        end_local = Some(local);
    }
    let error = advance(&[0.0; 9], h, tableau.error, &stages);
    let low = advance(&[0.0; 9], h, tableau.low_error, &stages);
    let length = |x: f64, y: f64| norm(combine(x, local.tangents[0], y, local.tangents[1]));
    // The two estimates of DOP853 as its authors combine them (Hairer, Nørsett, Wanner I, section II.10), in the metric.
    let tempered = |high: f64, low: f64| {
        let root = (high * high + 0.01 * low * low).sqrt();
        if low > 0.0 && root > 0.0 {
            high * (high / root)
        } else {
            high
        }
    };
    // Lengths in units of the step, so that all four count alike.
    let fields = |e: &StateVector| {
        (e[4] / h)
            .abs()
            .max(e[5].abs())
            .max(e[6].abs())
            .max((e[7] * h).abs())
    };
    let field_error = tempered(fields(&error), fields(&low)) / fields(&end).max(1.0);
    Some(Step {
        length: end[8],
        field_error,
        end: state_from(&end),
        position_error: tempered(length(error[0], error[1]), length(low[0], low[1]))
            .max(tempered(error[8].abs(), low[8].abs())),
        direction_error: tempered(length(error[2], error[3]), length(low[2], low[3])),
        propagator: [[end[6], end[4]], [end[7], end[5]]],
        end_local,
    })
}

/// The point and the velocity in a vector.
fn state_from(state: &StateVector) -> State {
    State {
        at: [state[0], state[1]],
        velocity: [state[2], state[3]],
    }
}

fn derivative(state: &StateVector, local: &Local) -> StateVector {
    let [_, _, x, y, m, m1, n, n1, _] = *state;
    let [a, b] = local.acceleration;
    let k = local.curvature;
    [x, y, a, b, m1, -k * m, n1, -k * n, 1.0]
}

fn advance(
    state: &StateVector,
    h: f64,
    weights: &[f64],
    stages: &[StateVector; MOST_STAGES],
) -> StateVector {
    let mut sum = [0.0; 9];
    for (&weight, stage) in weights.iter().zip(stages) {
        if weight != 0.0 {
            for (sum, &slope) in sum.iter_mut().zip(stage) {
                *sum += weight * slope;
            }
        }
    }
    std::array::from_fn(|k| state[k] + h * sum[k])
}
