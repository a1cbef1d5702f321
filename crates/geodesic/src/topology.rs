//! The kinds of a domain's sides, found numerically. In: samples of a surface. Out: [`Topology`].
//!
//! A pair of opposite sides that are the same curve wraps, with a flip if one runs backwards. A side that is one point,
//! while the other parameter wraps, is the tip of a cone with some total angle; with the angle 2π it is a smooth pole.
//! Tolerances are relative to the surface's size.

use std::f64::consts::TAU;

use crate::jet::Jet;
use crate::metric::{Form, gaussian_curvature};
use crate::point::Uv;
use crate::scale::{Scale, at};
use crate::sides::{Side, Sides};
use crate::vector::{combine, cross, dot, norm};

/// A side that has collapsed to one point, regarded as the tip of a cone. With ρ the parameter's distance from the side
/// and t the other parameter, (a, b) = r (cos kt, sin kt), r = ρ^(1/power), are coordinates in which the metric is
/// regular at the tip: for a smooth pole Cartesian coordinates, for a cone the unrolled cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apex {
    /// k: the tip's angle per unit of the other parameter.
    pub rate: f64,
    /// 1 where distance is proportional to ρ near the tip, 2 where to √ρ, ½ where to ρ².
    pub power: f64,
    /// The radius of curvature at the tip, in units of r: the order of magnitude of the coordinates' radius of
    /// convergence.
    pub bend: f64,
    /// The fraction of the domain's width over which the lines of constant t leave the tip nearly straight; 1 unless
    /// they wind about it, as in a sheared chart. Beyond it the coordinates above wind as they do.
    pub reach: f64,
    /// True if the total angle is 2π: a smooth point, through which rays pass.
    pub smooth: bool,
    /// True if the coordinates are usable: the angle is proportional to t, or, at a smooth tip, the directions trace an ellipse
    /// with constant areal speed.
    pub regular: bool,
    /// True if the lines of constant t continue through the tip without a kink in their speed or direction: then the
    /// acceleration in (a, b) is smooth there.
    pub odd: bool,
}

/// The kinds of all four sides.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Topology {
    /// The kinds of the sides as met by a ray; a cone point is an edge here.
    pub sides: Sides,
    /// `[axis][end]`: the collapsed sides, poles among them.
    pub apexes: [[Option<Apex>; 2]; 2],
}

/// The maximum distance of two points that count as one, relative to the surface's size.
const SAME_POINT: f64 = 1e-8;
/// The difference between the sums of two gluings' kinks from which on the smaller one counts.
const SAME_TANGENT: f64 = 1e-3;
/// The points at which sides are compared, as fractions of the other axis: asymmetric, in pairs (s, 1−s).
pub(crate) const PLACES: [f64; 8] = [0.07, 0.21, 0.34, 0.46, 0.54, 0.66, 0.79, 0.93];
/// The maximum deviation from 2π of a smooth pole's total angle …
const FULL_TURN: f64 = 1e-6;
/// … and the maximum where two ways to measure it differ.
const UNSURE: f64 = 1e-4;

/// The distance from a tip at which its total angle is first measured, as a fraction of the domain's width.
const NEAREST: f64 = 2e-7;

/// The maximum deviation of directions from an ellipse, relative to its size.
const SAME_ELLIPSE: f64 = 1e-5;

/// The minimum change of speed or direction at a tip, over the domain's width, that counts as a kink.
const KINK: f64 = 1e-5;

/// The distances from a tip at which the lines that leave it are examined, as fractions of the domain's width: the tip of a
/// slender surface is round only when seen from nearby.
const BESIDE: [f64; 3] = [1e-5, 1e-5 / 16.0, 1e-5 / 256.0];

/// Lines that leave a tip are straight while they turn less than this angle about it.
const STRAIGHT: f64 = 0.5;

impl Topology {
    /// Determines the kinds of a domain's sides. Sides that are mostly undefined are edges.
    pub fn find(jet: &dyn Fn(Uv) -> Jet, domain: [[f64; 2]; 2]) -> Self {
        let size = Scale::measure(jet, domain).size;
        let collapsed = [0, 1].map(|axis| [0, 1].map(|end| is_point(jet, domain, axis, end, size)));
        let mut pairs = [Side::Edge; 2];
        for axis in 0..2 {
            if !collapsed[axis][0] && !collapsed[axis][1] {
                pairs[axis] = seam(jet, domain, axis, size);
            }
        }
        Self::with(pairs, collapsed, &|axis, end| {
            apex(jet, domain, axis, end, true)
        })
    }

