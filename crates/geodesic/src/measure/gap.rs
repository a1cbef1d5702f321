//! The displacement from a ray's end to a nearby target, along and across the ray.
//!
//! A target has several copies in the coordinates about an end: beyond each side that wraps, and, about an apex, in the
//! coordinates in which the metric is regular there.

use super::MeasureError;
use super::source::{Arrival, RaySource};
use crate::frame::Frame;
use crate::metric::{Metric, gaussian_curvature, speed};
use crate::point::{TangentVector, Uv};
use crate::status::Status;
use crate::surface::{Side, Surface};
use crate::trace::TraceError;
use crate::vector::{combine, norm};

/// A point that geodesics are to reach.
#[derive(Clone)]
pub(super) struct AimedPlace<'s> {
    surface: &'s dyn Surface,
    pub(super) uv: Uv,
    /// Its position in space, if the surface is embedded.
    position: Option<[f64; 3]>,
    /// The point in coordinates that continue beyond the sides.
    copies: Vec<Uv>,
    /// The lattice of all its copies, if the nearest may be farther away than beyond the adjacent side.
    lattice: Option<SkewedLattice>,
}

/// About an apex, within this fraction of its chart's reach, the chart's coordinates are used.
const NEAR_APEX: f64 = 0.3;
/// A point nearer to the tip of a cone than this fraction of the domain's width is the tip.
const AT_TIP: f64 = 1e-12;

impl<'s> AimedPlace<'s> {
    pub(super) fn new(surface: &'s dyn Surface, given: Uv) -> Result<Self, MeasureError> {
        let domain = surface.domain();
        let mut at = given.0;
        surface.sides().bring_back(domain, &mut at);
        let tip = tip_at(surface, at);
        match Frame::new(surface, given, 0.0, 1.0) {
            Err(TraceError::DegenerateStart { .. }) if tip.is_some() => {}
            Err(error) => return Err(error.into()),
            Ok(_) => {}
        }
        for (x, [low, high]) in at.iter_mut().zip(domain) {
            *x = x.clamp(low, high);
        }
        let uv = Uv(at);
        let position = surface.is_embedded().then(|| surface.jet(uv).position);
        Ok(Self {
            surface,
            uv,
            position,
            copies: copies(surface, uv),
            lattice: SkewedLattice::at(surface, uv),
        })
    }

    /// Returns the displacements in the coordinates from a point to the nearby copies.
    fn ways(&self, from: Uv) -> impl Iterator<Item = TangentVector> {
        let next = self.copies.iter().map(move |&copy| copy - from);
        let nearest = self.lattice.map(|lattice| lattice.nearest(self.uv - from));
        next.chain(nearest.into_iter().flatten())
    }

