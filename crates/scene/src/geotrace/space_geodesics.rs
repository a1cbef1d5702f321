//! Geodesics on the surfaces of solids.
//!
//! In: a declaration that has been read, and the solid that it names. Out: its meaning and its object, or its errors.

use std::sync::Arc;

use expr::NodeId;
use geodesic::implicit::ImplicitSurface;
use syntax::diagnostic::Diagnostic;
use syntax::geotrace::actions::Declaration;
use syntax::span::Span;

use crate::geodesic_value::numbers;
use crate::geotrace::code::Expression;
use crate::geotrace::declarations::{Declarations, Understood, kind_of};
use crate::geotrace::dependencies::Dependencies;
use crate::geotrace::error::{self, SemanticError};
use crate::geotrace::geodesics::DeclaredWay;
use crate::geotrace::interval::DeclaredInterval;
use crate::geotrace::lowerer::Lowered;
use crate::geotrace::sets::DeclaredSolid;
use crate::geotrace::symbol::Meaning;
use crate::scene::{GeodesicPath, Sampling};

/// The maximum number of nodes of a field for which a check tests whether a geodesic can start.
const TRIED: usize = 4_000;

impl Declarations {
    /// Returns the solid that a geodesic names, if it names one, with the span of the name.
    pub(crate) fn solid_below(
        &self,
        intervals: &[DeclaredInterval],
    ) -> Option<(Arc<DeclaredSolid>, Arc<str>, Span)> {
        let of = |named: Expression| {
            let (symbol, span) = self.lowerer.code.functions(named).next()?;
            let Meaning::Solid(solid) = self.lowerer.symbols.meaning(symbol) else {
                return None;
            };
            let name = self.lowerer.symbols.name(symbol).into();
            Some((Arc::clone(solid), name, span))
        };
        match self.expressions(intervals) {
            Some([named, _, _]) => of(named),
            None => {
                let [named, _] = self.expressions(intervals)?;
                of(named)
            }
        }
    }

    /// `geodesic g(t) : ball = (a, b, c) @ (x, y, z), …;`
    pub(crate) fn space_geodesic(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[DeclaredInterval],
        (solid, name, place): (Arc<DeclaredSolid>, Arc<str>, Span),
        domain: Option<[Option<Sampling>; 1]>,
    ) -> Option<Understood> {
        let Some([_, direction, start]) = self.expressions(intervals) else {
            let [_, places] = self.expressions(intervals)?;
            let message = format!(
                "on a solid such as `{name}` a geodesic needs a start and a direction; shortest geodesics are available on surfaces and metrics only"
            );
            let error = SemanticError::new(error::NOT_IN_CHART, message)
                .with_hint("write `(a, b, c) @ (x, y, z)`");
            let span = self.lowerer.code.span(places);
            self.found.push(error.at(span));
            return None;
        };
        let span = {
            let code = &self.lowerer.code;
            code.span(direction).to(code.span(start))
        };
        let towards = self.constant(direction);
        let along = self.on_solid(direction, &towards, "direction", &name);
        let from = self.constant(start);
        let at = self.on_solid(start, &from, "start", &name);
        let (attributes, stated) = self.stated(declaration.keyword, 1);
        let field = match self.lowerer.solid_field(&solid) {
            Ok(field) => field,
            Err(error) => {
                self.found.push(error.at(place));
                return None;
            }
        };
        let (along, at) = (along?, at?);
        let [domain] = domain?;
        let sets = &mut self.lowerer.dependencies;
        let own = sets.union(towards.dependencies, from.dependencies);
        let dependencies = sets.union(own, solid.value_dependencies);
        if dependencies == Dependencies::default() {
            let warning = self.cannot_start(declaration, field, [along, at], span);
            self.found.extend(warning);
        }
        let path = GeodesicPath::Space {
            solid: name,
            field,
            direction: along,
            start: at,
        };
        let way = DeclaredWay::Space {
            field,
            start: at,
            direction: along,
        };
        self.declared_geodesic(
            declaration,
            (path, way),
            domain?,
            dependencies,
            (attributes, stated),
        )
    }

    /// Returns a direction or a start in space.
    fn on_solid(
        &mut self,
        expression: Expression,
        lowered: &Lowered,
        what: &str,
        solid: &str,
    ) -> Option<[NodeId; 3]> {
        let value = lowered.value.as_ref()?;
        if let Ok(components) = <[NodeId; 3]>::try_from(value.components()) {
            return Some(components);
        }
        let found = kind_of(value);
        let message = format!(
            "the {what} of a geodesic on a solid such as `{solid}` has 3 components, x, y and z, but this is {found}"
        );
        let hint = match what {
            "start" => "it need not lie on the surface: it is projected there along the gradient",
            _ => "it is projected onto the tangent plane",
        };
        let error = SemanticError::new(error::NOT_IN_CHART, message).with_hint(hint);
        let span = self.lowerer.code.span(expression);
        self.found.push(error.at(span));
        None
    }

    /// Returns a warning about a geodesic that depends on no param and cannot start.
    fn cannot_start(
        &self,
        declaration: &Declaration<'_>,
        field: NodeId,
        [along, at]: [[NodeId; 3]; 2],
        span: Span,
    ) -> Option<Diagnostic> {
        let lowerer = &self.lowerer;
        let nodes = [along, at].concat();
        if lowerer.geodesics.reads_connection(&lowerer.graph, &nodes) {
            return None;
        }
        let (uniforms, faults) = lowerer.values_of_geodesics(&nodes);
        let found = numbers(&lowerer.graph, &nodes, &uniforms, &[]);
        let [a, b, c, x, y, z] = found[..] else {
            return None;
        };
        let small = lowerer.graph.order(&[field]).len() <= TRIED;
        let is_known = found.iter().all(|x| x.is_finite());
        let reason = if is_known && small {
            let surface = ImplicitSurface::new(&lowerer.graph, field, &uniforms, None).ok()?;
            surface.start([x, y, z], [a, b, c]).err()?.to_string()
        } else if [x, y, z].iter().any(|x| !x.is_finite()) {
            "its start is undefined".to_owned()
        } else if !is_known {
            "its direction is undefined".to_owned()
        } else if [a, b, c] == [0.0; 3] {
            "its direction is zero".to_owned()
        } else {
            return None;
        };
        // The reason why a required number is undefined is more informative than the fact itself.
        let first = faults
            .iter()
            .map(|(name, fault)| format!("of `{name}`: {fault}"));
        let reason = first.min().unwrap_or(reason);
        let message = format!("`{}` is not drawn: {reason}", declaration.name);
        Some(Diagnostic::warning(
            error::GEODESIC_NOT_DRAWN,
            span,
            message,
        ))
    }
}
