//! The content key of an object: a list of words that is equal for equal objects, in any scene and at any position in it. It
//! is the key of cached samples, geodesics and kernels.
//!
//! An object's [`Structure`] consists of its expressions, its domain and its kind; with the values of the uniforms that it
//! reads it becomes a [`Content`]. Expressions are written from their roots down, each node once, so that neither their ids
//! nor other contents of the graph matter; uniforms are numbered in the order of their first occurrence.

use std::collections::HashMap;
use std::sync::Arc;

use expr::graph::Node;
use expr::{Graph, Input, NodeId};
use scene::ParamValues;
use scene::{
    AttributeValue, BoundGrid, GeodesicValue, GridId, Ground, Object, ObjectId, Sampling, Scene,
    Shape, Solid, SolidStep,
};

use crate::placement::Placement;

/// An object without the values of its uniforms.
#[derive(Clone, Debug)]
pub(crate) struct Structure {
    words: Arc<[u64]>,
    /// The uniforms, in the order of their first occurrence.
    uniforms: Vec<u32>,
    /// The grids over whose values a solid is a union, in the order of their first occurrence.
    united: Vec<BoundGrid>,
}

/// An object with the values of its uniforms. Two objects with equal contents have equal samples.
#[derive(Clone, Debug, Eq, Hash, PartialEq)]
pub(crate) struct Content(Arc<[u64]>);

/// Marks the kind of the words that follow it.
#[derive(Clone, Copy)]
enum WordTag {
    Constant = 1,
    Variable,
    Uniform,
    Unary,
    Binary,
    Power,
    Root,
    Value,
    Grid,
    Axis,
    Placement,
    Geodesic,
    Leaf,
    Union,
    Intersection,
    Difference,
    Instances,
}

impl Structure {
    /// Returns the structure of an object; for a geodesic, with the surface that it is on.
    pub(crate) fn new(scene: &Scene, object: &Object) -> Self {
        let mut writer = Writer::new(&scene.graph);
        writer.shape(&object.shape);
        if let Some((surface, _)) = object.shape.geodesic()
            && let Some(on) = scene.get(surface)
        {
            writer.shape(&on.shape);
        }
        if object.shape.is_geodesic() {
            // The notes on a geodesic contain its name.
            writer.text(&object.name);
        }
        let read = object.geodesic_values.iter();
        let read = read.filter_map(|index| scene.geodesic_values.get(*index as usize));
        for value in read.chain(object.shape.followed()) {
            writer.geodesic_value(value);
        }
        Self {
            words: writer.words.into(),
            uniforms: writer.uniforms,
            united: writer.united,
        }
    }

    /// Returns its words.
    pub(crate) fn words(&self) -> &Arc<[u64]> {
        &self.words
    }

    /// Returns the uniforms that it reads, in the order of their first occurrence.
    pub(crate) fn uniforms(&self) -> &[u32] {
        &self.uniforms
    }

    /// Returns the contents of all instances of the object.
    pub(crate) fn instances(
        &self,
        scene: &Scene,
        params: &ParamValues,
        object: &Object,
    ) -> Content {
        let open = object.grids.iter().filter_map(|&id| {
            let grid = scene.grids.get(id.0 as usize)?;
            Some((id, grid.first_uniform))
        });
        let open = open.filter(|(id, _)| params.fixed_grid(scene, *id).is_none());
        self.content(scene, params, open, params.uniforms())
    }

    /// Returns the content of one instance of the object, from the values of all uniforms.
    pub(crate) fn instance(
        &self,
        scene: &Scene,
        params: &ParamValues,
        uniforms: &[f64],
    ) -> Content {
        self.content(scene, params, std::iter::empty(), uniforms)
    }

