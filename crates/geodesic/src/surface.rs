//! What a geodesic needs to know of a surface: expressions in, jets out.

use std::cell::RefCell;

use expr::graph::TooLarge;
use expr::jets::{Fixed, JetRegisters, JetTape, Order};
use expr::{Graph, Input, NodeId};

use crate::accelerations;
use crate::topology::{Apex, Topology};

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

/// How many points a [`JetBlock`] holds.
pub const LANES: usize = expr::jets::LANES;

/// One number for each lane.
pub type Lanes = [f64; LANES];

/// How many points are worked on at once in single precision: as wide as [`LANES`] in double.
pub const SINGLES: usize = 2 * LANES;

/// One number in single precision for each lane.
pub type Singles = [f32; SINGLES];

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

/// A parametrised surface σ: R² → R³. Undefined values are NaN. Cheap to call from many threads.
pub trait Surface: Sync {
    /// The jet at (u, v).
    fn jet(&self, uv: [f64; 2]) -> Jet;
    /// The jets at [`LANES`] points (`at[0]` their u, `at[1]` their v), each the same as [`Surface::jet`]'s but for
    /// rounding.
    fn jets(&self, at: &[Lanes; 2], out: &mut JetBlock) {
        let [us, vs] = at;
        for (lane, (&u, &v)) in us.iter().zip(vs).enumerate() {
            out.set(lane, &self.jet([u, v]));
        }
    }
    /// The acceleration (u'', v'') of the geodesic at a point with this velocity: all that the thesis' method asks for,
    /// see [`crate::map::Method::Rk4`].
    fn acceleration(&self, at: [f64; 2], velocity: [f64; 2]) -> [f64; 2] {
        crate::metric::acceleration(&self.jet(at), velocity)
    }
    /// The same at [`LANES`] points.
    fn accelerations(&self, at: &[Lanes; 2], velocity: &[Lanes; 2], out: &mut [Lanes; 2]) {
        let mut jets = JetBlock::default();
        self.jets(at, &mut jets);
        accelerations::embedded(bytemuck::cast_ref(&jets), velocity, out);
    }
    /// The same at [`SINGLES`] points in single precision. Without an implementation of its own only rounded to it.
    fn accelerations_single(
        &self,
        at: &[Singles; 2],
        velocity: &[Singles; 2],
        out: &mut [Singles; 2],
    ) {
        for lane in 0..SINGLES {
            let [at, velocity] = [at, velocity].map(|x| x.map(|x| f64::from(x[lane])));
            let exact = self.acceleration(at, velocity);
            for (out, exact) in out.iter_mut().zip(exact) {
                out[lane] = exact as f32;
            }
        }
    }
    /// Whether positions are places in space. A metric without an embedding gives jets in a frame of its own at each
    /// point: inner products and Gauss's equation hold in each, but vectors at different points, and positions, are
    /// not to be compared.
    fn is_embedded(&self) -> bool {
        true
    }
    /// What is known of it beside its jets.
    fn outline(&self) -> &Outline;
    /// The domain: `[[u min, u max], [v min, v max]]`.
    fn domain(&self) -> [[f64; 2]; 2] {
        self.outline().domain
    }
    /// What lies beyond each side of the domain.
    fn sides(&self) -> Sides {
        self.outline().topology.sides
    }
    /// The side's single point, where the side has collapsed to one: `axis` 0 for a side of constant u, 1 for
    /// constant v; `end` 0 for its minimum, 1 for its maximum.
    fn apex(&self, axis: usize, end: usize) -> Option<Apex> {
        self.outline().topology.apexes[axis][end]
    }
    /// Lengths typical of the surface.
    fn scale(&self) -> Scale {
        self.outline().scale
    }
}

/// What is known of a surface beside its jets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outline {
    /// `[[u min, u max], [v min, v max]]`.
    pub domain: [[f64; 2]; 2],
    /// What lies beyond the sides.
    pub topology: Topology,
    /// Lengths typical of it.
    pub scale: Scale,
}

impl Outline {
    /// A domain of which nothing else is known yet.
    pub(crate) fn of(domain: [[f64; 2]; 2]) -> Self {
        Self {
            domain,
            topology: Topology::default(),
            scale: Scale {
                size: 1.0,
                stretch: [1.0; 2],
            },
        }
    }
}

/// Lengths typical of a surface: what "small" is compared with. All finite and positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// The extent in space of a sample of its points.
    pub size: f64,
    /// The median of |σu| and of |σv| over the sample.
    pub stretch: [f64; 2],
}

