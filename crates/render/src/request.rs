//! The picture request: a [`PictureRequest`] holds all that a picture depends on, as data that can be compared. It is
//! the same from a pane of a window, or a command line, down to what draws.

mod colours;
pub mod part;

pub(crate) use colours::{color_nodes, srgb_of};
pub use part::{ViewOptions, ViewPart};

use std::sync::Arc;

use scene::{ObjectId, ParamValues, Scene, stated_word};

use crate::bounds::ObjectCloud;
use crate::closed::ClosedSurface;
use crate::error::{MAX_SIDE, RenderError, SCALES};
use crate::shared::Shared;
use crate::style::{self, Theme};
use crate::texture::Texture;
use crate::trail::Trail;

/// One picture to be drawn. Equal requests are for equal pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureRequest {
    /// The scene.
    pub scene: Shared<Scene>,
    /// The values of its params and grids.
    pub params: Arc<ParamValues>,
    /// The view, its camera, and the options that this view alone reads.
    pub view: ViewPart,
    /// Width and height in pixels, each from 1 to [`MAX_SIDE`].
    pub size: [u32; 2],
    /// The images of surfaces, of which the last one counts; a surface that is not listed shows
    /// [`Texture::orientation`].
    pub textures: Vec<(ObjectId, Shared<Texture>)>,
    /// The images that the program names, by their words. An object shows the one that it states, unless it has another among
    /// [`PictureRequest::textures`].
    pub images: Vec<(String, Shared<Texture>)>,
    /// The image of the declared background, instead of one that it states.
    pub background_image: Option<Shared<Texture>>,
    /// Surfaces whose images lie on them the other way up: their top row is v max. Of [`Texture::orientation`], only the
    /// letters are turned over.
    pub flipped: Vec<ObjectId>,
    /// Surfaces that show their [curvature](Texture::curvature) instead. A renderer makes these textures and keeps them
    /// while the scene and its param values stay.
    pub curved: Vec<ObjectId>,
    /// The medium for which the colours of [`crate::style`] are chosen.
    pub theme: Theme,
    /// Colours (sRGB) other than those of [`crate::style`]; a surface's colour multiplies its texture.
    pub colours: Vec<(ObjectId, [u8; 3])>,
    /// The overlays that are drawn over the picture.
    pub overlays: Overlays,
    /// The factor of the widths of lines and points and of the heights of words, 1 by default; positive.
    pub scale: f32,
    /// Paths that geodesic cameras have walked: views draw them, with their lengths.
    pub trails: Vec<Shared<Trail>>,
    /// True if the view moves, and a picture at once is worth more than a fine one: then a geodesic view may be off by
    /// [`MOVING_TOLERANCE`](crate::geodesic_view::MOVING_TOLERANCE) pixels, and the software path blurs what it sees at
    /// a flat angle.
    pub moving: bool,
}

/// The overlays of a picture; none by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Overlays {
    /// A key to the hatchings and lines that the picture has.
    pub legend: bool,
    /// Geodesic circles at equal distances around the camera.
    pub wavefronts: Option<Spacing>,
    /// The conjugate points, where geodesics from the camera meet those that start beside them: the Jacobi field is
    /// zero there.
    pub conjugate_points: bool,
    /// The line beyond which a pixel's point is nearer to the camera by another way.
    pub cut_locus: bool,
    /// The estimated error, painted over the picture.
    pub error: bool,
    /// Names at what is seen.
    pub labels: bool,
    /// In space, a box around the scene with ticks.
    pub axes: bool,
    /// The hidden parts of curves and geodesics in space, dashed; only where lines are [vectors](crate::layers).
    pub hidden_lines: bool,
}

/// The distance between wavefronts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spacing {
    /// A round distance that gives about five of them.
    Auto,
    /// This distance, in the surface's units; positive.
    Every(f64),
}

/// The device that draws a picture.
#[derive(Clone, Copy, Debug, Default, Eq, Hash, PartialEq)]
pub enum Backend {
    /// A real GPU where there is one, else the software path.
    #[default]
    Auto,
    /// A GPU (a software implementation of Vulkan counts), or an error.
    Gpu,
    /// The software path.
    Software,
}

impl PictureRequest {
    /// A picture of a view, everything else at its default.
    pub fn new(
        scene: impl Into<Shared<Scene>>,
        params: impl Into<Arc<ParamValues>>,
        view: impl Into<ViewPart>,
        size: [u32; 2],
    ) -> Self {
        Self {
            scene: scene.into(),
            params: params.into(),
            view: view.into(),
            size,
            textures: Vec::new(),
            images: Vec::new(),
            background_image: None,
            flipped: Vec::new(),
            curved: Vec::new(),
            theme: Theme::default(),
            colours: Vec::new(),
            overlays: Overlays::default(),
            scale: 1.0,
            trails: Vec::new(),
            moving: false,
        }
    }

    /// The texture of a surface.
    pub fn texture(&self, object: ObjectId) -> Arc<Texture> {
        self.texture_seen(object, false)
    }

    /// The texture of a surface as the geodesic view has it: one colour would show nothing of how the surface bends.
    pub(crate) fn texture_inside(&self, object: ObjectId) -> Arc<Texture> {
        match self.own_texture(object) {
            None if self.states_colour(object) => Texture::checker(),
            _ => self.texture(object),
        }
    }

    /// The texture of a surface in space. The letters of the built-in one are read from the outside of a closed surface.
    pub fn texture_in_space(&self, object: ObjectId) -> Arc<Texture> {
        let cloud = |object| ObjectCloud::new(&self.scene, &self.params, object);
        let closed = self.scene.get(object).map(cloud);
        self.texture_of_closed(object, closed.and_then(|cloud| cloud.closed))
    }