    /// Returns the content for all values of the `open` grids, each with its first uniform, and for the values of the other
    /// uniforms.
    fn content(
        &self,
        scene: &Scene,
        params: &ParamValues,
        open: impl Iterator<Item = (GridId, u32)>,
        uniforms: &[f64],
    ) -> Content {
        let mut words = self.words.to_vec();
        let united = self.united.iter();
        let united = united.map(|bound| (bound.grid, bound.first_uniform));
        // The number of the grid and of the axis of each uniform that has all values of an axis.
        let mut of_grid = HashMap::new();
        for (number, (id, first_uniform)) in united.chain(open).enumerate() {
            let Some(grid) = scene.grids.get(id.0 as usize) else {
                continue;
            };
            words.push(WordTag::Grid as u64);
            let fixed = params.fixed_grid(scene, id);
            for (axis, sampling) in grid.axes.iter().enumerate() {
                match fixed {
                    Some(values) => {
                        words.extend([WordTag::Value as u64, value(values, axis as u32)])
                    }
                    None => {
                        words.push(WordTag::Axis as u64);
                        words.extend(sampling_words(sampling));
                    }
                }
                of_grid.insert(first_uniform + axis as u32, [number, axis]);
            }
        }
        for uniform in &self.uniforms {
            match of_grid.get(uniform) {
                Some(place) => words.extend(place.map(|n| n as u64)),
                None => {
                    words.push(WordTag::Value as u64);
                    words.push(value(uniforms, *uniform));
                }
            }
        }
        Content(words.into())
    }
}

impl Content {
    /// Returns the content in drawing units.
    pub(crate) fn placed(&self, placement: &Placement) -> Self {
        let [x, y, z] = placement.centre.map(f64::to_bits);
        let tail = [
            WordTag::Placement as u64,
            x,
            y,
            z,
            placement.radius.to_bits(),
        ];
        Self(self.0.iter().copied().chain(tail).collect())
    }
}

/// Returns the content of expressions over a domain, with the values of the uniforms that they read.
pub(crate) fn expressions(
    graph: &Graph,
    roots: &[NodeId],
    domain: &[Sampling],
    uniforms: &[f64],
) -> Content {
    let mut writer = Writer::new(graph);
    writer.words.extend(domain.iter().flat_map(sampling_words));
    for root in roots {
        let number = writer.node(*root);
        writer.words.extend([WordTag::Root as u64, number]);
    }
    let values = writer.uniforms.iter().map(|&k| value(uniforms, k));
    Content(writer.words.iter().copied().chain(values).collect())
}

fn value(uniforms: &[f64], uniform: u32) -> u64 {
    uniforms
        .get(uniform as usize)
        .map_or(u64::MAX, |value| value.to_bits())
}

fn sampling_words(sampling: &Sampling) -> [u64; 3] {
    [
        sampling.range.min.to_bits(),
        sampling.range.max.to_bits(),
        u64::from(sampling.count),
    ]
}

/// The structures of a scene's objects, computed once for each scene.
#[derive(Debug, Default)]
pub(crate) struct Structures {
    /// The scene is held so that its address is not reused.
    of: Option<(Arc<Scene>, Arc<[Structure]>)>,
}

impl Structures {
    pub(crate) fn get(&mut self, scene: &Arc<Scene>) -> Arc<[Structure]> {
        if let Some((known, structures)) = &self.of
            && Arc::ptr_eq(known, scene)
        {
            return structures.clone();
        }
        let objects = scene.objects.iter();
        let structures: Arc<[Structure]> = objects
            .map(|object| Structure::new(scene, object))
            .collect();
        self.of = Some((scene.clone(), structures.clone()));
        structures
    }
}

/// Returns the content of the first instance of an object; `None` if the scene has no such object.
pub(crate) fn first_instance(
    scene: &Scene,
    params: &ParamValues,
    structures: &[Structure],
    id: ObjectId,
) -> Option<Content> {
    let object = scene.get(id)?;
    let structure = structures.get(id.index())?;
    Some(structure.instance(scene, params, &params.first_instance(scene, object)))
}

struct Writer<'a> {
    graph: &'a Graph,
    words: Vec<u64>,
    uniforms: Vec<u32>,
    united: Vec<BoundGrid>,
    slots: HashMap<u32, u64>,
    written: HashMap<NodeId, u64>,
}

impl<'a> Writer<'a> {
    fn new(graph: &'a Graph) -> Self {
        Self {
            graph,
            words: Vec::new(),
            uniforms: Vec::new(),
            united: Vec::new(),
            slots: HashMap::new(),
            written: HashMap::new(),
        }
    }

    fn text(&mut self, text: &str) {
        self.words.push(text.len() as u64);
        self.words.extend(text.bytes().map(u64::from));
    }

    fn shape(&mut self, shape: &Shape) {
        self.text(shape.kind());
        self.words
            .extend(shape.domain().iter().flat_map(sampling_words));
        if let Some(solid) = shape.solid() {
            self.solid(solid);
        }
        for root in shape.roots() {
            let number = self.node(root);
            self.words.extend([WordTag::Root as u64, number]);
        }
    }

