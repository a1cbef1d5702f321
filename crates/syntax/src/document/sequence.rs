//! The chunks of a document in order: a balanced tree with sums.
//!
//! In: a chunk's handle with its measure (bytes, lines, …), inserted after another. Out: the chunk at an offset, the
//! offset of a chunk, and the order of two chunks, each in logarithmic time. It is a B⁺-tree whose inner nodes hold the
//! sums of their children; each chunk knows its leaf and each node its parent, so that a chunk's position is found from
//! below.
//!
//! The trees of `crop` and `ropey` have sums too, but they are private and hold text: they cannot find the position of an
//! element from its handle, which every query about a chunk requires.

use std::ops::{Add, AddAssign, Sub};
use std::sync::Arc;

use crate::persistent_vector::PersistentVector;

/// Identifies a chunk of a document. Once the chunk is removed, a new one may reuse the handle.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct ChunkId(pub(super) u32);

/// The measure of a chunk, or its sum over chunks.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub(super) struct Measure {
    /// The number of chunks.
    pub(super) chunks: u32,
    /// The number of bytes of their texts.
    pub(super) bytes: u32,
    /// The number of line ends in their texts.
    pub(super) lines: u32,
    /// The number of Unicode scalar values in their texts.
    pub(super) characters: u32,
    /// The number of diagnostics from reading them.
    pub(super) diagnostics: u32,
    /// The number of those diagnostics that search all names.
    pub(super) searches: u32,
    /// The number of tokens.
    pub(super) tokens: u32,
    /// The number of declarations.
    pub(super) declarations: u32,
}

/// The chunks in order.
#[derive(Clone, Debug)]
pub(super) struct Sequence {
    nodes: PersistentVector<Arc<TreeNode>>,
    free: Vec<u32>,
    root: u32,
    /// The leaf of each chunk, by its handle.
    leaves: PersistentVector<u32>,
}

#[derive(Clone, Debug)]
struct TreeNode {
    parent: u32,
    is_leaf: bool,
    /// The chunks of a leaf or the children of an inner node, each with its sum.
    items: Vec<(u32, Measure)>,
}

/// The maximum number of items of a node.
const MAX_ITEMS: usize = 32;
/// A node with fewer items is joined with a neighbour if both fit into one.
const MIN_ITEMS: usize = MAX_ITEMS / 4;
/// The parent of the root.
const NONE: u32 = u32::MAX;

impl Default for Sequence {
    fn default() -> Self {
        let mut nodes = PersistentVector::default();
        nodes.push(Arc::new(TreeNode {
            parent: NONE,
            is_leaf: true,
            items: Vec::new(),
        }));
        Self {
            nodes,
            free: Vec::new(),
            root: 0,
            leaves: PersistentVector::default(),
        }
    }
}

impl Sequence {
    /// Returns the sum over all chunks.
    pub(super) fn total(&self) -> Measure {
        sum(&self.nodes[self.root as usize].items)
    }

    pub(super) fn first(&self) -> Option<ChunkId> {
        let mut node = &self.nodes[self.root as usize];
        while !node.is_leaf {
            node = &self.nodes[node.items.first()?.0 as usize];
        }
        node.items.first().map(|item| ChunkId(item.0))
    }

    /// Returns the chunk that contains the byte at this offset, or the last one, with the sum of all chunks before it.
    pub(super) fn at_byte(&self, offset: u32) -> Option<(ChunkId, Measure)> {
        self.find(|before| before.bytes <= offset)
    }

    /// Returns the first chunk in which `lines` line ends are reached, or the last one, with the sum of all chunks
    /// before it.
    pub(super) fn at_line_end(&self, lines: u32) -> Option<(ChunkId, Measure)> {
        self.find(|before| before.lines < lines)
    }

    /// Returns the chunk that contains this character, counted from 0, or the last one, with the sum of all chunks
    /// before it.
    pub(super) fn at_character(&self, character: u32) -> Option<(ChunkId, Measure)> {
        self.find(|before| before.characters <= character)
    }

    /// Returns the chunk that contains this diagnostic, counted from 0, with the sum of all chunks before it.
    pub(super) fn at_diagnostic(&self, number: u32) -> Option<(ChunkId, Measure)> {
        self.find(|before| before.diagnostics <= number)
    }

    /// Returns the chunk that contains this token, counted from 0, or the last one, with the sum of all chunks before
    /// it.
    pub(super) fn at_token(&self, token: u32) -> Option<(ChunkId, Measure)> {
        self.find(|before| before.tokens <= token)
    }

