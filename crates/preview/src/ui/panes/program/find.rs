//! The search in the text: a bar above it, and highlighted matches.

use egui::text_edit::TextEditOutput;
use egui::{Key, KeyboardShortcut, Modifiers, TextEdit, Ui};
use session::editor::{Editor, Jump};
use session::typing;
use syntax::span::Span;

use super::code::{self, rects};
use super::keys;
use crate::ui::icons::{self, Icon};
use crate::ui::window::{TextSource, Window, WindowText};

/// The most places that are marked.
const MOST_MARKED: usize = 1000;

/// The search.
#[derive(Debug, Default)]
pub(crate) struct Find {
    is_open: bool,
    /// True if the field is to get the focus.
    wants_focus: bool,
    wanted: String,
    replacement: String,
    /// The number of the current match, from 0.
    current: usize,
}

/// A step from one match to another.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Direction {
    Next,
    Previous,
}

impl Window {
    /// Handles the keys of the search.
    pub(crate) fn find_keys(&mut self, ui: &Ui) {
        let pressed = |modifiers, key| {
            let shortcut = KeyboardShortcut::new(modifiers, key);
            ui.input_mut(|input| input.consume_shortcut(&shortcut))
        };
        if pressed(Modifiers::COMMAND, Key::F) {
            self.open_find();
        }
        if !self.text.find.is_open {
            return;
        }
        let is_in_text = ui.memory(|memory| memory.has_focus(code::id()));
        if is_in_text && !self.text.assistant.is_open() && pressed(Modifiers::NONE, Key::Escape) {
            self.text.find.is_open = false;
        } else if pressed(Modifiers::SHIFT, Key::F3) {
            self.text.go(Direction::Previous);
        } else if pressed(Modifiers::NONE, Key::F3) {
            self.text.go(Direction::Next);
        }
    }

    /// Opens the search, which gets the focus.
    pub(crate) fn open_find(&mut self) {
        self.panes.bring_forward(&session::pane::Pane::Program);
        self.text.find.is_open = true;
        self.text.find.wants_focus = true;
    }
}

impl Find {
    /// Returns whether the bar is open.
    pub(super) fn is_open(&self) -> bool {
        self.is_open
    }
}

impl WindowText {
    /// Shows the next match, or the previous one.
    fn go(&mut self, direction: Direction) {
        let TextSource::File { editor, .. } = &mut self.source else {
            return;
        };
        let places = typing::find(&editor.text, &self.find.wanted);
        let count = places.len();
        if count == 0 {
            return;
        }
        let current = &mut self.find.current;
        *current = match direction {
            Direction::Next => (*current + 1) % count,
            Direction::Previous => (*current + count - 1) % count,
        };
        show_place(editor, &places[*current]);
    }
}

fn show_place(editor: &mut Editor, place: &std::ops::Range<usize>) {
    editor.jump = Some(Jump {
        place: Span::new(place.start as u32, place.end as u32),
        takes_keys: false,
    });
}

/// A request of the user in the row that finds.
#[derive(Clone, Copy)]
enum FindRequest {
    Go(Direction),
    Close,
}

/// Shows the bar, if it is open. Returns whether the text was edited.
pub(super) fn show(text: &mut WindowText, ui: &mut Ui) -> bool {
    if !text.find.is_open {
        return false;
    }
    let TextSource::File { editor, .. } = &mut text.source else {
        return false;
    };
    let find = &mut text.find;
    let places = typing::find(&editor.text, &find.wanted);
    find.current = find.current.min(places.len().saturating_sub(1));
    let request = ui.horizontal_wrapped(|ui| find_row(find, editor, places.len(), ui));
    let mut request = request.inner;
    let edited = ui.horizontal_wrapped(|ui| {
        let edited = replace_row(find, editor, &places, ui);
        let close = (Icon::Close, "Close the search", "Close (Escape)");
        if icons::button(ui, close.0, false, close.1, close.2).clicked() {
            request = Some(FindRequest::Close);
        }
        edited
    });
    match request {
        Some(FindRequest::Close) => {
            find.is_open = false;
            editor.wants_keys = true;
        }
        Some(FindRequest::Go(direction)) => text.go(direction),
        None => {}
    }
    edited.inner
}

