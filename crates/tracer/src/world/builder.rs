//! The builder of worlds.
//!
//! In: shapes by expressions, set operations in postfix order, affine maps. Out: a [`World`].

use std::borrow::Borrow;
use std::sync::Arc;

use expr::polynomial::Region;
use expr::{Graph, Input, NodeId, TooLarge};
use glam::{DAffine3, DVec3};

use super::boxes::{JointSet, joined};
use super::{LEAF_WORK, World};
use crate::bounds::{BoundingBox, WorkBudget};
use crate::bvh::Hierarchy;
use crate::field::FieldCompiler;
use crate::frame::power_of_two;
use crate::leaf::Leaf;
use crate::line::SurfaceId;
use crate::low::{is_convex, is_simple, low_pieces};
use crate::product::find_products;
use crate::shape::{FramedShape, LeafSurface, Shape};
use crate::shared::share;
use crate::tree::{Forest, LeafLiterals, TreeStep};

/// Identifies a shape of a [`WorldBuilder`].
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub struct ShapeId(usize);

/// A step of a set expression in postfix order: an operand, or an operation on the last two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SetStep {
    /// The image of a shape under an affine map.
    Leaf(ShapeId, DAffine3),
    /// The points of at least one of the two.
    Union,
    /// The points of both.
    Intersection,
    /// The points of the first that do not belong to the second.
    Difference,
}

/// The reasons why a world cannot be built.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum BuildError {
    /// An expression is too large.
    TooLarge,
    /// The map of a leaf of this solid is singular or not finite.
    SingularMap(usize),
    /// The steps of this solid do not combine to one set.
    Unbalanced(usize),
    /// The given work is used up.
    TooMuchWork,
}

/// Collects the parts of a world.
pub struct WorldBuilder<'a> {
    compiler: FieldCompiler<'a>,
    uniform: &'a dyn Fn(Input) -> f64,
    work: WorkBudget,
    shapes: Vec<Shape>,
    solids: Vec<PlacedSolid>,
}

/// The steps of a solid, whose leaves are indices into the list of its placed shapes.
struct PlacedSolid {
    steps: Vec<TreeStep>,
    leaves: Vec<PlacedShape>,
}

/// A shape under an affine map.
pub(super) struct PlacedShape {
    pub(super) shape: usize,
    pub(super) map: DAffine3,
}

/// The fraction by which the box of a leaf is enlarged beyond its known bounds: the roots of its surface may be outside by
/// rounding errors, which are smaller unless the roots are nearly multiple.
const ROOM: f64 = 1e-8;
/// An unbounded field is searched within this number of radii of the bounded part of the scene along each axis without bounds.
pub const SEARCHED_RADII: f64 = 64.0;
/// The work of preparing a surface that bounds a leaf, in operations.
const PIECE_WORK: u64 = 24;
/// The work of finding boxes for sets whose leaves have none, in operations on intervals: a fraction of a second.
const JOINT_WORK: u64 = 1 << 26;
/// A map is singular if its determinant is below this fraction of the product of its columns' lengths.
const LEAST_DETERMINANT: f64 = 1e-12;

/// Returns true if the map is singular or not finite. A leaf cannot be placed by it.
pub fn is_singular(map: &DAffine3) -> bool {
    let matrix = map.matrix3;
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let volume: f64 = columns.map(DVec3::length).iter().product();
    let is_regular = matrix.determinant().abs() > LEAST_DETERMINANT * volume;
    !(map.is_finite() && is_regular)
}

impl<'a> WorldBuilder<'a> {
    /// Begins a world of expressions of this graph; `uniform` gives the values of its uniforms.
    pub fn new(graph: &'a Graph, uniform: &'a dyn Fn(Input) -> f64) -> Self {
        Self {
            compiler: FieldCompiler::new(graph),
            uniform,
            work: WorkBudget::new(u64::MAX),
            shapes: Vec::new(),
            solids: Vec::new(),
        }
    }

    /// Limits the work of reading shapes, of finding their boxes and of preparing leaves, in operations on intervals.
    pub fn with_work(mut self, work: u64) -> Self {
        self.work = WorkBudget::new(work);
        self
    }

    /// Returns the remaining work.
    pub fn work_left(&self) -> u64 {
        self.work.left()
    }

    /// Adds the set where the expression in the variables 0, 1, 2 (x, y, z) is not positive, within the cuts. It is not
    /// visible until a solid has it as a leaf.
    ///
    /// # Errors
    /// If the expression's gradient is too large, or the work is used up.
    pub fn shape(
        &mut self,
        field: NodeId,
        cuts: [Option<[f64; 2]>; 3],
    ) -> Result<ShapeId, BuildError> {
        self.shape_with(field, cuts, self.uniform)
    }

