//! The panes by name: views of the scene, and panes of text and controls.

use serde::{Deserialize, Serialize};

/// A pane with a picture.
#[derive(Clone, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub(crate) enum PaneKey {
    /// The 3D view.
    Space,
    /// The geodesic view of a surface, by its name.
    Inside(String),
}

impl PaneKey {
    /// Returns the pane that shows the view.
    pub(crate) fn pane(&self) -> Pane {
        match self {
            Self::Space => Pane::Space,
            Self::Inside(name) => Pane::Inside(name.clone()),
        }
    }
}

/// A pane.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) enum Pane {
    /// The 3D view.
    Space,
    /// The geodesic view of a surface.
    Inside(String),
    /// Sliders, colours, textures.
    Settings,
    /// The text and its status.
    Program,
}

impl Pane {
    /// Returns the view that the pane shows, if it shows one.
    pub(crate) fn picture(&self) -> Option<PaneKey> {
        match self {
            Self::Space => Some(PaneKey::Space),
            Self::Inside(name) => Some(PaneKey::Inside(name.clone())),
            Self::Settings | Self::Program => None,
        }
    }
}
