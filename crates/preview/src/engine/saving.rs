//! The file of the window's own text: saves it, and rescues unsaved changes.
//!
//! In: an [`Editor`]. Out: a complete file, and the editor's updated knowledge of it.

use std::path::{Path, PathBuf};

use export::whole_file::{write_new, write_whole};
use session::editor::Editor;

use crate::io::watch::Unreadable;

/// The result of saving.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Saved {
    /// The file holds the text.
    Written,
    /// There were no unsaved changes, but the file holds another text, which is now shown.
    Followed,
}

/// Writes the text to the file, unless the file has content that was never shown here: it may not be watched, or its
/// change may not have been reported yet.
///
/// # Errors
/// A sentence; the file is unchanged.
pub(crate) fn save(editor: &mut Editor) -> Result<Saved, String> {
    match crate::io::watch::read(&editor.path) {
        Ok(text) => {
            if editor.take_changed(text) {
                return Ok(Saved::Followed);
            }
            if !editor.is_changed() {
                return Ok(Saved::Written);
            }
        }
        Err(Unreadable::Missing(_)) => {}
        Err(unreadable) => {
            let path = editor.path.display();
            return Err(format!(
                "not saved, since the present content of `{path}` cannot be read ({unreadable})"
            ));
        }
    }
    if editor.conflict.is_some() {
        return Err("the file has changed on disk: choose which text to keep first".to_owned());
    }
    write_whole(&editor.path, editor.text_of_file().as_bytes())
        .map_err(|error| format!("cannot write `{}`: {error}", editor.path.display()))?;
    editor.note_saved();
    Ok(Saved::Written)
}

/// Writes the text to another file, which becomes its own.
///
/// # Errors
/// A sentence; the text keeps its previous file.
pub(crate) fn save_as(editor: &mut Editor, path: PathBuf) -> Result<(), String> {
    write_whole(&path, editor.text_of_file().as_bytes())
        .map_err(|error| format!("cannot write `{}`: {error}", path.display()))?;
    editor.path = path;
    editor.is_new = false;
    editor.conflict = None;
    editor.note_saved();
    Ok(())
}

/// Writes an unsaved text beside its file, or else among the system's temporary files, under an unused name. Returns a
/// sentence that says where, or why it could not be written; `None` if everything is saved.
pub(crate) fn rescue(editor: &Editor) -> Option<String> {
    if !editor.is_changed() {
        return None;
    }
    let stem = editor
        .path
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy();
    let extension = editor.path.extension();
    let extension = extension.map(|it| format!(".{}", it.to_string_lossy()));
    let extension = extension.unwrap_or_default();
    let name = |number: u32| match number {
        1 => format!("{stem}.unsaved{extension}"),
        _ => format!("{stem}.unsaved-{number}{extension}"),
    };
    let own = editor.path.with_file_name("");
    let write = |folder: &Path| write_new(folder, name, editor.text_of_file().as_bytes());
    let written = std::path::absolute(own).and_then(|own| write(&own));
    Some(match written.or_else(|_| write(&std::env::temp_dir())) {
        Ok(place) => format!("the unsaved text is in `{}`", place.display()),
        Err(error) => format!("the unsaved text is lost ({error})"),
    })
}

#[cfg(test)]
mod tests {
    use session::editor::Editor;

    use super::{Saved, save};

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
        assert!(
            save(&mut editor).is_err(),
            "not over what has not been seen"
        );
        assert!(!editor.settle(false));
        assert!(editor.is_changed() && save(&mut editor).is_ok() && !editor.is_changed());
    }

    #[test]
    fn a_file_that_nobody_watches_is_looked_at_before_it_is_written() {
        let (_folder, mut editor) = editor();
        let on_disk = |editor: &Editor| std::fs::read_to_string(&editor.path).expect("a file");
        editor.text = "mine".into();
        std::fs::write(&editor.path, "theirs").expect("written");
        assert!(save(&mut editor).is_err());
        assert_eq!(editor.conflict.as_deref(), Some("theirs"));
        assert_eq!(on_disk(&editor), "theirs");
        // Once more while the question is open.
        std::fs::write(&editor.path, "theirs too").expect("written");
        assert!(!editor.settle(false));
        assert!(save(&mut editor).is_err());
        assert_eq!(editor.conflict.as_deref(), Some("theirs too"));
        assert!(!editor.settle(false));
        assert_eq!(save(&mut editor), Ok(Saved::Written));
        assert_eq!(on_disk(&editor), "mine");
        // Nothing was written here: the file's is what there is.
        std::fs::write(&editor.path, "theirs again").expect("written");
        assert_eq!(save(&mut editor), Ok(Saved::Followed));
        assert_eq!(editor.text, "theirs again");
        assert!(!editor.is_changed());
        // What is no text is somebody's, too; what is gone is written anew.
        editor.text = "mine".into();
        std::fs::write(&editor.path, [0xff]).expect("written");
        let error = save(&mut editor).expect_err("not over it");
        assert!(error.contains("it is not UTF-8"), "{error}");
        assert_eq!(std::fs::read(&editor.path).expect("a file"), [0xff]);
        std::fs::remove_file(&editor.path).expect("removed");
        assert_eq!(save(&mut editor), Ok(Saved::Written));
        assert_eq!(on_disk(&editor), "mine");
    }

    #[test]
    fn the_line_ends_of_the_file_are_kept() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.gtr");
        let languages = ide::Languages::standard();
        for (before, after) in [
            ("one\r\ntwo\r\n", "one\r\nmore\r\ntwo\r\n"),
            ("one\ntwo\n", "one\nmore\ntwo\n"),
            // Both kinds are left alone.
            ("one\ntwo\r\n", "one\nmore\ntwo\r\n"),
        ] {
            std::fs::write(&path, before).expect("written");
            let language = languages.for_path(&path).clone();
            let mut editor = Editor::new(language, path.clone(), before.into());
            // The field ends a line by a line feed.
            editor.text = editor.text.replace("one\n", "one\nmore\n");
            assert_eq!(save(&mut editor), Ok(Saved::Written));
            let written = std::fs::read_to_string(&path).expect("a file");
            assert_eq!(written, after);
            assert!(!editor.take_changed(written) && !editor.is_changed());
        }
    }

    #[test]
    fn what_was_written_here_is_no_news() {
        let (_folder, mut editor) = editor();
        editor.text = "mine".into();
        save(&mut editor).expect("written");
        assert_eq!(
            std::fs::read_to_string(&editor.path).expect("a file"),
            "mine"
        );
        assert!(!editor.take_changed("mine".into()));
        assert_eq!(editor.conflict, None);
    }
}
