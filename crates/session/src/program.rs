//! A compiled program, as the model takes it over.

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
    /// The text's version.
    pub version: i32,
    /// The text.
    pub text: Arc<str>,
    /// Set if the text has no errors.
    pub ok: bool,
    /// The diagnostics, sorted by place.
    pub findings: Arc<[Finding]>,
    /// The scene. The scene of a text with errors has the declarations without errors as they are now, and the others
    /// as they last were. A text of which nothing can be shown has no scene.
    pub scene: Option<Arc<Scene>>,
    /// The objects of the scene that are shown as they last were, and those that read such an object.
    pub stale: Vec<String>,
    /// The declarations of the text, in its order.
    pub declared: Vec<DeclarationRange>,
    /// The text for the features of an editor; none of a text that cannot be read.
    pub analysis: Option<Arc<dyn Analysis>>,
    /// The time that compiling took.
    pub took: Duration,
}

/// A diagnostic with its line and column.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Finding {
    /// Its severity.
    pub severity: Severity,
    /// Its place in the text.
    pub span: Span,
    /// Its line, from 1.
    pub line: u32,
    /// Its column in characters, from 1.
    pub column: u32,
    /// One sentence.
    pub message: String,
    /// Advice for the user.
    pub hint: Option<String>,
    /// Changes of the text that correct it, one of which the user chooses.
    pub fixes: Vec<Fix>,
}
