//! Params and grids: from recorded declarations to uniforms.

use expr::value::Value;
use expr::{Graph, Input, NodeId, number};
use syntax::geotrace::actions::Declaration;

use crate::geotrace::code::Expression;
use crate::geotrace::declarations::{
    Declarations, DeclaredSource, Owner, SourceData, Understood, Uniforms, constant, kind_of,
};
use crate::geotrace::dependencies::SourceIndex;
use crate::geotrace::error::{self, SemanticError};
use crate::geotrace::interval::{Bounds, DeclaredInterval, Purpose};
use crate::geotrace::lowerer::Lowered;
use crate::geotrace::symbol::Meaning;
use crate::limits::{DEFAULT_SAMPLES, MAX_UNIFORMS};
use crate::scene::{Grid, GridId, Param, ParamId, Range};

impl Declarations {
    pub(crate) fn param(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[DeclaredInterval],
    ) -> Option<Understood> {
        let bounds = self.bounds(intervals, Purpose::Param);
        let ranges: Option<Vec<_>> =
            bounds.map(|bounds| bounds.iter().map(|bounds| bounds.range).collect());
        // Errors in the value are reported even if the intervals are wrong.
        let initial = match self.expressions(intervals) {
            Some([value]) => self.initial(declaration.name, value, ranges.as_deref()),
            None => (ranges.as_ref()).map(|ranges| ranges.iter().map(|range| range.min).collect()),
        };
        let (ranges, initial) = (ranges?, initial?);
        let id = ParamId(self.scene.params.len() as u32);
        let (meaning, uniforms, is_fresh) =
            self.uniforms(declaration, ranges.len(), Owner::Param(id))?;
        let data = SourceData::Param(Param {
            name: declaration.name.to_owned(),
            name_span: declaration.name_span,
            ranges,
            initial,
            first_uniform: uniforms.first,
        });
        Some(Understood::from(meaning).source(DeclaredSource {
            data,
            uniforms,
            is_fresh,
        }))
    }

    pub(crate) fn grid(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[DeclaredInterval],
    ) -> Option<Understood> {
        let bounds = self.bounds(intervals, Purpose::Grid);
        let axes: Vec<_> = bounds?
            .iter()
            .map(|bounds| bounds.sampling(DEFAULT_SAMPLES))
            .collect();
        let id = GridId(self.scene.grids.len() as u32);
        let (meaning, uniforms, is_fresh) =
            self.uniforms(declaration, axes.len(), Owner::Grid(id))?;
        let data = SourceData::Grid(Grid {
            name: declaration.name.to_owned(),
            name_span: declaration.name_span,
            axes,
            first_uniform: uniforms.first,
        });
        Some(Understood::from(meaning).source(DeclaredSource {
            data,
            uniforms,
            is_fresh,
        }))
    }

    /// Returns the initial value of a param, one number per interval; `None` after an error. It is checked against the
    /// intervals if they are known.
    fn initial(
        &mut self,
        name: &str,
        value: Expression,
        ranges: Option<&[Range]>,
    ) -> Option<Vec<f64>> {
        let lowered = self.constant(value);
        let found = self.checked_initial(name, &lowered, ranges);
        found.unwrap_or_else(|error| {
            let span = self.lowerer.code.span(value);
            self.found.push(error.at(span));
            None
        })
    }

