//! The curvatures and the first fundamental form at a point. In: a surface and (u, v). Out: numbers.

use std::array::from_fn;

use super::MeasureError;
use super::rescaled::Rescaled;
use crate::chart::{ApexChart, Atlas};
use crate::frame::Frame;
use crate::interpolate::{MIDDLE_OF_FOUR, MIDDLE_OF_SIX};
use crate::jet::Jet;
use crate::metric::gaussian_curvature;
use crate::point::Uv;
use crate::surface::Surface;
use crate::topology::Apex;
use crate::trace::TraceError;
use crate::vector::{cross, dot, norm};

/// The measures at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaceMeasures {
    /// (u, v), brought back into the domain.
    pub uv: Uv,
    /// E, F, G: the coefficients of the first fundamental form.
    pub form: [f64; 3],
    /// The Gaussian curvature K; `None` where the surface has no tangent plane, as at the tip of a cone, where K or H differs on
    /// both sides, and where rounding leaves less than two of its digits.
    pub gaussian: Option<f64>,
    /// The mean curvature H = (eG − 2fF + gE)/2(EG − F²) for the normal σu × σv; `None` on a metric, which bends in no
    /// space, and where there is no K.
    pub mean: Option<f64>,
    /// The directions of the largest and of the smallest normal curvature, for the same normal; `None` on a metric, at
    /// an umbilic, where all directions are alike, where (u, v) have no directions, and where there is no K.
    pub principal: Option<[Principal; 2]>,
}

/// A principal curvature and its direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principal {
    /// The normal curvature, the larger one first.
    pub curvature: f64,
    /// (a, b): a·σu + b·σv has length 1; the sign is arbitrary.
    pub direction: [f64; 2],
}

impl PlaceMeasures {
    /// Converts what was measured in usual units to the surface's own.
    fn rescaled(self, usual: &Rescaled<'_>) -> Self {
        let size = usual.size();
        let [e, f, g] = self.form;
        let principal = |it: Principal| Principal {
            curvature: it.curvature / size,
            direction: usual.restored_vector(it.direction.into()).0,
        };
        Self {
            uv: usual.restored(self.uv),
            form: [
                usual.restored_product(e, [0, 0]),
                usual.restored_product(f, [0, 1]),
                usual.restored_product(g, [1, 1]),
            ],
            gaussian: self.gaussian.map(|it| it / size / size),
            mean: self.mean.map(|it| it / size),
            principal: self.principal.map(|both| both.map(principal)),
        }
    }
}

/// The maximum relative difference of two principal curvatures that count as equal.
const UMBILIC: f64 = 1e-7;

/// The maximum size of a rounded zero, relative to the numbers from which it was computed.
const NOISE: f64 = 1e-14;

/// Returns a number, or zero where it is a rounding error relative to `size`.
fn rounded(number: f64, size: f64) -> f64 {
    if number.abs() <= NOISE * size {
        0.0
    } else {
        number
    }
}

/// Measures at one point. At a smooth pole, where the formulas yield 0/0, K and H are interpolated from nearby points.
///
/// # Errors
/// [`MeasureError`] where the point is outside the domain or on a crease, or the surface is undefined.
pub fn place(surface: &dyn Surface, uv: impl Into<Uv>) -> Result<PlaceMeasures, MeasureError> {
    let given = uv.into();
    if let Some(usual) = Rescaled::of(surface) {
        let found = place(&usual, usual.changed(given));
        let found = found.map_err(|error| usual.restored_error(error))?;
        return Ok(found.rescaled(&usual));
    }
    match Frame::new(surface, given, 0.0, 1.0) {
        // At the tip of a cone, E, F and G exist.
        Ok(_) | Err(TraceError::DegenerateStart { .. }) => {}
        Err(error) => return Err(error.into()),
    }
    let mut at = given.0;
    surface.sides().bring_back(surface.domain(), &mut at);
    let [[u0, u1], [v0, v1]] = surface.domain();
    let uv = Uv([at[0].clamp(u0, u1), at[1].clamp(v0, v1)]);
    let jet = surface.jet(uv);
    let [mut e, mut g] = [dot(jet.du, jet.du), dot(jet.dv, jet.dv)];
    let apex = apex_at(surface, uv);
    let is_finite = jet.du.iter().chain(&jet.dv).all(|x| x.is_finite());
    // A metric that is not semidefinite.
    let is_indefinite = !surface.is_embedded() && e == 0.0 && g == 0.0;
    if apex.is_none() && (!is_finite || is_indefinite) {
        return Err(MeasureError::Degenerate { at: uv.0 });
    }
    if apex.is_none() && is_on_crease(surface, uv) {
        return Err(MeasureError::Crease { at: uv.0 });
    }
    // Rounding may give a side that is a point some length.
    match apex {
        Some((0, _)) => g = 0.0,
        Some(_) => e = 0.0,
        None => {}
    }
    let form = [e, rounded(dot(jet.du, jet.dv), (e * g).sqrt()), g];
    let jumps = apex.is_none() && curvature_jumps(surface, uv);
    let [gaussian, mean] = match apex {
        Some((_, Apex { smooth: false, .. })) => [f64::NAN; 2],
        _ if jumps => [f64::NAN; 2],
        _ => curvatures_near(surface, uv),
    };
    let finite = |x: f64| x.is_finite().then_some(x);
    Ok(PlaceMeasures {
        uv,
        form,
        gaussian: finite(gaussian),
        mean: finite(mean).filter(|_| surface.is_embedded()),
        principal: principal(&jet).filter(|_| {
            let is_known = gaussian.is_finite() && mean.is_finite();
            surface.is_embedded() && apex.is_none() && is_known
        }),
    })
}

