//! The coordinates about an apex: polar coordinates undone, or a cone unrolled.

use super::{ENTER, ENTER_ROUND, LEAVE, LEAVE_ROUND, State, rotated};
use crate::topology::Apex;

/// At a smooth pole, nearer than this share of the chart's radius the chain rule has lost digits and the
/// acceleration is interpolated: it is a smooth function there.
const INNER: f64 = 1e-3;
/// The same as a share of the radius of curvature: the function's series must converge well there.
const INNER_BEND: f64 = 5e-3;
/// About what a stage of a step weighs.
const STAGE: f64 = 0.3;
/// A point this near a pole, as a share of the domain's width, is at it.
const AT_POLE: f64 = 1e-15;

/// The coordinates about an apex; see [`Apex`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct ApexChart {
    /// The axis along which the apex lies at an end of the domain.
    pub(crate) axis: usize,
    /// The parameter at the apex.
    pub(super) base: f64,
    /// +1 where the domain lies above `base`, −1 where below.
    pub(super) sign: f64,
    /// The other parameter along the a-axis.
    pub(super) reference: f64,
    /// The domain's width along `axis`.
    pub(super) width: f64,
    pub(crate) apex: Apex,
}

impl ApexChart {
    /// How far in the domain's parameter the chart is of use.
    pub(super) fn reach(&self) -> f64 {
        self.width * self.apex.reach
    }

    /// The chart's radius where its reach ends, which is the far end of the domain unless the chart winds.
    pub(crate) fn radius(&self) -> f64 {
        self.root(self.reach())
    }

    /// r^power, how far a point so far off the apex is from it in the domain's parameter.
    pub(super) fn power(&self, r: f64) -> f64 {
        if self.apex.power == 1.0 {
            r
        } else {
            r.powf(self.apex.power)
        }
    }

    /// The inverse.
    fn root(&self, rho: f64) -> f64 {
        if self.apex.power == 1.0 {
            rho
        } else {
            rho.powf(1.0 / self.apex.power)
        }
    }

    /// The radial parameter's derivative by r.
    pub(super) fn slope(&self, r: f64) -> f64 {
        let power = self.apex.power;
        if power == 1.0 {
            self.sign
        } else {
            self.sign * power * r.powf(power - 1.0)
        }
    }

    /// The radius of the neighbourhood in which the acceleration is interpolated.
    pub(super) fn inner(&self) -> f64 {
        (INNER * self.radius()).min(INNER_BEND * self.apex.bend)
    }

    /// The longest stretch, in chart units, that a step may go near a tip that is not smooth: towards it so that
    /// the tip stays ahead, away from it twice the distance. There the chain rule's rounding grows like 1/r.
    pub(crate) fn longest(&self, state: State) -> f64 {
        if self.apex.smooth {
            return f64::INFINITY;
        }
        let ([a, b], [x, y]) = (state.at, state.velocity);
        let r = a.hypot(b).max(1e-12 * self.radius());
        if a * x + b * y < 0.0 {
            0.75 * r
        } else {
            2.0 * r
        }
    }

    /// A point's distance from the apex, as a share of the chart's reach.
    pub(crate) fn share(&self, at: [f64; 2]) -> f64 {
        self.power(at[0].hypot(at[1])) / self.reach()
    }

