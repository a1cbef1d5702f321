//! The set where an expression is not positive, as a combination of polynomials.
//!
//! In: a node, and each input as a polynomial or a number. Out: a [`Region`]. Nodes are read in the order of their ids:
//! first numbers, then lattices of polynomials (`lattice.rs`), and of the rest the outermost `max`, `min`, signs and
//! products, as far as their operands are defined everywhere. Last, pairs of planes are split (`planes.rs`).

use std::sync::Arc;

use rustc_hash::FxHashMap;

use crate::graph::{Graph, Input, Node, NodeId};
use crate::ops::{Binary, Unary, small_integer};
use crate::polynomial::Polynomial;
use crate::polynomial::lattice::{Factors, Lattice, RootedPolynomial};
use crate::polynomial::planes::pair_of_planes;

/// The maximum number of pieces of a region.
pub const MOST_PIECES: usize = 64;
/// The maximum degree of a polynomial that is expanded.
pub const LARGEST_DEGREE: usize = 12;

/// The maximum depth of `max`, `min` and products around nodes that are not polynomials.
const DEEPEST: usize = 16;
/// The maximum number of terms that expansion may create in total.
const MOST_WORK: usize = 1 << 20;

/// A set of points.
#[derive(Clone, Debug, PartialEq)]
pub enum Region {
    /// The points where the polynomial is not positive.
    Polynomial(Polynomial),
    /// The points where an expression is not positive; with `true`, where its negative is not positive.
    Field(NodeId, bool),
    /// The intersection; of no sets, all points.
    All(Vec<Region>),
    /// The union; of no sets, no points.
    Any(Vec<Region>),
}

/// The meaning of a node.
#[derive(Clone, Debug)]
enum NodeForm {
    Number(f64),
    Pieces(Arc<Lattice>),
    Other,
}

/// A node that has been read.
#[derive(Clone, Debug)]
struct ReadNode {
    form: NodeForm,
    /// The node is a number everywhere.
    total: bool,
    /// The node is not negative where it is defined, by its form.
    nonnegative: bool,
}

struct RegionReader<'a> {
    graph: &'a Graph,
    known: FxHashMap<NodeId, ReadNode>,
    /// The polynomials that must not be negative for the expression to be defined.
    domain: Vec<Polynomial>,
    work: usize,
}

/// Reads the set where `root` is defined and not positive. `meaning` returns each input as a polynomial; NaN makes its
/// uses undefined. Also returns the approximate number of terms created.
pub fn region(
    graph: &Graph,
    root: NodeId,
    meaning: &dyn Fn(Input) -> Polynomial,
) -> (Region, usize) {
    let mut reader = RegionReader {
        graph,
        known: FxHashMap::default(),
        domain: Vec::new(),
        work: 0,
    };
    for id in graph.order(&[root]) {
        let known = reader.read(id, meaning);
        reader.known.insert(id, known);
    }
    let mut region = reader.set(root, false, DEEPEST);
    if !matches!(region, Region::Field(..)) && !reader.domain.is_empty() {
        let mut all: Vec<Region> = std::mem::take(&mut reader.domain)
            .into_iter()
            .map(|p| Region::Polynomial(p.scaled(-1.0)))
            .collect();
        all.push(region);
        region = Region::All(all);
    }
    let region = region.simplified();
    if region.pieces() > MOST_PIECES || !region.is_moderate() {
        return (Region::Field(root, false), reader.work);
    }
    let split = region.with_pairs_split().simplified();
    let is_small = split.pieces() <= MOST_PIECES;
    (if is_small { split } else { region }, reader.work)
}

impl Region {
    /// Returns the number of polynomials and expressions in it.
    pub fn pieces(&self) -> usize {
        match self {
            Self::Polynomial(_) | Self::Field(..) => 1,
            Self::All(parts) | Self::Any(parts) => parts.iter().map(Self::pieces).sum(),
        }
    }

