//! What the threads have told the window.

use std::path::PathBuf;

use protocol::{Command, Event, View};

use super::{Origin, Window};
use crate::artist::Answer;
use crate::compiler::Compiled;
use crate::mail::Letter;
use crate::model::Step;
use crate::orders::PaneKey;
use crate::panes::Pane;
use crate::watch::Unreadable;

impl Window {
    /// Reads all that has come; whether there was any.
    pub(super) fn read_letters(&mut self) -> bool {
        let mut any = false;
        while let Ok(letter) = self.letters.try_recv() {
            self.read_letter(letter);
            any = true;
        }
        any
    }

    pub(super) fn read_letter(&mut self, letter: Letter) {
        match letter {
            Letter::Compiled(compiled) => {
                self.take_compiled(compiled);
                self.open_wanted();
            }
            Letter::Artist(answer) => self.take_answer(*answer),
            Letter::Changed { text } => self.take_changed(text),
            Letter::Server(command) => self.obey(command),
            Letter::Show { view, version } => self.show_view(view, version),
            Letter::Parted(parting) => {
                if let Origin::Attached { parted, .. } = &mut self.origin {
                    *parted = Some(parting);
                }
            }
            Letter::Texture { path, texture } => {
                if let Err(sentence) = &texture {
                    self.said = Some((true, sentence.clone()));
                }
                self.library.take(path, texture);
            }
            Letter::Images(paths) => self.open_images(paths),
            Letter::Chosen(path) => self.dialogs.take_path(&path),
            Letter::NoDialogForImages => {
                self.said = Some((true, crate::desktop::NO_DIALOG.to_owned()));
                self.panes.bring_forward(&Pane::Settings);
                self.dialogs.wants_image = true;
            }
            Letter::Say { error, text } => self.said = Some((error, text)),
        }
    }

    fn take_compiled(&mut self, compiled: Compiled) {
        self.counters.compiled += 1;
        self.painter.mark(&compiled.findings);
        self.shown = Some((compiled.version, compiled.ok, compiled.arrived));
        let fresh = compiled.scene.is_some();
        let first = self.model.scene.is_none();
        self.model.take(compiled);
        if !fresh {
            return;
        }
        // A camera that nobody has moved shows everything of a new scene too.
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

    fn take_answer(&mut self, answer: Answer) {
        match answer {
            Answer::Drawn {
                pane,
                picture,
                order,
                counters,
            } => {
                self.counters.pictures += 1;
                self.counters.drawn = counters.pictures;
                self.counters.sampled = counters.sampled;
                self.counters.pipelines = counters.pipelines;
                self.counters.geodesic_kernels = counters.geodesic_kernels;
                self.counters.looks = counters.looks;
                let sent = self.sent.get(&pane);
                if sent.is_some_and(|sent| sent.is_like(&order)) {
                    self.waiting.remove(&pane);
                }
                match picture {
                    Ok(drawing) => self.take_drawing(pane, *drawing, &order),
                    Err(sentence) => {
                        let picture = self.picture(pane, &order);
                        picture.error = Some(sentence);
                        picture.version = order.version;
                    }
                }
            }
            Answer::Picked {
                scene,
                hit: Some(hit),
                purpose,
                camera,
            } => self.take_hit(&scene, &hit, purpose, camera),
            Answer::Picked { hit: None, .. } => {}
            Answer::Framed(home) => {
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
        let Origin::File { editor, .. } = &mut self.origin else {
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
                self.said = Some((true, sentence));
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
                let Origin::Attached { uri, path, .. } = &mut self.origin else {
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
            Some(View::Geodesic { surface }) => {
                self.wanted = Some((surface, version));
                self.open_wanted();
            }
            // A scene of metrics alone is shown without it.
            None if !self.panes.is_open(&Pane::Space) => {}
            Some(View::Space) | None => self.bring_forward(&Pane::Space),
        }
    }

    /// Opens the view of a surface that was asked for by name, once the text that may declare it has been read.
    fn open_wanted(&mut self) {
        let (read, version) = (self.model.read, self.model.version);
        let is_read = |wanted: &mut (String, Option<i32>)| {
            read && wanted.1.is_none_or(|wanted| wanted <= version)
        };
        let Some((surface, _)) = self.wanted.take_if(is_read) else {
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
        self.said = Some((true, text.clone()));
        self.say(Event::Message { error: true, text });
    }
}
