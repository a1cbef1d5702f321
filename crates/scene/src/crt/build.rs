//! The scene that a run produces.
//!
//! In: settings and emitted entities, in the script's coordinates. Out: a scene with y and z exchanged. Shapes of one
//! kind share a field; their sizes and positions are in their maps.

use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use expr::ops::Unary;
use expr::{Graph, Input, NodeId};
use geodesic::vector::{cross, dot};
use syntax::span::Span;

use super::entity::{Entity, Map, Node, ObjectNode, SetOperation, UnitShape};
use super::value::{Background, Material, ScriptCamera, ScriptLight, ScriptSettings};
use super::vector;
use crate::range::Range;
use crate::scene::{Object, Param, Scene, Shape};
use crate::solid;
use crate::solid::{
    AffineNodes, Attribute, AttributeValue, Cut, EVERYWHERE, Solid, SolidLeaf, SolidStep,
};
use crate::stated_picture::StatedPicture;

/// The maximum of `t`.
const LAST: f64 = 100.0;
/// The number of units of a script's `aperture` per unit of length.
pub(super) const APERTURES: f64 = 720.0;

/// Returns the scene of a run. Each entity is dropped once its object is created, so that a million of both are never
/// in memory together.
pub(super) fn scene(settings: &ScriptSettings, drawn: Vec<Arc<Entity>>) -> Scene {
    let mut builder = SceneBuilder::default();
    let mut objects = Vec::with_capacity(drawn.len());
    objects.extend(drawn.into_iter().map(|entity| builder.object(&entity)));
    let mut stage = Vec::new();
    for (k, light) in settings.lights.iter().enumerate() {
        stage.push(builder.light(k, light));
    }
    let default = Arc::new(ScriptCamera::default());
    let camera = settings.camera.as_ref().unwrap_or(&default);
    stage.push(builder.camera(camera, settings.dofsamples > 1));
    let background = settings.background.clone().unwrap_or_default();
    stage.push(builder.background(&background));
    Scene {
        graph: builder.graph,
        params: vec![Param {
            name: "t".to_owned(),
            name_span: Span::default(),
            ranges: vec![Range {
                min: 0.0,
                max: LAST,
            }],
            initial: vec![0.0],
            first_uniform: 0,
        }],
        uniform_count: 1,
        objects,
        stage,
        picture: Some(StatedPicture {
            gamma: settings.gamma,
            supersampling: settings.supersampling,
            lens_samples: settings.dofsamples,
            bounces: settings.recursiondepth,
        }),
        ..Scene::default()
    }
}

#[derive(Default)]
struct SceneBuilder {
    graph: Graph,
    /// The attributes of materials, by the bits of their numbers: loops create equal materials many times.
    materials: HashMap<[Option<u64>; 9], Arc<Vec<Attribute>>>,
    /// The fields of shapes without numbers, by their kind, and those of rings by the radius of their tube.
    fields: HashMap<(u8, u64), NodeId>,
}

/// The remaining work; the next step is last.
enum BuildStep<'a> {
    Entity(&'a Entity, Map),
    Join(SetOperation),
}

impl SceneBuilder {
    fn object(&mut self, entity: &Entity) -> Object {
        let leaves = entity.leaves as usize;
        let mut solid = Solid {
            leaves: Vec::with_capacity(leaves),
            steps: Vec::with_capacity(2 * leaves - 1),
            ..Solid::default()
        };
        let mut work = vec![BuildStep::Entity(entity, Map::IDENTITY)];
        while let Some(next) = work.pop() {
            match next {
                BuildStep::Join(operation) => solid.steps.push(step(operation)),
                BuildStep::Entity(entity, around) => {
                    let map = around.after(&entity.map);
                    match entity.node() {
                        Some(Node::Set(operation, a, b)) => {
                            work.push(BuildStep::Join(*operation));
                            work.push(BuildStep::Entity(b, map));
                            work.push(BuildStep::Entity(a, map));
                        }
                        Some(Node::Object(object)) => {
                            self.leaf(&mut solid, object, object.first, &map);
                            if let Some((operation, shape, own)) = object.second {
                                self.leaf(&mut solid, object, (shape, own), &map);
                                solid.steps.push(step(operation));
                            }
                        }
                        None => {}
                    }
                }
            }
        }
        if let Some(Node::Object(object)) = entity.node()
            && object.is_plane
        {
            solid.front = Some(0);
        }
        let (name, span) = match &entity.label {
            Some((name, span)) => (name.to_string(), *span),
            None => (String::new(), Span::default()),
        };
        self.staged(name, span, Shape::Solid(Arc::new(solid)), Vec::new())
    }

