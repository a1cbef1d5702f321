//! Solids that are unions of products: of intersections of simple leaves, and of complements of such leaves.
//!
//! Input: rays, and the leaves of products that they may meet. Output: for each ray the first place where it enters one. A
//! simple leaf is convex, or bounded by one quadric: a line is within it between two places, or everywhere else. So nothing
//! has to be kept up to date along the ray, and vectors of rays are read at once. Where the answer takes more than that, as
//! for a ray that starts inside, none is given. The places are those of `cast.rs`, to the last bit: the operations are those
//! of `line.rs`, `low.rs` and `roots.rs` in the same order.
//!
//! J. Goldfeather, J. P. M. Hultquist and H. Fuchs, "Fast constructive-solid geometry display in the Pixel-Powers graphics
//! system", SIGGRAPH 1986, multiply any tree out into a sum of such products. Here a tree counts as it is written: products
//! that are multiplied out may be many, and meet each other.

use expr::processor::Processor;
use expr::vectors::{Instructions, Lanes, MOST_LANES, Mask, Vector, VectorWork};
use glam::DVec3;

use crate::bundle::{RayBlock, RayBlocks};
use crate::leaf::{Leaf, NearLeaf};
use crate::line::SurfaceId;
use crate::low::{LowEquation, WorldPlane};
use crate::surface::QuadraticForm;
use crate::tree::TreeStep;
use crate::world::World;

/// The number of leaves of a product: more are left to the sweep.
const MOST: usize = 8;

/// The first place of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FirstPlace {
    /// The ray enters a solid through this surface at t.
    Enters(f64, SurfaceId),
    Nothing,
    /// The answer takes a sweep.
    Unknown,
}

/// A leaf of a product.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProductLeaf {
    pub(crate) leaf: u32,
    /// True if the solid lies outside of it.
    complemented: bool,
}

/// The leaves of each product that a solid is the union of, ascending; `is_simple` is true of those that are convex or bounded
/// by one quadric. `None` if the solid is none such union.
pub(crate) fn products(
    steps: &[TreeStep],
    is_simple: &dyn Fn(usize) -> bool,
) -> Option<Vec<Vec<ProductLeaf>>> {
    /// A set as a union of products, and, if it is one, as a union of leaves.
    struct Set {
        products: Vec<Vec<ProductLeaf>>,
        leaves: Option<Vec<u32>>,
    }
    let mut stack: Vec<Set> = Vec::new();
    for step in steps {
        if let TreeStep::Leaf(leaf) = *step {
            if !is_simple(leaf) {
                return None;
            }
            let leaf = leaf as u32;
            let complemented = false;
            stack.push(Set {
                products: vec![vec![ProductLeaf { leaf, complemented }]],
                leaves: Some(vec![leaf]),
            });
            continue;
        }
        let (b, a) = (stack.pop()?, stack.pop()?);
        stack.push(match step {
            TreeStep::Union => Set {
                products: joined(a.products, b.products),
                leaves: a.leaves.zip(b.leaves).map(|(a, b)| joined(a, b)),
            },
            TreeStep::Intersection => product(a.products, only(b.products)?)?,
            _ => {
                let complemented = true;
                let outside = |leaf| ProductLeaf { leaf, complemented };
                product(a.products, b.leaves?.into_iter().map(outside).collect())?
            }
        });
    }
    /// Both lists, in any order.
    fn joined<T>(mut a: Vec<T>, mut b: Vec<T>) -> Vec<T> {
        if a.len() < b.len() {
            std::mem::swap(&mut a, &mut b);
        }
        a.append(&mut b);
        a
    }
    fn only<T>(mut list: Vec<T>) -> Option<T> {
        let last = list.pop();
        last.filter(|_| list.is_empty())
    }
    fn product(a: Vec<Vec<ProductLeaf>>, b: Vec<ProductLeaf>) -> Option<Set> {
        let mut leaves = joined(only(a)?, b);
        leaves.sort_unstable_by_key(|of| of.leaf);
        (leaves.len() <= MOST).then(|| Set {
            products: vec![leaves],
            leaves: None,
        })
    }
    Some(stack.pop()?.products)
}

