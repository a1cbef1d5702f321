//! The coordinates about an apex: polar coordinates undone, or a cone unrolled.

use super::State;
use crate::ends::Coordinates;
use crate::jet::Jet;
use crate::metric::combine;
use crate::topology::Apex;

/// A ray enters the chart of an apex within this share of the chart's reach.
const ENTER: f64 = 0.25;
/// A ray leaves the chart of an apex beyond this share of its reach. It exceeds [`ENTER`], so that a ray does not go back and
/// forth.
const LEAVE: f64 = 0.3;
/// The factor to [`ENTER`] and [`LEAVE`] for a single ray where the surface does not bend within the reach.
const ROUND: f64 = 1.4;
/// The chart of an apex is never used beyond this share of its reach.
const REACH: f64 = 0.5;
/// The plain chart is not used nearer than this to an apex that has its own chart.
const KEEP_OFF: f64 = 0.1;

/// At a smooth pole, nearer than this share of the chart's radius the chain rule has lost digits and the
/// acceleration is interpolated: it is a smooth function there.
const INNER: f64 = 1e-3;
/// The same as a share of the radius of curvature: the function's series must converge well there.
const INNER_BEND: f64 = 5e-3;
/// About what a stage of a step weighs.
const STAGE: f64 = 0.3;
/// A point this near a pole, as a share of the domain's width, is at it.
const AT_POLE: f64 = 1e-15;
/// A tip of a cone is hit by what passes it within this share of its chart's radius.
const HIT: f64 = 1e-12;

/// The coordinates (a, b) = r (cos k(t−t₀), sin k(t−t₀)) about an apex; see [`Apex`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct ApexChart {
    /// The axis along which the apex lies at an end of the domain.
    pub(crate) axis: usize,
    /// The parameter at the apex.
    pub(crate) base: f64,
    /// +1 where the domain lies above `base`, −1 where below.
    pub(crate) sign: f64,
    /// t₀: the other parameter along the a-axis.
    pub(crate) reference: f64,
    /// The domain's width along `axis`.
    width: f64,
    /// The distance in the domain's parameter within which the chart is of use.
    reach: f64,
    /// The chart's radius where its reach ends, which is the far end of the domain unless the chart winds.
    pub(crate) radius: f64,
    /// The factor to the distances at which it is entered and left.
    stay: f64,
    pub(crate) apex: Apex,
}

impl ApexChart {
    /// The chart about the apex at an end of an axis, whose a-axis lies along the minimum of the other parameter.
    pub(super) fn new(domain: [[f64; 2]; 2], axis: usize, end: usize, apex: Apex) -> Self {
        let width = domain[axis][1] - domain[axis][0];
        let mut chart = Self {
            axis,
            base: domain[axis][end],
            sign: if end == 0 { 1.0 } else { -1.0 },
            reference: domain[1 - axis][0],
            width,
            reach: width * apex.reach,
            radius: 0.0,
            stay: 1.0,
            apex,
        };
        chart.radius = chart.root(chart.reach);
        chart
    }

    /// The chart about the same apex with its a-axis along another value of the other parameter.
    #[inline(always)]
    pub(crate) fn with_reference(self, reference: f64) -> Self {
        Self { reference, ..self }
    }

    /// The name of these coordinates.
    pub(crate) fn coordinates(&self) -> Coordinates {
        Coordinates::Apex {
            axis: self.axis as u8,
            end: u8::from(self.sign < 0.0),
        }
    }

    /// r^power, how far a point so far off the apex is from it in the domain's parameter.
    #[inline(always)]
    fn power(&self, r: f64) -> f64 {
        match self.apex.power {
            1.0 => r,
            2.0 => r * r,
            power => r.powf(power),
        }
    }

    /// The inverse.
    fn root(&self, rho: f64) -> f64 {
        match self.apex.power {
            1.0 => rho,
            2.0 => rho.sqrt(),
            power => rho.powf(1.0 / power),
        }
    }

    /// The radial parameter's derivative by r.
    #[inline(always)]
    pub(super) fn slope(&self, r: f64) -> f64 {
        match self.apex.power {
            1.0 => self.sign,
            2.0 => self.sign * 2.0 * r,
            power => self.sign * power * r.powf(power - 1.0),
        }
    }

    /// The distance of a point in (u,v) from the apex, in the domain's parameter; negative beyond it.
    fn distance(&self, at: [f64; 2]) -> f64 {
        self.sign * (at[self.axis] - self.base)
    }

    /// The radius of the neighbourhood in which the acceleration is interpolated, where it is smooth at the tip.
    pub(crate) fn inner(&self) -> f64 {
        (INNER * self.radius).min(INNER_BEND * self.apex.bend)
    }

    /// Returns whether the acceleration is interpolated about the tip.
    pub(crate) fn is_interpolated(&self) -> bool {
        self.apex.smooth && self.apex.odd
    }

