//! Why a command ends without its result, and the exit status that says so.

use std::process::ExitCode;

use crate::style::Palette;

/// Why a command failed. [`Failure::text`] says it in the user's words.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The program has errors; they have been printed already.
    Program,
    /// Something that the program or the arguments ask for has no answer: a camera on a cusp, an image file
    /// that holds no image.
    Input {
        /// What is wrong.
        message: String,
        /// What to do about it.
        hint: Option<String>,
    },
    /// The command line asks for what does not exist: an unknown name, a value out of range.
    Usage {
        /// What is wrong.
        message: String,
        /// What to do about it.
        hint: Option<String>,
    },
    /// A file cannot be read.
    Unreadable {
        /// As it was given.
        file: String,
        /// In the system's words, or ours.
        reason: String,
    },
    /// A file cannot be written. What stood there before still stands.
    Unwritable {
        /// As it was given.
        file: String,
        /// In the system's words, or ours.
        reason: String,
    },
    /// Our own mistake.
    Internal {
        /// What happened, for a report.
        message: String,
    },
    /// Whoever read our standard output has stopped reading, as `head` does. Not an error.
    ReaderGone,
    /// The editor that a language server served has left without saying `shutdown`: the protocol wants status 1.
    EditorGone,
}

/// What [`Failure::Unwritable`] calls the standard output.
pub(crate) const STDOUT: &str = "standard output";

impl Failure {
    /// Wrong usage, without a hint.
    pub(crate) fn usage(message: impl Into<String>) -> Self {
        Self::Usage {
            message: message.into(),
            hint: None,
        }
    }

    /// The exit status of the command-line contract.
    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            Self::ReaderGone => ExitCode::SUCCESS,
            Self::Program | Self::Input { .. } | Self::Internal { .. } | Self::EditorGone => {
                ExitCode::from(1)
            }
            Self::Usage { .. } | Self::Unreadable { .. } | Self::Unwritable { .. } => {
                ExitCode::from(2)
            }
        }
    }

    /// The sentence for standard error, with its hint; `None` where nothing is left to be said.
    pub(crate) fn text(&self, palette: Palette) -> Option<String> {
        let (message, hint) = match self {
            Self::Program | Self::ReaderGone | Self::EditorGone => return None,
            Self::Input { message, hint } | Self::Usage { message, hint } => {
                (message.clone(), hint.clone())
            }
            Self::Unreadable { file, reason } => (format!("cannot read `{file}`: {reason}"), None),
            Self::Unwritable { file, reason } if file == STDOUT => {
                (format!("cannot write to {file}: {reason}"), None)
            }
            Self::Unwritable { file, reason } => (format!("cannot write `{file}`: {reason}"), None),
            Self::Internal { message } => (
                message.clone(),
                Some("this is a mistake in geotrace, not in your program: please report it".into()),
            ),
        };
        let internal = if matches!(self, Self::Internal { .. }) {
            "internal error"
        } else {
            "error"
        };
        let mut text = format!("{}: {message}\n", palette.error(internal));
        if let Some(hint) = hint {
            text.push_str(&format!("  {}: {hint}\n", palette.help("help")));
        }
        Some(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unreadable_file_is_named_with_the_reason() {
        let failure = Failure::Unreadable {
            file: "a.gtr".into(),
            reason: "it is a directory".into(),
        };
        assert_eq!(
            failure.text(Palette::plain()).as_deref(),
            Some("error: cannot read `a.gtr`: it is a directory\n")
        );
    }

    #[test]
    fn a_hint_stands_on_its_own_line() {
        let failure = Failure::Usage {
            message: "there is no surface `g`".into(),
            hint: Some("did you mean `f`?".into()),
        };
        assert_eq!(
            failure.text(Palette::plain()).as_deref(),
            Some("error: there is no surface `g`\n  help: did you mean `f`?\n")
        );
    }
}
