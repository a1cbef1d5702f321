//! A surface's position with its derivatives at a point, and at several points side by side.

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
    /// Puts the jet of one lane's point.
    pub fn set(&mut self, lane: usize, jet: &Jet) {
        let parts = [
            (&mut self.position, jet.position),
            (&mut self.du, jet.du),
            (&mut self.dv, jet.dv),
            (&mut self.duu, jet.duu),
            (&mut self.duv, jet.duv),
            (&mut self.dvv, jet.dvv),
        ];
        for (block, vector) in parts {
            for (lanes, component) in block.iter_mut().zip(vector) {
                lanes[lane] = component;
            }
        }
    }
}
