//! Threads for the tiles of a picture.
//!
//! In: work that shares itself out. Out: its effects, from several threads at once. A page has no threads but those of rayon's
//! pool. A program's own threads leave that pool to the other pictures, which a long one would hold up there.

/// Runs the work on this many threads at once, or on fewer where the system has no more.
#[cfg(not(target_family = "wasm"))]
pub(crate) fn run_on(count: usize, work: impl Fn() + Sync) {
    std::thread::scope(|scope| {
        for _ in 1..count {
            let name = "tiles".to_owned();
            if std::thread::Builder::new()
                .name(name)
                .spawn_scoped(scope, &work)
                .is_err()
            {
                break;
            }
        }
        work();
    });
}

/// Runs the work on this many threads at once, or on fewer where the pool has no more.
#[cfg(target_family = "wasm")]
pub(crate) fn run_on(count: usize, work: impl Fn() + Sync) {
    let work = &work;
    rayon::scope(|scope| {
        for _ in 1..count {
            scope.spawn(move |_| work());
        }
        work();
    });
}
