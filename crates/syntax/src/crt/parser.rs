//! The parser of CRT scripts: LL(1) recursive descent along [`grammar`](super::grammar) that calls the hooks of [`Actions`].
//! One function reads all levels of left-associative operators.
//!
//! Parsing never fails: an error becomes a diagnostic, a missing expression becomes [`ParseStep::Missing`], and the enclosing
//! list (of statements, attributes, arguments) continues after the fault.
//!
//! - `expression`: expressions.
//! - `object`: objects with their attributes.
//! - `messages`: the sentences of lexical and syntax errors.

mod expression;
mod messages;
mod object;

use super::actions::{Actions, ParseStep};
use super::builder::Builder;
use super::codes;
use super::lexer::Lexer;
use super::token::{Token, TokenKind};
use super::tree::Block;
use crate::diagnostic::{Code, Diagnostic, Fix};
use crate::span::Span;
use crate::text::{MAX_DIAGNOSTICS, too_large, too_many_diagnostics};

/// The maximum nesting depth of a script, which counts brackets, blocks, prefix operators and right-associative operators.
/// In a debug build, 2 MiB of stack suffice for it.
pub const MAX_DEPTH: u32 = 256;

/// Returns true if a text is a certificate rather than a script.
pub fn is_certificate(source: &str) -> bool {
    let text = source.strip_prefix('\u{FEFF}').unwrap_or(source);
    text.starts_with("-----BEGIN")
}

/// Reads a whole script. A text of 4 GiB or more is refused with one diagnostic; a certificate is skipped.
pub fn parse_script<A: Actions>(source: &str, actions: &mut A) {
    if u32::try_from(source.len()).is_ok_and(|length| length < u32::MAX) {
        parse_chunk(source, true, actions);
    } else {
        actions.act_error(too_large());
    }
}

/// Reads a piece of a script: blocks. `is_first` is true for the first piece, where a byte order mark is white space.
pub(super) fn parse_chunk<A: Actions>(source: &str, is_first: bool, actions: &mut A) {
    if is_first && is_certificate(source) {
        return;
    }
    let has_mark = is_first && source.starts_with('\u{FEFF}');
    let start = if has_mark { '\u{FEFF}'.len_utf8() } else { 0 };
    let mut parser = Parser::new(source, start as u32, actions);
    parser.script();
}

/// Reads a lone expression, and returns its tree if it has no errors.
///
/// # Errors
/// The diagnostics, at least one of which is an error.
pub fn parse_expression(source: &str) -> Result<super::tree::Expression, Vec<Diagnostic>> {
    #[derive(Default)]
    struct ExpressionRecorder<'s> {
        builder: Builder<'s>,
        found: Vec<Diagnostic>,
    }
    impl Actions for ExpressionRecorder<'_> {
        fn act_step(&mut self, step: ParseStep<'_>, span: Span) {
            self.builder.act_step(step, span);
        }
        fn act_error(&mut self, diagnostic: Diagnostic) {
            self.found.push(diagnostic);
        }
    }
    if u32::try_from(source.len()).is_err() {
        return Err(vec![too_large()]);
    }
    let mut recorder = ExpressionRecorder {
        builder: Builder::new(source),
        found: Vec::new(),
    };
    let mut parser = Parser::new(source, 0, &mut recorder);
    parser.brackets = 1;
    parser.expression();
    if parser.current.kind != TokenKind::Eoi {
        parser.unexpected("the end of the expression");
    }
    let is_sound = parser.errors == 0;
    match recorder.builder.expression() {
        Some(expression) if is_sound => Ok(expression),
        _ => Err(recorder.found),
    }
}

/// Returns the tree of a piece of a script, its diagnostics and its tokens.
pub(super) fn parse_tree(
    source: &str,
    is_first: bool,
) -> (Vec<Token>, Vec<Block>, Vec<Diagnostic>) {
    struct TreeRecorder<'s> {
        tokens: Vec<Token>,
        builder: Builder<'s>,
        found: Vec<Diagnostic>,
    }
    impl Actions for TreeRecorder<'_> {
        fn act_advance(&mut self, token: Token) {
            self.tokens.push(token);
        }
        fn act_step(&mut self, step: ParseStep<'_>, span: Span) {
            self.builder.act_step(step, span);
        }
        fn act_error(&mut self, diagnostic: Diagnostic) {
            self.found.push(diagnostic);
        }
    }
    let mut recorder = TreeRecorder {
        tokens: Vec::new(),
        builder: Builder::new(source),
        found: Vec::new(),
    };
    parse_chunk(source, is_first, &mut recorder);
    (recorder.tokens, recorder.builder.blocks, recorder.found)
}

