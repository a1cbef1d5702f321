//! The coordinates that a fan's rays run in, and how points and vectors pass from one to another.
//!
//! In the plain ones a ray is never brought back: (u,v) goes on beyond sides that wrap, only the evaluation brings its
//! point back. So neighbouring rays agree, through wraps and flips, with no guessing of periods. About an apex they
//! are (a,b), as [`Coordinates::Apex`](crate::ends::Coordinates) has them.

use crate::surface::{LANES, Lanes, Scale, Side, Sides, Surface};
use crate::topology::Apex;

/// An apex's coordinates are entered within this share of their reach from it, …
const ENTER: f64 = 0.25;
/// … left beyond this one, …
const LEAVE: f64 = 0.3;
/// … and of no use beyond this one.
const REACH: f64 = 0.5;
/// The plain ones are not used nearer than this to an apex that has its own.
const KEEP_OFF: f64 = 0.1;
/// Nearer than this share of its radius to an apex, what is local there stands for the place: the chain rule loses
/// digits like 1/r, and nothing changes over so short a way.
pub(super) const NEAREST: f64 = 1e-6;

/// A kind of coordinates.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub(super) enum CoordinateKind {
    /// (u,v), lifted.
    Plain,
    /// (a,b) about the apex at an end of an axis.
    Apex { axis: u8, end: u8 },
}

/// Coordinates with what the a-axis points at: the other parameter's value there. It is the domain's minimum at a
/// smooth pole, and a ray's own at the tip of a cone, which no two rays need share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FanChart {
    pub(super) kind: CoordinateKind,
    pub(super) reference: f64,
}

impl FanChart {
    pub(super) const PLAIN: Self = Self {
        kind: CoordinateKind::Plain,
        reference: 0.0,
    };
}

/// An apex whose coordinates are of use.
#[derive(Clone, Copy, Debug)]
pub(super) struct PoleChart {
    pub(super) axis: usize,
    /// The parameter at the apex.
    pub(super) base: f64,
    /// +1 where the domain lies above `base`, −1 where below.
    pub(super) sign: f64,
    /// The minimum of the other parameter.
    pub(super) low: f64,
    /// How far in the parameter the coordinates are of use.
    reach: f64,
    /// The same in the coordinates.
    pub(super) radius: f64,
    pub(super) apex: Apex,
}

impl PoleChart {
    /// A point's distance from the apex, as a share of the reach.
    pub(super) fn share(&self, at: [f64; 2]) -> f64 {
        at[0].hypot(at[1]).powf(self.apex.power) / self.reach
    }

    pub(super) fn is_left_at(&self, at: [f64; 2]) -> bool {
        self.share(at) > LEAVE
    }

    pub(super) fn oversteps(&self, at: [f64; 2]) -> bool {
        self.share(at) > REACH
    }

    /// The distance in the parameter, negative beyond the apex.
    fn distance(&self, at: [f64; 2]) -> f64 {
        self.sign * (at[self.axis] - self.base)
    }

    /// Returns whether a plain point is within the coordinates' use.
    pub(super) fn holds(&self, at: [f64; 2]) -> bool {
        (0.0..=REACH * self.reach).contains(&self.distance(at))
    }

    /// The plain point for (a,b), with the other parameter within half a turn of the reference.
    pub(super) fn plain_point(&self, [a, b]: [f64; 2], reference: f64) -> [f64; 2] {
        let r = a.hypot(b);
        let w = self.base + self.sign * self.power(r);
        self.pair(w, reference + b.atan2(a) / self.apex.rate)
    }

    /// (u,v) from the parameter along the axis and the other one.
    pub(super) fn pair(&self, along: f64, across: f64) -> [f64; 2] {
        if self.axis == 0 {
            [along, across]
        } else {
            [across, along]
        }
    }

    /// r^power.
    #[inline(always)]
    pub(super) fn power(&self, r: f64) -> f64 {
        match self.apex.power {
            1.0 => r,
            2.0 => r * r,
            power => r.powf(power),
        }
    }

    /// (a,b) of a plain point.
    pub(super) fn point(&self, at: [f64; 2], reference: f64) -> [f64; 2] {
        let r = self.distance(at).max(0.0).powf(1.0 / self.apex.power);
        let angle = self.apex.rate * (at[1 - self.axis] - reference);
        [r * angle.cos(), r * angle.sin()]
    }

