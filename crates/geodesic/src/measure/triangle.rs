//! Triangles of shortest geodesics. In: three corners. Out: sides, angles, the area and ∫K of the region inside.
//!
//! The region is swept by the geodesics from a corner, or from the tip of a cone inside, to the points of the sides. Let t
//! be the arc length along a side, θ the angle of the geodesic that meets it there, and m its Jacobi field. Then dθ/dt is
//! the component of the side's direction across that geodesic over m; the geodesic sweeps an area of ∫m ds dθ and, since
//! m'' = −K m, a curvature of (1 − m') dθ.

use std::f64::consts::{PI, TAU};
use std::fmt;

use super::MeasureError;
use super::between::{Connection, FAMILY_REMARK, all_within, shortest};
use super::gap::{AimedPlace, components, is_one_place};
use super::quadrature;
use super::rescaled::Rescaled;
use super::shoot::{self, PolarVector};
use super::source::RaySource;
use crate::jacobi::integral;
use crate::point::{TangentVector, Uv};
use crate::reparametrised::Reparametrised;
use crate::surface::Surface;

/// A triangle of shortest geodesics.
#[derive(Clone, Debug, PartialEq)]
pub struct Triangle {
    /// The sides, the k-th opposite the k-th corner; `None` where no geodesic was found.
    pub sides: [Option<Connection>; 3],
    /// True for a side if another geodesic between its ends was found that is as short.
    pub ties: [bool; 3],
    /// The angles at the corners, in radians: those of the region inside, which may be larger than π where it contains the tip
    /// of a cone; without a region the smaller ones. `None` where a side is missing.
    pub angles: [Option<f64>; 3],
    /// The region inside.
    pub region: Result<TriangleRegion, NoRegion>,
}

impl Triangle {
    /// The sum of the angles less π; `None` where a side is missing.
    pub fn excess(&self) -> Option<f64> {
        let [a, b, c] = self.angles;
        Some(a? + b? + c? - PI)
    }

    /// Returns the remark at a side, with an index from 0, that is one of several shortest geodesics: with another one the
    /// angles and the region are others.
    pub fn remark(&self, side: usize) -> Option<&'static str> {
        match self.sides[side] {
            Some(side) if side.conjugate => Some(FAMILY_REMARK),
            _ => self.ties[side].then_some("one of several of this length"),
        }
    }
}

/// The region inside a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleRegion {
    /// Its area.
    pub area: f64,
    /// The integral of the Gaussian curvature over it, plus the angular deficit of a cone's tip inside.
    pub curvature: f64,
    /// The estimated error of the area.
    pub area_error: f64,
    /// The estimated error of the curvature.
    pub curvature_error: f64,
}

/// The reason why a triangle has no region.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum NoRegion {
    /// Two corners are the same point.
    OnePlace {
        /// The indices of the corners, from 0.
        corners: [usize; 2],
    },
    /// No geodesic was found between two corners.
    NoSide {
        /// The indices of the corners, from 0.
        corners: [usize; 2],
    },
    /// The geodesics from the first corner to the opposite side do not sweep a region between the other sides: the
    /// triangle encloses a handle, a hole or more than one tip, or geodesics meet inside it.
    NotSwept,
}

impl fmt::Display for NoRegion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OnePlace { corners: [a, b] } => {
                write!(f, "the corners {} and {} are the same point", a + 1, b + 1)
            }
            Self::NoSide { corners: [a, b] } => {
                let (a, b) = (a + 1, b + 1);
                write!(f, "no geodesic between the corners {a} and {b} was found")
            }
            Self::NotSwept => f.write_str(
                "the geodesics from the first corner to the opposite side sweep no region between the other two sides: \
                 the triangle runs around a handle or a hole, or geodesics meet inside it",
            ),
        }
    }
}

