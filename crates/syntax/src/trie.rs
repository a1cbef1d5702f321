//! A persistent trie: a map from names over `a-z A-Z 0-9` to values.
//!
//! It is *persistent*: a clone costs one reference count, and inserting into a clone copies only the path to the new
//! name (nothing if no other clone shares it), so that a snapshot can be kept at the boundary of every declaration.
//! Chains of single children are merged into one labelled node, which keeps the trie small. A label is stored in its
//! node, so that a name costs one or two allocations. An empty trie costs none.
//!
//! It finds the longest name that is a prefix of a word, by which words are split into tokens. Crates with tries that
//! find prefixes (`radix_trie`, `qp-trie`) do not share nodes between clones, and persistent maps (`imbl`, `rpds`) do not
//! find prefixes.

use std::ops::ControlFlow;
use std::sync::Arc;

/// A map from names to values that finds the longest defined name that is a prefix of a word.
#[derive(Clone, Debug)]
pub struct Trie<V> {
    /// `None` if no name is defined.
    root: Option<Arc<TrieNode<V>>>,
}

/// A name that is empty or contains a character outside `a-z A-Z 0-9`.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct NotAName;

impl<V> Default for Trie<V> {
    fn default() -> Self {
        Self { root: None }
    }
}

impl<V: Copy> Trie<V> {
    /// Sets the value of a name; returns its previous value.
    ///
    /// # Errors
    /// [`NotAName`] if the name is empty or contains a character outside the alphabet.
    pub fn insert(&mut self, name: &str, value: V) -> Result<Option<V>, NotAName> {
        if name.is_empty() || name.bytes().any(|byte| slot(byte).is_none()) {
            return Err(NotAName);
        }
        let mut rest = name.as_bytes();
        let root = self.root.get_or_insert_with(|| Arc::new(TrieNode::root()));
        let mut node = Arc::make_mut(root);
        loop {
            let Some(slot) = rest.first().copied().and_then(slot) else {
                return Ok(node.value.replace(value));
            };
            let index = node.index(slot);
            if !node.has(slot) {
                node.present |= 1 << slot;
                node.children.insert(index, TrieNode::chain(rest, value));
                return Ok(None);
            }
            let child = Arc::make_mut(&mut node.children[index]);
            let shared = shared_length(child.label.bytes(), rest);
            child.split(shared);
            rest = &rest[shared..];
            node = child;
        }
    }

    /// Returns the value of exactly this name.
    pub fn get(&self, name: &str) -> Option<V> {
        self.longest_prefix(name)
            .filter(|(length, _)| *length == name.len())
            .map(|(_, value)| value)
    }

    /// Returns the longest name that is a prefix of `word`: its length in bytes and its value.
    pub(crate) fn longest_prefix(&self, word: &str) -> Option<(usize, V)> {
        let mut longest = None;
        self.each_prefix(word, |length, value| longest = Some((length, value)));
        longest
    }

    /// Calls `found` with the length and value of each name that is a prefix of `word`, shortest first.
    pub(crate) fn each_prefix(&self, word: &str, mut found: impl FnMut(usize, V)) {
        let word = word.as_bytes();
        let Some(root) = &self.root else { return };
        let mut node = &**root;
        let mut length = 0;
        while let Some(slot) = word.get(length).copied().and_then(slot) {
            if !node.has(slot) {
                break;
            }
            node = &node.children[node.index(slot)];
            let label = node.label.bytes();
            if shared_length(label, &word[length..]) < label.len() {
                break;
            }
            length += label.len();
            if let Some(value) = node.value {
                found(length, value);
            }
        }
    }

    /// Visits every name with its value, in the order of the alphabet `a-z A-Z 0-9`, until `visit` breaks.
    pub fn each(&self, visit: impl FnMut(&str, V) -> ControlFlow<()>) {
        self.each_from("", visit);
    }

    /// Visits the names that begin with `prefix`, including itself, as [`each`](Self::each) does; other names cost
    /// nothing.
    pub(crate) fn each_from(
        &self,
        prefix: &str,
        mut visit: impl FnMut(&str, V) -> ControlFlow<()>,
    ) {
        let Some(root) = &self.root else { return };
        let mut node = &**root;
        let (mut name, mut above) = (String::new(), 0);
        while let Some(rest) = prefix.as_bytes().get(name.len()..)
            && let Some(first) = rest.first()
        {
            let Some(slot) = slot(*first).filter(|slot| node.has(*slot)) else {
                return;
            };
            node = &node.children[node.index(slot)];
            let label = node.label.bytes();
            if shared_length(label, rest) < label.len().min(rest.len()) {
                return;
            }
            above = name.len();
            name.extend(label.iter().map(|byte| char::from(*byte)));
        }
        // The nodes that remain to be visited, each with the length of the name above it. Labels are ASCII.
        let mut stack = vec![(node, above)];
        while let Some((node, above)) = stack.pop() {
            name.truncate(above);
            name.extend(node.label.bytes().iter().map(|byte| char::from(*byte)));
            if let Some(value) = node.value
                && visit(&name, value).is_break()
            {
                return;
            }
            let children = node.children.iter().rev();
            stack.extend(children.map(|child| (&**child, name.len())));
        }
    }
}

