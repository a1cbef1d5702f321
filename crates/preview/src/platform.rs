//! The parts of the window that depend on the operating system, each with a portable side.

use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};

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

/// Lowers the priority of this process, so that an editor's requests are answered before a picture is drawn. On Windows
/// the server has started it with a lower one.
pub(crate) fn lower_priority() {
    #[cfg(unix)]
    {
        // A process that may not be nice is as urgent as before.
        let _ = rustix::process::nice(5);
    }
}

/// Creates a file that folders do not show. Its name begins with a dot, which is enough except on Windows.
///
/// # Errors
/// The system's; an existing file is left as it is.
pub(crate) fn create_hidden(path: &Path) -> std::io::Result<File> {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(windows)]
    {
        const FILE_ATTRIBUTE_HIDDEN: u32 = 0x2;
        std::os::windows::fs::OpenOptionsExt::attributes(&mut options, FILE_ATTRIBUTE_HIDDEN);
    }
    options.open(path)
}