/// Shows the field of the wanted text, the buttons of the matches, and their number.
fn find_row(
    find: &mut Find,
    editor: &mut Editor,
    count: usize,
    ui: &mut Ui,
) -> Option<FindRequest> {
    let mut request = None;
    let field = TextEdit::singleline(&mut find.wanted).hint_text("Find");
    let field = ui.add(field.desired_width(110.0));
    let field = field.accessible_name("Find");
    if std::mem::take(&mut find.wants_focus) {
        field.request_focus();
        // Typing replaces the word of the last search.
        keys::select(ui, field.id, keys::everything(&find.wanted));
    }
    if field.changed() {
        find.current = 0;
        let places = typing::find(&editor.text, &find.wanted);
        if let Some(first) = places.first() {
            show_place(editor, first);
        }
    }
    if field.lost_focus() {
        let [enter, escape, shift] = ui.input(|input| {
            let pressed = [Key::Enter, Key::Escape].map(|key| input.key_pressed(key));
            [pressed[0], pressed[1], input.modifiers.shift]
        });
        if enter {
            let back = Direction::Previous;
            let direction = if shift { back } else { Direction::Next };
            request = Some(FindRequest::Go(direction));
            field.request_focus();
        }
        if escape {
            request = Some(FindRequest::Close);
        }
    }
    let [up, down] = [
        (Icon::Up, "Previous place", "Previous (Shift+F3)"),
        (Icon::Down, "Next place", "Next (F3)"),
    ]
    .map(|(icon, name, hint)| icons::button(ui, icon, false, name, hint).clicked());
    if up {
        request = Some(FindRequest::Go(Direction::Previous));
    } else if down {
        request = Some(FindRequest::Go(Direction::Next));
    }
    find.wants_focus |= up || down;
    let number = match count {
        0 if find.wanted.is_empty() => String::new(),
        0 => "not found".to_owned(),
        _ => format!("{} of {count}", find.current + 1),
    };
    ui.label(number);
    request
}

/// Shows the field of the replacement and its buttons. Returns true if matches were replaced.
fn replace_row(
    find: &mut Find,
    editor: &mut Editor,
    places: &[std::ops::Range<usize>],
    ui: &mut Ui,
) -> bool {
    let field = TextEdit::singleline(&mut find.replacement).hint_text("Replace by");
    ui.add(field.desired_width(110.0))
        .accessible_name("Replace by");
    let any = !places.is_empty();
    let one = ui.add_enabled(any, egui::Button::new("Replace").small());
    let all = ui.add_enabled(any, egui::Button::new("Replace all").small());
    let replaced = if all.clicked() {
        places
    } else if one.clicked() {
        &places[find.current..=find.current]
    } else {
        &[]
    };
    let is_edited = !replaced.is_empty();
    if is_edited {
        let mut text = String::with_capacity(editor.text.len());
        let mut from = 0;
        for place in replaced {
            text.push_str(&editor.text[from..place.start]);
            text.push_str(&find.replacement);
            from = place.end;
        }
        text.push_str(&editor.text[from..]);
        editor.replace(text);
        // Undo, and the keys that follow, apply to the text.
        editor.wants_keys = true;
        let places = typing::find(&editor.text, &find.wanted);
        // The search continues after the replacement, which may contain the word itself.
        let behind = replaced[0].start + find.replacement.len();
        let next = places.iter().position(|place| place.start >= behind);
        find.current = next.unwrap_or(0);
        if let Some(next) = places.get(find.current) {
            show_place(editor, next);
        }
    }
    is_edited
}

/// Highlights the matches in the visible text.
pub(super) fn mark(ui: &Ui, output: &TextEditOutput, text: &str, find: &Find) {
    if !find.is_open {
        return;
    }
    let clip = ui.clip_rect();
    let colour = ui.visuals().warn_fg_color;
    let places = typing::find(text, &find.wanted).into_iter().enumerate();
    for (k, place) in places.filter(|(k, _)| *k < MOST_MARKED || *k == find.current) {
        let alpha = if k == find.current { 0.45 } else { 0.2 };
        for rect in rects(output, text, place) {
            if clip.intersects(rect) {
                let fill = colour.gamma_multiply(alpha);
                ui.painter().rect_filled(rect, 2.0, fill);
            }
        }
    }
}
