//! The operating system: what the standard library does not have portably. Each function has a portable side, which
//! does less where a system offers less.

use std::process::Command;

/// Sets a window's process apart from this one before it is started: a key that interrupts an editor in a terminal is not
/// meant for the window. On systems other than Unix and Windows it stays in the group of its parent.
///
/// Windows gives it a console of its own, which is not seen, and schedules it behind the server; elsewhere the window
/// lowers its priority by itself.
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
/// Does nothing where the process cannot be watched: there the end of the input must do.
#[cfg(any(target_os = "linux", target_os = "macos", windows))]
pub(crate) fn when_process_ends(process: u32, then: impl FnOnce() + Send + 'static) {
    /// The number of the system's error for a process that does not exist: `ERROR_INVALID_PARAMETER`, `ESRCH`.
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
    // Without a thread the end of the input must do, too.
    let _ = thread.spawn(move || {
        if wait() {
            then();
        }
    });
}

/// Does nothing: no process can be watched here.
#[cfg(not(any(target_os = "linux", target_os = "macos", windows)))]
pub(crate) fn when_process_ends(_process: u32, _then: impl FnOnce() + Send + 'static) {}
