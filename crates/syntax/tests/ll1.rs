//! The grammar is LL(1), the parser follows it, and it is the language's own grammar.

#[path = "support/productions.rs"]
mod productions;
#[path = "support/recorder.rs"]
mod support;

use std::collections::{BTreeSet, HashSet};

use productions::Productions;
use support::parse;
use syntax::diagnostic::Severity;
use syntax::geotrace::codes;
use syntax::geotrace::declarations::{DeclarationKeyword, Syntax};
use syntax::geotrace::grammar::{Nonterminal, PRODUCTIONS, Terminal};
use syntax::geotrace::token::TokenKind;
use syntax::productions::{Item, Production};

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

fn factored() -> Productions<Nonterminal, Terminal> {
    Productions::new(Nonterminal::Prog, PRODUCTIONS)
}

/// The productions of the language's page, by numbered nonterminals; 0 is the start.
fn original() -> Productions<usize, Terminal> {
    let joined = original_text().replace("\n      |", " |");
    let lines = joined.lines().filter_map(|line| line.split_once(" = "));
    let lines: Vec<(&str, String)> = lines
        .map(|(left, right)| (left.trim(), format!("{right} ")))
        .collect();
    let symbol = |word: &str| match TERMINALS.iter().find(|(text, _)| *text == word) {
        Some((_, terminal)) => Item::T(*terminal),
        None => {
            let defined = lines.iter().position(|(left, _)| *left == word);
            Item::N(defined.unwrap_or_else(|| {
                panic!("{word} in docs/language.md is neither defined there nor in TERMINALS")
            }))
        }
    };
    let mut productions = Vec::new();
    for (left, (_, right)) in lines.iter().enumerate() {
        // The bar that is a terminal stands between quotes.
        for alternative in right.split(" | ") {
            let items: Vec<_> = alternative.split_whitespace().map(symbol).collect();
            let right: &'static [_] = items.leak();
            productions.push(Production { left, right });
        }
    }
    Productions::new(0, productions.leak())
}

#[test]
fn no_two_alternatives_of_a_nonterminal_begin_alike() {
    let grammar = factored();
    let table = grammar.table();
    assert_eq!(
        table.conflicts().keys().collect::<Vec<_>>(),
        Vec::<&(_, _)>::new()
    );
    // The sets themselves, where the language's page lets them be read off.
    let unary = grammar.first(Nonterminal::Unary);
    assert_eq!(unary.len(), 4 + 7);
    assert!(!unary.contains(&Some(Terminal::Caret)) && !unary.contains(&None));
    assert_eq!(grammar.first(Nonterminal::Tuple), unary);
    assert_eq!(grammar.follow(Nonterminal::Prog), BTreeSet::from([None]));
    let behind = grammar.follow(Nonterminal::Expr);
    assert!(behind.contains(&Some(Terminal::At)));
}

#[test]
fn a_conflict_would_be_found() {
    use {Item::N, Item::T};
    // 0 = 1 0 | ; 1 = "+" | "+" num
    static AMBIGUOUS: [Production<usize, char>; 4] = [
        Production {
            left: 0,
            right: &[N(1), N(0)],
        },
        Production {
            left: 0,
            right: &[],
        },
        Production {
            left: 1,
            right: &[T('+')],
        },
        Production {
            left: 1,
            right: &[T('+'), T('n')],
        },
    ];
    let grammar = Productions::new(0, &AMBIGUOUS);
    assert_eq!(grammar.first(0), BTreeSet::from([None, Some('+')]));
    assert_eq!(grammar.follow(1), BTreeSet::from([None, Some('+')]));
    let table = grammar.table();
    assert_eq!(
        table.conflicts().into_keys().collect::<Vec<_>>(),
        [(1, Some('+'))]
    );
}

#[test]
fn every_nonterminal_is_derived_and_reached() {
    let (defined, reached) = factored().nonterminals();
    assert_eq!(defined, reached);
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

/// Earley's recogniser: any grammar, left-recursive or not.
struct Earley(Vec<Vec<&'static [Item<usize, Terminal>]>>);

impl Earley {
    fn new(grammar: &Productions<usize, Terminal>) -> Self {
        let mut rules = Vec::new();
        for production in grammar.productions() {
            rules.resize(rules.len().max(production.left + 1), Vec::new());
            rules[production.left].push(production.right);
        }
        Self(rules)
    }

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
                    Some(Item::T(terminal)) => {
                        if text.get(at) == Some(terminal) {
                            add(
                                &mut sets,
                                at + 1,
                                (nonterminal, alternative, dot + 1, origin),
                            );
                        }
                    }
                    Some(Item::N(wanted)) => {
                        for k in 0..self.0[*wanted].len() {
                            add(&mut sets, at, (*wanted, k, 0, at));
                        }
                        if self.0[*wanted].iter().any(|it| it.is_empty()) {
                            add(&mut sets, at, (nonterminal, alternative, dot + 1, origin));
                        }
                    }
                    None => {
                        for (parent, k, dot, start) in sets[origin].clone() {
                            let awaits = self.0[parent][k].get(dot);
                            if matches!(awaits, Some(Item::N(n)) if *n == nonterminal) {
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
    let (original, factored) = (original(), factored());
    let (page, table) = (Earley::new(&original), factored.table());
    let mut random = Random(1);
    let (mut accepted, mut rejected) = (0, 0);
    for k in 0..6000 {
        let below = |bound| random.below(bound);
        let mut text = match k % 2 {
            0 => original.sentence(5 + k % 25, below),
            _ => factored.sentence(5 + k % 25, below),
        };
        if text.len() > 60 {
            continue;
        }
        for _ in 0..random.below(3) {
            mutate(&mut text, &mut random);
        }
        let expected = page.accepts(&text);
        assert_eq!(table.accepts(&text), expected, "{text:?}");
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
    let (original, table) = (original(), factored().table());
    let mut random = Random(2);
    let (mut accepted, mut rejected) = (0, 0);
    for k in 0..20_000 {
        let mut terminals = original.sentence(5 + k % 60, |bound| random.below(bound));
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
        let expected = seen.is_some_and(|seen| table.accepts(&seen));
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