/// The first places of the rays of a bundle.
#[derive(Clone, Debug, Default)]
pub(crate) struct FirstPlaces {
    /// The number of rays.
    count: usize,
    plan: PiecePlan,
    blocks: Vec<FirstBlock>,
}

/// The first places of a block of rays.
#[derive(Clone, Debug)]
struct FirstBlock {
    /// Infinite where nothing is met.
    t: [f64; MOST_LANES],
    /// The number of the piece, over all leaves.
    piece: [f64; MOST_LANES],
    /// Not 0 where the place is not known.
    unknown: [f64; MOST_LANES],
}

/// The pieces to read, product by product.
#[derive(Clone, Debug, Default)]
struct PiecePlan {
    pieces: Vec<PlannedPiece>,
    parts: Vec<PlannedPart>,
    /// The end of the parts of each product.
    products: Vec<usize>,
}

#[derive(Clone, Copy, Debug)]
struct PlannedPiece {
    /// Its number, over all leaves.
    number: usize,
    /// True if the rays start on its surface.
    is_left: bool,
}

/// A leaf of a product.
#[derive(Clone, Copy, Debug)]
struct PlannedPart {
    complemented: bool,
    is_convex: bool,
    /// The end of its pieces.
    end: usize,
}

impl FirstPlaces {
    /// Begins with rays of which nothing is known.
    pub(crate) fn clear(&mut self) {
        self.count = 0;
    }

    /// The first place of the ray with this index.
    pub(crate) fn get(&self, world: &World, index: usize) -> FirstPlace {
        if index >= self.count {
            return FirstPlace::Unknown;
        }
        let (block, lane) = (&self.blocks[index / MOST_LANES], index % MOST_LANES);
        if block.unknown[lane] != 0.0 {
            FirstPlace::Unknown
        } else if block.t[lane] == f64::INFINITY {
            FirstPlace::Nothing
        } else {
            let surface = world.surface_of_piece[block.piece[lane] as usize];
            FirstPlace::Enters(block.t[lane], surface)
        }
    }

    /// Those rays of a block, the first of which has this index, that are known to meet nothing before these places.
    pub(crate) fn free(&self, first: usize, before: &[f64; MOST_LANES]) -> Lanes {
        if first >= self.count {
            return Lanes::default();
        }
        let block = &self.blocks[first / MOST_LANES];
        Lanes::of(|lane| block.unknown[lane] == 0.0 && block.t[lane] >= before[lane])
    }

    /// Finds the first places of rays on products; `near` has the leaves of products that a ray may meet, ascending.
    pub(crate) fn find(
        &mut self,
        processor: Processor,
        world: &World,
        near: &[NearLeaf],
        rays: &RayBlocks,
    ) {
        self.plan.fill(world, near, rays.leaving);
        self.count = rays.len();
        let nothing = FirstBlock {
            t: [f64::INFINITY; MOST_LANES],
            piece: [0.0; MOST_LANES],
            unknown: [0.0; MOST_LANES],
        };
        self.blocks.resize(rays.blocks().len(), nothing);
        processor.run_vectors(PlaceSearch {
            world,
            plan: &self.plan,
            rays: rays.blocks(),
            found: &mut self.blocks,
        });
    }
}

impl PiecePlan {
    fn fill(&mut self, world: &World, near: &[NearLeaf], leaving: Option<SurfaceId>) {
        self.pieces.clear();
        self.parts.clear();
        self.products.clear();
        let left = leaving.and_then(|id| world.group(id));
        let is_left =
            |id: SurfaceId| leaving == Some(id) || left.is_some() && world.group(id) == left;
        let product = |near: &NearLeaf| world.product_of[near.leaf as usize];
        // The leaves of a product follow each other.
        for near in near.chunk_by(|a, b| product(a) == product(b)) {
            let Some(leaves) = product(&near[0]).map(|k| &world.products[k as usize]) else {
                continue;
            };
            let is_near = |leaf: u32| near.binary_search_by_key(&leaf, |near| near.leaf).is_ok();
            // What no ray meets is empty for them, and so is its product.
            if !leaves.iter().all(|of| of.complemented || is_near(of.leaf)) {
                continue;
            }
            for of in leaves.iter().filter(|of| is_near(of.leaf)) {
                let leaf = &world.leaves[of.leaf as usize];
                let pieces = (0..leaf.compiled.pieces.len()).map(|piece| PlannedPiece {
                    number: leaf.first_piece + piece,
                    is_left: leaving.is_some()
                        && is_left(SurfaceId {
                            leaf: of.leaf,
                            piece: piece as u32,
                        }),
                });
                self.pieces.extend(pieces);
                self.parts.push(PlannedPart {
                    complemented: of.complemented,
                    is_convex: world.convex[of.leaf as usize],
                    end: self.pieces.len(),
                });
            }
            self.products.push(self.parts.len());
        }
    }
}

