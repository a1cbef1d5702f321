//! Renaming: every use of a name gets another, and every other word keeps its reading.
//!
//! Words are split into the longest names that are defined, so a new name may be read where it was never meant. The
//! renamed text is therefore read again and compared with the old one, token by token; a word that would be read
//! otherwise is written apart, and what blanks cannot mend is refused.

use std::ops::Range;

use syntax::diagnostic::{Code, Severity};
use syntax::span::Span;
use syntax::token::{DeclareWord, TokenKind};

use crate::edit::{self, Edit};
use crate::meaning::Meanings;
use crate::reading::{Lexeme, Reading, Target, introduces_in};

/// Why a name cannot be changed; [`std::fmt::Display`] gives the sentence.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum RenameError {
    /// There is no name at the place.
    NoName,
    /// The name is builtin.
    Builtin(String),
    /// The new name is none: names start with a letter and consist of letters and digits.
    NotAName(String),
    /// The new name opens declarations.
    DeclareWord(String),
    /// The new name has a meaning already; `line` (from 1) is where, unless it is builtin.
    Taken {
        /// The name.
        name: String,
        /// Where it is declared.
        line: Option<u32>,
    },
    /// Some word would be read otherwise, whatever blanks are put in.
    ReadOtherwise {
        /// The word as it is written now.
        word: String,
        /// In which line, from 1.
        line: u32,
    },
}

impl std::fmt::Display for RenameError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoName => f.write_str("there is no name here"),
            Self::Builtin(name) => write!(f, "`{name}` is builtin and cannot be renamed"),
            Self::NotAName(name) => write!(
                f,
                "`{name}` is not a name: a name starts with a letter and has only letters a-z, A-Z and digits"
            ),
            Self::DeclareWord(name) => {
                write!(f, "`{name}` opens a declaration: it cannot be a name")
            }
            Self::Taken { name, line: None } => write!(f, "`{name}` is already builtin"),
            Self::Taken {
                name,
                line: Some(line),
            } => write!(f, "`{name}` is already declared in line {line}"),
            Self::ReadOtherwise { word, line } => {
                write!(
                    f,
                    "with this name, `{word}` in line {line} would be read otherwise"
                )
            }
        }
    }
}

impl std::error::Error for RenameError {}

/// The name at a place and where it stands, if it can be renamed.
///
/// # Errors
/// [`RenameError::NoName`], [`RenameError::Builtin`].
pub fn prepare(reading: &Reading, offset: u32) -> Result<(Span, String), RenameError> {
    let (span, target) = target(reading, offset)?;
    Ok((span, reading.name(target).to_owned()))
}

fn target(reading: &Reading, offset: u32) -> Result<(Span, Target), RenameError> {
    let token = reading.token_at(offset).ok_or(RenameError::NoName)?;
    let target = reading.target(token).ok_or(RenameError::NoName)?;
    if let Target::Symbol(id) = target
        && reading.item_of(id).is_none()
    {
        return Err(RenameError::Builtin(reading.name(target).to_owned()));
    }
    let token = reading.token(token).ok_or(RenameError::NoName)?;
    Ok((token.span, target))
}

/// The edits that give the name at a place another, and put blanks where words would else be read otherwise.
///
/// # Errors
/// [`RenameError`], with the reason.
pub fn rename(reading: &Reading, offset: u32, name: &str) -> Result<Vec<Edit>, RenameError> {
    let (_, target) = target(reading, offset)?;
    if reading.name(target) == name {
        return Ok(Vec::new());
    }
    check_name(reading, target, name)?;
    let renamed = reading.occurrences(target);
    let mut blanks: Vec<u32> = Vec::new();
    // Each round writes apart what the last one found; a word is cut at most as often as it has letters.
    loop {
        let edits = edits(reading, &renamed, &blanks, name);
        let again = Reading::new(edit::apply(reading.text(), &edits));
        let Some(token) = first_difference(reading, &again, &renamed, name) else {
            return keeps_errors(reading, &again).map(|()| edits);
        };
        let before = blanks.len();
        blanks.extend(seams(reading, token));
        blanks.sort_unstable();
        blanks.dedup();
        if blanks.len() == before {
            return Err(RenameError::ReadOtherwise {
                word: word(reading, token),
                line: reading
                    .token(token)
                    .map_or(1, |token| line(reading, token.span.start)),
            });
        }
    }
}

/// Whether the same errors are found: a name that was taken would be free where it is declared once more, and would then
/// mean something else there.
fn keeps_errors(reading: &Reading, again: &Reading) -> Result<(), RenameError> {
    let errors = |reading: &Reading| -> Vec<(Code, Span)> {
        let found = reading.diagnostics().iter();
        let errors = found.filter(|diagnostic| diagnostic.severity == Severity::Error);
        errors.map(|error| (error.code, error.span)).collect()
    };
    let (old, new) = (errors(reading), errors(again));
    if old
        .iter()
        .map(|(code, _)| code)
        .eq(new.iter().map(|(code, _)| code))
    {
        return Ok(());
    }
    let differs = old
        .iter()
        .zip(&new)
        .find(|((one, _), (other, _))| one != other);
    let span = differs
        .map(|((_, span), _)| *span)
        .or(old.last().map(|(_, span)| *span));
    let span = span.unwrap_or_default();
    Err(RenameError::ReadOtherwise {
        word: span.text(reading.text()).to_owned(),
        line: line(reading, span.start),
    })
}

