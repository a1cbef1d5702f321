//! Tasks that run beside the handlers and mostly wait, and long work: on tokio's threads, or, in a browser, in turns.

#[cfg(not(target_family = "wasm"))]
pub(crate) use threads::{spawn, work};

#[cfg(target_family = "wasm")]
pub(crate) use turns::{run, spawn, turn, work};

/// The work has panicked.
#[derive(Debug)]
pub(crate) struct Panicked;

#[cfg(not(target_family = "wasm"))]
mod threads {
    use tokio::task::JoinHandle;

    use super::Panicked;

    /// Starts a task.
    pub(crate) fn spawn(task: impl Future<Output = ()> + Send + 'static) {
        tokio::spawn(task);
    }

    /// Does work on a worker. Work that has not started when its result is no longer awaited never starts.
    pub(crate) async fn work<T: Send + 'static>(
        work: impl FnOnce() -> T + Send + 'static,
    ) -> Result<T, Panicked> {
        let mut worker = Worker(tokio::task::spawn_blocking(work));
        (&mut worker.0).await.map_err(|_| Panicked)
    }

    /// Cancels its work when it is dropped.
    struct Worker<T>(JoinHandle<T>);

    impl<T> Drop for Worker<T> {
        fn drop(&mut self) {
            self.0.abort();
        }
    }
}

/// Messages come first: work waits for a turn, so that an edit that has arrived meanwhile is applied before the work
/// starts.
#[cfg(target_family = "wasm")]
mod turns {
    use std::cell::RefCell;
    use std::collections::VecDeque;

    use futures::channel::oneshot;
    use futures::executor::{LocalPool, LocalSpawner};
    use futures::task::LocalSpawnExt;

    use super::Panicked;

    type Work = Box<dyn FnOnce()>;

    thread_local! {
        static POOL: RefCell<LocalPool> = RefCell::default();
        static SPAWNER: LocalSpawner = POOL.with_borrow(LocalPool::spawner);
        static WORK: RefCell<VecDeque<Work>> = RefCell::default();
    }

    /// Starts a task.
    pub(crate) fn spawn(task: impl Future<Output = ()> + 'static) {
        // Fails only when the thread ends.
        let _ = SPAWNER.with(|spawner| spawner.spawn_local(task));
    }

    /// Does work in a turn of its own. Work that has not started when its result is no longer awaited never starts.
    pub(crate) async fn work<T: 'static>(
        work: impl FnOnce() -> T + 'static,
    ) -> Result<T, Panicked> {
        let (done, result) = oneshot::channel();
        let work = Box::new(move || {
            if !done.is_canceled() {
                let _ = done.send(work());
            }
        });
        WORK.with_borrow_mut(|waiting| waiting.push_back(work));
        result.await.map_err(|_| Panicked)
    }

    /// Runs the tasks until all of them wait.
    pub(crate) fn run() {
        POOL.with_borrow_mut(LocalPool::run_until_stalled);
    }

    /// Does the work that has waited longest. Returns false if none waits.
    pub(crate) fn turn() -> bool {
        let Some(work) = WORK.with_borrow_mut(VecDeque::pop_front) else {
            return false;
        };
        work();
        run();
        true
    }
}