    /// Writes a solid's set, and the other data of its leaves.
    fn solid(&mut self, solid: &Solid) {
        for step in &solid.steps {
            match step {
                SolidStep::Leaf(leaf) => {
                    self.words.extend([WordTag::Leaf as u64, u64::from(*leaf)])
                }
                SolidStep::Union => self.words.push(WordTag::Union as u64),
                SolidStep::Intersection => self.words.push(WordTag::Intersection as u64),
                SolidStep::Difference => self.words.push(WordTag::Difference as u64),
                SolidStep::Instances(grids) => {
                    self.words
                        .extend([WordTag::Instances as u64, grids.len() as u64]);
                    for bound in grids {
                        let known = self.united.iter().position(|it| it == bound);
                        let number = known.unwrap_or_else(|| {
                            self.united.push(*bound);
                            self.united.len() - 1
                        });
                        self.words.push(number as u64);
                    }
                }
            }
        }
        for leaf in &solid.leaves {
            // Notes contain the name of the leaf.
            self.text(&leaf.name);
            for cut in &leaf.cuts {
                let words = cut.map(|cut| {
                    let [min, max] = [cut.range.min, cut.range.max].map(f64::to_bits);
                    [min, max, cut.cells.map_or(0, u64::from)]
                });
                self.words.extend(words.unwrap_or([u64::MAX; 3]));
            }
            for attribute in &*leaf.attributes {
                self.text(attribute.word);
                match &attribute.value {
                    AttributeValue::Numbers(nodes) => self.words.push(nodes.len() as u64),
                    AttributeValue::Word(word) => self.text(word),
                }
                self.words.push(u64::from(attribute.map.is_some()));
            }
        }
    }

    /// Writes a geodesic value: it depends on the values from which it is computed.
    fn geodesic_value(&mut self, value: &GeodesicValue) {
        // Notes contain the name of the geodesic.
        self.text(&value.geodesic);
        let (kind, domain) = match &value.ground {
            Ground::Chart(manifold) => (u64::from(manifold.is_metric), manifold.domain.as_slice()),
            Ground::Solid(_) => (2, [].as_slice()),
        };
        self.words.extend([WordTag::Geodesic as u64, kind]);
        let ends = domain.iter();
        let ends = ends.flat_map(|axis| [axis.min.to_bits(), axis.max.to_bits()]);
        self.words.extend(ends);
        for root in value.nodes() {
            let number = self.node(root);
            self.words.extend([WordTag::Root as u64, number]);
        }
        for uniform in value.first..value.first + value.width() {
            let slot = self.slots.get(&uniform).copied();
            self.words.push(slot.unwrap_or(u64::MAX));
        }
    }

    /// Returns the number of a node; at its first occurrence the node is written, after its operands.
    fn node(&mut self, root: NodeId) -> u64 {
        let mut stack = vec![root];
        while let Some(&id) = stack.last() {
            if self.written.contains_key(&id) {
                stack.pop();
                continue;
            }
            let node = self.graph.node(id);
            let before = stack.len();
            // The last node pushed is written first: the operands are pushed from right to left.
            let mut open: Vec<NodeId> = node.operands().collect();
            open.retain(|operand| !self.written.contains_key(operand));
            stack.extend(open.into_iter().rev());
            if stack.len() > before {
                continue;
            }
            stack.pop();
            self.write(node);
            let number = self.written.len() as u64;
            self.written.insert(id, number);
        }
        self.written[&root]
    }

    fn write(&mut self, node: Node) {
        let at = |id: NodeId| self.written[&id];
        let words = match node {
            Node::Constant(value) => [WordTag::Constant as u64, value.to_bits(), 0, 0],
            Node::Input(Input::Variable(k)) => [WordTag::Variable as u64, u64::from(k), 0, 0],
            Node::Input(Input::Uniform(k)) => {
                let next = self.uniforms.len() as u64;
                let slot = *self.slots.entry(k).or_insert(next);
                if slot == next {
                    self.uniforms.push(k);
                }
                [WordTag::Uniform as u64, slot, 0, 0]
            }
            Node::Unary(op, a) => [WordTag::Unary as u64, op as u64, at(a), 0],
            Node::Binary(op, a, b) => [WordTag::Binary as u64, op as u64, at(a), at(b)],
            Node::Power(a, n) => [WordTag::Power as u64, at(a), n as u64, 0],
        };
        self.words.extend(words);
    }
}