impl<V: Copy> Trie<V> {
    /// Visits the prefixes of names that have a node, in alphabetical order. `enter` is called with the prefix, the length
    /// of the part that an earlier call has seen, and the value if the prefix is a name. If it returns false, the walk
    /// skips everything that begins with the prefix.
    pub(crate) fn each_below(&self, mut enter: impl FnMut(&str, usize, Option<V>) -> bool) {
        let mut name = String::new();
        let Some(root) = &self.root else { return };
        let mut stack = vec![(&**root, 0)];
        while let Some((node, above)) = stack.pop() {
            name.truncate(above);
            name.extend(node.label.bytes().iter().map(|byte| char::from(*byte)));
            if enter(&name, above, node.value) {
                let children = node.children.iter().rev();
                stack.extend(children.map(|child| (&**child, name.len())));
            }
        }
    }
}

#[derive(Clone, Debug)]
struct TrieNode<V> {
    /// The letters that lead here from the parent; empty only at the root.
    label: Label,
    value: Option<V>,
    /// Bit `k` is set where a child's label begins with the k-th letter of the alphabet.
    present: u64,
    /// The children, in the order of the bits.
    children: Vec<Arc<TrieNode<V>>>,
}

/// A few letters, stored inline; longer runs are chains of nodes.
#[derive(Clone, Copy, Debug)]
struct Label {
    length: u8,
    letters: [u8; Label::LONGEST],
}

impl Label {
    const LONGEST: usize = 15;

    /// Returns the first letters of a run, at most as many as a label can hold.
    fn front(run: &[u8]) -> Self {
        let length = run.len().min(Self::LONGEST);
        let mut letters = [0; Self::LONGEST];
        letters[..length].copy_from_slice(&run[..length]);
        Self {
            length: length as u8,
            letters,
        }
    }

    #[inline]
    fn bytes(&self) -> &[u8] {
        &self.letters[..usize::from(self.length)]
    }
}

impl<V> TrieNode<V> {
    fn root() -> Self {
        Self {
            label: Label::front(&[]),
            value: None,
            present: 0,
            children: Vec::new(),
        }
    }

    /// Creates the nodes that lead over a run of letters to a value, each the only child of the previous one.
    fn chain(run: &[u8], value: V) -> Arc<Self> {
        let mut value = Some(value);
        let mut below = None;
        for letters in run.chunks(Label::LONGEST).rev() {
            let (present, children) = match below.take() {
                Some((slot, node)) => (1_u64 << slot, vec![node]),
                None => (0, Vec::new()),
            };
            let node = Arc::new(Self {
                label: Label::front(letters),
                value: value.take(),
                present,
                children,
            });
            below = letters
                .first()
                .copied()
                .and_then(slot)
                .map(|slot| (slot, node));
        }
        match below {
            Some((_, node)) => node,
            // A run is not empty, and its letters are in the alphabet.
            None => Arc::new(Self::root()),
        }
    }

    fn has(&self, slot: u32) -> bool {
        self.present >> slot & 1 == 1
    }

    /// Returns the index of the child for this slot, or the index at which to insert it.
    fn index(&self, slot: u32) -> usize {
        (self.present & ((1 << slot) - 1)).count_ones() as usize
    }

    /// Cuts the label after `length` bytes; the node's contents move to a child below the cut.
    fn split(&mut self, length: usize) {
        let label = self.label;
        let Some(slot) = label.bytes().get(length).copied().and_then(slot) else {
            return;
        };
        let lower = Self {
            label: Label::front(&label.bytes()[length..]),
            value: self.value.take(),
            present: self.present,
            children: std::mem::take(&mut self.children),
        };
        self.label = Label::front(&label.bytes()[..length]);
        self.present = 1 << slot;
        self.children.push(Arc::new(lower));
    }
}

/// Nodes are dropped from a list: otherwise a chain of names, each a letter longer than the last, would exhaust the
/// stack.
impl<V> Drop for TrieNode<V> {
    fn drop(&mut self) {
        if self.children.is_empty() {
            return;
        }
        let mut doomed = std::mem::take(&mut self.children);
        while let Some(node) = doomed.pop() {
            if let Some(mut node) = Arc::into_inner(node) {
                doomed.append(&mut node.children);
            }
        }
    }
}

/// Returns the index of a letter in the alphabet `a-z A-Z 0-9`, 0 to 61.
#[inline]
fn slot(byte: u8) -> Option<u32> {
    let slot = SLOTS[usize::from(byte)];
    (slot < 62).then_some(u32::from(slot))
}

/// [`slot`] of each byte; 62 for bytes outside the alphabet.
const SLOTS: [u8; 256] = {
    let mut slots = [62; 256];
    let mut letter = 0;
    while letter < 26 {
        slots[b'a' as usize + letter] = letter as u8;
        slots[b'A' as usize + letter] = 26 + letter as u8;
        letter += 1;
    }
    let mut digit = 0;
    while digit < 10 {
        slots[b'0' as usize + digit] = 52 + digit as u8;
        digit += 1;
    }
    slots
};

