//! A world as tables of numbers, for machines that have neither lists nor recursion.
//!
//! ```text
//! World ──▶ components: parts of solids that are unions, each a small tree of set operations
//!              │ leaves, their polynomials in frames of their own, their fields by name, the nodes of the tree
//!              └ a hierarchy of boxes over the components
//! ```
//!
//! In: a world. Out: its tables, or the part of it that tables cannot represent. A ray is inside a solid if it is inside a
//! component of it; `cast.rs` finds crossings leaf by leaf along a ray, a reader of the tables component by component.

use expr::{Graph, Input, NodeId};
use glam::{DAffine3, DVec3};

use crate::bounds::BoundingBox;
use crate::field::Field;
use crate::leaf::Leaf;
use crate::shape::LeafSurface;
use crate::surface::PolynomialSurface;
use crate::tree::{Forest, LeafLiterals, Literal};
use crate::world::World;

pub use crate::bvh::BoxRow;
pub use crate::tree::NodeRow;

/// The maximum number of nodes of a component's tree.
pub const MOST_NODES: usize = 128;
/// The maximum degree of a polynomial.
pub const HIGHEST_DEGREE: usize = 4;

/// The tables. Positions are relative to `origin`.
#[derive(Clone, Debug, Default)]
pub struct WorldTables {
    /// The world position to which all others are relative.
    pub origin: DVec3,
    /// Sorted by their solids.
    pub components: Vec<ComponentRow>,
    /// The leaves; those of a component are consecutive.
    pub leaves: Vec<LeafRow>,
    /// The pieces; those of a leaf are consecutive.
    pub pieces: Vec<PieceRow>,
    /// The terms of polynomials of degree above two.
    pub terms: Vec<([u8; 3], f64)>,
    /// The nodes of the components' trees.
    pub nodes: Vec<NodeRow>,
    /// A hierarchy of boxes; the first contains all others.
    pub boxes: Vec<BoxRow>,
    /// Components: first the unbounded ones, then those of the boxes.
    pub order: Vec<u32>,
    /// The number of unbounded components.
    pub endless: usize,
}

/// A component: a part of a solid, which is the union of its components.
#[derive(Clone, Copy, Debug)]
pub struct ComponentRow {
    /// The number of its solid.
    pub solid: u32,
    /// The first of its leaves.
    pub first_leaf: u32,
    /// The number of its leaves.
    pub leaf_count: u32,
    /// The first of its nodes, which determines whether a point is inside.
    pub first_node: u32,
    /// The number of its nodes.
    pub node_count: u32,
}

/// A leaf.
#[derive(Clone, Copy, Debug)]
pub struct LeafRow {
    /// Its number in the world.
    pub leaf: u32,
    /// The map from positions relative to `centre` to the frame of its polynomials.
    pub frame_from_world: DAffine3,
    /// A point in it, or near it.
    pub centre: DVec3,
    /// The box within which rays are tested against it; `None` if it is unbounded.
    pub bounds: Option<BoundingBox>,
    /// The literal that is true where a ray meets the leaf.
    pub gate: LiteralRow,
    /// The first of its pieces.
    pub first_piece: u32,
    /// The number of its pieces.
    pub piece_count: u32,
}

/// The effect of something on the tree of its component.
#[derive(Clone, Copy, Debug)]
pub struct LiteralRow {
    /// The node, counted from the component's first.
    pub node: u32,
    /// True if the node counts it where it does not hold.
    pub complemented: bool,
}

/// A surface that bounds a leaf.
#[derive(Clone, Copy, Debug)]
pub struct PieceRow {
    /// The piece whose equation it uses; its own number unless several pieces are one surface.
    pub equation: u32,
    /// The row of the leaf whose frame the polynomial or the field uses.
    pub frame: u32,
    /// True if the piece is inside where the polynomial or the field is positive.
    pub opposite: bool,
    /// Its literal.
    pub literal: LiteralRow,
    /// The equation.
    pub surface: SurfaceRow,
}

/// The equation of a surface.
#[derive(Clone, Copy, Debug)]
pub enum SurfaceRow {
    /// A polynomial of degree at most [`HIGHEST_DEGREE`].
    Polynomial(PolynomialRow),
    /// Another expression, by its number among the fields.
    Field(u32),
}

/// A polynomial.
#[derive(Clone, Copy, Debug)]
pub struct PolynomialRow {
    /// The polynomial's degree.
    pub degree: u32,
    /// The coefficients of x², y², z².
    pub squares: DVec3,
    /// The coefficients of yz, xz, xy.
    pub mixed: DVec3,
    /// The coefficients of x, y, z.
    pub linear: DVec3,
    /// The constant.
    pub constant: f64,
    /// The index of its first term in the table of terms, if the degree is above two.
    pub first_term: u32,
    /// The number of these terms.
    pub term_count: u32,
}