/// Returns the side that is a point and contains the given one: its axis and its shape.
fn apex_at(surface: &dyn Surface, uv: Uv) -> Option<(usize, Apex)> {
    let domain = surface.domain();
    [[0, 0], [0, 1], [1, 0], [1, 1]]
        .into_iter()
        .filter(|&[axis, end]| uv[axis] == domain[axis][end])
        .find_map(|[axis, end]| Some((axis, surface.apex(axis, end)?)))
}

/// Returns the point at a distance along an axis, a fraction of the domain and a few ulp at least; `None` outside the domain.
fn beside(surface: &dyn Surface, uv: Uv, axis: usize, share: f64) -> Option<Uv> {
    let domain = surface.domain();
    let [low, high] = domain[axis];
    let mut at = uv.0;
    let least = 4.0 * f64::EPSILON * at[axis].abs();
    at[axis] += (share.abs() * (high - low)).max(least).copysign(share);
    surface.sides().bring_back(domain, &mut at);
    (at[axis] >= low && at[axis] <= high).then_some(Uv(at))
}

/// Returns whether the tangent planes on both sides of a place make an angle, however near to it they are: also at the smallest
/// of the offsets, so that a surface which bends within the others has no crease.
fn is_on_crease(surface: &dyn Surface, uv: Uv) -> bool {
    const OFF: [f64; 3] = [1e-9, 1e-10, 1e-14];
    const BENT: f64 = 1e-4;
    let normal = |axis: usize, off: f64| {
        let jet = surface.jet(beside(surface, uv, axis, off)?);
        let normal = cross(jet.du, jet.dv);
        let length = norm(normal);
        Some(normal.map(|x| x / length))
    };
    let angle = |axis: usize, off: f64| {
        let sides = normal(axis, off).zip(normal(axis, -off));
        sides.map_or(f64::NAN, |(a, b)| norm(cross(a, b)))
    };
    surface.is_embedded()
        && (0..2).any(|axis| {
            let [far, near, nearest] = OFF.map(|off| angle(axis, off));
            near > BENT && near > 0.5 * far && nearest > 0.5 * near
        })
}

/// Returns whether K or H differ on both sides of a place, however near to it they are, as where a circle's arc goes on as a line.
fn curvature_jumps(surface: &dyn Surface, uv: Uv) -> bool {
    const OFF: [f64; 2] = [1e-7, 1e-9];
    /// Relative to the values on both sides.
    const JUMP: f64 = 1e-3;
    /// Relative to 1 over the length, or its square, of a coordinate line: below it, values are rounding.
    const ROUNDING: f64 = 1e-6;
    let jet = surface.jet(uv);
    let domain = surface.domain();
    (0..2).any(|axis| {
        let tangent = [jet.du, jet.dv][axis];
        let length = norm(tangent) * (domain[axis][1] - domain[axis][0]);
        let units = [length * length, length];
        let [far, near] = OFF.map(|off| {
            let at = |off| Some(curvatures(&surface.jet(beside(surface, uv, axis, off)?)));
            at(off).zip(at(-off))
        });
        let Some((far, near)) = far.zip(near) else {
            return false;
        };
        (0..2).any(|k| {
            let difference = |(a, b): ([f64; 2], [f64; 2])| (a[k] - b[k]).abs();
            let least = JUMP * (near.0[k].abs() + near.1[k].abs()) + ROUNDING / units[k];
            difference(near) > least && difference(near) > 0.5 * difference(far)
        })
    })
}