/// The search for first places.
struct PlaceSearch<'a> {
    world: &'a World,
    plan: &'a PiecePlan,
    rays: &'a [RayBlock],
    found: &'a mut [FirstBlock],
}

impl VectorWork for PlaceSearch<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Instructions>(self, s: S) {
        let mut parts = [Part::empty(s); MOST];
        for (block, found) in self.rays.iter().zip(self.found) {
            for part in 0..Vector::<S>::PARTS {
                let rays = Rays::load(s, block, part);
                let first = self.plan.first(s, self.world, &rays, &mut parts);
                first.t.store(&mut found.t, part);
                first.piece.store(&mut found.piece, part);
                let zero = Vector::splat(s, 0.0);
                let flag = first.is_unknown.choose(Vector::splat(s, 1.0), zero);
                flag.store(&mut found.unknown, part);
            }
        }
    }
}

impl PiecePlan {
    /// The first places of rays.
    #[inline(always)]
    fn first<S: Instructions>(
        &self,
        s: S,
        world: &World,
        rays: &Rays<S>,
        parts: &mut [Part<S>; MOST],
    ) -> First<S> {
        let mut first = First {
            t: Vector::splat(s, f64::INFINITY),
            piece: Vector::splat(s, 0.0),
            is_unknown: !rays.are_usable(s),
        };
        let (mut next_part, mut next_piece) = (0, 0);
        for &end in &self.products {
            let planned = &self.parts[next_part..end];
            next_part = end;
            for (part, of) in parts.iter_mut().zip(planned) {
                let pieces = &self.pieces[next_piece..of.end];
                next_piece = of.end;
                *part = Part::new(s, world, *of, pieces, rays, &mut first);
            }
            first.add(s, &parts[..planned.len().min(MOST)]);
        }
        first
    }
}

/// The coordinates of places or directions.
type Place<S> = [Vector<S>; 3];

/// A vector of rays.
struct Rays<S: Instructions> {
    origin: Place<S>,
    direction: Place<S>,
}

impl<S: Instructions> Rays<S> {
    #[inline(always)]
    fn load(s: S, [x, y, z, dx, dy, dz]: &RayBlock, part: usize) -> Self {
        Self {
            origin: [
                Vector::load(s, x, part),
                Vector::load(s, y, part),
                Vector::load(s, z, part),
            ],
            direction: [
                Vector::load(s, dx, part),
                Vector::load(s, dy, part),
                Vector::load(s, dz, part),
            ],
        }
    }

    /// True for those that are half-lines, as `Ray::is_usable` has it.
    #[inline(always)]
    fn are_usable(&self, s: S) -> Mask<S> {
        let zero = Vector::splat(s, 0.0);
        let [x, y, z] = self.direction;
        let mut are_usable = !(x.equals(zero) & y.equals(zero) & z.equals(zero));
        for x in [self.origin, self.direction].as_flattened() {
            are_usable = are_usable & x.is_finite();
        }
        are_usable
    }
}

/// Rays in the frame of a leaf, as `UnitLine` has them.
struct FramedLines<S: Instructions> {
    point: Place<S>,
    direction: Place<S>,
    middle: Vector<S>,
    speed: Vector<S>,
    slowness: Vector<S>,
}

