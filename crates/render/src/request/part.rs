//! The part of a request that belongs to its view: the camera, and the options that no other view reads.
//!
//! A view declares a plain struct and implements [`ViewOptions`] for it; a request holds it as a [`ViewPart`], which can be
//! cloned, compared and printed like any other data.

use std::any::Any;
use std::fmt;

use scene::{ObjectId, Scene};

use super::{Overlays, PictureRequest};
use crate::error::RenderError;
use crate::geodesic_view::PictureMethod;
use crate::point::WorldPoint;
use crate::style;
use crate::viewpoint::{GeodesicCamera, Viewpoint};

/// The options of a view.
pub trait ViewOptions: Comparable {
    /// Returns the view's name, under which it is registered.
    fn view(&self) -> &'static str;

    /// Returns the object that the view shows; `None` for a view of the whole scene.
    fn object(&self) -> Option<ObjectId> {
        self.geodesic_camera().map(|camera| camera.surface)
    }

    /// Returns the options that all views in space have; `None` for another view.
    fn space(&self) -> Option<&SpaceOptions> {
        None
    }

    /// As [`ViewOptions::space`], mutable.
    fn space_mut(&mut self) -> Option<&mut SpaceOptions> {
        None
    }

    /// Returns the camera of a view from within a surface, a metric or a solid; `None` for another view.
    fn geodesic_camera(&self) -> Option<&GeodesicCamera> {
        None
    }

    /// As [`ViewOptions::geodesic_camera`], mutable.
    fn geodesic_camera_mut(&mut self) -> Option<&mut GeodesicCamera> {
        None
    }

    /// Returns the method by which geodesics are integrated, for a view that offers several.
    fn method(&self) -> Option<PictureMethod> {
        None
    }

    /// Returns the number of samples of a pixel, for a view with progressive sampling.
    fn samples(&self) -> Option<u32> {
        None
    }

    /// Sets the number of samples of a pixel, for a view with progressive sampling.
    fn set_samples(&mut self, _samples: u32) {}

    /// Returns true if the view draws lines: overlays, trails and the geodesic camera that it displays.
    fn draws_lines(&self) -> bool {
        true
    }

    /// Turns one of the view's [settings](crate::view::Setting) on or off; returns whether the view has it.
    fn set(&mut self, _setting: &str, _on: bool) -> bool {
        false
    }

    /// Returns whether one of the view's [settings](crate::view::Setting) is on; `None` for a setting of another view.
    fn is_on(&self, _setting: &str) -> Option<bool> {
        None
    }

    /// Refuses options that cannot be drawn, whatever the backend.
    ///
    /// # Errors
    /// [`RenderError::Camera`], [`RenderError::Manifold`].
    fn check(&self, _scene: &Scene) -> Result<(), RenderError> {
        Ok(())
    }
}

/// The options that all views in space have: the camera, and the objects to draw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SpaceOptions {
    /// The camera. Without a position and a target, it is the camera that the program declares, if there is one.
    pub camera: Viewpoint,
    /// The name of the declared camera; the first one if not given.
    pub declared: Option<String>,
    /// A geodesic camera to be displayed: its frame, the axes and the border of its picture.
    pub show_camera: Option<GeodesicCamera>,
    /// The colour behind the objects: sRGB and a straight alpha; [`style::BACKGROUND`] if not given.
    pub background: Option<[u8; 4]>,
    /// An object to be highlighted, by mixing [`style::EMPHASIS_COLOUR`] into it.
    pub highlight: Option<ObjectId>,
    /// Objects to be hidden. Objects on them are drawn, and they can still be seen from inside.
    pub hidden: Vec<ObjectId>,
}

impl SpaceOptions {
    /// Creates options for a picture from a position, towards a target.
    pub fn seen_from(eye: impl Into<WorldPoint>, target: impl Into<WorldPoint>) -> Self {
        Self {
            camera: Viewpoint::new(eye, target),
            ..Self::default()
        }
    }

    /// Returns true if an object is drawn.
    pub fn shows(&self, object: ObjectId) -> bool {
        !self.hidden.contains(&object)
    }

    /// Returns true if the framing includes an object: also a hidden one with something on it.
    pub(crate) fn leaves_room(&self, request: &PictureRequest, object: ObjectId) -> bool {
        let mut geodesics = request.scene.geodesics_on(object);
        self.shows(object)
            || geodesics.any(|(id, _)| self.shows(id))
            || self
                .show_camera
                .is_some_and(|camera| camera.surface == object)
            || request.trails.iter().any(|trail| trail.surface == object)
    }

    /// Returns the background in linear light, and its alpha.
    pub(crate) fn background_light(&self) -> [f32; 4] {
        let [red, green, blue] = style::BACKGROUND;
        let [r, g, b, alpha] = self.background.unwrap_or([red, green, blue, 255]);
        let [r, g, b] = style::linear([r, g, b]);
        [r, g, b, f32::from(alpha) / 255.0]
    }

    /// Returns the fraction of [`style::EMPHASIS_COLOUR`] in an object, from 0 to 1.
    pub(crate) fn emphasis(&self, object: ObjectId) -> f32 {
        if self.highlight == Some(object) {
            style::EMPHASIS
        } else {
            0.0
        }
    }
}