    /// The texture of a surface in space that is closed as this says, if it is.
    pub(crate) fn texture_of_closed(
        &self,
        object: ObjectId,
        closed: Option<ClosedSurface>,
    ) -> Arc<Texture> {
        let points_inwards = closed.is_some_and(|closed| !closed.points_outwards);
        self.texture_seen(object, points_inwards)
    }

    /// The texture of a surface; `from_behind` if the built-in one is to be read from the side that σu×σv does not point
    /// to.
    fn texture_seen(&self, object: ObjectId, from_behind: bool) -> Arc<Texture> {
        let flipped = self.flipped.contains(&object);
        match self.own_texture(object) {
            // Colours of curvature have their place on the surface.
            Some(texture) if flipped && texture.curvature_scale().is_none() => texture.flipped(),
            Some(texture) => texture.arc().clone(),
            // A colour that is stated is not seen through letters.
            None if self.states_colour(object) => Texture::plain(),
            None if flipped != from_behind => Texture::orientation_from_behind(),
            None => Texture::orientation(),
        }
    }

    /// The image that was chosen for an object, else the one that it states.
    pub(crate) fn own_texture(&self, object: ObjectId) -> Option<&Shared<Texture>> {
        self.chosen_texture(object).or_else(|| {
            let attributes = &self.scene.get(object)?.attributes;
            self.image(stated_word(attributes, "image")?)
        })
    }

    /// The image that was chosen for an object.
    pub(crate) fn chosen_texture(&self, object: ObjectId) -> Option<&Shared<Texture>> {
        let mut chosen = self.textures.iter().rev();
        let (_, texture) = chosen.find(|(id, _)| *id == object)?;
        Some(texture)
    }

    /// An image that the program names.
    pub(crate) fn image(&self, word: &str) -> Option<&Shared<Texture>> {
        let (_, image) = self.images.iter().find(|(known, _)| known == word)?;
        Some(image)
    }

    /// Returns true if a surface is coloured by its curvature.
    fn shows_curvature(&self) -> bool {
        let mut textures = self.textures.iter();
        !self.curved.is_empty() || textures.any(|(_, it)| it.curvature_scale().is_some())
    }

    /// The colour of the lines of axes, sRGB: between that of the backdrop and its opposite.
    pub(crate) fn axes_colour(&self) -> [u8; 3] {
        let [r, g, b] = self.backdrop().map(u32::from);
        if r + g + b > 384 { [110; 3] } else { [165; 3] }
    }

    /// The colour behind everything, sRGB: that of the picture's backdrop where it has one.
    pub(crate) fn backdrop(&self) -> [u8; 3] {
        let background = self.view.space().and_then(|space| space.background);
        match background {
            Some([_, _, _, 0]) | None => match self.theme {
                Theme::Screen => style::BACKGROUND,
                Theme::Print => style::PAPER,
            },
            Some([r, g, b, _]) => [r, g, b],
        }
    }

    /// The options of the view that draws the request.
    ///
    /// # Errors
    /// [`RenderError::NoView`] if they are another view's, which claims this view's name.
    pub(crate) fn options<T: ViewOptions>(&self) -> Result<&T, RenderError> {
        self.view.get().ok_or_else(|| RenderError::NoView {
            name: self.view.name().to_owned(),
        })
    }

    /// The trails on a surface.
    pub fn trails_on(&self, surface: ObjectId) -> impl Iterator<Item = &Trail> {
        let trails = self.trails.iter().map(|trail| &**trail);
        trails.filter(move |trail| trail.surface == surface && trail.points.len() > 1)
    }

    /// Returns the request with the textures of the surfaces that show their curvature as images.
    pub fn with_curvatures(self) -> Self {
        let (scene, params) = (self.scene.clone(), self.params.clone());
        self.with_curvatures_from(|id| {
            let texture = Texture::curvature(&scene, &params, id);
            texture.ok().map(Shared::from)
        })
    }

    /// As [`Self::with_curvatures`], with the textures that `texture` returns. A surface without one, since its derivatives are
    /// too large, shows what it would show otherwise.
    pub(crate) fn with_curvatures_from(
        mut self,
        mut texture: impl FnMut(ObjectId) -> Option<Shared<Texture>>,
    ) -> Self {
        for id in std::mem::take(&mut self.curved) {
            self.textures.extend(texture(id).map(|it| (id, it)));
        }
        self
    }

    /// Refuses a request that cannot be drawn, whatever the backend.
    ///
    /// # Errors
    /// [`RenderError::Size`], and those of the view, such as [`RenderError::Camera`] and [`RenderError::Manifold`].
    pub fn check(&self) -> Result<(), RenderError> {
        if self.size.iter().any(|&side| side == 0 || side > MAX_SIDE) {
            return Err(RenderError::Size(self.size));
        }
        if !SCALES.contains(&self.scale) {
            return Err(RenderError::Scale(self.scale));
        }
        self.view.check(&self.scene)
    }
}

impl Overlays {
    /// Returns true if there is any overlay.
    pub fn any(&self) -> bool {
        *self != Self::default()
    }
}

impl Spacing {
    /// The distance in numbers, for a view that reaches as far as `zoom`.
    pub fn distance(self, zoom: f64) -> f64 {
        match self {
            Self::Every(distance) => distance,
            Self::Auto => {
                let rough = zoom / 4.0;
                let unit = 10.0_f64.powf(rough.log10().floor());
                let steps = [1.0, 2.0, 5.0, 10.0].map(|n| n * unit);
                steps
                    .into_iter()
                    .find(|step| *step >= rough)
                    .unwrap_or(rough)
            }
        }
    }
}
