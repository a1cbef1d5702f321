//! What is asked for, and what comes back: a [`Request`] becomes a [`Picture`] or a [`RenderError`].

use std::fmt;
use std::sync::Arc;

use geodesic::frame::Frame;
use geometry::ManifoldError;
use scene::{Object, ObjectId, Scene, Shape};

use crate::overlay::{Overlays, Standpoint, Trail};
use crate::texture::Texture;

/// The longest side of a picture in pixels.
pub const MAX_SIDE: u32 = 16_384;

/// One picture to be drawn.
#[derive(Clone, Debug)]
pub struct Request {
    /// Which view, and from where.
    pub view: View,
    /// Width and height in pixels, each from 1 to [`MAX_SIDE`].
    pub size: [u32; 2],
    /// What draws it.
    pub backend: Backend,
    /// The images of surfaces; a surface that is not listed shows [`Texture::orientation`].
    pub textures: Vec<(ObjectId, Arc<Texture>)>,
    /// Colours (sRGB) other than those of [`crate::style`]; a surface's colour multiplies its texture.
    pub colours: Vec<(ObjectId, [u8; 3])>,
    /// Whether a geodesic picture marks its centre with an open ring.
    pub mark_centre: bool,
    /// What is drawn over the picture.
    pub overlays: Overlays,
    /// A geodesic camera that the 3D view shows.
    pub show_camera: Option<Standpoint>,
    /// Paths that geodesic cameras have walked: both views draw them, with their lengths.
    pub trails: Vec<Arc<Trail>>,
    /// What lies behind the objects of the 3D view: sRGB and an alpha that is not multiplied into it;
    /// [`crate::style::BACKGROUND`] if not given. Geodesic pictures have no background.
    pub background: Option<[u8; 4]>,
    /// Whether the view moves, and a picture at once is worth more than a fine one: then a geodesic view may be off by
    /// [`MOVING_TOLERANCE`](crate::geodesic_view::MOVING_TOLERANCE) pixels, and the software path blurs what it sees at
    /// a flat angle.
    pub moving: bool,
    /// An object that the 3D view sets off, by mixing [`crate::style::EMPHASIS_COLOUR`] into it.
    pub highlight: Option<ObjectId>,
    /// Objects that the 3D view leaves out. What lies on them is drawn, and they are seen from inside as ever.
    pub hidden: Vec<ObjectId>,
}

/// A view of the scene.
#[derive(Clone, Debug, PartialEq)]
pub enum View {
    /// All objects in space, by a perspective camera. What is not given is chosen so that the scene fills the
    /// picture.
    Space {
        /// Where the camera stands, in the scene's units.
        eye: Option<[f64; 3]>,
        /// What it looks at, in the scene's units.
        target: Option<[f64; 3]>,
    },
    /// What a being inside a surface sees: the exponential map.
    Geodesic {
        /// The surface.
        surface: ObjectId,
        /// The camera's (u, v); the middle of the domain if not given.
        at: Option<[f64; 2]>,
        /// The angle from σu to the picture's x axis, towards σv, in radians.
        angle: f64,
        /// The distance on the surface from the picture's centre to the middle of its shorter side's edge;
        /// positive. Chosen from the surface's size if not given.
        zoom: Option<f64>,
        /// A camera that has walked: it takes the place of `at`, `angle` and `zoom`. Made by
        /// [`Inside::frame`](crate::geodesic_view::Inside) and moved by [`Frame`]'s methods.
        frame: Option<Frame>,
        /// How the geodesics are followed.
        method: Method,
    },
}

/// How the geodesics of a geodesic view are followed.
#[derive(Clone, Copy, Debug, Default, Eq, Hash, PartialEq)]
pub enum Method {
    /// The best: the fan, on both backends.
    #[default]
    Auto,
    /// Rays in f64 that all pixels share, interpolated by their Jacobi fields.
    Fan,
    /// The same, interpolated linearly between rays, for comparison.
    FanLinear,
    /// Fixed steps of the classical Runge–Kutta method for each pixel, as in the thesis (equations 4.2).
    Rk4Pixel,
    /// Adaptive steps in f64 for each pixel.
    Adaptive,
}

impl Method {
    /// Whether rays are shared by all pixels, so that the ends are a table of polynomials.
    pub(crate) fn is_fan(self) -> bool {
        match self {
            Self::Auto | Self::Fan | Self::FanLinear => true,
            Self::Rk4Pixel | Self::Adaptive => false,
        }
    }
}

/// What draws a picture.
#[derive(Clone, Copy, Debug, Default, Eq, Hash, PartialEq)]
pub enum Backend {
    /// A GPU where there is one, else the software path.
    #[default]
    Auto,
    /// A GPU (a software implementation of Vulkan counts), or an error.
    Gpu,
    /// The software path.
    Software,
}

