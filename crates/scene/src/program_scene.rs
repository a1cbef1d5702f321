//! The scene of a program, with errors or without.

use std::sync::Arc;

use crate::scene::Scene;

/// The scene of a program. Of one with errors: declarations without errors as they are now, the others as they last
/// were.
#[derive(Clone, Debug, Default)]
pub struct ProgramScene {
    /// The scene. Names stand where they do in the text; the name of what stands in for a declaration has the place of
    /// that. None where nothing can be shown.
    pub scene: Option<Arc<Scene>>,
    /// The objects that are shown as they last were, and those that depend on something that is.
    pub stale: Vec<String>,
    /// Something of the program is not shown at all.
    pub incomplete: bool,
}
