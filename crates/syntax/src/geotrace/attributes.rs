//! The table of attributes.
//!
//! Each row contains the word of an attribute, the declarations that may state it, its value with its range and its default,
//! and its documentation (the purpose in one sentence, an example). A word with different meanings on different declarations
//! has a row for each. The parser, completion, hover, the diagnostics and the documentation read this table. To add an
//! attribute, add a row.

use super::declarations::DeclarationKeyword;
use crate::attribute_range::AttributeRange;
use DeclarationKeyword::{
    Background, Camera, Curve, Geodesic, Light, Metric, Point, Solid, Surface, Vector,
};

/// The value of an attribute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AttributeType {
    /// An expression: a number within a range.
    Number(AttributeRange),
    /// An expression: one or three numbers within a range.
    Colour(AttributeRange),
    /// An expression: two numbers.
    Pair,
    /// One of these words; the first is the default.
    Choice(&'static [&'static str]),
    /// Any word.
    Name,
}

/// A row of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttributeRow {
    /// The word.
    pub word: AttributeWord,
    /// The word as written.
    pub text: &'static str,
    /// The declarations that may state it.
    pub on: &'static [DeclarationKeyword],
    /// Its value.
    pub value: AttributeType,
    /// The value if it is not stated, as written or as a phrase.
    pub default: &'static str,
    /// The purpose: the end of a sentence, without a full stop.
    pub purpose: &'static str,
    /// The item as a declaration states it.
    pub example: &'static str,
}

/// All objects that are drawn in space.
const DRAWN: &[DeclarationKeyword] = &[Curve, Surface, Point, Vector, Geodesic, Solid];
const FACES: &[DeclarationKeyword] = &[Surface, Solid];
const LINES: &[DeclarationKeyword] = &[Curve, Point, Vector, Geodesic];

macro_rules! attributes {
    (
        $($word:ident $text:literal)*;
        $($name:ident on $on:expr, $value:expr, $default:literal, $purpose:literal, $example:literal;)*
    ) => {
        /// The words of attributes.
        #[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
        #[allow(missing_docs)]
        pub enum AttributeWord {
            $($word),*
        }

        impl AttributeWord {
            /// All words.
            pub const ALL: [Self; [$($text),*].len()] = [$(Self::$word),*];

            /// Returns the word as written.
            pub const fn text(self) -> &'static str {
                match self {
                    $(Self::$word => $text),*
                }
            }

            /// Returns the attribute with this word.
            pub fn from_text(text: &str) -> Option<Self> {
                Some(match text {
                    $($text => Self::$word,)*
                    _ => return None,
                })
            }
        }

        /// The table.
        pub static TABLE: [AttributeRow; [$($default),*].len()] = [
            $(AttributeRow {
                word: AttributeWord::$name,
                text: AttributeWord::$name.text(),
                on: $on,
                value: $value,
                default: $default,
                purpose: $purpose,
                example: $example,
            }),*
        ];
    };
}

