//! The Geotrace language: from text to tokens, from tokens to calls of semantic hooks.
//!
//! ```text
//! text ──lexer──▶ tokens ──parser──▶ Actions::act_advance     every token, comments too
//!          ▲                    ├──▶ Actions::act_operator    expressions and sets, in postfix order
//!        symbol trie ◀──names───┤──▶ Actions::act_interval
//!                               ├──▶ Actions::act_attribute
//!                               ├──▶ Actions::act_declaration
//!                               └──▶ Actions::act_error       diagnostics, as they are found
//! ```
//!
//! The front-end knows no mathematics: the builtin names are passed in, and implementations of
//! [`Actions`](actions::Actions) give operators their meaning.
//!
//! - [`declarations`]: the one table of declarations; [`attributes`]: the one table of their attributes.
//! - [`token`], [`lexer`]: tokens.
//! - [`grammar`]: the productions as data; [`parser`] follows them and calls the hooks of [`actions`].
//! - [`symbols`]: the meaning of names.
//! - [`codes`]: the codes of the diagnostics.
//! - [`highlight`]: colours, an implementation of the hooks.
//! - [`document`]: a program that is edited.
//!
//! ```
//! use syntax::diagnostic::Diagnostic;
//! use syntax::geotrace::{actions::Actions, parse_program, symbols::Vocabulary};
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
pub mod attributes;
pub mod codes;
mod cut;
pub mod declarations;
pub mod document;
pub mod grammar;
pub mod highlight;
pub mod lexer;
pub mod parser;
mod records;
pub mod symbols;
pub mod token;

pub use parser::{parse_expression, parse_program};
