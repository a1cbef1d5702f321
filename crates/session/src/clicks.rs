//! Clicks on pictures: a click places a geodesic camera, if one can be there; otherwise it shows a declaration, and so
//! does a double click.
//!
//! The first click takes effect at once. If a second one makes a double click of it, it is withdrawn without a trace.
//! An effect that would move the panes under the pointer waits until no second click can follow.

use std::sync::Arc;

use render::view::Hit;
use render::{PictureRequest, RenderError};
use scene::{Object, SolidLeaf};

use crate::camera_controller::Subject;
use crate::inside_camera::InsideCamera;
use crate::model::Model;

/// The maximum time between the two clicks of a double click, in seconds.
pub const DOUBLE_CLICK: f64 = 0.5;

/// The clicks that may still become double clicks.
#[derive(Debug, Default)]
pub struct Clicks {
    /// The number of clicks so far.
    count: u64,
    /// The last click that was the first half of a double click.
    withdrawn: Option<u64>,
    /// The last click, while another one may follow.
    open: Option<Open>,
}

#[derive(Debug)]
struct Open {
    until: f64,
    /// The surface whose camera the click has moved.
    surface: Option<String>,
    /// The surface whose camera was shown in space before the click.
    shown: Option<String>,
}

/// A camera's move by a click that has been withdrawn.
#[derive(Debug)]
pub struct WithdrawnMove {
    /// The surface whose camera was shown in space before the click.
    pub shown: Option<String>,
}

impl Clicks {
    /// Notes a click at the time `now` in seconds, after [`Clicks::end`] has ended the last one. `now` is `None` for a
    /// key, which is never the first half of a double click. `shown` is the surface whose camera is shown in space.
    /// Returns the click's number.
    pub fn begin(&mut self, now: Option<f64>, shown: Option<String>) -> u64 {
        self.count += 1;
        self.open = now.map(|now| Open {
            until: now + DOUBLE_CLICK,
            surface: None,
            shown,
        });
        self.count
    }

    /// Notes that the last click was a single one. Returns the surface whose camera it has moved: its view may now come
    /// forward.
    pub fn end(&mut self, model: &mut Model) -> Option<String> {
        model.keep_placement();
        self.open.take()?.surface
    }

    /// Ends the last click: it has no further effect.
    pub fn forget(&mut self, model: &mut Model) {
        model.keep_placement();
        self.open = None;
    }

    /// Withdraws the last click: it was the first half of a double click. Returns what it has changed, if it has moved a
    /// camera.
    pub fn withdraw(&mut self, model: &mut Model) -> Option<WithdrawnMove> {
        let open = self.open.take()?;
        self.withdrawn = Some(self.count);
        model.withdraw_placement();
        let shown = open.shown;
        open.surface.map(|_| WithdrawnMove { shown })
    }

    /// Returns the time until which another click may still follow the last one, or `None` if none may.
    pub fn until(&self) -> Option<f64> {
        self.open.as_ref().map(|it| it.until)
    }

    /// Returns whether a click was the first half of a double click.
    pub fn is_withdrawn(&self, number: u64) -> bool {
        self.withdrawn == Some(number)
    }

    /// Places a geodesic camera where a click has hit. Returns whether the click has already ended, so that the
    /// surface's view may come forward.
    pub fn place(
        &mut self,
        number: u64,
        model: &mut Model,
        surface: &str,
        camera: InsideCamera,
    ) -> bool {
        model.place(surface, camera);
        match &mut self.open {
            Some(open) if number == self.count => {
                open.surface = Some(surface.to_owned());
                false
            }
            _ => {
                model.keep_placement();
                true
            }
        }
    }
}

/// An object that was found by a click.
#[derive(Clone, Copy, Debug)]
pub struct ClickedObject<'a> {
    request: &'a PictureRequest,
    /// The point that was hit.
    pub hit: &'a Hit,
    /// The object.
    pub object: &'a Object,
    /// The part of the solid's set that was hit.
    pub leaf: Option<&'a SolidLeaf>,
}

impl<'a> ClickedObject<'a> {
    /// Returns the object of a hit in a picture; `None` if the picture's scene does not have it.
    pub fn new(request: &'a PictureRequest, hit: &'a Hit) -> Option<Self> {
        let object = request.scene.get(hit.object)?;
        let solid = object.shape.solid();
        Some(Self {
            request,
            hit,
            object,
            leaf: solid.and_then(|solid| solid.leaves.get(hit.leaf?)),
        })
    }

    /// Returns the name of the object, and of the part of a set that was hit.
    pub fn title(&self) -> String {
        let name = &self.object.name;
        match self.leaf {
            Some(leaf) if leaf.name != *name => format!("{name}: {}", leaf.name),
            _ => name.clone(),
        }
    }

    /// Returns the point in words.
    pub fn words(&self) -> String {
        let title = self.title();
        let [u, v] = self.hit.parameters;
        match self.object.shape.domain() {
            [_, _] => {
                let chart = self.object.shape.chart_label();
                format!("{title} at {chart} = ({u:.4}, {v:.4})")
            }
            [_] => format!("{title} at {} = {u:.4}", self.object.shape.parameters()[0]),
            _ => title,
        }
    }

    /// Returns the object with the params of the picture in which it was hit.
    pub fn subject(&self) -> Subject {
        Subject {
            scene: Arc::clone(self.request.scene.arc()),
            param_values: Arc::clone(&self.request.params),
            surface: self.hit.object,
        }
    }

    /// Returns the geodesic camera that a click places there; `None` if it shows the declaration instead. On a solid,
    /// most clicks are meant for the declaration, except if its geodesic view is shown: `is_inside` says whether it is.
    ///
    /// # Errors
    /// [`RenderError`] if no camera can be there.
    pub fn camera(
        &self,
        model: &Model,
        is_inside: impl FnOnce(&str) -> bool,
    ) -> Result<Option<InsideCamera>, RenderError> {
        let name = &self.object.name;
        let has_camera = match self.object.shape.solid() {
            Some(_) => is_inside(name),
            None => self.object.shape.manifold().is_some(),
        };
        if !has_camera {
            return Ok(None);
        }
        let zoom = model.choices.inside.get(name).map(InsideCamera::zoom);
        self.subject().camera_at(self.hit, zoom).map(Some)
    }
}
