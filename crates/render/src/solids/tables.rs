//! Traced scenes as data for the pass on the GPU. In: a scene. Out: numbers, and the text of the functions for its
//! expressions; or the reason why the CPU follows its rays.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use expr::{Graph, NodeId};
use geometry::solids::{RayScene, VaryingAttribute, VaryingList, VaryingLook, VaryingPlace};
use glam::{DAffine3, DVec3};
use tracer::shade::{Face, FaceLook, FaceObject, FaceSides, Glass, Scenery};
use tracer::tables::{FieldRow, TableError, WorldTables};
use wgsl::traced::{FunctionUse, MOST_ATTRIBUTES, TooManyOperations, TracedFunctions, UsedNumber};

/// The number of intervals of the height of a direction, from −1 to 1, in the table of the background's light.
const SKY_CELLS: u32 = 4096;

/// A scene as data, without its lights and its camera.
#[derive(Debug)]
pub(crate) struct SceneTables {
    pub(crate) world: WorldTables,
    /// The fields that bound pieces.
    pub(crate) fields: Vec<TableField>,
    /// The functions of its expressions, as text, on which the pipeline depends.
    pub(crate) functions: String,
    /// The different looks of faces.
    pub(crate) looks: Vec<TableLook>,
    /// For each leaf of the world its look, and the sides from which it is visible.
    pub(crate) leaves: Vec<(u32, FaceSides)>,
    /// For each solid of the world the glass that it is of, and the look of the leaf that has it.
    pub(crate) glass: Vec<Option<(Glass, u32)>>,
    /// The background's light, by the height of a direction.
    pub(crate) sky: Vec<DVec3>,
}

/// A field that bounds pieces.
#[derive(Debug)]
pub(crate) struct TableField {
    /// The number of the function.
    pub(crate) function: u32,
    /// The centre of its frame, and half its sides.
    pub(crate) frame: [DVec3; 2],
    /// The numbers that the function reads.
    pub(crate) numbers: Vec<f64>,
}

/// The look of faces.
#[derive(Debug)]
pub(crate) struct TableLook {
    /// The look without the attributes of the lists.
    pub(crate) base: FaceLook,
    /// The attributes that are expressions.
    pub(crate) lists: Vec<AttributeList>,
}

/// Attributes that are expressions in the same coordinates.
#[derive(Debug)]
pub(crate) struct AttributeList {
    /// The number of the function.
    pub(crate) function: u32,
    /// The attributes, in the order of the function's numbers.
    pub(crate) attributes: Vec<VaryingAttribute>,
    /// The coordinates, from positions relative to the tables' origin.
    pub(crate) frame: DAffine3,
    /// The parameters of the two ends of a part of a curve.
    pub(crate) along: Option<[f64; 2]>,
    /// True if colours may exceed 1.
    pub(crate) bright: bool,
    /// The numbers that the function reads.
    pub(crate) numbers: Vec<f64>,
}

impl TableLook {
    /// Returns true if its transmission depends on the point.
    pub(crate) fn varies_through(&self) -> bool {
        let lists = self.lists.iter();
        let mut all = lists.flat_map(|list| &list.attributes);
        all.any(|attribute| match attribute {
            VaryingAttribute::Glass => true,
            VaryingAttribute::Mirror => self.base.glass > 0.0,
            _ => false,
        })
    }

    /// True if its colour depends on the place.
    pub(crate) fn varies_in_colour(&self) -> bool {
        let mut all = self.lists.iter().flat_map(|list| &list.attributes);
        all.any(|attribute| *attribute == VaryingAttribute::Colour)
    }
}

