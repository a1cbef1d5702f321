//! The tokens and hook calls of a chunk in packed form: eight bytes for each token, and for each step of an expression.
//!
//! In: tokens and events as passed to the hooks, with spans relative to the chunk's start. Out: the same tokens and
//! events, by number or in order. The values of numbers and the names are not stored, but read from the text again. A
//! chunk of 64 KiB or more, or with a number that does not fit, requires sixteen bytes for each.
//!
//! They are packed by hand because a program of 10,000 declarations has 230,000 tokens and 170,000 events. As enums with their
//! spans they would take 24 bytes each, 6.4 MB more in total: a fifth more than the whole server needs for that program.

use crate::geotrace::actions::{Interval, IntervalKind, Operator, Parameter, StatedAttribute};
use crate::geotrace::declarations::DeclarationKeyword;
use crate::geotrace::token::Token;
use crate::span::Span;
use crate::symbol::SymbolId;

use super::document::{ParseEvent, ReadDeclaration};
use tags::{
    STEPS_END, attribute, keyword, keyword_index, of_operator, of_token, operator, token_kind,
};

mod tags;

/// A list of packed entries.
#[derive(Clone, Debug)]
pub(crate) enum Records {
    /// Start, end, tag with the upper bits of the number, and its lower bits.
    Narrow(Box<[[u16; 4]]>),
    Wide(Box<[Entry]>),
}

/// A span, a tag that identifies its kind, and a number whose meaning depends on the tag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Entry {
    span: Span,
    tag: u8,
    number: u32,
}

/// The tokens of a chunk, in order.
#[derive(Clone, Copy, Debug)]
pub struct Tokens<'d> {
    records: &'d Records,
    text: &'d str,
}

/// The hook calls of a chunk, or a part of them, in order.
#[derive(Clone, Copy, Debug)]
pub struct ParseEvents<'d> {
    records: &'d Records,
    text: &'d str,
    next: usize,
    end: usize,
}

/// The parameters of a declaration that was read.
#[derive(Clone, Copy, Debug)]
pub struct Parameters<'d> {
    records: &'d Records,
    text: &'d str,
    next: usize,
    end: usize,
}

impl Default for Records {
    fn default() -> Self {
        Self::Narrow(Box::default())
    }
}

impl Records {
    /// Packs entries whose spans end at or before `length`.
    fn new(entries: impl Iterator<Item = Entry> + Clone, length: usize) -> Self {
        let fits = |entry: Entry| entry.number >> 24 == 0;
        if length > usize::from(u16::MAX) || !entries.clone().all(fits) {
            return Self::Wide(entries.collect());
        }
        let narrow = entries.map(|entry| {
            let [_, upper, lower @ ..] = entry.number.to_be_bytes();
            [
                entry.span.start as u16,
                entry.span.end as u16,
                u16::from_be_bytes([entry.tag, upper]),
                u16::from_be_bytes(lower),
            ]
        });
        Self::Narrow(narrow.collect())
    }

    /// Packs the tokens of a text.
    pub(crate) fn from_tokens(tokens: &[Token], text: &str) -> Self {
        let entries = tokens.iter().map(|token| {
            let (tag, number) = of_token(token.kind);
            let span = token.span;
            Entry { span, tag, number }
        });
        Self::new(entries, text.len())
    }

    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Narrow(entries) => entries.len(),
            Self::Wide(entries) => entries.len(),
        }
    }

    /// Returns the span of an entry.
    pub(crate) fn span(&self, index: usize) -> Option<Span> {
        Some(self.get(index)?.span)
    }

    fn get(&self, index: usize) -> Option<Entry> {
        match self {
            Self::Narrow(entries) => entries.get(index).map(|&[start, end, tag, lower]| {
                let [tag, upper] = tag.to_be_bytes();
                Entry {
                    span: Span::new(u32::from(start), u32::from(end)),
                    tag,
                    number: u32::from(upper) << 16 | u32::from(lower),
                }
            }),
            Self::Wide(entries) => entries.get(index).copied(),
        }
    }
}

impl<'d> Tokens<'d> {
    pub(crate) fn new(records: &'d Records, text: &'d str) -> Self {
        Self { records, text }
    }

    /// Returns the number of tokens.
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// Returns true if there are no tokens.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns a token by its number, from 0.
    pub fn get(&self, index: usize) -> Option<Token> {
        let Entry { span, tag, number } = self.records.get(index)?;
        Some(Token {
            kind: token_kind(tag, number, span.text(self.text)),
            span,
        })
    }

