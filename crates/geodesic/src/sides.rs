//! What lies beyond the sides of a chart's domain, and the way back into it.

/// The kind of one side of the domain.
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

/// How coordinates change on the way back into the domain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The signs by which the components of a vector change.
    pub signs: [f64; 2],
    /// True if left and right have changed places: by a flip, but not by a pole, behind which the formula's own
    /// coordinates are the mirrored ones.
    pub flipped: bool,
}

impl Sides {
    /// The two sides of an axis: 0 for u, 1 for v.
    pub fn of(&self, axis: usize) -> [Side; 2] {
        if axis == 0 { self.u } else { self.v }
    }

    /// Brings a point back into the domain through poles, then through the sides that wrap.
    pub fn bring_back(&self, domain: [[f64; 2]; 2], at: &mut [f64; 2]) -> Crossing {
        let mut signs = [1.0; 2];
        for axis in 0..2 {
            let [low, high] = domain[axis];
            let sides = self.of(axis);
            // Through a pole: as far beyond it, half a turn on.
            for (end, beyond) in [low - at[axis], at[axis] - high].into_iter().enumerate() {
                if sides[end] == Side::Pole && beyond > 0.0 && beyond <= high - low {
                    at[axis] = if end == 0 {
                        low + beyond
                    } else {
                        high - beyond
                    };
                    let [first, last] = domain[1 - axis];
                    at[1 - axis] += 0.5 * (last - first);
                    signs[axis] = -signs[axis];
                }
            }
        }
        let wrapped = self.wrap(domain, at);
        Crossing {
            signs: [0, 1].map(|k| signs[k] * wrapped.signs[k]),
            ..wrapped
        }
    }

    /// Brings a point back into the domain through the sides that wrap, however many turns away it is. A flip turns
    /// the other coordinate over.
    pub fn wrap(&self, domain: [[f64; 2]; 2], at: &mut [f64; 2]) -> Crossing {
        let mut crossing = Crossing {
            signs: [1.0; 2],
            flipped: false,
        };
        for axis in 0..2 {
            let [low, high] = domain[axis];
            let side = self.of(axis)[0];
            let wraps = matches!(side, Side::Wrap | Side::WrapFlip);
            if !wraps || (low..=high).contains(&at[axis]) {
                continue;
            }
            let turns = ((at[axis] - low) / (high - low)).floor();
            at[axis] = (at[axis] - turns * (high - low)).clamp(low, high);
            if side == Side::WrapFlip && turns.rem_euclid(2.0) == 1.0 {
                let [low, high] = domain[1 - axis];
                at[1 - axis] = low + high - at[1 - axis];
                crossing.signs[1 - axis] = -crossing.signs[1 - axis];
                crossing.flipped = !crossing.flipped;
            }
        }
        crossing
    }
}
