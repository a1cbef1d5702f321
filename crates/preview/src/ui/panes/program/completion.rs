//! The editor's completion and hover: a list of words that can be written at the cursor, and the description of a word.
//!
//! Both are based on the text as the compiler's thread has read it: a list is created once the text that is being typed
//! has been read.

use egui::text_edit::TextEditOutput;
use egui::{
    Align2, Area, Button, Event, Frame, Id, Key, Modifiers, Order, Rect, RichText, ScrollArea, Ui,
};
use ide::completion::Completion;
use ide::description::Description;
use session::editor::Editor;
use session::model::ReadText;
use syntax::span::Span;

use super::code::{byte, characters};

/// The width of the list in points, that of its parts other than text, and the maximum widths of a letter
/// in entries and in details.
const WIDTH: f32 = 260.0;
const MARGIN: f32 = 24.0;
const LETTER: f32 = 8.0;
const SMALL_LETTER: f32 = 5.5;
/// The number of letters of a word after which the list opens by itself.
const LETTERS: usize = 2;
/// The maximum number of entries in the list.
const LISTED: usize = 50;

/// The state of completion and hover between two frames.
#[derive(Debug, Default)]
pub(crate) struct Assistant {
    list: Option<List>,
    /// Set if a list is to be created once the typed text has been read.
    wanted: Option<Trigger>,
    /// True if the user writes in the text, rather than having reached it by Tab: then Tab indents.
    pub(super) is_writing: bool,
    /// The last description: the version of the text, the offset of the word, its description.
    described: Option<(i32, u32, Option<Description>)>,
}

/// The reason why a list is created.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Trigger {
    /// A word is being typed.
    Typing,
    /// The user has requested it.
    Key,
}

/// A list that is open.
#[derive(Debug)]
struct List {
    /// The part of the word that has been written, in bytes.
    range: Span,
    entries: Vec<Completion>,
    selected: usize,
    /// True if the user has requested the list, or has moved through it: then Enter accepts the selected entry.
    is_in_use: bool,
    /// The entry that was clicked.
    clicked: Option<usize>,
    /// The rectangle of the cursor on the screen.
    place: Rect,
}

impl Assistant {
    /// Returns whether a list is open.
    pub(crate) fn is_open(&self) -> bool {
        self.list.is_some()
    }

    /// Notes whether a letter of a word has been typed.
    pub(super) fn note_typing(&mut self, is_word: bool) {
        if is_word {
            self.wanted = Some(self.wanted.unwrap_or(Trigger::Typing));
        }
    }

    /// Handles the keys of the list. Returns whether the text was edited.
    pub(super) fn take_keys(&mut self, ui: &Ui, id: Id, editor: &mut Editor) -> bool {
        let pressed = |modifiers, key| ui.input_mut(|input| input.consume_key(modifiers, key));
        if pressed(Modifiers::COMMAND, Key::Space) || pressed(Modifiers::CTRL, Key::Space) {
            self.wanted = Some(Trigger::Key);
            // Some systems also send the space.
            ui.input_mut(|input| {
                let is_space = |event: &Event| matches!(event, Event::Text(text) if text == " ");
                input.events.retain(|event| !is_space(event));
            });
        }
        let Some(list) = &mut self.list else {
            return false;
        };
        let count = list.entries.len();
        let down = pressed(Modifiers::NONE, Key::ArrowDown);
        let up = pressed(Modifiers::NONE, Key::ArrowUp);
        if down || up {
            list.is_in_use = true;
            let step = if down { 1 } else { count - 1 };
            list.selected = (list.selected + step) % count;
        }
        if pressed(Modifiers::NONE, Key::Escape) {
            self.list = None;
            return false;
        }
        // If single letters are names, Enter ends a line more often than it completes a word.
        let takes = pressed(Modifiers::NONE, Key::Tab)
            || (list.is_in_use && pressed(Modifiers::NONE, Key::Enter));
        let chosen = list.clicked.take().or(takes.then_some(list.selected));
        match chosen {
            Some(chosen) => self.write(chosen, ui, id, editor),
            None => false,
        }
    }

