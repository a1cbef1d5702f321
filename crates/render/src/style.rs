//! The style of pictures: colours, light, widths. One set of constants for both backends.
//!
//! Lengths are in *drawing units* (see [`crate::placement::Placement`]: the scene has radius 1 in them), pixel lengths in
//! units of [`pixel_unit`], colours in linear light unless noted otherwise.
//!
//! **Glyphs** (curves, arrow shafts, points) are camera-facing strips and discs that are shaded like tubes and balls: at the
//! distance r ∈ `[0, 1]` from the glyph's axis the normal leans so that its component towards the eye is √(1−r²), and the
//! colour is multiplied by `glyph_light` of that. Arrowheads are true cones and use the same function with their normals.
//!
//! **Surfaces** are lit on both sides: the normal is first turned towards the eye, see `surface_light`.

use std::sync::{Arc, LazyLock};

pub use geometry::solids::SOLID_COLOUR;
use scene::{Object, Scene, Shape};
use tracer::srgb;

/// The background, sRGB.
pub const BACKGROUND: [u8; 3] = [18, 20, 26];
/// Points, sRGB.
pub const POINT_COLOUR: [u8; 3] = [255, 225, 30];
/// Vectors, sRGB, used in the order of their declarations.
pub const VECTOR_COLOURS: [[u8; 3]; 6] = [[255, 50, 240], GREEN, ORANGE, BLUE, RED, TEAL];
/// Curves and geodesics, sRGB, used in the order of their declarations.
pub const CURVE_COLOURS: [[u8; 3]; 6] = [RED, BLUE, ORANGE, GREEN, PINK, TEAL];
/// The colours of curves and geodesics in scenes that show curvature: none is close to the blue, white and red of its scale.
/// They may also lie beside the surface, on the background.
pub const CURVE_COLOURS_ON_CURVATURE: [[u8; 3]; 3] = [[255, 225, 30], [0, 255, 140], [190, 110, 0]];
/// Points on paper, sRGB.
pub(crate) const POINT_COLOUR_ON_PAPER: [u8; 3] = [30, 30, 36];
/// Vectors on paper, sRGB, used in the order of their declarations. The contrast of each to white is at least 4.5.
pub const VECTOR_COLOURS_ON_PAPER: [[u8; 3]; 6] = [
    PINK_ON_PAPER,
    GREEN_ON_PAPER,
    RUST_ON_PAPER,
    BLUE_ON_PAPER,
    RED_ON_PAPER,
    TEAL_ON_PAPER,
];
/// Curves and geodesics on paper, sRGB, used in the order of their declarations.
pub const CURVE_COLOURS_ON_PAPER: [[u8; 3]; 6] = [
    RED_ON_PAPER,
    BLUE_ON_PAPER,
    RUST_ON_PAPER,
    GREEN_ON_PAPER,
    PINK_ON_PAPER,
    TEAL_ON_PAPER,
];
/// The colours of curves and geodesics on paper in scenes that show curvature.
pub const CURVE_COLOURS_ON_CURVATURE_ON_PAPER: [[u8; 3]; 3] =
    [[30, 30, 36], [0, 120, 65], [170, 85, 0]];
const RED: [u8; 3] = [255, 45, 40];
const BLUE: [u8; 3] = [70, 150, 255];
const ORANGE: [u8; 3] = [255, 165, 30];
const GREEN: [u8; 3] = [0, 205, 120];
const PINK: [u8; 3] = [241, 65, 183];
const TEAL: [u8; 3] = [52, 118, 117];
const RED_ON_PAPER: [u8; 3] = [156, 21, 3];
const BLUE_ON_PAPER: [u8; 3] = [6, 89, 220];
const RUST_ON_PAPER: [u8; 3] = [189, 88, 28];
const GREEN_ON_PAPER: [u8; 3] = [64, 131, 87];
const PINK_ON_PAPER: [u8; 3] = [202, 57, 164];
const TEAL_ON_PAPER: [u8; 3] = [12, 84, 97];
/// Surfaces, sRGB; multiplies the texture.
pub const SURFACE_COLOUR: [u8; 3] = [255, 255, 255];

/// The factor of the linear colour of every other square of a checker on an object of one colour.
pub(crate) const DARK_SQUARE: f32 = 0.45;

/// The colour that is mixed into a highlighted object, sRGB; it differs from the colours above.
pub const EMPHASIS_COLOUR: [u8; 3] = [60, 215, 255];
/// The fraction of it in a highlighted object.
pub const EMPHASIS: f32 = 0.45;

/// The fraction of its brightness that an object keeps while it is out of date.
const DIMMED: f64 = 0.4;

/// Returns the colour, sRGB, of an object that is out of date.
pub fn dimmed(colour: [u8; 3]) -> [u8; 3] {
    colour.map(|part| (f64::from(part) * DIMMED) as u8)
}

