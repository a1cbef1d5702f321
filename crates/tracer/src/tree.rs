//! Trees of set operations with incremental updates, leaf by leaf.
//!
//! In: set operations in postfix order. Out: a forest of unions and intersections of any number of parts, with complements
//! only at the leaves; for each member of a leaf's region, the [`Literal`] that locates it in the tree. A change of a member
//! costs one step for each level that changes with it, whatever the number of leaves. Nothing recurses on the depth of a
//! tree.

use std::ops::Range;

use expr::polynomial::Region;

use crate::bounds::BoundingBox;

/// A step of a set expression in postfix order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TreeStep {
    /// A leaf, by its index.
    Leaf(usize),
    Union,
    Intersection,
    Difference,
}

/// A union or an intersection.
#[derive(Clone, Copy, Debug)]
struct SetNode {
    is_union: bool,
    /// The parent; [`NONE`] for a root.
    parent: u32,
    /// The solid, for a root.
    solid: u32,
    parts: u32,
    /// The number of parts that hold if every leaf is outside.
    holding: u32,
}

const NONE: u32 = u32::MAX;

/// The node that a member of a leaf belongs to, and whether it is complemented there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Literal {
    node: u32,
    complemented: bool,
}

/// A node of a component's tree, as in [`World::tables`](crate::World::tables).
#[derive(Clone, Copy, Debug)]
pub struct NodeRow {
    /// True for a union, false for an intersection.
    pub is_union: bool,
    /// Its parent, counted from the component's first node; `None` for that node.
    pub parent: Option<u32>,
    /// The number of its parts.
    pub parts: u32,
    /// The number of parts that hold if every leaf is outside.
    pub holding: u32,
}

/// The literals of a leaf.
#[derive(Clone, Debug)]
pub(crate) struct LeafLiterals {
    /// True where a ray may meet the leaf.
    pub(crate) gate: Literal,
    /// The literals of the polynomials and fields of its region, in order.
    pub(crate) pieces: Vec<Literal>,
}

/// All trees of a world.
#[derive(Clone, Debug, Default)]
pub(crate) struct Forest {
    nodes: Vec<SetNode>,
    roots: Vec<u32>,
}

/// The state of a forest on a ray.
#[derive(Debug, Default)]
pub(crate) struct ForestState {
    holding: Vec<u32>,
    /// The nodes that differ from the state with every leaf outside; may have repetitions.
    touched: Vec<u32>,
    /// The solids whose membership has changed; may have repetitions.
    pub(crate) changed: Vec<u32>,
}

impl Forest {
    /// Adds a solid. `regions` gives each leaf's region; `literals` receives the literals of each leaf.
    pub(crate) fn add(
        &mut self,
        steps: &[TreeStep],
        regions: &dyn Fn(usize) -> Region,
        literals: &mut dyn FnMut(usize, LeafLiterals),
    ) {
        let solid = self.roots.len() as u32;
        let root = self.push(false, NONE, solid);
        self.roots.push(root);
        // For each step, the beginning of the operand that ends there.
        let mut begins: Vec<usize> = Vec::with_capacity(steps.len());
        for (k, step) in steps.iter().enumerate() {
            begins.push(match step {
                TreeStep::Leaf(_) => k,
                _ if k > 0 && begins[k - 1] > 0 => begins[begins[k - 1] - 1],
                // Too few operands: an empty set.
                _ => k,
            });
        }
        // The step at which an operand ends, the node that it belongs to, and true if it is complemented.
        let mut stack: Vec<(usize, u32, bool)> = Vec::new();
        if let Some(last) = steps.len().checked_sub(1) {
            stack.push((last, root, false));
        } else {
            self.push(true, root, NONE);
        }
        while let Some((end, parent, complemented)) = stack.pop() {
            let step = steps[end];
            if let TreeStep::Leaf(leaf) = step {
                literals(leaf, self.leaf(&regions(leaf), parent, complemented));
                continue;
            }
            if begins[end] == end {
                self.push(!complemented, parent, NONE);
                continue;
            }
            let is_union = (step == TreeStep::Union) != complemented;
            let node = if self.nodes[parent as usize].is_union == is_union {
                parent
            } else {
                self.push(is_union, parent, NONE)
            };
            let second = end - 1;
            let first = begins[second] - 1;
            stack.push((second, node, complemented != (step == TreeStep::Difference)));
            stack.push((first, node, complemented));
        }
        self.settle(root);
    }

    /// Returns the number of solids.
    pub(crate) fn len(&self) -> usize {
        self.roots.len()
    }

    /// Returns true if the solid contains the points that no leaf contains.
    pub(crate) fn is_endless(&self, solid: usize) -> bool {
        let root = &self.nodes[self.roots[solid] as usize];
        root.holds(root.holding)
    }

    fn leaf(&mut self, region: &Region, parent: u32, complemented: bool) -> LeafLiterals {
        // The gate and the region, or the complement of both.
        let node = self.push(complemented, parent, NONE);
        let gate = self.literal(node, complemented);
        let mut pieces = Vec::new();
        self.region(region, node, complemented, &mut pieces);
        LeafLiterals { gate, pieces }
    }

    /// The nesting depth of a region is at most the number of its pieces, which is small.
    fn region(
        &mut self,
        region: &Region,
        parent: u32,
        complemented: bool,
        pieces: &mut Vec<Literal>,
    ) {
        let (parts, is_union) = match region {
            Region::Polynomial(_) | Region::Field(..) => {
                pieces.push(self.literal(parent, complemented));
                return;
            }
            Region::All(parts) => (parts, complemented),
            Region::Any(parts) => (parts, !complemented),
        };
        let node = self.push(is_union, parent, NONE);
        for part in parts {
            self.region(part, node, complemented, pieces);
        }
    }

