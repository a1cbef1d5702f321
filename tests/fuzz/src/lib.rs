//! Fuzz targets: functions that take any bytes and panic where something is wrong with what the program makes of them.
//!
//! ```text
//! seeds: examples, language cases, corpus/ ──mutation──▶ bytes ──▶ Target::run ──▶ nothing, or a panic
//! ```
//!
//! The tests of this package give each target a fixed number of inputs from a fixed seed. The program `geotrace-fuzz` gives
//! it any number, and runs one input again. Mutation is our own, because the tests need the same inputs on every run and a
//! stable compiler, which fuzzers that are guided by coverage (libFuzzer, AFL++) do not offer.

mod mutation;
pub mod run;
mod seeds;
mod targets;

pub use mutation::Random;
pub use targets::{TARGETS, Target, target};
