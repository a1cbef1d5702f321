//! Descriptions of names, for hovers and completions.

/// The description of a name for a reader: `code` in the language, `text` in Markdown.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Description {
    /// The language of `code`, as returned by [`Language::name`](crate::Language::name).
    pub language: &'static str,
    /// One line of code: `surface s(u, v)`.
    pub code: String,
    /// Paragraphs of Markdown.
    pub text: Vec<String>,
}

impl Description {
    /// Returns the description in Markdown.
    pub fn markdown(&self) -> String {
        let mut all = vec![format!("```{}\n{}\n```", self.language, self.code)];
        all.extend(self.text.iter().cloned());
        all.join("\n\n")
    }

    /// Returns the description as plain text.
    pub fn plain(&self) -> String {
        let mut all = vec![self.code.clone()];
        all.extend(self.text.iter().map(|text| without_marks(text)));
        all.join("\n\n")
    }
}

/// Returns the text of Markdown without its markup. Between backquotes is code, in which `*` is an ordinary character.
fn without_marks(text: &str) -> String {
    let parts = text.split('`').zip([false, true].into_iter().cycle());
    let plain = parts.map(|(part, is_code)| match is_code {
        true => part.to_owned(),
        false => part.replace('*', ""),
    });
    plain.collect()
}

#[cfg(test)]
mod tests {
    use super::Description;

    #[test]
    fn plain_text_keeps_the_signs_of_code() {
        let description = Description {
            language: "geotrace",
            code: "h(x, y)".to_owned(),
            text: vec!["**value**: `h(2*3, *4) = 96` *exactly*, see `2*3`".to_owned()],
        };
        assert_eq!(
            description.plain(),
            "h(x, y)\n\nvalue: h(2*3, *4) = 96 exactly, see 2*3"
        );
    }
}
