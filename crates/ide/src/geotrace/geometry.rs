//! The geometry of a surface, in words: its first fundamental form, its curvature, its singular points.

use geodesic::measure::{self, PlaceMeasures};
use geodesic::metric::Metric;
use geodesic::surface::{Side, Surface};
use geometry::Manifold;
use scene::ParamValues;

use super::analysis::GeotraceAnalysis;
use super::hints::short;
use super::item::Item;
use super::start;

/// The number of points along each axis at which a surface is evaluated, including its sides.
const LATTICE: u32 = 25;
/// If |σu × σv| is below this fraction of |σu||σv|, or of its maximum, it is considered zero.
const VANISHED: f64 = 1e-9;

/// Returns sentences about the surface that an item declares; none if it is not a surface.
pub(crate) fn of(analysis: &GeotraceAnalysis, item: &Item<'_>) -> Vec<String> {
    let sentences = || {
        let excerpt = analysis.excerpt([item.index]);
        let scene = excerpt.scene();
        let (id, object) = scene.object(item.name)?;
        // At the params' start and for the first instance.
        let uniforms = ParamValues::initial(scene).first_instance(scene, object);
        let manifold = Manifold::new(scene, id, &uniforms).ok()?;
        let surface = manifold.surface();
        let names = item.parameters().map(|(name, _)| name);
        let [u, v]: [&str; 2] = names.collect::<Vec<_>>().try_into().ok()?;
        let mut sentences = Vec::new();
        sentences.extend(
            first_form(surface, [u, v]).map(|told| told + &start::of_object(scene, object)),
        );
        sentences.extend(regularity(surface, [u, v]));
        sentences.extend(topology(surface, [u, v]));
        Some(sentences)
    };
    sentences().unwrap_or_default()
}

/// E, F, G and K in the middle of the domain, or beside it where the surface has no tangent plane there.
fn first_form(surface: &dyn Surface, [u, v]: [&str; 2]) -> Option<String> {
    let at = |share: [f64; 2]| {
        let domain = surface.domain();
        [0, 1].map(|axis| {
            let [low, high] = domain[axis];
            low + share[axis] * (high - low)
        })
    };
    let places = [[0.5, 0.5], [0.55, 0.6]].map(at).into_iter();
    let mut found = places.filter_map(|uv| measure::place(surface, uv).ok());
    let found = found.find(|found| found.gaussian.is_some())?;
    let ([x, y], [e, f, g]) = (found.uv.0.map(short), found.form.map(short));
    let k = short(curvature(&found)?);
    Some(format!(
        "first fundamental form at {u} = {x}, {v} = {y}: E = {e}, F = {f}, G = {g}; Gaussian curvature K = {k}"
    ))
}

/// The Gaussian curvature, with 0 for what rounding leaves of a zero beside the square of the mean curvature.
pub(super) fn curvature(found: &PlaceMeasures) -> Option<f64> {
    let k = found.gaussian?;
    let size = found.mean.map_or(0.0, |h| h * h);
    Some(if k.abs() < 1e-12 * size { 0.0 } else { k })
}

/// Returns the points where EG − F² vanishes, as far as a lattice of points shows.
fn regularity(surface: &dyn Surface, names: [&str; 2]) -> Option<String> {
    let domain = surface.domain();
    let last = LATTICE - 1;
    let at = |axis: usize, k: u32| {
        let [low, high] = domain[axis];
        if k == last {
            high
        } else {
            low + (high - low) * f64::from(k) / f64::from(last)
        }
    };
    let count = LATTICE as usize;
    let mut vanishes = vec![false; count * count];
    let mut undefined = 0;
    let mut areas = vec![f64::NAN; count * count];
    for i in 0..LATTICE {
        for j in 0..LATTICE {
            let jet = surface.jet([at(0, i), at(1, j)].into());
            let metric = Metric::of(&jet);
            let index = i as usize * count + j as usize;
            areas[index] = metric.r;
            if metric.r.is_finite() {
                vanishes[index] = metric.r <= VANISHED * (metric.e * metric.g).sqrt();
            } else if !jet.position.iter().all(|x| x.is_finite()) {
                undefined += 1;
            }
        }
    }
    let largest = areas
        .iter()
        .copied()
        .filter(|r| r.is_finite())
        .fold(0.0, f64::max);
    for (vanishes, area) in vanishes.iter_mut().zip(&areas) {
        *vanishes |= *area <= VANISHED * largest;
    }
    if vanishes.iter().all(|vanishes| *vanishes) {
        return Some("EG − F² vanishes everywhere".to_owned());
    }
    let mut places = Vec::new();
    for (axis, name) in names.into_iter().enumerate() {
        for k in 0..LATTICE {
            let index = |other: usize| {
                if axis == 0 {
                    k as usize * count + other
                } else {
                    other * count + k as usize
                }
            };
            if (0..count).all(|other| vanishes[index(other)]) {
                places.push(format!("{name} = {}", short(at(axis, k))));
                (0..count).for_each(|other| vanishes[index(other)] = false);
            }
        }
    }
    let points = vanishes.iter().filter(|v| **v).count();
    if points > 0 {
        places.push(format!("{points} further points of {}", count * count));
    }
    let mut told = if places.is_empty() {
        "regular: EG − F² > 0 at all sampled points".to_owned()
    } else {
        format!("EG − F² vanishes at {}", places.join(", "))
    };
    if undefined > 0 {
        told.push_str(&format!(
            "; undefined at {undefined} of {} points",
            count * count
        ));
    }
    Some(told)
}

/// Returns the kind of each side, in words.
fn topology(surface: &dyn Surface, names: [&str; 2]) -> Option<String> {
    let sides = surface.sides();
    let mut told = Vec::new();
    for (axis, name) in names.into_iter().enumerate() {
        let ends = surface.domain()[axis].map(short);
        let glued = format!("{name} = {} and {name} = {} are glued", ends[0], ends[1]);
        match sides.of(axis) {
            [Side::Wrap, _] => told.push(glued),
            [Side::WrapFlip, _] => told.push(format!("{glued} with a reversal")),
            both => {
                for (end, (side, at)) in both.into_iter().zip(ends).enumerate() {
                    if side == Side::Pole {
                        told.push(format!("{name} = {at} is a smooth pole"));
                    } else if surface.apex(axis, end).is_some() {
                        told.push(format!("{name} = {at} is the tip of a cone"));
                    }
                }
            }
        }
    }
    (!told.is_empty()).then(|| told.join("; "))
}
