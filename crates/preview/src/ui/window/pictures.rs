//! The panes' pictures: asked for where they differ from what is there, taken over when they come.

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::Ui;
use geodesic::ends::{Estimate, Work};
use scene::Scene;

use super::Window;
use crate::engine::render_thread::{Drawing, Painted};
use crate::engine::request::{Look, Order};
use crate::state::pane::PaneKey;
use crate::ui::gpu_surface::TextureBinding;

/// The time that a picture of a moving view should take.
const MOVING_PICTURE: f64 = 0.022;

/// A picture that is on the screen.
pub(crate) struct Picture {
    /// Newly arrived, to be handed to the GPU.
    pub(crate) fresh: Option<Painted>,
    /// Where it is painted from.
    pub(crate) binding: Option<TextureBinding>,
    pub(crate) notes: Vec<String>,
    pub(crate) overlays: Vec<&'static str>,
    pub(crate) inside: Option<(Work, Option<Estimate>)>,
    pub(crate) took: Duration,
    /// Seconds a pixel took.
    rate: f64,
    /// Why there is no newer one.
    pub(crate) error: Option<String>,
    pub(crate) version: i32,
    scene: Arc<Scene>,
}

impl Window {
    /// For how long a frame may wait for the pictures that it asks for, where they are expected within that time. None at
    /// first; a screen knows what is right for it.
    pub fn set_frame_wait_budget(&mut self, frame_wait_budget: Duration) {
        self.frame_wait_budget = frame_wait_budget;
    }

    /// A pane is on the screen and has room for so many pixels.
    pub(crate) fn make_room(&mut self, pane: &PaneKey, pixels: [u32; 2]) {
        self.seen.insert(pane.clone(), pixels);
        if *pane == PaneKey::Space && self.space_room.replace(pixels) != Some(pixels) {
            // A camera that nobody has moved shows everything in a pane of another shape too.
            self.model.reframe();
        }
    }

    /// Asks for the pictures that the panes on the screen have room for, as far as they are not on their way.
    pub(super) fn ask(&mut self, ui: &Ui) {
        let moving = ui.input(|input| input.time) < self.moving_until;
        let again = ui.ctx().current_pass_index() > 0;
        for (pane, pixels) in self.seen.clone() {
            self.want(&pane, pixels, moving, again);
        }
    }

    fn want(&mut self, pane: &PaneKey, pixels: [u32; 2], moving: bool, again: bool) {
        let size = match self.sent.get(pane) {
            // A picture that has just come is not replaced by one of a size that would have been quicker.
            Some(sent) if moving && again => sent.size,
            _ => self.picture_size(pane, pixels, moving),
        };
        let active = self.active_surface.clone();
        let model = &mut self.model;
        let library = &mut self.library;
        let order =
            crate::engine::request::order(model, library, pane, size, active.as_deref(), moving);
        let Some(order) = order else {
            return;
        };
        let sent = self.sent.get(pane);
        if sent.is_some_and(|sent| sent.is_like(&order)) {
            return;
        }
        self.sent.insert(pane.clone(), order.clone());
        self.waiting.insert(pane.clone());
        self.render_thread.draw(pane.clone(), order);
    }

    /// Waits for the pictures that are on their way, if they are expected soon: then they are part of this frame, and
    /// no frame is drawn without them.
    pub(super) fn await_pictures(&mut self, context: &egui::Context) {
        self.waited = Duration::ZERO;
        if self.waiting.is_empty() || context.current_pass_index() > 0 {
            return;
        }
        let took = |pane| self.pictures.get(pane).map(|it| it.took);
        let expected: Option<Duration> = self.waiting.iter().map(took).sum();
        if expected.is_none_or(|expected| expected > self.frame_wait_budget) {
            return;
        }
        let start = Instant::now();
        self.sender.listen(true);
        let mut came = false;
        while !self.waiting.is_empty() {
            let left = self.frame_wait_budget.saturating_sub(start.elapsed());
            let Ok(event) = self.events.recv_timeout(left) else {
                break;
            };
            self.handle_event(event);
            came = true;
        }
        self.sender.listen(false);
        // What came between the last look and now has woken nobody.
        came |= self.handle_events();
        self.waited = start.elapsed();
        if came {
            context.request_discard("pictures have come");
        }
    }