    /// The longest stretch, in arc length, that a step may go near a tip that is not smooth: towards it so that
    /// the tip stays ahead, away from it twice the distance. There the chain rule's rounding grows like 1/r.
    pub(crate) fn longest(&self, state: State) -> f64 {
        if self.apex.smooth {
            return f64::INFINITY;
        }
        let ([a, b], [x, y]) = (state.at, state.velocity);
        let r = a.hypot(b).max(HIT * self.radius);
        let stretch = if a * x + b * y < 0.0 { 0.75 } else { 2.0 };
        stretch * r / x.hypot(y)
    }

    /// Returns whether a point is as near the tip of a cone as counts for a hit.
    pub(crate) fn is_hit_at(&self, at: [f64; 2]) -> bool {
        at[0].hypot(at[1]) <= HIT * self.radius
    }

    /// Returns whether the straight line from one point to another passes through the tip.
    pub(crate) fn is_hit_between(&self, from: [f64; 2], to: [f64; 2]) -> bool {
        self.is_hit_at(nearest_between(from, to))
    }

    /// A point's distance from the apex, as a share of the chart's reach.
    fn share(&self, at: [f64; 2]) -> f64 {
        self.power(at[0].hypot(at[1])) / self.reach
    }

    /// The error that the rounding of the radial parameter causes in a direction that passes from one point to another in a
    /// straight line: nothing where the apex is at 0, much where ρ is a difference of large numbers.
    pub(crate) fn noise(&self, from: [f64; 2], to: [f64; 2]) -> f64 {
        let way = (to[0] - from[0]).hypot(to[1] - from[1]);
        let nearest = nearest_between(from, to);
        let floor = match self.is_interpolated() {
            true => self.inner(),
            false => 0.0,
        };
        let r = nearest[0]
            .hypot(nearest[1])
            .max(floor)
            .max(HIT * self.radius);
        // Beside the direction itself, the acceleration at a stage that falls near the apex, with its weight.
        let stage = if self.apex.smooth {
            (STAGE * way / r).max(1.0)
        } else {
            1.0
        };
        stage * f64::EPSILON * self.base.abs() / self.power(r)
    }

    /// Returns whether a point is far enough off to leave the chart.
    pub(crate) fn is_left_at(&self, at: [f64; 2]) -> bool {
        self.share(at) > LEAVE * self.stay
    }

    /// Returns whether a point in (u,v) is near enough to enter the chart.
    pub(super) fn is_entered_at(&self, at: [f64; 2]) -> bool {
        (0.0..=ENTER * self.stay * self.reach).contains(&self.distance(at))
    }

    /// Returns whether a point in (u,v) is too near for the plain chart, or beyond the apex.
    pub(super) fn is_needed_at(&self, at: [f64; 2]) -> bool {
        self.distance(at) < KEEP_OFF * self.reach
    }

    /// Returns whether a point is farther off than the chart is good for.
    pub(crate) fn oversteps(&self, at: [f64; 2]) -> bool {
        self.share(at) > REACH
    }

    /// Returns whether the chart is good for a point in (u,v).
    pub(crate) fn holds(&self, at: [f64; 2]) -> bool {
        (0.0..=REACH * self.reach).contains(&self.distance(at))
    }

    /// The chart as a single ray uses it: one about a pole as a sphere's, or a flatter one, farther out. Rays side by side
    /// part where one of them changes charts, so that they change as late as they can.
    pub(super) fn for_one_ray(self) -> Self {
        let round = self.apex.smooth && self.apex.bend > 0.25 * self.radius;
        Self {
            stay: if round { ROUND } else { 1.0 },
            ..self
        }
    }

    /// The point in (u,v), perhaps beyond sides that wrap.
    pub(crate) fn plain_point(&self, [a, b]: [f64; 2]) -> [f64; 2] {
        self.plain_polar(a.hypot(b), b.atan2(a))
    }

    /// The point in (u,v) for a radius and an angle.
    #[inline(always)]
    pub(crate) fn plain_polar(&self, r: f64, angle: f64) -> [f64; 2] {
        let along = self.base + self.sign * self.power(r);
        self.pair(along, self.reference + angle / self.apex.rate)
    }

    /// (u,v) from what belongs to the parameter along the axis and to the other one.
    #[inline(always)]
    fn pair(&self, along: f64, across: f64) -> [f64; 2] {
        if self.axis == 0 {
            [along, across]
        } else {
            [across, along]
        }
    }

    /// (a, b) of a point in (u,v).
    pub(crate) fn point(&self, at: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.angle(at).sin_cos();
        let r = self.radius_at(at);
        [r * cos, r * sin]
    }

    /// r of a point in (u,v); 0 beyond the apex.
    fn radius_at(&self, at: [f64; 2]) -> f64 {
        self.root(self.distance(at).max(0.0))
    }

