//! Worlds: solids as data, prepared for rays.
//!
//! In: expressions, set operations in postfix order, affine maps. Out: a [`World`], into which `cast.rs` casts rays.

use std::borrow::Borrow;
use std::sync::Arc;

use expr::interval::Interval;
use expr::polynomial::{Polynomial, Region};
use expr::{Graph, Input, NodeId, TooLarge};
use glam::{DAffine3, DVec3};

use crate::bounds::{BoundingBox, WorkBudget, enclose};
use crate::bvh::Hierarchy;
use crate::field::{FieldCompiler, FieldScratch};
use crate::frame::power_of_two;
use crate::leaf::Leaf;
use crate::line::SurfaceId;
use crate::low::{LowPiece, is_convex, is_simple, low_pieces};
use crate::product::{Product, ProductLeaf, find_products};
use crate::reach::joint_reach;
use crate::shape::{FramedShape, LeafSurface, Shape};
use crate::shared::{Surfaces, coordinates, share};
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
struct PlacedShape {
    shape: usize,
    map: DAffine3,
}

/// Solids into which rays can be cast.
#[derive(Debug)]
pub struct World {
    pub(crate) shapes: Vec<Shape>,
    pub(crate) leaves: Vec<Leaf>,
    pub(crate) forest: Forest,
    pub(crate) hierarchy: Hierarchy,
    /// The leaf of each box of the hierarchy.
    pub(crate) boxed: Vec<u32>,
    pub(crate) endless: Vec<u32>,
    /// The solids that contain the points that no leaf contains.
    pub(crate) endless_solids: Vec<usize>,
    pub(crate) surfaces: Surfaces,
    /// The pieces of degree at most two.
    pub(crate) low: Vec<Option<LowPiece>>,
    /// True for the leaves that a ray never meets again once it has left them.
    pub(crate) convex: Vec<bool>,
    /// The guard of each leaf: another leaf without which it does not matter.
    pub(crate) guards: Vec<Option<u32>>,
    /// The products whose unions are solids, and the role of each leaf in one.
    pub(crate) products: Vec<Product>,
    pub(crate) product_of: Vec<Option<ProductLeaf>>,
    /// The surface of each piece.
    pub(crate) surface_of_piece: Vec<SurfaceId>,
    pub(crate) solids: Vec<Vec<TreeStep>>,
    /// For each solid a box that contains it, `None` if none is found.
    bounds: Vec<Option<BoundingBox>>,
}

