//! Clicks on pictures, as the window handles them; `session::clicks` describes their effects.

use egui::Ui;
use render::PictureRequest;
use render::view::Hit;
use session::StatusMessage;
use session::clicks::ClickedObject;

use super::Window;
use crate::engine::render_thread::Purpose;

impl Window {
    /// Handles a click on a pixel of a picture of a view in space. A click by a key is never the first half of a double
    /// click.
    pub(crate) fn click(&mut self, request: PictureRequest, at: [f64; 2], by_key: bool, ui: &Ui) {
        if self.dialogs.measuring.is_open() {
            let purpose = Purpose::Measure(crate::ui::measure::snapping(ui));
            self.pictures.render_thread.pick(request, at, purpose);
            return;
        }
        self.end_click();
        let now = (!by_key).then(|| ui.input(|input| input.time));
        let number = self.input.clicks.begin(now, self.focus.surface.clone());
        self.pictures
            .render_thread
            .pick(request, at, Purpose::Place(number));
    }

    /// Handles a double click, whose first half has been handled as a click.
    pub(crate) fn double_click(&mut self, request: PictureRequest, at: [f64; 2]) {
        if self.dialogs.measuring.is_open() {
            return;
        }
        if let Some(moved) = self.input.clicks.withdraw(&mut self.model) {
            self.focus.surface = moved.shown;
        }
        self.pictures.render_thread.pick(request, at, Purpose::Open);
    }

    /// Ends the last click: it has no further effect.
    pub(super) fn forget_click(&mut self) {
        self.input.clicks.forget(&mut self.model);
    }

    /// Returns the time until which another click may still follow the last one, or `None` if none may.
    pub(crate) fn clicked_until(&self) -> Option<f64> {
        self.input.clicks.until()
    }

    /// Ends the last click when none can follow it any more.
    pub(super) fn end_old_click(&mut self, ui: &Ui) {
        let now = ui.input(|input| input.time);
        if self.clicked_until().is_some_and(|until| now >= until) {
            self.end_click();
        }
    }

    /// Notes that a click was a single one.
    fn end_click(&mut self) {
        if let Some(surface) = self.input.clicks.end(&mut self.model) {
            self.reveal_object(&surface);
        }
    }

    /// Takes over the object that was found by a click.
    pub(super) fn take_hit(&mut self, request: &PictureRequest, hit: &Hit, purpose: Purpose) {
        let Some(clicked) = ClickedObject::new(request, hit) else {
            return;
        };
        let name = &clicked.object.name;
        let number = match purpose {
            Purpose::Place(number) if self.input.clicks.is_withdrawn(number) => return,
            Purpose::Place(number) => number,
            Purpose::Open => {
                self.open_declaration(name);
                return self.show_leaf_of(request, &clicked);
            }
            Purpose::Measure(_) => return crate::ui::measure::add_place(self, name, hit),
            Purpose::Pointer(_) => return crate::ui::measure::point(self, &clicked),
        };
        self.status_message = Some(StatusMessage::clicked(clicked.words()));
        let camera = match clicked.camera(&self.model, |name| self.has_view_of(name)) {
            Ok(Some(camera)) => camera,
            Ok(None) => {
                self.show_declaration(name);
                return self.show_leaf_of(request, &clicked);
            }
            Err(error) => {
                self.status_message = Some(StatusMessage::error(error.to_string()));
                return;
            }
        };
        let clicks = &mut self.input.clicks;
        let has_ended = clicks.place(number, &mut self.model, name, camera);
        self.focus.surface = Some(name.clone());
        if has_ended {
            self.reveal_object(name);
        }
    }

    /// Shows the name of the part of a solid that was clicked, if it has one.
    fn show_leaf_of(&mut self, request: &PictureRequest, clicked: &ClickedObject<'_>) {
        if let Some(leaf) = clicked.leaf {
            self.show_leaf(request, leaf);
        }
    }
}
