//! The workers of the window, on threads of their own: the compiler, the renderer, measuring, recordings, textures; and
//! the text of the window's own editor.

pub(crate) mod compiler;
pub(crate) mod editor;
pub(crate) mod figures;
pub(crate) mod measure_thread;
pub(crate) mod reader;
pub(crate) mod recording;
pub(crate) mod remembered;
pub(crate) mod render_thread;
pub(crate) mod request;
mod snapping;
pub(crate) mod textures;
pub(crate) mod typing;