/// The medium for which the colours of points and lines are chosen.
#[derive(Clone, Copy, Debug, Default, Eq, Hash, PartialEq)]
pub enum Theme {
    /// A screen: bright colours, on a dark background.
    #[default]
    Screen,
    /// Paper: dark colours, which contrast with white.
    Print,
}

/// The background of a picture for print, sRGB.
pub const PAPER: [u8; 3] = [255; 3];

/// A length in space that stays readable: it follows perspective, within limits in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Length {
    /// In drawing units.
    pub nominal: f32,
    /// The minimum number of pixels, in [`pixel_unit`]s.
    pub min_pixels: f32,
    /// The maximum number of pixels, in [`pixel_unit`]s.
    pub max_pixels: f32,
}

/// The look of the lines of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineStyle {
    /// The factor of its widths, and of a point's radius.
    pub width: f32,
    /// The distance by which it is moved towards the eye beyond `GLYPH_LIFT`, in half widths: of coincident lines, the one
    /// with the largest lift is visible.
    pub lift: f32,
}

impl Default for LineStyle {
    fn default() -> Self {
        Self {
            width: 1.0,
            lift: 0.0,
        }
    }
}

/// The increase of the lift from one curve of a scene to the next, in half widths.
const LIFT_STEP: f32 = 0.3;
/// The number of curves with a lift of their own.
const LIFTS: usize = 6;

/// The colours of an object and the look of its lines.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Look {
    /// The colours of its instances in linear light, at least one; the last one is that of all further instances.
    pub(crate) colours: Arc<[[f32; 3]]>,
    /// The fraction of [`EMPHASIS_COLOUR`] that is mixed into it.
    pub(crate) emphasis: f32,
    pub(crate) line: LineStyle,
}

/// Half the width of curves and of the shafts of vectors.
pub(crate) const LINE_HALF_WIDTH: Length = Length {
    nominal: 0.0065,
    min_pixels: 0.8,
    max_pixels: 2.6,
};
/// The radius of points.
pub(crate) const POINT_RADIUS: Length = Length {
    nominal: 0.021,
    min_pixels: 2.4,
    max_pixels: 8.0,
};
/// The minimum half width of a line in true pixels, whatever the picture's size.
pub(crate) const LEAST_HALF_WIDTH: f32 = 0.6;
/// The minimum radius of a point in true pixels.
pub(crate) const LEAST_POINT_RADIUS: f32 = 1.2;
/// The length of an arrowhead, in half widths of its shaft.
pub(crate) const HEAD_LENGTH: f32 = 11.0;
/// The radius of an arrowhead, in half widths of its shaft.
pub(crate) const HEAD_RADIUS: f32 = 4.1;
/// The maximum fraction of a vector's length for its arrowhead; for shorter vectors, head and shaft are scaled down.
pub(crate) const HEAD_SHARE: f32 = 0.45;
/// Sides of an arrowhead's cone.
pub(crate) const HEAD_SEGMENTS: u32 = 16;
/// The number of corners of the polygon that represents a point's disc.
pub(crate) const POINT_SEGMENTS: u32 = 24;
/// Corners of the polygon that rounds a curve's joins and ends.
pub(crate) const JOIN_SEGMENTS: u32 = 12;
/// Glyphs are moved towards the eye by this multiple of their half widths (or radii), so that a curve on a surface is
/// entirely visible.
pub(crate) const GLYPH_LIFT: f32 = 1.6;
/// The same for joins: less than for the strips that they join, so that they fill only the gap between them.
pub(crate) const JOIN_LIFT: f32 = 1.4;

/// The field of view along the picture's shorter side, in radians.
pub const FIELD_OF_VIEW: f64 = 0.6;
/// The azimuth of the initial camera, from the x axis towards y, in radians.
pub const AZIMUTH: f64 = -std::f64::consts::FRAC_PI_3;
/// The elevation of the initial camera above the xy plane, in radians.
pub const ELEVATION: f64 = 0.45;
/// The fraction of the picture's shorter half that stays free around the scene.
pub const MARGIN: f64 = 0.08;

/// The fraction of its colour that a glyph keeps at its rim.
pub(crate) const GLYPH_RIM: f32 = 0.42;
/// The strength of the ambient light.
pub(crate) const AMBIENT: f32 = 0.20;
/// The strength of the light from the eye.
pub(crate) const FILL: f32 = 0.32;
/// The strength of the light from above the eye's left shoulder.
pub(crate) const KEY: f32 = 0.50;
/// The direction of the key light, in view space (x right, y up, z towards the eye); a unit vector.
pub(crate) const KEY_DIRECTION: [f32; 3] = [-0.4, 0.56, 0.725_534_3];
/// The strength of the highlight, white, added to the lit colour.
pub(crate) const HIGHLIGHT: f32 = 0.07;
/// The exponent of the highlight (Blinn).
pub(crate) const HIGHLIGHT_POWER: i32 = 40;

