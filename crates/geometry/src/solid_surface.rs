//! The surface of a solid for geodesics. In: a solid of a scene and values of its params. Out: the surface in space that
//! geodesics run on, its bounding box, and the initial position of a camera.
//!
//! Only this module turns a scene's solid into an [`ImplicitSurface`] for views and commands.

use std::sync::OnceLock;

use geodesic::implicit::{ImplicitSurface, SpaceFrame};
use geodesic::trace::Options;
use glam::DVec3;
use scene::{BoundGrid, ObjectId, ParamValues, Range, Sampling, Scene};
use tracer::{BoundingBox, Crossing, Ray, SurfaceId};

use crate::manifold::ManifoldError;
use crate::solids::{MAX_SHAPE_WORK, RayFault, RayScene, RaySceneOptions};

/// The surface of the first instance of a solid.
#[derive(Debug)]
pub struct SolidSurface {
    surface: ImplicitSurface,
    bounds: Option<BoundingBox>,
    rays: RayScene,
    /// Found when it is first needed: most cameras have a place.
    first: OnceLock<Option<[f64; 3]>>,
}

impl SolidSurface {
    /// Compiles a solid for these values of the params. A solid that depends on grids without given values is the union of all
    /// its instances.
    ///
    /// # Errors
    /// [`ManifoldError`].
    pub fn new(scene: &Scene, params: &ParamValues, id: ObjectId) -> Result<Self, ManifoldError> {
        let made = scene.made_anew(params);
        let (scene, id) = match &made {
            Some(made) => (&**made, scene.number_in(made, id)),
            None => (scene, Some(id)),
        };
        let Some(object) = id.and_then(|id| scene.get(id)) else {
            return Err(ManifoldError::NoSurface { name: None });
        };
        let name = || object.name.clone();
        let Some(solid) = object.shape.solid() else {
            return Err(ManifoldError::NoSurface { name: Some(name()) });
        };
        let too_large = |_| ManifoldError::TooLarge { name: name() };
        let mut graph = scene.graph.clone();
        let axes = |bound: &BoundGrid| -> Vec<Sampling> {
            let grid = scene.grids.get(bound.grid.0 as usize);
            let all = grid.map_or(&[][..], |grid| &grid.axes);
            match params.fixed_grid(scene, bound.grid) {
                Some(values) => values.iter().map(|&value| only(value)).collect(),
                None => all.to_vec(),
            }
        };
        let field = solid.field(&mut graph, &axes).map_err(too_large)?;
        let options = RaySceneOptions {
            shown: &|_| true,
            colour: &|_| DVec3::ONE,
            thickness: None,
            stage: false,
            picture_look: Default::default(),
        };
        let rays = RayScene::of_solid(scene, params, &options, object, &mut { MAX_SHAPE_WORK });
        let world = rays.world();
        let flat = rays.notes().into_iter().find_map(|note| match note.fault {
            RayFault::SingularMap {
                skipped,
                instances,
                leaf,
            } if skipped == instances => Some(leaf),
            _ => None,
        });
        if let Some(leaf) = flat {
            return Err(ManifoldError::Flat { name: name(), leaf });
        }
        let bounds = (world.solid_count() > 0).then(|| world.bounds(0)).flatten();
        if bounds.is_some_and(|bounds| bounds.is_empty()) {
            return Err(ManifoldError::Empty { name: name() });
        }
        let size = bounds.map(|bounds| (bounds.upper - bounds.lower).max_element());
        let uniforms = params.first_instance(scene, object);
        let surface = ImplicitSurface::new(&graph, field, &uniforms, size).map_err(too_large)?;
        Ok(Self {
            surface,
            bounds,
            rays,
            first: OnceLock::new(),
        })
    }

    /// Returns the surface that geodesics run on.
    pub fn surface(&self) -> &ImplicitSurface {
        &self.surface
    }

    /// Returns the lower and the upper corner of a bounding box; `None` for an unbounded solid.
    pub fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        self.bounds
            .map(|bounds| [bounds.lower.to_array(), bounds.upper.to_array()])
    }

    /// Returns the point where the ray from the centre of the bounding box along x leaves the solid, or along another axis or a
    /// slanted line if that one does not meet it; `None` if none does. If that face is much smaller than the largest one, such
    /// as a narrow cut, returns a point of the largest face. If geodesics from there end at once, as beside a double point,
    /// returns a point from which they go far.
    pub fn first_place(&self) -> Option<[f64; 3]> {
        let find = || first_place(&self.rays, self.bounds, &self.surface);
        *self.first.get_or_init(find)
    }
}

