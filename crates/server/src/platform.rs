//! The operating system: what the standard library does not have portably. Each function has a portable side, which
//! does less where a system offers less.

use std::process::Command;

/// Starts a command in a process group of its own: a key that interrupts an editor in a terminal is not meant for the
/// window. On systems other than Unix the command stays in the group of its parent.
pub(crate) fn detach_from_terminal(command: &mut Command) {
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(command, 0);
    #[cfg(not(unix))]
    let _ = command;
}

/// Calls `then` when a process has ended, on a thread that sleeps until then. A server whose editor has ended ends too,
/// even if its input stays open.
///
/// Does nothing on systems other than Linux, or where the process cannot be watched: there the end of the input must do.
#[cfg(target_os = "linux")]
pub(crate) fn when_process_ends(process: u32, then: impl FnOnce() + Send + 'static) {
    use rustix::event::{PollFd, PollFlags, poll};
    use rustix::process::{Pid, PidfdFlags, pidfd_open};

    let Some(pid) = i32::try_from(process).ok().and_then(Pid::from_raw) else {
        return;
    };
    let wait = move || match pidfd_open(pid, PidfdFlags::empty()) {
        Ok(descriptor) => loop {
            // The descriptor becomes readable when the process ends.
            let mut watched = [PollFd::new(&descriptor, PollFlags::IN)];
            match poll(&mut watched, None) {
                Ok(0) | Err(rustix::io::Errno::INTR) => {}
                Ok(_) => return true,
                Err(_) => return false,
            }
        },
        Err(error) => error == rustix::io::Errno::SRCH,
    };
    let thread = std::thread::Builder::new().name("editor watch".to_owned());
    // Without a thread the end of the input must do, too.
    let _ = thread.spawn(move || {
        if wait() {
            then();
        }
    });
}

/// Does nothing: processes are watched on Linux only.
#[cfg(not(target_os = "linux"))]
pub(crate) fn when_process_ends(_process: u32, _then: impl FnOnce() + Send + 'static) {}
