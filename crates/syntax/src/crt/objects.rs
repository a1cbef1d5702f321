//! The table of objects and their attributes.
//!
//! Each row contains an attribute of an object: its word, its value with its range and unit, its default, and its purpose.
//! The parser, the interpreter, completion, hover and the documentation read this table. To add an attribute, add a row.

use crate::attribute_range::AttributeRange;

/// The value of an attribute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ValueType {
    /// A number within a range.
    Number(AttributeRange),
    /// An integer within a range.
    Integer(AttributeRange),
    /// A vector.
    Vector,
    /// A colour.
    Colour,
    /// A string.
    Text,
    /// One of these strings; the first is the default.
    Choice(&'static [&'static str]),
    /// The path of an image, as a string.
    Image,
    /// A material.
    Material,
    /// A background.
    Background,
    /// A camera.
    Camera,
    /// A list of lights.
    Lights,
}

/// The default value of an attribute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DefaultValue {
    /// No default: the attribute is required.
    Required,
    /// A number.
    Number(f64),
    /// An integer.
    Integer(i32),
    /// A vector.
    Vector([f64; 3]),
    /// A colour.
    Colour([f64; 3]),
    /// A string.
    Text(&'static str),
    /// Another value, in the syntax of a script; it is created by the interpreter.
    Code(&'static str),
    /// A value that is described by a phrase and created by the interpreter.
    Phrase(&'static str),
}

impl DefaultValue {
    /// Returns the value in the syntax of a script, or the phrase; `None` if the attribute is required.
    pub fn text(self) -> Option<String> {
        Some(match self {
            Self::Required => return None,
            Self::Number(number) => number.to_string(),
            Self::Integer(number) => number.to_string(),
            Self::Vector([x, y, z]) => format!("vec3({x}, {y}, {z})"),
            Self::Colour([red, green, blue]) => format!("rgb({red}, {green}, {blue})"),
            Self::Text(text) => format!("\"{text}\""),
            Self::Code(code) => code.to_owned(),
            Self::Phrase(phrase) => phrase.to_owned(),
        })
    }
}

/// A row of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectAttribute {
    /// The object.
    pub object: ObjectName,
    /// The word as written.
    pub text: &'static str,
    /// The value.
    pub value: ValueType,
    /// The unit, or an empty text.
    pub unit: &'static str,
    /// The default value.
    pub default: DefaultValue,
    /// The purpose: the end of a sentence, without a full stop.
    pub purpose: &'static str,
}

impl ObjectAttribute {
    /// Returns true if an object must state it.
    pub fn is_required(&self) -> bool {
        self.default == DefaultValue::Required
    }
}

/// The type of an object as a value.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
#[allow(missing_docs)]
pub enum ObjectClass {
    Entity,
    Material,
    Camera,
    Light,
    Background,
    /// The block `Settings`, which is not a value.
    Settings,
}

macro_rules! objects {
    ($($name:ident $class:ident $purpose:literal { $($text:literal $value:expr, $unit:literal, $default:expr, $meaning:literal;)* })*) => {
        /// The names of objects, and the block `Settings`.
        #[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
        #[allow(missing_docs)]
        pub enum ObjectName {
            $($name),*
        }

        impl ObjectName {
            /// All names.
            pub const ALL: &[Self] = &[$(Self::$name),*];

            /// Returns the name as written.
            pub const fn text(self) -> &'static str {
                match self {
                    $(Self::$name => stringify!($name)),*
                }
            }

            /// Returns the object with this name.
            pub fn from_text(text: &str) -> Option<Self> {
                $(if text == stringify!($name) {
                    return Some(Self::$name);
                })*
                None
            }

            /// Returns the type of the object as a value.
            pub const fn class(self) -> ObjectClass {
                match self {
                    $(Self::$name => ObjectClass::$class),*
                }
            }

            /// Returns the purpose of the object: the end of a sentence, without a full stop.
            pub const fn purpose(self) -> &'static str {
                match self {
                    $(Self::$name => $purpose),*
                }
            }

            /// Returns the attributes of the object, in the order of the table. The material of an entity comes last.
            pub const fn attributes(self) -> &'static [ObjectAttribute] {
                match self {
                    $(Self::$name => {
                        const ROWS: &[ObjectAttribute] = &[$(ObjectAttribute {
                            object: ObjectName::$name,
                            text: $text,
                            value: $value,
                            unit: $unit,
                            default: $default,
                            purpose: $meaning,
                        }),*];
                        ROWS
                    }),*
                }
            }
        }
    };
}

use DefaultValue::{Code, Phrase, Required};

