//! Lenses: the views that a line above a declaration offers.

use syntax::span::Span;

/// A view that a line above a declaration offers.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Lens {
    /// The declaration's name; the lens appears above its line.
    pub span: Span,
    /// The text of the line: "3D", "geodesic view", "traced".
    pub title: &'static str,
    /// The name of the view, as the command line and the preview's messages use it: `3d`, `geodesic`, `traced`.
    pub view: &'static str,
    /// The object that the view is of, or the camera that it is seen from; `None` for a view of the whole scene.
    pub object: Option<String>,
}