    /// Inserts an entry of the list. Returns whether it was possible.
    fn write(&mut self, chosen: usize, ui: &Ui, id: Id, editor: &mut Editor) -> bool {
        self.wanted = None;
        let Some(mut list) = self.list.take() else {
            return false;
        };
        let range = list.range.start as usize..list.range.end as usize;
        if chosen >= list.entries.len() || editor.text.get(range.clone()).is_none() {
            return false;
        }
        let entry = list.entries.swap_remove(chosen);
        let mut text = editor.text.clone();
        text.replace_range(range.clone(), &entry.insert);
        let end = range.start + entry.insert.len();
        editor.replace(text);
        super::keys::select(ui, id, characters(&editor.text, end..end));
        true
    }

    /// Returns the description of the word at an offset of the text.
    pub(super) fn describe(&mut self, read: &ReadText, offset: u32) -> Option<&Description> {
        let known = self.described.as_ref();
        if known.is_none_or(|known| (known.0, known.1) != (read.version, offset)) {
            let found = read
                .analysis
                .hover(offset)
                .map(|(_, description)| description);
            self.described = Some((read.version, offset, found));
        }
        self.described.as_ref()?.2.as_ref()
    }

    /// Updates the list for the cursor. `read` is the current text, once it has been read.
    fn follow(&mut self, editor: &Editor, read: Option<&ReadText>, cursor: u32) {
        // The whole word has been erased, or the cursor has left it.
        self.list
            .take_if(|list| cursor <= list.range.start && list.range.end > list.range.start);
        if let Some(list) = self.list.take_if(|list| list.range.end != cursor) {
            self.wanted = Some(self.wanted.unwrap_or(Trigger::Typing));
            self.list = list.narrowed(&editor.text, cursor);
        }
        if let Some(read) = read
            && let Some(trigger) = self.wanted.take()
        {
            self.update(editor, read, cursor, trigger);
        }
    }

    /// Creates the list of words that can be written at an offset.
    fn update(&mut self, editor: &Editor, read: &ReadText, cursor: u32, trigger: Trigger) {
        let before = self.list.take();
        let found = read.analysis.completions(cursor, false);
        let range = found.range;
        let written = editor.text.get(range.start as usize..cursor as usize);
        let Some(written) = written.filter(|_| range.end == cursor) else {
            return;
        };
        let entries = fitting(found.list, written);
        let is_whole = entries.iter().any(|entry| entry.label == written);
        let is_long = written.chars().count() >= LETTERS;
        let is_requested = trigger == Trigger::Key;
        let goes_on = before
            .as_ref()
            .is_some_and(|it| it.range.start == range.start);
        if entries.is_empty() || (!is_requested && (is_whole || !(is_long || goes_on))) {
            return;
        }
        let was_in_use = goes_on && before.as_ref().is_some_and(|it| it.is_in_use);
        let selected = before.filter(|_| goes_on).map_or(0, |before| {
            position(&entries, &before.entries[before.selected].label)
        });
        self.list = Some(List {
            range,
            selected,
            is_in_use: is_requested || was_in_use,
            entries,
            clicked: None,
            place: Rect::NOTHING,
        });
    }
}

impl List {
    /// Returns the list's entries for the word up to the cursor, before the text has been read again; `None` if there
    /// are none.
    fn narrowed(mut self, text: &str, cursor: u32) -> Option<Self> {
        let written = text.get(self.range.start as usize..cursor as usize)?;
        let selected = self.entries[self.selected].label.clone();
        self.entries = fitting(self.entries, written);
        self.selected = position(&self.entries, &selected);
        self.range.end = cursor;
        (!self.entries.is_empty()).then_some(self)
    }
}

/// Returns the index of the entry with a label, or 0 if there is none.
fn position(entries: &[Completion], label: &str) -> usize {
    let found = entries.iter().position(|entry| entry.label == label);
    found.unwrap_or(0)
}

/// Returns the entries that start with the written text; those that match case come first.
fn fitting(entries: Vec<Completion>, written: &str) -> Vec<Completion> {
    let lower = written.to_lowercase();
    let mut fitting: Vec<Completion> = entries
        .into_iter()
        .filter(|entry| entry.label.to_lowercase().starts_with(&lower))
        .collect();
    fitting.sort_by_key(|entry| !entry.label.starts_with(written));
    fitting.truncate(LISTED);
    fitting
}

