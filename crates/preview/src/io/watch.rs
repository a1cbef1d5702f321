//! A watched file: its text is sent to the window whenever it changes.
//!
//! The system watches the file's folder, since many editors write a new file and rename it; for a symbolic link, also
//! that of the file to which it leads. A burst of changes is read once, after a short delay; an endless burst is read
//! periodically. A folder that disappears, as when a branch is switched, is looked for until it exists again.

use std::fmt;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::{Duration, Instant};

use export::whole_file::phrase;
use ide::language::LONGEST_PROGRAM;
use ide::limited::read_file;
use notify::{RecommendedWatcher, RecursiveMode, Watcher};

use crate::channel::{EventSender, start_thread};

/// The time without changes after which the file is read.
const QUIET: Duration = Duration::from_millis(30);
/// The maximum time from a change until the file is read, even if it keeps changing.
const LONGEST_BURST: Duration = Duration::from_millis(300);
/// The time after which a missing file is looked for again.
const ABSENCE: Duration = Duration::from_millis(500);
/// The maximum number of links that are followed, as on Linux.
const MOST_LINKS: usize = 40;

/// Watches a file for as long as it lives.
#[derive(Debug)]
pub(crate) struct Watch {
    _watcher: Arc<Mutex<RecommendedWatcher>>,
}

/// The file's path, and those to which links lead from it.
type Followed = Arc<Mutex<Vec<PathBuf>>>;

/// A change that the system has reported.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum FolderEvent {
    /// The file may hold another text.
    File,
    /// The folder has been removed or moved: another one may have its name.
    Folder,
}

/// The current text of a watched file.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) struct ChangedFile {
    /// The watched path: the window may show another file by now.
    pub(crate) path: PathBuf,
    /// Its text.
    pub(crate) text: Result<String, Unreadable>,
}

/// The reason why a file has no text.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) enum Unreadable {
    /// The file does not exist; the system's message.
    Missing(String),
    /// The file cannot be read; the system's message.
    Refused(String),
    /// The file is not text.
    NoText,
}

impl fmt::Display for Unreadable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing(reason) | Self::Refused(reason) => f.write_str(reason),
            Self::NoText => f.write_str("it is not UTF-8"),
        }
    }
}

/// Returns the text of a file.
///
/// # Errors
/// See [`Unreadable`].
pub(crate) fn read(path: &Path) -> Result<String, Unreadable> {
    let bytes = read_file(path, LONGEST_PROGRAM).map_err(|error| match error.kind() {
        ErrorKind::NotFound => Unreadable::Missing(phrase(&error.to_string())),
        _ => Unreadable::Refused(phrase(&error.to_string())),
    })?;
    String::from_utf8(bytes).map_err(|_| Unreadable::NoText)
}

