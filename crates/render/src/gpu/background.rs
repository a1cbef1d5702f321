//! Work on a separate thread, such as compiling a shader, that no picture has to wait for.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, OnceLock};
use std::thread::{self, JoinHandle};

/// A value that a thread builds or has built. Dropping it waits for the thread.
#[derive(Debug)]
pub(crate) struct BackgroundBuild<T> {
    /// The value, or the error message.
    outcome: Arc<OnceLock<Result<T, String>>>,
    thread: Option<JoinHandle<()>>,
}

impl<T: Send + Sync + 'static> BackgroundBuild<T> {
    /// Starts to build a value on a named thread. A panic of `work` counts as a failure, as does a failure to start the
    /// thread.
    pub(crate) fn start(
        name: &str,
        work: impl FnOnce() -> Result<T, String> + Send + 'static,
    ) -> Self {
        let outcome = Arc::new(OnceLock::new());
        let result = outcome.clone();
        let work = move || {
            let built = catch_unwind(AssertUnwindSafe(work));
            let built = built.unwrap_or_else(|_| Err("internal error: building it failed".into()));
            // Only this thread sets it.
            let _ = result.set(built);
        };
        let thread = thread::Builder::new().name(name.to_owned()).spawn(work);
        if let Err(error) = &thread {
            // Without a thread, nothing else sets it.
            let _ = outcome.set(Err(error.to_string()));
        }
        Self {
            outcome,
            thread: thread.ok(),
        }
    }
}

impl<T> BackgroundBuild<T> {
    /// Returns true until the value is built or has failed.
    pub(crate) fn is_building(&self) -> bool {
        self.outcome.get().is_none()
    }

    /// Returns the value or the error message; `None` while it is being built.
    pub(crate) fn get(&self) -> Option<&Result<T, String>> {
        self.outcome.get()
    }

    /// Waits until the value is built or has failed.
    pub(crate) fn wait(&self) {
        self.outcome.wait();
    }
}

impl<T> Drop for BackgroundBuild<T> {
    fn drop(&mut self) {
        // The process may end next, which unloads the driver: a thread that still uses it would crash the process.
        if let Some(thread) = self.thread.take() {
            // A panic of the thread has already been reported.
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::BackgroundBuild;

    #[test]
    fn a_value_is_built_once_it_has_been_waited_for() {
        let value = BackgroundBuild::start("test", || Ok(7));
        value.wait();
        assert!(!value.is_building());
        assert_eq!(value.get(), Some(&Ok(7)));
    }

    #[test]
    fn a_panic_is_a_failure_that_ends_waiting() {
        let value = BackgroundBuild::<u8>::start("test", || panic!("a fault"));
        value.wait();
        let failure = value.get().and_then(|it| it.as_ref().err());
        assert!(failure.is_some_and(|it| it.starts_with("internal error")));
    }
}
