//! Semantic tokens in the protocol's encoding, and the differences between two lists of them.

use ide::semantic::TokenType;
use syntax::span::Span;

use crate::documents::{Places, Snapshot};
use crate::encoding::Place;

/// One token relative to the one before: lines further, columns further (from the line's start on a new line), length,
/// type, modifiers.
pub(crate) type Encoded = [u32; 5];

/// Returns the tokens that touch a range, encoded.
pub(crate) fn encode(snapshot: &Snapshot, range: Option<[Place; 2]>) -> Vec<Encoded> {
    let span = match range {
        None => Span::new(0, snapshot.text().len()),
        Some(range) => {
            let [start, end] = range.map(|place| snapshot.offset(place));
            Span::new(start.min(end), start.max(end))
        }
    };
    let tokens = snapshot.analysis().semantic_tokens(span);
    let (Some(first), Some(last)) = (tokens.first(), tokens.last()) else {
        return Vec::new();
    };
    let first = first.span.start;
    let text = snapshot
        .text()
        .slice(Span::new(first, last.span.end))
        .unwrap_or_default();
    let piece = |start: u32, end: u32| &text[(start - first) as usize..(end - first) as usize];
    let mut before = Place::default();
    // Tokens are in order: the text between two is counted once.
    let [mut place, _] = snapshot.range(Span::new(first, first));
    let mut counted = first;
    let encoded = tokens.iter().map(|token| {
        let between = piece(counted, token.span.start);
        if between.contains(['\n', '\r']) {
            [place, _] = snapshot.range(token.span);
        } else {
            place.column += snapshot.encoding.length(between);
        }
        counted = token.span.start;
        let line = place.line - before.line;
        let column = match line {
            0 => place.column - before.column,
            _ => place.column,
        };
        before = place;
        let length = snapshot
            .encoding
            .length(piece(token.span.start, token.span.end));
        [
            line,
            column,
            length,
            index(token.token_type),
            token.modifiers.0,
        ]
    });
    encoded.collect()
}

fn index(token_type: TokenType) -> u32 {
    let position = TokenType::ALL.iter().position(|other| *other == token_type);
    position.unwrap_or_default() as u32
}

/// Returns one replacement that turns a list into another: its start, the number of tokens that it removes, and those
/// that it inserts. `None` if the lists are equal.
pub(crate) fn difference(old: &[Encoded], new: &[Encoded]) -> Option<(usize, usize, Vec<Encoded>)> {
    let prefix = old.iter().zip(new).take_while(|(a, b)| a == b).count();
    if prefix == old.len() && prefix == new.len() {
        return None;
    }
    let (old_rest, new_rest) = (&old[prefix..], &new[prefix..]);
    let pairs = old_rest.iter().rev().zip(new_rest.iter().rev());
    let suffix = pairs.take_while(|(a, b)| a == b).count();
    Some((
        prefix,
        old_rest.len() - suffix,
        new_rest[..new_rest.len() - suffix].to_vec(),
    ))
}

#[cfg(test)]
mod tests {
    use super::{Encoded, difference};

    #[test]
    fn a_difference_applied_to_the_old_list_gives_the_new() {
        let mut seed = 7_u64;
        let mut random = |limit: u64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) % limit
        };
        for _ in 0..2000 {
            let mut list = |count: u64| -> Vec<Encoded> {
                (0..count).map(|_| [random(2) as u32, 1, 2, 3, 4]).collect()
            };
            let (old, new) = (list(6), list(5));
            let mut result = old.clone();
            if let Some((start, gone, come)) = difference(&old, &new) {
                result.splice(start..start + gone, come);
            }
            assert_eq!(result, new);
        }
    }
}
