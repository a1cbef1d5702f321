//! The coordinates in which a geodesic is integrated: (u,v) themselves, or Cartesian coordinates about an apex.
//!
//! In: a point and a velocity in chart coordinates. Out: the acceleration there, and the local data that error control
//! needs. Points beyond a side that wraps are brought back into the domain, so the surface's formula is never evaluated
//! outside it.

mod apex;
mod layout;

pub(crate) use apex::{ApexChart, rotated, turned};
pub(crate) use layout::ChartLayout;

use std::cell::Cell;

use expr::interval::Interval;

use crate::interpolate::MIDDLE_OF_SIX;
use crate::metric::{acceleration, gaussian_curvature, minus_components};
use crate::point::Uv;
use crate::status::Status;
use crate::step_path::{Borders, PathPart};
use crate::surface::{Jet, Side, Surface};
use crate::vector::{combine, cross, dot, norm};

/// The number of proofs that a box is smooth that count as one evaluation: they take the values of a few corners alone, not all
/// derivatives.
pub(crate) const PROOFS_PER_EVALUATION: u64 = 8;
/// Within this fraction of its radius from an apex, directions are those at this distance.
const TINY: f64 = 1e-14;
/// The surface is degenerate where a tangent vector is shorter than its typical length by this factor, or the sine of
/// the angle between the two is below it.
const THIN: f64 = 1e-3;

/// The coordinates in use.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Chart {
    /// (u, v).
    Plain,
    /// (a, b) = r (cos k(t−t₀), sin k(t−t₀)) about an apex.
    Apex(ApexChart),
}

/// A point with its velocity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State {
    pub(crate) at: [f64; 2],
    pub(crate) velocity: [f64; 2],
}

/// The local data of the surface at a point.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Local {
    /// The second derivative of the coordinates.
    pub(crate) acceleration: [f64; 2],
    /// The Gaussian curvature.
    pub(crate) curvature: f64,
    /// The coordinates' tangent vectors.
    pub(crate) tangents: [[f64; 3]; 2],
    /// The relative amount by which the rounding of the coordinates turns or stretches the tangents. Nearer to a
    /// singular point than this, directions are meaningless.
    pub(crate) noise: f64,
}

/// A surface with its charts. It counts its evaluations.
pub(crate) struct Atlas<'s> {
    surface: &'s dyn Surface,
    pub(crate) layout: ChartLayout,
    /// True if vectors at different points may be compared.
    pub(crate) embedded: bool,
    evaluations: Cell<usize>,
    /// The number of boxes that were to be proven smooth.
    proofs: Cell<usize>,
}

impl<'s> Atlas<'s> {
    pub(crate) fn new(surface: &'s dyn Surface) -> Self {
        Self {
            surface,
            layout: ChartLayout::of(surface).for_one_ray(),
            embedded: surface.is_embedded(),
            evaluations: Cell::new(0),
            proofs: Cell::new(0),
        }
    }

    /// Returns the number of evaluations of the surface so far; proofs that a box is smooth count as some.
    pub(crate) fn evaluations(&self) -> usize {
        self.evaluations.get() + self.proofs.get() / PROOFS_PER_EVALUATION as usize
    }

    /// Returns the jet at a point that may be beyond sides that wrap, in the coordinates continued there.
    pub(crate) fn jet(&self, mut at: [f64; 2]) -> Jet {
        self.evaluations.set(self.evaluations.get() + 1);
        let crossing = self.layout.bring_back(&mut at);
        let mut jet = self.surface.jet(Uv(at));
        jet.reflect(crossing.signs);
        jet
    }

    /// Returns [`ChartLayout::smooth_piece`].
    pub(crate) fn smooth_piece(&self, at: [f64; 2]) -> u64 {
        self.layout.smooth_piece(self.surface, at)
    }

    /// Returns [`ChartLayout::off_crease`].
    pub(crate) fn off_crease(&self, at: [f64; 2], velocity: [f64; 2]) -> [f64; 2] {
        self.layout.off_crease(self.surface, at, velocity)
    }

