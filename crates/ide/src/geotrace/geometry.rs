//! The geometry of a surface, for a reader: its first fundamental form, its curvature, where it is not regular.

use geodesic::metric::{Metric, gaussian_curvature};
use geodesic::surface::{Side, Surface};
use geometry::Manifold;
use scene::ObjectId;
use scene::ParamValues;

use super::analysis::GeotraceAnalysis;
use super::hints::short;
use super::item::Item;
use super::start;

/// Points along each axis at which a surface is looked at, its sides included.
const LATTICE: u32 = 25;
/// |σu × σv| below this share of |σu||σv|, or of its largest value, has vanished.
const VANISHED: f64 = 1e-9;

/// Sentences about the surface that an item declares; none for what is no surface.
pub(crate) fn of(analysis: &GeotraceAnalysis, item: &Item<'_>) -> Vec<String> {
    let sentences = || {
        let excerpt = analysis.excerpt([item.index]);
        let scene = excerpt.scene();
        let mut objects = (0..).map(ObjectId::new).zip(&scene.objects);
        let (id, object) = objects.find(|(_, object)| object.name == item.name)?;
        // At the params' start and the first instance.
        let uniforms = ParamValues::initial(scene).first_instance(scene, object);
        let manifold = Manifold::new(scene, id, &uniforms).ok()?;
        let surface = manifold.parametric()?;
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

/// E, F, G and K in the middle of the domain.
fn first_form(surface: &dyn Surface, [u, v]: [&str; 2]) -> Option<String> {
    let middle = surface.domain().map(|[low, high]| 0.5 * (low + high));
    let jet = surface.jet(middle.into());
    let metric = Metric::of(&jet);
    let numbers = [metric.e, metric.f, metric.g, gaussian_curvature(&jet)];
    // What rounding left of a zero is shown as one.
    let scale = metric.e.abs().max(metric.g.abs());
    let [e, f, g, k] = numbers.map(|x| if x.abs() < 1e-12 * scale { 0.0 } else { x });
    numbers.iter().all(|x| x.is_finite()).then(|| {
        format!(
            "first fundamental form at {u} = {}, {v} = {}: E = {}, F = {}, G = {}; Gaussian curvature K = {}",
            short(middle[0]),
            short(middle[1]),
            short(e),
            short(f),
            short(g),
            short(k)
        )
    })
}

/// Returns the places where EG − F² vanishes, as far as a lattice of points shows.
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
            } else {
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
        "regular: EG − F² does not vanish at the points that were looked at".to_owned()
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
        let [first, last] = sides.of(axis);
        match (first, last) {
            (Side::Wrap, _) => told.push(format!("{name} wraps around")),
            (Side::WrapFlip, _) => told.push(format!("{name} wraps around with a flip")),
            _ => {
                for (side, end) in [first, last].into_iter().zip(surface.domain()[axis]) {
                    if side == Side::Pole {
                        told.push(format!("{name} = {} is a smooth pole", short(end)));
                    }
                }
            }
        }
    }
    (!told.is_empty()).then(|| told.join("; "))
}