/// The fraction by which the box of a leaf is enlarged beyond its known bounds: the roots of its surface may be outside by
/// rounding errors, which are smaller unless the roots are nearly multiple.
const ROOM: f64 = 1e-8;
/// An unbounded field is searched within this number of radii of the bounded part of the scene.
const RADII: f64 = 64.0;
/// The work of preparing a leaf, and each surface that bounds it, in operations.
const LEAF_WORK: u64 = 16;
const PIECE_WORK: u64 = 24;
/// The work of finding boxes for sets whose leaves have none, in operations on intervals: a fraction of a second.
const JOINT_WORK: u64 = 1 << 26;
/// Sets of more leaves are not examined as a whole, nor polynomials of a higher degree in world coordinates.
const MOST_JOINT_LEAVES: usize = 64;
const HIGHEST_JOINT: usize = 4;
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
        let mut frames = FrameCache {
            compiler: &self.compiler,
            shapes: &shapes,
            size: power_of_two((0.5 * (rest.upper - rest.lower)).max_element()),
            known: vec![None; shapes.len()],
        };
        let joint_work = WorkBudget::new(self.work.left().min(JOINT_WORK));
        let mut leaves: Vec<Leaf> = Vec::new();
        let mut boxes: Vec<Option<BoundingBox>> = Vec::new();
        let mut forest = Forest::default();
        let mut solids = Vec::new();
        let mut bounds = Vec::new();
        let mut piece_count = 0;
        for (solid, placed) in self.solids.into_iter().enumerate() {
            let first = leaves.len();
            let mut read = placed.steps;
            for step in &mut read {
                if let TreeStep::Leaf(leaf) = step {
                    *leaf += first;
                }
            }
            let placed = placed.leaves;
            // The known data of each leaf before its literals exist.
            let drafts = placed.iter().map(|leaf| frames.compiled(leaf.shape));
            let drafts: Vec<Arc<FramedShape>> = drafts.collect::<Result<_, _>>()?;
            let mut literals: Vec<Option<LeafLiterals>> = vec![None; drafts.len()];
            forest.add(
                &read,
                &|leaf| {
                    let shape = &drafts[leaf - first];
                    if is_convex(shape) {
                        // Its gate decides its membership.
                        return Region::All(Vec::new());
                    }
                    shape.region.clone()
                },
                &mut |leaf, found| literals[leaf - first] = Some(found),
            );
            let extent = |leaf: usize| {
                let PlacedShape { shape, map } = &placed[leaf - first];
                let shape: &Shape = &shapes[*shape];
                (shape.extent, map)
            };
            let joint = JointSet {
                steps: &read,
                first,
                leaves: &placed,
                drafts: &drafts,
                shapes: &shapes,
                work: &joint_work,
            };
            let (all, clips) = joined(&read, &extent, &|limits| joint.bounds(limits));
            bounds.push(all.if_finite());
            leaves.reserve(placed.len());
            boxes.reserve(placed.len());
            let known = drafts.into_iter().zip(clips).zip(literals);
            for (PlacedShape { shape, map }, ((compiled, clip), literals)) in
                placed.into_iter().zip(known)
            {
                // Each leaf is a part of its tree.
                let Some(LeafLiterals { gate, pieces }) = literals else {
                    return Err(BuildError::Unbalanced(solid));
                };
                let is_field = |piece: &LeafSurface| matches!(piece, LeafSurface::Field(..));
                let fields = compiled.pieces.iter().any(is_field);
                let bounds = clip.if_finite().map(|bounds| bounds.with_room(ROOM));
                let ends = bounds.is_some();
                let bounds = bounds.or_else(|| fields.then(|| wide(&rest)));
                boxes.push(bounds);
                let world_from_unit = map * compiled.shape_from_unit;
                let count = compiled.pieces.len();
                leaves.push(Leaf {
                    solid,
                    shape,
                    compiled,
                    unit_from_world: world_from_unit.inverse(),
                    shape_from_world: map.inverse(),
                    bounded: shapes[shape].bounds().is_some(),
                    bounds,
                    ends,
                    gate,
                    pieces,
                    first_piece: piece_count,
                });
                piece_count += count;
            }
            solids.push(read);
        }
        let indices = 0..boxes.len() as u32;
        let boxed: Vec<u32> = indices
            .clone()
            .filter(|&k| boxes[k as usize].is_some_and(|bounds| !bounds.is_empty()))
            .collect();
        let endless = indices.filter(|&k| boxes[k as usize].is_none()).collect();
        let hierarchy = boxed.iter().filter_map(|&k| boxes[k as usize]).collect();
        let surfaces = share(&leaves, piece_count, &rest);
        let surface_of_piece = leaves
            .iter()
            .enumerate()
            .flat_map(|(leaf, of)| {
                (0..of.compiled.pieces.len()).map(move |piece| SurfaceId {
                    leaf: leaf as u32,
                    piece: piece as u32,
                })
            })
            .collect();
        let (products, product_of) =
            find_products(&solids, leaves.len(), &|leaf| is_simple(&leaves[leaf]));
        let all = 0..forest.len();
        let endless_solids = all.filter(|&solid| forest.is_endless(solid)).collect();
        Ok(World {
            shapes,
            forest,
            hierarchy: Hierarchy::new(hierarchy),
            boxed,
            endless,
            endless_solids,
            low: low_pieces(&leaves, &surfaces),
            convex: leaves
                .iter()
                .map(|leaf| is_convex(&leaf.compiled))
                .collect(),
            guards: solids.iter().flat_map(|steps| guards(steps)).collect(),
            products,
            product_of,
            leaves,
            surfaces,
            surface_of_piece,
            solids,
            bounds,
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
            let center = if rest.is_empty() {
                DVec3::ZERO
            } else {
                rest.lower
            };
            return BoundingBox {
                lower: center - 1.0,
                upper: center + 1.0,
            };
        }
        rest
    }
}

/// Reads each shape once.
struct FrameCache<'a> {
    compiler: &'a FieldCompiler<'a>,
    shapes: &'a [Shape],
    /// Half the side of the frames of shapes that determine none.
    size: f64,
    known: Vec<Option<Arc<FramedShape>>>,
}

