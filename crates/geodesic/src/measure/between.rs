//! The geodesics between two points, the shortest first.

use std::f64::consts::TAU;

use super::MeasureError;
use super::gap::{AimedPlace, is_one_place};
use super::rescaled::Rescaled;
use super::search::{self, Guesses};
use super::shoot::{self, Hit, PolarVector};
use super::source::RaySource;
use crate::point::{TangentVector, Uv};
use crate::reparametrised::Reparametrised;
use crate::surface::Surface;

/// A geodesic from one point to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Connection {
    /// Its length, with a relative error of about 10⁻¹⁰, but at least the rounding of numbers of the surface's size.
    pub length: f64,
    /// Its start; at a pole, on the meridian along which it runs.
    pub from: Uv,
    /// (u', v') there, at unit speed.
    pub direction: TangentVector,
    /// Its end.
    pub to: Uv,
    /// (u', v') there.
    pub arrival: TangentVector,
    /// The Jacobi field at its end: a change dθ of the direction moves the end by m dθ.
    pub m: f64,
    /// True if m = 0: the two points are conjugate, and it may be one of a family of geodesics of the same length.
    pub conjugate: bool,
    /// Its angle at the start.
    pub(super) angle: f64,
}

/// The geodesics found.
#[derive(Clone, Debug, Default)]
pub struct Connections {
    /// The shortest first.
    pub found: Vec<Connection>,
    /// The length up to which geodesics were searched.
    pub within: f64,
    /// False if there may be more: the search was incomplete, or there are more than [`MOST_CONNECTIONS`].
    pub complete: bool,
    /// False if there may be a shorter one than the first.
    pub distance_known: bool,
}

/// The remark at a geodesic whose ends are conjugate.
pub const FAMILY_REMARK: &str = "one of a family: the ends are conjugate";

/// The maximum number of geodesics returned.
pub const MOST_CONNECTIONS: usize = 32;

/// Lengths whose relative difference is at most this are the same.
const SAME_LENGTH: f64 = 1e-7;
/// Angles that differ by at most this are the same.
const SAME_ANGLE: f64 = 1e-6;
/// Angles whose rays end within this distance of each other are the same, in units of the size.
const SAME_PLACE: f64 = 1e-9;
/// A loop is longer than this, in units of the size.
const NO_LENGTH: f64 = 1e-9;
/// The search for the shortest starts at this fraction of a length that is known to suffice.
const BEGIN: f64 = 0.02;
/// The factor by which the search length grows. Where geodesics diverge, the work grows exponentially with the length.
const GROW: f64 = 1.6;
/// The factor by which a search exceeds the necessary length.
const MORE: f64 = 1.02;

/// Finds the geodesics from one point to another up to the length `within`, or without it, up to twice the shortest.
/// Between a point and itself they are loops.
///
/// # Errors
/// [`MeasureError`] where a point is outside the domain, the surface is undefined or degenerate there, or `within` is not
/// a length.
pub fn between(
    surface: &dyn Surface,
    from: impl Into<Uv>,
    to: impl Into<Uv>,
    within: Option<f64>,
) -> Result<Connections, MeasureError> {
    if let Some(length) = within
        && !(length.is_finite() && length >= 0.0)
    {
        return Err(MeasureError::BadLength { length });
    }
    let (from, to) = (from.into(), to.into());
    if let Some(usual) = Rescaled::of(surface) {
        let [from, to] = [from, to].map(|uv| usual.changed(uv));
        let within = within.map(|length| length / usual.size());
        let found = between(&usual, from, to, within);
        let mut all = found.map_err(|error| usual.restored_error(error))?;
        all.within *= usual.size();
        for it in &mut all.found {
            *it = it.rescaled(&usual);
        }
        return Ok(all);
    }
    if let Some(even) = Reparametrised::of(surface) {
        let found = between_on(&even, even.changed(from).0, even.changed(to).0, within);
        let mut all = found.map_err(|error| error.restored(&even))?;
        for it in &mut all.found {
            *it = it.restored(&even);
        }
        return Ok(all);
    }
    between_on(surface, from, to, within)
}

