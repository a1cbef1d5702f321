//! Values in a text: the value of an application `s(1, 2)`, for a surface or a metric with the curvature there, for a solid
//! with the gradient and the curvature; and the value of an attribute.
//!
//! In: the token of a function's name, or the range of an expression. Out: sentences; none if an argument is a parameter of
//! the surrounding body, or if a required declaration has an error.

use std::collections::BTreeSet;

use geodesic::measure;
use geometry::{Manifold, SolidSurface};
use scene::geotrace::Compilation;
use scene::{Outcome, ParamValues, Value};
use syntax::geotrace::declarations::DeclarationKeyword;
use syntax::geotrace::token::TokenKind;
use syntax::span::Span;
use syntax::symbol::SymbolId;

use super::analysis::GeotraceAnalysis;
use super::hints::{short, shown};
use super::outline::parameters_of;
use super::start;

/// The maximum number of tokens of an application.
const LONGEST: usize = 200;
/// The maximum number of declarations that are compiled for a value.
const MOST_DECLARATIONS: usize = 500;
/// The maximum number of leaves of a solid whose curvature is computed.
const MOST_LEAVES: usize = 64;

/// Describes the value of the application of the function with this token.
pub(crate) fn describe(analysis: &GeotraceAnalysis, token: usize) -> Vec<String> {
    Application::at(analysis, token)
        .and_then(|application| application.sentences(analysis))
        .unwrap_or_default()
}

/// A function with its arguments in brackets.
struct Application {
    /// The application, from the function's name to the bracket's end.
    text: String,
    /// The function's name, without derivatives.
    name: String,
    /// The bracket with the arguments.
    arguments: String,
    is_derived: bool,
    symbols: Vec<SymbolId>,
}

impl Application {
    fn at(analysis: &GeotraceAnalysis, token: usize) -> Option<Self> {
        let function = analysis.token(token)?;
        let TokenKind::Function(id) = function.kind else {
            return None;
        };
        let mut symbols = vec![id];
        let mut bracket: Option<u32> = None;
        let mut depth = 0;
        let mut follows_underscore = false;
        for next in analysis.tokens(token + 1..token + LONGEST) {
            match next.kind {
                TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen => {
                    bracket.get_or_insert(next.span.start);
                    depth += 1;
                }
                TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => {
                    depth -= 1;
                }
                // A derivative.
                TokenKind::Prime | TokenKind::Underscore if bracket.is_none() => {}
                TokenKind::Variable(_) if bracket.is_none() && follows_underscore => {}
                TokenKind::Variable(_) if !derives(analysis, next.span.start) => return None,
                TokenKind::Variable(_) => {}
                TokenKind::Constant(id) | TokenKind::Function(id) if bracket.is_some() => {
                    symbols.push(id);
                }
                TokenKind::Undefined
                | TokenKind::Declare(_)
                | TokenKind::Semicolon
                | TokenKind::Equals
                | TokenKind::Error => return None,
                _ if bracket.is_none() => return None,
                _ => {}
            }
            follows_underscore = next.kind == TokenKind::Underscore;
            if let Some(start) = bracket
                && depth == 0
            {
                let (whole, own) = (
                    Span::new(function.span.start, next.span.end),
                    Span::new(start, next.span.end),
                );
                return Some(Self {
                    text: analysis.slice(whole),
                    name: function.text.to_owned(),
                    arguments: analysis.slice(own),
                    is_derived: start > function.span.end,
                    symbols,
                });
            }
        }
        None
    }

    fn sentences(&self, analysis: &GeotraceAnalysis) -> Option<Vec<String>> {
        let needed = Needed::compile(analysis, &self.symbols)?;
        let result = shown(&needed.value(&self.text)?);
        let start = &needed.start;
        let written: Vec<&str> = self.text.split_whitespace().collect();
        let mut sentences = vec![format!("`{}` = {result}{start}", written.join(" "))];
        if !self.is_derived {
            sentences.extend(self.gradient(analysis, &needed));
            sentences.extend(self.curvature(&needed));
            sentences.extend(self.level_curvature(&needed));
        }
        Some(sentences)
    }

    /// Returns the gradient of a solid's function at the arguments.
    fn gradient(&self, analysis: &GeotraceAnalysis, needed: &Needed) -> Option<String> {
        let symbol = analysis.symbol(*self.symbols.first()?)?;
        if symbol.keyword != Some(DeclarationKeyword::Solid) {
            return None;
        }
        let partial = |name| format!("{}_{name}{}", self.name, self.arguments);
        let partials: Vec<String> = parameters_of(symbol).map(partial).collect();
        let gradient = needed.value(&format!("({})", partials.join(", ")))?;
        Some(format!("there the gradient is {}", shown(&gradient)))
    }

