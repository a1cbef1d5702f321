//! What stands under the cursor.

use syntax::geotrace::token::TokenKind;
use syntax::span::Span;

use crate::describe::{self, Description};
use crate::reading::Reading;

/// What there is to say of the word at a place, and where the word stands.
pub fn hover(reading: &Reading, offset: u32) -> Option<(Span, Description)> {
    let k = reading.token_at(offset)?;
    let token = reading.token(k)?;
    if let TokenKind::Declare(word) = token.kind {
        let description = Description {
            code: crate::completion::form(word).to_owned(),
            text: vec![crate::completion::purpose(word).to_owned()],
        };
        return Some((token.span, description));
    }
    let description = describe::describe(reading, reading.target(k)?)?;
    Some((token.span, description))
}
