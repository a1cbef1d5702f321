//! Joining: pieces of WGSL are concatenated, then parsed and validated as a whole before a driver sees them.

use std::fmt;

use naga::valid::{Capabilities, ValidationFlags, Validator};

use crate::library::Piece;

/// WGSL that naga has accepted.
#[derive(Clone, Debug)]
pub struct Joined {
    source: String,
    module: naga::Module,
}

impl Joined {
    /// Returns the whole text, with a marker line before each piece.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// Returns the module parsed by naga.
    pub fn module(&self) -> &naga::Module {
        &self.module
    }

    /// Returns the names of its entry points, in the order of the text.
    pub fn entry_points(&self) -> impl Iterator<Item = &str> {
        self.module
            .entry_points
            .iter()
            .map(|entry| entry.name.as_str())
    }

    /// Returns the name, byte offset and size of each member of a struct, in order; empty if there is no such struct.
    ///
    /// Uniform structs exist twice, in WGSL and in Rust; tests compare the two with this.
    pub fn struct_layout(&self, name: &str) -> Vec<(String, u32, u32)> {
        let Some((_, ty)) = self
            .module
            .types
            .iter()
            .find(|(_, ty)| ty.name.as_deref() == Some(name))
        else {
            return Vec::new();
        };
        let naga::TypeInner::Struct { members, .. } = &ty.inner else {
            return Vec::new();
        };
        members
            .iter()
            .map(|member| {
                let size = self.module.types[member.ty]
                    .inner
                    .size(self.module.to_ctx());
                (member.name.clone().unwrap_or_default(), member.offset, size)
            })
            .collect()
    }

    /// Returns the names of its constants that are numbers, with their values.
    ///
    /// Codes exist twice, in WGSL and in Rust; tests compare the two with this.
    pub fn constants(&self) -> impl Iterator<Item = (&str, f64)> {
        let all = self.module.constants.iter();
        all.filter_map(|(_, constant)| {
            let value = match self.module.global_expressions[constant.init] {
                naga::Expression::Literal(naga::Literal::U32(value)) => f64::from(value),
                naga::Expression::Literal(naga::Literal::F32(value)) => f64::from(value),
                _ => return None,
            };
            Some((constant.name.as_deref()?, value))
        })
    }

    /// Returns the size in bytes of a struct with its padding; 0 if there is no such struct.
    pub fn struct_size(&self, name: &str) -> u32 {
        self.module
            .types
            .iter()
            .find(|(_, ty)| ty.name.as_deref() == Some(name))
            .map_or(0, |(_, ty)| ty.inner.size(self.module.to_ctx()))
    }
}

/// Generated or hand-written WGSL is wrong: a fault of this program, never of its user. The text is kept for
/// inspection.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct InternalError {
    /// The fault, with the piece and the line in it if known.
    pub message: String,
    /// The whole text.
    pub source: String,
}

impl fmt::Display for InternalError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "internal error in generated WGSL: {}", self.message)
    }
}

impl std::error::Error for InternalError {}

/// Concatenates the pieces, each under a line that names its origin; parses and validates the whole.
///
/// # Errors
/// [`InternalError`] with the joined text if naga rejects it.
pub fn join(pieces: &[Piece<'_>]) -> Result<Joined, InternalError> {
    let mut source = String::new();
    for piece in pieces {
        if !source.is_empty() {
            source.push('\n');
        }
        source.push_str(MARKER);
        source.push_str(piece.origin);
        source.push('\n');
        source.push_str(piece.text);
        if !piece.text.ends_with('\n') {
            source.push('\n');
        }
    }
    let module = match naga::front::wgsl::parse_str(&source) {
        Ok(module) => module,
        Err(error) => {
            let line = error.location(&source).map(|at| at.line_number);
            let message = located(&source, line, error.message());
            return Err(InternalError { message, source });
        }
    };
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::MULTISAMPLED_SHADING);
    if let Err(error) = validator.validate(&module) {
        let line = error.location(&source).map(|at| at.line_number);
        let mut sentence = error.to_string();
        let mut cause = std::error::Error::source(error.as_inner());
        while let Some(inner) = cause {
            sentence.push_str(": ");
            sentence.push_str(&inner.to_string());
            cause = inner.source();
        }
        let message = located(&source, line, &sentence);
        return Err(InternalError { message, source });
    }
    Ok(Joined { source, module })
}

/// The start of a marker line.
const MARKER: &str = "// ==== ";

/// Returns the message with the piece, and the line in it, that corresponds to a line of the whole.
fn located(source: &str, line: Option<u32>, message: &str) -> String {
    let Some(line) = line else {
        return message.to_owned();
    };
    let mut origin = "";
    let mut line_in_piece = 0;
    for (index, text) in source.lines().enumerate() {
        if let Some(name) = text.strip_prefix(MARKER) {
            origin = name;
            line_in_piece = 0;
        } else {
            line_in_piece += 1;
        }
        if index + 1 == line as usize {
            return format!("{origin}:{line_in_piece}: {message} (in `{}`)", text.trim());
        }
    }
    message.to_owned()
}
