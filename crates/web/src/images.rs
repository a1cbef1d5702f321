//! The images that the page has provided, by name.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use render::texture::{TexelBudget, Texture, named_files};
use session::textures::{ImageSource, ImageState};

/// Images that were dropped on the page.
#[derive(Debug, Default)]
pub(crate) struct GivenImages {
    given: BTreeMap<PathBuf, Arc<Texture>>,
    /// The budget of texels that they share.
    pub(crate) budget: TexelBudget,
}

impl GivenImages {
    /// Adds an image under a name, replacing another one.
    pub(crate) fn give(&mut self, name: PathBuf, image: Arc<Texture>) {
        self.given.insert(name, image);
    }

    /// Returns the name of the image for a word of a program.
    fn named(&self, word: &str) -> Option<PathBuf> {
        // Dropped images have no folder, whatever path a script specifies.
        let files = named_files(word, Path::new("")).into_iter();
        let names = files.filter_map(|file| Some(PathBuf::from(file.file_name()?)));
        names.into_iter().find(|name| self.given.contains_key(name))
    }
}

impl ImageSource for GivenImages {
    fn file_of(&self, word: &str) -> Option<PathBuf> {
        let missing = || named_files(word, Path::new("")).into_iter().next();
        self.named(word).or_else(missing)
    }

    fn has(&self, word: &str) -> bool {
        self.named(word).is_some()
    }

    fn read(&mut self, path: &Path) -> ImageState {
        match self.given.get(path) {
            Some(image) => ImageState::Ready(Arc::clone(image)),
            None => {
                let name = path.display();
                ImageState::Failed(format!("there is no image `{name}`: drop it on the page"))
            }
        }
    }
}