/// Returns a grid with one value.
fn only(value: f64) -> Sampling {
    Sampling {
        range: Range {
            min: value,
            max: value,
        },
        count: 1,
    }
}

/// The number of rays in a row along each axis that measure the faces of a solid.
const FACE_RAYS: u32 = 8;
/// The minimum area, as a fraction of the largest face's, of a face on which a camera is placed initially.
const NARROW: f64 = 0.5;
/// Areas and distances are alike if one is at least this fraction of the other.
const ALIKE: f64 = 1.0 - 1e-9;
/// The number of directions in which geodesics are followed from a place, and their length as a fraction of the longest side
/// of the solid's box.
const DIRECTIONS: u32 = 8;
const REACH: f64 = 0.5;
/// The minimum mean length of geodesics from the initial place, as a fraction of that length.
const LEAST_REACH: f64 = 0.05;
/// The approximate number of places that are compared if the usual one is not good.
const COMPARED: usize = 32;
/// Such lengths are alike if one is at least this fraction of the other.
const ALIKE_REACH: f64 = 0.99;
/// The tolerance of those geodesics.
const TOLERANCE: f64 = 1e-4;

/// Returns the initial place on a solid.
fn first_place(
    rays: &RayScene,
    bounds: Option<BoundingBox>,
    surface: &ImplicitSurface,
) -> Option<[f64; 3]> {
    let usual = usual_place(rays, bounds);
    let Some(bounds) = bounds else {
        return usual;
    };
    let length = REACH * (bounds.upper - bounds.lower).max_element();
    let reach = |place: &[f64; 3]| mean_reach(surface, *place, length) / length;
    if usual.is_some_and(|place| reach(&place) >= LEAST_REACH) {
        return usual;
    }
    let places: Vec<[f64; 3]> = axis_crossings(rays, &bounds)
        .map(|(crossing, _)| crossing.position.to_array())
        .collect();
    let compared = places
        .iter()
        .step_by(places.len().div_ceil(COMPARED).max(1));
    let reaches: Vec<(f64, [f64; 3])> = compared.map(|place| (reach(place), *place)).collect();
    let most = reaches.iter().map(|(reach, _)| *reach).fold(0.0, f64::max);
    // Choose the first of alike places: rounding must not decide.
    let farthest = reaches
        .into_iter()
        .find(|(reach, _)| most >= LEAST_REACH && *reach >= ALIKE_REACH * most);
    farthest.map(|(_, place)| place).or(usual)
}

/// Returns the mean length of geodesics from a place in some directions, each followed as far as `length`; 0 where none can
/// begin.
fn mean_reach(surface: &ImplicitSurface, place: [f64; 3], length: f64) -> f64 {
    let Ok(frame) = SpaceFrame::new(surface, place, 0.0, 1.0) else {
        return 0.0;
    };
    let options = Options {
        tolerance: TOLERANCE,
        ..Options::default()
    };
    let reach = |k: u32| {
        let angle = f64::from(k) * std::f64::consts::TAU / f64::from(DIRECTIONS);
        let trace = surface.trace(frame.at, frame.turned(angle).x, length, &options);
        trace.map_or(0.0, |trace| trace.length)
    };
    (0..DIRECTIONS).map(reach).sum::<f64>() / f64::from(DIRECTIONS)
}