    /// A vector at a plain point, in (a,b).
    pub(super) fn vector(&self, at: [f64; 2], reference: f64, v: [f64; 2]) -> [f64; 2] {
        let root = 1.0 / self.apex.power;
        let rho = self.distance(at).max(0.0);
        let r = rho.powf(root);
        let radial = self.sign * v[self.axis] * root * rho.powf(root - 1.0);
        let turning = r * self.apex.rate * v[1 - self.axis];
        let (sin, cos) = (self.apex.rate * (at[1 - self.axis] - reference)).sin_cos();
        [radial * cos - turning * sin, radial * sin + turning * cos]
    }

    /// A vector at (a,b), in the plain coordinates.
    pub(super) fn plain_vector(&self, [a, b]: [f64; 2], [x, y]: [f64; 2]) -> [f64; 2] {
        let r = a.hypot(b).max(NEAREST * NEAREST * self.radius);
        let (cos, sin) = (a / r, b / r);
        let power = self.apex.power;
        let radial = self.sign * power * r.powf(power - 1.0) * (cos * x + sin * y);
        self.pair(radial, (cos * y - sin * x) / r / self.apex.rate)
    }

    /// The sign by which left and right change places from the plain coordinates to these.
    pub(super) fn handedness(&self) -> f64 {
        // (radius, angle) has the handedness of (a,b); (w,t) is (u,v) or the other way about.
        self.sign * self.apex.rate.signum() * if self.axis == 0 { 1.0 } else { -1.0 }
    }
}

/// What is known of a surface's chart as a whole.
#[derive(Clone, Debug)]
pub(super) struct Space {
    pub(super) domain: [[f64; 2]; 2],
    sides: Sides,
    /// `[axis][end]`: the apexes that have coordinates of their own.
    tips: [[Option<PoleChart>; 2]; 2],
    /// `[axis][end]`: the sides that are one point.
    collapsed: [[bool; 2]; 2],
    pub(super) scale: Scale,
    any_tip: bool,
    any_edge: bool,
}

impl Space {
    pub(super) fn of<S: Surface + ?Sized>(surface: &S) -> Self {
        let domain = surface.domain();
        let sides = surface.sides();
        let apexes = [0, 1].map(|axis| [0, 1].map(|end| surface.apex(axis, end)));
        let tips = [0, 1].map(|axis| {
            [0, 1].map(|end| {
                let apex: Apex = apexes[axis][end].filter(|apex: &Apex| apex.regular)?;
                let reach = (domain[axis][1] - domain[axis][0]) * apex.reach;
                Some(PoleChart {
                    axis,
                    base: domain[axis][end],
                    sign: if end == 0 { 1.0 } else { -1.0 },
                    low: domain[1 - axis][0],
                    reach,
                    radius: reach.powf(1.0 / apex.power),
                    apex,
                })
            })
        });
        Self {
            domain,
            sides,
            any_tip: tips.iter().flatten().any(Option::is_some),
            any_edge: [sides.u, sides.v]
                .iter()
                .flatten()
                .any(|side| *side == Side::Edge),
            tips,
            collapsed: apexes.map(|ends| ends.map(|apex| apex.is_some())),
            scale: surface.scale(),
        }
    }

    /// The tip that coordinates are about.
    pub(super) fn tip(&self, kind: CoordinateKind) -> Option<&PoleChart> {
        match kind {
            CoordinateKind::Plain => None,
            CoordinateKind::Apex { axis, end } => self
                .tips
                .get(usize::from(axis))?
                .get(usize::from(end))?
                .as_ref(),
        }
    }

    fn tips(&self) -> impl Iterator<Item = (CoordinateKind, &PoleChart)> {
        (0..2u8).flat_map(move |axis| {
            (0..2u8).filter_map(move |end| {
                let kind = CoordinateKind::Apex { axis, end };
                Some((kind, self.tip(kind)?))
            })
        })
    }

    /// The coordinates of an apex near a plain point.
    pub(super) fn chart_near(&self, at: [f64; 2]) -> Option<FanChart> {
        if !self.any_tip {
            return None;
        }
        self.tips().find_map(|(kind, tip)| {
            let near = (0.0..=ENTER * tip.reach).contains(&tip.distance(at));
            near.then_some(FanChart {
                kind,
                reference: if tip.apex.smooth {
                    tip.low
                } else {
                    at[1 - tip.axis]
                },
            })
        })
    }

