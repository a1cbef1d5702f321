//! The surface of a solid for geodesics: a solid of a scene and values of its params flow in, what geodesics in space are
//! computed on flows out, with the box that holds it and the place where a camera first stands.
//!
//! This is the only place where a scene's solid becomes an [`ImplicitSurface`] for views and commands.

use geodesic::implicit::ImplicitSurface;
use glam::DVec3;
use scene::{BoundGrid, ObjectId, ParamValues, Range, Sampling, Scene};
use tracer::{BoundingBox, Ray};

use crate::manifold::ManifoldError;
use crate::solids::{MAX_SHAPE_WORK, RayFault, RayScene, RaySceneOptions};

/// The surface of the first instance of a solid.
#[derive(Debug)]
pub struct SolidSurface {
    surface: ImplicitSurface,
    bounds: Option<BoundingBox>,
    first: Option<[f64; 3]>,
}

impl SolidSurface {
    /// Compiles a solid, for these values of the params; of one that depends on grids that are given no value, the union of all
    /// instances.
    ///
    /// # Errors
    /// [`ManifoldError`].
    pub fn new(scene: &Scene, params: &ParamValues, id: ObjectId) -> Result<Self, ManifoldError> {
        let made = scene.made_anew(params);
        let scene = made.as_deref().unwrap_or(scene);
        let Some(object) = scene.get(id) else {
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
            color: &|_| DVec3::ONE,
            thickness: None,
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
        let first = first_place(&rays, bounds);
        Ok(Self {
            surface,
            bounds,
            first,
        })
    }

    /// The surface that geodesics are computed on.
    pub fn surface(&self) -> &ImplicitSurface {
        &self.surface
    }

    /// The lower and the upper corner of a box that holds it; `None` for an endless one.
    pub fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        self.bounds
            .map(|bounds| [bounds.lower.to_array(), bounds.upper.to_array()])
    }

    /// The place where the ray from the middle of its box along x leaves it, or one along another axis if that does not meet
    /// it; `None` if none does.
    pub fn first_place(&self) -> Option<[f64; 3]> {
        self.first
    }
}

/// A grid with one value.
fn only(value: f64) -> Sampling {
    Sampling {
        range: Range {
            min: value,
            max: value,
        },
        count: 1,
    }
}

fn first_place(rays: &RayScene, bounds: Option<BoundingBox>) -> Option<[f64; 3]> {
    let middle = bounds.map_or(DVec3::ZERO, |bounds| 0.5 * (bounds.lower + bounds.upper));
    let mut caster = rays.world().caster();
    let axes = [
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        -DVec3::X,
        -DVec3::Y,
        -DVec3::Z,
    ];
    axes.into_iter().find_map(|direction| {
        let ray = Ray {
            origin: middle,
            direction,
            leaving: None,
        };
        let crossings = caster.cast(&ray);
        let leaves = crossings.iter().find(|crossing| !crossing.entering)?;
        Some(leaves.position.to_array())
    })
}
