//! What waits to be told to a window: never more than is worth telling, whether the window reads or not.

use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use crate::Command;

/// The most views that wait to be shown. Nobody looks at more, but an editor can ask for any number.
const MOST_VIEWS: usize = 32;

/// Commands between a thread that must not wait and one that writes (or reads) a pipe.
///
/// A text takes the place of one that still waits, and the cursors in that are dropped with it; a cursor takes the place
/// of a cursor, and a view is asked for once. Else the order stays.
#[derive(Debug, Default)]
pub struct Mailbox {
    state: Mutex<State>,
    news: Condvar,
}

#[derive(Debug, Default)]
struct State {
    waiting: VecDeque<Command>,
    closed: bool,
}

impl Mailbox {
    /// An empty one.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Puts a command in, without waiting; the text that it has taken the place of, if one still waited. In a mailbox
    /// that is closed it is dropped. Behind [`Command::Close`] nothing is worth telling: it closes the mailbox, and of
    /// what waits only the greeting is still told.
    pub fn put(&self, command: Command) -> Option<Command> {
        let mut state = self.lock();
        if state.closed {
            return None;
        }
        let superseded = state.put(command);
        drop(state);
        self.news.notify_one();
        superseded
    }

    /// Waits for the next command; `None` when the mailbox is closed and empty.
    #[must_use]
    pub fn take(&self) -> Option<Command> {
        let mut state = self.lock();
        loop {
            if let Some(command) = state.waiting.pop_front() {
                return Some(command);
            }
            if state.closed {
                return None;
            }
            state = self
                .news
                .wait(state)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// The next command, if one waits.
    #[must_use]
    pub fn try_take(&self) -> Option<Command> {
        self.lock().waiting.pop_front()
    }

    /// Nothing more comes in; what waits can still be taken.
    pub fn close(&self) {
        self.lock().closed = true;
        self.news.notify_all();
    }

    /// Whether nothing more comes in.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.lock().closed
    }

    /// How many commands wait.
    #[must_use]
    pub fn len(&self) -> usize {
        self.lock().waiting.len()
    }

    /// Whether no command waits.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn put(&mut self, command: Command) -> Option<Command> {
        match &command {
            Command::Text { .. } => {
                self.waiting
                    .retain(|waiting| !matches!(waiting, Command::Cursor { .. }));
                let old = self
                    .waiting
                    .iter_mut()
                    .find(|waiting| matches!(waiting, Command::Text { .. }));
                if let Some(old) = old {
                    // It stays before the views that may be those of its surfaces.
                    return Some(std::mem::replace(old, command));
                }
            }
            Command::Cursor { .. } => self
                .waiting
                .retain(|waiting| !matches!(waiting, Command::Cursor { .. })),
            Command::Show { .. } => {
                self.waiting.retain(|waiting| *waiting != command);
                let is_view = |waiting: &Command| matches!(waiting, Command::Show { .. });
                if self.waiting.iter().filter(|w| is_view(w)).count() >= MOST_VIEWS
                    && let Some(oldest) = self.waiting.iter().position(is_view)
                {
                    self.waiting.remove(oldest);
                }
            }
            Command::Close => {
                self.waiting
                    .retain(|waiting| matches!(waiting, Command::Hello(_)));
                self.closed = true;
            }
            Command::Hello(_) => {}
        }
        self.waiting.push_back(command);
        None
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::{MOST_VIEWS, Mailbox};
    use crate::{Command, Hello, View};

    fn text(version: i32) -> Command {
        Command::Text {
            uri: "file:///a.gtr".to_owned(),
            path: None,
            version,
            text: format!("# {version}").into(),
        }
    }

    fn cursor(version: i32, offset: u32) -> Command {
        Command::Cursor { version, offset }
    }

    fn show(surface: &str) -> Command {
        let surface = surface.to_owned();
        Command::Show {
            view: Some(View::Geodesic { surface }),
        }
    }

    fn all(mailbox: &Mailbox) -> Vec<Command> {
        std::iter::from_fn(|| mailbox.try_take()).collect()
    }

    #[test]
    fn the_latest_text_takes_the_place_of_those_that_wait_and_the_rest_keeps_its_order() {
        let mailbox = Mailbox::new();
        let hello = Command::Hello(Hello::own());
        assert_eq!(mailbox.put(hello.clone()), None);
        assert_eq!(mailbox.put(text(1)), None);
        mailbox.put(show("s"));
        mailbox.put(cursor(1, 3));
        assert_eq!(mailbox.put(text(2)), Some(text(1)));
        mailbox.put(cursor(2, 4));
        mailbox.put(show("t"));
        mailbox.put(cursor(2, 5));
        mailbox.put(show("s"));
        assert_eq!(
            all(&mailbox),
            [hello, text(2), show("t"), cursor(2, 5), show("s")]
        );
        // What has been taken is not superseded.
        assert_eq!(mailbox.put(text(3)), None);
        assert_eq!(mailbox.take(), Some(text(3)));
        assert_eq!(mailbox.put(text(4)), None);
    }

    #[test]
    fn it_does_not_grow_though_nobody_reads() {
        let mailbox = Mailbox::new();
        for version in 0..100_000 {
            mailbox.put(text(version));
            mailbox.put(cursor(version, 7));
            mailbox.put(show(&format!("s{version}")));
            mailbox.put(Command::Show { view: None });
        }
        assert!(mailbox.len() <= MOST_VIEWS + 2, "{}", mailbox.len());
        assert_eq!(mailbox.take(), Some(text(99_999)));
    }

    #[test]
    fn a_farewell_drops_all_but_the_greeting_and_closes() {
        let mailbox = Mailbox::new();
        let hello = Command::Hello(Hello::own());
        for command in [hello.clone(), text(1), show("s"), Command::Close] {
            mailbox.put(command);
        }
        mailbox.put(text(2));
        assert_eq!(all(&mailbox), [hello, Command::Close]);
        assert!(mailbox.is_closed() && mailbox.is_empty());
        assert_eq!(mailbox.take(), None);
    }

    #[test]
    fn a_reader_that_waits_gets_the_last_text_and_the_end() {
        let mailbox = Arc::new(Mailbox::new());
        let reader = std::thread::spawn({
            let mailbox = mailbox.clone();
            move || {
                let mut versions = Vec::new();
                while let Some(Command::Text { version, .. }) = mailbox.take() {
                    versions.push(version);
                }
                versions
            }
        });
        for version in 0..10_000 {
            mailbox.put(text(version));
        }
        mailbox.close();
        mailbox.put(text(10_000));
        let versions = reader.join().expect("no panic");
        assert_eq!(versions.last(), Some(&9_999));
        assert!(versions.is_sorted_by(|a, b| a < b));
    }
}
