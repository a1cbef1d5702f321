//! The first crossings of rays with products.
//!
//! In: rays, and the leaves of products that they may meet. Out: for each ray the first point where it enters a product. A
//! simple leaf is convex, or bounded by one quadric: a line is inside it between two points, or everywhere else. So no state
//! has to be maintained along the ray, and vectors of rays are processed at once. No answer is given where it would need
//! such a state, as for a ray that starts inside. The results agree with those of `cast.rs` to the last bit.

mod changes;

use expr::processor::Processor;
use expr::vectors::{Instructions, Lanes, MOST_LANES, Mask, Vector, VectorWork};

use crate::bundle::{RayBlock, RayBlocks};
use crate::leaf::{MOST_NEAR, NearLeaf};
use crate::line::SurfaceId;
use crate::low::LowEquation;
use crate::world::World;
use changes::{Changes, FramedLines, Rays, plane_changes};

/// Few products have more leaves than this.
const FEW: usize = 8;

/// The first crossing of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FirstPlace {
    /// The ray passes the surface of a solid.
    Passes {
        t: f64,
        surface: SurfaceId,
        entering: bool,
    },
    Nothing,
    /// The answer requires a sweep.
    Unknown,
}

/// The first crossings of the rays of a bundle.
#[derive(Clone, Debug, Default)]
pub(crate) struct FirstPlaces {
    /// The number of rays.
    count: usize,
    plan: PiecePlan,
    blocks: Vec<FirstBlock>,
}

/// The first crossings of a block of rays.
#[derive(Clone, Debug)]
struct FirstBlock {
    /// Infinite where nothing is met.
    t: [f64; MOST_LANES],
    /// The number of the piece, counted over all leaves.
    piece: [f64; MOST_LANES],
    /// Not 0 for rays that leave the solid there.
    exits: [f64; MOST_LANES],
    /// Not 0 if the crossing is unknown.
    unknown: [f64; MOST_LANES],
}

/// The pieces to read, product by product.
#[derive(Clone, Debug, Default)]
struct PiecePlan {
    pieces: Vec<PlannedPiece>,
    parts: Vec<PlannedPart>,
    products: Vec<PlannedProduct>,
}

#[derive(Clone, Copy, Debug)]
struct PlannedProduct {
    /// The end of its range of parts.
    end: usize,
    /// True if a ray that starts inside the product leaves the solid where it leaves the product.
    has_exits: bool,
}

#[derive(Clone, Copy, Debug)]
struct PlannedPiece {
    /// Its number, counted over all leaves.
    number: usize,
    /// True if the rays start on its surface.
    is_left: bool,
}

/// A leaf of a product.
#[derive(Clone, Copy, Debug)]
struct PlannedPart {
    complemented: bool,
    is_convex: bool,
    /// The end of its range of pieces.
    end: usize,
}

impl FirstPlaces {
    /// Resets to rays about which nothing is known.
    pub(crate) fn clear(&mut self) {
        self.count = 0;
    }

    /// Returns the first crossing of the ray with this index.
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
            FirstPlace::Passes {
                t: block.t[lane],
                surface,
                entering: block.exits[lane] == 0.0,
            }
        }
    }

    /// Returns the rays of a block that are known to meet nothing before these parameters; `first` is the index of the
    /// block's first ray.
    pub(crate) fn free(&self, first: usize, before: &[f64; MOST_LANES]) -> Lanes {
        if first >= self.count {
            return Lanes::default();
        }
        let block = &self.blocks[first / MOST_LANES];
        Lanes::of(|lane| block.unknown[lane] == 0.0 && block.t[lane] >= before[lane])
    }

    /// Finds the first crossings of rays with products; `near` has the leaves of products that a ray may meet, ascending.
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
            exits: [0.0; MOST_LANES],
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
        // The leaves of a product are consecutive.
        let place = |near: &NearLeaf| world.product_of[near.leaf as usize];
        let product = |near: &NearLeaf| place(near).map(|place| place.product);
        for near in near.chunk_by(|a, b| product(a) == product(b)) {
            let Some(product) = product(&near[0]).map(|k| &world.products[k as usize]) else {
                continue;
            };
            // A leaf that no ray meets is empty for them, and so is its product.
            let places = near.iter().filter_map(place);
            if places.filter(|place| !place.complemented).count() < product.positives {
                continue;
            }
            for near in near {
                let leaf = &world.leaves[near.leaf as usize];
                let pieces = (0..leaf.compiled.pieces.len()).map(|piece| PlannedPiece {
                    number: leaf.first_piece + piece,
                    is_left: leaving.is_some()
                        && is_left(SurfaceId {
                            leaf: near.leaf,
                            piece: piece as u32,
                        }),
                });
                self.pieces.extend(pieces);
                self.parts.push(PlannedPart {
                    complemented: place(near).is_some_and(|place| place.complemented),
                    is_convex: world.convex[near.leaf as usize],
                    end: self.pieces.len(),
                });
            }
            self.products.push(PlannedProduct {
                end: self.parts.len(),
                // If the rays leave no surface, the caller needs the solids at their starts.
                has_exits: leaving.is_some() && product.is_alone,
            });
        }
    }
}

