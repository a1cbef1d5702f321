//! Solids, lights, cameras and backgrounds as data.

use std::sync::Arc;

use expr::{Graph, NodeId};
use syntax::span::Span;

use crate::ids::GridId;
use crate::range::Range;

/// A set of points: leaves, combined by set operations.
#[derive(Clone, Debug, Default)]
pub struct Solid {
    /// The leaves, in the order of the text.
    pub leaves: Vec<SolidLeaf>,
    /// The set, in postfix order.
    pub steps: Vec<SolidStep>,
    /// The only leaf whose faces are visible and cast shadows, from outside only; if `None`, all faces do, from both
    /// sides.
    pub front: Option<u32>,
    /// The names of the coordinates in its declaration: two of a prism, otherwise three; none of a set, whose coordinates
    /// are x, y and z.
    pub parameters: Option<Arc<[Box<str>]>>,
}

/// A step of a set in postfix order: operands, then the operation on the last two.
#[derive(Clone, Debug, PartialEq)]
pub enum SolidStep {
    /// A leaf, by its index into [`Solid::leaves`].
    Leaf(u32),
    /// The points in either.
    Union,
    /// The points in both.
    Intersection,
    /// The points in the first that are not in the second.
    Difference,
    /// The union of the last operand over all values of these grids: the instances of a solid that a set names.
    Instances(Vec<BoundGrid>),
}

/// A grid over whose values a set is a union, and the uniforms that represent it in the leaves of the set: the grid's own, or
/// others if a set reads the same grid inside and outside the union.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct BoundGrid {
    /// The grid.
    pub grid: GridId,
    /// The first of the uniforms, one for each component of the grid.
    pub first_uniform: u32,
}

/// The field of a leaf that consists only of its cuts.
pub(crate) const EVERYWHERE: f64 = -1.0;

/// The points where a function of three numbers is not positive, within cuts, under an affine map.
#[derive(Clone, Debug)]
pub struct SolidLeaf {
    /// The name of its function, or of its solid in field form.
    pub name: String,
    /// The span of its name in the set; for a solid in field form, in its declaration.
    pub name_span: Span,
    /// The function over `Variable(0)`, `Variable(1)`, `Variable(2)`: the leaf's own x, y, z.
    pub field: NodeId,
    /// The intervals that cut it, in its own x, y, z. A set that states intervals has a leaf for them, whose field is -1
    /// everywhere.
    pub cuts: [Option<Cut>; 3],
    /// The map from its own coordinates to the scene's.
    pub map: AffineNodes,
    /// The attributes of its faces: those of the outermost set that states one, else its own. Leaves of one material share
    /// them.
    pub attributes: Arc<Vec<Attribute>>,
}

/// An interval that cuts a leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// The interval.
    pub range: Range,
    /// The number of mesh cells along it, if stated.
    pub cells: Option<u32>,
}

/// An affine map: the rows of a 3 × 3 matrix, each followed by its translation. Its nodes read no `Variable`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AffineNodes(pub [[NodeId; 4]; 3]);

/// A stated attribute.
#[derive(Clone, Debug)]
pub struct Attribute {
    /// Its word: `color`, `mirror`, …
    pub word: &'static str,
    /// Its span in the text.
    pub span: Span,
    /// Its value.
    pub value: AttributeValue,
    /// For an attribute of a solid's face: the map from the coordinates in which the value is stated to the scene's.
    /// `None` if they are the same, or the value's variables are a surface's parameters.
    pub map: Option<AffineNodes>,
}

/// The value of an attribute.
#[derive(Clone, Debug, PartialEq)]
pub enum AttributeValue {
    /// One number or three, over the variables of the declaration: x, y, z; u, v; t; or none.
    Numbers(Vec<NodeId>),
    /// A word, of an attribute such as `bokeh` or `image`; the image of a script is a path.
    Word(String),
}

/// A light. Without both parts it would not shine; its attributes are those of its object.
#[derive(Clone, Copy, Debug)]
pub struct Light {
    /// Its position; `None` for a parallel light.
    pub position: Option<[NodeId; 3]>,
    /// The direction in which it shines; `None` for a light that shines in all directions.
    pub direction: Option<[NodeId; 3]>,
}

