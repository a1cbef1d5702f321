//! The front-end: from text to tokens, from tokens to calls of semantic hooks.
//!
//! ```text
//! text ──lexer──▶ tokens ──parser──▶ Actions::act_advance     every token, comments too
//!          ▲                    ├──▶ Actions::act_operator    expressions, in postfix order
//!        symbol trie ◀──names───┤──▶ Actions::act_interval
//!                               ├──▶ Actions::act_declaration
//!                               └──▶ Actions::act_error       diagnostics, as they are found
//! ```
//!
//! This crate knows no mathematics: the names that a language starts with are handed in, and what an
//! operator means is the business of whoever implements [`Actions`].

pub mod actions;
pub mod diagnostic;
pub mod span;
pub mod token;
