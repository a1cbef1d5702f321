//! The errors of renaming.

/// The reason why a name cannot be changed; its [`std::fmt::Display`] is a sentence.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum RenameError {
    /// There is no name at the offset.
    NoName,
    /// The name is builtin.
    Builtin(String),
    /// The new name is not valid.
    NotAName {
        /// The name.
        name: String,
        /// The rule for names.
        rule: &'static str,
    },
    /// The new name is a keyword of declarations.
    Keyword(String),
    /// The new name is already defined; `line` (from 1) is where, unless it is builtin.
    Taken {
        /// The name.
        name: String,
        /// The line of its declaration.
        line: Option<u32>,
    },
    /// A word would be read differently, even with inserted blanks.
    ReadOtherwise {
        /// The word as written now.
        word: String,
        /// The number of the line, from 1.
        line: u32,
    },
}

impl std::fmt::Display for RenameError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoName => f.write_str("there is no name here"),
            Self::Builtin(name) => write!(f, "`{name}` is builtin and cannot be renamed"),
            Self::NotAName { name, rule } => write!(f, "`{name}` is not a name: {rule}"),
            Self::Keyword(name) => {
                write!(f, "`{name}` is a keyword: it cannot be a name")
            }
            Self::Taken { name, line: None } => write!(f, "`{name}` is the name of a builtin"),
            Self::Taken {
                name,
                line: Some(line),
            } => write!(f, "`{name}` is already declared in line {line}"),
            Self::ReadOtherwise { word, line } => {
                write!(
                    f,
                    "with this name, `{word}` in line {line} would be read differently"
                )
            }
        }
    }
}

impl std::error::Error for RenameError {}
