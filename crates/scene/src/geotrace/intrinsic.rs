//! Declarations inside a surface: metrics, and geodesics on surfaces and metrics.
//!
//! In: a declaration that has been read. Out: its meaning and its object, or its errors.

use expr::value::{DimensionError, Value};
use expr::{NodeId, number};
use syntax::diagnostic::Diagnostic;
use syntax::geotrace::actions::Declaration;
use syntax::geotrace::declarations::DeclarationKeyword;
use syntax::span::Span;
use syntax::symbol::SymbolId;

use crate::geodesic_value::numbers;
use crate::geotrace::code::Expression;
use crate::geotrace::declarations::{Declarations, DeclaredManifold, Drawn, Understood, kind_of};
use crate::geotrace::dependencies::Dependencies;
use crate::geotrace::error::{self, SemanticError};
use crate::geotrace::geodesics::{DeclaredGeodesic, DeclaredWay};
use crate::geotrace::interval::DeclaredInterval;
use crate::geotrace::lowerer::Lowered;
use crate::geotrace::symbol::Meaning;
use crate::initial_conditions::{InitialConditions, InitialConditionsError};
use crate::metric::{Defect, Witness, witness};
use crate::param_values::ParamValues;
use crate::scene::{GeodesicPath, Sampling, Shape};
use crate::solid::Attribute;

/// The maximum number of instances of a metric that are searched for a point where it is not positive definite.
const SEARCHED_INSTANCES: u64 = 16;

/// The path of a geodesic on its surface.
struct Path {
    start: [NodeId; 2],
    direction: [NodeId; 2],
    unit: Option<NodeId>,
    /// The start and the direction, or the two endpoints, as written.
    ends: [[NodeId; 2]; 2],
    /// Without the dependencies of the surface.
    dependencies: Dependencies,
    span: Span,
}

impl Declarations {
    /// `metric h(u,v) = (E, F, G), …;`
    pub(crate) fn metric(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[DeclaredInterval],
    ) -> Option<Understood> {
        let domain = self.domain(declaration, intervals, "a metric has two parameters");
        let [body] = self.expressions(intervals)?;
        let known = self.found.len();
        let lowered = self.over_variables(body, declaration.parameters.len());
        self.explain_matrix(body, known);
        let components = self.coefficients(body, &lowered);
        let (attributes, all) = self.stated_with(declaration, 2, lowered.dependencies);
        let components = components?;
        let [u, v] = domain?;
        let [first, second] = declaration.parameters else {
            return None;
        };
        let shape = Shape::Metric {
            components,
            domain: [u?, v?],
            parameters: [first.name.clone(), second.name.clone()],
        };
        let drawn = self.object(declaration, shape, all, attributes);
        if let Some(drawn) = &drawn {
            let place = self.lowerer.code.span(body);
            let warning = self.degenerate(drawn, place);
            self.found.extend(warning);
        }
        Some(Understood::from(self.keep(declaration, body)).drawn(drawn))
    }

    /// `geodesic g(t) : s = (a, b) @ (u, v), …;` or `geodesic g(t) : s = (p, q), …;`
    pub(crate) fn geodesic(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[DeclaredInterval],
    ) -> Option<Understood> {
        let domain = self.domain(declaration, intervals, "a geodesic has one parameter");
        if let Some(solid) = self.solid_below(intervals) {
            return self.space_geodesic(declaration, intervals, solid, domain);
        }
        let (manifold, path) = match self.expressions(intervals) {
            Some([surface, direction, start]) => (
                self.surface_of(surface),
                self.path_from_place(direction, start),
            ),
            None => {
                let [surface, places] = self.expressions(intervals)?;
                let manifold = self.surface_of(surface);
                let path = self.path_between_places(declaration.name, places, manifold);
                (manifold, path)
            }
        };
        let (attributes, stated) = self.stated(declaration.keyword, 1);
        let (manifold, path) = (manifold?, path?);
        let [domain] = domain?;
        let sets = &mut self.lowerer.dependencies;
        let dependencies = sets.union(path.dependencies, manifold.dependencies);
        if path.dependencies == Dependencies::default() {
            let warning = self.not_drawn(declaration, &path, &manifold);
            self.found.extend(warning);
        }
        let Path {
            start,
            direction,
            unit,
            ..
        } = path;
        let path = GeodesicPath::Chart {
            surface: manifold.object,
            direction,
            start,
            unit,
        };
        let way = DeclaredWay::Chart {
            manifold: manifold.nodes,
            start,
            direction,
            unit,
        };
        self.declared_geodesic(
            declaration,
            (path, way),
            domain?,
            dependencies,
            (attributes, stated),
        )
    }

