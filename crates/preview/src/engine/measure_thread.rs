//! The thread that measures. In: questions about figures, points and walks, of which the latest of each kind wins. Out:
//! answers.
//!
//! A search for geodesics may take seconds, so it never runs on the frame's thread.

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};

use session::camera_controller::Subject;
use session::questions::{MeasureAnswer, MeasureQuestion, Measurer};

use crate::channel::{EventSender, start_thread};
use crate::queue::LatestQueue;

/// The order in which questions are answered, and the key under which the latest wins.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
enum QuestionKind {
    WayBack,
    Pointer,
    Walk,
    Figure,
}

/// Sends questions to the thread, which ends when this is dropped.
#[derive(Debug)]
pub(crate) struct MeasureThread {
    queue: LatestQueue<QuestionKind, (Subject, MeasureQuestion)>,
}

impl MeasureThread {
    /// Starts the thread.
    ///
    /// # Errors
    /// The system's error.
    pub(crate) fn start(events: EventSender<MeasureAnswer>) -> io::Result<Self> {
        let queue = LatestQueue::default();
        let own = queue.clone();
        start_thread("measure", move || work(&own, &events))?;
        Ok(Self { queue })
    }

    /// Asks a question, replacing one of its kind that has not been started.
    pub(crate) fn ask(&self, subject: Subject, question: MeasureQuestion) {
        let key = match question {
            MeasureQuestion::Pointer(..) => QuestionKind::Pointer,
            MeasureQuestion::Figure(_) => QuestionKind::Figure,
            MeasureQuestion::Walk { .. } => QuestionKind::Walk,
            MeasureQuestion::WayBack { .. } => QuestionKind::WayBack,
        };
        self.queue.push(key as u8, key, (subject, question));
    }
}

impl Drop for MeasureThread {
    fn drop(&mut self) {
        self.queue.abandon();
    }
}

fn work(
    queue: &LatestQueue<QuestionKind, (Subject, MeasureQuestion)>,
    events: &EventSender<MeasureAnswer>,
) {
    let mut measurer = Measurer::default();
    while let Some((_, (subject, question))) = queue.take() {
        // A panic must not end the thread: the question remains unanswered.
        let answered = catch_unwind(AssertUnwindSafe(|| measurer.answer(&subject, &question)));
        if let Ok(Some(answer)) = answered
            && !events.send(answer)
        {
            return;
        }
    }
}
