//! Sets of chunks, usually of one or two, sometimes of nearly all.
//!
//! There are two sets for each name of a text, so a set of up to five chunks is stored inline, without an allocation.
//! Persistent sets of libraries (`imbl::OrdSet`) do not do this, and one allocation for each of 200,000 sets would cost more
//! than all their elements.

use std::sync::Arc;

use super::sequence::ChunkId;

/// A set of chunks. A clone shares its blocks, and the first change after it copies one block.
#[derive(Clone, Debug)]
pub(super) enum ChunkSet {
    /// The first `count` of these, in no particular order.
    Few {
        count: u8,
        chunks: [ChunkId; MAX_FEW],
    },
    /// Sorted, in nonempty blocks.
    Many(Box<Blocks>),
}

/// Consecutive parts of a sorted list.
type Blocks = Vec<Arc<Vec<ChunkId>>>;

/// The maximum number of chunks that take no more space than the pointer to a list and its tag.
const MAX_FEW: usize = 5;
/// The maximum number of chunks in a block.
const MAX_BLOCK: usize = 128;

impl Default for ChunkSet {
    fn default() -> Self {
        Self::few(&[])
    }
}

impl ChunkSet {
    /// Creates a set of at most [`MAX_FEW`] chunks.
    fn few(some: &[ChunkId]) -> Self {
        let mut chunks = [ChunkId(0); MAX_FEW];
        let count = some.len().min(MAX_FEW);
        chunks[..count].copy_from_slice(&some[..count]);
        Self::Few {
            count: count as u8,
            chunks,
        }
    }

    pub(super) fn insert(&mut self, chunk: ChunkId) {
        match self {
            Self::Few { count, chunks } => {
                let known = &chunks[..usize::from(*count)];
                if known.contains(&chunk) {
                    return;
                }
                if let Some(place) = chunks.get_mut(usize::from(*count)) {
                    *place = chunk;
                    *count += 1;
                    return;
                }
                let mut all = chunks.to_vec();
                all.push(chunk);
                all.sort_unstable();
                *self = Self::Many(Box::new(vec![Arc::new(all)]));
            }
            Self::Many(blocks) => {
                let index = block_of(blocks, chunk);
                let Some(block) = blocks.get_mut(index) else {
                    return;
                };
                let Err(place) = block.binary_search(&chunk) else {
                    return;
                };
                let block = Arc::make_mut(block);
                block.insert(place, chunk);
                if block.len() > MAX_BLOCK {
                    // Chunks that are inserted in order fill their blocks.
                    let middle = match place == MAX_BLOCK {
                        true => MAX_BLOCK,
                        false => MAX_BLOCK / 2,
                    };
                    let rest = block.split_off(middle);
                    blocks.insert(index + 1, Arc::new(rest));
                }
            }
        }
    }

    pub(super) fn remove(&mut self, chunk: ChunkId) {
        match self {
            Self::Few { count, chunks } => {
                let known = &mut chunks[..usize::from(*count)];
                if let (Some(place), Some(last)) = (
                    known.iter().position(|other| *other == chunk),
                    known.len().checked_sub(1),
                ) {
                    known.swap(place, last);
                    *count -= 1;
                }
            }
            Self::Many(blocks) => {
                let index = block_of(blocks, chunk);
                let Some(block) = blocks.get_mut(index) else {
                    return;
                };
                let Ok(place) = block.binary_search(&chunk) else {
                    return;
                };
                let block = Arc::make_mut(block);
                block.remove(place);
                if block.is_empty() {
                    blocks.remove(index);
                }
                if let [only] = &blocks[..]
                    && only.len() <= MAX_FEW / 2
                {
                    *self = Self::few(only);
                }
            }
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.iter().next().is_none()
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = ChunkId> + '_ {
        let (few, many) = match self {
            Self::Few { count, chunks } => (&chunks[..usize::from(*count)], None),
            Self::Many(blocks) => (&[][..], Some(blocks)),
        };
        let many = many.into_iter().flat_map(|blocks| blocks.iter());
        few.iter()
            .chain(many.flat_map(|block| block.iter()))
            .copied()
    }
}

/// Returns the block that contains a chunk, or into which it would be inserted.
fn block_of(blocks: &[Arc<Vec<ChunkId>>], chunk: ChunkId) -> usize {
    let after = blocks.partition_point(|block| block.first().is_some_and(|it| *it <= chunk));
    after.saturating_sub(1)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::{ChunkId, ChunkSet};

    #[test]
    fn it_agrees_with_a_plain_set_on_random_changes_and_leaves_its_clones_alone() {
        let (mut set, mut plain) = (ChunkSet::default(), BTreeSet::new());
        let mut seed = 5_u64;
        let mut random = |below: u64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) % below
        };
        let mut kept = Vec::new();
        for round in 0..20_000 {
            let chunk = ChunkId(random(700) as u32);
            // It grows and shrinks in turn.
            if random(10) < if round / 4_000 % 2 == 0 { 7 } else { 2 } {
                set.insert(chunk);
                plain.insert(chunk);
            } else {
                set.remove(chunk);
                plain.remove(&chunk);
            }
            assert_eq!(set.is_empty(), plain.is_empty());
            if round % 500 == 0 {
                kept.push((set.clone(), plain.clone()));
            }
        }
        kept.push((set, plain));
        for (set, plain) in kept {
            let mut chunks: Vec<_> = set.iter().collect();
            chunks.sort_unstable();
            assert!(chunks.iter().eq(&plain));
        }
    }
}
