//! The window's text: its source, its compiler, and the window's title.

use std::path::PathBuf;
use std::sync::Arc;

use ide::{Language, Languages};
use protocol::Event;
use session::StatusMessage;
use session::editor::Editor;

use super::Window;
use super::server_events::ServerReports;
use crate::engine::compiler::Compiler;
use crate::engine::saving::{self, Saved};
use crate::io::link::{DisconnectReason, Link};
use crate::io::watch::Watch;
use crate::ui::highlighting;
use crate::ui::panes::program::completion::Assistant;
use crate::ui::panes::program::find::Find;
use crate::ui::panes::program::rename::{NOT_RENAMED, Rename};

/// The sentence of the status line after the text was saved, until it is edited.
pub(super) const SAVED: &str = "Saved";

/// The text of a window, and its compiler.
pub(crate) struct WindowText {
    pub(crate) source: TextSource,
    pub(super) compiler: Compiler,
    /// The languages of programs.
    pub(super) languages: Languages,
    /// The version after which texts belong to the current program.
    pub(super) begins_after: i32,
    /// Colours the text of the window's own pane.
    pub(crate) painter: highlighting::Painter,
    /// Completion and hover there.
    pub(crate) assistant: Assistant,
    /// The search in it.
    pub(crate) find: Find,
    /// The renaming in progress there.
    pub(crate) rename: Option<Rename>,
    pub(super) reports: ServerReports,
}

/// The source of the text.
pub(crate) enum TextSource {
    /// A file with a pane to edit it.
    File {
        editor: Box<Editor>,
        _watch: Option<Watch>,
    },
    /// An editor in another process.
    Attached {
        link: Link,
        uri: String,
        path: Option<PathBuf>,
        /// Set if the server sends nothing more.
        disconnected: Option<DisconnectReason>,
    },
}

impl WindowText {
    /// Returns the text of a source, which is passed to the compiler.
    pub(super) fn new(source: TextSource, compiler: Compiler, languages: Languages) -> Self {
        Self {
            source,
            compiler,
            languages,
            begins_after: i32::MIN,
            painter: highlighting::Painter::default(),
            assistant: Assistant::default(),
            find: Find::default(),
            rename: None,
            reports: ServerReports::default(),
        }
    }

    /// Returns the text of the window's own pane.
    pub(super) fn text(&self) -> Option<&str> {
        match &self.source {
            TextSource::File { editor, .. } => Some(&editor.text),
            TextSource::Attached { .. } => None,
        }
    }

    /// Returns the language of the text.
    pub(crate) fn language(&self) -> &Arc<dyn Language> {
        match &self.source {
            TextSource::File { editor, .. } => &editor.language,
            TextSource::Attached { path, .. } => match path {
                Some(path) => self.languages.for_path(path),
                None => self.languages.default_language(),
            },
        }
    }

    /// Returns the languages of programs.
    pub(crate) fn languages(&self) -> &Languages {
        &self.languages
    }

    /// Returns whether the text is that of the window's own pane.
    pub(crate) fn is_own(&self) -> bool {
        matches!(self.source, TextSource::File { .. })
    }

    /// Compiles the text of the window's own pane.
    pub(crate) fn compile(&mut self) {
        if let TextSource::File { editor, .. } = &mut self.source {
            editor.version += 1;
            let (language, text) = (Arc::clone(&editor.language), editor.text.as_str().into());
            self.compiler.compile(language, editor.version, text, None);
        }
    }

    /// Returns whether a text of the window's own pane is newer than a version.
    pub(super) fn is_ahead_of(&self, version: i32) -> bool {
        matches!(&self.source, TextSource::File { editor, .. } if editor.version != version)
    }

    /// Returns the version from which the next program starts: texts of this version and below belong to earlier
    /// programs.
    pub(super) fn next_program(&mut self) -> i32 {
        if let TextSource::File { editor, .. } = &self.source {
            self.begins_after = editor.version;
        }
        self.painter = highlighting::Painter::default();
        self.assistant = Assistant::default();
        self.find = Find::default();
        self.rename = None;
        self.begins_after
    }

    /// Returns whether the text of the window's own pane is blank.
    pub(crate) fn is_blank(&self) -> bool {
        self.text().is_some_and(|text| text.trim().is_empty())
    }

    /// Sends an event to the server, if there is one.
    pub(crate) fn send(&self, event: Event) {
        if let TextSource::Attached {
            link,
            disconnected: None,
            ..
        } = &self.source
        {
            link.send(event);
        }
    }

    /// Writes an unsaved text to a new file. Returns a sentence that says where, or why it could not be written; `None`
    /// if nothing would be lost.
    pub(crate) fn rescue(&self) -> Option<String> {
        match &self.source {
            TextSource::File { editor, .. } => saving::rescue(editor),
            TextSource::Attached { .. } => None,
        }
    }

    /// Returns whether closing the window would lose unsaved text.
    pub(crate) fn has_unsaved(&self) -> bool {
        matches!(&self.source, TextSource::File { editor, .. } if editor.is_changed())
    }

    /// Returns the absolute path of the program's file.
    pub(crate) fn file(&self) -> Option<PathBuf> {
        let path = match &self.source {
            TextSource::File { editor, .. } => Some(&editor.path),
            TextSource::Attached { path, .. } => path.as_ref(),
        };
        std::path::absolute(path?).ok()
    }

    /// Returns the folder in which dialogs start.
    pub(crate) fn folder(&self) -> Option<PathBuf> {
        self.file()?.parent().map(PathBuf::from)
    }

    /// Returns the window's title.
    pub(super) fn title(&self) -> String {
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
                // A text without a file has a name after its scheme: `untitled:Untitled-1`.
                let name = name.or_else(|| Some(uri.rsplit(['/', ':']).next()?.into()));
                format!("{} – Geotrace", name.unwrap_or_default())
            }
        }
    }
}

impl Window {
    /// Returns the text of the window's own pane.
    pub fn text(&self) -> Option<&str> {
        self.text.text()
    }

    /// Replaces the text of the window's own pane, as though it had been typed.
    pub fn set_text(&mut self, text: String) {
        if let TextSource::File { editor, .. } = &mut self.text.source {
            editor.text = text;
        }
        self.has_edited();
    }

    /// Compiles the text that the user has edited. It no longer counts as saved, and a refused renaming is past.
    pub(crate) fn has_edited(&mut self) {
        self.status_message
            .take_if(|it| it.text == SAVED || it.text.starts_with(NOT_RENAMED));
        self.text.compile();
    }

    /// Replaces the text of the window's own pane; this can be undone.
    pub(crate) fn replace_text(&mut self, text: &str) {
        if let TextSource::File { editor, .. } = &mut self.text.source {
            editor.replace(text.to_owned());
        }
        self.has_edited();
    }

    /// Returns the window's title.
    pub fn title(&self) -> String {
        match self.panes.is_welcome {
            true => "Geotrace".to_owned(),
            false => self.text.title(),
        }
    }

    /// Writes the own text to its file.
    pub(crate) fn save_text(&mut self) {
        let TextSource::File { editor, .. } = &mut self.text.source else {
            return;
        };
        if editor.is_new {
            crate::ui::dialogs::program::ask_for_target(self, None);
            return;
        }
        let saved = saving::save(editor);
        self.status_message = Some(match &saved {
            Ok(Saved::Written) => StatusMessage::info(SAVED),
            Ok(Saved::Followed) => StatusMessage::info("The file had changed: its text is shown"),
            Err(sentence) => StatusMessage::error(sentence),
        });
        if saved == Ok(Saved::Followed) {
            self.text.compile();
        }
    }
}
