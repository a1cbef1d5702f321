//! The resident memory of this process, as the kernel keeps it: of Linux only, elsewhere it is 0.

use testing::binary::high_water_mark;

/// Forgets the peak: from now on it is counted again.
pub fn forget_peak() {
    // Where that is refused, the peak is that of the whole run.
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// The largest resident memory since it was forgotten, in bytes.
pub fn peak() -> u64 {
    std::fs::read_to_string("/proc/self/status").map_or(0, |status| high_water_mark(&status))
}
