//! The interface between a language and its users: the language server, the preview window and the command line.
//!
//! ```text
//! Language ──open──▶ Program      a text that is edited; its diagnostics; its scene
//!     │                 │ snapshot
//!     └─────read────▶ Analysis    an immutable state of a program; one method for each feature of an editor
//! ```
//!
//! All positions are byte offsets, and all results are plain data. A small language implements the methods without a
//! default body, and any of the features: the default of a feature returns nothing.

use std::collections::BTreeMap;
use std::fmt::Debug;
use std::sync::Arc;

use scene::{Evaluation, ParamValues, ProgramScene, Scene};
use syntax::diagnostic::{Code, Diagnostic, Severity};
use syntax::span::Span;

use crate::colour::{EditColourError, WrittenColour};
use crate::completion::Completions;
use crate::conversion::ConvertError;
use crate::description::Description;
use crate::edit::{self, Edit};
use crate::edit_camera::EditCameraError;
use crate::edit_param::EditParamError;
use crate::fix::{self, Fix};
use crate::highlight::{self, Highlight};
use crate::hint::Hint;
use crate::lens::Lens;
use crate::link::FileLink;
use crate::occurrence::Occurrence;
use crate::outline::{DeclarationRange, Fold, OutlineEntry};
use crate::overview::OverviewRow;
use crate::rename::RenameError;
use crate::semantic::SemanticToken;
use crate::signature::Signature;
use crate::text::{PlainText, Text};

pub use syntax::document::EditError;

/// The maximum size of a program that is read from a file, in bytes. A larger one is a mistake (`/dev/zero`), and would
/// exceed the memory available for a check.
pub const LONGEST_PROGRAM: u64 = 64 << 20;

/// A scene language.
pub trait Language: Debug + Send + Sync {
    /// Returns the identifier by which editors know the language: `geotrace`.
    fn name(&self) -> &'static str;

    /// Returns the extensions of its files, without a dot: `gtr`.
    fn extensions(&self) -> &'static [&'static str];

    /// Returns the mark that begins a comment up to the end of its line, if there is one: `#`.
    fn line_comment(&self) -> Option<&'static str> {
        None
    }

    /// Returns the constructs of the language, in rows that fit on a page.
    fn overview(&self) -> Vec<OverviewRow> {
        Vec::new()
    }

    /// Opens a text, which may have any number of errors.
    ///
    /// # Errors
    /// [`EditError::TooLarge`] if the text has 4 GiB or more.
    fn open(&self, text: &str) -> Result<Box<dyn Program>, EditError>;

    /// Compiles a text once, for a command that does not edit it. A language may do this with less memory than
    /// [`Language::open`], which keeps the structures for edits.
    ///
    /// # Errors
    /// Those of [`Language::open`].
    fn compile(&self, text: &str) -> Result<Compiled, EditError> {
        let program = self.open(text)?;
        // Errors of a run may be absent for other values of the params.
        let of_text = program.diagnostics_of_reading();
        let diagnostics = program.diagnostics();
        let of_text = of_text.unwrap_or_else(|| diagnostics.clone());
        let is_error = |found: &Diagnostic| found.severity == Severity::Error;
        let scene = match of_text.iter().any(is_error) {
            true => None,
            false => program.scene().scene,
        };
        Ok(Compiled {
            diagnostics: diagnostics.to_vec(),
            scene,
            scope: Box::new(ProgramScope(program)),
        })
    }

    /// Analyses a text that will not be edited. A text that is too large is analysed as an empty one.
    fn read(&self, text: &str) -> Arc<dyn Analysis> {
        match self.open(text).or_else(|_| self.open("")) {
            Ok(program) => program.snapshot(),
            Err(_) => Arc::new(Unread(PlainText::default())),
        }
    }

    /// Returns a text in the canonical layout, for a command that does not edit it. A language may do this with less
    /// memory than [`Analysis::format`], which works on an open text.
    fn laid_out(&self, text: &str) -> String {
        edit::apply(text, &self.read(text).format(None))
    }

    /// Returns the coloured parts of a text, in the order of the text and without overlaps, for an editor without
    /// semantic tokens.
    fn highlight(&self, text: &str) -> Vec<Highlight> {
        let analysis = self.read(text);
        let tokens = analysis.semantic_tokens(Span::new(0, analysis.text().len()));
        highlight::from_tokens(&tokens)
    }
}

