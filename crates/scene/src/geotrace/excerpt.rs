//! Some declarations of a text and everything that they use, compiled separately: in time proportional to these, and
//! regardless of errors in the rest of the text.

use std::collections::BTreeSet;

use syntax::geotrace::document::Snapshot;

use crate::evaluation::Outcome;
use crate::geotrace::assembler::{Assembler, NamePlace, Reading};
use crate::geotrace::declarations::Declarations;
use crate::geotrace::evaluate::outcome;
use crate::geotrace::symbol::Meaning;
use crate::param_values::ParamValues;
use crate::scene::Scene;

/// The scene of some declarations, and the values of their names.
#[derive(Debug)]
pub struct Excerpt {
    scene: Scene,
    declarations: Declarations,
    names: Vec<(String, Meaning)>,
}

impl Excerpt {
    /// Compiles the declarations with these numbers, from 0, and everything that they use. Declarations with errors are
    /// omitted, and so are the ones that use them.
    pub fn new(snapshot: &Snapshot, declarations: impl IntoIterator<Item = u32>) -> Self {
        let wanted: Vec<u32> = declarations.into_iter().collect();
        let mut needed: BTreeSet<u32> = BTreeSet::new();
        let mut open = wanted.clone();
        while let Some(number) = open.pop() {
            if let Some(reading) = reading(snapshot, number)
                && needed.insert(number)
            {
                let used = reading.symbols();
                open.extend(used.filter_map(|symbol| snapshot.declaration_of(symbol)));
            }
        }
        let mut assembler = Assembler::new();
        for reading in needed.iter().filter_map(|it| reading(snapshot, *it)) {
            assembler.add(reading, NamePlace::Chunk(0));
        }
        let named = wanted.iter().filter_map(|number| {
            let name = reading(snapshot, *number)?.declaration.name;
            let symbol = assembler.symbol(name)?;
            let symbols = &assembler.declarations.lowerer.symbols;
            Some((name.to_owned(), symbols.meaning(symbol).clone()))
        });
        Self {
            names: named.collect(),
            scene: assembler.declarations.scene(),
            declarations: assembler.declarations,
        }
    }

    /// Returns the scene. Spans in it have no meaning.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Returns the value of one of the requested declarations; `None` if it has errors, is a function, or has too many
    /// values. `values` are those of [`Excerpt::scene`].
    pub fn value(&self, name: &str, values: &ParamValues) -> Option<Outcome> {
        let (_, meaning) = self.names.iter().find(|(named, _)| named == name)?;
        match meaning {
            Meaning::Constant(constant) => {
                let (value, dependencies) = (&constant.value, constant.dependencies);
                let found = outcome(&self.declarations, value, dependencies, values);
                found.ok().map(|(outcome, _)| outcome)
            }
            _ => None,
        }
    }
}

/// Returns a declaration by number.
fn reading(snapshot: &Snapshot, number: u32) -> Option<Reading<'_>> {
    let (placed, index) = snapshot.placed_chunk_of_declaration(number)?;
    let (declaration, events) = placed.declarations().nth(index)?;
    Some(Reading {
        snapshot,
        declaration,
        events,
    })
}
