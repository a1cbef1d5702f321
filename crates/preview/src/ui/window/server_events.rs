//! The window's events for the server, and its changes of the text.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use protocol::Event;
use render::{PictureRequest, ViewId};
use scene::SolidLeaf;
use session::StatusMessage;
use session::editor::Jump;
use session::pane::Pane;
use syntax::span::Span;

use super::Window;
use super::pane_view::{PaneView, Waiting};
use super::text::TextSource;
use crate::engine::compiler::CompiledText;

/// The state of the reports to the server.
#[derive(Debug, Default)]
pub(super) struct ServerReports {
    /// A compiled text that has not been reported as shown yet.
    unshown: Option<ShownText>,
    /// The params' values that were reported last.
    values: BTreeMap<String, Vec<f64>>,
    /// A view of an object to be opened when the text of this version has been read.
    pub(super) wanted_view: Option<(ViewId, Option<i32>)>,
}

/// A compiled text.
#[derive(Clone, Copy, Debug)]
struct ShownText {
    version: i32,
    ok: bool,
    arrived: Instant,
}

impl ServerReports {
    /// Notes a compiled text, which is reported when its pictures are on the screen.
    pub(super) fn note_compiled(&mut self, text: &CompiledText) {
        self.unshown = Some(ShownText {
            version: text.compiled.program.version,
            ok: text.compiled.program.ok,
            arrived: text.arrived,
        });
    }
}

impl Window {
    /// Reports the current content of the screen to the server.
    pub(super) fn report_shown(&mut self) {
        let shows = |view: &PaneView, version: i32| {
            let picture = view.picture.as_ref();
            !view.on_screen
                || view.waiting == Waiting::No
                || picture.is_some_and(|it| it.version >= version)
        };
        if let Some(ShownText {
            version,
            ok,
            arrived,
        }) = self.text.reports.unshown
            && (!ok
                || self
                    .pictures
                    .of_views
                    .values()
                    .all(|view| shows(view, version)))
        {
            self.text.reports.unshown = None;
            self.records.counters.version = version;
            self.text.send(Event::Shown {
                version,
                ok,
                milliseconds: arrived.elapsed().as_secs_f64() * 1e3,
                painting: self.display.clock.painting.as_secs_f64() * 1e3,
            });
        }
        if !self.text.is_own()
            && let (Some(scene), Some(settings)) =
                (self.model.scene.clone(), self.model.param_values())
        {
            let params = scene.params.iter();
            let values: BTreeMap<String, Vec<f64>> = params
                .map(|param| (param.name.clone(), settings.param(param).to_vec()))
                .collect();
            if values != self.text.reports.values {
                self.text.reports.values.clone_from(&values);
                self.text.send(Event::Values {
                    version: self.model.program.version,
                    values,
                });
            }
        }
    }

    /// Writes a param's value into the text.
    pub(crate) fn write_param(&mut self, name: &str) {
        let (Some(scene), Some(chosen)) = (&self.model.scene, self.model.chosen_values()) else {
            return;
        };
        let Some(param) = scene.params.iter().find(|param| param.name == name) else {
            return;
        };
        let value = chosen.param(param).to_vec();
        self.write_numbers(name, value);
    }

    /// Writes the value of a param, or of a number of a script's settings, into the text.
    pub(crate) fn write_numbers(&mut self, name: &str, value: Vec<f64>) {
        match &mut self.text.source {
            TextSource::Attached { .. } => self.text.send(Event::Write {
                version: self.model.program.version,
                param: name.to_owned(),
                value,
            }),
            TextSource::File { editor, .. } => {
                let written = editor.write(|analysis| analysis.edit_param(name, &value));
                self.note_written(written);
            }
        }
    }

    /// Writes a new colour of an object into the text: sRGB, in 0…1.
    pub(crate) fn write_colour(&mut self, object: &str, colour: [f64; 3]) {
        match &mut self.text.source {
            TextSource::Attached { .. } => self.text.send(Event::WriteColour {
                version: self.model.program.version,
                object: object.to_owned(),
                colour,
            }),
            TextSource::File { editor, .. } => {
                let written = editor.write(|analysis| analysis.edit_colour(object, colour));
                self.note_written(written);
            }
        }
    }

    /// Compiles the window's own text after it has been written into, or reports why it has not been.
    pub(crate) fn note_written(&mut self, written: Result<bool, String>) {
        match written {
            Ok(true) => self.has_edited(),
            Ok(false) => {}
            Err(sentence) => self.status_message = Some(StatusMessage::error(sentence)),
        }
    }

    /// Writes the camera of the views in space into the text: into the declared camera from which they opened, or else
    /// as a new one.
    pub(crate) fn write_camera(&mut self) {
        let Some(camera) = self.model.choices.space else {
            return;
        };
        let declared = self.model.declared_camera();
        let free = || self.model.free_camera_name();
        let name = declared.map_or_else(free, |camera| camera.name.clone());
        let direction = [0, 1, 2].map(|k| camera.target[k] - camera.eye[k]);
        // The text may have other coordinates than the scene.
        let stated = |vector| match &self.model.scene {
            Some(scene) => scene.stated(vector),
            None => vector,
        };
        let [direction, position] = [direction, camera.eye].map(stated);
        let pane = ViewId::of_scene(self.views.first().name());
        let room = self.pictures.of_views.get(&pane).and_then(|view| view.room);
        let fov = camera.vertical_fov(room.unwrap_or([1; 2]));
        match &mut self.text.source {
            TextSource::Attached { .. } => self.text.send(Event::WriteCamera {
                version: self.model.program.version,
                name,
                direction,
                position,
                fov,
            }),
            TextSource::File { editor, .. } => {
                let written =
                    editor.write(|analysis| analysis.edit_camera(&name, direction, position, fov));
                self.note_written(written);
            }
        }
    }

    /// Shows the declaration of a name in the current text, and gives it the focus.
    pub(crate) fn open_declaration(&mut self, name: &str) {
        if let Some(place) = self.model.place_of(name) {
            self.open(place, true);
        }
    }

    /// Shows a declaration after a single click, which may have been meant for the view: the focus and the panes stay
    /// as they are.
    pub(super) fn show_declaration(&mut self, name: &str) {
        let Some(place) = self.model.place_of(name) else {
            return;
        };
        self.model.highlight(Some(name.to_owned()));
        if !self.text.is_own() || self.panes.is_open(&Pane::Program) {
            self.open(place, false);
        }
    }

    /// Shows the name of a leaf within its set, in the text of the picture, after the declaration has been shown.
    pub(super) fn show_leaf(&mut self, request: &PictureRequest, leaf: &SolidLeaf) {
        let shown = self.model.scene.as_ref();
        let is_current = shown.is_some_and(|scene| Arc::ptr_eq(scene, request.scene.arc()));
        let place = leaf.name_span;
        match &mut self.text.source {
            _ if !is_current => {}
            TextSource::Attached { .. } => self.open(place, false),
            TextSource::File { editor, .. } => {
                if let Some(jump) = &mut editor.jump {
                    jump.place = place;
                }
            }
        }
    }

    /// Shows a range of the text, and gives it the focus.
    pub(crate) fn open_place(&mut self, place: Span) {
        self.open(place, true);
    }

    fn open(&mut self, place: Span, takes_keys: bool) {
        match &mut self.text.source {
            TextSource::Attached { .. } => self.text.send(Event::Open {
                version: self.model.program.version,
                range: [place.start, place.end],
            }),
            TextSource::File { editor, .. } => {
                editor.jump = Some(Jump { place, takes_keys });
                self.panes.bring_forward(&Pane::Program);
            }
        }
    }
}