/// A text that was compiled once.
#[derive(Debug)]
pub struct Compiled {
    /// All errors, warnings and hints, sorted by position.
    pub diagnostics: Vec<Diagnostic>,
    /// The scene; `None` if the text has errors. [`Scene::diagnostics`] has those of a run.
    pub scene: Option<Arc<Scene>>,
    /// The scope at the end of the program.
    pub scope: Box<dyn Scope>,
}

/// The names that an expression at the end of a program can use.
pub trait Scope: Debug {
    /// Returns the value of an expression.
    ///
    /// # Errors
    /// The diagnostics of the expression, with spans in `expression`.
    fn evaluate(
        &self,
        expression: &str,
        params: &ParamValues,
    ) -> Result<Evaluation, Vec<Diagnostic>>;
}

/// The scope of an opened program.
#[derive(Debug)]
struct ProgramScope(Box<dyn Program>);

impl Scope for ProgramScope {
    fn evaluate(
        &self,
        expression: &str,
        params: &ParamValues,
    ) -> Result<Evaluation, Vec<Diagnostic>> {
        self.0.evaluate(expression, params)
    }
}

/// A program of some language: a text that is edited, and its meaning.
pub trait Program: Debug + Send {
    /// Returns the present text.
    fn text(&self) -> &dyn Text;

    /// Replaces the bytes of a range.
    ///
    /// # Errors
    /// [`EditError`] if the text does not have the range, or would be too large; the program is then unchanged.
    fn edit(&mut self, range: Span, text: &str) -> Result<(), EditError>;

    /// Returns all errors, warnings and hints, sorted by position.
    fn diagnostics(&self) -> Arc<[Diagnostic]>;

    /// Returns the diagnostics of reading the text, if [`Program::diagnostics`] has to run the program to find more;
    /// `None` if it returns at once.
    fn diagnostics_of_reading(&self) -> Option<Arc<[Diagnostic]>> {
        None
    }

    /// Returns the scene; for a program with errors, as much of it as can be shown.
    fn scene(&self) -> ProgramScene;

    /// Returns the spans of the named declarations, in the order of the text.
    fn declarations(&self) -> Vec<DeclarationRange> {
        let outline = self.snapshot().outline().into_iter();
        let ranges = outline.map(|entry| DeclarationRange {
            span: entry.span,
            name_span: entry.name_span,
        });
        ranges.collect()
    }

    /// Returns an immutable state of the program for features, which may run on other threads while the program is
    /// edited. This is cheap: it shares the results of the program.
    fn snapshot(&self) -> Arc<dyn Analysis>;

    /// Returns the value of an expression in the scope at the end of the program.
    ///
    /// # Errors
    /// The diagnostics of the expression, with spans in `expression`.
    fn evaluate(
        &self,
        expression: &str,
        params: &ParamValues,
    ) -> Result<Evaluation, Vec<Diagnostic>> {
        let _ = params;
        let span = Span::new(0, u32::try_from(expression.len()).unwrap_or(u32::MAX));
        let message = "this language has no expressions to evaluate";
        Err(vec![Diagnostic::error(
            Code("no-expressions"),
            span,
            message,
        )])
    }
}

/// An immutable state of a program, and the editor features for it.
#[expect(unused_variables, reason = "a default uses no argument")]
pub trait Analysis: Debug + Send + Sync {
    /// Returns the text.
    fn text(&self) -> &dyn Text;

    /// Returns all errors, warnings and hints, sorted by position.
    fn diagnostics(&self) -> Arc<[Diagnostic]>;

    /// Returns true if a run of the program is not at hand: diagnostics, hover and fixes run it, or wait for its end.
    fn awaits_run(&self) -> bool {
        false
    }

    /// Returns the coloured tokens that touch a range, in the order of the text and without overlaps.
    fn semantic_tokens(&self, range: Span) -> Vec<SemanticToken> {
        Vec::new()
    }

    /// Returns the named declarations, in the order of the text.
    fn outline(&self) -> Vec<OutlineEntry> {
        Vec::new()
    }

