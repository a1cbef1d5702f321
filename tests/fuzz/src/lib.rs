//! Fuzz targets: functions that take any bytes and panic where something is wrong with what the program makes of them.
//!
//! ```text
//! seeds: examples, language cases, corpus/ ──mutation──▶ bytes ──▶ Target::run ──▶ nothing, or a panic
//! ```
//!
//! An attack does what no bytes do: it runs the program with options, kills it, fills its disk.
//!
//! The tests of this package give each target a fixed number of inputs from a fixed seed, and each attack a few attempts. The
//! program `geotrace-fuzz` gives them any number, and runs one input again. Mutation is our own, because the tests need the
//! same inputs on every run and a stable compiler, which fuzzers that are guided by coverage (libFuzzer, AFL++) do not offer.

mod attacks;
pub mod memory;
mod mutation;
pub mod run;
mod seeds;
mod targets;

pub use attacks::{ATTACKS, Attack};
pub use mutation::Random;
pub use targets::{TARGETS, Target, target};
