//! Renaming: every use of a name gets another, and every other word keeps its reading.
//!
//! Words are split into the longest names that are defined, so a new name may be read where it was never meant. The
//! renamed text is therefore read again and compared with the old one, token by token; a word that would be read
//! otherwise is written apart, and what blanks cannot mend is refused.

use syntax::diagnostic::{Code, Severity};
use syntax::span::Span;
use syntax::token::{DeclareWord, Token, TokenKind};

use crate::edit::{self, Edit};
use crate::reading::{Reading, Target};

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
    Ok((reading.tokens()[token].span, target))
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
                line: line(reading, reading.tokens()[token].span.start),
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
    let visible_below = |id| Some(Target::Symbol(id)) != Some(target);
    for (id, symbol) in reading.symbols().iter() {
        if symbol.name == name && visible_below(id) {
            return taken(symbol.name_span.map(|span| line(reading, span.start)));
        }
    }
    // A parameter may not have the name of a symbol above it, nor of its neighbours.
    let clash = reading.items().iter().enumerate().find_map(|(k, item)| {
        let reached = match target {
            Target::Symbol(id) => reading.item_of(id).is_some_and(|own| own <= k),
            Target::Parameter { item, .. } => item == k,
        };
        item.parameters.iter().find(|p| reached && p.name == name)
    });
    match clash {
        Some(parameter) => taken(Some(line(reading, parameter.span.start))),
        None => Ok(()),
    }
}

fn edits(reading: &Reading, renamed: &[usize], blanks: &[u32], name: &str) -> Vec<Edit> {
    let mut edits: Vec<Edit> = Vec::new();
    edits.extend(blanks.iter().map(|&offset| Edit::insert(offset, " ")));
    let spans = renamed.iter().map(|&k| reading.tokens()[k].span);
    edits.extend(spans.map(|span| Edit::replace(span, name)));
    // A blank before a name comes before what replaces the name.
    edits.sort_by_key(|edit| (edit.span.start, edit.span.end));
    edits
}

/// The first token that is read otherwise, as a position in the old reading.
fn first_difference(old: &Reading, new: &Reading, renamed: &[usize], name: &str) -> Option<usize> {
    let mut renamed = renamed.iter().copied().peekable();
    let same = |k: usize, old_token: &Token, new_token: &Token, is_renamed: bool| {
        let text = if is_renamed {
            name
        } else {
            old_token.span.text(old.text())
        };
        old_token.kind == new_token.kind
            && text == new_token.span.text(new.text())
            && old.introduces(old.tokens()[k].span) == new.introduces(new_token.span)
    };
    for (k, token) in old.tokens().iter().enumerate() {
        let is_renamed = renamed.next_if_eq(&k).is_some();
        match new.tokens().get(k) {
            Some(other) if same(k, token, other, is_renamed) => {}
            _ => return Some(k),
        }
    }
    (new.tokens().len() > old.tokens().len()).then(|| old.tokens().len().saturating_sub(1))
}

/// Whether a token is made of letters or digits.
fn is_word(token: &Token) -> bool {
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
    let tokens = reading.tokens();
    let touch = |k: usize| {
        is_word(&tokens[k])
            && is_word(&tokens[k + 1])
            && tokens[k].span.end == tokens[k + 1].span.start
    };
    let mut first = token;
    while first > 0 && touch(first - 1) {
        first -= 1;
    }
    let mut last = token;
    while last + 1 < tokens.len() && touch(last) {
        last += 1;
    }
    first..last + 1
}

/// The places where the word around a token can be written apart.
fn seams(reading: &Reading, token: usize) -> Vec<u32> {
    let mut run = run(reading, token);
    run.next();
    run.map(|k| reading.tokens()[k].span.start).collect()
}

fn word(reading: &Reading, token: usize) -> String {
    let run = run(reading, token);
    let tokens = &reading.tokens()[run];
    let span = tokens.iter().map(|t| t.span).reduce(Span::to);
    span.map_or_else(String::new, |span| span.text(reading.text()).to_owned())
}

fn line(reading: &Reading, offset: u32) -> u32 {
    reading.text()[..offset as usize].matches('\n').count() as u32 + 1
}
