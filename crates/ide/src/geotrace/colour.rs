//! Colours stated as numbers: after `color :`, and of a background.
//!
//! A colour that refers to a name is not a constant, and one outside 0…1 (of a light) is outside the range of a picker.

use syntax::geotrace::declarations::DeclarationKeyword;
use syntax::geotrace::token::TokenKind;
use syntax::span::Span;

use super::analysis::{GeotraceAnalysis, Lexeme};
use crate::colour::{EditColourError, WrittenColour};
use crate::edit::Edit;

/// The maximum number of tokens of a colour: three numbers, two commas, two brackets.
const LONGEST: usize = 7;

/// Returns the constant colours, in the order of the text.
pub fn colours(analysis: &GeotraceAnalysis) -> Vec<WrittenColour> {
    let all = analysis.tokens(0..analysis.token_count());
    let mut tokens = all
        .filter(|token| token.kind != TokenKind::Comment)
        .peekable();
    let mut found = Vec::new();
    let mut value: Vec<Lexeme<'_>> = Vec::with_capacity(LONGEST + 1);
    let mut opening = Opening::default();
    while let Some(token) = tokens.next() {
        if !opening.pass(&token) {
            continue;
        }
        value.clear();
        let mut depth = 0;
        let mut is_part = |kind| {
            depth += i32::from(opens(kind)) - i32::from(closes(kind));
            depth > 0 || closes(kind) || matches!(kind, TokenKind::Number(_))
        };
        while value.len() <= LONGEST
            && let Some(next) = tokens.next_if(|next| is_part(next.kind))
        {
            value.push(next);
        }
        let ends = tokens
            .peek()
            .is_some_and(|next| matches!(next.kind, TokenKind::Comma | TokenKind::Semicolon));
        if ends && let Some(rgb) = colour(&value) {
            let span = value.iter().map(|token| token.span).reduce(Span::to);
            // Replacing the colour would remove a comment.
            let has_comment = |span: &Span| {
                let mut within = analysis.tokens(analysis.tokens_in(*span));
                within.any(|token| token.kind == TokenKind::Comment)
            };
            let span = span.filter(|span| !has_comment(span));
            found.extend(span.map(|span| WrittenColour { span, rgb }));
        }
    }
    found
}

/// Returns the edit that changes the colour of an object that states it as numbers: red, green and blue, sRGB, 0…1.
///
/// # Errors
/// [`EditColourError::NotStated`].
pub fn edit_colour(
    analysis: &GeotraceAnalysis,
    object: &str,
    colour: [f64; 3],
) -> Result<Edit, EditColourError> {
    let item = analysis.declared(object);
    let within = |stated: &&WrittenColour| {
        item.as_ref().is_some_and(|item| {
            item.span.start <= stated.span.start && stated.span.end <= item.span.end
        })
    };
    let colours = colours(analysis);
    let stated = colours.iter().find(within);
    let stated = stated.ok_or_else(|| EditColourError::NotStated {
        name: object.to_owned(),
    })?;
    let text = colour_texts(colour).swap_remove(0);
    Ok(Edit::replace(stated.span, text))
}

/// Returns the texts that denote a colour: three numbers, and also a single one if they are equal.
pub fn colour_texts(rgb: [f64; 3]) -> Vec<String> {
    let [red, green, blue] = rgb.map(channel);
    let mut texts = vec![format!("({red}, {green}, {blue})")];
    if red == green && green == blue {
        texts.push(red);
    }
    texts
}

/// Returns a component of a colour, to a thousandth.
fn channel(x: f64) -> String {
    let share = if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) };
    let text = format!("{share:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The tokens before a colour.
#[derive(Default)]
struct Opening<'r> {
    /// The last three tokens, in the order of the text.
    last: [Option<Lexeme<'r>>; 3],
}

impl<'r> Opening<'r> {
    /// Adds the next token; returns true if a colour is expected after it.
    fn pass(&mut self, token: &Lexeme<'r>) -> bool {
        let [_, first, second] = self.last;
        self.last = [first, second, Some(*token)];
        let (Some(first), Some(second)) = (first, second) else {
            return false;
        };
        match token.kind {
            TokenKind::Colon => {
                // A parameter may have this name.
                first.kind == TokenKind::Comma
                    && second.text == "color"
                    && !matches!(second.kind, TokenKind::Variable(_))
            }
            TokenKind::Equals => first.kind == TokenKind::Declare(DeclarationKeyword::Background),
            _ => false,
        }
    }
}

fn opens(kind: TokenKind) -> bool {
    matches!(
        kind,
        TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen
    )
}

fn closes(kind: TokenKind) -> bool {
    matches!(
        kind,
        TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose
    )
}

/// Returns the colour denoted by some tokens: `0.5`, `(1, 0.5, 0)`.
fn colour(value: &[Lexeme<'_>]) -> Option<[f64; 3]> {
    let number = |token: &Lexeme<'_>| match token.kind {
        TokenKind::Number(x) => Some(x),
        _ => None,
    };
    let rgb = match value {
        [grey] => [number(grey)?; 3],
        [open, red, first, green, second, blue, close]
            if opens(open.kind)
                && closes(close.kind)
                && [first.kind, second.kind] == [TokenKind::Comma; 2] =>
        {
            [number(red)?, number(green)?, number(blue)?]
        }
        _ => return None,
    };
    rgb.iter().all(|x| (0.0..=1.0).contains(x)).then_some(rgb)
}

#[cfg(test)]
mod tests {
    use super::colour_texts;

    #[test]
    fn a_colour_is_written_to_a_thousandth() {
        assert_eq!(colour_texts([0.2, 1.0, 0.0]), ["(0.2, 1, 0)"]);
        assert_eq!(
            colour_texts([1.0 / 3.0; 3]),
            ["(0.333, 0.333, 0.333)", "0.333"]
        );
        assert_eq!(colour_texts([f64::NAN, 2.0, -1.0]), ["(0, 1, 0)"]);
    }
}
