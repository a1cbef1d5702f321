//! What runs beside the handlers: tasks that mostly wait, and work that takes time. On tokio's threads, or, in a browser,
//! in turns.

#[cfg(not(target_family = "wasm"))]
pub(crate) use threads::{spawn, work};

#[cfg(target_family = "wasm")]
pub(crate) use crate::turns::{spawn, work};

/// The work has panicked.
#[derive(Debug)]
pub(crate) struct Fault;

#[cfg(not(target_family = "wasm"))]
mod threads {
    use tokio::task::JoinHandle;

    use super::Fault;

    /// Starts a task.
    pub(crate) fn spawn(task: impl Future<Output = ()> + Send + 'static) {
        tokio::spawn(task);
    }

    /// Does work on a worker. Work that has not begun when nobody waits for it any more is never begun.
    pub(crate) async fn work<T: Send + 'static>(
        work: impl FnOnce() -> T + Send + 'static,
    ) -> Result<T, Fault> {
        let mut worker = Worker(tokio::task::spawn_blocking(work));
        (&mut worker.0).await.map_err(|_| Fault)
    }

    /// Is cancelled when it is dropped.
    struct Worker<T>(JoinHandle<T>);

    impl<T> Drop for Worker<T> {
        fn drop(&mut self) {
            self.0.abort();
        }
    }
}
