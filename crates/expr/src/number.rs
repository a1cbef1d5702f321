//! Numbers as text: for people, and for WGSL.

/// Returns the shortest decimal text that reads back as this f64: `0.1`, `2`, `1e300`, `6.283185307179586`; `undefined`
/// for NaN, `infinity` or `-infinity`.
pub fn text(value: f64) -> String {
    if value.is_nan() {
        return "undefined".to_owned();
    }
    if value.is_infinite() {
        return if value > 0.0 { "infinity" } else { "-infinity" }.to_owned();
    }
    let text = format!("{value:?}");
    match text.strip_suffix(".0") {
        Some(integer) => integer.to_owned(),
        None => text,
    }
}

/// Returns a number rounded to this many significant digits, at least one.
///
/// ```
/// assert_eq!(expr::number::rounded(2.0 / 3.0, 3), 0.667);
/// assert_eq!(expr::number::rounded(123_456.0, 2), 120_000.0);
/// ```
pub fn rounded(value: f64, digits: usize) -> f64 {
    let decimals = digits.saturating_sub(1);
    format!("{value:.decimals$e}").parse().unwrap_or(value)
}

/// A whole number with its digits in groups of three.
///
/// ```
/// assert_eq!(expr::number::grouped(1_234_567), "1,234,567");
/// assert_eq!(expr::number::grouped(999), "999");
/// ```
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (position, digit) in digits.chars().enumerate() {
        if position > 0 && (digits.len() - position).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// The number has no WGSL literal, since it is not finite in f32.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum LiteralError {
    /// The number is NaN.
    Undefined,
    /// The number is, or rounds to, plus infinity in f32: about 3.4028236e38 and more.
    Infinite,
    /// The number is, or rounds to, minus infinity in f32.
    MinusInfinite,
}

/// Returns a WGSL literal for this number rounded to f32: the shortest decimal text that reads back as that f32, always
/// with a point or an exponent: `1.0`, `6.2831855`, `1e-7`. A negative number has its sign before the literal.
///
/// # Errors
/// If the number is not finite in f32.
pub fn wgsl_literal(value: f64) -> Result<String, LiteralError> {
    let value = value as f32;
    if value.is_nan() {
        return Err(LiteralError::Undefined);
    }
    if value.is_infinite() {
        return Err(if value > 0.0 {
            LiteralError::Infinite
        } else {
            LiteralError::MinusInfinite
        });
    }
    Ok(format!("{value:?}"))
}

impl std::fmt::Display for LiteralError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Undefined => "an undefined number has no WGSL literal",
            Self::Infinite => "a number beyond the range of f32 has no WGSL literal",
            Self::MinusInfinite => "a number below the range of f32 has no WGSL literal",
        })
    }
}

impl std::error::Error for LiteralError {}
