//! Values, and the objects that are not entities.

use std::sync::Arc;

use syntax::crt::tree::Macro;

use super::entity::Entity;

/// A value of a script.
#[derive(Clone, Debug)]
pub(super) enum ScriptValue {
    Integer(i32),
    Float(f64),
    Text(Arc<str>),
    Boolean(bool),
    List(Arc<List>),
    Vector([f64; 3]),
    Colour([f64; 3]),
    Material(Arc<Material>),
    Light(Arc<ScriptLight>),
    Camera(Arc<ScriptCamera>),
    Background(Arc<Background>),
    Entity(Arc<Entity>),
    Macro(MacroValue),
}

/// A list.
#[derive(Debug)]
pub(super) struct List {
    pub(super) items: Vec<ScriptValue>,
    /// The depth of nested lists.
    pub(super) depth: u32,
    /// True for the value of a call: the entities that the macro emitted.
    pub(super) is_emitted: bool,
}

/// A macro, with the scope in which it is written.
#[derive(Clone, Debug)]
pub(super) struct MacroValue {
    pub(super) definition: Arc<Macro>,
    pub(super) scope: usize,
    /// The offset to which its spans are relative.
    pub(super) base: u32,
}

/// The look of an entity.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Material {
    pub(super) colour: [f64; 3],
    pub(super) reflectivity: f64,
    pub(super) transparency: f64,
    pub(super) refractiveindex: f64,
    pub(super) diffuse: Option<f64>,
    pub(super) specularity: f64,
    pub(super) shininess: f64,
}

/// A light.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ScriptLight {
    pub(super) position: Option<[f64; 3]>,
    pub(super) direction: Option<[f64; 3]>,
    pub(super) colour: [f64; 3],
    pub(super) ambient: f64,
    pub(super) falloff: f64,
    /// In degrees.
    pub(super) angle: Option<f64>,
    pub(super) radius: Option<f64>,
    pub(super) softness: f64,
}

/// A camera.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ScriptCamera {
    pub(super) position: [f64; 3],
    pub(super) pointing: [f64; 3],
    /// In degrees.
    pub(super) fov: f64,
    pub(super) aperture: f64,
    pub(super) focaldistance: f64,
    pub(super) apertureshape: Arc<str>,
    /// In degrees.
    pub(super) roll: f64,
    pub(super) projection: Arc<str>,
}

/// The light from directions in which nothing is hit.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Background {
    pub(super) image: Option<Arc<str>>,
    /// In radians.
    pub(super) angle: f64,
    pub(super) horizon: Option<[f64; 3]>,
    pub(super) sky: Option<[f64; 3]>,
    pub(super) colour: Option<[f64; 3]>,
}

/// The block `Settings`.
#[derive(Clone, Debug)]
pub(super) struct ScriptSettings {
    pub(super) gamma: f64,
    pub(super) background: Option<Arc<Background>>,
    pub(super) camera: Option<Arc<ScriptCamera>>,
    pub(super) lights: Vec<Arc<ScriptLight>>,
    pub(super) supersampling: u32,
    pub(super) dofsamples: u32,
    pub(super) recursiondepth: u32,
}

/// The maximum length of the text of a value, in characters; approximate for lists.
pub(super) const LONGEST: usize = 200;

