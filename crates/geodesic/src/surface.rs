//! Surfaces for geodesics. In: expressions. Out: jets.

use std::cell::RefCell;

use expr::graph::TooLarge;
use expr::interval::Interval;
use expr::jets::{Fixed, JetRegisters, JetTape, Order};
use expr::{Graph, Input, NodeId};

use crate::point::Uv;
use crate::smooth_pieces::SmoothPieces;
use crate::step_path::{Borders, PathPart};
use crate::topology::{Apex, Topology};

pub use crate::jet::{Jet, JetBlock, LANES, Lanes};
pub use crate::scale::Scale;
pub use crate::sides::{Crossing, Side, Sides};

/// A parametrised surface σ: R² → R³. Undefined values are NaN. Cheap to call from many threads.
pub trait Surface: Sync {
    /// Returns the jet at (u, v).
    fn jet(&self, uv: Uv) -> Jet;
    /// Computes the jets at [`LANES`] points (`at[0]` their u, `at[1]` their v), each equal to [`Surface::jet`]'s up to
    /// rounding.
    fn jets(&self, at: &[Lanes; 2], out: &mut JetBlock) {
        let [us, vs] = at;
        for (lane, (&u, &v)) in us.iter().zip(vs).enumerate() {
            out.set(lane, &self.jet(Uv([u, v])));
        }
    }
    /// Returns a number for the part of the chart to which a point belongs. Within the points of one number the formulas are
    /// smooth; where it changes, the surface may have a crease. 0 everywhere where nothing is known about creases.
    fn smooth_piece(&self, _uv: Uv) -> u64 {
        0
    }
    /// Returns true if all points of a box of the chart have one [`Surface::smooth_piece`] and none is on a crease; false where
    /// that cannot be decided.
    fn is_one_piece(&self, _within: [Interval; 2]) -> bool {
        true
    }
    /// Returns what is known of the creases along a part of a path in the chart.
    fn creases_along(&self, part: &PathPart<2>) -> Borders {
        Borders::none_if(self.is_one_piece(part.within()))
    }
    /// Returns whether positions are points in space. A metric without an embedding gives jets in a separate frame at each
    /// point: inner products and Gauss's equation hold in each, but vectors at different points, and positions, must not be
    /// compared.
    fn is_embedded(&self) -> bool {
        true
    }
    /// Returns the number of instructions of a jet; 0 where unknown.
    fn instruction_count(&self) -> usize {
        0
    }
    /// Returns the data of the surface's chart.
    fn chart_data(&self) -> &ChartData;
    /// Returns the domain: `[[u min, u max], [v min, v max]]`.
    fn domain(&self) -> [[f64; 2]; 2] {
        self.chart_data().domain
    }
    /// Returns the kinds of the domain's sides.
    fn sides(&self) -> Sides {
        self.chart_data().topology.sides
    }
    /// Returns the side's single point, if the side has collapsed to one: `axis` 0 for a side of constant u, 1 for
    /// constant v; `end` 0 for its minimum, 1 for its maximum.
    fn apex(&self, axis: usize, end: usize) -> Option<Apex> {
        self.chart_data().topology.apexes[axis][end]
    }
    /// Returns the typical lengths of the surface.
    fn scale(&self) -> Scale {
        self.chart_data().scale
    }
}

/// Limits on evaluations are stated for surfaces whose jets have at most this many instructions.
pub const USUAL_INSTRUCTIONS: usize = 200;

/// Returns the limit on evaluations for a surface: if its jets have k times [`USUAL_INSTRUCTIONS`], `limit` over k, which
/// bounds the run time.
pub fn affordable_evaluations(surface: &dyn Surface, limit: u64) -> u64 {
    let [cost, usual] = [surface.instruction_count(), USUAL_INSTRUCTIONS].map(|n| n as u64);
    if cost <= usual {
        return limit;
    }
    (u128::from(limit) * u128::from(usual) / u128::from(cost)) as u64
}

/// The data of a chart, besides the surface's jets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChartData {
    /// `[[u min, u max], [v min, v max]]`.
    pub domain: [[f64; 2]; 2],
    /// The kinds of its sides.
    pub topology: Topology,
    /// Typical lengths of the surface.
    pub scale: Scale,
}

impl ChartData {
    /// Creates the data of a domain of which nothing else is known yet.
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

/// A surface given by expressions in `Variable(0)` = u and `Variable(1)` = v, with the uniforms' values fixed. All
/// three components are one tape, so that they share their subexpressions. Cheap to create: nothing is differentiated
/// symbolically.
#[derive(Clone, Debug)]
pub struct ParametricSurface {
    tape: JetTape,
    fixed: Fixed,
    pieces: Option<SmoothPieces>,
    chart_data: ChartData,
}

thread_local! {
    /// Registers, one set per thread for single points and one for lanes, to avoid allocations and so that neither
    /// overwrites the other's constants.
    static REGISTERS: RefCell<[JetRegisters; 2]> = RefCell::default();
}

impl ParametricSurface {
    /// Compiles the position, and determines the kinds of the sides. A uniform without a value is NaN, which makes the
    /// surface undefined.
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
        let value = |input: &Input| input.value(&[], uniforms);
        let values: Vec<f64> = tape.uniforms().iter().map(value).collect();
        let fixed = tape.fix(&values);
        let pieces = SmoothPieces::of(graph, &position, value)?;
        let mut surface = Self {
            tape,
            fixed,
            pieces,
            chart_data: ChartData::of(domain),
        };
        surface.chart_data.scale = Scale::measure(&|uv| surface.jet(uv), domain);
        surface.chart_data.topology = Topology::find(&|uv| surface.jet(uv), domain);
        Ok(surface)
    }
}

impl Surface for ParametricSurface {
    fn jet(&self, uv: Uv) -> Jet {
        let mut out = [[[f64::NAN]; 3]; 6];
        REGISTERS.with_borrow_mut(|[registers, _]| {
            let at = uv.0.map(|x| [x]);
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
            // The block's fields are in the order of coefficients, each with a vector's components.
            let out: &mut [Lanes; 18] = bytemuck::cast_mut(out);
            self.tape.eval(registers, &self.fixed, at, out);
        });
    }

    fn smooth_piece(&self, uv: Uv) -> u64 {
        self.pieces.as_ref().map_or(0, |pieces| pieces.at(uv))
    }

    fn is_one_piece(&self, within: [Interval; 2]) -> bool {
        self.pieces
            .as_ref()
            .is_none_or(|pieces| pieces.is_one(within))
    }

    fn creases_along(&self, part: &PathPart<2>) -> Borders {
        let pieces = self.pieces.as_ref();
        pieces.map_or(Borders::None, |pieces| pieces.along(part))
    }

    fn instruction_count(&self) -> usize {
        self.tape.instruction_count()
    }

    fn chart_data(&self) -> &ChartData {
        &self.chart_data
    }
}
