//! The place of a scene: a robust box of its objects, from a coarse f64 sampling.
//!
//! The box decides the [`Placement`] (the drawing units of all samples) and, with its cloud of points, the first
//! camera. A generated kernel needs both before it runs, so they never come from the full sampling.

use expr::NodeId;
use expr::tape::Tape;
use geometry::Breaks;
use geometry::solids::{MAX_SHAPE_WORK, RayScene, RaySceneOptions, stated_radius};
use glam::DVec3;
use rayon::prelude::*;
use scene::{Object, ObjectId, ParamValues, Range, Sampling, Scene};
use tracer::{BoundingBox, Ray};

use crate::closed::{ClosedSurface, glued_sides};
use crate::placement::Placement;
use crate::point::WorldPoint;
use crate::sample::{Resolution, Sampler};
use crate::tips::tips;

mod outliers;

/// The rays along each axis that look for a solid, in a row: 20, and fewer where a scene has thousands of solids, whose points
/// would take gigabytes.
fn rays_in_a_row(solids: usize) -> usize {
    match solids {
        0..=1_000 => MOST_RAYS,
        1_001..=4_000 => 10,
        4_001..=16_000 => 5,
        _ => 3,
    }
}

/// The most rays in a row. Tips between them are looked for.
const MOST_RAYS: usize = 20;
/// The operations of those rays, of all solids together; each has an equal share.
const MOST_OPERATIONS: u64 = 1 << 28;
/// The number of objects that are prepared at once: a prepared solid takes some 10 kB.
const PREPARED: usize = 256;

/// Coarse samples of one object.
const SAMPLES: usize = 40_000;

/// The place and extent of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    /// Centre and radius.
    pub placement: Placement,
    /// Half the box's extents in drawing units.
    pub half: [f64; 3],
    /// Points of the objects inside the box, in drawing units.
    pub cloud: Vec<[f64; 3]>,
    /// The way that the first closed surface faces about the middle of its domain, outwards: a unit vector.
    pub facing: Option<[f64; 3]>,
}

/// The coarse places of an object.
#[derive(Clone, Debug, Default)]
pub(crate) struct ObjectCloud {
    /// Points without outliers, in the scene's units; none for what has no place in space.
    pub(crate) points: Vec<[f64; 3]>,
    /// The place in the middle of its first instance: of a vector its tip.
    pub(crate) middle: Option<[f64; 3]>,
    /// The shape of its first instance, of a closed surface.
    pub(crate) closed: Option<ClosedSurface>,
    /// True for u, and for v, if the two sides of its first instance are glued to each other.
    pub(crate) glued: [bool; 2],
    /// Of a surface, its places row by row, undefined ones and outliers among them; those of each instance are so many
    /// columns and rows.
    pub(crate) grid: Vec<[f64; 3]>,
    pub(crate) counts: [usize; 2],
    /// True for a solid without points because the work for a scene's solids was used up.
    pub(crate) is_omitted: bool,
    /// True for a solid with a box in which no ray meets it: it may be empty.
    pub(crate) is_missed: bool,
}

/// The share of the longest side of a box that is no thickness.
const THIN: f64 = 0.01;

/// The axis along which a box with these sides is flat, if the other two have an extent.
pub(crate) fn flat_axis(sides: [f64; 3]) -> Option<usize> {
    let longest = sides.into_iter().fold(0.0, f64::max);
    let is_thin = |axis: &usize| sides[*axis] < THIN * longest;
    let mut thin = (0..3).filter(is_thin);
    thin.next().filter(|_| thin.next().is_none())
}

impl Bounds {
    /// The bounds of what is defined; a scene where nothing is has the unit ball.
    pub fn of(scene: &Scene, params: &ParamValues) -> Self {
        Self::of_some(scene, params, |_| true)
    }

