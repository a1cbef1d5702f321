//! Handles the events of the window's parts.

use std::path::PathBuf;

use protocol::{Command, Event, ViewName};
use render::ViewId;
use session::StatusMessage;
use session::pane::Pane;

use super::event::WindowEvent;
use super::{Next, TextSource, Window};
use crate::engine::compiler::{CompiledText, CompilerEvent};
use crate::engine::render_thread::{Purpose, RenderEvent};
use crate::io::file_dialogs::{self, FileChoice};
use crate::io::link::LinkEvent;
use crate::io::watch::ChangedFile;
use crate::ui::panes::settings::SettingsTab;

/// The beginning of the sentence about a file that is gone or is no text.
const UNREADABLE: &str = "the file cannot be read";

impl Window {
    /// Handles all events that have arrived. Returns whether there were any.
    pub(super) fn handle_events(&mut self) -> bool {
        let mut any = false;
        while let Ok(event) = self.events.receiver.try_recv() {
            self.handle_event(event);
            any = true;
        }
        any
    }

    pub(super) fn handle_event(&mut self, event: WindowEvent) {
        match event {
            WindowEvent::Compiler(event) => self.take_compiler_event(event),
            WindowEvent::Render(event) => self.take_rendered(*event),
            WindowEvent::Measured(answer) => crate::ui::measure::take(self, *answer),
            WindowEvent::File(changed) => self.take_changed(changed),
            WindowEvent::Link(event) => self.take_link_event(event),
            WindowEvent::Texture(read) => {
                if let Some(sentence) = self.pictures.library.take(read) {
                    self.status_message = Some(StatusMessage::error(sentence));
                }
            }
            WindowEvent::FileChoice(choice) => self.take_file_choice(choice),
            WindowEvent::Status(message) => self.status_message = Some(message),
        }
    }

    fn take_compiler_event(&mut self, event: CompilerEvent) {
        let version = match &event {
            CompilerEvent::Compiled(text) => text.compiled.program.version,
            CompilerEvent::Rerun { version, .. } => *version,
        };
        match event {
            // Of a program that is no longer shown.
            _ if version <= self.text.begins_after => {}
            CompilerEvent::Compiled(text) => {
                self.take_compiled(text);
                self.open_wanted();
            }
            CompilerEvent::Rerun { scene, .. } => {
                self.model.take_rerun(scene);
                self.text.painter.mark(self.model.faults.findings());
            }
        }
    }

    fn take_link_event(&mut self, event: LinkEvent) {
        match event {
            LinkEvent::Command(command) => self.obey(command),
            LinkEvent::Show { view, version } => self.show_view(view, version),
            LinkEvent::Disconnected(reason) => {
                if let TextSource::Attached { disconnected, .. } = &mut self.text.source {
                    *disconnected = Some(reason);
                }
            }
        }
    }

    fn take_file_choice(&mut self, choice: FileChoice) {
        match choice {
            FileChoice::Images(paths) => self.open_images(paths),
            FileChoice::Target(path) => self.dialogs.take_path(&path),
            FileChoice::Program(path) => self.go_on(Next::File(path)),
            FileChoice::NoDialogForProgram => {
                self.status_message = Some(StatusMessage::error(file_dialogs::NO_DIALOG));
                crate::ui::dialogs::program::ask_for_file(self);
            }
            FileChoice::NoDialogForImages => {
                self.status_message = Some(StatusMessage::error(file_dialogs::NO_DIALOG));
                self.panes.bring_forward(&Pane::Settings);
                self.panes.settings_tab = SettingsTab::Objects;
                self.dialogs.wants_image = true;
            }
        }
    }