/// The principal curvatures and directions: those in which the second form, with respect to an orthonormal basis of the
/// tangent plane, is diagonal. `None` at an umbilic, and where there is no tangent plane: there the form is not finite.
fn principal(jet: &Jet) -> Option<[Principal; 2]> {
    let normal = cross(jet.du, jet.dv);
    let (area, length) = (norm(normal), norm(jet.du));
    // σu/|σu|, and σv without its component along σu, in terms of σu and σv.
    let along = dot(jet.du, jet.dv) / length / length;
    let basis = [[1.0 / length, 0.0], [-along * length / area, length / area]];
    let unit = normal.map(|x| x / area);
    let second = |w: [f64; 3]| dot(w, unit);
    let (l, m, n) = (second(jet.duu), second(jet.duv), second(jet.dvv));
    let form = |[a, b]: [f64; 2], [c, d]: [f64; 2]| a * c * l + (a * d + b * c) * m + b * d * n;
    let (p, q, r) = (
        form(basis[0], basis[0]),
        form(basis[0], basis[1]),
        form(basis[1], basis[1]),
    );
    let (mean, half) = (0.5 * (p + r), (0.5 * (p - r)).hypot(q));
    if !half.is_finite() || half <= UMBILIC * (mean.abs() + half) {
        return None;
    }
    let (sin, cos) = (0.5 * (2.0 * q).atan2(p - r)).sin_cos();
    let at = |curvature, [x, y]: [f64; 2]| {
        let [a, b] = [0, 1].map(|k| x * basis[0][k] + y * basis[1][k]);
        // Compare the lengths of the components along σu and σv, not the coefficients.
        let [along_u, along_v] = [a * length, b * norm(jet.dv)].map(f64::abs);
        let longer = along_u.max(along_v);
        Principal {
            curvature,
            direction: [
                if along_u <= NOISE * longer { 0.0 } else { a },
                if along_v <= NOISE * longer { 0.0 } else { b },
            ],
        }
    };
    // The smaller one would be the difference of two nearly equal numbers: it follows from their product.
    let larger = mean + half.copysign(mean);
    let smaller = gaussian_curvature(jet) / larger;
    let [first, second] = if mean.is_sign_negative() {
        [smaller, larger]
    } else {
        [larger, smaller]
    };
    Some([at(first, [cos, sin]), at(second, [-sin, cos])])
}

/// Returns the error that rounding may cause in K and in H. σu and σv are sums whose terms are about as long as these vectors are
/// elsewhere on the surface: where they are much shorter, as beside a cuspidal edge, their directions have few digits, and so
/// has the normal.
fn rounding(surface: &dyn Surface, jet: &Jet) -> [f64; 2] {
    const OF_TERMS: f64 = 4.0 * f64::EPSILON;
    let normal = cross(jet.du, jet.dv);
    let area = norm(normal);
    let unit = normal.map(|x| x / area);
    let [stretch_u, stretch_v] = surface.scale().stretch;
    let turn = OF_TERMS * (stretch_u * norm(jet.dv) + stretch_v * norm(jet.du)) / area;
    let seconds = [jet.duu, jet.duv, jet.dvv];
    let [l, m, n] = seconds.map(|w| dot(w, unit).abs() / area);
    let [dl, dm, dn] = seconds.map(|w| norm(w) * turn / area);
    let [e, f, g] = [
        dot(jet.du, jet.du) / area,
        dot(jet.du, jet.dv).abs() / area,
        dot(jet.dv, jet.dv) / area,
    ];
    // First the change of the normal, then that of the area.
    [
        l * dn + n * dl + dl * dn + 2.0 * m * dm + dm * dm + 2.0 * turn * (l * n + m * m),
        0.5 * (dl * g + 2.0 * dm * f + dn * e) + turn * (l * g + 2.0 * m * f + n * e),
    ]
}

