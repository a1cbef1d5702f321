//! The editor of the program's text.

use std::ops::Range;
use std::sync::Arc;

use egui::text::{CCursor, CCursorRange};
use egui::text_edit::{TextEditOutput, TextEditState};
use egui::{Align, EventFilter, FontId, Id, Rect, ScrollArea, Stroke, StrokeKind, TextEdit, Ui};
use session::editor::Editor;
use session::model::ReadText;
use session::typing;
use syntax::span::Span;

use super::{completion, find, keys, rename};
use crate::ui::window::{TextSource, Window};

/// Returns the id of the text field.
pub(crate) fn id() -> Id {
    Id::unique("program text")
}

/// Shows the text with line numbers, in the remaining room. Returns whether it was edited.
pub(super) fn show(window: &mut Window, ui: &mut Ui) -> bool {
    let mut replaced = find::show(&mut window.text, ui);
    replaced |= rename::show(&mut window.text, ui);
    let room = ui.available_height();
    let edited = ScrollArea::vertical()
        .id_salt("text")
        .max_height(room)
        .min_scrolled_height(room)
        .auto_shrink(false)
        .show(ui, |ui| text(window, ui, room))
        .inner;
    edited || replaced
}

fn text(window: &mut Window, ui: &mut Ui, room: f32) -> bool {
    let read = window.model.read_text();
    let text = &mut window.text;
    let TextSource::File { editor, .. } = &mut text.source else {
        return false;
    };
    let font = egui::TextStyle::Monospace.resolve(ui.style());
    let lines = editor.text.matches('\n').count() + 1;
    let digits = lines.to_string().len().max(2);
    let width = font.size * 0.65 * digits as f32 + 8.0;
    let before = editor.version;
    let undone = steps_back(ui).then(|| editor.text.clone());
    let by_keys = keys::take(ui, id(), editor, &mut text.assistant);
    let (painter, assistant) = (&mut text.painter, &mut text.assistant);
    let language = Arc::clone(&editor.language);
    let output = ui.horizontal_top(|ui| {
        let gutter = ui.allocate_space(egui::vec2(width, 1.0)).1;
        let mut layouter = |ui: &Ui, buffer: &dyn egui::TextBuffer, width: f32| {
            painter.layout(ui, &*language, buffer.as_str(), width)
        };
        remember(ui, id(), &mut editor.replaced);
        let field = TextEdit::multiline(&mut editor.text)
            .id(id())
            .font(egui::TextStyle::Monospace)
            .desired_width(f32::INFINITY)
            .min_size(egui::vec2(0.0, room - ui.spacing().item_spacing.y))
            .layouter(&mut layouter);
        // While a list is open, these keys belong to the list; Escape also to the search. Tab moves to the next control
        // until something is typed.
        let filter = EventFilter {
            tab: assistant.is_open() || assistant.is_writing,
            escape: assistant.is_open() || text.find.is_open(),
            ..field.get_event_filter()
        };
        let output = field.event_filter(filter).show(ui);
        let response = &output.response.response;
        response.clone().accessible_name("Program text");
        numbers(ui, &output.galley, output.galley_pos, gutter, &font);
        output
    });
    let output = output.inner;
    let edited = output.response.response.changed() || by_keys;
    let response = &output.response.response;
    assistant.is_writing |= edited || response.clicked();
    assistant.is_writing &= response.has_focus();
    // A field loses the focus in a frame in which something else is clicked: it gets it after that.
    let is_clicked = ui.input(|input| input.pointer.any_click());
    if let Some(before) = undone.filter(|before| *before != editor.text) {
        let at = change_end(&before, &editor.text);
        let cursor = characters(&editor.text, at..at);
        keys::select(ui, id(), cursor);
        ui.scroll_to_rect(place_of(&output, cursor.primary), None);
    }
    // The list of errors may have hidden the line that is being written.
    let known = ui.data_mut(|data| std::mem::replace(data.get_temp_mut_or(id(), room), room));
    if room < known - 1.0
        && response.has_focus()
        && let Some(range) = output.cursor_range
    {
        ui.scroll_to_rect(place_of(&output, range.primary), None);
    }
    if !is_clicked && let Some(jump) = editor.jump.take() {
        editor.wants_keys |= jump.takes_keys;
        go_to(ui, &output, &editor.text, jump.place);
    }
    if !is_clicked && std::mem::take(&mut editor.wants_keys) {
        ui.ctx().memory_mut(|memory| memory.request_focus(id()));
    } else if editor.wants_keys || editor.jump.is_some() {
        ui.ctx().request_repaint();
    }
    find::mark(ui, &output, &editor.text, &text.find);
    let read = read.filter(|it| it.version == before && !edited);
    completion::show(ui, &output, editor, assistant, read.as_ref());
    if let Some(read) = &read {
        hover(&output, &editor.text, read, assistant);
    }
    if let Some(range) = output.cursor_range {
        let cursor = byte(&editor.text, range.primary.index.0);
        brackets(ui, &output, editor, cursor);
        let under = window.model.declared_at(cursor as u32).map(str::to_owned);
        if window.model.highlighted != under {
            window.model.highlight(under);
            ui.ctx().request_repaint();
        }
    }
    edited
}

/// Returns whether the field is to undo or redo. This puts the cursor where it was before the change, which may be far
/// from the change itself.
fn steps_back(ui: &Ui) -> bool {
    let has_keys = ui.memory(|memory| memory.has_focus(id()));
    has_keys
        && ui.input(|input| {
            let command = input.modifiers.command;
            command && (input.key_pressed(egui::Key::Z) || input.key_pressed(egui::Key::Y))
        })
}