    /// Returns the span of a token, which is cheaper than the whole token.
    pub fn span(&self, index: usize) -> Option<Span> {
        self.records.span(index)
    }

    /// Returns all tokens, in order.
    pub fn iter(self) -> impl DoubleEndedIterator<Item = Token> + use<'d> {
        (0..self.len()).filter_map(move |index| self.get(index))
    }
}

/// Collects the events of reading a chunk.
#[derive(Debug)]
pub(crate) struct EventRecorder(Vec<Entry>);

impl EventRecorder {
    /// Creates a recorder with room for this many events.
    pub(crate) fn with_capacity(events: usize) -> Self {
        Self(Vec::with_capacity(events))
    }

    fn push(&mut self, tag: u8, span: Span, number: u32) {
        self.0.push(Entry { span, tag, number });
    }

    pub(crate) fn open(&mut self, keyword: DeclarationKeyword, span: Span) {
        self.push(OPEN + keyword_index(keyword), span, 0);
    }

    pub(crate) fn operator(&mut self, operator: Operator, span: Span) {
        let (tag, number) = of_operator(operator);
        self.push(tag, span, number);
    }

    pub(crate) fn interval(&mut self, interval: Interval) {
        let is_grid = u8::from(interval.kind == IntervalKind::Grid);
        let Some((parameter, span)) = interval.tag else {
            return self.push(INTERVAL + is_grid, interval.span, 0);
        };
        self.push(TAGGED_INTERVAL + is_grid, interval.span, 0);
        match parameter {
            Some(parameter) => self.push(SOME, span, parameter),
            None => self.push(NONE, span, 0),
        }
    }

    pub(crate) fn attribute(&mut self, attribute: StatedAttribute) {
        self.push(ATTRIBUTE, attribute.word_span, attribute.word as u32);
        self.push(NONE, attribute.value_span, 0);
    }

    pub(crate) fn diagnostic(&mut self) {
        self.push(DIAGNOSTIC, Span::default(), 0);
    }

    pub(crate) fn declaration(&mut self, declaration: &crate::geotrace::actions::Declaration<'_>) {
        let parameters = declaration.parameters;
        let tag = match declaration.faulty {
            true => FAULTY_DECLARATION,
            false => DECLARATION,
        };
        let tag = tag + keyword_index(declaration.keyword);
        self.push(tag, declaration.span, parameters.len() as u32);
        match declaration.symbol {
            Some(symbol) => self.push(SOME, declaration.name_span, symbol.0),
            None => self.push(NONE, declaration.name_span, 0),
        }
        for parameter in parameters {
            self.push(NONE, parameter.span, 0);
        }
    }

    /// Packs the events of a text.
    pub(crate) fn finish(self, text: &str) -> Records {
        Records::new(self.0.iter().copied(), text.len())
    }
}

impl<'d> ParseEvents<'d> {
    pub(crate) fn new(records: &'d Records, text: &'d str) -> Self {
        Self {
            records,
            text,
            next: 0,
            end: records.len(),
        }
    }

    /// Returns the declarations in order, each with its events: its steps and intervals.
    pub fn declarations(
        self,
    ) -> impl Iterator<Item = (ReadDeclaration<'d>, ParseEvents<'d>)> + use<'d> {
        let mut own = self;
        let mut rest = self;
        std::iter::from_fn(move || {
            loop {
                let at = rest.next;
                // The tags of further entries of an event are below those of declarations.
                let tag = rest.records.get(at).filter(|_| at < rest.end)?.tag;
                if tag < DECLARATION {
                    rest.next += 1;
                    continue;
                }
                if let Some(ParseEvent::Declaration(declaration)) = rest.next() {
                    own.end = at;
                    let found = (declaration, own);
                    own = rest;
                    return Some(found);
                }
            }
        })
    }

    fn entry(&mut self) -> Option<Entry> {
        let entry = self.records.get(self.next).filter(|_| self.next < self.end);
        self.next += usize::from(entry.is_some());
        entry
    }
}

impl<'d> Iterator for ParseEvents<'d> {
    type Item = ParseEvent<'d>;

