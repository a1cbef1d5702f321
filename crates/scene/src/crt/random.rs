//! Random numbers as `java.util.Random` has them.

/// The generator, with its 48 bits.
#[derive(Clone, Debug)]
pub(super) struct JavaRandom(u64);

const MULTIPLIER: u64 = 0x5_DEEC_E66D;
const MASK: u64 = (1 << 48) - 1;

impl JavaRandom {
    pub(super) fn new(seed: u64) -> Self {
        Self((seed ^ MULTIPLIER) & MASK)
    }

    /// Returns the top bits of the next state.
    fn next(&mut self, bits: u32) -> u64 {
        self.0 = self.0.wrapping_mul(MULTIPLIER).wrapping_add(11) & MASK;
        self.0 >> (48 - bits)
    }

    /// Returns a number from 0 to 1.
    pub(super) fn number(&mut self) -> f64 {
        let high = self.next(26) << 27;
        (high + self.next(27)) as f64 / (1u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::JavaRandom;

    #[test]
    fn the_first_numbers_are_those_of_java() {
        let mut random = JavaRandom::new(1337);
        assert_eq!(random.number(), 0.659_929_784_744_821_7);
        assert!((random.number() - 0.689_242_67).abs() < 5e-9);
    }
}