/// The search for first crossings.
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
        let mut few = [Part::empty(s); FEW];
        let mut many = None;
        for (block, found) in self.rays.iter().zip(self.found) {
            for part in 0..Vector::<S>::PARTS {
                let rays = Rays::load(s, block, part);
                let first = self.plan.first(s, self.world, &rays, &mut few, &mut many);
                first.t.store(&mut found.t, part);
                first.piece.store(&mut found.piece, part);
                let zero = Vector::splat(s, 0.0);
                let one = Vector::splat(s, 1.0);
                first.exits.choose(one, zero).store(&mut found.exits, part);
                let unknown = first.is_unknown.choose(one, zero);
                unknown.store(&mut found.unknown, part);
            }
        }
    }
}

impl PiecePlan {
    /// Finds the first crossings of rays.
    #[inline(always)]
    fn first<S: Instructions>(
        &self,
        s: S,
        world: &World,
        rays: &Rays<S>,
        few: &mut [Part<S>; FEW],
        many: &mut Option<[Part<S>; MOST_NEAR]>,
    ) -> First<S> {
        let mut first = First {
            t: Vector::splat(s, f64::INFINITY),
            piece: Vector::splat(s, 0.0),
            exits: Mask::splat(s, false),
            is_unknown: !rays.are_usable(s),
        };
        let (mut next_part, mut next_piece) = (0, 0);
        for product in &self.products {
            let planned = &self.parts[next_part..product.end];
            next_part = product.end;
            if planned.len() > FEW && many.is_none() {
                *many = Some([Part::empty(s); MOST_NEAR]);
            }
            let parts = match many {
                Some(many) if planned.len() > FEW => &mut many[..planned.len()],
                _ => &mut few[..planned.len()],
            };
            for (part, of) in parts.iter_mut().zip(planned) {
                let pieces = &self.pieces[next_piece..of.end];
                next_piece = of.end;
                *part = Part::new(s, world, *of, pieces, rays, &mut first);
            }
            first.add(s, parts, product.has_exits);
        }
        first
    }
}

/// The part of each ray that is within a leaf: from `entry` to `exit`, both infinite if there is none.
#[derive(Clone, Copy)]
struct Part<S: Instructions> {
    entry: Vector<S>,
    exit: Vector<S>,
    /// The pieces that bound the part.
    entry_piece: Vector<S>,
    exit_piece: Vector<S>,
    /// True if the product is within that part, false if it is outside of it.
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

    /// Reads a leaf; marks the rays for which it gives no answer.
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

/// The first crossings of a vector of rays.
struct First<S: Instructions> {
    t: Vector<S>,
    piece: Vector<S>,
    /// True for rays that leave the solid there.
    exits: Mask<S>,
    is_unknown: Mask<S>,
}

impl<S: Instructions> First<S> {
    /// Adds the product of these parts; `has_exits` specifies whether rays that start inside leave their solid with it.
    #[inline(always)]
    fn add(&mut self, s: S, parts: &[Part<S>], has_exits: bool) {
        let (zero, endless) = (Vector::splat(s, 0.0), Vector::splat(s, f64::INFINITY));
        let (mut t, mut piece) = (zero, zero);
        // Advance from point to point until all parts hold.
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
        let is_inside = t.equals(zero);
        if has_exits && is_inside.any() {
            let (mut out, mut through) = (endless, zero);
            for part in parts {
                let comes_in = zero.lt(part.entry).choose(part.entry, endless);
                let next = part.within.choose(part.exit, comes_in);
                let by = part.within.choose(part.exit_piece, part.entry_piece);
                let is_first = next.lt(out);
                out = is_first.choose(next, out);
                through = is_first.choose(by, through);
            }
            t = is_inside.choose(out, t);
            piece = is_inside.choose(through, piece);
        }
        // Where surfaces meet, or a ray starts inside, a sweep decides.
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
        self.exits = is_nearer & is_inside | !is_nearer & self.exits;
    }
}