fn between_on(
    surface: &dyn Surface,
    from: Uv,
    to: Uv,
    within: Option<f64>,
) -> Result<Connections, MeasureError> {
    let (source, target) = ends(surface, from, to)?;
    let size = surface.scale().size;
    let nearest = shortest(&source, &target);
    let wanted = within.or_else(|| Some(2.0 * nearest.found.first()?.length));
    let Some(mut wanted) = wanted else {
        return Ok(nearest);
    };
    let reach = wanted * (1.0 + SAME_LENGTH);
    // A complete search for the shortest has found it.
    let is_known = nearest.complete;
    let mut all = if reach <= nearest.within {
        nearest
    } else {
        // Where geodesics diverge, such a wide search may exceed the limits, and find less.
        let mut all = both_ways(&source, &target, |source, target| {
            all_within(source, target, reach)
        });
        all.add(nearest.found, size);
        all
    };
    if let (None, Some(first)) = (within, all.found.first()) {
        wanted = wanted.min(2.0 * first.length);
    }
    let within = wanted * (1.0 + SAME_LENGTH);
    all.found.retain(|it| it.length <= within);
    all.complete &= all.found.len() <= MOST_CONNECTIONS;
    let misses = misses_a_path(&source, &target, &all.found, wanted);
    all.complete &= !misses;
    all.distance_known = all.complete || is_known && !misses;
    all.found.truncate(MOST_CONNECTIONS);
    all.within = wanted;
    Ok(all)
}

/// Returns whether a line of the chart is shorter than everything found: then a shorter geodesic has been missed, except one
/// that an edge obstructs. A loop may be longer than such lines.
fn misses_a_path(
    source: &RaySource<'_>,
    target: &AimedPlace<'_>,
    found: &[Connection],
    wanted: f64,
) -> bool {
    let is_loop = is_loop(source, target);
    let straight = MORE * target.straight_length(source.start(0.0));
    !is_loop && straight < wanted && found.first().is_none_or(|it| it.length > straight)
}

/// Finds the shortest geodesic from one point to another; `None` where none was found. Between a point and itself it is a
/// loop.
///
/// # Errors
/// As [`between`].
pub fn distance(
    surface: &dyn Surface,
    from: impl Into<Uv>,
    to: impl Into<Uv>,
) -> Result<Option<Connection>, MeasureError> {
    let (from, to) = (from.into(), to.into());
    if let Some(usual) = Rescaled::of(surface) {
        let [from, to] = [from, to].map(|uv| usual.changed(uv));
        let found = distance(&usual, from, to);
        let found = found.map_err(|error| usual.restored_error(error))?;
        return Ok(found.map(|it| it.rescaled(&usual)));
    }
    if let Some(even) = Reparametrised::of(surface) {
        let found = distance_on(&even, even.changed(from).0, even.changed(to).0);
        let found = found.map_err(|error| error.restored(&even))?;
        return Ok(found.map(|it| it.restored(&even)));
    }
    distance_on(surface, from, to)
}

fn distance_on(
    surface: &dyn Surface,
    from: Uv,
    to: Uv,
) -> Result<Option<Connection>, MeasureError> {
    let (source, target) = ends(surface, from, to)?;
    Ok(shortest(&source, &target).found.first().copied())
}

/// Searches from one point to the other, and where that may have missed some geodesics, from the other point too: a geodesic
/// traversed backwards is a geodesic.
fn both_ways<'s>(
    source: &RaySource<'s>,
    target: &AimedPlace<'s>,
    search: impl Fn(&RaySource<'s>, &AimedPlace<'s>) -> Connections,
) -> Connections {
    let mut all = search(source, target);
    let is_loop = is_loop(source, target);
    if all.complete || is_loop {
        return all;
    }
    let surface = source.surface;
    let back = RaySource::at(surface, target.uv);
    let (Ok(back), Ok(aim)) = (back, AimedPlace::new(surface, source.start(0.0))) else {
        return all;
    };
    let other = search(&back, &aim);
    let reversed = |it: &Connection| {
        let angle = source.angle_of(it.to, -it.arrival)?;
        let guess = PolarVector {
            angle,
            length: it.length,
        };
        Some(match shoot::hit(source, target, guess) {
            Some(hit) => Connection::of(source, &hit),
            None => Connection {
                from: source.start(angle),
                direction: source.direction(angle),
                to: target.uv,
                arrival: -it.direction,
                angle,
                ..*it
            },
        })
    };
    let found: Vec<Connection> = other.found.iter().filter_map(reversed).collect();
    let is_complete = other.complete && found.len() == other.found.len();
    all.add(found, surface.scale().size);
    if is_complete {
        // The search from the other point has found all of them.
        all.complete = true;
        all.within = all.within.max(other.within);
    }
    all
}

