//! The curve of sRGB (IEC 61966-2-1) between colours and linear light.

use std::sync::LazyLock;

use glam::DVec3;

/// Returns the linear light of an sRGB component; the curve continues beyond 1.
pub fn decode(component: f64) -> f64 {
    if component <= 0.040_45 {
        component / 12.92
    } else {
        ((component + 0.055) / 1.055).powf(2.4)
    }
}

/// Returns the sRGB component of linear light; the curve continues beyond 1.
pub fn encode(light: f64) -> f64 {
    if light <= 0.003_130_8 {
        12.92 * light
    } else {
        1.055 * light.powf(1.0 / 2.4) - 0.055
    }
}

/// Returns the linear light of an sRGB colour; the curve continues beyond 1.
pub fn linear(colour: DVec3) -> DVec3 {
    DVec3::from_array(colour.to_array().map(decode))
}

/// Returns the nearest sRGB bytes of linear light. Values outside `[0, 1]` are clamped; NaN becomes 0.
pub fn bytes(light: DVec3) -> [u8; 3] {
    let table = &*BYTES;
    light.to_array().map(|x| table.byte(x))
}

/// Returns the nearest byte of linear light.
fn nearest_byte(light: f64) -> u8 {
    let light = if light.is_nan() { 0.0 } else { light };
    (255.0 * encode(light.clamp(0.0, 1.0))).round() as u8
}

/// A table with the results of [`nearest_byte`], to avoid its power.
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
            if usize::from(nearest_byte(f64::from_bits(middle))) < byte {
                below = middle + 1;
            } else {
                found = middle;
            }
        }
        *least = f64::from_bits(found);
    }
    let first = std::array::from_fn(|k| nearest_byte(k as f64 / BYTE_CELLS as f64));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_gives_the_bytes_of_the_curve() {
        let table = &*BYTES;
        for least in table.least {
            for x in [least.next_down(), least, least.next_up()] {
                assert_eq!(table.byte(x), nearest_byte(x), "{x}");
            }
        }
        for k in 0..1_000_000 {
            let x = f64::from(k) * 1.1e-6;
            assert_eq!(table.byte(x), nearest_byte(x), "{x}");
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
            assert_eq!(table.byte(x), nearest_byte(x), "{x}");
        }
    }
}
