//! A list that is cloned in next to no time, and copied only where a clone is changed.
//!
//! Elements lie in blocks, and blocks in racks; both are shared between clones. Reading an element takes two steps
//! more than in a vector. The first change of a block that a clone shares copies that block and its rack.

use std::ops::Index;
use std::sync::Arc;

/// How many elements a block has, and how many blocks a rack.
const SIZE: usize = 64;

/// A list of elements by their number.
#[derive(Clone, Debug)]
pub(super) struct Shelf<T> {
    racks: Vec<Arc<Vec<Arc<Vec<T>>>>>,
    length: usize,
}

impl<T> Default for Shelf<T> {
    fn default() -> Self {
        Self {
            racks: Vec::new(),
            length: 0,
        }
    }
}

impl<T> Shelf<T> {
    pub(super) fn len(&self) -> usize {
        self.length
    }

    pub(super) fn get(&self, index: usize) -> Option<&T> {
        let rack = self.racks.get(index / (SIZE * SIZE))?;
        rack.get(index / SIZE % SIZE)?.get(index % SIZE)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &T> {
        let blocks = self.racks.iter().flat_map(|rack| rack.iter());
        blocks.flat_map(|block| block.iter())
    }
}

impl<T: Clone> Shelf<T> {
    pub(super) fn get_mut(&mut self, index: usize) -> Option<&mut T> {
        let rack = Arc::make_mut(self.racks.get_mut(index / (SIZE * SIZE))?);
        let block = Arc::make_mut(rack.get_mut(index / SIZE % SIZE)?);
        block.get_mut(index % SIZE)
    }

    /// Adds an element at the end.
    pub(super) fn push(&mut self, element: T) {
        if self.length.is_multiple_of(SIZE * SIZE) {
            self.racks.push(Arc::default());
        }
        if let Some(rack) = self.racks.last_mut() {
            let rack = Arc::make_mut(rack);
            if self.length.is_multiple_of(SIZE) {
                rack.push(Arc::default());
            }
            if let Some(block) = rack.last_mut() {
                Arc::make_mut(block).push(element);
                self.length += 1;
            }
        }
    }

    /// Puts an element in the place of another; where there is none yet, `filling` goes between.
    pub(super) fn set(&mut self, index: usize, element: T, filling: T) {
        while self.length <= index {
            self.push(filling.clone());
        }
        if let Some(place) = self.get_mut(index) {
            *place = element;
        }
    }
}

impl<T> Index<usize> for Shelf<T> {
    type Output = T;

    /// # Panics
    /// Where there is no such element.
    fn index(&self, index: usize) -> &T {
        &self.racks[index / (SIZE * SIZE)][index / SIZE % SIZE][index % SIZE]
    }
}

#[cfg(test)]
mod tests {
    use super::Shelf;

    #[test]
    fn a_clone_stays_as_it_is_whatever_becomes_of_the_other() {
        let mut shelf = Shelf::default();
        let mut list = Vec::new();
        for k in 0..9_000_u32 {
            shelf.push(k);
            list.push(k);
        }
        let (kept, old) = (shelf.clone(), list.clone());
        for k in (0..9_000).step_by(37) {
            *shelf.get_mut(k).expect("there") += 1;
            list[k] += 1;
        }
        shelf.set(9_002, 5, 7);
        list.extend([7, 7, 5]);
        assert!(shelf.iter().eq(&list));
        assert!(kept.iter().eq(&old));
        assert_eq!((shelf.len(), kept.len()), (9_003, 9_000));
        assert_eq!((shelf.get(9_003), kept.get(9_000)), (None, None));
        assert!((0..list.len()).all(|k| shelf[k] == list[k]));
    }
}