const ANY: ValueType = ValueType::Number(AttributeRange::ANY);
const POSITIVE: ValueType = ValueType::Number(AttributeRange::POSITIVE);
const NOT_NEGATIVE: ValueType = ValueType::Number(AttributeRange::NOT_NEGATIVE);
const SHARE: ValueType = ValueType::Number(AttributeRange::SHARE);
const OPENING: ValueType = ValueType::Number(AttributeRange {
    is_open: true,
    ..AttributeRange::closed(0.0, 360.0)
});
/// The number of samples in each direction, or of samples, limited so that rendering ends in a reasonable time.
const COUNT: ValueType = ValueType::Integer(AttributeRange::closed(1.0, 65_536.0));
const DEPTH: ValueType = ValueType::Integer(AttributeRange::closed(0.0, 64.0));
const VECTOR: ValueType = ValueType::Vector;
const COLOUR: ValueType = ValueType::Colour;
const TEXT: ValueType = ValueType::Text;
const MATERIAL: ValueType = ValueType::Material;
/// The shapes of a lens. `uniform` is a square box.
const SHAPES: ValueType = ValueType::Choice(&[
    "circle", "gaussian", "uniform", "line", "triangle", "square", "pentagon", "hexagon",
    "octagon", "star",
]);
const PROJECTIONS: ValueType = ValueType::Choice(&["pinhole", "spherical", "cylindrical"]);
const NO_TEXT: DefaultValue = DefaultValue::Text("");
const PLAIN: DefaultValue = Code("Material {}");

const fn number(value: f64) -> DefaultValue {
    DefaultValue::Number(value)
}

objects! {
    Sphere Entity "a ball" {
        "center" VECTOR, "", Required, "its centre";
        "radius" POSITIVE, "", Required, "its radius";
        "material" MATERIAL, "", PLAIN, "its material";
    }
    Box Entity "a box along the axes" {
        "cornerA" VECTOR, "", Required, "a corner";
        "cornerB" VECTOR, "", Required, "the opposite corner";
        "material" MATERIAL, "", PLAIN, "its material";
    }
    Plane Entity "the half-space behind a plane; on its own it is visible, and casts shadows, only from the front" {
        "normal" VECTOR, "", Required, "the normal of its front";
        "position" VECTOR, "", Required, "a point on it";
        "material" MATERIAL, "", PLAIN, "its material";
    }
    HalfPlane Entity "the part of a plane's half-space on one side of a line" {
        "normal" VECTOR, "", Required, "the normal of its front";
        "position" VECTOR, "", Required, "a point on its edge";
        "direction" VECTOR, "", Required, "the direction from its edge into it";
        "material" MATERIAL, "", PLAIN, "its material";
    }
    Cylinder Entity "a cylinder, closed at both ends" {
        "base" VECTOR, "", Required, "the centre of one end";
        "top" VECTOR, "", Required, "the centre of the other end";
        "radius" POSITIVE, "", Required, "its radius";
        "material" MATERIAL, "", PLAIN, "its material";
    }
    Cone Entity "a cone, closed at its base" {
        "base" VECTOR, "", Required, "the centre of its base";
        "apex" VECTOR, "", Required, "its tip";
        "radius" POSITIVE, "", Required, "the radius of its base";
        "material" MATERIAL, "", PLAIN, "its material";
    }
    Torus Entity "a torus: a ring with a circular cross-section" {
        "center" VECTOR, "", Required, "its centre";
        "radius" POSITIVE, "", Required, "the distance from its centre to the middle of its tube";
        "tube" POSITIVE, "", Required, "the radius of its tube";
        "normal" VECTOR, "", DefaultValue::Vector([0.0, 1.0, 0.0]), "the direction of its axis";
        "material" MATERIAL, "", PLAIN, "its material";
    }
    Material Material "the look of an entity" {
        "color" COLOUR, "", DefaultValue::Colour([0.5, 0.5, 0.5]), "its colour";
        "reflectivity" SHARE, "", number(0.0), "the fraction of light that is reflected as by a mirror";
        "transparency" SHARE, "", number(0.0), "the fraction of light that is reflected or refracted as by glass";
        "refractiveindex" POSITIVE, "", number(1.5), "the index of refraction inside";
        "diffuse" NOT_NEGATIVE, "", Code("1 - reflectivity - transparency"), "the diffuse reflectance";
        "specularity" NOT_NEGATIVE, "", number(0.0), "the strength of highlights";
        "shininess" POSITIVE, "", number(3.0), "the exponent of highlights: the larger, the smaller they are";
    }
    Camera Camera "a camera, from which the scene is seen" {
        "position" VECTOR, "", Required, "its position";
        "pointing" VECTOR, "", Required, "the point that it looks at";
        "fov" OPENING, "degrees", Required, "the vertical field of view, below 180; a spherical camera sees 90 with 180, and no more with a larger number";
        "aperture" NOT_NEGATIVE, "", number(3.0), "the radius of the lens, in 720ths of the unit of length";
        "focaldistance" POSITIVE, "", number(0.5), "the distance of the plane in focus";
        "apertureshape" SHAPES, "", DefaultValue::Text("circle"), "the shape of the lens";
        "roll" ANY, "degrees", number(0.0), "the roll angle, from the picture's up towards its right";
        "projection" PROJECTIONS, "", DefaultValue::Text("pinhole"), "the projection";
    }
    PointLight Light "a light that shines in all directions" {
        "origin" VECTOR, "", Required, "its position";
        "color" COLOUR, "", Required, "its colour";
        "ambient" NOT_NEGATIVE, "", number(0.0), "the fraction of the light that is ambient";
        "falloff" ANY, "", number(-1.0), "the intensity at distance 1, which falls with the inverse square of the distance; at 0 or below the intensity is constant";
    }
    ParallelLight Light "a light whose rays are parallel" {
        "from" VECTOR, "", Required, "the point that it comes from";
        "pointing" VECTOR, "", Required, "the point that it shines at";
        "color" COLOUR, "", Required, "its colour";
        "ambient" NOT_NEGATIVE, "", number(0.0), "the fraction of the light that is ambient";
    }
    SpotLight Light "a light that shines in a cone" {
        "origin" VECTOR, "", Required, "its position";
        "pointing" VECTOR, "", Required, "the point that it shines at";
        "color" COLOUR, "", Required, "its colour";
        "angle" OPENING, "degrees", number(60.0), "the full opening of its cone";
        "softness" SHARE, "", number(0.2), "the fraction of its opening over which it fades to its edge";
        "ambient" NOT_NEGATIVE, "", number(0.0), "the fraction of the light that is ambient";
        "falloff" ANY, "", number(-1.0), "the intensity at distance 1, which falls with the inverse square of the distance; at 0 or below the intensity is constant";
    }
    CylinderLight Light "a beam of parallel rays" {
        "origin" VECTOR, "", Required, "its position";
        "pointing" VECTOR, "", Required, "the point that it shines at";
        "radius" POSITIVE, "", Required, "the radius of the beam";
        "color" COLOUR, "", Required, "its colour";
        "softness" SHARE, "", number(0.2), "the fraction of its radius over which it fades to its edge";
        "ambient" NOT_NEGATIVE, "", number(0.0), "the fraction of the light that is ambient";
        "falloff" ANY, "", number(-1.0), "the intensity at distance 1, which falls with the inverse square of the distance; at 0 or below the intensity is constant";
    }
    Background Background "the colour or image where no object is hit" {
        "image" ValueType::Image, "", Phrase("none"), "an image around the scene: a path beside the script or in `--images`";
        "angle" ANY, "radians", number(0.0), "the angle by which the image is rotated about y";
        "horizon" COLOUR, "", Phrase("none"), "the colour at the horizon";
        "sky" COLOUR, "", Phrase("none"), "the colour straight up and down";
        "color" COLOUR, "", Phrase("white, unless `image` or `horizon` and `sky` are stated"), "its colour";
    }
    Settings Settings "the settings of the picture" {
        "title" TEXT, "", NO_TEXT, "the name of the scene";
        "author" TEXT, "", NO_TEXT, "its author";
        "date" TEXT, "", NO_TEXT, "its date";
        "notes" TEXT, "", NO_TEXT, "any other text";
        "gamma" POSITIVE, "", number(1.0), "the gamma of the picture: a byte is 255 times light to the power 1/gamma";
        "background" ValueType::Background, "", Phrase("white"), "the colour or image where no object is hit";
        "camera" ValueType::Camera, "", Phrase("from (0, 0, -1) to (0, 0, 0), 60 degrees"), "the camera";
        "lights" ValueType::Lights, "", Code("[]"), "the lights";
        "supersampling" COUNT, "", DefaultValue::Integer(1), "the number of samples per pixel in each direction";
        "dofsamples" COUNT, "", DefaultValue::Integer(1), "the number of rays through the lens for each sample";
        "recursiondepth" DEPTH, "", DefaultValue::Integer(3), "the maximum number of reflections and refractions of a ray";
    }
}