    /// Adds a set as [`WorldBuilder::shape`] does, with uniforms of its own, those of one instance of an object.
    ///
    /// # Errors
    /// If the expression's gradient is too large, or the work is used up.
    pub fn shape_with(
        &mut self,
        field: NodeId,
        cuts: [Option<[f64; 2]>; 3],
        uniform: &dyn Fn(Input) -> f64,
    ) -> Result<ShapeId, BuildError> {
        // Checked before reading, too: a scene may have thousands more shapes.
        let is_enough = || match self.work.is_used_up() {
            true => Err(BuildError::TooMuchWork),
            false => Ok(()),
        };
        is_enough()?;
        let shape = Shape::new(&self.compiler, field, cuts, uniform, &self.work)?;
        is_enough()?;
        self.shapes.push(shape);
        Ok(ShapeId(self.shapes.len() - 1))
    }

    /// Adds a solid and returns its index.
    ///
    /// # Errors
    /// If a map is singular, the steps are not one set, or the work is used up.
    pub fn solid(
        &mut self,
        steps: impl IntoIterator<Item = impl Borrow<SetStep>>,
    ) -> Result<usize, BuildError> {
        let index = self.solids.len();
        let mut solid = PlacedSolid {
            steps: Vec::new(),
            leaves: Vec::new(),
        };
        let mut operands = 0usize;
        for step in steps {
            solid.steps.push(match *step.borrow() {
                SetStep::Leaf(ShapeId(shape), map) => {
                    if is_singular(&map) {
                        return Err(BuildError::SingularMap(index));
                    }
                    operands += 1;
                    let pieces = self.shapes[shape].pieces as u64;
                    if !self.work.take(LEAF_WORK + PIECE_WORK * pieces) {
                        return Err(BuildError::TooMuchWork);
                    }
                    solid.leaves.push(PlacedShape { shape, map });
                    TreeStep::Leaf(solid.leaves.len() - 1)
                }
                _ if operands < 2 => return Err(BuildError::Unbalanced(index)),
                join => {
                    operands -= 1;
                    match join {
                        SetStep::Union => TreeStep::Union,
                        SetStep::Intersection => TreeStep::Intersection,
                        _ => TreeStep::Difference,
                    }
                }
            });
        }
        if operands != 1 {
            return Err(BuildError::Unbalanced(index));
        }
        self.solids.push(solid);
        Ok(index)
    }

    /// Prepares the world.
    ///
    /// # Errors
    /// If an expression's gradient is too large.
    pub fn build(self) -> Result<World, BuildError> {
        let rest = self.rest();
        let shapes = self.shapes;
        let mut draft = WorldDraft {
            frames: FrameCache {
                compiler: &self.compiler,
                shapes: &shapes,
                size: power_of_two((0.5 * (rest.upper - rest.lower)).max_element()),
                compiled: vec![None; shapes.len()],
            },
            joint_work: WorkBudget::new(self.work.left().min(JOINT_WORK)),
            rest,
            leaves: Vec::new(),
            boxes: Vec::new(),
            forest: Forest::default(),
            solids: Vec::new(),
            extents: Vec::new(),
            piece_count: 0,
        };
        for placed in self.solids {
            draft.add(placed)?;
        }
        let WorldDraft {
            leaves,
            boxes,
            forest,
            solids,
            extents,
            piece_count,
            ..
        } = draft;
        let (hierarchy, boxed, endless) = by_boxes(&boxes);
        let surfaces = share(&leaves, piece_count, &rest);
        let (products, product_of) =
            find_products(&solids, leaves.len(), &|leaf| is_simple(&leaves[leaf]));
        let all = 0..forest.len();
        let endless_solids = all.filter(|&solid| forest.is_endless(solid)).collect();
        let convex = leaves
            .iter()
            .map(|leaf| is_convex(&leaf.compiled))
            .collect();
        Ok(World {
            low: low_pieces(&leaves, &surfaces),
            convex,
            guards: solids.iter().flat_map(|steps| guards(steps)).collect(),
            surface_of_piece: surfaces_of_pieces(&leaves),
            shapes,
            forest,
            hierarchy,
            boxed,
            endless,
            endless_solids,
            products,
            product_of,
            leaves,
            surfaces,
            solids,
            extents,
        })
    }

