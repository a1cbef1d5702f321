//! The picture request: a [`PictureRequest`] holds everything on which a picture depends, as data that can be compared. It
//! is passed unchanged from a pane of a window, or a command line, to the code that draws.

mod colours;
pub mod part;

pub(crate) use colours::{ColourFaults, colour_nodes, srgb_of};
pub use part::{ViewOptions, ViewPart};

use std::borrow::Cow;
use std::sync::Arc;

use scene::{ObjectId, ParamValues, Scene, stated_word};

use crate::bounds::ObjectCloud;
use crate::error::{MAX_SIDE, RenderError, SCALES};
use crate::shared::Shared;
use crate::style;
use crate::style::Theme;
use crate::texture::{Proportions, SurfaceImage, Texture};
use crate::trail::Trail;
use crate::viewpoint::GeodesicCamera;

/// One picture to be drawn. Equal requests produce equal pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureRequest {
    /// The scene.
    pub scene: Shared<Scene>,
    /// The values of its params and grids.
    pub params: Arc<ParamValues>,
    /// The view, its camera, and the options that only this view reads.
    pub view: ViewPart,
    /// Width and height in pixels, each from 1 to [`MAX_SIDE`].
    pub size: [u32; 2],
    /// The images of surfaces; the last entry for a surface counts. A surface that is not listed shows
    /// [`Texture::orientation`].
    pub textures: Vec<(ObjectId, Shared<Texture>)>,
    /// The images that the program names, by their names. An object shows the image that it specifies, unless
    /// [`PictureRequest::textures`] has another one for it.
    pub images: Vec<(String, Shared<Texture>)>,
    /// The image of the declared background; it replaces the one that the background specifies.
    pub background_image: Option<Shared<Texture>>,
    /// Surfaces whose images are upside down: their top row is v max. For [`Texture::orientation`], only the letters are
    /// flipped.
    pub flipped: Vec<ObjectId>,
    /// Surfaces that show their [curvature](Texture::curvature) instead. A renderer makes these textures and keeps them as
    /// long as the scene and its param values do not change.
    pub curved: Vec<ObjectId>,
    /// The medium for which the colours of [`crate::style`] are chosen.
    pub theme: Theme,
    /// Colours (sRGB) that override those of [`crate::style`]; a surface's colour multiplies its texture.
    pub colours: Vec<(ObjectId, [u8; 3])>,
    /// The overlays that are drawn over the picture.
    pub overlays: Overlays,
    /// The factor of the widths of lines and points and of the heights of words, 1 by default; positive.
    pub scale: f32,
    /// Paths of geodesic cameras: views draw them, with their lengths.
    pub trails: Vec<Shared<Trail>>,
    /// True if the view moves, and speed matters more than quality: the error of a geodesic view may then be
    /// [`MOVING_TOLERANCE`](crate::geodesic_view::MOVING_TOLERANCE) pixels, and the software path blurs surfaces at a
    /// grazing angle.
    pub moving: bool,
    /// The factor by which a coarse picture is magnified to the size of the picture at rest, 1 by default: words may be
    /// smaller by this factor than their least size.
    pub magnification: f32,
}

/// The overlays of a picture; none by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Overlays {
    /// A key to the hatchings and lines that the picture has.
    pub legend: bool,
    /// Geodesic circles at equal distances around the camera.
    pub wavefronts: Option<Spacing>,
    /// The conjugate points, where geodesics from the camera meet their neighbours again: the Jacobi field is zero there.
    pub conjugate_points: bool,
    /// The line beyond which another way from the camera to a pixel's point is shorter.
    pub cut_locus: bool,
    /// The estimated error, painted over the picture.
    pub error: bool,
    /// Names at the visible objects.
    pub labels: bool,
    /// In space, a box around the scene with ticks.
    pub axes: bool,
    /// The hidden parts of curves and geodesics in space, dashed; only where lines are [vectors](crate::layers).
    pub hidden_lines: bool,
}

/// The distance between wavefronts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spacing {
    /// A round distance that results in about five of them.
    Auto,
    /// This distance, in the surface's units; positive.
    Every(f64),
}

