//! A circle about a point, the wavefront: its length ∫|m|dθ and the area ∬|m| that its rays sweep.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};

use super::MeasureError;
use super::between::all_within;
use super::gap::AimedPlace;
use super::quadrature::{self, Integrals};
use super::rescaled::Rescaled;
use super::source::RaySource;
use crate::chart::Atlas;
use crate::jacobi::absolute_integral;
use crate::point::Uv;
use crate::reparametrised::Reparametrised;
use crate::status::Status;
use crate::surface::Surface;

/// A circle about a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// The wavefront's length.
    pub circumference: f64,
    /// The area that its rays sweep, counted as often as it is swept.
    pub area: f64,
    /// True if part of the area is swept more than once: the radius is larger than the distance to the cut locus. `None` where
    /// that is not known.
    pub overlaps: Option<bool>,
    /// The estimated error of the circumference.
    pub circumference_error: f64,
    /// The estimated error of the area.
    pub area_error: f64,
}

/// A ray that ends before it reaches the circle's radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayStop {
    /// Its direction: radians from σu towards σv.
    pub angle: f64,
    /// The arc length reached.
    pub length: f64,
    /// The reason for its end.
    pub status: Status,
}

impl RayStop {
    /// Returns a clause with the length as it is written: "the ray 45.00° from σu towards σv leaves the domain after 1.5".
    pub fn clause(&self, length: &str) -> String {
        let degrees = self.angle.to_degrees().rem_euclid(360.0);
        let reason = self.status.predicate();
        format!("the ray {degrees:.2}° from σu towards σv {reason} after {length}")
    }
}

/// The relative error allowed to the quadrature, and to the rays themselves.
const TOLERANCE: f64 = 1e-10;
const OF_RAYS: f64 = 2e-10;
/// The maximum number of directions that are sought in which the creases on the way change.
const MOST_BORDERS: usize = 64;
/// They are located to this angle, in radians.
const SHARP: f64 = 1e-12;
/// Within this angle of such a direction, in radians, it is not known whether a ray passes the crease that it grazes: a ray's
/// own error is as large.
const GRAZING: f64 = 1e-11;
/// The initial number of the quadrature's intervals. On a surface with creases there are more: the rays must meet the bumps that
/// creases surround. Each interval has 15 rays, so that a bump which is seen at an angle of 0.025 or more is met.
const FIRST: u32 = 4;
const FIRST_OF_CREASED: u32 = 32;
/// The maximum number of intervals before such directions are sought, and after.
const FEW: usize = 48;
const MOST: usize = 120;
/// The maximum number of times that such directions are sought.
const ROUNDS: usize = 3;

enum CircleStop {
    Ray(RayStop),
    Fault(MeasureError),
}

/// Measures the circle of a radius about a point; also returns a ray that ends earlier, if there is one.
///
/// # Errors
/// [`MeasureError`] where no ray can start, or the radius is not a length.
pub fn circle(
    surface: &dyn Surface,
    uv: impl Into<Uv>,
    radius: f64,
) -> Result<Result<Circle, RayStop>, MeasureError> {
    if !(radius.is_finite() && radius >= 0.0) {
        return Err(MeasureError::BadLength { length: radius });
    }
    let uv = uv.into();
    if let Some(usual) = Rescaled::of(surface) {
        let size = usual.size();
        let found = circle(&usual, usual.changed(uv), radius / size);
        let found = found.map_err(|error| usual.restored_error(error))?;
        return Ok(found
            .map(|it| Circle {
                circumference: size * it.circumference,
                area: size * (size * it.area),
                circumference_error: size * it.circumference_error,
                area_error: size * (size * it.area_error),
                ..it
            })
            .map_err(|stop| RayStop {
                length: size * stop.length,
                ..stop
            }));
    }
    // Angles are measured from the same direction in both parametrisations.
    match Reparametrised::of(surface) {
        Some(even) => {
            circle_on(&even, even.changed(uv).0, radius).map_err(|error| error.restored(&even))
        }
        None => circle_on(surface, uv, radius),
    }
}

