//! Shapes: sets that expressions bound, prepared for rays.
//!
//! In: an expression in x, y, z with its cuts. Out: the box that contains the set and, in coordinates that map that box to
//! [−1, 1]³, the polynomials and other expressions that bound it, with the way in which they combine.

use std::sync::Arc;

use expr::interval::Interval;
use expr::polynomial::{Polynomial, Region, region};
use expr::{Input, NodeId, TooLarge};
use glam::{DAffine3, DMat3, DVec3};

use crate::bounds::{BoundingBox, WorkBudget, enclose};
use crate::field::{Field, FieldCompiler, FieldScratch};
use crate::frame::{centres, frame};
use crate::program::PolynomialProgram;
use crate::region_bounds::{ellipsoid, region_bounds};
use crate::surface::PolynomialSurface;

/// The set where `field` is not positive, within cuts.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    pub(crate) node: NodeId,
    pub(crate) cuts: [Option<[f64; 2]>; 3],
    pub(crate) field: Field,
    /// The box outside which it has no point; some of its sides may be infinite.
    pub(crate) extent: BoundingBox,
    /// The box around the centres of the polynomials that bound it.
    centres: BoundingBox,
    /// The number of surfaces that bound it.
    pub(crate) pieces: usize,
}

/// A shape in a frame.
#[derive(Clone, Debug)]
pub(crate) struct FramedShape {
    pub(crate) region: Region,
    /// In the order of their occurrence in the region.
    pub(crate) pieces: Vec<LeafSurface>,
    /// True if the first piece is where the shape's whole expression is not positive.
    pub(crate) is_whole: bool,
    /// The map from the coordinates of the frame to the shape's coordinates.
    pub(crate) shape_from_unit: DAffine3,
}

/// A surface that bounds a shape.
#[derive(Clone, Debug)]
pub(crate) enum LeafSurface {
    /// In the frame.
    Polynomial(PolynomialSurface),
    /// In the shape's coordinates; the node names it.
    Field(Arc<Field>, NodeId),
}

/// The work of reading an expression, for each of its operations: copies, derivatives, short polynomials.
const READING: u64 = 32;

/// A side of a frame is at least this share of the longest.
const FLATTEST: f64 = 1e-3;

impl Shape {
    /// Makes a shape. If `work` is used up, its box is larger than necessary.
    pub(crate) fn new(
        compiler: &FieldCompiler<'_>,
        node: NodeId,
        cuts: [Option<[f64; 2]>; 3],
        uniform: &dyn Fn(Input) -> f64,
        work: &WorkBudget,
    ) -> Result<Self, TooLarge> {
        let graph = compiler.graph;
        let field = Field::new(compiler, node, false, uniform)?;
        // Add one: an expression without operations has a value, too.
        let operations = field.value_work() + 1;
        work.take(READING * operations);
        let limits = cuts.map(|cut| cut.map_or(Interval::WHOLE, |[a, b]| Interval::new(a, b)));
        let mut scratch = FieldScratch::default();
        let mut pieces = 2 * cuts.iter().flatten().count();
        let mut middles = BoundingBox::EMPTY;
        let extent = if limits.iter().any(|side| side.is_empty()) {
            BoundingBox::EMPTY
        } else {
            let (region, terms) = region(graph, node, &|input| meaning(input, uniform, &UNITS));
            // The expression is read again in its frame.
            work.take(2 * terms as u64);
            pieces += region.pieces();
            middles = centres(&region);
            let within = |bounds: BoundingBox| {
                let [lower, upper] = [bounds.lower.to_array(), bounds.upper.to_array()];
                [0, 1, 2].map(|k| {
                    let limit = limits[k];
                    Interval::new(lower[k].max(limit.lower()), upper[k].min(limit.upper()))
                })
            };
            let is_empty = |sides: &[Interval; 3]| sides.iter().any(|side| side.is_empty());
            let mut on_box = |sides| match work.take(operations) {
                true => field.on_box(&mut scratch, sides),
                false => Interval::WHOLE,
            };
            match ellipsoid(&region).map(within) {
                Some(sides) if is_empty(&sides) => BoundingBox::EMPTY,
                Some(sides) => BoundingBox {
                    lower: DVec3::from_array(sides.map(Interval::lower)),
                    upper: DVec3::from_array(sides.map(Interval::upper)),
                },
                None => {
                    let found = enclose(limits, &mut on_box);
                    let bounds = || region_bounds(&region, work).map(within);
                    match found.if_finite().map_or_else(bounds, |_| None) {
                        Some(sides) if is_empty(&sides) => BoundingBox::EMPTY,
                        Some(sides) => enclose(sides, &mut on_box),
                        None => found,
                    }
                }
            }
        };
        Ok(Self {
            node,
            cuts,
            field,
            extent,
            centres: middles,
            pieces,
        })
    }