    /// Returns the chunk that contains this declaration, counted from 0, or the last one, with the sum of all chunks
    /// before it.
    pub(super) fn at_declaration(&self, declaration: u32) -> Option<(ChunkId, Measure)> {
        self.find(|before| before.declarations <= declaration)
    }

    /// Finds the last chunk whose preceding sum still satisfies `holds`, a monotone predicate that holds for the empty sum.
    /// Returns it with that sum.
    fn find(&self, holds: impl Fn(&Measure) -> bool) -> Option<(ChunkId, Measure)> {
        let mut before = Measure::default();
        let mut node = &self.nodes[self.root as usize];
        loop {
            let mut chosen = node.items.first()?.0;
            let mut at = before;
            let mut sum = before;
            for (item, measure) in &node.items {
                if !holds(&sum) {
                    break;
                }
                (chosen, at) = (*item, sum);
                sum += *measure;
            }
            before = at;
            if node.is_leaf {
                return Some((ChunkId(chosen), before));
            }
            node = &self.nodes[chosen as usize];
        }
    }

    /// Returns the sum of all chunks before this one.
    pub(super) fn before(&self, chunk: ChunkId) -> Measure {
        let mut before = Measure::default();
        let mut item = chunk.0;
        let mut at = self.leaves[chunk.0 as usize];
        while at != NONE {
            let node = &self.nodes[at as usize];
            for (other, measure) in &node.items {
                if *other == item {
                    break;
                }
                before += *measure;
            }
            (item, at) = (at, node.parent);
        }
        before
    }

    /// Returns the number of chunks before this one.
    pub(super) fn rank(&self, chunk: ChunkId) -> u32 {
        self.before(chunk).chunks
    }

    pub(super) fn next(&self, chunk: ChunkId) -> Option<ChunkId> {
        let mut item = chunk.0;
        let mut at = self.leaves[chunk.0 as usize];
        while at != NONE {
            let node = &self.nodes[at as usize];
            if let Some(&(mut next, _)) = node.items.get(node.index(item) + 1) {
                let mut is_leaf = node.is_leaf;
                while !is_leaf {
                    let child = &self.nodes[next as usize];
                    is_leaf = child.is_leaf;
                    next = child.items.first()?.0;
                }
                return Some(ChunkId(next));
            }
            (item, at) = (at, node.parent);
        }
        None
    }