    fn next(&mut self) -> Option<ParseEvent<'d>> {
        let Entry { span, tag, number } = self.entry()?;
        Some(match tag {
            ..OPEN => ParseEvent::Operator(operator(tag, number, span.text(self.text)), span),
            OPEN..INTERVAL => ParseEvent::Open(keyword(tag - OPEN), span),
            INTERVAL..DIAGNOSTIC => {
                let kind = match tag {
                    INTERVAL | TAGGED_INTERVAL => IntervalKind::Range,
                    _ => IntervalKind::Grid,
                };
                let mut tagged = None;
                if tag >= TAGGED_INTERVAL {
                    let entry = self.entry()?;
                    tagged = Some(((entry.tag == SOME).then_some(entry.number), entry.span));
                }
                ParseEvent::Interval(Interval {
                    kind,
                    span,
                    tag: tagged,
                })
            }
            DIAGNOSTIC..ATTRIBUTE => ParseEvent::Diagnostic,
            ATTRIBUTE..DECLARATION => {
                let value = self.entry()?.span;
                let read = StatedAttribute {
                    word: attribute(number),
                    word_span: span,
                    value_span: value,
                };
                ParseEvent::Attribute(read, value.text(self.text))
            }
            DECLARATION.. => {
                let faulty = tag >= FAULTY_DECLARATION;
                let first = if faulty {
                    FAULTY_DECLARATION
                } else {
                    DECLARATION
                };
                let name = self.entry()?;
                let parameters = self.next;
                self.next += number as usize;
                ParseEvent::Declaration(ReadDeclaration {
                    keyword: keyword(tag - first),
                    span,
                    symbol: (name.tag == SOME).then_some(SymbolId(name.number)),
                    name: name.span.text(self.text),
                    name_span: name.span,
                    parameters: Parameters {
                        records: self.records,
                        text: self.text,
                        next: parameters,
                        end: self.next,
                    },
                    faulty,
                })
            }
        })
    }
}

impl<'d> Iterator for Parameters<'d> {
    type Item = (&'d str, Span);

    fn next(&mut self) -> Option<(&'d str, Span)> {
        let entry = self
            .records
            .get(self.next)
            .filter(|_| self.next < self.end)?;
        self.next += 1;
        Some((entry.span.text(self.text), entry.span))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.end - self.next, Some(self.end - self.next))
    }
}

impl ExactSizeIterator for Parameters<'_> {}

impl Parameters<'_> {
    /// Returns the parameters in the form of the hooks, moved by a number of bytes.
    pub fn moved(self, bytes: u32) -> Vec<Parameter> {
        self.map(|(name, span)| Parameter {
            name: name.to_owned(),
            span: span.moved(bytes),
        })
        .collect()
    }
}

// The tags of events; those of operators are below `OPEN`.
const OPEN: u8 = STEPS_END;
const INTERVAL: u8 = 48;
const TAGGED_INTERVAL: u8 = 50;
const DIAGNOSTIC: u8 = 52;
const ATTRIBUTE: u8 = 53;
const DECLARATION: u8 = 64;
const FAULTY_DECLARATION: u8 = 80;
// The tags of the second and further entries of an event, below all tags that begin a declaration.
const NONE: u8 = 0;
const SOME: u8 = 1;

#[cfg(test)]
mod tests {
    use super::ParseEvent;
    use super::tags::STEPS;
    use super::{Entry, EventRecorder, ParseEvents, Records, Tokens};
    use crate::geotrace::actions::{
        Declaration, Interval, IntervalKind, Operator, Parameter, StatedAttribute,
    };
    use crate::geotrace::attributes::AttributeWord;
    use crate::geotrace::declarations::DeclarationKeyword;
    use crate::geotrace::token::{MapWord, Token, TokenKind};
    use crate::span::Span;
    use crate::symbol::SymbolId;

    /// A text of so many bytes that begins with a number.
    fn text(length: usize) -> String {
        format!("2.5e1{}", "x".repeat(length - 5))
    }

    #[test]
    fn tokens_come_back_as_they_were_in_short_texts_and_long_ones_and_under_large_numbers() {
        for (length, id) in [(300, 7), (300, 1 << 24), (70_000, 7)] {
            let text = text(length);
            let span = |k: usize| Span::new(k as u32, length as u32);
            let mut kinds = TokenKind::PLAIN.to_vec();
            kinds.extend(DeclarationKeyword::ALL.map(TokenKind::Declare));
            kinds.push(TokenKind::Constant(SymbolId(id)));
            kinds.push(TokenKind::Function(SymbolId(id)));
            kinds.push(TokenKind::Variable(id));
            kinds.extend(AttributeWord::ALL.map(TokenKind::Attribute));
            kinds.extend(MapWord::ALL.map(TokenKind::Map));
            let mut tokens = vec![Token {
                kind: TokenKind::Number(25.0),
                span: Span::new(0, 5),
            }];
            let others = kinds.into_iter().enumerate();
            tokens.extend(others.map(|(k, kind)| Token {
                kind,
                span: span(k + 5),
            }));
            let records = Records::from_tokens(&tokens, &text);
            let is_narrow = matches!(records, Records::Narrow(_));
            assert_eq!(is_narrow, length < 1 << 16 && id < 1 << 24);
            let found = Tokens::new(&records, &text);
            assert_eq!(found.iter().collect::<Vec<_>>(), tokens);
            assert_eq!(found.get(3), Some(tokens[3]));
            assert_eq!(found.get(tokens.len()), None);
        }
        assert_eq!(size_of::<Entry>(), 16);
    }

