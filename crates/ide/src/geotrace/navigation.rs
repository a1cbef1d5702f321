//! Navigation from a use to its declaration, and back to all uses.

use syntax::span::Span;

use super::analysis::GeotraceAnalysis;
use crate::occurrence::Occurrence;

/// Returns the span of the name at an offset, and the span that introduces it; `None` for builtins and for anything but
/// a name.
pub fn definition(analysis: &GeotraceAnalysis, offset: u32) -> Option<(Span, Span)> {
    let token = analysis.token_at(offset)?;
    let place = analysis.introduction(analysis.target(token)?)?;
    Some((analysis.token(token)?.span, place))
}

/// Returns every occurrence of the name at an offset, in the order of the text; builtins have occurrences too.
pub fn occurrences(analysis: &GeotraceAnalysis, offset: u32) -> Vec<Occurrence> {
    let target = analysis.token_at(offset).and_then(|k| analysis.target(k));
    let Some(target) = target else {
        return Vec::new();
    };
    let introduction = analysis.introduction(target);
    let tokens = analysis.occurrences(target).into_iter();
    tokens
        .filter_map(|k| {
            let span = analysis.token(k)?.span;
            Some(Occurrence {
                span,
                introduces: introduction == Some(span),
            })
        })
        .collect()
}
