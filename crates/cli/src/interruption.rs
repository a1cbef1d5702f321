//! The signals that end the program: what is half written is removed first, and the program ends as it would without this.

/// Handles the signals on a thread of its own, which sleeps until one comes. On systems other than Unix, and where no
/// thread can be started, temporary files stay behind.
#[cfg(unix)]
pub(crate) fn remove_what_is_half_written() {
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::emulate_default_handler;

    let Ok(mut signals) = Signals::new([SIGINT, SIGTERM]) else {
        return;
    };
    let thread = std::thread::Builder::new().name("signals".to_owned());
    let _ = thread.spawn(move || {
        if let Some(signal) = signals.forever().next() {
            export::whole_file::abandon_all(|| {
                // It does not return for these signals.
                let _ = emulate_default_handler(signal);
            });
        }
    });
}

/// Does nothing: see the other side.
#[cfg(not(unix))]
pub(crate) fn remove_what_is_half_written() {}
