//! The panes by name: views of the scene, and panes of text and controls.

use std::collections::BTreeSet;

use render::ViewId;
use serde::{Deserialize, Serialize};

/// A pane.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(from = "SavedPane", into = "SavedPane")]
pub enum Pane {
    /// The picture of a view.
    View(ViewId),
    /// Sliders, colours, textures.
    Settings,
    /// The text and its status.
    Program,
}

/// A pane as it is saved in a file.
#[derive(Deserialize, Serialize)]
#[serde(rename_all = "camelCase")]
enum SavedPane {
    /// A view by its name: `3d`, `geodesic:s`.
    View(String),
    /// The 3D view in a file of version 0.1.
    Space,
    /// The geodesic view of a surface in a file of version 0.1.
    Inside(String),
    Settings,
    Program,
}

impl Pane {
    /// Returns the view that the pane shows, if it shows one.
    pub fn view(&self) -> Option<&ViewId> {
        match self {
            Self::View(id) => Some(id),
            Self::Settings | Self::Program => None,
        }
    }

    /// Returns whether it shows a view of an object.
    pub fn is_of_object(&self) -> bool {
        self.view().is_some_and(|id| id.object.is_some())
    }
}

impl From<SavedPane> for Pane {
    fn from(saved: SavedPane) -> Self {
        match saved {
            SavedPane::View(name) => Self::View(name.as_str().into()),
            SavedPane::Space => Self::View(ViewId::of_scene("3d")),
            SavedPane::Inside(surface) => Self::View(geodesic_view(&surface)),
            SavedPane::Settings => Self::Settings,
            SavedPane::Program => Self::Program,
        }
    }
}

impl From<Pane> for SavedPane {
    fn from(pane: Pane) -> Self {
        match pane {
            Pane::View(id) => Self::View(id.to_string()),
            Pane::Settings => Self::Settings,
            Pane::Program => Self::Program,
        }
    }
}

/// Returns the names of views of objects. A file of version 0.1 has the names of surfaces instead, which stand for
/// their geodesic views.
pub(super) fn saved_views(names: BTreeSet<String>) -> BTreeSet<String> {
    let names = names.into_iter();
    names
        .map(|name| match name.contains(':') {
            true => name,
            false => geodesic_view(&name).to_string(),
        })
        .collect()
}

fn geodesic_view(surface: &str) -> ViewId {
    ViewId::of_object("geodesic", surface)
}
