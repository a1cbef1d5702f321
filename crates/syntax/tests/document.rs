//! The incremental document: equal to reading the whole text after every edit, whatever the edit is, and by
//! reading no more than it has to.

use std::fmt::Write as _;

use syntax::diagnostic::Diagnostic;
use syntax::document::{ChunkId, EditError};
use syntax::geotrace::actions::{Actions, Declaration, Interval, Operator, StatedAttribute};
use syntax::geotrace::declarations::DeclarationKeyword;
use syntax::geotrace::document::{Document, ParseEvent};
use syntax::geotrace::parse_program;
use syntax::geotrace::symbols::{Symbol, Vocabulary};
use syntax::geotrace::token::{Token, TokenKind};
use syntax::line_index::{LineIndex, Position};
use syntax::span::Span;
use syntax::symbol::SymbolId;

fn vocabulary() -> Vocabulary {
    let functions = ["sin", "cos", "exp", "asin"];
    Vocabulary::new(&["pi", "e"], &functions).with_inverse("sin", "asin")
}

/// What reading a text calls, as lines; symbols by their names and places, for identifiers differ.
#[derive(Default)]
struct Transcript {
    lines: Vec<String>,
    tokens: Vec<Token>,
    events: Vec<ParseEvent<'static>>,
    diagnostics: Vec<Diagnostic>,
}

impl Actions for Transcript {
    fn act_advance(&mut self, token: Token) {
        self.tokens.push(token);
    }
    fn act_declaration_start(&mut self, keyword: DeclarationKeyword, span: Span) {
        self.events.push(ParseEvent::Open(keyword, span));
    }
    fn act_operator(&mut self, operator: Operator, span: Span) {
        self.events.push(ParseEvent::Operator(operator, span));
    }
    fn act_interval(&mut self, interval: Interval) {
        self.events.push(ParseEvent::Interval(interval));
    }
    fn act_attribute(&mut self, attribute: StatedAttribute, _: &str) {
        self.events.push(ParseEvent::Attribute(attribute, ""));
    }
    fn act_declaration(&mut self, d: &Declaration<'_>) {
        let mut line = format!("{:?} {:?} {} {:?}", d.keyword, d.span, d.name, d.name_span);
        let _ = write!(
            line,
            " {:?} {} {}",
            d.parameters,
            d.faulty,
            d.symbol.is_some()
        );
        self.lines.push(line);
    }
    fn act_error(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }
}

fn describe(symbol: Option<&Symbol>, place: Option<Span>) -> String {
    match symbol {
        Some(s) => {
            let parameters: Vec<&str> = s.parameters.iter().map(|p| &*p.name).collect();
            let Symbol {
                name,
                kind,
                keyword,
                faulty,
                ..
            } = s;
            format!("{name} {kind:?} {keyword:?} {place:?} {parameters:?} {faulty}")
        }
        None => "a symbol that is gone".to_owned(),
    }
}

fn tokens(all: impl Iterator<Item = Token>, name: impl Fn(SymbolId) -> String) -> Vec<String> {
    all.map(|token| match token.kind {
        TokenKind::Constant(id) => format!("{:?} constant {}", token.span, name(id)),
        TokenKind::Function(id) => format!("{:?} function {}", token.span, name(id)),
        kind => format!("{:?} {kind:?}", token.span),
    })
    .collect()
}

fn steps<'e>(
    events: impl Iterator<Item = (u32, ParseEvent<'e>)>,
    name: impl Fn(SymbolId) -> String,
) -> Vec<String> {
    events
        .filter_map(|(start, event)| {
            Some(match event {
                ParseEvent::Operator(Operator::Constant(id), span) => {
                    format!("{:?} {}", span.moved(start), name(id))
                }
                ParseEvent::Operator(Operator::Function(id), span) => {
                    format!("{:?} {}", span.moved(start), name(id))
                }
                ParseEvent::Operator(operator, span) => {
                    format!("{:?} {operator:?}", span.moved(start))
                }
                ParseEvent::Open(word, span) => format!("{:?} {word:?}", span.moved(start)),
                ParseEvent::Interval(interval) => {
                    let tag = interval.tag.map(|(at, span)| (at, span.moved(start)));
                    format!(
                        "{:?} {:?} {tag:?}",
                        interval.kind,
                        interval.span.moved(start)
                    )
                }
                ParseEvent::Attribute(attribute, _) => {
                    let StatedAttribute {
                        word,
                        word_span,
                        value_span,
                    } = attribute;
                    let places = [word_span, value_span].map(|span| span.moved(start));
                    format!("{word:?} {places:?}")
                }
                ParseEvent::Declaration(_) | ParseEvent::Diagnostic => return None,
            })
        })
        .collect()
}

