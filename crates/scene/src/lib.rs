//! From declarations to a [`Scene`]: what is drawn, what it depends on, and every mistake on the way.
//!
//! ```text
//! text ──syntax──▶ hooks ──▶ compile.rs ──▶ Scene (data)  +  diagnostics
//!                               │
//!                               ▼
//! names and numbers ──▶ values.rs (Settings) ──▶ uniforms of each instance
//! an expression     ──▶ evaluate.rs          ──▶ its value
//! ```
//!
//! A scene is data: expressions in one graph, and handles into it. It knows no view and no GPU.

mod apply;
mod builtin;
mod code;
pub mod compile;
mod declare;
pub mod document;
pub mod evaluate;
mod fault;
pub mod geodesic;
mod interval;
mod intrinsic;
pub mod limits;
mod lower;
mod metric;
mod params;
mod reads;
pub mod scene;
mod symbol;
pub mod values;

pub use builtin::{count as builtin_count, vocabulary};
pub use compile::{Compilation, compile};
pub use document::Document;
pub use evaluate::{Evaluation, Instance, Outcome, Value};
pub use fault::CODES;
pub use scene::Scene;
pub use values::Settings;
