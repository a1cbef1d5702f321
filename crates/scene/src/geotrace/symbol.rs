//! The meanings of symbols.
//!
//! In: declarations with their meanings. Out: the meaning of a name in the expressions below. A symbol without a
//! meaning is one whose declaration failed: its uses are not reported, because the error has been.

use std::sync::Arc;

use expr::Graph;
use expr::ops::CONSTANTS;
use expr::value::Value;
use syntax::geotrace::declarations::DeclarationKeyword;
use syntax::symbol::SymbolId;

use crate::geotrace::builtin::Builtin;
use crate::geotrace::code::Expression;
use crate::geotrace::dependencies::Dependencies;
use crate::geotrace::error::{self, SemanticError};
use crate::geotrace::geodesics::GeodesicId;
use crate::geotrace::sets::DeclaredSolid;

/// The meanings of all symbols that have one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Symbols(Vec<Symbol>);

/// A name and its meaning.
#[derive(Clone, Debug)]
struct Symbol {
    name: Box<str>,
    /// The keyword that declares it; `None` for a builtin.
    keyword: Option<DeclarationKeyword>,
    meaning: Meaning,
}

/// The meaning of a name.
#[derive(Clone, Debug)]
pub(crate) enum Meaning {
    /// Its declaration failed.
    Poisoned,
    Constant(Constant),
    Builtin(Builtin),
    Declared(Declared),
    /// An integrated curve, whose points have nodes of their own.
    Geodesic(GeodesicId),
    /// A set of points, which is also a function.
    Solid(Arc<DeclaredSolid>),
}

/// A named value.
#[derive(Clone, Debug)]
pub(crate) struct Constant {
    pub(crate) value: Value,
    /// The params and grids that it reads.
    pub(crate) dependencies: Dependencies,
}

/// A declared function, curve, surface or metric.
#[derive(Clone, Debug)]
pub(crate) struct Declared {
    pub(crate) body: Expression,
    pub(crate) parameters: Box<[Box<str>]>,
}

impl Symbols {
    /// Returns the builtin names with their meanings, in the order of [`vocabulary`](super::builtin::vocabulary).
    pub(crate) fn builtin(graph: &mut Graph) -> Self {
        let mut symbols = Self::default();
        let constants = CONSTANTS.into_iter().map(|(name, value, _)| {
            let value = Value::Number(graph.constant(value));
            let dependencies = Dependencies::default();
            (
                name,
                Meaning::Constant(Constant {
                    value,
                    dependencies,
                }),
            )
        });
        let functions = Builtin::all().map(|(name, builtin)| (name, Meaning::Builtin(builtin)));
        for (id, (name, meaning)) in (0..).map(SymbolId).zip(constants.chain(functions)) {
            symbols.define(id, name, None, meaning);
        }
        symbols
    }

    /// Sets the meaning of a symbol. Symbols come in the order of their ids; the ones that are skipped are poisoned.
    pub(crate) fn define(
        &mut self,
        symbol: SymbolId,
        name: &str,
        keyword: Option<DeclarationKeyword>,
        meaning: Meaning,
    ) {
        let index = symbol.0 as usize;
        while self.0.len() <= index {
            self.0.push(Symbol {
                name: Box::default(),
                keyword: None,
                meaning: Meaning::Poisoned,
            });
        }
        self.0[index] = Symbol {
            name: name.into(),
            keyword,
            meaning,
        };
    }

    /// Returns the largest symbol plus one.
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    pub(crate) fn meaning(&self, symbol: SymbolId) -> &Meaning {
        match self.0.get(symbol.0 as usize) {
            Some(symbol) => &symbol.meaning,
            None => &Meaning::Poisoned,
        }
    }

    pub(crate) fn name(&self, symbol: SymbolId) -> &str {
        match self.0.get(symbol.0 as usize) {
            Some(symbol) => &symbol.name,
            None => "",
        }
    }

    /// Returns the keyword that declares a symbol.
    pub(crate) fn keyword(&self, symbol: SymbolId) -> Option<DeclarationKeyword> {
        self.0.get(symbol.0 as usize)?.keyword
    }

    /// Returns the name of a function's parameter.
    pub(crate) fn parameter(&self, symbol: SymbolId, position: usize) -> &str {
        match self.meaning(symbol) {
            Meaning::Declared(Declared { parameters, .. }) => named(parameters, position),
            Meaning::Solid(solid) => named(&solid.parameters, position),
            _ => "x",
        }
    }

    /// Returns the names of a function's parameters; `None` if it has no body in the text.
    fn parameters(&self, symbol: SymbolId) -> Option<&[Box<str>]> {
        match self.meaning(symbol) {
            Meaning::Declared(declared) => Some(&declared.parameters),
            Meaning::Solid(solid) => Some(&solid.parameters),
            _ => None,
        }
    }

    /// Returns the error of writing `f'` for a function of several parameters, which has a derivative by each.
    pub(crate) fn total_error(&self, symbol: SymbolId) -> Option<SemanticError> {
        let parameters = self.parameters(symbol)?;
        let count = parameters.len();
        if count == 1 {
            return None;
        }
        let name = self.name(symbol);
        let partials: Vec<String> = parameters
            .iter()
            .take(3)
            .map(|parameter| format!("`{name}_{parameter}`"))
            .collect();
        Some(
            SemanticError::new(
                error::AMBIGUOUS_DERIVATIVE,
                format!(
                    "`{name}'` does not specify by which of the {count} parameters of `{name}` to differentiate"
                ),
            )
            .with_hint(format!(
                "write a partial derivative: {}{}",
                partials.join(" or "),
                if count > 3 { ", …" } else { "" }
            )),
        )
    }
}

fn named(parameters: &[Box<str>], position: usize) -> &str {
    parameters.get(position).map_or("", |name| &**name)
}
