//! A second language in the incremental document: statements end with their line, blocks nest and may span lines, names are
//! ordinary identifiers. After random edits the document equals one that is made from the whole text.

use std::collections::BTreeSet;
use std::sync::Arc;

use syntax::diagnostic::{Code, Diagnostic};
use syntax::document::{Analysis, Definition, Document, Grammar, Reading, ScopeView, Surroundings};
use syntax::span::Span;
use syntax::symbol::SymbolId;

/// `name = …` defines a name for the statements below; `-` opens a comment.
#[derive(Clone, Debug)]
struct Toy;

#[derive(Clone, Debug)]
struct Name {
    text: Arc<str>,
    span: Option<Span>,
    /// The right side is a block: what the statements below notice of the name.
    is_block: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Use { is_block: bool },
    Definition,
    Undefined,
    Other,
}

#[derive(Clone, Debug, Default)]
struct Statement {
    tokens: Vec<(Span, Kind)>,
    defined: Option<(SymbolId, Span)>,
}

impl Grammar for Toy {
    /// The depth of nested blocks, and whether a comment has not ended.
    type CutState = (u32, bool);
    type Builtins = str;
    type Symbol = Name;
    type Analysis = Statement;
    /// The offset of an undefined word.
    type Deferred = u32;

    fn cut(text: &str, from: usize, state: (u32, bool), ends: &mut Vec<usize>) -> (u32, bool) {
        let (mut depth, mut in_comment) = state;
        for (at, byte) in text.bytes().enumerate().skip(from) {
            match byte {
                b'-' => in_comment = true,
                b'{' if !in_comment => depth += 1,
                b'}' if !in_comment => depth = depth.saturating_sub(1),
                b'\n' => {
                    in_comment = false;
                    if depth == 0 {
                        ends.push(at + 1);
                    }
                }
                _ => {}
            }
        }
        (depth, in_comment)
    }

    fn builtins(names: &str) -> Vec<Name> {
        let names = names.split_whitespace().map(|name| Name {
            text: name.into(),
            span: None,
            is_block: false,
        });
        names.collect()
    }

    fn each_declared<'t>(text: &'t str, mut found: impl FnMut(&'t str, u32)) {
        let mut all = tokens(text);
        if let (Some((name, span)), Some(("=", _))) = (all.next(), all.next()) {
            found(name, span.start);
        }
    }

    fn read<'d>(
        text: &str,
        _: bool,
        mut scope: ScopeView<'d, Self>,
    ) -> (ScopeView<'d, Self>, Reading<Self>) {
        let all: Vec<(&str, Span)> = tokens(text).collect();
        let mut statement = Statement::default();
        let (mut diagnostics, mut deferred) = (Vec::new(), Vec::new());
        let mut declared = None;
        for (index, &(word, span)) in all.iter().enumerate() {
            let known = scope.get(word).filter(|_| is_name(word));
            let defines = index == 0 && is_name(word) && all.get(1).is_some_and(|it| it.0 == "=");
            let kind = match known {
                _ if !is_name(word) => Kind::Other,
                Some(id) => {
                    scope.record_use(id);
                    if defines {
                        let message = format!("`{word}` is taken");
                        diagnostics.push(Diagnostic::error(Code("taken"), span, message));
                    }
                    let is_block = scope.symbol(id).is_block;
                    Kind::Use { is_block }
                }
                None => {
                    scope.record_name_lookup(span);
                    if defines {
                        declared = Some((word, span));
                        Kind::Definition
                    } else {
                        deferred.push((diagnostics.len(), span.start));
                        let message = format!("`{word}` is not defined");
                        diagnostics.push(Diagnostic::error(Code("undefined"), span, message));
                        Kind::Undefined
                    }
                }
            };
            statement.tokens.push((span, kind));
        }
        let mut known_from = Vec::new();
        if let Some((name, span)) = declared {
            let id = scope.define(Name {
                text: name.into(),
                span: Some(span),
                is_block: all.get(2).is_some_and(|it| it.0 == "{"),
            });
            let end = text.len() as u32;
            statement.defined = Some((id, Span::new(span.start, end)));
            known_from.push((id, end));
        }
        let reading = Reading {
            analysis: statement,
            diagnostics,
            deferred,
            known_from,
        };
        (scope, reading)
    }

    fn complete(
        offset: &u32,
        diagnostic: &mut Diagnostic,
        surroundings: &Surroundings<'_, Self>,
        _: usize,
    ) {
        let word = diagnostic.message.split('`').nth(1).unwrap_or_default();
        diagnostic.hint = match surroundings.declared_below(word, *offset) {
            Some((_, line)) => Some(format!("it is defined in line {line}")),
            None => {
                let near = surroundings.nearest(None, word, *offset);
                near.map(|name| format!("did you mean `{name}`?"))
            }
        };
    }
}

impl Definition for Name {
    type Signature = bool;

    fn name(&self) -> &Arc<str> {
        &self.text
    }

    fn share_name(&mut self, name: &Arc<str>) {
        self.text = Arc::clone(name);
    }

    fn name_span(&self) -> Option<Span> {
        self.span
    }

    fn signature(&self) -> bool {
        self.is_block
    }
}

impl Analysis for Statement {
    fn token_count(&self) -> usize {
        self.tokens.len()
    }

    fn token_span(&self, index: usize) -> Option<Span> {
        self.tokens.get(index).map(|(span, _)| *span)
    }

    fn declaration_spans<'a>(&'a self, _: &'a str) -> impl Iterator<Item = Span> + 'a {
        self.defined.iter().map(|(_, span)| *span)
    }