/// Holds a document to what reading its whole text gives.
fn check(document: &Document, text: &str) {
    assert_eq!(document.text(), text);
    let mut whole = Transcript::default();
    let parsed = parse_program(text, &vocabulary(), &mut whole);
    let by_id = |id| {
        let symbol = parsed.symbols.get(id);
        describe(symbol, symbol.and_then(|symbol| symbol.name_span))
    };
    let by_handle = |id| describe(document.symbol(id), document.place(id));

    Diagnostic::sort(&mut whole.diagnostics);
    assert_eq!(document.diagnostics(), whole.diagnostics, "{text:?}");

    let all = Span::new(0, document.len());
    let found = tokens(document.tokens(all), by_handle);
    assert_eq!(found, tokens(whole.tokens.into_iter(), by_id), "{text:?}");

    let events = document.chunks().flat_map(|chunk| {
        let start = document.start(chunk);
        document.events(chunk).map(move |event| (start, event))
    });
    let found = steps(events, by_handle);
    let expected = steps(whole.events.iter().map(|event| (0, *event)), by_id);
    assert_eq!(found, expected, "{text:?}");

    let found: Vec<String> = document
        .declarations()
        .map(|(chunk, d)| {
            let start = document.start(chunk);
            let parameters = d.parameters.moved(start);
            let name_span = match d.name.is_empty() {
                true => d.name_span,
                false => d.name_span.moved(start),
            };
            let mut line = format!("{:?} {:?}", d.keyword, d.span.moved(start));
            let _ = write!(line, " {} {name_span:?} {parameters:?}", d.name);
            let _ = write!(line, " {} {}", d.faulty, d.symbol.is_some());
            line
        })
        .collect();
    assert_eq!(found, whole.lines, "{text:?}");

    let sorted = |mut symbols: Vec<String>| {
        symbols.sort();
        symbols
    };
    let found = document.symbols().map(|(id, _)| by_handle(id)).collect();
    let expected = parsed.symbols.iter().map(|(id, _)| by_id(id)).collect();
    assert_eq!(sorted(found), sorted(expected), "{text:?}");
}

/// A generator of numbers that is the same on every machine.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % bound.max(1) as u64) as usize
    }

    fn pick<'t>(&mut self, of: &[&'t str]) -> &'t str {
        of[self.below(of.len())]
    }
}

const NAMES: &[&str] = &[
    "a", "b", "ab", "abc", "s", "si", "sinx", "x", "t", "f", "g", "fg", "piu", "u", "define2",
    "radius", "radiuz", "c1", "c12", "light", "sol", "y", "xy", "scale", "color", "cam",
];

const PIECES: &[&str] = &[
    ";",
    ";",
    ";",
    "#",
    "#",
    "\n",
    "\n",
    "\r\n",
    " ",
    "=",
    "(",
    ")",
    "[",
    "]",
    ",",
    ":",
    "@",
    "_",
    "'",
    "^",
    "+",
    "2",
    ".",
    "1e",
    "e",
    "\u{FEFF}",
    "é",
    "𝔘",
    "# 𝔘𝔫𝔦 ; π\n",
    "define ",
    "param ",
    "function ",
    "curve ",
    "point",
    "sint",
    "sinx",
    "a",
    "b",
    "ab",
    "abc",
    "x",
    "f_x",
    "f_",
    "f'",
    "f(x)_1",
    "sin(x)^2",
    "sin 2x",
    "sin^-1 x",
    "asint",
    "sin-1x",
    "sin⁻¹",
    "2^ab",
    "a(2)",
    "(1 2)",
    "0..1",
    "a.b",
    "zz.ab",
    "\\times",
    "（",
    "；",
    "defin",
    "piu",
    "raduis",
    "define a = 1;",
    "define ab = a b;",
    "function f(x) = x a + sinx;",
    "function g(x, t) = f x t ab;",
    "curve c(t) = (t, a, ab), t : [0, 1];",
    "param abc : [0, a];",
    "param ab = 2a : [0, 9];",
    "define define b = abc",
    "\nmetric m(u, v) = (1, 0, u), u : [0, 1], v : [0, b];",
    "|",
    "&",
    "\\",
    "solid ",
    "light ",
    "camera",
    "background b",
    "color : x",
    "; t : [0, 1]",
    ";\n x: ",
    ", x : [0, 1]",
    "scale 2",
    "rotate",
    "bokeh : star",
    "image : earth",
    "solid s = f @ a & (g \\ fg @ scale 2), color : xy + x, mirror : a;",
    "solid ab(x, y) = x y - a, y : [0, 1], bump : ab;",
    "light sol = @ a, radius : b;",
    "light light = a @ b;",
    "camera cam = a @ b, fov : 1, bokeh : star;",
    "background b(x, t, u) = (x, t, u);",
    "background a = light;",
    "solid t = s @ f @ rotate x | sol",
    "point x = s_x(1, 2, a), color : a;",
    "\ngeodesic k(t) : m = (1, a) @ (0, 0), t : [0, 1];",
];