fn circle_on(
    surface: &dyn Surface,
    uv: Uv,
    radius: f64,
) -> Result<Result<Circle, RayStop>, MeasureError> {
    let source = RaySource::at(surface, uv)?;
    let mut passes_conjugate = false;
    let mut passes_several = false;
    // The angle of each ray, and the number of creases that it passes.
    let passed: RefCell<Vec<(f64, usize)>> = RefCell::default();
    let mut pieces = BTreeSet::from([surface.smooth_piece(uv)]);
    let mut ray = |angle: f64| {
        let (end, trace) = source
            .follow(angle, radius, true)
            .map_err(CircleStop::Fault)?;
        if end.status != Status::Complete {
            return Err(CircleStop::Ray(RayStop {
                angle,
                length: end.length,
                status: end.status,
            }));
        }
        pieces.insert(surface.smooth_piece(end.at));
        passes_several |= trace.creases > 1;
        passed.borrow_mut().push((angle, trace.creases));
        passes_conjugate |= trace.conjugates.iter().any(|s| *s < radius * (1.0 - 1e-9));
        Ok([end.m.abs(), absolute_integral(&trace.jacobi_knots)])
    };
    let has_creases = Atlas::new(surface).layout.has_creases;
    let first = if has_creases { FIRST_OF_CREASED } else { FIRST };
    let found = integrate_between_borders(first, &mut ray, &passed, |angle| {
        let (_, trace) = source
            .follow(angle, radius, true)
            .map_err(CircleStop::Fault)?;
        Ok(trace.creases)
    });
    let found = match found {
        Ok(found) => found,
        Err(CircleStop::Ray(stop)) => return Ok(Err(stop)),
        Err(CircleStop::Fault(error)) => return Err(error),
    };
    let [circumference, area] = found.values;
    let error = |k: usize| found.errors[k] + OF_RAYS * found.values[k];
    Ok(Ok(Circle {
        circumference,
        area,
        overlaps: if passes_conjugate {
            Some(true)
        } else {
            // Where creases meet, and behind a tip between two of them, rays may meet without a loop.
            let may_have_vertex = pieces.len() > 2 || passes_several;
            meets_itself(&source, uv, radius)?.filter(|meets| *meets || !may_have_vertex)
        },
        circumference_error: error(0),
        area_error: error(1),
    }))
}

/// Integrates over all angles, in `first` intervals or more. Between rays that pass different creases the length of the field jumps, or is unbounded: there
/// the integral is divided. `passed` holds the angles of the rays so far, with the numbers of creases that they pass; `count`
/// returns that number for another angle.
fn integrate_between_borders<E>(
    first: u32,
    ray: &mut dyn FnMut(f64) -> Result<[f64; 2], E>,
    passed: &RefCell<Vec<(f64, usize)>>,
    mut count: impl FnMut(f64) -> Result<usize, E>,
) -> Result<Integrals<2>, E> {
    let mut breaks: Vec<f64> = (0..=first)
        .map(|n| TAU * f64::from(n) / f64::from(first))
        .collect();
    let mut borders: Vec<f64> = Vec::new();
    let mut round = 0;
    loop {
        let most = if round == 0 { FEW } else { MOST };
        // By the angle alone where nothing is known of borders.
        let mut found = if borders.is_empty() {
            quadrature::integrate(&breaks, TOLERANCE, most, ray)?
        } else {
            between(&breaks, ray)?
        };
        let more = crease_borders(&mut passed.borrow_mut(), &borders, &mut count)?;
        let is_whole = found.errors.iter().zip(found.values);
        let mut is_whole = is_whole.map(|(error, value)| *error <= TOLERANCE * value);
        if more.is_empty() && (round > 0 || is_whole.all(|it| it)) || round == ROUNDS {
            for border in borders {
                for beside in [border - GRAZING, border + GRAZING] {
                    let values = ray(beside)?;
                    for (error, value) in found.errors.iter_mut().zip(values) {
                        // The integral over the angles in between, of a value that grows there as 1/√x.
                        *error += 2.0 * GRAZING * value;
                    }
                }
            }
            return Ok(found);
        }
        borders.extend(&more);
        breaks.extend(more);
        breaks.sort_by(f64::total_cmp);
        round += 1;
    }
}