struct Parser<'s, 'a, A> {
    source: &'s str,
    lexer: Lexer<'s>,
    actions: &'a mut A,
    /// The next token to accept.
    current: Token,
    /// The last accepted token that is not a comment.
    previous: Token,
    /// The start of the token of the last reported error: a token gets at most one error.
    reported: Option<u32>,
    /// The number of errors so far.
    errors: usize,
    diagnostics: usize,
    depth: u32,
    /// True if the block is nested too deep, which has been reported.
    is_too_deep: bool,
    /// The start of the statement that is being read.
    statement_start: u32,
    /// The number of open brackets in the statement.
    brackets: u32,
    /// The start of the `<` of the modifiers that are being read.
    modifiers: Option<u32>,
    /// The start of the value of the last attribute, if that is a colour.
    colour_start: Option<u32>,
}

impl<'s, 'a, A: Actions> Parser<'s, 'a, A> {
    fn new(source: &'s str, start: u32, actions: &'a mut A) -> Self {
        let token = Token {
            kind: TokenKind::Eoi,
            span: Span::new(start, start),
        };
        let mut parser = Self {
            source,
            lexer: Lexer::new(source, start),
            actions,
            current: token,
            previous: token,
            reported: None,
            errors: 0,
            diagnostics: 0,
            depth: 0,
            is_too_deep: false,
            statement_start: start,
            brackets: 0,
            modifiers: None,
            colour_start: None,
        };
        parser.fetch();
        parser
    }

    /// `Script = Block Script |`
    fn script(&mut self) {
        while !self.at(TokenKind::Eoi) {
            self.is_too_deep = false;
            self.block();
        }
    }

    /// `Block = "Settings" "{" Attrs "}" | "Scene" "{" Stmts "}" | Stmt`
    fn block(&mut self) {
        let start = self.current.span.start;
        match self.current.kind {
            TokenKind::Settings => {
                self.advance();
                let (braces, count) = self.attributes(None, true);
                self.step(ParseStep::Settings(braces, count), start);
            }
            TokenKind::Scene => {
                self.advance();
                self.body();
                self.step(ParseStep::Scene, start);
            }
            TokenKind::Identifier if self.begins_small_block() => {
                let word = self.text();
                let is_scene = word.eq_ignore_ascii_case("scene");
                let meant = if is_scene { "Scene" } else { "Settings" };
                let span = self.current.span;
                let message = format!("there is no object `{word}`");
                let diagnostic = Diagnostic::error(codes::UNKNOWN_OBJECT, span, message)
                    .with_hint(format!("write `{meant}`, with a capital letter"))
                    .with_fix(Fix::change(span, meant, true).with_all());
                self.report(diagnostic);
                self.advance();
                if is_scene {
                    self.body();
                    self.step(ParseStep::Scene, start);
                } else {
                    let (braces, count) = self.attributes(None, true);
                    self.step(ParseStep::Settings(braces, count), start);
                }
            }
            kind if kind.begins_statement() => {
                self.statement();
                self.step(ParseStep::Statement, start);
            }
            _ => self.stray(),
        }
    }

    /// Returns true if the current word is that of a block in lower case, and a brace follows.
    fn begins_small_block(&self) -> bool {
        let text = self.text();
        ["scene", "settings"]
            .iter()
            .any(|word| word.eq_ignore_ascii_case(text))
            && self.lexer.peek() == TokenKind::BraceOpen
    }

    /// `Stmt = Expr | "while" "(" Expr ")" "{" Stmts "}" | If`
    fn statement(&mut self) {
        let start = self.current.span.start;
        let outer = (self.statement_start, self.brackets);
        (self.statement_start, self.brackets) = (start, 0);
        match self.current.kind {
            TokenKind::While => {
                self.advance();
                self.arm(start);
                self.step(ParseStep::While, start);
            }
            TokenKind::If => self.if_statement(),
            _ => {
                self.expression();
                self.step(ParseStep::Expression, start);
            }
        }
        (self.statement_start, self.brackets) = outer;
    }

