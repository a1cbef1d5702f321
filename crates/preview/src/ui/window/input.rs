//! The user's input: keys, shortcuts, dropped files; and the animation of params.

use std::path::PathBuf;
use std::time::Duration;

use egui::{Event, Key, KeyboardShortcut, Modifiers, MouseWheelSource, MouseWheelUnit, Ui};
use scene::ObjectId;
use session::camera_input::MAX_STEP;
use session::camera_input::axis_views::Turn;
use session::clicks::Clicks;
use session::motion::Motion;
use session::pane::Pane;
use session::{MessageKind, StatusMessage};
use session::{SpaceCamera, Step, TextureChoice};

use super::Window;
use crate::engine::textures;
use crate::ui::camera_input::{held, may_be_of_control, presses_camera_key};
use crate::ui::held_keys::HeldKeys;
use crate::ui::panes::picture;

/// The state of the user's input between two frames.
#[derive(Debug, Default)]
pub(crate) struct InputState {
    pub(super) clicks: Clicks,
    /// A param that keys have changed: its value is written into the text when the keys are released.
    pub(crate) unwritten_param: Option<String>,
    /// True if the keys were used last, and not the pointer.
    pub(crate) by_keys: bool,
    /// The keys that are held.
    pub(crate) held: HeldKeys,
    /// True if two fingers on a touchpad scrolled last, and not a wheel.
    pub(crate) fingers: bool,
    /// The camera in space while it turns to a view along an axis.
    pub(crate) turn: Option<Turn>,
}

/// A change of the size of the controls.
#[derive(Clone, Copy)]
enum Sizing {
    Larger,
    Smaller,
    Plain,
}

impl Sizing {
    /// Returns the next larger or smaller size.
    fn of(self, scale: f32) -> f32 {
        let mut sizes = session::SCALES.into_iter();
        let next = match self {
            Self::Plain => None,
            Self::Larger => sizes.find(|it| *it > scale + 0.01).or(Some(scale)),
            Self::Smaller => sizes.rfind(|it| *it < scale - 0.01).or(Some(scale)),
        };
        next.unwrap_or(1.0)
    }
}

/// Returns whether an event that scrolls comes from two fingers on a touchpad; `None` for another event.
fn by_fingers(event: &Event) -> Option<bool> {
    match event {
        Event::MouseWheel { source, unit, .. } => Some(match source {
            MouseWheelSource::Trackpad | MouseWheelSource::Momentum => true,
            MouseWheelSource::Wheel => false,
            // If the platform does not specify the unit, wheels count lines.
            MouseWheelSource::Unknown => *unit == MouseWheelUnit::Point,
        }),
        _ => None,
    }
}

impl Window {
    pub(super) fn animate(&mut self, ui: &Ui) {
        if !self.model.is_animated() {
            return;
        }
        let seconds = ui
            .input(|input| f64::from(input.unstable_dt))
            .clamp(0.0, MAX_STEP);
        self.model.animate(seconds);
        self.display.clock.note_motion(ui.input(|input| input.time));
        ui.ctx().request_repaint();
    }

    /// Notes that the user has moved a view or a param.
    pub(crate) fn has_moved(&mut self, ui: &Ui) {
        self.status_message
            .take_if(|message| message.kind == MessageKind::Clicked);
        self.display
            .clock
            .note_gesture(ui.input(|input| input.time));
    }

    /// Requests a repaint for the time when a motion has come to rest and a click can no longer become a double click.
    /// A frame that comes sooner cancels the request, so each frame renews it.
    pub(super) fn wake_in_time(&self, ui: &Ui) {
        let now = ui.input(|input| input.time);
        let clock = &self.display.clock;
        let times = [
            Some(clock.moving_until),
            clock.attention.next_end(&self.model),
            self.clicked_until(),
        ];
        let next = times.into_iter().flatten().filter(|time| *time > now);
        if let Some(time) = next.min_by(f64::total_cmp) {
            let pause = Duration::from_secs_f64(time - now + 0.01);
            ui.ctx().request_repaint_after(pause);
        }
    }

    /// Handles the keys that are pressed and released, and scrolling. The keys of a text or a dialog never move a
    /// camera.
    pub(super) fn hold_keys(&mut self, ui: &Ui) {
        let letters = !ui.ctx().text_edit_focused() && !self.dialogs.is_open();
        let presses =
            |input: &egui::InputState| input.modifiers.is_none() && presses_camera_key(input);
        if letters && !self.input.held.any() && ui.input(presses) {
            self.activate_pointed(ui);
        }
        let arrows = letters && self.has_arrows(ui);
        let has_key = |key| {
            if may_be_of_control(key) {
                arrows
            } else {
                letters
            }
        };
        ui.input(|input| {
            self.input.held.update(&input.events, has_key);
            let mut events = input.events.iter().rev();
            self.input.fingers = events.find_map(by_fingers).unwrap_or(self.input.fingers);
        });
    }

