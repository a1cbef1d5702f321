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

/// The values of an object's attributes that are stated, with their spans. All required ones are present, and all have the
/// types of the table. A number, a vector, a colour or a string that is not stated has the default of the table.
struct Stated {
    object: ObjectName,
    values: HashMap<&'static str, (ScriptValue, Span)>,
}

impl Stated {
    /// Returns the values of an object that states nothing.
    fn nothing(object: ObjectName) -> Self {
        Self {
            object,
            values: HashMap::new(),
        }
    }

    fn get(&self, word: &str) -> Option<&ScriptValue> {
        self.values.get(word).map(|(value, _)| value)
    }

    fn span(&self, word: &str) -> Option<Span> {
        self.values.get(word).map(|(_, span)| *span)
    }

    fn default(&self, word: &str) -> Option<DefaultValue> {
        self.object.attribute(word).map(|row| row.default)
    }

    fn number(&self, word: &str) -> Option<f64> {
        match (self.get(word), self.default(word)?) {
            (Some(value), _) => value.number(),
            (None, DefaultValue::Number(number)) => Some(number),
            (None, DefaultValue::Integer(number)) => Some(number.into()),
            _ => None,
        }
    }

    fn triple(&self, word: &str) -> Option<[f64; 3]> {
        match (self.get(word), self.default(word)?) {
            (Some(ScriptValue::Vector(parts) | ScriptValue::Colour(parts)), _) => Some(*parts),
            (None, DefaultValue::Vector(parts) | DefaultValue::Colour(parts)) => Some(parts),
            _ => None,
        }
    }

    fn text(&self, word: &str) -> Option<Arc<str>> {
        match (self.get(word), self.default(word)?) {
            (Some(ScriptValue::Text(text)), _) => Some(text.clone()),
            (None, DefaultValue::Text(text)) => Some(text.into()),
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
                angle: stated.number("angle").unwrap_or_default(),
                horizon: stated.triple("horizon"),
                sky: stated.triple("sky"),
                colour: stated.triple("color"),
            }))),
            ObjectName::PointLight
            | ObjectName::ParallelLight
            | ObjectName::SpotLight
            | ObjectName::CylinderLight => self.light(&stated, span),
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
        let settings = settings(&stated);
        let samples = u64::from(settings.supersampling)
            .pow(2)
            .saturating_mul(settings.dofsamples.into());
        if samples > MAX_SAMPLES {
            let at = stated.span("dofsamples").or(stated.span("supersampling"));
            let message = format!(
                "a pixel has at most {MAX_SAMPLES} samples, dofsamples times the square of supersampling, but these are {samples}"
            );
            return Err(self.fault(codes::OUT_OF_RANGE, at.unwrap_or(span), message));
        }
        Ok(settings)
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
        Ok(Stated {
            object: name,
            values: stated,
        })
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
        let camera = camera(stated);
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

    fn light(&mut self, stated: &Stated, span: Span) -> Result<ScriptValue, Stopped> {
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
            ambient: stated.number("ambient").unwrap_or_default(),
            falloff: stated.number("falloff").unwrap_or_default(),
            angle: stated.number("angle"),
            radius: stated.number("radius"),
            softness: stated.number("softness").unwrap_or_default(),
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
        let number = |word: &str| stated.number(word).unwrap_or_default();
        let radius = number("radius");
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
                let normal = self.direction(at("normal"), "normal", stated, span)?;
                let tube = number("tube") / radius;
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
    let number = |word: &str| stated.number(word).unwrap_or_default();
    Material {
        colour: stated.triple("color").unwrap_or_default(),
        reflectivity: number("reflectivity"),
        transparency: number("transparency"),
        refractiveindex: number("refractiveindex"),
        diffuse: stated.number("diffuse"),
        specularity: number("specularity"),
        shininess: number("shininess"),
    }
}

impl Default for Material {
    fn default() -> Self {
        material(&Stated::nothing(ObjectName::Material))
    }
}

fn camera(stated: &Stated) -> ScriptCamera {
    let number = |word: &str| stated.number(word).unwrap_or_default();
    ScriptCamera {
        position: stated.triple("position").unwrap_or_default(),
        pointing: stated.triple("pointing").unwrap_or_default(),
        fov: number("fov"),
        aperture: number("aperture"),
        focaldistance: number("focaldistance"),
        apertureshape: stated.text("apertureshape").unwrap_or_default(),
        roll: number("roll"),
        projection: stated.text("projection").unwrap_or_default(),
    }
}

impl Default for ScriptCamera {
    fn default() -> Self {
        Self {
            position: [0.0, 0.0, -1.0],
            fov: 60.0,
            ..camera(&Stated::nothing(ObjectName::Camera))
        }
    }
}

fn settings(stated: &Stated) -> ScriptSettings {
    let whole = |word: &str| stated.number(word).unwrap_or_default() as u32;
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
    ScriptSettings {
        gamma: stated.number("gamma").unwrap_or_default(),
        background: match stated.get("background") {
            Some(ScriptValue::Background(background)) => Some(background.clone()),
            _ => None,
        },
        camera: match stated.get("camera") {
            Some(ScriptValue::Camera(camera)) => Some(camera.clone()),
            _ => None,
        },
        lights,
        supersampling: whole("supersampling"),
        dofsamples: whole("dofsamples"),
        recursiondepth: whole("recursiondepth"),
    }
}

impl Default for ScriptSettings {
    fn default() -> Self {
        settings(&Stated::nothing(ObjectName::Settings))
    }
}
