//! A recorder of everything the hooks say, and short forms of it as text.
#![allow(dead_code, unreachable_pub)]

use syntax::diagnostic::{Diagnostic, Severity};
use syntax::geotrace::actions::{Actions, Declaration, Interval, Operator, StatedAttribute};
use syntax::geotrace::declarations::DeclarationKeyword;
use syntax::geotrace::symbols::{Parsed, Vocabulary};
use syntax::geotrace::token::{Token, TokenKind};
use syntax::geotrace::{parse_expression, parse_program};
use syntax::line_index::LineIndex;
use syntax::span::Span;
use syntax::symbol::SymbolId;

/// A declaration, as it was handed out.
#[derive(Clone, Debug)]
pub struct Declared {
    pub keyword: DeclarationKeyword,
    pub name: String,
    pub symbol: Option<SymbolId>,
    pub parameters: Vec<String>,
    pub faulty: bool,
    pub span: Span,
    pub name_span: Span,
    pub steps: Vec<(Operator, Span)>,
    pub intervals: Vec<Interval>,
    pub attributes: Vec<StatedAttribute>,
}

/// Records every call of a hook.
#[derive(Default)]
pub struct Recorder {
    pub tokens: Vec<Token>,
    pub opened: Vec<(DeclarationKeyword, Span)>,
    pub steps: Vec<(Operator, Span)>,
    pub intervals: Vec<Interval>,
    pub attributes: Vec<StatedAttribute>,
    pub declared: Vec<Declared>,
    pub diagnostics: Vec<Diagnostic>,
}

impl Actions for Recorder {
    fn act_advance(&mut self, token: Token) {
        self.tokens.push(token);
    }
    fn act_declaration_start(&mut self, keyword: DeclarationKeyword, span: Span) {
        self.steps.clear();
        self.intervals.clear();
        self.attributes.clear();
        self.opened.push((keyword, span));
    }
    fn act_operator(&mut self, operator: Operator, span: Span) {
        self.steps.push((operator, span));
    }
    fn act_interval(&mut self, interval: Interval) {
        self.intervals.push(interval);
    }
    fn act_attribute(&mut self, attribute: StatedAttribute, _: &str) {
        self.attributes.push(attribute);
    }
    fn act_declaration(&mut self, declaration: &Declaration<'_>) {
        self.declared.push(Declared {
            keyword: declaration.keyword,
            name: declaration.name.to_owned(),
            symbol: declaration.symbol,
            parameters: declaration
                .parameters
                .iter()
                .map(|p| p.name.clone())
                .collect(),
            faulty: declaration.faulty,
            span: declaration.span,
            name_span: declaration.name_span,
            steps: std::mem::take(&mut self.steps),
            intervals: std::mem::take(&mut self.intervals),
            attributes: std::mem::take(&mut self.attributes),
        });
    }
    fn act_error(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }
}

pub fn vocabulary() -> Vocabulary {
    let functions = [
        "sin", "cos", "tan", "exp", "log", "sqrt", "id", "asin", "acos", "atan", "sinh", "cosh",
        "tanh", "abs",
    ];
    Vocabulary::new(&["pi", "e"], &functions).with_inverse("sin", "asin")
}

pub fn parse(source: &str) -> (Recorder, Parsed) {
    let mut recorder = Recorder::default();
    let parsed = parse_program(source, &vocabulary(), &mut recorder);
    (recorder, parsed)
}

/// `line:column severity[code] text | message | hint` for each diagnostic, in order of place.
pub fn diagnostic_lines(source: &str, diagnostics: &[Diagnostic]) -> Vec<String> {
    let index = LineIndex::new(source);
    let mut diagnostics: Vec<&Diagnostic> = diagnostics.iter().collect();
    diagnostics.sort_by_key(|diagnostic| diagnostic.span);
    let show = |diagnostic: &&Diagnostic| {
        let start = index.position(diagnostic.span.start);
        let severity = match diagnostic.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Hint => "hint",
        };
        let hint = diagnostic.hint.as_ref().map(|hint| format!(" | {hint}"));
        format!(
            "{}:{} {severity}[{}] {} | {}{}",
            start.line,
            start.column,
            diagnostic.code.0,
            diagnostic.span.text(source).replace('\n', "⏎"),
            diagnostic.message,
            hint.unwrap_or_default(),
        )
    };
    diagnostics.iter().map(show).collect()
}

