//! The parts of the window that depend on the operating system, each with a portable side.

use std::path::PathBuf;

/// Returns the folder for what the window remembers between runs that belongs to no program.
pub(crate) fn state_folder() -> Option<PathBuf> {
    let folder = |variable: &str| {
        let path = PathBuf::from(std::env::var_os(variable)?);
        path.is_absolute().then_some(path)
    };
    let folder = if cfg!(windows) {
        folder("LOCALAPPDATA")
    } else if cfg!(target_os = "macos") {
        folder("HOME").map(|home| home.join("Library/Application Support"))
    } else {
        folder("XDG_STATE_HOME").or_else(|| Some(folder("HOME")?.join(".local/state")))
    };
    Some(folder?.join("geotrace"))
}

/// Lowers the priority of this process, so that an editor's requests are answered before a picture is drawn. Other
/// systems than Linux schedule a process in the background by themselves or not at all.
pub(crate) fn lower_priority() {
    #[cfg(target_os = "linux")]
    {
        // A process that may not be nice is as urgent as before.
        let _ = rustix::process::nice(5);
    }
}
