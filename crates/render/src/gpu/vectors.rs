//! The painter of vectors: a strip, a disc and a cone for each.

use crate::gpu::glyphs::GlyphKind;
use crate::style;

/// A shaft, its round end and a head for each arrow.
pub(crate) const KIND: GlyphKind = GlyphKind {
    label: "vectors",
    shader: wgsl::painter::vectors,
    width: &style::LINE_HALF_WIDTH,
    least: style::LEAST_HALF_WIDTH,
    corners: 6 + 3 * style::JOIN_SEGMENTS + 6 * style::HEAD_SEGMENTS,
};
