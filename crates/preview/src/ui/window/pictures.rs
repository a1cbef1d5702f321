//! The panes' pictures: requested when they differ from those that are shown, taken over when they arrive.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use egui::Ui;
use render::rendered::RenderedImage;
use render::{PictureRequest, Renderer, ViewId};
use session::framing::put_camera;
use session::refinement::{self, PictureProgress};
use session::request::{PaneRequest, at_rest, picture_request};
use session::{Model, SpaceCamera};

use super::Window;
use super::pane_view::{PaneView, Picture, Waiting};
use crate::engine::render_thread::{RenderThread, VersionedRequest};
use crate::engine::textures::Library;

/// The pictures of a window, and the thread that draws them.
pub(crate) struct Pictures {
    pub(crate) render_thread: RenderThread,
    pub(crate) library: Library,
    /// The views that have been on the screen.
    pub(crate) of_views: BTreeMap<ViewId, PaneView>,
}

impl Pictures {
    /// Returns whether any picture is pending.
    pub(super) fn is_waiting(&self) -> bool {
        let mut views = self.of_views.values();
        views.any(|view| view.waiting != Waiting::No)
    }

    /// Returns the expected time until the pictures for which a frame may wait; `None` if it waits for none. The time
    /// for a pane's first picture is unknown: waiting is worth a try.
    fn expected(&self) -> Option<Duration> {
        let views = self.of_views.values();
        let mut waiting = views
            .filter(|view| view.waiting == Waiting::ForFrame)
            .peekable();
        waiting.peek()?;
        let took = waiting.filter_map(|view| view.picture.as_ref().map(|it| it.took));
        Some(took.sum())
    }

    /// Returns the request that was sent last for a pane's picture.
    pub(crate) fn sent(&self, pane: &ViewId) -> Option<&PictureRequest> {
        self.of_views.get(pane)?.request.as_ref()
    }

    /// Returns the time of the interface at which a picture of something else was requested for a pane, in seconds.
    pub(crate) fn changed_at(&self, pane: &ViewId) -> f64 {
        self.of_views.get(pane).map_or(0.0, |view| view.changed_at)
    }

    /// Returns the picture that a pane shows.
    pub(crate) fn shown(&self, pane: &ViewId) -> Option<&Picture> {
        self.of_views.get(pane)?.picture.as_ref()
    }

    /// Returns the request for a picture that is saved: as its pane shows it at rest, even while it moves.
    pub(crate) fn kept(&self, model: &Model, pane: &ViewId) -> Option<PictureRequest> {
        let preferences = &model.choices.preferences;
        let view = self.of_views.get(pane)?;
        let request = view.request.clone()?;
        let room = view.room.filter(|_| view.on_screen);
        let size = room.map_or(request.size, |room| {
            refinement::size_at_rest(preferences, pane, room)
        });
        Some(at_rest(request, model, size))
    }

    /// Requests all pictures again, from another renderer.
    pub(super) fn draw_by(&mut self, renderer: Renderer) {
        for view in self.of_views.values_mut() {
            view.forget_request();
            view.picture = None;
        }
        self.render_thread.set_renderer(renderer);
    }

    /// Drops all pictures and requests, since they are of another program.
    pub(super) fn forget_all(&mut self) {
        for (pane, _) in std::mem::take(&mut self.of_views) {
            self.render_thread.forget(&pane);
        }
        self.render_thread.begin_program();
    }

    /// Drops the requests of panes that are not on the screen. Returns whether there were any.
    pub(super) fn forget_hidden(&mut self) -> bool {
        let mut any = false;
        for (pane, view) in &mut self.of_views {
            if !view.on_screen && view.request.is_some() {
                self.render_thread.forget(pane);
                view.forget_request();
                any = true;
            }
        }
        any
    }
}

impl Window {
    /// Sets the maximum time that a frame waits for the pictures that it requests, if they are expected within that
    /// time. It is zero initially; the display determines it.
    pub fn set_frame_wait_budget(&mut self, budget: Duration) {
        self.display.clock.wait_budget = budget;
    }

    /// Notes that a pane is on the screen, and its size in pixels.
    pub(crate) fn make_room(&mut self, pane: &ViewId, pixels: [u32; 2]) {
        let view = self.pictures.of_views.entry(pane.clone()).or_default();
        view.on_screen = true;
        let has_changed = view.room.replace(pixels) != Some(pixels);
        let options = self.views.get(&pane.kind).map(|view| view.options(None));
        if has_changed && options.is_some_and(|options| options.space().is_some()) {
            // A camera that the user has not moved sees everything in a pane of another shape too.
            self.model.reframe();
        }
    }

    /// Requests the pictures of the panes on the screen, unless they are pending. Pictures that follow the camera of
    /// another view come last.
    pub(super) fn request_pictures(&mut self, ui: &Ui) {
        let now = ui.input(|input| input.time);
        let moving = now < self.display.clock.moving_until;
        let seen = self
            .pictures
            .of_views
            .iter()
            .filter(|(_, view)| view.on_screen);
        let seen: Vec<ViewId> = seen.map(|(pane, _)| pane.clone()).collect();
        let mut following = Vec::new();
        for pane in seen {
            let Some(picture) = self.wanted_picture(&pane, moving) else {
                continue;
            };
            let view = self.pictures.of_views.entry(pane.clone()).or_default();
            view.send(&picture, now);
            let version = self.model.program.version;
            let request = VersionedRequest { picture, version };
            match view.waiting {
                Waiting::Following => following.push((pane, request)),
                _ => self.pictures.render_thread.draw(pane, request),
            }
        }
        for (pane, request) in following {
            self.pictures.render_thread.draw(pane, request);
        }
    }

