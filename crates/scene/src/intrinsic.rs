//! Declarations that live inside a surface: metrics, and geodesics on surfaces and metrics.
//!
//! What flows in: a declaration that has been read. What flows out: its meaning and its object, or what is
//! wrong with it.

use expr::NodeId;
use expr::value::Value;
use syntax::actions::Declaration;
use syntax::diagnostic::Diagnostic;
use syntax::span::Span;
use syntax::token::{DeclareWord, SymbolId};

use crate::code::Expression;
use crate::declare::{Declarations, Patch, kind_of};
use crate::fault::{self, Fault};
use crate::geodesic::Launcher;
use crate::interval::{Interval, number};
use crate::lower::Lowered;
use crate::metric::{Defect, Witness, witness};
use crate::reads::Reads;
use crate::scene::{ObjectId, Shape};
use crate::symbol::Meaning;
use crate::values::Settings;

/// The most instances of a metric that are searched for a point where it is none.
const SEARCHED_INSTANCES: u64 = 16;

impl Declarations {
    /// `metric h(u,v) = (E, F, G), …;`
    pub(crate) fn metric(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[Interval],
    ) -> Option<Meaning> {
        let domain = self.domain(declaration, intervals, "a metric has two parameters");
        let [body] = self.expressions(intervals)?;
        let lowered = self.over_variables(body, declaration.parameters.len());
        let components = self.coefficients(body, &lowered)?;
        let [u, v] = domain?;
        let [first, second] = declaration.parameters else {
            return None;
        };
        let shape = Shape::Metric {
            components,
            domain: [u?, v?],
            parameters: [first.name.clone(), second.name.clone()],
        };
        if let Some(object) = self.patch(declaration, shape, lowered.reads) {
            let place = self.lowerer.code.span(body);
            let warning = self.degenerate(object, place, lowered.reads);
            self.diagnostics.extend(warning);
        }
        Some(self.keep(declaration, body))
    }

    /// `geodesic g(t) : s = (a,b) @ (u,v), …;`
    pub(crate) fn geodesic(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[Interval],
    ) -> Option<Meaning> {
        let domain = self.domain(
            declaration,
            intervals,
            "a geodesic has one parameter, its length",
        );
        let [surface, direction, start] = self.expressions(intervals)?;
        let patch = self.surface_of(surface);
        let towards = self.constant(direction);
        let a_b = self.in_chart(direction, &towards, "direction");
        let from = self.constant(start);
        let u_v = self.in_chart(start, &from, "start");
        let (direction_span, start_span) = (
            self.lowerer.code.span(direction),
            self.lowerer.code.span(start),
        );
        let (patch, direction, start) = (patch?, a_b?, u_v?);
        let [domain] = domain?;
        let own = self.lowerer.reads.union(towards.reads, from.reads);
        if own == Reads::default() {
            let place = direction_span.to(start_span);
            self.diagnostics
                .extend(self.not_drawn(declaration, &direction, &start, &patch, place));
        }
        let shape = Shape::Geodesic {
            surface: patch.object,
            direction,
            start,
            domain: domain?,
            parameter: declaration.parameters.first()?.name.clone(),
        };
        let reads = self.lowerer.reads.union(own, patch.reads);
        self.object(declaration, shape, reads);
        Some(Meaning::Geodesic)
    }

    /// E, F and G; none where the value is something else or has failed before.
    fn coefficients(&mut self, body: Expression, lowered: &Lowered) -> Option<[NodeId; 3]> {
        let value = lowered.value.as_ref()?;
        if let Ok(components) = <[NodeId; 3]>::try_from(value.components()) {
            return Some(components);
        }
        let found = kind_of(value);
        let message = format!("a metric's value is (E, F, G), 3 numbers, but this is {found}");
        let fault = Fault::new(fault::NOT_A_METRIC, message)
            .with_hint("its length element is E du^2 + 2F du dv + G dv^2");
        let span = self.lowerer.code.span(body);
        self.diagnostics.push(fault.at(span));
        None
    }

