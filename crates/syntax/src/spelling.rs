//! Similarly spelt names: suggestions for an undefined word.
//!
//! The distance between two words is the optimal string alignment distance. `strsim` computes it too, but only for pairs
//! of words. `Search::among` walks a [`Trie`] and skips every branch that cannot contain a similar name; otherwise a
//! misspelt word among 100,000 names would cost 100,000 comparisons.

use crate::trie::Trie;

/// A search for the name most similar in spelling to a word, among the names passed to it.
pub(crate) struct Search<'w> {
    word: &'w str,
    /// The word in lower case: case does not count as a difference.
    folded: Vec<u8>,
    limit: u8,
    best: Option<((u8, bool), String)>,
}

/// The maximum length of a word that is compared with names.
const MAX_WORD: usize = 32;

/// The distances between one prefix of a name and every prefix of a word.
type Row = [u8; MAX_WORD + 1];

impl<'w> Search<'w> {
    /// Calls `consider` with a search for names at distance 1, and if it finds none, at distance 2. Returns the nearest name.
    /// A word of one letter matches only names that differ in case; a word of more than 32 letters matches none.
    pub(crate) fn nearest(word: &'w str, mut consider: impl FnMut(&mut Self)) -> Option<String> {
        let furthest = match word.len() {
            1 => 0,
            2..=5 => 1,
            6..=MAX_WORD => 2,
            _ => return None,
        };
        // At distance 1 the walk skips most names, and most misspelt words are found there.
        (furthest.min(1)..=furthest).find_map(|limit| {
            let mut search = Self {
                word,
                folded: word.to_ascii_lowercase().into_bytes(),
                limit,
                best: None,
            };
            consider(&mut search);
            search.best.map(|(_, name)| name)
        })
    }

    /// Returns the word in lower case.
    fn folded_text(&self) -> String {
        self.word.to_ascii_lowercase()
    }

    /// Considers every name of a trie that is `visible`, in alphabetical order.
    pub(crate) fn among<V: Copy>(&mut self, names: &Trie<V>, visible: impl Fn(V) -> bool) {
        // Row k belongs to the first k letters of a name. Names with a common prefix share its rows, and if the prefix is
        // too far from every prefix of the word, so is every name that begins with it.
        let mut rows = vec![first_row()];
        let mut front = Vec::new();
        names.each_below(|name, above, value| {
            rows.truncate(above + 1);
            front.truncate(above);
            for letter in name[above..].bytes() {
                front.push(letter.to_ascii_lowercase());
                rows.push(next_row(&rows, &front, &self.folded));
                let length = self.folded.len();
                let least = |row: &Row| row[..=length].iter().min().copied().unwrap_or_default();
                // A swap refers to the row before the previous one, at a cost of one.
                if let [.., before, last] = &rows[..]
                    && least(last) > self.limit
                    && least(before) >= self.limit
                {
                    return false;
                }
            }
            if let (Some(value), Some(row)) = (value, rows.last()) {
                self.consider(name, row[self.folded.len()], || visible(value));
            }
            true
        });
    }

    fn consider(&mut self, name: &str, distance: u8, visible: impl FnOnce() -> bool) {
        // Among names equally near, prefer one with the same first letter, then the first.
        let rank = (distance, !name.starts_with(&self.word[..1]));
        if distance <= self.limit
            && name != self.word
            && self.best.as_ref().is_none_or(|(best, _)| rank < *best)
            && visible()
        {
            self.best = Some((rank, name.to_owned()));
        }
    }
}

/// Returns the name most similar in spelling to a word; among equals, the first. Returns `None` if no name is similar enough.
pub fn nearest<'n>(word: &str, names: impl Iterator<Item = &'n str> + Clone) -> Option<String> {
    if !word.is_ascii() || word.is_empty() {
        return None;
    }
    Search::nearest(word, |search| {
        let near = names.clone().filter(|name| name.is_ascii());
        for name in near {
            let distance = distance(&name.to_ascii_lowercase(), &search.folded_text());
            search.consider(name, distance, || true);
        }
    })
}

/// Returns the distances between the empty text and the prefixes of a word.
fn first_row() -> Row {
    std::array::from_fn(|length| length as u8)
}

/// Returns the distances between `front` and the prefixes of `word`; `rows` has those of each shorter prefix of
/// `front`.
///
/// The distance is the minimum number of insertions, deletions, substitutions and swaps of neighbours that turn one into
/// the other, with no letter edited twice (optimal string alignment; L. Boytsov, Indexing methods for approximate
/// dictionary searching, ACM J. Exp. Algorithmics 16, 2011, section 2.2.1).
fn next_row(rows: &[Row], front: &[u8], word: &[u8]) -> Row {
    let i = front.len();
    let above = &rows[i - 1];
    let mut row = [u8::MAX; MAX_WORD + 1];
    row[0] = i.min(usize::from(u8::MAX)) as u8;
    for j in 1..=word.len() {
        let changed = u8::from(front[i - 1] != word[j - 1]);
        let mut cost = above[j]
            .saturating_add(1)
            .min(row[j - 1].saturating_add(1))
            .min(above[j - 1].saturating_add(changed));
        if i > 1 && j > 1 && front[i - 1] == word[j - 2] && front[i - 2] == word[j - 1] {
            cost = cost.min(rows[i - 2][j - 2].saturating_add(1));
        }
        row[j] = cost;
    }
    row
}

/// Returns the distance between two ASCII words, the second of which is no longer than [`MAX_WORD`].
fn distance(a: &str, b: &str) -> u8 {
    let mut rows = vec![first_row()];
    for length in 1..=a.len() {
        rows.push(next_row(&rows, &a.as_bytes()[..length], b.as_bytes()));
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::{Search, distance};
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
        let words = [
            "radiu", "radius", "xx", "x3", "hieght", "sin", "bab", "q", "RADIUS", "hgt", "raxxus",
        ];
        for word in words {
            for hidden in [0, 2, 6] {
                let found = Search::nearest(word, |search| {
                    search.among(&trie, |length| length != hidden);
                });
                let expected = Search::nearest(word, |search| {
                    for name in &sorted {
                        let (a, b) = (name.to_ascii_lowercase(), word.to_ascii_lowercase());
                        search.consider(name, distance(&a, &b), || name.len() != hidden);
                    }
                });
                assert_eq!(found, expected, "{word} {hidden}");
            }
        }
    }
}
