//! The scene as data.

use std::collections::BTreeSet;
use std::sync::Arc;

use expr::{Graph, NodeId};
use syntax::diagnostic::Diagnostic;
use syntax::span::Span;

use crate::geodesic_value::{GeodesicCache, GeodesicFault, GeodesicValue, MOST_NUMBERS};
pub use crate::ids::{GridId, ObjectId, ParamId};
pub use crate::range::{Range, Sampling};
use crate::rerun::Rerun;
use crate::solid::{Attribute, stated_word};
use crate::stated_picture::StatedPicture;

mod shape;
pub use shape::{GeodesicPath, Shape, SpacePath};

/// A compiled program.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Every expression of the scene.
    pub graph: Graph,
    /// The params, in the order of the text.
    pub params: Vec<Param>,
    /// The grids, in the order of the text.
    pub grids: Vec<Grid>,
    /// The drawn objects, in the order of the text.
    pub objects: Vec<Object>,
    /// The solids that are not drawn because a set names them, in the order of the text.
    pub parts: Vec<Object>,
    /// The lights, the cameras and the background, each in the order of the text.
    pub stage: Vec<Object>,
    /// The number of uniforms (components of params and grids, and numbers of geodesics):
    /// `expr::Input::Uniform(0..n)`.
    pub uniform_count: u32,
    /// The values of geodesics that expressions read, in the order of their uniforms. A value may read those before it.
    pub geodesic_values: Vec<GeodesicValue>,
    /// The values that have been computed.
    pub geodesic_cache: GeodesicCache,
    /// The picture that the text itself describes, if any. Such a scene has only its own lights.
    pub picture: Option<StatedPicture>,
    /// The scene for other values of the params, if params may change more than numbers.
    pub rerun: Option<Rerun<Scene>>,
    /// The diagnostics of the text and of the run that made the scene, sorted by position, if they may differ for other values
    /// of the params.
    pub diagnostics: Option<Arc<[Diagnostic]>>,
}

impl Scene {
    /// Returns true if the text is a scene script, which describes one picture: its axes are left-handed, its colours may be
    /// brighter than white, and it has only its own lights.
    pub fn is_script(&self) -> bool {
        self.picture.is_some()
    }

    /// Converts coordinates, or the components of a vector, from the scene to the text or back: y and z are exchanged if
    /// the text is left-handed.
    pub fn stated<T: Copy>(&self, [x, y, z]: [T; 3]) -> [T; 3] {
        if self.is_script() {
            [x, z, y]
        } else {
            [x, y, z]
        }
    }

    /// Returns for each axis of the scene the corresponding axis of the text, from 0 to 2.
    pub fn stated_axes(&self) -> [usize; 3] {
        self.stated([0, 1, 2])
    }

    /// Returns the objects with their ids.
    pub fn numbered(&self) -> impl Iterator<Item = (ObjectId, &Object)> {
        (0..).map(ObjectId::new).zip(&self.objects)
    }

    /// Returns true if the object with this id is a solid.
    pub fn is_solid(&self, id: ObjectId) -> bool {
        let object = self.get(id);
        object.is_some_and(|object| object.shape.solid().is_some())
    }

    /// Returns the object with this id.
    pub fn get(&self, id: ObjectId) -> Option<&Object> {
        self.objects.get(id.index())
    }

    /// Returns true if the 3D view shows an object: all except metrics, and geodesics on a metric, are in space.
    pub fn is_in_space(&self, object: &Object) -> bool {
        match object.shape.geodesic() {
            Some((surface, _)) => self.get(surface).is_none_or(|on| !on.shape.is_metric()),
            None => !object.shape.is_metric(),
        }
    }

    /// Returns the geodesics on a surface, a metric or a solid.
    pub fn geodesics_on(&self, surface: ObjectId) -> impl Iterator<Item = (ObjectId, &Object)> {
        let name = self.get(surface).map(|on| &*on.name);
        let lies_on = move |object: &Object| match object.shape.space_geodesic() {
            Some((path, _)) => name == Some(path.solid),
            None => {
                let geodesic = object.shape.geodesic();
                geodesic.is_some_and(|(on, _)| on == surface)
            }
        };
        self.numbered().filter(move |(_, object)| lies_on(object))
    }

    /// Computes the values of geodesics that an object reads, and writes them into its uniforms.
    pub(crate) fn fill(&self, object: &Object, uniforms: &mut [f64]) {
        for &index in &object.geodesic_values {
            if let Some(value) = self.geodesic_values.get(index as usize) {
                value.fill(&self.graph, uniforms, &self.geodesic_cache);
            }
        }
    }

