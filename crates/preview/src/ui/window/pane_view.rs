//! A pane with a picture: its room on the screen, the request that was sent for it, and the picture that it shows.

use std::time::Duration;

use geodesic::ends::{Estimate, Work};

use crate::engine::render_thread::{Drawing, Painted};
use crate::engine::request::Order;
use crate::ui::gpu_surface::TextureBinding;

/// A pane with a picture.
#[derive(Default)]
pub(crate) struct PaneView {
    /// The pixels that the pane had room for when it was last on the screen.
    pub(super) room: Option<[u32; 2]>,
    /// Set if it was on the screen when the window last drew itself.
    pub(super) on_screen: bool,
    /// The request that was sent last.
    pub(super) request: Option<Order>,
    pub(super) waiting: Waiting,
    /// The picture that is on the screen.
    pub(crate) picture: Option<Picture>,
}

/// The state of a pane's last request.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub(super) enum Waiting {
    /// It has.
    #[default]
    No,
    /// It has not, and a frame may wait for the answer.
    ForFrame,
    /// It has not. The picture only follows the camera of another view, and no frame waits for it.
    Following,
}

/// A picture that is on the screen.
#[derive(Default)]
pub(crate) struct Picture {
    /// Newly arrived pixels, to be handed to the GPU.
    pub(crate) fresh: Option<Painted>,
    /// The texture that it is painted from.
    pub(crate) binding: Option<TextureBinding>,
    pub(crate) notes: Vec<String>,
    pub(crate) inside: Option<(Work, Option<Estimate>)>,
    pub(crate) took: Duration,
    /// The seconds that a pixel took.
    pub(super) rate: f64,
    /// The reason why there is no newer one.
    pub(crate) error: Option<String>,
    /// The version of the text that it shows.
    pub(crate) version: i32,
}

impl PaneView {
    /// Notes a request that is sent now. A picture that differs from the one before only by another view's camera is
    /// one
    /// that follows.
    pub(super) fn send(&mut self, order: &Order) {
        let before = self.request.as_ref();
        let follows = before.is_some_and(|before| before.differs_by_shown_camera(order));
        self.waiting = match (follows, self.waiting) {
            (true, Waiting::No | Waiting::Following) => Waiting::Following,
            _ => Waiting::ForFrame,
        };
        self.request = Some(order.clone());
    }

    /// Forgets the request, whose answer nobody needs.
    pub(super) fn forget_request(&mut self) {
        self.request = None;
        self.waiting = Waiting::No;
    }

    /// Takes over a picture that was drawn.
    pub(super) fn take(&mut self, drawing: Drawing, version: i32) {
        let pixels = drawing.pixels.pixels();
        let picture = self.picture.get_or_insert_default();
        picture.fresh = Some(drawing.pixels);
        picture.notes = drawing.notes;
        picture.inside = drawing.inside.or(picture.inside);
        picture.took = drawing.took;
        picture.rate = drawing.took.as_secs_f64() / pixels.max(1) as f64;
        picture.error = None;
        picture.version = version;
    }

    /// Takes over the reason why there is no newer picture.
    pub(super) fn fail(&mut self, reason: String, version: i32) {
        let picture = self.picture.get_or_insert_default();
        picture.error = Some(reason);
        picture.version = version;
    }
}
