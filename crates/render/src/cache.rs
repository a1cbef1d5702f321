//! Caches by content: the values that the last picture used, and a limited number of earlier ones.

use std::collections::HashMap;
use std::hash::Hash;

/// Values by key, each with a size in bytes. Values that the current picture has not used are evicted, the oldest first,
/// once they exceed an allowance.
#[derive(Debug)]
pub(crate) struct Cache<K, V> {
    entries: HashMap<K, Entry<V>>,
    allowance: usize,
    now: u64,
}

#[derive(Debug)]
struct Entry<V> {
    value: V,
    bytes: usize,
    used: u64,
}

impl<K: Clone + Eq + Hash, V: Clone> Cache<K, V> {
    /// Creates an empty cache; values that are not in use may take this number of bytes.
    pub(crate) fn new(allowance: usize) -> Self {
        Self {
            entries: HashMap::new(),
            allowance,
            now: 0,
        }
    }

    /// Returns the value of a key, and marks it as in use.
    pub(crate) fn get(&mut self, key: &K) -> Option<V> {
        let entry = self.entries.get_mut(key)?;
        entry.used = self.now;
        Some(entry.value.clone())
    }

    /// Stores a value that is in use.
    pub(crate) fn put(&mut self, key: K, value: V, bytes: usize) {
        let used = self.now;
        self.entries.insert(key, Entry { value, bytes, used });
    }

    /// Removes a value.
    pub(crate) fn remove(&mut self, key: &K) {
        self.entries.remove(key);
    }

    /// Ends a picture: values that it has not used no longer count as in use.
    pub(crate) fn next(&mut self) {
        let mut idle: Vec<(u64, usize, K)> = self
            .entries
            .iter()
            .filter(|(_, entry)| entry.used < self.now)
            .map(|(key, entry)| (entry.used, entry.bytes, key.clone()))
            .collect();
        idle.sort_by_key(|(used, ..)| std::cmp::Reverse(*used));
        let mut bytes = 0;
        for (_, size, key) in idle {
            bytes += size;
            if bytes > self.allowance {
                self.entries.remove(&key);
            }
        }
        self.now += 1;
    }

    /// Returns the number of entries.
    #[cfg(test)]
    pub(crate) fn len(&self) -> usize {
        self.entries.len()
    }
}

#[cfg(test)]
mod tests {
    use super::Cache;

    #[test]
    fn what_a_picture_has_used_stays_and_the_oldest_of_the_rest_goes_first() {
        let mut kept = Cache::new(10);
        for key in 0..4 {
            kept.put(key, key, 5);
            kept.next();
        }
        // The last one is in use until another picture ends without it.
        assert_eq!(kept.len(), 3);
        kept.next();
        assert_eq!(
            [0, 1, 2, 3].map(|key| kept.get(&key).is_some()),
            [false, false, true, true]
        );
        kept.put(9, 9, 100);
        kept.next();
        assert_eq!(kept.get(&9), Some(9));
        kept.next();
        kept.next();
        assert_eq!(kept.get(&9), None);
    }
}
