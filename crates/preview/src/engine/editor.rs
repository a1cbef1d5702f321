//! The text of the window's own pane, and its file.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use export::whole_file::{write_new, write_whole};
use ide::edit::Edit;
use ide::{Analysis, Language};
use syntax::span::Span;

use crate::io::watch::Unreadable;

/// A place of the text that is to be shown.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jump {
    pub(crate) place: Span,
    /// The place gets the keyboard focus.
    pub(crate) takes_keys: bool,
}

/// A text that is edited here.
#[derive(Debug)]
pub(crate) struct Editor {
    pub(crate) language: Arc<dyn Language>,
    /// Its file, or the name that a new program has before it is saved.
    pub(crate) path: PathBuf,
    /// It has no file yet.
    pub(crate) is_new: bool,
    pub(crate) text: String,
    /// Counts the texts that were compiled.
    pub(crate) version: i32,
    /// The file's content, as far as is known.
    saved: String,
    /// The file's new text, where it has changed while this one had too.
    pub(crate) conflict: Option<String>,
    /// A place that the cursor is to be put to.
    pub(crate) jump: Option<Jump>,
    /// The field that shows the text is to have the keys.
    pub(crate) wants_keys: bool,
    /// The texts whose place another one has taken by other means than typing, oldest first, until the field that shows
    /// the text has them among what it can undo.
    pub(crate) replaced: Vec<String>,
}

/// The effect of saving.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Saved {
    /// The file holds the text.
    Written,
    /// Nothing had been written here, but the file holds another text: that is shown now.
    Followed,
}

impl Editor {
    /// A file's text.
    pub(crate) fn new(language: Arc<dyn Language>, path: PathBuf, text: String) -> Self {
        Self {
            language,
            path,
            is_new: false,
            saved: text.clone(),
            text,
            version: 0,
            conflict: None,
            jump: None,
            wants_keys: false,
            replaced: Vec::new(),
        }
    }

    /// A text without a file, which would have this name.
    pub(crate) fn untitled(language: Arc<dyn Language>, name: &str, text: String) -> Self {
        Self {
            is_new: true,
            ..Self::new(language, PathBuf::from(name), text)
        }
    }

    /// Returns whether the text differs from the file's, or from what a new one began with.
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
        self.replace(text.clone());
        self.saved = text;
        true
    }

    /// Ends a conflict: with the file's text, or with the own one, which then differs from the file's. Whether the
    /// text is another one now.
    pub(crate) fn settle(&mut self, take_file: bool) -> bool {
        let Some(text) = self.conflict.take() else {
            return false;
        };
        if take_file {
            self.replace(text.clone());
        }
        self.saved = text;
        take_file
    }

    /// Writes the text to the file, unless that has content that was never shown here: it may not be watched, or the
    /// news of it
    /// may be on its way.
    ///
    /// # Errors
    /// A sentence; the file is as it was.
    pub(crate) fn save(&mut self) -> Result<Saved, String> {
        match crate::io::watch::read(&self.path) {
            Ok(text) => {
                if self.take_changed(text) {
                    return Ok(Saved::Followed);
                }
                if !self.is_changed() {
                    return Ok(Saved::Written);
                }
            }
            Err(Unreadable::Missing(_)) => {}
            Err(unreadable) => {
                let path = self.path.display();
                return Err(format!(
                    "not saved, since what `{path}` holds now cannot be read ({unreadable})"
                ));
            }
        }
        if self.conflict.is_some() {
            return Err("the file has changed on disk: choose which text to keep first".to_owned());
        }
        write_whole(&self.path, self.text.as_bytes())
            .map_err(|error| format!("cannot write `{}`: {error}", self.path.display()))?;
        self.saved.clone_from(&self.text);
        Ok(Saved::Written)
    }

    /// Writes the text to another file, which is its own from then on.
    ///
    /// # Errors
    /// A sentence; the text belongs to the file that it had.
    pub(crate) fn save_as(&mut self, path: PathBuf) -> Result<(), String> {
        write_whole(&path, self.text.as_bytes())
            .map_err(|error| format!("cannot write `{}`: {error}", path.display()))?;
        self.path = path;
        self.is_new = false;
        self.conflict = None;
        self.saved.clone_from(&self.text);
        Ok(())
    }

    /// Writes a text that has not been saved beside its file, or where that cannot be, among the system's temporary
    /// files:
    /// under a name that nothing has yet. A sentence that says where, or why not; none where all is saved.
    pub(crate) fn rescue(&self) -> Option<String> {
        if !self.is_changed() {
            return None;
        }
        let stem = self.path.file_stem().unwrap_or_default().to_string_lossy();
        let extension = self.path.extension();
        let extension = extension.map(|it| format!(".{}", it.to_string_lossy()));
        let extension = extension.unwrap_or_default();
        let name = |number: u32| match number {
            1 => format!("{stem}.unsaved{extension}"),
            _ => format!("{stem}.unsaved-{number}{extension}"),
        };
        let own = self.path.with_file_name("");
        let write = |folder: &Path| write_new(folder, name, self.text.as_bytes());
        let written = std::path::absolute(own).and_then(|own| write(&own));
        Some(match written.or_else(|_| write(&std::env::temp_dir())) {
            Ok(place) => format!("the text that was not saved is in `{}`", place.display()),
            Err(error) => format!("the text that was not saved is lost ({error})"),
        })
    }

    /// Makes an edit of the text as it is now; whether the text is another one then.
    ///
    /// # Errors
    /// Those of `make`; the text is as it was.
    pub(crate) fn write<E: std::fmt::Display>(
        &mut self,
        make: impl FnOnce(&dyn Analysis) -> Result<Edit, E>,
    ) -> Result<bool, String> {
        let analysis = self.language.read(&self.text);
        let edit = make(&*analysis).map_err(|refusal| refusal.to_string())?;
        let text = ide::edit::apply(&self.text, &[edit]);
        let changed = text != self.text;
        if changed {
            self.replace(text);
        }
        Ok(changed)
    }

    /// Puts another text in the place of this one, which the field that shows it can undo.
    pub(crate) fn replace(&mut self, text: String) {
        self.replaced.push(std::mem::replace(&mut self.text, text));
    }
}