    #[test]
    fn events_come_back_as_they_were_and_each_declaration_with_its_own() {
        for length in [300, 70_000] {
            let text = text(length);
            let span = |k: u32| Span::new(k, k + 3);
            let mut operators = STEPS.to_vec();
            operators.extend([3, 1 << 20].map(|n| Operator::Constant(SymbolId(n))));
            operators.extend([3, 1 << 20].map(|n| Operator::Function(SymbolId(n))));
            operators.extend([Operator::Variable(2), Operator::Partial(3)]);
            operators.extend([Operator::Component(9), Operator::Tuple(100)]);
            let intervals = [None, Some((None, span(8))), Some((Some(1), span(9)))];
            let intervals = intervals.map(|tag| {
                [IntervalKind::Range, IntervalKind::Grid].map(|kind| Interval {
                    kind,
                    span: span(7),
                    tag,
                })
            });
            let intervals = intervals.concat();
            let mut recorder = EventRecorder::with_capacity(0);
            let parameter = |k: u32| Parameter {
                name: span(k).text(&text).to_owned(),
                span: span(k),
            };
            let parameters = [parameter(12), parameter(15)];
            let declared = |symbol, faulty, count: usize| Declaration {
                keyword: DeclarationKeyword::Geodesic,
                span: Span::new(6, 30),
                symbol,
                name: span(10).text(&text),
                name_span: span(10),
                parameters: &parameters[..count],
                faulty,
            };
            recorder.open(DeclarationKeyword::Param, span(6));
            recorder.operator(Operator::Number(25.0), Span::new(0, 5));
            recorder.diagnostic();
            for operator in &operators {
                recorder.operator(*operator, span(6));
            }
            recorder.declaration(&declared(Some(SymbolId(77)), false, 2));
            for interval in &intervals {
                recorder.interval(*interval);
            }
            let attributes = AttributeWord::ALL.map(|word| StatedAttribute {
                word,
                word_span: span(4),
                value_span: span(8),
            });
            for attribute in &attributes {
                recorder.attribute(*attribute);
            }
            recorder.declaration(&declared(None, true, 0));
            recorder.open(DeclarationKeyword::Geodesic, span(6));
            let records = recorder.finish(&text);

            let told = |event: ParseEvent<'_>| match event {
                ParseEvent::Declaration(read) => {
                    let parameters = read.parameters.moved(0);
                    format!("{:?}", read.as_declaration(&parameters))
                }
                other => format!("{other:?}"),
            };
            let expected = |events: &[Operator]| -> Vec<String> {
                let steps = events.iter().map(|it| ParseEvent::Operator(*it, span(6)));
                steps.map(told).collect()
            };
            let number = ParseEvent::Operator(Operator::Number(25.0), Span::new(0, 5));
            let mut first = vec![told(ParseEvent::Open(DeclarationKeyword::Param, span(6)))];
            first.extend([told(number), told(ParseEvent::Diagnostic)]);
            first.extend(expected(&operators));
            let intervals = intervals.iter().map(|it| ParseEvent::Interval(*it));
            let attributes = attributes.iter();
            let attributes =
                attributes.map(|it| ParseEvent::Attribute(*it, it.value_span.text(&text)));
            let second = intervals.chain(attributes);
            let second: Vec<_> = second.map(told).collect();
            let all = ParseEvents::new(&records, &text);
            let found: Vec<_> = all.declarations().collect();
            let declarations = [
                declared(Some(SymbolId(77)), false, 2),
                declared(None, true, 0),
            ];
            assert_eq!(found.len(), 2);
            for (((read, events), expected), own) in
                found.iter().zip(declarations).zip([&first, &second])
            {
                let parameters = read.parameters.moved(0);
                assert_eq!(read.as_declaration(&parameters), expected);
                assert_eq!(read.parameters.len(), expected.parameters.len());
                assert_eq!(&events.map(told).collect::<Vec<_>>(), own);
            }
            let last = told(ParseEvent::Open(DeclarationKeyword::Geodesic, span(6)));
            assert_eq!(all.map(told).last(), Some(last));
            assert_eq!(all.count(), first.len() + second.len() + 3);
        }
    }
}
