//! The grammar is LL(1), the parser follows it, and it is the language's own grammar.

#[path = "support/recorder.rs"]
mod support;

use std::collections::{BTreeMap, BTreeSet, HashSet};

use support::parse;
use syntax::diagnostic::Severity;
use syntax::geotrace::codes;
use syntax::geotrace::declarations::{DeclarationKeyword, Syntax};
use syntax::geotrace::grammar::{Item, Nonterminal, PRODUCTIONS, Production, Terminal};
use syntax::geotrace::token::TokenKind;

/// The grammar as the language's page states it, left recursion and all.
fn original_text() -> String {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/language.md");
    let page = std::fs::read_to_string(path).expect("docs/language.md");
    let block = page.split("```grammar\n").nth(1);
    let block = block.and_then(|rest| rest.split("```").next());
    block.expect("a grammar in docs/language.md").to_owned()
}

const TERMINALS: &[(&str, Terminal)] = &[
    ("\"param\"", Terminal::Keyword(DeclarationKeyword::Param)),
    ("\"grid\"", Terminal::Keyword(DeclarationKeyword::Grid)),
    ("\"define\"", Terminal::Keyword(DeclarationKeyword::Define)),
    (
        "\"function\"",
        Terminal::Keyword(DeclarationKeyword::Function),
    ),
    ("\"curve\"", Terminal::Keyword(DeclarationKeyword::Curve)),
    (
        "\"surface\"",
        Terminal::Keyword(DeclarationKeyword::Surface),
    ),
    ("\"point\"", Terminal::Keyword(DeclarationKeyword::Point)),
    ("\"vector\"", Terminal::Keyword(DeclarationKeyword::Vector)),
    ("\"metric\"", Terminal::Keyword(DeclarationKeyword::Metric)),
    (
        "\"geodesic\"",
        Terminal::Keyword(DeclarationKeyword::Geodesic),
    ),
    ("\"solid\"", Terminal::Keyword(DeclarationKeyword::Solid)),
    ("\"light\"", Terminal::Keyword(DeclarationKeyword::Light)),
    ("\"camera\"", Terminal::Keyword(DeclarationKeyword::Camera)),
    (
        "\"background\"",
        Terminal::Keyword(DeclarationKeyword::Background),
    ),
    ("tag", Terminal::Tag),
    ("attr", Terminal::Attr),
    ("key", Terminal::Key),
    ("word", Terminal::Word),
    ("map", Terminal::Map),
    ("\"|\"", Terminal::Bar),
    ("\"&\"", Terminal::Ampersand),
    ("\"\\\"", Terminal::Backslash),
    ("id", Terminal::Id),
    ("const", Terminal::Const),
    ("func", Terminal::Func),
    ("var", Terminal::Var),
    ("num", Terminal::Num),
    ("\"+\"", Terminal::Plus),
    ("\"-\"", Terminal::Minus),
    ("\"*\"", Terminal::Star),
    ("\"/\"", Terminal::Slash),
    ("\"^\"", Terminal::Caret),
    ("\"_\"", Terminal::Underscore),
    ("\"'\"", Terminal::Prime),
    ("\"(\"", Terminal::ParenOpen),
    ("\")\"", Terminal::ParenClose),
    ("\"[\"", Terminal::BracketOpen),
    ("\"]\"", Terminal::BracketClose),
    ("\"{\"", Terminal::BraceOpen),
    ("\"}\"", Terminal::BraceClose),
    ("\",\"", Terminal::Comma),
    ("\";\"", Terminal::Semicolon),
    ("\":\"", Terminal::Colon),
    ("\"=\"", Terminal::Equals),
    ("\"@\"", Terminal::At),
];

/// A set of terminals; `None` is the end of the input in FOLLOW, and the empty word in FIRST.
type Set = BTreeSet<Option<Terminal>>;

struct Sets {
    first: BTreeMap<Nonterminal, Set>,
    follow: BTreeMap<Nonterminal, Set>,
}

