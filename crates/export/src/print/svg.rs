//! SVG: an image, paths, and text.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use render::layers::{Layers, PlacedWords, Stroke};

/// The fonts of words: that of the program's pictures, then common ones.
const FONTS: &str = "Ubuntu, 'Helvetica Neue', Arial, sans-serif";

pub(super) fn text(layers: &Layers, title: &str) -> Result<String, String> {
    let image = &layers.below.image;
    let (width, height) = image.dimensions();
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\">\n<title>{}</title>\n",
        escaped(title)
    );
    let pixels = STANDARD.encode(super::png(image)?);
    svg.push_str(&format!(
        "<image width=\"{width}\" height=\"{height}\" href=\"data:image/png;base64,{pixels}\"/>\n"
    ));
    svg.push_str("<g fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n");
    for stroke in &layers.strokes {
        svg.push_str(&path(stroke));
    }
    svg.push_str(&format!(
        "</g>\n<g font-family=\"{FONTS}\" font-weight=\"300\" stroke-linejoin=\"round\">\n"
    ));
    for words in &layers.words {
        svg.push_str(&label(words));
    }
    svg.push_str("</g>\n</svg>\n");
    Ok(svg)
}

fn path(stroke: &Stroke) -> String {
    let mut d = String::new();
    for (k, [x, y]) in stroke.points.iter().enumerate() {
        let letter = if k == 0 { "M" } else { " L" };
        // Writing to a string does not fail.
        let _ = write!(d, "{letter}{} {}", number(*x), number(*y));
    }
    let dashes = stroke.dashes().map_or_else(String::new, |[dash, gap]| {
        let [dash, gap] = [dash, gap].map(number);
        format!(" stroke-dasharray=\"{dash} {gap}\" stroke-linecap=\"butt\"")
    });
    format!(
        "<path d=\"{d}\" stroke=\"{}\" stroke-width=\"{}\"{dashes}/>\n",
        colour(stroke.colour),
        number(stroke.width)
    )
}

/// Returns the words, with the outlines of all of them underneath: a browser that spaces letters draws them one by one,
/// and each outline would cover the previous letter.
fn label(words: &PlacedWords) -> String {
    let [x, y] = words.baseline;
    let opacity = if words.opacity < 1.0 {
        format!(" opacity=\"{}\"", number(words.opacity))
    } else {
        String::new()
    };
    let text = |paint: &str| {
        format!(
            "<text x=\"{}\" y=\"{}\" font-size=\"{}\" textLength=\"{}\" {paint}{opacity}>{}</text>\n",
            number(x),
            number(y),
            number(words.size),
            number(words.width),
            escaped(&words.words)
        )
    };
    let rim = format!(
        "fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" aria-hidden=\"true\"",
        colour(words.rim),
        number(2.0 * words.rim_width)
    );
    text(&rim) + &text(&format!("fill=\"{}\"", colour(words.colour)))
}

/// Formats a number with as many digits as are visible.
fn number(x: f32) -> String {
    let text = format!("{x:.2}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

fn colour([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Escapes a text as the content of an element.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            // XML cannot represent other control characters.
            _ if letter.is_control() => escaped.push(' '),
            _ => escaped.push(letter),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::{escaped, number};

    #[test]
    fn numbers_are_short() {
        assert_eq!(number(1.0), "1");
        assert_eq!(number(-0.126), "-0.13");
        assert_eq!(number(200.0), "200");
    }

    #[test]
    fn a_text_cannot_leave_its_element() {
        assert_eq!(escaped("a<b & c>\u{1}π"), "a&lt;b &amp; c&gt; π");
    }
}
