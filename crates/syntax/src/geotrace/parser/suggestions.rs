//! Suggestions for an undefined word: a name that is declared further down, or a misspelt declaration keyword.

use std::collections::HashMap;

use crate::geotrace::declarations::DeclarationKeyword;
use crate::spelling::nearest;

/// All names that follow a declaration keyword in a text, with their last positions.
pub(super) struct DeclaredNames<'s>(HashMap<&'s str, u32>);

impl<'s> DeclaredNames<'s> {
    /// Returns the last position of a name after a declaration keyword.
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

/// Calls `found` with every name that follows a declaration keyword, and its position.
pub(crate) fn each_declared<'s>(source: &'s str, mut found: impl FnMut(&'s str, u32)) {
    let (mut after_declaring, mut at_start) = (false, true);
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
            b'#' => run(|byte| !matches!(byte, b'\n' | b'\r')),
            b'a'..=b'z' | b'A'..=b'Z' => {
                let length = run(u8::is_ascii_alphanumeric);
                let word = &source[at..at + length];
                let keyword = DeclarationKeyword::from_text(word);
                let declares = keyword.is_some_and(|it| at_start || !it.is_soft());
                at_start = false;
                if after_declaring && !declares {
                    found(word, at as u32);
                }
                after_declaring = declares;
                length
            }
            b' ' | b'\t' | b'\r' | b'\n' => 1,
            _ => {
                after_declaring = false;
                at_start = byte == b';';
                1
            }
        };
        at += length;
    }
}

/// Returns the declaration keyword that a word is most likely meant to be.
pub(super) fn nearest_keyword(word: &str) -> Option<DeclarationKeyword> {
    let keywords = DeclarationKeyword::ALL.iter();
    let nearest = nearest(word, keywords.map(|keyword| keyword.text()))?;
    DeclarationKeyword::from_text(&nearest)
}

#[cfg(test)]
mod tests {
    use super::{DeclaredNames, nearest_keyword};
    use crate::geotrace::declarations::DeclarationKeyword;

    #[test]
    fn a_misspelt_keyword_is_recognised() {
        assert_eq!(nearest_keyword("surfce"), Some(DeclarationKeyword::Surface));
        assert_eq!(nearest_keyword("Param"), Some(DeclarationKeyword::Param));
        assert_eq!(nearest_keyword("hello"), None);
    }

    #[test]
    fn names_after_keywords_are_found_without_parsing() {
        let names = DeclaredNames::scan("define a = 1; # define b\n curve\n c(t) define define 2x");
        let mut found: Vec<_> = names.0.into_iter().collect();
        found.sort_unstable();
        assert_eq!(found, [("a", 7), ("c", 33)]);
    }
}
