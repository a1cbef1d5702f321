//! Descriptions of names, for hovers and completions.

/// The description of a name for a reader: `code` in the language, `text` in Markdown.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Description {
    /// The language of `code`, as [`Language::name`](crate::Language::name) gives it.
    pub language: &'static str,
    /// One line of code: `surface s(u, v)`.
    pub code: String,
    /// Paragraphs of Markdown.
    pub text: Vec<String>,
}

impl Description {
    /// The description in Markdown.
    pub fn markdown(&self) -> String {
        let mut all = vec![format!("```{}\n{}\n```", self.language, self.code)];
        all.extend(self.text.iter().cloned());
        all.join("\n\n")
    }

    /// The description as plain text.
    pub fn plain(&self) -> String {
        let mut all = vec![self.code.clone()];
        all.extend(self.text.iter().map(|text| text.replace(['`', '*'], "")));
        all.join("\n\n")
    }
}
