//! The event channel between threads and window: each part sends events of its own type, and the window receives them
//! as one type.
//!
//! An [`EventSender`] is generic over its event type, so that a part knows nothing of the parts above it. The window
//! creates one sender for its own event type and derives a sender for each part from it ([`EventSender::for_part`]). An
//! event wakes the window, unless another one is about to follow.

use std::fmt;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use session::StatusMessage;

/// Sends events of one type to the window; cheap to clone.
pub(crate) struct EventSender<T> {
    deliver: Arc<dyn Fn(T) -> bool + Send + Sync>,
    waker: Arc<Waker>,
}

/// Wakes the window.
#[derive(Debug, Default)]
struct Waker {
    context: Mutex<egui::Context>,
    /// True while the window waits for events and need not be woken.
    listens: AtomicBool,
}

impl<T> Clone for EventSender<T> {
    fn clone(&self) -> Self {
        Self {
            deliver: Arc::clone(&self.deliver),
            waker: Arc::clone(&self.waker),
        }
    }
}

impl<T> fmt::Debug for EventSender<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("EventSender").finish_non_exhaustive()
    }
}

impl<T: Send + 'static> EventSender<T> {
    /// Returns the channel of a window.
    pub(crate) fn new(context: egui::Context) -> (Self, Receiver<T>) {
        let (sender, receiver) = channel();
        let events = Self {
            deliver: Arc::new(move |event| sender.send(event).is_ok()),
            waker: Arc::new(Waker {
                context: Mutex::new(context),
                listens: AtomicBool::new(false),
            }),
        };
        (events, receiver)
    }

    /// Returns a sender for a part whose events are converted to this type by `wrap`.
    pub(crate) fn for_part<U>(
        &self,
        wrap: impl Fn(U) -> T + Send + Sync + 'static,
    ) -> EventSender<U> {
        let deliver = Arc::clone(&self.deliver);
        EventSender {
            deliver: Arc::new(move |event| deliver(wrap(event))),
            waker: Arc::clone(&self.waker),
        }
    }
}

impl<T> EventSender<T> {
    /// Sends an event and wakes the window. Returns false if the window no longer exists.
    pub(crate) fn send(&self, event: T) -> bool {
        let sent = (self.deliver)(event);
        if !self.waker.listens.load(Ordering::SeqCst) {
            self.wake();
        }
        sent
    }

    /// Sends an event without waking the window, since another one follows. Returns false if the window no longer
    /// exists.
    pub(crate) fn send_quietly(&self, event: T) -> bool {
        (self.deliver)(event)
    }

    /// Sets whether the window waits for events. When it stops waiting, it must check once more: events that were sent
    /// before have not woken it.
    pub(crate) fn listen(&self, listens: bool) {
        self.waker.listens.store(listens, Ordering::SeqCst);
    }

    /// Wakes the window, which has something to process.
    pub(crate) fn wake(&self) {
        let context = self.waker.context.lock();
        let context = context.unwrap_or_else(PoisonError::into_inner);
        // Immediately, but only once: without any delay it would be drawn twice.
        context.request_repaint_after(Duration::from_nanos(1));
    }

    /// Redirects future events to the window of another context.
    pub(crate) fn readdress(&self, context: egui::Context) {
        let own = self.waker.context.lock();
        *own.unwrap_or_else(PoisonError::into_inner) = context;
    }
}

/// Starts a thread with a name.
///
/// # Errors
/// The system's error.
pub(crate) fn start_thread(
    name: &str,
    work: impl FnOnce() + Send + 'static,
) -> io::Result<JoinHandle<()>> {
    let thread = std::thread::Builder::new().name(name.to_owned());
    thread.spawn(work)
}

/// Does slow work on a thread of its own, and sends the resulting sentence.
pub(crate) fn report_when_done(
    events: EventSender<StatusMessage>,
    work: impl FnOnce() -> Result<String, String> + Send + 'static,
) {
    let failures = events.clone();
    let thread = start_thread("work", move || {
        // A panic is reported too.
        let done = catch_unwind(AssertUnwindSafe(work));
        let done = done.unwrap_or_else(|_| Err("internal error: it was not done".to_owned()));
        events.send(match done {
            Ok(text) => StatusMessage::info(text),
            Err(text) => StatusMessage::error(text),
        });
    });
    if let Err(error) = thread {
        failures.send(StatusMessage::error(format!("it is not done: {error}")));
    }
}

#[cfg(test)]
mod tests {
    use session::StatusMessage;

    use super::{EventSender, report_when_done};

    #[test]
    fn what_becomes_of_a_work_is_reported_also_where_it_fails() {
        let (sender, events) = EventSender::new(egui::Context::default());
        let next = || -> StatusMessage { events.recv().expect("an event") };
        report_when_done(sender.clone(), || Ok("done".to_owned()));
        assert_eq!(next(), StatusMessage::info("done"));
        report_when_done(sender.clone(), || Err("no room".to_owned()));
        assert_eq!(next(), StatusMessage::error("no room"));
        report_when_done(sender, || panic!("a fault"));
        let StatusMessage { kind, text } = next();
        assert!(
            kind == session::MessageKind::Failed && text.starts_with("internal error"),
            "{text}"
        );
    }

    #[test]
    fn a_parts_events_arrive_as_events_of_the_window() {
        #[derive(Debug, Eq, PartialEq)]
        enum Event {
            Number(u32),
            Text(String),
        }
        let (sender, events) = EventSender::new(egui::Context::default());
        sender.for_part(Event::Number).send(7);
        sender.for_part(Event::Text).send("a".to_owned());
        let all: Vec<Event> = events.try_iter().collect();
        assert_eq!(all, [Event::Number(7), Event::Text("a".to_owned())]);
    }
}