    /// Returns the box outside which it has no point; `None` for an unbounded set.
    pub(crate) fn bounds(&self) -> Option<BoundingBox> {
        self.extent.if_finite()
    }

    /// Returns true at the points of the set, by the expression's value.
    pub(crate) fn contains(&self, scratch: &mut FieldScratch, at: DVec3) -> bool {
        let within = |(cut, x): (&Option<[f64; 2]>, f64)| cut.is_none_or(|[a, b]| a <= x && x <= b);
        self.cuts.iter().zip(at.to_array()).all(within) && self.field.value(scratch, at) <= 0.0
    }

    /// Reads the shape in coordinates that map its box to [−1, 1]³; for an unbounded shape, a box around the centres of its
    /// polynomials, with half the side `size` if they determine none.
    pub(crate) fn compile(
        &self,
        compiler: &FieldCompiler<'_>,
        size: f64,
    ) -> Result<FramedShape, TooLarge> {
        if self.extent.is_empty() {
            return Ok(FramedShape::empty());
        }
        let frame = match self.bounds() {
            Some(bounds) => bounds,
            None => frame(&self.centres, &self.extent, size),
        };
        let graph = compiler.graph;
        let uniform: &dyn Fn(Input) -> f64 = &|input| self.field.uniform(input);
        let centre = frame.centre();
        let half = 0.5 * (frame.upper - frame.lower);
        let least = (FLATTEST * half.max_element()).max(f64::MIN_POSITIVE);
        let half = half.max(DVec3::splat(if least.is_finite() { least } else { 1.0 }));
        let frame = [0, 1, 2].map(|k| [centre[k], half[k]]);
        let (mut region, _) = region(graph, self.node, &|input| meaning(input, uniform, &frame));
        let whole = matches!(region, Region::Polynomial(_));
        let cuts = (0..3).filter_map(|k| self.cuts[k].map(|cut| (k, cut)));
        for (k, [a, b]) in cuts {
            let x = meaning(Input::Variable(k as u32), uniform, &frame);
            let above = x.plus(&Polynomial::constant(-b));
            let below = x.scaled(-1.0).plus(&Polynomial::constant(a));
            let sides = [above, below].map(Region::Polynomial);
            region = match region {
                Region::All(mut parts) => {
                    parts.extend(sides);
                    Region::All(parts)
                }
                region => Region::All([region].into_iter().chain(sides).collect()),
            };
        }
        let mut pieces = Vec::new();
        collect(&region, compiler, uniform, &mut pieces)?;
        if whole
            && let Some(LeafSurface::Polynomial(surface)) = pieces.first_mut()
            && let Some(program) = PolynomialProgram::new(graph, self.node, uniform, &frame)
        {
            // The whole expression is the first piece; the cuts follow.
            *surface = surface.clone().with_program(program);
        }
        Ok(FramedShape {
            region,
            pieces,
            is_whole: whole,
            shape_from_unit: DAffine3::from_mat3_translation(DMat3::from_diagonal(half), centre),
        })
    }
}

/// The centre and half the side of the frame in which polynomials are written unchanged.
const UNITS: [[f64; 2]; 3] = [[0.0, 1.0]; 3];

/// Returns an input as a polynomial in the coordinates of a frame.
fn meaning(input: Input, uniform: &dyn Fn(Input) -> f64, frame: &[[f64; 2]; 3]) -> Polynomial {
    match input {
        Input::Variable(k @ 0..3) => {
            let [centre, half] = frame[k as usize];
            let mut slopes = [0.0; 3];
            slopes[k as usize] = half;
            Polynomial::linear(centre, slopes)
        }
        input => Polynomial::constant(uniform(input)),
    }
}

impl FramedShape {
    /// Returns the empty set.
    fn empty() -> Self {
        Self {
            region: Region::Any(Vec::new()),
            pieces: Vec::new(),
            is_whole: false,
            shape_from_unit: DAffine3::IDENTITY,
        }
    }
}

/// The nesting depth of a region is at most the number of its pieces, which is small.
fn collect(
    region: &Region,
    compiler: &FieldCompiler<'_>,
    uniform: &dyn Fn(Input) -> f64,
    pieces: &mut Vec<LeafSurface>,
) -> Result<(), TooLarge> {
    match region {
        Region::Polynomial(p) => {
            pieces.push(LeafSurface::Polynomial(PolynomialSurface::new(p.clone())));
        }
        Region::Field(node, negated) => {
            let field = Field::new(compiler, *node, *negated, uniform)?;
            pieces.push(LeafSurface::Field(Arc::new(field), *node));
        }
        Region::All(parts) | Region::Any(parts) => {
            for part in parts {
                collect(part, compiler, uniform, pieces)?;
            }
        }
    }
    Ok(())
}