impl FrameCache<'_> {
    fn compiled(&mut self, shape: usize) -> Result<Arc<FramedShape>, BuildError> {
        if let Some(known) = &self.known[shape] {
            return Ok(known.clone());
        }
        let compiled = self.shapes[shape].compile(self.compiler, self.size)?;
        let compiled = Arc::new(compiled);
        self.known[shape] = Some(compiled.clone());
        Ok(compiled)
    }
}

impl World {
    /// Returns a world without solids.
    pub fn empty() -> Self {
        Self {
            shapes: Vec::new(),
            leaves: Vec::new(),
            forest: Forest::default(),
            hierarchy: Hierarchy::new(Vec::new()),
            boxed: Vec::new(),
            endless: Vec::new(),
            endless_solids: Vec::new(),
            surfaces: Surfaces::default(),
            low: Vec::new(),
            convex: Vec::new(),
            guards: Vec::new(),
            products: Vec::new(),
            product_of: Vec::new(),
            surface_of_piece: Vec::new(),
            solids: Vec::new(),
            bounds: Vec::new(),
        }
    }

    /// Returns true if the leaf belongs to a product.
    pub(crate) fn is_in_product(&self, leaf: u32) -> bool {
        self.product_of[leaf as usize].is_some()
    }

    /// Returns the group of the surfaces that coincide with this one.
    pub(crate) fn group(&self, id: SurfaceId) -> Option<u32> {
        let piece = self.leaves[id.leaf as usize].first_piece + id.piece as usize;
        self.surfaces.group(piece).map(|member| member.group)
    }

    /// Returns the number of solids.
    pub fn solid_count(&self) -> usize {
        self.forest.len()
    }

    /// Returns the number of leaves of all solids; the leaves of a solid are consecutive, in the order of its steps.
    pub fn leaf_count(&self) -> usize {
        self.leaves.len()
    }

    /// Returns a box that contains the solid; `None` for an unbounded one, and if the boxes of its leaves do not bound it.
    pub fn bounds(&self, solid: usize) -> Option<BoundingBox> {
        self.bounds[solid]
    }

    /// Returns the highest degree of the polynomials that bound a leaf; `None` if a field bounds it.
    pub fn degree(&self, leaf: usize) -> Option<usize> {
        let mut highest = 0;
        for piece in &self.leaves[leaf].compiled.pieces {
            match piece {
                LeafSurface::Polynomial(surface) => highest = highest.max(surface.degree()),
                LeafSurface::Field(..) => return None,
            }
        }
        Some(highest)
    }

    /// Returns the work of [`World::contains`], in operations.
    pub(crate) fn work_on_point(&self, solid: usize) -> u64 {
        let work = |step: &TreeStep| match *step {
            TreeStep::Leaf(leaf) => {
                let shape = &self.shapes[self.leaves[leaf].shape];
                LEAF_WORK + shape.field.value_work()
            }
            _ => 1,
        };
        self.solids[solid].iter().map(work).sum()
    }

    /// Returns true if the solid contains the point, by the values of its leaves' expressions there.
    pub fn contains(&self, solid: usize, point: DVec3) -> bool {
        let mut scratch = FieldScratch::default();
        let mut stack: Vec<bool> = Vec::new();
        for step in &self.solids[solid] {
            if let TreeStep::Leaf(leaf) = *step {
                let leaf = &self.leaves[leaf];
                let at = leaf.shape_from_world.transform_point3(point);
                stack.push(self.shapes[leaf.shape].contains(&mut scratch, at));
            } else if let (Some(b), Some(a)) = (stack.pop(), stack.pop()) {
                stack.push(match step {
                    TreeStep::Union => a || b,
                    TreeStep::Intersection => a && b,
                    _ => a && !b,
                });
            }
        }
        stack.pop().unwrap_or(false)
    }
}

/// A set that is not an operand yet.
struct OpenSet<'a> {
    /// The step at which it ends.
    step: usize,
    /// Its box in the frame of its leaves, with their map, if they share one.
    in_frame: Option<(BoundingBox, &'a DAffine3)>,
}

