//! Surfaces without a chart: the points of space where a field is 0. Geodesics on them run in space.
//!
//! ```text
//! expr ──implicit.rs──▶ smooth pieces of the field ──curvature──▶ acceleration, K
//!                                │                                     │
//!                   place: onto the surface            ray.rs: steps and corrections ──▶ trace.rs: an end and a status
//!                                │                                     │
//!                        frame.rs (camera) ──────────▶ fan.rs: shared rays ──ends.rs──▶ piecewise.rs
//! ```
//!
//! A field may have kinks (`max`, `min`, `abs`): where set operations join solids, where an interval cuts one. With each of
//! them decided as at one point, it is smooth: a *piece*. A ray runs on the piece on which it starts, and ends at an edge,
//! where another piece takes over.

mod fan;
mod frame;
mod ray;
mod trace;

use std::cell::RefCell;
use std::collections::HashMap;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use expr::interval::Interval;
use expr::ops::{Binary, Unary};
use expr::tape::{Registers, Tape};
use expr::{Graph, Input, Node, NodeId, TooLarge};

use crate::vector::{combine, cross, dot, norm};

pub use fan::SpaceFan;
pub use frame::SpaceFrame;
pub use trace::{SpacePoints, SpaceTrace, SpaceTraceError};

/// The surface where a field in `Variable(0)`, `Variable(1)` and `Variable(2)` is 0, with the uniforms' values fixed.
#[derive(Debug)]
pub struct ImplicitSurface {
    graph: Graph,
    root: NodeId,
    kinks: Vec<Kink>,
    /// The kinks on which the root depends without another kink between.
    outermost: Vec<u32>,
    /// The field's value, then both operands of each kink.
    decisions: PlaceTape,
    size: f64,
    pieces: Mutex<HashMap<Vec<u32>, Arc<FieldPiece>>>,
}

/// An operation that is not smooth, with the kinks on which each operand depends without another kink between.
#[derive(Clone, Debug)]
struct Kink {
    node: NodeId,
    /// Twice the same where it has one.
    operands: [NodeId; 2],
    below: [Vec<u32>; 2],
}

/// The decisions of the kinks that matter at a point: twice a kink's index, plus 1 where its second operand is
/// selected. In ascending order.
type Decisions = Vec<u32>;

/// Expressions evaluated at points of space.
#[derive(Debug)]
struct PlaceTape {
    tape: Tape,
    /// For each input of the tape, the coordinate that it is; `None` for an input without a value.
    coordinates: Vec<Option<usize>>,
}

/// A smooth piece of the field: its value, its gradient, and the second derivatives by xx, xy, xz, yy, yz, zz.
#[derive(Debug)]
pub(crate) struct FieldPiece {
    decisions: Decisions,
    tape: PlaceTape,
}

/// The data of a piece's surface at a point, independent of the field's scale.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalShape {
    /// The field over its gradient's length: the approximate distance to the surface.
    pub(crate) distance: f64,
    /// ∇f/|∇f|.
    pub(crate) normal: [f64; 3],
    /// The second derivatives over the gradient's length, by rows.
    pub(crate) bend: [[f64; 3]; 3],
    /// The Gaussian curvature of the level surface of f through the point.
    pub(crate) curvature: f64,
    /// |∇f|.
    slope: f64,
}

/// The reason why a point cannot be moved onto a surface. Its text is the end of a sentence about the point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlaceError {
    /// A coordinate is not a finite number.
    NotFinite,
    /// The field is undefined there.
    Undefined,
    /// The field has no gradient at a point on the way.
    NoGradient,
    /// No surface was found along the gradient.
    NotFound,
}

/// A point is on the surface within this fraction of its coordinates, or of the surface's size.
const ON_SURFACE: f64 = 1e-13;
/// The maximum number of steps towards the surface.
const MOST_STEPS: usize = 200;
/// The values of two pieces are equal if they differ by at most this fraction of the terms that they may be sums of.
const SAME: f64 = 1e-13;

thread_local! {
    static SCRATCH: RefCell<TapeScratch> = RefCell::default();
}

#[derive(Default)]
struct TapeScratch {
    registers: Registers,
    inputs: Vec<f64>,
    out: Vec<f64>,
    input_intervals: Vec<Interval>,
    intervals: Vec<Interval>,
}

