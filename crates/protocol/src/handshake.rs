//! The first message of each side, and the error if the two do not understand each other.

use std::fmt;

use crate::{Command, Event, Hello, VERSION};

/// A side of the conversation.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Side {
    /// The language server.
    Server,
    /// The preview window.
    Window,
}

/// A message that may be the first.
pub trait Greeting {
    /// The side that sends it.
    const SIDE: Side;

    /// Returns the greeting, if the message is one.
    fn hello(&self) -> Option<&Hello>;
}

/// The reason why a conversation cannot continue. Its text is a sentence for the user.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum HandshakeError {
    /// The first message is not [`Hello`].
    NoHello {
        /// The side that sent it.
        from: Side,
    },
    /// The other side speaks another version.
    OtherVersion {
        /// The side.
        from: Side,
        /// Its message.
        theirs: Hello,
    },
}

impl Hello {
    /// Returns this program's greeting.
    #[must_use]
    pub fn own() -> Self {
        Self {
            protocol: VERSION,
            program: env!("CARGO_PKG_VERSION").to_owned(),
        }
    }
}

/// Checks the first message that the other side sent.
///
/// # Errors
/// See [`HandshakeError`].
pub fn check<T: Greeting>(first: &T) -> Result<(), HandshakeError> {
    match first.hello() {
        Some(theirs) if theirs.protocol == VERSION => Ok(()),
        Some(theirs) => Err(HandshakeError::OtherVersion {
            from: T::SIDE,
            theirs: theirs.clone(),
        }),
        None => Err(HandshakeError::NoHello { from: T::SIDE }),
    }
}

impl Greeting for Command {
    const SIDE: Side = Side::Server;

    fn hello(&self) -> Option<&Hello> {
        match self {
            Self::Hello(hello) => Some(hello),
            _ => None,
        }
    }
}

impl Greeting for Event {
    const SIDE: Side = Side::Window;

    fn hello(&self) -> Option<&Hello> {
        match self {
            Self::Hello(hello) => Some(hello),
            _ => None,
        }
    }
}

impl Side {
    fn name(self) -> &'static str {
        match self {
            Self::Server => "language server",
            Self::Window => "preview window",
        }
    }

    fn other(self) -> Self {
        match self {
            Self::Server => Self::Window,
            Self::Window => Self::Server,
        }
    }
}

impl fmt::Display for HandshakeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoHello { from } => write!(
                f,
                "The {} did not send its version first: it is not a {} of geotrace.",
                from.name(),
                from.name()
            ),
            Self::OtherVersion { from, theirs } => write!(
                f,
                "The {} (geotrace {}) speaks version {} of the preview's messages, the {} (geotrace {}) speaks version \
                 {VERSION}. Restart the language server, so that both come from one installation.",
                from.name(),
                theirs.program,
                theirs.protocol,
                from.other().name(),
                env!("CARGO_PKG_VERSION"),
            ),
        }
    }
}

impl std::error::Error for HandshakeError {}

#[cfg(test)]
mod tests {
    use super::{HandshakeError, Side, check};
    use crate::{Command, Event, Hello, VERSION};

    #[test]
    fn another_version_is_refused_with_a_sentence_that_names_both() {
        let theirs = Hello {
            protocol: VERSION + 7,
            program: "9.9.9".to_owned(),
        };
        let error = check(&Event::Hello(theirs.clone())).expect_err("another version");
        let message = error.to_string();
        for part in [
            "preview window (geotrace 9.9.9)",
            &format!("speaks version {}", VERSION + 7),
            &format!(
                "the language server (geotrace {})",
                env!("CARGO_PKG_VERSION")
            ),
            &format!("speaks version {VERSION}"),
        ] {
            assert!(message.contains(part), "{part:?} in {message}");
        }
        let message = check(&Command::Hello(theirs)).expect_err("another version");
        assert!(
            message
                .to_string()
                .starts_with("The language server (geotrace 9.9.9)")
        );
    }

    #[test]
    fn the_own_version_is_accepted_whatever_the_program_calls_itself() {
        assert_eq!(check(&Command::Hello(Hello::own())), Ok(()));
        let theirs = Hello {
            protocol: VERSION,
            program: "some other".to_owned(),
        };
        assert_eq!(check(&Event::Hello(theirs)), Ok(()));
    }

    #[test]
    fn whoever_begins_with_something_else_is_refused() {
        let refused = check(&Event::Closed);
        assert_eq!(refused, Err(HandshakeError::NoHello { from: Side::Window }));
        assert!(check(&Command::Close).is_err());
    }
}