    /// Returns true if its polynomials are of moderate degree with finite coefficients.
    fn is_moderate(&self) -> bool {
        match self {
            Self::Polynomial(p) => p.degree() <= LARGEST_DEGREE && p.is_finite(),
            Self::Field(..) => true,
            Self::All(parts) | Self::Any(parts) => parts.iter().all(Self::is_moderate),
        }
    }

    /// Returns the region with half-spaces in place of each pair of planes.
    fn with_pairs_split(&self) -> Self {
        let all = |parts: &[Self]| parts.iter().map(Self::with_pairs_split).collect();
        match self {
            Self::Polynomial(p) => pair_of_planes(p).unwrap_or_else(|| self.clone()),
            Self::Field(..) => self.clone(),
            Self::All(parts) => Self::All(all(parts)),
            Self::Any(parts) => Self::Any(all(parts)),
        }
    }

    /// Returns the region without constants, and without unions and intersections of a single set.
    fn simplified(self) -> Self {
        match self {
            Self::Polynomial(p) => match p.value() {
                Some(value) if value <= 0.0 => Self::All(Vec::new()),
                Some(_) => Self::Any(Vec::new()),
                None => Self::Polynomial(p),
            },
            Self::Field(..) => self,
            Self::All(parts) => {
                let mut kept = Vec::new();
                for part in parts {
                    match part.simplified() {
                        Self::All(inner) => kept.extend(inner),
                        Self::Any(inner) if inner.is_empty() => return Self::Any(Vec::new()),
                        part => kept.push(part),
                    }
                }
                one_or(kept, Self::All)
            }
            Self::Any(parts) => {
                let mut kept = Vec::new();
                for part in parts {
                    match part.simplified() {
                        Self::Any(inner) => kept.extend(inner),
                        Self::All(inner) if inner.is_empty() => return Self::All(Vec::new()),
                        part => kept.push(part),
                    }
                }
                one_or(kept, Self::Any)
            }
        }
    }
}

/// Returns the set of some parts, where equal neighbours count once; a single part is itself the set.
fn one_or(mut parts: Vec<Region>, set: impl FnOnce(Vec<Region>) -> Region) -> Region {
    parts.dedup();
    match parts.pop() {
        Some(one) if parts.is_empty() => one,
        last => {
            parts.extend(last);
            set(parts)
        }
    }
}

