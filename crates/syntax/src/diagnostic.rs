//! Diagnostics: a fault of a text, its location, and its corrections.

use crate::span::Span;

/// The severity of a diagnostic.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub enum Severity {
    /// The text is not valid here.
    Error,
    /// Legal, but probably not what the user means.
    Warning,
    /// Worth knowing.
    Hint,
}

impl Severity {
    /// Returns its name in messages: `error`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Hint => "hint",
        }
    }
}

/// A stable name for one kind of diagnostic, in kebab-case: `unexpected-token`.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct Code(pub &'static str);

/// Another location that explains a diagnostic, such as the body of a function.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Related {
    /// The span.
    pub span: Span,
    /// One sentence, in the user's words.
    pub message: String,
}

/// A change of the text that corrects the fault of a diagnostic, if it is what the user means.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Fix {
    /// The effect, as an imperative: "Write `sin(2x)`".
    pub title: String,
    /// The range that is replaced; empty to insert.
    pub span: Span,
    /// The new text.
    pub replacement: String,
    /// True if an editor may apply it without asking the user to choose.
    pub preferred: bool,
    /// True if an editor may apply it together with all others that have this flag.
    pub all: bool,
}

/// A finding about a text.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Diagnostic {
    /// Its severity.
    pub severity: Severity,
    /// Its kind.
    pub code: Code,
    /// Its span.
    pub span: Span,
    /// One sentence that describes the fault, in the words of the language's users.
    pub message: String,
    /// A correction, if one is known ("did you mean `cos`?").
    pub hint: Option<String>,
    /// Other locations that explain it.
    pub related: Vec<Related>,
    /// Changes of the text that correct it.
    pub fixes: Vec<Fix>,
}

impl Fix {
    /// Creates a fix that replaces a word by another.
    pub(crate) fn change(span: Span, word: &str, preferred: bool) -> Self {
        Self {
            title: format!("Change to `{word}`"),
            span,
            replacement: word.to_owned(),
            preferred,
            all: false,
        }
    }

    /// Creates a fix that removes a sign.
    pub(crate) fn remove(span: Span, sign: &str) -> Self {
        Self {
            title: format!("Remove `{sign}`"),
            ..Self::change(span, "", true)
        }
    }

    /// Returns the fix, marked as one that may be applied together with others.
    #[must_use]
    pub(crate) fn with_all(self) -> Self {
        Self { all: true, ..self }
    }

    /// Creates a fix that rewrites an expression unambiguously.
    pub(crate) fn write(span: Span, text: &str) -> Self {
        Self {
            title: format!("Write `{text}`"),
            span,
            replacement: text.to_owned(),
            preferred: false,
            all: false,
        }
    }

    /// Creates a fix that inserts a text at an offset.
    pub(crate) fn insert(title: &str, offset: u32, text: &str) -> Self {
        Self {
            title: title.to_owned(),
            span: Span::new(offset, offset),
            replacement: text.to_owned(),
            preferred: true,
            all: false,
        }
    }
}

impl Diagnostic {
    /// Creates an error without hint or related locations.
    pub fn error(code: Code, span: Span, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            code,
            span,
            message: message.into(),
            hint: None,
            related: Vec::new(),
            fixes: Vec::new(),
        }
    }

    /// Creates a warning without hint or related locations.
    pub fn warning(code: Code, span: Span, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Warning,
            ..Self::error(code, span, message)
        }
    }

    /// Sorts diagnostics by their start; with equal starts, the widest comes first.
    pub fn sort(diagnostics: &mut [Self]) {
        diagnostics.sort_by_key(|diagnostic| {
            let Span { start, end } = diagnostic.span;
            (start, std::cmp::Reverse(end), diagnostic.severity)
        });
    }

    /// Returns the diagnostic with a hint.
    #[must_use]
    pub fn with_hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// Returns the diagnostic with another fix.
    #[must_use]
    pub fn with_fix(mut self, fix: Fix) -> Self {
        self.fixes.push(fix);
        self
    }

    /// Returns the diagnostic with all its spans mapped.
    #[must_use]
    pub fn mapped(mut self, place: impl Fn(Span) -> Span) -> Self {
        self.span = place(self.span);
        for related in &mut self.related {
            related.span = place(related.span);
        }
        for fix in &mut self.fixes {
            fix.span = place(fix.span);
        }
        self
    }

    /// Returns the diagnostic with all its spans moved by `bytes`.
    #[must_use]
    pub fn moved(self, bytes: u32) -> Self {
        self.mapped(|span| span.moved(bytes))
    }

    /// Returns the diagnostic with another related location.
    #[must_use]
    pub fn with_related(mut self, span: Span, message: impl Into<String>) -> Self {
        self.related.push(Related {
            span,
            message: message.into(),
        });
        self
    }
}
