//! Bounding boxes of entities, in the script's coordinates.
//!
//! The box of a shape is exact; the box of a difference is that of its first operand, and the box of an intersection is the
//! intersection of the operands' boxes.

use super::entity::{Entity, Map, Node, SetOperation, UnitShape};

/// A summary of an entity.
#[derive(Clone, Debug, PartialEq)]
pub struct EntityExtent {
    /// The object, "Sphere", or the outermost operation: "union", "difference", "intersection".
    pub what: String,
    /// The number of leaves.
    pub leaves: u64,
    /// The minimum and the maximum along each axis, which may be infinite; `None` if the box is empty.
    pub bounds: Option<[[f64; 2]; 3]>,
}

/// The minimum and the maximum along each axis.
type Bounds = [[f64; 2]; 3];

/// Returns the summary of an entity.
pub(super) fn extent(entity: &Entity) -> EntityExtent {
    let what = match entity.node() {
        Some(Node::Object(object)) => object.made.split(' ').next().unwrap_or("Entity"),
        Some(Node::Set(SetOperation::Union, ..)) => "union",
        Some(Node::Set(SetOperation::Difference, ..)) => "difference",
        Some(Node::Set(SetOperation::Intersection, ..)) => "intersection",
        None => "Entity",
    };
    let bounds = bounds(entity);
    let is_empty = bounds.iter().any(|[least, most]| least > most);
    EntityExtent {
        what: what.to_owned(),
        leaves: entity.leaves,
        bounds: (!is_empty).then_some(bounds),
    }
}

enum ExtentStep<'e> {
    Visit(&'e Entity, Map),
    Join(SetOperation),
}

/// Returns the box of an entity. Loops can nest sets deeply: this uses a stack instead of recursion.
fn bounds(entity: &Entity) -> Bounds {
    let mut steps = vec![ExtentStep::Visit(entity, Map::IDENTITY)];
    let mut done: Vec<Bounds> = Vec::new();
    while let Some(step) = steps.pop() {
        match step {
            ExtentStep::Join(operation) => {
                if let (Some(second), Some(first)) = (done.pop(), done.pop()) {
                    done.push(joined(operation, first, second));
                }
            }
            ExtentStep::Visit(entity, outer) => {
                let map = outer.after(&entity.map);
                match entity.node() {
                    Some(Node::Set(operation, a, b)) => steps.extend([
                        ExtentStep::Join(*operation),
                        ExtentStep::Visit(b, map),
                        ExtentStep::Visit(a, map),
                    ]),
                    Some(Node::Object(object)) => {
                        let (shape, own) = &object.first;
                        let mut bounds = of_shape(*shape, &map.after(own));
                        if let Some((operation, shape, own)) = &object.second {
                            let second = of_shape(*shape, &map.after(own));
                            bounds = joined(*operation, bounds, second);
                        }
                        done.push(bounds);
                    }
                    None => {}
                }
            }
        }
    }
    done.pop()
        .unwrap_or([[f64::INFINITY, f64::NEG_INFINITY]; 3])
}

fn joined(operation: SetOperation, a: Bounds, b: Bounds) -> Bounds {
    std::array::from_fn(|k| match operation {
        SetOperation::Union => [a[k][0].min(b[k][0]), a[k][1].max(b[k][1])],
        SetOperation::Intersection => [a[k][0].max(b[k][0]), a[k][1].min(b[k][1])],
        SetOperation::Difference => a[k],
    })
}

/// Returns the box of a shape under a map, from the shape's support along each axis.
fn of_shape(shape: UnitShape, map: &Map) -> Bounds {
    map.0.map(|[a, b, c, place]| {
        let (across, along) = (a.hypot(b), a.hypot(b).hypot(c));
        let [least, most] = match shape {
            UnitShape::Ball => [-along, along],
            UnitShape::Cube => {
                let half = a.abs() + b.abs() + c.abs();
                [-half, half]
            }
            // Bounded only along the normal.
            UnitShape::HalfSpace if across > 0.0 => [f64::NEG_INFINITY, f64::INFINITY],
            UnitShape::HalfSpace if c > 0.0 => [f64::NEG_INFINITY, 0.0],
            UnitShape::HalfSpace if c < 0.0 => [0.0, f64::INFINITY],
            UnitShape::HalfSpace => [0.0, 0.0],
            UnitShape::Cylinder => [c.min(0.0) - across, c.max(0.0) + across],
            UnitShape::Cone => [c.min(-across), c.max(across)],
            UnitShape::Torus(tube) => {
                let reach = across + tube * along;
                [-reach, reach]
            }
        };
        [place + least, place + most]
    })
}