/// The error allowed to the quadrature, and to rays and corners, relative to the square of the largest side; for ∫K, to 1.
const TOLERANCE: f64 = 1e-10;
const OF_RAYS: f64 = 1e-9;
/// The maximum number of the quadrature's intervals along a side.
const MOST: usize = 24;
/// The approximate number of strides in which a side is first followed.
const STRIDES: f64 = 6.0;
/// The minimum length of a stride as a fraction of its side.
const SHORTEST: f64 = 1e-3;
/// The maximum angle by which a ray may turn from one point of a side to the next, beyond the expected angle.
const LEAP: f64 = 0.3;
/// The maximum difference between the angles swept and those at the corner.
const SAME_ANGLE: f64 = 1e-6;

/// Measures the triangle of three corners.
///
/// # Errors
/// [`MeasureError`] where a corner is outside the domain, or the surface is undefined or degenerate there.
pub fn triangle<P: Into<Uv>>(
    surface: &dyn Surface,
    corners: [P; 3],
) -> Result<Triangle, MeasureError> {
    let corners = corners.map(Into::into);
    if let Some(usual) = Rescaled::of(surface) {
        let found = triangle(&usual, corners.map(|corner| usual.changed(corner)));
        let mut found = found.map_err(|error| usual.restored_error(error))?;
        found.sides = found.sides.map(|side| Some(side?.rescaled(&usual)));
        if let Ok(region) = &mut found.region {
            region.area *= usual.size() * usual.size();
            region.area_error *= usual.size() * usual.size();
        }
        return Ok(found);
    }
    if let Some(even) = Reparametrised::of(surface) {
        let found = triangle_on(&even, corners.map(|corner| even.changed(corner).0));
        let mut found = found.map_err(|error| error.restored(&even))?;
        found.sides = found.sides.map(|side| Some(side?.restored(&even)));
        return Ok(found);
    }
    triangle_on(surface, corners)
}

fn triangle_on(surface: &dyn Surface, corners: [Uv; 3]) -> Result<Triangle, MeasureError> {
    let mut sources = Vec::new();
    let mut targets = Vec::new();
    for corner in corners {
        sources.push(RaySource::at(surface, corner)?);
        targets.push(AimedPlace::new(surface, corner)?);
    }
    let is_one = |[from, to]: [usize; 2]| is_one_place(surface, corners[from], corners[to]);
    let side = |[from, to]: [usize; 2]| {
        // Loops are not sides.
        if is_one([from, to]) {
            return (None, false);
        }
        let all = shortest(&sources[from], &targets[to]);
        (all.found.first().copied(), all.has_tie())
    };
    let [(ab, tie_ab), (ac, tie_ac), (bc, tie_bc)] = [[0, 1], [0, 2], [1, 2]].map(side);
    let leaving = |side: &Option<Connection>| side.map(|side| side.angle);
    let arriving = |at: usize, side: &Option<Connection>| {
        side.and_then(|side| sources[at].angle_of(side.to, -side.arrival))
    };
    let between = |one: Option<f64>, other: Option<f64>| {
        let turn = (one? - other?) / TAU;
        Some(((turn - turn.round()) * TAU).abs())
    };
    let mut angles = [
        between(leaving(&ab), leaving(&ac)),
        between(arriving(1, &ab), leaving(&bc)),
        between(arriving(2, &ac), arriving(2, &bc)),
    ];
    let without = |corners: [usize; 2]| match is_one(corners) {
        true => Err(NoRegion::OnePlace { corners }),
        false => Err(NoRegion::NoSide { corners }),
    };
    let region = match (ab, ac, bc) {
        (None, _, _) => without([0, 1]),
        (_, None, _) => without([0, 2]),
        (_, _, None) => without([1, 2]),
        (Some(ab), Some(ac), Some(bc)) => {
            let sides = [
                SidePath::new(&sources[0], &ab, false),
                SidePath::new(&sources[1], &bc, false),
                SidePath::new(&sources[0], &ac, true),
            ];
            region(surface, &sources[0], &targets[0], &sides).map(|(region, inside)| {
                if let Some(inside) = inside {
                    angles = inside.map(Some);
                }
                region
            })
        }
    };
    Ok(Triangle {
        sides: [bc, ac, ab],
        ties: [tie_bc, tie_ac, tie_ab],
        angles,
        region,
    })
}