    /// Returns [`ChartLayout::is_one_piece`].
    pub(crate) fn is_one_piece(&self, within: [Interval; 2]) -> bool {
        self.proofs.set(self.proofs.get() + 1);
        self.layout.is_one_piece(self.surface, within)
    }

    /// Returns [`ChartLayout::creases_along`].
    pub(crate) fn creases_along(&self, part: &PathPart<2>) -> Borders {
        self.proofs.set(self.proofs.get() + 1);
        self.layout.creases_along(self.surface, part)
    }

    /// Returns the distance between two points in (u,v): in space, or, without an embedding, by the metric at the first
    /// one. The second point is first replaced by its nearest periodic copy.
    pub(crate) fn gap(&self, a: [f64; 2], b: [f64; 2]) -> f64 {
        let jet = self.jet(a);
        if self.embedded {
            return norm(combine(1.0, jet.position, -1.0, self.jet(b).position));
        }
        let difference = [0, 1].map(|axis| {
            let difference = b[axis] - a[axis];
            let width = self.layout.width(axis);
            if self.layout.sides.of(axis)[0] == Side::Wrap {
                difference - width * (difference / width).round()
            } else {
                difference
            }
        });
        crate::metric::speed(&jet, difference)
    }

    /// Returns the reason why a ray cannot continue at a point of the domain.
    pub(crate) fn rank_at(&self, at: [f64; 2]) -> Status {
        let jet = self.jet(at);
        let vectors = [jet.position, jet.du, jet.dv, jet.duu, jet.duv, jet.dvv];
        let [su, sv] = [norm(jet.du), norm(jet.dv)];
        let sine = norm(cross(jet.du, jet.dv)) / (su * sv);
        let short =
            su < THIN * self.layout.scale.stretch[0] || sv < THIN * self.layout.scale.stretch[1];
        let infinite = vectors.iter().flatten().any(|x| x.is_infinite());
        if short || sine < THIN || infinite {
            Status::Degenerate
        } else {
            // Undefined here, or defined here and undefined at every distance beyond.
            Status::Undefined
        }
    }

    /// Returns the acceleration of a geodesic and the other local data; `None` where any of it is undefined.
    pub(crate) fn local(&self, chart: &Chart, state: State) -> Option<Local> {
        match chart {
            Chart::Plain => {
                let jet = self.jet(state.at);
                checked(Local {
                    acceleration: acceleration(&jet, state.velocity).0,
                    curvature: gaussian_curvature(&jet),
                    tangents: [jet.du, jet.dv],
                    noise: f64::EPSILON * self.turning(&jet, state.at),
                })
            }
            Chart::Apex(chart) => {
                let inner = chart.inner();
                let r = state.at[0].hypot(state.at[1]);
                if chart.is_interpolated() && r < inner {
                    return self.inner(chart, state, r, inner);
                }
                self.about_apex(chart, state)
            }
        }
    }

    /// Returns the relative amount by which a unit change of u or v turns or stretches the tangents. Without an
    /// embedding only the stretching is known: second derivatives depend on the choice of frame.
    fn turning(&self, jet: &Jet, at: [f64; 2]) -> f64 {
        let change = |tangent: [f64; 3], second: [f64; 3]| {
            if self.embedded {
                norm(second) / norm(tangent)
            } else {
                (dot(second, tangent) / dot(tangent, tangent)).abs()
            }
        };
        (at[0].abs() * change(jet.du, jet.duu)).max(at[1].abs() * change(jet.dv, jet.dvv))
    }

