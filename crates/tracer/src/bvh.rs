//! A bounding volume hierarchy, and the boxes that a ray meets.
//!
//! In: boxes. Out: for a ray, the indices of the boxes that it meets, each with the parameter at which the ray enters.

use glam::DVec3;

use crate::bounds::BoundingBox;
use crate::bundle::RayBundle;

/// A hierarchy of boxes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hierarchy {
    nodes: Vec<BoxNode>,
    /// The indices of the boxes, leaf by leaf.
    order: Vec<u32>,
    boxes: Vec<BoundingBox>,
}

#[derive(Clone, Copy, Debug)]
struct BoxNode {
    bounds: BoundingBox,
    /// The first box of a leaf, or the second child; the first child directly follows its parent.
    place: u32,
    /// The number of boxes; 0 for an inner node.
    count: u32,
}

/// A node of a hierarchy, as in [`World::tables`](crate::World::tables).
#[derive(Clone, Copy, Debug)]
pub struct BoxRow {
    /// The box.
    pub bounds: BoundingBox,
    /// The index of its first box in the order, or its second child; the first child directly follows its parent.
    pub place: u32,
    /// The number of its boxes; 0 for an inner node.
    pub count: u32,
}

/// A part of a node, by its number.
#[derive(Clone, Copy, Debug)]
pub(crate) enum NodePart {
    Node(u32),
    Box(u32),
}

/// A part of the hierarchy that a ray meets, with the parameter at which the ray enters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MetBox {
    id: u32,
    entry: f64,
}

/// Nodes of at most this number of boxes are not divided.
const FEW: usize = 4;

impl Hierarchy {
    pub(crate) fn new(boxes: Vec<BoundingBox>) -> Self {
        let mut hierarchy = Self {
            nodes: Vec::with_capacity(boxes.len() / 2),
            order: (0..boxes.len() as u32).collect(),
            boxes,
        };
        // A range of `order`, and the node whose second child it is.
        let mut stack = vec![(0, hierarchy.order.len(), None)];
        while let Some((from, to, parent)) = stack.pop() {
            if from == to {
                continue;
            }
            let id = hierarchy.nodes.len() as u32;
            if let Some(parent) = parent {
                let parent: &mut BoxNode = &mut hierarchy.nodes[parent as usize];
                parent.place = id;
            }
            let Hierarchy { order, boxes, .. } = &mut hierarchy;
            let range = &mut order[from..to];
            let mut bounds = BoundingBox::EMPTY;
            let mut centres = BoundingBox::EMPTY;
            for &k in range.iter() {
                let one = &boxes[k as usize];
                bounds = bounds.union(one);
                let centre = one.centre();
                centres.lower = centres.lower.min(centre);
                centres.upper = centres.upper.max(centre);
            }
            let spread = centres.upper - centres.lower;
            let few = range.len() <= FEW || spread.max_element() <= 0.0;
            if !few {
                let axis = (0..3)
                    .max_by(|&j, &k| spread[j].total_cmp(&spread[k]))
                    .unwrap_or(0);
                let middle = range.len() / 2;
                let key = |k: &u32| boxes[*k as usize].centre()[axis];
                range.select_nth_unstable_by(middle, |a, b| {
                    key(a).total_cmp(&key(b)).then(a.cmp(b))
                });
                stack.push((from + middle, to, Some(id)));
                stack.push((from, from + middle, None));
            }
            hierarchy.nodes.push(BoxNode {
                bounds,
                place: from as u32,
                count: if few { (to - from) as u32 } else { 0 },
            });
        }
        hierarchy
    }

    /// Returns the nodes; the order of their boxes begins at index `first` of a longer list.
    pub(crate) fn rows(&self, first: u32) -> Vec<BoxRow> {
        let row = |node: &BoxNode| BoxRow {
            bounds: node.bounds,
            place: node.place + if node.count > 0 { first } else { 0 },
            count: node.count,
        };
        self.nodes.iter().map(row).collect()
    }

    /// Returns the indices of the boxes in the order in which the nodes refer to them.
    pub(crate) fn order(&self) -> &[u32] {
        &self.order
    }

    /// Returns the box that contains all boxes.
    pub(crate) fn bounds(&self) -> BoundingBox {
        self.nodes
            .first()
            .map_or(BoundingBox::EMPTY, |node| node.bounds)
    }

    /// Passes the boxes that the ray meets from its start on to `found`, approximately from the nearest to the farthest.
    /// `found` receives the maximum parameter of the ray and returns the new maximum: boxes beyond it are skipped. Returns
    /// the last maximum.
    pub(crate) fn each_met(
        &self,
        origin: DVec3,
        direction: DVec3,
        mut reach: f64,
        stack: &mut Vec<MetBox>,
        found: &mut dyn FnMut(usize, f64) -> f64,
    ) -> f64 {
        let reciprocal = direction.recip();
        let entry = |bounds: &BoundingBox| Some(bounds.met(origin, reciprocal)?[0]);
        stack.clear();
        if let Some(root) = self.nodes.first()
            && let Some(entry) = entry(&root.bounds)
        {
            stack.push(MetBox { id: 0, entry });
        }
        while let Some(met) = stack.pop() {
            if met.entry > reach {
                continue;
            }
            let node = &self.nodes[met.id as usize];
            if node.count == 0 {
                let children = [met.id + 1, node.place];
                let [a, b] = children.map(|id| {
                    let entry = entry(&self.nodes[id as usize].bounds)?;
                    Some(MetBox { id, entry })
                });
                // The nearer child is visited first.
                let is_first = |a: MetBox, b: MetBox| a.entry <= b.entry;
                match (a, b) {
                    (Some(a), Some(b)) if is_first(a, b) => stack.extend([b, a]),
                    (a, b) => stack.extend([a, b].into_iter().flatten()),
                }
                continue;
            }
            for &k in &self.order[node.place as usize..][..node.count as usize] {
                if entry(&self.boxes[k as usize]).is_some_and(|entry| entry <= reach) {
                    reach = found(k as usize, reach);
                }
            }
        }
        reach
    }

    /// Passes the boxes that a ray of the bundle may meet to `found` until it returns false; in that case returns false.
    pub(crate) fn each_near(
        &self,
        bundle: &RayBundle,
        stack: &mut Vec<u32>,
        found: &mut dyn FnMut(usize, &BoundingBox) -> bool,
    ) -> bool {
        stack.clear();
        if !self.nodes.is_empty() {
            stack.push(0);
        }
        while let Some(id) = stack.pop() {
            let node = &self.nodes[id as usize];
            if !bundle.may_meet(&node.bounds) {
                continue;
            }
            if node.count == 0 {
                stack.push(node.place);
                stack.push(id + 1);
                continue;
            }
            for &k in &self.order[node.place as usize..][..node.count as usize] {
                let bounds = &self.boxes[k as usize];
                if bundle.may_meet(bounds) && !found(k as usize, bounds) {
                    return false;
                }
            }
        }
        true
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Returns the two children of a node, or its boxes; node 0 is the root.
    pub(crate) fn parts(&self, node: u32) -> impl Iterator<Item = (NodePart, &BoundingBox)> {
        let BoxNode { place, count, .. } = self.nodes[node as usize];
        let children = [node + 1, place];
        let nodes = children.into_iter().filter(move |_| count == 0);
        let boxes = &self.order[place as usize..][..count as usize];
        let nodes = nodes.map(|id| (NodePart::Node(id), &self.nodes[id as usize].bounds));
        let boxes = boxes
            .iter()
            .map(|&k| (NodePart::Box(k), &self.boxes[k as usize]));
        nodes.chain(boxes)
    }
}
