//! Images for surfaces: each file is read once, on a thread of its own.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};

use image::RgbaImage;
use render::texture::Texture;

use crate::channel::EventSender;
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
    events: Option<EventSender<TextureRead>>,
}

#[derive(Debug)]
enum ImageState {
    Reading,
    Ready(Arc<Texture>),
    Failed(String),
}

/// A texture that leaves a surface its colour.
static PLAIN: LazyLock<Arc<Texture>> = LazyLock::new(|| {
    let white = RgbaImage::from_pixel(1, 1, image::Rgba([255; 4]));
    Arc::new(Texture::from_image(white))
});

impl Library {
    /// An empty library.
    pub(crate) fn new(events: EventSender<TextureRead>) -> Self {
        Self {
            images: BTreeMap::new(),
            events: Some(events),
        }
    }

    /// The texture of a choice. An image that has not been read is sent for, and shows nothing until it comes.
    pub(crate) fn texture(&mut self, choice: &Choice) -> Option<Arc<Texture>> {
        match choice {
            Choice::Default | Choice::Curvature => None,
            Choice::Plain => Some(PLAIN.clone()),
            Choice::Image(path) => match self.images.get(path) {
                Some(ImageState::Ready(texture)) => Some(texture.clone()),
                Some(ImageState::Reading | ImageState::Failed(_)) => None,
                None => {
                    self.read(path.clone());
                    None
                }
            },
        }
    }

    /// Returns the sentence about an image that cannot be read.
    pub(crate) fn trouble(&self, path: &Path) -> Option<&str> {
        match self.images.get(path) {
            Some(ImageState::Failed(sentence)) => Some(sentence),
            _ => None,
        }
    }

    /// Reads an image, again if it has been read before.
    pub(crate) fn read(&mut self, path: PathBuf) {
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
