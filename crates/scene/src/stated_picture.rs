//! The picture that a text describes by itself.

use syntax::crt::objects::{ObjectName, ValueType};

/// The settings of a picture, of a text in left-handed coordinates (x right, y up, z into the screen).
#[derive(Clone, Debug, PartialEq)]
pub struct StatedPicture {
    /// The exponent 1/gamma makes bytes of light; positive.
    pub gamma: f64,
    /// The samples of a pixel lie on a grid of so many columns and rows; at least 1.
    pub supersampling: u32,
    /// The samples on the lens of each of them; at least 1.
    pub lens_samples: u32,
    /// The reflections and refractions that are followed.
    pub bounces: u32,
}

/// A number of the settings of a script, as its block `Settings` names it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StatedSetting {
    /// Its name.
    pub word: &'static str,
    /// Its purpose: a phrase.
    pub purpose: &'static str,
    /// Its value.
    pub value: f64,
    /// The least and the greatest value; the least of `gamma` itself is none.
    pub range: [f64; 2],
    /// True if it is a whole number.
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
