//! The text of the window's own pane, and its file.

use std::path::PathBuf;

use syntax::span::Span;

use crate::memory::write_whole;

/// A text that is edited here.
#[derive(Debug)]
pub(crate) struct Editor {
    pub(crate) path: PathBuf,
    pub(crate) text: String,
    /// Counts the texts that were compiled.
    pub(crate) version: i32,
    /// What the file holds, as far as is known.
    saved: String,
    /// The file's new text, where it has changed while this one had too.
    pub(crate) conflict: Option<String>,
    /// A place that the cursor is to be put to.
    pub(crate) jump: Option<Span>,
    /// The text has been changed by other means than typing.
    pub(crate) replaced: bool,
}

impl Editor {
    /// A file's text.
    pub(crate) fn new(path: PathBuf, text: String) -> Self {
        Self {
            path,
            saved: text.clone(),
            text,
            version: 0,
            conflict: None,
            jump: None,
            replaced: false,
        }
    }

    /// Whether the text differs from the file's.
    pub(crate) fn is_changed(&self) -> bool {
        self.text != self.saved
    }

    /// The file holds another text: taken over, unless something was written here that would be lost. Whether the
    /// text is another one now.
    pub(crate) fn take_changed(&mut self, text: String) -> bool {
        if text == self.text || text == self.saved {
            self.saved = text;
            self.conflict = None;
            return false;
        }
        if self.is_changed() {
            self.conflict = Some(text);
            return false;
        }
        self.text.clone_from(&text);
        self.saved = text;
        self.replaced = true;
        true
    }

    /// Ends a conflict: with the file's text, or with the own one, which then differs from the file's. Whether the
    /// text is another one now.
    pub(crate) fn settle(&mut self, take_file: bool) -> bool {
        let Some(text) = self.conflict.take() else {
            return false;
        };
        if take_file {
            self.text.clone_from(&text);
            self.replaced = true;
        }
        self.saved = text;
        take_file
    }

    /// Writes the text to the file.
    ///
    /// # Errors
    /// A sentence; the file is as it was.
    pub(crate) fn save(&mut self) -> Result<(), String> {
        if self.conflict.is_some() {
            return Err("the file has changed on disk: choose which text to keep first".to_owned());
        }
        write_whole(&self.path, self.text.as_bytes())
            .map_err(|error| format!("cannot write `{}`: {error}", self.path.display()))?;
        self.saved.clone_from(&self.text);
        Ok(())
    }

    /// Writes a param's value into the text; whether the text is another one now.
    ///
    /// # Errors
    /// A sentence; the text is as it was.
    pub(crate) fn write_param(&mut self, name: &str, value: &[f64]) -> Result<bool, String> {
        let reading = ide::Reading::new(self.text.as_str());
        let edit =
            ide::write::value(&reading, name, value).map_err(|refusal| refusal.to_string())?;
        let text = ide::edit::apply(&self.text, &[edit]);
        let changed = text != self.text;
        self.text = text;
        self.replaced |= changed;
        Ok(changed)
    }
}

#[cfg(test)]
mod tests {
    use super::Editor;

    fn editor() -> (tempfile::TempDir, Editor) {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.gtr");
        std::fs::write(&path, "one").expect("written");
        (folder, Editor::new(path, "one".into()))
    }

    #[test]
    fn a_file_that_changes_is_followed_unless_something_would_be_lost() {
        let (_folder, mut editor) = editor();
        assert!(editor.take_changed("two".into()));
        assert_eq!(editor.text, "two");
        editor.text = "mine".into();
        assert!(!editor.take_changed("three".into()));
        assert_eq!(
            (editor.text.as_str(), editor.conflict.as_deref()),
            ("mine", Some("three"))
        );
        assert!(editor.save().is_err(), "not over what has not been seen");
        assert!(!editor.settle(false));
        assert!(editor.is_changed() && editor.save().is_ok() && !editor.is_changed());
    }

    #[test]
    fn a_params_value_is_written_into_its_declaration() {
        let (_folder, mut editor) = editor();
        editor.text = "param a : [0, 1];\npoint p = (a, 0, 0);\n".into();
        assert_eq!(editor.write_param("a", &[0.25]), Ok(true));
        assert!(
            editor.text.starts_with("param a = 0.25 : [0, 1];\n"),
            "{}",
            editor.text
        );
        assert_eq!(editor.write_param("a", &[0.25]), Ok(false));
        assert!(editor.write_param("b", &[0.25]).is_err());
    }

    #[test]
    fn the_files_text_can_be_taken() {
        let (_folder, mut editor) = editor();
        editor.text = "mine".into();
        editor.take_changed("theirs".into());
        assert!(editor.settle(true));
        assert!(!editor.is_changed());
        assert_eq!(editor.text, "theirs");
    }

    #[test]
    fn what_was_written_here_is_no_news() {
        let (_folder, mut editor) = editor();
        editor.text = "mine".into();
        editor.save().expect("written");
        assert_eq!(
            std::fs::read_to_string(&editor.path).expect("a file"),
            "mine"
        );
        assert!(!editor.take_changed("mine".into()));
        assert_eq!(editor.conflict, None);
    }
}
