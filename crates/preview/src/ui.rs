//! The window's user interface: panes, menu, dialogs, input, and the GPU that displays it.

pub(crate) mod app;
pub(crate) mod camera_input;
mod colour;
pub(crate) mod dialogs;
pub(crate) mod event_loop;
pub(crate) mod event_splitter;
pub(crate) mod gallery;
pub(crate) mod gpu_surface;
pub(crate) mod held_keys;
pub(crate) mod highlighting;
pub(crate) mod icons;
mod key_names;
pub(crate) mod measure;
pub(crate) mod menu;
pub(crate) mod navigation;
pub(crate) mod number_field;
pub(crate) mod panes;
pub(crate) mod status;
pub(crate) mod toolbar;
pub(crate) mod welcome;
pub(crate) mod window;