/// Integrates over the intervals between breaks. At these the function may be unbounded as 1/√x: with sin x in place of the
/// angle it is smooth there.
fn between<E>(
    breaks: &[f64],
    ray: &mut dyn FnMut(f64) -> Result<[f64; 2], E>,
) -> Result<Integrals<2>, E> {
    let numbers: Vec<f64> = (0..breaks.len()).map(|n| n as f64).collect();
    quadrature::integrate(&numbers, TOLERANCE, MOST, &mut |x| {
        let interval = (x as usize).min(breaks.len() - 2);
        let [low, high] = [breaks[interval], breaks[interval + 1]];
        let half = 0.5 * (high - low);
        let (sin, cos) = (PI * (x - interval as f64 - 0.5)).sin_cos();
        let values = ray(0.5 * (low + high) + half * sin)?;
        Ok(values.map(|value| value * half * PI * cos))
    })
}

/// Returns the angles at which the number of creases that rays pass changes, besides those that are known, from the numbers at
/// some angles; `count` returns it at another one.
fn crease_borders<E>(
    passed: &mut [(f64, usize)],
    known: &[f64],
    mut count: impl FnMut(f64) -> Result<usize, E>,
) -> Result<Vec<f64>, E> {
    passed.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut borders = Vec::new();
    for pair in passed.windows(2) {
        let [(mut low, here), (mut high, there)] = [pair[0], pair[1]];
        let is_known = known.iter().any(|border| low <= *border && *border <= high);
        if here == there || is_known || known.len() + borders.len() >= MOST_BORDERS {
            continue;
        }
        while high - low > SHARP {
            let middle = 0.5 * (low + high);
            if count(middle)? == here {
                low = middle;
            } else {
                high = middle;
            }
        }
        borders.push(0.5 * (low + high));
    }
    Ok(borders)
}

/// Returns whether two rays of a length meet, if that is known, neither of which has a conjugate point before. Where two first meet, they
/// form a loop (Klingenberg's lemma: do Carmo, *Riemannian Geometry*, 1992, chapter 13, proposition 2.12). Rays also meet
/// behind the tip of a cone of less than a full turn.
fn meets_itself(source: &RaySource<'_>, uv: Uv, radius: f64) -> Result<Option<bool>, MeasureError> {
    let surface = source.surface;
    let target = AimedPlace::new(surface, uv)?;
    let loops = all_within(source, &target, 2.0 * radius);
    if loops
        .found
        .iter()
        .any(|it| it.length < 2.0 * radius * (1.0 - 1e-9))
    {
        return Ok(Some(true));
    }
    let mut is_known = loops.complete;
    for axis in 0..2 {
        for end in 0..2 {
            let domain = surface.domain();
            let Some(apex) = surface.apex(axis, end).filter(|apex| !apex.smooth) else {
                continue;
            };
            let turn = apex.rate.abs() * (domain[1 - axis][1] - domain[1 - axis][0]);
            let mut tip = uv;
            tip[axis] = domain[axis][end];
            if turn < TAU
                && let Ok(tip) = AimedPlace::new(surface, tip)
            {
                let ways = all_within(source, &tip, radius * (1.0 - 1e-9));
                if !ways.found.is_empty() {
                    return Ok(Some(true));
                }
                is_known &= ways.complete;
            }
        }
    }
    Ok(is_known.then_some(false))
}