impl SceneTables {
    /// Returns the tables of a scene.
    ///
    /// # Errors
    /// A clause about the part of the scene that the pass cannot draw.
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
        let (world, fields) = rays.world().tables().map_err(|error| match error {
            TableError::Degree { solid, degree } => {
                format!(
                    "`{}` joins polynomials, one of them of degree {degree}",
                    name(solid)
                )
            }
            TableError::EndlessQuartic { solid } => {
                format!(
                    "`{}` has an unbounded surface of degree three or more",
                    name(solid)
                )
            }
            TableError::TooManyNodes { solid } => {
                format!("`{}` joins very many solids", name(solid))
            }
        })?;
        let mut looks = LookTable::default();
        let fields = looks.functions.fields(&fields);
        let fields = fields.map_err(|(solid, why)| {
            format!("`{}` is bounded by a function of which {why}", name(solid))
        })?;
        let mut leaves = vec![(0, FaceSides::Both); rays.world().leaf_count()];
        for component in &world.components {
            let solid = component.solid as usize;
            let first = component.first_leaf as usize;
            for row in &world.leaves[first..first + component.leaf_count as usize] {
                let leaf = row.leaf as usize;
                let look = looks.of_leaf(rays, scenery, world.origin, [solid, leaf])?;
                let sides = scenery.sides.get(leaf).copied().unwrap_or_default();
                leaves[leaf] = (look, sides);
            }
        }
        let mut glass = vec![None; scenery.glass.len()];
        for (solid, found) in scenery.glass.iter().enumerate() {
            if let Some(of) = found {
                let look = looks.of_leaf(rays, scenery, world.origin, [solid, of.leaf])?;
                glass[solid] = Some((*of, look));
            }
        }
        let height = |k: u32| 2.0 * f64::from(k) / f64::from(SKY_CELLS) - 1.0;
        let direction = |z: f64| DVec3::new((1.0 - z * z).max(0.0).sqrt(), 0.0, z);
        let sky = (0..=SKY_CELLS).map(|k| (scenery.background)(direction(height(k))));
        Ok(Self {
            fields,
            functions: looks.functions.traced.text(),
            looks: looks.looks,
            leaves,
            glass,
            sky: sky.collect(),
            world,
        })
    }
}

/// Returns a face of a leaf, at an arbitrary point.
fn anywhere(solid: usize, leaf: usize) -> Face {
    Face {
        t: 1.0,
        position: DVec3::ZERO,
        normal: DVec3::Z,
        beam: DVec3::ZERO,
        of: FaceObject::Solid {
            solid,
            leaf,
            surface: tracer::SurfaceId::of_leaf(leaf),
            entering: true,
        },
    }
}

/// The looks of a scene's faces.
#[derive(Default)]
struct LookTable {
    looks: Vec<TableLook>,
    known: HashMap<Vec<u64>, u32>,
    functions: FunctionTable,
}

/// The functions of a scene.
#[derive(Default)]
struct FunctionTable {
    traced: TracedFunctions,
    /// The function of each list of attributes that has been read, and of each field, by its expressions.
    lists: HashMap<(*const Graph, Vec<NodeId>), FunctionUse>,
    fields: HashMap<(*const Graph, NodeId), FunctionUse>,
}

impl FunctionTable {
    /// Returns the fields of a world; if one is too large, its solid and a clause.
    fn fields(
        &mut self,
        rows: &[FieldRow<'_>],
    ) -> Result<Vec<TableField>, (usize, TooManyOperations)> {
        let field = |row: &FieldRow<'_>| {
            let (graph, root) = row.expression();
            let used = match self.fields.entry((std::ptr::from_ref(graph), root)) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(new) => {
                    let used = self.traced.field(graph, root);
                    new.insert(used.map_err(|why| (row.solid, why))?)
                }
            };
            Ok(TableField {
                function: used.function,
                frame: [row.middle, row.half],
                numbers: numbers(used, &|slot| row.uniform(slot)),
            })
        };
        rows.iter().map(field).collect()
    }
}

/// Returns the numbers that a function reads.
fn numbers(used: &FunctionUse, uniform: &dyn Fn(u32) -> f64) -> Vec<f64> {
    let number = |number: &UsedNumber| match *number {
        UsedNumber::Constant(value) => value,
        UsedNumber::Uniform(slot) => uniform(slot),
    };
    used.numbers.iter().map(number).collect()
}

