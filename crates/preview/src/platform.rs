//! The parts of the window that depend on the operating system, each with a portable side.

/// Lowers the priority of this process, so that an editor's requests are answered before a picture is drawn. Other
/// systems than Linux schedule a process in the background by themselves or not at all.
pub(crate) fn lower_priority() {
    #[cfg(target_os = "linux")]
    {
        // A process that may not be nice is as urgent as before.
        let _ = rustix::process::nice(5);
    }
}
