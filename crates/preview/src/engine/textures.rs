//! Images for surfaces: each file is read once, on one thread for all.
//!
//! The file in which a window remembers a view may come from someone else, beside a program. An image that it names is
//! opened only if it is below the program's folder, or if the user has opened it before.

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use render::texture::{TexelBudget, Texture, named_file, named_files};
use session::textures::{ImageSource, ImageState, TextureRead};

use crate::channel::{EventSender, start_thread};
use crate::io::path_list::PathList;
use crate::queue::LatestQueue;

/// The images of a window.
pub(crate) type Library = session::textures::Library<ImageFiles>;

/// Reads image files.
#[derive(Debug, Default)]
pub(crate) struct ImageFiles {
    /// The folder of the program.
    pub(crate) folder: Option<PathBuf>,
    /// The images that the user has opened, in this window or before.
    pub(crate) opened: PathList,
    /// The budget of texels that they share.
    pub(crate) budget: TexelBudget,
    events: Option<EventSender<TextureRead>>,
    /// The thread that reads, once there is something to read.
    reader: Option<ReaderThread>,
}

/// Sends paths to the thread that reads images, which ends when this is dropped.
#[derive(Debug)]
struct ReaderThread(LatestQueue<PathBuf, TexelBudget>);

impl ImageFiles {
    /// Returns a source that reads files on a thread and sends the images as events.
    pub(crate) fn new(events: EventSender<TextureRead>) -> Self {
        Self {
            events: Some(events),
            ..Self::default()
        }
    }

    fn send(&self, read: TextureRead) {
        if let Some(events) = &self.events {
            events.send(read);
        }
    }

    /// Starts to read an image.
    fn begin(&mut self, path: PathBuf) -> ImageState {
        if let Err(error) = self.queue(&path) {
            let texture = Err(format!("cannot read `{}`: {error}", path.display()));
            self.send(TextureRead { path, texture });
        }
        ImageState::Reading
    }

    /// Queues an image for the thread, and starts the thread for the first one.
    fn queue(&mut self, path: &Path) -> io::Result<()> {
        let Some(events) = &self.events else {
            return Ok(());
        };
        let reader = match &mut self.reader {
            Some(reader) => reader,
            reader => reader.insert(ReaderThread::start(events.clone())?),
        };
        reader.0.push(0, path.to_owned(), self.budget.clone());
        Ok(())
    }
}

impl ReaderThread {
    fn start(events: EventSender<TextureRead>) -> io::Result<Self> {
        let queue = LatestQueue::<PathBuf, TexelBudget>::default();
        let own = queue.clone();
        start_thread("images", move || {
            while let Some((path, budget)) = own.take() {
                // A panic must not end the thread: it becomes a sentence.
                let texture = match catch_unwind(AssertUnwindSafe(|| Texture::load(&path, &budget)))
                {
                    Ok(texture) => texture.map(Arc::new).map_err(|error| error.to_string()),
                    Err(_) => Err(format!(
                        "internal error: `{}` could not be read",
                        path.display()
                    )),
                };
                if !events.send(TextureRead { path, texture }) {
                    return;
                }
            }
        })?;
        Ok(Self(queue))
    }
}

impl Drop for ReaderThread {
    fn drop(&mut self) {
        self.0.abandon();
    }
}

impl ImageFiles {
    /// Returns true if an image exists and is not below the folder of the program.
    fn is_outside(&self, path: &Path) -> bool {
        let (Some(folder), Ok(path)) = (&self.folder, path.canonicalize()) else {
            return false;
        };
        // The folder of a bare file name is empty.
        let folder = match folder.as_os_str().is_empty() {
            true => Path::new("."),
            false => folder,
        };
        !folder
            .canonicalize()
            .is_ok_and(|folder| path.starts_with(folder))
    }
}

impl ImageSource for ImageFiles {
    fn file_of(&self, word: &str) -> Option<PathBuf> {
        let folders = self.folder.as_slice();
        // For a missing file, reading reports that it cannot be read.
        let missing = || named_files(word, folders.first()?).into_iter().next();
        named_file(word, folders).or_else(missing)
    }

    fn has(&self, word: &str) -> bool {
        named_file(word, self.folder.as_slice()).is_some()
    }

    /// Reads an image if it can be trusted; otherwise returns that it is not opened.
    fn read(&mut self, path: &Path) -> ImageState {
        if !self.is_outside(path) || self.opened.contains(path) {
            return self.begin(path.to_owned());
        }
        let path = path.to_owned();
        let sentence = format!(
            "`{}` is not opened: it lies outside the program's folder, and was not opened here before; *Open textures…* opens it",
            path.display()
        );
        let texture = Err(sentence);
        self.send(TextureRead { path, texture });
        ImageState::Reading
    }
}