impl ObjectName {
    /// Returns the attribute with this word; `None` if the object does not have it.
    pub fn attribute(self, word: &str) -> Option<&'static ObjectAttribute> {
        self.attributes().iter().find(|row| row.text == word)
    }

    /// Returns the objects that an expression can be: all except `Settings`.
    pub fn objects() -> impl Iterator<Item = Self> + Clone {
        let all = Self::ALL.iter().copied();
        all.filter(|name| name.class() != ObjectClass::Settings)
    }
}

/// The builtin functions of scripts, each with the names of its arguments and its purpose. A macro with the same name
/// takes precedence.
pub const FUNCTIONS: &[(&str, &[&str], &str)] = &[
    ("vec3", &["x", "y", "z"], "a vector"),
    (
        "rgb",
        &["red", "green", "blue"],
        "a colour, each component from 0 to 1",
    ),
    (
        "rgba",
        &["red", "green", "blue", "alpha"],
        "a colour; the last component is not used",
    ),
    ("sin", &["angle"], "the sine of an angle in radians"),
    ("cos", &["angle"], "the cosine of an angle in radians"),
    ("tan", &["angle"], "the tangent of an angle in radians"),
    (
        "rand",
        &["a", "b"],
        "a random number between two numbers, the same at each run",
    ),
    ("sqrt", &["x"], "the square root"),
    ("abs", &["x"], "the absolute value"),
    (
        "floor",
        &["x"],
        "the greatest whole number that is not above it",
    ),
    ("pow", &["x", "y"], "x to the power y"),
    (
        "length",
        &["value"],
        "the length of a vector, a list or a string",
    ),
];