fn usual_place(rays: &RayScene, bounds: Option<BoundingBox>) -> Option<[f64; 3]> {
    let middle = bounds.map_or(DVec3::ZERO, |bounds| 0.5 * (bounds.lower + bounds.upper));
    let half = bounds.map_or(DVec3::ONE, |bounds| 0.5 * (bounds.upper - bounds.lower));
    let mut caster = rays.world().caster();
    let axes = [
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        -DVec3::X,
        -DVec3::Y,
        -DVec3::Z,
    ];
    let mut cast = |origin: DVec3, direction: DVec3, enters: bool| {
        let ray = Ray {
            origin,
            direction,
            leaving: None,
        };
        let mut crossings = caster.cast(&ray).iter();
        crossings.find(|it| enters || !it.entering).copied()
    };
    let leaving = axes.iter().filter_map(|&axis| cast(middle, axis, false));
    let mut leaving: Vec<Crossing> = leaving.collect();
    if leaving.is_empty() {
        // Holes along all axes, or an endless solid whose surface has the middle.
        let slanted = (0..8).map(|k| {
            let side = |axis: u32| if k >> axis & 1 == 0 { 1.0 } else { -1.0 };
            half * DVec3::new(side(0), 0.8 * side(1), 0.6 * side(2))
        });
        let slanted: Vec<DVec3> = slanted.collect();
        let mut out = slanted.iter();
        let found = out.find_map(|way| cast(middle, way.normalize_or_zero(), false));
        let mut beside = axes.iter();
        let found =
            found.or_else(|| beside.find_map(|&axis| cast(middle + slanted[0], axis, true)));
        leaving.extend(found);
    }
    let usual = *leaving.first()?;
    let is_one = leaving.iter().all(|it| it.surface == usual.surface);
    let other = bounds.filter(|_| !is_one).and_then(|bounds| {
        let faces = MeasuredFace::all(rays, &bounds);
        let area = |face: &MeasuredFace| {
            if face.surface == usual.surface {
                face.area
            } else {
                0.0
            }
        };
        let own: f64 = faces.iter().map(area).sum();
        let most = faces.iter().map(|face| face.area).fold(0.0, f64::max);
        // Choose the first of alike faces: rounding, which differs between machines, must not decide.
        let alike = faces.into_iter().filter(|face| face.area >= ALIKE * most);
        let largest = alike.min_by_key(|face| face.surface)?;
        let ahead = leaving.iter().find(|it| it.surface == largest.surface);
        (own < NARROW * largest.area).then_some(*ahead.unwrap_or(&largest.nearest))
    });
    Some(other.unwrap_or(usual).position.to_array())
}

/// A face of a solid.
struct MeasuredFace {
    surface: SurfaceId,
    area: f64,
    /// Its point nearest to the centre of the solid's box.
    nearest: Crossing,
}

impl MeasuredFace {
    /// Returns the faces of a solid in a box, as rays along the axes meet them.
    fn all(rays: &RayScene, bounds: &BoundingBox) -> Vec<Self> {
        let middle = 0.5 * (bounds.lower + bounds.upper);
        let mut faces: Vec<Self> = Vec::new();
        for (crossing, area) in axis_crossings(rays, bounds) {
            let known = faces
                .iter_mut()
                .find(|face| face.surface == crossing.surface);
            let Some(face) = known else {
                faces.push(Self {
                    surface: crossing.surface,
                    area,
                    nearest: crossing,
                });
                continue;
            };
            face.area += area;
            let [new, old] = [&crossing, &face.nearest].map(|it| it.position.distance(middle));
            if new < ALIKE * old {
                face.nearest = crossing;
            }
        }
        faces
    }
}

/// Returns the crossings of a solid in a box with rows of rays along the axes, each with the area of its part of the surface.
fn axis_crossings(rays: &RayScene, bounds: &BoundingBox) -> impl Iterator<Item = (Crossing, f64)> {
    let (lower, sides) = (bounds.lower, bounds.upper - bounds.lower);
    let mut caster = rays.world().caster();
    let share = |k: u32| (f64::from(k) + 0.5) / f64::from(FACE_RAYS);
    let places = (0..FACE_RAYS).flat_map(|i| (0..FACE_RAYS).map(move |j| [i, j]));
    let rays = (0..3).flat_map(move |axis| places.clone().map(move |place| (axis, place)));
    rays.flat_map(move |(axis, [i, j])| {
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut origin = lower;
        origin[axis] -= sides[axis];
        origin[b] += share(i) * sides[b];
        origin[c] += share(j) * sides[c];
        let ray = Ray {
            origin,
            direction: DVec3::AXES[axis],
            leaving: None,
        };
        // Rays along each axis meet a part of a face as often as it is turned towards them: these fractions of the three
        // axes add up to 1.
        let cell = sides[b] * sides[c] / f64::from(FACE_RAYS * FACE_RAYS);
        let area = |it: &Crossing| cell * it.normal[axis].abs();
        let crossings: Vec<(Crossing, f64)> =
            caster.cast(&ray).iter().map(|it| (*it, area(it))).collect();
        crossings
    })
}
