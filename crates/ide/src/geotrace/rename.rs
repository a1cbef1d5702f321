//! Renaming: every use of a name is renamed, and every other word is read as before.
//!
//! Words are split into the longest defined names, so a new name may be read where it was not intended. The edits are
//! therefore applied to a copy of the document, and the chunks that are read again are compared with the original, token
//! by token. A word that would be read differently is split by blanks; if that does not help, the renaming is refused.
//! Chunks that are not read again are unchanged.

use std::collections::HashSet;

use syntax::document::ChunkId;
use syntax::geotrace::declarations::DeclarationKeyword;
use syntax::geotrace::document::{Document, Snapshot};
use syntax::geotrace::token::TokenKind;
use syntax::span::Span;

use super::analysis::{GeotraceAnalysis, Lexeme};
use super::meaning::Meaning;
use super::targets::{ChunkTargets, Target};
use crate::edit::Edit;
use crate::rename::RenameError;

/// Returns the name at an offset and its span, if it can be renamed.
///
/// # Errors
/// [`RenameError::NoName`], [`RenameError::Builtin`].
pub fn prepare(analysis: &GeotraceAnalysis, offset: u32) -> Result<(Span, String), RenameError> {
    let (span, target) = target(analysis, offset)?;
    Ok((span, analysis.name(target).to_owned()))
}

fn target(analysis: &GeotraceAnalysis, offset: u32) -> Result<(Span, Target), RenameError> {
    let token = analysis.token_at(offset).ok_or(RenameError::NoName)?;
    let target = analysis.target(token).ok_or(RenameError::NoName)?;
    let is_builtin = match target {
        Target::Symbol(id) => analysis.item_of(id).is_none(),
        // The coordinates of a set are not introduced anywhere.
        Target::Parameter { item, .. } => analysis.item(item).is_none_or(|item| item.is_set()),
    };
    if is_builtin {
        return Err(RenameError::Builtin(analysis.name(target).to_owned()));
    }
    let token = analysis.token(token).ok_or(RenameError::NoName)?;
    Ok((token.span, target))
}

/// Returns the edits that rename the name at an offset, and insert blanks where words would otherwise be read
/// differently.
///
/// # Errors
/// [`RenameError`], with the reason.
pub fn rename(
    analysis: &GeotraceAnalysis,
    offset: u32,
    name: &str,
) -> Result<Vec<Edit>, RenameError> {
    let (_, target) = target(analysis, offset)?;
    if analysis.name(target) == name {
        return Ok(Vec::new());
    }
    check_name(analysis, target, name)?;
    let renamed = analysis.occurrences(target);
    let mut blanks: Vec<u32> = Vec::new();
    // Each round inserts blanks where the previous round found differences; a word is split at most once per letter.
    loop {
        let edits = edits(analysis, &renamed, &blanks, name);
        let again = Renamed::new(analysis, &edits);
        let Some(token) = again.first_difference(analysis, &renamed, name) else {
            return again.keeps_errors(analysis).map(|()| edits);
        };
        let before = blanks.len();
        blanks.extend(seams(analysis, token));
        blanks.sort_unstable();
        blanks.dedup();
        if blanks.len() == before {
            return Err(RenameError::ReadOtherwise {
                word: word(analysis, token),
                line: analysis
                    .token(token)
                    .map_or(1, |token| line(analysis, token.span.start)),
            });
        }
    }
}

/// Returns true if a word can be a name.
pub(crate) fn is_name(word: &str) -> bool {
    let mut letters = word.bytes();
    letters.next().is_some_and(|b| b.is_ascii_alphabetic())
        && letters.all(|b| b.is_ascii_alphanumeric())
        && word.len() <= 255
}

/// Returns true if a word is a keyword in any context.
pub(crate) fn is_reserved(word: &str) -> bool {
    DeclarationKeyword::from_text(word).is_some_and(|keyword| !keyword.is_soft())
}

/// Returns true if a name is available for a new declaration.
pub(crate) fn is_free(analysis: &GeotraceAnalysis, name: &str) -> bool {
    is_name(name) && !is_reserved(name) && analysis.document().named(name).is_none()
}

/// Refuses an invalid or unavailable name.
fn check_name(analysis: &GeotraceAnalysis, target: Target, name: &str) -> Result<(), RenameError> {
    if !is_name(name) {
        return Err(RenameError::NotAName {
            name: name.to_owned(),
            rule: "a name starts with a letter and has only letters a-z, A-Z and digits",
        });
    }
    if is_reserved(name) {
        return Err(RenameError::Keyword(name.to_owned()));
    }
    let taken = |line| {
        Err(RenameError::Taken {
            name: name.to_owned(),
            line,
        })
    };
    if let Some(id) = analysis.document().named(name)
        && Target::Symbol(id) != target
    {
        return taken(analysis.place(id).map(|span| line(analysis, span.start)));
    }
    // A parameter cannot have the name of a symbol above it, nor of another parameter of the list.
    let (first, count) = match target {
        Target::Symbol(id) => (analysis.item_of(id).unwrap_or_default(), usize::MAX),
        Target::Parameter { item, .. } => (item, 1),
    };
    let mut parameters = analysis
        .items_from(first)
        .take(count)
        .flat_map(|item| item.parameters());
    let clash = parameters.find(|(own, _)| *own == name);
    match clash {
        Some((_, place)) => taken(Some(line(analysis, place.start))),
        None => Ok(()),
    }
}