fn declaration(random: &mut Random) -> String {
    let name = random.pick(NAMES);
    let other = random.pick(NAMES);
    let word = [random.pick(NAMES), random.pick(NAMES)].concat();
    let third = random.pick(NAMES);
    match random.below(10) {
        0 => format!("define {name} = {other} + {word};\n"),
        1 => format!("function {name}({other}) = {word} {other} - {third};\n"),
        2 => format!("function {name}(x, t) = {word}x + {other}_x(x, t) t;\n"),
        3 => format!("param {name} : [0, {other}];"),
        4 => format!("curve {name}(t) = ({word}, {third}, 0), t : [0, 2{other}]; # {word} ;\n"),
        5 => format!("# 𝔘 {word}\npoint {name} = (1, {other}, {third});\n"),
        6 => format!("define {name} = {other}"),
        7 => format!("{name} = {other}{word};\n"),
        8 => format!("define {name} = sin({other})^2 {word}; define {third} = 2;"),
        _ => format!("define {name} = {word};\n"),
    }
}

/// One random edit: where, and what comes there.
fn edit(random: &mut Random, text: &str) -> (Span, String) {
    let boundary = |at: usize| {
        let mut at = at.min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    let length = text.len();
    let at = boundary(random.below(length + 1));
    let reach = match random.below(8) {
        0..=3 => 0,
        4 | 5 => 1 + random.below(3),
        6 => random.below(24),
        _ => random.below(if length > 260 { length } else { 60 }),
    };
    let end = boundary(at + reach).max(at);
    let inserted = match random.below(8) {
        _ if length > 420 => String::new(),
        0 if reach > 0 => String::new(),
        1 => declaration(random),
        2 => random.pick(NAMES).to_owned(),
        _ => random.pick(PIECES).to_owned(),
    };
    // A whole word is renamed now and then.
    if random.below(6) == 0 {
        let is_word = |byte: u8| byte.is_ascii_alphanumeric();
        let bytes = text.as_bytes();
        let mut start = at;
        while start > 0 && is_word(bytes[start - 1]) {
            start -= 1;
        }
        let mut end = at;
        while end < length && is_word(bytes[end]) {
            end += 1;
        }
        return (
            Span::new(start as u32, end as u32),
            random.pick(NAMES).to_owned(),
        );
    }
    (Span::new(at as u32, end as u32), inserted)
}

/// How many random edits are made: `GEOTRACE_EDITS`, or a hundred thousand.
fn edit_count() -> usize {
    let wanted = std::env::var("GEOTRACE_EDITS").ok();
    wanted
        .and_then(|count| count.parse().ok())
        .unwrap_or(100_000)
}

/// Makes random edits and holds the document to its text after each.
fn storm(seed: u64, edits: usize) {
    const EDITS_OF_ONE: usize = 250;
    let mut random = Random(seed);
    let mut done = 0;
    while done < edits {
        let count = random.below(9);
        let mut text: String = (0..count).map(|_| declaration(&mut random)).collect();
        let mut document = Document::new(&text, &vocabulary()).expect("a small text");
        check(&document, &text);
        for _ in 0..EDITS_OF_ONE {
            let (range, inserted) = edit(&mut random, &text);
            let before = text.clone();
            if random.below(20) == 0 {
                // One that goes on from what this one was is none the worse.
                document = Document::from_snapshot(document.snapshot());
            }
            let outcome = document.edit(range, &inserted);
            assert!(outcome.is_ok(), "{outcome:?}");
            text.replace_range(range.start as usize..range.end as usize, &inserted);
            let held = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                check(&document, &text);
            }));
            if held.is_err() {
                panic!("seed {seed}: after the edit {range:?} {inserted:?} of {before:?}");
            }
            done += 1;
        }
    }
}