    fn leaf(
        &mut self,
        solid: &mut Solid,
        object: &ObjectNode,
        (shape, own): (UnitShape, Map),
        around: &Map,
    ) {
        let (field, cuts) = self.shape(shape);
        solid.steps.push(SolidStep::Leaf(solid.leaves.len() as u32));
        let Map([x, y, z]) = around.after(&own);
        let name = object.name.get().map(|name| name.to_string());
        let map = [x, z, y].map(|row| row.map(|number| self.graph.constant(number)));
        solid.leaves.push(SolidLeaf {
            name: name.unwrap_or_else(|| object.made.clone()),
            name_span: object.span,
            field,
            cuts,
            map: AffineNodes(map),
            attributes: self.material(&object.material),
        });
    }

    /// Returns the field and the cuts of a shape in its own coordinates.
    fn shape(&mut self, shape: UnitShape) -> (NodeId, [Option<Cut>; 3]) {
        let cut = |min: f64| {
            Some(Cut {
                range: Range { min, max: 1.0 },
                cells: None,
            })
        };
        let (kind, tube, cuts) = match shape {
            UnitShape::Ball => (0, 0.0, [None; 3]),
            UnitShape::Cube => (1, 0.0, [cut(-1.0); 3]),
            UnitShape::HalfSpace => (2, 0.0, [None; 3]),
            UnitShape::Cylinder => (3, 0.0, [None, None, cut(0.0)]),
            UnitShape::Cone => (4, 0.0, [None, None, cut(0.0)]),
            UnitShape::Torus(tube) => (5, tube, [None; 3]),
        };
        if let Some(field) = self.fields.get(&(kind, tube.to_bits())) {
            return (*field, cuts);
        }
        let graph = &mut self.graph;
        let [x, y, z] = [0, 1, 2].map(|k| graph.input(Input::Variable(k)));
        let [xx, yy, zz] = [x, y, z].map(|it| graph.mul(it, it));
        let around = graph.add(xx, yy);
        let all = graph.add(around, zz);
        let one = graph.constant(1.0);
        let field = match shape {
            UnitShape::Ball => graph.sub(all, one),
            UnitShape::Cube => graph.constant(EVERYWHERE),
            UnitShape::HalfSpace => z,
            UnitShape::Cylinder => graph.sub(around, one),
            UnitShape::Cone => {
                let rest = graph.sub(one, z);
                let rest = graph.mul(rest, rest);
                graph.sub(around, rest)
            }
            UnitShape::Torus(tube) => {
                let offset = graph.constant(1.0 - tube * tube);
                let sum = graph.add(all, offset);
                let square = graph.mul(sum, sum);
                let four = graph.constant(4.0);
                let ring = graph.mul(four, around);
                graph.sub(square, ring)
            }
        };
        self.fields.insert((kind, tube.to_bits()), field);
        (field, cuts)
    }

    fn material(&mut self, material: &Material) -> Arc<Vec<Attribute>> {
        let Material {
            colour,
            reflectivity,
            transparency,
            refractiveindex,
            diffuse,
            specularity,
            shininess,
        } = *material;
        let bits = |number: f64| Some(number.to_bits());
        let [red, green, blue] = colour.map(bits);
        let key = [
            red,
            green,
            blue,
            bits(reflectivity),
            bits(transparency),
            bits(refractiveindex),
            bits(specularity),
            bits(shininess),
            diffuse.and_then(bits),
        ];
        if let Some(known) = self.materials.get(&key) {
            return known.clone();
        }
        let mut stated = vec![
            self.numbers("color", &colour),
            self.numbers("specular", &[specularity]),
            self.numbers("shininess", &[shininess]),
        ];
        if reflectivity > 0.0 {
            stated.push(self.numbers("mirror", &[reflectivity]));
        }
        if transparency > 0.0 {
            stated.push(self.numbers("glass", &[transparency]));
            stated.push(self.numbers("ior", &[refractiveindex]));
        }
        if let Some(diffuse) = diffuse {
            stated.push(self.numbers("diffuse", &[diffuse]));
        }
        let stated = Arc::new(stated);
        self.materials.insert(key, stated.clone());
        stated
    }

    fn light(&mut self, k: usize, light: &ScriptLight) -> Object {
        let mut stated = vec![self.numbers("color", &light.colour)];
        if light.ambient > 0.0 {
            stated.push(self.numbers("ambient", &[light.ambient]));
        }
        if light.falloff > 0.0 {
            stated.push(self.numbers("falloff", &[light.falloff.sqrt()]));
        }
        if let Some(angle) = light.angle {
            stated.push(self.numbers("angle", &[angle.to_radians()]));
        }
        if let Some(radius) = light.radius {
            stated.push(self.numbers("radius", &[radius]));
        }
        if light.direction.is_some() && light.position.is_some() {
            stated.push(self.numbers("soft", &[light.softness]));
        }
        let shape = Shape::Light(solid::Light {
            position: light.position.map(|place| self.place(place)),
            direction: light.direction.map(|direction| self.place(direction)),
        });
        self.staged(format!("light{}", k + 1), Span::default(), shape, stated)
    }

