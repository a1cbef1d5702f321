//! One step of an explicit Runge–Kutta pair along geodesics, for one ray or several side by side. In: states and a step
//! length. Out: states and errors.
//!
//! Along each geodesic the step integrates two Jacobi fields y'' = −K y, the fundamental solution over this step: how an
//! error in position or in direction at its start propagates to its end. They cost no evaluation. The Jacobi equation:
//! do Carmo, *Differential Geometry of Curves and Surfaces*, 1976, section 5-5.
//!
//! The innermost loops run over the rays, so that the compiler vectorises them where there are several.

#![allow(clippy::needless_range_loop)] // Several arrays are traversed together, ray by ray.

mod tableau;

pub(crate) use tableau::{DOP853, DOPRI5, RK4, Tableau};

/// The states of several rays: point, velocity, and the fields (m, m'), (n, n') of y'' = −K y with m' = 1 and n = 1 at
/// the step's start. Eight components in a chart, where points have two coordinates; ten in space, where they have
/// three.
pub(crate) type States<const N: usize, const C: usize = 8> = [[f64; N]; C];

/// The geodesic equation of `N` rays in common coordinates.
pub(crate) trait GeodesicEquation<const N: usize, const C: usize = 8> {
    /// The local data of the surface at the rays' points.
    type Local: RatesOfChange<N, C>;

    /// The error of an evaluation after which a step cannot continue. Rays side by side have none, since only one of them
    /// may be undefined.
    type Undefined;

    /// Evaluates the local data at the states' points.
    fn evaluate(
        &self,
        states: &States<N, C>,
        local: &mut Self::Local,
    ) -> Result<(), Self::Undefined>;
}

/// The rates of change that a step needs from the local data.
pub(crate) trait RatesOfChange<const N: usize, const C: usize = 8>: Default {
    /// The derivatives of the states by arc length.
    fn slope(&self, states: &States<N, C>) -> States<N, C>;
    /// The lengths of the states' points taken as tangent vectors, for differences of points.
    fn way(&self, states: &States<N, C>) -> [f64; N];
    /// The lengths of the states' velocities.
    fn speed(&self, states: &States<N, C>) -> [f64; N];
}

/// The parameter in which a step's size is measured.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum StepParameter {
    /// Arc length.
    Length,
    /// In (u,v), the distance in the coordinates, measured by the metric at the step's start. Where a metric nearly
    /// degenerates, as on the rim of a flat ellipsoid, coordinates are smooth functions of this parameter but not of
    /// arc length.
    Coordinates,
}

/// The result of a step.
pub(crate) struct Step<const N: usize, L, const C: usize = 8> {
    pub(crate) end: States<N, C>,
    /// Its arc lengths.
    pub(crate) length: [f64; N],
    /// The estimated errors of the points, in the surface's units.
    pub(crate) position_error: [f64; N],
    /// The estimated errors of the unit velocities.
    pub(crate) direction_error: [f64; N],
    /// The estimated error, component by component.
    pub(crate) error: States<N, C>,
    /// The local data of the last evaluation.
    pub(crate) local: L,
    /// True if that was at the step's end.
    pub(crate) evaluated_end: bool,
}

impl<L, const C: usize> Step<1, L, C> {
    /// Returns the estimated relative error of the Jacobi fields of the only ray.
    pub(crate) fn field_error(&self, h: f64) -> f64 {
        field_size(h, &self.error, 0) / field_size(h, &self.end, 0).max(1.0)
    }
}

/// Takes one step of size `h`, as measured by `pace`, from points with their local data. `SLOPES` is at least the number of
/// the pair's evaluations, including the one at the start.
#[inline(always)]
pub(crate) fn step<
    const N: usize,
    const C: usize,
    const SLOPES: usize,
    E: GeodesicEquation<N, C>,
