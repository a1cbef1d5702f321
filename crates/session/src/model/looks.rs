//! The default looks of objects.

use render::style::Theme;

use super::Model;
use crate::TextureChoice;

impl Model {
    /// Returns true if a surface or metric of the scene shows its curvature.
    pub(crate) fn shows_curvature(&self) -> bool {
        let objects = self.scene.iter().flat_map(|scene| &scene.objects);
        let mut manifolds = objects.filter(|object| object.shape.manifold().is_some());
        manifolds.any(|object| *self.choices.texture(&object.name) == TextureChoice::Curvature)
    }

    /// Returns the colour (sRGB) of an object for which none is chosen.
    pub fn default_colour(&self, name: &str) -> [u8; 3] {
        let own = self.scene.as_ref().and_then(|scene| {
            let (id, _) = scene.object(name)?;
            let colours = render::style::colours(scene, Theme::Screen, self.shows_curvature());
            colours.get(id.index()).copied()
        });
        own.unwrap_or(render::style::SURFACE_COLOUR)
    }
}