impl LookTable {
    /// The number of the look of the faces that a leaf of a solid owns.
    fn of_leaf(
        &mut self,
        rays: &RayScene,
        scenery: &Scenery<'_>,
        origin: DVec3,
        [solid, leaf]: [usize; 2],
    ) -> Result<u32, String> {
        let name = &rays.object_of_solid(solid).name;
        let varying = rays.varying_look(leaf);
        let varying =
            varying.map_err(|_| format!("the faces of `{name}` have places of an image"))?;
        let Some(varying) = varying else {
            let base = (scenery.look)(&anywhere(solid, leaf)).balanced();
            return Ok(self.number(base, Vec::new()));
        };
        let lists = self.lists(&varying, origin);
        let lists = lists.map_err(|why| format!("`{name}` {why}"))?;
        let shares = [VaryingAttribute::Mirror, VaryingAttribute::Glass];
        let mut stated = lists.iter().flat_map(|list| &list.attributes);
        let base = match stated.any(|attribute| shares.contains(attribute)) {
            true => varying.base,
            false => varying.base.balanced(),
        };
        Ok(self.number(base, lists))
    }

    /// The number of a look, which is a new one unless it is known.
    fn number(&mut self, base: FaceLook, lists: Vec<AttributeList>) -> u32 {
        let mut key = bits(&base);
        lists.iter().for_each(|list| list.add_bits(&mut key));
        *self.known.entry(key).or_insert_with(|| {
            self.looks.push(TableLook { base, lists });
            self.looks.len() as u32 - 1
        })
    }

    /// Returns the lists of a look that depends on the point.
    fn lists(
        &mut self,
        look: &VaryingLook<'_>,
        origin: DVec3,
    ) -> Result<Vec<AttributeList>, String> {
        let lists = look.lists.iter();
        let lists = lists.filter(|list| !list.attributes.is_empty());
        lists
            .map(|list| self.list(list, look.uniforms, origin))
            .collect()
    }

    fn list(
        &mut self,
        list: &VaryingList<'_>,
        uniforms: &[f64],
        origin: DVec3,
    ) -> Result<AttributeList, String> {
        let roots = list.attributes.iter();
        let roots: Vec<NodeId> = roots.flat_map(|(_, numbers)| numbers.clone()).collect();
        if roots.len() > MOST_ATTRIBUTES {
            return Err("has more attributes that depend on the place than its shader".to_owned());
        }
        let key = (std::ptr::from_ref(list.graph), roots);
        let used = match self.functions.lists.get(&key) {
            Some(known) => known,
            None => {
                let used = self.functions.traced.list(list.graph, &key.1);
                let used = used.map_err(|why| format!("has attributes of which {why}"))?;
                self.functions.lists.entry(key).or_insert(used)
            }
        };
        let (frame, along) = match list.place {
            VaryingPlace::Within(frame) => (frame, None),
            VaryingPlace::Along(frame, parameters) => (frame, Some(parameters)),
        };
        let uniform = |slot: u32| uniforms.get(slot as usize).copied().unwrap_or(f64::NAN);
        Ok(AttributeList {
            function: used.function,
            attributes: list.attributes.iter().map(|(it, _)| *it).collect(),
            frame: frame * DAffine3::from_translation(origin),
            along,
            bright: list.bright,
            numbers: numbers(used, &uniform),
        })
    }
}

impl AttributeList {
    /// Adds the bits that distinguish lists.
    fn add_bits(&self, bits: &mut Vec<u64>) {
        let Self {
            function,
            attributes,
            frame,
            along,
            bright,
            numbers,
        } = self;
        bits.extend([u64::from(*function), u64::from(*bright)]);
        bits.push(attributes.len() as u64);
        bits.extend(attributes.iter().map(|attribute| *attribute as u64));
        let along = along.unwrap_or([f64::NAN; 2]);
        let frame = frame.to_cols_array();
        let numbers = frame.iter().chain(&along).chain(numbers);
        bits.extend(numbers.map(|number| number.to_bits()));
    }
}

/// Returns the bits of the numbers of a look.
fn bits(look: &FaceLook) -> Vec<u64> {
    let FaceLook {
        colour,
        diffuse,
        specular,
        shininess,
        mirror,
        glass,
        bump,
    } = *look;
    let shares = [diffuse.unwrap_or(-1.0), specular, shininess, glass];
    let vectors = [colour, mirror, bump].map(|vector| vector.to_array());
    let numbers = shares.iter().chain(vectors.iter().flatten());
    numbers.map(|number| number.to_bits()).collect()
}
