//! Completions: attributes between the braces of an object, the words of an attribute, and the beginnings of expressions.

use std::collections::HashMap;

use syntax::crt::objects::{FUNCTIONS, ObjectAttribute, ObjectName, ValueType};
use syntax::crt::token::{RESERVED, Token, TokenKind};
use syntax::span::Span;

use super::CrtAnalysis;
use super::hover;
use super::names::Origin;
use crate::completion::{Completion, CompletionKind, Completions, behind_word};
use crate::description::Description;

/// The context of a completion.
enum CompletionPlace {
    /// The name of an attribute of an object, which states these already.
    Attribute(ObjectName, Vec<String>),
    /// The value of an attribute that is one of these strings; `true` if within quotes.
    Choice(&'static [&'static str], bool),
    /// A modifier, within `<…>`.
    Modifier,
    /// A modifier, or a value that is compared with the one before.
    BehindLess,
    /// Another value.
    Value,
    /// A statement or an expression outside an object.
    Statement {
        /// It is at top level.
        is_top: bool,
        /// An `else` may follow.
        is_behind_if: bool,
    },
    /// A comment or a string.
    Nothing,
}

fn keyword(word: &str) -> Completion {
    Completion {
        label: word.to_owned(),
        kind: CompletionKind::Keyword,
        detail: String::new(),
        insert: word.to_owned(),
        snippet: false,
    }
}

/// Returns the completions at an offset.
pub(super) fn completions(analysis: &CrtAnalysis, offset: u32, snippets: bool) -> Completions {
    let start = analysis.snapshot.word_start(offset);
    let mut completions = Completions {
        range: Span::new(start, offset),
        ..Completions::empty(offset)
    };
    let list = &mut completions.list;
    match place(analysis, start) {
        CompletionPlace::Nothing => {}
        CompletionPlace::Attribute(object, stated) => {
            let rows = object.attributes().iter();
            let rows = rows.filter(|row| !stated.iter().any(|word| word == row.text));
            let has_value = behind_word(&analysis.snapshot, offset).starts_with("->");
            list.extend(rows.map(|row| match has_value {
                true => Completion {
                    insert: row.text.to_owned(),
                    snippet: false,
                    ..attribute(row, snippets)
                },
                false => attribute(row, snippets),
            }));
        }
        CompletionPlace::Choice(words, is_quoted) => {
            let words = words.iter().map(|word| match is_quoted {
                true => (*word).to_owned(),
                false => format!("\"{word}\""),
            });
            list.extend(words.map(|word| Completion {
                label: word.clone(),
                kind: CompletionKind::Word,
                detail: String::new(),
                insert: word,
                snippet: false,
            }));
        }
        CompletionPlace::Modifier => list.extend(modifiers()),
        CompletionPlace::Value => expressions(analysis, offset, snippets, list),
        CompletionPlace::Statement {
            is_top,
            is_behind_if,
        } => {
            expressions(analysis, offset, snippets, list);
            let tokens = analysis.all_tokens();
            // The block of the word that is being written does not count.
            let has = |kind| {
                let mut others = tokens.iter().filter(|token| token.kind == kind);
                others.any(|token| token.span.end < start || token.span.start > offset)
            };
            let words = RESERVED.iter().filter(|(_, kind)| match kind {
                TokenKind::Settings | TokenKind::Scene => is_top && !has(*kind),
                TokenKind::Else => is_behind_if,
                kind => !kind.is_modifier(),
            });
            list.extend(words.map(|(word, _)| keyword(word)));
        }
        CompletionPlace::BehindLess => {
            list.extend(modifiers());
            expressions(analysis, offset, snippets, list);
        }
    }
    completions
}

fn modifiers() -> impl Iterator<Item = Completion> {
    let words = RESERVED.iter().filter(|(_, kind)| kind.is_modifier());
    words.map(|(word, _)| keyword(word))
}

fn attribute(row: &ObjectAttribute, snippets: bool) -> Completion {
    let detail = match row.default.text() {
        None => "required".to_owned(),
        Some(default) => default,
    };
    Completion {
        label: row.text.to_owned(),
        kind: CompletionKind::Attribute,
        detail,
        insert: match snippets {
            true => format!("{} -> ${{1}}", row.text),
            false => format!("{} -> ", row.text),
        },
        snippet: snippets,
    }
}