    /// Makes the view over which the pointer was moved active, unless a control has the focus.
    fn activate_pointed(&mut self, ui: &Ui) {
        let Some(pointed) = self.focus.pointed.take() else {
            return;
        };
        if self.has_arrows(ui) && self.panes.in_front().contains(&pointed) {
            if ui.memory(egui::Memory::focused).is_some() {
                ui.memory_mut(|memory| memory.request_focus(picture::id(&pointed)));
            }
            self.activate(&pointed);
        }
    }

    /// Moves the camera of the active pane by held keys, unless a text is being written.
    pub(super) fn keys(&mut self, ui: &Ui) {
        // Determined in any case: menus and dialogs also refer to the active view.
        let has_keys = self.has_keys();
        if !has_keys || ui.ctx().text_edit_focused() || self.dialogs.is_open() {
            return;
        }
        let arrows = self.has_arrows(ui);
        let (id, camera) = (self.focus.view.clone(), self.camera_input(&self.focus.view));
        let pressed = |key| ui.input(|input| input.key_pressed(key) && input.modifiers.is_none());
        if pressed(Key::R) || pressed(Key::Home) {
            camera.reset(self, &id);
        }
        if pressed(Key::M) {
            crate::ui::measure::toggle(self);
        }
        camera.keys(self, ui, &id, arrows);
        if ui.input(|input| held(input, &self.input.held, arrows).any()) {
            ui.ctx().request_repaint();
        }
    }

    /// Returns whether the arrows belong to the active view: no control has the focus.
    pub(super) fn has_arrows(&self, ui: &Ui) -> bool {
        let focused = ui.memory(egui::Memory::focused);
        focused.is_none_or(|id| id == picture::id(&self.focus.view))
    }

    /// Moves the 3D camera, as one step with the other motions of the same gesture `hand`.
    pub(crate) fn move_space(&mut self, hand: &str, camera: SpaceCamera, ui: &Ui) {
        self.model.move_space(hand, camera);
        self.has_moved(ui);
    }

    /// Moves a geodesic camera.
    pub(crate) fn walk(&mut self, surface: &str, motion: Motion, ui: &Ui) {
        self.model.move_camera(surface, motion);
        self.has_moved(ui);
    }

    /// Requests a camera in space that sees everything, or one object, in its current direction: the render thread
    /// determines its distance.
    pub(crate) fn frame(&mut self, only: Option<&str>) {
        let sent = self.pictures.of_views.values();
        let mut sent = sent.filter_map(|view| view.request.as_ref());
        let Some(mut request) = sent.find(|it| it.view.space().is_some()).cloned() else {
            return;
        };
        if let Some(only) = only {
            let objects = (0..).zip(&request.scene.objects);
            let others = objects.filter(|(_, object)| object.name != only);
            let others = others.map(|(index, _)| ObjectId::new(index)).collect();
            if let Some(space) = request.view.space_mut() {
                space.hidden = others;
            }
        }
        self.pictures.render_thread.frame(request);
    }