    fn checked_initial(
        &self,
        name: &str,
        lowered: &Lowered,
        ranges: Option<&[Range]>,
    ) -> Result<Option<Vec<f64>>, SemanticError> {
        let lowerer = &self.lowerer;
        if let Some(symbol) = lowerer.dependencies.first(lowered.dependencies) {
            let keyword = lowerer.symbols.keyword(symbol);
            return Err(SemanticError::new(
                error::INITIAL_NOT_CONSTANT,
                format!(
                    "a param starts at a constant, but this depends on the {} `{}`",
                    keyword.map_or("param", |keyword| keyword.text()),
                    lowerer.symbols.name(symbol)
                ),
            ));
        }
        // Uses of a name whose declaration failed are not reported.
        let (Some(value), Some(ranges)) = (&lowered.value, ranges) else {
            return Ok(None);
        };
        let components = value.components();
        if components.len() != ranges.len() {
            let intervals = match ranges.len() {
                1 => "1 interval".to_owned(),
                count => format!("{count} intervals"),
            };
            return Err(SemanticError::new(
                error::INITIAL_DIMENSION,
                format!("`{name}` has {intervals}, but this is {}", kind_of(value)),
            )
            .with_hint("the initial value of a param has a component for each interval"));
        }
        let numbers = lowerer.numbers(components);
        for (component, (&value, range)) in numbers.iter().zip(ranges).enumerate() {
            let part = match ranges.len() {
                1 => format!("`{name}`"),
                _ => format!("`{name}_{}`", component + 1),
            };
            if !value.is_finite() {
                let what = if value.is_nan() {
                    "undefined"
                } else {
                    "infinite"
                };
                return Err(SemanticError::new(
                    error::INITIAL_UNDEFINED,
                    format!("the initial value of {part} is {what}"),
                ));
            }
            if !(range.min..=range.max).contains(&value) {
                return Err(SemanticError::new(
                    error::INITIAL_OUTSIDE,
                    format!(
                        "{part} starts at {}, which lies outside its interval [{}, {}]",
                        number::text(value),
                        number::text(range.min),
                        number::text(range.max)
                    ),
                ));
            }
        }
        Ok(Some(numbers))
    }

    /// Returns a number or a vector over uniforms, the uniforms, and whether they are new; `None` if there are too
    /// many.
    fn uniforms(
        &mut self,
        declaration: &Declaration<'_>,
        count: usize,
        owner: Owner,
    ) -> Option<(Meaning, Uniforms, bool)> {
        let count = u32::try_from(count).ok()?;
        let kept = self.kept.take().filter(|kept| kept.count == count);
        let known = self.lowerer.dependencies.uniform_count();
        let first = kept.map_or(known, |kept| kept.first);
        let components = self.components.checked_add(count)?;
        if components > MAX_UNIFORMS && !self.is_checker {
            let error = SemanticError::new(
                error::TOO_MANY_UNIFORMS,
                format!(
                    "with `{}` the params and grids have {components} components, and the limit is {MAX_UNIFORMS}",
                    declaration.name
                ),
            );
            self.found.push(error.at(declaration.name_span));
            return None;
        }
        let graph: &mut Graph = &mut self.lowerer.graph;
        let nodes: Vec<NodeId> = (first..first.checked_add(count)?)
            .map(|index| graph.input(Input::Uniform(index)))
            .collect();
        let value = match nodes[..] {
            [node] => Value::Number(node),
            _ => Value::Vector(nodes),
        };
        let uniforms = match kept {
            Some(kept) => {
                self.sources[kept.source.0 as usize] = owner;
                kept
            }
            None => {
                self.components = components;
                let source = SourceIndex(self.sources.len() as u32);
                self.sources.push(owner);
                let sets = &mut self.lowerer.dependencies;
                Uniforms {
                    first,
                    count,
                    dependencies: sets.declare(declaration.symbol, count as usize),
                    source,
                }
            }
        };
        let meaning = constant(value, uniforms.dependencies);
        Some((meaning, uniforms, kept.is_none()))
    }

    /// Returns all intervals; `None` if any has an error.
    fn bounds(&mut self, intervals: &[DeclaredInterval], purpose: Purpose) -> Option<Vec<Bounds>> {
        let bounds: Vec<_> = intervals
            .iter()
            .map(|interval| interval.bounds(&mut self.lowerer, purpose, &mut self.found))
            .collect();
        // A declaration without an interval could not have been read.
        let bounds: Option<Vec<_>> = bounds.into_iter().collect();
        bounds.filter(|bounds| !bounds.is_empty())
    }
}
