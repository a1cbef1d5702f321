//! Boxes of sets whose leaves bound each other.
//!
//! In: the steps of a set, the known extent of each leaf. Out: a box that contains the set, and one for each leaf.

use std::sync::Arc;

use expr::NodeId;
use expr::interval::Interval;
use expr::polynomial::{Polynomial, Region};
use glam::{DAffine3, DVec3};

use super::LEAF_WORK;
use super::builder::PlacedShape;
use crate::bounds::{BoundingBox, WorkBudget, enclose};
use crate::field::FieldScratch;
use crate::region_bounds::joint_bounds;
use crate::shape::{FramedShape, Shape};
use crate::shared::coordinates;
use crate::tree::TreeStep;

/// Sets of more leaves are not examined as a whole, nor polynomials of a higher degree in world coordinates.
const MOST_JOINT_LEAVES: usize = 64;
const HIGHEST_JOINT: usize = 4;

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
pub(super) fn joined<'a>(
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
pub(super) struct JointSet<'a> {
    pub(super) steps: &'a [TreeStep],
    /// The number of its first leaf.
    pub(super) first: usize,
    pub(super) leaves: &'a [PlacedShape],
    pub(super) compiled: &'a [Arc<FramedShape>],
    pub(super) shapes: &'a [Shape],
    pub(super) work: &'a WorkBudget,
}

impl JointSet<'_> {
    /// Returns a box within `limits` that contains the solid; some of its sides may be infinite. No leaf needs to be
    /// bounded: a point is outside of an intersection if it is outside of one of its operands.
    pub(super) fn bounds(&self, limits: BoundingBox) -> BoundingBox {
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
        match joint_bounds(&region, self.work) {
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
                    let draft = &self.compiled[leaf];
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