impl<S: Instructions> FramedLines<S> {
    #[inline(always)]
    fn new(s: S, leaf: &Leaf, rays: &Rays<S>) -> Self {
        let matrix = &leaf.unit_from_world.matrix3;
        let columns = [
            splat(s, matrix.x_axis),
            splat(s, matrix.y_axis),
            splat(s, matrix.z_axis),
        ];
        let center = splat(s, leaf.unit_from_world.translation);
        let origin = sum(transformed(&columns, &rays.origin), center);
        let velocity = transformed(&columns, &rays.direction);
        let speed = dot(&velocity, &velocity).sqrt();
        let slowness = Vector::splat(s, 1.0) / speed;
        let direction = scaled(slowness, velocity);
        let middle = -dot(&origin, &direction);
        let point = sum(origin, scaled(middle, direction));
        let off = dot(&point, &direction);
        Self {
            point: difference(point, scaled(off, direction)),
            direction,
            middle: middle * slowness,
            speed,
            slowness,
        }
    }

    /// The coefficients along the lines, as [`QuadraticForm::along`] has them.
    #[inline(always)]
    fn along(&self, s: S, form: &QuadraticForm) -> [Vector<S>; 3] {
        let (p, d) = (&self.point, &self.direction);
        match form {
            QuadraticForm::Plane { normal, offset } => {
                let normal = splat(s, *normal);
                let value = dot(&normal, p) + Vector::splat(s, *offset);
                [value, dot(&normal, d), Vector::splat(s, 0.0)]
            }
            QuadraticForm::Quadric {
                squares,
                mixed,
                linear,
                constant,
            } => {
                let linear = splat(s, *linear);
                let (at, along) = if *mixed == DVec3::ZERO {
                    let squares = splat(s, *squares);
                    (product_of(squares, p), product_of(squares, d))
                } else {
                    let (squares, mixed) = (splat(s, *squares), splat(s, *mixed));
                    (
                        half_gradient(s, squares, mixed, p),
                        half_gradient(s, squares, mixed, d),
                    )
                };
                let twice = scaled(Vector::splat(s, 2.0), at);
                [
                    dot(&sum(at, linear), p) + Vector::splat(s, *constant),
                    dot(&sum(twice, linear), d),
                    dot(&along, d),
                ]
            }
        }
    }

    /// The parameters of places on the lines.
    #[inline(always)]
    fn in_t(&self, changes: Changes<S>) -> Changes<S> {
        let Changes { first, second, .. } = changes;
        Changes {
            first: self.middle + first * self.slowness,
            second: self.middle + second * self.slowness,
            ..changes
        }
    }
}

/// The places where polynomials of degree two at most change their sign on rays: `first` and `second`, infinite where they do
/// not.
#[derive(Clone, Copy)]
struct Changes<S: Instructions> {
    first: Vector<S>,
    second: Vector<S>,
    /// True where the polynomial is not positive before the first place.
    inside_first: Mask<S>,
}

impl<S: Instructions> Changes<S> {
    #[inline(always)]
    fn of_linear(s: S, [c, b]: [Vector<S>; 2]) -> Self {
        let (zero, endless) = (Vector::splat(s, 0.0), Vector::splat(s, f64::INFINITY));
        let is_flat = b.equals(zero);
        Self {
            first: is_flat.choose(endless, -c / b),
            second: endless,
            inside_first: is_flat & c.le(zero) | !is_flat & zero.lt(b),
        }
    }

    #[inline(always)]
    fn of_quadratic(s: S, [c, b, a]: [Vector<S>; 3]) -> Self {
        let (zero, endless) = (Vector::splat(s, 0.0), Vector::splat(s, f64::INFINITY));
        let discriminant = b * b - Vector::splat(s, 4.0) * a * c;
        let q = Vector::splat(s, -0.5) * (b + discriminant.sqrt().copysign(b));
        let (u, v) = (q / a, c / q);
        let is_linear = a.equals(zero);
        let has_places = zero.lt(discriminant);
        let first = has_places.choose(u.least(v), endless);
        let second = has_places.choose(u.greatest(v), endless);
        let curved = Self {
            first,
            second,
            inside_first: a.lt(zero),
        };
        if !is_linear.any() {
            return curved;
        }
        let linear = Self::of_linear(s, [c, b]);
        Self {
            first: is_linear.choose(linear.first, first),
            second: is_linear.choose(linear.second, second),
            inside_first: is_linear & linear.inside_first | !is_linear & curved.inside_first,
        }
    }