    /// Determines the kinds of the sides of a metric's domain, from its coefficients and jets.
    pub(crate) fn of_metric(
        form: &dyn Fn(Uv) -> Form,
        jet: &dyn Fn(Uv) -> Jet,
        domain: [[f64; 2]; 2],
        scale: Scale,
    ) -> Self {
        let collapsed =
            [0, 1].map(|axis| [0, 1].map(|end| has_no_length(form, domain, axis, end, scale)));
        let mut pairs = [Side::Edge; 2];
        for axis in 0..2 {
            if !collapsed[axis][0] && !collapsed[axis][1] {
                pairs[axis] = metric_seam(form, domain, axis);
            }
        }
        Self::with(pairs, collapsed, &|axis, end| {
            // Tangents of a metric at different points have no common directions.
            let mut apex = apex(jet, domain, axis, end, false);
            apex.bend = apex.bend.min(curvature_radius(jet, domain, axis, end));
            apex
        })
    }

    fn with(
        pairs: [Side; 2],
        collapsed: [[bool; 2]; 2],
        apex: &dyn Fn(usize, usize) -> Apex,
    ) -> Self {
        let mut topology = Self::default();
        for axis in 0..2 {
            let mut sides = [pairs[axis]; 2];
            for end in 0..2 {
                if collapsed[axis][end] && pairs[1 - axis] == Side::Wrap {
                    let apex = apex(axis, end);
                    topology.apexes[axis][end] = Some(apex);
                    if apex.smooth {
                        sides[end] = Side::Pole;
                    }
                }
            }
            if axis == 0 {
                topology.sides.u = sides;
            } else {
                topology.sides.v = sides;
            }
        }
        topology
    }
}

