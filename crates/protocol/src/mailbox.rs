//! The commands that wait for a window: never more than are useful, even if the window does not read.
//!
//! This is not a queue in which the latest value of a key wins: commands are composed, and an edit stays after its text
//! and before the views that are shown of it.

use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use crate::Command;

/// The maximum number of views that wait to be shown. An editor can request any number.
const MOST_VIEWS: usize = 32;

/// Commands between a thread that must not wait and one that writes (or reads) a pipe.
///
/// A text replaces one that still waits, and the edits of that text; an edit is composed with one that still waits.
/// Cursors in superseded texts are dropped. A cursor replaces a cursor, and a view is requested once. Otherwise the
/// order is preserved.
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
    /// Returns an empty mailbox.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a command without waiting. Returns the versions of the texts that will not be read because the command
    /// supersedes them. A closed mailbox drops the command. Nothing follows [`Command::Close`]: it closes the mailbox,
    /// and only a waiting greeting stays.
    pub fn put(&self, command: Command) -> Vec<i32> {
        let mut state = self.lock();
        if state.closed {
            return Vec::new();
        }
        let superseded = state.put(command);
        drop(state);
        self.news.notify_one();
        superseded
    }

    /// Returns the approximate length in a message of the edits that wait, in bytes; 0 if none do.
    #[must_use]
    pub fn waiting_edits(&self) -> usize {
        let state = self.lock();
        let edits = state.waiting.iter().filter_map(|waiting| match waiting {
            Command::Edit { changes, .. } => Some(changes.weight()),
            _ => None,
        });
        edits.sum()
    }

    /// Waits for the next command. Returns `None` when the mailbox is closed and empty.
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

    /// Closes the mailbox: no command is added any more; waiting ones can still be taken.
    pub fn close(&self) {
        self.lock().closed = true;
        self.news.notify_all();
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn put(&mut self, command: Command) -> Vec<i32> {
        // Each command determines here which waiting commands it supersedes, and where it waits.
        match &command {
            Command::Text { .. } => {
                let overtaken = self.waiting.iter().filter_map(version).collect();
                // It stays before the views, which may be of its surfaces.
                let place = self.waiting.iter().position(|it| version(it).is_some());
                let place = place.unwrap_or(self.waiting.len());
                self.waiting.insert(place, command);
                let mut index = 0;
                self.waiting.retain(|waiting| {
                    index += 1;
                    let is_cursor = matches!(waiting, Command::Cursor { .. });
                    index == place + 1 || version(waiting).is_none() && !is_cursor
                });
                return overtaken;
            }
            Command::Edit {
                version: next,
                base,
                changes,
            } => {
                let (next, base) = (*next, *base);
                for waiting in &mut self.waiting {
                    if let Command::Edit {
                        version,
                        changes: first,
                        ..
                    } = waiting
                        && *version == base
                    {
                        *first = first.then(changes);
                        *version = next;
                        self.drop_cursors();
                        return vec![base];
                    }
                }
                self.drop_cursors();
                // After the text to which it applies, before the views, which may be of its surfaces.
                let text = self.waiting.iter().position(|it| version(it) == Some(base));
                if let Some(text) = text {
                    self.waiting.insert(text + 1, command);
                    return Vec::new();
                }
            }
            Command::Cursor { .. } => self.drop_cursors(),
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
        Vec::new()
    }

    fn drop_cursors(&mut self) {
        self.waiting
            .retain(|waiting| !matches!(waiting, Command::Cursor { .. }));
    }
}

/// Returns the version of the text to which a command leads.
fn version(command: &Command) -> Option<i32> {
    match command {
        Command::Text { version, .. } | Command::Edit { version, .. } => Some(*version),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::{MOST_VIEWS, Mailbox};
    use crate::changes::Changes;
    use crate::{Command, Hello, ViewName};

    fn text(version: i32) -> Command {
        Command::Text {
            uri: "file:///a.gtr".to_owned(),
            path: None,
            version,
            text: format!("# {version}").into(),
        }
    }

    /// An edit that writes its version before the text.
    fn edit(base: i32, version: i32) -> Command {
        Command::Edit {
            version,
            base,
            changes: Changes::one([0, 0], version.to_string()),
        }
    }

    fn cursor(version: i32, offset: u32) -> Command {
        Command::Cursor { version, offset }
    }

    fn show(surface: &str) -> Command {
        Command::Show {
            view: Some(ViewName::of_object("geodesic", surface)),
        }
    }

    fn all(mailbox: &Mailbox) -> Vec<Command> {
        mailbox.lock().waiting.drain(..).collect()
    }

    #[test]
    fn the_latest_text_takes_the_place_of_those_that_wait_and_the_rest_keeps_its_order() {
        let mailbox = Mailbox::new();
        let hello = Command::Hello(Hello::own());
        assert!(mailbox.put(hello.clone()).is_empty());
        assert!(mailbox.put(text(1)).is_empty());
        mailbox.put(show("s"));
        mailbox.put(cursor(1, 3));
        assert_eq!(mailbox.put(text(2)), [1]);
        mailbox.put(cursor(2, 4));
        mailbox.put(show("t"));
        mailbox.put(cursor(2, 5));
        mailbox.put(show("s"));
        assert_eq!(
            all(&mailbox),
            [hello, text(2), show("t"), cursor(2, 5), show("s")]
        );
        // What has been taken is not superseded.
        assert!(mailbox.put(text(3)).is_empty());
        assert_eq!(mailbox.take(), Some(text(3)));
        assert!(mailbox.put(text(4)).is_empty());
    }

    #[test]
    fn edits_that_wait_are_one_and_a_text_takes_the_place_of_all() {
        let mailbox = Mailbox::new();
        mailbox.put(text(1));
        mailbox.put(show("s"));
        mailbox.put(cursor(1, 3));
        assert!(mailbox.put(edit(1, 2)).is_empty());
        mailbox.put(cursor(2, 4));
        assert_eq!(mailbox.put(edit(2, 3)), [2]);
        assert_eq!(mailbox.put(edit(3, 7)), [3]);
        mailbox.put(cursor(7, 5));
        let composed = Command::Edit {
            version: 7,
            base: 1,
            changes: Changes::one([0, 0], "732"),
        };
        assert_eq!(all(&mailbox), [text(1), composed, show("s"), cursor(7, 5)]);
        assert!(mailbox.put(edit(7, 8)).is_empty());
        assert_eq!(mailbox.waiting_edits(), 33);
        mailbox.put(show("t"));
        assert_eq!(mailbox.put(text(9)), [8]);
        assert_eq!(mailbox.waiting_edits(), 0);
        assert!(mailbox.put(edit(9, 10)).is_empty());
        assert_eq!(mailbox.put(text(11)), [9, 10]);
        assert_eq!(all(&mailbox), [text(11), show("t")]);
        // An edit of a text that was never put is not composed with others.
        mailbox.put(edit(20, 21));
        mailbox.put(edit(30, 31));
        assert_eq!(all(&mailbox), [edit(20, 21), edit(30, 31)]);
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
        let waiting = mailbox.lock().waiting.len();
        assert!(waiting <= MOST_VIEWS + 2, "{waiting}");
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
        {
            let state = mailbox.lock();
            assert!(state.closed && state.waiting.is_empty());
        }
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
