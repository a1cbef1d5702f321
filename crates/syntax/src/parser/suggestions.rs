//! What a word that means nothing may have been meant to be: a name declared further down, or one that is
//! spelt alike.

use std::collections::HashMap;
use std::ops::ControlFlow;

use crate::token::DeclareWord;

/// Every name that stands after a declaring word somewhere in a text, and where it does last.
pub(super) struct DeclaredNames<'s>(HashMap<&'s str, u32>);

impl<'s> DeclaredNames<'s> {
    /// The last place of a name behind a declaring word.
    pub(super) fn place(&self, name: &str) -> Option<u32> {
        self.0.get(name).copied()
    }

    pub(super) fn scan(source: &'s str) -> Self {
        let mut names = HashMap::new();
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
                        names.insert(word, at as u32);
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
        Self(names)
    }
}

/// Looks for names that are spelt alike. A text gets so much of it and no more, so that ten thousand
/// misspelt words among ten thousand names cost no more than a few.
#[derive(Default)]
pub(super) struct Suggestions {
    compared: usize,
}

/// How many names are compared for one text.
const MAX_COMPARED: usize = 200_000;

pub(super) struct Search<'b, 'w> {
    budget: &'b mut Suggestions,
    word: &'w str,
    limit: usize,
    pub(super) best: Option<((usize, usize), String)>,
}

impl Suggestions {
    pub(super) fn search<'b, 'w>(&'b mut self, word: &'w str) -> Option<Search<'b, 'w>> {
        let limit = match word.len() {
            1 => 0,
            2..=5 => 1,
            6..=32 => 2,
            _ => return None,
        };
        Some(Search {
            budget: self,
            word,
            limit,
            best: None,
        })
    }
}

impl Search<'_, '_> {
    pub(super) fn consider(&mut self, name: &str) -> ControlFlow<()> {
        if name.len().abs_diff(self.word.len()) > self.limit || name == self.word {
            return ControlFlow::Continue(());
        }
        if self.budget.compared >= MAX_COMPARED {
            return ControlFlow::Break(());
        }
        self.budget.compared += 1;
        let distance = distance(&self.word.to_ascii_lowercase(), &name.to_ascii_lowercase());
        // Between names equally near, the one that keeps the first letter.
        let first = usize::from(!name.starts_with(&self.word[..1]));
        let rank = (distance, first);
        if distance <= self.limit && self.best.as_ref().is_none_or(|(best, _)| rank < *best) {
            self.best = Some((rank, name.to_owned()));
        }
        ControlFlow::Continue(())
    }
}

/// The least number of insertions, deletions, substitutions and swaps of neighbours that turn one ASCII
/// word into the other (optimal string alignment).
fn distance(a: &str, b: &str) -> usize {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut before: Vec<usize> = Vec::new();
    let mut above: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let changed = usize::from(a[i - 1] != b[j - 1]);
            let mut cost = (above[j] + 1)
                .min(row[j - 1] + 1)
                .min(above[j - 1] + changed);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                cost = cost.min(before[j - 2] + 1);
            }
            row.push(cost);
        }
        before = std::mem::replace(&mut above, row);
    }
    above[b.len()]
}

/// The declaring word that a word is most likely meant to be.
pub(super) fn nearest_declaring(word: &str) -> Option<DeclareWord> {
    let mut budget = Suggestions::default();
    let mut search = budget.search(word)?;
    for declaring in DeclareWord::ALL {
        let _ = search.consider(declaring.text());
    }
    let (_, nearest) = search.best?;
    DeclareWord::from_text(&nearest)
}

#[cfg(test)]
mod tests {
    use super::{DeclaredNames, distance, nearest_declaring};
    use crate::token::DeclareWord;

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
    fn names_after_declaring_words_are_found_without_parsing() {
        let names = DeclaredNames::scan("define a = 1; # define b\n curve\n c(t) define define 2x");
        let mut found: Vec<_> = names.0.into_iter().collect();
        found.sort_unstable();
        assert_eq!(found, [("a", 7), ("c", 33)]);
    }
}
