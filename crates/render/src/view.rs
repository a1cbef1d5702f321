//! Views: the ways to see a scene. A view is a module that implements [`View`] and is registered in [`Views`]; the command
//! line, the window and the protocol offer all registered views.
//!
//! ```text
//! Views ──name──▶ View ──options──▶ ViewPart of a PictureRequest
//!                  └──renderer──▶ ViewRenderer, kept by a Renderer ──draw──▶ RenderedImage
//! ```
//!
//! To add a view: a struct of options ([`ViewOptions`](crate::request::ViewOptions)), a [`View`], a [`ViewRenderer`], and a
//! line in [`Views::standard`].

pub mod geodesic;
mod shared_state;
pub mod space;
pub mod traced;

pub use shared_state::{Interrupt, SharedState};

use std::fmt;
use std::sync::Arc;

use image::RgbaImage;
use scene::{Object, ObjectId, Scene};

use crate::camera::Camera;
use crate::error::RenderError;
use crate::gpu::Pixels;
use crate::layers::Layers;
use crate::plan::{self, Plan};
use crate::point::{PixelPoint, WorldPoint};
use crate::rendered::RenderedImage;
use crate::request::{Backend, PictureRequest, ViewPart};

/// A way to see a scene.
pub trait View: fmt::Debug + Send + Sync {
    /// Returns its name for the command line and the protocol: a word in lower case.
    fn name(&self) -> &'static str;

    /// Returns its title for the user: "3D view".
    fn title(&self) -> &'static str;

    /// Returns a line of help.
    fn purpose(&self) -> &'static str;

    /// Returns the kinds of objects that it shows, in words: "surface, metric or solid"; `None` for a view of the whole
    /// scene. A view of an object has a pane for each object, and its name may be followed by the object's: `geodesic:s`.
    fn object_kind(&self) -> Option<&'static str> {
        None
    }

    /// Returns true if it shows one object.
    fn is_of_object(&self) -> bool {
        self.object_kind().is_some()
    }

    /// Returns true if it can be opened for this object, or, for a view of the whole scene, if the object is visible in it.
    fn shows(&self, scene: &Scene, object: &Object) -> bool;

    /// Returns true if a window opens the view of an object automatically; otherwise the user must open it.
    fn opens_by_itself(&self, _object: &Object) -> bool {
        true
    }

    /// Returns a sentence about a scene of which it shows no object.
    fn nothing(&self) -> &'static str {
        "Nothing to show"
    }

    /// Returns the view in whose pane it is shown, for an alternative to another view; `None` if it has a pane of its own.
    fn instead_of(&self) -> Option<&'static str> {
        None
    }

    /// Returns the placeholder of a name after the view's, such as `SURFACE` in `geodesic:SURFACE`; `None` if no name may
    /// follow.
    fn name_behind(&self) -> Option<&'static str> {
        self.is_of_object().then_some("SURFACE")
    }

    /// Returns the options of an initial picture with a name after the view's: by default the name of the object that it
    /// shows. `None` if the scene has nothing suitable of this name.
    fn options_of(&self, scene: &Scene, name: &str) -> Option<ViewPart> {
        let (id, _) = scene.object(name)?;
        self.is_of_object().then(|| self.options(Some(id)))
    }

    /// Returns the options of an initial picture: of this object, if the view shows one. If a view of an object is given
    /// none, its options refer to an object that does not exist, and its pictures are refused.
    fn options(&self, object: Option<ObjectId>) -> ViewPart;

    /// Returns the keys and gestures that move its camera, for a list of shortcuts.
    fn keys(&self) -> &'static [Key] {
        &[]
    }

    /// Returns the settings of its pictures that can be turned on and off, in addition to those that all views have.
    fn settings(&self) -> &'static [Setting] {
        &[]
    }

    /// Adds the needs of a picture to a plan.
    fn plan(&self, _request: &PictureRequest, _plan: &mut Plan) {}

    /// Returns the state that a renderer keeps for this view from one picture to the next.
    fn renderer(&self) -> Box<dyn ViewRenderer>;
}