    /// Returns the ranges that can be folded, in the order of the text.
    fn folds(&self) -> Vec<Fold> {
        Vec::new()
    }

    /// Returns the ranges around an offset, from the smallest to the whole text, each of which contains the previous
    /// one.
    fn selection(&self, offset: u32) -> Vec<Span> {
        vec![Span::new(0, self.text().len())]
    }

    /// Returns the description of the word at an offset, and the range of the word.
    fn hover(&self, offset: u32) -> Option<(Span, Description)> {
        None
    }

    /// Returns the signature of the function around an offset.
    fn signature(&self, offset: u32) -> Option<Signature> {
        None
    }

    /// Returns the completions at an offset, with placeholders if the editor supports `snippets`.
    fn completions(&self, offset: u32, snippets: bool) -> Completions {
        Completions::empty(offset)
    }

    /// Returns the description of a completion by its label.
    fn describe_completion(&self, offset: u32, label: &str) -> Option<Description> {
        None
    }

    /// Returns the range of the name at an offset, and the range that introduces the name.
    fn definition(&self, offset: u32) -> Option<(Span, Span)> {
        None
    }

    /// Returns every occurrence of the name at an offset, in the order of the text.
    fn occurrences(&self, offset: u32) -> Vec<Occurrence> {
        Vec::new()
    }

    /// Returns the range and the text of the name at an offset, if it can be renamed.
    ///
    /// # Errors
    /// [`RenameError`] with the reason.
    fn prepare_rename(&self, offset: u32) -> Result<(Span, String), RenameError> {
        Err(RenameError::NoName)
    }

    /// Returns the edits that rename the name at an offset.
    ///
    /// # Errors
    /// [`RenameError`] with the reason.
    fn rename(&self, offset: u32, name: &str) -> Result<Vec<Edit>, RenameError> {
        Err(RenameError::NoName)
    }

    /// Returns the fixes of the diagnostics that touch a range; if there are none and the range is empty, of the
    /// diagnostics on its line.
    fn fixes(&self, range: Span) -> Vec<Fix> {
        let found = fix::fixes(&self.diagnostics(), range);
        if !found.is_empty() || range.start < range.end {
            return found;
        }
        let text = self.text();
        let line = text.line(range.start);
        let start = text.line_start(line).unwrap_or(range.start);
        let end = text.line_start(line + 1).map(|next| next - 1);
        let line = Span::new(start, end.unwrap_or(text.len()).max(start));
        fix::fixes(&self.diagnostics(), line)
    }

    /// Returns the edits of all fixes that may be applied without asking the user to choose, and the number of those fixes.
    fn fix_all(&self) -> (Vec<Edit>, usize) {
        fix::fix_all(&self.diagnostics(), self.text())
    }

    /// Returns the edits that convert the text, or the declarations that touch a range, to the canonical layout.
    fn format(&self, range: Option<Span>) -> Vec<Edit> {
        Vec::new()
    }

    /// Returns the edits that format the declaration that ends before an offset, or `None` if none ends there.
    fn format_on_type(&self, offset: u32) -> Option<Vec<Edit>> {
        None
    }

    /// Returns the hints in a range, in the order of the text.
    fn hints(&self, range: Span) -> Vec<Hint> {
        Vec::new()
    }

    /// Returns hints with the values of the params in a range in a preview. `values` are by name, one number per
    /// component.
    fn preview_values(&self, range: Span, values: &BTreeMap<String, Vec<f64>>) -> Vec<Hint> {
        Vec::new()
    }

    /// Returns the views offered above declarations, in the order of the text.
    fn lenses(&self) -> Vec<Lens> {
        Vec::new()
    }

    /// Returns the files that the text names, in the order of the text.
    fn links(&self) -> Vec<FileLink> {
        Vec::new()
    }

    /// Returns the constant colours, in the order of the text.
    fn colours(&self) -> Vec<WrittenColour> {
        Vec::new()
    }

    /// Returns the texts for a colour (red, green and blue, sRGB, 0…1) that can replace the one in a range, the simplest
    /// first.
    fn colour_texts(&self, range: Span, rgb: [f64; 3]) -> Vec<String> {
        Vec::new()
    }