    fn take_compiled(&mut self, text: CompiledText) {
        self.records.counters.compiled += 1;
        self.text.reports.note_compiled(&text);
        let compiled = text.compiled;
        let fresh = compiled.scene.is_some();
        let first = self.model.scene.is_none();
        self.pictures.library.look_again();
        self.model.take(compiled);
        self.display.clock.note_text();
        self.text.painter.mark(self.model.faults.findings());
        if !fresh {
            return;
        }
        // A camera that the user has not moved sees everything of a new scene too.
        self.model.reframe();
        let has_inside = |name: &String| {
            let object = self.model.object(name);
            object.is_some_and(|(_, object)| object.shape.has_inside())
        };
        if !self.focus.surface.as_ref().is_some_and(has_inside) {
            self.focus.surface = self.model.surfaces().into_iter().next();
        }
        let offered = self.offered();
        if !offered.contains(&self.focus.view) {
            self.focus.view = ViewId::of_scene(self.views.first().name());
        }
        let wanted: Vec<ViewId> = offered
            .iter()
            .filter(|id| self.is_wanted(id))
            .cloned()
            .collect();
        self.panes.follow(&offered, &wanted, self.model.program.ok);
        if !self.model.is_unseen_in(self.views.first()) {
            self.panes.bring_back_first();
        } else if first {
            // A view that a scene does not need is not shown.
            self.panes.leave_out_first();
            let mut of_objects = offered.iter().filter(|id| id.object.is_some());
            if let Some(id) = of_objects.next()
                && !self.panes.has_first()
            {
                self.activate(id);
            }
        }
    }

    fn take_rendered(&mut self, event: RenderEvent) {
        match event {
            RenderEvent::Drawn {
                pane,
                picture,
                space_camera,
                request,
                counters,
            } => {
                self.records.counters.pictures += 1;
                self.records.counters.drawn = counters.pictures;
                self.records.counters.sampled = counters.sampled;
                self.records.counters.pipelines = counters.pipelines;
                self.records.counters.followed = counters.followed;
                self.records.counters.worlds = counters.worlds;
                self.records.counters.rays = counters.rays;
                self.records.counters.traced = counters.traced;
                self.take_picture(&pane, picture, space_camera, &request);
                let shown = self.pictures.shown(&pane).and_then(|it| it.detail.samples);
                let samples = &mut self.records.counters.samples;
                match shown {
                    Some(shown) => samples.insert(pane.to_string(), shown),
                    None => samples.remove(&pane.to_string()),
                };
            }
            RenderEvent::Picked {
                request,
                hit,
                snapped,
                purpose,
            } => {
                match purpose {
                    Purpose::Pointer(_) => {
                        crate::ui::measure::take_snap(self, snapped);
                        if hit.is_none() {
                            crate::ui::measure::point_at_nothing(self);
                        }
                    }
                    _ => self.pictures.render_thread.note_answer(),
                }
                if let Some(hit) = hit {
                    self.take_hit(&request, &hit, purpose);
                }
            }
            RenderEvent::Framed(home) => {
                self.pictures.render_thread.note_answer();
                if let Some(home) = home {
                    self.model.frame_everything(&home);
                }
            }
        }
    }

    fn take_changed(&mut self, changed: ChangedFile) {
        let TextSource::File { editor, .. } = &mut self.text.source else {
            return;
        };
        // It was in transit when another program replaced its own.
        if changed.path != editor.path {
            return;
        }
        match changed.text {
            Ok(text) => {
                self.status_message
                    .take_if(|it| it.text.starts_with(UNREADABLE));
                if editor.take_changed(text) {
                    self.text.compile();
                }
            }
            Err(reason) => {
                editor.note_gone();
                let sentence =
                    format!("{UNREADABLE} ({reason}); its last text is kept here, not saved");
                self.status_message = Some(StatusMessage::error(sentence));
            }
        }
    }

    fn obey(&mut self, command: Command) {
        match command {
            Command::Text {
                uri: new,
                path: place,
                ..
            } => {
                let TextSource::Attached { uri, path, .. } = &mut self.text.source else {
                    return;
                };
                if *uri != new {
                    *uri = new;
                    *path = place.map(PathBuf::from);
                    if let Some(path) = path.clone() {
                        self.remember(path);
                        self.take_appearance();
                    }
                }
            }
            Command::Cursor { version, offset } if version == self.model.program.version => {
                let name = self.model.declared_at(offset).map(str::to_owned);
                self.model.highlight(name);
            }
            Command::Close => self.display.closing = true,
            // A cursor in a text that is no longer shown; and commands that are handled where messages are read
            // (`io/link.rs`).
            _ => {}
        }
    }