    /// The bounds of some of the objects.
    pub(crate) fn of_some(
        scene: &Scene,
        params: &ParamValues,
        counts: impl Fn(ObjectId) -> bool,
    ) -> Self {
        let wanted: Vec<bool> = scene.numbered().map(|(id, _)| counts(id)).collect();
        let clouds = ObjectCloud::all(scene, params, &wanted);
        let radii = stated_radii(scene, params);
        let clouds = clouds.iter().zip(radii);
        Self::around_objects(clouds.filter_map(|(cloud, radius)| Some((cloud.as_ref()?, radius))))
    }

    /// The bounds of some objects, each with its stated radius.
    pub(crate) fn around_objects<'c>(
        clouds: impl Iterator<Item = (&'c ObjectCloud, f64)> + Clone,
    ) -> Self {
        let mut closed = clouds.clone().filter_map(|(cloud, _)| cloud.closed);
        let facing = closed.next().map(|closed| closed.facing);
        let points = clouds.flat_map(|(cloud, radius)| cloud.thick_points(radius));
        Self {
            facing,
            ..Self::around(points.collect())
        }
    }

    /// The bounds of finite points in the scene's units.
    pub fn around(mut cloud: Vec<[f64; 3]>) -> Self {
        let ends: [[f64; 2]; 3] = std::array::from_fn(|k| {
            cloud
                .iter()
                .map(|p| p[k])
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
                    [low.min(x), high.max(x)]
                })
        });
        if cloud.is_empty() {
            let placement = Placement {
                centre: [0.0; 3],
                radius: 1.0,
            };
            return Self {
                placement,
                half: [0.5; 3],
                cloud,
                facing: None,
            };
        }
        // Halved first: the sum or difference of two finite numbers may not be finite.
        let centre = ends.map(|[low, high]| 0.5 * low + 0.5 * high);
        let half = ends.map(|[low, high]| 0.5 * high - 0.5 * low);
        let longest = half.iter().fold(0.0, |a: f64, &b| a.max(b));
        let scale = if longest > 0.0 { longest } else { 1.0 };
        let mut radius = scale * half.iter().map(|h| (h / scale).powi(2)).sum::<f64>().sqrt();
        // A single place has no size of its own: it gets one that f64 still distinguishes from 0.
        let least = 1e-12 * centre.iter().fold(0.0, |a: f64, &b| a.max(b.abs()));
        if radius <= least {
            radius = if least > 0.0 {
                (1e9 * least).min(1.0).max(2.0 * least)
            } else {
                1.0
            };
        }
        let radius = radius.min(f64::MAX / 4.0);
        let placement = Placement { centre, radius };
        for point in &mut cloud {
            *point = placement.local(WorldPoint(*point)).0;
        }
        Self {
            placement,
            half: half.map(|h| h / radius),
            cloud,
            facing: None,
        }
    }
}

/// The radius that each object of a scene states.
pub(crate) fn stated_radii(scene: &Scene, params: &ParamValues) -> Vec<f64> {
    let objects = scene.objects.iter();
    objects
        .map(|object| stated_radius(scene, params, object))
        .collect()
}

/// The places of a thick object around which others are looked at.
const THICK_PLACES: usize = 2000;

impl ObjectCloud {
    /// The points, and where the object has a radius, places at that distance from many of them.
    pub(crate) fn thick_points(&self, radius: f64) -> impl Iterator<Item = [f64; 3]> {
        let steps = [-1.0, 0.0, 1.0];
        let cube = steps.map(|x| steps.map(|y| steps.map(|z| DVec3::new(x, y, z))));
        let around = cube.into_iter().flatten().flatten();
        let around = around.filter(|step| step.length_squared() != 2.0);
        let around: Vec<DVec3> = around
            .map(|step| radius * step.normalize_or_zero())
            .collect();
        let each = self.points.len().div_ceil(THICK_PLACES).max(1);
        let thick = self.points.iter().step_by(each);
        let thick = thick.take(if radius > 0.0 { usize::MAX } else { 0 });
        let beside = thick.flat_map(move |&place| {
            let around = around.clone().into_iter();
            around.map(move |step| (DVec3::from(place) + step).to_array())
        });
        self.points.iter().copied().chain(beside)
    }