    /// Returns the extension of the files into which the text can be converted, without a dot; `None` if it cannot be
    /// converted.
    fn conversion(&self) -> Option<&'static str> {
        None
    }

    /// Returns a text with the extension of [`Analysis::conversion`] that shows the same scene at these values of the
    /// params, one number per uniform. `file` is the name of its file.
    ///
    /// # Errors
    /// [`ConvertError`].
    fn convert(&self, uniforms: &[f64], file: &str) -> Result<String, ConvertError> {
        Err(ConvertError::NotOffered)
    }

    /// Returns the edit that sets the initial values of a param, one for each of its components. The params of a script are the
    /// numbers of its settings.
    ///
    /// # Errors
    /// [`EditParamError`] with the reason.
    fn edit_param(&self, param: &str, values: &[f64]) -> Result<Edit, EditParamError> {
        let name = param.to_owned();
        Err(EditParamError::NoParam { name })
    }

    /// Returns the edit after which the camera `name` looks along a direction from a position, in the coordinates of the
    /// text. An undeclared camera is added with a vertical field of view `fov`, in radians; a declared one keeps its own. A
    /// script has one camera, whatever the name, and keeps its field of view even if it does not state it.
    ///
    /// # Errors
    /// [`EditCameraError`] with the reason.
    fn edit_camera(
        &self,
        name: &str,
        direction: [f64; 3],
        position: [f64; 3],
        fov: f64,
    ) -> Result<Edit, EditCameraError> {
        Err(EditCameraError::NoCameras)
    }

    /// Returns the edit that changes the colour of an object that states it as numbers: red, green and blue, sRGB, 0…1.
    ///
    /// # Errors
    /// [`EditColourError`] with the reason.
    fn edit_colour(&self, object: &str, colour: [f64; 3]) -> Result<Edit, EditColourError> {
        let _ = colour;
        let name = object.to_owned();
        Err(EditColourError::NotStated { name })
    }
}

/// The methods of [`Analysis`] that the standard languages share, each implemented by a function of a module of the
/// language.
macro_rules! features_of_modules {
    () => {
        fn semantic_tokens(&self, range: Span) -> Vec<$crate::semantic::SemanticToken> {
            semantic::semantic_tokens(self, range)
        }

        fn outline(&self) -> Vec<$crate::outline::OutlineEntry> {
            outline::outline(self)
        }

        fn folds(&self) -> Vec<$crate::outline::Fold> {
            outline::folds(self)
        }

        fn selection(&self, offset: u32) -> Vec<Span> {
            outline::selection(self, offset)
        }

        fn hover(&self, offset: u32) -> Option<(Span, $crate::description::Description)> {
            hover::hover(self, offset)
        }

        fn signature(&self, offset: u32) -> Option<$crate::signature::Signature> {
            signature::signature(self, offset)
        }

        fn completions(&self, offset: u32, snippets: bool) -> $crate::completion::Completions {
            completion::completions(self, offset, snippets)
        }

        fn describe_completion(
            &self,
            offset: u32,
            label: &str,
        ) -> Option<$crate::description::Description> {
            completion::describe(self, offset, label)
        }

        fn prepare_rename(
            &self,
            offset: u32,
        ) -> Result<(Span, String), $crate::rename::RenameError> {
            rename::prepare(self, offset)
        }

        fn rename(
            &self,
            offset: u32,
            name: &str,
        ) -> Result<Vec<$crate::edit::Edit>, $crate::rename::RenameError> {
            rename::rename(self, offset, name)
        }

        fn format(&self, range: Option<Span>) -> Vec<$crate::edit::Edit> {
            format::format(self, range)
        }

        fn colours(&self) -> Vec<$crate::colour::WrittenColour> {
            colour::colours(self)
        }

        fn colour_texts(&self, _range: Span, rgb: [f64; 3]) -> Vec<String> {
            colour::colour_texts(rgb)
        }
    };
}

pub(crate) use features_of_modules;

/// The analysis of a text whose language cannot even open an empty text.
#[derive(Debug)]
struct Unread(PlainText);

impl Analysis for Unread {
    fn text(&self) -> &dyn Text {
        &self.0
    }

    fn diagnostics(&self) -> Arc<[Diagnostic]> {
        Arc::default()
    }
}