/// Returns the point (or its fractions) with these parameters along an axis and along the other one.
pub(crate) fn place(axis: usize, along: f64, across: f64) -> [f64; 2] {
    if axis == 0 {
        [along, across]
    } else {
        [across, along]
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    norm(combine(1.0, a, -1.0, b))
}

/// Returns whether the side is one point.
fn is_point(
    jet: &dyn Fn(Uv) -> Jet,
    domain: [[f64; 2]; 2],
    axis: usize,
    end: usize,
    size: f64,
) -> bool {
    let points: Vec<[f64; 3]> = PLACES
        .iter()
        .map(|&across| jet(at(domain, place(axis, end as f64, across))).position)
        .filter(|p| p.iter().all(|x| x.is_finite()))
        .collect();
    points.len() > PLACES.len() / 2
        && points
            .iter()
            .all(|&p| distance(p, points[0]) <= SAME_POINT * size)
}

/// Returns the kind of an axis's two sides. Where they are the same curve in both directions, as a segment that is run through to
/// and fro, the direction in which the surface continues with a smaller kink counts.
fn seam(jet: &dyn Fn(Uv) -> Jet, domain: [[f64; 2]; 2], axis: usize, size: f64) -> Side {
    let side = |along: f64, across: f64| jet(at(domain, place(axis, along, across)));
    // The sum of the changes of the unit tangent across the seam; `None` if the sides are different curves.
    let kink = |other: &dyn Fn(f64) -> f64| {
        let mut compared = 0;
        let mut kink = 0.0;
        for across in PLACES {
            let ends = [side(0.0, across), side(1.0, other(across))];
            let gap = distance(ends[0].position, ends[1].position);
            if gap.is_finite() {
                if gap > SAME_POINT * size {
                    return None;
                }
                let [before, behind] = ends.map(|jet| {
                    let tangent = if axis == 0 { jet.du } else { jet.dv };
                    let length = norm(tangent);
                    tangent.map(|x| x / length)
                });
                let change = distance(before, behind);
                kink += if change.is_finite() { change } else { 0.0 };
                compared += 1;
            }
        }
        (compared > PLACES.len() / 2).then_some(kink)
    };
    match (kink(&|across| across), kink(&|across| 1.0 - across)) {
        (Some(plain), Some(flipped)) if flipped + SAME_TANGENT < plain => Side::WrapFlip,
        (Some(_), _) => Side::Wrap,
        (None, Some(_)) => Side::WrapFlip,
        (None, None) => Side::Edge,
    }
}

/// Returns whether a metric assigns the side length zero.
fn has_no_length(
    form: &dyn Fn(Uv) -> Form,
    domain: [[f64; 2]; 2],
    axis: usize,
    end: usize,
    scale: Scale,
) -> bool {
    let mut compared = 0;
    for across in PLACES {
        let [e, _, g] = form(at(domain, place(axis, end as f64, across))).efg;
        let square = if axis == 0 { g } else { e };
        let least = SAME_POINT * scale.stretch[1 - axis];
        if square.is_finite() {
            // Rounding may leave a small value on either side of zero.
            if square.abs() > least * least {
                return false;
            }
            compared += 1;
        }
    }
    compared > PLACES.len() / 2
}

/// Returns the kind of an axis's two sides in a metric: joined where the coefficients and their first derivatives
/// agree.
fn metric_seam(form: &dyn Fn(Uv) -> Form, domain: [[f64; 2]; 2], axis: usize) -> Side {
    let widths = domain.map(|[low, high]| high - low);
    let joined = |flip: bool| {
        let mut compared = 0;
        for across in PLACES {
            let other = if flip { 1.0 - across } else { across };
            let near = form(at(domain, place(axis, 0.0, across)));
            let far = form(at(domain, place(axis, 1.0, other)));
            if near.efg.iter().chain(&far.efg).any(|x| !x.is_finite()) {
                continue;
            }
            compared += 1;
            let [e, _, g] = near.efg.map(f64::abs);
            let sizes = [e, (e * g).sqrt(), g];
            for (k, size) in sizes.into_iter().enumerate() {
                // Reversed, F is odd, and so is the derivative across the flip of an even coefficient.
                let sign = if flip && k == 1 { -1.0 } else { 1.0 };
                let turned = if flip { -sign } else { sign };
                let [by_u, by_v] = if axis == 0 {
                    [sign, turned]
                } else {
                    [turned, sign]
                };
                for (a, b, unit) in [
                    (near.efg[k], sign * far.efg[k], 1.0),
                    (near.by_u[k], by_u * far.by_u[k], widths[0]),
                    (near.by_v[k], by_v * far.by_v[k], widths[1]),
                ] {
                    let (a, b) = (a * unit, b * unit);
                    // Also `false` for NaN.
                    let same = (a - b).abs() <= SAME_POINT * size.max(a.abs()).max(b.abs());
                    if !same {
                        return false;
                    }
                }
            }
        }
        compared > PLACES.len() / 2
    };
    if joined(false) {
        Side::Wrap
    } else if joined(true) {
        Side::WrapFlip
    } else {
        Side::Edge
    }
}

/// Returns the minimum of 1/√|K| slightly off an apex, in units of r.
fn curvature_radius(
    jet: &dyn Fn(Uv) -> Jet,
    domain: [[f64; 2]; 2],
    axis: usize,
    end: usize,
) -> f64 {
    const OFF: f64 = 1e-3;
    let share = if end == 0 { OFF } else { 1.0 - OFF };
    let radii = PLACES.map(|across| {
        let jet = jet(at(domain, place(axis, share, across)));
        let stretch = norm(if axis == 0 { jet.du } else { jet.dv });
        1.0 / gaussian_curvature(&jet).abs().sqrt() / stretch
    });
    radii.into_iter().fold(f64::INFINITY, f64::min)
}

/// Returns the tip's shape, from the directions in which the surface leaves it.
fn apex(
    jet: &dyn Fn(Uv) -> Jet,
    domain: [[f64; 2]; 2],
    axis: usize,
    end: usize,
    is_embedded: bool,
) -> Apex {
    const SAMPLES: u32 = 64;
    const MORE_SAMPLES: u32 = 512;
    const NEAR: f64 = 1e-6;
    const FARTHER: f64 = 1e-5;
    let share = |offset: f64| if end == 0 { offset } else { 1.0 - offset };
    let radial = |jet: &Jet| if axis == 0 { jet.du } else { jet.dv };
    let [low, high] = domain[1 - axis];
    let period = high - low;
    let width = domain[axis][1] - domain[axis][0];
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    let mut slope = 0.0;
    let mut winding = 0.0;
    let mut directions = Vec::new();
    // w|² and the areal speed, for a metric.
    let mut sizes = Vec::new();
    let mut areas = Vec::new();
    for n in 0..SAMPLES {
        let across = (f64::from(n) + 0.5) / f64::from(SAMPLES);
        let near = jet(at(domain, place(axis, share(NEAR), across)));
        let direction = radial(&near);
        directions.push(direction);
        let rate = turning(&near, axis);
        sizes.push(dot(direction, direction));
        areas.push(rate * dot(direction, direction));
        let around = if axis == 0 { near.dv } else { near.du };
        // The rate at which t must change for the line to leave the tip at a right angle to the curves about it; the
        // effect of their being ellipses cancels over a full turn.
        winding += dot(direction, around) / dot(around, around) * rate / f64::from(SAMPLES);
        least = least.min(rate);
        most = most.max(rate);
        let farther = jet(at(domain, place(axis, share(FARTHER), across)));
        slope += (norm(radial(&farther)) / norm(direction)).ln()
            / (FARTHER / NEAR).ln()
            / f64::from(SAMPLES);
    }
    // Distance grows like ρ^(1 + slope).
    let power = [1.0, 2.0, 0.5]
        .into_iter()
        .find(|power| (1.0 / power - 1.0 - slope).abs() < 0.02);
    let odd = power.and_then(|power| {
        let mut distances = BESIDE.into_iter();
        distances.find(|off| is_odd(jet, (domain, axis, end), power, *off, is_embedded))
    });
    let beside = odd.unwrap_or(BESIDE[0]);
    let bend = power.map_or(0.0, |power| bend(jet, (domain, axis, end), power, beside));
    let even = most - least <= 1e-3 * most;
    // The midpoints of equal steps integrate best a function that is smooth across the seam; Gauss points, two to a step of
    // twice the length, one that is not.
    let totals = |samples: u32| {
        let middle = |n: u32| (f64::from(n) + 0.5) / f64::from(samples);
        let gauss = |n: u32| {
            let off = if n.is_multiple_of(2) { -1.0 } else { 1.0 } / 3.0_f64.sqrt();
            (f64::from(n - n % 2) + 1.0 + off) / f64::from(samples)
        };
        [&middle as &dyn Fn(u32) -> f64, &gauss].map(|across| {
            total_angle(power.unwrap_or(1.0), &|off| {
                let rate = |n| {
                    let jet = jet(at(domain, place(axis, share(off), across(n))));
                    turning(&jet, axis) * period / f64::from(samples)
                };
                (0..samples).map(rate).sum()
            })
        })
    };
    let [mut total, mut other] = totals(SAMPLES);
    if (total - other).abs() > FULL_TURN {
        // The directions of a slender ellipse turn fast near its ends.
        [total, other] = totals(MORE_SAMPLES);
    }
    let bound = (2.0 * (total - other).abs()).clamp(FULL_TURN, UNSURE);
    let smooth = power.is_some() && (total - TAU).abs() <= bound;
    Apex {
        rate: if smooth { TAU / period } else { total / period },
        power: power.unwrap_or(1.0),
        bend,
        reach: (STRAIGHT / (winding.abs() * width)).min(1.0),
        smooth,
        odd: odd.is_some(),
        regular: if smooth && is_embedded {
            is_ellipse(&directions)
        } else if smooth {
            is_ellipse_by_sizes(&sizes, &areas)
        } else {
            power.is_some() && even && total > 1e-3
        },
    }
}

/// Returns the rate, by the other parameter t, at which the direction w of the lines of constant t turns: |w ×
/// w_t|/|w|².
fn turning(jet: &Jet, axis: usize) -> f64 {
    let direction = if axis == 0 { jet.du } else { jet.dv };
    norm(cross(direction, jet.duv)) / dot(direction, direction)
}

/// Returns the angle of a tip from those measured at several distances from it, as fractions of the domain's width: terms
/// in r and r² are eliminated (Richardson extrapolation).
fn total_angle(power: f64, measured: &dyn Fn(f64) -> f64) -> f64 {
    const ROUNDING: f64 = 1e-12;
    let [a, b, c] = [1.0, 2.0, 4.0_f64].map(|r| measured(NEAREST * r.powf(power)));
    let change = (5.0 * (a - b) + (c - b)) / 3.0;
    if change.abs() <= ROUNDING * a {
        a
    } else {
        a + change
    }
}

/// Returns whether directions at equal steps of a full turn are those of an ellipse about its centre: the linear images of
/// (cos t, sin t). Otherwise (a, b) is not differentiable there on the surface.
fn is_ellipse(directions: &[[f64; 3]]) -> bool {
    let count = directions.len() as f64;
    let turned = |n: usize| TAU * n as f64 / count;
    let mut axes = [[0.0; 3]; 2];
    for (n, direction) in directions.iter().enumerate() {
        let (sin, cos) = turned(n).sin_cos();
        for (axis, share) in axes.iter_mut().zip([cos, sin]) {
            *axis = combine(1.0, *axis, 2.0 * share / count, *direction);
        }
    }
    let size = axes.map(norm).into_iter().fold(0.0, f64::max);
    let axes = axes.map(|axis| axis.map(|x| x / size));
    let normal = cross(axes[0], axes[1]);
    directions.iter().enumerate().all(|(n, direction)| {
        let (sin, cos) = turned(n).sin_cos();
        let fitted = combine(cos, axes[0], sin, axes[1]);
        let off = combine(1.0 / size, *direction, -1.0, fitted);
        // Curvature displaces all of them along the normal.
        norm(cross(off, normal)) <= SAME_ELLIPSE * norm(normal)
    })
}

/// The same for a metric, whose directions have no common frame: their squared sizes are a₀ + a₁ cos 2t + a₂ sin 2t, and the
/// areal speed is constant.
fn is_ellipse_by_sizes(sizes: &[f64], areas: &[f64]) -> bool {
    let count = sizes.len() as f64;
    let turned = |n: usize| 2.0 * TAU * n as f64 / count;
    let mut fit = [0.0; 3];
    for (n, size) in sizes.iter().enumerate() {
        let (sin, cos) = turned(n).sin_cos();
        for (sum, share) in fit.iter_mut().zip([1.0, 2.0 * cos, 2.0 * sin]) {
            *sum += share * size / count;
        }
    }
    let mean = areas.iter().sum::<f64>() / count;
    let is_even = |area: &f64| (area - mean).abs() <= SAME_ELLIPSE * mean;
    let is_fitted = |(n, size): (usize, &f64)| {
        let (sin, cos) = turned(n).sin_cos();
        (size - fit[0] - fit[1] * cos - fit[2] * sin).abs() <= SAME_ELLIPSE * fit[0]
    };
    areas.iter().all(is_even) && sizes.iter().enumerate().all(is_fitted)
}

/// A side at which an apex is: the domain, the axis that ends there, and the end of it.
type ApexSide = ([[f64; 2]; 2], usize, usize);

/// Returns whether the lines that leave the apex continue through it without a kink: neither their speed nor their
/// direction in the surface has a first derivative by r at r = 0. A metric determines only the speed. They are examined at a
/// fraction of the domain's width off the apex.
fn is_odd(
    jet: &dyn Fn(Uv) -> Jet,
    (domain, axis, end): ApexSide,
    power: f64,
    beside: f64,
    is_embedded: bool,
) -> bool {
    let reach = (domain[axis][1] - domain[axis][0]).powf(1.0 / power);
    // The rates of speed and direction by r, relative to the speed.
    let rates = |across: f64, off: f64| {
        let [by_r, by_rr, around] = by_radius(jet, (domain, axis, end), power, across, off);
        let square = dot(by_r, by_r);
        let beside = combine(1.0, around, -dot(around, by_r) / square, by_r);
        let aside = dot(by_rr, beside) / norm(beside) / square.sqrt();
        [
            dot(by_rr, by_r) / square,
            if is_embedded { aside } else { 0.0 },
        ]
    };
    PLACES.iter().all(|&across| {
        // Eliminate the terms linear in r.
        let near = rates(across, beside);
        let twice = rates(across, beside * 2.0f64.powf(power));
        (0..2).all(|k| ((2.0 * near[k] - twice[k]) * reach).abs() <= KINK)
    })
}

/// Returns σ_r, σ_rr and the tangent along the other parameter, at a fraction of the domain's width off the apex.
fn by_radius(
    jet: &dyn Fn(Uv) -> Jet,
    (domain, axis, end): ApexSide,
    power: f64,
    across: f64,
    off: f64,
) -> [[f64; 3]; 3] {
    let [low, high] = domain[axis];
    let r = (off * (high - low)).powf(1.0 / power);
    let (sign, share) = if end == 0 {
        (1.0, off)
    } else {
        (-1.0, 1.0 - off)
    };
    let jet = jet(at(domain, place(axis, share, across)));
    let (w, ww, around) = if axis == 0 {
        (jet.du, jet.duu, jet.dv)
    } else {
        (jet.dv, jet.dvv, jet.du)
    };
    let first = sign * power * r.powf(power - 1.0);
    let by_r = w.map(|x| x * first);
    let by_rr = combine(first * first, ww, first * (power - 1.0) / r, w);
    [by_r, by_rr, around]
}

/// Returns the minimum radius of curvature of the coordinate lines that leave the apex, at a fraction of the domain's width off
/// it, in units of r.
fn bend(jet: &dyn Fn(Uv) -> Jet, side: ApexSide, power: f64, beside: f64) -> f64 {
    let radii = PLACES.map(|across| {
        let [by_r, by_rr, _] = by_radius(jet, side, power, across, beside);
        let bent = norm(cross(by_r, by_rr)) / dot(by_r, by_r);
        1.0 / bent
    });
    // `min` ignores NaN.
    radii.into_iter().fold(f64::INFINITY, f64::min)
}
