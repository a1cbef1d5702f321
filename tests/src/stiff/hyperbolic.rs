//! Planes of curvature −1, where errors grow like eˢ: H1, H2.

use super::shapes::{half_plane, poincare_disc};
use super::{Case, complete, go, worst};

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (length, bound) in [
        (5.0, 1e-10),
        (20.0, 1e-13 * f64::exp(20.0)),
        (24.0, 1e-13 * f64::exp(24.0)),
        (27.0, 1e-13 * f64::exp(27.0)),
    ] {
        let case = format!("half-plane, L={length}");
        cases.push(Case::new(
            "H1",
            case,
            "hyperbolic distance",
            bound,
            move |options| {
                let s = half_plane();
                worst([0.0, 0.5, -0.9, 2.5].map(|angle: f64| {
                    let end = go(&s, [0.0, 1.0], [angle.cos(), angle.sin()], length, options);
                    let [u, v] = half_plane_line(angle, length);
                    complete(&end, |end| {
                        let gap = (end.uv[0] - u).hypot(end.uv[1] - v);
                        2.0 * f64::asinh(0.5 * gap / (v * end.uv[1]).sqrt())
                    })
                }))
            },
        ));
    }
    for (length, bound) in [(5.0, 1e-9), (15.0, 1e-6)] {
        let case = format!("Poincaré disc, L={length}");
        cases.push(Case::new(
            "H2",
            case,
            "radius, relative to 1−r",
            bound,
            move |options| {
                let s = poincare_disc();
                worst([0.0, 0.4, 2.5].map(|angle: f64| {
                    let end = go(&s, [0.0, 0.0], [angle.cos(), angle.sin()], length, options);
                    let rest = 2.0 / (length.exp() + 1.0);
                    complete(&end, |end| {
                        ((1.0 - end.uv[0].hypot(end.uv[1])) / rest - 1.0).abs()
                    })
                }))
            },
        ));
    }
    cases
}

/// The point at the distance s from (0, 1) of the half-plane on the line with this angle there.
fn half_plane_line(angle: f64, s: f64) -> [f64; 2] {
    let d = s.cosh() - s.sinh() * angle.sin();
    [s.sinh() * angle.cos() / d, 1.0 / d]
}