attributes! {
    Color "color" Mirror "mirror" Glass "glass" Ior "ior" Depth "depth" Diffuse "diffuse" Specular "specular"
    Shininess "shininess" Bump "bump" Uv "uv" Image "image" Radius "radius" Power "power" Ambient "ambient"
    Falloff "falloff" Angle "angle" Soft "soft" Size "size" Fov "fov" Focus "focus" Aperture "aperture" Bokeh "bokeh"
    Roll "roll" Projection "projection" Turn "turn";

    Color on &[Curve, Point, Vector, Geodesic], AttributeType::Colour(AttributeRange::SHARE), "from a palette",
        "the colour: a grey or (red, green, blue), sRGB", "color : (0.8, 0.3, 0.1)";
    Color on &[Surface, Metric], AttributeType::Colour(AttributeRange::SHARE), "none: its texture is shown",
        "the colour: a grey or (red, green, blue), sRGB", "color : (0.8, 0.3, 0.1)";
    Color on &[Solid], AttributeType::Colour(AttributeRange::SHARE), "(0.88, 0.86, 0.82); 1 where it is glass",
        "the colour: a grey or (red, green, blue), sRGB", "color : (0.8, 0.3, 0.1)";
    Color on &[Light], AttributeType::Colour(AttributeRange::NOT_NEGATIVE), "1",
        "the light's colour: a grey or (red, green, blue), sRGB", "color : (1, 0.9, 0.7)";
    Mirror on DRAWN, AttributeType::Colour(AttributeRange::SHARE), "0",
        "the fraction of light that is reflected as by a mirror: one number, or one for each of red, green and blue", "mirror : 0.3";
    Glass on FACES, AttributeType::Number(AttributeRange::SHARE), "0",
        "the fraction of light that is reflected or refracted as by glass", "glass : 0.9";
    Ior on &[Solid], AttributeType::Number(AttributeRange::POSITIVE), "1.5",
        "the index of refraction inside", "ior : 1.33";
    Depth on &[Solid], AttributeType::Number(AttributeRange::POSITIVE), "1",
        "the distance in glass after which light has the solid's colour", "depth : 0.5";
    Diffuse on DRAWN, AttributeType::Number(AttributeRange::NOT_NEGATIVE), "1 - mirror - glass",
        "the diffuse reflectance", "diffuse : 0.8";
    Specular on DRAWN, AttributeType::Number(AttributeRange::NOT_NEGATIVE), "0.07",
        "the strength of highlights", "specular : 0.5";
    Shininess on DRAWN, AttributeType::Number(AttributeRange::POSITIVE), "40",
        "the exponent of highlights: the larger, the smaller they are", "shininess : 200";
    Bump on FACES, AttributeType::Number(AttributeRange::ANY), "0",
        "a height along the normal, which tilts the normal but moves nothing", "bump : 0.01sin(40z)";
    Uv on &[Surface], AttributeType::Pair, "its parameters, as fractions of their intervals",
        "the position in the texture, which repeats", "uv : (3u, v)";
    Uv on &[Solid], AttributeType::Pair, "none: its image is not shown",
        "the position in the texture, which repeats", "uv : (x, y)";
    Image on &[Surface, Metric, Solid, Background], AttributeType::Name, "none",
        "the texture: an image of this name beside the program or in `--images`", "image : earth";
    Radius on LINES, AttributeType::Number(AttributeRange::NOT_NEGATIVE), "as the 3D view shows it",
        "the thickness in the traced view, as a radius", "radius : 0.05";
    Radius on &[Light], AttributeType::Number(AttributeRange::POSITIVE), "none: the light is a cone",
        "the radius of a beam of parallel rays", "radius : 0.5";
    Power on &[Light], AttributeType::Number(AttributeRange::NOT_NEGATIVE), "1",
        "the factor of the light's colour", "power : 2";
    Ambient on &[Light], AttributeType::Number(AttributeRange::NOT_NEGATIVE), "0",
        "the fraction of the light that is ambient", "ambient : 0.2";
    Falloff on &[Light], AttributeType::Number(AttributeRange::NOT_NEGATIVE), "none: the intensity is constant",
        "the distance at which the light has its stated intensity, which falls with the inverse square of the distance", "falloff : 5";
    Angle on &[Light], AttributeType::Number(AttributeRange::TURN), "pi/3",
        "the full opening of a spot's cone, in radians", "angle : pi/8";
    Soft on &[Light], AttributeType::Number(AttributeRange::SHARE), "0.2",
        "the fraction of a cone's opening or of a beam's radius over which it fades to its edge", "soft : 0";
    Size on &[Light], AttributeType::Number(AttributeRange::NOT_NEGATIVE), "0",
        "the radius of the light source; larger sources cast softer shadows", "size : 0.3";
    Fov on &[Camera], AttributeType::Number(AttributeRange::TURN), "pi/4",
        "the vertical field of view, in radians, below pi; a spherical camera sees pi/2 with pi, and no more with a larger number", "fov : 75pi/180";
    Focus on &[Camera], AttributeType::Number(AttributeRange::POSITIVE), "the length of the direction",
        "the distance of the plane in focus", "focus : 3";
    Aperture on &[Camera], AttributeType::Number(AttributeRange::NOT_NEGATIVE), "0",
        "the radius of the lens: depth of field", "aperture : 0.05";
    Bokeh on &[Camera], AttributeType::Choice(&[
        "circle", "line", "triangle", "square", "pentagon", "hexagon", "octagon", "star", "box", "gaussian",
    ]), "circle", "the shape of the lens", "bokeh : star";
    Roll on &[Camera], AttributeType::Number(AttributeRange::ANY), "0",
        "the roll angle in radians, from the picture's up towards its right", "roll : pi/12";
    Projection on &[Camera], AttributeType::Choice(&["pinhole", "spherical", "cylindrical"]), "pinhole",
        "the projection", "projection : spherical";
    Turn on &[Background], AttributeType::Number(AttributeRange::ANY), "0",
        "the angle in radians by which the background's image is rotated about z", "turn : pi/2";
}

impl AttributeWord {
    /// Returns the rows of the word.
    pub fn rows(self) -> impl Iterator<Item = &'static AttributeRow> {
        TABLE.iter().filter(move |row| row.word == self)
    }

    /// Returns the row of the word on a declaration; `None` if the declaration does not allow it.
    pub fn row(self, on: DeclarationKeyword) -> Option<&'static AttributeRow> {
        self.rows().find(|row| row.on.contains(&on))
    }

    /// Returns true if its value is a word.
    pub fn is_key(self) -> bool {
        matches!(self, Self::Image | Self::Bokeh | Self::Projection)
    }
}

/// Returns the attributes that a declaration may state, in the order of the table.
pub fn of(declaration: DeclarationKeyword) -> impl Iterator<Item = &'static AttributeRow> {
    TABLE
        .iter()
        .filter(move |row| row.on.contains(&declaration))
}

#[cfg(test)]
mod tests {
    use super::{AttributeType, AttributeWord, TABLE, of};
    use crate::geotrace::declarations::DeclarationKeyword;

    #[test]
    fn each_word_has_one_row_on_a_declaration_and_values_of_one_kind() {
        for word in AttributeWord::ALL {
            assert_eq!(AttributeWord::from_text(word.text()), Some(word));
            assert!(word.rows().count() > 0, "{word:?}");
            for row in word.rows() {
                let takes_word =
                    matches!(row.value, AttributeType::Choice(_) | AttributeType::Name);
                assert_eq!(takes_word, word.is_key(), "{word:?}");
                assert!(row.example.starts_with(&format!("{} : ", row.text)));
            }
        }
        for keyword in DeclarationKeyword::ALL {
            for row in of(keyword) {
                assert_eq!(row.word.row(keyword), Some(row));
            }
        }
        assert_eq!(of(DeclarationKeyword::Define).count(), 0);
        let rows: usize = AttributeWord::ALL
            .map(|word| word.rows().count())
            .iter()
            .sum();
        assert_eq!(rows, TABLE.len());
    }
}
