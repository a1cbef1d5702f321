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

/// An index from words that are not one whole name to the chunks that looked them up.
#[derive(Clone, Debug, Default)]
pub(super) struct UnresolvedWords {
    /// The words whose beginning became a token. There are few of them, and every name is compared with them.
    split: WordIndex,
    others: WordIndex,
}

/// WordIndex in lexicographic order, so that all words that begin with a name are adjacent.
#[derive(Clone, Debug, Default)]
struct WordIndex(BTreeMap<Box<str>, Vec<Group>>);

/// The chunks that looked up a word with the same result.
#[derive(Clone, Debug)]
struct Group {
    length: u32,
    chunks: ChunkSet,
}

impl UnresolvedWords {
    /// Adds a chunk that looked up a word, whose first `length` bytes became a token.
    pub(super) fn insert(&mut self, chunk: ChunkId, rest: &str, length: u32, is_split: bool) {
        self.words_mut(is_split).insert(chunk, rest, length);
    }

    /// Removes an entry added by [`insert`](Self::insert).
    pub(super) fn remove(&mut self, chunk: ChunkId, rest: &str, length: u32, is_split: bool) {
        self.words_mut(is_split).remove(chunk, rest, length);
    }

    fn words_mut(&mut self, is_split: bool) -> &mut WordIndex {
        match is_split {
            true => &mut self.split,
            false => &mut self.others,
        }
    }

    /// Returns the chunks that a definition of `name` above them would change.
    pub(super) fn beginning_with<'w>(
        &'w self,
        name: &'w str,
    ) -> impl Iterator<Item = ChunkId> + 'w {
        let split = self.split_beginning_with(name);
        split.chain(self.others.beginning_with(name))
    }

    /// Returns those of [`beginning_with`](Self::beginning_with) in which a token was split off.
    pub(super) fn split_beginning_with<'w>(
        &'w self,
        name: &'w str,
    ) -> impl Iterator<Item = ChunkId> + 'w {
        self.split.beginning_with(name)
    }
}

impl WordIndex {
    fn insert(&mut self, chunk: ChunkId, rest: &str, length: u32) {
        let Some(groups) = self.0.get_mut(rest) else {
            // Most words have one group; a vector that grows by itself would reserve space for four.
            self.0.insert(rest.into(), vec![Group::new(chunk, length)]);
            return;
        };
        match groups.iter_mut().find(|group| group.length == length) {
            Some(group) => group.chunks.insert(chunk),
            None => {
                groups.reserve_exact(1);
                groups.push(Group::new(chunk, length));
            }
        }
    }

    fn remove(&mut self, chunk: ChunkId, rest: &str, length: u32) {
        let Some(groups) = self.0.get_mut(rest) else {
            return;
        };
        for group in groups.iter_mut() {
            if group.length == length {
                group.chunks.remove(chunk);
            }
        }
        groups.retain(|group| !group.chunks.is_empty());
        if groups.is_empty() {
            self.0.remove(rest);
        }
    }

    fn beginning_with<'w>(&'w self, name: &'w str) -> impl Iterator<Item = ChunkId> + 'w {
        let from = (Bound::Included(name), Bound::Unbounded);
        self.0
            .range::<str, _>(from)
            .take_while(move |(rest, _)| rest.starts_with(name))
            .flat_map(|(_, groups)| groups)
            .filter(move |group| (group.length as usize) < name.len())
            .flat_map(|group| group.chunks.iter())
    }
}

impl Group {
    fn new(chunk: ChunkId, length: u32) -> Self {
        let mut chunks = ChunkSet::default();
        chunks.insert(chunk);
        Self { length, chunks }
    }
}
