//! What can be shown of a program with errors.
//!
//! In: a text. Out: its diagnostics, and a scene. Where a declaration has an error, its last good text stands in for
//! it, so that the others keep up with what is written; where there is none, it is left out, and so is what needs it.

use std::collections::HashMap;

use scene::Document;
use scene::scene::Scene;
use syntax::diagnostic::{Diagnostic, Severity};
use syntax::document::ChunkId;
use syntax::span::Span;

/// How often declarations are left out before the whole scene is given up: each round can only bring out errors of
/// what used the one before.
const ROUNDS: usize = 6;

/// Reads texts one after the other, and remembers the last good declarations.
#[derive(Debug, Default)]
pub(crate) struct Mender {
    document: Option<Document>,
    /// The last good text of what is declared, by name.
    good: HashMap<String, String>,
}

/// What was read.
#[derive(Debug, Default)]
pub(crate) struct Read {
    /// Of the text as it is.
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// Places of names are those of the text as it is; of a declaration that is stood in for, its place.
    pub(crate) scene: Option<Scene>,
    /// The objects that are shown as they last were.
    pub(crate) stale: Vec<String>,
}

/// A declaration on its way to a mended text.
struct Piece {
    /// Where it stands in the text as it is.
    place: Span,
    /// Its text, or the one that stands in for it.
    text: String,
    stands_in: bool,
}

impl Mender {
    /// Reads a text, of which only what differs from the one before is read anew.
    pub(crate) fn read(&mut self, text: &str) -> Read {
        if let Err(diagnostics) = self.update(text) {
            return Read {
                diagnostics,
                ..Read::default()
            };
        }
        let Some(document) = &self.document else {
            return Read::default();
        };
        let compilation = document.compilation();
        let diagnostics = compilation.diagnostics.clone();
        if let Some(scene) = &compilation.scene {
            let scene = scene.clone();
            self.good = document
                .text()
                .chunks()
                .filter_map(|chunk| {
                    let text = document.text().chunk_text(chunk);
                    Some((name_of(document, chunk)?, text.to_owned()))
                })
                .collect();
            return Read {
                diagnostics,
                scene: Some(scene),
                stale: Vec::new(),
            };
        }
        let pieces = self.pieces(document, &diagnostics);
        let (scene, stale) = mended(pieces).unzip();
        Read {
            diagnostics,
            scene,
            stale: stale.unwrap_or_default(),
        }
    }

    /// Brings the document to a text by one edit of what differs.
    fn update(&mut self, text: &str) -> Result<(), Vec<Diagnostic>> {
        let refused = |error: syntax::document::EditError| {
            let code = syntax::diagnostic::Code("too-large");
            vec![Diagnostic::error(code, Span::default(), error.to_string())]
        };
        let Some(document) = &mut self.document else {
            self.document = Some(Document::new(text).map_err(refused)?);
            return Ok(());
        };
        let old = document.text().text();
        let (range, new) = difference(&old, text);
        if range.start == range.end && new.is_empty() {
            return Ok(());
        }
        document.edit(range, new).map_err(refused)?;
        Ok(())
    }

    fn pieces(&self, document: &Document, diagnostics: &[Diagnostic]) -> Vec<Piece> {
        let piece = |chunk: ChunkId| {
            let text = document.text().chunk_text(chunk);
            let start = document.text().start(chunk);
            let place = Span::new(start, start + text.len() as u32);
            let text = if has_error(diagnostics, place) {
                let name = name_of(document, chunk);
                let good = name.and_then(|name| self.good.get(&name)).cloned();
                return Piece {
                    place,
                    text: good.unwrap_or_default(),
                    stands_in: true,
                };
            } else {
                text.to_owned()
            };
            Piece {
                place,
                text,
                stands_in: false,
            }
        };
        document.text().chunks().map(piece).collect()
    }
}

/// Compiles pieces, leaving out what still has errors.
fn mended(mut pieces: Vec<Piece>) -> Option<(Scene, Vec<String>)> {
    for _ in 0..ROUNDS {
        let text: String = pieces.iter().map(|piece| piece.text.as_str()).collect();
        let compilation = scene::compile(&text);
        let Some(mut scene) = compilation.scene else {
            let mut start = 0;
            for piece in &mut pieces {
                let end = start + piece.text.len() as u32;
                if has_error(&compilation.diagnostics, Span::new(start, end)) {
                    piece.text.clear();
                    piece.stands_in = true;
                }
                start = end;
            }
            continue;
        };
        let mut stale = Vec::new();
        let mut starts = Vec::with_capacity(pieces.len());
        let mut length = 0;
        for piece in &pieces {
            starts.push(length);
            length += piece.text.len() as u32;
        }
        let mut place = |name: &str, span: &mut Span| {
            // Empty pieces share their start with the one behind them, which is the last of those.
            let index = starts.partition_point(|start| *start <= span.start);
            let Some((piece, start)) = index
                .checked_sub(1)
                .and_then(|index| Some((pieces.get(index)?, starts[index])))
            else {
                return;
            };
            if piece.stands_in {
                stale.push(name.to_owned());
                *span = piece.place;
            } else {
                let moved = |at: u32| at - start + piece.place.start;
                *span = Span::new(moved(span.start), moved(span.end));
            }
        };
        for object in &mut scene.objects {
            place(&object.name, &mut object.name_span);
        }
        for param in &mut scene.params {
            place(&param.name, &mut param.name_span);
        }
        for grid in &mut scene.grids {
            place(&grid.name, &mut grid.name_span);
        }
        return Some((scene, stale));
    }
    None
}