impl Watch {
    /// Starts to watch. `known` is the text that the window has.
    ///
    /// # Errors
    /// The system's message.
    pub(crate) fn start(
        path: &Path,
        known: String,
        events: EventSender<ChangedFile>,
    ) -> Result<Self, String> {
        let watched_path = path.to_owned();
        let path = std::path::absolute(path).map_err(|error| error.to_string())?;
        let paths = links(&path);
        let followed: Followed = Arc::new(Mutex::new(paths.clone()));
        let (sender, changes) = channel();
        let watched = followed.clone();
        let handler = move |event: notify::Result<notify::Event>| {
            let Ok(event) = event else {
                // A watcher reports lost events by an error: check, to be sure.
                let _ = sender.send(FolderEvent::Folder);
                return;
            };
            if event.kind.is_access() {
                return;
            }
            let followed = lock(&watched);
            let is_folder = |it: &PathBuf| followed.iter().any(|path| folder(path) == it);
            // Some systems ignore the case of names.
            let is_file = |it: &PathBuf| {
                let mut names = followed.iter().filter_map(|path| path.file_name());
                it.file_name()
                    .is_some_and(|it| names.any(|name| it.eq_ignore_ascii_case(name)))
            };
            if event.paths.iter().any(is_folder) {
                let _ = sender.send(FolderEvent::Folder);
            } else if event.paths.iter().any(is_file) {
                let _ = sender.send(FolderEvent::File);
            }
        };
        let mut watcher =
            notify::recommended_watcher(handler).map_err(|error| error.to_string())?;
        watcher
            .watch(folder(&path), RecursiveMode::NonRecursive)
            .map_err(|error| error.to_string())?;
        for target in paths.iter().skip(1) {
            // One that does not exist is looked for.
            let _ = watcher.watch(folder(target), RecursiveMode::NonRecursive);
        }
        let watcher = Arc::new(Mutex::new(watcher));
        let weak = Arc::downgrade(&watcher);
        let thread = start_thread("watch", move || {
            let mut known: Result<String, Unreadable> = Ok(known);
            // Ends when the watcher is dropped.
            while let Some(change) = next(&changes, matches!(known, Err(Unreadable::Missing(_)))) {
                let now = links(&path);
                let is_elsewhere = now != *lock(&followed);
                if (change == FolderEvent::Folder || is_elsewhere)
                    && !watch_again(&weak, &followed, now)
                {
                    return;
                }
                let text = read(&path);
                if text == known {
                    continue;
                }
                known.clone_from(&text);
                let changed = ChangedFile {
                    path: watched_path.clone(),
                    text,
                };
                if !events.send(changed) {
                    return;
                }
            }
        });
        thread.map_err(|error| error.to_string())?;
        Ok(Self { _watcher: watcher })
    }
}

/// Waits for a change and the end of its burst; for an absent file, only for a limited time. Returns `None` when
/// watching ends.
fn next(changes: &Receiver<FolderEvent>, is_absent: bool) -> Option<FolderEvent> {
    let mut change = match is_absent {
        false => changes.recv().ok()?,
        true => match changes.recv_timeout(ABSENCE) {
            Ok(_) | Err(RecvTimeoutError::Timeout) => FolderEvent::Folder,
            Err(RecvTimeoutError::Disconnected) => return None,
        },
    };
    let begun = Instant::now();
    while begun.elapsed() < LONGEST_BURST {
        match changes.recv_timeout(QUIET) {
            Ok(FolderEvent::File) => {}
            Ok(FolderEvent::Folder) => change = FolderEvent::Folder,
            Err(RecvTimeoutError::Timeout) => break,
            Err(RecvTimeoutError::Disconnected) => return None,
        }
    }
    Some(change)
}

/// Watches the folders that have these names now, if they exist. Returns false when watching ends.
fn watch_again(
    watcher: &Weak<Mutex<RecommendedWatcher>>,
    followed: &Followed,
    now: Vec<PathBuf>,
) -> bool {
    let Some(watcher) = watcher.upgrade() else {
        return false;
    };
    let mut watcher = lock(&watcher);
    let before = std::mem::replace(&mut *lock(followed), now.clone());
    // Unwatching a folder that is no longer watched fails, and so does watching a missing one.
    for path in &before {
        let _ = watcher.unwatch(folder(path));
    }
    for path in &now {
        let _ = watcher.watch(folder(path), RecursiveMode::NonRecursive);
    }
    true
}

/// Returns a path, and those to which links lead from it, one after the other.
fn links(path: &Path) -> Vec<PathBuf> {
    let next = |path: &PathBuf| Some(folder(path).join(path.read_link().ok()?));
    let all = std::iter::successors(Some(path.to_owned()), next);
    all.take(MOST_LINKS).collect()
}

