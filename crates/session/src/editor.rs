//! A text that is edited, and the known content of its file. This module reads and writes no files.
//!
//! The lines of the text end in line feeds, whatever those of the file end in: a cursor cannot be inside a line end.

use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::Arc;

use ide::edit::Edit;
use ide::{Analysis, Language};
use syntax::span::Span;

/// A range of the text that is to be shown.
#[derive(Clone, Copy, Debug)]
pub struct Jump {
    /// The range, in bytes of the text.
    pub place: Span,
    /// True if the keyboard focus goes there.
    pub takes_keys: bool,
}

/// A text that is edited here.
#[derive(Debug)]
pub struct Editor {
    /// The language of the text.
    pub language: Arc<dyn Language>,
    /// Its file, or the name that a new program has before it is saved.
    pub path: PathBuf,
    /// True if it has no file yet.
    pub is_new: bool,
    /// The text as it is now.
    pub text: String,
    /// The number of texts that were compiled.
    pub version: i32,
    /// The last known content of the file.
    saved: String,
    /// True if the file's lines end in carriage returns and line feeds.
    has_carriage_returns: bool,
    /// True if the file has been deleted or moved, or can no longer be read as text.
    is_gone: bool,
    /// The file's new text, if it has changed while this one had too.
    pub conflict: Option<String>,
    /// A range to which the cursor is to move.
    pub jump: Option<Jump>,
    /// True if the field that shows the text is to have the keyboard focus.
    pub wants_keys: bool,
    /// The texts that were replaced by other means than typing, oldest first, until the field that shows the text has
    /// added them to its undo history.
    pub replaced: Vec<String>,
}

impl Editor {
    /// Returns the editor of a file's text.
    pub fn new(language: Arc<dyn Language>, path: PathBuf, text: String) -> Self {
        let (text, has_carriage_returns) = with_line_feeds(text);
        Self {
            language,
            path,
            is_new: false,
            saved: text.clone(),
            has_carriage_returns,
            is_gone: false,
            text,
            version: 0,
            conflict: None,
            jump: None,
            wants_keys: false,
            replaced: Vec::new(),
        }
    }

    /// Returns the editor of a text without a file, which would have this name.
    pub fn untitled(language: Arc<dyn Language>, name: &str, text: String) -> Self {
        Self {
            is_new: true,
            ..Self::new(language, PathBuf::from(name), text)
        }
    }

    /// Returns whether the text differs from the file's, or from the initial text of a new program. A file that is gone
    /// holds no text.
    pub fn is_changed(&self) -> bool {
        self.is_gone || self.text != self.saved
    }

    /// Notes that the file can no longer be read: the text is not saved anywhere.
    pub fn note_gone(&mut self) {
        self.is_gone = true;
    }

    /// Notes that the file holds another text. Takes it over unless unsaved changes would be lost. Returns whether the
    /// text has changed.
    pub fn take_changed(&mut self, text: String) -> bool {
        let (text, has_carriage_returns) = with_line_feeds(text);
        self.has_carriage_returns = has_carriage_returns;
        self.is_gone = false;
        if text == self.text || text == self.saved {
            self.saved = text;
            self.conflict = None;
            return false;
        }
        if self.is_changed() {
            self.conflict = Some(text);
            return false;
        }
        self.conflict = None;
        self.replace(text.clone());
        self.saved = text;
        true
    }

    /// Ends a conflict: with the file's text, or with the edited one, which then differs from the file's. Returns
    /// whether the text has changed.
    pub fn settle(&mut self, take_file: bool) -> bool {
        let Some(text) = self.conflict.take() else {
            return false;
        };
        if take_file {
            self.replace(text.clone());
        }
        self.saved = text;
        take_file
    }