impl PlaceTape {
    fn new(graph: &Graph, roots: &[NodeId]) -> Self {
        let tape = Tape::new(graph, roots);
        let coordinate = |input: &Input| match *input {
            Input::Variable(k @ 0..3) => Some(k as usize),
            _ => None,
        };
        Self {
            coordinates: tape.inputs().iter().map(coordinate).collect(),
            tape,
        }
    }

    fn eval<T>(&self, at: [f64; 3], read: impl FnOnce(&[f64]) -> T) -> T {
        SCRATCH.with_borrow_mut(|scratch| {
            let TapeScratch {
                registers,
                inputs,
                out,
                ..
            } = scratch;
            inputs.clear();
            let coordinates = self.coordinates.iter();
            inputs.extend(coordinates.map(|k| k.map_or(f64::NAN, |k| at[k])));
            out.clear();
            out.resize(self.tape.root_count(), f64::NAN);
            self.tape.eval(registers, inputs, out);
            read(out)
        })
    }

    /// The same for all points of a box.
    fn eval_box<T>(&self, within: [Interval; 3], read: impl FnOnce(&[Interval]) -> T) -> T {
        SCRATCH.with_borrow_mut(|scratch| {
            let TapeScratch {
                registers,
                input_intervals,
                intervals,
                ..
            } = scratch;
            input_intervals.clear();
            let coordinates = self.coordinates.iter();
            input_intervals
                .extend(coordinates.map(|k| k.map_or(Interval::UNDEFINED, |k| within[k])));
            intervals.clear();
            intervals.resize(self.tape.root_count(), Interval::UNDEFINED);
            self.tape
                .eval_intervals(registers, input_intervals, intervals);
            read(intervals)
        })
    }
}

