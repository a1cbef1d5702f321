//! The CRT scene language: from text to tokens, from tokens to calls of semantic hooks, and to the tree of a script.
//!
//! ```text
//! text ──lexer──▶ tokens ──parser──▶ Actions::act_advance     every token, comments too
//!                               ├──▶ Actions::act_step        statements and expressions, in postfix order
//!                               └──▶ Actions::act_error       diagnostics, as they are found
//! ```
//!
//! A script is run by an interpreter, which reads its [`tree`](tree::Script). This module reports all that can be found
//! without running it: what does not follow the grammar, objects and attributes that are unknown, missing or stated twice, a
//! second block, a statement after the scene.
//!
//! - [`objects`]: the one table of objects and their attributes.
//! - [`token`], [`lexer`]: tokens.
//! - [`grammar`]: the productions as data; [`parser`] follows them and calls the hooks of [`actions`].
//! - [`tree`]: what a script says; `builder` makes it, an implementation of the hooks.
//! - [`codes`]: the codes of the diagnostics.
//! - [`highlight`]: colours, an implementation of the hooks.
//! - `order`: blocks that stand where they may not.
//! - [`document`]: a script that is edited; `cut` finds its pieces.

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