/// The device that draws a picture.
#[derive(Clone, Copy, Debug, Default, Eq, Hash, PartialEq)]
pub enum Backend {
    /// A real GPU if there is one, otherwise the software path.
    #[default]
    Auto,
    /// A GPU (a software implementation of Vulkan counts), or an error.
    Gpu,
    /// The software path.
    Software,
}

impl PictureRequest {
    /// Creates a picture of a view, with defaults for everything else.
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
            magnification: 1.0,
        }
    }

    /// Returns the texture of a surface.
    pub fn texture(&self, object: ObjectId) -> Arc<Texture> {
        self.texture_seen(object, false)
    }

    /// Returns the texture of a surface in the geodesic view: a single colour would not show how the surface bends.
    pub(crate) fn texture_inside(&self, object: ObjectId) -> Arc<Texture> {
        match self.own_texture(object) {
            None if self.states_colour(object) => Texture::checker(),
            _ => self.texture(object),
        }
    }

    /// Returns the image of a surface in space. The letters of the built-in one read correctly from the outside of a closed
    /// surface.
    pub fn image_in_space(&self, object: ObjectId) -> SurfaceImage {
        let cloud = |object| ObjectCloud::new(&self.scene, &self.params, object);
        self.image_of_cloud(object, self.scene.get(object).map(cloud).as_ref())
    }

    /// Returns the image of a surface in space with its coarse points, if they are known.
    pub(crate) fn image_of_cloud(
        &self,
        object: ObjectId,
        cloud: Option<&ObjectCloud>,
    ) -> SurfaceImage {
        let closed = cloud.and_then(|cloud| cloud.closed);
        let points_inwards = closed.is_some_and(|closed| !closed.points_outwards);
        SurfaceImage {
            texture: self.texture_seen(object, points_inwards),
            repeats: cloud.map_or([false; 2], |cloud| cloud.glued),
        }
    }

    /// Returns the texture of a surface. With `from_behind`, the built-in one reads correctly from the side that σu×σv
    /// points away from.
    fn texture_seen(&self, object: ObjectId, from_behind: bool) -> Arc<Texture> {
        let flipped = self.flipped.contains(&object);
        match self.own_texture(object) {
            // Colours of curvature are tied to points of the surface.
            Some(texture) if flipped && texture.curvature_scale().is_none() => texture.flipped(),
            Some(texture) => texture.arc().clone(),
            // Letters would hide a specified colour.
            None if self.states_colour(object) => Texture::plain(),
            None => {
                let object = self.scene.get(object);
                let proportions = object.map(|object| Proportions::of(&self.scene, object));
                let proportions = proportions.unwrap_or(Proportions::Even);
                Texture::orientation(proportions, flipped != from_behind)
            }
        }
    }

    /// Returns the image that was chosen for an object, otherwise the one that it specifies.
    pub fn own_texture(&self, object: ObjectId) -> Option<&Shared<Texture>> {
        self.chosen_texture(object).or_else(|| {
            let attributes = &self.scene.get(object)?.attributes;
            self.image(stated_word(attributes, "image")?)
        })
    }

    /// Returns the image that was chosen for an object.
    pub(crate) fn chosen_texture(&self, object: ObjectId) -> Option<&Shared<Texture>> {
        let mut chosen = self.textures.iter().rev();
        let (_, texture) = chosen.find(|(id, _)| *id == object)?;
        Some(texture)
    }

    /// Returns the colour, sRGB, that was chosen for an object.
    pub fn chosen_colour(&self, object: ObjectId) -> Option<[u8; 3]> {
        let mut chosen = self.colours.iter().rev();
        chosen
            .find(|(id, _)| *id == object)
            .map(|(_, colour)| *colour)
    }

    /// Returns an image that the program names.
    pub(crate) fn image(&self, word: &str) -> Option<&Shared<Texture>> {
        let (_, image) = self.images.iter().find(|(known, _)| known == word)?;
        Some(image)
    }

    /// Returns true if a surface is coloured by its curvature.
    fn shows_curvature(&self) -> bool {
        let mut textures = self.textures.iter();
        !self.curved.is_empty() || textures.any(|(_, it)| it.curvature_scale().is_some())
    }

    /// Returns the colour of the lines of axes, sRGB: between that of the backdrop and its opposite.
    pub(crate) fn axes_colour(&self) -> [u8; 3] {
        let [r, g, b] = self.backdrop().map(u32::from);
        if r + g + b > 384 { [110; 3] } else { [165; 3] }
    }

    /// Returns the colour behind everything, sRGB: that of the picture's backdrop if it has one.
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

    /// Returns the options of the view that draws the request.
    ///
    /// # Errors
    /// [`RenderError::NoView`] if they belong to another view with this view's name.
    pub(crate) fn options<T: ViewOptions>(&self) -> Result<&T, RenderError> {
        self.view.get().ok_or_else(|| RenderError::NoView {
            name: self.view.name().to_owned(),
        })
    }

    /// Returns the trails on a surface.
    pub(crate) fn trails_on(&self, surface: ObjectId) -> impl Iterator<Item = &Trail> {
        let trails = self.trails.iter().map(|trail| &**trail);
        trails.filter(move |trail| trail.surface == surface && trail.points.len() > 1)
    }

    /// Returns the request with the textures of the surfaces that show their curvature, as images.
    pub fn with_curvatures(self) -> Self {
        let (scene, params) = (self.scene.clone(), self.params.clone());
        self.with_curvatures_from(|id| {
            let texture = Texture::curvature(&scene, &params, id);
            texture.ok().map(Shared::from)
        })
    }

    /// As [`Self::with_curvatures`], with the textures that `texture` returns. A surface without one, because its
    /// derivatives are too large, keeps its other texture.
    pub(crate) fn with_curvatures_from(
        mut self,
        mut texture: impl FnMut(ObjectId) -> Option<Shared<Texture>>,
    ) -> Self {
        for id in std::mem::take(&mut self.curved) {
            self.textures.extend(texture(id).map(|it| (id, it)));
        }
        self
    }

    /// Returns the request with the scene that the values of its params make, where they change more than numbers. Objects are
    /// found there by their names; what names an object that is gone is dropped, and a camera on it stands on nothing.
    pub fn with_scene_of_params(&self) -> Cow<'_, Self> {
        let Some(made) = self.scene.made_anew(&self.params) else {
            return Cow::Borrowed(self);
        };
        let number = |id: ObjectId| self.scene.number_in(&made, id);
        let renumber = |id: &mut ObjectId| number(*id).map(|new| *id = new).is_some();
        let mut whole = self.clone();
        // Exhaustive, so that a new field that names objects is not forgotten.
        let Self {
            scene,
            params: _,
            view,
            size: _,
            textures,
            images: _,
            background_image: _,
            flipped,
            curved,
            theme: _,
            colours,
            overlays: _,
            scale: _,
            trails,
            moving: _,
            magnification: _,
        } = &mut whole;
        textures.retain_mut(|(id, _)| renumber(id));
        colours.retain_mut(|(id, _)| renumber(id));
        flipped.retain_mut(renumber);
        curved.retain_mut(renumber);
        trails.retain_mut(|trail| {
            let surface = number(trail.surface);
            if let Some(surface) = surface.filter(|surface| *surface != trail.surface) {
                let moved = Trail {
                    surface,
                    ..Trail::clone(trail)
                };
                *trail = moved.into();
            }
            surface.is_some()
        });
        if let Some(camera) = self.view.shown_camera() {
            let surface = number(camera.surface).unwrap_or(ObjectId::new(u32::MAX as usize));
            view.show_camera(GeodesicCamera { surface, ..*camera });
        }
        if let Some(space) = view.space_mut() {
            space.hidden.retain_mut(renumber);
            space.highlight = space.highlight.and_then(number);
        }
        *scene = made.into();
        Cow::Owned(whole)
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
    /// Returns the distance as a number, for a view that extends to the distance `zoom`.
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
