//! The front-end: from text to syntax, and again after each edit.
//!
//! The crate root is a kernel that knows no grammar:
//!
//! - [`span`], [`text`], [`line_index`]: ranges and positions in a text.
//! - [`diagnostic`], [`codes`]: the faults of a text.
//! - [`symbol`], [`trie`], [`spelling`]: names.
//! - [`highlight`]: the kinds of coloured pieces.
//! - [`productions`]: grammars as data.
//! - [`document`]: a text that is edited, and read piece by piece.
//! - [`attribute_range`]: the numbers that an attribute can have.
//!
//! Each language is a module beside the kernel: [`geotrace`], [`crt`].

pub mod attribute_range;
mod checkpoints;
pub mod codes;
pub mod crt;
pub mod diagnostic;
pub mod document;
pub mod geotrace;
pub mod highlight;
pub mod line_index;
mod persistent_vector;
pub mod productions;
pub mod span;
pub mod spelling;
pub mod symbol;
pub mod text;
pub mod trie;