    /// Without the place `root`, as `deflated` has it; with false where the polynomial is of a lower degree.
    #[inline(always)]
    fn of_deflated(s: S, [c, b, a]: [Vector<S>; 3], root: Vector<S>) -> (Self, Mask<S>) {
        let largest = c.abs().greatest(b.abs()).greatest(a.abs());
        let is_near = root.abs().le(Vector::splat(s, 1.0));
        let first = (Vector::splat(s, 0.0) - c) / root;
        let linear = [
            is_near.choose(b + a * root, first),
            is_near.choose(a, (first - b) / root),
        ];
        let is_quadratic = (largest * Vector::splat(s, 1e-17)).lt(a.abs());
        (Self::of_linear(s, linear), is_quadratic)
    }

    /// The part on which a convex set lies, as `QuadraticChanges::convex_part` has it; empty where it does not begin before it
    /// ends.
    #[inline(always)]
    fn convex_part(self, s: S, opposite: bool) -> [Vector<S>; 2] {
        let endless = Vector::splat(s, f64::INFINITY);
        let Self { first, second, .. } = self;
        let inside = self.inside_first.differs(Mask::splat(s, opposite));
        // The far one of two parts does not count.
        let is_far = !second.equals(endless) & !first.abs().lt(second.abs());
        [
            inside.choose(is_far.choose(second, -endless), first),
            inside.choose(is_far.choose(endless, first), second),
        ]
    }
}

/// The part of each ray that is within a leaf: from `entry` up to `exit`, both infinite where there is none.
#[derive(Clone, Copy)]
struct Part<S: Instructions> {
    entry: Vector<S>,
    exit: Vector<S>,
    /// The pieces that bound it.
    entry_piece: Vector<S>,
    exit_piece: Vector<S>,
    /// True where the product lies within that part, false where it lies outside of it.
    within: Mask<S>,
}

impl<S: Instructions> Part<S> {
    #[inline(always)]
    fn empty(s: S) -> Self {
        let endless = Vector::splat(s, f64::INFINITY);
        Self {
            entry: endless,
            exit: endless,
            entry_piece: endless,
            exit_piece: endless,
            within: Mask::splat(s, true),
        }
    }

    /// Reads a leaf; marks the rays that it can say nothing of.
    #[inline(always)]
    fn new(
        s: S,
        world: &World,
        of: PlannedPart,
        pieces: &[PlannedPiece],
        rays: &Rays<S>,
        first: &mut First<S>,
    ) -> Self {
        let endless = Vector::splat(s, f64::INFINITY);
        let mut part = Self {
            entry: -endless,
            within: Mask::splat(s, !of.complemented),
            ..Self::empty(s)
        };
        for piece in pieces {
            let Some(low) = &world.low[piece.number] else {
                first.is_unknown = Mask::splat(s, true);
                continue;
            };
            let changes = match &low.equation {
                LowEquation::Plane(plane) => plane_changes(s, plane, rays, piece.is_left),
                LowEquation::Quadric { frame, form } => {
                    let lines = FramedLines::new(s, &world.leaves[*frame as usize], rays);
                    let zero = Vector::splat(s, 0.0);
                    let is_line = lines.slowness.lt(endless) & lines.speed.lt(endless);
                    first.is_unknown = first.is_unknown | !is_line;
                    let along = lines.along(s, form);
                    lines.in_t(if piece.is_left {
                        let start = (zero - lines.middle) * lines.speed;
                        let (changes, is_known) = Changes::of_deflated(s, along, start);
                        first.is_unknown = first.is_unknown | !is_known;
                        changes
                    } else {
                        Changes::of_quadratic(s, along)
                    })
                }
            };
            let number = Vector::splat(s, piece.number as f64);
            let [from, to] = if of.is_convex {
                changes.convex_part(s, low.opposite)
            } else {
                let turned = Mask::splat(s, low.opposite == of.complemented);
                part.within = changes.inside_first.differs(turned);
                [changes.first, changes.second]
            };
            let (enters, leaves) = (part.entry.lt(from), to.lt(part.exit));
            part.entry = enters.choose(from, part.entry);
            part.exit = leaves.choose(to, part.exit);
            part.entry_piece = enters.choose(number, part.entry_piece);
            part.exit_piece = leaves.choose(number, part.exit_piece);
        }
        let is_part = part.entry.lt(part.exit);
        part.entry = is_part.choose(part.entry, endless);
        part.exit = is_part.choose(part.exit, endless);
        part
    }
}

