//! What the window tells the server, and what it asks of the text.

use std::collections::BTreeMap;

use protocol::Event;
use syntax::span::Span;

use super::{TextSource, Window};
use crate::engine::editor::Jump;
use crate::state::StatusMessage;
use crate::state::pane::{Pane, PaneKey};

impl Window {
    /// Tells the server what is on the screen now.
    pub(super) fn tell(&mut self) {
        let on_screen = |pane: &PaneKey, version: i32| {
            !self.waiting.contains(pane)
                || self
                    .pictures
                    .get(pane)
                    .is_some_and(|it| it.version >= version)
        };
        if let Some((version, ok, arrived)) = self.shown
            && (!ok || self.seen.keys().all(|pane| on_screen(pane, version)))
        {
            self.shown = None;
            self.counters.version = version;
            self.say(Event::Shown {
                version,
                ok,
                milliseconds: arrived.elapsed().as_secs_f64() * 1e3,
                painting: self.painting.as_secs_f64() * 1e3,
            });
        }
        if matches!(self.source, TextSource::Attached { .. })
            && let (Some(scene), Some(settings)) = (self.model.scene.clone(), self.model.settings())
        {
            let params = scene.params.iter();
            let values: BTreeMap<String, Vec<f64>> = params
                .map(|param| (param.name.clone(), settings.param(param).to_vec()))
                .collect();
            if values != self.told_values {
                self.told_values.clone_from(&values);
                self.say(Event::Values {
                    version: self.model.version,
                    values,
                });
            }
        }
    }

    /// Tells the server something, if there is one.
    pub(crate) fn say(&self, event: Event) {
        if let TextSource::Attached {
            link,
            disconnected: None,
            ..
        } = &self.source
        {
            link.say(event);
        }
    }

    /// A param's value is to stand in the text.
    pub(crate) fn write_param(&mut self, name: &str) {
        let (Some(scene), Some(settings)) = (self.model.scene.clone(), self.model.settings())
        else {
            return;
        };
        let Some(param) = scene.params.iter().find(|param| param.name == name) else {
            return;
        };
        let value = settings.param(param).to_vec();
        match &mut self.source {
            TextSource::Attached { .. } => self.say(Event::Write {
                version: self.model.version,
                param: name.to_owned(),
                value,
            }),
            TextSource::File { editor, .. } => match editor.write_param(name, &value) {
                Ok(true) => self.compile_own(),
                Ok(false) => {}
                Err(sentence) => self.status_message = Some(StatusMessage::error(sentence)),
            },
        }
    }

    /// The declaration of a name is to be shown to the user, as it stands in the text now, and to have the keys.
    pub(crate) fn open_declaration(&mut self, name: &str) {
        if let Some(place) = self.model.place_of(name) {
            self.open(place, true);
        }
    }

    /// The same for one click, which may have been meant for the view: in this window the keys stay where they are, and
    /// so do the panes.
    pub(super) fn show_declaration(&mut self, name: &str) {
        let Some(place) = self.model.place_of(name) else {
            return;
        };
        self.model.highlighted = Some(name.to_owned());
        if matches!(self.source, TextSource::Attached { .. }) || self.panes.is_open(&Pane::Program)
        {
            self.open(place, false);
        }
    }

    /// A place of the text is to be shown to the user, and to have the keys.
    pub(crate) fn open_place(&mut self, place: Span) {
        self.open(place, true);
    }

    fn open(&mut self, place: Span, takes_keys: bool) {
        match &mut self.source {
            TextSource::Attached { .. } => self.say(Event::Open {
                version: self.model.version,
                range: [place.start, place.end],
            }),
            TextSource::File { editor, .. } => {
                editor.jump = Some(Jump { place, takes_keys });
                self.panes.bring_forward(&Pane::Program);
            }
        }
    }
}
