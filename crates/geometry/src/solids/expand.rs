//! Sets with their instances.
//!
//! In: a solid of a scene and the uniforms of one of its instances. Out: the steps of its set in postfix order, in which
//! each union over the values of grids is expanded, and each leaf has numbers for its uniforms.

use std::collections::HashMap;
use std::sync::Arc;

use expr::{Input, NodeId};
use glam::DAffine3;
use scene::{BoundGrid, Cut, Object, ParamValues, Scene, Solid, SolidStep};
use tracer::{BuildError, SetStep, ShapeId, WorldBuilder, is_singular};

use super::attributes::AffineTape;

/// A leaf with its numbers.
#[derive(Clone, Debug)]
pub(super) struct ExpandedLeaf {
    /// Its index in the solid's leaves.
    pub(super) leaf: u32,
    pub(super) uniforms: Arc<[f64]>,
    pub(super) map: DAffine3,
}

/// A step of a set whose leaves are indices into a list of expanded leaves.
#[derive(Clone, Copy, Debug)]
enum ExpandedStep {
    Leaf(u32),
    Union,
    Intersection,
    Difference,
}

/// A set without unions over grids.
#[derive(Clone, Debug, Default)]
pub(super) struct ExpandedSolid {
    steps: Vec<ExpandedStep>,
    pub(super) leaves: Vec<ExpandedLeaf>,
}

/// The reason why a solid, or an instance of it, is not drawn.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Omission {
    Singular { leaf: u32 },
    TooManyLeaves,
    TooLarge,
    TooMuchWork,
    Unbalanced,
}

impl From<BuildError> for Omission {
    fn from(error: BuildError) -> Self {
        match error {
            BuildError::TooMuchWork => Self::TooMuchWork,
            BuildError::TooLarge => Self::TooLarge,
            BuildError::SingularMap(_) | BuildError::Unbalanced(_) => Self::Unbalanced,
        }
    }
}

/// The remaining work, the next item last.
enum Work {
    /// The operand that ends at a step.
    Operand(usize, Arc<[f64]>),
    /// The instances of the operand that ends before a step, beginning with this one.
    Instances(usize, u64, Arc<[f64]>),
    Join(ExpandedStep),
}

/// Expands a solid.
pub(super) struct Expansion<'a> {
    pub(super) scene: &'a Scene,
    pub(super) params: &'a ParamValues,
    pub(super) object: &'a Object,
    pub(super) solid: &'a Solid,
    /// The maps of its leaves.
    pub(super) maps: Vec<AffineTape>,
    /// The number of leaves that may still be added.
    pub(super) room: usize,
}

/// Returns the grids over whose values a solid as a whole is a union.
pub fn instance_grids(solid: &Solid) -> &[BoundGrid] {
    match solid.steps.last() {
        Some(SolidStep::Instances(grids)) => grids,
        _ => &[],
    }
}

impl Expansion<'_> {
    /// Adds the instance with these uniforms and this combination of the solid's own grids; the solid is the union of all
    /// instances added.
    pub(super) fn add(
        &mut self,
        into: &mut ExpandedSolid,
        uniforms: &[f64],
        index: u64,
    ) -> Result<(), Omission> {
        let (steps, leaves) = (into.steps.len(), into.leaves.len());
        let grids = instance_grids(self.solid);
        let uniforms =
            self.params
                .with_combination(self.scene, self.object, grids, index, uniforms);
        let added = self.written(into, uniforms.into());
        match added {
            Ok(()) if steps > 0 => into.steps.push(ExpandedStep::Union),
            Ok(()) => {}
            Err(_) => {
                into.steps.truncate(steps);
                into.leaves.truncate(leaves);
            }
        }
        added
    }

    fn written(&mut self, into: &mut ExpandedSolid, uniforms: Arc<[f64]>) -> Result<(), Omission> {
        let steps = &self.solid.steps;
        // The start of the operand that ends at each step.
        let mut begins: Vec<usize> = Vec::with_capacity(steps.len());
        let before =
            |begins: &[usize], k: usize| begins[k].checked_sub(1).ok_or(Omission::Unbalanced);
        for (k, step) in steps.iter().enumerate() {
            let last = k.checked_sub(1).ok_or(Omission::Unbalanced);
            let begin = match step {
                SolidStep::Leaf(_) => k,
                SolidStep::Instances(_) => begins[last?],
                _ => begins[before(&begins, last?)?],
            };
            begins.push(begin);
        }
        let own = usize::from(!instance_grids(self.solid).is_empty());
        let last = steps.len().checked_sub(1 + own);
        let last = last.ok_or(Omission::Unbalanced)?;
        if begins[last] != 0 {
            return Err(Omission::Unbalanced);
        }
        let mut work = vec![Work::Operand(last, uniforms)];
        while let Some(next) = work.pop() {
            match next {
                Work::Join(step) => into.steps.push(step),
                Work::Operand(end, uniforms) => {
                    let join = match &steps[end] {
                        SolidStep::Leaf(leaf) => {
                            self.leaf(into, *leaf, uniforms)?;
                            continue;
                        }
                        SolidStep::Instances(_) => {
                            work.push(Work::Instances(end, 0, uniforms));
                            continue;
                        }
                        SolidStep::Union => ExpandedStep::Union,
                        SolidStep::Intersection => ExpandedStep::Intersection,
                        SolidStep::Difference => ExpandedStep::Difference,
                    };
                    work.push(Work::Join(join));
                    work.push(Work::Operand(end - 1, uniforms.clone()));
                    work.push(Work::Operand(begins[end - 1] - 1, uniforms));
                }
                Work::Instances(end, index, uniforms) => {
                    let SolidStep::Instances(grids) = &steps[end] else {
                        continue;
                    };
                    let count = self.params.combination_count(self.scene, grids);
                    if index + 1 < count {
                        work.push(Work::Instances(end, index + 1, uniforms.clone()));
                    }
                    if index > 0 {
                        work.push(Work::Join(ExpandedStep::Union));
                    }
                    let own = self.params.with_combination(
                        self.scene,
                        self.object,
                        grids,
                        index,
                        &uniforms,
                    );
                    work.push(Work::Operand(end - 1, own.into()));
                }
            }
        }
        Ok(())
    }

    fn leaf(
        &mut self,
        into: &mut ExpandedSolid,
        leaf: u32,
        uniforms: Arc<[f64]>,
    ) -> Result<(), Omission> {
        let map = self.maps.get(leaf as usize).ok_or(Omission::Unbalanced)?;
        let map = map.at(&uniforms);
        self.room = self.room.checked_sub(1).ok_or(Omission::TooManyLeaves)?;
        if is_singular(&map) {
            return Err(Omission::Singular { leaf });
        }
        into.steps
            .push(ExpandedStep::Leaf(into.leaves.len() as u32));
        into.leaves.push(ExpandedLeaf {
            leaf,
            uniforms,
            map,
        });
        Ok(())
    }
}