/// A view's part of a renderer: it draws, and keeps data that the next picture may use.
pub trait ViewRenderer: fmt::Debug + Send {
    /// Draws a picture; the request has been checked. `progress` receives the completed fraction, from 0 to 1, from any
    /// thread.
    ///
    /// # Errors
    /// See [`RenderError`].
    fn draw(
        &mut self,
        shared: &mut SharedState,
        request: &PictureRequest,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<RenderedImage, RenderError>;

    /// Draws a picture for print, with its lines and words as vectors if the view supports them; by default everything is
    /// pixels.
    ///
    /// # Errors
    /// See [`RenderError`].
    fn layers(
        &mut self,
        shared: &mut SharedState,
        request: &PictureRequest,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<Layers, RenderError> {
        let mut drawn = self.draw(shared, request, progress)?;
        let none = Pixels::Image(RgbaImage::default());
        let pixels = shared.read(std::mem::replace(&mut drawn.image, none))?;
        Ok(Layers::flat(drawn.with_pixels(pixels)))
    }

    /// Finds the object and the point at a pixel.
    ///
    /// # Errors
    /// As [`ViewRenderer::draw`].
    fn pick(
        &mut self,
        _shared: &mut SharedState,
        _request: &PictureRequest,
        _at: PixelPoint,
    ) -> Result<Option<Hit>, RenderError> {
        Ok(None)
    }

    /// Returns the camera in space of a request; `None` for a view that has no such camera.
    ///
    /// # Errors
    /// [`RenderError::Camera`].
    fn camera(
        &mut self,
        _shared: &mut SharedState,
        _request: &PictureRequest,
    ) -> Result<Option<Camera>, RenderError> {
        Ok(None)
    }
}

/// The object and the point at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The object.
    pub object: ObjectId,
    /// The point in space; `None` on a metric.
    pub position: Option<WorldPoint>,
    /// (u, v) for a surface, (t, 0) for a curve, zero otherwise.
    pub parameters: [f64; 2],
    /// The number of the object's instance, from 0.
    pub instance: u64,
    /// For a solid, the leaf whose surface it is: a position in [`scene::Solid::leaves`].
    pub leaf: Option<usize>,
    /// In a geodesic view, the polar coordinates of the point about the camera: the length of the pixel's geodesic, and its
    /// angle in (−π, π] from the picture's right towards its up.
    pub polar: Option<[f64; 2]>,
}

/// A key or gesture, in words.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Key {
    /// The keys: "W A S D".
    pub keys: &'static str,
    /// Their effect: "move".
    pub action: &'static str,
}

impl Key {
    /// Creates a key with its effect.
    pub const fn new(keys: &'static str, action: &'static str) -> Self {
        Self { keys, action }
    }
}

/// A property of a view's pictures that can be turned on and off; [`ViewPart::set`] takes its name.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Setting {
    /// The name in files.
    pub name: &'static str,
    /// The title for the user.
    pub title: &'static str,
    /// True if it is on unless the user says otherwise.
    pub default: bool,
}

/// One view of a scene: of the whole scene, or of one object.
#[derive(Clone, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct ViewId {
    /// The view's name.
    pub kind: String,
    /// The name of the object that it shows; `None` for a view of the whole scene.
    pub object: Option<String>,
}

impl ViewId {
    /// Returns a view of the whole scene.
    pub fn of_scene(kind: &str) -> Self {
        Self {
            kind: kind.to_owned(),
            object: None,
        }
    }

    /// Returns a view of an object.
    pub fn of_object(kind: &str, object: &str) -> Self {
        Self {
            kind: kind.to_owned(),
            object: Some(object.to_owned()),
        }
    }

    /// Returns the view of a request.
    pub fn from_request(request: &PictureRequest) -> Self {
        let object = request.view.object();
        let object = object.and_then(|id| request.scene.get(id));
        Self {
            kind: request.view.name().to_owned(),
            object: object.map(|object| object.name.clone()),
        }
    }
}

/// Reads the command line's form: `3d`, `geodesic:s`.
impl From<&str> for ViewId {
    fn from(text: &str) -> Self {
        match text.split_once(':') {
            Some((kind, object)) => Self::of_object(kind, object),
            None => Self::of_scene(text),
        }
    }
}