/// Returns the sizes of points, arrows and curves for rays, in a scene whose drawing unit has the length `radius`.
pub fn thickness(radius: f64) -> geometry::solids::Thickness {
    geometry::solids::Thickness {
        point: radius * f64::from(POINT_RADIUS.nominal),
        line: radius * f64::from(LINE_HALF_WIDTH.nominal),
        head_length: HEAD_LENGTH.into(),
        head_radius: HEAD_RADIUS.into(),
        head_share: HEAD_SHARE.into(),
    }
}

/// Returns the number of pixels that count as one in the pixel bounds of a [`Length`]: 1 for a picture whose shorter side is
/// 512.
pub fn pixel_unit(size: [u32; 2]) -> f32 {
    size[0].min(size[1]) as f32 / 512.0
}

impl Length {
    /// Returns the length and its bounds, multiplied by a factor.
    #[must_use]
    pub fn times(self, factor: f32) -> Self {
        Self {
            nominal: self.nominal * factor,
            min_pixels: self.min_pixels * factor,
            max_pixels: self.max_pixels * factor,
        }
    }

    /// Returns the length in drawing units at the distance `w` along the view direction. `pixels_per_unit` is
    /// [`crate::camera::Camera::pixels_per_unit`], `least` a bound in true pixels.
    pub fn at(&self, w: f32, pixels_per_unit: f32, unit: f32, least: f32) -> f32 {
        let pixel = w / pixels_per_unit;
        let low = (self.min_pixels * unit).max(least);
        let high = (self.max_pixels * unit).max(low);
        self.nominal.clamp(low * pixel, high * pixel)
    }
}

/// Returns the light on a glyph whose normal has the component `facing` ∈ `[0, 1]` towards the eye.
#[inline(always)]
pub(crate) fn glyph_light(facing: f32) -> f32 {
    GLYPH_RIM + (1.0 - GLYPH_RIM) * facing.clamp(0.0, 1.0)
}

/// Returns the light on a surface: (factor of its colour, white added to it). `normal` and `to_eye` are unit vectors in view
/// space, the normal on the eye's side.
#[inline(always)]
pub(crate) fn surface_light(normal: [f32; 3], to_eye: [f32; 3]) -> (f32, f32) {
    let normal = glam::Vec3::from(normal);
    let to_eye = glam::Vec3::from(to_eye);
    let key = glam::Vec3::from(KEY_DIRECTION);
    let diffuse = AMBIENT + FILL * normal.dot(to_eye).max(0.0) + KEY * normal.dot(key).max(0.0);
    let half = key + to_eye;
    // Also zero if the two are opposite and have no half vector.
    let cosine = (normal.dot(half) / half.length()).max(0.0);
    (diffuse, HIGHLIGHT * power(cosine, HIGHLIGHT_POWER))
}

/// Returns a power by squaring, without a branch for a constant exponent, so that loops over many points vectorise.
#[inline(always)]
fn power(mut x: f32, mut exponent: i32) -> f32 {
    let mut product = 1.0;
    while exponent > 0 {
        if exponent & 1 == 1 {
            product *= x;
        }
        x *= x;
        exponent >>= 1;
    }
    product
}

/// Returns a colour in linear light with a fraction of [`EMPHASIS_COLOUR`] mixed in.
#[inline(always)]
pub(crate) fn emphasised(colour: [f32; 3], share: f32) -> [f32; 3] {
    if share == 0.0 {
        return colour;
    }
    let other = linear(EMPHASIS_COLOUR);
    std::array::from_fn(|k| colour[k] + share * (other[k] - colour[k]))
}

/// Returns the colours of a scene's objects, sRGB, in their order: those of lines are used in the order of declaration.
pub fn colours(scene: &Scene, theme: Theme, shows_curvature: bool) -> Vec<[u8; 3]> {
    let curve_colours: &[[u8; 3]] = match (theme, shows_curvature) {
        (Theme::Screen, true) => &CURVE_COLOURS_ON_CURVATURE,
        (Theme::Screen, false) => &CURVE_COLOURS,
        (Theme::Print, true) => &CURVE_COLOURS_ON_CURVATURE_ON_PAPER,
        (Theme::Print, false) => &CURVE_COLOURS_ON_PAPER,
    };
    let (vector_colours, point_colour) = match theme {
        Theme::Screen => (VECTOR_COLOURS, POINT_COLOUR),
        Theme::Print => (VECTOR_COLOURS_ON_PAPER, POINT_COLOUR_ON_PAPER),
    };
    let mut curves = curve_colours.iter().cycle();
    let mut vectors = vector_colours.iter().cycle();
    let colour = |object: &Object| match object.shape {
        Shape::Point { .. } => point_colour,
        Shape::Vector { .. } => vectors.next().copied().unwrap_or(point_colour),
        Shape::Curve { .. } | Shape::Geodesic { .. } => {
            curves.next().copied().unwrap_or(point_colour)
        }
        Shape::Solid(_) => SOLID_COLOUR,
        Shape::Surface { .. }
        | Shape::Metric { .. }
        | Shape::Light(_)
        | Shape::Camera(_)
        | Shape::Background(_) => SURFACE_COLOUR,
    };
    scene.objects.iter().map(colour).collect()
}