/// Returns the length of the common prefix of two runs. It is small, so they are compared letter by letter.
#[inline]
fn shared_length(a: &[u8], b: &[u8]) -> usize {
    a.iter().zip(b).take_while(|(a, b)| a == b).count()
}

#[cfg(test)]
mod tests {
    use super::{NotAName, Trie};
    use proptest::prelude::*;
    use std::collections::BTreeMap;
    use std::ops::ControlFlow;

    fn names<V: Copy>(trie: &Trie<V>) -> Vec<String> {
        let mut names = Vec::new();
        trie.each(|name, _| {
            names.push(name.to_owned());
            ControlFlow::Continue(())
        });
        names
    }

    #[test]
    fn the_longest_defined_prefix_wins() {
        let mut trie = Trie::default();
        for (value, name) in ["s", "sin", "sinh", "pi", "k2"].into_iter().enumerate() {
            assert_eq!(trie.insert(name, value), Ok(None));
        }
        assert_eq!(trie.longest_prefix("sinx"), Some((3, 1)));
        assert_eq!(trie.longest_prefix("sinhx"), Some((4, 2)));
        assert_eq!(trie.longest_prefix("six"), Some((1, 0)));
        assert_eq!(trie.longest_prefix("p"), None);
        assert_eq!(trie.longest_prefix(""), None);
        assert_eq!(trie.longest_prefix("k2é"), Some((2, 4)));
        assert_eq!(trie.get("si"), None);
        assert_eq!(trie.insert("sin", 9), Ok(Some(1)));
    }

    #[test]
    fn what_leaves_the_alphabet_is_no_name() {
        let mut trie = Trie::default();
        assert_eq!(trie.insert("", 0), Err(NotAName));
        assert_eq!(trie.insert("é", 0), Err(NotAName));
        assert_eq!(trie.insert("a_b", 0), Err(NotAName));
        assert!(names(&trie).is_empty());
    }

    #[test]
    fn a_snapshot_keeps_what_it_held() {
        let mut trie = Trie::default();
        let mut snapshots = Vec::new();
        for k in 0..200_u32 {
            snapshots.push(trie.clone());
            trie.insert(&format!("n{k}"), k).expect("a name");
        }
        for (k, snapshot) in snapshots.iter().enumerate() {
            assert_eq!(names(snapshot).len(), k);
            assert_eq!(snapshot.get(&format!("n{k}")), None);
        }
    }

    #[test]
    fn names_longer_than_a_label_are_split_and_found() {
        let long = "abcdefghij".repeat(25);
        let mut trie = Trie::default();
        for (value, length) in [250, 15, 16, 14, 30, 31, 100, 1].into_iter().enumerate() {
            assert_eq!(trie.insert(&long[..length], value), Ok(None));
            assert_eq!(trie.get(&long[..length]), Some(value));
        }
        let other = format!("{}X{}", &long[..40], &long[..40]);
        assert_eq!(trie.insert(&other, 9), Ok(None));
        assert_eq!(names(&trie).len(), 9);
        assert_eq!(trie.longest_prefix(&long[..249]), Some((100, 6)));
        assert_eq!(trie.longest_prefix(&long), Some((250, 0)));
        assert_eq!(trie.longest_prefix(&other), Some((81, 9)));
        assert_eq!(trie.longest_prefix(&other[..80]), Some((31, 5)));
    }

    #[test]
    fn a_deep_trie_is_dropped_without_recursion() {
        // On a stack that is too small for so many calls.
        let thread = std::thread::Builder::new().stack_size(1 << 17);
        let work = || {
            let mut trie = Trie::default();
            let word = "a".repeat(6_000);
            for length in 1..=word.len() {
                trie.insert(&word[..length], length).expect("a name");
            }
            assert_eq!(trie.longest_prefix(&word), Some((word.len(), word.len())));
        };
        let thread = thread.spawn(work).expect("a thread");
        thread.join().expect("a trie that is dropped");
    }

    proptest! {
        #[test]
        fn it_agrees_with_an_ordered_map(
            pairs in prop::collection::vec(("[ab]{1,5}|[a-cX0]{1,4}", 0_u32..100), 0..40),
            words in prop::collection::vec("[abcX0]{0,7}", 0..20),
        ) {
            let mut trie = Trie::default();
            let mut map = BTreeMap::new();
            for (name, value) in &pairs {
                prop_assert_eq!(trie.insert(name, *value), Ok(map.insert(name.clone(), *value)));
            }
            let mut visited = names(&trie);
            visited.sort();
            prop_assert_eq!(visited, map.keys().cloned().collect::<Vec<_>>());
            for word in &words {
                let expected = (1..=word.len())
                    .rev()
                    .find_map(|length| map.get(&word[..length]).map(|value| (length, *value)));
                prop_assert_eq!(trie.longest_prefix(word), expected);
                prop_assert_eq!(trie.get(word), map.get(word).copied());
            }
        }
    }
}