    /// Returns all chunks from `first` on.
    pub(super) fn from(&self, first: Option<ChunkId>) -> impl Iterator<Item = ChunkId> + '_ {
        std::iter::successors(first, |chunk| self.next(*chunk))
    }

    /// Inserts a new chunk after another, or at the front.
    pub(super) fn insert(&mut self, after: Option<ChunkId>, chunk: ChunkId, measure: Measure) {
        let (leaf, index) = match after {
            Some(after) => {
                let leaf = self.leaves[after.0 as usize];
                (leaf, self.nodes[leaf as usize].index(after.0) + 1)
            }
            None => {
                let mut leaf = self.root;
                while let node = &self.nodes[leaf as usize]
                    && !node.is_leaf
                    && let Some((first, _)) = node.items.first()
                {
                    leaf = *first;
                }
                (leaf, 0)
            }
        };
        self.leaves.set(chunk.0 as usize, leaf, NONE);
        let items = &mut self.node_mut(leaf).items;
        let is_last = index == items.len();
        items.insert(index, (chunk.0, measure));
        let highest = self.split(leaf, is_last);
        self.add_above(highest, measure);
    }

    pub(super) fn remove(&mut self, chunk: ChunkId) {
        // Remove it from the sums above.
        self.measure(chunk, Measure::default());
        let leaf = self.leaves[chunk.0 as usize];
        self.leaves.set(chunk.0 as usize, NONE, NONE);
        self.remove_item(leaf, chunk.0);
    }

    /// Sets the measure of a chunk.
    pub(super) fn measure(&mut self, chunk: ChunkId, measure: Measure) {
        let leaf = self.leaves[chunk.0 as usize];
        let node = self.node_mut(leaf);
        let index = node.index(chunk.0);
        let before = std::mem::replace(&mut node.items[index].1, measure);
        if before != measure {
            self.add_above(leaf, measure - before);
        }
    }

    /// Adds to the sums above a node.
    fn add_above(&mut self, mut at: u32, more: Measure) {
        loop {
            let parent = self.nodes[at as usize].parent;
            if parent == NONE {
                return;
            }
            let above = self.node_mut(parent);
            let index = above.index(at);
            above.items[index].1 += more;
            at = parent;
        }
    }

    /// Splits a node that is too large, and then its ancestors as long as they become too large. Returns the highest node
    /// that has a new item: the sums above it do not include the new item yet.
    ///
    /// `is_last` is true if the new item is the node's last: then the node keeps all its other items, so that a text that
    /// is read from top to bottom fills its nodes instead of leaving them half empty.
    fn split(&mut self, mut at: u32, mut is_last: bool) -> u32 {
        while self.nodes[at as usize].items.len() > MAX_ITEMS {
            let node = self.node_mut(at);
            let middle = match is_last {
                true => MAX_ITEMS,
                false => node.items.len() / 2,
            };
            let items = node.items.split_off(middle);
            let (is_leaf, mut parent) = (node.is_leaf, node.parent);
            let left_sum = sum(&node.items);
            let right_sum = sum(&items);
            if parent == NONE {
                parent = self.allocate(TreeNode {
                    parent: NONE,
                    is_leaf: false,
                    items: vec![(at, left_sum)],
                });
                self.node_mut(at).parent = parent;
                self.root = parent;
            }
            let right = self.allocate(TreeNode {
                parent,
                is_leaf,
                items,
            });
            self.adopt(right);
            let above = self.node_mut(parent);
            let index = above.index(at);
            above.items[index].1 = left_sum;
            is_last &= index + 1 == above.items.len();
            above.items.insert(index + 1, (right, right_sum));
            at = parent;
        }
        at
    }

    /// Makes a node the leaf or parent of its items.
    fn adopt(&mut self, at: u32) {
        let node = self.nodes[at as usize].clone();
        for (item, _) in &node.items {
            match node.is_leaf {
                true => self.leaves.set(*item as usize, at, NONE),
                false => self.node_mut(*item).parent = at,
            }
        }
    }

    /// Removes an item that the sums above the node no longer include.
    fn remove_item(&mut self, at: u32, item: u32) {
        let node = self.node_mut(at);
        let index = node.index(item);
        node.items.remove(index);
        let (count, parent) = (node.items.len(), node.parent);
        if parent == NONE {
            // A root with a single child is replaced by it.
            while let node = &self.nodes[self.root as usize]
                && !node.is_leaf
                && let [(only, _)] = node.items[..]
            {
                self.free.push(self.root);
                self.root = only;
                self.node_mut(only).parent = NONE;
            }
            return;
        }
        if count == 0 {
            self.free.push(at);
            self.remove_item(parent, at);
            return;
        }
        if count < MIN_ITEMS {
            self.join(at, parent);
        }
    }

    /// Joins a small node with a neighbour if one node can hold the items of both.
    fn join(&mut self, at: u32, parent: u32) {
        let above = &self.nodes[parent as usize];
        let index = above.index(at);
        let neighbours = [
            index.checked_sub(1).map(|left| (left, index)),
            Some((index, index + 1)),
        ];
        for (place, next) in neighbours.into_iter().flatten() {
            let (Some(&(left, _)), Some(&(right, more))) =
                (above.items.get(place), above.items.get(next))
            else {
                continue;
            };
            let count = |node: u32| self.nodes[node as usize].items.len();
            if count(left) + count(right) > MAX_ITEMS {
                continue;
            }
            let moved = std::mem::take(&mut self.node_mut(right).items);
            self.node_mut(parent).items[place].1 += more;
            self.node_mut(left).items.extend(moved);
            self.adopt(left);
            self.free.push(right);
            self.remove_item(parent, right);
            return;
        }
    }

    fn node_mut(&mut self, at: u32) -> &mut TreeNode {
        let node = self.nodes.get_mut(at as usize);
        Arc::make_mut(node.expect("a node of this tree"))
    }

    fn allocate(&mut self, node: TreeNode) -> u32 {
        match self.free.pop() {
            Some(index) => {
                *self.node_mut(index) = node;
                index
            }
            None => {
                self.nodes.push(Arc::new(node));
                self.nodes.len() as u32 - 1
            }
        }
    }
}

impl TreeNode {
    /// Returns the position of an item, which the node must contain.
    fn index(&self, item: u32) -> usize {
        // Search from the end: a text that is read from top to bottom changes the last item.
        let index = self.items.iter().rposition(|(other, _)| *other == item);
        debug_assert!(index.is_some(), "a node holds what names it as its parent");
        index.unwrap_or_default()
    }
}

fn sum(items: &[(u32, Measure)]) -> Measure {
    items
        .iter()
        .fold(Measure::default(), |sum, (_, measure)| sum + *measure)
}

