//! The Geotrace language: programs on the incremental document, features on its snapshots.
//!
//! ```text
//! scene::document ──▶ GeotraceProgram ──snapshot──▶ GeotraceAnalysis ─┬─▶ semantic            colours by meaning
//!                                                                     ├─▶ hover, signature, completion, describe
//!                                                                     ├─▶ navigation          definition, occurrences
//!                                                                     ├─▶ rename, format, edit_param, edit_camera   edits
//!                                                                     └─▶ outline, hints, lens, colour, preview_values
//! ```
//!
//! Rename and format read their results again and refuse changes of meaning.

mod analysis;
mod application;
pub mod colour;
pub mod completion;
mod completion_place;
mod describe;
pub mod edit_camera;
pub mod edit_param;
pub mod format;
mod geometry;
pub mod hints;
pub mod hover;
mod item;
pub mod lens;
mod meaning;
mod names_in_scope;
pub mod navigation;
pub mod outline;
mod overview;
mod preview_values;
pub mod rename;
pub mod semantic;
pub mod signature;
mod solid;
mod start;
mod targets;

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use scene::geotrace::{Compilation, Document};
use scene::{Evaluation, ParamValues, ProgramScene};
use syntax::diagnostic::Diagnostic;
use syntax::geotrace::highlight::highlight;
use syntax::span::Span;

pub use analysis::{GeotraceAnalysis, Lexeme};
pub use item::Item;
pub use targets::Target;

use crate::colour::EditColourError;
use crate::edit::Edit;
use crate::edit_camera::EditCameraError;
use crate::edit_param::EditParamError;
use crate::highlight::Highlight;
use crate::hint::Hint;
use crate::language::{
    Analysis, Compiled, EditError, Language, Program, Scope, features_of_modules,
};
use crate::lens::Lens;
use crate::occurrence::Occurrence;
use crate::outline::DeclarationRange;
use crate::overview::OverviewRow;
use crate::text::Text;

/// The name of the language.
pub(crate) const NAME: &str = "geotrace";
/// The extension of its files.
pub(crate) const EXTENSION: &str = "gtr";

/// The Geotrace language.
#[derive(Clone, Copy, Debug, Default)]
pub struct Geotrace;

/// A Geotrace program.
#[derive(Debug)]
pub struct GeotraceProgram {
    document: Document,
    /// The diagnostics of the document, once requested.
    diagnostics: OnceLock<Arc<[Diagnostic]>>,
}

/// The scope of a program that was compiled once.
#[derive(Debug)]
struct CompilationScope(Compilation);

impl Scope for CompilationScope {
    fn evaluate(
        &self,
        expression: &str,
        params: &ParamValues,
    ) -> Result<Evaluation, Vec<Diagnostic>> {
        self.0.evaluate(expression, params)
    }
}

impl Language for Geotrace {
    fn name(&self) -> &'static str {
        NAME
    }

    fn extensions(&self) -> &'static [&'static str] {
        &[EXTENSION]
    }

    fn line_comment(&self) -> Option<&'static str> {
        Some("#")
    }

    fn overview(&self) -> Vec<OverviewRow> {
        overview::overview()
    }

    fn open(&self, text: &str) -> Result<Box<dyn Program>, EditError> {
        Ok(Box::new(GeotraceProgram {
            document: Document::new(text)?,
            diagnostics: OnceLock::new(),
        }))
    }

    // This stores no structures for edits, which would require several times the memory.
    fn compile(&self, text: &str) -> Result<Compiled, EditError> {
        let mut compilation = scene::geotrace::compile(text);
        Ok(Compiled {
            diagnostics: std::mem::take(&mut compilation.diagnostics),
            scene: compilation.scene.take().map(Arc::new),
            scope: Box::new(CompilationScope(compilation)),
        })
    }

    // This reads only the tokens: nothing is checked before a feature needs it.
    fn read(&self, text: &str) -> Arc<dyn Analysis> {
        Arc::new(GeotraceAnalysis::new(text))
    }

    fn laid_out(&self, text: &str) -> String {
        format::laid_out(text)
    }

    fn highlight(&self, text: &str) -> Vec<Highlight> {
        let parts = highlight(text, &scene::geotrace::vocabulary()).into_iter();
        let parts = parts.map(|part| Highlight {
            span: part.span,
            kind: part.kind,
        });
        parts.collect()
    }
}

impl Program for GeotraceProgram {
    fn text(&self) -> &dyn Text {
        &**self.document.text()
    }

    fn edit(&mut self, range: Span, text: &str) -> Result<(), EditError> {
        self.document.edit(range, text)?;
        self.diagnostics = OnceLock::new();
        Ok(())
    }

    fn diagnostics(&self) -> Arc<[Diagnostic]> {
        let diagnostics = || self.document.diagnostics().into();
        self.diagnostics.get_or_init(diagnostics).clone()
    }

    fn scene(&self) -> ProgramScene {
        self.document.scene_with_last_good().clone()
    }

    // The window requests them after each edit: only the spans are computed.
    fn declarations(&self) -> Vec<DeclarationRange> {
        let text = self.document.text();
        let mut all = Vec::new();
        let mut start = 0;
        for chunk in text.chunks() {
            let read = text.events(chunk).declarations();
            let named = read.filter(|(read, _)| !read.name.is_empty());
            all.extend(named.map(|(read, _)| DeclarationRange {
                span: read.span.moved(start),
                name_span: read.name_span.moved(start),
            }));
            start += text.chunk_text(chunk).len() as u32;
        }
        all
    }

    fn snapshot(&self) -> Arc<dyn Analysis> {
        let document = self.document.text().snapshot();
        Arc::new(GeotraceAnalysis::of(document, Some(self.diagnostics())))
    }

    fn evaluate(
        &self,
        expression: &str,
        params: &ParamValues,
    ) -> Result<Evaluation, Vec<Diagnostic>> {
        self.document.compilation().evaluate(expression, params)
    }
}

impl Analysis for GeotraceAnalysis {
    fn text(&self) -> &dyn Text {
        self.document()
    }

    fn diagnostics(&self) -> Arc<[Diagnostic]> {
        self.diagnostics().clone()
    }

    features_of_modules! {}

    fn definition(&self, offset: u32) -> Option<(Span, Span)> {
        navigation::definition(self, offset)
    }

    fn occurrences(&self, offset: u32) -> Vec<Occurrence> {
        navigation::occurrences(self, offset)
    }

    fn format_on_type(&self, offset: u32) -> Option<Vec<Edit>> {
        // The offset is after the `;` that ends the declaration.
        let item = self.item_at(offset.saturating_sub(1))?;
        Some(format::format(self, Some(item.span)))
    }

    fn hints(&self, range: Span) -> Vec<Hint> {
        hints::hints(self, range)
    }

    fn preview_values(&self, range: Span, values: &BTreeMap<String, Vec<f64>>) -> Vec<Hint> {
        preview_values::preview_values(self, range, values)
    }

    fn lenses(&self) -> Vec<Lens> {
        lens::lenses(self)
    }

    fn edit_param(&self, param: &str, values: &[f64]) -> Result<Edit, EditParamError> {
        edit_param::edit_param(self, param, values)
    }

    fn edit_camera(
        &self,
        name: &str,
        direction: [f64; 3],
        position: [f64; 3],
        fov: f64,
    ) -> Result<Edit, EditCameraError> {
        edit_camera::edit_camera(self, name, direction, position, fov)
    }

    fn edit_colour(&self, object: &str, colour: [f64; 3]) -> Result<Edit, EditColourError> {
        colour::edit_colour(self, object, colour)
    }
}
