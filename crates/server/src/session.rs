//! The state of a session: settings, documents, the last messages sent.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use ide::Languages;

use crate::documents::Documents;
use crate::encoding::Place;
use crate::preview::{Previews, WindowProgram};
use crate::settings::Settings;
use crate::tokens::Encoded;

/// The capabilities of the editor.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Editor {
    /// Shows Markdown in hovers.
    pub(crate) markdown: bool,
    /// True if the documentation of completions may be Markdown; `None` if it must be a plain string.
    pub(crate) documentation: Option<bool>,
    /// Supports placeholders in completions.
    pub(crate) snippets: bool,
    /// Supports edits of a document at a version.
    pub(crate) versioned_edits: bool,
    /// Accepts the parameters of a signature as ranges of its label.
    pub(crate) label_offsets: bool,
    /// Accepts an action as the preferred one.
    pub(crate) preferred_actions: bool,
    /// Asks whether a name can be changed.
    pub(crate) prepares_rename: bool,
    /// Accepts related locations in a diagnostic.
    pub(crate) related_places: bool,
    /// Answers requests for settings.
    pub(crate) configuration: bool,
    /// Accepts a document's outline as a tree.
    pub(crate) hierarchical_symbols: bool,
    /// Refreshes hints on request.
    pub(crate) refreshes_hints: bool,
    /// Refreshes lenses on request.
    pub(crate) refreshes_lenses: bool,
    /// Shows a range of a document on request.
    pub(crate) shows_documents: bool,
    /// Applies edits that the server sends.
    pub(crate) applies_edits: bool,
    /// Creates files with edits that the server sends.
    pub(crate) creates_files: bool,
    /// Wants to hear of each picture: `experimental.geotrace.shown`.
    pub(crate) wants_shown: bool,
}

/// The state of a session: changed only by handlers before they first await, and hence in the order of the messages.
#[derive(Debug)]
pub(crate) struct Session {
    pub(crate) editor: Editor,
    pub(crate) settings: Settings,
    pub(crate) documents: Documents,
    pub(crate) previews: Previews,
    /// The last known position of the cursor in each document, for the next window.
    pub(crate) cursors: HashMap<String, Place>,
    /// The command that starts a preview; `None` in a build without it.
    pub(crate) window: Option<Arc<WindowProgram>>,
    /// The folders of the workspace.
    pub(crate) folders: Vec<std::path::PathBuf>,
    /// The tokens last sent for each document, with their name.
    pub(crate) tokens: HashMap<String, (String, Arc<[Encoded]>)>,
    /// The documents whose diagnostics the editor pulls; they are not pushed.
    pub(crate) pulled: HashSet<String>,
    pub(crate) counter: u64,
}

impl Session {
    /// Returns a session for documents in these languages, which starts this program for a preview.
    pub(crate) fn new(languages: Languages, window: Option<WindowProgram>) -> Self {
        Self {
            editor: Editor::default(),
            settings: Settings::default(),
            documents: Documents::new(languages),
            previews: Previews::default(),
            cursors: HashMap::new(),
            window: window.map(Arc::new),
            folders: Vec::new(),
            tokens: HashMap::new(),
            pulled: HashSet::new(),
            counter: 0,
        }
    }

    /// Sends the current text to a document's window, if it has one.
    pub(crate) fn preview_text(&mut self, uri: &str) {
        if self.previews.has(uri)
            && let Some(open) = self.documents.get(uri)
        {
            self.previews.text(uri, open.version, open.text().string());
        }
    }

    /// Sends the last changes to a document's window, if it has one.
    pub(crate) fn preview_edit(&mut self, uri: &str) {
        if let Some(open) = self.documents.get(uri) {
            self.previews.edit(uri, open, open.changes());
        }
    }

    /// Keeps the text of a document that has a window, before it is closed or reloaded.
    pub(crate) fn keep_text(&mut self, uri: &str) {
        if let Some(open) = self.documents.get(uri) {
            self.previews.keep_text(uri, open);
        }
    }

    /// Returns a name that has not been used yet.
    pub(crate) fn fresh_name(&mut self) -> String {
        self.counter += 1;
        self.counter.to_string()
    }
}
