//! The entries of the menu *Edit* for the text.

use egui::Ui;
use egui::text_edit::TextEditState;

use super::code::id;
use super::keys;
use crate::ui::window::{TextSource, Window, WindowText};

/// A command for the text.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum TextCommand {
    Undo,
    Redo,
    /// Makes comments of the selected lines, or of comments lines.
    Comment,
}

/// Returns whether a command has anything to do.
pub(crate) fn is_possible(text: &WindowText, ui: &Ui, command: TextCommand) -> bool {
    let TextSource::File { editor, .. } = &text.source else {
        return false;
    };
    let state = TextEditState::load(ui.ctx(), id()).unwrap_or_default();
    let present = (
        state.cursor.char_range().unwrap_or_default(),
        editor.text.clone(),
    );
    match command {
        TextCommand::Undo => state.undoer().has_undo(&present) || !editor.replaced.is_empty(),
        TextCommand::Redo => state.undoer().has_redo(&present),
        TextCommand::Comment => editor.language.line_comment().is_some(),
    }
}

impl Window {
    /// Does a command in the text of the window's own pane, which gets the keys.
    pub(crate) fn edit_text(&mut self, ui: &Ui, command: TextCommand) {
        let TextSource::File { editor, .. } = &mut self.text.source else {
            return;
        };
        super::code::remember(ui, id(), &mut editor.replaced);
        let mut state = TextEditState::load(ui.ctx(), id()).unwrap_or_default();
        let present = (
            state.cursor.char_range().unwrap_or_default(),
            editor.text.clone(),
        );
        let mut undoer = state.undoer();
        let other = match command {
            TextCommand::Undo => undoer.undo(&present).cloned(),
            TextCommand::Redo => undoer.redo(&present).cloned(),
            TextCommand::Comment => {
                keys::toggle_comment(ui, id(), editor);
                None
            }
        };
        if let Some((cursor, text)) = other {
            state.cursor.set_char_range(Some(cursor));
            state.set_undoer(undoer);
            state.store(ui.ctx(), id());
            editor.text = text;
        }
        editor.wants_keys = true;
        self.has_edited();
    }
}