    /// `If = "if" "(" Expr ")" "{" Stmts "}" Else`, `Else = "else" Alternative |`, `Alternative = "{" Stmts "}" | If`
    fn if_statement(&mut self) {
        let start = self.current.span.start;
        let (mut count, mut has_else) = (0, false);
        loop {
            let arm = self.current.span.start;
            self.advance();
            self.arm(arm);
            count += 1;
            if !self.at(TokenKind::Else) {
                break;
            }
            self.advance();
            if !self.at(TokenKind::If) {
                self.body();
                has_else = true;
                break;
            }
        }
        self.step(ParseStep::If(count, has_else), start);
    }

    /// `"(" Expr ")" "{" Stmts "}"`
    fn arm(&mut self, start: u32) {
        let open = self.current.span;
        if self.at(TokenKind::ParenOpen) {
            self.advance();
            self.brackets += 1;
            self.expression();
            self.close(TokenKind::ParenClose, open);
            self.brackets -= 1;
        } else {
            let hint = "the condition is enclosed in `(` and `)`";
            self.unexpected_with("a `(`", Some(hint.to_owned()));
            match self.current.kind.begins_expression() {
                true => self.expression(),
                false => self.missing(),
            }
        }
        self.body();
        self.step(ParseStep::Arm, start);
    }

    /// `"{" Stmts "}"`
    fn body(&mut self) {
        let open = self.current.span;
        if !self.at(TokenKind::BraceOpen) {
            let hint = "the statements of a body are enclosed in `{` and `}`";
            self.unexpected_with("a `{`", Some(hint.to_owned()));
            return self.step(ParseStep::Body(0), self.previous.span.end);
        }
        self.advance();
        let mut count = 0;
        if self.enter() {
            loop {
                match self.current.kind {
                    TokenKind::BraceClose
                    | TokenKind::Eoi
                    | TokenKind::Settings
                    | TokenKind::Scene => break,
                    kind if kind.begins_statement() => {
                        self.statement();
                        count += 1;
                    }
                    _ => self.stray(),
                }
            }
            self.leave();
        }
        self.close(TokenKind::BraceClose, open);
        self.step(ParseStep::Body(count), open.start);
    }

    /// Skips tokens that do not begin a statement, up to the end of their line and of braces that open on it.
    fn stray(&mut self) {
        self.unexpected("a statement");
        let mut open = 0;
        loop {
            open += usize::from(self.at(TokenKind::BraceOpen));
            self.advance();
            let kind = self.current.kind;
            match kind {
                TokenKind::Settings | TokenKind::Scene | TokenKind::Eoi => break,
                TokenKind::BraceClose if open > 0 => open -= 1,
                TokenKind::BraceClose => break,
                _ if kind.begins_statement() || open == 0 && self.begins_line() => break,
                _ => {}
            }
        }
    }

    /// Returns true if the current token is the first of its line.
    fn begins_line(&self) -> bool {
        let between = Span::new(self.previous.span.end, self.current.span.start);
        between.text(self.source).contains('\n')
    }

    fn at(&self, kind: TokenKind) -> bool {
        self.current.kind == kind
    }

