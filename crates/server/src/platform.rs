//! The operating system: functions that the standard library does not offer portably. Each function has a portable
//! fallback, which does less if the system offers less.

use std::process::Command;

/// Separates a window's process from this one before it is started: a key that interrupts an editor in a terminal must
/// not reach the window. On systems other than Unix and Windows the window stays in its parent's group.
///
/// On Windows it gets a hidden console of its own and a lower priority than the server; elsewhere the window lowers its
/// own priority.
pub(crate) fn set_apart(command: &mut Command) {
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(command, 0);
    #[cfg(windows)]
    {
        const CREATE_NEW_PROCESS_GROUP: u32 = 0x200;
        const BELOW_NORMAL_PRIORITY_CLASS: u32 = 0x4000;
        const CREATE_NO_WINDOW: u32 = 0x0800_0000;
        std::os::windows::process::CommandExt::creation_flags(
            command,
            CREATE_NEW_PROCESS_GROUP | BELOW_NORMAL_PRIORITY_CLASS | CREATE_NO_WINDOW,
        );
    }
    #[cfg(not(any(unix, windows)))]
    let _ = command;
}

/// Calls `then` when a process has ended, on a thread that sleeps until then. A server whose editor has ended ends too,
/// even if its input stays open.
///
/// Does nothing if the process cannot be watched: then only the end of the input ends the server.
#[cfg(any(target_os = "linux", target_os = "macos", windows))]
pub(crate) fn when_process_ends(process: u32, then: impl FnOnce() + Send + 'static) {
    /// The system's error code for a process that does not exist: `ERROR_INVALID_PARAMETER`, `ESRCH`.
    const NO_SUCH_PROCESS: i32 = if cfg!(windows) { 87 } else { 3 };

    let Ok(process) = i32::try_from(process) else {
        return;
    };
    let wait = move || match waitpid_any::WaitHandle::open(process) {
        Ok(mut handle) => loop {
            match handle.wait() {
                Ok(()) => return true,
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                Err(_) => return false,
            }
        },
        Err(error) => error.raw_os_error() == Some(NO_SUCH_PROCESS),
    };
    let thread = std::thread::Builder::new().name("editor watch".to_owned());
    // Without a thread, only the end of the input ends the server.
    let _ = thread.spawn(move || {
        if wait() {
            then();
        }
    });
}

/// Does nothing: processes cannot be watched here.
#[cfg(not(any(target_os = "linux", target_os = "macos", windows)))]
pub(crate) fn when_process_ends(_process: u32, _then: impl FnOnce() + Send + 'static) {}
