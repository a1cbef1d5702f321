//! Reads the texts of a program, one after the other.
//!
//! In: a text and its language. Out: its diagnostics, its declarations and its scene, also combined in the form that
//! the model takes over. Only the difference from the previous text is read again.

use std::sync::Arc;
use std::time::Duration;

use ide::language::Analysis;
use ide::language::EditError;
use ide::outline::DeclarationRange;
use ide::{Language, Program};
use protocol::changes::Changes;
use scene::ProgramScene;
use syntax::diagnostic::{Code, Diagnostic, Severity};
use syntax::line_index::LineIndex;
use syntax::span::Span;

use crate::program::{Compiled, Finding, ReadProgram};

/// Keeps the program of the text that was read last.
#[derive(Debug, Default)]
pub struct Reader {
    /// The name of the language, and the program.
    program: Option<(&'static str, Box<dyn Program>)>,
}

/// The result of reading a text.
#[derive(Debug, Default)]
pub struct Read {
    /// The diagnostics, sorted by position.
    pub diagnostics: Arc<[Diagnostic]>,
    /// The declarations of the text, in order.
    pub declarations: Vec<DeclarationRange>,
    /// The scene, and the objects that are in their last valid form.
    pub program: ProgramScene,
    /// The analysis of the text, for editor features; `None` if the text cannot be read.
    pub analysis: Option<Arc<dyn Analysis>>,
}

/// A text to be read.
#[derive(Clone, Copy, Debug)]
pub struct SourceText<'a> {
    /// The language of the text.
    pub language: &'a dyn Language,
    /// The whole text.
    pub text: &'a str,
    /// The changes that turn the previously read text into this one; their offsets refer to the previous text.
    pub changes: Option<&'a Changes>,
}

impl Read {
    /// Returns this version of the text in the form that the model takes over, with the duration zero.
    pub fn compiled(self, version: i32, text: Arc<str>) -> Compiled {
        let findings = findings(&text, &self.diagnostics);
        Compiled {
            program: ReadProgram {
                version,
                ok: findings.iter().all(|it| it.severity != Severity::Error),
                declared: self.declarations,
                analysis: self.analysis,
                text,
                took: Duration::ZERO,
            },
            findings,
            scene: self.program.scene,
            stale: self.program.stale,
        }
    }
}

/// Returns a text that caused a panic in its reader, with a finding that reports it.
pub fn unreadable(version: i32, text: Arc<str>) -> Compiled {
    let fault = Finding {
        severity: Severity::Error,
        span: Span::default(),
        line: 1,
        column: 1,
        message: "internal error: the program could not be read".to_owned(),
        hint: Some("please report it, with the program".to_owned()),
        fixes: Vec::new(),
    };
    let mut compiled = Read::default().compiled(version, text);
    compiled.program.ok = false;
    compiled.findings = [fault].into();
    compiled
}

/// Adds lines and columns to diagnostics.
pub(crate) fn findings(text: &str, diagnostics: &[Diagnostic]) -> Arc<[Finding]> {
    if diagnostics.is_empty() {
        return Arc::default();
    }
    let index = LineIndex::new(text);
    let finding = |diagnostic: &Diagnostic| {
        let place = index.position(diagnostic.span.start);
        Finding {
            severity: diagnostic.severity,
            span: diagnostic.span,
            line: place.line,
            column: place.column,
            message: diagnostic.message.clone(),
            hint: diagnostic.hint.clone(),
            fixes: diagnostic.fixes.clone(),
        }
    };
    diagnostics.iter().map(finding).collect()
}

impl Reader {
    /// Reads a text.
    pub fn read(&mut self, source: &SourceText<'_>) -> Read {
        match self.bring(source) {
            Ok(program) => Read {
                diagnostics: program.diagnostics(),
                declarations: program.declarations(),
                program: program.scene(),
                analysis: Some(program.snapshot()),
            },
            Err(error) => {
                let code = Code("too-large");
                let diagnostic = Diagnostic::error(code, Span::default(), error.to_string());
                Read {
                    diagnostics: [diagnostic].into(),
                    ..Read::default()
                }
            }
        }
    }

    /// Updates the program to a text by its changes, or by the difference if they are not known. Opens the text if
    /// there is no program of this language.
    fn bring(&mut self, source: &SourceText<'_>) -> Result<&dyn Program, EditError> {
        let name = source.language.name();
        let program = match self.program.take() {
            Some((known, mut program)) if known == name => {
                let changes = match source.changes {
                    Some(changes) => changes.clone(),
                    None => Changes::between(&program.text().string(), source.text),
                };
                // From the last to the first, so that the offsets of the others stay valid.
                for change in changes.iter().rev() {
                    let [start, end] = change.range;
                    program.edit(Span::new(start, end), &change.text)?;
                }
                program
            }
            _ => source.language.open(source.text)?,
        };
        debug_assert_eq!(
            program.text().string(),
            source.text,
            "the changes are not those of the text"
        );
        let (_, program) = self.program.insert((name, program));
        Ok(&**program)
    }
}

#[cfg(test)]
mod tests {
    use super::{Reader, SourceText};
    use ide::Languages;

    #[test]
    fn a_declaration_with_an_error_is_shown_as_it_last_was_and_the_places_are_those_of_the_text() {
        let good = "point p = (1,2,3);\npoint q = (0,0,0);\nvector v = (1,0,0) @ q;\n";
        let languages = Languages::standard();
        let mut reader = Reader::default();
        let mut read = |text| {
            reader.read(&SourceText {
                language: languages.default_language().as_ref(),
                text,
                changes: None,
            })
        };
        assert!(read(good).program.stale.is_empty());
        let broken = "point p = (1,2,;\npoint qq = (0,0,0);\nvector v = (1,0,0) @ qq;\n";
        let faulty = read(broken);
        assert!(!faulty.diagnostics.is_empty());
        assert_eq!(faulty.program.stale, ["p"]);
        assert_eq!(faulty.declarations[1].name_span.text(broken), "qq");
        let again = read(good);
        assert!(again.diagnostics.is_empty() && again.program.stale.is_empty());
    }
}
