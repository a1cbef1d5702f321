//! From a use to its declaration, and back to all uses.

use syntax::span::Span;
use syntax::symbol::SymbolId;

use crate::reading::{Reading, Target};

/// Where a name is used, and how.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Occurrence {
    /// Where.
    pub span: Span,
    /// Whether it is introduced there.
    pub introduces: bool,
}

/// The name at a place, and where it is introduced; none for builtins and for what is no name.
pub fn definition(reading: &Reading, offset: u32) -> Option<(Span, Span)> {
    let token = reading.token_at(offset)?;
    let place = match reading.target(token)? {
        Target::Symbol(id) => reading.place(id)?,
        Target::Parameter { item, position } => reading.item(item)?.parameters().nth(position)?.1,
    };
    Some((reading.token(token)?.span, place))
}

/// Every occurrence of the name at a place, in the order of the text; builtins have occurrences too.
pub fn occurrences(reading: &Reading, offset: u32) -> Vec<Occurrence> {
    let target = reading.token_at(offset).and_then(|k| reading.target(k));
    let Some(target) = target else {
        return Vec::new();
    };
    let tokens = reading.occurrences(target).into_iter();
    tokens
        .filter_map(|k| {
            Some(Occurrence {
                span: reading.token(k)?.span,
                introduces: reading.introduces(k),
            })
        })
        .collect()
}

/// The object that is declared at or used at a place: what a view should show.
pub fn object_at(reading: &Reading, offset: u32) -> Option<SymbolId> {
    let used = reading.token_at(offset).and_then(|k| reading.target(k));
    match used {
        Some(Target::Symbol(id)) if reading.item_of(id).is_some() => Some(id),
        _ => reading.item_at(offset)?.symbol,
    }
}
