//! What is wrong with a program, where, and what to do about it.

use crate::span::Span;

/// How grave a diagnostic is.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub enum Severity {
    /// The program has no meaning here.
    Error,
    /// Legal, but it probably does not mean what was meant.
    Warning,
    /// Worth knowing.
    Hint,
}

/// A stable name for one kind of diagnostic, in kebab-case: `unexpected-token`.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct Code(pub &'static str);

/// Another place that explains a diagnostic, such as the body of a function.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Related {
    /// Where.
    pub span: Span,
    /// One sentence, in the user's words.
    pub message: String,
}

/// A change of the text that mends what a diagnostic is about, if it is what was meant.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Fix {
    /// What it does, as an order: "Write `sin(2x)`".
    pub title: String,
    /// What is replaced; empty to insert.
    pub span: Span,
    /// What takes its place.
    pub replacement: String,
    /// Whether it is the one to take without a thought.
    pub preferred: bool,
}

/// One finding in a program.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Diagnostic {
    /// How grave it is.
    pub severity: Severity,
    /// What kind it is.
    pub code: Code,
    /// Where it is.
    pub span: Span,
    /// One sentence that says what is wrong, in the user's words.
    pub message: String,
    /// What to do about it, where that is known ("did you mean `cos`?").
    pub hint: Option<String>,
    /// Other places that explain it.
    pub related: Vec<Related>,
    /// Changes of the text that mend it.
    pub fixes: Vec<Fix>,
}

impl Fix {
    /// The fix that puts a word in the place of another.
    pub(crate) fn change(span: Span, word: &str, preferred: bool) -> Self {
        Self {
            title: format!("Change to `{word}`"),
            span,
            replacement: word.to_owned(),
            preferred,
        }
    }

    /// The fix that writes something in the place of what was read otherwise.
    pub(crate) fn write(span: Span, text: &str) -> Self {
        Self {
            title: format!("Write `{text}`"),
            span,
            replacement: text.to_owned(),
            preferred: false,
        }
    }

    /// The fix that puts something at an offset.
    pub(crate) fn insert(title: &str, offset: u32, text: &str) -> Self {
        Self {
            title: title.to_owned(),
            span: Span::new(offset, offset),
            replacement: text.to_owned(),
            preferred: true,
        }
    }
}

impl Diagnostic {
    /// An error without hint or related places.
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

    /// A warning without hint or related places.
    pub fn warning(code: Code, span: Span, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Warning,
            ..Self::error(code, span, message)
        }
    }

    /// Sorts by place; what starts at one place, the widest first.
    pub fn sort(diagnostics: &mut [Self]) {
        diagnostics.sort_by_key(|diagnostic| {
            let Span { start, end } = diagnostic.span;
            (start, std::cmp::Reverse(end), diagnostic.severity)
        });
    }

    /// The same, with a hint.
    #[must_use]
    pub fn with_hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// The same, with one more change that mends it.
    #[must_use]
    pub fn with_fix(mut self, fix: Fix) -> Self {
        self.fixes.push(fix);
        self
    }

    /// The same, with all its places put elsewhere.
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

    /// Returns the diagnostic with all its places `bytes` further down.
    #[must_use]
    pub fn moved(self, bytes: u32) -> Self {
        self.mapped(|span| span.moved(bytes))
    }

    /// The same, with one more related place.
    #[must_use]
    pub fn with_related(mut self, span: Span, message: impl Into<String>) -> Self {
        self.related.push(Related {
            span,
            message: message.into(),
        });
        self
    }
}