impl Connections {
    /// Returns true if another geodesic is as short as the first.
    pub(super) fn has_tie(&self) -> bool {
        let mut lengths = self.found.iter().map(|it| it.length);
        let (first, second) = (lengths.next(), lengths.next());
        first.is_some_and(|first| second.is_some_and(|it| it <= first * (1.0 + SAME_LENGTH)))
    }

    /// Adds those that are not yet included.
    fn add(&mut self, others: Vec<Connection>, size: f64) {
        for it in others {
            if !self.found.iter().any(|other| other.is_same(&it, size)) {
                self.found.push(it);
            }
        }
        self.found.sort_by(|a, b| a.length.total_cmp(&b.length));
    }
}

/// Returns both points; if they are the same, the second one has the coordinates of the first.
fn ends(
    surface: &dyn Surface,
    from: Uv,
    to: Uv,
) -> Result<(RaySource<'_>, AimedPlace<'_>), MeasureError> {
    let source = RaySource::at(surface, from)?;
    let to = if is_one_place(surface, from, to) {
        from
    } else {
        to
    };
    Ok((source, AimedPlace::new(surface, to)?))
}

/// Returns whether geodesics from the source to the target are loops.
fn is_loop(source: &RaySource<'_>, target: &AimedPlace<'_>) -> bool {
    is_one_place(source.surface, source.start(0.0), target.uv)
}

impl Connection {
    /// Converts a connection on a reparametrised surface to the parameters of the surface itself. Its angle is the same:
    /// both are measured from the same direction.
    pub(super) fn restored(self, even: &Reparametrised<'_>) -> Self {
        Self {
            from: even.restored(self.from).0,
            direction: even.restored_vector(self.from, self.direction),
            to: even.restored(self.to).0,
            arrival: even.restored_vector(self.to, self.arrival),
            ..self
        }
    }

    /// Converts a connection on a surface in usual units to those of the surface itself.
    pub(super) fn rescaled(self, usual: &Rescaled<'_>) -> Self {
        Self {
            length: self.length * usual.size(),
            from: usual.restored(self.from),
            direction: usual.restored_vector(self.direction),
            to: usual.restored(self.to),
            arrival: usual.restored_vector(self.arrival),
            m: self.m * usual.size(),
            ..self
        }
    }

    fn of(source: &RaySource<'_>, hit: &Hit) -> Self {
        let [from, direction] = source.tidy_start(hit.at.angle);
        Self {
            length: hit.at.length,
            from: Uv(from),
            direction: TangentVector(direction),
            to: hit.end.at,
            arrival: hit.end.along,
            m: hit.end.m,
            conjugate: shoot::is_conjugate(hit),
            angle: hit.at.angle,
        }
    }

    fn is_same(&self, other: &Self, size: f64) -> bool {
        let rounding = 64.0 * f64::EPSILON * size;
        let turn = (self.angle - other.angle) / TAU;
        let turn = (turn - turn.round()).abs() * TAU;
        let apart = turn * self.m.abs().min(other.m.abs());
        let one_angle = turn < SAME_ANGLE || apart < rounding;
        let longer = self.length.max(other.length);
        (self.length - other.length).abs() < SAME_LENGTH * longer + rounding
            && (one_angle || self.conjugate && other.conjugate)
    }
}

/// Searches for the shortest geodesic, and finds others on the way: those within the length searched.
pub(super) fn shortest<'s>(source: &RaySource<'s>, target: &AimedPlace<'s>) -> Connections {
    both_ways(source, target, shortest_from)
}