impl ScriptValue {
    /// Returns the name of its type.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::Integer(_) => "Integer",
            Self::Float(_) => "Float",
            Self::Text(_) => "String",
            Self::Boolean(_) => "Boolean",
            Self::List(_) => "List",
            Self::Vector(_) => "Vector",
            Self::Colour(_) => "Color",
            Self::Material(_) => "Material",
            Self::Light(_) => "Light",
            Self::Camera(_) => "Camera",
            Self::Background(_) => "Background",
            Self::Entity(_) => "Entity",
            Self::Macro(_) => "Macro",
        }
    }

    /// Returns the number of an Integer or a Float.
    pub(super) fn number(&self) -> Option<f64> {
        match *self {
            Self::Integer(number) => Some(f64::from(number)),
            Self::Float(number) => Some(number),
            _ => None,
        }
    }

    /// Returns the components of a number, a vector or a colour.
    pub(super) fn numbers(&self) -> Vec<f64> {
        match self {
            Self::Vector(parts) | Self::Colour(parts) => parts.to_vec(),
            other => other.number().into_iter().collect(),
        }
    }

    /// Returns the entities of a list that contains nothing else.
    pub(super) fn entities(&self) -> Option<Vec<Arc<Entity>>> {
        let Self::List(list) = self else {
            return None;
        };
        let entity = |item: &Self| match item {
            Self::Entity(entity) => Some(entity.clone()),
            _ => None,
        };
        list.items.iter().map(entity).collect()
    }

    /// Returns true if two values other than lists are equal: numbers across types, entities by identity.
    pub(super) fn equals(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Integer(a), Self::Integer(b)) => a == b,
            (Self::Text(a), Self::Text(b)) => a == b,
            (Self::Boolean(a), Self::Boolean(b)) => a == b,
            (Self::Vector(a), Self::Vector(b)) | (Self::Colour(a), Self::Colour(b)) => a == b,
            (Self::Material(a), Self::Material(b)) => a == b,
            (Self::Light(a), Self::Light(b)) => a == b,
            (Self::Camera(a), Self::Camera(b)) => a == b,
            (Self::Background(a), Self::Background(b)) => a == b,
            (Self::Entity(a), Self::Entity(b)) => a.id == b.id,
            (Self::Macro(a), Self::Macro(b)) => Arc::ptr_eq(&a.definition, &b.definition),
            _ => match (self.number(), other.number()) {
                (Some(a), Some(b)) => a == b,
                _ => false,
            },
        }
    }

    /// Returns the text of a number, a string or a Boolean, as concatenated by `+`.
    pub(super) fn simple_text(&self) -> Option<String> {
        Some(match self {
            Self::Integer(number) => number.to_string(),
            Self::Float(number) => float_text(*number),
            Self::Text(text) => text.to_string(),
            Self::Boolean(truth) => truth.to_string(),
            _ => return None,
        })
    }

    /// Returns the value in the syntax of a script; a long list is truncated.
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        self.write(&mut text);
        text
    }

    fn write(&self, into: &mut String) {
        if into.len() > LONGEST {
            return;
        }
        let parts = |name: &str, parts: &[f64; 3]| {
            let parts = parts.map(float_text);
            format!("{name}({})", parts.join(", "))
        };
        let text = match self {
            Self::Text(text) => quoted(text),
            Self::Vector(vector) => parts("vec3", vector),
            Self::Colour(colour) => parts("rgb", colour),
            Self::List(list) => {
                into.push('[');
                for (k, item) in list.items.iter().enumerate() {
                    if into.len() > LONGEST {
                        into.push('…');
                        break;
                    }
                    if k > 0 {
                        into.push_str(", ");
                    }
                    item.write(into);
                }
                into.push(']');
                return;
            }
            Self::Macro(it) => {
                let names = it.definition.parameters.iter();
                let names: Vec<&str> = names.map(|word| &*word.text).collect();
                format!("Macro ({}) {{ … }}", names.join(", "))
            }
            Self::Entity(entity) => match entity.leaves {
                1 => "Entity".to_owned(),
                leaves => format!("Entity of {leaves} leaves"),
            },
            other => other
                .simple_text()
                .unwrap_or_else(|| format!("{} {{ … }}", other.kind())),
        };
        into.push_str(&text);
    }
}

/// Returns a string as a literal, with Java's escapes.
fn quoted(text: &str) -> String {
    let mut literal = String::from('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => literal.extend(['\\', c]),
            '\n' => literal.push_str("\\n"),
            '\r' => literal.push_str("\\r"),
            '\t' => literal.push_str("\\t"),
            c if c.is_control() => literal.push_str(&format!("\\u{:04x}", u32::from(c))),
            c => literal.push(c),
        }
    }
    literal.push('"');
    literal
}

/// Returns a Float in the format of Java.
pub(super) fn float_text(number: f64) -> String {
    if number.is_nan() {
        return "NaN".to_owned();
    }
    if number.is_infinite() {
        let sign = if number < 0.0 { "-" } else { "" };
        return format!("{sign}Infinity");
    }
    let size = number.abs();
    if size == 0.0 || (1e-3..1e7).contains(&size) {
        return format!("{number:?}");
    }
    let text = format!("{number:e}");
    match text.split_once('e') {
        Some((digits, exponent)) if !digits.contains('.') => format!("{digits}.0E{exponent}"),
        Some((digits, exponent)) => format!("{digits}E{exponent}"),
        None => text,
    }
}