/// Whether the name is one, and free.
fn check_name(reading: &Reading, target: Target, name: &str) -> Result<(), RenameError> {
    let mut letters = name.bytes();
    let well_formed = letters.next().is_some_and(|b| b.is_ascii_alphabetic())
        && letters.all(|b| b.is_ascii_alphanumeric());
    if !well_formed || name.len() > 255 {
        return Err(RenameError::NotAName(name.to_owned()));
    }
    if DeclareWord::from_text(name).is_some() {
        return Err(RenameError::DeclareWord(name.to_owned()));
    }
    let taken = |line| {
        Err(RenameError::Taken {
            name: name.to_owned(),
            line,
        })
    };
    if let Some(id) = reading.document().named(name)
        && Target::Symbol(id) != target
    {
        return taken(reading.place(id).map(|span| line(reading, span.start)));
    }
    // A parameter may not have the name of a symbol above it, nor of its neighbours.
    let (first, count) = match target {
        Target::Symbol(id) => (reading.item_of(id).unwrap_or_default(), usize::MAX),
        Target::Parameter { item, .. } => (item, 1),
    };
    let mut parameters = reading
        .items_from(first)
        .take(count)
        .flat_map(|item| item.parameters());
    let clash = parameters.find(|(own, _)| *own == name);
    match clash {
        Some((_, place)) => taken(Some(line(reading, place.start))),
        None => Ok(()),
    }
}

fn edits(reading: &Reading, renamed: &[usize], blanks: &[u32], name: &str) -> Vec<Edit> {
    let mut edits: Vec<Edit> = Vec::new();
    edits.extend(blanks.iter().map(|&offset| Edit::insert(offset, " ")));
    let tokens = renamed.iter().filter_map(|&k| reading.token(k));
    let spans = tokens.map(|token| token.span);
    edits.extend(spans.map(|span| Edit::replace(span, name)));
    // A blank before a name comes before what replaces the name.
    edits.sort_by_key(|edit| (edit.span.start, edit.span.end));
    edits
}

/// The first token that is read otherwise, as a position in the old reading.
fn first_difference(old: &Reading, new: &Reading, renamed: &[usize], name: &str) -> Option<usize> {
    let mut renamed = renamed.iter().copied().peekable();
    let all = |reading: &Reading| 0..reading.token_count();
    let (meanings, others) = (Meanings::of(old), Meanings::of(new));
    let introduced = |reading| reading_introduced(reading, all(reading));
    let (introduced, mut also_introduced) = (introduced(old), introduced(new).into_iter());
    let mut new_tokens = new.tokens(all(new));
    let old_tokens = old.tokens(all(old)).zip(introduced).enumerate();
    for (k, (token, introduces)) in old_tokens {
        let is_renamed = renamed.next_if_eq(&k).is_some();
        let text = if is_renamed { name } else { token.text };
        let is_same = new_tokens.next().is_some_and(|other| {
            meanings.get(token.kind) == others.get(other.kind)
                && text == other.text
                && also_introduced.next() == Some(introduces)
        });
        if !is_same {
            return Some(k);
        }
    }
    (new.token_count() > old.token_count()).then(|| old.token_count().saturating_sub(1))
}

/// Whether each of the tokens introduces a name.
fn reading_introduced(reading: &Reading, tokens: Range<usize>) -> Vec<bool> {
    let document = reading.document();
    let pieces = document.pieces_from(document.piece_at(0));
    let all = pieces.flat_map(|piece| {
        let tokens = 0..piece.tokens.len();
        tokens.map(move |index| introduces_in(piece, index))
    });
    all.take(tokens.len()).collect()
}

/// Whether a token is made of letters or digits.
fn is_word(token: &Lexeme<'_>) -> bool {
    matches!(
        token.kind,
        TokenKind::Constant(_)
            | TokenKind::Function(_)
            | TokenKind::Variable(_)
            | TokenKind::Undefined
            | TokenKind::Number(_)
    )
}

/// The run of touching words and numbers around a token.
fn run(reading: &Reading, token: usize) -> std::ops::Range<usize> {
    let touch = |k: usize| {
        let (one, other) = (reading.token(k), reading.token(k + 1));
        one.zip(other).is_some_and(|(one, other)| {
            is_word(&one) && is_word(&other) && one.span.end == other.span.start
        })
    };
    let mut first = token;
    while first > 0 && touch(first - 1) {
        first -= 1;
    }
    let mut last = token;
    while touch(last) {
        last += 1;
    }
    first..last + 1
}

/// The places where the word around a token can be written apart.
fn seams(reading: &Reading, token: usize) -> Vec<u32> {
    let mut run = run(reading, token);
    run.next();
    let tokens = reading.tokens(run);
    tokens.map(|token| token.span.start).collect()
}

fn word(reading: &Reading, token: usize) -> String {
    let run = run(reading, token);
    let tokens = reading.tokens(run);
    let span = tokens.map(|token| token.span).reduce(Span::to);
    span.map_or_else(String::new, |span| reading.slice(span))
}

fn line(reading: &Reading, offset: u32) -> u32 {
    reading.document().line(offset)
}