/// A camera.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// The direction of the picture's centre. Its length is the default distance of the sharp plane.
    pub direction: [NodeId; 3],
    /// Its position.
    pub position: [NodeId; 3],
}

/// The light from directions without an object.
#[derive(Clone, Copy, Debug)]
pub struct Background {
    /// Its colour, sRGB, over `Variable(0)`, `Variable(1)`, `Variable(2)`: the unit direction.
    pub colour: [NodeId; 3],
}

impl Solid {
    /// Returns true if two solids differ only in spans of the text.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        let mut pairs = self.leaves.iter().zip(&other.leaves);
        self.steps == other.steps
            && self.front == other.front
            && self.leaves.len() == other.leaves.len()
            && pairs.all(|(a, b)| a.is_same(b))
    }

    /// Returns for each leaf whether its points are subtracted: it is in the right operands of an odd number of differences.
    pub(crate) fn taken_away(&self) -> Vec<bool> {
        let mut taken = vec![false; self.leaves.len()];
        // The leaves of each operand: steps contain all leaves in order.
        let mut operands: Vec<std::ops::Range<usize>> = Vec::new();
        for step in &self.steps {
            match *step {
                SolidStep::Leaf(leaf) => operands.push(leaf as usize..leaf as usize + 1),
                SolidStep::Instances(_) => {}
                SolidStep::Union | SolidStep::Intersection | SolidStep::Difference => {
                    let (Some(second), Some(first)) = (operands.pop(), operands.pop()) else {
                        break;
                    };
                    if *step == SolidStep::Difference {
                        for leaf in &mut taken[second.clone()] {
                            *leaf = !*leaf;
                        }
                    }
                    operands.push(first.start..second.end);
                }
            }
        }
        taken
    }
}

impl Cut {
    /// Returns the length of a mesh cell along the interval, if a number of cells is stated.
    pub fn cell(&self) -> Option<f64> {
        let Range { min, max } = self.range;
        Some((max - min) / f64::from(self.cells?))
    }
}

impl SolidLeaf {
    fn is_same(&self, other: &Self) -> bool {
        let mut pairs = self.attributes.iter().zip(&*other.attributes);
        self.name == other.name
            && self.field == other.field
            && self.cuts == other.cuts
            && self.map == other.map
            && self.attributes.len() == other.attributes.len()
            && pairs.all(|(a, b)| a.is_same(b))
    }

    /// Returns true if it consists only of the cuts of a set.
    pub(crate) fn is_cut_alone(&self, graph: &Graph) -> bool {
        self.cuts.iter().any(Option::is_some) && graph.value(self.field) == Some(EVERYWHERE)
    }

    /// Returns the nodes that its points depend on.
    pub(crate) fn point_nodes(&self) -> Vec<NodeId> {
        let map = self.map.0.as_flattened();
        std::iter::once(&self.field).chain(map).copied().collect()
    }

    pub(crate) fn nodes_mut(&mut self) -> impl Iterator<Item = &mut NodeId> {
        let attributes = Arc::make_mut(&mut self.attributes).iter_mut();
        let attributes = attributes.flat_map(Attribute::nodes_mut);
        let map = self.map.0.as_flattened_mut().iter_mut();
        std::iter::once(&mut self.field)
            .chain(map)
            .chain(attributes)
    }
}

/// Returns the stated word of an attribute such as `bokeh`.
pub fn stated_word<'a>(attributes: &'a [Attribute], attribute: &str) -> Option<&'a str> {
    let stated = attributes.iter().find(|stated| stated.word == attribute)?;
    match &stated.value {
        AttributeValue::Word(word) => Some(word),
        AttributeValue::Numbers(_) => None,
    }
}

impl Attribute {
    /// Returns true if it differs only in its span in the text.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.word == other.word && self.value == other.value && self.map == other.map
    }

    pub(crate) fn nodes_mut(&mut self) -> impl Iterator<Item = &mut NodeId> {
        let numbers = match &mut self.value {
            AttributeValue::Numbers(nodes) => nodes.as_mut_slice(),
            AttributeValue::Word(_) => &mut [],
        };
        let map = self.map.iter_mut();
        numbers
            .iter_mut()
            .chain(map.flat_map(|map| map.0.as_flattened_mut()))
    }
}
