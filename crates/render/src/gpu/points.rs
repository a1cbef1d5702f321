//! The painter of points: discs.

use crate::gpu::glyphs::GlyphKind;
use crate::style;

/// A disc for each point.
pub(crate) const KIND: GlyphKind = GlyphKind {
    label: "points",
    shader: wgsl::painter::points,
    width: &style::POINT_RADIUS,
    least: style::LEAST_POINT_RADIUS,
    corners: 3 * style::POINT_SEGMENTS,
};
