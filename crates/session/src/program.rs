//! A compiled program, in the form that the model takes over.

use std::sync::Arc;
use std::time::Duration;

use ide::language::Analysis;
use ide::outline::DeclarationRange;
use scene::Scene;
use syntax::diagnostic::{Fix, Severity};
use syntax::span::Span;

/// The result of compiling a text.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The program.
    pub program: ReadProgram,
    /// The diagnostics, sorted by position.
    pub findings: Arc<[Finding]>,
    /// The scene. For a text with errors, it has the declarations without errors in their current form, and the others
    /// in their last valid one. A text of which nothing can be shown has no scene.
    pub scene: Option<Arc<Scene>>,
    /// The objects of the scene that are shown in their last valid form, and those that depend on them.
    pub stale: Vec<String>,
}

/// A program as it was read from a text.
#[derive(Clone, Debug, Default)]
pub struct ReadProgram {
    /// The text's version.
    pub version: i32,
    /// The text.
    pub text: Arc<str>,
    /// True if the text has no errors.
    pub ok: bool,
    /// The declarations of the text, in order.
    pub declared: Vec<DeclarationRange>,
    /// The analysis of the text, for editor features; `None` if the text cannot be read.
    pub analysis: Option<Arc<dyn Analysis>>,
    /// The time that compilation took.
    pub took: Duration,
}

/// Returns the first sentence of a program's initial comment, whose lines begin with `mark`.
pub fn first_sentence(text: &str, mark: &str) -> String {
    let lines = text.lines().map_while(|line| line.strip_prefix(mark));
    let first = lines.map(str::trim).take_while(|line| !line.is_empty());
    let paragraph = first.collect::<Vec<_>>().join(" ");
    match paragraph.find(". ") {
        Some(end) => paragraph[..=end].to_owned(),
        None => paragraph,
    }
}

/// A diagnostic with its line and column.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Finding {
    /// Its severity.
    pub severity: Severity,
    /// Its range in the text.
    pub span: Span,
    /// Its line, from 1.
    pub line: u32,
    /// Its column in characters, from 1.
    pub column: u32,
    /// One sentence.
    pub message: String,
    /// Advice for the user.
    pub hint: Option<String>,
    /// Alternative changes of the text that fix it; the user chooses one.
    pub fixes: Vec<Fix>,
}