/// The derived traits of every type of options, for values of unknown type.
pub trait Comparable: Any + fmt::Debug + Send + Sync {
    /// Returns true if the other value has the same type and is equal.
    fn is_equal(&self, other: &dyn ViewOptions) -> bool;
    /// Returns a copy.
    fn copy(&self) -> Box<dyn ViewOptions>;
    /// Returns the options as a value of any type.
    fn any(&self) -> &dyn Any;
    /// Returns the options as a mutable value of any type.
    fn any_mut(&mut self) -> &mut dyn Any;
}

impl<T: ViewOptions + Clone + PartialEq> Comparable for T {
    fn is_equal(&self, other: &dyn ViewOptions) -> bool {
        other.any().downcast_ref() == Some(self)
    }

    fn copy(&self) -> Box<dyn ViewOptions> {
        Box::new(self.clone())
    }

    fn any(&self) -> &dyn Any {
        self
    }

    fn any_mut(&mut self) -> &mut dyn Any {
        self
    }
}

/// The options of the view of a request, whichever it is.
pub struct ViewPart(Box<dyn ViewOptions>);

impl ViewPart {
    /// Returns the view's name.
    pub fn name(&self) -> &'static str {
        self.0.view()
    }

    /// Returns the object that the view shows; `None` for a view of the whole scene.
    pub fn object(&self) -> Option<ObjectId> {
        self.0.object()
    }

    /// Returns the options that all views in space have; `None` for another view.
    pub fn space(&self) -> Option<&SpaceOptions> {
        self.0.space()
    }

    /// As [`ViewPart::space`], mutable.
    pub fn space_mut(&mut self) -> Option<&mut SpaceOptions> {
        self.0.space_mut()
    }

    /// Returns the camera of a view from within a surface, a metric or a solid; `None` for another view.
    pub fn geodesic_camera(&self) -> Option<&GeodesicCamera> {
        self.0.geodesic_camera()
    }

    /// Returns the geodesic camera that draws the picture, or that it displays in space.
    pub fn shown_camera(&self) -> Option<&GeodesicCamera> {
        let in_space = || self.space().and_then(|space| space.show_camera.as_ref());
        self.geodesic_camera().or_else(in_space)
    }

    /// Returns the method by which geodesics are integrated, for a view that offers several.
    pub fn method(&self) -> Option<PictureMethod> {
        self.0.method()
    }

    /// Returns the number of samples of a pixel, for a view with progressive sampling.
    pub fn samples(&self) -> Option<u32> {
        self.0.samples()
    }

    /// Sets the number of samples of a pixel, for a view with progressive sampling.
    pub fn set_samples(&mut self, samples: u32) {
        self.0.set_samples(samples);
    }

    /// Returns true if the view draws lines: overlays, trails and the geodesic camera that it displays.
    pub fn draws_lines(&self) -> bool {
        self.0.draws_lines()
    }

    /// Returns those of some overlays that the view draws.
    pub fn drawn(&self, overlays: Overlays) -> Overlays {
        let Overlays {
            legend,
            wavefronts,
            conjugate_points,
            cut_locus,
            error,
            labels,
            axes,
            hidden_lines,
        } = overlays;
        let draws_lines = self.draws_lines();
        let is_inside = self.geodesic_camera().is_some();
        let is_in_space = draws_lines && !is_inside;
        let has_camera = draws_lines && self.shown_camera().is_some();
        Overlays {
            legend: legend && draws_lines,
            wavefronts: wavefronts.filter(|_| has_camera),
            conjugate_points: conjugate_points && has_camera,
            cut_locus: cut_locus && is_inside,
            error: error && is_inside,
            labels,
            axes: axes && is_in_space,
            hidden_lines: hidden_lines && is_in_space,
        }
    }

    /// Sets the geodesic camera that draws the picture, or that it displays in space.
    pub fn show_camera(&mut self, camera: GeodesicCamera) {
        if let Some(own) = self.0.geodesic_camera_mut() {
            *own = camera;
        } else if let Some(space) = self.space_mut() {
            space.show_camera = Some(camera);
        }
    }

    /// Turns one of the view's settings on or off; returns whether the view has it.
    pub fn set(&mut self, setting: &str, on: bool) -> bool {
        self.0.set(setting, on)
    }

    /// Returns whether one of the view's settings is on; `None` for a setting of another view.
    pub fn is_on(&self, setting: &str) -> Option<bool> {
        self.0.is_on(setting)
    }

    /// Returns the options, if they are of this type.
    pub fn get<T: ViewOptions>(&self) -> Option<&T> {
        self.0.any().downcast_ref()
    }

    /// Returns the options, if they are of this type, mutable.
    pub fn get_mut<T: ViewOptions>(&mut self) -> Option<&mut T> {
        self.0.any_mut().downcast_mut()
    }

    /// Refuses options that cannot be drawn, whatever the backend.
    ///
    /// # Errors
    /// Those of [`ViewOptions::check`].
    pub fn check(&self, scene: &Scene) -> Result<(), RenderError> {
        self.0.check(scene)
    }
}

impl<T: ViewOptions> From<T> for ViewPart {
    fn from(options: T) -> Self {
        Self(Box::new(options))
    }
}

impl Clone for ViewPart {
    fn clone(&self) -> Self {
        Self(self.0.copy())
    }
}

impl PartialEq for ViewPart {
    fn eq(&self, other: &Self) -> bool {
        self.0.is_equal(&*other.0)
    }
}

impl fmt::Debug for ViewPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}