#[cfg(test)]
mod tests {
    use super::{Editor, Saved};

    fn editor() -> (tempfile::TempDir, Editor) {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.gtr");
        std::fs::write(&path, "one").expect("written");
        let languages = ide::Languages::standard();
        let language = languages.for_path(&path).clone();
        (folder, Editor::new(language, path, "one".into()))
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
        let (_folder, mut editor) = editor();
        editor.text = "mine".into();
        editor.take_changed("theirs".into());
        assert!(editor.settle(true));
        assert!(!editor.is_changed());
        assert_eq!(editor.text, "theirs");
    }

    #[test]
    fn a_file_that_nobody_watches_is_looked_at_before_it_is_written() {
        let (_folder, mut editor) = editor();
        let on_disk = |editor: &Editor| std::fs::read_to_string(&editor.path).expect("a file");
        editor.text = "mine".into();
        std::fs::write(&editor.path, "theirs").expect("written");
        assert!(editor.save().is_err());
        assert_eq!(editor.conflict.as_deref(), Some("theirs"));
        assert_eq!(on_disk(&editor), "theirs");
        // Once more while the question is open.
        std::fs::write(&editor.path, "theirs too").expect("written");
        assert!(!editor.settle(false));
        assert!(editor.save().is_err());
        assert_eq!(editor.conflict.as_deref(), Some("theirs too"));
        assert!(!editor.settle(false));
        assert_eq!(editor.save(), Ok(Saved::Written));
        assert_eq!(on_disk(&editor), "mine");
        // Nothing was written here: the file's is what there is.
        std::fs::write(&editor.path, "theirs again").expect("written");
        assert_eq!(editor.save(), Ok(Saved::Followed));
        assert_eq!(editor.text, "theirs again");
        assert!(!editor.is_changed());
        // What is no text is somebody's, too; what is gone is written anew.
        editor.text = "mine".into();
        std::fs::write(&editor.path, [0xff]).expect("written");
        let told = editor.save().expect_err("not over it");
        assert!(told.contains("it is not UTF-8"), "{told}");
        assert_eq!(std::fs::read(&editor.path).expect("a file"), [0xff]);
        std::fs::remove_file(&editor.path).expect("removed");
        assert_eq!(editor.save(), Ok(Saved::Written));
        assert_eq!(on_disk(&editor), "mine");
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