    /// Near a smooth pole: interpolates the acceleration from six points along a line, to sixth order in their
    /// distance.
    fn inner(&self, chart: &ApexChart, state: State, r: f64, inner: f64) -> Option<Local> {
        let along = if r > 0.0 {
            state.at.map(|x| x / r)
        } else {
            [1.0, 0.0]
        };
        let sample = |offset: f64| {
            let at = [0, 1].map(|k| state.at[k] + offset * along[k]);
            self.about_apex(chart, State { at, ..state })
        };
        let step = 2.0 * inner;
        let near = sample(step)?;
        let mut acceleration = [0.0; 2];
        let mut tangents = [[0.0; 3]; 2];
        let mut curvature = 0.0;
        for (n, weight) in (1..).zip(MIDDLE_OF_SIX) {
            let offset = step * f64::from(n);
            let forward = if n == 1 { near } else { sample(offset)? };
            let pair = [forward, sample(-offset)?];
            for (k, sum) in acceleration.iter_mut().enumerate() {
                *sum += weight * (pair[0].acceleration[k] + pair[1].acceleration[k]);
            }
            curvature += weight * (pair[0].curvature + pair[1].curvature);
            for (k, sum) in tangents.iter_mut().enumerate() {
                *sum = combine(1.0, *sum, weight, pair[0].tangents[k]);
                *sum = combine(1.0, *sum, weight, pair[1].tangents[k]);
            }
        }
        checked(Local {
            acceleration,
            curvature,
            tangents,
            ..near
        })
    }

    /// Applies the chain rule to the jet in (u,v), along the velocity alone. This loses fewer digits than transforming the
    /// whole jet, which rays integrated side by side need ([`ApexChart::radial_jet`]).
    fn about_apex(&self, chart: &ApexChart, state: State) -> Option<Local> {
        let [a, b] = state.at;
        let tiny = TINY * chart.radius;
        let (r, cos, sin) = match a.hypot(b) {
            r if r > tiny => (r, a / r, b / r),
            _ => (tiny, 1.0, 0.0),
        };
        let jet = self.jet(chart.plain_point([r * cos, r * sin]));
        let (power, rate) = (chart.apex.power, chart.apex.rate);
        // The radial parameter is base + sign r^power; these are its derivatives by r.
        let first = chart.slope(r);
        let second = first * (power - 1.0) / r;
        let (dw, dww, dt, dtt) = if chart.axis == 0 {
            (jet.du, jet.duu, jet.dv, jet.dvv)
        } else {
            (jet.dv, jet.dvv, jet.du, jet.duu)
        };
        let by_r = dw.map(|x| x * first);
        let by_rr = combine(first * first, dww, second, dw);
        let by_angle = dt.map(|x| x / rate);
        let by_angle_angle = dtt.map(|x| x / (rate * rate));
        let by_r_angle = jet.duv.map(|x| x * first / rate);
        let tangents = [
            combine(cos, by_r, -sin / r, by_angle),
            combine(sin, by_r, cos / r, by_angle),
        ];
        // The second derivative along the straight line in (a, b) with this velocity.
        let [x, y] = state.velocity;
        let radial = cos * x + sin * y;
        let turning = (cos * y - sin * x) / r;
        let mut along = combine(radial * radial, by_rr, 2.0 * radial * turning, by_r_angle);
        along = combine(1.0, along, turning * turning, by_angle_angle);
        along = combine(1.0, along, r * turning * turning, by_r);
        along = combine(1.0, along, -2.0 * radial * turning / r, by_angle);
        checked(Local {
            acceleration: minus_components(tangents[0], tangents[1], along),
            curvature: gaussian_curvature(&jet),
            tangents: if self.embedded {
                tangents
            } else {
                upright(tangents)
            },
            noise: 0.0,
        })
    }

    /// Returns the chart for a point in (u,v): that of a nearby apex, with the point on its a-axis, else the plain one.
    pub(crate) fn chart_for(&self, at: [f64; 2]) -> Chart {
        let chart = self.layout.chart_near(at);
        chart.map_or(Chart::Plain, |chart| {
            Chart::Apex(chart.with_reference(at[1 - chart.axis]))
        })
    }

