//! Renaming: every use of a name gets another, and every other word keeps its reading.
//!
//! Words are split into the longest names that are defined, so a new name may be read where it was never meant. The
//! edits are therefore made on a copy of the document and what is read again is compared with what it was, token by
//! token; a word that would be read otherwise is written apart, and what blanks cannot mend is refused. What is not read
//! again is what it was.

use std::collections::HashSet;

use syntax::document::ChunkId;
use syntax::geotrace::declarations::DeclarationKeyword;
use syntax::geotrace::document::{Document, Snapshot};
use syntax::geotrace::token::TokenKind;
use syntax::span::Span;

use crate::edit::Edit;
use crate::meaning::Meaning;
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
    DeclarationKeyword(String),
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
            Self::DeclarationKeyword(name) => {
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
        let again = Renamed::new(reading, &edits);
        let Some(token) = again.first_difference(reading, &renamed, name) else {
            return again.keeps_errors(reading).map(|()| edits);
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

/// Whether the name is one, and free.
fn check_name(reading: &Reading, target: Target, name: &str) -> Result<(), RenameError> {
    let mut letters = name.bytes();
    let well_formed = letters.next().is_some_and(|b| b.is_ascii_alphabetic())
        && letters.all(|b| b.is_ascii_alphanumeric());
    if !well_formed || name.len() > 255 {
        return Err(RenameError::NotAName(name.to_owned()));
    }
    if DeclarationKeyword::from_text(name).is_some() {
        return Err(RenameError::DeclarationKeyword(name.to_owned()));
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

/// A copy of a document with the edits of a renaming.
struct Renamed {
    document: Document,
    /// What was read again, in the order of the text.
    read: Vec<ChunkId>,
}

impl Renamed {
    fn new(reading: &Reading, edits: &[Edit]) -> Self {
        let before = reading.document();
        let mut document = Document::from_snapshot(before.clone());
        let mut read = HashSet::new();
        // From the last to the first, so that the places of the others stay.
        for edit in edits.iter().rev() {
            match document.edit(edit.span, &edit.text) {
                Ok(change) => read.extend(change.read),
                // The text would be too large: the name stays what it was, which is found below.
                Err(_) => read.extend(before.piece_at(edit.span.start).map(|it| it.chunk)),
            }
        }
        let mut read: Vec<ChunkId> = read.into_iter().collect();
        read.sort_by_key(|chunk| before.rank(*chunk));
        Self { document, read }
    }

    /// The first token that is read otherwise, as a position in the old reading.
    fn first_difference(&self, old: &Reading, renamed: &[usize], name: &str) -> Option<usize> {
        let (before, after): (&Snapshot, &Snapshot) = (old.document(), &self.document);
        self.read.iter().find_map(|chunk| {
            let (piece, other) = (before.piece_of(*chunk), after.piece_of(*chunk));
            let first = piece.first_token as usize;
            let is_same = |k: usize| {
                let (Some(token), Some(read)) = (piece.tokens().get(k), other.tokens().get(k))
                else {
                    return false;
                };
                let text = match renamed.binary_search(&(first + k)) {
                    Ok(_) => name,
                    Err(_) => token.span.text(piece.text),
                };
                Meaning::of(before, token.kind) == Meaning::of(after, read.kind)
                    && text == read.span.text(other.text)
                    && introduces_in(piece, k) == introduces_in(other, k)
            };
            let count = piece.tokens().len();
            let differs = (0..count).find(|k| !is_same(*k));
            let longer = (other.tokens().len() > count).then(|| count.saturating_sub(1));
            differs.or(longer).map(|k| first + k)
        })
    }

    /// Whether the same errors are found: a name that was taken would be free where it is declared once more, and would
    /// then mean something else there.
    fn keeps_errors(&self, old: &Reading) -> Result<(), RenameError> {
        for &chunk in &self.read {
            let errors = old.document().errors(chunk);
            let mut found = self.document.errors(chunk).map(|(code, _)| code);
            let mut last = None;
            for (code, span) in errors {
                last = Some(span);
                if found.next() != Some(code) {
                    break;
                }
                last = None;
            }
            let is_more = found.next().is_some();
            if last.is_some() || is_more {
                let piece = old.document().piece_of(chunk);
                let span = last.or(piece.tokens().span(0)).unwrap_or_default();
                return Err(RenameError::ReadOtherwise {
                    word: span.text(piece.text).to_owned(),
                    line: line(old, span.moved(piece.start).start),
                });
            }
        }
        Ok(())
    }
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

#[cfg(test)]
mod tests {
    use super::{Renamed, edits};
    use crate::reading::{Reading, Target};

    #[test]
    fn what_is_read_again_is_what_uses_the_name_however_long_the_program_is() {
        let work = |declarations: usize| {
            let mut text = "define radius = 2;\n".to_owned();
            for k in 0..declarations {
                let used = if k % (declarations / 4) == 0 {
                    "radius"
                } else {
                    "pi"
                };
                text += &format!("define a{k} = 2{used} + {k};\n");
            }
            let reading = Reading::new(text.as_str());
            let symbol = reading.document().named("radius").expect("declared");
            let renamed = reading.occurrences(Target::Symbol(symbol));
            assert_eq!(renamed.len(), 5);
            let again = Renamed::new(&reading, &edits(&reading, &renamed, &[], "length"));
            assert_eq!(again.read.len(), 5);
            assert_eq!(again.first_difference(&reading, &renamed, "length"), None);
            let work = again.document.counters();
            (work.cut, work.edited, work.reread)
        };
        let (cut, edited, reread) = work(4_000);
        assert_eq!((edited, reread), (5, 4));
        // The numbers in the declarations are longer, the declarations as many.
        let (shorter, edited, reread) = work(40);
        assert_eq!((edited, reread), (5, 4));
        assert!(cut < shorter + 5 * 10, "{cut} and {shorter}");
    }
}
