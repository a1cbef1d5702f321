//! Parsers of the appearance of objects: colours, images, and optional parts of a view.

use std::path::PathBuf;

/// `OBJECT=IMAGE`: an image file for a surface, a solid or a background.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TextureFile {
    /// The object's name.
    pub(crate) object: String,
    /// The image.
    pub(crate) path: PathBuf,
}

/// `NAME=#RRGGBB`: a colour for an object.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ObjectColour {
    /// The object's name.
    pub(crate) object: String,
    /// The colour, sRGB.
    pub(crate) colour: [u8; 3],
}

/// Parses a colour: sRGB with straight (not premultiplied) alpha.
pub(crate) fn colour(text: &str) -> Result<[u8; 4], String> {
    let named = [
        ("transparent", [0, 0, 0, 0]),
        ("white", [255; 4]),
        ("black", [0, 0, 0, 255]),
    ];
    if let Some((_, colour)) = named.iter().find(|(name, _)| *name == text) {
        return Ok(*colour);
    }
    let digits = text.strip_prefix('#').unwrap_or(text);
    let expected =
        "expected transparent, white, black, or a colour such as #fff, #1a2b3c or #1a2b3c80";
    let values: Option<Vec<u8>> = digits
        .chars()
        .map(|digit| digit.to_digit(16).map(|value| value as u8))
        .collect();
    match values.as_deref() {
        Some(&[r, g, b]) => Ok([17 * r, 17 * g, 17 * b, 255]),
        Some(&[a, b, c, d, e, f]) => Ok([16 * a + b, 16 * c + d, 16 * e + f, 255]),
        Some(&[a, b, c, d, e, f, g, h]) => Ok([16 * a + b, 16 * c + d, 16 * e + f, 16 * g + h]),
        _ => Err(expected.into()),
    }
}

/// Parses `NAME=COLOUR`.
pub(crate) fn object_colour(text: &str) -> Result<ObjectColour, String> {
    let expected = "expected NAME=COLOUR, such as c=#1a2b3c, c=#fff or c=white";
    let (object, text) = text.split_once('=').ok_or(expected)?;
    match colour(text.trim()).map_err(|_| expected)? {
        [r, g, b, 255] if !object.trim().is_empty() => Ok(ObjectColour {
            object: object.trim().into(),
            colour: [r, g, b],
        }),
        _ => Err(expected.into()),
    }
}

/// Parses `NAME=on` or `NAME=off`.
pub(crate) fn setting(text: &str) -> Result<(String, bool), String> {
    match text.split_once('=') {
        Some((name, "on")) => Ok((name.trim().into(), true)),
        Some((name, "off")) => Ok((name.trim().into(), false)),
        _ => Err("expected NAME=on or NAME=off, such as centre=off".into()),
    }
}

/// Parses `OBJECT=IMAGE`.
pub(crate) fn texture(text: &str) -> Result<TextureFile, String> {
    match text.split_once('=') {
        Some((object, path)) if !object.trim().is_empty() && !path.is_empty() => Ok(TextureFile {
            object: object.trim().into(),
            path: path.into(),
        }),
        _ => Err("expected OBJECT=IMAGE, such as s=earth.jpg".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_named_or_have_three_six_or_eight_digits() {
        assert_eq!(colour("transparent"), Ok([0, 0, 0, 0]));
        assert_eq!(colour("#fa0"), Ok([255, 170, 0, 255]));
        assert_eq!(colour("1A2b3c"), Ok([26, 43, 60, 255]));
        assert_eq!(colour("#1a2b3c80"), Ok([26, 43, 60, 128]));
        for text in ["", "#", "#12", "#12345", "#gggggg", "red?", "#ééé"] {
            assert!(colour(text).is_err(), "{text}");
        }
    }

    #[test]
    fn an_object_has_a_colour_without_transparency() {
        let given = |text| object_colour(text).map(|it| (it.object, it.colour));
        assert_eq!(given("c=#1a2b3c"), Ok(("c".into(), [26, 43, 60])));
        assert_eq!(given("T_1 = white"), Ok(("T_1".into(), [255; 3])));
        let expected = "expected NAME=COLOUR, such as c=#1a2b3c, c=#fff or c=white";
        for text in ["c", "=#fff", "c=", "c=#12345678", "c=transparent", "c=red"] {
            assert_eq!(given(text), Err(expected.to_owned()), "{text}");
        }
    }

    #[test]
    fn settings_are_on_or_off() {
        assert_eq!(setting("centre=off"), Ok(("centre".into(), false)));
        for text in ["centre", "centre=", "centre=no"] {
            assert!(setting(text).is_err(), "{text}");
        }
    }

    #[test]
    fn textures_name_an_object_and_a_file() {
        assert_eq!(
            texture("s=a=b.png"),
            Ok(TextureFile {
                object: "s".into(),
                path: "a=b.png".into()
            })
        );
        assert!(texture("earth.png").is_err());
        assert!(texture("s=").is_err());
    }
}
