//! Declared geodesics. In: a scene's declarations and the values of its params. Out: knots of all instances.

use expr::tape::{Registers, Tape};
use geodesic::implicit::ImplicitSurface;
use rayon::prelude::*;
use scene::InitialConditionsEvaluator;
use scene::ParamValues;
use scene::{Object, ObjectId, Sampling, Scene, SpacePath};

use crate::manifold::{Manifold, ManifoldError};
use crate::polyline::{
    GeodesicStart, Knot, KnotLine, MAX_LINE_EVALUATIONS, knots_at, space_knots_at,
};

/// The maximum number of points of all instances of a declared geodesic; further instances are not drawn.
pub const MAX_POINTS: u64 = 2_000_000;

/// The maximum number of surface evaluations for all declared geodesics of a scene: a few seconds.
pub const MAX_DECLARED_EVALUATIONS: u64 = 20_000_000;

/// Returns the maximum number of evaluations for one instance of a declared geodesic of which `instances` are drawn: each
/// declaration has an equal share of [`MAX_DECLARED_EVALUATIONS`], and each of its instances an equal share of that.
pub fn evaluations_per_line(scene: &Scene, instances: u64) -> u64 {
    let declared = scene.objects.iter().filter(|object| {
        object.shape.geodesic().is_some() || object.shape.space_geodesic().is_some()
    });
    let declared = declared.count().max(1) as u64;
    (MAX_DECLARED_EVALUATIONS / declared / instances.max(1)).min(MAX_LINE_EVALUATIONS)
}

/// Returns the sentence about lines of a declared geodesic that end because their evaluations are used up.
pub fn cut_note(name: &str) -> String {
    format!(
        "`{name}` is not drawn to its end, which exceeds the work limit: shorten its interval, or declare fewer geodesics"
    )
}

/// All instances of a declared geodesic, as knots.
#[derive(Clone, Debug, Default)]
pub struct FollowedGeodesic {
    /// The number of knots of one instance.
    pub count: u32,
    /// The knots of each instance in the order of t; `None` where the geodesic ends earlier.
    pub lines: Vec<Vec<Option<Knot>>>,
    /// Sentences for the user: the instances that are omitted, and the reason.
    pub notes: Vec<String>,
}

/// Follows all instances of a declared geodesic on all cores. The result is empty for other objects.
pub fn follow_declared(scene: &Scene, params: &ParamValues, id: ObjectId) -> FollowedGeodesic {
    let domain = scene.get(id).and_then(|object| object.shape.arc_lengths());
    domain.map_or_else(FollowedGeodesic::default, |domain| {
        follow_declared_over(scene, params, id, domain)
    })
}

/// Follows all instances of a declared geodesic as [`follow_declared`] does, to other values of its parameter than the
/// declared ones.
pub fn follow_declared_over(
    scene: &Scene,
    params: &ParamValues,
    id: ObjectId,
    domain: &Sampling,
) -> FollowedGeodesic {
    if let Some(object) = scene.get(id)
        && let Some((path, _)) = object.shape.space_geodesic()
    {
        return follow_in_space(scene, params, object, path, domain);
    }
    let Some((object, surface, _)) = parts(scene, id) else {
        return FollowedGeodesic::default();
    };
    let Some(initial_conditions) = InitialConditionsEvaluator::new(scene, id) else {
        return FollowedGeodesic::default();
    };
    let name = &object.name;
    // Values of its parameter, in units of its speed.
    let lengths: Vec<f64> = (0..domain.count).map(|i| domain.value(i)).collect();
    // Only a surface that depends on grids varies between instances.
    let on = scene.get(surface);
    let shared = on
        .filter(|on| on.grids.is_empty())
        .map(|_| Manifold::first(scene, params, surface));
    let line = |index: u64, max_evaluations: u64| -> InstanceLine {
        let nowhere = || KnotLine::nowhere(lengths.len());
        let uniforms = params.instance(scene, object, index);
        let own;
        let manifold = match &shared {
            Some(shared) => shared,
            None => {
                own = Manifold::new(scene, surface, &uniforms);
                &own
            }
        };
        let manifold = match manifold {
            Ok(manifold) => manifold,
            Err(error) => return (nowhere(), Some(error.to_string())),
        };
        match initial_conditions.clone().evaluate(&uniforms) {
            Ok(initial) => {
                let surface = manifold.surface();
                let from = GeodesicStart::Chart(initial.start, initial.direction);
                let lengths: Vec<f64> = lengths.iter().map(|t| t * initial.unit).collect();
                let line = knots_at(surface, &from, &lengths, max_evaluations);
                (line, None)
            }
            Err(fault) => {
                let faults = scene.geodesic_faults(object, &uniforms);
                // The reason why a dependency is undefined is more informative.
                let reason = match faults.first() {
                    Some((of, fault)) if of == name => fault.to_string(),
                    Some((of, fault)) => format!("of `{of}`: {fault}"),
                    None => fault.to_string(),
                };
                (nowhere(), Some(reason))
            }
        }
    };
    all_instances(scene, params, object, domain, &line)
}

