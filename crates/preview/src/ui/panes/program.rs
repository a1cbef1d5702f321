//! The program: in a window of its own the text, to be edited; its status in any.

use std::sync::Arc;

use egui::text::{CCursor, CCursorRange};
use egui::text_edit::TextEditState;
use egui::{Align, FontId, Rect, ScrollArea, TextEdit, Ui};
use syntax::span::Span;

use crate::ui::highlighting::severity_colour;
use crate::ui::window::{TextSource, Window};

/// Draws the pane.
pub(super) fn show(window: &mut Window, ui: &mut Ui) {
    let margin = egui::Frame::new().inner_margin(6.0);
    margin.show(ui, |ui| {
        if matches!(window.text.source, TextSource::File { .. }) {
            let changed = bar(window, ui);
            let room = (ui.available_height() - 110.0).max(60.0);
            let edited = ScrollArea::vertical()
                .id_salt("text")
                .max_height(room)
                .min_scrolled_height(room)
                .auto_shrink(false)
                .show(ui, |ui| text(window, ui))
                .inner;
            if edited || changed {
                window.text.compile();
            }
        }
        findings(window, ui);
    });
}

/// The file and what can be done with it; whether the text was replaced.
fn bar(window: &mut Window, ui: &mut Ui) -> bool {
    let mut changed = false;
    let TextSource::File { editor, .. } = &mut window.text.source else {
        return false;
    };
    if editor.conflict.is_some() {
        ui.horizontal_wrapped(|ui| {
            let colour = ui.visuals().warn_fg_color;
            ui.colored_label(
                colour,
                "The file has changed on disk, and so has this text.",
            );
            if ui.button("Take the file's").clicked() {
                changed = editor.settle(true);
            }
            if ui.button("Keep this one").clicked() {
                changed = editor.settle(false);
            }
        });
    }
    let mut save = false;
    ui.horizontal(|ui| {
        save = ui
            .add_enabled(editor.is_changed(), egui::Button::new("Save"))
            // Dialogs have a button of this name too.
            .accessible_name("Save program")
            .on_hover_text("Ctrl+S")
            .clicked();
        if editor.is_changed() {
            ui.weak("not saved");
        }
        // The name alone: a folder's would decide how wide the text is.
        let name = editor.path.file_name().unwrap_or_default();
        let name = egui::Label::new(name.to_string_lossy()).truncate();
        ui.add(name)
            .on_hover_text(editor.path.display().to_string());
    });
    if save {
        window.save_text();
    }
    changed
}

/// The text with line numbers; whether it was edited.
fn text(window: &mut Window, ui: &mut Ui) -> bool {
    let TextSource::File { editor, .. } = &mut window.text.source else {
        return false;
    };
    let font = egui::TextStyle::Monospace.resolve(ui.style());
    let lines = editor.text.matches('\n').count() + 1;
    let digits = lines.to_string().len().max(2);
    let width = font.size * 0.65 * digits as f32 + 8.0;
    let painter = &mut window.text.painter;
    let language = Arc::clone(&editor.language);
    let edited = ui
        .horizontal_top(|ui| {
            let gutter = ui.allocate_space(egui::vec2(width, 1.0)).1;
            let mut layouter = |ui: &Ui, buffer: &dyn egui::TextBuffer, width: f32| {
                painter.layout(ui, &*language, buffer.as_str(), width)
            };
            let id = egui::Id::unique("program text");
            remember(ui, id, &mut editor.replaced);
            let output = TextEdit::multiline(&mut editor.text)
                .id(id)
                .font(egui::TextStyle::Monospace)
                .desired_width(f32::INFINITY)
                .desired_rows(12)
                .layouter(&mut layouter)
                .show(ui);
            let response = &output.response.response;
            response.clone().accessible_name("Program text");
            numbers(ui, &output.galley, output.galley_pos, gutter, &font);
            if let Some(jump) = editor.jump.take() {
                let range = characters(&editor.text, jump.place);
                let mut state = output.state.clone();
                state.cursor.set_char_range(Some(range));
                state.store(ui.ctx(), id);
                if jump.takes_keys {
                    ui.ctx().memory_mut(|memory| memory.request_focus(id));
                }
                let place = output.galley.pos_from_cursor(range.primary);
                let place = place.translate(output.galley_pos.to_vec2());
                ui.scroll_to_rect(place, Some(Align::Center));
            }
            let cursor = output.cursor_range.map(|range| range.primary.index.0);
            (response.changed(), cursor)
        })
        .inner;
    let (edited, cursor) = edited;
    if let Some(cursor) = cursor {
        let offset = byte(&editor.text, cursor);
        let under = window.model.declared_at(offset).map(str::to_owned);
        if window.model.highlighted != under {
            window.model.highlighted = under;
            ui.ctx().request_repaint();
        }
    }
    edited
}

/// Puts texts whose place another one has taken among what the field can undo, which sees only what is typed into it.
fn remember(ui: &Ui, id: egui::Id, replaced: &mut Vec<String>) {
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

/// The status, and below it what was found; a click shows the place.
fn findings(window: &mut Window, ui: &mut Ui) {
    let status = window.model.status();
    let colour = if window.model.ok || !window.model.read {
        ui.visuals().text_color()
    } else {
        ui.visuals().error_fg_color
    };
    ui.colored_label(colour, status);
    let dark = ui.visuals().dark_mode;
    let mut jump: Option<Span> = None;
    ScrollArea::vertical()
        .id_salt("findings")
        .auto_shrink(false)
        .show(ui, |ui| {
            for finding in window.model.findings.iter().take(100) {
                let text = format!("{}:{}: {}", finding.line, finding.column, finding.message);
                let text = egui::RichText::new(text).color(severity_colour(finding.severity, dark));
                let link = ui.link(text);
                let link = match &finding.hint {
                    Some(hint) => link.on_hover_text(hint),
                    None => link,
                };
                if link.clicked() {
                    jump = Some(finding.span);
                }
            }
        });
    if let Some(span) = jump {
        window.open_place(span);
    }
}

/// A range of bytes in characters.
fn characters(text: &str, span: Span) -> CCursorRange {
    let index = |offset: u32| {
        let before = text.get(..offset as usize).unwrap_or(text);
        CCursor::new(egui::text::CharIndex(before.chars().count()))
    };
    CCursorRange::two(index(span.start), index(span.end))
}

fn byte(text: &str, character: usize) -> u32 {
    let at = text.char_indices().nth(character);
    at.map_or(text.len(), |(at, _)| at) as u32
}