fn shortest_from(source: &RaySource<'_>, target: &AimedPlace<'_>) -> Connections {
    let size = source.surface.scale().size;
    let straight = target.straight_length(source.start(0.0));
    // Around an edge a geodesic may be longer than the straight line of the chart, which is not a geodesic.
    let most = if straight.is_finite() {
        2.0 * straight * MORE
    } else {
        8.0 * size
    };
    let mut reach = target.near_distance(source).max(BEGIN * most);
    reach = MORE * reach.min(most);
    loop {
        let first = search(source, target, reach, true);
        if !first.found.is_empty() {
            return first;
        }
        if first.within < reach {
            // The guess that ended the search was not a geodesic.
            let all = all_within(source, target, reach);
            if !all.found.is_empty() {
                return all;
            }
        }
        if reach >= most {
            return first;
        }
        reach = (GROW * reach).min(most);
    }
}

/// Returns whether the surface has a pole with unevenly spaced directions: rays end there, where geodesics continue.
fn has_uneven_pole(surface: &dyn Surface) -> bool {
    let mut sides = (0..4).map(|k| surface.apex(k / 2, k % 2));
    sides.any(|apex| apex.is_some_and(|apex| apex.smooth && !apex.regular))
}

/// Finds all geodesics within a length, the shortest first.
pub(super) fn all_within(
    source: &RaySource<'_>,
    target: &AimedPlace<'_>,
    reach: f64,
) -> Connections {
    search(source, target, reach, false)
}

/// Finds all geodesics within a length, or as far as needed for the shortest.
fn search(
    source: &RaySource<'_>,
    target: &AimedPlace<'_>,
    reach: f64,
    shortest: bool,
) -> Connections {
    let size = source.surface.scale().size;
    // Between a point and itself, a geodesic of length zero does not count.
    let mut least = NO_LENGTH * size;
    if !is_loop(source, target) {
        least = least.min(0.5 * target.near_distance(source));
    }
    let Guesses {
        found,
        within,
        complete,
    } = search::guesses(source, target, MORE * reach, shortest);
    let mut hits: Vec<Hit> = Vec::new();
    let mut all = Connections {
        found: Vec::new(),
        within: reach.min(within),
        complete: complete && !has_uneven_pole(source.surface),
        distance_known: false,
    };
    for guess in found {
        if hits.len() >= MOST_CONNECTIONS {
            all.complete = false;
            break;
        }
        if in_known_family(source, target, &hits, guess, size) {
            continue;
        }
        let Some(hit) = shoot::hit(source, target, guess) else {
            continue;
        };
        let known = hits.iter().any(|other| is_same(other, &hit, size));
        if !known && hit.at.length <= reach && hit.at.length > least {
            hits.push(hit);
        }
    }
    hits.sort_by(|a, b| a.at.length.total_cmp(&b.at.length));
    all.found = (hits.iter())
        .map(|hit| Connection::of(source, hit))
        .collect();
    all
}

/// Returns whether a guess belongs to a family of geodesics of the same length, of which one is known.
fn in_known_family(
    source: &RaySource<'_>,
    target: &AimedPlace<'_>,
    hits: &[Hit],
    guess: PolarVector,
    size: f64,
) -> bool {
    const NEAR: f64 = 1e-2;
    hits.iter().any(|hit| {
        let near = (hit.at.length - guess.length).abs() < NEAR * hit.at.length.max(size);
        near && shoot::is_conjugate(hit) && {
            let end = source.follow(guess.angle, hit.at.length, false);
            end.is_ok_and(|(end, _)| {
                let way = target.way_from(&end);
                way.is_some_and(|[x, y]| x.hypot(y) < SAME_LENGTH * size.max(hit.at.length))
            })
        }
    })
}

fn is_same(a: &Hit, b: &Hit, size: f64) -> bool {
    let longer = a.at.length.max(b.at.length).max(size);
    let turn = (a.at.angle - b.at.angle) / TAU;
    let turn = (turn - turn.round()).abs() * TAU;
    let apart = turn * a.end.m.abs().min(b.end.m.abs());
    let one_angle = turn < SAME_ANGLE || apart < SAME_PLACE * longer;
    let conjugate = shoot::is_conjugate(a) && shoot::is_conjugate(b);
    (a.at.length - b.at.length).abs() < SAME_LENGTH * longer && (one_angle || conjugate)
}