fn edits(analysis: &GeotraceAnalysis, renamed: &[usize], blanks: &[u32], name: &str) -> Vec<Edit> {
    let mut edits: Vec<Edit> = Vec::new();
    edits.extend(blanks.iter().map(|&offset| Edit::insert(offset, " ")));
    let tokens = renamed.iter().filter_map(|&k| analysis.token(k));
    let spans = tokens.map(|token| token.span);
    edits.extend(spans.map(|span| Edit::replace(span, name)));
    // A blank before a name comes before the replacement of the name.
    edits.sort_by_key(|edit| (edit.span.start, edit.span.end));
    edits
}

/// Combines edits, which are in the order of the text, into one.
fn joined(document: &Snapshot, edits: &[Edit]) -> (Span, String) {
    let spans = edits.iter().map(|edit| edit.span);
    let span = spans.reduce(Span::to).unwrap_or_default();
    let old = document.slice(span).unwrap_or_default();
    let mut text = String::with_capacity(old.len());
    let mut copied = span.start;
    for edit in edits {
        text += &old[(copied - span.start) as usize..(edit.span.start - span.start) as usize];
        text += &edit.text;
        copied = edit.span.end;
    }
    (span, text)
}

/// A copy of a document with the edits of a renaming.
struct Renamed {
    document: Document,
    /// The chunks that were read again, in the order of the text.
    read: Vec<ChunkId>,
}

impl Renamed {
    fn new(analysis: &GeotraceAnalysis, edits: &[Edit]) -> Self {
        let before = analysis.document();
        let mut document = Document::from_snapshot(before.clone());
        let mut read = HashSet::new();
        let chunk_of = |edit: &Edit| Some(before.placed_chunk_at(edit.span.start)?.chunk);
        // A chunk is read again once, however many edits it has. Chunks are edited from last to first, so that the
        // offsets of the others remain valid.
        let chunks = edits.chunk_by(|one, other| chunk_of(one) == chunk_of(other));
        for edits in chunks.rev() {
            let (span, text) = joined(before, edits);
            match document.edit(span, &text) {
                Ok(change) => read.extend(change.read),
                // The text would be too large: the name remains unchanged, which is detected below.
                Err(_) => read.extend(before.placed_chunk_at(span.start).map(|it| it.chunk)),
            }
        }
        let mut read: Vec<ChunkId> = read.into_iter().collect();
        read.sort_by_key(|chunk| before.rank(*chunk));
        Self { document, read }
    }

    /// Returns the index in the old reading of the first token that is read differently.
    fn first_difference(
        &self,
        old: &GeotraceAnalysis,
        renamed: &[usize],
        name: &str,
    ) -> Option<usize> {
        let (before, after): (&Snapshot, &Snapshot) = (old.document(), &self.document);
        self.read.iter().find_map(|chunk| {
            let (placed, other) = (before.placed_chunk(*chunk), after.placed_chunk(*chunk));
            let [targets, others] = [placed, other].map(ChunkTargets::new);
            let first = placed.first_token as usize;
            let is_same = |k: usize| {
                let (Some(token), Some(read)) = (placed.tokens().get(k), other.tokens().get(k))
                else {
                    return false;
                };
                let text = match renamed.binary_search(&(first + k)) {
                    Ok(_) => name,
                    Err(_) => token.span.text(placed.text),
                };
                Meaning::of(before, token.kind) == Meaning::of(after, read.kind)
                    && text == read.span.text(other.text)
                    && targets.introduces(k) == others.introduces(k)
            };
            let count = placed.tokens().len();
            let differs = (0..count).find(|k| !is_same(*k));
            let longer = (other.tokens().len() > count).then(|| count.saturating_sub(1));
            differs.or(longer).map(|k| first + k)
        })
    }

    /// Refuses a renaming that changes the errors: for example, a name that was declared twice would become free, and its
    /// second declaration would then have a meaning.
    fn keeps_errors(&self, old: &GeotraceAnalysis) -> Result<(), RenameError> {
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
                let placed = old.document().placed_chunk(chunk);
                let span = last.or(placed.tokens().span(0)).unwrap_or_default();
                return Err(RenameError::ReadOtherwise {
                    word: span.text(placed.text).to_owned(),
                    line: line(old, span.moved(placed.start).start),
                });
            }
        }
        Ok(())
    }
}

/// Returns true if a token consists of letters or digits.
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

/// Returns the run of adjacent words and numbers around a token.
fn run(analysis: &GeotraceAnalysis, token: usize) -> std::ops::Range<usize> {
    let touch = |k: usize| {
        let (one, other) = (analysis.token(k), analysis.token(k + 1));
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

/// Returns the offsets where the word around a token can be split.
fn seams(analysis: &GeotraceAnalysis, token: usize) -> Vec<u32> {
    let mut run = run(analysis, token);
    run.next();
    let tokens = analysis.tokens(run);
    tokens.map(|token| token.span.start).collect()
}

fn word(analysis: &GeotraceAnalysis, token: usize) -> String {
    let run = run(analysis, token);
    let tokens = analysis.tokens(run);
    let span = tokens.map(|token| token.span).reduce(Span::to);
    span.map_or_else(String::new, |span| analysis.slice(span))
}

fn line(analysis: &GeotraceAnalysis, offset: u32) -> u32 {
    analysis.document().line(offset)
}

#[cfg(test)]
mod tests {
    use super::{Renamed, edits};
    use crate::geotrace::analysis::GeotraceAnalysis;
    use crate::geotrace::targets::Target;

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
            let analysis = GeotraceAnalysis::new(text.as_str());
            let symbol = analysis.document().named("radius").expect("declared");
            let renamed = analysis.occurrences(Target::Symbol(symbol));
            assert_eq!(renamed.len(), 5);
            let again = Renamed::new(&analysis, &edits(&analysis, &renamed, &[], "length"));
            assert_eq!(again.read.len(), 5);
            assert_eq!(again.first_difference(&analysis, &renamed, "length"), None);
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
