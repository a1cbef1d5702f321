//! The events of the window's parts, taken over.

use std::path::PathBuf;

use protocol::{Command, Event, View};

use super::event::WindowEvent;
use super::{TextSource, Window};
use crate::engine::render_thread::RenderEvent;
use crate::io::file_dialogs::{self, FileChoice};
use crate::io::link::LinkEvent;
use crate::io::watch::Unreadable;
use crate::state::pane::{Pane, PaneKey};
use crate::state::{Compiled, StatusMessage, Step};

impl Window {
    /// Takes over all events that have come; returns whether there were any.
    pub(super) fn handle_events(&mut self) -> bool {
        let mut any = false;
        while let Ok(event) = self.events.try_recv() {
            self.handle_event(event);
            any = true;
        }
        any
    }

    pub(super) fn handle_event(&mut self, event: WindowEvent) {
        match event {
            WindowEvent::Compiled(compiled) => {
                self.take_compiled(compiled);
                self.open_wanted();
            }
            WindowEvent::Render(event) => self.take_rendered(*event),
            WindowEvent::File(text) => self.take_changed(text),
            WindowEvent::Link(event) => self.take_link_event(event),
            WindowEvent::Texture(read) => {
                if let Some(sentence) = self.library.take(read) {
                    self.status_message = Some(StatusMessage::error(sentence));
                }
            }
            WindowEvent::FileChoice(choice) => self.take_file_choice(choice),
            WindowEvent::Status(message) => self.status_message = Some(message),
        }
    }

    fn take_link_event(&mut self, event: LinkEvent) {
        match event {
            LinkEvent::Command(command) => self.obey(command),
            LinkEvent::Show { view, version } => self.show_view(view, version),
            LinkEvent::Disconnected(reason) => {
                if let TextSource::Attached { disconnected, .. } = &mut self.source {
                    *disconnected = Some(reason);
                }
            }
        }
    }

    fn take_file_choice(&mut self, choice: FileChoice) {
        match choice {
            FileChoice::Images(paths) => self.open_images(paths),
            FileChoice::Target(path) => self.dialogs.take_path(&path),
            FileChoice::NoDialogForImages => {
                self.status_message = Some(StatusMessage::error(file_dialogs::NO_DIALOG));
                self.panes.bring_forward(&Pane::Settings);
                self.dialogs.wants_image = true;
            }
        }
    }

    fn take_compiled(&mut self, compiled: Compiled) {
        self.counters.compiled += 1;
        self.painter.mark(&compiled.findings);
        self.reports.note_compiled(&compiled);
        let fresh = compiled.scene.is_some();
        let first = self.model.scene.is_none();
        self.model.take(compiled);
        if !fresh {
            return;
        }
        // A camera that the user has not moved shows everything of a new scene too.
        self.model.reframe();
        let surfaces = self.model.surfaces();
        let known = |name: &String| surfaces.contains(name);
        if !self.active_surface.as_ref().is_some_and(known) {
            self.active_surface = surfaces.first().cloned();
        }
        if let PaneKey::Inside(name) = &self.active
            && !surfaces.contains(name)
        {
            self.active = PaneKey::Space;
        }
        let (closed, ok) = (&self.model.view.closed, self.model.ok);
        self.panes.follow(&surfaces, closed, ok);
        if !self.model.has_only_metrics() {
            self.panes.bring_back_space();
        } else if first {
            // What a scene does not need is not shown.
            self.panes.leave_out_space();
            if let Some(name) = surfaces.into_iter().next()
                && !self.panes.is_open(&Pane::Space)
            {
                self.activate(&PaneKey::Inside(name));
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
                self.counters.pictures += 1;
                self.counters.drawn = counters.pictures;
                self.counters.sampled = counters.sampled;
                self.counters.pipelines = counters.pipelines;
                self.counters.looks = counters.looks;
                self.take_picture(&pane, picture, space_camera, &request);
            }
            RenderEvent::Picked {
                request,
                hit: Some(hit),
                purpose,
            } => self.take_hit(&request, &hit, purpose),
            RenderEvent::Picked { hit: None, .. } => {}
            RenderEvent::Framed(home) => {
                if let Some(camera) = self.model.view.space {
                    let step = Step::new("Frame everything", "");
                    let framed = camera.framed(&home);
                    self.model.change(step, |view| view.space = Some(framed));
                    self.model.history.settle();
                }
            }
        }
    }

    fn take_changed(&mut self, text: Result<String, Unreadable>) {
        let TextSource::File { editor, .. } = &mut self.source else {
            return;
        };
        match text {
            Ok(text) => {
                if editor.take_changed(text) {
                    self.compile_own();
                }
            }
            Err(reason) => {
                let sentence = format!("the file cannot be read ({reason}); its text is kept here");
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
                let TextSource::Attached { uri, path, .. } = &mut self.source else {
                    return;
                };
                if *uri != new {
                    *uri = new;
                    *path = place.map(PathBuf::from);
                    if let Some(path) = path.clone() {
                        self.remember(path);
                    }
                }
            }
            Command::Cursor { version, offset } if version == self.model.version => {
                self.model.highlighted = self.model.declared_at(offset).map(str::to_owned);
            }
            Command::Close => self.closing = true,
            _ => {}
        }
    }

    /// A view is to be seen of the text of a version.
    fn show_view(&mut self, view: Option<View>, version: Option<i32>) {
        self.raise = true;
        match view {
            Some(View {
                view,
                surface: Some(surface),
            }) if view == "geodesic" => {
                self.reports.wanted_view = Some((surface, version));
                self.open_wanted();
            }
            // A scene of metrics alone is shown without it.
            None if !self.panes.is_open(&Pane::Space) => {}
            _ => self.bring_forward(&Pane::Space),
        }
    }

    /// Opens the view of a surface that was asked for by name, once the text that may declare it has been read.
    fn open_wanted(&mut self) {
        let (read, version) = (self.model.read, self.model.version);
        let is_read = |wanted: &mut (String, Option<i32>)| {
            read && wanted.1.is_none_or(|wanted| wanted <= version)
        };
        let Some((surface, _)) = self.reports.wanted_view.take_if(is_read) else {
            return;
        };
        let surfaces = self.model.surfaces();
        if surfaces.contains(&surface) {
            self.open_inside(&surface);
            return;
        }
        let known = match surfaces.len() {
            0 => "the program has none".to_owned(),
            _ => format!("the program has {}", surfaces.join(", ")),
        };
        let errors = if self.model.ok { "" } else { ", and errors" };
        let text = format!("There is no surface or metric `{surface}`: {known}{errors}.");
        self.status_message = Some(StatusMessage::error(text.clone()));
        self.say(Event::Message { error: true, text });
    }
}