/// A finished picture.
#[derive(Clone, Debug)]
pub struct Picture {
    /// sRGB, top row first; opaque but for a background that was asked for. Alpha is not multiplied into the colours.
    pub image: image::RgbaImage,
    /// Which backend drew it, and why.
    pub backend: String,
    /// What a reader of the picture should know: sentences such as "`p` is undefined at the current params and
    /// is not drawn".
    pub notes: Vec<String>,
    /// What has been drawn over it, by name: nothing unless it was asked for, or the scene declares geodesics on the
    /// surface that is seen from inside.
    pub overlays: Vec<&'static str>,
}

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq)]
pub enum RenderError {
    /// No GPU can be used; `reason` completes "because …".
    NoGpu {
        /// For instance "no GPU driver was found".
        reason: String,
    },
    /// The GPU refused or lost the work, in the driver's words.
    Gpu(String),
    /// The object has no geodesic view: it is not a surface, or its geodesics cannot be computed.
    Manifold(ManifoldError),
    /// The geodesic camera cannot stand there: the surface is undefined or has no tangent plane at (u, v).
    UndefinedCamera {
        /// The surface's name.
        name: String,
        /// The point of its chart.
        at: [f64; 2],
    },
    /// The geodesic camera's (u, v) is not in the surface's domain.
    CameraOutside {
        /// The surface's name.
        name: String,
        /// The point of its chart.
        at: [f64; 2],
        /// `[[u min, u max], [v min, v max]]`.
        domain: [[f64; 2]; 2],
    },
    /// A number of the camera is not finite, a zoom is not positive, or eye and target coincide; the sentence
    /// says which.
    Camera(String),
    /// The picture's size is not between 1×1 and [`MAX_SIDE`]×[`MAX_SIDE`].
    Size([u32; 2]),
    /// A fault of this program: generated text did not pass validation.
    Internal {
        /// What was found, with its origin.
        message: String,
        /// The text, kept for a report.
        source: String,
    },
}

/// The zooms that single precision can hold, and their inverses.
const ZOOMS: std::ops::RangeInclusive<f64> = 1e-30..=1e30;

impl Request {
    /// A 3D view of the given size, everything else at its default.
    pub fn space(size: [u32; 2]) -> Self {
        Self::new(
            View::Space {
                eye: None,
                target: None,
            },
            size,
        )
    }

    /// A geodesic view of the given size, everything else at its default.
    pub fn geodesic(surface: ObjectId, size: [u32; 2]) -> Self {
        let view = View::Geodesic {
            surface,
            at: None,
            angle: 0.0,
            zoom: None,
            frame: None,
            method: Method::Auto,
        };
        Self::new(view, size)
    }

    fn new(view: View, size: [u32; 2]) -> Self {
        Self {
            view,
            size,
            backend: Backend::Auto,
            textures: Vec::new(),
            colours: Vec::new(),
            mark_centre: true,
            overlays: Overlays::default(),
            show_camera: None,
            trails: Vec::new(),
            background: None,
            moving: false,
            highlight: None,
            hidden: Vec::new(),
        }
    }

    /// The texture of a surface.
    pub fn texture(&self, object: ObjectId) -> Arc<Texture> {
        let own = self.textures.iter().rev().find(|(id, _)| *id == object);
        own.map_or_else(Texture::orientation, |(_, texture)| texture.clone())
    }

    /// The colour of an object, in linear light.
    pub fn colour(&self, object: ObjectId, shape: &Shape) -> [f32; 3] {
        let own = self.colours.iter().rev().find(|(id, _)| *id == object);
        crate::style::linear(own.map_or_else(|| crate::style::colour(shape), |(_, colour)| *colour))
    }

    /// The background in linear light, and its alpha.
    pub fn background_light(&self) -> [f32; 4] {
        let [red, green, blue] = crate::style::BACKGROUND;
        let [r, g, b, alpha] = self.background.unwrap_or([red, green, blue, 255]);
        let [r, g, b] = crate::style::linear([r, g, b]);
        [r, g, b, f32::from(alpha) / 255.0]
    }

    /// How much of [`crate::style::EMPHASIS_COLOUR`] an object has, from 0 to 1.
    pub fn emphasis(&self, object: ObjectId) -> f32 {
        if self.highlight == Some(object) {
            crate::style::EMPHASIS
        } else {
            0.0
        }
    }