fn expressions(analysis: &CrtAnalysis, offset: u32, snippets: bool, list: &mut Vec<Completion>) {
    let names = analysis.names();
    let visible = names.variables().filter(|variable| {
        variable
            .scope
            .is_none_or(|scope| scope.start <= offset && offset <= scope.end)
    });
    let visible: Vec<_> = visible.collect();
    // An inner variable hides an outer one of the same name.
    let mut starts: HashMap<&str, Option<u32>> = HashMap::new();
    for variable in &visible {
        let start = variable.scope.map(|scope| scope.start);
        let known = starts.entry(&*variable.name).or_insert(start);
        *known = start.max(*known);
    }
    let is_seen = |start: Option<u32>, name: &str| starts.get(name) == Some(&start);
    for variable in visible {
        if !is_seen(variable.scope.map(|scope| scope.start), &variable.name) {
            continue;
        }
        let (kind, detail) = match variable.origin {
            Origin::Parameter => (CompletionKind::Parameter, ""),
            Origin::Macro => (CompletionKind::Function, "Macro"),
            Origin::Object(object) => (CompletionKind::Solid, object.text()),
            Origin::Value => (CompletionKind::Constant, ""),
        };
        list.push(Completion {
            label: variable.name.to_string(),
            kind,
            detail: detail.to_owned(),
            insert: variable.name.to_string(),
            snippet: false,
        });
    }
    if !starts.contains_key(hover::FRAME_NAME) {
        list.push(Completion {
            label: hover::FRAME_NAME.to_owned(),
            kind: CompletionKind::Constant,
            detail: "the frame".to_owned(),
            insert: hover::FRAME_NAME.to_owned(),
            snippet: false,
        });
    }
    let behind = behind_word(&analysis.snapshot, offset);
    let has_braces = behind.starts_with('{');
    let has_brackets = behind.starts_with('(');
    for object in ObjectName::objects() {
        let required = object.attributes().iter().filter(|row| row.is_required());
        let lines = required.enumerate().map(|(k, row)| {
            let stop = k + 1;
            format!("    {} -> ${{{stop}}}\n", row.text)
        });
        let lines: String = lines.collect();
        list.push(Completion {
            label: object.text().to_owned(),
            kind: CompletionKind::Solid,
            detail: object.purpose().to_owned(),
            insert: match snippets && !has_braces {
                true => format!("{} {{\n{lines}}}", object.text()),
                false => object.text().to_owned(),
            },
            snippet: snippets && !has_braces,
        });
    }
    for (name, arguments, _) in FUNCTIONS {
        let fields = arguments.iter().enumerate();
        let fields: Vec<String> = fields
            .map(|(k, it)| format!("${{{}:{it}}}", k + 1))
            .collect();
        list.push(Completion {
            label: (*name).to_owned(),
            kind: CompletionKind::Function,
            detail: format!("({})", arguments.join(", ")),
            insert: match snippets && !has_brackets {
                true => format!("{name}({})", fields.join(", ")),
                false => (*name).to_owned(),
            },
            snippet: snippets && !has_brackets,
        });
    }
}

/// Returns the description of the completion with this label.
pub(super) fn describe(analysis: &CrtAnalysis, offset: u32, label: &str) -> Option<Description> {
    let start = analysis.snapshot.word_start(offset);
    if let CompletionPlace::Attribute(object, _) = place(analysis, start) {
        return object.attribute(label).map(hover::attribute);
    }
    if let Some(object) = ObjectName::from_text(label) {
        return Some(hover::object(object));
    }
    let place = analysis.names().place_of(label);
    let variable = place.and_then(|place| analysis.names().variable_at(place.start + 1));
    match variable {
        Some((_, variable)) => Some(hover::describe_variable(analysis, variable)),
        None if label == hover::FRAME_NAME => Some(hover::frame()),
        None => hover::function(label),
    }
}

/// Finds the context before an offset where no word has begun.
fn place(analysis: &CrtAnalysis, offset: u32) -> CompletionPlace {
    let tokens = analysis.all_tokens();
    let before = tokens.partition_point(|token| token.span.end <= offset);
    let is_open = |token: &Token| {
        matches!(
            token.kind,
            TokenKind::Comment | TokenKind::Error | TokenKind::Text
        )
    };
    if tokens
        .get(before)
        .is_some_and(|it| it.span.start < offset && is_open(it))
    {
        let is_text = analysis.slice(tokens[before].span).starts_with('"');
        return match place_behind(analysis, &tokens[..before], offset) {
            CompletionPlace::Choice(words, _) if is_text => CompletionPlace::Choice(words, true),
            _ => CompletionPlace::Nothing,
        };
    }
    place_behind(analysis, &tokens[..before], offset)
}

