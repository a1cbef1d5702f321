//! What an editor shows of a text beyond its mistakes, as plain data on byte offsets.
//!
//! ```text
//! a text, or a document ──reading.rs──▶ Reading ─┬─▶ semantic    colours by meaning
//!                                                ├─▶ hover, signature, completion
//!                                                ├─▶ navigate    definition, occurrences
//!                                                ├─▶ rename, fix, format, write   edits; rename and format read the result again
//!                                                └─▶ outline, hints, lens, live
//! ```
//!
//! No type of the language server protocol: its numbers of lines and columns, and its names, are the server's business.

pub mod completion;
pub mod describe;
pub mod edit;
pub mod fix;
pub mod format;
mod geometry;
pub mod hints;
pub mod hover;
mod item;
pub mod lens;
pub mod live;
mod meaning;
pub mod navigate;
pub mod outline;
pub mod reading;
pub mod rename;
pub mod semantic;
pub mod signature;
mod visible;
pub mod write;

pub use item::Item;
pub use reading::{Lexeme, Reading, Target};