/// Returns the folder of a file.
fn folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new("/"))
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::sync::mpsc::{Receiver, channel};
    use std::time::{Duration, Instant};

    use super::{ChangedFile, FolderEvent, Unreadable, Watch, next};
    use crate::channel::EventSender;

    /// Nothing takes longer, whatever else the machine does.
    const LONG: Duration = Duration::from_secs(60);

    fn watched(path: &Path) -> (Watch, Receiver<ChangedFile>) {
        std::fs::write(path, "first").expect("written");
        let (events, received) = EventSender::new(egui::Context::default());
        let watch = Watch::start(path, "first".to_owned(), events).expect("it is watched");
        (watch, received)
    }

    /// Waits until the file is reported to have a text, or none.
    fn until(received: &Receiver<ChangedFile>, text: Option<&str>) {
        loop {
            let changed = received.recv_timeout(LONG).expect("the change is reported");
            match (changed.text, text) {
                (Ok(reported), Some(text)) if reported == text => return,
                (Err(Unreadable::Missing(_)), None) => return,
                _ => {}
            }
        }
    }

    #[test]
    fn a_file_that_never_rests_is_read_all_the_same() {
        let (sender, changes) = channel();
        let is_over = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                let begun = Instant::now();
                while !is_over.load(Ordering::Relaxed) {
                    assert!(begun.elapsed() < LONG, "the burst has no end");
                    sender.send(FolderEvent::File).expect("it is waited for");
                    std::thread::sleep(Duration::from_millis(1));
                }
            });
            assert_eq!(next(&changes, false), Some(FolderEvent::File));
            is_over.store(true, Ordering::Relaxed);
        });
    }

    #[test]
    fn a_folder_that_goes_is_watched_again_when_it_is_back() {
        let above = tempfile::tempdir().expect("a folder");
        let folder = above.path().join("folder");
        std::fs::create_dir(&folder).expect("a folder");
        let path = folder.join("a.gtr");
        let (_watch, received) = watched(&path);
        std::fs::remove_dir_all(&folder).expect("removed");
        until(&received, None);
        std::fs::create_dir(&folder).expect("a folder");
        std::fs::write(&path, "second").expect("written");
        until(&received, Some("second"));
        std::fs::write(&path, "third").expect("written");
        until(&received, Some("third"));
        // Another folder takes its place.
        std::fs::rename(&folder, above.path().join("elsewhere")).expect("renamed");
        std::fs::create_dir(&folder).expect("a folder");
        std::fs::write(&path, "fourth").expect("written");
        until(&received, Some("fourth"));
        std::fs::write(&path, "fifth").expect("written");
        until(&received, Some("fifth"));
    }

    #[cfg(unix)]
    #[test]
    fn the_file_of_a_link_is_followed_and_so_is_the_link() {
        use std::os::unix::fs::symlink;

        let above = tempfile::tempdir().expect("a folder");
        let path = |name: &str| above.path().join(name);
        for folder in ["links", "files", "others"] {
            std::fs::create_dir(path(folder)).expect("a folder");
        }
        let link = path("links/a.gtr");
        std::fs::write(path("files/b.gtr"), "first").expect("written");
        symlink("../files/c.gtr", &link).expect("a link");
        symlink("b.gtr", path("files/c.gtr")).expect("a link");
        let (_watch, received) = watched(&link);
        let change = |name: &str, text: &str| {
            std::fs::write(path(name), text).expect("written");
            until(&received, Some(text));
        };
        change("files/b.gtr", "second");
        change("links/a.gtr", "third");
        // The last link, and then the first, lead elsewhere.
        std::fs::write(path("others/d.gtr"), "fourth").expect("written");
        symlink("../others/d.gtr", path("files/new")).expect("a link");
        std::fs::rename(path("files/new"), path("files/c.gtr")).expect("renamed");
        until(&received, Some("fourth"));
        change("others/d.gtr", "fifth");
        std::fs::remove_file(&link).expect("removed");
        until(&received, None);
        symlink(path("files/b.gtr"), &link).expect("a link");
        until(&received, Some("third"));
        change("files/b.gtr", "sixth");
    }
}
