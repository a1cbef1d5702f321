//! The active view, which receives the keys: the last visible one that was clicked, opened or brought to the front.

use egui::Pos2;
use render::ViewId;
use session::pane::Pane;

use super::Window;
use crate::ui::camera_input::{CameraInput, input_of};

/// The view with which the user is working.
#[derive(Debug)]
pub(crate) struct Focus {
    /// The view that keys move.
    pub(crate) view: ViewId,
    /// The surface whose camera is shown in space.
    pub(crate) surface: Option<String>,
    /// The view over which the pointer has moved since a view became active: the next camera key applies to it.
    pub(crate) pointed: Option<ViewId>,
    /// The last position of the pointer over a view.
    pub(crate) pointer: Option<Pos2>,
}

impl Window {
    /// Returns the input for a view's camera.
    pub(crate) fn camera_input(&self, id: &ViewId) -> &'static dyn CameraInput {
        input_of(self.views.get(&id.kind))
    }

    /// Returns the views of the scene that is shown.
    pub(crate) fn offered(&self) -> Vec<ViewId> {
        self.views.of_scene(self.model.scene.as_deref())
    }

    /// Makes a view active: keys move its camera.
    pub(crate) fn activate(&mut self, id: &ViewId) {
        if self.focus.view != *id {
            self.input.held.release_views();
            self.focus.view = id.clone();
        }
        self.focus.pointed = None;
        self.note_surface(id);
    }

    /// Notes the surface of a geodesic view: its camera is shown in space.
    fn note_surface(&mut self, id: &ViewId) {
        let options = self.views.get(&id.kind).map(|view| view.options(None));
        if options.is_some_and(|options| options.geodesic_camera().is_some()) {
            self.focus.surface.clone_from(&id.object);
        }
    }

    /// Brings a pane to the front, and makes it active if it is a view.
    pub(crate) fn bring_forward(&mut self, pane: &Pane) {
        match pane {
            Pane::View(id) => {
                self.reveal(id);
                self.activate(id);
            }
            _ => self.panes.bring_forward(pane),
        }
    }

    /// Opens a view, or brings it to the front; the active view stays the same.
    pub(super) fn reveal(&mut self, id: &ViewId) {
        self.note_surface(id);
        if !self.is_wanted(id) {
            self.note_wanted(id, true);
        }
        self.panes.bring_forward(&Pane::View(id.clone()));
    }

    /// Returns whether a view of an object is open.
    pub(super) fn has_view_of(&self, name: &str) -> bool {
        let mut offered = self.offered().into_iter();
        offered.any(|id| id.object.as_deref() == Some(name) && self.panes.is_open(&Pane::View(id)))
    }

    /// Opens the first view of an object, or brings it to the front; the active view stays the same.
    pub(super) fn reveal_object(&mut self, name: &str) {
        let mut offered = self.offered().into_iter();
        if let Some(id) = offered.find(|id| id.object.as_deref() == Some(name)) {
            self.reveal(&id);
        }
    }

    /// Remembers that a pane was closed, if it is of an object.
    pub(crate) fn note_closed(&mut self, pane: &Pane) {
        if let Pane::View(id) = pane {
            self.note_wanted(id, false);
        }
    }

    /// Returns whether a view of the scene opens by itself.
    pub(crate) fn opens_by_itself(&self, id: &ViewId) -> bool {
        let scene = self.model.scene.as_ref();
        scene.is_some_and(|scene| self.views.opens_by_itself(id, scene))
    }

    /// Returns whether a view of an object is to be open: because it opens by itself and was not closed, or because it
    /// was opened.
    pub(super) fn is_wanted(&self, id: &ViewId) -> bool {
        let (name, choices) = (id.to_string(), &self.model.choices);
        match self.opens_by_itself(id) {
            true => !choices.closed.contains(&name),
            false => choices.opened.contains(&name),
        }
    }

    fn note_wanted(&mut self, id: &ViewId, is_wanted: bool) {
        if id.object.is_none() {
            return;
        }
        let (name, by_itself) = (id.to_string(), self.opens_by_itself(id));
        self.model.adjust(|choices| {
            choices.closed.remove(&name);
            choices.opened.remove(&name);
            match (by_itself, is_wanted) {
                (true, false) => choices.closed.insert(name),
                (false, true) => choices.opened.insert(name),
                _ => false,
            };
        });
    }

    /// Makes a visible view active if the active one was closed or covered. Returns whether there is an active view.
    pub(super) fn has_keys(&mut self) -> bool {
        let seen = self.panes.in_front();
        if seen.contains(&self.focus.view) {
            return true;
        }
        // Preferably the view of the active surface, otherwise one of the whole scene.
        let surface = &self.focus.surface;
        let next = seen.into_iter().min_by_key(|id| {
            let is_of_surface = id.object.is_some() && id.object == *surface;
            (!is_of_surface, id.object.is_some(), id.clone())
        });
        if let Some(id) = &next {
            self.activate(id);
        }
        next.is_some()
    }
}