/// A field that bounds a piece: an expression in coordinates of its own, the variables 0, 1, 2.
#[derive(Clone, Copy, Debug)]
pub struct FieldRow<'a> {
    /// The number of the piece's solid.
    pub solid: usize,
    /// The centre of the frame, in these coordinates.
    pub middle: DVec3,
    /// Half the sides of the frame, which is a box.
    pub half: DVec3,
    field: &'a Field,
}

impl<'a> FieldRow<'a> {
    /// Returns the expression with its graph, which the instances of an object share.
    pub fn expression(&self) -> (&'a Graph, NodeId) {
        self.field.expression()
    }

    /// Returns the number of a uniform that it reads.
    pub fn uniform(&self, slot: u32) -> f64 {
        self.field.uniform(Input::Uniform(slot))
    }
}

/// A part of a world that tables cannot represent.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum TableError {
    /// A leaf of this solid is bounded by several polynomials, one of them of a degree above [`HIGHEST_DEGREE`].
    Degree {
        /// The solid.
        solid: usize,
        /// The degree.
        degree: usize,
    },
    /// A leaf of this solid without a box is bounded by a polynomial of degree above two.
    EndlessQuartic {
        /// The solid.
        solid: usize,
    },
    /// This solid has too many set operations.
    TooManyNodes {
        /// The solid.
        solid: usize,
    },
}

impl World {
    /// Returns the world as tables, and the fields of its pieces.
    ///
    /// # Errors
    /// If tables cannot represent a part of the world.
    pub fn tables(&self) -> Result<(WorldTables, Vec<FieldRow<'_>>), TableError> {
        let mut fields = Vec::new();
        let mut tables = WorldTables {
            origin: if self.hierarchy.bounds().is_empty() {
                DVec3::ZERO
            } else {
                self.hierarchy.bounds().centre()
            },
            ..WorldTables::default()
        };
        let mut first_leaf = 0;
        let trees = WholeTrees::of(self);
        let own_boxes = trees.node_boxes(self);
        let mut boxes = Vec::new();
        let mut boxed = Vec::new();
        for solid in 0..trees.forest.len() {
            for nodes in trees.forest.components(solid) {
                if nodes.len() > MOST_NODES {
                    return Err(TableError::TooManyNodes { solid });
                }
                let rest = trees.literals[first_leaf..].iter();
                let of_component =
                    |leaf: &&LeafLiterals| nodes.contains(&(leaf.gate.node() as usize));
                let leaf_count = rest.take_while(of_component).count();
                let component = tables.components.len() as u32;
                match own_boxes[nodes.start] {
                    Some(bounds) if bounds.is_empty() => {}
                    Some(bounds) => {
                        boxes.push(tables.moved(bounds));
                        boxed.push(component);
                    }
                    None => tables.order.push(component),
                }
                tables.components.push(ComponentRow {
                    solid: solid as u32,
                    first_leaf: first_leaf as u32,
                    leaf_count: leaf_count as u32,
                    first_node: tables.nodes.len() as u32,
                    node_count: nodes.len() as u32,
                });
                for leaf in first_leaf..first_leaf + leaf_count {
                    let literals = &trees.literals[leaf];
                    self.add_leaf(&mut tables, &mut fields, leaf, literals, nodes.start)?;
                }
                tables.nodes.extend(trees.forest.rows(nodes));
                first_leaf += leaf_count;
            }
        }
        tables.endless = tables.order.len();
        let hierarchy = crate::bvh::Hierarchy::new(boxes);
        let shift = tables.endless as u32;
        tables.boxes = hierarchy.rows(shift);
        let order = hierarchy.order().iter();
        tables.order.extend(order.map(|&k| boxed[k as usize]));
        Ok((tables, fields))
    }