/// Shows the list at the cursor, if one is open or wanted. `read` is the current text, once it has been read.
pub(super) fn show(
    ui: &Ui,
    output: &TextEditOutput,
    editor: &mut Editor,
    assistant: &mut Assistant,
    read: Option<&ReadText>,
) {
    let is_pointed_at = is_pointed_at(ui);
    let response = &output.response.response;
    match output.cursor_range {
        Some(range) if range.is_empty() && (response.has_focus() || is_pointed_at) => {
            let cursor = byte(&editor.text, range.primary.index.0) as u32;
            assistant.follow(editor, read, cursor);
            if let Some(list) = &mut assistant.list {
                let place = output.galley.pos_from_cursor(range.primary);
                list.place = place.translate(output.galley_pos.to_vec2());
            }
        }
        // A click on the list takes the focus from the field before the list has handled it.
        None if is_pointed_at => {}
        _ => {
            assistant.list = None;
            assistant.wanted = None;
        }
    }
    if let Some(list) = &mut assistant.list {
        popup(ui, list);
        if list.clicked.is_some() {
            // The field gets the focus again, and inserts the entry in the frame after that.
            editor.wants_keys = true;
            ui.ctx().request_repaint();
        }
    }
}

/// Returns the detail beside an entry, shortened to the available room: the entry itself is always shown in full.
fn beside(entry: &Completion) -> String {
    let label = LETTER * entry.label.chars().count() as f32;
    let room = ((WIDTH - MARGIN - label) / SMALL_LETTER).max(0.0) as usize;
    let count = entry.detail.chars().count();
    if count <= room {
        return entry.detail.clone();
    }
    let shown: String = entry.detail.chars().take(room.saturating_sub(1)).collect();
    match shown.trim_end() {
        "" => String::new(),
        shown => format!("{shown}…"),
    }
}

fn popup_id() -> Id {
    Id::unique("completions")
}

/// Returns whether the pointer is over the list: a press there takes the focus from the field.
fn is_pointed_at(ui: &Ui) -> bool {
    let place = ui.ctx().pointer_interact_pos();
    let layer = place.and_then(|place| ui.ctx().layer_id_at(place));
    layer.is_some_and(|layer| layer.id == popup_id())
}

fn popup(ui: &Ui, list: &mut List) {
    let place = list.place;
    let row = ui.spacing().interact_size.y;
    let screen = ui.ctx().content_rect();
    let rows = list.entries.len().min(8) as f32;
    let height = rows * (row + 2.0) + 12.0;
    // The list of errors may be below the text; it must not be covered.
    let below = ui.clip_rect().bottom().min(screen.bottom());
    let fits_above = place.top() - height >= screen.top();
    let is_above =
        place.bottom() + height > screen.bottom() || place.bottom() + height > below && fits_above;
    let (at, pivot) = match is_above {
        true => (place.left_top(), Align2::LEFT_BOTTOM),
        false => (place.left_bottom(), Align2::LEFT_TOP),
    };
    let area = Area::new(popup_id()).order(Order::Foreground);
    area.pivot(pivot).fixed_pos(at).show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).show(ui, |ui| {
            ui.set_width(WIDTH);
            let scroll = ScrollArea::vertical().max_height(height);
            scroll.show(ui, |ui| {
                for (k, entry) in list.entries.iter().enumerate() {
                    let is_selected = k == list.selected;
                    let detail = RichText::new(beside(entry)).weak().small();
                    let title = RichText::new(&entry.label).monospace();
                    let button = Button::selectable(is_selected, title)
                        .right_text(detail)
                        .truncate()
                        .min_size(egui::vec2(ui.available_width(), row));
                    let button = ui.add(button);
                    if is_selected {
                        button.scroll_to_me(None);
                    }
                    if button.accessible_name(&entry.label).clicked() {
                        list.clicked = Some(k);
                    }
                }
            });
        });
    });
}