#[inline(always)]
fn plane_changes<S: Instructions>(
    s: S,
    plane: &WorldPlane,
    rays: &Rays<S>,
    is_left: bool,
) -> Changes<S> {
    let normal = splat(s, plane.normal);
    let slope = dot(&normal, &rays.direction);
    if is_left {
        return Changes::of_linear(s, [slope, Vector::splat(s, 0.0)]);
    }
    let origin = difference(rays.origin, splat(s, plane.center));
    let value = dot(&normal, &origin) + Vector::splat(s, plane.offset);
    Changes::of_linear(s, [value, slope])
}

/// The first places of a vector of rays.
struct First<S: Instructions> {
    t: Vector<S>,
    piece: Vector<S>,
    is_unknown: Mask<S>,
}

impl<S: Instructions> First<S> {
    /// Adds the product of these parts.
    #[inline(always)]
    fn add(&mut self, s: S, parts: &[Part<S>]) {
        let (zero, endless) = (Vector::splat(s, 0.0), Vector::splat(s, f64::INFINITY));
        let (mut t, mut piece) = (zero, zero);
        // From place to place, until all parts hold there.
        loop {
            let mut moved = Mask::splat(s, false);
            for part in parts {
                let is_ahead = t.lt(part.entry);
                let is_in = !is_ahead & t.lt(part.exit);
                let within = is_in.choose(t, is_ahead.choose(part.entry, endless));
                let outside = is_in.choose(part.exit, t);
                let next = part.within.choose(within, outside);
                let moves = t.lt(next);
                let through = part.within.choose(part.entry_piece, part.exit_piece);
                piece = moves.choose(through, piece);
                t = moves.choose(next, t);
                moved = moved | moves;
            }
            if parts.len() == 1 || !moved.any() {
                break;
            }
        }
        // Where surfaces meet, or a ray starts inside, a sweep tells.
        let (mut is_met, mut is_tied) = (Mask::splat(s, false), t.equals(self.t) | t.equals(zero));
        for part in parts {
            for place in [part.entry, part.exit] {
                let is_here = place.equals(t);
                is_tied = is_tied | is_met & is_here;
                is_met = is_met | is_here;
            }
        }
        self.is_unknown = self.is_unknown | is_tied & t.lt(endless);
        let is_nearer = t.lt(self.t);
        self.t = is_nearer.choose(t, self.t);
        self.piece = is_nearer.choose(piece, self.piece);
    }
}

/// Half of the gradient of the part of degree two, with these coefficients of squares and of mixed terms.
#[inline(always)]
fn half_gradient<S: Instructions>(
    s: S,
    squares: Place<S>,
    [x, y, z]: Place<S>,
    v: &Place<S>,
) -> Place<S> {
    let mixed = [
        z * v[1] + y * v[2],
        z * v[0] + x * v[2],
        y * v[0] + x * v[1],
    ];
    let half = scaled(Vector::splat(s, 0.5), mixed);
    sum(product_of(squares, v), half)
}

#[inline(always)]
fn product_of<S: Instructions>(a: Place<S>, b: &Place<S>) -> Place<S> {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

#[inline(always)]
fn splat<S: Instructions>(s: S, v: DVec3) -> Place<S> {
    [
        Vector::splat(s, v.x),
        Vector::splat(s, v.y),
        Vector::splat(s, v.z),
    ]
}

#[inline(always)]
fn dot<S: Instructions>(a: &Place<S>, b: &Place<S>) -> Vector<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn sum<S: Instructions>(a: Place<S>, b: Place<S>) -> Place<S> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn difference<S: Instructions>(a: Place<S>, b: Place<S>) -> Place<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn scaled<S: Instructions>(factor: Vector<S>, a: Place<S>) -> Place<S> {
    [factor * a[0], factor * a[1], factor * a[2]]
}

/// The image under a matrix with these columns.
#[inline(always)]
fn transformed<S: Instructions>(columns: &[Place<S>; 3], v: &Place<S>) -> Place<S> {
    let [x, y, z] = columns;
    sum(sum(scaled(v[0], *x), scaled(v[1], *y)), scaled(v[2], *z))
}