    /// Declares a geodesic, and draws it with its attributes, which have dependencies of their own.
    pub(crate) fn declared_geodesic(
        &mut self,
        declaration: &Declaration<'_>,
        (path, way): (GeodesicPath, DeclaredWay),
        domain: Sampling,
        dependencies: Dependencies,
        (attributes, stated): (Vec<Attribute>, Dependencies),
    ) -> Option<Understood> {
        let shape = Shape::Geodesic {
            path,
            domain,
            parameter: declaration.parameters.first()?.name.clone(),
        };
        let all = self.lowerer.dependencies.union(dependencies, stated);
        let drawn = self.object(declaration, shape, all, attributes);
        let geodesic = self.lowerer.geodesics.declare(DeclaredGeodesic {
            name: declaration.name.into(),
            way,
            dependencies,
        });
        Some(Understood::from(Meaning::Geodesic(geodesic)).drawn(drawn))
    }

    /// `(a, b) @ (u, v)`.
    fn path_from_place(&mut self, direction: Expression, start: Expression) -> Option<Path> {
        let towards = self.constant(direction);
        let a_b = self.in_chart(direction, &towards, "direction");
        let from = self.constant(start);
        let u_v = self.in_chart(start, &from, "start");
        let code = &self.lowerer.code;
        let span = code.span(direction).to(code.span(start));
        let sets = &mut self.lowerer.dependencies;
        let (start, direction) = (u_v?, a_b?);
        Some(Path {
            start,
            direction,
            unit: None,
            ends: [start, direction],
            dependencies: sets.union(towards.dependencies, from.dependencies),
            span,
        })
    }

    /// `(p, q)`: the shortest geodesic from p to q.
    fn path_between_places(
        &mut self,
        name: &str,
        places: Expression,
        manifold: Option<DeclaredManifold>,
    ) -> Option<Path> {
        let (list, lowered) = self.lowerer.lower_list(places, &mut self.found);
        let span = self.lowerer.code.span(places);
        let list = match (list, &lowered.value) {
            (Some(list), _) => list,
            (None, Some(value)) => {
                let message = format!(
                    "a geodesic is `direction @ start` or has two points `(p, q)`, but this is {}",
                    kind_of(value)
                );
                let error = SemanticError::new(error::NOT_IN_CHART, message)
                    .with_hint("write `(a, b) @ (u, v)`, or `((u, v), (w, z))` for the shortest between two points");
                self.found.push(error.at(span));
                return None;
            }
            (None, None) => return None,
        };
        let places: Vec<[NodeId; 2]> = list
            .iter()
            .filter_map(|value| <[NodeId; 2]>::try_from(value.components()).ok())
            .collect();
        let (&[from, to], 2) = (&places[..], list.len()) else {
            let message = "a geodesic runs between two points, and each has 2 components, one for each parameter of its surface";
            self.found
                .push(SemanticError::new(error::NOT_IN_CHART, message).at(span));
            return None;
        };
        let manifold = manifold?;
        let lowerer = &mut self.lowerer;
        let sets = &mut lowerer.dependencies;
        let all = sets.union(lowered.dependencies, manifold.dependencies);
        let [u, v, a, b, unit] = lowerer.geodesics.connection(
            &mut lowerer.graph,
            sets,
            name,
            manifold.nodes,
            [from, to],
            all,
        );
        Some(Path {
            start: [u, v],
            direction: [a, b],
            unit: Some(unit),
            ends: [from, to],
            dependencies: lowered.dependencies,
            span,
        })
    }

    /// Gives the error of a metric that is written as a matrix, `((E, F), (F, G))`, the hint that is meant. `known` is the number
    /// of earlier diagnostics.
    fn explain_matrix(&mut self, body: Expression, known: usize) {
        let nested = DimensionError::Nested {
            position: 1,
            dimension: 2,
        };
        let span = self.lowerer.code.span(body);
        for found in &mut self.found[known..] {
            if found.span == span && found.hint.as_deref() == nested.hint() {
                let hint = "a metric's value is `(E, F, G)`: that of the plane is `(1, 0, 1)`";
                found.hint = Some(hint.to_owned());
            }
        }
    }

