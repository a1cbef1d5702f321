//! The look-ups that chunks make in the names above them, and the index of the words that a new name would change.

use std::collections::BTreeMap;
use std::ops::Bound;

use super::chunk_set::ChunkSet;
use super::names::NameId;
use super::sequence::ChunkId;

/// A look-up made in the names above while a chunk was read.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub(super) enum Lookup {
    /// A token is this name, which the text declares.
    Used(NameId),
    /// The chunk's text from `start` to `end` was looked up. Any name longer than `length` at the start of it would
    /// have changed the reading.
    Open {
        start: u32,
        end: u32,
        length: u32,
        /// A token of `length` bytes was split off.
        is_split: bool,
    },
}

/// An index from words that are not one whole name to the chunks that looked them up, in lexicographic order, so that all
/// words that begin with a name are adjacent.
#[derive(Clone, Debug, Default)]
pub(super) struct UnresolvedWords(BTreeMap<Box<str>, Vec<Group>>);

/// The chunks that looked up a word with the same result.
#[derive(Clone, Debug)]
struct Group {
    length: u32,
    is_split: bool,
    chunks: ChunkSet,
}

impl UnresolvedWords {
    /// Adds a chunk that looked up a word, whose first `length` bytes became a token.
    pub(super) fn insert(&mut self, chunk: ChunkId, rest: &str, length: u32, is_split: bool) {
        if !self.0.contains_key(rest) {
            self.0.insert(rest.into(), Vec::new());
        }
        let Some(groups) = self.0.get_mut(rest) else {
            return;
        };
        let same = |group: &&mut Group| group.length == length && group.is_split == is_split;
        match groups.iter_mut().find(same) {
            Some(group) => group.chunks.insert(chunk),
            None => {
                let mut chunks = ChunkSet::default();
                chunks.insert(chunk);
                // Most words have one group; a vector that grows by itself would reserve space for four.
                groups.reserve_exact(1);
                groups.push(Group {
                    length,
                    is_split,
                    chunks,
                });
            }
        }
    }

    /// Removes an entry added by [`insert`](Self::insert).
    pub(super) fn remove(&mut self, chunk: ChunkId, rest: &str, length: u32, is_split: bool) {
        let Some(groups) = self.0.get_mut(rest) else {
            return;
        };
        for group in groups.iter_mut() {
            if group.length == length && group.is_split == is_split {
                group.chunks.remove(chunk);
            }
        }
        groups.retain(|group| !group.chunks.is_empty());
        if groups.is_empty() {
            self.0.remove(rest);
        }
    }

    /// Returns the chunks that a definition of `name` above them would change, each with a flag that is true if a token
    /// was split off.
    pub(super) fn beginning_with<'w>(
        &'w self,
        name: &'w str,
    ) -> impl Iterator<Item = (ChunkId, bool)> + 'w {
        let from = (Bound::Included(name), Bound::Unbounded);
        self.0
            .range::<str, _>(from)
            .take_while(move |(rest, _)| rest.starts_with(name))
            .flat_map(|(_, groups)| groups)
            .filter(move |group| (group.length as usize) < name.len())
            .flat_map(|group| {
                let split = group.is_split;
                group.chunks.iter().map(move |chunk| (chunk, split))
            })
    }
}