    /// Returns the next request for a pane's picture: see [`PictureProgress::next`].
    fn wanted_picture(&mut self, pane: &ViewId, moving: bool) -> Option<PictureRequest> {
        let room = self.pictures.of_views.get(pane)?.room?;
        let asked = PaneRequest {
            id: pane,
            size: refinement::size_at_rest(&self.model.choices.preferences, pane, room),
            active: self.focus.surface.as_deref(),
        };
        let library = &mut self.pictures.library;
        let request = picture_request(&mut self.model, library, &self.views, asked)?;
        let view = self.pictures.of_views.get(pane)?;
        let shown = view.picture.as_ref();
        let has_failed = shown.is_some_and(|shown| shown.error.is_some());
        let progress = PictureProgress {
            sent: view.request.as_ref(),
            shown: shown.map(|shown| shown.detail),
            is_answered: view.waiting == Waiting::No && !has_failed,
            moving,
        };
        progress.next(request, self.model.choices.preferences.samples)
    }

    /// Returns whether a pane shows the whole scene ray-traced.
    pub(crate) fn shows_traced(&self, pane: &ViewId) -> bool {
        self.model.choices.preferences.traced && self.can_be_traced(pane)
    }

    /// Returns whether a pane can show the whole scene ray-traced.
    pub(crate) fn can_be_traced(&self, pane: &ViewId) -> bool {
        pane.object.is_none() && self.views.instead_of(&pane.kind).is_some()
    }

    /// Shows the whole scene ray-traced, or as before.
    pub(crate) fn toggle_traced(&mut self) {
        let traced = self.model.choices.preferences.traced;
        self.model.set_traced(!traced);
    }

    /// In the first frame, waits for the initial text: the frame is laid out for that text, and no frame is drawn
    /// without it.
    pub(super) fn await_first_text(&mut self) {
        if self.records.counters.frames == 0 && !self.panes.is_welcome {
            self.await_events(|window| !window.model.read);
        }
    }

    /// Waits for the pending pictures, if they are expected soon: then they are part of this frame, and no frame is
    /// drawn without them.
    pub(super) fn await_pictures(&mut self, context: &egui::Context) {
        if context.current_pass_index() > 0 {
            return;
        }
        let expected = self.pictures.expected();
        if expected.is_none_or(|expected| expected > self.display.clock.wait_budget) {
            return;
        }
        if self.await_events(|window| window.pictures.expected().is_some()) {
            context.request_discard("pictures have come");
        }
    }

    /// Handles events while they are wanted and the frame may wait. Returns whether there were any.
    fn await_events(&mut self, are_wanted: impl Fn(&Self) -> bool) -> bool {
        let start = Instant::now();
        self.events.sender.listen(true);
        let mut came = false;
        while are_wanted(self) {
            let budget = self.display.clock.wait_budget;
            let left = budget.saturating_sub(start.elapsed());
            let Ok(event) = self.events.receiver.recv_timeout(left) else {
                break;
            };
            self.handle_event(event);
            came = true;
        }
        self.events.sender.listen(false);
        // An event that arrived between the last check and now has not woken the window.
        came |= self.handle_events();
        self.display.clock.waited += start.elapsed();
        came
    }

    /// Takes over a pane's picture, or the sentence that says why there is none, and the camera of the views in space.
    pub(super) fn take_picture(
        &mut self,
        pane: &ViewId,
        picture: Result<Box<RenderedImage>, String>,
        space_camera: Option<SpaceCamera>,
        request: &VersionedRequest,
    ) {
        let view = self.pictures.of_views.entry(pane.clone()).or_default();
        if view.request.as_ref() == Some(&request.picture) {
            view.waiting = Waiting::No;
        }
        match picture {
            Ok(drawn) => view.take(*drawn, request.version),
            Err(reason) => view.fail(reason, request.version),
        }
        // Not before this: it puts the camera into the request that was sent, which is compared above.
        if let Some(camera) = space_camera {
            self.take_space_camera(pane, camera, &request.picture);
        }
    }

    /// Takes over the camera that sees everything, for a scene that has none: from then on it stays, whatever the
    /// params do. It is ignored if the scene or the pane's size has changed since the request.
    fn take_space_camera(&mut self, pane: &ViewId, first: SpaceCamera, request: &PictureRequest) {
        if self.model.choices.space.is_some() || self.model.follows_declared_camera() {
            return self.model.take_first_camera(first);
        }
        let view = self.pictures.of_views.get_mut(pane);
        let Some(sent) = view.and_then(|view: &mut PaneView| view.request.as_mut()) else {
            return;
        };
        if sent.scene != request.scene || sent.size != request.size {
            return;
        }
        if sent == request {
            // The same picture would be drawn with it.
            put_camera(sent, &first);
        }
        self.model.take_first_camera(first);
    }

    /// Returns the request for a picture of a view that is saved.
    pub(crate) fn kept(&self, id: &ViewId) -> Option<PictureRequest> {
        self.pictures.kept(&self.model, id)
    }
}
