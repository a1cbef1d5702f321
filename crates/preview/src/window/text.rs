//! The text: the own pane's, which is compiled, saved and rescued, and what the window is called after it.

use std::path::PathBuf;
use std::sync::Arc;

use super::{Origin, Window};
use crate::panes::editor::Saved;

impl Window {
    /// The text of the window's own pane.
    pub fn text(&self) -> Option<&str> {
        match &self.origin {
            Origin::File { editor, .. } => Some(&editor.text),
            Origin::Attached { .. } => None,
        }
    }

    /// Puts another text into the window's own pane, as though it had been typed.
    pub fn set_text(&mut self, text: String) {
        if let Origin::File { editor, .. } = &mut self.origin {
            editor.text = text;
        }
        self.compile_own();
    }

    pub(crate) fn compile_own(&mut self) {
        if let Origin::File { editor, .. } = &self.origin {
            let text: Arc<str> = editor.text.as_str().into();
            self.compile(text);
        }
    }

    pub(super) fn compile(&mut self, text: Arc<str>) {
        if let Origin::File { editor, .. } = &mut self.origin {
            editor.version += 1;
            self.compiler.compile(editor.version, text);
        }
    }

    /// Writes the own text to its file.
    pub(crate) fn save_text(&mut self) {
        let Origin::File { editor, .. } = &mut self.origin else {
            return;
        };
        let saved = editor.save();
        self.said = Some(match &saved {
            Ok(Saved::Written) => (false, "Saved".to_owned()),
            Ok(Saved::Followed) => (false, "The file had changed: this is its text".to_owned()),
            Err(sentence) => (true, sentence.clone()),
        });
        if saved == Ok(Saved::Followed) {
            self.compile_own();
        }
    }

    /// Writes a text that has not been saved where it takes no other file's place; a sentence that says where, or why not.
    /// None where nothing would be lost.
    pub(crate) fn rescue(&self) -> Option<String> {
        match &self.origin {
            Origin::File { editor, .. } => editor.rescue(),
            Origin::Attached { .. } => None,
        }
    }

    /// Whether closing the window would lose something that was written.
    pub(crate) fn has_unsaved(&self) -> bool {
        matches!(&self.origin, Origin::File { editor, .. } if editor.is_changed())
    }

    /// The folder that dialogs begin in.
    pub(crate) fn folder(&self) -> Option<PathBuf> {
        let path = match &self.origin {
            Origin::File { editor, .. } => Some(&editor.path),
            Origin::Attached { path, .. } => path.as_ref(),
        };
        let folder = path?.parent()?;
        std::path::absolute(folder).ok()
    }

    /// What the window is called.
    pub fn title(&self) -> String {
        match &self.origin {
            Origin::File { editor, .. } => {
                let mark = if editor.is_changed() { "*" } else { "" };
                let name = editor
                    .path
                    .file_name()
                    .unwrap_or_default()
                    .to_string_lossy();
                format!("{mark}{name} – Geotrace")
            }
            Origin::Attached { uri, .. } if uri.is_empty() => "Geotrace".to_owned(),
            Origin::Attached { uri, path, .. } => {
                let file = path.as_ref().and_then(|path| path.file_name());
                let name = file.map(|name| name.to_string_lossy());
                // A text that lies nowhere has a name behind its kind: `untitled:Untitled-1`.
                let name = name.or_else(|| Some(uri.rsplit(['/', ':']).next()?.into()));
                format!("{} – Geotrace", name.unwrap_or_default())
            }
        }
    }
}
