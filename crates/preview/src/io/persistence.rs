//! The window's state between runs: a small JSON file beside the program's.
//!
//! `dir/name.gtr` has `dir/.name.gtr.geotrace.json`. The file holds a [`Choices`], the layouts of the panes, and a format
//! number. Missing entries have their defaults, unknown ones are skipped, and invalid ones are left out. A file that
//! cannot be read is renamed before a new one is written.

use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use export::whole_file::{phrase, write_whole_created};
use render::figure::{Figure, FigureKind};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use session::layout::Layout;
use session::measuring::PlacedFigure;
use session::{Choices, StatusMessage};

use crate::channel::{EventSender, start_thread};

/// The number of the format that is written.
const FORMAT: u32 = 1;
/// The maximum length of a file that is read, in bytes.
const MOST_BYTES: u64 = 4 << 20;
/// The maximum number of unreadable files that are kept; a further one replaces the first.
const MOST_ASIDE: usize = 9;

#[derive(Debug, Deserialize, Serialize)]
struct Remembered {
    format: u32,
    #[serde(flatten)]
    known: Known,
}

/// The part of the window's state that is remembered for a program.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub(crate) struct Known {
    /// The user's choices of what is shown.
    #[serde(rename = "view")]
    pub(crate) choices: Choices,
    /// The layouts of the panes, for a standalone window and for one beside an editor.
    #[serde(default)]
    pub(crate) layouts: BTreeMap<String, Value>,
    /// The lines that are drawn on surfaces besides those of the program.
    #[serde(default)]
    pub(crate) drawn: Drawn,
}

/// The lines that are drawn on surfaces: a measured figure, and the paths of walks.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(default)]
pub(crate) struct Drawn {
    /// The figure.
    pub(crate) figure: Option<DrawnFigure>,
    /// The points (u, v) of paths, by surface name; paths too long for a command line are left out.
    pub(crate) paths: BTreeMap<String, Vec<[f64; 2]>>,
}

/// A figure on a surface.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub(crate) struct DrawnFigure {
    surface: String,
    kind: String,
    places: Vec<[f64; 2]>,
    #[serde(default)]
    radius: Option<f64>,
}

impl From<&PlacedFigure> for DrawnFigure {
    fn from(PlacedFigure { surface, figure }: &PlacedFigure) -> Self {
        Self {
            surface: surface.clone(),
            kind: figure.kind.name().to_owned(),
            places: figure.places.clone(),
            radius: figure.radius,
        }
    }
}

impl DrawnFigure {
    /// Returns the figure; `None` if the saved one is invalid.
    pub(crate) fn placed(&self) -> Option<PlacedFigure> {
        let kind = FigureKind::ALL
            .into_iter()
            .find(|it| it.name() == self.kind)?;
        let numbers = self.places.iter().flatten().chain(&self.radius);
        let is_sane = self.places.len() <= kind.places() && { numbers }.all(|x| x.is_finite());
        is_sane.then(|| PlacedFigure {
            surface: self.surface.clone(),
            figure: Figure {
                kind,
                places: self.places.clone(),
                radius: self.radius,
            },
        })
    }
}

/// Returns the file that remembers a program's view.
pub(crate) fn place(program: &Path) -> Option<PathBuf> {
    let name = program.file_name()?.to_str()?;
    Some(program.with_file_name(format!(".{name}.geotrace.json")))
}

/// The reason why nothing is remembered of a program.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) enum NotKnown {
    /// There is no file.
    NoFile,
    /// The file cannot be read; the system's message.
    Unreadable(PathBuf, String),
    /// The file is damaged, or of a later version.
    Unusable(PathBuf, String),
}

impl fmt::Display for NotKnown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoFile => write!(f, "the window has no saved view of this program"),
            Self::Unreadable(place, reason) => write!(
                f,
                "the saved view cannot be read (`{}`: {reason})",
                place.display()
            ),
            Self::Unusable(place, reason) => write!(
                f,
                "the saved view cannot be used (`{}`: {reason})",
                place.display()
            ),
        }
    }
}

/// Reads the saved state, and changes nothing.
///
/// # Errors
/// See [`NotKnown`].
pub(crate) fn read(program: &Path) -> Result<Known, NotKnown> {
    let place = place(program).ok_or(NotKnown::NoFile)?;
    // Writing through a link would replace a file that the window did not create.
    if place.is_symlink() {
        return Err(NotKnown::Unusable(place, "it is a link".into()));
    }
    let bytes =
        ide::limited::read_file(&place, MOST_BYTES).map_err(|error| match error.kind() {
            std::io::ErrorKind::NotFound => NotKnown::NoFile,
            _ => NotKnown::Unreadable(place.clone(), phrase(&error.to_string())),
        })?;
    match serde_json::from_slice::<Remembered>(&bytes) {
        Ok(Remembered { format, known }) if format <= FORMAT => {
            let choices = known.choices.sane();
            Ok(Known { choices, ..known })
        }
        Ok(_) => Err(NotKnown::Unusable(place, "it is of a later version".into())),
        Err(error) => Err(NotKnown::Unusable(place, error.to_string())),
    }
}