    /// Returns the box of everything bounded; if nothing is, that of the unit sphere.
    fn rest(&self) -> BoundingBox {
        let mut rest = BoundingBox::EMPTY;
        for leaf in self.solids.iter().flat_map(|solid| &solid.leaves) {
            if let Some(bounds) = self.shapes[leaf.shape].bounds()
                && !bounds.is_empty()
            {
                rest = rest.union(&bounds.transformed(&leaf.map));
            }
        }
        if rest.is_empty() || rest.lower == rest.upper {
            let centre = if rest.is_empty() {
                DVec3::ZERO
            } else {
                rest.lower
            };
            return BoundingBox {
                lower: centre - 1.0,
                upper: centre + 1.0,
            };
        }
        rest
    }
}

/// The parts of a world, solid by solid.
struct WorldDraft<'a> {
    frames: FrameCache<'a>,
    /// The work of finding boxes for sets whose leaves have none.
    joint_work: WorkBudget,
    /// The box of everything bounded.
    rest: BoundingBox,
    leaves: Vec<Leaf>,
    /// The box of each leaf, if it has one.
    boxes: Vec<Option<BoundingBox>>,
    forest: Forest,
    solids: Vec<Vec<TreeStep>>,
    /// The box of each solid, if one is found.
    extents: Vec<BoundingBox>,
    piece_count: usize,
}

impl WorldDraft<'_> {
    /// Adds a solid with its leaves.
    fn add(&mut self, placed: PlacedSolid) -> Result<(), BuildError> {
        let solid = self.solids.len();
        let first = self.leaves.len();
        let mut steps = placed.steps;
        for step in &mut steps {
            if let TreeStep::Leaf(leaf) = step {
                *leaf += first;
            }
        }
        let shapes = placed.leaves.iter();
        let compiled: Vec<Arc<FramedShape>> = shapes
            .map(|leaf| self.frames.compiled(leaf.shape))
            .collect::<Result<_, _>>()?;
        let literals = self.literals(&steps, &compiled);
        let (extent, clips) = self.clips(&steps, &placed.leaves, &compiled);
        self.extents.push(extent);
        let parts = compiled.into_iter().zip(clips).zip(literals);
        for (placed, ((compiled, clip), literals)) in placed.leaves.into_iter().zip(parts) {
            // Each leaf is a part of its tree.
            let literals = literals.ok_or(BuildError::Unbalanced(solid))?;
            self.add_leaf(solid, placed, compiled, clip, literals);
        }
        self.solids.push(steps);
        Ok(())
    }

    /// Adds a solid to the forest; returns the literals of its leaves.
    fn literals(
        &mut self,
        steps: &[TreeStep],
        compiled: &[Arc<FramedShape>],
    ) -> Vec<Option<LeafLiterals>> {
        let first = self.leaves.len();
        let mut literals: Vec<Option<LeafLiterals>> = vec![None; compiled.len()];
        self.forest.add(
            steps,
            &|leaf| {
                let shape = &compiled[leaf - first];
                if is_convex(shape) {
                    // Its gate decides its membership.
                    return Region::All(Vec::new());
                }
                shape.region.clone()
            },
            &mut |leaf, found| literals[leaf - first] = Some(found),
        );
        literals
    }

    /// Returns a box that contains a solid, and the boxes outside which its leaves do not matter.
    fn clips(
        &self,
        steps: &[TreeStep],
        leaves: &[PlacedShape],
        compiled: &[Arc<FramedShape>],
    ) -> (BoundingBox, Vec<BoundingBox>) {
        let first = self.leaves.len();
        let shapes = self.frames.shapes;
        let extent = |leaf: usize| {
            let PlacedShape { shape, map } = &leaves[leaf - first];
            let shape: &Shape = &shapes[*shape];
            (shape.extent, map)
        };
        let joint = JointSet {
            steps,
            first,
            leaves,
            compiled,
            shapes,
            work: &self.joint_work,
        };
        joined(steps, &extent, &|limits| joint.bounds(limits))
    }

    fn add_leaf(
        &mut self,
        solid: usize,
        PlacedShape { shape, map }: PlacedShape,
        compiled: Arc<FramedShape>,
        clip: BoundingBox,
        LeafLiterals { gate, pieces }: LeafLiterals,
    ) {
        let is_field = |piece: &LeafSurface| matches!(piece, LeafSurface::Field(..));
        let has_fields = compiled.pieces.iter().any(is_field);
        let bounds = clip.if_finite().map(|bounds| bounds.with_room(ROOM));
        let ends = bounds.is_some();
        let bounds = bounds.or_else(|| has_fields.then(|| searched(&clip, &self.rest)));
        self.boxes.push(bounds);
        let world_from_unit = map * compiled.shape_from_unit;
        let first_piece = self.piece_count;
        self.piece_count += compiled.pieces.len();
        self.leaves.push(Leaf {
            solid,
            shape,
            compiled,
            unit_from_world: world_from_unit.inverse(),
            shape_from_world: map.inverse(),
            bounded: self.frames.shapes[shape].bounds().is_some(),
            bounds,
            ends,
            gate,
            pieces,
            first_piece,
        });
    }
}

