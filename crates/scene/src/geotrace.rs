//! The Geotrace language: from declarations to a [`Scene`](crate::Scene), with all errors.
//!
//! ```text
//! text ──syntax──▶ hooks ──▶ declarations.rs    the state between two declarations
//!                              declare.rs, params.rs, intrinsic.rs, space_geodesics.rs, solids.rs, stage.rs   declarations
//!                              interval.rs, attributes.rs   the numbers between `[` and `]`, and the values of attributes
//!                              lower.rs ──▶ apply.rs ──▶ lowerer.rs   from steps to values over one graph
//!                              sets.rs, affine.rs   sets of points as values, and their maps
//!                              geodesics.rs, geodesic_equation.rs   points of geodesics as values over that graph
//!                              code.rs, operation.rs, symbol.rs, builtin.rs, foreign.rs, dependencies.rs, error.rs
//!
//! compile.rs    a text, from scratch            ─┐
//! document.rs   a text that is edited           ─┴─▶ Compilation: a scene and diagnostics
//! assembler.rs  combines declarations that have been read, without reading them again
//! excerpt.rs    some declarations of a text, with their dependencies
//! evaluate.rs   a lone expression in a program's scope
//! ```

mod affine;
mod apply;
mod assembler;
mod attributes;
mod builtin;
mod code;
mod compile;
mod declarations;
mod declare;
mod dependencies;
mod document;
mod error;
mod evaluate;
mod excerpt;
mod foreign;
mod geodesic_equation;
mod geodesics;
mod interval;
mod intrinsic;
mod lower;
mod lowerer;
mod operation;
mod params;
mod sets;
mod solids;
mod space_geodesics;
mod stage;
mod symbol;

pub use builtin::{count as builtin_count, vocabulary};
pub use compile::{Compilation, compile};
pub use document::{Counters, Document};
pub use error::CODES;
pub use excerpt::Excerpt;