#[test]
fn random_edits_give_what_reading_the_whole_text_gives() {
    let threads = 4;
    let each = edit_count().div_ceil(threads);
    std::thread::scope(|scope| {
        for thread in 0..threads {
            scope.spawn(move || storm(thread as u64 + 1, each));
        }
    });
}

#[test]
fn a_long_text_is_inserted_into_a_long_one() {
    let text = "define a = 1;\n".repeat(7_000);
    let mut document = Document::new(&text, &vocabulary()).expect("a small text");
    document.edit(Span::new(0, 0), &text).expect("an edit");
    assert_eq!(document.text(), text.repeat(2));
}

#[test]
fn lines_columns_and_offsets_are_those_of_the_text() {
    let mut random = Random(7);
    let mut text = String::new();
    for k in 0..60 {
        text.push_str(&declaration(&mut random));
        text.push_str(["\r\n", "# 𝔘 π é", "\n\n", " "][k % 4]);
    }
    let mut document = Document::new(&text, &vocabulary()).expect("a small text");
    document.edit(Span::new(0, 0), "\n𝔘\r\n").expect("an edit");
    let text = document.text();
    let index = LineIndex::new(&text);
    assert_eq!(document.line_count(), index.line_count());
    for (offset, _) in text.char_indices().chain([(text.len(), ' ')]) {
        let offset = offset as u32;
        assert_eq!(
            document.position(offset),
            index.position(offset),
            "{offset}"
        );
    }
    for line in 0..=index.line_count() + 1 {
        for column in 0..60 {
            let position = Position { line, column };
            assert_eq!(
                document.offset(position),
                index.offset(position),
                "{position:?}"
            );
        }
    }
    for _ in 0..200 {
        let (a, b) = (random.below(text.len() + 3), random.below(text.len() + 3));
        let (start, end) = (a.min(b), a.max(b));
        let expected = text.get(start..end).map(str::to_owned);
        assert_eq!(
            document.slice(Span::new(start as u32, end as u32)),
            expected
        );
    }
}

#[test]
fn tokens_are_counted_up_to_each_place() {
    let text = "define a = 1 + 2;\n\n# é\nfunction f(x) = x^2 - sin x; point p = (a, f(1), 0);";
    let document = Document::new(text, &vocabulary()).expect("a small text");
    let all: Vec<Token> = document.tokens(Span::new(0, document.len())).collect();
    assert_eq!(document.token_count() as usize, all.len());
    for at in 0..=document.len() {
        let ended = all.iter().filter(|token| token.span.end <= at).count();
        let begun = all.iter().filter(|token| token.span.start < at).count();
        assert_eq!(document.tokens_ended(at) as usize, ended, "{at}");
        assert_eq!(document.tokens_begun(at) as usize, begun, "{at}");
    }
}

#[test]
fn a_keyword_that_becomes_longer_no_longer_ends_what_is_above() {
    // Between brackets, a `;` ends a declaration only if a keyword follows.
    let text = "define a = (1;\nbackground 2); define c = 2;";
    let mut document = Document::new(text, &vocabulary()).expect("a small text");
    check(&document, text);
    assert_eq!(document.chunks().count(), 4);
    let at = text.find(" 2)").expect("there") as u32;
    document.edit(Span::new(at, at), "x").expect("an edit");
    check(&document, &text.replacen(" 2)", "x 2)", 1));
    document.edit(Span::new(at, at + 1), "").expect("an edit");
    check(&document, text);
}

#[test]
fn an_edit_that_is_none_leaves_the_document_as_it_is() {
    let mut document = Document::new("define a = 1; # é", &vocabulary()).expect("a small text");
    let length = document.len();
    let outside = Span {
        start: 3,
        end: length + 1,
    };
    assert_eq!(document.edit(outside, "x"), Err(EditError::OutOfRange));
    let backwards = Span { start: 4, end: 2 };
    assert_eq!(document.edit(backwards, "x"), Err(EditError::OutOfRange));
    let inside = Span {
        start: length - 1,
        end: length,
    };
    assert_eq!(document.edit(inside, "x"), Err(EditError::InsideCharacter));
    assert_eq!(document.version(), 0);
    check(&document, "define a = 1; # é");
}

/// Makes one edit in the place of a text and says the texts of the chunks that were read.
fn read_again(text: &str, old: &str, new: &str) -> Vec<String> {
    let mut document = Document::new(text, &vocabulary()).expect("a small text");
    let start = text.find(old).expect("the place of the edit") as u32;
    let range = Span::new(start, start + old.len() as u32);
    let change = document.edit(range, new).expect("an edit");
    check(&document, &text.replacen(old, new, 1));
    let name = |chunk: &ChunkId| document.chunk_text(*chunk).trim().to_owned();
    change.read.iter().map(name).collect()
}