    /// The size of the picture for a pane: coarser while it moves, if pictures take long.
    fn picture_size(&self, pane: &PaneKey, pixels: [u32; 2], moving: bool) -> [u32; 2] {
        let preferences = &self.model.view.preferences;
        let wanted = match pane {
            PaneKey::Space => preferences.space_size,
            PaneKey::Inside(_) => preferences.inside_size,
        };
        let shorter = f64::from(pixels[0].min(pixels[1]).max(1));
        let mut scale = wanted.map_or(1.0, |side| f64::from(side) / shorter);
        if moving && let Some(picture) = self.pictures.get(pane) {
            let all = f64::from(pixels[0]) * f64::from(pixels[1]) * scale * scale;
            let share = (MOVING_PICTURE / (picture.rate * all).max(1e-9)).sqrt();
            // In steps, so that the size does not change with every picture.
            scale *= ((share * 8.0).floor() / 8.0).clamp(0.25, 1.0);
        }
        pixels.map(|side| ((f64::from(side) * scale).round() as u32).clamp(16, 4096))
    }

    /// The order that a pane's picture was asked for by.
    pub(crate) fn sent(&self, pane: &PaneKey) -> Option<&Order> {
        self.sent.get(pane)
    }

    /// The order of a picture that is kept: as its pane shows it at rest, though it may move.
    pub(crate) fn kept(&self, pane: &PaneKey) -> Option<Order> {
        let order = self.sent.get(pane)?.clone();
        let room = self.seen.get(pane).copied();
        let size = room.map_or(order.size, |room| self.picture_size(pane, room, false));
        Some(order.kept(size))
    }

    /// The picture of a pane; an empty one at first.
    pub(super) fn picture(&mut self, pane: PaneKey, order: &Order) -> &mut Picture {
        self.pictures.entry(pane).or_insert_with(|| Picture {
            fresh: None,
            binding: None,
            notes: Vec::new(),
            overlays: Vec::new(),
            inside: None,
            took: std::time::Duration::ZERO,
            rate: 0.0,
            error: None,
            version: order.version,
            scene: Arc::clone(&order.scene),
        })
    }

    pub(super) fn take_drawing(&mut self, pane: PaneKey, drawing: Drawing, order: &Order) {
        self.take_space_camera(&pane, &drawing, order);
        let pixels = drawing.pixels.pixels();
        let picture = self.picture(pane, order);
        picture.fresh = Some(drawing.pixels);
        picture.notes = drawing.notes;
        picture.overlays = drawing.overlays;
        picture.inside = drawing.inside.or(picture.inside);
        picture.took = drawing.took;
        picture.rate = drawing.took.as_secs_f64() / pixels.max(1) as f64;
        picture.error = None;
        picture.version = order.version;
        picture.scene = Arc::clone(&order.scene);
    }

    /// Takes over the camera that sees everything, for a scene that has none: from then on it stays, whatever the params
    /// do. It is ignored if the scene or the pane's size has changed since the request.
    fn take_space_camera(&mut self, pane: &PaneKey, drawing: &Drawing, order: &Order) {
        let Some(first) = drawing.space_camera else {
            return;
        };
        if self.model.view.space.is_some() {
            return;
        }
        let Some(sent) = self.sent.get_mut(pane) else {
            return;
        };
        if !Arc::ptr_eq(&sent.scene, &order.scene) || sent.size != order.size {
            return;
        }
        let same = sent.is_like(order);
        if let Look::Space { camera, .. } = &mut sent.look
            && same
        {
            *camera = Some(first);
        }
        self.model.adjust(|view| view.space = Some(first));
    }
}
