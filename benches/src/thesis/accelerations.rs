//! Several geodesics side by side: derivatives at their points and velocities in, accelerations (u'', v'') out.
//!
//! These are the thesis' equations (system 2.2) as they stand: cheap, in any precision, and with less care for sheared
//! charts than [`geodesic::metric::acceleration`] takes.

use expr::processor::{Processor, Work};

use super::real::Real;
use super::{Pair, Triple};

/// From the derivatives σ, σu, σv, σuu, σuv, σvv: [E F; F G]·(u'',v'') = −(σu·A, σv·A) with A = σuu u'² + 2σuv u'v' +
/// σvv v'².
pub(super) fn embedded<T: Real, const N: usize>(
    processor: Processor,
    derivatives: &[Triple<T, N>; 6],
    velocity: &Pair<T, N>,
    out: &mut Pair<T, N>,
) {
    processor.run(Embedded {
        derivatives,
        velocity,
        out,
    });
}

/// From E, F, G, then their derivatives by u, then by v, by the Christoffel symbols of the first kind. NaN where it is
/// no metric.
pub(super) fn intrinsic<T: Real, const N: usize>(
    processor: Processor,
    form: &[Triple<T, N>; 3],
    velocity: &Pair<T, N>,
    out: &mut Pair<T, N>,
) {
    processor.run(Intrinsic {
        form,
        velocity,
        out,
    });
}

struct Embedded<'a, T, const N: usize> {
    derivatives: &'a [Triple<T, N>; 6],
    velocity: &'a Pair<T, N>,
    out: &'a mut Pair<T, N>,
}

impl<T: Real, const N: usize> Work for Embedded<'_, T, N> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let [_, du, dv, duu, duv, dvv] = *self.derivatives;
        let (velocity, mut out) = (*self.velocity, [[T::default(); N]; 2]);
        for lane in 0..N {
            let [xx, xy, yy] = products(&velocity, lane);
            let zero = T::default();
            let (mut e, mut f, mut g) = (zero, zero, zero);
            let (mut along_u, mut along_v) = (zero, zero);
            for k in 0..3 {
                let (tangent, other) = (du[k][lane], dv[k][lane]);
                let bent = xx * duu[k][lane] + xy * duv[k][lane] + yy * dvv[k][lane];
                e = e + tangent * tangent;
                f = f + tangent * other;
                g = g + other * other;
                along_u = along_u + tangent * bent;
                along_v = along_v + other * bent;
            }
            let r = T::ONE / (e * g - f * f);
            out[0][lane] = r * (f * along_v - g * along_u);
            out[1][lane] = r * (f * along_u - e * along_v);
        }
        *self.out = out;
    }
}

struct Intrinsic<'a, T, const N: usize> {
    form: &'a [Triple<T, N>; 3],
    velocity: &'a Pair<T, N>,
    out: &'a mut Pair<T, N>,
}

impl<T: Real, const N: usize> Work for Intrinsic<'_, T, N> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let [efg, by_u, by_v] = *self.form;
        let (velocity, mut out) = (*self.velocity, [[T::default(); N]; 2]);
        let half = T::nearest(0.5);
        for lane in 0..N {
            let [xx, xy, yy] = products(&velocity, lane);
            let [e, f, g] = [efg[0][lane], efg[1][lane], efg[2][lane]];
            let [eu, fu, gu] = [by_u[0][lane], by_u[1][lane], by_u[2][lane]];
            let [ev, fv, gv] = [by_v[0][lane], by_v[1][lane], by_v[2][lane]];
            let along_u = half * (xx * eu + xy * ev) + yy * (fv - half * gu);
            let along_v = xx * (fu - half * ev) + half * (xy * gu + yy * gv);
            let square = e * g - f * f;
            let zero = T::default();
            let r = T::ONE
                / if (e > zero) & (square > zero) {
                    square
                } else {
                    T::nearest(f64::NAN)
                };
            out[0][lane] = r * (f * along_v - g * along_u);
            out[1][lane] = r * (f * along_u - e * along_v);
        }
        *self.out = out;
    }
}

/// u'², 2u'v', v'².
#[inline(always)]
fn products<T: Real, const N: usize>(velocity: &Pair<T, N>, lane: usize) -> [T; 3] {
    let [x, y] = [velocity[0][lane], velocity[1][lane]];
    let mixed = x * y;
    [x * x, mixed + mixed, y * y]
}
