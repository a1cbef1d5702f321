//! The entries of the menu *Edit* for the text, and their keys.

use std::convert::Infallible;
use std::fmt::Display;

use egui::text_edit::TextEditState;
use egui::{Event, Key, KeyboardShortcut, Modifiers, Ui};
use ide::Analysis;
use ide::edit::Edit;
use session::editor::{Editor, Jump};
use syntax::diagnostic::Fix;
use syntax::span::Span;

use super::code::id;
use super::keys;
use crate::ui::window::{TextSource, Window};

/// A command for the text.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum TextCommand {
    Undo,
    Redo,
    /// Comments out the selected lines, or uncomments them.
    Comment,
    /// Asks for a new name for the name at the cursor.
    Rename,
    /// Applies all fixes that need no choice.
    FixAll,
    /// Formats the text, or the selected declarations, canonically.
    Format,
}

/// Returns whether a command would have an effect.
pub(crate) fn is_possible(window: &Window, ui: &Ui, command: TextCommand) -> bool {
    let TextSource::File { editor, .. } = &window.text.source else {
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
        TextCommand::FixAll => {
            let mut fixes = window
                .model
                .faults
                .findings()
                .iter()
                .flat_map(|it| &it.fixes);
            fixes.any(|fix| fix.all)
        }
        TextCommand::Rename | TextCommand::Format => true,
    }
}

/// Makes edits of the text, and keeps the cursor, which is `at` in bytes, at the same position relative to the text.
/// Returns whether the text has changed.
///
/// # Errors
/// Those of `make`; the text is unchanged.
pub(super) fn rewrite<E: Display>(
    editor: &mut Editor,
    at: u32,
    make: impl FnOnce(&dyn Analysis) -> Result<Vec<Edit>, E>,
) -> Result<bool, String> {
    let mut cursor = i64::from(at);
    let changed = editor.rewrite(|analysis| {
        let edits = make(analysis)?;
        let before = edits.iter().filter(|edit| edit.span.end <= at);
        cursor += before
            .map(|edit| edit.text.len() as i64 - i64::from(edit.span.end - edit.span.start))
            .sum::<i64>();
        Ok::<_, E>(edits)
    })?;
    let cursor = (cursor.max(0) as u32).min(editor.text.len() as u32);
    editor.jump = Some(Jump {
        place: Span::new(cursor, cursor),
        takes_keys: true,
    });
    Ok(changed)
}

impl Window {
    /// Handles the keys of commands that the field does not know.
    pub(crate) fn text_keys(&mut self, ui: &Ui) {
        let pressed = |modifiers, key| {
            let shortcut = KeyboardShortcut::new(modifiers, key);
            ui.input_mut(|input| input.consume_shortcut(&shortcut))
        };
        if pressed(Modifiers::NONE, Key::F2) {
            self.edit_text(ui, TextCommand::Rename);
        }
        if pressed(Modifiers::COMMAND, Key::Period) {
            self.edit_text(ui, TextCommand::FixAll);
        }
        if pressed(Modifiers::SHIFT | Modifiers::ALT, Key::F) {
            // Systems also send the letter; a Mac sends another one.
            ui.input_mut(|input| {
                let is_letter =
                    |event: &Event| matches!(event, Event::Text(text) if text.chars().count() == 1);
                input.events.retain(|event| !is_letter(event));
            });
            self.edit_text(ui, TextCommand::Format);
        }
    }

    /// Runs a command on the text of the window's own pane, which gets the focus.
    pub(crate) fn edit_text(&mut self, ui: &Ui, command: TextCommand) {
        let TextSource::File { editor, .. } = &mut self.text.source else {
            return;
        };
        let selection = keys::selected(ui, id(), editor);
        let cursor = selection.end as u32;
        match command {
            TextCommand::Undo | TextCommand::Redo => travel(ui, editor, command),
            TextCommand::Comment => {
                keys::toggle_comment(ui, id(), editor);
            }
            TextCommand::Rename => return self.ask_for_name(ui),
            TextCommand::FixAll => {
                let fixed = rewrite(editor, cursor, |analysis| {
                    Ok::<_, Infallible>(analysis.fix_all().0)
                });
                return self.note_written(fixed);
            }
            TextCommand::Format => {
                let range = Span::new(selection.start as u32, cursor);
                let range = (range.start < range.end).then_some(range);
                let formatted = rewrite(editor, cursor, |analysis| {
                    Ok::<_, Infallible>(analysis.format(range))
                });
                return self.note_written(formatted);
            }
        }
        editor.wants_keys = true;
        self.has_edited();
    }

    /// Applies a fix of the text that was compiled last.
    pub(super) fn apply(&mut self, fix: &Fix) {
        let TextSource::File { editor, .. } = &mut self.text.source else {
            return;
        };
        // The ranges of a text that is being typed differ until it has been compiled.
        if editor.text != *self.model.program.text {
            return;
        }
        let edit = Edit::replace(fix.span, fix.replacement.as_str());
        let fixed = rewrite(editor, fix.span.end, |_| Ok::<_, Infallible>(vec![edit]));
        self.note_written(fixed);
    }
}

/// Undoes the last edit of the text, or redoes it.
fn travel(ui: &Ui, editor: &mut Editor, command: TextCommand) {
    super::code::remember(ui, id(), &mut editor.replaced);
    let mut state = TextEditState::load(ui.ctx(), id()).unwrap_or_default();
    let present = (
        state.cursor.char_range().unwrap_or_default(),
        editor.text.clone(),
    );
    let mut undoer = state.undoer();
    let other = match command {
        TextCommand::Undo => undoer.undo(&present).cloned(),
        _ => undoer.redo(&present).cloned(),
    };
    if let Some((cursor, text)) = other {
        state.cursor.set_char_range(Some(cursor));
        state.set_undoer(undoer);
        state.store(ui.ctx(), id());
        editor.text = text;
    }
}
