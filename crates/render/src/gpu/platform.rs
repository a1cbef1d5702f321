//! Detection of a GPU before a driver is loaded: loading takes time, and some drivers write to standard error.

/// Device files of the kernel's GPU drivers: direct rendering, NVIDIA, Windows Subsystem for Linux, Adreno, Mali.
#[cfg(target_os = "linux")]
const DEVICES: [&str; 5] = [
    "/dev/dri",
    "/dev/nvidiactl",
    "/dev/dxg",
    "/dev/kgsl-3d0",
    "/dev/mali0",
];

/// Returns false if there is certainly no GPU.
#[cfg(target_os = "linux")]
pub(super) fn may_have_gpu() -> bool {
    DEVICES
        .iter()
        .any(|device| std::path::Path::new(device).exists())
}

/// Returns true: only the drivers know.
#[cfg(not(target_os = "linux"))]
pub(super) fn may_have_gpu() -> bool {
    true
}