/// Returns the end of the part of a text, in bytes, that differs from the previous one.
fn change_end(before: &str, after: &str) -> usize {
    let common = |a: &mut dyn Iterator<Item = char>, b: &mut dyn Iterator<Item = char>| {
        let pairs = a.zip(b).take_while(|(x, y)| x == y);
        pairs.map(|(x, _)| x.len_utf8()).sum::<usize>()
    };
    let start = common(&mut before.chars(), &mut after.chars());
    let [old, new] = [before, after].map(|text| text[start..].chars().rev());
    let (mut old, mut new) = (old, new);
    after.len() - common(&mut old, &mut new)
}

/// Adds replaced texts to the field's undo history, which records only what is typed into it.
pub(super) fn remember(ui: &Ui, id: Id, replaced: &mut Vec<String>) {
    if replaced.is_empty() {
        return;
    }
    let mut state = TextEditState::load(ui.ctx(), id).unwrap_or_default();
    let cursor = state.cursor.char_range().unwrap_or_default();
    let mut undoer = state.undoer();
    for text in replaced.drain(..) {
        undoer.add_undo(&(cursor, text));
    }
    state.set_undoer(undoer);
    state.store(ui.ctx(), id);
}

/// Selects a range and scrolls to it.
fn go_to(ui: &Ui, output: &TextEditOutput, text: &str, place: Span) {
    let Span { start, end } = place;
    let range = characters(text, start as usize..end as usize);
    let mut state = output.state.clone();
    state.cursor.set_char_range(Some(range));
    state.store(ui.ctx(), id());
    ui.scroll_to_rect(place_of(output, range.primary), Some(Align::Center));
}

/// Returns the rectangle of a character on the screen.
fn place_of(output: &TextEditOutput, cursor: CCursor) -> Rect {
    let place = output.galley.pos_from_cursor(cursor);
    place.translate(output.galley_pos.to_vec2())
}

fn numbers(ui: &Ui, galley: &egui::Galley, at: egui::Pos2, gutter: Rect, font: &FontId) {
    let clip = ui.clip_rect();
    let mut line = 1;
    let mut begins = true;
    for row in &galley.rows {
        let top = at.y + row.rect().top();
        if begins && top <= clip.bottom() && top + row.rect().height() >= clip.top() {
            let place = egui::pos2(gutter.right() - 4.0, top);
            let colour = ui.visuals().weak_text_color();
            let text = line.to_string();
            ui.painter()
                .text(place, egui::Align2::RIGHT_TOP, text, font.clone(), colour);
        }
        begins = row.ends_with_newline;
        line += usize::from(begins);
    }
}

/// Frames the bracket at the cursor and its partner.
fn brackets(ui: &Ui, output: &TextEditOutput, editor: &Editor, cursor: usize) {
    let comment = editor.language.line_comment();
    let Some(places) = typing::partners(&editor.text, cursor, comment) else {
        return;
    };
    let stroke = Stroke::new(1.0, ui.visuals().weak_text_color());
    for at in places {
        for rect in rects(output, &editor.text, at..at + 1) {
            ui.painter()
                .rect_stroke(rect, 2.0, stroke, StrokeKind::Inside);
        }
    }
}

/// Shows the description of the word under the resting pointer.
fn hover(
    output: &TextEditOutput,
    text: &str,
    read: &ReadText,
    assistant: &mut completion::Assistant,
) {
    let response = &output.response.response;
    let Some(pointer) = response.hover_pos().filter(|_| !assistant.is_open()) else {
        return;
    };
    let place = pointer - output.galley_pos;
    let cursor = output.galley.cursor_from_pos(place);
    let near = output.galley.pos_from_cursor(cursor);
    let is_on_text = near
        .expand2(egui::vec2(12.0, 2.0))
        .contains(place.to_pos2());
    let offset = byte(text, cursor.index.0) as u32;
    if !is_on_text {
        return;
    }
    if let Some(description) = assistant.describe(read, offset) {
        let response = response.clone();
        response.on_hover_ui_at_pointer(|ui| {
            ui.set_max_width(420.0);
            ui.monospace(&description.code);
            for paragraph in &description.text {
                ui.label(paragraph.replace(['`', '*'], ""));
            }
        });
    }
}

/// Returns the rectangles that mark a range of bytes on the screen. A range over several rows is marked in its first row.
pub(super) fn rects(output: &TextEditOutput, text: &str, range: Range<usize>) -> Vec<Rect> {
    let range = characters(text, range);
    // At a row break, a range starts on the next row.
    let first = CCursor {
        prefer_next_row: true,
        ..range.secondary
    };
    let [start, end] = [first, range.primary].map(|cursor| place_of(output, cursor));
    if (start.top() - end.top()).abs() < 1.0 {
        return vec![Rect::from_min_max(start.left_top(), end.right_bottom())];
    }
    // A range over several rows is marked in the first one, up to the edge.
    let edge = egui::pos2(output.text_clip_rect.right(), start.bottom());
    vec![Rect::from_min_max(start.left_top(), edge)]
}

/// Converts a range of bytes to characters, with the cursor at its end.
pub(super) fn characters(text: &str, range: Range<usize>) -> CCursorRange {
    let index = |offset: usize| {
        let before = text.get(..offset).unwrap_or(text);
        CCursor::new(egui::text::CharIndex(before.chars().count()))
    };
    CCursorRange::two(index(range.start), index(range.end))
}

/// Converts a character index to a byte offset.
pub(super) fn byte(text: &str, character: usize) -> usize {
    let at = text.char_indices().nth(character);
    at.map_or(text.len(), |(at, _)| at)
}
