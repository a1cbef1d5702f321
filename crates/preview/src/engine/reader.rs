//! Reads the texts of a window, one after the other.
//!
//! In: a text. Out: its diagnostics, what it declares, and its scene. Only what differs from the text before is read anew.

use scene::ProgramScene;
use scene::geotrace::Document;
use syntax::diagnostic::{Code, Diagnostic};
use syntax::document::EditError;
use syntax::span::Span;

use crate::state::Declared;

/// Keeps the document of the text that was read last.
#[derive(Debug, Default)]
pub(crate) struct Reader {
    document: Option<Document>,
}

/// What was read.
#[derive(Debug, Default)]
pub(crate) struct Read {
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// What the text declares, in its order.
    pub(crate) declared: Vec<Declared>,
    pub(crate) program: ProgramScene,
}

impl Reader {
    /// Reads a text.
    pub(crate) fn read(&mut self, text: &str) -> Read {
        if let Err(error) = self.bring(text) {
            let code = Code("too-large");
            let sentence = error.to_string();
            return Read {
                diagnostics: vec![Diagnostic::error(code, Span::default(), sentence)],
                ..Read::default()
            };
        }
        let Some(document) = &self.document else {
            return Read::default();
        };
        Read {
            diagnostics: document.compilation().diagnostics.clone(),
            declared: declared(document),
            program: document.scene_with_last_good().clone(),
        }
    }

    /// Brings the document to a text by one edit of what differs.
    fn bring(&mut self, text: &str) -> Result<(), EditError> {
        let Some(document) = &mut self.document else {
            self.document = Some(Document::new(text)?);
            return Ok(());
        };
        let old = document.text().text();
        let (range, new) = difference(&old, text);
        if range.start < range.end || !new.is_empty() {
            document.edit(range, new)?;
        }
        Ok(())
    }
}

/// What a text declares.
fn declared(document: &Document) -> Vec<Declared> {
    let text = document.text();
    let mut all = Vec::new();
    let mut start = 0;
    for chunk in text.chunks() {
        let read = text.events(chunk).declarations();
        let named = read.filter(|(read, _)| !read.name.is_empty());
        all.extend(named.map(|(read, _)| Declared {
            span: read.span.moved(start),
            name_span: read.name_span.moved(start),
        }));
        start += text.chunk_text(chunk).len() as u32;
    }
    all
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
    use super::{Reader, difference};
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

    #[test]
    fn a_declaration_with_an_error_is_shown_as_it_last_was_and_the_places_are_those_of_the_text() {
        let good = "point p = (1,2,3);\npoint q = (0,0,0);\nvector v = (1,0,0) @ q;\n";
        let mut reader = Reader::default();
        assert!(reader.read(good).program.stale.is_empty());
        let broken = "point p = (1,2,;\npoint qq = (0,0,0);\nvector v = (1,0,0) @ qq;\n";
        let read = reader.read(broken);
        assert!(!read.diagnostics.is_empty());
        assert_eq!(read.program.stale, ["p"]);
        assert_eq!(read.declared[1].name_span.text(broken), "qq");
        let read = reader.read(good);
        assert!(read.diagnostics.is_empty() && read.program.stale.is_empty());
    }
}