    /// Whether another request asks for the same picture of the same scene from the same backend. Textures that only
    /// look alike count as different ones.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        // Taken apart: a field that is added is not forgotten here.
        let Self {
            view,
            size,
            backend: _,
            textures,
            colours,
            mark_centre,
            overlays,
            show_camera,
            trails,
            background,
            moving,
            highlight,
            hidden,
        } = self;
        let same_textures = textures.len() == other.textures.len()
            && textures
                .iter()
                .zip(&other.textures)
                .all(|(a, b)| a.0 == b.0 && Arc::ptr_eq(&a.1, &b.1));
        same_textures
            && *view == other.view
            && *size == other.size
            && *colours == other.colours
            && *mark_centre == other.mark_centre
            && *overlays == other.overlays
            && *show_camera == other.show_camera
            && *trails == other.trails
            && *background == other.background
            && *moving == other.moving
            && *highlight == other.highlight
            && *hidden == other.hidden
    }

    /// Whether the 3D view draws an object.
    pub fn shows(&self, object: ObjectId) -> bool {
        !self.hidden.contains(&object)
    }

    /// Whether the 3D view leaves room for an object: also for one that is hidden, where something lies on it.
    pub fn leaves_room(&self, scene: &Scene, object: ObjectId) -> bool {
        let lies_there = |(id, other): (ObjectId, &Object)| match other.shape {
            Shape::Geodesic { surface, .. } => surface == object && self.shows(id),
            _ => false,
        };
        self.shows(object)
            || (0..).map(ObjectId).zip(&scene.objects).any(lies_there)
            || self
                .show_camera
                .is_some_and(|camera| camera.surface == object)
            || self.trails.iter().any(|trail| trail.surface == object)
    }

    /// Refuses what cannot be drawn, whatever the backend.
    ///
    /// # Errors
    /// [`RenderError::Size`], [`RenderError::Camera`], [`RenderError::Manifold`].
    pub fn check(&self, scene: &Scene) -> Result<(), RenderError> {
        if self.size.iter().any(|&side| side == 0 || side > MAX_SIDE) {
            return Err(RenderError::Size(self.size));
        }
        match &self.view {
            View::Space { eye, target } => {
                let finite = |place: &Option<[f64; 3]>| {
                    place.is_none_or(|p| p.iter().all(|x| x.is_finite()))
                };
                if !finite(eye) || !finite(target) {
                    return Err(RenderError::Camera(
                        "the camera's place and target must be finite".into(),
                    ));
                }
                if eye.is_some() && eye == target {
                    return Err(RenderError::Camera(
                        "the camera stands on its target and has no direction".into(),
                    ));
                }
            }
            View::Geodesic {
                surface,
                at,
                angle,
                zoom,
                ..
            } => {
                let object = scene.objects.get(surface.0 as usize);
                if object.is_none_or(|object| object.shape.manifold().is_none()) {
                    let name = object.map(|object| object.name.clone());
                    return Err(ManifoldError::NoSurface { name }.into());
                }
                if !angle.is_finite() || at.is_some_and(|at| at.iter().any(|x| !x.is_finite())) {
                    return Err(RenderError::Camera(
                        "the camera's place and angle must be finite".into(),
                    ));
                }
                if zoom.is_some_and(|zoom| !zoom.is_finite() || zoom <= 0.0) {
                    return Err(RenderError::Camera(
                        "the zoom is a distance and must be positive".into(),
                    ));
                }
                if zoom.is_some_and(|zoom| !ZOOMS.contains(&zoom)) {
                    return Err(RenderError::Camera(format!(
                        "the zoom must lie between {:e} and {:e}",
                        ZOOMS.start(),
                        ZOOMS.end()
                    )));
                }
            }
        }
        Ok(())
    }
}

impl fmt::Display for RenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoGpu { reason } => write!(f, "no GPU can be used: {reason}"),
            Self::Gpu(message) => write!(f, "the GPU could not draw the picture: {message}"),
            Self::Manifold(error) => write!(f, "{error}"),
            Self::UndefinedCamera { name, at: [u, v] } => {
                write!(
                    f,
                    "`{name}` has no tangent plane at (u, v) = ({u}, {v}), so the camera cannot stand there"
                )
            }
            Self::CameraOutside {
                name,
                at: [u, v],
                domain: [[u0, u1], [v0, v1]],
            } => write!(
                f,
                "({u}, {v}) is outside the domain of `{name}`, which is [{u0}, {u1}] by [{v0}, {v1}]"
            ),
            Self::Camera(sentence) => write!(f, "{sentence}"),
            Self::Size([width, height]) => {
                write!(
                    f,
                    "a picture of {width}x{height} pixels cannot be made: each side is from 1 to {MAX_SIDE}"
                )
            }
            Self::Internal { message, .. } => {
                write!(f, "internal error in a generated shader: {message}")
            }
        }
    }
}

impl std::error::Error for RenderError {}

impl From<ManifoldError> for RenderError {
    fn from(error: ManifoldError) -> Self {
        Self::Manifold(error)
    }
}