    /// Returns the curvature of a surface or a metric at the arguments.
    fn curvature(&self, needed: &Needed) -> Option<String> {
        let Value::Vector(arguments) = needed.value(&self.arguments)? else {
            return None;
        };
        let [Some(u), Some(v)] = arguments[..] else {
            return None;
        };
        let scene = needed.compilation.scene.as_ref()?;
        let (id, object) = scene.object(&self.name)?;
        object.shape.manifold()?;
        let uniforms = needed.params.first_instance(scene, object);
        let manifold = Manifold::new(scene, id, &uniforms).ok()?;
        let found = match measure::place(manifold.surface(), [u, v]) {
            Ok(found) => found,
            Err(error) => return Some(error.to_string()),
        };
        let k = super::geometry::curvature(&found).map_or_else(|| "undefined".to_owned(), short);
        let [e, f, g] = found.form.map(short);
        Some(format!(
            "there K = {k}, E = {e}, F = {f}, G = {g}, from exact derivatives"
        ))
    }

    /// Returns the curvature of the level surface of a solid's function through the arguments: where the function is 0, of the
    /// solid itself.
    fn level_curvature(&self, needed: &Needed) -> Option<String> {
        let Value::Vector(arguments) = needed.value(&self.arguments)? else {
            return None;
        };
        let [Some(x), Some(y), Some(z)] = arguments[..] else {
            return None;
        };
        let scene = needed.compilation.scene.as_ref()?;
        let (id, object) = scene.object(&self.name)?;
        if !object.grids.is_empty() || object.shape.solid()?.leaves.len() > MOST_LEAVES {
            return None;
        }
        let solid = SolidSurface::new(scene, &needed.params, id).ok()?;
        let k = solid.surface().curvature([x, y, z])?;
        Some(format!("the level surface through it has K = {}", short(k)))
    }
}

/// The value of an expression that reads no parameter: `= 0.5`.
pub(crate) fn value(analysis: &GeotraceAnalysis, span: Span) -> Option<String> {
    let mut tokens = analysis.tokens(analysis.tokens_in(span)).take(LONGEST);
    let reads = |kind| matches!(kind, TokenKind::Variable(_) | TokenKind::Undefined);
    if tokens.any(|token| reads(token.kind)) {
        return None;
    }
    let needed = Needed::compile(analysis, &analysis.symbols_in(span))?;
    let result = needed.value(&analysis.slice(span))?;
    Some(format!("= {}{}", shown(&result), needed.start))
}

/// The declarations that an expression needs, compiled.
struct Needed {
    compilation: Compilation,
    params: ParamValues,
    /// The end of a sentence with a value: the params' start.
    start: String,
}

impl Needed {
    fn compile(analysis: &GeotraceAnalysis, symbols: &[SymbolId]) -> Option<Self> {
        let compilation = scene::geotrace::compile(&declarations(analysis, symbols)?);
        let scene = compilation.scene.as_ref()?;
        Some(Self {
            params: ParamValues::initial(scene),
            start: start::of_scene(scene),
            compilation,
        })
    }

    fn value(&self, expression: &str) -> Option<Value> {
        let evaluation = self.compilation.evaluate(expression, &self.params);
        match evaluation.ok()?.outcome {
            Outcome::Single(value) => Some(value),
            Outcome::Instances(_) => None,
        }
    }
}

/// Returns true if a word follows an underscore, so that it names the parameter of a derivative.
fn derives(analysis: &GeotraceAnalysis, start: u32) -> bool {
    let before = Span::new(start.saturating_sub(1), start);
    analysis.slice(before) == "_"
}

/// Returns the text of the declarations of some symbols, and of everything that they use; `None` if there are too many.
fn declarations(analysis: &GeotraceAnalysis, symbols: &[SymbolId]) -> Option<String> {
    let mut open = symbols.to_vec();
    let mut items: BTreeSet<usize> = BTreeSet::new();
    while let Some(id) = open.pop() {
        let Some(item) = analysis.item_of(id).filter(|item| items.insert(*item)) else {
            continue;
        };
        if items.len() > MOST_DECLARATIONS {
            return None;
        }
        open.extend(analysis.symbols_in(analysis.item(item)?.span));
    }
    let texts = items.into_iter().filter_map(|item| analysis.item(item));
    let texts = texts.map(|item| analysis.slice(item.span) + "\n");
    Some(texts.collect())
}