    /// Returns the displacement from an end: its components along the ray and across it.
    pub(super) fn way_from(&self, end: &Arrival) -> Option<[f64; 2]> {
        let near_apex = self.about_apex(end);
        if near_apex.is_some() {
            return near_apex;
        }
        let ways = self
            .ways(end.at)
            .filter_map(|way| components(end.along, end.left, way));
        ways.min_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1])))
    }

    /// Returns the distance from an end in space, if the surface is embedded: a lower bound of the one on the surface.
    pub(super) fn distance_in_space(&self, end: &Arrival) -> Option<f64> {
        let position = self.position?;
        let other = self.surface.jet(end.at).position;
        Some(norm(combine(1.0, position, -1.0, other)))
    }

    /// Returns an approximate lower bound of the distance from an end: exact in space, else half of the displacement
    /// in the coordinates.
    pub(super) fn distance_at_least(&self, end: &Arrival) -> f64 {
        if let Some(distance) = self.distance_in_space(end) {
            return distance;
        }
        let jet = self.surface.jet(self.uv);
        let here = self.way_from(end).map_or(0.0, |[x, y]| x.hypot(y));
        if self.about_apex(end).is_some() {
            return 0.5 * here;
        }
        let there = self
            .ways(end.at)
            .map(|way| speed(&jet, way))
            .fold(f64::INFINITY, f64::min);
        0.5 * if there.is_finite() {
            here.min(there)
        } else {
            here
        }
    }

    /// Returns the distance from a nearby point, by the metric at the target.
    pub(super) fn distance_from(&self, at: Uv) -> Option<f64> {
        let jet = self.surface.jet(self.uv);
        let e = TangentVector([1.0, 0.0]);
        let metric = Metric::of(&jet);
        let along = e.map(|x| x / metric.e.sqrt());
        let end = Arrival {
            at: self.uv,
            along,
            left: metric.turn_left(along),
            m: 0.0,
            length: 0.0,
            status: Status::Complete,
        };
        let other = Self {
            uv: at,
            copies: copies(self.surface, at),
            lattice: SkewedLattice::at(self.surface, at),
            ..self.clone()
        };
        // At a pole σu has no direction: there use the distance in space, or the one along a meridian.
        let way = other.way_from(&end).map(|[x, y]| x.hypot(y));
        way.or_else(|| {
            let position = self.position?;
            let here = self.surface.jet(at).position;
            Some(norm(combine(1.0, position, -1.0, here)))
        })
    }

    /// Returns an approximate lower bound of the distance from a source: exact in space; else the hyperbolic distance that
    /// corresponds to the displacement in the coordinates of a half-plane with the curvature here, less a third.
    pub(super) fn near_distance(&self, source: &RaySource<'_>) -> f64 {
        let Ok((start, _)) = source.follow(0.0, 0.0, false) else {
            return 0.0;
        };
        if self.position.is_some() {
            return self.distance_at_least(&start);
        }
        let curvature = |at: Uv| gaussian_curvature(&self.surface.jet(at)).abs();
        let root = curvature(self.uv).max(curvature(start.at)).sqrt();
        let way = self.way_from(&start).map_or(0.0, |[x, y]| x.hypot(y));
        let bent = 0.5 * way * root;
        if bent > 1e-3 && bent.is_finite() {
            2.0 / 3.0 * way * (bent.asinh() / bent)
        } else {
            2.0 / 3.0 * way
        }
    }

    /// Returns the minimum length of the chart's straight lines from a point to the copies; infinite where all of them
    /// leave the surface. Lines on a side that is a point have length zero.
    pub(super) fn straight_length(&self, from: Uv) -> f64 {
        const PIECES: u32 = 64;
        let sides = self.surface.sides();
        let domain = self.surface.domain();
        let line = |way: TangentVector| {
            let length: f64 = (0..PIECES)
                .map(|n| {
                    let share = (f64::from(n) + 0.5) / f64::from(PIECES);
                    let mut at = (from + share * way).0;
                    let signs = sides.bring_back(domain, &mut at).signs;
                    let way = TangentVector([signs[0] * way[0], signs[1] * way[1]]);
                    speed(&self.surface.jet(Uv(at)), way) / f64::from(PIECES)
                })
                .sum();
            if length.is_nan() {
                f64::INFINITY
            } else {
                length
            }
        };
        let none = 64.0 * f64::EPSILON * self.surface.scale().size;
        let lengths = self.ways(from).map(line).filter(|length| *length > none);
        lengths.fold(f64::INFINITY, f64::min)
    }

    /// Returns the displacement in the coordinates about an apex that both points are near.
    fn about_apex(&self, end: &Arrival) -> Option<[f64; 2]> {
        let domain = self.surface.domain();
        for axis in 0..2 {
            for side in 0..2 {
                let Some(apex) = self.surface.apex(axis, side).filter(|apex| apex.regular) else {
                    continue;
                };
                let sign = if side == 0 { 1.0 } else { -1.0 };
                let reach = NEAR_APEX * apex.reach * (domain[axis][1] - domain[axis][0]);
                let rho = |at: Uv| (sign * (at[axis] - domain[axis][side])).max(0.0);
                let [here, there] = [rho(end.at), rho(self.uv)];
                if here > reach || there > reach || here == 0.0 {
                    continue;
                }
                let root = 1.0 / apex.power;
                let [r, s] = [here, there].map(|rho| rho.powf(root));
                let period = domain[1 - axis][1] - domain[1 - axis][0];
                let turn = self.uv[1 - axis] - end.at[1 - axis];
                let angle = apex.rate * (turn - period * (turn / period).round());
                if !apex.smooth && there > 0.0 && angle.abs() >= std::f64::consts::PI {
                    // The tip is between them.
                    continue;
                }
                // The end is on the a-axis.
                let vector = |v: TangentVector| {
                    let radial = sign * v[axis] * root * here.powf(root - 1.0);
                    TangentVector([radial, r * apex.rate * v[1 - axis]])
                };
                let way = TangentVector([s * angle.cos() - r, s * angle.sin()]);
                return components(vector(end.along), vector(end.left), way);
            }
        }
        None
    }
}