    fn defined<'a>(&'a self, _: &'a str) -> impl Iterator<Item = SymbolId> + 'a {
        self.defined.iter().map(|(id, _)| *id)
    }
}

fn is_name(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_lowercase())
}

/// Identifiers, and single characters that are neither white space nor in a comment.
fn tokens(text: &str) -> impl Iterator<Item = (&str, Span)> {
    let mut at = 0;
    std::iter::from_fn(move || {
        loop {
            let rest = &text[at..];
            let first = rest.chars().next()?;
            let run = |holds: fn(char) -> bool| rest.find(|c| !holds(c)).unwrap_or(rest.len());
            let length = match first {
                '-' => run(|c| c != '\n'),
                'a'..='z' => run(|c| c.is_ascii_alphanumeric()),
                _ => first.len_utf8(),
            };
            let start = at;
            at += length;
            if first != '-' && !first.is_whitespace() {
                let span = Span::new(start as u32, at as u32);
                return Some((span.text(text), span));
            }
        }
    })
}

/// All that a document says of its text, with names for handles.
fn describe(document: &Document<Toy>) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for chunk in document.chunks() {
        let start = document.start(chunk);
        for (span, kind) in &document.analysis(chunk).tokens {
            lines.push(format!("{:?} {kind:?}", span.moved(start)));
        }
        lines.push(format!("{start} {:?}", document.chunk_text(chunk)));
    }
    let diagnostics = document.diagnostics();
    lines.extend(diagnostics.iter().map(|it| format!("{it:?}")));
    let symbols = document.symbols();
    let symbols = symbols.map(|(id, name)| format!("{:?} {name:?}", document.place(id)));
    lines.extend(symbols.collect::<BTreeSet<_>>());
    lines
}

/// The undefined and taken words of a text, found without a document.
fn faults(text: &str) -> Vec<(String, u32)> {
    let (mut statements, mut start, mut end, mut depth) = (Vec::new(), 0, 0, 0_u32);
    for line in text.split_inclusive('\n') {
        for c in line.split('-').next().unwrap_or_default().chars() {
            match c {
                '{' => depth += 1,
                '}' => depth = depth.saturating_sub(1),
                _ => {}
            }
        }
        end += line.len();
        if depth == 0 {
            statements.push(start..end);
            start = end;
        }
    }
    statements.push(start..end);
    let mut known = BTreeSet::from(["pi"]);
    let mut found = Vec::new();
    for statement in statements {
        let from = statement.start as u32;
        let all: Vec<_> = tokens(&text[statement]).collect();
        let defines = all.get(1).is_some_and(|it| it.0 == "=");
        for (k, (word, span)) in all.iter().enumerate() {
            let introduces = k == 0 && defines;
            if is_name(word) && known.contains(word) == introduces {
                found.push(((*word).to_owned(), from + span.start));
            }
        }
        if let (Some((name, _)), true) = (all.first(), defines)
            && is_name(name)
        {
            known.insert(name);
        }
    }
    found
}

#[test]
fn random_edits_of_a_second_language_give_what_reading_the_whole_text_gives() {
    const PIECES: [&str; 16] = [
        "\n",
        "\n",
        "{",
        "}",
        "-",
        " ",
        "a = 1\n",
        "b = { a\n a }\n",
        "ab",
        "a",
        "b = a",
        "c = {",
        "}\n",
        "pi + c",
        "é",
        "= 2",
    ];
    let mut seed = 3_u64;
    let mut random = |below: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 33) as usize % below
    };
    for _ in 0..60 {
        let mut text = String::new();
        let mut document: Document<Toy> = Document::new(&text, "pi").expect("a small text");
        for _ in 0..100 {
            let boundary = |mut at: usize| {
                while !text.is_char_boundary(at) {
                    at -= 1;
                }
                at
            };
            let start = boundary(random(text.len() + 1));
            let end = boundary((start + random(6)).min(text.len())).max(start);
            let inserted = match text.len() < 200 {
                true => PIECES[random(PIECES.len())],
                false => "",
            };
            let range = Span::new(start as u32, end as u32);
            document.edit(range, inserted).expect("an edit");
            text.replace_range(start..end, inserted);
            assert_eq!(document.text(), text);
            let whole: Document<Toy> = Document::new(&text, "pi").expect("a small text");
            assert_eq!(describe(&document), describe(&whole), "{text:?}");
            let diagnostics = document.diagnostics();
            let found = diagnostics.iter().map(|it| {
                let word = it.span.text(&text).to_owned();
                (word, it.span.start)
            });
            assert_eq!(found.collect::<Vec<_>>(), faults(&text), "{text:?}");
        }
    }
}

#[test]
fn an_edit_reads_its_statement_and_those_that_notice() {
    let text = "a = 1\nb = a\nc = {\n  b\n}\nd = c\n";
    let mut document: Document<Toy> = Document::new(text, "pi").expect("a small text");
    assert_eq!(document.chunks().count(), 5);
    let read = |document: &mut Document<Toy>, old: &str, new: &str| {
        let start = document.text().find(old).expect("the place") as u32;
        let range = Span::new(start, start + old.len() as u32);
        document.edit(range, new).expect("an edit").read.len()
    };
    // The value of a name is not noticed below, a block is.
    assert_eq!(read(&mut document, "1", "2"), 1);
    assert_eq!(read(&mut document, "a = 2", "a = { 2 }"), 2);
    // Renamed: its statement, and those with the old name and the new one.
    assert_eq!(read(&mut document, "c = {", "e = {"), 2);
    assert_eq!(document.diagnostics()[0].message, "`c` is not defined");
    assert_eq!(read(&mut document, "\nd", "\nc = 1\nd"), 2);
    assert_eq!(document.diagnostics(), []);
}