    /// Samples the objects of a scene that are wanted coarsely; `None` for the others.
    pub(crate) fn all(scene: &Scene, params: &ParamValues, wanted: &[bool]) -> Vec<Option<Self>> {
        let options = RaySceneOptions {
            shown: &|_| true,
            colour: &|_| DVec3::ONE,
            thickness: None,
            stage: false,
            picture_look: Default::default(),
        };
        let is_solid = |object: &&Object| object.shape.solid().is_some();
        let solids = scene.objects.iter().filter(is_solid).count();
        let in_a_row = rays_in_a_row(solids);
        let operations = MOST_OPERATIONS / solids.max(1) as u64;
        // In the order of the scene: what the work is enough for does not depend on threads.
        let mut work = MAX_SHAPE_WORK;
        let mut prepared = |object: &Object| {
            let solid = object.shape.solid().is_some();
            solid.then(|| RayScene::of_solid(scene, params, &options, object, &mut work))
        };
        let cloud = |(object, wanted, rays): &(&Object, bool, Option<RayScene>)| match rays {
            Some(rays) => Some(Self::of_solid(rays, in_a_row, operations)),
            None => wanted.then(|| Self::new(scene, params, object)),
        };
        let mut clouds = Vec::with_capacity(scene.objects.len());
        for (objects, wanted) in scene.objects.chunks(PREPARED).zip(wanted.chunks(PREPARED)) {
            let objects = objects.iter().zip(wanted);
            let objects: Vec<(&Object, bool, Option<RayScene>)> = objects
                .map(|(object, &wanted)| {
                    (object, wanted, wanted.then(|| prepared(object)).flatten())
                })
                .collect();
            clouds.par_extend(objects.par_iter().map(cloud));
        }
        clouds
    }

    /// Samples an object coarsely that is no solid.
    pub(crate) fn new(scene: &Scene, params: &ParamValues, object: &Object) -> Self {
        let roots: Vec<NodeId> = match (object.shape.position(), object.shape.vector()) {
            (Some(position), _) => position.to_vec(),
            (None, Some((direction, origin))) => origin.iter().chain(direction).copied().collect(),
            // Metrics and geodesics have no expression for a place in space.
            (None, None) => return Self::default(),
        };
        let tape = Tape::new(&scene.graph, &roots);
        let sampler = Sampler::new(scene, params, object, tape, Resolution::Coarse(SAMPLES));
        let (mut closed, mut glued) = (None, [false; 2]);
        let (mut grid, mut counts) = (Vec::new(), [0; 2]);
        let (places, middle): (Vec<[f64; 3]>, _) = if roots.len() == 6 {
            let ends = sampler.map(|_, out: &[f64; 6]| {
                let [x, y, z, dx, dy, dz] = *out;
                [[x, y, z], [x + dx, y + dy, z + dz]]
            });
            let ends = ends
                .into_iter()
                .filter(|ends| ends.iter().all(outliers::is_finite));
            let ends: Vec<[f64; 3]> = ends.flatten().collect();
            let tip = ends.get(1).copied();
            (ends, tip)
        } else {
            let places = sampler.map(|_, out: &[f64; 3]| *out);
            counts = sampler.counts();
            if object.shape.is_surface() {
                closed = ClosedSurface::from_grid(&places, counts);
                glued = glued_sides(&places, counts);
                grid.clone_from(&places);
            }
            let [across, along] = [counts[0] / 2, counts[1] / 2];
            // Of a curve with an even number of samples it is between two of them, unless the curve is interrupted there.
            let before = match counts[1] {
                1 => counts[0].saturating_sub(1) / 2,
                _ => across,
            };
            let between = [before, across].map(|k| sampler.axes()[0][k]);
            let is_whole = before == across || !is_interrupted(scene, params, object, between);
            let before = if is_whole { before } else { across };
            let [before, at] = [before, across].map(|k| places.get(along * counts[0] + k));
            let middle = before.zip(at).map(|(before, at)| {
                let mean = |k: usize| 0.5 * before[k] + 0.5 * at[k];
                [0, 1, 2].map(mean)
            });
            let middle = middle.filter(outliers::is_finite);
            (places, middle)
        };
        let mut points = places;
        let limits = outliers::limits(scene, params, object, sampler.axes(), &mut points);
        let is_within = |p: &[f64; 3]| (0..3).all(|k| limits[k][0] <= p[k] && p[k] <= limits[k][1]);
        points.retain(|place| outliers::is_finite(place) && is_within(place));
        Self {
            points,
            middle,
            closed,
            glued,
            grid,
            counts,
            is_omitted: false,
            is_missed: false,
        }
    }

