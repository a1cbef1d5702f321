//! The active view, which has the keys: the one that was clicked on, opened or brought forward last, while it can be
//! seen.

use render::ViewId;

use super::Window;
use crate::state::pane::Pane;
use crate::ui::camera_input::{CameraInput, input_of};

/// The view that the user is busy with.
#[derive(Debug)]
pub(crate) struct Focus {
    /// The view that keys move.
    pub(crate) view: ViewId,
    /// The surface whose camera is shown in space.
    pub(crate) surface: Option<String>,
}

impl Window {
    /// Returns what moves a view's camera.
    pub(crate) fn camera_input(&self, id: &ViewId) -> &'static dyn CameraInput {
        input_of(self.views.get(&id.kind))
    }

    /// Returns the views of the scene that is shown.
    pub(crate) fn offered(&self) -> Vec<ViewId> {
        self.views.of_scene(self.model.scene.as_deref())
    }

    /// Keys move this view's camera from now on.
    pub(crate) fn activate(&mut self, id: &ViewId) {
        if self.focus.view != *id {
            self.input.held.release_views();
            self.focus.view = id.clone();
        }
        self.note_surface(id);
    }

    /// Notes the surface that a view is seen from, if it is: its camera is shown in space.
    fn note_surface(&mut self, id: &ViewId) {
        let options = self.views.get(&id.kind).map(|view| view.options(None));
        if options.is_some_and(|options| options.geodesic_camera().is_some()) {
            self.focus.surface.clone_from(&id.object);
        }
    }

    /// Shows a pane, wherever it is, and gives it the keys if it is a view.
    pub(crate) fn bring_forward(&mut self, pane: &Pane) {
        match pane {
            Pane::View(id) => {
                self.reveal(id);
                self.activate(id);
            }
            _ => self.panes.bring_forward(pane),
        }
    }

    /// Opens a view, or brings it to the front; the keys stay where they are.
    pub(super) fn reveal(&mut self, id: &ViewId) {
        self.note_surface(id);
        if self.model.view.closed.contains(&id.to_string()) {
            self.model.adjust(|view| {
                view.closed.remove(&id.to_string());
            });
        }
        self.panes.bring_forward(&Pane::View(id.clone()));
    }

    /// Opens the first view of an object, or brings it to the front; the keys stay where they are.
    pub(super) fn reveal_object(&mut self, name: &str) {
        let mut offered = self.offered().into_iter();
        if let Some(id) = offered.find(|id| id.object.as_deref() == Some(name)) {
            self.reveal(&id);
        }
    }

    /// Remembers that a pane was closed, if it opens by itself.
    pub(crate) fn note_closed(&mut self, pane: &Pane) {
        if let Pane::View(id) = pane
            && id.object.is_some()
        {
            self.model.adjust(|view| {
                view.closed.insert(id.to_string());
            });
        }
    }

    /// Gives the keys to a view that can be seen, where the one that has them was closed or covered; whether one has
    /// them.
    pub(super) fn has_keys(&mut self) -> bool {
        let seen = self.panes.in_front();
        if seen.contains(&self.focus.view) {
            return true;
        }
        // Likely the view of the active surface, else one of the whole scene.
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
