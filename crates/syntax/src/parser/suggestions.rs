//! What a word that means nothing may have been meant to be: a name declared further down, or one that is
//! spelt alike.

use std::collections::HashMap;

use crate::token::DeclareWord;
use crate::trie::Trie;

/// Every name that stands after a declaring word somewhere in a text, and where it does last.
pub(super) struct DeclaredNames<'s>(HashMap<&'s str, u32>);

impl<'s> DeclaredNames<'s> {
    /// The last place of a name behind a declaring word.
    pub(super) fn place(&self, name: &str) -> Option<u32> {
        self.0.get(name).copied()
    }

    pub(super) fn scan(source: &'s str) -> Self {
        let mut names = HashMap::new();
        each_declared(source, |name, offset| {
            names.insert(name, offset);
        });
        Self(names)
    }
}

/// Calls `found` with every name that stands after a declaring word, and its place.
pub(crate) fn each_declared<'s>(source: &'s str, mut found: impl FnMut(&'s str, u32)) {
    let mut after_declaring = false;
    let bytes = source.as_bytes();
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        let run = |inside: fn(&u8) -> bool| {
            let rest = &bytes[at..];
            rest.iter()
                .position(|byte| !inside(byte))
                .unwrap_or(rest.len())
        };
        let length = match byte {
            b'#' => run(|byte| *byte != b'\n'),
            b'a'..=b'z' | b'A'..=b'Z' => {
                let length = run(u8::is_ascii_alphanumeric);
                let word = &source[at..at + length];
                let declares = DeclareWord::from_text(word).is_some();
                if after_declaring && !declares {
                    found(word, at as u32);
                }
                after_declaring = declares;
                length
            }
            b' ' | b'\t' | b'\r' | b'\n' => 1,
            _ => {
                after_declaring = false;
                1
            }
        };
        at += length;
    }
}

/// The name that is spelt most like a word, among those that have been considered.
pub(crate) struct Search<'w> {
    word: &'w str,
    /// The word in small letters: case is no difference.
    folded: Vec<u8>,
    limit: usize,
    best: Option<((usize, usize), String)>,
}

impl<'w> Search<'w> {
    /// None for a word that is too short or too long to be told from others.
    pub(crate) fn new(word: &'w str) -> Option<Self> {
        let limit = match word.len() {
            1 => 0,
            2..=5 => 1,
            6..=32 => 2,
            _ => return None,
        };
        Some(Self {
            word,
            folded: word.to_ascii_lowercase().into_bytes(),
            limit,
            best: None,
        })
    }

    /// Considers every name of a trie that is `visible`, in the order of the alphabet.
    pub(crate) fn among<V: Copy>(&mut self, names: &Trie<V>, visible: impl Fn(V) -> bool) {
        // Row k belongs to the first k letters of a name: names with a common front share rows, and where a
        // front is too far off, no name that begins so is near.
        let mut rows = vec![first_row(&self.folded)];
        names.each_below(|name, above, value| {
            rows.truncate(above + 1);
            let front = name.to_ascii_lowercase();
            for length in above + 1..=name.len() {
                let row = next_row(&rows, &front.as_bytes()[..length], &self.folded);
                rows.push(row);
                let least = |row: &[usize]| row.iter().min().copied().unwrap_or_default();
                // A swap reaches back two rows, for one more.
                if let [.., before, last] = &rows[..]
                    && least(last) > self.limit
                    && least(before) >= self.limit
                {
                    return false;
                }
            }
            let distance = rows.last().and_then(|row| row.last());
            if let (Some(value), Some(&distance)) = (value, distance) {
                self.consider(name, distance, || visible(value));
            }
            true
        });
    }

    fn consider(&mut self, name: &str, distance: usize, visible: impl FnOnce() -> bool) {
        // Between names equally near, the one that keeps the first letter, then the first.
        let first = usize::from(!name.starts_with(&self.word[..1]));
        let rank = (distance, first);
        if distance <= self.limit
            && name != self.word
            && self.best.as_ref().is_none_or(|(best, _)| rank < *best)
            && visible()
        {
            self.best = Some((rank, name.to_owned()));
        }
    }

    /// What has been found.
    pub(crate) fn nearest(self) -> Option<String> {
        self.best.map(|(_, name)| name)
    }
}

