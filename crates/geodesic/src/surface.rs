//! What a geodesic needs to know of a surface.

/// Position and partial derivatives up to order two at a point of the chart, in R³.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(missing_docs)]
pub struct Jet {
    pub position: [f64; 3],
    pub du: [f64; 3],
    pub dv: [f64; 3],
    pub duu: [f64; 3],
    pub duv: [f64; 3],
    pub dvv: [f64; 3],
}

/// A parametrised surface σ: R² → R³. Undefined values are NaN. Cheap to call from many threads.
pub trait Surface: Sync {
    /// The jet at (u, v).
    fn jet(&self, uv: [f64; 2]) -> Jet;
    /// The domain: `[[u min, u max], [v min, v max]]`.
    fn domain(&self) -> [[f64; 2]; 2];
    /// What lies beyond each side of the domain.
    fn sides(&self) -> Sides;
}

/// What lies beyond one side of the domain.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Side {
    /// Nothing: the surface ends.
    #[default]
    Edge,
    /// The opposite side: σ(u₀,v) = σ(u₁,v).
    Wrap,
    /// The opposite side, turned over: σ(u₀,v) = σ(u₁,v₀+v₁−v). Handedness flips.
    WrapFlip,
    /// The side is one point, passed by going on half a period further along the other, wrapping, parameter.
    Pole,
}

/// The four sides: `u[0]` at u min, `u[1]` at u max, likewise `v`.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
#[allow(missing_docs)]
pub struct Sides {
    pub u: [Side; 2],
    pub v: [Side; 2],
}