/// Reads the saved state; returns the default, with a sentence, if the file cannot be read.
pub(crate) fn load(program: &Path) -> (Known, Option<String>) {
    let sentence = match read(program) {
        Ok(known) => return (known, None),
        Err(NotKnown::NoFile) => None,
        Err(NotKnown::Unusable(place, reason)) => Some(set_aside(&place, &reason)),
        Err(unreadable) => Some(unreadable.to_string()),
    };
    (Known::default(), sentence)
}

/// Renames a file that cannot be read, so that it is not lost when the window writes its own.
fn set_aside(place: &Path, reason: &str) -> String {
    let free = |aside: &PathBuf| aside.symlink_metadata().is_err();
    let aside = place.with_extension("json.unreadable");
    let numbered = (2..).map(|k| place.with_extension(format!("json.unreadable-{k}")));
    let aside = std::iter::once(aside.clone())
        .chain(numbered.take(MOST_ASIDE - 1))
        .find(free)
        .unwrap_or(aside);
    let kept = match std::fs::rename(place, &aside) {
        Ok(()) => format!("it is kept as `{}`", aside.display()),
        Err(_) => format!("see `{}`", place.display()),
    };
    format!("the saved view cannot be used ({reason}); {kept}")
}

/// Writes the state, completely or not at all.
///
/// # Errors
/// A sentence; the previous file is kept.
pub(crate) fn save(program: &Path, known: &Known) -> Result<(), String> {
    let Some(place) = place(program) else {
        return Ok(());
    };
    let remembered = Remembered {
        format: FORMAT,
        known: known.clone(),
    };
    let text = serde_json::to_vec_pretty(&remembered).map_err(|error| error.to_string())?;
    let written = write_whole_created(&place, crate::platform::create_hidden, &text);
    written.map_err(|error| {
        let reason = phrase(&error.to_string());
        format!("the view cannot be saved (`{}`: {reason})", place.display())
    })
}

/// The time for which a view must stay unchanged before it is written.
const QUIET: Duration = Duration::from_millis(400);
/// The maximum time for which an animation delays writing.
const LONGEST: Duration = Duration::from_secs(5);

/// Writes the view when it has changed, on a thread of its own; and once more, if necessary, when it is dropped.
#[derive(Debug)]
pub(crate) struct ViewStore {
    last: Known,
    sender: Option<Sender<Known>>,
    thread: Option<JoinHandle<()>>,
}

impl ViewStore {
    /// Starts to save the view of a program; `known` is the state that is already saved.
    pub(crate) fn start(
        program: PathBuf,
        known: Known,
        events: EventSender<StatusMessage>,
    ) -> Self {
        let (sender, views) = channel::<Known>();
        let mut written = Known {
            choices: kept(&known.choices),
            ..known
        };
        let last = written.clone();
        let failures = events.clone();
        let thread = start_thread("view store", move || {
            while let Ok(mut view) = views.recv() {
                let begun = Instant::now();
                let closed = loop {
                    match views.recv_timeout(QUIET) {
                        Ok(next) => view = next,
                        Err(RecvTimeoutError::Timeout) => break false,
                        Err(RecvTimeoutError::Disconnected) => break true,
                    }
                    if begun.elapsed() > LONGEST {
                        break false;
                    }
                };
                if view != written {
                    match save(&program, &view) {
                        Ok(()) => written = view,
                        Err(text) => {
                            events.send(StatusMessage::error(text));
                        }
                    }
                }
                if closed {
                    return;
                }
            }
        });
        if let Err(error) = &thread {
            let sentence = format!("the view is not saved: {error}");
            failures.send(StatusMessage::error(sentence));
        }
        Self {
            last,
            sender: Some(sender),
            thread: thread.ok(),
        }
    }

    /// Queues a view to be saved, and the layout of the panes in a kind of window if they were arranged, without
    /// waiting.
    pub(crate) fn keep(
        &mut self,
        choices: &Choices,
        drawn: Drawn,
        window: &str,
        layout: Option<&Layout>,
    ) {
        let mut next = Known {
            choices: kept(choices),
            drawn,
            layouts: self.last.layouts.clone(),
        };
        if let Some(Ok(layout)) = layout.map(serde_json::to_value) {
            next.layouts.insert(window.to_owned(), layout);
        }
        if next == self.last {
            return;
        }
        self.last = next.clone();
        if let Some(sender) = &self.sender {
            let _ = sender.send(next);
        }
    }
}

