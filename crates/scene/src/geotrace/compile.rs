//! From a text to a [`Compilation`]: the scene, or the errors.

use syntax::diagnostic::Diagnostic;
use syntax::geotrace::parse_program;
use syntax::span::Span;

use crate::evaluation::Evaluation;
use crate::geotrace::builtin;
use crate::geotrace::declarations::Declarations;
use crate::geotrace::error::{self, SemanticError, has_errors};
use crate::geotrace::evaluate::Scope;
use crate::param_values::ParamValues;
use crate::scene::Scene;

/// The result of compiling a text.
#[derive(Clone, Debug, Default)]
pub struct Compilation {
    /// The diagnostics, sorted by position. Spans refer to the text.
    pub diagnostics: Vec<Diagnostic>,
    /// The scene, if no diagnostic is an error.
    pub scene: Option<Scene>,
    /// The meanings of the names at the end of the text, if no diagnostic is an error.
    scope: Option<Scope>,
}

/// Compiles a program: reads every declaration, reports every error, and builds the scene if there are none.
///
/// ```
/// let compilation = scene::geotrace::compile("param r : [1, 2];  curve c(t) = r(cost, sint, 0), t : [0, 2pi];");
/// let scene = compilation.scene.expect("no errors");
/// assert_eq!(scene.objects.len(), 1);
///
/// let compilation = scene::geotrace::compile("point p = (1, 2);");
/// assert_eq!(compilation.diagnostics[0].code.0, "not-in-space");
/// ```
pub fn compile(source: &str) -> Compilation {
    let mut declarations = Declarations::new();
    let parsed = parse_program(source, &builtin::vocabulary(), &mut declarations);
    let mut diagnostics = std::mem::take(&mut declarations.diagnostics);
    Diagnostic::sort(&mut diagnostics);
    let program = (!has_errors(&diagnostics)).then(|| {
        let scene = declarations.scene();
        (scene, Scope::new(source, parsed, declarations))
    });
    Compilation::new(diagnostics, program)
}

impl Compilation {
    pub(crate) fn new(diagnostics: Vec<Diagnostic>, program: Option<(Scene, Scope)>) -> Self {
        let (scene, scope) = program.unzip();
        Self {
            diagnostics,
            scene,
            scope,
        }
    }

    /// Returns true if a diagnostic is an error; then there is no scene.
    pub fn has_errors(&self) -> bool {
        has_errors(&self.diagnostics)
    }

    /// Returns the value of an expression, read with the names at the program's end.
    ///
    /// `params` are those of the program's scene. [`Compilation::scene`] may have been taken out.
    ///
    /// ```
    /// use scene::{Outcome, ParamValues, Value};
    ///
    /// let compilation = scene::geotrace::compile("function f(x) = x^3;");
    /// let params = ParamValues::initial(compilation.scene.as_ref().expect("no errors"));
    /// let evaluation = compilation.evaluate("f'2", &params).expect("no errors");
    /// assert_eq!(evaluation.outcome, Outcome::Single(Value::Number(Some(12.0))));
    /// ```
    ///
    /// # Errors
    /// The diagnostics of the expression, sorted by position; all spans refer to `text`. An expression has no value in
    /// a program with errors.
    pub fn evaluate(
        &self,
        text: &str,
        params: &ParamValues,
    ) -> Result<Evaluation, Vec<Diagnostic>> {
        match &self.scope {
            Some(scope) => scope.evaluate(text, params),
            None => {
                let span = Span::new(0, u32::try_from(text.len()).unwrap_or(u32::MAX));
                let message = "the program has errors, so no expression has a value in it";
                Err(vec![
                    SemanticError::new(error::PROGRAM_HAS_ERRORS, message).at(span),
                ])
            }
        }
    }
}