/// Returns a box that contains a set, perhaps an infinite one: the union of both operands' boxes for a union, their
/// intersection for an intersection, the first operand's box for a difference. Also restricts the box of each leaf, outside
/// which the leaf does not matter, to the intersection of its own box and those of all sets that contain it.
///
/// Outside its box such a set is empty, whatever its unbounded leaves are taken to contain there: this holds for a union of
/// such sets, for an intersection with one of them, and for a difference from one.
///
/// If the box of the whole set is infinite, `joint` finds one within it.
fn joined<'a>(
    steps: &[TreeStep],
    leaf: &dyn Fn(usize) -> (BoundingBox, &'a DAffine3),
    joint: &dyn Fn(BoundingBox) -> BoundingBox,
) -> (BoundingBox, Vec<BoundingBox>) {
    // For each step the box of the set that ends there, and the steps at which its operands end.
    let mut sets: Vec<(BoundingBox, Option<[usize; 2]>)> = Vec::with_capacity(steps.len());
    let mut stack: Vec<OpenSet<'_>> = Vec::new();
    for (k, step) in steps.iter().enumerate() {
        let (set, operands, in_frame) = match *step {
            TreeStep::Leaf(place) => {
                let (extent, map) = leaf(place);
                (extent.transformed(map), None, Some((extent, map)))
            }
            _ => {
                let (Some(second), Some(first)) = (stack.pop(), stack.pop()) else {
                    break;
                };
                let join = |a: BoundingBox, b: BoundingBox| match step {
                    TreeStep::Union => a.union(&b),
                    TreeStep::Intersection => a.common(&b),
                    _ => a,
                };
                let set = join(sets[first.step].0, sets[second.step].0);
                let in_frame = first.in_frame.zip(second.in_frame);
                let in_frame = in_frame
                    .filter(|((_, map), (_, other))| map == other)
                    .map(|((a, map), (b, _))| (join(a, b), map));
                // In a rotated frame, two operands may both be unbounded along an axis along which their intersection is
                // bounded.
                let set = match (set.if_finite(), in_frame) {
                    (None, Some((extent, map))) => set.common(&extent.transformed(map)),
                    _ => set,
                };
                (set, Some([first.step, second.step]), in_frame)
            }
        };
        sets.push((set, operands));
        stack.push(OpenSet { step: k, in_frame });
    }
    if let Some((all, _)) = sets.last_mut()
        && all.if_finite().is_none()
    {
        *all = joint(*all);
    }
    let mut clips = vec![BoundingBox::WHOLE; sets.len()];
    for k in (0..sets.len()).rev() {
        let clip = clips[k].common(&sets[k].0);
        clips[k] = clip;
        for operand in sets[k].1.into_iter().flatten() {
            clips[operand] = clip;
        }
    }
    let leaves = steps.iter().zip(clips);
    let leaves = leaves.filter(|(step, _)| matches!(step, TreeStep::Leaf(_)));
    let whole = sets.last().map_or(BoundingBox::WHOLE, |set| set.0);
    (whole, leaves.map(|(_, clip)| clip).collect())
}

/// A solid whose leaves are examined as a whole.
struct JointSet<'a> {
    steps: &'a [TreeStep],
    /// The number of its first leaf.
    first: usize,
    leaves: &'a [PlacedShape],
    drafts: &'a [Arc<FramedShape>],
    shapes: &'a [Shape],
    work: &'a WorkBudget,
}

