//! The signals that end the program: what is half written is removed first, and the program ends as it would without this.
//! A command may ask to be told of the first signal instead, to keep what it has done; so does the window, whose text would be
//! lost.

#[cfg(unix)]
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Set if the first signal only asks for an end.
static IS_HEARD: AtomicBool = AtomicBool::new(false);
/// Set once it has come.
static IS_INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Asks what runs to end by itself; false if it cannot.
type Ask = Box<dyn Fn() -> bool + Send>;
/// Called at the first signal.
static ASK: Mutex<Option<Ask>> = Mutex::new(None);
/// The time that what was asked to end has for it.
const GRACE: Duration = Duration::from_secs(3);

/// From now on the first signal calls `ask`. Where that returns true, the program is ended only if it is still there a little
/// later.
#[cfg_attr(
    not(feature = "window"),
    expect(dead_code, reason = "only a window is asked")
)]
pub(crate) fn ask_first(ask: impl Fn() -> bool + Send + 'static) {
    *ASK.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(ask));
}

/// From now on the first signal only asks for an end, which [`is_interrupted`] tells; the second one ends the program.
pub(crate) fn hear() {
    IS_HEARD.store(true, Ordering::Relaxed);
}

/// Returns true once an end has been asked for.
pub(crate) fn is_interrupted() -> bool {
    IS_INTERRUPTED.load(Ordering::Relaxed)
}

/// Takes a signal; `end` ends the program.
#[cfg(any(unix, windows))]
fn take(end: impl FnOnce()) {
    if IS_HEARD.load(Ordering::Relaxed) && !IS_INTERRUPTED.swap(true, Ordering::Relaxed) {
        return;
    }
    let ask = ASK.lock().unwrap_or_else(PoisonError::into_inner).take();
    if ask.is_some_and(|ask| ask()) {
        std::thread::sleep(GRACE);
    }
    export::whole_file::abandon_all(end);
}

/// Handles the signals on a thread of its own, which sleeps until one comes. Where no thread can be started, temporary
/// files stay behind. A file that grows beyond what the user may write is from now on an error of the write, which says so.
#[cfg(unix)]
pub(crate) fn remove_what_is_half_written() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXFSZ};
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::emulate_default_handler;

    // A handler that does nothing but note it: without one, the signal ends the program.
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
                // It does not return for these signals.
                let _ = emulate_default_handler(signal);
            });
        }
    });
}

/// Returns true if a signal is ignored, as `nohup` leaves it; also where the system does not say it in `/proc`.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:"))
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_none_or(|mask| mask >> (signal - 1) & 1 == 1)
}

/// Handles Ctrl+C and Ctrl+Break on a thread of its own, which sleeps until one is pressed. Where no thread can be started,
/// temporary files stay behind.
#[cfg(windows)]
pub(crate) fn remove_what_is_half_written() {
    /// The exit status of a program that Ctrl+C ends: `STATUS_CONTROL_C_EXIT`.
    const STATUS: i32 = 0xC000_013A_u32.cast_signed();

    let _ = ctrlc::set_handler(|| take(|| std::process::exit(STATUS)));
}

/// Does nothing: there are no signals here.
#[cfg(not(any(unix, windows)))]
pub(crate) fn remove_what_is_half_written() {}
