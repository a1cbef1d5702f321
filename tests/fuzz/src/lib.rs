//! Fuzz targets: functions that take any bytes and panic where something is wrong with what the program makes of them.
//!
//! ```text
//! seeds: examples, language cases, corpus/ ──mutation──▶ bytes ──▶ Target::run ──▶ nothing, or a panic
//!                                    libfuzzer/ ───────────▲
//! ```
//!
//! The tests of this package give each target a fixed number of inputs from a fixed seed. The program `fuzz` gives it any
//! number, and runs one input again. `libfuzzer/` has the same targets for `cargo fuzz`, which finds its way by coverage.

mod mutation;
pub mod run;
mod seeds;
mod targets;

pub use mutation::Random;
pub use targets::{TARGETS, Target, target};
