//! Numbers in the arguments and in texts for people.

pub(crate) use expr::number::{grouped, rounded};

/// Parses a finite number of the command line.
pub(crate) fn parse(text: &str) -> Result<f64, String> {
    let text = text.trim();
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        // Rust also parses `inf`, `nan` and values that overflow.
        Ok(_) if text.contains(|c: char| c.is_ascii_digit()) => {
            Err(format!("{text} is too large a number"))
        }
        _ if text.is_empty() => Err("a number is missing".into()),
        _ => Err(format!("`{text}` is not a number")),
    }
}

/// Formats a number as the shortest text that parses to the same number, with an exponent if it is very large or very
/// small. NaN becomes `undefined`, and zero has no sign.
pub(crate) fn show(value: f64) -> String {
    let magnitude = value.abs();
    let value = if value == 0.0 { 0.0 } else { value };
    if value.is_nan() {
        "undefined".into()
    } else if value.is_infinite() {
        if value > 0.0 { "∞" } else { "-∞" }.into()
    } else if magnitude != 0.0 && !(1e-5..1e16).contains(&magnitude) {
        format!("{value:e}")
    } else {
        format!("{value}")
    }
}

/// Formats a measured number like [`show`], but with at most twelve significant digits, the accuracy of measuring.
pub(crate) fn show_measured(value: f64) -> String {
    show(rounded(value, 12))
}

/// The relative error estimate from which a number is vague.
const VAGUE: f64 = 0.01;

/// Returns whether the error estimate of a number leaves it at most two digits.
pub(crate) fn is_vague(value: f64, estimate: f64) -> bool {
    estimate > VAGUE * value.abs()
}

/// Formats a measured number like [`show_measured`]; a vague one only with the digits that its error estimate leaves.
pub(crate) fn show_estimated(value: f64, estimate: f64) -> String {
    if !is_vague(value, estimate) || value == 0.0 || !value.is_finite() {
        return show_measured(value);
    }
    let digits = if estimate < value.abs() { 2 } else { 1 };
    show(rounded(value, digits))
}

/// Formats one number, or several as a tuple.
pub(crate) fn show_all(values: &[f64]) -> String {
    match values {
        [value] => show(*value),
        _ => {
            let shown: Vec<String> = values.iter().map(|value| show(*value)).collect();
            format!("({})", shown.join(", "))
        }
    }
}

/// Formats a count with its noun, in the plural if needed: `1 error`, `2 errors`.
pub(crate) fn count(number: usize, noun: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{} {noun}{plural}", grouped(number as u64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_they_are_written() {
        for (text, value) in [
            ("1", 1.0),
            ("-.5", -0.5),
            ("1.", 1.0),
            (" 3e-4", 3e-4),
            ("+2", 2.0),
        ] {
            assert_eq!(parse(text), Ok(value), "{text}");
        }
    }

    #[test]
    fn what_is_no_finite_number_is_refused() {
        for text in [
            "", "x", "nan", "inf", "-inf", "infinity", "1e999", "1,2", "0x10",
        ] {
            assert!(parse(text).is_err(), "{text}");
        }
        assert_eq!(parse("1e999"), Err("1e999 is too large a number".into()));
    }

    #[test]
    fn shown_numbers_read_back_as_themselves() {
        for value in [0.1, 1e300, 5e-324, std::f64::consts::PI, 123456789.0, 1e16] {
            let shown = show(value);
            assert_eq!(
                shown.parse::<f64>().map(f64::to_bits),
                Ok(value.to_bits()),
                "{shown}"
            );
        }
        assert_eq!(show_measured(0.999_999_999_999_999_9), "1");
        assert_eq!(show_measured(f64::NAN), "undefined");
        assert_eq!(show_estimated(14726.055, 12e3), "15000");
        assert_eq!(show_estimated(14726.055, 15e3), "10000");
        assert_eq!(show_estimated(14726.055, 1.0), "14726.055");
        assert_eq!(show(-0.0), "0");
        assert_eq!(show(f64::NAN), "undefined");
        assert_eq!(show_all(&[1.0, 0.5]), "(1, 0.5)");
    }

    #[test]
    fn counts_have_plurals_and_groups() {
        assert_eq!(count(1, "error"), "1 error");
        assert_eq!(count(0, "error"), "0 errors");
    }
}