/// Finds the context after some tokens.
fn place_behind(analysis: &CrtAnalysis, tokens: &[Token], offset: u32) -> CompletionPlace {
    let before: Vec<Token> = tokens
        .iter()
        .copied()
        .filter(|token| token.kind != TokenKind::Comment)
        .collect();
    let Some(last) = before.last() else {
        return CompletionPlace::Statement {
            is_top: true,
            is_behind_if: false,
        };
    };
    if begins_modifier(analysis, &before, offset) {
        return CompletionPlace::Modifier;
    }
    if last.kind == TokenKind::Less {
        return CompletionPlace::BehindLess;
    }
    // The open bracket at this point.
    let mut depth = 0;
    let open = before.iter().rposition(|token| {
        match token.kind {
            TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => depth += 1,
            TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen => depth -= 1,
            _ => {}
        }
        depth < 0
    });
    let is_behind_if = ends_if(&before);
    let Some(open) = open else {
        return CompletionPlace::Statement {
            is_top: true,
            is_behind_if,
        };
    };
    if before[open].kind != TokenKind::BraceOpen {
        return CompletionPlace::Value;
    }
    let object = open.checked_sub(1).and_then(|at| {
        let token = before[at];
        match token.kind {
            TokenKind::Settings => Some(ObjectName::Settings),
            TokenKind::Name => ObjectName::from_text(&analysis.slice(token.span)),
            _ => None,
        }
    });
    let Some(object) = object else {
        return CompletionPlace::Statement {
            is_top: false,
            is_behind_if,
        };
    };
    let ends_value = matches!(
        last.kind,
        TokenKind::BraceOpen
            | TokenKind::BraceClose
            | TokenKind::ParenClose
            | TokenKind::BracketClose
            | TokenKind::Integer
            | TokenKind::Float
            | TokenKind::Text
            | TokenKind::True
            | TokenKind::False
            | TokenKind::Identifier
    );
    let modifier_ends = &analysis.names().modifier_ends;
    let ends_value = ends_value
        || last.kind == TokenKind::Greater && modifier_ends.binary_search(&last.span.start).is_ok();
    if ends_value {
        return CompletionPlace::Attribute(
            object,
            stated_attributes(analysis, before[open].span.end),
        );
    }
    let word = before.len().checked_sub(2).map(|at| before[at].span);
    let row = word.and_then(|word| object.attribute(&analysis.slice(word)));
    match row.map(|row| row.value) {
        Some(ValueType::Choice(words)) if last.kind == TokenKind::Arrow => {
            CompletionPlace::Choice(words, false)
        }
        _ => CompletionPlace::Value,
    }
}

/// Returns true if some tokens end with an arm of an `if`.
fn ends_if(before: &[Token]) -> bool {
    let mut tokens = before.iter().rev().peekable();
    if tokens
        .peek()
        .is_none_or(|it| it.kind != TokenKind::BraceClose)
    {
        return false;
    }
    // The braces, and the condition before them.
    for _ in 0..2 {
        let mut depth = 0;
        for token in tokens.by_ref() {
            match token.kind {
                TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => {
                    depth += 1;
                }
                TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen => depth -= 1,
                _ => {}
            }
            if depth <= 0 {
                break;
            }
        }
    }
    tokens.next().is_some_and(|it| it.kind == TokenKind::If)
}

/// Returns true if a modifier is expected after some tokens: after a `<` that is closed on its line, or after a `,` within
/// `<…>`.
fn begins_modifier(analysis: &CrtAnalysis, before: &[Token], offset: u32) -> bool {
    let Some((last, before)) = before.split_last() else {
        return false;
    };
    match last.kind {
        TokenKind::Modify => true,
        TokenKind::Less => {
            let rest = behind_word(&analysis.snapshot, offset);
            rest.replace("->", "").contains('>')
        }
        TokenKind::Comma => {
            let mut depth = 0;
            for token in before.iter().rev() {
                match token.kind {
                    TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => {
                        depth += 1;
                    }
                    TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen => {
                        depth -= 1;
                    }
                    TokenKind::Modify if depth == 0 => return true,
                    TokenKind::Greater if depth == 0 => return false,
                    _ => {}
                }
                if depth < 0 {
                    return false;
                }
            }
            false
        }
        _ => false,
    }
}

/// Returns the attributes that are stated between the braces that begin at an offset.
fn stated_attributes(analysis: &CrtAnalysis, start: u32) -> Vec<String> {
    let tokens = analysis.all_tokens();
    let from = tokens.partition_point(|token| token.span.end <= start);
    let inside: Vec<&Token> = tokens[from..]
        .iter()
        .filter(|token| token.kind != TokenKind::Comment)
        .collect();
    let mut depth = 0;
    let mut stated = Vec::new();
    for (at, token) in inside.iter().enumerate() {
        match token.kind {
            TokenKind::BraceOpen => depth += 1,
            TokenKind::BraceClose if depth == 0 => break,
            TokenKind::BraceClose => depth -= 1,
            TokenKind::Identifier if depth == 0 => {
                let next = inside.get(at + 1);
                if next.is_some_and(|next| next.kind == TokenKind::Arrow) {
                    stated.push(analysis.slice(token.span));
                }
            }
            _ => {}
        }
    }
    stated
}
