//! The hand-written WGSL of `/shaders`, embedded.
//!
//! `contract/` contains a stub of every function that one side defines and the other calls: its specification. `lib/`
//! contains pure functions and structs; `pass/` contains entry points and all bindings, and the functions that read
//! these.

/// A piece of WGSL with the name used in messages.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Piece<'a> {
    /// Its origin, e.g. `lib/number.wgsl`.
    pub origin: &'a str,
    /// Its text.
    pub text: &'a str,
}

macro_rules! piece {
    ($path:literal) => {
        Piece {
            origin: $path,
            text: include_str!(concat!("../../../shaders/", $path)),
        }
    };
}

/// NaN and infinities, constructed and recognised by their bits.
pub const NUMBER: Piece<'static> = piece!("lib/number.wgsl");
/// Powers, and products that a zero factor annihilates.
pub const POWER: Piece<'static> = piece!("lib/power.wgsl");
/// Structs of partial derivatives.
pub const JET: Piece<'static> = piece!("lib/jet.wgsl");
/// Equally spaced values and the numbering of samples.
pub const SAMPLING: Piece<'static> = piece!("lib/sampling.wgsl");
/// The camera of the 3D view.
pub const VIEW: Piece<'static> = piece!("lib/view.wgsl");
/// Strips and discs that face the eye.
pub const GLYPH: Piece<'static> = piece!("lib/glyph.wgsl");

/// Rays from a lens, and the positions of samples.
pub const LENS: Piece<'static> = piece!("lib/lens.wgsl");
/// Reflection, refraction and lights.
pub const OPTICS: Piece<'static> = piece!("lib/optics.wgsl");
/// Sign changes of polynomials along lines.
pub const LINE: Piece<'static> = piece!("lib/line.wgsl");
/// Ranges of expressions.
pub const RANGE: Piece<'static> = piece!("lib/range.wgsl");
/// Images on surfaces, filtered over a footprint.
pub const IMAGE: Piece<'static> = piece!("lib/image.wgsl");

/// The conversion from the light that a pixel sees to its bytes.
pub const PICTURE: Piece<'static> = piece!("lib/picture.wgsl");
/// The hatching of pixels that see nothing.
pub const HATCHING: Piece<'static> = piece!("lib/hatching.wgsl");
/// The function called by hatching: whether anything is seen at a pixel.
pub const CONTRACT_SEEN: Piece<'static> = piece!("contract/seen.wgsl");
/// The function called by generated functions: a uniform's value.
pub const CONTRACT_UNIFORMS: Piece<'static> = piece!("contract/uniforms.wgsl");
/// The functions called by the generated `evaluate`: its inputs and outputs.
pub const CONTRACT_TABLE: Piece<'static> = piece!("contract/table.wgsl");
/// A generated point.
pub const CONTRACT_POINT: Piece<'static> = piece!("contract/point.wgsl");
/// A generated vector.
pub const CONTRACT_VECTOR: Piece<'static> = piece!("contract/vector.wgsl");
/// A generated curve.
pub const CONTRACT_CURVE: Piece<'static> = piece!("contract/curve.wgsl");
/// A generated surface with its first derivatives.
pub const CONTRACT_SURFACE: Piece<'static> = piece!("contract/surface.wgsl");
/// Generated expressions over a table of inputs.
pub const CONTRACT_EVALUATE: Piece<'static> = piece!("contract/evaluate.wgsl");

/// Generated attributes of faces.
pub const CONTRACT_LISTS: Piece<'static> = piece!("contract/lists.wgsl");
/// Generated fields of pieces.
pub const CONTRACT_FIELDS: Piece<'static> = piece!("contract/fields.wgsl");
/// The function called by generated attributes: stores a number.
pub const CONTRACT_STORED: Piece<'static> = piece!("contract/stored.wgsl");
/// The function called by the pass of traced pictures: the look of a face at a point.
pub const CONTRACT_VARIED: Piece<'static> = piece!("contract/varied.wgsl");
/// The functions called by the pass of traced pictures: the sign changes of a field, and its gradient.
pub const CONTRACT_SEARCHED: Piece<'static> = piece!("contract/searched.wgsl");

/// Samples of a point.
pub const PASS_SAMPLE_POINT: Piece<'static> = piece!("pass/sample_point.wgsl");
/// Samples of a vector.
pub const PASS_SAMPLE_VECTOR: Piece<'static> = piece!("pass/sample_vector.wgsl");
/// Samples of a curve.
pub const PASS_SAMPLE_CURVE: Piece<'static> = piece!("pass/sample_curve.wgsl");
/// Samples of a surface.
pub const PASS_SAMPLE_SURFACE: Piece<'static> = piece!("pass/sample_surface.wgsl");
/// Expressions over rows of inputs.
pub const PASS_EVALUATE: Piece<'static> = piece!("pass/evaluate.wgsl");
/// The copy of a picture onto a target owned by the caller.
pub const PASS_BLIT: Piece<'static> = piece!("pass/blit.wgsl");
/// The painter of points.
pub const PASS_DRAW_POINTS: Piece<'static> = piece!("pass/draw_points.wgsl");
/// The painter of vectors.
pub const PASS_DRAW_VECTORS: Piece<'static> = piece!("pass/draw_vectors.wgsl");
/// The painter of curves.
pub const PASS_DRAW_CURVES: Piece<'static> = piece!("pass/draw_curves.wgsl");
/// The painter of surfaces.
pub const PASS_DRAW_SURFACES: Piece<'static> = piece!("pass/draw_surfaces.wgsl");
/// The painter of solids.
pub const PASS_DRAW_SOLIDS: Piece<'static> = piece!("pass/draw_solids.wgsl");
/// The pass from a table of polynomials to colours.
pub const PASS_RESOLVE_PIECEWISE: Piece<'static> = piece!("pass/resolve_piecewise.wgsl");
/// The pass of traced pictures.
pub const PASS_TRACE_SCENE: Piece<'static> = piece!("pass/trace_scene.wgsl");
/// The tables of its scene.
pub const PASS_TRACE_TABLES: Piece<'static> = piece!("pass/trace_tables.wgsl");
/// Its part that finds crossings.
pub const PASS_TRACE_CROSSINGS: Piece<'static> = piece!("pass/trace_crossings.wgsl");
/// Its part for faces whose attributes are expressions.
pub const PASS_TRACE_VARIED: Piece<'static> = piece!("pass/trace_varied.wgsl");
/// Its part for pieces bounded by fields.
pub const PASS_TRACE_FIELDS: Piece<'static> = piece!("pass/trace_fields.wgsl");
