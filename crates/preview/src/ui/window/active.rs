//! The active view, which has the keys: the one that was clicked on, opened or brought forward last, while it can be
//! seen.

use super::Window;
use crate::state::pane::{Pane, PaneKey};

impl Window {
    /// Keys move this pane's camera from now on.
    pub(crate) fn activate(&mut self, pane: &PaneKey) {
        self.active = pane.clone();
        if let PaneKey::Inside(name) = pane {
            self.active_surface = Some(name.clone());
        }
    }

    /// Shows a pane, wherever it is, and gives it the keys if it is a view.
    pub(crate) fn bring_forward(&mut self, pane: &Pane) {
        self.panes.bring_forward(pane);
        if let Some(picture) = pane.picture() {
            self.activate(&picture);
        }
    }

    /// Opens the geodesic view of a surface, or brings it to the front, and gives it the keys.
    pub(crate) fn open_inside(&mut self, surface: &str) {
        self.show_inside(surface);
        self.activate(&PaneKey::Inside(surface.to_owned()));
    }

    /// Opens the geodesic view of a surface, or brings it to the front; the keys stay where they are.
    pub(super) fn show_inside(&mut self, surface: &str) {
        self.active_surface = Some(surface.to_owned());
        self.model.adjust(|view| {
            view.closed.remove(surface);
        });
        self.panes.bring_forward(&Pane::Inside(surface.to_owned()));
    }

    /// Gives the keys to a view that can be seen, where the one that has them was closed or covered; whether one has
    /// them.
    pub(super) fn has_keys(&mut self) -> bool {
        let seen = self.panes.in_front();
        if seen.contains(&self.active) {
            return true;
        }
        let surface = self.active_surface.clone().map(PaneKey::Inside);
        let likely = surface.into_iter().chain([PaneKey::Space]);
        let next = likely.chain(seen.iter().min().cloned());
        let next = next.into_iter().find(|pane| seen.contains(pane));
        if let Some(pane) = &next {
            self.activate(pane);
        }
        next.is_some()
    }
}