/// A side, traversed in the order of the corners.
struct SidePath<'a, 's> {
    source: &'a RaySource<'s>,
    side: Connection,
    /// True if it was found from its end to its start.
    backward: bool,
}

impl<'a, 's> SidePath<'a, 's> {
    fn new(source: &'a RaySource<'s>, side: &Connection, backward: bool) -> Self {
        Self {
            source,
            side: *side,
            backward,
        }
    }

    /// Returns the point at an arc length and the direction there.
    fn at(&self, t: f64) -> Option<(Uv, TangentVector)> {
        let length = if self.backward {
            self.side.length - t
        } else {
            t
        };
        let (end, _) = self.source.follow(self.side.angle, length, false).ok()?;
        let along = if self.backward { -end.along } else { end.along };
        Some((end.at, along))
    }
}

/// The sums of a sweep along a side.
#[derive(Clone, Copy)]
struct Sweep {
    /// Area, curvature, angle.
    values: [f64; 3],
    errors: [f64; 3],
    /// The ray to the side's end.
    last: PolarVector,
    /// The components of the side's direction along and across the rays to its start and to its end.
    directions: [[f64; 2]; 2],
}

/// Returns the region, and its angles at the corners where they need not be the smaller ones.
fn region(
    surface: &dyn Surface,
    corner: &RaySource<'_>,
    first: &AimedPlace<'_>,
    sides: &[SidePath<'_, '_>; 3],
) -> Result<(TriangleRegion, Option<[f64; 3]>), NoRegion> {
    let [ab, bc, ca] = sides;
    for (axis, end) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        if let Some(tip) = RaySource::tip(surface, axis, end)
            && let Some((found, angles)) =
                around_tip(surface, &tip, (axis, end), corner, first, sides)
        {
            return Ok((found, Some(angles)));
        }
    }
    let start = PolarVector {
        angle: ab.side.angle,
        length: ab.side.length,
    };
    let swept = sweep(corner, bc, start).ok_or(NoRegion::NotSwept)?;
    let turn = (ca.side.angle - ab.side.angle) / TAU;
    let expected = (turn - turn.round()) * TAU;
    let [area, curvature, angle] = swept.values;
    let reached = (swept.last.length - ca.side.length).abs() <= SAME_ANGLE * ca.side.length;
    // (A flat triangle's area is zero, and either side of it will do.)
    if !reached || (angle - expected).abs() > SAME_ANGLE {
        return Err(NoRegion::NotSwept);
    }
    let found = measured([area, curvature], &swept.errors, angle.signum(), sides, 0.0);
    Ok((found, None))
}

fn measured(
    [area, curvature]: [f64; 2],
    errors: &[f64; 3],
    sign: f64,
    sides: &[SidePath<'_, '_>; 3],
    deficit: f64,
) -> TriangleRegion {
    let longest = sides
        .iter()
        .map(|path| path.side.length)
        .fold(0.0, f64::max);
    TriangleRegion {
        area: sign * area,
        curvature: sign * curvature + deficit,
        area_error: errors[0] + OF_RAYS * area.abs().max(longest * longest),
        curvature_error: errors[1] + OF_RAYS * curvature.abs().max(1.0),
    }
}