impl RegionReader<'_> {
    fn read(&mut self, id: NodeId, meaning: &dyn Fn(Input) -> Polynomial) -> ReadNode {
        let of = |operand: NodeId| self.known[&operand].clone();
        match self.graph.node(id) {
            Node::Constant(value) => ReadNode::number(value),
            Node::Input(input) => {
                let polynomial = meaning(input);
                match polynomial.value() {
                    Some(value) => ReadNode::number(value),
                    None if !polynomial.is_finite() => ReadNode::number(f64::NAN),
                    None => {
                        let piece = Lattice::Piece(RootedPolynomial::polynomial(polynomial));
                        ReadNode::pieces(Some(piece), true, false)
                    }
                }
            }
            Node::Unary(op, a) => self.unary(op, of(a)),
            Node::Power(a, n) => self.power(of(a), n),
            Node::Binary(op, a, b) => {
                let square = a == b;
                self.binary(op, of(a), of(b), square)
            }
        }
    }

    fn unary(&mut self, op: Unary, a: ReadNode) -> ReadNode {
        let total = a.total
            && match op {
                Unary::Log | Unary::Asin | Unary::Acos => false,
                Unary::Sqrt => a.nonnegative,
                _ => true,
            };
        let nonnegative = matches!(op, Unary::Abs | Unary::Sqrt | Unary::Exp | Unary::Cosh);
        let pieces = match a.form {
            NodeForm::Number(x) => return ReadNode::number(op.eval(x)),
            NodeForm::Other => None,
            NodeForm::Pieces(lattice) => match op {
                Unary::Neg => Some(lattice.scaled(-1.0)),
                Unary::Abs => lattice.max(&lattice.scaled(-1.0)),
                Unary::Sqrt => {
                    let root = lattice.root();
                    if let (Some(_), Lattice::Piece(piece)) = (&root, &*lattice)
                        && !a.nonnegative
                    {
                        self.domain.push(piece.rational.clone());
                    }
                    root
                }
                _ => None,
            },
        };
        ReadNode::pieces(pieces, total, nonnegative)
    }

    fn power(&mut self, a: ReadNode, n: i32) -> ReadNode {
        let even = n % 2 == 0;
        let nonnegative = even || a.nonnegative;
        let pieces = match (a.form, u32::try_from(n)) {
            (NodeForm::Number(x), _) => return ReadNode::number(crate::ops::integer_power(x, n)),
            (NodeForm::Pieces(lattice), Ok(n)) if n > 0 && n <= LARGEST_DEGREE as u32 => {
                let power = self.affordable(|| lattice.power(n));
                // The last of the n − 1 products is the largest.
                let last = power.as_ref().map_or(0, Lattice::size) * lattice.size();
                self.work += (n as usize - 1) * last / 2;
                power
            }
            _ => None,
        };
        ReadNode::pieces(pieces, a.total && n >= 0, nonnegative)
    }

    fn binary(&mut self, op: Binary, a: ReadNode, b: ReadNode, square: bool) -> ReadNode {
        let both = a.nonnegative && b.nonnegative;
        let (total, nonnegative) = match op {
            Binary::Add | Binary::Max => (true, both || op == Binary::Max && a.nonnegative),
            Binary::Min => (true, both),
            Binary::Sub => (true, false),
            Binary::Mul => (true, both || square),
            Binary::Div => (matches!(b.form, NodeForm::Number(x) if x != 0.0), both),
            Binary::AtMost => (true, true),
            Binary::Pow | Binary::Zmul => (false, both),
        };
        let total = total && a.total && b.total;
        let pieces = match (a.form, b.form) {
            (NodeForm::Number(x), NodeForm::Number(y)) => return ReadNode::number(op.eval(x, y)),
            (NodeForm::Pieces(a), NodeForm::Number(y)) => match op {
                Binary::Mul | Binary::Zmul => Some(a.scaled(y)),
                Binary::Div if y != 0.0 => Some(a.scaled(1.0 / y)),
                Binary::Pow if y == 0.5 => {
                    let known = ReadNode::pieces(Some((*a).clone()), total, false);
                    return self.unary(Unary::Sqrt, known);
                }
                Binary::Pow => {
                    let known = ReadNode::pieces(Some((*a).clone()), true, false);
                    return match small_integer(y) {
                        Some(0) => ReadNode::number(1.0),
                        Some(n) => self.power(known, n),
                        None => ReadNode::pieces(None, false, false),
                    };
                }
                _ => self.combined(op, &a, &Lattice::constant(y)),
            },
            (NodeForm::Number(x), NodeForm::Pieces(b)) => match op {
                Binary::Mul => Some(b.scaled(x)),
                _ => self.combined(op, &Lattice::constant(x), &b),
            },
            (NodeForm::Pieces(a), NodeForm::Pieces(b)) => self.combined(op, &a, &b),
            _ => None,
        };
        ReadNode::pieces(pieces, total, nonnegative)
    }

    fn combined(&mut self, op: Binary, a: &Lattice, b: &Lattice) -> Option<Lattice> {
        self.work += a.size() + b.size();
        if op == Binary::Mul {
            self.work += a.size() * b.size();
        }
        self.affordable(|| match op {
            Binary::Add => a.plus(b),
            Binary::Sub => a.plus(&b.scaled(-1.0)),
            Binary::Mul => a.times(b),
            Binary::Min => a.min(b),
            Binary::Max => a.max(b),
            _ => None,
        })
    }

    fn affordable(&self, make: impl FnOnce() -> Option<Lattice>) -> Option<Lattice> {
        if self.work > MOST_WORK { None } else { make() }
    }

    /// Returns the set where the node, or its negative, is not positive.
    fn set(&self, id: NodeId, negated: bool, depth: usize) -> Region {
        let known = &self.known[&id];
        let field = Region::Field(id, negated);
        match &known.form {
            NodeForm::Number(x) => {
                let x = if negated { -x } else { *x };
                return if x <= 0.0 {
                    Region::All(Vec::new())
                } else {
                    Region::Any(Vec::new())
                };
            }
            NodeForm::Pieces(lattice) if !negated => return lattice.region(),
            NodeForm::Pieces(lattice) => return lattice.scaled(-1.0).region(),
            NodeForm::Other => {}
        }
        // A part that is undefined makes the whole undefined; the parts express that only in an intersection.
        let total = known.total && self.domain.is_empty();
        if depth == 0 || !total {
            return field;
        }
        let set = |id, negated| self.set(id, negated, depth - 1);
        let both = |a, b| vec![set(a, negated), set(b, negated)];
        match self.graph.node(id) {
            Node::Unary(Unary::Neg, a) => set(a, !negated),
            Node::Binary(Binary::Max, a, b) if !negated => Region::All(both(a, b)),
            Node::Binary(Binary::Min, a, b) if negated => Region::All(both(a, b)),
            Node::Binary(Binary::Max | Binary::Min, a, b) => Region::Any(both(a, b)),
            Node::Binary(Binary::Mul, a, b) if a != b => {
                // Of different signs, or of the same sign.
                Region::Any(vec![
                    Region::All(vec![set(a, false), set(b, !negated)]),
                    Region::All(vec![set(a, true), set(b, negated)]),
                ])
            }
            _ => field,
        }
    }
}

