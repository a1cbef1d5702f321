//! The two looks of a picture: the formulas that convert light to bytes.
//!
//! In `geotrace`, stated colours are sRGB and light is linear; in `crt`, the look of the CRT scene language, colours are
//! light, and a gamma curve converts it to bytes.

use std::sync::LazyLock;

use glam::DVec3;

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
    pub fn light(self, color: DVec3) -> DVec3 {
        match self {
            Self::Geotrace => decoded(color),
            Self::Crt => color,
        }
    }

    /// Returns the light of an image whose colour is this linear light.
    pub fn image_light(self, light: DVec3) -> DVec3 {
        match self {
            Self::Geotrace => light,
            Self::Crt => DVec3::from_array(encoded(light).map(f64::from)) / 255.0,
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

/// Returns the sRGB colour of linear light, as bytes.
pub fn encoded(light: DVec3) -> [u8; 3] {
    let table = &*BYTES;
    let [r, g, b] = light.to_array();
    [table.byte(r), table.byte(g), table.byte(b)]
}

/// Returns the byte of linear light by the sRGB curve.
fn encoded_byte(x: f64) -> u8 {
    let x = if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) };
    let encoded = if x <= 0.003_130_8 {
        12.92 * x
    } else {
        1.055 * x.powf(1.0 / 2.4) - 0.055
    };
    (255.0 * encoded).round() as u8
}

/// A table with the results of [`encoded_byte`], to avoid its power.
struct ByteTable {
    /// The smallest light of each byte.
    least: [f64; 256],
    /// The byte of the smallest light of each cell.
    first: [u8; BYTE_CELLS + 1],
}

/// Even where the curve is steepest, a cell has at most two bytes.
const BYTE_CELLS: usize = 4096;

static BYTES: LazyLock<ByteTable> = LazyLock::new(|| {
    let mut least = [0.0; 256];
    for (byte, least) in least.iter_mut().enumerate() {
        // The numbers from 0 to 1 have the order of their bits.
        let (mut below, mut found) = (0, 1f64.to_bits());
        while below < found {
            let middle = below + (found - below) / 2;
            if usize::from(encoded_byte(f64::from_bits(middle))) < byte {
                below = middle + 1;
            } else {
                found = middle;
            }
        }
        *least = f64::from_bits(found);
    }
    let first = std::array::from_fn(|k| encoded_byte(k as f64 / BYTE_CELLS as f64));
    ByteTable { least, first }
});

impl ByteTable {
    #[inline]
    fn byte(&self, x: f64) -> u8 {
        // The cast maps NaN to 0.
        let cell = (x * BYTE_CELLS as f64) as usize;
        let mut byte = self.first[cell.min(BYTE_CELLS)];
        while byte < u8::MAX && x >= self.least[usize::from(byte) + 1] {
            byte += 1;
        }
        byte
    }
}

/// Returns the linear light of an sRGB colour; the curve continues beyond 1.
pub fn decoded(color: DVec3) -> DVec3 {
    DVec3::from_array(color.to_array().map(|x| {
        if x <= 0.040_45 {
            x / 12.92
        } else {
            ((x + 0.055) / 1.055).powf(2.4)
        }
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_gives_the_bytes_of_the_curve() {
        let table = &*BYTES;
        for least in table.least {
            for x in [least.next_down(), least, least.next_up()] {
                assert_eq!(table.byte(x), encoded_byte(x), "{x}");
            }
        }
        for k in 0..1_000_000 {
            let x = f64::from(k) * 1.1e-6;
            assert_eq!(table.byte(x), encoded_byte(x), "{x}");
        }
        for x in [
            f64::NAN,
            -1.0,
            -0.0,
            1.0,
            2.0,
            1e300,
            f64::INFINITY,
            f64::NEG_INFINITY,
        ] {
            assert_eq!(table.byte(x), encoded_byte(x), "{x}");
        }
    }
}
