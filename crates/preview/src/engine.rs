//! The window's workers, on threads of their own: the compiler, the renderer, measuring, recordings, textures; and the
//! file of the window's own text.

pub(crate) mod compiler;
pub(crate) mod measure_thread;
pub(crate) mod recording;
pub(crate) mod remembered;
pub(crate) mod render_thread;
pub(crate) mod saving;
pub(crate) mod textures;