pub fn program_diagnostics(source: &str) -> Vec<String> {
    diagnostic_lines(source, &parse(source).0.diagnostics)
}

/// The steps of expressions in postfix order: names and numbers as they are written, `·` for juxtaposition,
/// `@` for application, `u+ u- u* u/` for the prefix operators, `f^` for the power of a function, `_n` for a
/// component, `∂k` and `′` for derivatives, `(n)` for a bracket with n components.
pub fn postfix(steps: &[(Operator, Span)], parsed: &Parsed, parameters: &[String]) -> String {
    let show = |(operator, _): &(Operator, Span)| match operator {
        Operator::Number(value) => value.to_string(),
        Operator::Constant(id) | Operator::Function(id) => parsed.symbols[*id].name.to_string(),
        Operator::Variable(k) => parameters[*k as usize].clone(),
        Operator::Partial(k) => format!("∂{k}"),
        Operator::Total => "′".to_owned(),
        Operator::FunctionPower => "f^".to_owned(),
        Operator::Apply => "@".to_owned(),
        Operator::Add => "+".to_owned(),
        Operator::Subtract => "-".to_owned(),
        Operator::Juxtapose => "·".to_owned(),
        Operator::Multiply => "*".to_owned(),
        Operator::Divide => "/".to_owned(),
        Operator::Power => "^".to_owned(),
        Operator::Plus => "u+".to_owned(),
        Operator::Negate => "u-".to_owned(),
        Operator::Square => "u*".to_owned(),
        Operator::Reciprocal => "u/".to_owned(),
        Operator::Component(n) => format!("_{n}"),
        Operator::Tuple(1) => "()".to_owned(),
        Operator::Tuple(n) => format!("({n})"),
        Operator::Position => "place".to_owned(),
        Operator::Atom => "set".to_owned(),
        Operator::Union => "|".to_owned(),
        Operator::Intersection => "&".to_owned(),
        Operator::Difference => "\\".to_owned(),
        Operator::Move => "move".to_owned(),
        Operator::Scale => "scale".to_owned(),
        Operator::Rotate => "rotate".to_owned(),
        Operator::Image => "image".to_owned(),
    };
    steps.iter().map(show).collect::<Vec<_>>().join(" ")
}

/// The postfix form of an expression in the scope of a prelude, with its diagnostics if there are any.
pub fn read(prelude: &str, expression: &str) -> String {
    let (recorder, parsed) = parse(prelude);
    assert!(
        recorder.diagnostics.is_empty(),
        "{:?}",
        diagnostic_lines(prelude, &recorder.diagnostics)
    );
    let mut recorder = Recorder::default();
    let complete = parse_expression(expression, &parsed, &mut recorder);
    let has_error = recorder
        .diagnostics
        .iter()
        .any(|d| d.severity == Severity::Error);
    assert_eq!(complete, !has_error);
    postfix(&recorder.steps, &parsed, &[])
}

/// Tokens and white space make up the whole text, in order, on character boundaries.
pub fn assert_tokens_tile(source: &str, tokens: &[Token]) {
    let mut end = 0;
    let gap = |start: usize, end: usize| {
        let gap = &source[start..end];
        let gap = if start == 0 {
            gap.trim_start_matches('\u{FEFF}')
        } else {
            gap
        };
        assert!(
            gap.chars().all(|c| " \t\r\n".contains(c)),
            "gap {gap:?} in {source:?}"
        );
    };
    for token in tokens {
        let (start, token_end) = (token.span.start as usize, token.span.end as usize);
        assert!(start < token_end && token.kind != TokenKind::Eoi);
        gap(end, start);
        end = token_end;
    }
    gap(end, source.len());
}