/// Returns the components of a vector along two others; `None` where they do not span a plane.
pub fn components(a: TangentVector, b: TangentVector, way: TangentVector) -> Option<[f64; 2]> {
    let determinant = a[0] * b[1] - a[1] * b[0];
    let found = [
        (way[0] * b[1] - way[1] * b[0]) / determinant,
        (a[0] * way[1] - a[1] * way[0]) / determinant,
    ];
    found.iter().all(|x| x.is_finite()).then_some(found)
}

/// Returns the cone whose tip is at a point.
fn tip_at(surface: &dyn Surface, at: [f64; 2]) -> Option<(usize, usize)> {
    let domain = surface.domain();
    let mut ends = (0..2).flat_map(|axis| [(axis, 0), (axis, 1)]);
    ends.find(|&(axis, end)| {
        let off = (at[axis] - domain[axis][end]).abs();
        let apex = surface.apex(axis, end);
        apex.is_some_and(|apex| apex.regular && !apex.smooth)
            && off <= AT_TIP * (domain[axis][1] - domain[axis][0])
    })
}

/// Returns the step in (u, v) from one point to a near one: of those across sides that are glued, the shortest by the metric
/// at the first point.
pub fn shortest_step(
    surface: &dyn Surface,
    from: impl Into<Uv>,
    to: impl Into<Uv>,
) -> TangentVector {
    let from = from.into();
    let metric = Metric::of(&surface.jet(from));
    let length = |step: &TangentVector| metric.inner(*step, *step);
    let steps = copies(surface, to.into()).into_iter();
    let steps = steps.map(|copy| TangentVector([copy[0] - from[0], copy[1] - from[1]]));
    let shortest = steps.min_by(|a, b| length(a).total_cmp(&length(b)));
    shortest.expect("the first copy is the point itself")
}

/// Returns whether two pairs (u, v) denote the same point: they are equal up to rounding, are on sides that are glued, or on a
/// side that is a point.
pub fn is_one_place(surface: &dyn Surface, a: impl Into<Uv>, b: impl Into<Uv>) -> bool {
    const ROUNDING: f64 = 4.0 * f64::EPSILON;
    let domain = surface.domain();
    let [a, b] = [a.into(), b.into()].map(|Uv(mut at)| {
        surface.sides().bring_back(domain, &mut at);
        at
    });
    let widths = domain.map(|[low, high]| high - low);
    let is_near = |other: &Uv| {
        let off = |axis: usize| (a[axis] - other[axis]).abs();
        (0..2).all(|axis| off(axis) <= ROUNDING * widths[axis])
    };
    let is_at = |at: [f64; 2], axis: usize, end: usize| {
        (at[axis] - domain[axis][end]).abs() <= AT_TIP * widths[axis]
    };
    let mut ends = (0..2).flat_map(|axis| [(axis, 0), (axis, 1)]);
    // A domain may be much wider than the distances on it.
    (0..2).all(|axis| (a[axis] - b[axis]).abs() <= ROUNDING * a[axis].abs())
        // The first copy is the point itself.
        || copies(surface, Uv(b)).iter().skip(1).any(is_near)
        || ends.any(|(axis, end)| {
            let is_point = surface.apex(axis, end).is_some();
            is_point && is_at(a, axis, end) && is_at(b, axis, end)
        })
}

