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
    /// The inputs at which the target panicked.
    pub failures: Vec<Vec<u8>>,
    /// The longest time for an input.
    pub slowest: Duration,
    /// The input that took it.
    pub slowest_input: Vec<u8>,
}

/// Gives a target its corpus, its seeds as they are, and then `count` mutated inputs of a sequence. It goes on behind a panic,
/// up to ten of them.
pub fn run(target: &Target, seed: u64, count: u64) -> Report {
    let mut report = Report::default();
    let seeds = (target.seeds)();
    let corpus = seeds::corpus(target.name);
    for input in corpus.iter().chain(&seeds) {
        one(target, input, &mut report);
    }
    let mut random = Random::new(seed);
    for _ in 0..count {
        if report.failures.len() >= 10 {
            break;
        }
        let mut input = match seeds.len() {
            0 => Vec::new(),
            seeds_count => seeds[random.below(seeds_count)].clone(),
        };
        mutate(&mut random, &mut input, &seeds, target.words);
        one(target, &input, &mut report);
    }
    report
}

fn one(target: &Target, input: &[u8], report: &mut Report) {
    let start = Instant::now();
    let ended = catch_unwind(AssertUnwindSafe(|| (target.run)(input)));
    let took = start.elapsed();
    report.inputs += 1;
    if ended.is_err() {
        report.failures.push(input.to_vec());
    }
    if took > report.slowest {
        report.slowest = took;
        report.slowest_input = input.to_vec();
    }
}
