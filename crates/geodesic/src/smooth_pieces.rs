//! The pieces of a chart on which the formulas of a surface are smooth. In: expressions. Out: a number for each piece.
//!
//! Where an absolute value, a minimum or a maximum changes from one of its formulas to the other, σ may have a crease. The
//! signs of what they compare tell on which side of each crease a point is.

use std::cell::RefCell;

use expr::graph::TooLarge;
use expr::interval::{Interval, Slope};
use expr::jets::{Fixed, JetRegisters, JetTape, Order};
use expr::tape::{Registers, Tape};
use expr::{Graph, Input, NodeId};

use crate::point::Uv;
use crate::step_path::{Borders, PathPart};

/// The maximum number of corners that are examined by intervals, which for more would take most of the time.
const MOST_CORNERS: usize = 8;
/// A factor for the rounding of a product.
const ROUNDED: f64 = 1.0 + 4.0 * f64::EPSILON;
/// Rounding outward makes less than this of a zero.
const ZERO: f64 = 1e-300;

/// The signs of a surface's corners ([`Graph::corners`]), with the uniforms' values fixed.
#[derive(Clone, Debug)]
pub(crate) struct SmoothPieces {
    corners: JetTape,
    fixed: Fixed,
    /// The same corners for intervals.
    tape: Tape,
    /// The tape's inputs.
    inputs: Vec<PieceInput>,
}

/// An input of a [`SmoothPieces::tape`].
#[derive(Clone, Copy, Debug)]
enum PieceInput {
    /// A coordinate: 0 for u, 1 for v.
    Coordinate(usize),
    /// A uniform with its value.
    Fixed(f64),
}

/// Registers, inputs and results for intervals.
#[derive(Default)]
struct Ranges {
    registers: Registers,
    inputs: Vec<Interval>,
    values: Vec<Interval>,
    middles: Vec<Interval>,
    slope_inputs: Vec<Slope>,
    slopes: Vec<Slope>,
}

thread_local! {
    /// Registers and results, one set per thread, to avoid allocations.
    static SCRATCH: RefCell<(JetRegisters, Vec<[f64; 1]>)> = RefCell::default();
    static RANGES: RefCell<Ranges> = RefCell::default();
}

impl SmoothPieces {
    /// Compiles the corners of the roots; `None` where there are none. `uniform` gives the values of the uniforms.
    ///
    /// # Errors
    /// [`TooLarge`] where they do not fit into the graph's limit.
    pub(crate) fn of(
        graph: &Graph,
        roots: &[NodeId],
        uniform: impl Fn(&Input) -> f64,
    ) -> Result<Option<Self>, TooLarge> {
        let (mut graph, roots) = graph.extract(roots);
        let corners = graph.corners(&roots);
        if corners.is_empty() {
            return Ok(None);
        }
        let tape = Tape::new(&graph, &corners);
        let input = |input: &Input| match *input {
            Input::Variable(k) => PieceInput::Coordinate((k as usize).min(1)),
            Input::Uniform(_) => PieceInput::Fixed(uniform(input)),
        };
        let inputs = tape.inputs().iter().map(input).collect();
        let variables = [Input::Variable(0), Input::Variable(1)];
        let corners = JetTape::new(&graph, &corners, variables, Order::Value)?;
        let values: Vec<f64> = corners.uniforms().iter().map(uniform).collect();
        let fixed = corners.fix(&values);
        Ok(Some(Self {
            corners,
            fixed,
            tape,
            inputs,
        }))
    }

    /// Returns the number of the piece to which a point belongs.
    pub(crate) fn at(&self, uv: Uv) -> u64 {
        SCRATCH.with_borrow_mut(|(registers, values)| {
            values.clear();
            values.resize(self.corners.root_count(), [0.0]);
            let at = uv.0.map(|x| [x]);
            self.corners.eval(registers, &self.fixed, &at, values);
            let positive = values.iter().map(|[value]| u64::from(*value > 0.0));
            positive.fold(0, |piece: u64, sign| piece.rotate_left(1) ^ sign)
        })
    }

    /// Returns true if all points of a box belong to one piece and none is on a crease; false where intervals cannot decide.
    /// True also where there are too many corners to be examined.
    pub(crate) fn is_one(&self, within: [Interval; 2]) -> bool {
        if self.tape.root_count() > MOST_CORNERS {
            return true;
        }
        RANGES.with_borrow_mut(|ranges| {
            let Ranges {
                registers,
                inputs,
                values,
                ..
            } = ranges;
            self.values(registers, inputs, within, values);
            values.iter().all(has_one_sign)
        })
    }

    /// Returns what is known of the creases along a part of a path; as [`SmoothPieces::is_one`] does where there are too many
    /// corners.
    pub(crate) fn along(&self, part: &PathPart<2>) -> Borders {
        let within = part.within();
        if self.is_one(within) {
            return Borders::None;
        }
        RANGES.with_borrow_mut(|ranges| {
            let Ranges {
                registers,
                inputs,
                values,
                middles,
                slope_inputs,
                slopes,
            } = ranges;
            if values.iter().any(|value| value.is_partial()) {
                return Borders::Unknown;
            }
            slope_inputs.clear();
            slope_inputs.extend(self.inputs.iter().map(|input| match *input {
                PieceInput::Coordinate(k) => part.coordinates[k],
                PieceInput::Fixed(x) => Slope::constant(x),
            }));
            slopes.clear();
            slopes.resize(self.tape.root_count(), Slope::constant(0.0));
            self.tape.eval_slopes(registers, slope_inputs, slopes);
            let is_decided =
                |(value, slope): (&Interval, &Slope)| has_one_sign(value) || slope.is_monotone();
            let all_decided = values.iter().zip(&*slopes).all(is_decided);
            if !all_decided {
                self.values(registers, inputs, part.middle, middles);
            }
            let mut known = Borders::None;
            for (k, (value, slope)) in values.iter().zip(&*slopes).enumerate() {
                if has_one_sign(value) {
                    continue;
                }
                if slope.is_monotone() {
                    known = Borders::CrossedOnce;
                    continue;
                }
                // The mean value theorem.
                let reach = part.half * slope.slope.lower().abs().max(slope.slope.upper().abs());
                let middle = &middles[k];
                let is_far = middle.lower() > reach * ROUNDED || middle.upper() < -reach * ROUNDED;
                if middle.is_partial() || !is_far {
                    return Borders::Unknown;
                }
            }
            known
        })
    }

    /// Evaluates the corners on a box.
    fn values(
        &self,
        registers: &mut Registers,
        inputs: &mut Vec<Interval>,
        within: [Interval; 2],
        values: &mut Vec<Interval>,
    ) {
        inputs.clear();
        inputs.extend(self.inputs.iter().map(|input| match *input {
            PieceInput::Coordinate(k) => within[k],
            PieceInput::Fixed(x) => Interval::point(x),
        }));
        values.clear();
        values.resize(self.tape.root_count(), Interval::point(0.0));
        self.tape.eval_intervals(registers, inputs, values);
    }
}

/// Returns true if a corner has one sign, or is 0 everywhere: where what is compared is the same, both formulas are.
fn has_one_sign(value: &Interval) -> bool {
    let is_zero = value.lower() > -ZERO && value.upper() < ZERO;
    !value.is_partial() && (value.lower() > 0.0 || value.upper() < 0.0 || is_zero)
}