impl Measure {
    /// Combines two measures count by count.
    fn with(self, other: Self, together: impl Fn(u32, u32) -> u32) -> Self {
        Self {
            chunks: together(self.chunks, other.chunks),
            bytes: together(self.bytes, other.bytes),
            lines: together(self.lines, other.lines),
            characters: together(self.characters, other.characters),
            diagnostics: together(self.diagnostics, other.diagnostics),
            searches: together(self.searches, other.searches),
            tokens: together(self.tokens, other.tokens),
            declarations: together(self.declarations, other.declarations),
        }
    }
}

/// A negative difference wraps around, and so does a sum with it.
impl Add for Measure {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.with(other, u32::wrapping_add)
    }
}

impl Sub for Measure {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.with(other, u32::wrapping_sub)
    }
}

impl AddAssign for Measure {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

#[cfg(test)]
mod tests {
    use super::{ChunkId, MAX_ITEMS, MIN_ITEMS, Measure, Sequence};

    fn measure(bytes: u32) -> Measure {
        Measure {
            chunks: 1,
            bytes,
            lines: bytes % 3,
            ..Measure::default()
        }
    }

    #[test]
    fn it_agrees_with_a_list_on_random_insertions_removals_and_changes() {
        let mut sequence = Sequence::default();
        let mut list: Vec<(ChunkId, u32)> = Vec::new();
        let mut seed = 1_u64;
        let mut random = |below: usize| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) as usize % below
        };
        let mut fresh = 0;
        for round in 0..6_000 {
            // It grows, then shrinks to nothing, then grows again.
            let growing = !(2_500..=5_200).contains(&round);
            let bytes = 1 + random(9) as u32;
            match random(4) {
                0 | 1 if growing || list.is_empty() => {
                    let index = random(list.len() + 1);
                    let after = index.checked_sub(1).map(|index| list[index].0);
                    let chunk = ChunkId(fresh);
                    fresh += 1;
                    sequence.insert(after, chunk, measure(bytes));
                    list.insert(index, (chunk, bytes));
                }
                2 if !list.is_empty() => {
                    let index = random(list.len());
                    list[index].1 = bytes;
                    sequence.measure(list[index].0, measure(bytes));
                }
                _ if !list.is_empty() && (!growing || random(4) == 0) => {
                    let index = random(list.len());
                    sequence.remove(list.remove(index).0);
                }
                _ => {}
            }
            let total: u32 = list.iter().map(|item| item.1).sum();
            assert_eq!(sequence.total().bytes, total);
            assert_eq!(sequence.first(), list.first().map(|item| item.0));
            if let Some(index) = (!list.is_empty()).then(|| random(list.len())) {
                let before: u32 = list[..index].iter().map(|item| item.1).sum();
                let (chunk, bytes) = list[index];
                assert_eq!(sequence.before(chunk).bytes, before);
                assert_eq!(sequence.rank(chunk), index as u32);
                assert_eq!(sequence.next(chunk), list.get(index + 1).map(|next| next.0));
                let inside = before + random(bytes as usize) as u32;
                let found = sequence
                    .at_byte(inside)
                    .map(|(chunk, at)| (chunk, at.bytes));
                assert_eq!(found, Some((chunk, before)));
                let lines: u32 = list[..index].iter().map(|item| item.1 % 3).sum();
                if bytes % 3 > 0 {
                    let found = sequence.at_line_end(lines + 1).map(|(chunk, _)| chunk);
                    assert_eq!(found, Some(chunk));
                }
            }
            if round % 500 == 0 {
                let all: Vec<_> = sequence.from(sequence.first()).collect();
                assert_eq!(all, list.iter().map(|item| item.0).collect::<Vec<_>>());
            }
        }
        assert!(fresh as usize > 20 * MAX_ITEMS);
    }

    #[test]
    fn what_is_left_after_removals_lies_in_few_nodes() {
        let mut sequence = Sequence::default();
        let count = 4_000_u32;
        for k in 0..count {
            let after = k.checked_sub(1).map(ChunkId);
            sequence.insert(after, ChunkId(k), measure(1));
        }
        let used = |sequence: &Sequence| sequence.nodes.len() - sequence.free.len();
        let before = used(&sequence);
        assert!(before > 4_000 / MAX_ITEMS, "{before}");
        let kept: Vec<ChunkId> = (0..count).step_by(50).map(ChunkId).collect();
        for k in (0..count).filter(|k| k % 50 != 0) {
            sequence.remove(ChunkId(k));
        }
        let all: Vec<ChunkId> = sequence.from(sequence.first()).collect();
        assert_eq!(all, kept);
        // Of two leaves beside each other that could be one, one is as full as it may be while it is left alone.
        let most = kept.len() / MIN_ITEMS;
        assert!(used(&sequence) <= most, "{} of {before}", used(&sequence));
    }
}