fn has_error(diagnostics: &[Diagnostic], place: Span) -> bool {
    diagnostics.iter().any(|diagnostic| {
        let at = diagnostic.span.start;
        // What is missing at the end of a text is reported there.
        let inside = place.start <= at && (at < place.end || at == place.end && at > place.start);
        diagnostic.severity == Severity::Error && inside
    })
}

/// What a chunk declares: the name that was read, or that stands behind its first word.
fn name_of(document: &Document, chunk: ChunkId) -> Option<String> {
    let events = document.text().events(chunk);
    let names = events.declarations().map(|(read, _)| read.name);
    if let Some(read) = names.filter(|name| !name.is_empty()).last() {
        return Some(read.to_owned());
    }
    let text = document.text().chunk_text(chunk);
    let code = text
        .lines()
        .map(|line| line.split('#').next().unwrap_or(""));
    let code: String = code.collect::<Vec<_>>().join(" ");
    let mut words = code.split(|c: char| !c.is_ascii_alphanumeric());
    let mut words = words.by_ref().filter(|word| !word.is_empty());
    let name = words.nth(1)?;
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        .then(|| name.to_owned())
}

/// What of `old` is to be replaced by what, so that it becomes `new`: all but the longest common start and end.
fn difference<'n>(old: &str, new: &'n str) -> (Span, &'n str) {
    let mut start = old
        .bytes()
        .zip(new.bytes())
        .take_while(|(a, b)| a == b)
        .count();
    while !(old.is_char_boundary(start) && new.is_char_boundary(start)) {
        start -= 1;
    }
    let (a, b) = (&old.as_bytes()[start..], &new.as_bytes()[start..]);
    let mut end = a
        .iter()
        .rev()
        .zip(b.iter().rev())
        .take_while(|(a, b)| a == b)
        .count();
    while !(old.is_char_boundary(old.len() - end) && new.is_char_boundary(new.len() - end)) {
        end -= 1;
    }
    let range = Span::new(start as u32, (old.len() - end) as u32);
    (range, &new[start..new.len() - end])
}

#[cfg(test)]
mod tests {
    use super::{Mender, difference};
    use syntax::span::Span;

    #[test]
    fn the_difference_of_two_texts_is_what_lies_between_their_common_ends() {
        for (old, new, range, text) in [
            ("abc", "abxc", (2, 2), "x"),
            ("aaa", "aa", (2, 3), ""),
            ("é", "è", (0, 2), "è"),
            ("", "x", (0, 0), "x"),
            ("same", "same", (4, 4), ""),
        ] {
            assert_eq!(difference(old, new), (Span::new(range.0, range.1), text));
        }
    }

    const GOOD: &str = "point p = (1,2,3);\npoint q = (0,0,0);\nvector v = (1,0,0) @ q;\n";

    #[test]
    fn a_declaration_with_an_error_is_shown_as_it_last_was_while_others_move_on() {
        let mut mender = Mender::default();
        assert!(mender.read(GOOD).stale.is_empty());
        let broken = "point p = (1,2,;\npoint qq = (0,0,0);\nvector v = (1,0,0) @ qq;\n";
        let read = mender.read(broken);
        assert!(!read.diagnostics.is_empty());
        assert_eq!(read.stale, ["p"]);
        let scene = read.scene.expect("mended");
        let names: Vec<&str> = scene.objects.iter().map(|it| it.name.as_str()).collect();
        assert_eq!(names, ["p", "qq", "v"]);
        assert_eq!(scene.objects[1].name_span.text(broken), "qq");
    }

    #[test]
    fn what_needs_a_declaration_that_was_never_good_is_left_out() {
        let text = "point q = (0,0;\nvector v = (1,0,0) @ q;\npoint r = (1,1,1);";
        let read = Mender::default().read(text);
        let scene = read.scene.expect("mended");
        let names: Vec<&str> = scene.objects.iter().map(|it| it.name.as_str()).collect();
        assert_eq!(names, ["r"]);
    }

    #[test]
    fn a_text_that_is_mended_by_hand_has_no_stale_objects() {
        let mut mender = Mender::default();
        mender.read(GOOD);
        mender.read("point p = ");
        let read = mender.read(GOOD);
        assert!(read.diagnostics.is_empty() && read.stale.is_empty());
        assert_eq!(read.scene.expect("good").objects.len(), 3);
    }
}
