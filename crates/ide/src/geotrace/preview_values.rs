//! The values of params and defines in a preview, shown after their declarations.

use std::collections::BTreeMap;

use scene::{Outcome, ParamValues};
use syntax::geotrace::declarations::{Category, DeclarationKeyword};
use syntax::span::Span;

use super::analysis::GeotraceAnalysis;
use super::hints::{short, shown};
use super::item::Item;
use crate::hint::Hint;

/// Returns hints such as `= 0.25` after each param in a range that has a value, and after each define that depends on one;
/// `values` are by name, one number per component.
pub(super) fn preview_values(
    analysis: &GeotraceAnalysis,
    range: Span,
    values: &BTreeMap<String, Vec<f64>>,
) -> Vec<Hint> {
    let mut hints = params(analysis, range, values);
    hints.extend(defines(analysis, range, values));
    hints.sort_by_key(|hint| hint.offset);
    hints
}

fn defines(
    analysis: &GeotraceAnalysis,
    range: Span,
    values: &BTreeMap<String, Vec<f64>>,
) -> Vec<Hint> {
    let is_wanted = |item: &Item<'_>| {
        item.keyword == DeclarationKeyword::Define
            && !item.faulty
            && item
                .symbol
                .is_some_and(|symbol| analysis.depends_on_settings(symbol))
    };
    let wanted: Vec<Item<'_>> = analysis.items_in(range).filter(is_wanted).collect();
    if wanted.is_empty() {
        return Vec::new();
    }
    let excerpt = analysis.excerpt(wanted.iter().map(|item| item.index));
    let mut params = ParamValues::initial(excerpt.scene());
    for (name, value) in values {
        // Params that the defines do not read are absent.
        let _ = params.set(excerpt.scene(), name, value);
    }
    let hints = wanted.into_iter().filter_map(|item| {
        let Outcome::Single(value) = excerpt.value(item.name, &params)? else {
            return None;
        };
        Some(Hint {
            offset: item.span.end.saturating_sub(1),
            label: format!("= {}", shown(&value)),
            tooltip: format!("the value of `{}` in the preview", item.name),
            apart: true,
        })
    });
    hints.collect()
}

fn params(
    analysis: &GeotraceAnalysis,
    range: Span,
    values: &BTreeMap<String, Vec<f64>>,
) -> Vec<Hint> {
    analysis
        .items_in(range)
        .filter(|item| item.keyword.category() == Category::Slider)
        .filter_map(|item| {
            let value = values.get(item.name)?;
            let numbers: Vec<String> = value.iter().map(|x| short(*x)).collect();
            let label = match &numbers[..] {
                [] => return None,
                [number] => format!("= {number}"),
                numbers => format!("= ({})", numbers.join(", ")),
            };
            Some(Hint {
                offset: item.span.end.saturating_sub(1),
                label,
                tooltip: format!("the value of `{}` in the preview", item.name),
                apart: true,
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::preview_values;
    use crate::geotrace::GeotraceAnalysis;
    use syntax::span::Span;

    #[test]
    fn the_values_of_params_stand_behind_their_declarations() {
        let text = "param a : [0, 1];\nparam p : [0, 1], [0, 2];\ndefine b = 1;\nparam c : [0, 1];";
        let values = [
            ("a".to_owned(), vec![1.0 / 3.0]),
            ("p".to_owned(), vec![0.5, 2.0]),
            ("b".to_owned(), vec![9.0]),
            ("gone".to_owned(), vec![9.0]),
        ];
        let analysis = GeotraceAnalysis::new(text);
        let shown = |range: Span| -> Vec<(String, String)> {
            let hints = preview_values(&analysis, range, &values.clone().into());
            let hints = hints.into_iter();
            hints
                .map(|hint| (text[..hint.offset as usize].to_owned(), hint.label))
                .collect()
        };
        let one = ("param a : [0, 1]".to_owned(), "= 0.33333".to_owned());
        let other = (
            "param a : [0, 1];\nparam p : [0, 1], [0, 2]".to_owned(),
            "= (0.5, 2)".to_owned(),
        );
        assert_eq!(shown(Span::new(0, 99)), [one, other.clone()]);
        assert_eq!(shown(Span::new(20, 21)), [other]);
    }

    #[test]
    fn the_values_of_defines_follow_those_of_params() {
        let text = "param a : [0, 1];\ndefine b = (2a, 1);\ndefine c = 5;\ndefine d = (b)_1 + a;";
        let values = [("a".to_owned(), vec![0.25])];
        let hints = preview_values(
            &GeotraceAnalysis::new(text),
            Span::new(18, 99),
            &values.into(),
        );
        let labels: Vec<&str> = hints.iter().map(|hint| hint.label.as_str()).collect();
        assert_eq!(labels, ["= (0.5, 1)", "= 0.75"]);
    }
}