impl Sets {
    /// Both by iteration to the least fixed point.
    fn of(productions: &[Production]) -> Self {
        let mut sets = Self {
            first: BTreeMap::new(),
            follow: BTreeMap::new(),
        };
        sets.follow
            .entry(Nonterminal::Prog)
            .or_default()
            .insert(None);
        loop {
            let before = sets.size();
            for Production { left, right } in productions {
                let first = sets.first_of(right);
                sets.first.entry(*left).or_default().extend(first);
                for (k, item) in right.iter().enumerate() {
                    if let Item::N(nonterminal) = item {
                        let mut after = sets.first_of(&right[k + 1..]);
                        if after.remove(&None) {
                            after.extend(sets.follow.get(left).cloned().unwrap_or_default());
                        }
                        sets.follow.entry(*nonterminal).or_default().extend(after);
                    }
                }
            }
            if sets.size() == before {
                return sets;
            }
        }
    }

    fn size(&self) -> usize {
        self.first
            .values()
            .chain(self.follow.values())
            .map(Set::len)
            .sum()
    }

    fn first_of(&self, items: &[Item]) -> Set {
        let mut result = Set::new();
        for item in items {
            match item {
                Item::T(terminal) => {
                    result.insert(Some(*terminal));
                    return result;
                }
                Item::N(nonterminal) => {
                    let mut first = self.first.get(nonterminal).cloned().unwrap_or_default();
                    let empty = first.remove(&None);
                    result.extend(first);
                    if !empty {
                        return result;
                    }
                }
            }
        }
        result.insert(None);
        result
    }

    /// The lookaheads that choose a production.
    fn predict(&self, production: &Production) -> Set {
        let mut set = self.first_of(production.right);
        if set.remove(&None) {
            set.extend(self.follow[&production.left].clone());
        }
        set
    }

    /// The LL(1) table, and what stands in the way of there being one.
    fn table(&self, productions: &'static [Production]) -> (Table, Vec<String>) {
        let mut table = Table::new();
        let mut conflicts = Vec::new();
        for production in productions {
            for lookahead in self.predict(production) {
                let key = (production.left, lookahead);
                if table.insert(key, production.right).is_some() {
                    conflicts.push(format!("{key:?}"));
                }
            }
        }
        (table, conflicts)
    }
}

type Table = BTreeMap<(Nonterminal, Option<Terminal>), &'static [Item]>;

fn table() -> Table {
    Sets::of(PRODUCTIONS).table(PRODUCTIONS).0
}