impl Drop for ViewStore {
    fn drop(&mut self) {
        self.sender = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Returns the part of a view that the user has chosen, without cameras that the user has not moved.
fn kept(choices: &Choices) -> Choices {
    let mut choices = choices.clone();
    choices.space = choices.space.filter(|camera| camera.moved);
    choices.inside.retain(|_, camera| camera.is_moved());
    choices
}

#[cfg(test)]
mod tests {
    use session::{Choices, Look, TextureChoice};

    use super::{Drawn, DrawnFigure, Known, load, place, save};

    fn known() -> Known {
        let mut choices = Choices::default();
        choices.params.insert("a".into(), vec![Some(0.5), None]);
        let look = Look {
            colour: Some([1, 2, 3]),
            texture: TextureChoice::Image("map.png".into()),
            flipped: false,
            hidden: true,
        };
        choices.looks.insert("s".into(), look);
        let layouts = [("alone".to_owned(), serde_json::json!({"pane": "space"}))];
        Known {
            choices,
            layouts: layouts.into(),
            drawn: Drawn {
                figure: Some(DrawnFigure {
                    surface: "s".into(),
                    kind: "circle".into(),
                    places: vec![[0.25, 1.5]],
                    radius: Some(0.5),
                }),
                paths: [("s".to_owned(), vec![[0.0, 1.0], [0.5, 1.25]])].into(),
            },
        }
    }

    #[test]
    fn a_view_comes_back_as_it_was() {
        let folder = tempfile::tempdir().expect("a folder");
        let program = folder.path().join("a.gtr");
        assert_eq!(load(&program), (Known::default(), None));
        save(&program, &known()).expect("written");
        assert_eq!(load(&program), (known(), None));
        let files = std::fs::read_dir(folder.path()).expect("a folder").count();
        assert_eq!(files, 1, "nothing but the file is left behind");
    }

    #[cfg(windows)]
    #[test]
    fn the_file_is_hidden_until_somebody_shows_it() {
        use std::os::windows::fs::MetadataExt as _;
        let folder = tempfile::tempdir().expect("a folder");
        let program = folder.path().join("a.gtr");
        let beside = place(&program).expect("a name");
        let attributes = || beside.metadata().expect("written").file_attributes();
        for _ in 0..2 {
            save(&program, &known()).expect("written");
            assert_eq!(attributes() & 0x2, 0x2);
        }
        assert_eq!(load(&program), (known(), None));
    }

    #[test]
    fn a_broken_file_is_kept_and_reported() {
        let folder = tempfile::tempdir().expect("a folder");
        let program = folder.path().join("a.gtr");
        let beside = place(&program).expect("a name");
        std::fs::write(&beside, "{ not json").expect("written");
        let (loaded, sentence) = load(&program);
        assert_eq!(loaded, Known::default());
        assert!(sentence.expect("a sentence").contains("it is kept as"));
        save(&program, &known()).expect("written");
        let kept = beside.with_extension("json.unreadable");
        assert_eq!(std::fs::read_to_string(kept).expect("kept"), "{ not json");
    }

    #[test]
    fn each_broken_file_is_kept() {
        let folder = tempfile::tempdir().expect("a folder");
        let program = folder.path().join("a.gtr");
        let beside = place(&program).expect("a name");
        for text in ["first", "second"] {
            std::fs::write(&beside, text).expect("written");
            let _ = load(&program);
        }
        for (extension, text) in [
            ("json.unreadable", "first"),
            ("json.unreadable-2", "second"),
        ] {
            let kept = std::fs::read_to_string(beside.with_extension(extension));
            assert_eq!(kept.expect("kept"), text);
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_not_written_through() {
        let folder = tempfile::tempdir().expect("a folder");
        let program = folder.path().join("a.gtr");
        let beside = place(&program).expect("a name");
        let other = folder.path().join("settings.json");
        let text = r#"{"format": 1, "view": {}, "layouts": {}, "other": 7}"#;
        std::fs::write(&other, text).expect("written");
        std::os::unix::fs::symlink(&other, &beside).expect("a link");
        let (_, sentence) = load(&program);
        assert!(sentence.expect("a sentence").contains("it is a link"));
        save(&program, &known()).expect("written");
        assert_eq!(std::fs::read_to_string(&other).expect("kept"), text);
        assert_eq!(load(&program).0, known());
    }

    #[test]
    fn a_file_of_a_later_version_is_kept_and_reported() {
        let folder = tempfile::tempdir().expect("a folder");
        let program = folder.path().join("a.gtr");
        let beside = place(&program).expect("a name");
        std::fs::write(&beside, r#"{"format": 99, "view": {}}"#).expect("written");
        assert!(
            load(&program)
                .1
                .expect("a sentence")
                .contains("later version")
        );
    }
}
