//! Mutations of inputs: a seed is changed in a few places, by pieces of other seeds and of a dictionary.

/// A sequence of pseudo-random numbers: xorshift64*, the same on every machine.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The sequence of a seed.
    pub fn new(seed: u64) -> Self {
        // The state must not be zero, and close seeds must not begin alike.
        Self((seed ^ 0x9E37_79B9_7F4A_7C15).wrapping_mul(0xD134_2543_DE82_EF95) | 1)
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    /// A number below a limit; 0 if the limit is 0.
    pub fn below(&mut self, limit: usize) -> usize {
        match limit {
            0 => 0,
            limit => (self.bits() >> 11) as usize % limit,
        }
    }

    /// One of a list, which is not empty.
    pub fn choose<'a, T: ?Sized>(&mut self, list: &'a [&'a T]) -> &'a T {
        list[self.below(list.len())]
    }
}

/// The longest input that mutation makes, in bytes.
const LONGEST: usize = 1 << 14;

/// Changes an input in one to eight places.
pub(crate) fn mutate(random: &mut Random, input: &mut Vec<u8>, seeds: &[Vec<u8>], words: &[&str]) {
    for _ in 0..=random.below(8) {
        mutate_once(random, input, seeds, words);
    }
    input.truncate(LONGEST);
}

fn mutate_once(random: &mut Random, input: &mut Vec<u8>, seeds: &[Vec<u8>], words: &[&str]) {
    let [start, end] = range(random, input);
    match random.below(10) {
        // One byte becomes another one.
        0 if start < input.len() => input[start] = random.bits() as u8,
        1 if start < input.len() => input[start] ^= 1 << random.below(8),
        // A range goes, comes twice, or comes elsewhere.
        2 => drop(input.drain(start..end)),
        3 => {
            let copy = input[start..end].to_vec();
            let at = random.below(input.len() + 1);
            input.splice(at..at, copy);
        }
        // A piece of another seed takes the place of a range.
        4 | 5 if !seeds.is_empty() => {
            let other = &seeds[random.below(seeds.len())];
            let [from, to] = range(random, other);
            input.splice(start..end, other[from..to].iter().copied());
        }
        6 if !words.is_empty() => {
            let word = random.choose(words).as_bytes();
            input.splice(start..end, word.iter().copied());
        }
        _ if !words.is_empty() => {
            let word = random.choose(words).as_bytes();
            input.splice(start..start, word.iter().copied());
        }
        _ => input.insert(start, random.bits() as u8),
    }
}

/// A range of an input: short ones are more frequent, and may be empty.
fn range(random: &mut Random, input: &[u8]) -> [usize; 2] {
    let start = random.below(input.len() + 1);
    let longest = [2, 8, 32, 256][random.below(4)];
    [start, (start + random.below(longest)).min(input.len())]
}
