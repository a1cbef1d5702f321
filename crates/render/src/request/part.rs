//! The part of a request that belongs to its view: the camera, and the options that no other view reads.
//!
//! A view declares a plain struct and implements [`ViewOptions`] for it; a request carries it as a [`ViewPart`], which
//! can be cloned, compared and printed like any other data.

use std::any::Any;
use std::fmt;

use scene::{ObjectId, Scene};

use crate::error::RenderError;
use crate::viewpoint::ViewCamera;

/// The options of a view.
pub trait ViewOptions: Comparable {
    /// The view's name, under which it is registered.
    fn view(&self) -> &'static str;

    /// The object that the view is of; `None` for a view of the whole scene.
    fn object(&self) -> Option<ObjectId> {
        None
    }

    /// The camera.
    fn camera(&self) -> ViewCamera {
        ViewCamera::Fixed
    }

    /// Puts another camera in place; one of another kind is ignored.
    fn set_camera(&mut self, _camera: ViewCamera) {}

    /// Turns one of the view's [settings](crate::view::Setting) on or off; returns whether the view has it.
    fn set(&mut self, _setting: &str, _on: bool) -> bool {
        false
    }

    /// Refuses options that cannot be drawn, whatever the backend.
    ///
    /// # Errors
    /// [`RenderError::Camera`], [`RenderError::Manifold`].
    fn check(&self, _scene: &Scene) -> Result<(), RenderError> {
        Ok(())
    }
}

/// The derived traits that every type of options has, for values whose type is not known.
pub trait Comparable: Any + fmt::Debug + Send + Sync {
    /// Returns true if the other value has the same type and is equal.
    fn is_equal(&self, other: &dyn ViewOptions) -> bool;
    /// A copy.
    fn copy(&self) -> Box<dyn ViewOptions>;
    /// As a value of any type.
    fn any(&self) -> &dyn Any;
    /// As a value of any type, to be changed.
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

/// The options of whichever view a request is for.
pub struct ViewPart(Box<dyn ViewOptions>);

impl ViewPart {
    /// The view's name.
    pub fn name(&self) -> &'static str {
        self.0.view()
    }

    /// The object that the view is of; `None` for a view of the whole scene.
    pub fn object(&self) -> Option<ObjectId> {
        self.0.object()
    }

    /// The camera.
    pub fn camera(&self) -> ViewCamera {
        self.0.camera()
    }

    /// Puts another camera in place; one of another kind is ignored.
    pub fn set_camera(&mut self, camera: ViewCamera) {
        self.0.set_camera(camera);
    }

    /// Turns one of the view's settings on or off; returns whether the view has it.
    pub fn set(&mut self, setting: &str, on: bool) -> bool {
        self.0.set(setting, on)
    }

    /// The options, if they are of this type.
    pub fn get<T: ViewOptions>(&self) -> Option<&T> {
        self.0.any().downcast_ref()
    }

    /// The options, if they are of this type, to be changed.
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
