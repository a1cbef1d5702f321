//! The two looks of a picture: the formulas that convert light to bytes.
//!
//! In `geotrace`, stated colours are sRGB and light is linear; in `crt`, the look of the CRT scene language, colours are
//! light, and a gamma curve converts it to bytes.

use glam::DVec3;

use crate::srgb;

/// The formulas of a picture.
#[derive(Clone, Copy, Debug, Default, Eq, Hash, PartialEq)]
pub enum PictureLook {
    /// Linear light; stated colours are sRGB.
    #[default]
    Geotrace,
    /// The formulas of the CRT scene language.
    Crt,
}

impl PictureLook {
    /// Both looks.
    pub const ALL: [Self; 2] = [Self::Geotrace, Self::Crt];

    /// Returns its name on a command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Geotrace => "geotrace",
            Self::Crt => "crt",
        }
    }

    /// Returns the light of a stated colour; the curve continues beyond 1.
    pub fn light(self, colour: DVec3) -> DVec3 {
        match self {
            Self::Geotrace => srgb::linear(colour),
            Self::Crt => colour,
        }
    }

    /// Returns the light of an image whose colour is this linear light.
    pub fn image_light(self, light: DVec3) -> DVec3 {
        match self {
            Self::Geotrace => light,
            Self::Crt => DVec3::from_array(srgb::bytes(light).map(f64::from)) / 255.0,
        }
    }

    /// Returns the weight below which rays are dropped. In `crt`, lights may be much brighter than the surfaces they light.
    pub fn least_weight(self) -> f64 {
        match self {
            Self::Geotrace => 1.0 / 1024.0,
            Self::Crt => 1.0 / 16384.0,
        }
    }
}

/// Returns the bytes of light in the look `crt`: 255·c^(1/gamma), truncated to integers.
pub fn gamma_encoded(light: DVec3, gamma: f64) -> [u8; 3] {
    light
        .to_array()
        .map(|c| (255.0 * c.max(0.0).powf(1.0 / gamma)) as u8)
}
