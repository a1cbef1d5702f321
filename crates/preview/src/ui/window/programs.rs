//! Switches the program that is shown: to a file, a new one, or none initially.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::Context;
use ide::Languages;
use render::{ViewId, Views};
use session::editor::Editor;
use session::{Choices, StatusMessage};

use super::Window;
use super::event::{WindowEvent, WindowEvents};
use super::text::{SAVED, TextSource, WindowText};
use crate::Failure;
use crate::engine::compiler::Compiler;
use crate::engine::saving;
use crate::engine::textures::turn_to;
use crate::io::path_list::PathList;
use crate::io::persistence::{self, Known, ViewStore};
use crate::io::settings::SharedSettings;
use crate::io::watch::Watch;
use crate::ui::panes::Panes;

/// The name of a new program until it is saved.
pub(crate) const UNTITLED: &str = "Untitled";

/// The step after the current program, if the program may be closed.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) enum Next {
    /// Close the window.
    Close,
    /// Open a file.
    File(PathBuf),
    /// Start a new program.
    New {
        /// Its name until it is saved, without an extension.
        name: &'static str,
        text: &'static str,
    },
}

impl Window {
    /// Returns a window without a program: it offers new programs, recent ones, and the examples.
    ///
    /// # Errors
    /// [`Failure::NoThread`].
    pub fn welcome(
        context: &Context,
        languages: &Languages,
        views: Views,
    ) -> Result<Self, Failure> {
        let events = WindowEvents::new(context.clone());
        let compiler = Compiler::start(events.sender.for_part(WindowEvent::Compiler))?;
        let editor = untitled(languages, UNTITLED, "");
        let source = TextSource::File {
            editor: Box::new(editor),
            _watch: None,
        };
        let text = WindowText::new(source, compiler, languages.clone());
        let mut window = Self::new(views, events, text)?;
        window.panes.is_welcome = true;
        window.text.compile();
        Ok(window)
    }

    /// Returns a window for a file's text, which it edits and, with `watched`, follows on disk.
    ///
    /// # Errors
    /// [`Failure::Unreadable`], [`Failure::NoThread`].
    pub fn of_file(
        context: &Context,
        languages: &Languages,
        views: Views,
        path: PathBuf,
        watched: bool,
    ) -> Result<Self, Failure> {
        let text = crate::io::watch::read(&path).map_err(|reason| Failure::Unreadable {
            path: path.clone(),
            reason: reason.to_string(),
        })?;
        let mut window = Self::welcome(context, languages, views)?;
        window.show_file(path, text, watched);
        Ok(window)
    }

    /// Starts to keep the lists of recent programs and images in a folder, and reads the settings for all programs from
    /// there.
    pub fn remember_paths_in(&mut self, folder: &Path) {
        self.records.recent = PathList::programs(folder);
        self.pictures.library.source.opened = PathList::images(folder);
        self.records.settings = SharedSettings::in_folder(folder);
        if !self.remembers_views() {
            // The saved state of a program that is already open must not be used.
            self.records.view_store = None;
            self.model.turn_to(Choices::default());
        }
        self.take_appearance();
        self.note_recent();
    }

    /// Gives the window the theme and the scale that were last chosen in any window.
    pub(super) fn take_appearance(&mut self) {
        let settings = self.records.settings.now();
        let mut choices = self.model.choices.clone();
        let preferences = &mut choices.preferences;
        preferences.theme = settings.theme.unwrap_or(preferences.theme);
        preferences.scale = settings.scale.unwrap_or(preferences.scale);
        self.records.appearance = Some((preferences.theme, preferences.scale));
        if choices != self.model.choices {
            self.model.turn_to(choices);
        }
    }

    /// Saves the theme and the scale for all programs, if they have changed since the program was opened.
    pub(super) fn keep_appearance(&mut self) {
        let preferences = &self.model.choices.preferences;
        let now = (preferences.theme, preferences.scale);
        let before = self.records.appearance.replace(now);
        if before.is_some_and(|before| before != now) {
            self.records.settings.change(|settings| {
                settings.theme = Some(now.0);
                settings.scale = Some(now.1);
            });
        }
    }

    /// Returns whether views are saved beside programs.
    pub(crate) fn remembers_views(&self) -> bool {
        self.records.settings.now().remembers_views
    }

    /// Sets whether views are saved beside programs: from now on, in this window and in all that are opened later.
    pub(crate) fn remember_views(&mut self, on: bool) {
        self.records
            .settings
            .change(|settings| settings.remembers_views = on);
        self.records.view_store = None;
        let is_new = matches!(&self.text.source, TextSource::File { editor, .. } if editor.is_new);
        if let Some(path) = self.text.file().filter(|_| !is_new) {
            // The layouts of other kinds of windows are kept.
            let known = persistence::read(&path).unwrap_or_default();
            self.keep_view_of(path, known);
        }
    }