/// The distances between nothing and the first letters of a word.
fn first_row(word: &[u8]) -> Vec<usize> {
    (0..=word.len()).collect()
}

/// The distances between `front` and the first letters of `word`, where `rows` holds those of each shorter
/// front: the least number of insertions, deletions, substitutions and swaps of neighbours that turn one
/// into the other (optimal string alignment).
fn next_row(rows: &[Vec<usize>], front: &[u8], word: &[u8]) -> Vec<usize> {
    let i = front.len();
    let above = &rows[i - 1];
    let mut row = vec![i];
    for j in 1..=word.len() {
        let changed = usize::from(front[i - 1] != word[j - 1]);
        let mut cost = (above[j] + 1)
            .min(row[j - 1] + 1)
            .min(above[j - 1] + changed);
        if i > 1 && j > 1 && front[i - 1] == word[j - 2] && front[i - 2] == word[j - 1] {
            cost = cost.min(rows[i - 2][j - 2] + 1);
        }
        row.push(cost);
    }
    row
}

/// The declaring word that a word is most likely meant to be.
pub(super) fn nearest_declaring(word: &str) -> Option<DeclareWord> {
    let mut search = Search::new(word)?;
    for declaring in DeclareWord::ALL.map(DeclareWord::text) {
        let distance = distance(&word.to_ascii_lowercase(), declaring);
        search.consider(declaring, distance, || true);
    }
    DeclareWord::from_text(&search.nearest()?)
}

/// The distance between two ASCII words.
fn distance(a: &str, b: &str) -> usize {
    let mut rows = vec![first_row(b.as_bytes())];
    for length in 1..=a.len() {
        rows.push(next_row(&rows, &a.as_bytes()[..length], b.as_bytes()));
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::{DeclaredNames, Search, distance, nearest_declaring};
    use crate::token::DeclareWord;
    use crate::trie::Trie;

    #[test]
    fn the_distance_counts_edits_and_swaps() {
        for (a, b, expected) in [
            ("", "abc", 3),
            ("sin", "sin", 0),
            ("sni", "sin", 1),
            ("sinn", "sin", 1),
            ("cas", "cos", 1),
            ("surfaec", "surface", 1),
            ("kitten", "sitting", 3),
        ] {
            assert_eq!(distance(a, b), expected, "{a} {b}");
            assert_eq!(distance(b, a), expected, "{b} {a}");
        }
    }

    #[test]
    fn a_misspelt_declaring_word_is_recognised() {
        assert_eq!(nearest_declaring("surfce"), Some(DeclareWord::Surface));
        assert_eq!(nearest_declaring("Param"), Some(DeclareWord::Param));
        assert_eq!(nearest_declaring("hello"), None);
    }

    #[test]
    fn a_search_in_a_trie_finds_what_comparing_every_name_finds() {
        let names = [
            "a", "ab", "ba", "radius", "radios", "raduis", "Radius", "rdius", "height", "heigth",
            "x1", "x2", "x12", "sinh", "asinh", "cos",
        ];
        let mut trie = Trie::default();
        for name in names {
            trie.insert(name, name.len()).expect("a name");
        }
        let mut sorted = Vec::new();
        trie.each(|name, _| {
            sorted.push(name.to_owned());
            std::ops::ControlFlow::Continue(())
        });
        for word in [
            "radiu", "radius", "xx", "x3", "hieght", "sin", "bab", "q", "RADIUS",
        ] {
            for hidden in [0, 2, 6] {
                let mut found = Search::new(word);
                let mut expected = Search::new(word);
                if let (Some(found), Some(expected)) = (&mut found, &mut expected) {
                    found.among(&trie, |length| length != hidden);
                    for name in &sorted {
                        let (a, b) = (name.to_ascii_lowercase(), word.to_ascii_lowercase());
                        expected.consider(name, distance(&a, &b), || name.len() != hidden);
                    }
                }
                let nearest = |search: Option<Search<'_>>| search.and_then(Search::nearest);
                assert_eq!(nearest(found), nearest(expected), "{word} {hidden}");
            }
        }
    }

    #[test]
    fn names_after_declaring_words_are_found_without_parsing() {
        let names = DeclaredNames::scan("define a = 1; # define b\n curve\n c(t) define define 2x");
        let mut found: Vec<_> = names.0.into_iter().collect();
        found.sort_unstable();
        assert_eq!(found, [("a", 7), ("c", 33)]);
    }
}