/// Returns K and H, or NaN for what rounding leaves without two digits.
fn without_noise(surface: &dyn Surface, jet: &Jet, values: [f64; 2]) -> [f64; 2] {
    const VAGUE: f64 = 0.01;
    /// The value, in units of 1 over the surface's size or its square, below which one counts as this large.
    const FLAT: f64 = 1e-4;
    if !surface.is_embedded() {
        return values;
    }
    let size = surface.scale().size;
    let units = [1.0 / size / size, 1.0 / size];
    let errors = rounding(surface, jet);
    from_fn(|k| {
        if errors[k] <= VAGUE * values[k].abs().max(FLAT * units[k]) {
            values[k]
        } else {
            f64::NAN
        }
    })
}

/// Returns K and H; beside a pole, where the formulas lose digits, computed in whatever way has the least error. NaN for what
/// rounding leaves without two digits.
fn curvatures_near(surface: &dyn Surface, uv: Uv) -> [f64; 2] {
    /// The distances of the points for interpolation, relative to those at which the acceleration of a ray is interpolated.
    const CLOSER: [f64; 3] = [1.0, 1.0 / 8.0, 1.0 / 64.0];
    let atlas = Atlas::new(surface);
    let jet = surface.jet(uv);
    let Some(chart) = atlas.layout.pole_near(uv.0) else {
        return without_noise(surface, &jet, curvatures(&jet));
    };
    if !surface.is_embedded() {
        return interpolated(surface, chart, uv, CLOSER[0]).map(|it| it[0]);
    }
    let here = (curvatures(&jet), rounding(surface, &jet));
    let here: [[f64; 2]; 2] = from_fn(|k| [here.0[k], here.1[k]]);
    let all = CLOSER.map(|closer| interpolated(surface, chart, uv, closer));
    // An error that is not a number is none of the least.
    let error = |[_, error]: [f64; 2]| if error.is_nan() { f64::INFINITY } else { error };
    let better = |a: [f64; 2], b: [f64; 2]| if error(b) < error(a) { b } else { a };
    let best = |k: usize| {
        all.into_iter()
            .fold(here[k], |best, it| better(best, it[k]))
    };
    from_fn(|k| best(k)[0])
}

/// Returns K and H near a pole, each with its error: interpolated from six points on a line through the place and the pole, in the
/// chart about it. The error is that of rounding at the nearest of them, and the difference to what four points give.
fn interpolated(surface: &dyn Surface, chart: &ApexChart, uv: Uv, closer: f64) -> [[f64; 2]; 2] {
    let [a, b] = chart.point(uv.0);
    let r = a.hypot(b);
    let along = if r > 0.0 { [a / r, b / r] } else { [1.0, 0.0] };
    let (mut six, mut four, mut errors) = ([0.0; 2], [0.0; 2], [0.0_f64; 2]);
    for (n, weight) in MIDDLE_OF_SIX.into_iter().enumerate() {
        for side in [-1.0, 1.0] {
            let offset = side * 2.0 * closer * chart.inner() * (n + 1) as f64;
            let mut at = chart.plain_point([a + offset * along[0], b + offset * along[1]]);
            surface.sides().bring_back(surface.domain(), &mut at);
            let jet = surface.jet(Uv(at));
            let (values, rounding) = (curvatures(&jet), rounding(surface, &jet));
            for k in 0..2 {
                six[k] += weight * values[k];
                four[k] += MIDDLE_OF_FOUR.get(n).unwrap_or(&0.0) * values[k];
                errors[k] = errors[k].max(rounding[k]);
            }
        }
    }
    from_fn(|k| [six[k], errors[k] + (six[k] - four[k]).abs()])
}

/// Returns K and H (do Carmo, *Differential Geometry of Curves and Surfaces*, 1976, section 3-3). Each quotient is
/// computed before the product, which might overflow.
fn curvatures(jet: &Jet) -> [f64; 2] {
    let normal = cross(jet.du, jet.dv);
    let length = norm(normal);
    let unit = normal.map(|x| x / length);
    let second = |w: [f64; 3]| dot(w, unit) / length;
    let (l, m, n) = (second(jet.duu), second(jet.duv), second(jet.dvv));
    let (e, f, g) = (
        dot(jet.du, jet.du) / length,
        dot(jet.du, jet.dv) / length,
        dot(jet.dv, jet.dv) / length,
    );
    let mean = 0.5 * (l * g - 2.0 * m * f + n * e);
    [gaussian_curvature(jet), mean]
}
