//! Editor features beyond diagnostics, as plain data on byte offsets, whatever the program's language.
//!
//! ```text
//! languages     the languages by file extension and name
//! language      the interface of a language: Language, Program, Analysis
//! geotrace, crt the languages
//! text          access to a text by its lines
//! limited       files that are read up to a limit
//! colour, completion, description, edit, fix, hint, lens, link, occurrence, outline, rename, semantic, signature, …
//!               the results of the features
//! ```
//!
//! The crate does not use the types of the language server protocol: the server converts lines, columns and names.

pub mod colour;
pub mod completion;
pub mod conversion;
pub mod crt;
pub mod description;
pub mod edit;
pub mod edit_camera;
pub mod edit_param;
pub mod fix;
pub mod geotrace;
pub mod highlight;
pub mod hint;
pub mod language;
mod languages;
pub mod lens;
pub mod limited;
pub mod link;
pub mod occurrence;
pub mod outline;
pub mod overview;
pub mod rename;
pub mod semantic;
pub mod signature;
pub mod text;

pub use language::{Analysis, Language, Program};
pub use languages::Languages;