    /// Casts rays along the axes into a solid, so many in a row, as long as they take no more operations.
    fn of_solid(rays: &RayScene, in_a_row: usize, operations: u64) -> Self {
        let bounds = solid_box(rays);
        let points = match &bounds {
            Some(bounds) => solid_points(rays, bounds, in_a_row, operations),
            None => Vec::new(),
        };
        Self {
            is_missed: bounds.is_some() && points.is_empty() && in_a_row == MOST_RAYS,
            points,
            is_omitted: rays.is_out_of_work(),
            ..Self::default()
        }
    }
}

/// Returns whether the first instance of a curve is interrupted between two parameters.
fn is_interrupted(
    scene: &Scene,
    params: &ParamValues,
    object: &Object,
    [min, max]: [f64; 2],
) -> bool {
    let range = Range { min, max };
    let between = Sampling { range, count: 2 };
    let breaks = Breaks::of(scene, params, object);
    let found =
        breaks.and_then(|breaks| breaks.find(&[between], &params.first_instance(scene, object)));
    found.is_some_and(|found| !found.breaks.is_empty())
}

/// The box of a solid; none of an endless one, and of one that is known to be empty.
fn solid_box(rays: &RayScene) -> Option<BoundingBox> {
    let world = rays.world();
    let bounds = (world.solid_count() > 0).then(|| world.bounds(0)).flatten();
    bounds.filter(|bounds| !bounds.is_empty())
}

/// Places on a solid that rays along the axes find in its box. Where they take more operations, two corners of the box stand
/// for the others.
fn solid_points(
    rays: &RayScene,
    bounds: &BoundingBox,
    in_a_row: usize,
    operations: u64,
) -> Vec<[f64; 3]> {
    let world = rays.world();
    let size = bounds.upper - bounds.lower;
    let cells = (0..3).flat_map(|axis| (0..in_a_row * in_a_row).map(move |cell| (axis, cell)));
    let mut crossings = Vec::new();
    let mut points = Vec::new();
    let mut caster = world.caster();
    caster.limit_fields(operations);
    for (axis, cell) in cells {
        if caster.operations() > operations {
            points.extend([bounds.lower, bounds.upper].map(|corner| corner.to_array()));
            break;
        }
        let share = |k: usize| (k as f64 + 0.5) / in_a_row as f64;
        let mut origin = bounds.lower;
        origin[axis] -= 0.5 * size[axis].max(f64::MIN_POSITIVE);
        origin[(axis + 1) % 3] += size[(axis + 1) % 3] * share(cell % in_a_row);
        origin[(axis + 2) % 3] += size[(axis + 2) % 3] * share(cell / in_a_row);
        let ray = Ray {
            origin,
            direction: DVec3::AXES[axis],
            leaving: None,
        };
        crossings.extend_from_slice(caster.cast(&ray));
    }
    if in_a_row == MOST_RAYS {
        let tips = tips(&mut caster, bounds, &crossings, in_a_row, operations);
        points.extend(tips.iter().map(DVec3::to_array));
    }
    points.extend(
        crossings
            .iter()
            .map(|crossing| crossing.position.to_array()),
    );
    points.retain(|point| point.iter().all(|x| x.is_finite()));
    points
}