/// The periods of a surface whose metric is so oblique that the nearest copy of a point may be beyond others.
#[derive(Clone, Copy)]
struct SkewedLattice {
    /// A reduced basis, by the metric at the point; the second vector is zero where one pair of sides wraps.
    periods: [TangentVector; 2],
    metric: Metric,
}

impl SkewedLattice {
    /// Returns the lattice by the metric at a point; `None` where the nearest copies are those beyond the adjacent sides,
    /// and where sides are glued with a flip, whose metric is oblique both ways.
    fn at(surface: &dyn Surface, uv: Uv) -> Option<Self> {
        let domain = surface.domain();
        let width = |axis: usize| domain[axis][1] - domain[axis][0];
        let [mut p, mut q] = [
            TangentVector([width(0), 0.0]),
            TangentVector([0.0, width(1)]),
        ];
        let kinds = [0, 1].map(|axis| surface.sides().of(axis)[0]);
        let metric = Metric::of(&surface.jet(uv));
        let oblique = 2.0 * metric.inner(p, q).abs();
        let is_oblique = |period: TangentVector| oblique > metric.inner(period, period);
        let is_of_use = match kinds {
            [Side::Wrap, Side::Wrap] => is_oblique(p) || is_oblique(q),
            [Side::WrapFlip, _] | [_, Side::WrapFlip] => false,
            [Side::Wrap, _] => is_oblique(p),
            [_, Side::Wrap] => {
                std::mem::swap(&mut p, &mut q);
                is_oblique(p)
            }
            _ => false,
        };
        if !is_of_use || !oblique.is_finite() {
            return None;
        }
        if kinds != [Side::Wrap; 2] {
            q = TangentVector([0.0; 2]);
        }
        // Lagrange's reduction: each round shortens the longer vector, by a constant factor except in the last round.
        for _ in 0..64 {
            if metric.inner(q, q) < metric.inner(p, p) && q != TangentVector([0.0; 2]) {
                std::mem::swap(&mut p, &mut q);
            }
            let times = (metric.inner(p, q) / metric.inner(p, p)).round();
            if times == 0.0 {
                break;
            }
            q = q - times * p;
        }
        let lattice = Self {
            periods: [p, q],
            metric,
        };
        lattice
            .periods
            .iter()
            .all(|it| it.is_finite())
            .then_some(lattice)
    }

    /// Returns the nine (or three) shortest displacements that differ from the given one by periods: with a reduced basis,
    /// the nearest copy is adjacent to the one whose coordinates are both at most one half.
    fn nearest(&self, way: TangentVector) -> [TangentVector; 9] {
        let [p, q] = self.periods;
        let [x, y] = components(p, q, way).unwrap_or_else(|| {
            let share = self.metric.inner(way, p) / self.metric.inner(p, p);
            [share, 0.0]
        });
        let shortest = way - x.round() * p - y.round() * q;
        std::array::from_fn(|n| {
            let [i, j] = [n / 3, n % 3].map(|k| k as f64 - 1.0);
            shortest + i * p + j * q
        })
    }
}

/// Returns a point and its copies beyond each side that wraps.
fn copies(surface: &dyn Surface, uv: Uv) -> Vec<Uv> {
    let domain = surface.domain();
    let mut copies = vec![uv];
    for axis in 0..2 {
        let side = surface.sides().of(axis)[0];
        let width = domain[axis][1] - domain[axis][0];
        let [low, high] = domain[1 - axis];
        let before = copies.clone();
        for shift in [-width, width] {
            for copy in &before {
                let mut copy = *copy;
                match side {
                    Side::Wrap => {}
                    Side::WrapFlip => copy[1 - axis] = low + high - copy[1 - axis],
                    Side::Edge | Side::Pole => continue,
                }
                copy[axis] += shift;
                copies.push(copy);
            }
        }
    }
    copies
}
