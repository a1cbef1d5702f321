//! The keys that do more than type: brackets in pairs, indentation, comments, and the list of completions.

use std::ops::Range;

use egui::text::CCursorRange;
use egui::text_edit::TextEditState;
use egui::{Event, Id, Key, Modifiers, Ui};
use session::editor::Editor;
use session::typing;

use super::code::{byte, characters};
use super::completion::Assistant;

/// The keys that move the cursor or change the text around it.
const MOVING: [Key; 12] = [
    Key::ArrowLeft,
    Key::ArrowRight,
    Key::ArrowUp,
    Key::ArrowDown,
    Key::Home,
    Key::End,
    Key::PageUp,
    Key::PageDown,
    Key::Enter,
    Key::Tab,
    Key::Backspace,
    Key::Delete,
];

/// Handles the keys that the field does not know, and rewrites events for it where more happens than typing. Returns
/// whether the text was edited.
pub(super) fn take(ui: &Ui, id: Id, editor: &mut Editor, assistant: &mut Assistant) -> bool {
    if !ui.memory(|memory| memory.has_focus(id)) || ui.ctx().current_pass_index() > 0 {
        return false;
    }
    let mut edited = assistant.take_keys(ui, id, editor);
    let comments = ui.input_mut(|input| input.consume_key(Modifiers::COMMAND, Key::Slash));
    if comments {
        edited |= toggle_comment(ui, id, editor);
    }
    if assistant.is_writing {
        let pressed = |modifiers| ui.input_mut(|it| it.consume_key(modifiers, Key::Tab));
        // The plain shortcut also matches with Shift, which is therefore checked first.
        if pressed(Modifiers::SHIFT) {
            change_lines(ui, id, editor, typing::unindent);
            edited = true;
        } else if pressed(Modifiers::NONE) {
            change_lines(ui, id, editor, typing::indent);
            edited = true;
        }
    }
    let selection = selected(ui, id, editor);
    let mut typist = Typist::new(&editor.text, selection);
    ui.input_mut(|input| {
        let events = std::mem::take(&mut input.events);
        for event in events {
            typist.take(event, &mut input.events);
        }
    });
    assistant.note_typing(typist.has_typed_word);
    edited
}

/// Comments out the selected lines, or uncomments them. Returns whether the language has comments.
pub(super) fn toggle_comment(ui: &Ui, id: Id, editor: &mut Editor) -> bool {
    let Some(mark) = editor.language.line_comment() else {
        return false;
    };
    change_lines(ui, id, editor, |text, selection| {
        typing::toggle_comment(text, selection, mark)
    });
    true
}

/// Changes the text based on its selection, and sets the selection that `change` returns.
fn change_lines(
    ui: &Ui,
    id: Id,
    editor: &mut Editor,
    change: impl FnOnce(&str, Range<usize>) -> (String, Range<usize>),
) {
    let (text, selection) = change(&editor.text, selected(ui, id, editor));
    editor.replace(text);
    select(ui, id, characters(&editor.text, selection));
}

/// Returns the selection in bytes; empty at the cursor if nothing is selected.
pub(super) fn selected(ui: &Ui, id: Id, editor: &Editor) -> Range<usize> {
    let state = TextEditState::load(ui.ctx(), id).unwrap_or_default();
    let range = state.cursor.char_range().unwrap_or_default();
    let [a, b] = [range.primary, range.secondary].map(|at| byte(&editor.text, at.index.0));
    a.min(b)..a.max(b)
}

/// Returns the range of all characters of a text.
pub(super) fn everything(text: &str) -> CCursorRange {
    characters(text, 0..text.len())
}

/// Selects a range of characters.
pub(super) fn select(ui: &Ui, id: Id, range: CCursorRange) {
    let mut state = TextEditState::load(ui.ctx(), id).unwrap_or_default();
    state.cursor.set_char_range(Some(range));
    state.store(ui.ctx(), id);
}

/// Rewrites the events of a frame. The field handles them one after the other, so the result is right even if several
/// arrive at once.
struct Typist<'t> {
    text: &'t str,
    /// The selection before the frame's events.
    selection: Range<usize>,
    /// The brackets that were closed automatically in this frame and directly follow the cursor.
    closed: Vec<char>,
    /// True if the cursor has moved otherwise than by typing in this frame.
    is_lost: bool,
    has_typed_word: bool,
}

impl<'t> Typist<'t> {
    fn new(text: &'t str, selection: Range<usize>) -> Self {
        Self {
            text,
            selection,
            closed: Vec::new(),
            is_lost: false,
            has_typed_word: false,
        }
    }

    /// Handles an event, and passes on the events for the field.
    fn take(&mut self, event: Event, events: &mut Vec<Event>) {
        match &event {
            Event::Text(typed) => {
                let mut characters = typed.chars();
                let first = characters.next().filter(|_| characters.next().is_none());
                let last = typed.chars().next_back();
                self.has_typed_word = last.is_some_and(char::is_alphanumeric);
                if let Some(first) = first.filter(|_| !self.is_lost)
                    && self.bracket(first, events)
                {
                    return;
                }
            }
            Event::Key {
                key,
                pressed: true,
                modifiers,
                ..
            } => {
                let plain = modifiers.is_none() && !self.is_lost && self.closed.is_empty();
                if *key == Key::Enter && plain {
                    let indent = typing::indentation(self.text, self.selection.start);
                    if !indent.is_empty() {
                        events.push(Event::Text(format!("\n{indent}")));
                        return;
                    }
                }
                if *key == Key::Backspace && plain && self.is_between_brackets() {
                    events.push(press(Key::Delete));
                }
                // On a Mac, Ctrl is not the command key, and Ctrl with a letter moves the cursor.
                self.is_lost |= modifiers.command || modifiers.ctrl || MOVING.contains(key);
            }
            Event::Paste(_) | Event::Cut | Event::PointerButton { .. } | Event::Ime(_) => {
                self.is_lost = true;
            }
            _ => {}
        }
        events.push(event);
    }

    /// Handles a typed bracket. Returns false if it is to be inserted as it is.
    fn bracket(&mut self, typed: char, events: &mut Vec<Event>) -> bool {
        let next = self.closed.last().copied();
        let behind = self.text[self.selection.end..].chars().next();
        if let Some(close) = typing::closing(typed) {
            if !self.selection.is_empty() {
                let selected = &self.text[self.selection.clone()];
                events.push(Event::Text(format!("{typed}{selected}{close}")));
                self.is_lost = true;
                return true;
            }
            if typing::closes_before(next.or(behind)) {
                events.push(Event::Text(format!("{typed}{close}")));
                events.push(press(Key::ArrowLeft));
                self.closed.push(close);
                return true;
            }
        } else if typing::is_closing(typed) && self.selection.is_empty() {
            if next == Some(typed) {
                self.closed.pop();
                events.push(press(Key::ArrowRight));
                return true;
            }
            if next.is_none() && behind == Some(typed) {
                self.is_lost = true;
                events.push(press(Key::ArrowRight));
                return true;
            }
        }
        false
    }

    /// Returns whether there is nothing between the bracket before the cursor and its closing partner.
    fn is_between_brackets(&self) -> bool {
        let before = self.text[..self.selection.start].chars().next_back();
        let behind = self.text[self.selection.end..].chars().next();
        self.selection.is_empty() && behind.is_some() && before.and_then(typing::closing) == behind
    }
}

/// Returns the event of a pressed key.
fn press(key: Key) -> Event {
    Event::Key {
        key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: Modifiers::NONE,
    }
}