/// The shapes of a world by their definition, so that equal ones are shared.
#[derive(Default)]
pub(super) struct ShapeTable(HashMap<ShapeKey, Result<ShapeId, BuildError>>);

/// The field, the bits of the cuts, and those of the uniforms that the field reads.
type ShapeKey = (NodeId, [Option<[u64; 2]>; 3], Vec<u64>);

impl ShapeTable {
    fn shape(
        &mut self,
        builder: &mut WorldBuilder<'_>,
        inputs: &[u32],
        field: NodeId,
        cuts: &[Option<Cut>; 3],
        uniforms: &[f64],
    ) -> Result<ShapeId, BuildError> {
        let cuts = cuts.map(|cut| cut.map(|cut| [cut.range.min, cut.range.max]));
        let number = |k: u32| uniforms.get(k as usize).copied().unwrap_or(f64::NAN);
        let key = (
            field,
            cuts.map(|cut| cut.map(|ends| ends.map(f64::to_bits))),
            inputs.iter().map(|&k| number(k).to_bits()).collect(),
        );
        let known = self.0.entry(key);
        *known.or_insert_with(|| {
            builder.shape_with(field, cuts, &|input| match input {
                Input::Uniform(k) => number(k),
                Input::Variable(_) => f64::NAN,
            })
        })
    }
}

impl ExpandedSolid {
    /// Returns the minimum length of a mesh cell that the intervals of its leaves state, in the scene's units.
    pub(super) fn stated_cell(&self, solid: &Solid) -> Option<f64> {
        let cells = self.leaves.iter().flat_map(|expanded| {
            let cuts = &solid.leaves[expanded.leaf as usize].cuts;
            cuts.iter().enumerate().filter_map(move |(axis, cut)| {
                let cell = (*cut)?.cell()?;
                Some(cell * expanded.map.matrix3.col(axis).length())
            })
        });
        cells.reduce(f64::min)
    }

    /// Adds the solid to a world.
    pub(super) fn build(
        &self,
        scene: &Scene,
        solid: &Solid,
        builder: &mut WorldBuilder<'_>,
        shapes: &mut ShapeTable,
    ) -> Result<(), Omission> {
        let inputs: Vec<Vec<u32>> = solid
            .leaves
            .iter()
            .map(|leaf| {
                let inputs = scene.graph.inputs(&[leaf.field]).into_iter();
                let uniforms = inputs.filter_map(|input| match input {
                    Input::Uniform(k) => Some(k),
                    Input::Variable(_) => None,
                });
                uniforms.collect()
            })
            .collect();
        let ids = self.leaves.iter().map(|expanded| {
            let leaf = &solid.leaves[expanded.leaf as usize];
            let inputs = &inputs[expanded.leaf as usize];
            shapes.shape(builder, inputs, leaf.field, &leaf.cuts, &expanded.uniforms)
        });
        let ids: Vec<ShapeId> = ids.collect::<Result<_, BuildError>>()?;
        let steps = self.steps.iter().map(|step| match *step {
            ExpandedStep::Leaf(k) => SetStep::Leaf(ids[k as usize], self.leaves[k as usize].map),
            ExpandedStep::Union => SetStep::Union,
            ExpandedStep::Intersection => SetStep::Intersection,
            ExpandedStep::Difference => SetStep::Difference,
        });
        builder.solid(steps)?;
        Ok(())
    }
}