    fn text(&self) -> &'s str {
        self.current.span.text(self.source)
    }

    /// Consumes the current token.
    fn advance(&mut self) {
        if self.at(TokenKind::Eoi) {
            return;
        }
        self.actions.act_advance(self.current);
        self.previous = self.current;
        self.fetch();
    }

    /// Reads the next token. Comments and characters that begin no token are skipped on the way.
    #[inline]
    fn fetch(&mut self) {
        let lexeme = self.lexer.read();
        self.current = lexeme.token;
        if lexeme.fault.is_some() || lexeme.token.kind == TokenKind::Comment {
            self.fetch_slowly(lexeme);
        }
    }

    /// Consumes the current token if it is of a kind; otherwise reports what is expected.
    fn accept(&mut self, kind: TokenKind, expected: &str) -> bool {
        let is_here = self.at(kind);
        if is_here {
            self.advance();
        } else {
            self.unexpected(expected);
        }
        is_here
    }

    /// Consumes the bracket that closes `open`. If it is missing, nothing is consumed.
    fn close(&mut self, kind: TokenKind, open: Span) {
        if self.at(kind) {
            return self.advance();
        }
        let is_other = matches!(
            self.current.kind,
            TokenKind::ParenClose | TokenKind::BracketClose
        );
        let closer = kind.text().unwrap_or_default();
        if is_other {
            let text = self.text();
            let opener = open.text(self.source);
            let message = format!("`{opener}` is closed by `{closer}`, not by `{text}`");
            let span = self.current.span;
            if let Some(diagnostic) = self.fault(codes::UNEXPECTED_TOKEN, span, message) {
                let fix = Fix::change(span, closer, true);
                self.report(diagnostic.with_fix(fix).with_related(open, "it opens here"));
            }
            return self.advance();
        }
        let message = format!("the `{}` is not closed", open.text(self.source));
        if let Some(diagnostic) = self.fault(codes::UNCLOSED_BRACKET, open, message) {
            let end = self
                .end_in_modifiers(open)
                .unwrap_or(self.previous.span.end);
            let last = self.previous.span.text(self.source);
            let is_open_string = last.starts_with('"') && (last.len() == 1 || !last.ends_with('"'));
            let diagnostic = match self.current.kind {
                TokenKind::Arrow => {
                    diagnostic.with_hint("the attributes of an object are enclosed in `{` and `}`")
                }
                // The text would become part of the string.
                _ if is_open_string => diagnostic,
                _ => {
                    let title = format!("Insert `{closer}`");
                    diagnostic.with_fix(Fix::insert(&title, end, closer))
                }
            };
            self.report(diagnostic);
        }
    }

    /// Returns the offset before the `>` that seems to close the modifiers around an unclosed bracket, which was read as a
    /// comparison: nothing that is compared with follows on its line.
    fn end_in_modifiers(&self, open: Span) -> Option<u32> {
        self.modifiers.filter(|start| *start < open.start)?;
        let (mut lexer, mut before) = (Lexer::new(self.source, open.end), open.end);
        let mut depth = 0;
        loop {
            let Token { kind, span } = lexer.read().token;
            if span.end > self.previous.span.end || kind == TokenKind::Eoi {
                return None;
            }
            match kind {
                TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen => depth += 1,
                TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => {
                    depth -= 1;
                }
                TokenKind::Greater if depth == 0 => {
                    let rest = self.source[span.end as usize..].lines().next();
                    let rest = rest.unwrap_or_default().trim_start();
                    let ends =
                        rest.is_empty() || rest.starts_with([',', '+', '-', '^', ')', ']', '}']);
                    if ends {
                        return Some(before);
                    }
                }
                _ => {}
            }
            before = span.end;
        }
    }

    /// Counts a level of nesting. If there are too many, reports that, skips to the closing bracket and returns false.
    fn enter(&mut self) -> bool {
        if self.depth < MAX_DEPTH {
            self.depth += 1;
            return true;
        }
        let message = format!("this is nested deeper than {MAX_DEPTH} levels");
        let span = self.current.span;
        if !std::mem::replace(&mut self.is_too_deep, true)
            && let Some(diagnostic) = self.fault(codes::TOO_DEEP, span, message)
        {
            self.report(diagnostic);
        }
        let mut open = 0;
        loop {
            match self.current.kind {
                TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen => open += 1,
                TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => {
                    if open == 0 {
                        break;
                    }
                    open -= 1;
                }
                TokenKind::Settings | TokenKind::Scene | TokenKind::Eoi => break,
                _ => {}
            }
            self.advance();
        }
        // Errors here are consequences.
        self.reported = Some(self.current.span.start);
        false
    }

    fn leave(&mut self) {
        self.depth -= 1;
    }

    fn step(&mut self, step: ParseStep<'_>, start: u32) {
        let end = self.previous.span.end.max(start);
        self.actions.act_step(step, Span::new(start, end));
    }

    /// Returns the error, unless one has already been reported at the current token.
    fn fault(&mut self, code: Code, span: Span, message: impl Into<String>) -> Option<Diagnostic> {
        let start = self.current.span.start;
        let is_new = self.reported.replace(start) != Some(start);
        is_new.then(|| Diagnostic::error(code, span, message))
    }

    /// Reports a diagnostic.
    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics += 1;
        self.errors += usize::from(diagnostic.severity == crate::diagnostic::Severity::Error);
        if self.diagnostics < MAX_DIAGNOSTICS {
            self.actions.act_error(diagnostic);
        } else if self.diagnostics == MAX_DIAGNOSTICS {
            self.actions
                .act_error(too_many_diagnostics(diagnostic.span));
        }
    }
}