    /// Shows a view of the text of a version.
    fn show_view(&mut self, view: Option<ViewName>, version: Option<i32>) {
        self.display.raise = true;
        let first = ViewId::of_scene(self.views.first().name());
        let Some(ViewName { view, surface }) = view else {
            // A scene of which the first view shows nothing is shown without it.
            if self.panes.has_first() {
                self.bring_forward(&Pane::View(first));
            }
            return;
        };
        let known = self.views.get(&view);
        if let Some(other) = known.and_then(|known| known.instead_of()) {
            if let Some(name) = surface {
                self.model.look_through(&name);
            }
            self.model.set_traced(true);
            return self.bring_forward(&Pane::View(ViewId::of_scene(other)));
        }
        if self.can_be_traced(&ViewId::of_scene(&view)) {
            self.model.set_traced(false);
        }
        let known = self.views.get(&view);
        match known.map(|known| (known.is_of_object(), surface)) {
            Some((true, Some(name))) => {
                let wanted = ViewId::of_object(&view, &name);
                self.text.reports.wanted_view = Some((wanted, version));
                self.open_wanted();
            }
            Some((false, _)) => self.bring_forward(&Pane::View(ViewId::of_scene(&view))),
            _ => self.bring_forward(&Pane::View(first)),
        }
    }

    /// Opens the view of an object that was requested by name, once the text that may declare the object has been read.
    fn open_wanted(&mut self) {
        let (read, version) = (self.model.read, self.model.program.version);
        let is_read = |wanted: &mut (ViewId, Option<i32>)| {
            read && wanted.1.is_none_or(|wanted| wanted <= version)
        };
        let Some((wanted, _)) = self.text.reports.wanted_view.take_if(is_read) else {
            return;
        };
        let mut offered = self.offered();
        if offered.contains(&wanted) {
            self.bring_forward(&Pane::View(wanted));
            return;
        }
        offered.retain(|id| id.kind == wanted.kind);
        let names: Vec<String> = offered.into_iter().filter_map(|id| id.object).collect();
        let known = match names.len() {
            0 => "the program has none".to_owned(),
            _ => format!("the program has {}", names.join(", ")),
        };
        let errors = if self.model.program.ok {
            ""
        } else {
            ", and errors"
        };
        let view = self.views.get(&wanted.kind);
        let kind = view.and_then(render::view::View::object_kind);
        let (kind, name) = (kind.unwrap_or("object"), wanted.object.unwrap_or_default());
        let text = format!("There is no {kind} `{name}`: {known}{errors}.");
        self.status_message = Some(StatusMessage::error(text.clone()));
        self.text.send(Event::Message { error: true, text });
    }
}

#[cfg(test)]
mod tests {
    use ide::Languages;
    use render::Views;

    use super::*;

    #[test]
    fn what_was_read_of_another_file_does_not_become_the_text() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("here.gtr");
        std::fs::write(&path, "define a = 1;").expect("written");
        let (context, languages) = (egui::Context::default(), Languages::standard());
        let window = Window::of_file(&context, &languages, Views::standard(), path.clone(), false);
        let mut window = window.expect("the file is there");
        let changed = |path: PathBuf| ChangedFile {
            path,
            text: Ok("define b = 2;".to_owned()),
        };
        window.take_changed(changed(folder.path().join("before.gtr")));
        assert_eq!(window.text(), Some("define a = 1;"));
        window.take_changed(changed(path));
        assert_eq!(window.text(), Some("define b = 2;"));
    }

    #[test]
    fn the_text_of_a_deleted_file_is_not_lost_on_closing() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("here.gtr");
        std::fs::write(&path, "define a = 1;").expect("written");
        let (context, languages) = (egui::Context::default(), Languages::standard());
        let window = Window::of_file(&context, &languages, Views::standard(), path.clone(), false);
        let mut window = window.expect("the file is there");
        std::fs::remove_file(&path).expect("removed");
        window.take_changed(ChangedFile {
            path: path.clone(),
            text: crate::io::watch::read(&path),
        });
        assert!(window.title().starts_with('*'), "{}", window.title());
        window.go_on(Next::Close);
        assert!(!window.display.closing && window.dialogs.leaving == Some(Next::Close));
        let sentence = window.text.rescue().expect("a rescue");
        let rescued = folder.path().join("here.unsaved.gtr");
        assert!(sentence.contains("here.unsaved.gtr"), "{sentence}");
        let rescued = std::fs::read_to_string(rescued).expect("the rescued text");
        assert_eq!(rescued, "define a = 1;");
        window.save_text();
        assert!(!window.text.has_unsaved() && path.exists());
    }
}
