//! Diagnostics for other programs: one JSON document.

use serde::Serialize;
use syntax::diagnostic::Diagnostic;

use crate::source::SourceText;

/// `{"diagnostics": […]}`
#[derive(Debug, Default, Serialize)]
pub(crate) struct DiagnosticsJson {
    diagnostics: Vec<DiagnosticEntry>,
}

/// One diagnostic. Lines and columns count from 1, columns in Unicode scalar values; the end is the position after the
/// last character.
#[derive(Debug, Serialize)]
struct DiagnosticEntry {
    file: String,
    line: u32,
    column: u32,
    end_line: u32,
    end_column: u32,
    severity: &'static str,
    code: &'static str,
    message: String,
    hint: Option<String>,
}

impl DiagnosticsJson {
    /// Adds the diagnostics of one text.
    pub(crate) fn add(&mut self, source: &SourceText, diagnostics: &[Diagnostic]) {
        if diagnostics.is_empty() {
            return;
        }
        let lines = source.lines();
        self.diagnostics
            .extend(diagnostics.iter().map(|diagnostic| {
                let start = lines.position(diagnostic.span.start);
                let end = lines.position(diagnostic.span.end);
                DiagnosticEntry {
                    file: source.name.clone(),
                    line: start.line,
                    column: start.column,
                    end_line: end.line,
                    end_column: end.column,
                    severity: diagnostic.severity.name(),
                    code: diagnostic.code.0,
                    message: diagnostic.message.clone(),
                    hint: diagnostic.hint.clone(),
                }
            }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use syntax::diagnostic::{Code, Severity};
    use syntax::span::Span;

    #[test]
    fn entries_have_the_keys_of_the_contract() {
        let source = SourceText::new("a.gtr".into(), "π\nérr".into());
        let mut document = DiagnosticsJson::default();
        document.add(
            &source,
            &[Diagnostic {
                severity: Severity::Error,
                code: Code("undefined-name"),
                span: Span::new(5, 7),
                message: "`rr` is not defined".into(),
                hint: None,
                related: Vec::new(),
                fixes: Vec::new(),
            }],
        );
        assert_eq!(
            serde_json::to_string(&document).expect("JSON"),
            "{\"diagnostics\":[{\"file\":\"a.gtr\",\"line\":2,\"column\":2,\"end_line\":2,\"end_column\":4,\
             \"severity\":\"error\",\"code\":\"undefined-name\",\"message\":\"`rr` is not defined\",\
             \"hint\":null}]}"
        );
    }
}
