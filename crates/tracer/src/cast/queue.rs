//! Priority queues on a ray: the smallest key is removed first.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// A queue that yields the value with the smallest key.
#[derive(Debug)]
pub(super) struct Queue<K, V>(BinaryHeap<Queued<K, V>>);

#[derive(Debug)]
struct Queued<K, V> {
    key: Reverse<K>,
    value: V,
}

/// The order of a parameter on a ray: −∞ first, NaN last.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub(super) struct RayOrder(i64);

impl RayOrder {
    /// Returns the order of a parameter of the ray, that of [`f64::total_cmp`].
    pub(super) fn of(t: f64) -> Self {
        let bits = t.to_bits().cast_signed();
        // A negative number has the sign bit, and its other bits grow as it decreases.
        Self(bits ^ ((bits >> 63).cast_unsigned() >> 1).cast_signed())
    }
}

impl<K: Ord, V> Queue<K, V> {
    pub(super) fn new() -> Self {
        Self(BinaryHeap::new())
    }

    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    pub(super) fn push(&mut self, key: K, value: V) {
        let key = Reverse(key);
        self.0.push(Queued { key, value });
    }

    /// Returns the value with the smallest key.
    pub(super) fn first(&self) -> Option<&V> {
        self.0.peek().map(|first| &first.value)
    }

    /// Removes and returns the smallest key with its value, if the value meets the condition.
    pub(super) fn pop_if(&mut self, condition: impl FnOnce(&V) -> bool) -> Option<(K, V)> {
        self.first().filter(|first| condition(first))?;
        self.0.pop().map(|first| (first.key.0, first.value))
    }
}

impl<K: Ord, V> Ord for Queued<K, V> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.key.cmp(&other.key)
    }
}

impl<K: Ord, V> PartialOrd for Queued<K, V> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<K: Ord, V> PartialEq for Queued<K, V> {
    fn eq(&self, other: &Self) -> bool {
        self.key == other.key
    }
}

impl<K: Ord, V> Eq for Queued<K, V> {}
