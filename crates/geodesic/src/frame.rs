//! The camera of the geodesic view.

/// A point of the chart with two tangent vectors X ⟂ Y of equal length, in (u,v) components. Pixel
/// (x, y) ∈ [−1,1]² looks along xX + yY.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Frame {
    pub uv: [f64; 2],
    pub x: [f64; 2],
    pub y: [f64; 2],
}
