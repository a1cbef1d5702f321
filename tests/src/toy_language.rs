//! A toy second language: all that a scene language needs to open in the command line, the server and the window.
//!
//! A line `dot X Y Z` is a point; `//` opens a comment. `Languages::standard().with(Dots)` registers it.

use std::sync::Arc;

use ide::language::{Analysis, EditError, Language, Program};
use ide::outline::{OutlineEntry, OutlineKind};
use ide::semantic::{Modifiers, SemanticToken, TokenType};
use ide::text::{PlainText, Text};
use scene::{Object, ProgramScene, Scene, Shape};
use syntax::diagnostic::{Code, Diagnostic};
use syntax::span::Span;

/// The language.
#[derive(Debug)]
pub struct Dots;

impl Language for Dots {
    fn name(&self) -> &'static str {
        "dots"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["dots"]
    }

    fn open(&self, text: &str) -> Result<Box<dyn Program>, EditError> {
        let mut program = DotsProgram::default();
        program.edit(Span::new(0, 0), text)?;
        Ok(Box::new(program))
    }
}

/// A text and its dots.
#[derive(Clone, Debug, Default)]
struct DotsProgram {
    text: PlainText,
    dots: Vec<Dot>,
    tokens: Vec<SemanticToken>,
    diagnostics: Vec<Diagnostic>,
}

#[derive(Clone, Copy, Debug)]
struct Dot {
    span: Span,
    place: [f64; 3],
}

impl Dot {
    fn name(&self, index: usize) -> String {
        format!("dot{}", index + 1)
    }
}

impl DotsProgram {
    /// Reads the whole text again: a toy has no need to be incremental.
    fn read(&mut self) {
        (self.dots, self.tokens, self.diagnostics) = Default::default();
        let text = self.text.as_str().to_owned();
        let mut start = 0;
        for line in text.split_inclusive('\n') {
            let code = line.split("//").next().unwrap_or_default();
            self.token(
                start + code.len(),
                line.trim_end().len().saturating_sub(code.len()),
                TokenType::Comment,
            );
            if !code.trim().is_empty() {
                self.statement(start, code);
            }
            start += line.len();
        }
    }

    fn statement(&mut self, start: usize, code: &str) {
        let begin = code.len() - code.trim_start().len();
        let span = Span::new(
            (start + begin) as u32,
            (start + code.trim_end().len()) as u32,
        );
        let mut words = code.split_whitespace();
        let keyword = words.next();
        let numbers: Option<Vec<f64>> = words.map(|word| word.parse().ok()).collect();
        match (keyword, numbers.as_deref()) {
            (Some("dot"), Some(&[x, y, z])) => {
                self.token(start + begin, 3, TokenType::Keyword);
                self.dots.push(Dot {
                    span,
                    place: [x, y, z],
                });
            }
            _ => {
                let sentence = "a line is `dot` and three numbers";
                self.diagnostics
                    .push(Diagnostic::error(Code("no-dot"), span, sentence));
            }
        }
    }

    fn token(&mut self, start: usize, length: usize, token_type: TokenType) {
        if length > 0 {
            self.tokens.push(SemanticToken {
                span: Span::new(start as u32, (start + length) as u32),
                token_type,
                modifiers: Modifiers::default(),
            });
        }
    }
}

impl Program for DotsProgram {
    fn text(&self) -> &dyn Text {
        &self.text
    }

    fn edit(&mut self, range: Span, text: &str) -> Result<(), EditError> {
        self.text.edit(range, text)?;
        self.read();
        Ok(())
    }

    fn diagnostics(&self) -> Arc<[Diagnostic]> {
        self.diagnostics.as_slice().into()
    }

    fn scene(&self) -> ProgramScene {
        let mut scene = Scene::default();
        for (index, dot) in self.dots.iter().enumerate() {
            let position = dot.place.map(|x| scene.graph.constant(x));
            scene.objects.push(Object {
                name: dot.name(index),
                name_span: dot.span,
                shape: Shape::Point { position },
                params: Vec::new(),
                grids: Vec::new(),
                geodesic_values: Vec::new(),
                attributes: Vec::new(),
            });
        }
        ProgramScene {
            scene: Some(Arc::new(scene)),
            stale: Vec::new(),
            incomplete: !self.diagnostics.is_empty(),
        }
    }

    fn snapshot(&self) -> Arc<dyn Analysis> {
        Arc::new(self.clone())
    }
}

impl Analysis for DotsProgram {
    fn text(&self) -> &dyn Text {
        &self.text
    }

    fn diagnostics(&self) -> Arc<[Diagnostic]> {
        Program::diagnostics(self)
    }

    fn semantic_tokens(&self, range: Span) -> Vec<SemanticToken> {
        let touches =
            |token: &&SemanticToken| token.span.start < range.end && range.start < token.span.end;
        self.tokens.iter().filter(touches).copied().collect()
    }

    fn outline(&self) -> Vec<OutlineEntry> {
        let entries = self
            .dots
            .iter()
            .enumerate()
            .map(|(index, dot)| OutlineEntry {
                name: dot.name(index),
                kind: OutlineKind::Constant,
                keyword: "dot",
                detail: String::new(),
                span: dot.span,
                name_span: dot.span,
            });
        entries.collect()
    }
}
