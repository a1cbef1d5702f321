//! The CRT scene language: scripts on the incremental document, features on its snapshots.
//!
//! ```text
//! syntax::crt::document ──▶ CrtProgram ──snapshot──▶ CrtAnalysis ─┬─▶ names        variables and objects, by scope
//!                                                                 ├─▶ semantic, outline, hover, completion, color
//!                                                                 ├─▶ rename, format, edit_settings   edits
//!                                                                 └─▶ convert          a program in Geotrace's language
//! ```

pub mod color;
pub mod completion;
pub mod convert;
mod edit_settings;
pub mod format;
pub mod hover;
pub mod names;
pub mod outline;
pub mod rename;
pub mod semantic;

use std::sync::{Arc, OnceLock};

use scene::{Evaluation, Outcome, ParamValues, ProgramScene, Scene, Value};
use syntax::crt::document::{Document, Snapshot};
use syntax::crt::token::Token;
use syntax::crt::tree::Script;
use syntax::diagnostic::{Diagnostic, Severity};
use syntax::span::Span;

use names::ScriptNames;

use crate::color::StatedColor;
use crate::completion::Completions;
use crate::conversion::ConvertError;
use crate::description::Description;
use crate::edit::Edit;
use crate::edit_camera::EditCameraError;
use crate::edit_param::EditParamError;
use crate::highlight::Highlight;
use crate::language::{Analysis, EditError, Language, Program};
use crate::occurrence::Occurrence;
use crate::outline::{Fold, OutlineEntry};
use crate::rename::RenameError;
use crate::semantic::SemanticToken;
use crate::text::Text;

/// The name of the language.
pub(crate) const NAME: &str = "crt";

/// The CRT scene language.
#[derive(Clone, Copy, Debug, Default)]
pub struct Crt;

/// A CRT script.
#[derive(Debug)]
pub struct CrtProgram {
    document: Document,
    /// The diagnostics, once they have been requested.
    diagnostics: OnceLock<Arc<[Diagnostic]>>,
    /// The run, once it has been requested; `None` for a script that cannot be read, which is not run.
    run: OnceLock<Option<CrtRun>>,
}

/// A script that has been run.
#[derive(Debug)]
struct CrtRun {
    scene: Arc<Scene>,
    diagnostics: Vec<Diagnostic>,
}

/// A CRT script at one version.
#[derive(Debug)]
pub struct CrtAnalysis {
    snapshot: Snapshot,
    diagnostics: Arc<[Diagnostic]>,
    names: OnceLock<ScriptNames>,
}

impl Language for Crt {
    fn name(&self) -> &'static str {
        NAME
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["crt"]
    }

    fn line_comment(&self) -> Option<&'static str> {
        Some("--")
    }

    fn open(&self, text: &str) -> Result<Box<dyn Program>, EditError> {
        Ok(Box::new(CrtProgram {
            document: Document::new(text, &())?,
            diagnostics: OnceLock::new(),
            run: OnceLock::new(),
        }))
    }

    fn highlight(&self, text: &str) -> Vec<Highlight> {
        let parts = syntax::crt::highlight::highlight(text).into_iter();
        let parts = parts.map(|(span, kind)| Highlight { span, kind });
        parts.collect()
    }
}

impl Program for CrtProgram {
    fn text(&self) -> &dyn Text {
        &*self.document
    }

    fn edit(&mut self, range: Span, text: &str) -> Result<(), EditError> {
        self.document.edit(range, text)?;
        self.diagnostics = OnceLock::new();
        self.run = OnceLock::new();
        Ok(())
    }

    fn diagnostics(&self) -> Arc<[Diagnostic]> {
        let diagnostics = || {
            let mut all = self.document.findings();
            all.extend(self.run().iter().flat_map(|run| run.diagnostics.clone()));
            Diagnostic::sort(&mut all);
            all.into()
        };
        self.diagnostics.get_or_init(diagnostics).clone()
    }

    fn scene(&self) -> ProgramScene {
        ProgramScene {
            scene: self.run().map(|run| run.scene.clone()),
            ..ProgramScene::default()
        }
    }

    fn evaluate(
        &self,
        expression: &str,
        params: &ParamValues,
    ) -> Result<Evaluation, Vec<Diagnostic>> {
        let expression = syntax::crt::parse_expression(expression)?;
        let t = params.uniforms().first().copied().unwrap_or(0.0);
        let snapshot = self.document.snapshot();
        let script = snapshot.script();
        let found = scene::crt::evaluate(&script, &whole(&snapshot), t, &expression)?;
        let defined = |number: &f64| number.is_finite().then_some(*number);
        let numbers: Vec<Option<f64>> = found.numbers.iter().map(defined).collect();
        Ok(Evaluation {
            outcome: Outcome::Single(match numbers[..] {
                [] => Value::Text(found.text),
                [number] => Value::Number(number),
                _ => Value::Vector(numbers),
            }),
            warnings: Vec::new(),
        })
    }

