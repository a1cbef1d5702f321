//! Times of several runs, and the peak memory of this process.

use std::fmt;
use std::time::{Duration, Instant};

/// The times of several runs.
#[derive(Clone, Debug)]
pub(crate) struct Times(Vec<Duration>);

impl Times {
    /// Runs something several times, at least once.
    pub(crate) fn of<T>(runs: usize, mut work: impl FnMut() -> T) -> Self {
        let times = (0..runs.max(1)).map(|_| {
            let start = Instant::now();
            std::hint::black_box(work());
            start.elapsed()
        });
        Self::new(times.collect())
    }

    /// Times measured elsewhere; not none.
    pub(crate) fn new(mut times: Vec<Duration>) -> Self {
        times.sort_unstable();
        Self(times)
    }

    /// The median; zero for no runs.
    pub(crate) fn median(&self) -> Duration {
        self.0.get(self.0.len() / 2).copied().unwrap_or_default()
    }
}

impl fmt::Display for Times {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let milliseconds =
            |time: Option<&Duration>| time.map_or(0.0, |time| 1e3 * time.as_secs_f64());
        write!(
            f,
            "{:9.2} ms ({:.2}–{:.2}, {} runs)",
            1e3 * self.median().as_secs_f64(),
            milliseconds(self.0.first()),
            milliseconds(self.0.last()),
            self.0.len()
        )
    }
}

/// The mean processor time of a run on this thread, of as many runs as take a third of a second after a first one: what
/// one thread takes, whatever else the machine does.
pub(crate) fn processor_time<T>(mut work: impl FnMut() -> T) -> Duration {
    const ENOUGH: Duration = Duration::from_millis(333);
    let begun = thread_clock();
    std::hint::black_box(work());
    let start = thread_clock();
    let first = start.saturating_sub(begun);
    if first >= ENOUGH {
        return first;
    }
    let mut runs = 0;
    loop {
        std::hint::black_box(work());
        runs += 1;
        let spent = thread_clock().saturating_sub(start);
        if spent >= ENOUGH {
            return spent / runs;
        }
    }
}

/// What this thread has spent on a processor.
pub(crate) fn thread_clock() -> Duration {
    clock(rustix::time::ClockId::ThreadCPUTime)
}

/// What all threads of this process have spent on processors.
pub(crate) fn process_clock() -> Duration {
    clock(rustix::time::ClockId::ProcessCPUTime)
}

fn clock(id: rustix::time::ClockId) -> Duration {
    let now = rustix::time::clock_gettime(id);
    Duration::new(now.tv_sec.unsigned_abs(), now.tv_nsec as u32)
}

/// The largest resident memory of this process so far, in bytes; 0 where the system does not tell.
pub(crate) fn peak_memory() -> u64 {
    std::fs::read_to_string("/proc/self/status")
        .map_or(0, |status| testing::binary::high_water_mark(&status))
}

/// Bytes as megabytes.
pub(crate) fn megabytes(bytes: u64) -> f64 {
    bytes as f64 / f64::from(1 << 20)
}
