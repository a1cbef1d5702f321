//! A persistent vector: a clone costs a few reference counts, and a change copies only what other clones share.
//!
//! Elements are stored in blocks of 64, and blocks in groups of 64; clones share both. The first change of a block that
//! another clone shares copies that block and its group: 64 elements and 64 pointers. Reading an element follows two more
//! pointers than in a [`Vec`].
//!
//! `imbl::Vector` would also work. It is not used because it would add seven crates to a crate without dependencies, for
//! operations that are not needed here (concatenation, insertion in the middle), which make up most of its code.

use std::ops::Index;
use std::sync::Arc;

/// The number of elements of a block, and of blocks of a group.
const SIZE: usize = 64;

/// A vector whose clones share their elements.
#[derive(Clone, Debug)]
pub(crate) struct PersistentVector<T> {
    groups: Vec<Arc<Vec<Arc<Vec<T>>>>>,
    length: usize,
}

impl<T> Default for PersistentVector<T> {
    fn default() -> Self {
        Self {
            groups: Vec::new(),
            length: 0,
        }
    }
}

impl<T> PersistentVector<T> {
    pub(crate) fn len(&self) -> usize {
        self.length
    }

    pub(crate) fn get(&self, index: usize) -> Option<&T> {
        let group = self.groups.get(index / (SIZE * SIZE))?;
        group.get(index / SIZE % SIZE)?.get(index % SIZE)
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &T> {
        let blocks = self.groups.iter().flat_map(|group| group.iter());
        blocks.flat_map(|block| block.iter())
    }
}

impl<T: Clone> PersistentVector<T> {
    pub(crate) fn get_mut(&mut self, index: usize) -> Option<&mut T> {
        let group = Arc::make_mut(self.groups.get_mut(index / (SIZE * SIZE))?);
        let block = Arc::make_mut(group.get_mut(index / SIZE % SIZE)?);
        block.get_mut(index % SIZE)
    }

    /// Appends an element.
    pub(crate) fn push(&mut self, element: T) {
        if self.length.is_multiple_of(SIZE * SIZE) {
            self.groups.push(Arc::default());
        }
        if let Some(group) = self.groups.last_mut() {
            let group = Arc::make_mut(group);
            if self.length.is_multiple_of(SIZE) {
                group.push(Arc::default());
            }
            if let Some(block) = group.last_mut() {
                Arc::make_mut(block).push(element);
                self.length += 1;
            }
        }
    }

    /// Replaces an element. An index past the end extends the vector, with `filling` before the element.
    pub(crate) fn set(&mut self, index: usize, element: T, filling: T) {
        while self.length <= index {
            self.push(filling.clone());
        }
        if let Some(place) = self.get_mut(index) {
            *place = element;
        }
    }
}

impl<T> Index<usize> for PersistentVector<T> {
    type Output = T;

    /// # Panics
    /// If the index is out of bounds.
    fn index(&self, index: usize) -> &T {
        &self.groups[index / (SIZE * SIZE)][index / SIZE % SIZE][index % SIZE]
    }
}

#[cfg(test)]
mod tests {
    use super::PersistentVector;

    #[test]
    fn a_clone_stays_as_it_is_whatever_becomes_of_the_other() {
        let mut vector = PersistentVector::default();
        let mut list = Vec::new();
        for k in 0..9_000_u32 {
            vector.push(k);
            list.push(k);
        }
        let (kept, old) = (vector.clone(), list.clone());
        for k in (0..9_000).step_by(37) {
            *vector.get_mut(k).expect("there") += 1;
            list[k] += 1;
        }
        vector.set(9_002, 5, 7);
        list.extend([7, 7, 5]);
        assert!(vector.iter().eq(&list));
        assert!(kept.iter().eq(&old));
        assert_eq!((vector.len(), kept.len()), (9_003, 9_000));
        assert_eq!((vector.get(9_003), kept.get(9_000)), (None, None));
        assert!((0..list.len()).all(|k| vector[k] == list[k]));
    }
}
