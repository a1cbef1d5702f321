//! Images for surfaces: each file is read once, on a thread of its own.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};

use image::RgbaImage;
use render::texture::Texture;

use crate::mail::{Letter, Mail};
use crate::model::Choice;

/// What has been read.
#[derive(Debug, Default)]
pub(crate) struct Library {
    images: BTreeMap<PathBuf, State>,
    mail: Option<Mail>,
}

#[derive(Debug)]
enum State {
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
    pub(crate) fn new(mail: Mail) -> Self {
        Self {
            images: BTreeMap::new(),
            mail: Some(mail),
        }
    }

    /// The texture of a choice. An image that has not been read is sent for, and shows nothing until it comes.
    pub(crate) fn texture(&mut self, choice: &Choice) -> Option<Arc<Texture>> {
        match choice {
            Choice::Default | Choice::Curvature => None,
            Choice::Plain => Some(PLAIN.clone()),
            Choice::Image(path) => match self.images.get(path) {
                Some(State::Ready(texture)) => Some(texture.clone()),
                Some(State::Reading | State::Failed(_)) => None,
                None => {
                    self.read(path.clone());
                    None
                }
            },
        }
    }

    /// Why an image is not shown.
    pub(crate) fn trouble(&self, path: &Path) -> Option<&str> {
        match self.images.get(path) {
            Some(State::Failed(sentence)) => Some(sentence),
            _ => None,
        }
    }

    /// Reads an image, again if it has been read before.
    pub(crate) fn read(&mut self, path: PathBuf) {
        let Some(mail) = self.mail.clone() else {
            return;
        };
        self.images.insert(path.clone(), State::Reading);
        std::thread::spawn(move || {
            let texture = Texture::load(&path).map(Arc::new);
            let texture = texture.map_err(|error| error.to_string());
            mail.send(Letter::Texture { path, texture });
        });
    }

    /// Takes over what a thread has read.
    pub(crate) fn take(&mut self, path: PathBuf, texture: Result<Arc<Texture>, String>) {
        let state = match texture {
            Ok(texture) => State::Ready(texture),
            Err(sentence) => State::Failed(sentence),
        };
        self.images.insert(path, state);
    }
}
