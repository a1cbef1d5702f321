//! Expressions to WGSL functions, joined with the hand-written passes of `/shaders` and validated.
//!
//! ```text
//! expr::Graph + roots ──emit.rs──▶ functions as text ──contract.rs: names and signatures compared──┐
//! /shaders (library.rs) ──────────────────────────────────────────────────────────────────────────┴▶ join.rs
//!                                                          one text, validated by naga ──▶ kernel.rs: a Kernel
//! ```
//!
//! Generated text contains functions only; entry points and bindings are hand-written in `shaders/pass`. Joining is
//! concatenation, without templates. A mistake in any text is an [`InternalError`] that contains it, never a panic.

pub mod contract;
mod emit;
pub mod join;
pub mod kernel;
pub mod library;
pub mod painter;
mod ranges;
pub mod traced;

pub use join::{InternalError, Joined};
pub use kernel::{GenerateError, Kernel};
