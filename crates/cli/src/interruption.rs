//! The signals that end the program: partly written files are removed first; then the program ends as it would by
//! default. A command may request to be notified of the first signal instead, to keep its results so far; so do the
//! window, whose text would be lost, and the language server, whose windows would stay.

#[cfg(unix)]
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// True if the first signal only requests an end.
static REQUESTS_END_FIRST: AtomicBool = AtomicBool::new(false);
/// Set once that signal has arrived.
static IS_INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Requests that the running work end by itself. Returns false if it cannot.
type Ask = Box<dyn Fn() -> bool + Send>;
/// Called at the first signal.
static ASK: Mutex<Option<Ask>> = Mutex::new(None);
/// The time that the work then has to end.
const GRACE: Duration = Duration::from_secs(3);

/// Makes the first signal call `ask`. If that returns true, the program is ended only if it is still running a little
/// later.
pub(crate) fn ask_first(ask: impl Fn() -> bool + Send + 'static) {
    *ASK.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(ask));
}

/// Makes the first signal only request an end, which [`is_interrupted`] reports; the second one ends the program.
pub(crate) fn ask_for_end_first() {
    REQUESTS_END_FIRST.store(true, Ordering::Relaxed);
}

/// Returns true once an end has been requested.
pub(crate) fn is_interrupted() -> bool {
    IS_INTERRUPTED.load(Ordering::Relaxed)
}

/// Ends the program with success, and does not wait for other threads.
pub(crate) fn end_now() -> ! {
    #[cfg(unix)]
    signal_hook::low_level::exit(0);
    #[cfg(not(unix))]
    std::process::exit(0)
}

/// Handles a signal; `end` ends the program.
#[cfg(any(unix, windows))]
fn take(end: impl FnOnce()) {
    if REQUESTS_END_FIRST.load(Ordering::Relaxed) && !IS_INTERRUPTED.swap(true, Ordering::Relaxed) {
        return;
    }
    let ask = ASK.lock().unwrap_or_else(PoisonError::into_inner).take();
    if ask.is_some_and(|ask| ask()) {
        std::thread::sleep(GRACE);
    }
    export::whole_file::abandon_all(end);
}

/// Handles the signals on a thread of its own, which sleeps until one arrives. If no thread can be started, temporary
/// files are left behind. A file that exceeds the user's size limit becomes an error of the write instead of a signal.
#[cfg(unix)]
pub(crate) fn remove_what_is_half_written() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXFSZ};
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::emulate_default_handler;

    // The handler only records the signal: without a handler, the signal would end the program.
    let _ = signal_hook::flag::register(SIGXFSZ, Arc::default());
    let mut ends = vec![SIGINT, SIGQUIT, SIGTERM];
    if !is_ignored(SIGHUP) {
        ends.push(SIGHUP);
    }
    let Ok(mut signals) = Signals::new(ends) else {
        return;
    };
    let thread = std::thread::Builder::new().name("signals".to_owned());
    let _ = thread.spawn(move || {
        for signal in signals.forever() {
            take(|| {
                // For these signals it does not return.
                let _ = emulate_default_handler(signal);
            });
        }
    });
}

/// Returns true if a signal is ignored, as under `nohup`; also if the system does not report that in `/proc`.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:"))
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_none_or(|mask| mask >> (signal - 1) & 1 == 1)
}

/// Handles Ctrl+C and Ctrl+Break on a thread of its own, which sleeps until one is pressed. If no thread can be
/// started, temporary files are left behind.
#[cfg(windows)]
pub(crate) fn remove_what_is_half_written() {
    /// The exit status of a program that Ctrl+C ends: `STATUS_CONTROL_C_EXIT`.
    const STATUS: i32 = 0xC000_013A_u32.cast_signed();

    let _ = ctrlc::set_handler(|| take(|| std::process::exit(STATUS)));
}

/// Does nothing: there are no signals here.
#[cfg(not(any(unix, windows)))]
pub(crate) fn remove_what_is_half_written() {}
