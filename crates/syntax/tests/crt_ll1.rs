//! The grammar of CRT scripts is LL(1) but for four cells, and the parser follows it.

#[path = "support/productions.rs"]
mod productions;

use std::collections::BTreeSet;

use productions::Productions;
use syntax::crt::actions::Actions;
use syntax::crt::codes;
use syntax::crt::grammar::{GREEDY, Nonterminal, PRODUCTIONS};
use syntax::crt::parse_script;
use syntax::crt::token::{Token, TokenKind};
use syntax::diagnostic::{Diagnostic, Severity};

#[test]
fn the_grammar_has_the_four_known_conflicts_and_no_others() {
    let grammar = Productions::new(Nonterminal::Script, PRODUCTIONS);
    let table = grammar.table();
    let conflicts = table.conflicts();
    let known = GREEDY.map(|(nonterminal, kind)| (nonterminal, Some(kind)));
    assert_eq!(
        conflicts.keys().copied().collect::<BTreeSet<_>>(),
        BTreeSet::from(known)
    );
    for (cell, all) in conflicts {
        // Of the two the parser takes the one that is not empty.
        assert!(
            all.len() == 2 && all.iter().any(|it| it.is_empty()),
            "{cell:?}"
        );
    }
    let (defined, reached) = grammar.nonterminals();
    assert_eq!(defined, reached);
    assert_eq!((defined.len(), PRODUCTIONS.len()), (34, 81));
}

/// A generator of random numbers (splitmix64).
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((mixed ^ (mixed >> 31)) % bound as u64) as usize
    }
}

/// A text of tokens; they stand apart, so that they stay what they are.
fn write(random: &mut Random, tokens: &[TokenKind]) -> String {
    let words = tokens.iter().map(|kind| match kind {
        TokenKind::Integer => "12",
        TokenKind::Float => "1.5",
        TokenKind::Text => "\"a b\"",
        TokenKind::Identifier => "ab",
        TokenKind::Name => "Material",
        kind => kind.text().expect("a sign or a word"),
    });
    let mut text = String::new();
    for word in words {
        text.push_str(word);
        text.push_str([" ", " ", " ", "\n", "\n  ", " -- c\n"][random.below(6)]);
    }
    text
}

#[derive(Default)]
struct TokenRecorder {
    tokens: Vec<Token>,
    found: Vec<Diagnostic>,
}

impl Actions for TokenRecorder {
    fn act_advance(&mut self, token: Token) {
        self.tokens.push(token);
    }

    fn act_error(&mut self, diagnostic: Diagnostic) {
        self.found.push(diagnostic);
    }
}

#[test]
fn the_parser_and_the_table_accept_the_same_texts() {
    let grammar = Productions::new(Nonterminal::Script, PRODUCTIONS);
    let table = grammar.table();
    let mut random = Random(7);
    let (mut accepted, mut rejected) = (0, 0);
    for round in 0..20_000 {
        let mut tokens = grammar.sentence(5 + round % 60, |bound| random.below(bound));
        if round % 2 == 1 && !tokens.is_empty() {
            // A token less, one more, or two that change places.
            let at = random.below(tokens.len());
            match random.below(3) {
                0 => drop(tokens.remove(at)),
                1 => tokens.insert(at, tokens[random.below(tokens.len())]),
                _ => {
                    let other = random.below(tokens.len());
                    tokens.swap(at, other);
                }
            }
        }
        let text = write(&mut random, &tokens);
        let mut recorder = TokenRecorder::default();
        parse_script(&text, &mut recorder);
        let seen = recorder.tokens.iter().map(|token| token.kind);
        let seen: Vec<_> = seen.filter(|kind| *kind != TokenKind::Comment).collect();
        let expected = table.accepts(&seen);
        let of_names = [
            codes::MISSING_ATTRIBUTE,
            codes::UNKNOWN_ATTRIBUTE,
            codes::DUPLICATE_PARAMETER,
            codes::NOT_ASSIGNABLE,
        ];
        let error = recorder
            .found
            .iter()
            .find(|it| it.severity == Severity::Error && !of_names.contains(&it.code));
        assert_eq!(error.is_none(), expected, "{text}\n{error:?}");
        if expected {
            accepted += 1;
        } else {
            rejected += 1;
        }
    }
    assert!(accepted > 4000 && rejected > 4000, "{accepted} {rejected}");
}