impl ReadNode {
    fn number(x: f64) -> Self {
        Self {
            form: NodeForm::Number(x),
            total: !x.is_nan(),
            nonnegative: x >= 0.0,
        }
    }

    fn pieces(lattice: Option<Lattice>, total: bool, nonnegative: bool) -> Self {
        let form = lattice.map_or(NodeForm::Other, |lattice| {
            NodeForm::Pieces(Arc::new(lattice))
        });
        Self {
            form,
            total,
            nonnegative,
        }
    }
}

impl Lattice {
    /// Returns the number of terms.
    fn size(&self) -> usize {
        match self {
            Self::Piece(piece) => {
                let root = piece.root.as_ref();
                piece.rational.terms().len()
                    + root.map_or(0, |(b, p)| b.terms().len() + p.terms().len())
            }
            Self::Min(parts) | Self::Max(parts) => parts.iter().map(Self::size).sum(),
        }
    }

    fn region(&self) -> Region {
        let all = |parts: &[Self]| parts.iter().map(Self::region).collect();
        match self {
            Self::Piece(piece) => piece.region(),
            Self::Min(parts) => Region::Any(all(parts)),
            Self::Max(parts) => Region::All(all(parts)),
        }
    }
}

impl RootedPolynomial {
    /// Returns the set where a + b√p ≤ 0, given that p is not negative: a ≤ 0 and a² ≥ b²p where b is not negative, a ≤ 0 or
    /// a² ≤ b²p where it is not positive. Factors that occur an even number of times in a product, and a root alone, do not
    /// change the sign, and squared they would have double zeros: the set omits the surfaces on which they are 0.
    fn region(&self) -> Region {
        if let Some(sign) = self.factors.as_ref().and_then(Factors::sign) {
            return Region::Polynomial(sign);
        }
        let a = &self.rational;
        let Some((b, p)) = &self.root else {
            return Region::Polynomial(a.clone());
        };
        if a.value() == Some(0.0) {
            return Region::Polynomial(b.clone());
        }
        let minus = |p: &Polynomial| p.scaled(-1.0);
        let squares = b.times(b).times(p).plus(&minus(&a.times(a)));
        let set = |p: &Polynomial| Region::Polynomial(p.clone());
        let far = Region::All(vec![set(a), set(&squares)]);
        let near = Region::Any(vec![set(a), Region::Polynomial(minus(&squares))]);
        match b.value() {
            Some(b) if b >= 0.0 => far,
            Some(_) => near,
            None => Region::Any(vec![
                Region::All(vec![Region::Polynomial(minus(b)), far]),
                Region::All(vec![set(b), near]),
            ]),
        }
    }
}