/// Returns the looks of a scene's lines, in the order of its objects: of coincident lines, the one that is declared last is
/// visible. Widths are multiplied by `scale`.
pub(crate) fn line_styles(scene: &Scene, scale: f32) -> Vec<LineStyle> {
    let mut curves = 0;
    let line = |object: &Object| {
        let is_curve = matches!(object.shape, Shape::Curve { .. } | Shape::Geodesic { .. });
        let lift = if is_curve {
            LIFT_STEP * curves.min(LIFTS) as f32
        } else {
            0.0
        };
        curves += usize::from(is_curve);
        LineStyle { width: scale, lift }
    };
    scene.objects.iter().map(line).collect()
}

/// Converts sRGB to linear light.
pub fn linear(colour: [u8; 3]) -> [f32; 3] {
    colour.map(decode)
}

/// Converts one sRGB byte to linear light in `[0, 1]`.
pub fn decode(byte: u8) -> f32 {
    Decoder::get().decode(byte)
}

/// The table from sRGB to linear light, fetched once for many colours.
#[derive(Clone, Copy, Debug)]
pub struct Decoder(&'static [f32; 256]);

impl Decoder {
    /// Returns the table.
    pub fn get() -> Self {
        static TABLE: LazyLock<[f32; 256]> =
            LazyLock::new(|| std::array::from_fn(|byte| srgb::decode(byte as f64 / 255.0) as f32));
        Self(&TABLE)
    }

    /// Converts one byte.
    #[inline]
    pub fn decode(self, byte: u8) -> f32 {
        self.0[usize::from(byte)]
    }
}

/// Converts linear light to the nearest sRGB byte. Values outside `[0, 1]` are clamped; NaN becomes 0.
#[inline(always)]
pub fn encode(light: f32) -> u8 {
    encode_word(light) as u8
}

/// Converts colours in linear light to the bytes of opaque pixels: all that are given, at most L.
#[inline(always)]
pub(crate) fn encode_pixels<const L: usize>(light: &[[f32; L]; 3], pixels: &mut [u8]) {
    let mut words = [0; L];
    for k in 0..L {
        let [r, g, b] = [light[0][k], light[1][k], light[2][k]];
        words[k] = encode_word(r) | encode_word(g) << 8 | encode_word(b) << 16 | 0xff << 24;
    }
    for (pixel, word) in pixels.chunks_exact_mut(4).zip(words) {
        pixel.copy_from_slice(&word.to_le_bytes());
    }
}

/// Converts as [`encode`] does, without a branch or a table, so that a loop over colours vectorises: a table of the same
/// precision would fill the first-level cache.
///
/// The curve of IEC 61966-2-1 is nearly a polynomial in the fourth root of the light; these coefficients of degree 6 have
/// the smallest error on `[0.0031308, 1]`, 0.0004 of a byte.
#[inline(always)]
fn encode_word(light: f32) -> u32 {
    let light = if light > 0.0 { light } else { 0.0 };
    let light = if light < 1.0 { light } else { 1.0 };
    let x = light.sqrt().sqrt();
    let curve = 17.416_418;
    let curve = curve * x - 81.286_2;
    let curve = curve * x + 167.723_03;
    let curve = curve * x - 217.615_95;
    let curve = curve * x + 348.358_07;
    let curve = curve * x + 35.588_457;
    let curve = curve * x - 15.183_459;
    let line = 12.92 * 255.0 * light;
    let byte = if light <= 0.003_130_8 { line } else { curve };
    // 2²³ leaves no bits for a fraction: the last bits of the sum are the nearest integer.
    (byte + 8_388_608.0).to_bits() & 0xff
}

#[cfg(test)]
mod tests {
    use super::{encode, srgb};

    #[test]
    fn light_becomes_the_nearest_byte_of_the_srgb_curve() {
        let mut worst = 0.0_f64;
        for step in 0..=1_000_000 {
            let light = f64::from(step) / 1e6;
            let off = (f64::from(encode(light as f32)) - 255.0 * srgb::encode(light)).abs();
            worst = worst.max(off);
        }
        assert!(worst < 0.5005, "{worst}");
        assert_eq!(
            [-1.0, f32::NAN, 2.0, f32::INFINITY].map(encode),
            [0, 0, 255, 255]
        );
    }
}
