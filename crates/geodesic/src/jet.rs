//! A surface's position with its derivatives, at one point and at several points side by side.

#![allow(clippy::needless_range_loop)] // Several arrays are traversed together, lane by lane.

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

impl Jet {
    /// Reverses u or v, or both, where the sign is −1.
    #[inline(always)]
    pub(crate) fn reflect(&mut self, [s, t]: [f64; 2]) {
        self.du = self.du.map(|x| s * x);
        self.dv = self.dv.map(|x| t * x);
        self.duv = self.duv.map(|x| s * t * x);
    }
}

/// The number of points that a [`JetBlock`] holds.
pub const LANES: usize = expr::jets::LANES;

/// One number for each lane.
pub type Lanes = [f64; LANES];

/// The jets at [`LANES`] points, component by component: `du[k][lane]` is the k-th component of σu at a lane's point.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
#[allow(missing_docs)]
pub struct JetBlock {
    pub position: [Lanes; 3],
    pub du: [Lanes; 3],
    pub dv: [Lanes; 3],
    pub duu: [Lanes; 3],
    pub duv: [Lanes; 3],
    pub dvv: [Lanes; 3],
}

impl Default for JetBlock {
    fn default() -> Self {
        let nothing = [[f64::NAN; LANES]; 3];
        Self {
            position: nothing,
            du: nothing,
            dv: nothing,
            duu: nothing,
            duv: nothing,
            dvv: nothing,
        }
    }
}

impl JetBlock {
    /// Returns the jet of one lane's point.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Jet {
        let of = |block: &[Lanes; 3]| [block[0][lane], block[1][lane], block[2][lane]];
        Jet {
            position: of(&self.position),
            du: of(&self.du),
            dv: of(&self.dv),
            duu: of(&self.duu),
            duv: of(&self.duv),
            dvv: of(&self.dvv),
        }
    }

    /// Sets the jet of one lane's point.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, jet: &Jet) {
        for k in 0..3 {
            self.position[k][lane] = jet.position[k];
            self.du[k][lane] = jet.du[k];
            self.dv[k][lane] = jet.dv[k];
            self.duu[k][lane] = jet.duu[k];
            self.duv[k][lane] = jet.duv[k];
            self.dvv[k][lane] = jet.dvv[k];
        }
    }

    /// Reverses u or v, or both, of each lane where the sign is −1.
    #[inline(always)]
    pub(crate) fn reflect(&mut self, [s, t]: &[Lanes; 2]) {
        for k in 0..3 {
            for lane in 0..LANES {
                self.du[k][lane] *= s[lane];
                self.dv[k][lane] *= t[lane];
                self.duv[k][lane] *= s[lane] * t[lane];
            }
        }
    }
}