impl Scale {
    /// Measures on a lattice of interior points; those that are undefined are passed over.
    pub fn measure(jet: &dyn Fn([f64; 2]) -> Jet, domain: [[f64; 2]; 2]) -> Self {
        const LATTICE: u32 = 5;
        let mut positions: Vec<[f64; 3]> = Vec::new();
        let mut stretches: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
        for i in 0..LATTICE {
            for j in 0..LATTICE {
                // Off the lattice's own symmetry, so that no special line of the surface is favoured.
                let share = [
                    (f64::from(i) + 0.43) / f64::from(LATTICE),
                    (f64::from(j) + 0.61) / f64::from(LATTICE),
                ];
                let at = jet(crate::topology::at(domain, share));
                if at.position.iter().all(|x| x.is_finite()) {
                    positions.push(at.position);
                }
                for (stretch, d) in stretches.iter_mut().zip([at.du, at.dv]) {
                    let length = crate::metric::norm(d);
                    if length.is_finite() && length > 0.0 {
                        stretch.push(length);
                    }
                }
            }
        }
        let extent = (0..3).map(|k| {
            let (low, high) = positions
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
                    (low.min(p[k]), high.max(p[k]))
                });
            high - low
        });
        let size = extent.fold(0.0, f64::max);
        let median = |values: &mut Vec<f64>| {
            values.sort_unstable_by(f64::total_cmp);
            values.get(values.len() / 2).copied().unwrap_or(1.0)
        };
        let [us, vs] = &mut stretches;
        Self {
            size: if size > 0.0 && size.is_finite() {
                size
            } else {
                1.0
            },
            stretch: [median(us), median(vs)],
        }
    }
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

impl Sides {
    /// The two sides of an axis: 0 for u, 1 for v.
    pub fn of(&self, axis: usize) -> [Side; 2] {
        if axis == 0 { self.u } else { self.v }
    }
}

/// A surface given by expressions in `Variable(0)` = u and `Variable(1)` = v, with the uniforms' values fixed. All
/// three components are one tape, so that they share their subexpressions. Cheap to make: nothing is derived
/// symbolically.
#[derive(Clone, Debug)]
pub struct ParametricSurface {
    tape: JetTape,
    fixed: Fixed,
    outline: Outline,
}

thread_local! {
    /// Registers, one set per thread for single points and one for lanes, so that none allocates and neither
    /// displaces the other's constants.
    static REGISTERS: RefCell<[JetRegisters; 2]> = RefCell::default();
    /// The same in single precision.
    static SINGLE: RefCell<JetRegisters<f32>> = RefCell::default();
}

impl ParametricSurface {
    /// Compiles the position, and looks for what lies beyond the sides. A uniform without a value is NaN: the surface
    /// is undefined then.
    ///
    /// # Errors
    /// [`TooLarge`] where the derivatives do not fit into the graph's limit.
    pub fn new(
        graph: &Graph,
        position: [NodeId; 3],
        domain: [[f64; 2]; 2],
        uniforms: &[f64],
    ) -> Result<Self, TooLarge> {
        let variables = [Input::Variable(0), Input::Variable(1)];
        let tape = JetTape::new(graph, &position, variables, Order::Second)?;
        let values: Vec<f64> = tape
            .uniforms()
            .iter()
            .map(|input| match *input {
                Input::Variable(_) => f64::NAN,
                Input::Uniform(k) => uniforms.get(k as usize).copied().unwrap_or(f64::NAN),
            })
            .collect();
        let fixed = tape.fix(&values);
        let mut surface = Self {
            tape,
            fixed,
            outline: Outline::of(domain),
        };
        surface.outline.scale = Scale::measure(&|uv| surface.jet(uv), domain);
        surface.outline.topology = Topology::find(&|uv| surface.jet(uv), domain);
        Ok(surface)
    }
}

impl Surface for ParametricSurface {
    fn jet(&self, uv: [f64; 2]) -> Jet {
        let mut out = [[[f64::NAN]; 3]; 6];
        REGISTERS.with_borrow_mut(|[registers, _]| {
            let at = uv.map(|x| [x]);
            let out = out.as_flattened_mut();
            self.tape.eval(registers, &self.fixed, &at, out);
        });
        let [position, du, dv, duu, duv, dvv] = out.map(|vector| vector.map(|[x]| x));
        Jet {
            position,
            du,
            dv,
            duu,
            duv,
            dvv,
        }
    }

    fn jets(&self, at: &[Lanes; 2], out: &mut JetBlock) {
        REGISTERS.with_borrow_mut(|[_, registers]| {
            // The block's fields are in the order of coefficients, each a vector's components.
            let out: &mut [Lanes; 18] = bytemuck::cast_mut(out);
            self.tape.eval(registers, &self.fixed, at, out);
        });
    }

    fn accelerations_single(
        &self,
        at: &[Singles; 2],
        velocity: &[Singles; 2],
        out: &mut [Singles; 2],
    ) {
        let mut derivatives = [[[f32::NAN; SINGLES]; 3]; 6];
        SINGLE.with_borrow_mut(|registers| {
            let derivatives = derivatives.as_flattened_mut();
            self.tape.eval(registers, &self.fixed, at, derivatives);
        });
        accelerations::embedded(&derivatives, velocity, out);
    }

    fn outline(&self) -> &Outline {
        &self.outline
    }
}