/// Returns the region about the tip of a cone and its angles at the corners, if the triangle encloses it once: all three sides
/// as seen from the tip.
fn around_tip(
    surface: &dyn Surface,
    tip: &RaySource<'_>,
    (axis, end): (usize, usize),
    corner: &RaySource<'_>,
    first: &AimedPlace<'_>,
    sides: &[SidePath<'_, '_>; 3],
) -> Option<(TriangleRegion, [f64; 3])> {
    let mut place = first.uv;
    place[axis] = surface.domain()[axis][end];
    let target = AimedPlace::new(surface, place).ok()?;
    let longest: f64 = sides.iter().map(|path| path.side.length).sum();
    // A tip inside is nearer to each corner than half of the perimeter.
    let to_tip = all_within(corner, &target, longest);
    let to_tip = to_tip.found.first()?;
    // Just before the tip the ray is on the meridian by which it arrives.
    let (near, _) = corner
        .follow(to_tip.angle, 0.98 * to_tip.length, false)
        .ok()?;
    let guess = PolarVector {
        angle: tip.angle_towards(near.at)?,
        length: to_tip.length,
    };
    let mut at = shoot::hit(tip, first, guess)?.at;
    let (mut values, mut errors) = ([0.0; 3], [0.0; 3]);
    let mut directions = Vec::new();
    for side in sides {
        let swept = sweep(tip, side, at)?;
        at = swept.last;
        directions.push(swept.directions);
        for k in 0..3 {
            values[k] += swept.values[k];
            errors[k] += swept.errors[k];
        }
    }
    let [area, curvature, angle] = values;
    let inside = (angle.abs() - tip.turn()).abs() <= SAME_ANGLE;
    inside.then(|| {
        let deficit = TAU - tip.turn();
        let sign = angle.signum();
        let found = measured([area, curvature], &errors, sign, sides, deficit);
        // At each corner, from the side that arrives over the way to the tip to the side that leaves.
        let angles = std::array::from_fn(|k| {
            let [_, [along, across]] = directions[(k + 2) % 3];
            let [[away, aside], _] = directions[k];
            (sign * across).atan2(along) + (sign * aside).atan2(-away)
        });
        (found, angles)
    })
}

/// The ray from a source to a point of a side.
#[derive(Clone, Copy)]
struct KnownRay {
    t: f64,
    at: PolarVector,
    /// The derivatives by t.
    rate: PolarVector,
    /// The components of the side's direction along and across the ray.
    direction: [f64; 2],
}

/// Sweeps the rays from a source along a side, beginning with the ray to its start. `None` where a ray is not found, or
/// is behind a conjugate point.
fn sweep(source: &RaySource<'_>, side: &SidePath<'_, '_>, start: PolarVector) -> Option<Sweep> {
    let length = side.side.length;
    let mut known: Vec<KnownRay> = Vec::new();
    let mut look = |t: f64| -> Option<[f64; 3]> {
        let (place, direction) = side.at(t)?;
        let target = AimedPlace::new(source.surface, place).ok()?;
        let before = known
            .iter()
            .min_by(|a, b| (a.t - t).abs().total_cmp(&(b.t - t).abs()));
        let guess = before.map_or(start, |before| PolarVector {
            angle: before.at.angle + before.rate.angle * (t - before.t),
            length: before.at.length + before.rate.length * (t - before.t),
        });
        let hit = shoot::hit(source, &target, guess)?;
        if (hit.at.angle - guess.angle).abs() > LEAP || hit.end.m <= 0.0 {
            return None;
        }
        let (end, trace) = source.follow(hit.at.angle, hit.at.length, true).ok()?;
        let [along, across] = components(end.along, end.left, direction)?;
        let rate = PolarVector {
            angle: across / end.m,
            length: along,
        };
        known.push(KnownRay {
            t,
            at: hit.at,
            rate,
            direction: [along, across],
        });
        let [_, slope] = trace.jacobi;
        let area = integral(&trace.jacobi_knots);
        Some([area, 1.0 - slope, 1.0].map(|x| x * rate.angle))
    };
    look(0.0)?;
    let (mut t, mut stride) = (0.0, length / STRIDES);
    while t < length {
        let next = if t + 1.01 * stride > length {
            length
        } else {
            t + stride
        };
        if look(next).is_some() {
            t = next;
            stride *= 1.5;
        } else {
            stride *= 0.4;
            if stride < SHORTEST * length {
                return None;
            }
        }
    }
    let breaks = [0.0, 0.5 * length, length];
    let mut function = |t: f64| look(t).ok_or(());
    let found = quadrature::integrate(&breaks, TOLERANCE, MOST, &mut function).ok()?;
    let order = |a: &&KnownRay, b: &&KnownRay| a.t.total_cmp(&b.t);
    let (start, end) = (known.iter().min_by(order)?, known.iter().max_by(order)?);
    Some(Sweep {
        values: found.values,
        errors: found.errors,
        last: end.at,
        directions: [start.direction, end.direction],
    })
}
