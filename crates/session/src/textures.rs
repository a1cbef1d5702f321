//! Images for surfaces: the texture of each choice, and the images that programs name.
//!
//! In: choices, and the names of images in a scene. Out: textures. The images come from an [`ImageSource`]: files of a
//! computer, or bytes that a page was given.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use render::shared::Shared;
use render::texture::Texture;
use scene::Scene;

use crate::choices::TextureChoice;

/// Finds images and reads them.
pub trait ImageSource {
    /// Returns the file that a program names by a word, whether it can be read or not; `None` if the word cannot name a
    /// file.
    fn file_of(&self, word: &str) -> Option<PathBuf>;

    /// Returns whether the file that a program names by a word exists now.
    fn has(&self, word: &str) -> bool;

    /// Reads an image that the user has not chosen directly: at once, or so that the library receives it later by
    /// [`Library::take`].
    fn read(&mut self, path: &Path) -> ImageState;
}

/// An image file that was read.
#[derive(Debug)]
pub struct TextureRead {
    /// The file.
    pub path: PathBuf,
    /// Its texture, or a sentence that says why there is none.
    pub texture: Result<Arc<Texture>, String>,
}

/// The state of an image of the library.
#[derive(Clone, Debug)]
pub enum ImageState {
    /// It is being read.
    Reading,
    /// It has been read.
    Ready(Arc<Texture>),
    /// It cannot be read; the sentence says why.
    Failed(String),
}

/// The images that have been read from a source.
#[derive(Debug, Default)]
pub struct Library<S> {
    images: BTreeMap<PathBuf, ImageState>,
    /// The files for the words by which programs name images.
    named: BTreeMap<String, Option<PathBuf>>,
    /// The source that reads them.
    pub source: S,
}

impl<S: ImageSource> Library<S> {
    /// Returns an empty library.
    pub fn new(source: S) -> Self {
        Self {
            images: BTreeMap::new(),
            named: BTreeMap::new(),
            source,
        }
    }

    /// Returns the texture of a choice. An image that has not been read is requested, and shows nothing until it
    /// arrives.
    pub fn texture(&mut self, choice: &TextureChoice) -> Option<Arc<Texture>> {
        match choice {
            TextureChoice::Default | TextureChoice::Curvature => None,
            TextureChoice::Plain => Some(Texture::plain()),
            TextureChoice::Image(path) => {
                if !self.images.contains_key(path) {
                    let state = self.source.read(path);
                    self.put(path.clone(), state);
                }
                match self.images.get(path) {
                    Some(ImageState::Ready(texture)) => Some(Arc::clone(texture)),
                    _ => None,
                }
            }
        }
    }

    /// Returns the images that a scene names and that have been read; the others are requested.
    pub fn named(&mut self, scene: &Scene) -> Vec<(String, Shared<Texture>)> {
        let mut images = Vec::new();
        for word in scene.image_words() {
            let (files, source) = (&mut self.named, &self.source);
            let file = files
                .entry(word.to_owned())
                .or_insert_with(|| source.file_of(word));
            let choice = file.clone().map(TextureChoice::Image);
            let texture = choice.and_then(|choice| self.texture(&choice));
            images.extend(texture.map(|texture| (word.to_owned(), texture.into())));
        }
        images
    }

    /// Drops all images: another program is shown, whose words name other files.
    pub fn forget(&mut self) {
        self.images.clear();
        self.named.clear();
    }

    /// Looks again for the files of named images that were missing.
    pub fn look_again(&mut self) {
        let (images, source) = (&mut self.images, &self.source);
        self.named.retain(|word, file| {
            let failed = |file: &PathBuf| matches!(images.get(file), Some(ImageState::Failed(_)));
            let Some(file) = file.as_ref().filter(|file| failed(file)) else {
                return true;
            };
            let is_missing = !source.has(word);
            if !is_missing {
                images.remove(file);
            }
            is_missing
        });
    }

    /// Returns the sentence about an image that cannot be read.
    pub fn trouble(&self, path: &Path) -> Option<&str> {
        match self.images.get(path) {
            Some(ImageState::Failed(sentence)) => Some(sentence),
            _ => None,
        }
    }

    /// Sets the state of an image, and replaces an earlier one: the user has chosen the image, or a page has its bytes.
    pub fn put(&mut self, path: PathBuf, state: ImageState) {
        self.images.insert(path, state);
    }

    /// Takes over an image that was read. Returns the error sentence if it cannot be used.
    pub fn take(&mut self, read: TextureRead) -> Option<String> {
        let (state, trouble) = match read.texture {
            Ok(texture) => (ImageState::Ready(texture), None),
            Err(sentence) => (ImageState::Failed(sentence.clone()), Some(sentence)),
        };
        self.put(read.path, state);
        trouble
    }
}
