//! The picture that a text itself describes.

use syntax::crt::objects::{ObjectName, ValueType};

/// The settings of the picture of a text in left-handed coordinates (x right, y up, z into the screen).
#[derive(Clone, Debug, PartialEq)]
pub struct StatedPicture {
    /// The exponent 1/gamma converts light to bytes; positive.
    pub gamma: f64,
    /// The samples of a pixel form a grid with this number of columns and of rows; at least 1.
    pub supersampling: u32,
    /// The number of samples on the lens for each of them; at least 1.
    pub lens_samples: u32,
    /// The maximum number of reflections and refractions.
    pub bounces: u32,
}

/// A number of a script's settings, as named in the block `Settings`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StatedSetting {
    /// Its name.
    pub word: &'static str,
    /// Its purpose, as a phrase.
    pub purpose: &'static str,
    /// Its value.
    pub value: f64,
    /// The minimum and the maximum; the minimum of `gamma` is excluded.
    pub range: [f64; 2],
    /// True if it is an integer.
    pub is_whole: bool,
}

impl StatedPicture {
    /// Returns the numbers of the settings, in the order of the table of objects.
    pub fn settings(&self) -> impl Iterator<Item = StatedSetting> + '_ {
        let attributes = ObjectName::Settings.attributes().iter();
        attributes.filter_map(|attribute| {
            let value = match attribute.text {
                "gamma" => self.gamma,
                "supersampling" => f64::from(self.supersampling),
                "dofsamples" => f64::from(self.lens_samples),
                "recursiondepth" => f64::from(self.bounces),
                _ => return None,
            };
            let (is_whole, range) = match attribute.value {
                ValueType::Integer(range) => (true, range),
                ValueType::Number(range) => (false, range),
                _ => return None,
            };
            Some(StatedSetting {
                word: attribute.text,
                purpose: attribute.purpose,
                value,
                range: [range.min, range.max],
                is_whole,
            })
        })
    }
}
