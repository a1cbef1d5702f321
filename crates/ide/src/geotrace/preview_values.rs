//! The values that the params have in a preview, shown behind their declarations.

use std::collections::BTreeMap;

use syntax::geotrace::declarations::Category;
use syntax::span::Span;

use super::analysis::GeotraceAnalysis;
use super::hints::short;
use crate::hint::Hint;

/// `= 0.25` behind each param in a range that has a value; `values` are by name, one number per component.
pub fn preview_values(
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
}
