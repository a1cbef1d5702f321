//! The words that would be read otherwise if a name were defined that they begin with.

use std::collections::BTreeMap;
use std::ops::Bound;

use super::chunk_set::ChunkSet;
use super::names::NameId;
use super::sequence::ChunkId;

/// What a chunk has asked of the names above it.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub(super) enum Lookup {
    /// A token is this name, which the document declares.
    Used(NameId),
    /// The chunk's text from `start` to `end` was looked up, and every name longer than `length` that it
    /// begins with would be noticed.
    Open {
        start: u32,
        end: u32,
        length: u32,
        /// A token of `length` bytes was split off.
        is_split: bool,
    },
}

/// By the words that were looked up and are not one whole name: in lexicographic order, so that those that begin
/// with a name stand together.
#[derive(Clone, Debug, Default)]
pub(super) struct OpenWords(BTreeMap<Box<str>, Vec<Group>>);

/// Chunks that have looked up the same word with the same result.
#[derive(Clone, Debug)]
struct Group {
    length: u32,
    is_split: bool,
    chunks: ChunkSet,
}

impl OpenWords {
    /// A chunk has looked up a word, of which a token of `length` bytes was made.
    pub(super) fn enter(&mut self, chunk: ChunkId, rest: &str, length: u32, is_split: bool) {
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
                // As a rule it stays the only one: a list that grows by itself starts with four places.
                groups.reserve_exact(1);
                groups.push(Group {
                    length,
                    is_split,
                    chunks,
                });
            }
        }
    }

    /// Strikes out what has been entered.
    pub(super) fn strike(&mut self, chunk: ChunkId, rest: &str, length: u32, is_split: bool) {
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

    /// The chunks that would notice a name if it were defined above them, each with whether a token was split off.
    pub(super) fn of<'w>(&'w self, name: &'w str) -> impl Iterator<Item = (ChunkId, bool)> + 'w {
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