/// Writes the view in the form of the command line: `3d`, `geodesic:s`.
impl fmt::Display for ViewId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.object {
            Some(object) => write!(f, "{}:{object}", self.kind),
            None => f.write_str(&self.kind),
        }
    }
}

/// The available views; the first one is the [default](Views::default_of) of most scenes.
#[derive(Clone, Debug)]
pub struct Views(Vec<Arc<dyn View>>);

impl Views {
    /// Returns the views of this program.
    pub fn standard() -> Self {
        Self(vec![
            Arc::new(space::SpaceView),
            Arc::new(geodesic::GeodesicView),
            Arc::new(traced::TracedView),
        ])
    }

    /// Returns these views and another one, which replaces a view of the same name.
    #[must_use]
    pub fn with(mut self, view: impl View + 'static) -> Self {
        self.0.retain(|known| known.name() != view.name());
        self.0.push(Arc::new(view));
        self
    }

    /// Returns the default view.
    pub fn first(&self) -> &dyn View {
        &*self.0[0]
    }

    /// Returns the view that shows the whole of a scene by default: the first one, or the view that replaces it if the scene
    /// describes a picture.
    pub fn default_of(&self, scene: &Scene) -> &dyn View {
        let first = self.first();
        let instead = self.instead_of(first.name());
        instead.filter(|_| scene.is_script()).unwrap_or(first)
    }

    /// Returns the views that a scene has: those of the whole scene, and for each object those that show it.
    pub fn of_scene(&self, scene: Option<&Scene>) -> Vec<ViewId> {
        let mut ids = Vec::new();
        for view in self.iter().filter(|view| view.instead_of().is_none()) {
            if !view.is_of_object() {
                ids.push(ViewId::of_scene(view.name()));
            } else if let Some(scene) = scene {
                let shown = scene.objects.iter();
                let shown = shown.filter(|object| view.shows(scene, object));
                ids.extend(shown.map(|object| ViewId::of_object(view.name(), &object.name)));
            }
        }
        ids
    }

    /// Returns true if a window opens a view of a scene automatically.
    pub fn opens_by_itself(&self, id: &ViewId, scene: &Scene) -> bool {
        let object = id.object.as_ref().and_then(|name| scene.object(name));
        let both = self.get(&id.kind).zip(object);
        both.is_some_and(|(view, (_, object))| view.opens_by_itself(object))
    }

    /// Returns the options of an initial picture of a view; `None` if there is no such view of this scene.
    pub fn options(&self, id: &ViewId, scene: &Scene) -> Option<ViewPart> {
        let view = self.get(&id.kind)?;
        match &id.object {
            Some(name) => view.options_of(scene, name),
            None => (!view.is_of_object()).then(|| view.options(None)),
        }
    }

    /// Returns the view that is shown in the pane of another one, in its place.
    pub fn instead_of(&self, name: &str) -> Option<&dyn View> {
        self.iter().find(|view| view.instead_of() == Some(name))
    }

    /// Returns the title of a view, followed by `between` and the name of the object that it shows: "Geodesic view of s".
    pub fn title(&self, id: &ViewId, between: &str) -> String {
        let title = self.get(&id.kind).map_or(&*id.kind, |view| view.title());
        match &id.object {
            Some(object) => format!("{title}{between}{object}"),
            None => title.to_owned(),
        }
    }

    /// Returns the view with a name.
    pub fn get(&self, name: &str) -> Option<&dyn View> {
        self.iter().find(|view| view.name() == name)
    }

    /// Returns all views.
    pub fn iter(&self) -> impl Iterator<Item = &dyn View> {
        self.0.iter().map(|view| &**view)
    }

    /// Plans a picture: what is built for it, and what is left out. The request has been checked.
    pub fn plan(&self, request: &PictureRequest, backend: Backend) -> Plan {
        let mut plan = Plan::new(backend != Backend::Software);
        if let Some(view) = self.get(request.view.name()) {
            view.plan(request, &mut plan);
        }
        plan::complete(&mut plan);
        plan
    }
}

impl Default for Views {
    fn default() -> Self {
        Self::standard()
    }
}
