//! Renaming the name at the cursor: a bar above the text asks for the new name.

use egui::{Key, TextEdit, Ui};
use ide::rename::RenameError;
use session::StatusMessage;
use session::pane::Pane;

use super::code::id;
use super::{commands, keys};
use crate::ui::icons::{self, Icon};
use crate::ui::window::{TextSource, Window, WindowText};

/// The beginning of the sentence about a cursor that is at no name that can be renamed.
pub(crate) const NOT_RENAMED: &str = "not renamed";

/// A renaming in progress.
#[derive(Debug)]
pub(crate) struct Rename {
    /// An occurrence of the name in the text, in bytes.
    at: u32,
    name: String,
    wanted: String,
    /// The reason why the last wanted name is not possible.
    refusal: Option<String>,
    /// True if the field is to get the focus, with all of its text selected.
    wants_focus: bool,
}

impl Window {
    /// Opens the bar for the name at the cursor of the text, or reports why it cannot be renamed.
    pub(crate) fn ask_for_name(&mut self, ui: &Ui) {
        let TextSource::File { editor, .. } = &self.text.source else {
            return;
        };
        self.status_message
            .take_if(|it| it.text.starts_with(NOT_RENAMED));
        let at = keys::selected(ui, id(), editor).end as u32;
        match editor.language.read(&editor.text).prepare_rename(at) {
            Ok((_, name)) => {
                self.panes.bring_forward(&Pane::Program);
                self.text.rename = Some(Rename {
                    at,
                    wanted: name.clone(),
                    name,
                    refusal: None,
                    wants_focus: true,
                });
            }
            Err(refusal) => {
                let sentence = format!("{NOT_RENAMED}: {refusal}");
                self.status_message = Some(StatusMessage::error(sentence));
            }
        }
    }
}

/// Shows the bar, if it is open. Returns whether the text was edited.
pub(super) fn show(text: &mut WindowText, ui: &mut Ui) -> bool {
    let (Some(rename), TextSource::File { editor, .. }) = (&mut text.rename, &mut text.source)
    else {
        return false;
    };
    let (mut is_given, mut closes) = (false, false);
    ui.horizontal_wrapped(|ui| {
        let label = ui.label(format!("Rename `{}` to", rename.name));
        let mut field = TextEdit::singleline(&mut rename.wanted)
            .desired_width(110.0)
            .show(ui);
        let response = field.response.response.labelled_by(label.id);
        if std::mem::take(&mut rename.wants_focus) {
            response.request_focus();
            let all = keys::everything(&rename.wanted);
            field.state.cursor.set_char_range(Some(all));
            field.state.store(ui.ctx(), response.id);
        }
        if response.changed() {
            rename.refusal = None;
        }
        if response.lost_focus() {
            let [enter, escape] =
                ui.input(|input| [Key::Enter, Key::Escape].map(|key| input.key_pressed(key)));
            is_given = enter;
            closes = escape;
        }
        is_given |= ui.small_button("Rename").clicked();
        let close = (Icon::Close, "Do not rename", "Close (Escape)");
        closes |= icons::button(ui, close.0, false, close.1, close.2).clicked();
    });
    let mut edited = false;
    if is_given {
        let given = commands::rewrite(editor, rename.at, |analysis| {
            // The text may have been edited since the bar was opened.
            let (_, name) = analysis.prepare_rename(rename.at)?;
            match name == rename.name {
                true => analysis.rename(rename.at, &rename.wanted),
                false => Err(RenameError::NoName),
            }
        });
        match given {
            Ok(changed) => (edited, closes) = (changed, true),
            Err(refusal) => {
                rename.refusal = Some(refusal);
                rename.wants_focus = true;
            }
        }
    }
    if let Some(refusal) = &rename.refusal {
        ui.colored_label(ui.visuals().error_fg_color, refusal);
    }
    if closes {
        text.rename = None;
        editor.wants_keys = true;
    }
    edited
}