    /// Returns E, F and G; `None` if the value is something else or its declaration failed.
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

    /// Returns a direction or a start in the parameters of a surface.
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

    /// Returns the surface or metric that a geodesic names; `None` if the name denotes something else or its
    /// declaration failed.
    fn surface_of(&mut self, named: Expression) -> Option<DeclaredManifold> {
        let (symbol, span) = self.lowerer.code.functions(named).next()?;
        if let Some(manifold) = self.manifold_of(symbol) {
            return Some(manifold);
        }
        let what = self.what_else(symbol)?;
        let name = self.lowerer.symbols.name(symbol);
        let message =
            format!("a geodesic lies on a surface, a metric or a solid, but `{name}` is {what}");
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
            (Meaning::Geodesic(_), _) => Some("a geodesic"),
            (_, Some(DeclarationKeyword::Curve)) => Some("a curve"),
            _ => Some("a function"),
        }
    }

    /// Returns a warning about a geodesic that cannot start for any values of the params.
    fn not_drawn(
        &self,
        declaration: &Declaration<'_>,
        path: &Path,
        manifold: &DeclaredManifold,
    ) -> Option<Diagnostic> {
        let lowerer = &self.lowerer;
        let nodes = path.ends.concat();
        if lowerer.geodesics.reads_connection(&lowerer.graph, &nodes) {
            return None;
        }
        let (uniforms, faults) = lowerer.values_of_geodesics(&nodes);
        let [one, other] = path.ends.map(|nodes| {
            let found = numbers(&lowerer.graph, &nodes, &uniforms, &[]);
            [found[0], found[1]]
        });
        let domain = manifold.nodes.domain;
        // A geodesic between two points starts at both.
        let (start, ways) = match path.unit {
            None => (one, vec![(one, other)]),
            Some(_) => (one, vec![(one, [1.0; 2]), (other, [1.0; 2])]),
        };
        let faulty = |&(start, direction): &([f64; 2], [f64; 2])| {
            InitialConditions::new(start, direction, 1.0, domain).err()
        };
        let same = path.unit.is_some() && start == other;
        let error = ways.iter().find_map(faulty);
        let error = error.or(same.then_some(InitialConditionsError::OnePlace))?;
        // The reason why a required point is undefined is more informative than the fact itself.
        let first = faults
            .iter()
            .map(|(name, fault)| format!("of `{name}`: {fault}"));
        let reason = first.min().unwrap_or_else(|| error.to_string());
        let message = format!("`{}` is not drawn: {reason}", declaration.name);
        Some(Diagnostic::warning(
            error::GEODESIC_NOT_DRAWN,
            path.span,
            message,
        ))
    }

    /// Returns a warning about a metric that is not positive definite somewhere inside its domain, for the initial
    /// values of the params.
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
            let mut uniforms = values.instance(&self.scene, object, index);
            let lowerer = &self.lowerer;
            uniforms.resize(lowerer.dependencies.uniform_count() as usize, f64::NAN);
            lowerer
                .geodesics
                .fill(&lowerer.graph, components, &mut uniforms);
            let graph = &lowerer.graph;
            witness(graph, components, domain, &uniforms, searched as usize)
        })?;
        let Witness { at: [u, v], defect } = found;
        let (what, condition) = match defect {
            Defect::Undefined => ("is undefined".to_owned(), ""),
            Defect::First(e) => (format!("has E = {}", short(e)), ", which is not positive"),
            Defect::Determinant(d) if !d.is_finite() => {
                let what = "has E, F or G so large that E G - F^2 overflows";
                (what.to_owned(), "")
            }
            Defect::Determinant(d) => (
                format!("has E G - F^2 = {}", short(d)),
                ", which is not positive",
            ),
        };
        let settings = if metric.dependencies == Dependencies::default() {
            ""
        } else {
            ", with the params at their initial values"
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

/// Returns a number to six digits.
fn short(value: f64) -> String {
    number::text(number::rounded(value, 6))
}