/// A line of one instance, and the reason if it is not drawn.
type InstanceLine = (KnotLine, Option<String>);

/// Follows all instances of a geodesic on a solid.
fn follow_in_space(
    scene: &Scene,
    params: &ParamValues,
    object: &Object,
    path: SpacePath<'_>,
    domain: &Sampling,
) -> FollowedGeodesic {
    let lengths: Vec<f64> = (0..domain.count).map(|i| domain.value(i)).collect();
    let start = Tape::new(&scene.graph, &[path.direction, path.start].concat());
    let line = |index: u64, max_evaluations: u64| -> InstanceLine {
        let uniforms = params.instance(scene, object, index);
        let nowhere = |reason: String| (KnotLine::nowhere(lengths.len()), Some(reason));
        let surface = ImplicitSurface::new(&scene.graph, path.field, &uniforms, None);
        let Ok(surface) = surface else {
            let name = path.solid.to_owned();
            return nowhere(ManifoldError::TooLarge { name }.to_string());
        };
        let inputs = start.inputs().iter();
        let inputs: Vec<f64> = inputs.map(|it| it.value(&[], &uniforms)).collect();
        let mut out = [f64::NAN; 6];
        start.eval(&mut Registers::default(), &inputs, &mut out);
        let [a, b, c, x, y, z] = out;
        match space_knots_at(&surface, [x, y, z], [a, b, c], &lengths, max_evaluations) {
            Ok(line) => (line, None),
            Err(fault) => {
                let faults = scene.geodesic_faults(object, &uniforms);
                nowhere(match faults.first() {
                    Some((of, fault)) => format!("of `{of}`: {fault}"),
                    None => fault.to_string(),
                })
            }
        }
    };
    all_instances(scene, params, object, domain, &line)
}

/// Returns the lines of all instances, computed on all cores.
fn all_instances(
    scene: &Scene,
    params: &ParamValues,
    object: &Object,
    domain: &Sampling,
    line: &(dyn Fn(u64, u64) -> InstanceLine + Sync),
) -> FollowedGeodesic {
    let name = &object.name;
    let instances = params.instance_count(scene, object);
    let drawn = instances.min((MAX_POINTS / u64::from(domain.count.max(1))).max(1));
    let mut notes = Vec::new();
    if drawn < instances {
        notes.push(format!(
            "only the first {drawn} of the {instances} instances of `{name}` are drawn: that is the limit"
        ));
    }
    let max_evaluations = evaluations_per_line(scene, drawn);
    let (lines, faults): (Vec<_>, Vec<_>) = (0..drawn)
        .into_par_iter()
        .map(|index| line(index, max_evaluations))
        .unzip();
    if lines.iter().any(|line| line.is_cut) {
        notes.push(cut_note(name));
    }
    let faults: Vec<String> = faults.into_iter().flatten().collect();
    if let Some(first) = faults.first() {
        notes.push(match (faults.len(), drawn) {
            (_, 1) => format!("`{name}` is not drawn: {first}"),
            (few, all) => {
                format!("{few} of the {all} instances of `{name}` are not drawn: {first}")
            }
        });
    }
    FollowedGeodesic {
        count: domain.count,
        lines: lines.into_iter().map(|line| line.knots).collect(),
        notes,
    }
}

/// Returns whether an object is a geodesic on a surface in space or on a solid, so that the 3D view draws it.
pub fn lies_in_space(scene: &Scene, id: ObjectId) -> bool {
    let object = scene.get(id);
    if object.is_some_and(|object| object.shape.space_geodesic().is_some()) {
        return true;
    }
    let surface = parts(scene, id).and_then(|(_, surface, _)| scene.get(surface));
    surface.is_some_and(|surface| surface.shape.is_surface())
}

/// Returns the object, its surface and its arc lengths; `None` for objects other than geodesics.
fn parts(scene: &Scene, id: ObjectId) -> Option<(&Object, ObjectId, &Sampling)> {
    let object = scene.get(id)?;
    let (surface, domain) = object.shape.geodesic()?;
    Some((object, surface, domain))
}