    /// What the rounding of the radial parameter does to a direction that passes from one point to another in a
    /// straight line: nothing where the apex is at 0, much where ρ is a difference of large numbers.
    pub(crate) fn noise(&self, from: [f64; 2], to: [f64; 2]) -> f64 {
        let way = [0, 1].map(|k| to[k] - from[k]);
        let square = way[0] * way[0] + way[1] * way[1];
        let along = if square > 0.0 {
            (-(from[0] * way[0] + from[1] * way[1]) / square).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let nearest = [0, 1].map(|k| from[k] + along * way[k]);
        let floor = if self.apex.smooth { self.inner() } else { 0.0 };
        let r = nearest[0].hypot(nearest[1]).max(floor);
        // Beside the direction itself, the acceleration at a stage that falls near the apex, with its weight.
        let stage = if self.apex.smooth {
            (STAGE * square.sqrt() / r).max(1.0)
        } else {
            1.0
        };
        stage * f64::EPSILON * self.base.abs() / self.power(r)
    }

    /// Returns whether a point is far enough off to leave the chart.
    pub(crate) fn is_left_at(&self, at: [f64; 2]) -> bool {
        let most = if self.is_round() { LEAVE_ROUND } else { LEAVE };
        self.share(at) > most
    }

    /// How far from the apex, in the domain's parameter, the chart is entered.
    pub(super) fn enters_within(&self) -> f64 {
        let share = if self.is_round() { ENTER_ROUND } else { ENTER };
        share * self.reach()
    }

    /// Returns whether the pole is one as a sphere's, or a flatter one.
    fn is_round(&self) -> bool {
        self.apex.smooth && self.apex.bend > 0.25 * self.radius()
    }

    /// The point in (u,v), perhaps beyond sides that wrap.
    pub(crate) fn plain_point(&self, [a, b]: [f64; 2]) -> [f64; 2] {
        let w = self.base + self.sign * self.power(a.hypot(b));
        let t = self.reference + b.atan2(a) / self.apex.rate;
        if self.axis == 0 { [w, t] } else { [t, w] }
    }

    /// (a, b) of a point in (u,v).
    pub(crate) fn point(&self, at: [f64; 2]) -> [f64; 2] {
        let rho = (self.sign * (at[self.axis] - self.base)).max(0.0);
        let (sin, cos) = self.angle(at).sin_cos();
        let r = self.root(rho);
        [r * cos, r * sin]
    }

    /// The angle of a point in (u,v) from the a-axis.
    pub(crate) fn angle(&self, at: [f64; 2]) -> f64 {
        self.apex.rate * (at[1 - self.axis] - self.reference)
    }

    /// A vector of `other`, the chart about the same apex with another reference, in this one.
    pub(crate) fn vector_of(&self, other: &Self, vector: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = (self.apex.rate * (self.reference - other.reference)).sin_cos();
        rotated([cos, sin], vector)
    }

    /// +1 where the parameter along the axis grows away from the apex, else −1.
    pub(crate) fn outward(&self) -> f64 {
        self.sign
    }

    /// 0 for the axis' minimum, 1 for its maximum.
    pub(crate) fn end(&self) -> usize {
        usize::from(self.sign < 0.0)
    }

    /// Returns whether a point in (u,v) is at the apex, as far as its parameter can tell.
    pub(crate) fn is_at(&self, at: [f64; 2]) -> bool {
        let rho = (self.sign * (at[self.axis] - self.base)).max(0.0);
        self.root(rho) <= (1.0 + 1e-3) * self.nearest()
    }

    /// +1 where (a, b) has the handedness of (u,v), −1 where it is mirrored.
    pub(crate) fn handedness(&self) -> f64 {
        // (r, angle) has the handedness of (a,b); the parameter along the axis comes first or second in (u,v).
        let order = if self.axis == 0 { 1.0 } else { -1.0 };
        self.sign * self.apex.rate.signum() * order
    }

    /// The parameter at the apex.
    pub(crate) fn base(&self) -> f64 {
        self.base
    }

    /// From (u,v) into this chart, whose reference is the point's other parameter: it lies on the a-axis.
    pub(crate) fn enter(&self, state: State) -> State {
        let rho = (self.sign * (state.at[self.axis] - self.base)).max(0.0);
        let r = self.root(rho);
        let radial = self.sign * state.velocity[self.axis];
        let radial = if self.apex.power == 1.0 {
            radial
        } else {
            let root = 1.0 / self.apex.power;
            radial * root * rho.powf(root - 1.0)
        };
        State {
            at: [r, 0.0],
            velocity: [radial, r * self.apex.rate * state.velocity[1 - self.axis]],
        }
    }

    /// How near the apex, in units of r, the parameters can still tell a point from it.
    pub(crate) fn nearest(&self) -> f64 {
        let rho = (AT_POLE * self.width).max(4.0 * f64::EPSILON * self.base.abs());
        self.root(rho)
    }

    /// The radius within which [`Self::is_inner`] holds.
    pub(crate) fn inner_radius(&self) -> f64 {
        self.inner()
    }

    /// Returns whether a point lies where the chain rule from (u,v) has lost digits.
    pub(crate) fn is_inner(&self, at: [f64; 2]) -> bool {
        self.apex.smooth && at[0].hypot(at[1]) < self.inner()
    }

    /// Back to (u,v), perhaps beyond sides that wrap.
    pub(crate) fn leave(&self, mut state: State) -> State {
        let [x, y] = state.velocity;
        let nearest = self.nearest();
        let r = state.at[0].hypot(state.at[1]);
        if self.apex.smooth && r < nearest && x.hypot(y) > 0.0 {
            // The angle of a point at the pole is free: the one in which the ray goes on.
            state.at = [x, y].map(|c| nearest * c / x.hypot(y));
        }
        let [a, b] = state.at;
        let r = a.hypot(b);
        let (cos, sin) = if r > 0.0 { (a / r, b / r) } else { (1.0, 0.0) };
        let radial = self.slope(r) * (cos * x + sin * y);
        let turning = if r > 0.0 {
            (cos * y - sin * x) / r / self.apex.rate
        } else {
            0.0
        };
        State {
            at: self.plain_point(state.at),
            velocity: if self.axis == 0 {
                [radial, turning]
            } else {
                [turning, radial]
            },
        }
    }

    /// Turns the chart so that the point lies on the a-axis: along a ray the angle may go on growing. Gives the
    /// rotation as (cos, sin), for what else is expressed in the chart.
    pub(crate) fn turn_to(&mut self, state: &mut State) -> [f64; 2] {
        let [a, b] = state.at;
        let r = a.hypot(b);
        if r == 0.0 {
            return [1.0, 0.0];
        }
        let rotation = [a / r, b / r];
        self.reference += b.atan2(a) / self.apex.rate;
        state.at = [r, 0.0];
        state.velocity = rotated(rotation, state.velocity);
        rotation
    }
}