/// Switches to the program in a folder, or to one without a folder.
pub(crate) fn turn_to(library: &mut Library, folder: Option<&Path>) {
    if library.source.folder.as_deref() != folder {
        library.forget();
        library.source.folder = folder.map(Path::to_owned);
    }
}

/// Reads an image that the user has chosen, again if it has been read before.
pub(crate) fn open(library: &mut Library, path: PathBuf) {
    library.source.opened.note(&path);
    let state = library.source.begin(path.clone());
    library.put(path, state);
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::mpsc::Receiver;

    use session::TextureChoice;
    use session::textures::TextureRead;

    use super::{ImageFiles, Library, open, turn_to};
    use crate::channel::EventSender;
    use crate::io::path_list::PathList;

    /// Looks at an image as a view does that a window remembers; returns the sentence if it is not opened.
    fn trouble(
        library: &mut Library,
        events: &Receiver<TextureRead>,
        path: &Path,
    ) -> Option<String> {
        assert!(
            library
                .texture(&TextureChoice::Image(path.to_owned()))
                .is_none()
        );
        library.take(events.recv().expect("an answer"))
    }

    #[test]
    fn an_image_elsewhere_is_opened_only_after_the_user_has_opened_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let [program, elsewhere, state] = ["program", "elsewhere", "state"].map(|name| {
            let folder = folder.path().join(name);
            std::fs::create_dir(&folder).expect("made");
            folder
        });
        let own = program.join("maps/own.png");
        let other = elsewhere.join("other.png");
        std::fs::create_dir(program.join("maps")).expect("made");
        for path in [&own, &other] {
            image::RgbaImage::new(2, 2).save(path).expect("written");
        }
        let library_of = |folder: &Path| {
            let (sender, events) = EventSender::new(egui::Context::default());
            let mut library = Library::new(ImageFiles::new(sender));
            library.source.folder = Some(folder.to_owned());
            library.source.opened = PathList::images(&state);
            (library, events)
        };
        let library = || library_of(&program);
        let (mut first, events) = library();
        assert_eq!(trouble(&mut first, &events, &own), None);
        // Dots lead out of the folder as well.
        for path in [&other, &program.join("../elsewhere/other.png")] {
            let sentence = trouble(&mut first, &events, path).expect("a sentence");
            assert!(sentence.contains("Open textures"), "{sentence}");
        }
        // The folder of a bare file name, and one that has vanished.
        for folder in ["", "vanished"] {
            let (mut bare, events) = library_of(Path::new(folder));
            let sentence = trouble(&mut bare, &events, &other).expect("a sentence");
            assert!(sentence.contains("Open textures"), "{sentence}");
        }
        open(&mut first, other.clone());
        assert_eq!(first.take(events.recv().expect("an answer")), None);
        assert!(
            first
                .texture(&TextureChoice::Image(other.clone()))
                .is_some()
        );
        let (mut second, events) = library();
        assert_eq!(trouble(&mut second, &events, &other), None);
        assert!(second.texture(&TextureChoice::Image(other)).is_some());
    }

    #[test]
    fn a_word_means_the_image_beside_the_program_that_is_shown() {
        let source = "surface s(u, v) = (u, v, 0), u : [0, 1], v : [0, 1], image : earth;";
        let scene = scene::geotrace::compile(source).scene.expect("a scene");
        let folder = tempfile::tempdir().expect("a folder");
        let (sender, events) = EventSender::new(egui::Context::default());
        let mut library = Library::new(ImageFiles::new(sender));
        let mut shown = |program: Option<&Path>| {
            turn_to(&mut library, program);
            if library.named(&scene).is_empty() && program.is_some() {
                library.take(events.recv().expect("an answer"));
            }
            let named = library.named(&scene);
            named
                .first()
                .map(|(_, texture)| texture.levels()[0].texels[0][0])
        };
        for shade in [10, 200] {
            let program = folder.path().join(shade.to_string());
            std::fs::create_dir(&program).expect("made");
            let image = image::RgbImage::from_pixel(2, 2, image::Rgb([shade; 3]));
            image.save(program.join("earth.png")).expect("written");
            assert_eq!(shown(Some(&program)), Some(shade));
            assert_eq!(shown(None), None, "a program without a folder");
        }
    }
}
