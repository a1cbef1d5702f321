//! The coordinates about an apex: polar coordinates made Cartesian, or a cone unrolled.

use super::State;
use crate::ends::Coordinates;
use crate::jet::Jet;
use crate::topology::Apex;
use crate::vector::combine;

/// A ray enters an apex's chart within this fraction of the chart's reach.
const ENTER: f64 = 0.25;
/// A ray leaves an apex's chart beyond this fraction of its reach. It exceeds [`ENTER`] so that a ray does not alternate
/// between charts.
const LEAVE: f64 = 0.3;
/// The factor on [`ENTER`] and [`LEAVE`] for a single ray about a smooth pole that is as round as a sphere's, or flatter.
const ROUND: f64 = 1.4;
/// An apex's chart is never used beyond this fraction of its reach.
const REACH: f64 = 0.5;
/// The plain chart is not used within this fraction of the reach of an apex that has its own chart.
const KEEP_OFF: f64 = 0.1;

/// At a smooth pole, within this fraction of the chart's radius, the chain rule loses digits and the acceleration is
/// interpolated: it is a smooth function there.
const INNER: f64 = 1e-3;
/// The same as a fraction of the radius of curvature: the function's series must converge well there.
const INNER_BEND: f64 = 5e-3;
/// The approximate weight of one stage of a step.
const STAGE: f64 = 0.3;
/// A point within this fraction of the domain's width from a pole is at the pole.
const AT_POLE: f64 = 1e-15;
/// A ray that passes the tip of a cone within this fraction of its chart's radius hits it.
const HIT: f64 = 1e-12;

/// The coordinates (a, b) = r (cos k(t−t₀), sin k(t−t₀)) about an apex; see [`Apex`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct ApexChart {
    /// The axis at one end of which the apex is.
    pub(crate) axis: usize,
    /// The parameter at the apex.
    pub(crate) base: f64,
    /// +1 where the domain is above `base`, −1 where below.
    pub(crate) sign: f64,
    /// t₀: the value of the other parameter along the a-axis.
    pub(crate) reference: f64,
    /// The domain's width along `axis`.
    width: f64,
    /// The distance in the domain's parameter within which the chart is usable.
    reach: f64,
    /// The chart's radius at its reach, which is the far end of the domain unless the chart winds.
    pub(crate) radius: f64,
    /// The factor on the distances at which the chart is entered and left.
    stay: f64,
    pub(crate) apex: Apex,
}

impl ApexChart {
    /// Creates the chart about the apex at an end of an axis, with its a-axis at the minimum of the other parameter.
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

    /// Returns the chart about the same apex with its a-axis at another value of the other parameter.
    #[inline(always)]
    pub(crate) fn with_reference(self, reference: f64) -> Self {
        Self { reference, ..self }
    }

    /// Returns the name of these coordinates.
    pub(crate) fn coordinates(&self) -> Coordinates {
        Coordinates::Apex {
            axis: self.axis as u8,
            end: u8::from(self.sign < 0.0),
        }
    }

    /// Returns r^power: the distance in the domain's parameter of a point at radius r.
    #[inline(always)]
    fn power(&self, r: f64) -> f64 {
        match self.apex.power {
            1.0 => r,
            2.0 => r * r,
            power => r.powf(power),
        }
    }

    /// The inverse of `power`.
    fn root(&self, rho: f64) -> f64 {
        match self.apex.power {
            1.0 => rho,
            2.0 => rho.sqrt(),
            power => rho.powf(1.0 / power),
        }
    }

    /// Returns the radial parameter's derivative by r.
    #[inline(always)]
    pub(super) fn slope(&self, r: f64) -> f64 {
        match self.apex.power {
            1.0 => self.sign,
            2.0 => self.sign * 2.0 * r,
            power => self.sign * power * r.powf(power - 1.0),
        }
    }

    /// Returns the distance of a point in (u,v) from the apex, in the domain's parameter; negative beyond it.
    fn distance(&self, at: [f64; 2]) -> f64 {
        self.sign * (at[self.axis] - self.base)
    }

    /// Returns the radius within which the acceleration is interpolated, if it is smooth at the tip.
    pub(crate) fn inner(&self) -> f64 {
        (INNER * self.radius).min(INNER_BEND * self.apex.bend)
    }

    /// Returns whether the acceleration is interpolated near the tip.
    pub(crate) fn is_interpolated(&self) -> bool {
        self.apex.smooth && self.apex.odd
    }

