//! The first fundamental form at a point. In: jets. Out: lengths, angles, accelerations and curvature.

use crate::jet::{Jet, JetBlock, Lanes};
use crate::point::TangentVector;
use crate::vector::{combine, cross, dot, norm};

/// The first fundamental form E du² + 2F du dv + G dv² with its area element R = |σu×σv|, which preserves the digits
/// that √(EG−F²) loses in a sheared chart.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Metric {
    pub e: f64,
    pub f: f64,
    pub g: f64,
    pub r: f64,
}

impl Metric {
    /// Returns the metric at a jet's point.
    pub fn of(jet: &Jet) -> Self {
        Self {
            e: dot(jet.du, jet.du),
            f: dot(jet.du, jet.dv),
            g: dot(jet.dv, jet.dv),
            r: norm(cross(jet.du, jet.dv)),
        }
    }

    /// Returns the inner product of two tangent vectors in (u,v) components.
    pub fn inner(&self, a: impl Into<TangentVector>, b: impl Into<TangentVector>) -> f64 {
        let (a, b) = (a.into(), b.into());
        self.e * a[0] * b[0] + self.f * (a[0] * b[1] + a[1] * b[0]) + self.g * a[1] * b[1]
    }

    /// Returns a tangent vector turned by `angle` from σu towards σv (C. Grundmann, *Geodesic Tracing*, 2022, 2.2.2):
    /// (a cos θ − (aF+bG)/R sin θ, (aE+bF)/R sin θ + b cos θ).
    pub fn turn(&self, vector: impl Into<TangentVector>, angle: f64) -> TangentVector {
        let TangentVector([a, b]) = vector.into();
        let (sin, cos) = angle.sin_cos();
        TangentVector([
            a * cos - (a * self.f + b * self.g) / self.r * sin,
            (a * self.e + b * self.f) / self.r * sin + b * cos,
        ])
    }

    /// Returns a tangent vector turned by +90°.
    pub fn turn_left(&self, vector: impl Into<TangentVector>) -> TangentVector {
        let TangentVector([a, b]) = vector.into();
        TangentVector([
            -(a * self.f + b * self.g) / self.r,
            (a * self.e + b * self.f) / self.r,
        ])
    }
}

/// E, F, G and their first derivatives at a point: `by_u[0]` is ∂E/∂u.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub(crate) struct Form {
    pub(crate) efg: [f64; 3],
    pub(crate) by_u: [f64; 3],
    pub(crate) by_v: [f64; 3],
    /// −Evv/2 + Fuv − Guu/2, the second derivatives' contribution to the curvature in Gauss's equation.
    pub(crate) bent: f64,
}

impl Form {
    /// Reads them from the derivatives of E, F and G.
    #[inline(always)]
    pub(crate) fn of_lane(forms: &JetBlock, lane: usize) -> Self {
        let of = |block: &[Lanes; 3]| [block[0][lane], block[1][lane], block[2][lane]];
        Self {
            efg: of(&forms.position),
            by_u: of(&forms.du),
            by_v: of(&forms.dv),
            bent: -0.5 * forms.dvv[0][lane] + forms.duv[1][lane] - 0.5 * forms.duu[2][lane],
        }
    }
}

/// Returns the length of a tangent vector in (u,v) components, from the vectors themselves: no cancellation in a
/// sheared chart.
pub fn speed(jet: &Jet, velocity: impl Into<TangentVector>) -> f64 {
    let velocity = velocity.into();
    norm(combine(velocity[0], jet.du, velocity[1], jet.dv))
}

/// Returns the second derivative (u'', v'') of the geodesic with this velocity, which cancels the tangential part of A
/// = σuu u'² + 2σuv u'v' + σvv v'²: `[E F; F G](u'',v'') = −(σu·A, σv·A)` (thesis, system 2.2).
#[inline(always)]
pub fn acceleration(jet: &Jet, velocity: impl Into<TangentVector>) -> TangentVector {
    let TangentVector(velocity) = velocity.into();
    TangentVector(turned(jet, velocity, velocity))
}

/// Returns the derivative of a vector's components under parallel transport with this velocity.
#[inline(always)]
pub(crate) fn turned(jet: &Jet, velocity: [f64; 2], vector: [f64; 2]) -> [f64; 2] {
    let ([a, b], [c, d]) = (velocity, vector);
    let mut second = combine(a * c, jet.duu, a * d + b * c, jet.duv);
    second = combine(1.0, second, b * d, jet.dvv);
    minus_components(jet.du, jet.dv, second)
}

/// Returns the negative components of `w`'s tangential part along the two vectors, by orthogonalisation: the normal
/// equations would square the condition number of a sheared chart.
#[inline(always)]
pub(crate) fn minus_components(du: [f64; 3], dv: [f64; 3], w: [f64; 3]) -> [f64; 2] {
    let e = 1.0 / dot(du, du);
    let shear = dot(du, dv) * e;
    let across = combine(1.0, dv, -shear, du);
    let second = -dot(across, w) / dot(across, across);
    [-dot(du, w) * e - shear * second, second]
}

/// Returns the Gaussian curvature (LN − M²)/(EG − F²), with L = σuu·n and so on (do Carmo, *Differential Geometry of
/// Curves and Surfaces*, 1976, section 3-3).
#[inline(always)]
pub fn gaussian_curvature(jet: &Jet) -> f64 {
    let normal = cross(jet.du, jet.dv);
    if (1e-280..1e280).contains(&dot(normal, normal)) {
        curvature_in_range(jet)
    } else {
        extreme_curvature(jet, normal)
    }
}

/// The same without a branch, for several points at once, where EG − F² is in range. Each quotient is computed before the
/// product, which might overflow.
#[inline(always)]
pub(crate) fn curvature_in_range(jet: &Jet) -> f64 {
    let normal = cross(jet.du, jet.dv);
    let share = 1.0 / dot(normal, normal);
    let [l, m, n] = [jet.duu, jet.duv, jet.dvv].map(|second| dot(second, normal));
    (l * share) * (n * share) - (m * share) * (m * share)
}

/// The same where EG − F² may overflow or underflow.
#[cold]
fn extreme_curvature(jet: &Jet, normal: [f64; 3]) -> f64 {
    let r = norm(normal);
    let normal = normal.map(|x| x / r);
    let [l, m, n] = [jet.duu, jet.duv, jet.dvv].map(|second| dot(second, normal) / r);
    l * n - m * m
}

/// Returns the Christoffel symbols of the second kind: `[k][0]` = Γᵏ_uu, `[k][1]` = Γᵏ_uv, `[k][2]` = Γᵏ_vv.
pub fn christoffel(jet: &Jet) -> [[f64; 3]; 2] {
    let columns = [jet.duu, jet.duv, jet.dvv].map(|w| minus_components(jet.du, jet.dv, w));
    [0, 1].map(|k| [-columns[0][k], -columns[1][k], -columns[2][k]])
}