/// Compiles each shape once.
struct FrameCache<'a> {
    compiler: &'a FieldCompiler<'a>,
    shapes: &'a [Shape],
    /// Half the side of the frames of shapes that determine none.
    size: f64,
    compiled: Vec<Option<Arc<FramedShape>>>,
}

impl FrameCache<'_> {
    fn compiled(&mut self, shape: usize) -> Result<Arc<FramedShape>, BuildError> {
        if let Some(compiled) = &self.compiled[shape] {
            return Ok(compiled.clone());
        }
        let compiled = self.shapes[shape].compile(self.compiler, self.size)?;
        let compiled = Arc::new(compiled);
        self.compiled[shape] = Some(compiled.clone());
        Ok(compiled)
    }
}

/// Returns the hierarchy of the boxes that are not empty, the leaves that they belong to, and those without one.
fn by_boxes(boxes: &[Option<BoundingBox>]) -> (Hierarchy, Vec<u32>, Vec<u32>) {
    let (mut boxed, mut endless, mut all) = (Vec::new(), Vec::new(), Vec::new());
    for (leaf, bounds) in (0..).zip(boxes) {
        match bounds {
            None => endless.push(leaf),
            Some(bounds) if bounds.is_empty() => {}
            Some(bounds) => {
                boxed.push(leaf);
                all.push(*bounds);
            }
        }
    }
    (Hierarchy::new(all), boxed, endless)
}

/// Returns the surface of each piece of each leaf.
fn surfaces_of_pieces(leaves: &[Leaf]) -> Vec<SurfaceId> {
    let pieces = (0..).zip(leaves).flat_map(|(leaf, of)| {
        (0..of.compiled.pieces.len() as u32).map(move |piece| SurfaceId { leaf, piece })
    });
    pieces.collect()
}

/// Returns for each leaf of a solid its guard, if it has one: a leaf without which the largest possible set around it is
/// empty. If the guard is empty, so is an intersection with it, and a difference from it.
fn guards(steps: &[TreeStep]) -> Vec<Option<u32>> {
    // For each set its guard, and the number of leaves before it.
    let mut stack: Vec<(Option<u32>, usize)> = Vec::new();
    let mut guards: Vec<Option<u32>> = Vec::new();
    for step in steps {
        if let TreeStep::Leaf(leaf) = *step {
            stack.push((Some(leaf as u32), guards.len()));
            guards.push(None);
            continue;
        }
        let (Some((second, _)), Some((first, begin))) = (stack.pop(), stack.pop()) else {
            break;
        };
        let guard = match step {
            TreeStep::Union => None,
            TreeStep::Intersection => first.or(second),
            _ => first,
        };
        if guard.is_some() {
            guards[begin..].fill(guard);
        }
        stack.push((guard, begin));
    }
    let leaves = steps.iter().filter_map(|step| match *step {
        TreeStep::Leaf(leaf) => Some(leaf as u32),
        _ => None,
    });
    guards
        .into_iter()
        .zip(leaves)
        .map(|(guard, leaf)| guard.filter(|guard| *guard != leaf))
        .collect()
}

/// Returns the box within which a field is searched that does not matter outside `clip`, some of whose sides are at infinity.
fn searched(clip: &BoundingBox, rest: &BoundingBox) -> BoundingBox {
    let radius = SEARCHED_RADII * 0.5 * (rest.upper - rest.lower).length();
    let axis = |k: usize| {
        let [lower, upper] = [clip.lower[k], clip.upper[k]];
        let centre = rest.centre()[k].max(lower).min(upper);
        let room = ROOM * radius;
        match (lower.is_finite(), upper.is_finite()) {
            (true, true) => [lower - room, upper + room],
            _ => [
                (lower - room).max(centre - radius),
                (upper + room).min(centre + radius),
            ],
        }
    };
    BoundingBox::of_ranges([0, 1, 2].map(axis))
}

impl From<TooLarge> for BuildError {
    fn from(_: TooLarge) -> Self {
        Self::TooLarge
    }
}

impl std::fmt::Display for BuildError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::TooLarge => TooLarge.fmt(f),
            Self::SingularMap(solid) => {
                write!(f, "a map of solid {solid} is singular")
            }
            Self::TooMuchWork => write!(f, "locating the shapes exceeds the work limit"),
            Self::Unbalanced(solid) => {
                write!(f, "the steps of solid {solid} do not join into one set")
            }
        }
    }
}

impl std::error::Error for BuildError {}