    /// Returns the geodesics that an object reads and that have no value for an instance of it, each with the reason.
    pub fn geodesic_faults(&self, object: &Object, uniforms: &[f64]) -> Vec<(&str, GeodesicFault)> {
        let mut uniforms = uniforms.to_vec();
        let read = object.geodesic_values.iter();
        let read = read.filter_map(|index| self.geodesic_values.get(*index as usize));
        let mut faults: Vec<(&str, GeodesicFault)> = Vec::new();
        for value in read {
            let fault = value.fill(&self.graph, &mut uniforms, &self.geodesic_cache);
            // The value that it requires has been reported.
            let fault = fault.filter(|fault| *fault != GeodesicFault::UndefinedInput);
            faults.extend(fault.map(|fault| (&*value.geodesic, fault)));
        }
        faults
    }

    /// Returns the variables of a curve at a parameter: the parameter, then the numbers of the geodesics that it follows, which
    /// are NaN if undefined.
    pub fn curve_variables(&self, shape: &Shape, uniforms: &[f64], parameter: f64) -> Vec<f64> {
        let mut variables = vec![parameter];
        for value in shape.followed() {
            let solved = value.solve(&self.graph, uniforms, &variables, &self.geodesic_cache);
            let numbers = solved.unwrap_or([f64::NAN; MOST_NUMBERS]);
            variables.extend_from_slice(&numbers[..value.width() as usize]);
        }
        variables
    }

    /// Returns the images that attributes name, as words or as paths, without duplicates, in alphabetical order.
    pub fn image_words(&self) -> BTreeSet<&str> {
        let objects = self.objects.iter().chain(&self.stage);
        objects.flat_map(Object::image_words).collect()
    }

    /// Returns the background.
    pub fn background(&self) -> Option<&Object> {
        let mut stage = self.stage.iter();
        stage.find(|object| matches!(object.shape, Shape::Background(_)))
    }

    /// Returns the object with a name.
    pub fn object(&self, name: &str) -> Option<(ObjectId, &Object)> {
        self.objects_named(name).next()
    }

    /// The objects of a name: several of a script may share one.
    pub fn objects_named(&self, name: &str) -> impl Iterator<Item = (ObjectId, &Object)> {
        self.numbered()
            .filter(move |(_, object)| object.name == name)
    }

    /// The number that an object of this scene has in another one: the n-th object of a name is the n-th of that name there.
    pub fn number_in(&self, other: &Self, id: ObjectId) -> Option<ObjectId> {
        let name = &self.get(id)?.name;
        let mut own = self.objects_named(name);
        let place = own.position(|(known, _)| known == id)?;
        let (found, _) = other.objects_named(name).nth(place)?;
        Some(found)
    }
}

/// A slider, or one for each component.
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// Its name.
    pub name: String,
    /// The span of the name in the text.
    pub name_span: Span,
    /// One interval per component.
    pub ranges: Vec<Range>,
    /// The initial value, one number per component, within its interval: the declared one, or else the minimum.
    pub initial: Vec<f64>,
    /// The uniform `expr::Input::Uniform(first_uniform)` of its first component; the others follow.
    pub first_uniform: u32,
}

/// Equally spaced values; an object that depends on them has an instance for each.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Its name.
    pub name: String,
    /// The span of the name in the text.
    pub name_span: Span,
    /// One axis per component; the grid's values are the product of its axes.
    pub axes: Vec<Sampling>,
    /// The uniform `expr::Input::Uniform(first_uniform)` of its first component; the others follow.
    pub first_uniform: u32,
}

/// A drawn object.
#[derive(Clone, Debug)]
pub struct Object {
    /// Its name.
    pub name: String,
    /// The span of the name in the text.
    pub name_span: Span,
    /// Its kind, with its expressions.
    pub shape: Shape,
    /// The params that it reads, directly or indirectly, in order; its value need not change with each.
    pub params: Vec<ParamId>,
    /// The grids that it reads, directly or indirectly, in order; it is drawn once for each combination of their
    /// values.
    pub grids: Vec<GridId>,
    /// The values of geodesics that it reads, directly or indirectly: indexes into [`Scene::geodesic_values`],
    /// ascending.
    pub geodesic_values: Vec<u32>,
    /// The attributes that it states, in the order of the text. A solid's faces have the attributes of its leaves.
    pub attributes: Vec<Attribute>,
}

impl Object {
    /// Returns the images that its attributes name, or those of its leaves, as words or as paths.
    pub fn image_words(&self) -> impl Iterator<Item = &str> {
        let leaves = self.shape.solid().into_iter();
        let leaves = leaves.flat_map(|solid| &solid.leaves);
        let stated = std::iter::once(&self.attributes).chain(leaves.map(|leaf| &*leaf.attributes));
        stated.filter_map(|attributes| stated_word(attributes, "image"))
    }

    pub(crate) fn nodes_mut(&mut self) -> impl Iterator<Item = &mut NodeId> {
        let attributes = self.attributes.iter_mut().flat_map(Attribute::nodes_mut);
        self.shape.nodes_mut().into_iter().chain(attributes)
    }
}
