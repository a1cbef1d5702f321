//! Declarations that live inside a surface: metrics, and geodesics on surfaces and metrics.
//!
//! In: a declaration that has been read. Out: its meaning and its object, or its errors.

use expr::NodeId;
use expr::value::Value;
use syntax::diagnostic::Diagnostic;
use syntax::geotrace::actions::Declaration;
use syntax::geotrace::declarations::DeclarationKeyword;
use syntax::span::Span;
use syntax::symbol::SymbolId;

use crate::geotrace::code::Expression;
use crate::geotrace::declarations::{Declarations, DeclaredManifold, Drawn, Understood, kind_of};
use crate::geotrace::dependencies::Dependencies;
use crate::geotrace::error::{self, SemanticError};
use crate::geotrace::interval::{DeclaredInterval, number};
use crate::geotrace::lowerer::Lowered;
use crate::geotrace::symbol::Meaning;
use crate::initial_conditions::InitialConditionsEvaluator;
use crate::metric::{Defect, Witness, witness};
use crate::param_values::ParamValues;
use crate::scene::Shape;

/// The largest number of instances of a metric that are searched for a point where it is not positive definite.
const SEARCHED_INSTANCES: u64 = 16;

impl Declarations {
    /// `metric h(u,v) = (E, F, G), …;`
    pub(crate) fn metric(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[DeclaredInterval],
    ) -> Option<Understood> {
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
        let drawn = self.object(declaration, shape, lowered.dependencies);
        if let Some(drawn) = &drawn {
            let place = self.lowerer.code.span(body);
            let warning = self.degenerate(drawn, place);
            self.found.extend(warning);
        }
        Some(Understood::from(self.keep(declaration, body)).drawn(drawn))
    }

    /// `geodesic g(t) : s = (a,b) @ (u,v), …;`
    pub(crate) fn geodesic(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[DeclaredInterval],
    ) -> Option<Understood> {
        let domain = self.domain(
            declaration,
            intervals,
            "a geodesic has one parameter, its length",
        );
        let [surface, direction, start] = self.expressions(intervals)?;
        let manifold = self.surface_of(surface);
        let towards = self.constant(direction);
        let a_b = self.in_chart(direction, &towards, "direction");
        let from = self.constant(start);
        let u_v = self.in_chart(start, &from, "start");
        let (direction_span, start_span) = (
            self.lowerer.code.span(direction),
            self.lowerer.code.span(start),
        );
        let (manifold, direction, start) = (manifold?, a_b?, u_v?);
        let [domain] = domain?;
        let own = self
            .lowerer
            .dependencies
            .union(towards.dependencies, from.dependencies);
        if own == Dependencies::default() {
            let place = direction_span.to(start_span);
            self.found
                .extend(self.not_drawn(declaration, &direction, &start, &manifold, place));
        }
        let shape = Shape::Geodesic {
            surface: manifold.object,
            direction,
            start,
            domain: domain?,
            parameter: declaration.parameters.first()?.name.clone(),
        };
        let dependencies = self.lowerer.dependencies.union(own, manifold.dependencies);
        let drawn = self.object(declaration, shape, dependencies);
        Some(Understood::from(Meaning::Geodesic).drawn(drawn))
    }

    /// E, F and G; `None` if the value is something else or its declaration failed.
    fn coefficients(&mut self, body: Expression, lowered: &Lowered) -> Option<[NodeId; 3]> {
        let value = lowered.value.as_ref()?;
        if let Ok(components) = <[NodeId; 3]>::try_from(value.components()) {
            return Some(components);
        }
        let found = kind_of(value);
        let message = format!("a metric's value is (E, F, G), 3 numbers, but this is {found}");
        let error = SemanticError::new(error::NOT_A_METRIC, message)
            .with_hint("its length element is E du^2 + 2F du dv + G dv^2");
        let span = self.lowerer.code.span(body);
        self.found.push(error.at(span));
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
        let mut error = SemanticError::new(error::NOT_IN_CHART, message);
        if let (Value::Vector(nodes), "direction") = (value, what)
            && nodes.len() == 3
        {
            error = error.with_hint("(a, b) stands for a σu + b σv");
        }
        let span = self.lowerer.code.span(expression);
        self.found.push(error.at(span));
        None
    }

    /// The surface or metric that a geodesic names; `None` if the name means something else or its declaration failed.
    fn surface_of(&mut self, named: Expression) -> Option<DeclaredManifold> {
        let (symbol, span) = self.lowerer.code.functions(named).next()?;
        if let Some(manifold) = self.manifold_of(symbol) {
            return Some(manifold);
        }
        let what = self.what_else(symbol)?;
        let name = self.lowerer.symbols.name(symbol);
        let message = format!("a geodesic lies on a surface or a metric, but `{name}` is {what}");
        self.found
            .push(SemanticError::new(error::NOT_A_SURFACE, message).at(span));
        None
    }

    /// Describes a name that is not a surface or a metric; `None` if its declaration failed.
    fn what_else(&self, symbol: SymbolId) -> Option<&'static str> {
        let symbols = &self.lowerer.symbols;
        match (symbols.meaning(symbol), symbols.keyword(symbol)) {
            (Meaning::Poisoned, _)
            | (_, Some(DeclarationKeyword::Surface | DeclarationKeyword::Metric)) => None,
            (Meaning::Builtin(_), _) => Some("a builtin function"),
            (Meaning::Geodesic, _) => Some("a geodesic"),
            (_, Some(DeclarationKeyword::Curve)) => Some("a curve"),
            _ => Some("a function"),
        }
    }

    /// A warning about a geodesic that cannot start for any values of the params.
    fn not_drawn(
        &self,
        declaration: &Declaration<'_>,
        direction: &[NodeId; 2],
        start: &[NodeId; 2],
        manifold: &DeclaredManifold,
        place: Span,
    ) -> Option<Diagnostic> {
        let mut evaluator = InitialConditionsEvaluator::from_nodes(
            &self.lowerer.graph,
            direction,
            start,
            manifold.domain,
        );
        let error = evaluator.evaluate(&[]).err()?;
        let message = format!("`{}` is not drawn: {error}", declaration.name);
        Some(Diagnostic::warning(
            error::GEODESIC_NOT_DRAWN,
            place,
            message,
        ))
    }

    /// A warning about a metric that is not positive definite somewhere inside its domain, at the initial values of the
    /// params.
    fn degenerate(&self, metric: &Drawn, place: Span) -> Option<Diagnostic> {
        let object = &metric.object;
        let (components, domain) = object.shape.metric()?;
        let [first, second] = object.shape.parameters() else {
            return None;
        };
        let values = ParamValues::initial(&self.scene);
        let all = values.instance_count(&self.scene, object);
        let searched = all.min(SEARCHED_INSTANCES);
        let found = (0..searched).find_map(|k| {
            // The first, the last, and evenly between.
            let index = k * (all - 1) / (searched - 1).max(1);
            let uniforms = values.instance(&self.scene, object, index);
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
        let settings = if metric.dependencies == Dependencies::default() {
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
            Diagnostic::warning(error::DEGENERATE_METRIC, place, message).with_hint(
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