    /// Starts to save the view of a program, if views are saved; `known` is the state that is already saved.
    pub(super) fn keep_view_of(&mut self, program: PathBuf, known: Known) {
        if self.remembers_views() {
            let store = ViewStore::start(program, known, self.events.status());
            self.records.view_store = Some(store);
        }
    }

    fn note_recent(&mut self) {
        if let TextSource::File { editor, .. } = &self.text.source
            && !editor.is_new
        {
            self.records.recent.note(&editor.path);
        }
    }

    /// Takes the next step; if unsaved text would be lost, the user is asked first.
    pub(crate) fn go_on(&mut self, next: Next) {
        if self.text.has_unsaved() {
            self.dialogs.leaving = Some(next);
        } else {
            self.take_next(next);
        }
    }

    /// Takes the next step, without regard to unsaved text.
    pub(crate) fn take_next(&mut self, next: Next) {
        match next {
            Next::Close => self.display.closing = true,
            Next::File(path) => match crate::io::watch::read(&path) {
                Ok(text) => self.show_file(path, text, true),
                Err(reason) => {
                    self.records.recent.forget(&path);
                    let sentence = format!("cannot read `{}`: {reason}", path.display());
                    self.status_message = Some(StatusMessage::error(sentence));
                }
            },
            Next::New { name, text } => {
                let editor = untitled(&self.text.languages, name, text);
                self.show_editor(editor, None);
            }
        }
    }

    fn show_file(&mut self, path: PathBuf, text: String, watched: bool) {
        let watch = if watched {
            let events = self.events.sender.for_part(WindowEvent::File);
            Watch::start(&path, text.clone(), events).map(Some)
        } else {
            Ok(None)
        };
        let language = Arc::clone(self.text.languages.for_path(&path));
        let editor = Editor::new(language, path.clone(), text);
        let (watch, trouble) = match watch {
            Ok(watch) => (watch, None),
            Err(reason) => (None, Some(format!("the file is not watched: {reason}"))),
        };
        self.show_editor(editor, watch);
        self.remember(path);
        self.take_appearance();
        if let Some(sentence) = trouble {
            self.status_message = Some(StatusMessage::error(sentence));
        }
        self.note_recent();
    }

    /// Replaces the text that is shown by an editor; nothing of the previous program is left.
    fn show_editor(&mut self, mut editor: Editor, watch: Option<Watch>) {
        // Results for the previous program are recognised by their lower version.
        let version = self.text.next_program();
        editor.version = version;
        self.text.source = TextSource::File {
            editor: Box::new(editor),
            _watch: watch,
        };
        let sender = &self.events.sender;
        // If no new thread can be started, the previous program's continues.
        if let Ok(compiler) = Compiler::start(sender.for_part(WindowEvent::Compiler)) {
            self.text.compiler = compiler;
        }
        self.records.view_store = None;
        self.forget_click();
        // First the program: choices for it would have it run again.
        self.model.forget_program();
        let preferences = self.model.choices.preferences.clone();
        self.model.turn_to(Choices {
            preferences,
            ..Choices::default()
        });
        let first = ViewId::of_scene(self.views.first().name());
        self.focus.view.clone_from(&first);
        self.focus.surface = None;
        self.panes = Panes::new(first, true);
        crate::ui::measure::close(self);
        turn_to(&mut self.pictures.library, None);
        self.pictures.forget_all();
        self.status_message = None;
        self.text.compile();
    }

    /// Saves the own text and takes the next step, unless saving fails; a new program needs a name first.
    pub(crate) fn save_text_and(&mut self, next: Next) {
        match &self.text.source {
            TextSource::File { editor, .. } if editor.is_new => {
                crate::ui::dialogs::program::ask_for_target(self, Some(next));
            }
            _ => {
                self.save_text();
                if !self.text.has_unsaved() {
                    self.take_next(next);
                }
            }
        }
    }

    /// Writes the own text to another file, and follows that one from then on.
    ///
    /// # Errors
    /// A sentence; nothing has changed.
    pub(crate) fn save_text_as(&mut self, path: PathBuf) -> Result<(), String> {
        let TextSource::File { editor, _watch } = &mut self.text.source else {
            return Ok(());
        };
        saving::save_as(editor, path.clone())?;
        editor.language = Arc::clone(self.text.languages.for_path(&path));
        let events = self.events.sender.for_part(WindowEvent::File);
        // A file that is not watched is checked before it is overwritten.
        *_watch = Watch::start(&path, editor.text_of_file().into_owned(), events).ok();
        turn_to(&mut self.pictures.library, path.parent());
        self.keep_view_of(path, Known::default());
        self.status_message = Some(StatusMessage::info(SAVED));
        self.note_recent();
        self.text.compile();
        Ok(())
    }
}

/// Returns an editor of a program that has no file yet.
fn untitled(languages: &Languages, name: &str, text: &str) -> Editor {
    let language = languages.default_language();
    let extension = language.extensions().first().unwrap_or(&"txt");
    let name = format!("{name}.{extension}");
    Editor::untitled(Arc::clone(language), &name, text.to_owned())
}
