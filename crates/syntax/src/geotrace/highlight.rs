//! Colours for a text: "highlighting is another compiler", a second implementation of the hooks.

use crate::geotrace::actions::{Actions, Declaration};
use crate::geotrace::parser::parse_program;
use crate::geotrace::symbols::Vocabulary;
use crate::geotrace::token::{Token, TokenKind};
use crate::highlight::HighlightKind;
use crate::span::Span;

/// A coloured piece of the text.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Highlight {
    /// Its span.
    pub span: Span,
    /// Its class.
    pub kind: HighlightKind,
    /// True for a name where it is introduced.
    pub declares: bool,
}

/// Returns every token of a program with its colour, in the order of the text and without overlaps.
pub fn highlight(source: &str, vocabulary: &Vocabulary) -> Vec<Highlight> {
    let mut highlighter = Highlighter::default();
    parse_program(source, vocabulary, &mut highlighter);
    highlighter.highlights
}

/// Collects the colours while the parser runs.
#[derive(Clone, Debug, Default)]
pub struct Highlighter {
    /// The coloured pieces so far. A name that is being introduced gets its colour at the end of its declaration.
    pub highlights: Vec<Highlight>,
}

impl Highlighter {
    /// Recolours the token at `span` as a name introduced there.
    fn declare(&mut self, span: Span, kind: HighlightKind) {
        let found = self.highlights.binary_search_by_key(&span, |h| h.span);
        if let Ok(index) = found {
            self.highlights[index].kind = kind;
            self.highlights[index].declares = true;
        }
    }
}

impl Actions for Highlighter {
    fn act_advance(&mut self, token: Token) {
        if let Some(kind) = kind(token.kind) {
            self.highlights.push(Highlight {
                span: token.span,
                kind,
                declares: false,
            });
        }
    }

    fn act_declaration(&mut self, declaration: &Declaration<'_>) {
        if declaration.symbol.is_some() {
            let has_parameters = !declaration.parameters.is_empty();
            let kind = match declaration.keyword.declares_function(has_parameters) {
                false => HighlightKind::Constant,
                true => HighlightKind::Function,
            };
            self.declare(declaration.name_span, kind);
        }
        for parameter in declaration.parameters {
            self.declare(parameter.span, HighlightKind::Variable);
        }
    }
}

/// Returns the kind of a token, apart from the names that a text declares; `None` for the end of the text.
pub fn kind(token: TokenKind) -> Option<HighlightKind> {
    Some(match token {
        TokenKind::Comment => HighlightKind::Comment,
        TokenKind::Number(_) => HighlightKind::Number,
        TokenKind::Declare(_) | TokenKind::Attribute(_) | TokenKind::Map(_) => {
            HighlightKind::Keyword
        }
        TokenKind::Word => HighlightKind::Constant,
        TokenKind::Constant(_) => HighlightKind::Constant,
        TokenKind::Function(_) => HighlightKind::Function,
        TokenKind::Variable(_) => HighlightKind::Variable,
        TokenKind::Undefined => HighlightKind::Undefined,
        TokenKind::Plus
        | TokenKind::Minus
        | TokenKind::Star
        | TokenKind::Slash
        | TokenKind::Caret
        | TokenKind::Underscore
        | TokenKind::Prime
        | TokenKind::Bar
        | TokenKind::Ampersand
        | TokenKind::Backslash => HighlightKind::Operator,
        TokenKind::ParenOpen
        | TokenKind::ParenClose
        | TokenKind::BracketOpen
        | TokenKind::BracketClose
        | TokenKind::BraceOpen
        | TokenKind::BraceClose
        | TokenKind::Comma
        | TokenKind::Semicolon
        | TokenKind::Colon
        | TokenKind::Equals
        | TokenKind::At => HighlightKind::Punctuation,
        TokenKind::Error => HighlightKind::Error,
        TokenKind::Eoi => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::{HighlightKind, highlight};
    use crate::geotrace::symbols::Vocabulary;

    #[test]
    fn metrics_and_geodesics_are_functions_where_they_are_named() {
        let vocabulary = Vocabulary::new(&[], &["sin"]);
        let source = "metric h(u,v) = (1,0,u), u:[1,2], v:[1,2];
            geodesic g(t) : h = (1,0) @ (1,1), t:[0,1]; metrics geodesic";
        let coloured = highlight(source, &vocabulary);
        let of = |wanted: HighlightKind, declares: bool| -> Vec<&str> {
            let found = coloured
                .iter()
                .filter(|h| h.kind == wanted && h.declares == declares);
            found.map(|h| h.span.text(source)).collect()
        };
        let keywords = ["metric", "geodesic", "geodesic"];
        assert_eq!(of(HighlightKind::Keyword, false), keywords);
        assert_eq!(of(HighlightKind::Function, true), ["h", "g"]);
        assert_eq!(of(HighlightKind::Function, false), ["h"]);
        assert_eq!(of(HighlightKind::Variable, true), ["u", "v", "t"]);
        // In the body, and before the intervals.
        assert_eq!(of(HighlightKind::Variable, false), ["u", "u", "v", "t"]);
        assert_eq!(of(HighlightKind::Undefined, false), ["metrics"]);
    }

    #[test]
    fn each_token_has_the_colour_of_what_it_means() {
        let vocabulary = Vocabulary::new(&["pi"], &["sin"]);
        let source = "#π\nfunction f(u) = sinpiu + 2foo €; define a = f 3; define pi = 1;";
        let shown: Vec<String> = highlight(source, &vocabulary)
            .into_iter()
            .filter(|h| h.kind != HighlightKind::Punctuation)
            .map(|h| {
                let mark = if h.declares { "!" } else { "" };
                format!("{} {:?}{mark}", h.span.text(source), h.kind)
            })
            .collect();
        let expected = [
            "#π Comment",
            "function Keyword",
            "f Function!",
            "u Variable!",
            "sin Function",
            "pi Constant",
            "u Variable",
            "+ Operator",
            "2 Number",
            "foo Undefined",
            "€ Error",
            "define Keyword",
            "a Constant!",
            "f Function",
            "3 Number",
            "define Keyword",
            "pi Constant",
            "1 Number",
        ];
        assert_eq!(shown, expected);
    }
}
