//! The CRT scene language: scripts on the incremental document, features on its snapshots.
//!
//! ```text
//! syntax::crt::document ──▶ CrtProgram ──snapshot──▶ CrtAnalysis ─┬─▶ names        variables and objects, by scope
//!                                                                 ├─▶ semantic, outline, hover, signature, completion, colour, links
//!                                                                 ├─▶ rename, format, edit_settings   edits
//!                                                                 └─▶ convert          a program in Geotrace's language
//! ```

mod colour;
mod completion;
mod convert;
mod edit_settings;
mod format;
mod hover;
mod links;
mod names;
mod outline;
mod rename;
mod semantic;
mod signature;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use scene::crt::Assignment;
use scene::{Evaluation, Outcome, ParamValues, ProgramScene, Scene, Value};
use syntax::crt::document::{Document, Snapshot};
use syntax::crt::token::Token;
use syntax::crt::tree::Script;
use syntax::diagnostic::{Diagnostic, Severity};
use syntax::span::Span;

use names::ScriptNames;

use crate::conversion::ConvertError;
use crate::edit::Edit;
use crate::edit_camera::EditCameraError;
use crate::edit_param::EditParamError;
use crate::highlight::Highlight;
use crate::language::{Analysis, EditError, Language, Program, features_of_modules};
use crate::link::FileLink;
use crate::occurrence::Occurrence;
use crate::text::Text;

/// The name of the language.
pub(crate) const NAME: &str = "crt";

/// The CRT scene language.
#[derive(Clone, Copy, Debug, Default)]
pub struct Crt;

/// A CRT script.
#[derive(Debug)]
struct CrtProgram {
    document: Document,
    /// The analysis of the document's present state, once requested.
    analysis: OnceLock<Arc<CrtAnalysis>>,
}

/// The result of running a script.
#[derive(Debug)]
struct CrtRun {
    scene: Arc<Scene>,
    assignments: Vec<Assignment>,
}

/// A CRT script at one version. It is run on the first request for results that require a run. An edit of the program
/// cancels a run in progress.
#[derive(Debug)]
struct CrtAnalysis {
    snapshot: Snapshot,
    /// The diagnostics of reading the script.
    reading_diagnostics: Arc<[Diagnostic]>,
    given_up: AtomicBool,
    /// The run; `None` if parts of the script cannot be read, so that it is not run, and if the run was cancelled.
    run: OnceLock<Option<CrtRun>>,
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
            analysis: OnceLock::new(),
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
        if let Some(old) = self.analysis.take() {
            old.given_up.store(true, Ordering::Relaxed);
        }
        Ok(())
    }

    fn diagnostics(&self) -> Arc<[Diagnostic]> {
        Analysis::diagnostics(&**self.analysis())
    }

    fn diagnostics_of_reading(&self) -> Option<Arc<[Diagnostic]>> {
        let analysis = self.analysis();
        let reading = || Arc::clone(&analysis.reading_diagnostics);
        analysis.awaits_run().then(reading)
    }

    fn scene(&self) -> ProgramScene {
        let analysis = self.analysis();
        let run = analysis
            .run()
            .filter(|_| analysis.errors().next().is_none());
        ProgramScene {
            scene: run.map(|run| run.scene.clone()),
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
        self.analysis().clone()
    }
}

impl CrtProgram {
    fn analysis(&self) -> &Arc<CrtAnalysis> {
        self.analysis.get_or_init(|| {
            Arc::new(CrtAnalysis {
                snapshot: self.document.snapshot(),
                reading_diagnostics: self.document.all_diagnostics().into(),
                given_up: AtomicBool::new(false),
                run: OnceLock::new(),
                names: OnceLock::new(),
            })
        })
    }
}

fn whole(snapshot: &Snapshot) -> String {
    let all = Span::new(0, snapshot.len());
    snapshot.slice(all).unwrap_or_default()
}

impl CrtAnalysis {
    /// Returns the errors of reading the script.
    fn errors(&self) -> impl Iterator<Item = &Diagnostic> {
        let diagnostics = self.reading_diagnostics.iter();
        diagnostics.filter(|it| it.severity == Severity::Error)
    }

    /// Returns true if the script is run: it has no errors, or none that leave its tree incomplete.
    fn is_run(&self) -> bool {
        self.errors()
            .all(|it| syntax::crt::codes::OF_WHOLE_TREES.contains(&it.code))
    }

    fn run(&self) -> Option<&CrtRun> {
        let run = self.run.get_or_init(|| {
            if !self.is_run() {
                return None;
            }
            let (script, text) = (self.script(), whole(&self.snapshot));
            let reading = &self.reading_diagnostics;
            let run = scene::crt::run_unless(&script, &text, reading, &self.given_up)?;
            Some(CrtRun {
                scene: Arc::new(run.scene),
                assignments: run.assignments,
            })
        });
        run.as_ref()
    }

    /// Returns the locations where the run assigns names, in the order of the text; `None` for a script that is not
    /// run.
    pub(crate) fn assignments(&self) -> Option<&[Assignment]> {
        self.run().map(|run| &run.assignments[..])
    }

    /// Returns the syntax tree of the script.
    pub(crate) fn script(&self) -> Script {
        self.snapshot.script()
    }

    pub(crate) fn snapshot_text(&self) -> &Snapshot {
        &self.snapshot
    }

    /// Returns the names of the script, which are resolved on the first call.
    pub(crate) fn names(&self) -> &ScriptNames {
        self.names.get_or_init(|| ScriptNames::of(&self.script()))
    }

    /// Returns the tokens that touch a range, including comments.
    pub(crate) fn tokens(&self, range: Span) -> impl Iterator<Item = Token> + '_ {
        self.snapshot.tokens(range)
    }

    /// Returns all tokens, including comments.
    pub(crate) fn all_tokens(&self) -> Vec<Token> {
        self.tokens(Span::new(0, self.snapshot.len())).collect()
    }

    /// Returns the text of a range; empty if the range is outside the text.
    pub(crate) fn slice(&self, span: Span) -> String {
        self.snapshot.slice(span).unwrap_or_default()
    }

    /// Returns the word at an offset: the token that contains it, or else the word that ends there.
    pub(crate) fn word_at(&self, offset: u32) -> Option<Token> {
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
        let of_run = self.run().and_then(|run| run.scene.diagnostics.as_ref());
        Arc::clone(of_run.unwrap_or(&self.reading_diagnostics))
    }

    fn awaits_run(&self) -> bool {
        self.is_run() && self.run.get().is_none()
    }

    features_of_modules! {}

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
        _fov: f64,
    ) -> Result<Edit, EditCameraError> {
        edit_settings::edit_camera(self, direction, position)
    }

    fn links(&self) -> Vec<FileLink> {
        links::links(self)
    }
}
