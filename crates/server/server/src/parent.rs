//! The editor's death: a server whose editor is gone ends, even if its input stays open.

/// Calls `then` when the process is gone, on a thread that sleeps until then. Never, where that cannot be known: the end
/// of the input has to do there.
#[cfg(target_os = "linux")]
pub(crate) fn when_gone(process: u32, then: impl FnOnce() + Send + 'static) {
    use rustix::event::{PollFd, PollFlags, poll};
    use rustix::process::{Pid, PidfdFlags, pidfd_open};

    let Some(pid) = i32::try_from(process).ok().and_then(Pid::from_raw) else {
        return;
    };
    let wait = move || match pidfd_open(pid, PidfdFlags::empty()) {
        Ok(descriptor) => loop {
            // It becomes readable when the process ends.
            let mut watched = [PollFd::new(&descriptor, PollFlags::IN)];
            match poll(&mut watched, None) {
                Ok(0) | Err(rustix::io::Errno::INTR) => {}
                Ok(_) => return true,
                Err(_) => return false,
            }
        },
        Err(error) => error == rustix::io::Errno::SRCH,
    };
    let thread = std::thread::Builder::new().name("editor's death".to_owned());
    // Without a thread to spare the end of the input has to do, too.
    let _ = thread.spawn(move || {
        if wait() {
            then();
        }
    });
}

/// Not known on this system.
#[cfg(not(target_os = "linux"))]
pub(crate) fn when_gone(_process: u32, _then: impl FnOnce() + Send + 'static) {}
