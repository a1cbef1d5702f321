//! Traced scenes as data for the fixed pass of the GPU: a scene flows in, numbers flow out, or the reason for which the CPU
//! follows its rays.

use std::collections::HashMap;

use geometry::solids::RayScene;
use glam::DVec3;
use tracer::shade::{Face, FaceLook, FaceObject, FaceSides, Glass, Scenery};
use tracer::tables::{TableError, WorldTables};

/// The parts of the height of a direction, from −1 to 1, of which the background's light is known.
const SKY_CELLS: u32 = 4096;

/// A scene as data, apart from its lights and its camera.
#[derive(Debug)]
pub(crate) struct SceneTables {
    pub(crate) world: WorldTables,
    /// The different looks of faces.
    pub(crate) looks: Vec<FaceLook>,
    /// For each leaf of the world its look, and the sides from which it is seen.
    pub(crate) leaves: Vec<(u32, FaceSides)>,
    /// For each solid of the world.
    pub(crate) glass: Vec<Option<Glass>>,
    /// The background's light, by the height of a direction.
    pub(crate) sky: Vec<DVec3>,
}

impl SceneTables {
    /// The tables of a scene.
    ///
    /// # Errors
    /// A clause about what of the scene the pass cannot draw.
    pub(super) fn new(
        rays: &RayScene,
        scenery: &Scenery<'_>,
        has_image: bool,
    ) -> Result<Self, String> {
        if !rays.sheets().bounds().is_empty() {
            return Err("the scene has parametric surfaces".to_owned());
        }
        if has_image || !rays.has_level_background() {
            return Err("the background differs around the horizon".to_owned());
        }
        let name = |solid: usize| &rays.object_of_solid(solid).name;
        let world = rays.world().tables().map_err(|error| match error {
            TableError::NoPolynomial { solid } => {
                format!("`{}` is not bounded by polynomials", name(solid))
            }
            TableError::Degree { solid, degree } => {
                format!("`{}` has a polynomial of degree {degree}", name(solid))
            }
            TableError::EndlessQuartic { solid } => {
                format!(
                    "`{}` has an endless surface of degree three or four",
                    name(solid)
                )
            }
            TableError::TooManyNodes { solid } => {
                format!("`{}` joins very many solids", name(solid))
            }
        })?;
        let mut looks = Vec::new();
        let mut known: HashMap<Vec<u64>, u32> = HashMap::new();
        let mut leaves = vec![(0, FaceSides::Both); rays.world().leaf_count()];
        for component in &world.components {
            let solid = component.solid as usize;
            let first = component.first_leaf as usize;
            for row in &world.leaves[first..first + component.leaf_count as usize] {
                let leaf = row.leaf as usize;
                if !rays.is_even(leaf) {
                    let name = name(solid);
                    return Err(format!("the faces of `{name}` differ from place to place"));
                }
                let look = (scenery.look)(&anywhere(solid, leaf)).balanced();
                let look = *known.entry(bits(&look)).or_insert_with(|| {
                    looks.push(look);
                    looks.len() as u32 - 1
                });
                let sides = scenery.sides.get(leaf).copied().unwrap_or_default();
                leaves[leaf] = (look, sides);
            }
        }
        let height = |k: u32| 2.0 * f64::from(k) / f64::from(SKY_CELLS) - 1.0;
        let direction = |z: f64| DVec3::new((1.0 - z * z).max(0.0).sqrt(), 0.0, z);
        let sky = (0..=SKY_CELLS).map(|k| (scenery.background)(direction(height(k))));
        Ok(Self {
            looks,
            leaves,
            glass: scenery.glass.to_vec(),
            sky: sky.collect(),
            world,
        })
    }
}

/// A face that a leaf owns, somewhere.
fn anywhere(solid: usize, leaf: usize) -> Face {
    Face {
        t: 1.0,
        position: DVec3::ZERO,
        normal: DVec3::Z,
        of: FaceObject::Solid {
            solid,
            leaf,
            surface: tracer::SurfaceId::of_leaf(leaf),
            entering: true,
        },
    }
}

/// The bits of the numbers of a look.
fn bits(look: &FaceLook) -> Vec<u64> {
    let shares = [look.scattered(), look.specular, look.shininess, look.glass];
    let colors = [look.color, look.mirror].map(|color| color.to_array());
    let numbers = shares.iter().chain(colors.iter().flatten());
    numbers.map(|number| number.to_bits()).collect()
}
