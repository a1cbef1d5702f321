//! Objects: evaluates attributes and checks them against the table. The results are entities, materials, lights, cameras,
//! backgrounds and settings.

use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use geodesic::vector::{cross, norm};
use syntax::crt::objects::{DefaultValue, ObjectAttribute, ObjectName, ValueType};
use syntax::crt::tree::{Attribute, Object};
use syntax::diagnostic::Diagnostic;
use syntax::span::Span;
use syntax::spelling::nearest;

use super::codes;
use super::entity::{Entity, Map, Node, ObjectNode, SetOperation, UnitShape};
use super::run::{Interpreter, Stopped};
use super::value::{Background, Material, ScriptCamera, ScriptLight, ScriptSettings, ScriptValue};
use super::vector;

/// The values of an object's attributes, with their spans. All required ones are present, and all have the types of the
/// table.
struct Stated(HashMap<&'static str, (ScriptValue, Span)>);

impl Stated {
    fn get(&self, word: &str) -> Option<&ScriptValue> {
        self.0.get(word).map(|(value, _)| value)
    }

    fn span(&self, word: &str) -> Option<Span> {
        self.0.get(word).map(|(_, span)| *span)
    }

    fn number(&self, word: &str) -> Option<f64> {
        self.get(word)?.number()
    }

    fn number_or(&self, word: &str, other: f64) -> f64 {
        self.number(word).unwrap_or(other)
    }

    fn triple(&self, word: &str) -> Option<[f64; 3]> {
        match self.get(word)? {
            ScriptValue::Vector(parts) | ScriptValue::Colour(parts) => Some(*parts),
            _ => None,
        }
    }

    fn text(&self, word: &str) -> Option<Arc<str>> {
        match self.get(word)? {
            ScriptValue::Text(text) => Some(text.clone()),
            _ => None,
        }
    }
}

impl Interpreter<'_> {
    /// Evaluates an object.
    pub(super) fn object(&mut self, object: &Object, span: Span) -> Result<ScriptValue, Stopped> {
        let Some(name) = ObjectName::from_text(&object.name.text) else {
            for attribute in &object.attributes {
                self.value(&attribute.value)?;
            }
            return Err(Stopped);
        };
        let stated = self.attributes(name, &object.attributes)?;
        self.count_object();
        match name {
            ObjectName::Material => Ok(ScriptValue::Material(Arc::new(material(&stated)))),
            ObjectName::Camera => self.camera(&stated, span),
            ObjectName::Background => Ok(ScriptValue::Background(Arc::new(Background {
                image: stated.text("image"),
                angle: stated.number_or("angle", 0.0),
                horizon: stated.triple("horizon"),
                sky: stated.triple("sky"),
                colour: stated.triple("color"),
            }))),
            ObjectName::PointLight
            | ObjectName::ParallelLight
            | ObjectName::SpotLight
            | ObjectName::CylinderLight => self.light(name, &stated, span),
            ObjectName::Settings => Err(Stopped),
            entity => self.entity(entity, &stated, object),
        }
    }

    /// Evaluates the block `Settings`.
    pub(super) fn settings(
        &mut self,
        attributes: &[Attribute],
        span: Span,
    ) -> Result<ScriptSettings, Stopped> {
        let stated = self.attributes(ObjectName::Settings, attributes)?;
        let whole = |word: &str, other: u32| match stated.get(word) {
            Some(ScriptValue::Integer(number)) => u32::try_from(*number).unwrap_or(other),
            _ => other,
        };
        let lights = match stated.get("lights") {
            Some(ScriptValue::List(list)) => {
                let lights = list.items.iter().filter_map(|item| match item {
                    ScriptValue::Light(light) => Some(light.clone()),
                    _ => None,
                });
                lights.collect()
            }
            _ => Vec::new(),
        };
        let (supersampling, dofsamples) = (whole("supersampling", 1), whole("dofsamples", 1));
        let samples = u64::from(supersampling)
            .pow(2)
            .saturating_mul(dofsamples.into());
        if samples > MAX_SAMPLES {
            let at = stated.span("dofsamples").or(stated.span("supersampling"));
            let message = format!(
                "a pixel has at most {MAX_SAMPLES} samples, dofsamples times the square of supersampling, but these are {samples}"
            );
            return Err(self.fault(codes::OUT_OF_RANGE, at.unwrap_or(span), message));
        }
        Ok(ScriptSettings {
            gamma: stated.number_or("gamma", 1.0),
            background: match stated.get("background") {
                Some(ScriptValue::Background(background)) => Some(background.clone()),
                _ => None,
            },
            camera: match stated.get("camera") {
                Some(ScriptValue::Camera(camera)) => Some(camera.clone()),
                _ => None,
            },
            lights,
            supersampling,
            dofsamples,
            recursiondepth: whole("recursiondepth", 3),
        })
    }

    /// Evaluates all attributes in the order of the text; the last one with a name counts.
    fn attributes(
        &mut self,
        name: ObjectName,
        attributes: &[Attribute],
    ) -> Result<Stated, Stopped> {
        let mut stated = HashMap::new();
        let mut is_whole = true;
        for attribute in attributes {
            let Ok(value) = self.value(&attribute.value) else {
                is_whole = false;
                continue;
            };
            let Some(row) = name.attribute(&attribute.name.text) else {
                continue;
            };
            match self.checked(row, value, attribute.value.span) {
                Ok(value) => {
                    stated.insert(row.text, (value, attribute.value.span));
                }
                Err(Stopped) => is_whole = false,
            }
        }
        let mut required = name.attributes().iter().filter(|row| row.is_required());
        if !is_whole || required.any(|row| !stated.contains_key(row.text)) {
            return Err(Stopped);
        }
        Ok(Stated(stated))
    }

    /// Checks a value against its row of the table.
    fn checked(
        &mut self,
        row: &ObjectAttribute,
        value: ScriptValue,
        span: Span,
    ) -> Result<ScriptValue, Stopped> {
        let word = row.text;
        let is_one = match (row.value, &value) {
            (ValueType::Number(range) | ValueType::Integer(range), value)
                if value.number().is_some() =>
            {
                let is_whole = matches!(value, ScriptValue::Integer(_));
                if is_whole || matches!(row.value, ValueType::Number(_)) {
                    let number = value.number().unwrap_or(f64::NAN);
                    if !range.contains(number) {
                        let message = match range.text() {
                            Some(text) => format!("`{word}` must be {text}, but this is {number}"),
                            None if !number.is_finite() => {
                                format!("`{word}` must be a finite number, but this is {number}")
                            }
                            None if range.is_open => format!(
                                "`{word}` must be > {} and ≤ {}, but this is {number}",
                                range.min, range.max
                            ),
                            None => format!(
                                "`{word}` must be from {} to {}, but this is {number}",
                                range.min, range.max
                            ),
                        };
                        return Err(self.fault(codes::OUT_OF_RANGE, span, message));
                    }
                }
                is_whole || matches!(row.value, ValueType::Number(_))
            }
            (ValueType::Vector, ScriptValue::Vector(parts))
            | (ValueType::Colour, ScriptValue::Colour(parts)) => {
                if parts.iter().any(|part| !part.is_finite()) {
                    let message = format!("`{word}` has a component that is not a finite number");
                    return Err(self.fault(codes::OUT_OF_RANGE, span, message));
                }
                true
            }
            (ValueType::Choice(choices), ScriptValue::Text(text)) => {
                if !choices.contains(&&**text) {
                    let message = format!("`{word}` must be one of {}", choices.join(", "));
                    let mut diagnostic = Diagnostic::error(codes::OUT_OF_RANGE, span, message);
                    if let Some(near) = nearest(text, choices.iter().copied()) {
                        diagnostic = diagnostic.with_hint(format!("did you mean \"{near}\"?"));
                    }
                    self.report(diagnostic);
                    return Err(Stopped);
                }
                true
            }
            (ValueType::Lights, ScriptValue::List(list)) => list
                .items
                .iter()
                .all(|it| matches!(it, ScriptValue::Light(_))),
            (ValueType::Text | ValueType::Image, ScriptValue::Text(_))
            | (ValueType::Material, ScriptValue::Material(_))
            | (ValueType::Background, ScriptValue::Background(_))
            | (ValueType::Camera, ScriptValue::Camera(_)) => true,
            _ => false,
        };
        if is_one {
            return Ok(value);
        }
        let needs = match row.value {
            ValueType::Number(_) => "a number",
            ValueType::Integer(_) => "an Integer",
            ValueType::Vector => "a Vector",
            ValueType::Colour => "a Color",
            ValueType::Text | ValueType::Choice(_) | ValueType::Image => "a String",
            ValueType::Material => "a Material",
            ValueType::Background => "a Background",
            ValueType::Camera => "a Camera",
            ValueType::Lights => "a List of lights",
        };
        let message = format!(
            "`{word}` must be {needs}, but this is a value of type {}",
            value.kind()
        );
        Err(self.fault(codes::TYPE_MISMATCH, span, message))
    }

    fn camera(&mut self, stated: &Stated, span: Span) -> Result<ScriptValue, Stopped> {
        let default = ScriptCamera::default();
        let camera = ScriptCamera {
            position: stated.triple("position").unwrap_or(default.position),
            pointing: stated.triple("pointing").unwrap_or(default.pointing),
            fov: stated.number_or("fov", default.fov),
            aperture: stated.number_or("aperture", default.aperture),
            focaldistance: stated.number_or("focaldistance", default.focaldistance),
            apertureshape: stated
                .text("apertureshape")
                .unwrap_or(default.apertureshape),
            roll: stated.number_or("roll", default.roll),
            projection: stated.text("projection").unwrap_or(default.projection),
        };
        self.direction(
            vector::sub(camera.pointing, camera.position),
            "pointing",
            stated,
            span,
        )?;
        if &*camera.projection != "spherical" && camera.fov >= 180.0 {
            let message = format!(
                "`fov` of a {} camera must be less than 180, but this is {}",
                camera.projection, camera.fov
            );
            let at = stated.span("fov").unwrap_or(span);
            return Err(self.fault(codes::OUT_OF_RANGE, at, message));
        }
        Ok(ScriptValue::Camera(Arc::new(camera)))
    }

    fn light(
        &mut self,
        name: ObjectName,
        stated: &Stated,
        span: Span,
    ) -> Result<ScriptValue, Stopped> {
        let from = stated.triple("origin").or(stated.triple("from"));
        let direction = match (from, stated.triple("pointing")) {
            (Some(from), Some(pointing)) => {
                let direction = vector::sub(pointing, from);
                self.direction(direction, "pointing", stated, span)?;
                Some(direction)
            }
            _ => None,
        };
        Ok(ScriptValue::Light(Arc::new(ScriptLight {
            position: stated.triple("origin"),
            direction,
            colour: stated.triple("color").unwrap_or([1.0; 3]),
            ambient: stated.number_or("ambient", 0.0),
            falloff: stated.number_or("falloff", -1.0),
            angle: (name == ObjectName::SpotLight).then(|| stated.number_or("angle", 60.0)),
            radius: stated.number("radius"),
            softness: stated.number_or("softness", 0.2),
        })))
    }

    /// Refuses a zero direction.
    fn direction(
        &mut self,
        direction: [f64; 3],
        word: &str,
        stated: &Stated,
        span: Span,
    ) -> Result<[f64; 3], Stopped> {
        if let Some(unit) = vector::unit(direction) {
            return Ok(unit);
        }
        let message = format!("`{word}` gives no direction: its length is 0");
        let at = stated.span(word).unwrap_or(span);
        Err(self.fault(codes::OUT_OF_RANGE, at, message))
    }

    fn entity(
        &mut self,
        name: ObjectName,
        stated: &Stated,
        object: &Object,
    ) -> Result<ScriptValue, Stopped> {
        let at = |word: &str| stated.triple(word).unwrap_or_default();
        let radius = stated.number_or("radius", 1.0);
        let span = object.name.span;
        let mut second = None;
        let first = match name {
            ObjectName::Sphere => (UnitShape::Ball, round(radius, at("center"))),
            ObjectName::Box => {
                let (a, b) = (at("cornerA"), at("cornerB"));
                let half = [0, 1, 2].map(|k| 0.5 * (b[k] - a[k]).abs());
                let middle = [0, 1, 2].map(|k| 0.5 * (a[k] + b[k]));
                let map = Map::translate(middle).after(&Map::scale(half));
                (UnitShape::Cube, map)
            }
            ObjectName::Plane | ObjectName::HalfPlane => {
                let normal = self.direction(at("normal"), "normal", stated, span)?;
                if name == ObjectName::HalfPlane {
                    let way = self.direction(at("direction"), "direction", stated, span)?;
                    // A direction along the normal cuts off nothing of the plane.
                    if norm(cross(normal, way)) > 1e-12 {
                        let behind = frame(vector::scaled(way, -1.0), [1.0; 3], at("position"));
                        second = Some((SetOperation::Intersection, UnitShape::HalfSpace, behind));
                    }
                }
                (
                    UnitShape::HalfSpace,
                    frame(normal, [1.0; 3], at("position")),
                )
            }
            ObjectName::Cylinder | ObjectName::Cone => {
                let (end, shape) = match name {
                    ObjectName::Cone => ("apex", UnitShape::Cone),
                    _ => ("top", UnitShape::Cylinder),
                };
                let axis = vector::sub(at(end), at("base"));
                let unit = self.direction(axis, end, stated, span)?;
                let sides = [radius, radius, norm(axis)];
                (shape, frame(unit, sides, at("base")))
            }
            _ => {
                let normal = stated.triple("normal").unwrap_or([0.0, 1.0, 0.0]);
                let normal = self.direction(normal, "normal", stated, span)?;
                let tube = stated.number_or("tube", 1.0) / radius;
                let map = frame(normal, [radius; 3], at("center"));
                if tube > 1.0 {
                    // If the tube extends beyond the axis, the equation leaves a hollow.
                    let within = radius * (tube * tube - 1.0).sqrt();
                    let ball = round(within, at("center"));
                    second = Some((SetOperation::Union, UnitShape::Ball, ball));
                }
                (UnitShape::Torus(tube), map)
            }
        };
        let material = match stated.get("material") {
            Some(ScriptValue::Material(material)) => material.clone(),
            _ => Arc::new(Material::default()),
        };
        let place = span.moved(self.base);
        let node = ObjectNode {
            first,
            second,
            made: format!("{} {}", name.text(), self.lines.place(place.start)),
            name: OnceLock::new(),
            span: place,
            material,
            is_plane: matches!(name, ObjectName::Plane | ObjectName::HalfPlane),
        };
        let node = Node::Object(Box::new(node));
        let id = self.id();
        Ok(ScriptValue::Entity(Arc::new(Entity::of(
            Arc::new(node),
            id,
        ))))
    }
}

/// The maximum number of samples per pixel.
const MAX_SAMPLES: u64 = 1 << 16;

fn round(radius: f64, centre: [f64; 3]) -> Map {
    Map::translate(centre).after(&Map::scale([radius; 3]))
}

/// Returns the map that takes z to a unit vector, with these lengths of the axes.
fn frame(z: [f64; 3], [a, b, c]: [f64; 3], at: [f64; 3]) -> Map {
    let [x, y] = vector::across(z);
    let axes = [
        vector::scaled(x, a),
        vector::scaled(y, b),
        vector::scaled(z, c),
    ];
    Map::columns(axes, at)
}

fn material(stated: &Stated) -> Material {
    let default = Material::default();
    let number = |word: &str| {
        let row = ObjectName::Material.attribute(word);
        let other = match row.map(|row| row.default) {
            Some(DefaultValue::Number(number)) => number,
            _ => 0.0,
        };
        stated.number_or(word, other)
    };
    Material {
        colour: stated.triple("color").unwrap_or(default.colour),
        reflectivity: number("reflectivity"),
        transparency: number("transparency"),
        refractiveindex: number("refractiveindex"),
        diffuse: stated.number("diffuse"),
        specularity: number("specularity"),
        shininess: number("shininess"),
    }
}
