//! What hands do: keys, shortcuts, dropped files; and what moves by itself.

use std::path::PathBuf;
use std::time::Duration;

use egui::{Key, KeyboardShortcut, Modifiers, Ui};

use super::Window;
use crate::model::{SpaceCamera, Step};
use crate::motion;
use crate::orders::PaneKey;

/// For how long after its last motion a view counts as moving: the pause between two turns of a wheel.
const MOTION_PAUSE: f64 = 0.18;

impl Window {
    pub(super) fn animate(&mut self, ui: &Ui) {
        if !self.model.is_animated() {
            return;
        }
        let seconds = ui
            .input(|input| f64::from(input.unstable_dt))
            .clamp(0.0, 0.1);
        self.model.animate(seconds);
        self.has_moved(ui);
        ui.ctx().request_repaint();
    }

    /// A view or a param is moving.
    pub(crate) fn has_moved(&mut self, ui: &Ui) {
        self.moving_until = ui.input(|input| input.time) + MOTION_PAUSE;
        let pause = Duration::from_secs_f64(MOTION_PAUSE + 0.01);
        ui.ctx().request_repaint_after(pause);
    }

    /// Held keys move the camera of the active pane, unless a text is being written.
    pub(super) fn keys(&mut self, ui: &Ui) {
        if ui.ctx().text_edit_focused() || self.dialogs.is_open() {
            return;
        }
        let speed = self.model.view.preferences.camera_speed;
        match self.active.clone() {
            PaneKey::Space => {
                self.space_shortcuts(ui);
                let Some(camera) = self.model.view.space else {
                    return;
                };
                let next = ui.input(|input| motion::space_keys(input, camera, speed));
                if next != camera {
                    self.move_space("keys", next, ui);
                }
            }
            PaneKey::Inside(name) => {
                if ui.input(|input| input.key_pressed(Key::R) && input.modifiers.is_none())
                    || ui.input(|input| input.key_pressed(Key::Home))
                {
                    self.reset_inside(&name);
                }
                let motions = ui.input(|input| motion::inside_keys(input, speed));
                for motion in motions {
                    self.walk(&name, motion, ui);
                }
            }
        }
        if ui.input(motion::any_held) {
            ui.ctx().request_repaint();
        }
    }

    fn space_shortcuts(&mut self, ui: &Ui) {
        let pressed = |key| ui.input(|input| input.key_pressed(key) && input.modifiers.is_none());
        if pressed(Key::R) || pressed(Key::Home) {
            self.reset_space();
        }
        if pressed(Key::F) {
            self.frame_all();
        }
    }

    /// Moves the 3D camera, as one step with what else `hand` does in one go.
    pub(crate) fn move_space(&mut self, hand: &str, camera: SpaceCamera, ui: &Ui) {
        let step = Step::new("Move the 3D camera", hand);
        self.model.change(step, |view| view.space = Some(camera));
        self.has_moved(ui);
    }

    /// Moves a geodesic camera.
    pub(crate) fn walk(&mut self, surface: &str, motion: motion::Motion, ui: &Ui) {
        let step = Step::new("Move the geodesic camera", surface);
        self.model.begin(step);
        self.artist.walk(surface, motion);
        self.has_moved(ui);
    }

    /// Puts the 3D camera where everything is seen, from the first direction.
    pub(crate) fn reset_space(&mut self) {
        let step = Step::new("Reset the 3D camera", "");
        self.model.change(step, |view| view.space = None);
        self.model.history.settle();
    }

    /// Puts the 3D camera where everything is seen, from where it looks now: the artist knows how far that is.
    pub(crate) fn frame_all(&mut self) {
        if let Some(order) = self.sent.get(&PaneKey::Space) {
            self.artist.frame(order.clone());
        }
    }

    /// Puts a geodesic camera at its first place.
    pub(crate) fn reset_inside(&mut self, surface: &str) {
        let step = Step::new("Reset the geodesic camera", surface);
        self.model.change(step, |view| {
            view.inside.remove(surface);
        });
        self.model.history.settle();
        self.model.placed += 1;
    }

    pub(super) fn shortcuts(&mut self, ui: &Ui) {
        let pressed = |modifiers: Modifiers, key: Key| {
            let shortcut = KeyboardShortcut::new(modifiers, key);
            ui.input_mut(|input| input.consume_shortcut(&shortcut))
        };
        if pressed(Modifiers::COMMAND, Key::S) {
            self.save_text();
        }
        if pressed(Modifiers::NONE, Key::F1) {
            self.dialogs.shortcuts = true;
        }
        // In a text, these belong to the text.
        if !ui.ctx().text_edit_focused() {
            let redo = pressed(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z)
                || pressed(Modifiers::COMMAND, Key::Y);
            if redo {
                self.redo();
            } else if pressed(Modifiers::COMMAND, Key::Z) {
                self.undo();
            }
        }
    }

    /// Takes the last change of the view back.
    pub fn undo(&mut self) {
        self.said = self
            .model
            .undo()
            .map(|title| (false, format!("Undone: {title}")));
    }

    /// Does the last change of the view again.
    pub fn redo(&mut self) {
        self.said = self
            .model
            .redo()
            .map(|title| (false, format!("Done again: {title}")));
    }

    pub(super) fn take_drops(&mut self, ui: &Ui) {
        let paths: Vec<PathBuf> = ui.input(|input| {
            let files = input.raw.dropped_files.iter();
            files.map(|file| file.path().to_owned()).collect()
        });
        if !paths.is_empty() {
            self.open_images(paths);
        }
    }

    /// Adds image files to the list of textures; the last one is what the active surface shows.
    pub(crate) fn open_images(&mut self, paths: Vec<PathBuf>) {
        for path in &paths {
            self.library.read(path.clone());
        }
        self.model.change(Step::new("Open textures", ""), |view| {
            for path in paths {
                if !view.textures.contains(&path) {
                    view.textures.push(path);
                }
            }
        });
    }
}
