//! Lenses: the views offered on a line above a declaration.

use syntax::span::Span;

/// A view offered on a line above a declaration.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Lens {
    /// The declaration's name; the lens appears above its line.
    pub span: Span,
    /// The text of the line: "3D", "geodesic view", "traced".
    pub title: &'static str,
    /// The name of the view in the command line and in the preview's messages: `3d`, `geodesic`, `traced`.
    pub view: &'static str,
    /// The object of the view, or its camera; `None` for a view of the whole scene.
    pub object: Option<String>,
}
