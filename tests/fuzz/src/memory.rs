//! The resident memory of this process, as the kernel keeps it: of Linux only, elsewhere it is 0.

use testing::binary::high_water_mark;

/// The largest resident memory until now, in bytes.
pub fn peak() -> u64 {
    std::fs::read_to_string("/proc/self/status").map_or(0, |status| high_water_mark(&status))
}
