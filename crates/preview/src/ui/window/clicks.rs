//! Clicks on views in space: one puts a geodesic camera somewhere, where there can be one; else it shows a declaration,
//! and so
//! do two.
//!
//! The first click is heeded at once. Where a second one makes a double click of it, it is as though it had never been.
//! An effect that would move the panes under the pointer waits until there can be no second one.

use std::sync::Arc;

use egui::Ui;
use render::PictureRequest;
use render::view::Hit;
use scene::{Object, SolidLeaf};

use super::Window;
use crate::engine::render_thread::Purpose;
use crate::state::camera_controller::Subject;
use crate::state::{InsideCamera, StatusMessage};

/// The longest time between two clicks that are a double click, in seconds.
pub(super) const DOUBLE_CLICK: f64 = 0.5;

/// The clicks that may still become double clicks.
#[derive(Debug, Default)]
pub(super) struct Clicks {
    /// The number of clicks so far.
    count: u64,
    /// The last one that was the first of two.
    withdrawn: Option<u64>,
    /// The last one, for as long as another one may follow.
    open: Option<Open>,
}

#[derive(Debug)]
struct Open {
    until: f64,
    /// The surface whose camera it has moved.
    surface: Option<String>,
    /// The surface whose camera was shown in space before.
    shown: Option<String>,
}

/// The leaf of a solid's set that was found.
fn leaf_of<'s>(object: &'s Object, hit: &Hit) -> Option<&'s SolidLeaf> {
    object.shape.solid()?.leaves.get(hit.leaf?)
}

impl Window {
    /// A click on a pixel of a picture of a view in space. One by a key is never the first half of two.
    pub(crate) fn click(&mut self, request: PictureRequest, at: [f64; 2], by_key: bool, ui: &Ui) {
        if self.dialogs.measuring.is_open() {
            let purpose = Purpose::Measure(crate::ui::measure::snapping(ui));
            self.pictures.render_thread.pick(request, at, purpose);
            return;
        }
        self.end_click();
        self.input.clicks.count += 1;
        self.input.clicks.open = (!by_key).then(|| Open {
            until: ui.input(|input| input.time) + DOUBLE_CLICK,
            surface: None,
            shown: self.focus.surface.clone(),
        });
        let purpose = Purpose::Place(self.input.clicks.count);
        self.pictures.render_thread.pick(request, at, purpose);
    }

    /// A double click there, whose first half has been taken for a click.
    pub(crate) fn double_click(&mut self, request: PictureRequest, at: [f64; 2]) {
        if self.dialogs.measuring.is_open() {
            return;
        }
        if let Some(open) = self.input.clicks.open.take() {
            self.input.clicks.withdrawn = Some(self.input.clicks.count);
            self.model.withdraw_placement();
            if open.surface.is_some() {
                self.focus.surface = open.shown;
            }
        }
        self.pictures.render_thread.pick(request, at, Purpose::Open);
    }

    /// Ends the last click: it has no further effect.
    pub(super) fn forget_click(&mut self) {
        self.model.keep_placement();
        self.input.clicks.open = None;
    }

    /// Returns the time until which another click may still follow the last one, if it may.
    pub(crate) fn clicked_until(&self) -> Option<f64> {
        self.input.clicks.open.as_ref().map(|it| it.until)
    }

    /// Ends the last click when none can follow it any more.
    pub(super) fn end_old_click(&mut self, ui: &Ui) {
        let time = ui.input(|input| input.time);
        if self
            .input
            .clicks
            .open
            .as_ref()
            .is_some_and(|it| time >= it.until)
        {
            self.end_click();
        }
    }

    /// A click was one, and nothing more.
    fn end_click(&mut self) {
        self.model.keep_placement();
        if let Some(surface) = self.input.clicks.open.take().and_then(|it| it.surface) {
            self.reveal_object(&surface);
        }
    }

    /// Takes over the object that was found under a click.
    pub(super) fn take_hit(&mut self, request: &PictureRequest, hit: &Hit, purpose: Purpose) {
        let Some(object) = request.scene.objects.get(hit.object.0 as usize) else {
            return;
        };
        let name = object.name.clone();
        let number = match purpose {
            Purpose::Place(number) if self.input.clicks.withdrawn == Some(number) => return,
            Purpose::Place(number) => number,
            Purpose::Open => {
                self.open_declaration(&name);
                if let Some(leaf) = leaf_of(object, hit) {
                    self.show_leaf(request, leaf);
                }
                return;
            }
            Purpose::Measure(_) => return crate::ui::measure::add_place(self, &name, hit),
            Purpose::Pointer(_) => return crate::ui::measure::point(self, &name, hit),
        };
        let [u, v] = hit.parameters;
        let sentence = match object.shape.domain() {
            [_, _] => format!("{name} at (u, v) = ({u:.4}, {v:.4})"),
            [_] => format!("{name} at t = {u:.4}"),
            _ => match leaf_of(object, hit) {
                Some(leaf) if leaf.name != name => format!("{name}: {}", leaf.name),
                _ => name.clone(),
            },
        };
        self.status_message = Some(StatusMessage::info(sentence));
        // A solid's declaration is what most want of it, unless they look from inside it.
        let has_camera = match object.shape.solid() {
            Some(_) => self.has_view_of(&name),
            None => object.shape.manifold().is_some(),
        };
        if !has_camera {
            self.show_declaration(&name);
            if let Some(leaf) = leaf_of(object, hit) {
                self.show_leaf(request, leaf);
            }
            return;
        }
        let subject = Subject {
            scene: Arc::clone(request.scene.arc()),
            settings: Arc::clone(&request.params),
            surface: hit.object,
        };
        let zoom = self.model.view.inside.get(&name).map(InsideCamera::zoom);
        let camera = match subject.camera_at(hit, zoom) {
            Ok(camera) => camera,
            Err(error) => {
                self.status_message = Some(StatusMessage::error(error.to_string()));
                return;
            }
        };
        self.model.place(&name, camera);
        self.focus.surface = Some(name.clone());
        match &mut self.input.clicks.open {
            Some(open) if number == self.input.clicks.count => open.surface = Some(name),
            _ => {
                self.model.keep_placement();
                self.reveal_object(&name);
            }
        }
    }
}
