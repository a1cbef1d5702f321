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
//! operator means is the business of whoever implements [`Actions`](actions::Actions). Only [`parser`] and
//! [`grammar`] know *this* grammar; a second one can stand beside them over the same lexer, trie and
//! diagnostics.
//!
//! ```
//! use syntax::{actions::Actions, diagnostic::Diagnostic, parse_program, symbols::Vocabulary};
//!
//! #[derive(Default)]
//! struct Errors(Vec<Diagnostic>);
//! impl Actions for Errors {
//!     fn act_error(&mut self, diagnostic: Diagnostic) {
//!         self.0.push(diagnostic);
//!     }
//! }
//!
//! let vocabulary = Vocabulary::new(&["pi", "e"], &["sin", "cos"]);
//! let mut errors = Errors::default();
//! let parsed = parse_program("define a = cos 2 + foo;", &vocabulary, &mut errors);
//! assert_eq!(errors.0[0].message, "`foo` is not defined");
//! assert!(parsed.trie.get("a").is_some());
//! ```

pub mod actions;
pub mod codes;
pub mod diagnostic;
pub mod document;
pub mod grammar;
pub mod highlight;
pub mod lexer;
pub mod line_index;
pub mod parser;
pub mod span;
pub mod symbols;
pub mod text;
pub mod token;
pub mod trie;

pub use parser::suggestions::nearest;
pub use parser::{parse_expression, parse_program};
