//! Runs of a target over many inputs.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use crate::mutation::{Random, mutate};
use crate::{Target, seeds};

/// The outcome of a run.
#[derive(Debug, Default)]
pub struct Report {
    /// The number of inputs.
    pub inputs: u64,
    /// The inputs at which something was wrong.
    pub failures: Vec<Vec<u8>>,
    /// The longest time for an input.
    pub slowest: Duration,
    /// The input that took it.
    pub slowest_input: Vec<u8>,
    /// The largest resident memory of a process that was started, in bytes; 0 if none was.
    pub peak: u64,
}

impl Report {
    /// Tries an input: `act` panics where something is wrong, and returns the largest resident memory of the processes that
    /// it has started.
    pub(crate) fn attempt(&mut self, input: &[u8], act: impl FnOnce() -> u64) {
        let start = Instant::now();
        let ended = catch_unwind(AssertUnwindSafe(act));
        let took = start.elapsed();
        self.inputs += 1;
        match ended {
            Ok(peak) => self.peak = self.peak.max(peak),
            Err(_) => self.failures.push(input.to_vec()),
        }
        if took > self.slowest {
            self.slowest = took;
            self.slowest_input = input.to_vec();
        }
    }

    /// Adds the outcome of another run.
    pub fn add(&mut self, other: Self) {
        self.inputs += other.inputs;
        self.failures.extend(other.failures);
        self.peak = self.peak.max(other.peak);
        if other.slowest > self.slowest {
            self.slowest = other.slowest;
            self.slowest_input = other.slowest_input;
        }
    }

    /// Returns true once so many inputs have failed that more of them would say nothing new.
    pub fn is_hopeless(&self) -> bool {
        self.failures.len() >= 10
    }
}

/// Gives a target its corpus, its seeds as they are, and then `count` mutated inputs of a sequence. It goes on behind a panic,
/// up to ten of them.
pub fn run(target: &Target, seed: u64, count: u64) -> Report {
    let mut report = Report::default();
    let seeds = (target.seeds)();
    let corpus = seeds::corpus(target.name);
    let one = |input: &[u8]| {
        (target.run)(input);
        0
    };
    for input in corpus.iter().chain(&seeds) {
        report.attempt(input, || one(input));
    }
    let mut random = Random::new(seed);
    for _ in 0..count {
        if report.is_hopeless() {
            break;
        }
        let mut input = match seeds.len() {
            0 => Vec::new(),
            seeds_count => seeds[random.below(seeds_count)].clone(),
        };
        mutate(&mut random, &mut input, &seeds, target.words);
        report.attempt(&input, || one(&input));
    }
    report
}