impl JointSet<'_> {
    /// Returns a box within `limits` that contains the solid; some of its sides may be infinite. No leaf needs to be
    /// bounded: a point is outside of an intersection if it is outside of one of its operands.
    fn bounds(&self, limits: BoundingBox) -> BoundingBox {
        if self.leaves.len() > MOST_JOINT_LEAVES {
            return limits;
        }
        let found = self.enclosed(limits);
        if found.if_finite().is_some() {
            return found;
        }
        // The known sides help to bound the rest.
        let ends = (0..3).flat_map(|k| [(k, 1.0, found.upper[k]), (k, -1.0, -found.lower[k])]);
        let ends = ends.filter(|(.., place)| place.is_finite());
        let ends = ends.map(|(k, sign, place)| {
            let mut slopes = [0.0; 3];
            slopes[k] = sign;
            Region::Polynomial(Polynomial::linear(-place, slopes))
        });
        let region = Region::All(ends.chain([self.region()]).collect());
        match joint_reach(&region, self.work) {
            Some(cube) => self.enclosed(found.common(&cube)),
            None => found,
        }
    }

    /// Returns the smallest box within `limits` that intervals find.
    fn enclosed(&self, limits: BoundingBox) -> BoundingBox {
        if limits.is_empty() {
            return limits;
        }
        let inverses: Vec<DAffine3> = self.leaves.iter().map(|leaf| leaf.map.inverse()).collect();
        let work = |leaf: &PlacedShape| LEAF_WORK + self.shapes[leaf.shape].field.value_work();
        let operations = self.leaves.iter().map(work).sum();
        let mut scratch = FieldScratch::default();
        let mut is_leaf_outside = |leaf: usize, place: &BoundingBox| {
            let shape = &self.shapes[self.leaves[leaf].shape];
            let place = place.transformed(&inverses[leaf]).common(&shape.extent);
            if place.is_empty() {
                return true;
            }
            let [lower, upper] = [place.lower.to_array(), place.upper.to_array()];
            let sides = [0, 1, 2].map(|k| Interval::new(lower[k], upper[k]));
            let value = shape.field.on_box(&mut scratch, sides);
            value.is_empty() || value.lower() > 0.0
        };
        let mut stack: Vec<bool> = Vec::new();
        let mut value = |sides: [Interval; 3]| {
            if !self.work.take(operations) {
                return Interval::WHOLE;
            }
            let place = BoundingBox {
                lower: DVec3::from_array(sides.map(Interval::lower)),
                upper: DVec3::from_array(sides.map(Interval::upper)),
            };
            stack.clear();
            for step in self.steps {
                let outside = match *step {
                    TreeStep::Leaf(leaf) => is_leaf_outside(leaf - self.first, &place),
                    _ => {
                        let second = stack.pop().unwrap_or_default();
                        let first = stack.pop().unwrap_or_default();
                        match step {
                            TreeStep::Union => first && second,
                            TreeStep::Intersection => first || second,
                            _ => first,
                        }
                    }
                };
                stack.push(outside);
            }
            match stack.last() {
                Some(true) => Interval::UNDEFINED,
                _ => Interval::WHOLE,
            }
        };
        let [lower, upper] = [limits.lower.to_array(), limits.upper.to_array()];
        let limits = [0, 1, 2].map(|k| Interval::new(lower[k], upper[k]));
        enclose(limits, &mut value)
    }

    /// Returns a region that contains the solid, in world coordinates.
    fn region(&self) -> Region {
        let mut stack: Vec<Region> = Vec::new();
        for step in self.steps {
            let set = match *step {
                TreeStep::Leaf(leaf) => {
                    let leaf = leaf - self.first;
                    let PlacedShape { shape, map } = &self.leaves[leaf];
                    let draft = &self.drafts[leaf];
                    let frame = coordinates(&(*map * draft.shape_from_unit).inverse());
                    moved(&draft.region, &frame, self.shapes[*shape].node)
                }
                _ => {
                    let (Some(second), Some(first)) = (stack.pop(), stack.pop()) else {
                        break;
                    };
                    match step {
                        TreeStep::Union => Region::Any(vec![first, second]),
                        TreeStep::Intersection => Region::All(vec![first, second]),
                        _ => first,
                    }
                }
            };
            stack.push(set);
        }
        stack.pop().unwrap_or(Region::Any(Vec::new()))
    }
}

/// Returns a region in other coordinates, without bounds from polynomials of a high degree.
fn moved(region: &Region, frame: &[Polynomial; 3], node: NodeId) -> Region {
    let all = |parts: &[Region]| parts.iter().map(|part| moved(part, frame, node)).collect();
    match region {
        Region::Polynomial(p) if p.degree() <= HIGHEST_JOINT => {
            Region::Polynomial(p.compose(frame))
        }
        Region::Polynomial(_) | Region::Field(..) => Region::Field(node, false),
        Region::All(parts) => Region::All(all(parts)),
        Region::Any(parts) => Region::Any(all(parts)),
    }
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

/// Returns the box within which unbounded fields are searched.
fn wide(rest: &BoundingBox) -> BoundingBox {
    let radius = 0.5 * (rest.upper - rest.lower).length();
    let center = rest.center();
    BoundingBox {
        lower: center - RADII * radius,
        upper: center + RADII * radius,
    }
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