    /// Converts a state from (u,v) into an apex's chart. Near a smooth pole the velocity keeps its direction in space:
    /// there the parameter's rounding at the pole makes (u,v) and the chart disagree about angles.
    pub(crate) fn enter(&self, chart: &ApexChart, state: State) -> Option<(State, Local)> {
        let mut entered = chart.enter(state);
        let at = Chart::Apex(*chart);
        let mut local = self.local(&at, entered)?;
        if chart.is_inner(entered.at) && entered.at[0] > 0.0 {
            if self.embedded {
                let jet = self.jet(state.at);
                let velocity = combine(state.velocity[0], jet.du, state.velocity[1], jet.dv);
                if velocity.iter().all(|x| x.is_finite()) {
                    entered.velocity = components(local.tangents, velocity);
                }
            } else {
                // Without a direction in space, preserve at least the unit speed.
                let [x, y] = entered.velocity;
                let speed = norm(combine(x, local.tangents[0], y, local.tangents[1]));
                if speed > 0.0 && speed.is_finite() {
                    entered.velocity = [x / speed, y / speed];
                }
            }
            local = self.local(&at, entered)?;
        }
        Some((entered, local))
    }

    /// Converts a state from an apex's chart, which has these tangents there, back to (u,v), possibly beyond sides that
    /// wrap. The velocity again keeps its direction in space.
    pub(crate) fn leave(&self, chart: &ApexChart, state: State, tangents: [[f64; 3]; 2]) -> State {
        let mut left = chart.leave(state);
        if self.embedded && chart.is_inner(state.at) {
            let [x, y] = state.velocity;
            let jet = self.jet(left.at);
            let velocity = components([jet.du, jet.dv], combine(x, tangents[0], y, tangents[1]));
            if velocity.iter().all(|x| x.is_finite()) {
                left.velocity = velocity;
            }
        }
        left
    }
}

/// Expresses two tangent vectors in the frame whose first axis is along the first of them. Without an embedding, this
/// frame varies smoothly from point to point.
fn upright([t, w]: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
    let length = norm(t);
    [
        [length, 0.0, 0.0],
        [dot(t, w) / length, norm(cross(t, w)) / length, 0.0],
    ]
}

/// Returns the components of a tangent vector.
fn components(tangents: [[f64; 3]; 2], vector: [f64; 3]) -> [f64; 2] {
    minus_components(tangents[0], tangents[1], vector).map(|x| -x)
}

/// Returns `None` unless all numbers are finite.
fn checked(local: Local) -> Option<Local> {
    let finite = local.acceleration.iter().all(|x| x.is_finite())
        && local.tangents.iter().flatten().all(|x| x.is_finite());
    finite.then_some(Local {
        // The curvature serves the error estimate only.
        curvature: if local.curvature.is_finite() {
            local.curvature
        } else {
            0.0
        },
        ..local
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sides::Sides;
    use crate::surface::ChartData;

    /// A flat cylinder that is given by its metric, 5 around.
    struct Cylinder(ChartData);

    impl Surface for Cylinder {
        fn jet(&self, Uv(at): Uv) -> Jet {
            Jet {
                position: [at[0], at[1], 0.0],
                du: [1.0, 0.0, 0.0],
                dv: [0.0, 1.0, 0.0],
                ..Jet::default()
            }
        }

        fn is_embedded(&self) -> bool {
            false
        }

        fn chart_data(&self) -> &ChartData {
            &self.0
        }
    }

    #[test]
    fn places_that_repeat_each_other_are_one() {
        let mut data = ChartData::of([[0.0, 5.0], [-1.0, 1.0]]);
        data.topology.sides = Sides {
            u: [Side::Wrap; 2],
            ..data.topology.sides
        };
        let cylinder = Cylinder(data);
        let atlas = Atlas::new(&cylinder);
        for (other, expected) in [
            ([1.5, 0.0], 0.5),
            ([6.5, 0.0], 0.5),
            ([4.5, 0.0], 1.5),
            ([-9.0, 0.75], 0.75),
        ] {
            let gap = atlas.gap([1.0, 0.0], other);
            assert!((gap - expected).abs() < 1e-14, "{other:?}: {gap}");
        }
    }
}
