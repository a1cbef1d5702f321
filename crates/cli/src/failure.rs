//! Failures of commands: sentences for the user and exit statuses.

use std::process::ExitCode;

use geometry::ManifoldError;

use crate::style::{TextColours, escaped};

/// The reason why a command failed.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The program has errors; they have been printed already.
    ProgramHasErrors,
    /// The program or the arguments request a result that does not exist: a camera on a cusp, an image from a file that
    /// is not an image.
    Input {
        /// The problem.
        message: String,
        /// The remedy.
        hint: Option<String>,
    },
    /// The command line is wrong: an unknown name, a value out of range.
    Usage {
        /// The problem.
        message: String,
        /// The remedy.
        hint: Option<String>,
    },
    /// A file cannot be read.
    Unreadable {
        /// The path, as it was given.
        file: String,
        /// A phrase, from the system or this program.
        reason: String,
    },
    /// A file cannot be written. An existing file is unchanged.
    Unwritable {
        /// The path, as it was given.
        file: String,
        /// A phrase, from the system or this program.
        reason: String,
    },
    /// A bug in this program.
    Internal {
        /// A sentence for a bug report.
        message: String,
    },
    /// The reader of standard output has closed it, as `head` does. This is not an error.
    ReaderGone,
    /// The editor has closed the connection without a `shutdown` request: the protocol requires status 1.
    EditorGone,
}

/// The name of standard output in [`Failure::Unwritable`].
pub(crate) const STDOUT: &str = "standard output";

impl Failure {
    /// Returns [`Failure::Usage`] without a hint.
    pub(crate) fn usage(message: impl Into<String>) -> Self {
        Self::Usage {
            message: message.into(),
            hint: None,
        }
    }

    /// Returns the failure of a command that needs a manifold.
    pub(crate) fn no_manifold(error: &ManifoldError) -> Self {
        let message = error.to_string();
        match error {
            ManifoldError::NoSurface { .. } => Self::usage(message),
            ManifoldError::TooLarge { .. }
            | ManifoldError::Flat { .. }
            | ManifoldError::Empty { .. } => Self::Input {
                message,
                hint: None,
            },
        }
    }

    /// Returns the exit status that the command-line contract assigns to the failure.
    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            Self::ReaderGone => ExitCode::SUCCESS,
            Self::ProgramHasErrors
            | Self::Input { .. }
            | Self::Internal { .. }
            | Self::EditorGone => ExitCode::from(1),
            Self::Usage { .. } | Self::Unreadable { .. } | Self::Unwritable { .. } => {
                ExitCode::from(2)
            }
        }
    }

    /// Returns the text for standard error, with its hint; `None` if everything has already been reported.
    pub(crate) fn text(&self, colours: TextColours) -> Option<String> {
        let (message, hint) = match self {
            Self::ProgramHasErrors | Self::ReaderGone | Self::EditorGone => return None,
            Self::Input { message, hint } | Self::Usage { message, hint } => {
                (message.clone(), hint.clone())
            }
            Self::Unreadable { file, reason } => {
                (format!("cannot read `{}`: {reason}", escaped(file)), None)
            }
            Self::Unwritable { file, reason } if file == STDOUT => {
                (format!("cannot write to {file}: {reason}"), None)
            }
            Self::Unwritable { file, reason } => {
                (format!("cannot write `{}`: {reason}", escaped(file)), None)
            }
            Self::Internal { message } => (
                message.clone(),
                Some("this is a bug in geotrace, not in your program: please report it".into()),
            ),
        };
        let internal = if matches!(self, Self::Internal { .. }) {
            "internal error"
        } else {
            "error"
        };
        let mut text = format!("{}: {message}\n", colours.error(internal));
        if let Some(hint) = hint {
            text.push_str(&format!("  {}: {hint}\n", colours.help("help")));
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
            failure.text(TextColours::plain()).as_deref(),
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
            failure.text(TextColours::plain()).as_deref(),
            Some("error: there is no surface `g`\n  help: did you mean `f`?\n")
        );
    }
}
