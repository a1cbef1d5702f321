//! The window's input and output: the server's messages, files, the desktop's dialogs.

pub(crate) mod file_dialogs;
pub(crate) mod files;
pub(crate) mod link;
pub(crate) mod path_list;
pub(crate) mod persistence;
pub(crate) mod report;
pub(crate) mod settings;
pub(crate) mod watch;
