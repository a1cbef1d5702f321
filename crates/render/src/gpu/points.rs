//! Painter of points: discs.

use crate::gpu::glyphs::Kind;
use crate::style;

/// A disc for each point.
pub(crate) const KIND: Kind = Kind {
    label: "points",
    shader: wgsl::painter::points,
    width: &style::POINT_RADIUS,
    least: style::LEAST_POINT_RADIUS,
    corners: 3 * style::POINT_SEGMENTS,
};
