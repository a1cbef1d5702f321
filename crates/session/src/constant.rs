//! The number that is typed into a field: a constant expression of the default language.

use ide::Languages;
use scene::{Outcome, ParamValues, Value};

/// The words of [`value`]'s sentence behind the text.
pub const REFUSAL: &str = " is not a number: ";

/// Returns the value of a constant expression, such as `1.5` or `2pi/3`.
///
/// # Errors
/// A sentence that says why the text is not a number.
pub fn value(text: &str) -> Result<f64, String> {
    let text = text.trim().replace('−', "-");
    let plain = text.parse::<f64>().ok().filter(|value| value.is_finite());
    match plain {
        Some(value) => Ok(value),
        None => evaluated(&text).map_err(|reason| format!("`{text}`{REFUSAL}{reason}")),
    }
}

fn evaluated(text: &str) -> Result<f64, String> {
    let languages = Languages::standard();
    let compiled = languages.default_language().compile("");
    let compiled = compiled.map_err(|error| error.to_string())?;
    let scene = compiled.scene.ok_or("there is no scope")?;
    let params = ParamValues::initial(&scene);
    match compiled.scope.evaluate(text, &params) {
        Err(diagnostics) => {
            let first = diagnostics.into_iter().next();
            Err(first.map_or_else(|| "it has an error".to_owned(), |first| first.message))
        }
        Ok(evaluation) => match evaluation.outcome {
            Outcome::Single(Value::Number(Some(value))) => Ok(value),
            Outcome::Single(Value::Number(None)) => Err("its value is undefined".to_owned()),
            _ => Err("its value is not a single number".to_owned()),
        },
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};

    use super::{REFUSAL, value};

    #[test]
    fn constant_expressions_have_values() {
        for (text, wanted) in [
            ("1.5", 1.5),
            (" -2e-3 ", -2e-3),
            ("−4", -4.0),
            ("pi/2", FRAC_PI_2),
            ("2pi/3", 2.0 * PI / 3.0),
            ("sqrt 2", SQRT_2),
            ("-(1 + 2)^2", -9.0),
        ] {
            let found = value(text).expect(text);
            assert!((found - wanted).abs() < 1e-15, "{text}: {found}");
        }
    }

    #[test]
    fn what_is_no_number_says_why() {
        for text in ["", "2pi/", "x", "inf", "NaN", "1/0", "(1, 2)", "1,5"] {
            let sentence = value(text).expect_err(text);
            let begin = format!("`{text}`{REFUSAL}");
            assert!(sentence.starts_with(&begin), "{sentence}");
            assert!(sentence.len() > begin.len(), "{sentence}");
        }
    }
}
