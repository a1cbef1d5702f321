//! The sides of a chart's domain, and the way back into it from beyond them.

#![allow(clippy::needless_range_loop)] // Several arrays are traversed together, lane by lane.

/// The kind of one side of the domain.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Side {
    /// Nothing: the surface ends.
    #[default]
    Edge,
    /// The opposite side: σ(u₀,v) = σ(u₁,v).
    Wrap,
    /// The opposite side, reversed: σ(u₀,v) = σ(u₁,v₀+v₁−v). Handedness flips.
    WrapFlip,
    /// The side is one point, passed by continuing half a period further along the other, wrapping, parameter.
    Pole,
}

/// The four sides: `u[0]` at u min, `u[1]` at u max, likewise `v`.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
#[allow(missing_docs)]
pub struct Sides {
    pub u: [Side; 2],
    pub v: [Side; 2],
}

/// The change of coordinates when a point is brought back into the domain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The signs by which the components of a vector change.
    pub signs: [f64; 2],
    /// True if left and right are exchanged: by a flip, but not by a pole, behind which the formula's own coordinates
    /// are mirrored.
    pub flipped: bool,
}

impl Sides {
    /// Returns the two sides of an axis: 0 for u, 1 for v.
    #[inline(always)]
    pub fn of(&self, axis: usize) -> [Side; 2] {
        if axis == 0 { self.u } else { self.v }
    }

    /// Brings a point back into the domain through poles, then through the sides that wrap.
    pub fn bring_back(&self, domain: [[f64; 2]; 2], at: &mut [f64; 2]) -> Crossing {
        let mut points = at.map(|x| [x]);
        let crossings = self.bring_all_back(domain, &mut points);
        *at = points.map(|[x]| x);
        crossings.of(0)
    }

    /// Brings a point back into the domain through the sides that wrap alone, however many turns away it is.
    pub fn wrap(&self, domain: [[f64; 2]; 2], at: &mut [f64; 2]) -> Crossing {
        let mut points = at.map(|x| [x]);
        let crossings = self.wrap_all(domain, &mut points);
        *at = points.map(|[x]| x);
        crossings.of(0)
    }

    /// Brings points back into the domain, as [`Sides::bring_back`] does each.
    #[inline(always)]
    pub(crate) fn bring_all_back<const N: usize>(
        &self,
        domain: [[f64; 2]; 2],
        at: &mut [[f64; N]; 2],
    ) -> Crossings<N> {
        let mut mirrored = [[1.0; N]; 2];
        for axis in 0..2 {
            let [low, high] = domain[axis];
            let half = 0.5 * (domain[1 - axis][1] - domain[1 - axis][0]);
            for end in 0..2 {
                if self.of(axis)[end] != Side::Pole {
                    continue;
                }
                // Through a pole: the same distance beyond it, half a turn on.
                for lane in 0..N {
                    let x = at[axis][lane];
                    let (beyond, back) = if end == 0 {
                        (low - x, low + (low - x))
                    } else {
                        (x - high, high - (x - high))
                    };
                    let passed = (beyond > 0.0) & (beyond <= high - low);
                    at[axis][lane] = if passed { back } else { x };
                    at[1 - axis][lane] += if passed { half } else { 0.0 };
                    mirrored[axis][lane] *= if passed { -1.0 } else { 1.0 };
                }
            }
        }
        let mut crossings = self.wrap_all(domain, at);
        for (signs, mirrored) in crossings.signs.iter_mut().zip(&mirrored) {
            for lane in 0..N {
                signs[lane] *= mirrored[lane];
            }
        }
        crossings
    }

    #[inline(always)]
    fn wrap_all<const N: usize>(
        &self,
        domain: [[f64; 2]; 2],
        at: &mut [[f64; N]; 2],
    ) -> Crossings<N> {
        let mut crossings = Crossings {
            signs: [[1.0; N]; 2],
            flipped: [false; N],
        };
        for axis in 0..2 {
            let [low, high] = domain[axis];
            let side = self.of(axis)[0];
            if !matches!(side, Side::Wrap | Side::WrapFlip) {
                continue;
            }
            let width = high - low;
            let share = 1.0 / width;
            let mut odd = [false; N];
            for lane in 0..N {
                let x = at[axis][lane];
                let turns = ((x - low) * share).floor();
                let back = x - turns * width;
                let back = if back < low { low } else { back };
                let back = if back > high { high } else { back };
                let inside = (x >= low) & (x <= high);
                at[axis][lane] = if inside { x } else { back };
                odd[lane] = !inside & (turns - 2.0 * (0.5 * turns).floor() == 1.0);
            }
            // A flip reverses the other coordinate.
            if side == Side::WrapFlip {
                let [low, high] = domain[1 - axis];
                for lane in 0..N {
                    let x = at[1 - axis][lane];
                    at[1 - axis][lane] = if odd[lane] { low + high - x } else { x };
                    crossings.signs[1 - axis][lane] *= if odd[lane] { -1.0 } else { 1.0 };
                    crossings.flipped[lane] ^= odd[lane];
                }
            }
        }
        crossings
    }
}

/// The changes of several points' coordinates; see [`Crossing`].
pub(crate) struct Crossings<const N: usize> {
    pub(crate) signs: [[f64; N]; 2],
    flipped: [bool; N],
}

impl<const N: usize> Crossings<N> {
    fn of(&self, lane: usize) -> Crossing {
        Crossing {
            signs: [self.signs[0][lane], self.signs[1][lane]],
            flipped: self.flipped[lane],
        }
    }
}