    fn add_leaf<'a>(
        &'a self,
        tables: &mut WorldTables,
        fields: &mut Vec<FieldRow<'a>>,
        number: usize,
        literals: &LeafLiterals,
        first_node: usize,
    ) -> Result<(), TableError> {
        let leaf = &self.leaves[number];
        let row = |literal: Literal| LiteralRow {
            node: literal.node() - first_node as u32,
            complemented: literal.is_complemented(),
        };
        let origin = tables.origin;
        let centre = leaf.unit_from_world.inverse().translation;
        let bounds = self.own_box(leaf);
        let first_piece = tables.pieces.len() as u32;
        for k in 0..leaf.compiled.pieces.len() {
            let own = leaf.first_piece + k;
            let (of, place, opposite) = match self.surfaces.group(own) {
                Some(member) => {
                    let (first, place) = self.surfaces.first[member.group as usize];
                    (first as usize, place as usize, member.opposite)
                }
                None => (number, k, false),
            };
            let solid = leaf.solid;
            let frame = &self.leaves[of];
            let shape = &frame.compiled;
            let field = match &shape.pieces[place] {
                LeafSurface::Field(field, _) => Ok(&**field),
                LeafSurface::Polynomial(surface) => match surface.degree() {
                    ..=2 => Err(surface),
                    3..=HIGHEST_DEGREE if leaf.bounded && frame.bounded => Err(surface),
                    _ if bounds.is_none() => return Err(TableError::EndlessQuartic { solid }),
                    _ if shape.is_whole && place == 0 => Ok(&self.shapes[frame.shape].field),
                    degree => return Err(TableError::Degree { solid, degree }),
                },
            };
            let surface = match field {
                Ok(_) => SurfaceRow::Field(fields.len() as u32),
                Err(polynomial) => SurfaceRow::Polynomial(tables.add_polynomial(polynomial)),
            };
            tables.pieces.push(PieceRow {
                equation: (frame.first_piece + place) as u32,
                frame: of as u32,
                opposite: opposite != field.is_ok_and(Field::is_negated),
                literal: row(literals.pieces[k]),
                surface,
            });
            fields.extend(field.ok().map(|field| FieldRow {
                solid,
                middle: shape.shape_from_unit.translation,
                half: shape.shape_from_unit.matrix3.diagonal(),
                field,
            }));
        }
        tables.leaves.push(LeafRow {
            leaf: number as u32,
            frame_from_world: DAffine3 {
                translation: leaf.unit_from_world.transform_point3(centre),
                ..leaf.unit_from_world
            },
            centre: centre - origin,
            bounds: bounds.map(|bounds| tables.moved(bounds)),
            gate: row(literals.gate),
            first_piece,
            piece_count: tables.pieces.len() as u32 - first_piece,
        });
        Ok(())
    }

    /// Returns the box of a leaf, which no ray enters inside of the leaf; for an unbounded leaf, the box to which its search
    /// is limited.
    fn own_box(&self, leaf: &Leaf) -> Option<BoundingBox> {
        let own = self.shapes[leaf.shape].bounds();
        let world_from_shape = leaf.shape_from_world.inverse();
        let own = own.map(|bounds| bounds.transformed(&world_from_shape));
        own.or(leaf.bounds)
    }
}

/// The trees of a world with a node for each piece. Those that rays in f64 use have none for convex leaves.
struct WholeTrees {
    forest: Forest,
    /// For each leaf of the world.
    literals: Vec<LeafLiterals>,
}

impl WholeTrees {
    fn of(world: &World) -> Self {
        let mut forest = Forest::default();
        let mut literals = vec![None; world.leaves.len()];
        for steps in &world.solids {
            forest.add(
                steps,
                &|leaf| world.leaves[leaf].compiled.region.clone(),
                &mut |leaf, found| literals[leaf] = Some(found),
            );
        }
        // Each leaf is a part of its tree.
        Self {
            forest,
            literals: literals.into_iter().flatten().collect(),
        }
    }

    /// Returns for each node a box that contains its set; `None` if no box is found.
    fn node_boxes(&self, world: &World) -> Vec<Option<BoundingBox>> {
        let mut boxes = self.forest.whole_boxes();
        for (leaf, literals) in world.leaves.iter().zip(&self.literals) {
            let gate = literals.gate;
            // The gate of a subtracted leaf belongs to a union with everything outside it.
            boxes[gate.node() as usize] = match !gate.is_complemented() && leaf.bounded {
                true => world.own_box(leaf),
                false => None,
            };
            for piece in &literals.pieces {
                if piece.node() != gate.node() {
                    boxes[piece.node() as usize] = None;
                }
            }
        }
        self.forest.fold_boxes(&mut boxes);
        boxes
    }
}

impl WorldTables {
    fn add_polynomial(&mut self, surface: &PolynomialSurface) -> PolynomialRow {
        let degree = surface.degree();
        // The scale of the equation is arbitrary.
        let largest = surface.polynomial.largest();
        let scale = if largest > 0.0 { 1.0 / largest } else { 1.0 };
        let coefficient = |e: [u8; 3]| {
            let mut terms = surface.polynomial.terms();
            let found = terms.find(|(f, _)| *f == e);
            found.map_or(0.0, |(_, c)| scale * c)
        };
        let three = |e: [[u8; 3]; 3]| DVec3::from_array(e.map(coefficient));
        let first_term = self.terms.len() as u32;
        if degree > 2 {
            let terms = surface.polynomial.terms();
            self.terms.extend(terms.map(|(e, c)| (e, scale * c)));
        }
        PolynomialRow {
            degree: degree as u32,
            squares: three([[2, 0, 0], [0, 2, 0], [0, 0, 2]]),
            mixed: three([[0, 1, 1], [1, 0, 1], [1, 1, 0]]),
            linear: three([[1, 0, 0], [0, 1, 0], [0, 0, 1]]),
            constant: coefficient([0; 3]),
            first_term,
            term_count: self.terms.len() as u32 - first_term,
        }
    }

    fn moved(&self, bounds: BoundingBox) -> BoundingBox {
        BoundingBox {
            lower: bounds.lower - self.origin,
            upper: bounds.upper - self.origin,
        }
    }
}