impl FieldPiece {
    /// Returns the local shape; `None` where anything is undefined, or the gradient is 0.
    pub(crate) fn shape(&self, at: [f64; 3]) -> Option<LocalShape> {
        let (value, gradient, second) = self.tape.eval(at, |out| match *out {
            [f, x, y, z, xx, xy, xz, yy, yz, zz] => {
                (f, [x, y, z], [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
            }
            _ => (f64::NAN, [f64::NAN; 3], [[f64::NAN; 3]; 3]),
        });
        let slope = norm(gradient);
        let known = value.is_finite() && slope > 0.0 && slope.is_finite();
        if !known || second.iter().flatten().any(|x| !x.is_finite()) {
            return None;
        }
        let normal = gradient.map(|x| x / slope);
        let bend = second.map(|row| row.map(|x| x / slope));
        Some(LocalShape {
            distance: value / slope,
            normal,
            bend,
            curvature: curvature(normal, &bend),
            slope,
        })
    }

    /// Returns the field's value; NaN where it is undefined.
    fn value(&self, at: [f64; 3]) -> f64 {
        self.tape.eval(at, |out| out[0])
    }
}

/// K = ∇fᵀ adj(H) ∇f / |∇f|⁴, from ∇f and H over |∇f| (Goldman, *Curvature formulas for implicit curves and surfaces*, CAGD
/// 22, 2005, section 4).
fn curvature(n: [f64; 3], h: &[[f64; 3]; 3]) -> f64 {
    let minor = |i: usize, j: usize| {
        let [a, b] = [(i + 1) % 3, (i + 2) % 3];
        let [c, d] = [(j + 1) % 3, (j + 2) % 3];
        h[a][c] * h[b][d] - h[a][d] * h[b][c]
    };
    let mut sum = 0.0;
    for i in 0..3 {
        for j in 0..3 {
            sum += n[i] * n[j] * minor(i, j);
        }
    }
    sum
}

impl LocalShape {
    /// Returns H v over |∇f|.
    pub(crate) fn bent(&self, v: [f64; 3]) -> [f64; 3] {
        self.bend.map(|row| dot(row, v))
    }

    /// Returns the acceleration of the geodesic with this unit velocity.
    pub(crate) fn acceleration(&self, v: [f64; 3]) -> [f64; 3] {
        let bend = dot(v, self.bent(v));
        self.normal.map(|n| -bend * n)
    }

    /// Returns the unit normal to a velocity in the tangent plane, on its left as seen from where f is positive.
    pub(crate) fn left(&self, v: [f64; 3]) -> [f64; 3] {
        cross(self.normal, v)
    }

    /// Returns a vector without its component along the normal.
    pub(crate) fn tangential(&self, v: [f64; 3]) -> [f64; 3] {
        combine(1.0, v, -dot(v, self.normal), self.normal)
    }

    /// Returns a length of the order of the radii of curvature; infinite on a plane.
    pub(crate) fn radius(&self) -> f64 {
        let square: f64 = self.bend.iter().flatten().map(|x| x * x).sum();
        1.0 / square.sqrt()
    }
}

impl ImplicitSurface {
    /// Compiles a field. A uniform without a value is NaN, which makes the field undefined. `size` is a typical length of
    /// the surface, such as its longest side, if one is known.
    ///
    /// # Errors
    /// [`TooLarge`] where the field does not fit into the graph's limit.
    pub fn new(
        graph: &Graph,
        field: NodeId,
        uniforms: &[f64],
        size: Option<f64>,
    ) -> Result<Self, TooLarge> {
        let (mut graph, roots) = graph.extract(&[field]);
        let numbers: HashMap<Input, NodeId> = graph
            .inputs(&roots)
            .into_iter()
            .filter_map(|input| match input {
                Input::Uniform(_) => Some((input, graph.constant(input.value(&[], uniforms)))),
                Input::Variable(_) => None,
            })
            .collect();
        let roots = graph.substitute(&roots, &|input| numbers.get(&input).copied())?;
        let (graph, roots) = graph.extract(&roots);
        let root = roots.first().copied().ok_or(TooLarge)?;
        let (kinks, outermost) = kinks(&graph, root);
        let mut read = vec![root];
        for kink in &kinks {
            read.extend(kink.operands);
        }
        let usable = |size: &f64| *size > 0.0 && size.is_finite();
        Ok(Self {
            decisions: PlaceTape::new(&graph, &read),
            graph,
            root,
            kinks,
            outermost,
            size: size.filter(usable).unwrap_or(f64::INFINITY),
            pieces: Mutex::default(),
        })
    }

    /// Returns the surface's typical length; infinite where none is known.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Returns true if the surface may have edges.
    pub(crate) fn has_edges(&self) -> bool {
        !self.kinks.is_empty()
    }

    /// Returns the unit normal at a point of the surface, towards where the field is positive; `None` where it has
    /// none.
    pub fn normal(&self, at: [f64; 3]) -> Option<[f64; 3]> {
        Some(self.piece_at(at).ok()?.shape(at)?.normal)
    }

    /// Returns the Gaussian curvature at a point of the surface; `None` where it has none.
    pub fn curvature(&self, at: [f64; 3]) -> Option<f64> {
        Some(self.piece_at(at).ok()?.shape(at)?.curvature)
    }

    /// Returns the field's value and the decisions at a point.
    fn decided(&self, at: [f64; 3]) -> (f64, Decisions) {
        self.decisions.eval(at, |out| {
            let mut decisions = Decisions::new();
            let mut open: Vec<u32> = self.outermost.clone();
            let mut seen = vec![false; self.kinks.len()];
            while let Some(k) = open.pop() {
                let index = k as usize;
                if std::mem::replace(&mut seen[index], true) {
                    continue;
                }
                let [a, b] = [out[1 + 2 * index], out[2 + 2 * index]];
                let second = match self.graph.node(self.kinks[index].node) {
                    // Undefined counts as outside.
                    Node::Binary(Binary::Min, ..) => b < a || a.is_nan(),
                    Node::Binary(Binary::Max, ..) => b > a || b.is_nan(),
                    _ => a < 0.0,
                };
                let second = usize::from(second);
                decisions.push(2 * k + second as u32);
                open.extend(&self.kinks[index].below[second]);
            }
            decisions.sort_unstable();
            (out[0], decisions)
        })
    }

    /// Returns the piece that is in effect at a point.
    ///
    /// # Errors
    /// [`TooLarge`] where its derivatives exceed the graph's limit.
    pub(crate) fn piece_at(&self, at: [f64; 3]) -> Result<Arc<FieldPiece>, TooLarge> {
        let decisions = match self.kinks.is_empty() {
            true => Decisions::new(),
            false => self.decided(at).1,
        };
        let mut known = self.pieces.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(piece) = known.get(&decisions) {
            return Ok(piece.clone());
        }
        let piece = Arc::new(self.piece(&decisions)?);
        known.insert(decisions, piece.clone());
        Ok(piece)
    }

    fn piece(&self, decisions: &Decisions) -> Result<FieldPiece, TooLarge> {
        let (mut graph, roots) = self.graph.extract(&[self.root]);
        // An extract preserves the order of ids.
        let order = self.graph.order(&[self.root]);
        let same = graph.order(&roots);
        let mut smooth: HashMap<NodeId, NodeId> = HashMap::new();
        let decided: HashMap<NodeId, bool> = decisions
            .iter()
            .map(|decision| {
                let kink = &self.kinks[(decision / 2) as usize];
                (kink.node, decision % 2 == 1)
            })
            .collect();
        for (&id, &copy) in order.iter().zip(&same) {
            let of = |operand: NodeId| smooth.get(&operand).copied().unwrap_or(copy);
            let made = match (self.graph.node(id), decided.get(&id)) {
                (Node::Binary(_, a, b), Some(second)) => of(if *second { b } else { a }),
                (Node::Unary(_, a), Some(true)) => {
                    let a = of(a);
                    graph.neg(a)
                }
                (Node::Unary(_, a), Some(false)) => of(a),
                (Node::Constant(_) | Node::Input(_), _) => copy,
                (Node::Unary(op, a), None) => {
                    let a = of(a);
                    graph.unary(op, a)
                }
                (Node::Power(a, n), _) => {
                    let a = of(a);
                    graph.integer_power(a, n)
                }
                (Node::Binary(op, a, b), None) => {
                    let (a, b) = (of(a), of(b));
                    graph.binary(op, a, b)
                }
            };
            smooth.insert(id, made);
        }
        let field = smooth.get(&self.root).copied().ok_or(TooLarge)?;
        let (mut graph, roots) = graph.extract(&[field]);
        let mut gradient = Vec::with_capacity(3);
        for k in 0..3 {
            gradient.extend(graph.derivatives(&roots, Input::Variable(k))?);
        }
        let mut all = roots;
        all.extend(&gradient);
        for (k, first) in gradient.iter().enumerate() {
            for other in k as u32..3 {
                all.extend(graph.derivatives(&[*first], Input::Variable(other))?);
            }
        }
        if graph.overflowed() {
            return Err(TooLarge);
        }
        Ok(FieldPiece {
            decisions: decisions.clone(),
            tape: PlaceTape::new(&graph, &all),
        })
    }

    /// Returns true if a point of a piece is beyond an edge: another piece bounds the solid there, or none does.
    pub(crate) fn is_beyond(&self, piece: &FieldPiece, at: [f64; 3]) -> bool {
        if self.kinks.is_empty() {
            return false;
        }
        let (value, decisions) = self.decided(at);
        if decisions == piece.decisions {
            return false;
        }
        // Where two leaves share a face, the piece continues.
        let Some(shape) = piece.shape(at) else {
            return true;
        };
        let own = shape.distance * shape.slope;
        let same = (value - own).abs() <= SAME * shape.slope * self.reach(at, &shape);
        !same
    }

    /// Returns true if no point of a box that is on a piece is beyond an edge; false where intervals cannot decide.
    pub(crate) fn stays_on(&self, piece: &FieldPiece, within: [Interval; 3]) -> bool {
        self.decisions.eval_box(within, |out| {
            piece.decisions.iter().all(|decision| {
                let (index, second) = ((decision / 2) as usize, decision % 2 == 1);
                let [a, b] = [out[1 + 2 * index], out[2 + 2 * index]];
                let is_less = |a: Interval, b: Interval| {
                    !a.is_partial() && !b.is_partial() && a.upper() < b.lower()
                };
                match (self.graph.node(self.kinks[index].node), second) {
                    (Node::Binary(Binary::Min, ..), false)
                    | (Node::Binary(Binary::Max, ..), true) => is_less(a, b),
                    (Node::Binary(..), _) => is_less(b, a),
                    (_, false) => is_less(Interval::point(0.0), a),
                    (_, true) => is_less(a, Interval::point(0.0)),
                }
            })
        })
    }

    /// Returns the length of which rounding is a fraction at a point: its distance from the origin, or the surface's size, or
    /// its radius of curvature where the size is not known.
    fn reach(&self, at: [f64; 3], shape: &LocalShape) -> f64 {
        let sizes = [self.size, shape.radius()];
        let size = sizes.into_iter().find(|size| size.is_finite());
        norm(at).max(size.unwrap_or(0.0))
    }

    /// Moves a point onto the surface along the field's gradient: Newton's method, each step shortened until the field's
    /// magnitude decreases.
    ///
    /// # Errors
    /// [`PlaceError`].
    pub fn place(&self, near: [f64; 3]) -> Result<[f64; 3], PlaceError> {
        if near.iter().any(|x| !x.is_finite()) {
            return Err(PlaceError::NotFinite);
        }
        let mut at = near;
        let value_at = |at: [f64; 3]| match self.kinks.is_empty() {
            true => self.decisions.eval(at, |out| out[0]),
            false => self.decided(at).0,
        };
        let mut last = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let piece = self.piece_at(at).map_err(|_| PlaceError::NotFound)?;
            if !piece.value(at).is_finite() {
                return Err(PlaceError::Undefined);
            }
            let shape = piece.shape(at).ok_or(PlaceError::NoGradient)?;
            let step = shape.distance.abs();
            let reach = self.reach(at, &shape);
            let value = (shape.distance * shape.slope).abs();
            // Newton's last steps shrink below rounding, or fluctuate within it.
            if step <= ON_SURFACE * reach
                && (step >= 0.5 * last || step <= 1e-3 * ON_SURFACE * reach)
            {
                return Ok(at);
            }
            last = step;
            let mut share = 1.0;
            let next = loop {
                let next = combine(1.0, at, -share * shape.distance, shape.normal);
                if value_at(next).abs() < value {
                    break Some(next);
                }
                share *= 0.5;
                if share < 1e-12 {
                    break None;
                }
            };
            match next {
                Some(next) => at = next,
                None if step <= ON_SURFACE * reach => return Ok(at),
                None => return Err(PlaceError::NotFound),
            }
        }
        Err(PlaceError::NotFound)
    }
}

/// Returns the operands of an operation that is not smooth, twice the same of one with a single operand; `None` for any other.
fn kink_operands(node: Node) -> Option<[NodeId; 2]> {
    match node {
        Node::Binary(Binary::Max | Binary::Min, a, b) => Some([a, b]),
        Node::Unary(Unary::Abs, a) => Some([a, a]),
        _ => None,
    }
}

/// Returns the kinks of an expression, and those on which its root depends without another kink between.
fn kinks(graph: &Graph, root: NodeId) -> (Vec<Kink>, Vec<u32>) {
    let order = graph.order(&[root]);
    let mut numbers: HashMap<NodeId, u32> = HashMap::new();
    let mut kinks: Vec<Kink> = Vec::new();
    // The kinks on which a node depends without another between; itself if it is one.
    let mut nearest: HashMap<NodeId, Vec<u32>> = HashMap::new();
    for id in order {
        if let Some([a, b]) = kink_operands(graph.node(id)) {
            let of = |operand: NodeId| nearest.get(&operand).cloned().unwrap_or_default();
            let number = kinks.len() as u32;
            kinks.push(Kink {
                node: id,
                operands: [a, b],
                below: [of(a), of(b)],
            });
            numbers.insert(id, number);
            nearest.insert(id, vec![number]);
            continue;
        }
        let mut all: Vec<u32> = Vec::new();
        for operand in graph.node(id).operands() {
            if let Some(own) = nearest.get(&operand) {
                all.extend(own);
            }
        }
        all.sort_unstable();
        all.dedup();
        if !all.is_empty() {
            nearest.insert(id, all);
        }
    }
    let outermost = nearest.remove(&root).unwrap_or_default();
    (kinks, outermost)
}

impl fmt::Display for PlaceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotFinite => "it is not three numbers",
            Self::Undefined => "the solid is undefined there",
            Self::NoGradient => "the gradient is 0 or undefined on the way to the surface",
            Self::NotFound => "no surface was found along the gradient from there",
        })
    }
}

impl std::error::Error for PlaceError {}