    /// A vector at a point in (u,v), in this chart.
    pub(crate) fn vector(&self, at: [f64; 2], v: [f64; 2]) -> [f64; 2] {
        let rho = self.distance(at).max(0.0);
        let mut radial = self.sign * v[self.axis];
        if self.apex.power != 1.0 {
            let root = 1.0 / self.apex.power;
            radial *= root * rho.powf(root - 1.0);
        }
        let turning = self.radius_at(at) * self.apex.rate * v[1 - self.axis];
        let (sin, cos) = self.angle(at).sin_cos();
        [radial * cos - turning * sin, radial * sin + turning * cos]
    }

    /// A vector at (a, b), in (u,v).
    pub(crate) fn plain_vector(&self, [a, b]: [f64; 2], vector: [f64; 2]) -> [f64; 2] {
        let r = a.hypot(b);
        if r == 0.0 {
            return self.pair(self.slope(r) * vector[0], 0.0);
        }
        let [radial, turning] = rotated([a / r, b / r], vector);
        self.pair(self.slope(r) * radial, turning / r / self.apex.rate)
    }

    /// A point's radius, `nearest` at least, with its direction from the apex as (cos, sin).
    #[inline(always)]
    pub(crate) fn polar(&self, [a, b]: [f64; 2], nearest: f64) -> (f64, [f64; 2]) {
        let r = (a * a + b * b).sqrt();
        let direction = if r > 0.0 { [a / r, b / r] } else { [1.0, 0.0] };
        (r.max(nearest), direction)
    }

    /// The jet at radius `r` by the chain rule from that in (u,v), its derivatives along the radius and across it, where
    /// the coordinates are straight lines with these directions. Those of (a, b) are the same ones turned by the angle;
    /// vectors are turned instead, for they are fewer.
    #[inline(always)]
    pub(crate) fn radial_jet(&self, r: f64, jet: &Jet) -> Jet {
        let (dw, dww, dt, dtt) = if self.axis == 0 {
            (jet.du, jet.duu, jet.dv, jet.dvv)
        } else {
            (jet.dv, jet.dvv, jet.du, jet.duu)
        };
        // The radial parameter is base + sign r^power: its derivatives by r.
        let first = self.slope(r);
        let inverse = 1.0 / r;
        let second = first * (self.apex.power - 1.0) * inverse;
        // Derivatives by the angle are over r, so that all are of one size.
        let turn = inverse / self.apex.rate;
        let (du, dv) = (dw.map(|x| first * x), dt.map(|x| turn * x));
        Jet {
            position: jet.position,
            du,
            dv,
            duu: combine(first * first, dww, second, dw),
            duv: combine(turn * first, jet.duv, -inverse, dv),
            dvv: combine(turn * turn, dtt, inverse, du),
        }
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

    /// Returns whether a point in (u,v) is at the apex, as far as its parameter can tell.
    pub(crate) fn is_at(&self, at: [f64; 2]) -> bool {
        self.radius_at(at) <= (1.0 + 1e-3) * self.nearest()
    }

    /// +1 where (a, b) has the handedness of (u,v), −1 where it is mirrored.
    pub(crate) fn handedness(&self) -> f64 {
        // (r, angle) has the handedness of (a,b); the parameter along the axis comes first or second in (u,v).
        let order = if self.axis == 0 { 1.0 } else { -1.0 };
        self.sign * self.apex.rate.signum() * order
    }

    /// From (u,v) into this chart.
    pub(crate) fn enter(&self, state: State) -> State {
        State {
            at: self.point(state.at),
            velocity: self.vector(state.at, state.velocity),
        }
    }

    /// The least distance from the apex, in units of r, at which the parameters still distinguish a point from it.
    pub(crate) fn nearest(&self) -> f64 {
        let rho = (AT_POLE * self.width).max(4.0 * f64::EPSILON * self.base.abs());
        self.root(rho)
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
        State {
            at: self.plain_point(state.at),
            velocity: self.plain_vector(state.at, state.velocity),
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

/// The point of the straight line from one point to another that is nearest to the apex.
fn nearest_between(from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    let way = [0, 1].map(|k| to[k] - from[k]);
    let square = way[0] * way[0] + way[1] * way[1];
    let along = if square > 0.0 {
        (-(from[0] * way[0] + from[1] * way[1]) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    [0, 1].map(|k| from[k] + along * way[k])
}

/// A vector turned back by the rotation (cos, sin).
#[inline(always)]
pub(crate) fn rotated([cos, sin]: [f64; 2], [x, y]: [f64; 2]) -> [f64; 2] {
    [cos * x + sin * y, cos * y - sin * x]
}

/// A vector turned by the rotation (cos, sin).
#[inline(always)]
pub(crate) fn turned([cos, sin]: [f64; 2], [x, y]: [f64; 2]) -> [f64; 2] {
    [cos * x - sin * y, sin * x + cos * y]
}
