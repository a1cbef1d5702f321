//! The grammar of CRT scripts is LL(1) but for four cells, and the parser follows it.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use syntax::crt::actions::Actions;
use syntax::crt::codes;
use syntax::crt::grammar::{GREEDY, Item, Nonterminal, PRODUCTIONS};
use syntax::crt::parse_script;
use syntax::crt::token::{Token, TokenKind};
use syntax::diagnostic::{Diagnostic, Severity};

/// A set of tokens; `None` is the end of the input in FOLLOW, and the empty word in FIRST.
type Set = BTreeSet<Option<TokenKind>>;
type Cell = (Nonterminal, Option<TokenKind>);
type Table = BTreeMap<Cell, &'static [Item]>;

/// FIRST and FOLLOW by iteration to the least fixed point.
#[derive(Default)]
struct Sets {
    first: BTreeMap<Nonterminal, Set>,
    follow: BTreeMap<Nonterminal, Set>,
}

impl Sets {
    fn new() -> Self {
        let mut sets = Self::default();
        sets.follow.insert(Nonterminal::Script, Set::from([None]));
        loop {
            let size = |sets: &Self| -> usize {
                let all = sets.first.values().chain(sets.follow.values());
                all.map(Set::len).sum()
            };
            let before = size(&sets);
            for production in PRODUCTIONS {
                let first = sets.first_of(production.right);
                sets.first.entry(production.left).or_default().extend(first);
                for (k, item) in production.right.iter().enumerate() {
                    if let Item::N(nonterminal) = item {
                        let mut after = sets.first_of(&production.right[k + 1..]);
                        if after.remove(&None) {
                            after.extend(
                                sets.follow
                                    .get(&production.left)
                                    .cloned()
                                    .unwrap_or_default(),
                            );
                        }
                        sets.follow.entry(*nonterminal).or_default().extend(after);
                    }
                }
            }
            if size(&sets) == before {
                return sets;
            }
        }
    }

    fn first_of(&self, items: &[Item]) -> Set {
        let mut result = Set::new();
        for item in items {
            let mut first = match item {
                Item::T(kind) => Set::from([Some(*kind)]),
                Item::N(nonterminal) => self.first.get(nonterminal).cloned().unwrap_or_default(),
            };
            let is_empty = first.remove(&None);
            result.extend(first);
            if !is_empty {
                return result;
            }
        }
        result.insert(None);
        result
    }

    /// The table, and its cells with two productions. Of these the one that is not empty is taken.
    fn table(&self) -> (Table, BTreeSet<Cell>) {
        let mut table = Table::new();
        let mut conflicts = BTreeSet::new();
        for production in PRODUCTIONS {
            let mut lookaheads = self.first_of(production.right);
            if lookaheads.remove(&None) {
                lookaheads.extend(self.follow[&production.left].clone());
            }
            for lookahead in lookaheads {
                let cell = (production.left, lookahead);
                if let Some(other) = table.get(&cell) {
                    conflicts.insert(cell);
                    assert!(other.is_empty() != production.right.is_empty(), "{cell:?}");
                }
                if !production.right.is_empty() || !table.contains_key(&cell) {
                    table.insert(cell, production.right);
                }
            }
        }
        (table, conflicts)
    }
}

fn accepts(table: &Table, text: &[TokenKind]) -> bool {
    let mut stack = vec![Item::N(Nonterminal::Script)];
    let mut rest = text.iter().copied().peekable();
    while let Some(item) = stack.pop() {
        match item {
            Item::T(kind) if rest.peek() == Some(&kind) => {
                rest.next();
            }
            Item::T(_) => return false,
            Item::N(nonterminal) => match table.get(&(nonterminal, rest.peek().copied())) {
                Some(right) => stack.extend(right.iter().rev()),
                None => return false,
            },
        }
    }
    rest.next().is_none()
}

#[test]
fn the_grammar_has_the_four_known_conflicts_and_no_others() {
    let (_, conflicts) = Sets::new().table();
    let known = GREEDY.map(|(nonterminal, kind)| (nonterminal, Some(kind)));
    assert_eq!(conflicts, BTreeSet::from(known));
    let defined: HashSet<_> = PRODUCTIONS.iter().map(|it| it.left).collect();
    let mut used = HashSet::from([Nonterminal::Script]);
    for item in PRODUCTIONS.iter().flat_map(|production| production.right) {
        if let Item::N(nonterminal) = item {
            used.insert(*nonterminal);
        }
    }
    assert_eq!(defined, used);
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

/// The least number of steps in which each nonterminal ends.
fn heights() -> BTreeMap<Nonterminal, usize> {
    let mut heights = BTreeMap::new();
    for _ in 0..40 {
        for production in PRODUCTIONS {
            if let Some(height) = height(production.right, &heights) {
                let known = heights.entry(production.left).or_insert(usize::MAX);
                *known = (*known).min(height + 1);
            }
        }
    }
    heights
}

fn height(items: &[Item], heights: &BTreeMap<Nonterminal, usize>) -> Option<usize> {
    let each = items.iter().map(|item| match item {
        Item::T(_) => Some(0),
        Item::N(nonterminal) => heights.get(nonterminal).copied(),
    });
    each.sum()
}

/// A random sentence; once it is about `budget` long, the shortest ways out are taken.
fn sentence(
    random: &mut Random,
    heights: &BTreeMap<Nonterminal, usize>,
    budget: usize,
) -> Vec<TokenKind> {
    let mut text = Vec::new();
    let mut stack = vec![Item::N(Nonterminal::Script)];
    while let Some(item) = stack.pop() {
        match item {
            Item::T(kind) => text.push(kind),
            Item::N(nonterminal) => {
                let all: Vec<_> = PRODUCTIONS
                    .iter()
                    .filter(|it| it.left == nonterminal)
                    .collect();
                let chosen = if text.len() + stack.len() > budget {
                    let least = all.iter().min_by_key(|it| height(it.right, heights));
                    least.expect("a production").right
                } else {
                    all[random.below(all.len())].right
                };
                stack.extend(chosen.iter().rev());
            }
        }
    }
    text
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
    let (table, _) = Sets::new().table();
    let heights = heights();
    let mut random = Random(7);
    let (mut accepted, mut rejected) = (0, 0);
    for round in 0..20_000 {
        let mut tokens = sentence(&mut random, &heights, 5 + round % 60);
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
        let expected = accepts(&table, &seen);
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
