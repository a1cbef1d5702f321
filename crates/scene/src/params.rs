//! Params and grids: from what was read to uniforms.

use expr::tape::{Registers, Tape};
use expr::value::Value;
use expr::{Graph, Input, NodeId};
use syntax::actions::Declaration;

use crate::code::Expression;
use crate::declare::{Declarations, kind_of};
use crate::fault::{self, Fault};
use crate::interval::{Bounds, Interval, Purpose, number};
use crate::limits::{DEFAULT_SAMPLES, MAX_UNIFORMS};
use crate::lower::Lowered;
use crate::reads::{Reads, Source};
use crate::scene::{Grid, GridId, Param, ParamId, Range};
use crate::symbol::{Constant, Meaning};

/// The uniforms of a param or a grid.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) struct Uniforms {
    pub(crate) first: u32,
    pub(crate) count: u32,
    /// The set that holds just this param or grid.
    pub(crate) reads: Reads,
    pub(crate) source: Source,
}

/// What a source of reads is.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Owner {
    Param(ParamId),
    Grid(GridId),
}

impl Declarations {
    pub(crate) fn param(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[Interval],
    ) -> Option<Meaning> {
        let bounds = self.bounds(intervals, Purpose::Axis);
        let ranges: Option<Vec<_>> =
            bounds.map(|bounds| bounds.iter().map(|bounds| bounds.range).collect());
        // The value has its own mistakes, whatever is wrong with the intervals.
        let opening = match self.expressions(intervals) {
            Some([value]) => self.opening(declaration.name, value, ranges.as_deref()),
            None => (ranges.as_ref()).map(|ranges| ranges.iter().map(|range| range.min).collect()),
        };
        let (ranges, opening) = (ranges?, opening?);
        let id = ParamId(self.scene.params.len() as u32);
        let (value, first_uniform) = self.uniforms(declaration, ranges.len(), Owner::Param(id))?;
        self.scene.params.push(Param {
            name: declaration.name.to_owned(),
            name_span: declaration.name_span,
            ranges,
            opening,
            first_uniform,
        });
        Some(Meaning::Constant(value))
    }

    pub(crate) fn grid(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[Interval],
    ) -> Option<Meaning> {
        let bounds = self.bounds(intervals, Purpose::Axis);
        let axes: Vec<_> = bounds?
            .iter()
            .map(|bounds| bounds.sampling(DEFAULT_SAMPLES))
            .collect();
        let id = GridId(self.scene.grids.len() as u32);
        let (value, first_uniform) = self.uniforms(declaration, axes.len(), Owner::Grid(id))?;
        self.scene.grids.push(Grid {
            name: declaration.name.to_owned(),
            name_span: declaration.name_span,
            axes,
            first_uniform,
        });
        Some(Meaning::Constant(value))
    }

    /// The value that a param opens with, one number per interval; none where something is wrong with it. It is
    /// held to the intervals where they are known.
    fn opening(
        &mut self,
        name: &str,
        value: Expression,
        ranges: Option<&[Range]>,
    ) -> Option<Vec<f64>> {
        let lowered = self.constant(value);
        let found = self.opening_of(name, &lowered, ranges);
        found.unwrap_or_else(|fault| {
            let span = self.lowerer.code.span(value);
            self.diagnostics.push(fault.at(span));
            None
        })
    }

    fn opening_of(
        &self,
        name: &str,
        lowered: &Lowered,
        ranges: Option<&[Range]>,
    ) -> Result<Option<Vec<f64>>, Fault> {
        let lowerer = &self.lowerer;
        if let Some(symbol) = lowerer.reads.first(lowered.reads) {
            let word = lowerer.symbols.word(symbol);
            return Err(Fault::new(
                fault::OPENING_NOT_CONSTANT,
                format!(
                    "a param opens with a constant, but this depends on the {} `{}`",
                    word.map_or("param", |word| word.text()),
                    lowerer.symbols.name(symbol)
                ),
            ));
        }
        // What uses a name that failed before is not reported.
        let (Some(value), Some(ranges)) = (&lowered.value, ranges) else {
            return Ok(None);
        };
        let components = value.components();
        if components.len() != ranges.len() {
            let intervals = match ranges.len() {
                1 => "1 interval".to_owned(),
                count => format!("{count} intervals"),
            };
            return Err(Fault::new(
                fault::OPENING_DIMENSION,
                format!("`{name}` has {intervals}, but this is {}", kind_of(value)),
            )
            .with_hint("the value that a param opens with has a component for each interval"));
        }
        let tape = Tape::new(&lowerer.graph, components);
        let mut numbers = vec![f64::NAN; components.len()];
        if tape.inputs().is_empty() {
            tape.eval(&mut Registers::default(), &[], &mut numbers);
        }
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
                return Err(Fault::new(
                    fault::OPENING_UNDEFINED,
                    format!("the value that {part} opens with is {what}"),
                ));
            }
            if !(range.min..=range.max).contains(&value) {
                return Err(Fault::new(
                    fault::OPENING_OUTSIDE,
                    format!(
                        "{part} opens with {}, which lies outside its interval [{}, {}]",
                        number(value),
                        number(range.min),
                        number(range.max)
                    ),
                ));
            }
        }
        Ok(Some(numbers))
    }

    /// Fresh uniforms: a number, or a vector of them, and the first; none where there are too many.
    fn uniforms(
        &mut self,
        declaration: &Declaration<'_>,
        count: usize,
        owner: Owner,
    ) -> Option<(Constant, u32)> {
        let count = u32::try_from(count).ok()?;
        let kept = self.kept.take().filter(|kept| kept.count == count);
        let first = kept.map_or(self.scene.uniform_count, |kept| kept.first);
        let end = first.checked_add(count)?;
        if end > MAX_UNIFORMS && !self.is_workshop {
            let fault = Fault::new(
                fault::TOO_MANY_UNIFORMS,
                format!(
                    "with `{}` the params and grids have {end} components, and the limit is {MAX_UNIFORMS}",
                    declaration.name
                ),
            );
            self.diagnostics.push(fault.at(declaration.name_span));
            return None;
        }
        let graph: &mut Graph = &mut self.lowerer.graph;
        let nodes: Vec<NodeId> = (first..end)
            .map(|index| graph.input(Input::Uniform(index)))
            .collect();
        let value = match nodes[..] {
            [node] => Value::Number(node),
            _ => Value::Vector(nodes),
        };
        let reads = match kept {
            Some(kept) => {
                self.sources[kept.source.0 as usize] = owner;
                kept.reads
            }
            None => {
                self.scene.uniform_count = end;
                self.sources.push(owner);
                self.lowerer
                    .reads
                    .declare(declaration.symbol, count as usize)
            }
        };
        Some((Constant { value, reads }, first))
    }

    /// All intervals; none where something is wrong with any.
    fn bounds(&mut self, intervals: &[Interval], purpose: Purpose) -> Option<Vec<Bounds>> {
        let bounds: Vec<_> = intervals
            .iter()
            .map(|interval| interval.bounds(&mut self.lowerer, purpose, &mut self.diagnostics))
            .collect();
        // Without an interval the declaration could not have been read.
        let bounds: Option<Vec<_>> = bounds.into_iter().collect();
        bounds.filter(|bounds| !bounds.is_empty())
    }
}