    fn camera(&mut self, camera: &ScriptCamera, has_lens: bool) -> Object {
        let direction = vector::sub(camera.pointing, camera.position);
        let mut stated = vec![
            self.numbers("fov", &[camera.fov.to_radians()]),
            self.numbers("focus", &[camera.focaldistance]),
        ];
        if has_lens {
            stated.push(self.numbers("aperture", &[camera.aperture / APERTURES]));
        }
        let roll = roll(direction, camera.roll.to_radians());
        if roll != 0.0 {
            stated.push(self.numbers("roll", &[roll]));
        }
        stated.push(word("bokeh", bokeh(&camera.apertureshape)));
        stated.push(word("projection", &camera.projection));
        let shape = Shape::Camera(solid::Camera {
            direction: self.place(direction),
            position: self.place(camera.position),
        });
        self.staged("camera".to_owned(), Span::default(), shape, stated)
    }

    fn background(&mut self, background: &Background) -> Object {
        let colour = match (background.horizon, background.sky, background.colour) {
            (None, None, None) => [1.0; 3],
            (None, None, Some(colour)) => colour,
            (horizon, sky, colour) => {
                let other = colour.unwrap_or([1.0; 3]);
                let (horizon, sky) = (horizon.unwrap_or(other), sky.unwrap_or(other));
                let graph = &mut self.graph;
                let z = graph.input(Input::Variable(2));
                let share = graph.unary(Unary::Abs, z);
                let one = graph.constant(1.0);
                let rest = graph.sub(one, share);
                let colour = [0, 1, 2].map(|k| {
                    let low = graph.constant(horizon[k]);
                    let high = graph.constant(sky[k]);
                    let low = graph.mul(low, rest);
                    let high = graph.mul(high, share);
                    graph.add(low, high)
                });
                return self.sky(colour, background);
            }
        };
        let colour = colour.map(|part| self.graph.constant(part));
        self.sky(colour, background)
    }

    fn sky(&mut self, colour: [NodeId; 3], background: &Background) -> Object {
        let mut stated = Vec::new();
        if let Some(image) = &background.image {
            stated.push(word("image", image));
            stated.push(self.numbers("turn", &[background.angle - FRAC_PI_2]));
        }
        let shape = Shape::Background(solid::Background { colour });
        self.staged("background".to_owned(), Span::default(), shape, stated)
    }

    fn staged(
        &self,
        name: String,
        name_span: Span,
        shape: Shape,
        attributes: Vec<Attribute>,
    ) -> Object {
        Object {
            name,
            name_span,
            shape,
            params: Vec::new(),
            grids: Vec::new(),
            geodesic_values: Vec::new(),
            attributes,
        }
    }

    /// Returns numbers of the script as nodes, in the order of the scene's axes.
    fn place(&mut self, [x, y, z]: [f64; 3]) -> [NodeId; 3] {
        [x, z, y].map(|number| self.graph.constant(number))
    }

    fn numbers(&mut self, word: &'static str, numbers: &[f64]) -> Attribute {
        let nodes = numbers.iter().map(|&number| self.graph.constant(number));
        Attribute {
            word,
            span: Span::default(),
            value: AttributeValue::Numbers(nodes.collect()),
            map: None,
        }
    }
}

/// Returns the word for the shape of a lens.
pub(super) fn bokeh(shape: &str) -> &str {
    match shape {
        "uniform" => "box",
        shape => shape,
    }
}

fn word(word: &'static str, value: &str) -> Attribute {
    Attribute {
        word,
        span: Span::default(),
        value: AttributeValue::Word(value.to_owned()),
        map: None,
    }
}

fn step(operation: SetOperation) -> SolidStep {
    match operation {
        SetOperation::Union => SolidStep::Union,
        SetOperation::Difference => SolidStep::Difference,
        SetOperation::Intersection => SolidStep::Intersection,
    }
}

/// Returns the roll of a camera that looks along a direction of the script: the angle of the picture's up towards its right,
/// relative to the scene's cameras. The script's up is the projection of (sin roll, cos roll, 0) perpendicular to the
/// direction.
pub(super) fn roll(direction: [f64; 3], roll: f64) -> f64 {
    let Some(ahead) = vector::unit(direction) else {
        return 0.0;
    };
    let is_upright = ahead[0] == 0.0 && ahead[2] == 0.0;
    if roll == 0.0 && !is_upright {
        return 0.0;
    }
    let above = if is_upright {
        [ahead[1].signum(), 0.0, 0.0]
    } else {
        [roll.sin(), roll.cos(), 0.0]
    };
    let Some(left) = vector::unit(cross(ahead, above)) else {
        return 0.0;
    };
    let right = vector::scaled(left, -1.0);
    let up = cross(ahead, right);
    // The scene's up: y, or z if the camera looks straight up or down.
    let usual = if is_upright {
        [0.0, 0.0, 1.0]
    } else {
        [0.0, 1.0, 0.0]
    };
    let Some(left) = vector::unit(cross(ahead, usual)) else {
        return 0.0;
    };
    let right = vector::scaled(left, -1.0);
    let usual = cross(ahead, right);
    dot(up, right).atan2(dot(up, usual))
}
