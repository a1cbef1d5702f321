//! The image of a surface in space: a texture, and where it ends.

use std::sync::Arc;

use super::{Sampler, Texture};

/// The image of a surface over its domain, whose width and height it has.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceImage {
    /// The texture.
    pub texture: Arc<Texture>,
    /// True for u, and for v, if the image repeats: its sides are glued, so that colours blend across them. Otherwise it ends
    /// there.
    pub repeats: [bool; 2],
}

impl SurfaceImage {
    /// Creates the image of a surface whose sides are all open.
    pub fn open(texture: Arc<Texture>) -> Self {
        Self {
            texture,
            repeats: [false; 2],
        }
    }

    /// Returns a sampler of the image about its corner.
    pub fn sampler(&self) -> Sampler<'_> {
        Sampler::new(&self.texture, [0.0; 2], [1.0; 2], self.repeats)
    }

    /// Returns samplers of the images of the instances, as [`Texture::instances`].
    pub fn samplers(&self) -> impl Iterator<Item = Sampler<'_>> {
        let textures = self.texture.instances();
        textures.map(|it| Sampler::new(it, [0.0; 2], [1.0; 2], self.repeats))
    }

    /// Returns the images of the instances; the last one is that of all further instances.
    pub fn instances(&self) -> impl Iterator<Item = Self> {
        let textures = self.texture.instances();
        textures.map(|texture| Self {
            texture: texture.clone(),
            repeats: self.repeats,
        })
    }
}