#[test]
fn only_what_can_notice_an_edit_is_read_again() {
    let text = "define a = 1; define b = a; define c = b; define d = ab; function f(x) = sint; point p = f(1);";
    // No name changes.
    assert_eq!(read_again(text, "= 1", "= 2"), ["define a = 2;"]);
    // A name goes, another comes: its users, and what is split otherwise.
    assert_eq!(
        read_again(text, "define a", "define q"),
        [
            "define q = 1;",
            "define b = a;",
            "define c = b;",
            "define d = ab;"
        ]
    );
    // A name that hides a split takes the words that begin with it, and no others.
    assert_eq!(
        read_again(text, " define b", "define ab = 3; define b"),
        ["define ab = 3;", "define d = ab;"]
    );
    assert_eq!(
        read_again(text, "define a", "define sint = 3;define a"),
        [
            "define sint = 3;",
            "function f(x) = sint;",
            "point p = f(1);"
        ]
    );
    // `asint` may mean `a sin t`.
    assert_eq!(
        read_again("define t = 1; define b = asint;", "t", "a = 2; define t"),
        ["define a = 2;", "define t = 1;", "define b = asint;"]
    );
    // A parameter's name is seen below, a comment is not.
    assert_eq!(
        read_again(text, "f(x) = sint", "f(y) = sint"),
        ["function f(y) = sint;", "point p = f(1);"]
    );
    assert_eq!(
        read_again(text, "define a = 1;", "# Π\ndefine a = 1;"),
        ["# Π\ndefine a = 1;"]
    );
}

#[test]
fn an_edit_among_ten_thousand_declarations_reads_one_of_them() {
    let mut text = String::new();
    for k in 0..10_000 {
        let _ = writeln!(text, "define n{k} = {k} + n{};", k / 2);
    }
    text = text.replacen("n0;", "0;", 1);
    let mut document = Document::new(&text, &vocabulary()).expect("a text");
    assert_eq!(document.diagnostics(), []);
    let before = document.counters();
    for place in [0, text.len() / 2, text.len()] {
        let at = text[..place].rfind("= ").map_or(11, |at| at + 2) as u32;
        let change = document.edit(Span::new(at, at), "1").expect("an edit");
        assert_eq!(change.read.len(), 1);
    }
    let after = document.counters();
    assert_eq!(after.edited - before.edited, 3);
    assert_eq!(after.reread, before.reread);
    assert!(after.cut - before.cut < 200);
    // Renaming a name of two users reads those two.
    let at = text.find("define n4000 ").expect("it is declared") as u32 + 8;
    let change = document.edit(Span::new(at, at), "m").expect("an edit");
    assert_eq!(change.read.len(), 3);
}

#[test]
fn a_change_has_the_version_after_its_edit() {
    let mut document = Document::new("define a = 1;", &vocabulary()).expect("a small text");
    for version in 1..=3 {
        let change = document.edit(Span::new(0, 0), " ").expect("an edit");
        assert_eq!((change.version, document.version()), (version, version));
    }
}

#[test]
fn a_symbol_keeps_its_identifier_while_its_declaration_stays() {
    let text = "define a = 1; define b = a;";
    let mut document = Document::new(text, &vocabulary()).expect("a small text");
    let find = |document: &Document, name: &str| {
        let mut symbols = document.symbols();
        symbols
            .find(|(_, symbol)| *symbol.name == *name)
            .map(|it| it.0)
    };
    let (a, b) = (find(&document, "a"), find(&document, "b"));
    let change = document
        .edit(Span::new(0, 0), "define z = 0;")
        .expect("an edit");
    assert_eq!(change.read.len(), 1);
    assert_eq!((find(&document, "a"), find(&document, "b")), (a, b));
    // Cut in two, both halves keep what they declare.
    document.edit(Span::new(25, 26), "").expect("an edit");
    assert_eq!(document.chunks().count(), 3);
    document.edit(Span::new(25, 25), ";").expect("an edit");
    assert_eq!(document.chunks().count(), 4);
    assert_eq!((find(&document, "a"), find(&document, "b")), (a, b));
    let change = document.edit(Span::new(20, 21), "q").expect("an edit");
    assert_eq!(change.forgotten, a.into_iter().collect::<Vec<_>>());
}