    fn snapshot(&self) -> Arc<dyn Analysis> {
        Arc::new(CrtAnalysis {
            snapshot: self.document.snapshot(),
            diagnostics: self.diagnostics(),
            names: OnceLock::new(),
        })
    }
}

impl CrtProgram {
    /// The run; `None` for a script that cannot be read.
    fn run(&self) -> Option<&CrtRun> {
        let run = self.run.get_or_init(|| {
            let found = self.document.findings();
            if found.iter().any(|it| it.severity == Severity::Error) {
                return None;
            }
            let snapshot = self.document.snapshot();
            let run = scene::crt::run(&snapshot.script(), &whole(&snapshot));
            Some(CrtRun {
                scene: Arc::new(run.scene),
                diagnostics: run.diagnostics,
            })
        });
        run.as_ref()
    }
}

fn whole(snapshot: &Snapshot) -> String {
    let all = Span::new(0, snapshot.len());
    snapshot.slice(all).unwrap_or_default()
}

impl CrtAnalysis {
    /// The tree of the script.
    pub fn script(&self) -> Script {
        self.snapshot.script()
    }

    pub(crate) fn snapshot_text(&self) -> &Snapshot {
        &self.snapshot
    }

    /// The names of the script, which are looked up on the first call.
    pub fn names(&self) -> &ScriptNames {
        self.names.get_or_init(|| ScriptNames::of(&self.script()))
    }

    /// The tokens that touch a range, comments among them.
    pub fn tokens(&self, range: Span) -> impl Iterator<Item = Token> + '_ {
        self.snapshot.tokens(range)
    }

    /// All tokens, comments among them.
    pub fn all_tokens(&self) -> Vec<Token> {
        self.tokens(Span::new(0, self.snapshot.len())).collect()
    }

    /// The text of a range; empty if the range lies outside the text.
    pub fn slice(&self, span: Span) -> String {
        self.snapshot.slice(span).unwrap_or_default()
    }

    /// The word at a place: the token that holds it, or else the word that ends there.
    pub fn word_at(&self, offset: u32) -> Option<Token> {
        let around = Span::new(offset, offset);
        let mut words = self.tokens(around).filter(|token| {
            let text = self.slice(token.span);
            text.starts_with(|c: char| c.is_ascii_alphabetic())
        });
        words.next()
    }
}

impl Analysis for CrtAnalysis {
    fn text(&self) -> &dyn Text {
        &self.snapshot
    }

    fn diagnostics(&self) -> Arc<[Diagnostic]> {
        Arc::clone(&self.diagnostics)
    }

    fn semantic_tokens(&self, range: Span) -> Vec<SemanticToken> {
        semantic::semantic_tokens(self, range)
    }

    fn outline(&self) -> Vec<OutlineEntry> {
        outline::outline(self)
    }

    fn folds(&self) -> Vec<Fold> {
        outline::folds(self)
    }

    fn selection(&self, offset: u32) -> Vec<Span> {
        outline::selection(self, offset)
    }

    fn hover(&self, offset: u32) -> Option<(Span, Description)> {
        hover::hover(self, offset)
    }

    fn completions(&self, offset: u32, snippets: bool) -> Completions {
        completion::completions(self, offset, snippets)
    }

    fn describe_completion(&self, offset: u32, label: &str) -> Option<Description> {
        completion::describe(self, offset, label)
    }

    fn definition(&self, offset: u32) -> Option<(Span, Span)> {
        let (span, variable) = self.names().variable_at(offset)?;
        Some((span, self.names().first(variable)?))
    }

    fn occurrences(&self, offset: u32) -> Vec<Occurrence> {
        match self.names().variable_at(offset) {
            Some((_, variable)) => self.names().occurrences(variable),
            None => Vec::new(),
        }
    }

    fn prepare_rename(&self, offset: u32) -> Result<(Span, String), RenameError> {
        rename::prepare(self, offset)
    }

    fn rename(&self, offset: u32, name: &str) -> Result<Vec<Edit>, RenameError> {
        rename::rename(self, offset, name)
    }

    fn format(&self, range: Option<Span>) -> Vec<Edit> {
        format::format(self, range)
    }

    fn colors(&self) -> Vec<StatedColor> {
        color::colors(self)
    }

    fn conversion(&self) -> Option<&'static str> {
        Some(crate::geotrace::EXTENSION)
    }

    fn convert(&self, uniforms: &[f64], file: &str) -> Result<String, ConvertError> {
        let t = uniforms.first().copied().unwrap_or(0.0);
        convert::convert(self, t, file)
    }

    fn edit_param(&self, param: &str, values: &[f64]) -> Result<Edit, EditParamError> {
        edit_settings::edit_number(self, param, values)
    }

    fn edit_camera(
        &self,
        _name: &str,
        direction: [f64; 3],
        position: [f64; 3],
    ) -> Result<Edit, EditCameraError> {
        edit_settings::edit_camera(self, direction, position)
    }

    fn color_texts(&self, _range: Span, rgb: [f64; 3]) -> Vec<String> {
        color::color_texts(rgb)
    }
}
