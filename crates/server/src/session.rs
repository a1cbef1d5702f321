//! What the server remembers of a session: settings, documents, what was sent last.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use ide::Languages;

use crate::documents::Documents;
use crate::encoding::Place;
use crate::preview::{Previews, WindowProgram};
use crate::settings::Settings;
use crate::tokens::Encoded;

/// What the editor says that it understands.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Editor {
    /// Markdown in hovers.
    pub(crate) markdown: bool,
    /// Whether the documentation of completions may be Markdown; none where it has to be a plain string.
    pub(crate) documentation: Option<bool>,
    /// Places to fill in in completions.
    pub(crate) snippets: bool,
    /// Edits of documents of a version.
    pub(crate) versioned_edits: bool,
    /// Can be asked for settings.
    pub(crate) configuration: bool,
    /// Takes a declaration's outline as a tree.
    pub(crate) hierarchical_symbols: bool,
    /// Can be told that hints have changed.
    pub(crate) refreshes_hints: bool,
    /// Can be told that lenses have changed.
    pub(crate) refreshes_lenses: bool,
    /// Can be asked to show a place of a document.
    pub(crate) shows_documents: bool,
    /// Takes edits that it has not asked for.
    pub(crate) applies_edits: bool,
    /// Wants to hear of each picture: `experimental.geotrace.shown`.
    pub(crate) hears_shown: bool,
}

/// The state of a session: changed only by handlers, before they wait for anything, so in the order of the messages.
#[derive(Debug)]
pub(crate) struct Session {
    pub(crate) editor: Editor,
    pub(crate) settings: Settings,
    pub(crate) documents: Documents,
    pub(crate) previews: Previews,
    /// Where the cursor was last seen in each document: for the window that is opened next.
    pub(crate) cursors: HashMap<String, Place>,
    /// What is started for a preview; none in a build without it.
    pub(crate) window: Option<Arc<WindowProgram>>,
    /// The folders of the workspace.
    pub(crate) folders: Vec<std::path::PathBuf>,
    /// The tokens sent last for each document, and under which name.
    pub(crate) tokens: HashMap<String, (String, Arc<[Encoded]>)>,
    /// The documents whose diagnostics the editor asks for: they are not sent unasked.
    pub(crate) pulled: HashSet<String>,
    pub(crate) counter: u64,
}

impl Session {
    /// A session for documents in these languages, which starts this program for a preview.
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

    /// Sends the text as it is now to a document's window, if it has one.
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

    /// Keeps the text of a document that has a window, before it is closed or read anew.
    pub(crate) fn keep_text(&mut self, uri: &str) {
        if let Some(open) = self.documents.get(uri) {
            self.previews.keep_text(uri, open);
        }
    }

    /// A name that has not been used yet.
    pub(crate) fn fresh_name(&mut self) -> String {
        self.counter += 1;
        self.counter.to_string()
    }
}