    /// Returns the maximum arc length of a step near a tip that is not smooth: a step towards the tip must stop short
    /// of it, a step away from it is limited to twice the distance. The chain rule's rounding grows like 1/r there.
    pub(crate) fn longest(&self, state: State) -> f64 {
        if self.apex.smooth {
            return f64::INFINITY;
        }
        let ([a, b], [x, y]) = (state.at, state.velocity);
        let r = a.hypot(b).max(HIT * self.radius);
        let stretch = if a * x + b * y < 0.0 { 0.75 } else { 2.0 };
        stretch * r / x.hypot(y)
    }

    /// Returns whether a point is near enough to the tip of a cone to count as a hit.
    pub(crate) fn is_hit_at(&self, at: [f64; 2]) -> bool {
        at[0].hypot(at[1]) <= HIT * self.radius
    }

    /// Returns whether the line segment between two points passes through the tip.
    pub(crate) fn is_hit_between(&self, from: [f64; 2], to: [f64; 2]) -> bool {
        self.is_hit_at(nearest_between(from, to))
    }

    /// Returns a point's distance from the apex as a fraction of the chart's reach.
    fn share(&self, at: [f64; 2]) -> f64 {
        self.power(at[0].hypot(at[1])) / self.reach
    }

    /// Returns the error in direction that the rounding of the radial parameter causes along the line segment between two
    /// points: zero where the apex is at 0, large where ρ is a difference of large numbers.
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
        // Besides the direction itself: the acceleration at a stage that falls near the apex, with its weight.
        let stage = if self.apex.smooth {
            (STAGE * way / r).max(1.0)
        } else {
            1.0
        };
        stage * f64::EPSILON * self.base.abs() / self.power(r)
    }

    /// Returns whether a point is far enough away to leave the chart.
    pub(crate) fn is_left_at(&self, at: [f64; 2]) -> bool {
        self.share(at) > LEAVE * self.stay
    }

    /// Returns whether a point in (u,v) is near enough to enter the chart.
    pub(super) fn is_entered_at(&self, at: [f64; 2]) -> bool {
        (0.0..=ENTER * self.stay * self.reach).contains(&self.distance(at))
    }

    /// Returns whether a point in (u,v) is too near the apex for the plain chart, or beyond it.
    pub(super) fn is_needed_at(&self, at: [f64; 2]) -> bool {
        self.distance(at) < KEEP_OFF * self.reach
    }

    /// Returns whether a point is farther away than the chart is valid.
    pub(crate) fn oversteps(&self, at: [f64; 2]) -> bool {
        self.share(at) > REACH
    }

    /// Returns whether the chart is valid at a point in (u,v).
    pub(crate) fn holds(&self, at: [f64; 2]) -> bool {
        (0.0..=REACH * self.reach).contains(&self.distance(at))
    }

    /// Returns the chart as a single ray uses it: about a pole as round as a sphere's, or flatter, it reaches farther out.
    /// Rays integrated side by side separate when one of them changes charts, so they change as late as possible.
    pub(super) fn for_one_ray(self) -> Self {
        let round = self.apex.smooth && self.apex.bend > 0.25 * self.radius;
        Self {
            stay: if round { ROUND } else { 1.0 },
            ..self
        }
    }

    /// Returns the point in (u,v), possibly beyond sides that wrap.
    pub(crate) fn plain_point(&self, [a, b]: [f64; 2]) -> [f64; 2] {
        self.plain_polar(a.hypot(b), b.atan2(a))
    }

    /// Returns the point in (u,v) for a radius and an angle.
    #[inline(always)]
    pub(crate) fn plain_polar(&self, r: f64, angle: f64) -> [f64; 2] {
        let along = self.base + self.sign * self.power(r);
        self.pair(along, self.reference + angle / self.apex.rate)
    }

    /// Returns (u,v) from the components for the parameter along the axis and for the other parameter.
    #[inline(always)]
    fn pair(&self, along: f64, across: f64) -> [f64; 2] {
        if self.axis == 0 {
            [along, across]
        } else {
            [across, along]
        }
    }

    /// Returns (a, b) of a point in (u,v).
    pub(crate) fn point(&self, at: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.angle(at).sin_cos();
        let r = self.radius_at(at);
        [r * cos, r * sin]
    }

    /// Returns r of a point in (u,v); 0 beyond the apex.
    fn radius_at(&self, at: [f64; 2]) -> f64 {
        self.root(self.distance(at).max(0.0))
    }

    /// Converts a vector at a point in (u,v) into this chart.
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

    /// Converts a vector at (a, b) into (u,v).
    pub(crate) fn plain_vector(&self, [a, b]: [f64; 2], vector: [f64; 2]) -> [f64; 2] {
        let r = a.hypot(b);
        if r == 0.0 {
            return self.pair(self.slope(r) * vector[0], 0.0);
        }
        let [radial, turning] = rotated([a / r, b / r], vector);
        self.pair(self.slope(r) * radial, turning / r / self.apex.rate)
    }

    /// Returns a point's radius, at least `nearest`, and its direction from the apex as (cos, sin).
    #[inline(always)]
    pub(crate) fn polar(&self, [a, b]: [f64; 2], nearest: f64) -> (f64, [f64; 2]) {
        let r = (a * a + b * b).sqrt();
        let direction = if r > 0.0 { [a / r, b / r] } else { [1.0, 0.0] };
        (r.max(nearest), direction)
    }

    /// Transforms the jet in (u,v) to radius `r` by the chain rule. The derivatives are along the radius and across it,
    /// in Cartesian coordinates with these directions. Those of (a, b) are the same rotated by the angle; callers rotate
    /// vectors instead, since there are fewer of them.
    #[inline(always)]
    pub(crate) fn radial_jet(&self, r: f64, jet: &Jet) -> Jet {
        let (dw, dww, dt, dtt) = if self.axis == 0 {
            (jet.du, jet.duu, jet.dv, jet.dvv)
        } else {
            (jet.dv, jet.dvv, jet.du, jet.duu)
        };
        // The radial parameter is base + sign r^power; these are its derivatives by r.
        let first = self.slope(r);
        let inverse = 1.0 / r;
        let second = first * (self.apex.power - 1.0) * inverse;
        // Derivatives by the angle are divided by r, so that all have the same magnitude.
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

    /// Returns the angle of a point in (u,v) from the a-axis.
    pub(crate) fn angle(&self, at: [f64; 2]) -> f64 {
        self.apex.rate * (at[1 - self.axis] - self.reference)
    }

    /// Converts a vector of `other`, the chart about the same apex with another reference, into this chart.
    pub(crate) fn vector_of(&self, other: &Self, vector: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = (self.apex.rate * (self.reference - other.reference)).sin_cos();
        rotated([cos, sin], vector)
    }

    /// Returns whether a point in (u,v) is at the apex, to within its parameter's rounding.
    pub(crate) fn is_at(&self, at: [f64; 2]) -> bool {
        self.radius_at(at) <= (1.0 + 1e-3) * self.nearest()
    }

    /// +1 where (a, b) has the handedness of (u,v), −1 where it is mirrored.
    pub(crate) fn handedness(&self) -> f64 {
        // (r, angle) has the handedness of (a,b); the parameter along the axis comes first or second in (u,v).
        let order = if self.axis == 0 { 1.0 } else { -1.0 };
        self.sign * self.apex.rate.signum() * order
    }

    /// Converts a state from (u,v) into this chart.
    pub(crate) fn enter(&self, state: State) -> State {
        State {
            at: self.point(state.at),
            velocity: self.vector(state.at, state.velocity),
        }
    }

    /// Returns the minimum distance from the apex, in units of r, at which the parameters still distinguish a point
    /// from it.
    pub(crate) fn nearest(&self) -> f64 {
        let rho = (AT_POLE * self.width).max(4.0 * f64::EPSILON * self.base.abs());
        self.root(rho)
    }

    /// Returns whether a point is where the chain rule from (u,v) loses digits.
    pub(crate) fn is_inner(&self, at: [f64; 2]) -> bool {
        self.apex.smooth && at[0].hypot(at[1]) < self.inner()
    }

    /// Converts a state back to (u,v), possibly beyond sides that wrap.
    pub(crate) fn leave(&self, mut state: State) -> State {
        let [x, y] = state.velocity;
        let nearest = self.nearest();
        let r = state.at[0].hypot(state.at[1]);
        if self.apex.smooth && r < nearest && x.hypot(y) > 0.0 {
            // A point at the pole has no angle of its own: use the angle at which the ray continues.
            state.at = [x, y].map(|c| nearest * c / x.hypot(y));
        }
        State {
            at: self.plain_point(state.at),
            velocity: self.plain_vector(state.at, state.velocity),
        }
    }

    /// Turns the chart so that the point is on the a-axis: the angle may grow without bound along a ray. Returns the
    /// rotation as (cos, sin), to be applied to whatever else is expressed in the chart.
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

/// Returns the point of a line segment that is nearest to the apex.
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

/// Returns a vector turned back by the rotation (cos, sin).
#[inline(always)]
pub(crate) fn rotated([cos, sin]: [f64; 2], [x, y]: [f64; 2]) -> [f64; 2] {
    [cos * x + sin * y, cos * y - sin * x]
}

/// Returns a vector turned by the rotation (cos, sin).
#[inline(always)]
pub(crate) fn turned([cos, sin]: [f64; 2], [x, y]: [f64; 2]) -> [f64; 2] {
    [cos * x - sin * y, sin * x + cos * y]
}
