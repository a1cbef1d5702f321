//! Sets of chunks: most often one or two, sometimes nearly all.

use std::sync::Arc;

use super::sequence::ChunkId;

/// Chunks without an order. A clone costs next to nothing, and so does the first change after it.
#[derive(Clone, Debug)]
pub(super) enum ChunkSet {
    Few(Vec<ChunkId>),
    /// Sorted, in blocks of which none is empty.
    Many(Vec<Arc<Vec<ChunkId>>>),
}

/// The most chunks in a plain list.
const MAX_FEW: usize = 16;
/// The most chunks in a block.
const MAX_BLOCK: usize = 128;

impl Default for ChunkSet {
    fn default() -> Self {
        Self::Few(Vec::new())
    }
}

impl ChunkSet {
    pub(super) fn insert(&mut self, chunk: ChunkId) {
        match self {
            Self::Few(chunks) if chunks.contains(&chunk) => {}
            Self::Few(chunks) if chunks.len() < MAX_FEW => chunks.push(chunk),
            Self::Few(chunks) => {
                let mut all = std::mem::take(chunks);
                all.push(chunk);
                all.sort_unstable();
                *self = Self::Many(vec![Arc::new(all)]);
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
                    // What comes in order fills its blocks.
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
            Self::Few(chunks) => chunks.retain(|other| *other != chunk),
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
                    && only.len() < MAX_FEW / 2
                {
                    *self = Self::Few(only.to_vec());
                }
            }
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.iter().next().is_none()
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = ChunkId> + '_ {
        let (few, many) = match self {
            Self::Few(chunks) => (Some(chunks), None),
            Self::Many(blocks) => (None, Some(blocks)),
        };
        let many = many.into_iter().flatten().flat_map(|block| block.iter());
        few.into_iter().flatten().chain(many).copied()
    }
}

/// The block that holds a chunk, or would.
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