/// The table-driven recogniser.
fn accepts(table: &Table, text: &[Terminal]) -> bool {
    let mut stack = vec![Item::N(Nonterminal::Prog)];
    let mut rest = text.iter().copied().peekable();
    while let Some(item) = stack.pop() {
        match item {
            Item::T(terminal) if rest.peek() == Some(&terminal) => {
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
fn no_two_alternatives_of_a_nonterminal_begin_alike() {
    let sets = Sets::of(PRODUCTIONS);
    assert_eq!(sets.table(PRODUCTIONS).1, Vec::<String>::new());
    // The sets themselves, where the language's page lets them be read off.
    let first = |nonterminal| sets.first[&nonterminal].clone();
    let unary = first(Nonterminal::Unary);
    assert_eq!(unary.len(), 4 + 7);
    assert!(!unary.contains(&Some(Terminal::Caret)) && !unary.contains(&None));
    assert_eq!(first(Nonterminal::Tuple), unary);
    assert_eq!(sets.follow[&Nonterminal::Prog], Set::from([None]));
    assert!(sets.follow[&Nonterminal::Expr].contains(&Some(Terminal::At)));
}

#[test]
fn a_conflict_would_be_found() {
    use {Item::N, Item::T};
    static AMBIGUOUS: [Production; 4] = [
        Production {
            left: Nonterminal::Prog,
            right: &[N(Nonterminal::Add), N(Nonterminal::Prog)],
        },
        Production {
            left: Nonterminal::Prog,
            right: &[],
        },
        Production {
            left: Nonterminal::Add,
            right: &[T(Terminal::Plus)],
        },
        Production {
            left: Nonterminal::Add,
            right: &[T(Terminal::Plus), T(Terminal::Num)],
        },
    ];
    assert_eq!(
        Sets::of(&AMBIGUOUS).table(&AMBIGUOUS).1,
        ["(Add, Some(Plus))"]
    );
}

#[test]
fn every_nonterminal_is_derived_and_reached() {
    let defined: HashSet<_> = PRODUCTIONS
        .iter()
        .map(|production| production.left)
        .collect();
    let mut used = HashSet::from([Nonterminal::Prog]);
    for item in PRODUCTIONS.iter().flat_map(|production| production.right) {
        if let Item::N(nonterminal) = item {
            used.insert(*nonterminal);
        }
    }
    assert_eq!(defined, used);
    assert_eq!((defined.len(), PRODUCTIONS.len()), (51, 112));
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

/// A symbol of a grammar, whichever it is.
#[derive(Clone, Debug)]
enum Symbol {
    T(Terminal),
    N(usize),
}

/// A grammar by numbered nonterminals; 0 is the start.
struct Grammar(Vec<Vec<Vec<Symbol>>>);

impl Grammar {
    fn factored() -> Self {
        let mut names: Vec<Nonterminal> = Vec::new();
        for production in PRODUCTIONS {
            if !names.contains(&production.left) {
                names.push(production.left);
            }
        }
        let number = |name: &Nonterminal| names.iter().position(|n| n == name).expect("defined");
        let mut rules = vec![Vec::new(); names.len()];
        for production in PRODUCTIONS {
            let right = production.right.iter().map(|item| match item {
                Item::T(terminal) => Symbol::T(*terminal),
                Item::N(name) => Symbol::N(number(name)),
            });
            rules[number(&production.left)].push(right.collect());
        }
        Self(rules)
    }

    fn original() -> Self {
        let joined = original_text().replace("\n      |", " |");
        let lines = joined.lines().filter_map(|line| line.split_once(" = "));
        let lines: Vec<(&str, String)> = lines
            .map(|(left, right)| (left.trim(), format!("{right} ")))
            .collect();
        let symbol = |word: &str| match TERMINALS.iter().find(|(text, _)| *text == word) {
            Some((_, terminal)) => Symbol::T(*terminal),
            None => {
                let defined = lines.iter().position(|(left, _)| *left == word);
                Symbol::N(defined.unwrap_or_else(|| {
                    panic!("{word} in docs/language.md is neither defined there nor in TERMINALS")
                }))
            }
        };
        let alternative = |text: &str| text.split_whitespace().map(symbol).collect();
        // The bar that is a terminal stands between quotes.
        let rules = lines
            .iter()
            .map(|(_, right)| right.split(" | ").map(alternative).collect());
        Self(rules.collect())
    }

    /// The least number of steps in which each nonterminal ends.
    fn heights(&self) -> Vec<usize> {
        let mut heights = vec![usize::MAX; self.0.len()];
        for _ in 0..self.0.len() {
            for (nonterminal, alternatives) in self.0.iter().enumerate() {
                for alternative in alternatives {
                    let height = height(alternative, &heights);
                    heights[nonterminal] = heights[nonterminal].min(height.saturating_add(1));
                }
            }
        }
        heights
    }

    /// A random sentence; once it is about `budget` long, the shortest ways out are taken.
    fn sentence(&self, random: &mut Random, budget: usize) -> Vec<Terminal> {
        let heights = self.heights();
        let mut text = Vec::new();
        let mut stack = vec![Symbol::N(0)];
        while let Some(symbol) = stack.pop() {
            match symbol {
                Symbol::T(terminal) => text.push(terminal),
                Symbol::N(nonterminal) => {
                    let alternatives = &self.0[nonterminal];
                    let chosen = if text.len() + stack.len() > budget {
                        alternatives
                            .iter()
                            .min_by_key(|a| height(a, &heights))
                            .expect("one")
                    } else {
                        &alternatives[random.below(alternatives.len())]
                    };
                    stack.extend(chosen.iter().rev().cloned());
                }
            }
        }
        text
    }

    /// Earley's recogniser: any grammar, left-recursive or not.
    fn accepts(&self, text: &[Terminal]) -> bool {
        // (nonterminal, alternative, position in it, where it began)
        type Step = (usize, usize, usize, usize);
        let mut sets: Vec<Vec<Step>> = vec![Vec::new(); text.len() + 1];
        let mut seen: Vec<HashSet<Step>> = vec![HashSet::new(); text.len() + 1];
        let mut add = |sets: &mut Vec<Vec<Step>>, at: usize, step: Step| {
            if seen[at].insert(step) {
                sets[at].push(step);
            }
        };
        for alternative in 0..self.0[0].len() {
            add(&mut sets, 0, (0, alternative, 0, 0));
        }
        for at in 0..=text.len() {
            let mut next = 0;
            while let Some(&(nonterminal, alternative, dot, origin)) = sets[at].get(next) {
                next += 1;
                match self.0[nonterminal][alternative].get(dot) {
                    Some(Symbol::T(terminal)) => {
                        if text.get(at) == Some(terminal) {
                            add(
                                &mut sets,
                                at + 1,
                                (nonterminal, alternative, dot + 1, origin),
                            );
                        }
                    }
                    Some(Symbol::N(wanted)) => {
                        for k in 0..self.0[*wanted].len() {
                            add(&mut sets, at, (*wanted, k, 0, at));
                        }
                        if self.0[*wanted].iter().any(Vec::is_empty) {
                            add(&mut sets, at, (nonterminal, alternative, dot + 1, origin));
                        }
                    }
                    None => {
                        for (parent, k, dot, start) in sets[origin].clone() {
                            let awaits = self.0[parent][k].get(dot);
                            if matches!(awaits, Some(Symbol::N(n)) if *n == nonterminal) {
                                add(&mut sets, at, (parent, k, dot + 1, start));
                            }
                        }
                    }
                }
            }
        }
        sets[text.len()]
            .iter()
            .any(|&(n, a, dot, origin)| n == 0 && origin == 0 && dot == self.0[n][a].len())
    }
}

fn height(alternative: &[Symbol], heights: &[usize]) -> usize {
    let height = |symbol: &Symbol| match symbol {
        Symbol::T(_) => 0,
        Symbol::N(nonterminal) => heights[*nonterminal],
    };
    alternative.iter().map(height).max().unwrap_or(0)
}

/// Changes a text in one place.
fn mutate(text: &mut Vec<Terminal>, random: &mut Random) {
    let terminal = TERMINALS[random.below(TERMINALS.len())].1;
    let at = random.below(text.len() + 1);
    match random.below(4) {
        0 => text.insert(at, terminal),
        1 if at < text.len() => text[at] = terminal,
        2 if at < text.len() => {
            text.remove(at);
        }
        _ if at + 1 < text.len() => text.swap(at, at + 1),
        _ => {}
    }
}

#[test]
fn the_factored_grammar_is_the_language_s_own() {
    let (original, factored, table) = (Grammar::original(), Grammar::factored(), table());
    let mut random = Random(1);
    let (mut accepted, mut rejected) = (0, 0);
    for k in 0..6000 {
        let grammar = if k % 2 == 0 { &original } else { &factored };
        let mut text = grammar.sentence(&mut random, 5 + k % 25);
        if text.len() > 60 {
            continue;
        }
        for _ in 0..random.below(3) {
            mutate(&mut text, &mut random);
        }
        let expected = original.accepts(&text);
        assert_eq!(accepts(&table, &text), expected, "{text:?}");
        if expected {
            accepted += 1
        } else {
            rejected += 1
        }
    }
    assert!(accepted > 1000 && rejected > 1000, "{accepted} {rejected}");
}

/// A text whose tokens are, as far as names allow, the given ones.
fn render(terminals: &[Terminal]) -> String {
    let mut text = String::from("function g(q) = q; define c = 1;\n");
    let mut fresh = 0;
    // The keyword of the declaration that is being read, its first parameter, and whether that is a variable here.
    let mut keyword = DeclarationKeyword::Define;
    let (mut parameter, mut in_body): (Option<String>, bool) = (None, false);
    for (k, terminal) in terminals.iter().enumerate() {
        let previous = k.checked_sub(1).map(|k| terminals[k]);
        let word = match terminal {
            Terminal::Id => {
                fresh += 1;
                let name = format!("n{fresh}x");
                if keyword.may_have_parameters()
                    && parameter.is_none()
                    && previous == Some(Terminal::ParenOpen)
                {
                    parameter = Some(name.clone());
                }
                name
            }
            Terminal::Var if previous == Some(Terminal::Underscore) => "q".to_owned(),
            Terminal::Var => {
                let variable = parameter.clone().filter(|_| in_body);
                variable.unwrap_or_else(|| "c".to_owned())
            }
            Terminal::Const => "c".to_owned(),
            Terminal::Func => "g".to_owned(),
            Terminal::Num => "2".to_owned(),
            Terminal::Tag => parameter.clone().unwrap_or_else(|| "t".to_owned()),
            Terminal::Attr => "color".to_owned(),
            Terminal::Key => "image".to_owned(),
            Terminal::Word => "earth".to_owned(),
            Terminal::Map => "scale".to_owned(),
            Terminal::Equals => {
                let is_field = keyword.row().syntax != Syntax::InSurface;
                in_body = parameter.is_some() && is_field;
                if keyword == DeclarationKeyword::Solid && parameter.is_none() {
                    parameter = Some("x".to_owned());
                }
                "=".to_owned()
            }
            Terminal::Colon => {
                in_body = previous == Some(Terminal::Attr);
                ":".to_owned()
            }
            _ => {
                let found = TERMINALS.iter().find(|(_, other)| other == terminal);
                found.expect("a terminal").0.trim_matches('"').to_owned()
            }
        };
        if let Terminal::Keyword(found) = terminal {
            keyword = *found;
            (parameter, in_body) = (None, false);
        }
        text.push_str(&word);
        text.push(' ');
    }
    text
}

#[test]
fn parser_and_table_agree_on_random_texts() {
    let (original, table) = (Grammar::original(), table());
    let mut random = Random(2);
    let (mut accepted, mut rejected) = (0, 0);
    for k in 0..20_000 {
        let mut terminals = original.sentence(&mut random, 5 + k % 60);
        for _ in 0..random.below(3) {
            mutate(&mut terminals, &mut random);
        }
        let text = render(&terminals);
        let (recorder, _) = parse(&text);
        // What the lexer made of the names is what the table is asked about. A tag may be a parameter.
        let kinds: Vec<TokenKind> = recorder.tokens.iter().map(|token| token.kind).collect();
        let is_tag = |k: usize| {
            matches!(kinds[k], TokenKind::Variable(_) | TokenKind::Undefined)
                && k > 0
                && kinds[k - 1] == TokenKind::Comma
                && kinds.get(k + 1) == Some(&TokenKind::Colon)
        };
        let seen = (0..kinds.len()).map(|k| match is_tag(k) {
            true => Some(Terminal::Tag),
            false => Terminal::from_token(kinds[k]),
        });
        // A sign that is no token there is none of any sentence.
        let seen: Option<Vec<Terminal>> = seen.collect();
        let expected = seen.is_some_and(|seen| accepts(&table, &seen));
        // Which name stands at a place is no business of the grammar.
        let of_names = [
            codes::UNKNOWN_TAG,
            codes::DUPLICATE_PARAMETER,
            codes::DUPLICATE_ATTRIBUTE,
            codes::ATTRIBUTE_NOT_HERE,
        ];
        let mut errors = recorder.diagnostics.iter().filter(|diagnostic| {
            diagnostic.severity == Severity::Error && !of_names.contains(&diagnostic.code)
        });
        let error = errors.next();
        assert_eq!(error.is_none(), expected, "{text}\n{error:?}");
        if expected {
            accepted += 1
        } else {
            rejected += 1
        }
    }
    assert!(accepted > 4000 && rejected > 4000, "{accepted} {rejected}");
}