    fn literal(&mut self, node: u32, complemented: bool) -> Literal {
        let place = &mut self.nodes[node as usize];
        place.parts += 1;
        place.holding += u32::from(complemented);
        Literal { node, complemented }
    }

    fn push(&mut self, is_union: bool, parent: u32, solid: u32) -> u32 {
        if parent != NONE {
            self.nodes[parent as usize].parts += 1;
        }
        self.nodes.push(SetNode {
            is_union,
            parent,
            solid,
            parts: 0,
            holding: 0,
        });
        (self.nodes.len() - 1) as u32
    }

    /// Counts the parts of nodes that hold if every leaf is outside: children come after their parents.
    fn settle(&mut self, root: u32) {
        for k in (root as usize..self.nodes.len()).rev() {
            let node = self.nodes[k];
            if node.parent != NONE && node.holds(node.holding) {
                self.nodes[node.parent as usize].holding += 1;
            }
        }
    }
}

/// Trees as tables.
impl Forest {
    /// Returns the node ranges of the components of a solid: one for each part of a union, otherwise one for the whole
    /// solid.
    pub(crate) fn components(&self, solid: usize) -> Vec<Range<usize>> {
        let root = self.roots[solid] as usize;
        let next = self.roots.get(solid + 1);
        let end = next.map_or(self.nodes.len(), |&next| next as usize);
        let union = root + 1;
        let is_alone = self.nodes[root].parts == 1;
        if !(is_alone && union < end && self.nodes[union].is_union) {
            return std::iter::once(root..end).collect();
        }
        // The nodes of a part are consecutive.
        let is_part = |k: &usize| self.nodes[*k].parent as usize == union;
        let first: Vec<usize> = (union + 1..end).filter(is_part).collect();
        let ends = first.iter().skip(1).copied().chain([end]);
        let parts = first.iter().copied().zip(ends);
        parts.map(|(first, end)| first..end).collect()
    }

    /// Returns the nodes of a component.
    pub(crate) fn rows(&self, component: Range<usize>) -> impl Iterator<Item = NodeRow> {
        let first = component.start;
        self.nodes[component].iter().map(move |node| NodeRow {
            is_union: node.is_union,
            parent: match node.parent {
                NONE => None,
                parent => (parent as usize).checked_sub(first).map(|k| k as u32),
            },
            parts: node.parts,
            holding: node.holding,
        })
    }

    /// Returns for each node its box without parts: the empty box for a union, `None` for an intersection.
    pub(crate) fn whole_boxes(&self) -> Vec<Option<BoundingBox>> {
        let whole = |node: &SetNode| node.is_union.then_some(BoundingBox::EMPTY);
        self.nodes.iter().map(whole).collect()
    }

    /// Combines the box of each node with those of its parts that are nodes.
    pub(crate) fn fold_boxes(&self, boxes: &mut [Option<BoundingBox>]) {
        // Children come after their parents.
        for k in (0..self.nodes.len()).rev() {
            let parent = self.nodes[k].parent;
            if parent == NONE {
                continue;
            }
            let parent = parent as usize;
            boxes[parent] = match (self.nodes[parent].is_union, boxes[parent], boxes[k]) {
                (true, Some(all), Some(part)) => Some(all.union(&part)),
                (true, ..) => None,
                (false, Some(all), Some(part)) => Some(all.common(&part)),
                (false, all, part) => all.or(part),
            };
        }
    }
}

impl Literal {
    /// Returns the node, counted over the forest.
    pub(crate) fn node(self) -> u32 {
        self.node
    }

    /// Returns true if it counts where it does not hold.
    pub(crate) fn is_complemented(self) -> bool {
        self.complemented
    }
}

impl SetNode {
    fn holds(&self, holding: u32) -> bool {
        if self.is_union {
            holding > 0
        } else {
            holding == self.parts
        }
    }
}

impl ForestState {
    /// Restores the state with every leaf outside.
    pub(crate) fn reset(&mut self, forest: &Forest) {
        if self.holding.len() != forest.nodes.len() {
            self.holding = forest.nodes.iter().map(|node| node.holding).collect();
        }
        for &node in &self.touched {
            self.holding[node as usize] = forest.nodes[node as usize].holding;
        }
        self.touched.clear();
        self.changed.clear();
    }

    /// Returns the work since the last reset, in operations; the work on a node is mostly memory latency.
    pub(crate) fn operations(&self) -> u64 {
        4 * self.touched.len() as u64
    }

    /// Changes the membership of a literal, which must differ, to `inside`.
    pub(crate) fn set(&mut self, forest: &Forest, literal: Literal, inside: bool) {
        let mut rises = inside != literal.complemented;
        let mut id = literal.node;
        loop {
            let node = &forest.nodes[id as usize];
            let holding = &mut self.holding[id as usize];
            let before = node.holds(*holding);
            if rises {
                *holding += 1;
            } else {
                *holding -= 1;
            }
            let after = node.holds(*holding);
            self.touched.push(id);
            if before == after {
                return;
            }
            if node.parent == NONE {
                self.changed.push(node.solid);
                return;
            }
            rises = after;
            id = node.parent;
        }
    }

    /// Returns true inside the solid.
    pub(crate) fn inside(&self, forest: &Forest, solid: usize) -> bool {
        let root = forest.roots[solid] as usize;
        forest.nodes[root].holds(self.holding[root])
    }
}
