//! The text: the own pane's, which is compiled, saved and rescued, and what the window is called after it.

use std::path::PathBuf;
use std::sync::Arc;

use super::{TextSource, Window};
use crate::engine::editor::Saved;
use crate::state::StatusMessage;

impl Window {
    /// The text of the window's own pane.
    pub fn text(&self) -> Option<&str> {
        match &self.source {
            TextSource::File { editor, .. } => Some(&editor.text),
            TextSource::Attached { .. } => None,
        }
    }

    /// Puts another text into the window's own pane, as though it had been typed.
    pub fn set_text(&mut self, text: String) {
        if let TextSource::File { editor, .. } = &mut self.source {
            editor.text = text;
        }
        self.compile_own();
    }

    pub(crate) fn compile_own(&mut self) {
        if let TextSource::File { editor, .. } = &self.source {
            let text: Arc<str> = editor.text.as_str().into();
            self.compile(text);
        }
    }

    pub(super) fn compile(&mut self, text: Arc<str>) {
        if let TextSource::File { editor, .. } = &mut self.source {
            editor.version += 1;
            let language = Arc::clone(&editor.language);
            self.compiler.compile(language, editor.version, text, None);
        }
    }

    /// Writes the own text to its file.
    pub(crate) fn save_text(&mut self) {
        let TextSource::File { editor, .. } = &mut self.source else {
            return;
        };
        let saved = editor.save();
        self.status_message = Some(match &saved {
            Ok(Saved::Written) => StatusMessage::info("Saved"),
            Ok(Saved::Followed) => StatusMessage::info("The file had changed: this is its text"),
            Err(sentence) => StatusMessage::error(sentence),
        });
        if saved == Ok(Saved::Followed) {
            self.compile_own();
        }
    }

    /// Writes a text that has not been saved where it takes no other file's place; a sentence that says where, or why
    /// not.
    /// Returns nothing if nothing would be lost.
    pub(crate) fn rescue(&self) -> Option<String> {
        match &self.source {
            TextSource::File { editor, .. } => editor.rescue(),
            TextSource::Attached { .. } => None,
        }
    }

    /// Returns whether closing the window would lose something that was written.
    pub(crate) fn has_unsaved(&self) -> bool {
        matches!(&self.source, TextSource::File { editor, .. } if editor.is_changed())
    }

    /// The folder that dialogs begin in.
    pub(crate) fn folder(&self) -> Option<PathBuf> {
        let path = match &self.source {
            TextSource::File { editor, .. } => Some(&editor.path),
            TextSource::Attached { path, .. } => path.as_ref(),
        };
        let folder = path?.parent()?;
        std::path::absolute(folder).ok()
    }

    /// Returns the window's title.
    pub fn title(&self) -> String {
        match &self.source {
            TextSource::File { editor, .. } => {
                let mark = if editor.is_changed() { "*" } else { "" };
                let name = editor
                    .path
                    .file_name()
                    .unwrap_or_default()
                    .to_string_lossy();
                format!("{mark}{name} – Geotrace")
            }
            TextSource::Attached { uri, .. } if uri.is_empty() => "Geotrace".to_owned(),
            TextSource::Attached { uri, path, .. } => {
                let file = path.as_ref().and_then(|path| path.file_name());
                let name = file.map(|name| name.to_string_lossy());
                // A text that lies nowhere has a name behind its kind: `untitled:Untitled-1`.
                let name = name.or_else(|| Some(uri.rsplit(['/', ':']).next()?.into()));
                format!("{} – Geotrace", name.unwrap_or_default())
            }
        }
    }
}
