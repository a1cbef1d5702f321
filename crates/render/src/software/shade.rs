//! The colour of a place on a triangle.

use glam::{Vec2, Vec3};

use crate::style;
use crate::texture::Sampler;

/// How triangles of one kind of one object look.
#[derive(Clone, Debug)]
pub(super) struct Material<'a> {
    pub kind: Kind<'a>,
    /// In linear light.
    pub colour: [f32; 3],
    /// How much of [`style::EMPHASIS_COLOUR`] is mixed in.
    pub emphasis: f32,
}

/// What triangles are lit as.
#[derive(Clone, Debug)]
pub(super) enum Kind<'a> {
    /// A strip or disc that faces the eye: its texture coordinates are the place in the unit disc.
    Glyph,
    /// An arrowhead.
    Cone,
    /// A surface.
    Surface(Sampler<'a>),
}

/// A place on a triangle, interpolated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub normal: Vec3,
    pub uv: Vec2,
    /// How uv changes from pixel to pixel, to the right and down.
    pub footprint: [Vec2; 2],
    /// The unit vector to the eye, in view space.
    pub to_eye: Vec3,
    /// Whether the triangle runs counterclockwise as seen.
    pub front: bool,
}

impl Material<'_> {
    /// Whether a place's normal, or footprint, matters.
    #[inline(always)]
    pub(super) fn is_surface(&self) -> bool {
        matches!(self.kind, Kind::Surface(_))
    }

    /// In linear light.
    #[inline(always)]
    pub(super) fn shade(&self, place: &Place) -> [f32; 3] {
        style::emphasised(self.lit(place), self.emphasis)
    }

    #[inline(always)]
    fn lit(&self, place: &Place) -> [f32; 3] {
        let colour = self.colour;
        match &self.kind {
            Kind::Glyph => {
                let facing = (1.0 - place.uv.length_squared().min(1.0)).sqrt();
                colour.map(|c| c * style::glyph_light(facing))
            }
            Kind::Cone => {
                let facing = place
                    .normal
                    .normalize_or(place.to_eye)
                    .dot(place.to_eye)
                    .abs();
                colour.map(|c| c * style::glyph_light(facing))
            }
            Kind::Surface(image) => {
                let normal = match place.normal.try_normalize() {
                    // The side is the triangle's: near a silhouette an interpolated normal may lean away from the
                    // eye, and turning it over there would speckle the rim.
                    Some(normal) if place.front => normal,
                    Some(normal) => -normal,
                    None => place.to_eye,
                };
                let (diffuse, white) = style::surface_light(normal.into(), place.to_eye.into());
                let [across, along] = place.footprint;
                let texel = image.colour(place.uv.into(), across.into(), along.into());
                std::array::from_fn(|k| texel[k] * colour[k] * diffuse + white)
            }
        }
    }
}