    /// Returns whether a plain point is too near an apex that has its own coordinates, or beyond it.
    pub(super) fn needs_apex(&self, at: [f64; 2]) -> bool {
        self.any_tip
            && self
                .tips()
                .any(|(_, tip)| tip.distance(at) < KEEP_OFF * tip.reach)
    }

    pub(super) fn width(&self, axis: usize) -> f64 {
        self.domain[axis][1] - self.domain[axis][0]
    }

    /// The periods by which neighbours behind a smooth pole may differ.
    pub(super) fn periods(&self) -> [f64; 2] {
        [0, 1].map(|axis| {
            let pole = self.tips[1 - axis]
                .iter()
                .flatten()
                .any(|tip| tip.apex.smooth);
            if pole { self.width(axis) } else { 0.0 }
        })
    }

    /// The edge that a plain point lies beyond, if any.
    #[inline(always)]
    pub(super) fn beyond_edge(&self, at: [f64; 2]) -> Option<(usize, usize)> {
        if !self.any_edge || self.contains(at[0], at[1]) {
            return None;
        }
        (0..2).find_map(|axis| {
            let [low, high] = self.domain[axis];
            let slack = 1e-12 * (high - low);
            let sides = self.sides.of(axis);
            if sides[0] == Side::Edge && at[axis] < low - slack {
                Some((axis, 0))
            } else if sides[1] == Side::Edge && at[axis] > high + slack {
                Some((axis, 1))
            } else {
                None
            }
        })
    }

    /// Where plain points are beyond a true edge: infinite where there is none.
    pub(super) fn bounds(&self) -> [[f64; 2]; 2] {
        [0, 1].map(|axis| {
            let sides = self.sides.of(axis);
            [(0, f64::NEG_INFINITY), (1, f64::INFINITY)].map(|(end, none)| {
                let edge = sides[end] == Side::Edge && !self.is_collapsed(axis, end);
                if edge { self.domain[axis][end] } else { none }
            })
        })
    }

    pub(super) fn has_edges(&self) -> bool {
        self.any_edge
    }

    pub(super) fn is_collapsed(&self, axis: usize, end: usize) -> bool {
        self.collapsed[axis][end]
    }

    /// Returns whether a point lies within the domain itself.
    #[inline(always)]
    pub(super) fn contains(&self, u: f64, v: f64) -> bool {
        let [[a, b], [c, d]] = self.domain;
        (u >= a) & (u <= b) & (v >= c) & (v <= d)
    }

    /// Brings points back through the sides that wrap, with the signs that their coordinates' derivatives change by.
    #[inline(always)]
    pub(super) fn bring_all_back(&self, at: &mut [Lanes; 2], signs: &mut [Lanes; 2]) {
        for axis in 0..2 {
            let [low, high] = self.domain[axis];
            let side = self.sides.of(axis)[0];
            if !matches!(side, Side::Wrap | Side::WrapFlip) {
                continue;
            }
            let width = high - low;
            let share = 1.0 / width;
            let mut turns = [0.0; LANES];
            for lane in 0..LANES {
                let x = at[axis][lane];
                let turn = ((x - low) * share).floor();
                let inside = (x >= low) & (x <= high);
                turns[lane] = if inside { 0.0 } else { turn };
                at[axis][lane] = if inside {
                    x
                } else {
                    (x - turn * width).max(low).min(high)
                };
            }
            if side == Side::WrapFlip {
                let [low, high] = self.domain[1 - axis];
                for lane in 0..LANES {
                    if turns[lane].rem_euclid(2.0) == 1.0 {
                        at[1 - axis][lane] = low + high - at[1 - axis][lane];
                        signs[1 - axis][lane] = -signs[1 - axis][lane];
                    }
                }
            }
        }
    }

    /// Brings a finite point back through the sides that wrap, with the signs that its coordinates' derivatives change
    /// by.
    pub(super) fn bring_back(&self, mut at: [f64; 2]) -> ([f64; 2], [f64; 2]) {
        if !at.iter().all(|x| x.is_finite()) {
            return (at, [1.0; 2]);
        }
        let crossing = self.sides.wrap(self.domain, &mut at);
        (at, crossing.signs)
    }
}
