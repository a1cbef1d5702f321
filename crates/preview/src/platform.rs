//! The parts of the window that depend on the operating system, each with a portable fallback.

use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};

/// Returns the folder for state that is kept between runs and belongs to no program.
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
/// the server has already started it with a lower priority.
pub(crate) fn lower_priority() {
    #[cfg(unix)]
    {
        // If the priority cannot be lowered, it stays as it is.
        let _ = rustix::process::nice(5);
    }
}

/// Creates a hidden file. Its name begins with a dot, which suffices except on Windows.
///
/// # Errors
/// The system's error; an existing file is unchanged.
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
