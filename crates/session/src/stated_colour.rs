//! The colour that the text states for an object, which a frontend shows and writes instead of a chosen one.

use scene::{AttributeValue, Object, Scene};

/// The colour that an object states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StatedColour {
    /// Numbers: sRGB, 0…1.
    Constant([f64; 3]),
    /// An expression that depends on position or on a param.
    Expression,
}

impl StatedColour {
    /// Returns the colour that an object of a scene states.
    pub fn of(scene: &Scene, object: &Object) -> Option<Self> {
        let stated = object.attributes.iter().find(|it| it.word == "color")?;
        let AttributeValue::Numbers(nodes) = &stated.value else {
            return None;
        };
        let values: Option<Vec<f64>> = nodes.iter().map(|node| scene.graph.value(*node)).collect();
        Some(match values.as_deref() {
            Some([grey]) => Self::Constant([*grey; 3]),
            Some(&[red, green, blue]) => Self::Constant([red, green, blue]),
            _ => Self::Expression,
        })
    }

    /// Returns its components in 0…255, if they are numbers.
    pub fn rgb(self) -> Option<[u8; 3]> {
        match self {
            Self::Constant(stated) => {
                Some(stated.map(|part| (255.0 * part.clamp(0.0, 1.0)).round() as u8))
            }
            Self::Expression => None,
        }
    }
}