    pub(super) fn shortcuts(&mut self, ui: &Ui) {
        self.input.by_keys = ui.input(|input| {
            let key = |event: &Event| matches!(event, Event::Key { pressed: true, .. });
            !input.pointer.any_down() && (self.input.by_keys || input.events.iter().any(key))
        });
        let pressed = |modifiers: Modifiers, key: Key| {
            let shortcut = KeyboardShortcut::new(modifiers, key);
            ui.input_mut(|input| input.consume_shortcut(&shortcut))
        };
        if pressed(Modifiers::COMMAND | Modifiers::SHIFT, Key::S) {
            if !self.panes.is_welcome && !self.dialogs.is_open() {
                crate::ui::dialogs::program::ask_for_target(self, None);
            }
        } else if pressed(Modifiers::COMMAND, Key::S) && !self.panes.is_welcome {
            self.save_text();
        }
        if self.text.is_own() && !self.panes.is_welcome && !self.dialogs.is_open() {
            self.find_keys(ui);
            self.text_keys(ui);
        }
        if pressed(Modifiers::NONE, Key::F11) {
            crate::ui::menu::toggle_full_screen(ui);
        }
        if pressed(Modifiers::COMMAND, Key::B) {
            self.panes.shows_views_alone ^= true;
        }
        if pressed(Modifiers::NONE, Key::F1) {
            self.dialogs.shortcuts = !self.dialogs.shortcuts;
        }
        if pressed(Modifiers::SHIFT, Key::F6) {
            self.next_view(ui, true);
        } else if pressed(Modifiers::NONE, Key::F6) {
            self.next_view(ui, false);
        }
        let size = (pressed(Modifiers::COMMAND, Key::Plus)
            || pressed(Modifiers::COMMAND, Key::Equals))
        .then_some(Sizing::Larger)
        .or(pressed(Modifiers::COMMAND, Key::Minus).then_some(Sizing::Smaller))
        .or(pressed(Modifiers::COMMAND, Key::Num0).then_some(Sizing::Plain));
        if let Some(sizing) = size {
            let step = Step::new("Change a setting", "scale");
            self.model.change(step, |choices| {
                let scale = &mut choices.preferences.scale;
                *scale = sizing.of(*scale);
            });
        }
        if !self.dialogs.is_open() {
            crate::ui::menu::file_keys(self, ui);
        }
        // In a text field, these keys belong to the text.
        if !ui.ctx().text_edit_focused() {
            let arrows = Modifiers::COMMAND | Modifiers::SHIFT;
            if pressed(arrows, Key::ArrowRight) {
                self.resize_active(true);
            }
            if pressed(arrows, Key::ArrowLeft) {
                self.resize_active(false);
            }
            let redo = pressed(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z)
                || pressed(Modifiers::COMMAND, Key::Y);
            if redo {
                self.redo();
            } else if pressed(Modifiers::COMMAND, Key::Z) {
                self.undo();
            }
        }
    }

    /// Makes the next or the previous open view active.
    pub(crate) fn next_view(&mut self, ui: &Ui, back: bool) {
        let views = self.offered().into_iter().map(Pane::View);
        let views: Vec<Pane> = views.filter(|pane| self.panes.is_open(pane)).collect();
        if views.is_empty() {
            return;
        }
        let now = views
            .iter()
            .position(|pane| pane.view() == Some(&self.focus.view));
        let next = match now {
            Some(at) if back => (at + views.len() - 1) % views.len(),
            Some(at) => (at + 1) % views.len(),
            None => 0,
        };
        self.bring_forward(&views[next]);
        let active = picture::id(&self.focus.view);
        ui.memory_mut(|memory| memory.request_focus(active));
    }

    /// Gives the active view more or less room beside its neighbours.
    pub(crate) fn resize_active(&mut self, larger: bool) {
        let factor = if larger { 1.25 } else { 0.8 };
        self.panes
            .resize(&Pane::View(self.focus.view.clone()), factor);
    }

    /// Undoes the last change of the view.
    pub fn undo(&mut self) {
        self.forget_click();
        let title = self.model.undo();
        self.arrive("Undone", title);
    }

    /// Redoes the last undone change of the view.
    pub fn redo(&mut self) {
        self.forget_click();
        let title = self.model.redo();
        self.arrive("Done again", title);
    }

    fn arrive(&mut self, verb: &str, title: Option<&'static str>) {
        self.status_message = title.map(|title| StatusMessage::info(format!("{verb}: {title}")));
    }

    pub(super) fn take_drops(&mut self, ui: &Ui) {
        let paths: Vec<PathBuf> = ui.input(|input| {
            let files = input.raw.dropped_files.iter();
            files.map(|file| file.path().to_owned()).collect()
        });
        self.open_images(paths);
    }

    /// Adds image files to the list of textures. The active surface, or the only one, shows the last of them.
    pub(crate) fn open_images(&mut self, paths: Vec<PathBuf>) {
        let Some(last) = paths.last().cloned() else {
            return;
        };
        for path in &paths {
            textures::open(&mut self.pictures.library, path.clone());
        }
        let surfaces = self.model.surfaces();
        let only = (surfaces.len() == 1).then(|| surfaces[0].clone());
        let surface = self.focus.surface.clone().or(only);
        if let Some(surface) = &surface {
            let file = last.file_name().unwrap_or(last.as_os_str());
            let sentence = format!("{} lies on {surface}", file.to_string_lossy());
            self.status_message = Some(StatusMessage::info(sentence));
        }
        self.model
            .change(Step::new("Open textures", ""), |choices| {
                for path in paths {
                    if !choices.textures.contains(&path) {
                        choices.textures.push(path);
                    }
                }
                if let Some(surface) = surface {
                    choices.looks.entry(surface).or_default().texture = TextureChoice::Image(last);
                }
            });
    }
}
