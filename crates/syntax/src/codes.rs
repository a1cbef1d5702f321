//! The codes of the diagnostics for texts of any language, with their explanations.

use crate::diagnostic::Code;

/// Defines codes and their table, `CODES`.
macro_rules! codes {
    ($($constant:ident = $name:literal, $explanation:literal;)*) => {
        $(#[doc = $explanation] pub const $constant: Code = Code($name);)*

        /// Every code of this module with one sentence that explains it, for documentation.
        pub const CODES: &[(Code, &str)] = &[$(($constant, $explanation)),*];
    };
}
pub(crate) use codes;

codes! {
    FILE_TOO_LARGE = "file-too-large", "A text is limited to 4 GiB, and a program that is read from a file to 64 MB.";
    INVALID_UTF8 = "invalid-utf8", "A text is UTF-8; some bytes of this one are not.";
    TOO_MANY_ERRORS = "too-many-errors", "The limit of diagnostics is reached; further ones are left out.";
}
