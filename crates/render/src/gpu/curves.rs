//! The painter of curves: strips with round joins.

use crate::gpu::glyphs::GlyphKind;
use crate::style;

/// A quad and a join for each sample.
pub(crate) const KIND: GlyphKind = GlyphKind {
    label: "curves",
    shader: wgsl::painter::curves,
    width: &style::LINE_HALF_WIDTH,
    least: style::LEAST_HALF_WIDTH,
    corners: 6 + 3 * style::JOIN_SEGMENTS,
};
