//! The CRT scene language: from text to tokens, from tokens to calls of semantic hooks, and to the syntax tree of a
//! script.
//!
//! ```text
//! text ──lexer──▶ tokens ──parser──▶ Actions::act_advance     every token, comments too
//!                               ├──▶ Actions::act_step        statements and expressions, in postfix order
//!                               └──▶ Actions::act_error       diagnostics, as they are found
//! ```
//!
//! An interpreter runs a script from its [`tree`](tree::Script). This module reports all errors that can be found without
//! running it: syntax errors, unknown, missing or duplicate attributes, unknown objects, a second block of a kind,
//! statements after the scene.
//!
//! - [`objects`]: the one table of objects and their attributes.
//! - [`token`], [`lexer`]: tokens.
//! - [`grammar`]: the productions as data; [`parser`] follows them and calls the hooks of [`actions`].
//! - [`tree`]: the syntax tree; `builder` makes it, an implementation of the hooks.
//! - [`codes`]: the codes of the diagnostics.
//! - [`highlight`]: colours, an implementation of the hooks.
//! - `order`: misplaced blocks.
//! - [`document`]: a script that is edited; `cut` finds the ends of its pieces.

pub mod actions;
mod builder;
pub mod codes;
mod cut;
pub mod document;
pub mod grammar;
pub mod highlight;
pub mod lexer;
pub mod objects;
mod order;
pub mod parser;
pub mod token;
pub mod tree;

pub use parser::{parse_expression, parse_script};
