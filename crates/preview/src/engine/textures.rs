//! Images for surfaces: each file is read once, on a thread of its own.
//!
//! The file that a window remembers a view in may come from somebody else, beside a program. An image that it names is opened
//! only if it lies below the program's folder, or if the user has opened it before.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use render::shared::Shared;
use render::texture::{Texture, named_file, named_files};
use scene::Scene;

use crate::channel::EventSender;
use crate::io::path_list::PathList;
use crate::state::Choice;

/// An image file that was read: its texture, or a sentence.
#[derive(Debug)]
pub(crate) struct TextureRead {
    path: PathBuf,
    texture: Result<Arc<Texture>, String>,
}

/// The images that have been read.
#[derive(Debug, Default)]
pub(crate) struct Library {
    images: BTreeMap<PathBuf, ImageState>,
    /// The files of the words by which programs name images.
    named: BTreeMap<String, Option<PathBuf>>,
    /// The folder of the program.
    pub(crate) folder: Option<PathBuf>,
    /// The images that the user has opened, in this window or before.
    pub(crate) opened: PathList,
    events: Option<EventSender<TextureRead>>,
}

#[derive(Debug)]
enum ImageState {
    Reading,
    Ready(Arc<Texture>),
    Failed(String),
}

impl Library {
    /// An empty library.
    pub(crate) fn new(events: EventSender<TextureRead>) -> Self {
        Self {
            events: Some(events),
            ..Self::default()
        }
    }

    /// The texture of a choice. An image that has not been read is sent for, and shows nothing until it comes.
    pub(crate) fn texture(&mut self, choice: &Choice) -> Option<Arc<Texture>> {
        match choice {
            Choice::Default | Choice::Curvature => None,
            Choice::Plain => Some(Texture::plain()),
            Choice::Image(path) => match self.images.get(path) {
                Some(ImageState::Ready(texture)) => Some(texture.clone()),
                Some(ImageState::Reading | ImageState::Failed(_)) => None,
                None => {
                    self.read_if_trusted(path);
                    None
                }
            },
        }
    }

    /// The images that a scene names and that have been read; what lies beside the program is sent for.
    pub(crate) fn named(&mut self, scene: &Scene) -> Vec<(String, Shared<Texture>)> {
        let mut images = Vec::new();
        for word in scene.image_words() {
            let folders = self.folder.as_slice();
            let files = &mut self.named;
            let file = files.entry(word.to_owned()).or_insert_with(|| {
                // Reading says of a file that is not there that it cannot be read.
                let missing = || named_files(word, folders.first()?).into_iter().next();
                named_file(word, folders).or_else(missing)
            });
            let choice = file.clone().map(Choice::Image);
            let texture = choice.and_then(|choice| self.texture(&choice));
            images.extend(texture.map(|texture| (word.to_owned(), texture.into())));
        }
        images
    }

    /// Looks again for the files of images that programs name, and that were not there.
    pub(crate) fn look_again(&mut self) {
        let (images, folders) = (&mut self.images, self.folder.as_slice());
        self.named.retain(|word, file| {
            let failed = |file: &PathBuf| matches!(images.get(file), Some(ImageState::Failed(_)));
            let Some(file) = file.as_ref().filter(|file| failed(file)) else {
                return true;
            };
            let is_missing = named_file(word, folders).is_none();
            if !is_missing {
                images.remove(file);
            }
            is_missing
        });
    }

    /// Returns the sentence about an image that cannot be read.
    pub(crate) fn trouble(&self, path: &Path) -> Option<&str> {
        match self.images.get(path) {
            Some(ImageState::Failed(sentence)) => Some(sentence),
            _ => None,
        }
    }

    /// Reads an image that the user has chosen, again if it has been read before.
    pub(crate) fn open(&mut self, path: PathBuf) {
        self.opened.note(&path);
        self.read(path);
    }

    fn read_if_trusted(&mut self, path: &Path) {
        let inside = self.folder.as_deref().and_then(|folder| {
            let folder = folder.canonicalize().ok()?;
            Some(path.canonicalize().ok()?.starts_with(folder))
        });
        // Of a file that is not there, reading says so.
        if inside != Some(false) || self.opened.contains(path) {
            return self.read(path.to_owned());
        }
        let path = path.to_owned();
        let sentence = format!(
            "`{}` is not opened: it lies outside the program's folder, and was not opened here before; *Open textures…* opens it",
            path.display()
        );
        self.images.insert(path.clone(), ImageState::Reading);
        if let Some(events) = &self.events {
            let texture = Err(sentence);
            events.send(TextureRead { path, texture });
        }
    }

    fn read(&mut self, path: PathBuf) {
        let Some(events) = self.events.clone() else {
            return;
        };
        self.images.insert(path.clone(), ImageState::Reading);
        std::thread::spawn(move || {
            let texture = Texture::load(&path).map(Arc::new);
            let texture = texture.map_err(|error| error.to_string());
            events.send(TextureRead { path, texture });
        });
    }

    /// Reads an image at once, unless it has been read.
    ///
    /// # Errors
    /// The sentence about one that cannot be read.
    pub(crate) fn read_now(&mut self, path: &Path) -> Result<(), String> {
        if !self.images.contains_key(path) {
            let texture = Texture::load(path).map_err(|error| error.to_string())?;
            let state = ImageState::Ready(Arc::new(texture));
            self.images.insert(path.to_owned(), state);
        }
        Ok(())
    }

    /// Takes over an image that was read; returns the sentence about one that cannot be.
    pub(crate) fn take(&mut self, read: TextureRead) -> Option<String> {
        let (state, trouble) = match read.texture {
            Ok(texture) => (ImageState::Ready(texture), None),
            Err(sentence) => (ImageState::Failed(sentence.clone()), Some(sentence)),
        };
        self.images.insert(read.path, state);
        trouble
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::mpsc::Receiver;

    use super::{Library, TextureRead};
    use crate::channel::EventSender;
    use crate::io::path_list::PathList;
    use crate::state::Choice;

    /// Looks at an image as a view does that a window remembers; returns the sentence if it is not opened.
    fn trouble(
        library: &mut Library,
        events: &Receiver<TextureRead>,
        path: &Path,
    ) -> Option<String> {
        assert!(library.texture(&Choice::Image(path.to_owned())).is_none());
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
        let library = || {
            let (sender, events) = EventSender::new(egui::Context::default());
            let mut library = Library::new(sender);
            library.folder = Some(program.clone());
            library.opened = PathList::images(&state);
            (library, events)
        };
        let (mut first, events) = library();
        assert_eq!(trouble(&mut first, &events, &own), None);
        // Dots lead out of the folder as well.
        for path in [&other, &program.join("../elsewhere/other.png")] {
            let sentence = trouble(&mut first, &events, path).expect("a sentence");
            assert!(sentence.contains("Open textures"), "{sentence}");
        }
        first.open(other.clone());
        assert_eq!(first.take(events.recv().expect("an answer")), None);
        assert!(first.texture(&Choice::Image(other.clone())).is_some());
        let (mut second, events) = library();
        assert_eq!(trouble(&mut second, &events, &other), None);
        assert!(second.texture(&Choice::Image(other)).is_some());
    }
}
