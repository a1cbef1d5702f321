//! The scene of a program with or without errors.

use std::sync::Arc;

use crate::scene::Scene;

/// The scene of a program. For a program with errors: declarations without errors in their present form, the others in
/// their last good form.
#[derive(Clone, Debug, Default)]
pub struct ProgramScene {
    /// The scene. Spans of names refer to the text; the name of a replacement has the span of the declaration that it
    /// replaces. `None` if nothing can be shown.
    pub scene: Option<Arc<Scene>>,
    /// The objects that are shown in their last good form, and those that depend on such objects.
    pub stale: Vec<String>,
    /// True if parts of the program are not shown at all.
    pub incomplete: bool,
}