>(
    equation: &E,
    tableau: &Tableau,
    start: &States<N, C>,
    local: &E::Local,
    h: f64,
    pace: StepParameter,
) -> Result<Step<N, E::Local, C>, E::Undefined> {
    let even = pace == StepParameter::Length;
    let mut rates = [[1.0; N]; SLOPES];
    let mut slopes = [[[0.0; N]; C]; SLOPES];
    slopes[0] = local.slope(start);
    let mut state = *start;
    let mut last = E::Local::default();
    let stages = tableau.stages.len();
    let evaluated_end = tableau.error.len() > stages + 1;
    for stage in 0..=stages {
        let at_end = stage == stages;
        let row = if at_end {
            tableau.weights
        } else {
            tableau.stages[stage]
        };
        state = add(start, h, row, &slopes);
        if at_end && !evaluated_end {
            break;
        }
        equation.evaluate(&state, &mut last)?;
        slopes[stage + 1] = last.slope(&state);
        if !even {
            let before = local.speed(start);
            let way = local.speed(&state);
            for ray in 0..N {
                let rate = before[ray] / way[ray];
                rates[stage + 1][ray] = rate;
                for component in &mut slopes[stage + 1] {
                    component[ray] *= rate;
                }
            }
        }
    }
    let nothing = [[0.0; N]; C];
    let mut error = add(&nothing, h, tableau.error, &slopes);
    let mut position_error = local.way(&error);
    let mut direction_error = local.speed(&error);
    if !tableau.low_error.is_empty() {
        let low = add(&nothing, h, tableau.low_error, &slopes);
        let position = local.way(&low);
        let direction = local.speed(&low);
        for ray in 0..N {
            position_error[ray] = tempered(position_error[ray], position[ray]);
            direction_error[ray] = tempered(direction_error[ray], direction[ray]);
            let (high, low) = (field_size(h, &error, ray), field_size(h, &low, ray));
            for field in C - 4..C {
                error[field][ray] *= tempered(high, low) / high.max(f64::MIN_POSITIVE);
            }
        }
    }
    let mut length = [h; N];
    if !even {
        for ray in 0..N {
            let sum = |weights: &[f64]| -> f64 {
                let terms = weights.iter().zip(&rates);
                h * terms.map(|(weight, rate)| weight * rate[ray]).sum::<f64>()
            };
            length[ray] = sum(tableau.weights);
            let error = tempered(sum(tableau.error), sum(tableau.low_error));
            position_error[ray] = position_error[ray].max(error);
        }
    }
    Ok(Step {
        end: state,
        length,
        position_error,
        direction_error,
        error,
        local: last,
        evaluated_end,
    })
}

/// Combines the two estimates of DOP853 as its authors do (Hairer, Nørsett, Wanner I, section II.10).
#[inline(always)]
fn tempered(high: f64, low: f64) -> f64 {
    let (high, low) = (high.abs(), low.abs());
    let root = (high * high + 0.01 * low * low).sqrt();
    if low > 0.0 && root > 0.0 {
        high * (high / root)
    } else {
        high
    }
}

/// Returns the magnitude of a ray's fields after a step of length `h`: lengths in units of the step, so that all four
/// have equal weight.
#[inline(always)]
fn field_size<const N: usize, const C: usize>(h: f64, state: &States<N, C>, ray: usize) -> f64 {
    let [m, m1, n, n1] = [4, 3, 2, 1].map(|k| state[C - k][ray]);
    let ends = (m / h).abs().max((n1 * h).abs());
    ends.max(m1.abs()).max(n.abs())
}

/// Returns the derivatives of states by arc length, in the coordinates of a chart.
#[inline(always)]
pub(crate) fn chart_slope<const N: usize>(
    state: &States<N>,
    [a, b]: [[f64; N]; 2],
    curvature: [f64; N],
) -> States<N> {
    let [_, _, x, y, m, m1, n, n1] = *state;
    let (mut bent_m, mut bent_n) = ([0.0; N], [0.0; N]);
    for ray in 0..N {
        bent_m[ray] = -curvature[ray] * m[ray];
        bent_n[ray] = -curvature[ray] * n[ray];
    }
    [x, y, a, b, m1, bent_m, n1, bent_n]
}

/// Returns `state` plus the weighted slopes, times `h`.
#[inline(always)]
fn add<const N: usize, const C: usize>(
    state: &States<N, C>,
    h: f64,
    weights: &[f64],
    slopes: &[States<N, C>],
) -> States<N, C> {
    let mut sum = [[0.0; N]; C];
    for (&weight, slope) in weights.iter().zip(slopes) {
        if weight != 0.0 {
            for k in 0..C {
                for ray in 0..N {
                    sum[k][ray] += weight * slope[k][ray];
                }
            }
        }
    }
    let mut end = *state;
    for k in 0..C {
        for ray in 0..N {
            end[k][ray] += h * sum[k][ray];
        }
    }
    end
}