    /// Returns the text with the line ends of the file.
    pub fn text_of_file(&self) -> Cow<'_, str> {
        match self.has_carriage_returns {
            true => self.text.replace('\n', "\r\n").into(),
            false => self.text.as_str().into(),
        }
    }

    /// Notes that the file holds the text as it is now.
    pub fn note_saved(&mut self) {
        self.is_gone = false;
        self.saved.clone_from(&self.text);
    }

    /// Makes an edit of the current text. Returns whether the text has changed.
    ///
    /// # Errors
    /// Those of `make`; the text is unchanged.
    pub fn write<E: std::fmt::Display>(
        &mut self,
        make: impl FnOnce(&dyn Analysis) -> Result<Edit, E>,
    ) -> Result<bool, String> {
        self.rewrite(|analysis| make(analysis).map(|edit| vec![edit]))
    }

    /// Makes edits of the current text. Returns whether the text has changed.
    ///
    /// # Errors
    /// Those of `make`; the text is unchanged.
    pub fn rewrite<E: std::fmt::Display>(
        &mut self,
        make: impl FnOnce(&dyn Analysis) -> Result<Vec<Edit>, E>,
    ) -> Result<bool, String> {
        let analysis = self.language.read(&self.text);
        let edits = make(&*analysis).map_err(|refusal| refusal.to_string())?;
        let text = ide::edit::apply(&self.text, &edits);
        let changed = text != self.text;
        if changed {
            self.replace(text);
        }
        Ok(changed)
    }

    /// Replaces the text; the field that shows it can undo this.
    pub fn replace(&mut self, text: String) {
        self.replaced.push(std::mem::replace(&mut self.text, text));
    }
}

/// Returns a file's text with line feeds, and whether all of its lines end in carriage returns and line feeds. A text
/// with both kinds of line ends is not changed.
fn with_line_feeds(text: String) -> (String, bool) {
    let pairs = text.matches("\r\n").count();
    match pairs > 0 && pairs == text.matches('\n').count() {
        true => (text.replace("\r\n", "\n"), true),
        false => (text, false),
    }
}

#[cfg(test)]
mod tests {
    use super::Editor;

    fn editor() -> Editor {
        let languages = ide::Languages::standard();
        let language = languages.default_language().clone();
        Editor::new(language, "a.gtr".into(), "one".into())
    }

    #[test]
    fn a_params_value_is_written_into_its_declaration() {
        let mut editor = editor();
        editor.text = "param a : [0, 1];\npoint p = (a, 0, 0);\n".into();
        assert_eq!(
            editor.write(|analysis| analysis.edit_param("a", &[0.25])),
            Ok(true)
        );
        assert!(
            editor.text.starts_with("param a = 0.25 : [0, 1];\n"),
            "{}",
            editor.text
        );
        assert_eq!(
            editor.write(|analysis| analysis.edit_param("a", &[0.25])),
            Ok(false)
        );
        assert!(
            editor
                .write(|analysis| analysis.edit_param("b", &[0.25]))
                .is_err()
        );
    }

    #[test]
    fn the_files_text_can_be_taken() {
        let mut editor = editor();
        editor.text = "mine".into();
        editor.take_changed("theirs".into());
        assert!(editor.settle(true));
        assert!(!editor.is_changed());
        assert_eq!(editor.text, "theirs");
    }

    #[test]
    fn the_text_of_a_file_that_is_gone_is_not_saved_until_the_file_is_back() {
        let mut editor = editor();
        editor.note_gone();
        assert!(editor.is_changed());
        assert!(!editor.take_changed("one".into()));
        assert!(!editor.is_changed());
        // As when another branch is checked out: the text was not edited, and the new one is followed.
        editor.note_gone();
        assert!(editor.take_changed("two".into()));
        assert!(!editor.is_changed());
        editor.note_gone();
        editor.note_saved();
        assert!(!editor.is_changed());
    }

    #[test]
    fn a_conflict_ends_when_the_file_is_followed_again() {
        let mut editor = editor();
        editor.text = "mine".into();
        editor.take_changed("theirs".into());
        assert!(editor.conflict.is_some());
        // The edit is undone, and the file changes once more.
        editor.text = "one".into();
        assert!(editor.take_changed("theirs, later".into()));
        assert_eq!(editor.conflict, None);
        assert!(!editor.settle(true));
        assert_eq!(editor.text, "theirs, later");
    }
}
