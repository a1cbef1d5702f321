//! Entities: shapes under affine maps, combined by set operations.
//!
//! Maps are in the script's coordinates. A loop can nest sets once per iteration, so nothing here is recursive over
//! them.

use std::sync::{Arc, OnceLock};

use syntax::span::Span;

use super::value::Material;

/// An affine map: the rows of a 3 × 3 matrix, each followed by its translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Map(pub(super) [[f64; 4]; 3]);

/// A set operation.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum SetOperation {
    Union,
    Difference,
    Intersection,
}

/// A shape in its own coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum UnitShape {
    /// The ball of radius 1.
    Ball,
    /// From −1 to 1 along each axis.
    Cube,
    /// z ≤ 0.
    HalfSpace,
    /// Of radius 1 about z, from z = 0 to 1.
    Cylinder,
    /// Of radius 1 at z = 0, with its apex at z = 1.
    Cone,
    /// Of radius 1 about z, with a tube of this radius.
    Torus(f64),
}

/// A set of points with its construction.
#[derive(Debug)]
pub(super) struct Entity {
    /// The identity: entities are equal if their ids are.
    pub(super) id: u64,
    /// The emitted variable, or the position of the statement, with its span.
    pub(super) label: Option<(Arc<str>, Span)>,
    pub(super) map: Map,
    /// `None` only during drop.
    node: Option<Arc<Node>>,
    /// The number of leaves.
    pub(super) leaves: u64,
}

#[derive(Debug)]
pub(super) enum Node {
    Object(Box<ObjectNode>),
    Set(SetOperation, Arc<Entity>, Arc<Entity>),
}

/// An object created by a script.
#[derive(Debug)]
pub(super) struct ObjectNode {
    /// The first part; `second` is combined with it.
    pub(super) first: (UnitShape, Map),
    pub(super) second: Option<(SetOperation, UnitShape, Map)>,
    /// `Sphere 4:7`.
    pub(super) made: String,
    /// The variable to which it was assigned first.
    pub(super) name: OnceLock<Arc<str>>,
    /// The span of the object's name.
    pub(super) span: Span,
    pub(super) material: Arc<Material>,
    /// True if, when used alone, the first part is visible from outside only, and the second one is invisible.
    pub(super) is_plane: bool,
}

impl Entity {
    pub(super) fn of(node: Arc<Node>, id: u64) -> Self {
        let leaves = match &*node {
            Node::Object(object) => 1 + u64::from(object.second.is_some()),
            Node::Set(_, a, b) => a.leaves + b.leaves,
        };
        Self {
            id,
            label: None,
            map: Map::IDENTITY,
            node: Some(node),
            leaves,
        }
    }

    pub(super) fn node(&self) -> Option<&Node> {
        self.node.as_deref()
    }

    /// Returns the same points under a map, with another id.
    pub(super) fn placed(&self, map: &Map, id: u64) -> Self {
        Self {
            id,
            label: None,
            map: map.after(&self.map),
            node: self.node.clone(),
            leaves: self.leaves,
        }
    }

    /// Returns the same entity with a label.
    pub(super) fn labelled(&self, label: (Arc<str>, Span)) -> Self {
        Self {
            id: self.id,
            label: Some(label),
            map: self.map,
            node: self.node.clone(),
            leaves: self.leaves,
        }
    }

    /// Sets the name of the variable to which it is assigned, if it is a single object.
    pub(super) fn name(&self, name: &Arc<str>) {
        if let Some(Node::Object(object)) = self.node() {
            object.name.get_or_init(|| name.clone());
        }
    }
}

impl Drop for Entity {
    fn drop(&mut self) {
        let mut stack: Vec<Arc<Node>> = self.node.take().into_iter().collect();
        while let Some(node) = stack.pop() {
            if let Some(Node::Set(_, a, b)) = Arc::into_inner(node) {
                for mut part in [a, b].into_iter().filter_map(Arc::into_inner) {
                    stack.extend(part.node.take());
                }
            }
        }
    }
}

impl Map {
    pub(super) const IDENTITY: Self = Self([
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
    ]);

    /// Returns the map that takes the axes to these columns, and 0 to `at`.
    pub(super) fn columns([x, y, z]: [[f64; 3]; 3], at: [f64; 3]) -> Self {
        Self([0, 1, 2].map(|k| [x[k], y[k], z[k], at[k]]))
    }

    pub(super) fn scale([x, y, z]: [f64; 3]) -> Self {
        Self::columns([[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]], [0.0; 3])
    }

    pub(super) fn translate(by: [f64; 3]) -> Self {
        Self(std::array::from_fn(|k| {
            let [a, b, c, _] = Self::IDENTITY.0[k];
            [a, b, c, by[k]]
        }))
    }

    /// Returns the rotation by degrees about x, then y, then z.
    pub(super) fn rotate(degrees: [f64; 3]) -> Self {
        let [[sx, cx], [sy, cy], [sz, cz]] = degrees.map(sin_cos);
        let about_x = Self([
            [1.0, 0.0, 0.0, 0.0],
            [0.0, cx, -sx, 0.0],
            [0.0, sx, cx, 0.0],
        ]);
        let about_y = Self([
            [cy, 0.0, sy, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [-sy, 0.0, cy, 0.0],
        ]);
        let about_z = Self([
            [cz, -sz, 0.0, 0.0],
            [sz, cz, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
        ]);
        about_z.after(&about_y.after(&about_x))
    }

    /// Returns this map composed after `first`.
    pub(super) fn after(&self, first: &Self) -> Self {
        Self(self.0.map(|[a, b, c, d]| {
            let mut row: [f64; 4] =
                std::array::from_fn(|k| a * first.0[0][k] + b * first.0[1][k] + c * first.0[2][k]);
            row[3] += d;
            row
        }))
    }
}

/// Returns the sine and cosine of an angle in degrees, exact for quarter turns.
fn sin_cos(degrees: f64) -> [f64; 2] {
    let quarters = degrees / 90.0;
    if quarters.fract() == 0.0 {
        return match quarters.rem_euclid(4.0) as u8 {
            0 => [0.0, 1.0],
            1 => [1.0, 0.0],
            2 => [0.0, -1.0],
            _ => [-1.0, 0.0],
        };
    }
    let (sin, cos) = degrees.to_radians().sin_cos();
    [sin, cos]
}