    /// A direction or a start in the parameters of a surface.
    fn in_chart(
        &mut self,
        expression: Expression,
        lowered: &Lowered,
        what: &str,
    ) -> Option<[NodeId; 2]> {
        let value = lowered.value.as_ref()?;
        if let Ok(components) = <[NodeId; 2]>::try_from(value.components()) {
            return Some(components);
        }
        let found = kind_of(value);
        let message = format!(
            "a geodesic's {what} has 2 components, one for each parameter of its surface, but this is {found}"
        );
        let mut fault = Fault::new(fault::NOT_IN_CHART, message);
        if let (Value::Vector(nodes), "direction") = (value, what)
            && nodes.len() == 3
        {
            fault = fault.with_hint("(a, b) stands for a σu + b σv");
        }
        let span = self.lowerer.code.span(expression);
        self.diagnostics.push(fault.at(span));
        None
    }

    /// The surface or metric that a geodesic names; none where it names something else, or what has failed.
    fn surface_of(&mut self, named: Expression) -> Option<Patch> {
        let (symbol, span) = self.lowerer.code.functions(named).next()?;
        if let Some(patch) = self.patch_of(symbol) {
            return Some(patch);
        }
        let what = self.what_else(symbol)?;
        let name = self.lowerer.symbols.name(symbol);
        let message = format!("a geodesic lies on a surface or a metric, but `{name}` is {what}");
        self.diagnostics
            .push(Fault::new(fault::NOT_A_SURFACE, message).at(span));
        None
    }

    /// What a name stands for that is no surface; none where its declaration failed.
    fn what_else(&self, symbol: SymbolId) -> Option<&'static str> {
        let symbols = &self.lowerer.symbols;
        match (symbols.meaning(symbol), symbols.word(symbol)) {
            (Meaning::Poisoned, _) | (_, Some(DeclareWord::Surface | DeclareWord::Metric)) => None,
            (Meaning::Builtin(_), _) => Some("a builtin function"),
            (Meaning::Geodesic, _) => Some("a geodesic"),
            (_, Some(DeclareWord::Curve)) => Some("a curve"),
            _ => Some("a function"),
        }
    }

    /// A warning of a geodesic that does not start, whatever the params are.
    fn not_drawn(
        &self,
        declaration: &Declaration<'_>,
        direction: &[NodeId; 2],
        start: &[NodeId; 2],
        patch: &Patch,
        place: Span,
    ) -> Option<Diagnostic> {
        let mut launcher = Launcher::of(&self.lowerer.graph, direction, start, patch.domain);
        let fault = launcher.launch(&[]).err()?;
        let message = format!("`{}` is not drawn: {fault}", declaration.name);
        Some(Diagnostic::warning(
            fault::GEODESIC_NOT_DRAWN,
            place,
            message,
        ))
    }

    /// A warning of a metric that is none somewhere inside its domain, with the params as they start.
    fn degenerate(&self, metric: ObjectId, place: Span, reads: Reads) -> Option<Diagnostic> {
        let object = self.scene.objects.get(metric.0 as usize)?;
        let Shape::Metric {
            components,
            domain,
            parameters: [first, second],
        } = &object.shape
        else {
            return None;
        };
        let settings = Settings::opening(&self.scene);
        let all = settings.instance_count(&self.scene, object);
        let searched = all.min(SEARCHED_INSTANCES);
        let found = (0..searched).find_map(|k| {
            // The first, the last, and evenly between.
            let index = k * (all - 1) / (searched - 1).max(1);
            let uniforms = settings.instance(&self.scene, object, index);
            let graph = &self.lowerer.graph;
            witness(graph, components, domain, &uniforms, searched as usize)
        })?;
        let Witness { at: [u, v], defect } = found;
        let (what, condition) = match defect {
            Defect::Undefined => ("is undefined".to_owned(), ""),
            Defect::First(e) => (format!("has E = {}", short(e)), ", which is not positive"),
            Defect::Determinant(d) => (
                format!("has E G - F^2 = {}", short(d)),
                ", which is not positive",
            ),
        };
        let settings = if reads == Reads::default() {
            ""
        } else {
            ", with the params as they start"
        };
        let message = format!(
            "`{}` {what}{condition}, at ({first}, {second}) = ({}, {}){settings}",
            object.name,
            short(u),
            short(v),
        );
        Some(
            Diagnostic::warning(fault::DEGENERATE_METRIC, place, message).with_hint(
                "inside the domain of a metric E > 0 and E G > F^2; geodesics end where that fails",
            ),
        )
    }
}

/// A number to six digits.
fn short(value: f64) -> String {
    let rounded = format!("{value:.5e}").parse();
    number(rounded.unwrap_or(value))
}
