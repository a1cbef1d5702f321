//! Inlay hints, which an editor shows within the text: how words are split, and the values of constants.

use scene::geotrace::Excerpt;
use scene::{Outcome, ParamValues, Value};
use syntax::geotrace::declarations::DeclarationKeyword;
use syntax::geotrace::token::TokenKind;
use syntax::span::Span;

use super::analysis::GeotraceAnalysis;
use super::item::Item;
use crate::hint::Hint;

/// Returns the hints in a range, in the order of the text.
pub fn hints(analysis: &GeotraceAnalysis, range: Span) -> Vec<Hint> {
    let mut hints = splits(analysis, range);
    hints.extend(values(analysis, range));
    hints.sort_by_key(|hint| hint.offset);
    hints
}

/// Returns hints such as `pi·v`, between the tokens into which a word was split.
fn splits(analysis: &GeotraceAnalysis, range: Span) -> Vec<Hint> {
    let tokens: Vec<_> = analysis.tokens(analysis.tokens_in(range)).collect();
    let is_word = |kind| {
        matches!(
            kind,
            TokenKind::Constant(_)
                | TokenKind::Function(_)
                | TokenKind::Variable(_)
                | TokenKind::Undefined
        )
    };
    let pairs = tokens.windows(2).enumerate().filter(|(_, pair)| {
        is_word(pair[0].kind) && is_word(pair[1].kind) && pair[0].span.end == pair[1].span.start
    });
    let before = analysis
        .tokens_before(analysis.tokens_in(range).start)
        .next();
    let is_derivative = |k: usize| {
        let before = k.checked_sub(1).map_or(before, |k| Some(tokens[k]));
        before.is_some_and(|token| token.kind == TokenKind::Underscore)
    };
    pairs
        .map(|(k, pair)| {
            let (one, other) = (pair[0].text, pair[1].text);
            let applied = matches!(pair[0].kind, TokenKind::Function(_)) || is_derivative(k);
            let (label, told) = if applied {
                (" ", "applied to")
            } else {
                ("·", "times")
            };
            Hint {
                offset: pair[1].span.start,
                label: label.to_owned(),
                tooltip: format!("read as `{one}` {told} `{other}`"),
                apart: false,
            }
        })
        .collect()
}

/// Returns hints such as `= 6.2832` after defines that no param or grid changes.
fn values(analysis: &GeotraceAnalysis, range: Span) -> Vec<Hint> {
    let is_wanted = |item: &Item<'_>| {
        item.keyword == DeclarationKeyword::Define
            && !item.faulty
            && !is_literal(analysis, item.span)
            && item
                .symbol
                .is_some_and(|symbol| !analysis.depends_on_settings(symbol))
    };
    let wanted: Vec<Item<'_>> = analysis.items_in(range).filter(is_wanted).collect();
    let excerpt = analysis.excerpt(wanted.iter().map(|item| item.index));
    wanted
        .into_iter()
        .filter_map(|item| {
            let value = constant(&excerpt, item.name)?;
            Some(Hint {
                offset: item.span.end.saturating_sub(1),
                label: format!("= {value}"),
                tooltip: format!("the value of `{}`", item.name),
                apart: true,
            })
        })
        .collect()
}

/// Returns true if a define is a literal: `define a = 2;`.
fn is_literal(analysis: &GeotraceAnalysis, span: Span) -> bool {
    let body = analysis
        .tokens(analysis.tokens_in(span))
        .skip_while(|t| t.kind != TokenKind::Equals)
        .skip(1);
    let mut words = body.filter(|t| !matches!(t.kind, TokenKind::Semicolon | TokenKind::Comment));
    words.all(|t| matches!(t.kind, TokenKind::Number(_) | TokenKind::Minus))
}

/// Returns the value of a name that does not depend on grids, as text; params are at their start.
pub(crate) fn constant(excerpt: &Excerpt, name: &str) -> Option<String> {
    let values = ParamValues::initial(excerpt.scene());
    match excerpt.value(name, &values)? {
        Outcome::Single(value) => Some(shown(&value)),
        Outcome::Instances(_) => None,
    }
}

/// Returns a value as text, to five digits.
pub(crate) fn shown(value: &Value) -> String {
    let number = |x: &Option<f64>| match x {
        Some(x) => short(*x),
        None => "undefined".to_owned(),
    };
    match value {
        Value::Number(x) => number(x),
        Value::Text(text) => text.clone(),
        Value::Vector(components) => {
            let components: Vec<String> = components.iter().map(number).collect();
            format!("({})", components.join(", "))
        }
    }
}

/// Returns a number to five significant digits.
pub(crate) fn short(x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    let magnitude = x.abs().log10().floor();
    if !(-4.0..7.0).contains(&magnitude) {
        return format!("{x:.4e}");
    }
    let decimals = (4.0 - magnitude).max(0.0) as usize;
    let text = format!("{x:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn numbers_are_shown_to_five_digits() {
        for (x, text) in [
            (std::f64::consts::TAU, "6.2832"),
            (-0.5, "-0.5"),
            (123_456.0, "123456"),
            (1e-7, "1.0000e-7"),
            (100.0, "100"),
            (0.001_234_56, "0.0012346"),
        ] {
            assert_eq!(short(x), text);
        }
    }
}
