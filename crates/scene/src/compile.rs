//! From a text to a [`Compilation`]: the scene, or what is wrong with it.

use syntax::diagnostic::{Diagnostic, Severity};

use crate::evaluate::Evaluation;
use crate::scene::Scene;
use crate::values::Settings;

/// What a text compiles to.
#[derive(Clone, Debug)]
pub struct Compilation {
    /// What was found, sorted by place. Spans are those of the text.
    pub diagnostics: Vec<Diagnostic>,
    /// The scene; none where any diagnostic is an error.
    pub scene: Option<Scene>,
}

/// Compiles a program: reads every declaration, reports every mistake, and builds the scene if there is none.
pub fn compile(source: &str) -> Compilation {
    let _ = source;
    todo!()
}

impl Compilation {
    /// Whether the program has an error; it then has no scene. Warnings are no errors.
    pub fn has_errors(&self) -> bool {
        self.diagnostics
            .iter()
            .any(|diagnostic| diagnostic.severity == Severity::Error)
    }

    /// The value of an expression, read with the names that stand at the program's end.
    ///
    /// # Errors
    /// What is wrong with the expression, sorted by place; all spans are those of `text`. An expression has
    /// no value in a program with errors.
    pub fn evaluate(&self, text: &str, settings: &Settings) -> Result<Evaluation, Vec<Diagnostic>> {
        let _ = (text, settings);
        todo!()
    }
}
