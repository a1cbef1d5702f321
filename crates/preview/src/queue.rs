//! A queue between two threads in which the latest value of each key wins.
//!
//! A newer value replaces a waiting one with the same key and keeps its turn, so that no key waits forever. No channel
//! crate does this: they drop the oldest or the newest value, whatever its key.

use std::collections::BTreeMap;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// The queue; clones share it.
#[derive(Debug)]
pub(crate) struct LatestQueue<K, V> {
    shared: Arc<(Mutex<Entries<K, V>>, Condvar)>,
}

#[derive(Debug)]
struct Entries<K, V> {
    /// By key: the rank, the turn in which the key arrived, and the value. The lowest rank and turn is next.
    waiting: BTreeMap<K, (u8, u64, V)>,
    turn: u64,
    closed: bool,
}

impl<K, V> Clone for LatestQueue<K, V> {
    fn clone(&self) -> Self {
        Self {
            shared: Arc::clone(&self.shared),
        }
    }
}

impl<K, V> Default for LatestQueue<K, V> {
    fn default() -> Self {
        let entries = Entries {
            waiting: BTreeMap::new(),
            turn: 0,
            closed: false,
        };
        Self {
            shared: Arc::new((Mutex::new(entries), Condvar::new())),
        }
    }
}

impl<K: Clone + Ord, V> LatestQueue<K, V> {
    /// Adds a value, replacing a waiting one with the same key. Values of a lower rank are taken first.
    pub(crate) fn push(&self, rank: u8, key: K, value: V) {
        self.update(rank, key, |_| value);
    }

    /// Adds the value that `update` makes of the waiting one with the same key.
    pub(crate) fn update(&self, rank: u8, key: K, update: impl FnOnce(Option<V>) -> V) {
        let mut entries = self.lock();
        entries.turn += 1;
        let (turn, before) = match entries.waiting.remove(&key) {
            Some((_, turn, value)) => (turn, Some(value)),
            None => (entries.turn, None),
        };
        let value = update(before);
        entries.waiting.insert(key, (rank, turn, value));
        drop(entries);
        self.shared.1.notify_one();
    }

    /// Puts back a value that was taken, unless a newer one with the same key waits or the queue is closed. Only the
    /// thread that takes values may call this: no other one is woken.
    pub(crate) fn restore(&self, rank: u8, key: K, value: V) {
        let mut entries = self.lock();
        if !entries.closed && !entries.waiting.contains_key(&key) {
            entries.turn += 1;
            let turn = entries.turn;
            entries.waiting.insert(key, (rank, turn, value));
        }
    }

    /// Takes the waiting value with a key.
    pub(crate) fn remove(&self, key: &K) -> Option<V> {
        let waiting = self.lock().waiting.remove(key);
        waiting.map(|(_, _, value)| value)
    }

    /// Takes the next value, and waits while there is none. Returns `None` when the queue is closed and empty.
    pub(crate) fn take(&self) -> Option<(K, V)> {
        let mut entries = self.lock();
        loop {
            if let Some(key) = entries.next().cloned()
                && let Some((_, _, value)) = entries.waiting.remove(&key)
            {
                return Some((key, value));
            }
            if entries.closed {
                return None;
            }
            let woken = self.shared.1.wait(entries);
            entries = woken.unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Returns the key of the next value.
    pub(crate) fn next_key(&self) -> Option<K> {
        self.lock().next().cloned()
    }

    /// Returns true if the queue has been closed or abandoned.
    pub(crate) fn is_closed(&self) -> bool {
        self.lock().closed
    }

    /// Closes the queue; waiting values can still be taken.
    pub(crate) fn close(&self) {
        self.lock().closed = true;
        self.shared.1.notify_one();
    }

    /// Drops the waiting values and closes the queue.
    pub(crate) fn abandon(&self) {
        self.lock().waiting.clear();
        self.close();
    }

    fn lock(&self) -> MutexGuard<'_, Entries<K, V>> {
        let entries = self.shared.0.lock();
        entries.unwrap_or_else(PoisonError::into_inner)
    }
}

impl<K: Ord, V> Entries<K, V> {
    fn next(&self) -> Option<&K> {
        let waiting = self.waiting.iter();
        let first = waiting.min_by_key(|(_, (rank, turn, _))| (*rank, *turn));
        first.map(|(key, _)| key)
    }
}

#[cfg(test)]
mod tests {
    use super::LatestQueue;

    #[test]
    fn the_latest_value_of_a_key_wins_and_keeps_its_turn() {
        let queue = LatestQueue::default();
        queue.push(1, "a", 1);
        queue.push(1, "b", 2);
        queue.push(1, "a", 3);
        queue.push(0, "first", 4);
        queue.push(1, "gone", 5);
        queue.remove(&"gone");
        queue.close();
        let taken: Vec<_> = std::iter::from_fn(|| queue.take()).collect();
        assert_eq!(taken, [("first", 4), ("a", 3), ("b", 2)]);
    }

    #[test]
    fn a_value_that_is_put_back_gives_way_to_a_newer_one_and_to_those_of_lower_ranks() {
        let queue = LatestQueue::default();
        queue.push(1, "a", 1);
        let (key, value) = queue.take().expect("a value");
        queue.push(1, "b", 2);
        queue.restore(2, key, value);
        queue.restore(2, "b", 3);
        queue.close();
        let taken: Vec<_> = std::iter::from_fn(|| queue.take()).collect();
        assert_eq!(taken, [("b", 2), ("a", 1)]);
    }

    #[test]
    fn a_queue_that_is_abandoned_ends_at_once() {
        let queue = LatestQueue::default();
        let other = queue.clone();
        queue.push(0, 1, "a");
        let reader = std::thread::spawn(move || {
            let first = other.take();
            (first, other.take())
        });
        while queue.next_key().is_some() {
            std::thread::yield_now();
        }
        queue.abandon();
        assert_eq!(reader.join().expect("it ends"), (Some((1, "a")), None));
    }

    #[test]
    fn a_value_that_is_put_back_into_an_abandoned_queue_is_dropped() {
        let queue = LatestQueue::default();
        queue.push(0, 1, "a");
        let (key, value) = queue.take().expect("a value");
        queue.abandon();
        queue.restore(0, key, value);
        assert!(queue.is_closed());
        assert_eq!(queue.take(), None);
    }
}
