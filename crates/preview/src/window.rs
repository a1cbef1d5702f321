//! The window: what it knows, and what it does each time it draws itself.
//!
//! ```text
//! letters.rs  what the threads have told      shortcuts, keys, animation
//!        └────────────▶ model ◀────────────────────────┘
//! menu.rs, status.rs, panes.rs draw it; each pane asks the artist for the picture it has room for
//! ```

mod letters;

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

use egui::{Key, KeyboardShortcut, Modifiers, Ui};
use geodesic::ends::{Estimate, Work};
use protocol::Event;
use render::gpu::Canvas;
use render::live::Stage;
use scene::scene::Scene;

use crate::artist::{Artist, Painted};
use crate::compiler::Compiler;
use crate::highlighting;
use crate::link::Link;
use crate::mail::{Letter, Mail};
use crate::memory::Keeper;
use crate::menu::Dialogs;
use crate::model::{Model, SpaceCamera, Step, Theme};
use crate::motion;
use crate::orders::{Order, PaneKey};
use crate::panes::editor::Editor;
use crate::panes::layout::Layout;
use crate::panes::{Pane, Panes};
use crate::pointer::Trickle;
use crate::report::{Counters, Report};
use crate::screen::Screen;
use crate::textures::Library;
use crate::watch::Watch;

/// For how long after its last motion a view counts as moving: the pause between two turns of a wheel.
const MOTION_PAUSE: f64 = 0.18;
/// The time that a picture of a moving view should take.
const MOVING_PICTURE: f64 = 0.022;

/// Everything that the window is.
pub struct Window {
    pub(crate) model: Model,
    pub(crate) mail: Mail,
    letters: Receiver<Letter>,
    compiler: Compiler,
    pub(crate) artist: Artist,
    pub(crate) library: Library,
    pub(crate) origin: Origin,
    pub(crate) panes: Panes,
    /// The pane that keys move.
    pub(crate) active: PaneKey,
    /// The surface whose camera is shown in 3D.
    pub(crate) active_surface: Option<String>,
    pub(crate) pictures: BTreeMap<PaneKey, Picture>,
    sent: BTreeMap<PaneKey, Order>,
    /// Panes whose last order has not been answered.
    waiting: BTreeSet<PaneKey>,
    /// Panes that were on the screen when the window last drew itself.
    seen: BTreeSet<PaneKey>,
    moving_until: f64,
    /// The pixels that the 3D pane had room for when the window last drew itself.
    space_room: Option<[u32; 2]>,
    pub(crate) said: Option<(bool, String)>,
    pub(crate) painter: highlighting::Painter,
    pub(crate) dialogs: Dialogs,
    pub(crate) backend: String,
    pub(crate) screen: Option<Screen>,
    keeper: Option<Keeper>,
    shown: Option<(i32, bool, Instant)>,
    /// What the frame before this one took.
    pub(crate) painting: Duration,
    told_values: BTreeMap<String, Vec<f64>>,
    pub(crate) counters: Counters,
    report: Option<Report>,
    style: Option<(Theme, f32)>,
    /// The window is to come to the front.
    pub(crate) raise: bool,
    /// The window is to close.
    pub(crate) closing: bool,
}

/// Where the text comes from.
pub(crate) enum Origin {
    /// A file with a pane to edit it.
    File {
        editor: Box<Editor>,
        _watch: Option<Watch>,
    },
    /// An editor elsewhere.
    Attached {
        link: Link,
        uri: String,
        path: Option<PathBuf>,
        /// The server is gone; why, if it is known.
        gone: Option<String>,
    },
}

/// A picture that is on the screen.
pub(crate) struct Picture {
    /// Newly arrived, to be handed to the GPU.
    pub(crate) fresh: Option<Painted>,
    pub(crate) texture: Option<egui::TextureHandle>,
    /// The canvas that is shown, and as what: kept for as long as it is.
    pub(crate) canvas: Option<(Canvas, egui::TextureId)>,
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
    /// A window for a file's text, which it edits and, with `watched`, follows on disk.
    ///
    /// # Errors
    /// [`crate::Failure::Unreadable`].
    pub fn of_file(
        context: &egui::Context,
        path: PathBuf,
        watched: bool,
    ) -> Result<Self, crate::Failure> {
        let text = crate::watch::read(&path).map_err(|reason| crate::Failure::Unreadable {
            path: path.clone(),
            reason,
        })?;
        let (mail, letters) = Mail::new(context.clone());
        let mut said = None;
        let watch = if watched {
            match Watch::start(&path, text.clone(), mail.clone()) {
                Ok(watch) => Some(watch),
                Err(reason) => {
                    said = Some((true, format!("the file is not watched: {reason}")));
                    None
                }
            }
        } else {
            None
        };
        let origin = Origin::File {
            editor: Box::new(Editor::new(path.clone(), text.clone())),
            _watch: watch,
        };
        let compiler = Compiler::start(mail.clone());
        let mut window = Self::new(mail, letters, compiler, origin);
        window.remember(path);
        window.said = said.or(window.said);
        window.compile(text.into());
        Ok(window)
    }

    /// A window for an editor's text, which comes from `input`; events go to `output`.
    pub fn attached(
        context: &egui::Context,
        input: impl std::io::Read + Send + 'static,
        output: impl std::io::Write + Send + 'static,
    ) -> Self {
        let (mail, letters) = Mail::new(context.clone());
        let compiler = Compiler::start(mail.clone());
        let link = Link::start(mail.clone(), compiler.clone(), input, output);
        let origin = Origin::Attached {
            link,
            uri: String::new(),
            path: None,
            gone: None,
        };
        Self::new(mail, letters, compiler, origin)
    }

    fn new(mail: Mail, letters: Receiver<Letter>, compiler: Compiler, origin: Origin) -> Self {
        let edits = matches!(origin, Origin::File { .. });
        Self {
            model: Model::default(),
            compiler,
            artist: Artist::start(mail.clone(), Stage::software()),
            library: Library::new(mail.clone()),
            panes: Panes::new(edits),
            active: PaneKey::Space,
            active_surface: None,
            pictures: BTreeMap::new(),
            sent: BTreeMap::new(),
            waiting: BTreeSet::new(),
            seen: BTreeSet::new(),
            moving_until: 0.0,
            space_room: None,
            said: None,
            painter: highlighting::Painter::default(),
            dialogs: Dialogs::default(),
            backend: "software".to_owned(),
            screen: None,
            keeper: None,
            shown: None,
            painting: Duration::ZERO,
            told_values: BTreeMap::new(),
            counters: Counters::default(),
            report: None,
            style: None,
            raise: false,
            closing: false,
            mail,
            letters,
            origin,
        }
    }

    /// Writes counters after each drawing.
    pub(crate) fn report_to(&mut self, report: Report) {
        self.report = Some(report);
    }

    /// Tells where the controls of a screen are, if it reports at all.
    pub(crate) fn report_from(&self, context: &egui::Context) {
        if let Some(report) = &self.report {
            report.tell_places(context);
        }
    }

    /// Shows itself on a screen from now on, and draws on its GPU if that is wanted. All pictures are asked for anew.
    pub(crate) fn move_to(
        &mut self,
        screen: Screen,
        backend: crate::Backend,
        context: &egui::Context,
    ) {
        self.mail.readdress(context.clone());
        self.style = None;
        // A new context counts its time from the beginning.
        self.moving_until = 0.0;
        self.pictures.clear();
        self.sent.clear();
        self.waiting.clear();
        let (stage, words) = screen.stage(backend);
        self.backend = words;
        self.artist.take_stage(stage);
        self.screen = Some(screen);
    }

    /// Whether the GPU that it is shown by is gone.
    pub(crate) fn has_lost_its_screen(&mut self) -> bool {
        self.screen.as_ref().is_some_and(Screen::is_lost)
    }

    /// Takes over what was remembered of a program, and remembers on.
    fn remember(&mut self, program: PathBuf) {
        let (known, mut trouble) = crate::memory::load(&program);
        self.model.view = known.view.clone();
        if let Some(layout) = known.layouts.get(self.kind()) {
            let layout = serde_json::from_value::<Layout>(layout.clone());
            if !layout.is_ok_and(|layout| self.panes.arrange(&layout)) {
                let sentence =
                    "the places of the panes that were remembered make no sense, and are not used";
                trouble.get_or_insert_with(|| sentence.to_owned());
            }
        }
        if let Some(sentence) = trouble {
            self.said = Some((true, sentence));
        }
        self.keeper = Some(Keeper::start(program, known, self.mail.clone()));
    }

    /// The kind of window whose panes are remembered together.
    fn kind(&self) -> &'static str {
        match self.origin {
            Origin::File { .. } => "alone",
            Origin::Attached { .. } => "attached",
        }
    }

    /// The state that is shown, for tests and assistive tools.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// What has happened so far.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// Whether every view on the screen shows its newest picture, and no text waits to be compiled.
    pub fn is_settled(&self) -> bool {
        self.waiting.is_empty()
            && self.model.read
            && self.counters.compiled > 0
            && !self.is_behind()
    }

    fn is_behind(&self) -> bool {
        match &self.origin {
            Origin::File { editor, .. } => editor.version != self.model.version,
            Origin::Attached { .. } => false,
        }
    }

    /// The text of the window's own pane.
    pub fn text(&self) -> Option<&str> {
        match &self.origin {
            Origin::File { editor, .. } => Some(&editor.text),
            Origin::Attached { .. } => None,
        }
    }

    /// Puts another text into the window's own pane, as though it had been typed.
    pub fn set_text(&mut self, text: String) {
        if let Origin::File { editor, .. } = &mut self.origin {
            editor.text = text;
        }
        self.compile_own();
    }

    pub(crate) fn compile_own(&mut self) {
        if let Origin::File { editor, .. } = &self.origin {
            let text: Arc<str> = editor.text.as_str().into();
            self.compile(text);
        }
    }

    fn compile(&mut self, text: Arc<str>) {
        if let Origin::File { editor, .. } = &mut self.origin {
            editor.version += 1;
            self.compiler.compile(editor.version, text);
        }
    }

    /// Draws the window.
    pub fn show(&mut self, ui: &mut Ui) {
        let context = ui.ctx().clone();
        self.dress(&context);
        self.read_letters();
        self.shortcuts(ui);
        self.take_drops(ui);
        self.animate(ui);
        self.keys(ui);
        self.seen.clear();
        crate::menu::bar(self, ui);
        crate::status::banners(self, ui);
        crate::status::line(self, ui);
        crate::panes::show(self, ui);
        crate::menu::dialogs(self, ui);
        self.after(ui);
    }

    fn dress(&mut self, context: &egui::Context) {
        let preferences = &self.model.view.preferences;
        let style = (preferences.theme, preferences.scale);
        if self.style == Some(style) {
            return;
        }
        self.style = Some(style);
        // Each context takes it once.
        context.add_plugin(Trickle::default());
        context.set_theme(match style.0 {
            Theme::System => egui::ThemePreference::System,
            Theme::Light => egui::ThemePreference::Light,
            Theme::Dark => egui::ThemePreference::Dark,
        });
        context.set_zoom_factor(style.1);
        context.all_styles_mut(|style| {
            // A blinking cursor would draw the window again and again.
            style.visuals.text_cursor.blink = false;
            style.spacing.slider_width = 150.0;
            style.spacing.interact_size.y = 22.0;
        });
    }

    fn animate(&mut self, ui: &Ui) {
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
    fn keys(&mut self, ui: &Ui) {
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

    fn shortcuts(&mut self, ui: &Ui) {
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

    /// Writes the own text to its file.
    pub(crate) fn save_text(&mut self) {
        if let Origin::File { editor, .. } = &mut self.origin {
            self.said = Some(match editor.save() {
                Ok(()) => (false, "Saved".to_owned()),
                Err(sentence) => (true, sentence),
            });
        }
    }

    fn take_drops(&mut self, ui: &Ui) {
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

    /// The picture that a pane has room for: asks for it if it is not on its way.
    pub(crate) fn want(&mut self, pane: &PaneKey, pixels: [u32; 2], ui: &Ui) {
        self.seen.insert(pane.clone());
        let moving = ui.input(|input| input.time) < self.moving_until;
        let size = self.picture_size(pane, pixels, moving);
        if *pane == PaneKey::Space && self.space_room.replace(pixels) != Some(pixels) {
            // A camera that nobody has moved shows everything in a pane of another shape too.
            self.reframe();
        }
        let active = self.active_surface.clone();
        let model = &mut self.model;
        let library = &mut self.library;
        let order = crate::orders::order(model, library, pane, size, active.as_deref(), moving);
        let Some(order) = order else {
            return;
        };
        let walks = matches!(pane, PaneKey::Inside(name) if self.artist.has_motions(name));
        if !walks && self.sent.get(pane).is_some_and(|sent| sent.is_like(&order)) {
            return;
        }
        self.sent.insert(pane.clone(), order.clone());
        self.waiting.insert(pane.clone());
        self.artist.draw(pane.clone(), order);
    }

    /// Lets the artist put the 3D camera where everything is seen, unless the user has moved it.
    fn reframe(&mut self) {
        if self.model.view.space.is_some_and(|camera| !camera.moved) {
            self.model.adjust(|view| view.space = None);
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

    /// What is done when everything has been drawn.
    fn after(&mut self, ui: &Ui) {
        let unseen: Vec<PaneKey> = self
            .sent
            .keys()
            .filter(|pane| !self.seen.contains(*pane))
            .cloned()
            .collect();
        for pane in unseen {
            self.artist.forget(&pane);
            self.sent.remove(&pane);
            self.waiting.remove(&pane);
        }
        let idle = ui.input(|input| !input.pointer.any_down() && !motion::any_held(input));
        if idle {
            self.model.history.settle();
        }
        let kind = self.kind();
        if let Some(keeper) = &mut self.keeper {
            let layout = self.panes.layout();
            keeper.keep(&self.model.view, kind, layout.as_ref());
        }
        self.tell();
        self.counters.frames += 1;
        if self.report.is_some() {
            self.count();
        }
        if let Some(report) = &self.report {
            report.write(&self.counters);
        }
    }

    fn count(&mut self) {
        self.counters.settled = self.is_settled();
        let model = &mut self.model;
        self.counters.stale = model.is_stale();
        self.counters.status = model.status();
        if let (Some(scene), Some(settings)) = (model.scene.clone(), model.settings()) {
            let values = |param| settings.param(param).to_vec();
            let params = scene.params.iter();
            self.counters.params = params.map(|it| (it.name.clone(), values(it))).collect();
        }
        self.counters.eye = model.view.space.map(|camera| camera.eye);
        let inside = model.view.inside.iter();
        let walked = model.walked.iter();
        self.counters.trails = walked
            .map(|(name, way)| (name.clone(), way.trail.length))
            .collect();
        self.counters.inside = inside.map(|(name, it)| (name.clone(), it.at)).collect();
    }

    /// Tells the server what is on the screen now.
    fn tell(&mut self) {
        let on_screen = |pane: &PaneKey, version: i32| {
            !self.waiting.contains(pane)
                || self
                    .pictures
                    .get(pane)
                    .is_some_and(|it| it.version >= version)
        };
        if let Some((version, ok, arrived)) = self.shown
            && (!ok || self.seen.iter().all(|pane| on_screen(pane, version)))
        {
            self.shown = None;
            self.counters.version = version;
            self.say(Event::Shown {
                version,
                ok,
                milliseconds: arrived.elapsed().as_secs_f64() * 1e3,
                painting: self.painting.as_secs_f64() * 1e3,
            });
        }
        if matches!(self.origin, Origin::Attached { .. })
            && let (Some(scene), Some(settings)) = (self.model.scene.clone(), self.model.settings())
        {
            let params = scene.params.iter();
            let values: BTreeMap<String, Vec<f64>> = params
                .map(|param| (param.name.clone(), settings.param(param).to_vec()))
                .collect();
            if values != self.told_values {
                self.told_values.clone_from(&values);
                self.say(Event::Values {
                    version: self.model.version,
                    values,
                });
            }
        }
    }

    /// Tells the server something, if there is one.
    pub(crate) fn say(&self, event: Event) {
        if let Origin::Attached {
            link, gone: None, ..
        } = &self.origin
        {
            link.say(event);
        }
    }

    /// A param's value is to stand in the text.
    pub(crate) fn write_param(&mut self, name: &str) {
        let (Some(scene), Some(settings)) = (self.model.scene.clone(), self.model.settings())
        else {
            return;
        };
        let Some(param) = scene.params.iter().find(|param| param.name == name) else {
            return;
        };
        let value = settings.param(param).to_vec();
        match &mut self.origin {
            Origin::Attached { .. } => self.say(Event::Write {
                version: self.model.version,
                param: name.to_owned(),
                value,
            }),
            Origin::File { editor, .. } => match editor.write_param(name, &value) {
                Ok(true) => self.compile_own(),
                Ok(false) => {}
                Err(sentence) => self.said = Some((true, sentence)),
            },
        }
    }

    /// A place of the text is to be shown to the user.
    pub(crate) fn open_place(&mut self, span: syntax::span::Span) {
        match &mut self.origin {
            Origin::Attached { .. } => self.say(Event::Open {
                version: self.model.version,
                range: [span.start, span.end],
            }),
            Origin::File { editor, .. } => {
                editor.jump = Some(span);
                self.panes.bring_forward(&Pane::Program);
            }
        }
    }

    /// The folder that dialogs begin in.
    pub(crate) fn folder(&self) -> Option<PathBuf> {
        let path = match &self.origin {
            Origin::File { editor, .. } => Some(&editor.path),
            Origin::Attached { path, .. } => path.as_ref(),
        };
        let folder = path?.parent()?;
        std::path::absolute(folder).ok()
    }

    /// What the window is called.
    pub(crate) fn title(&self) -> String {
        match &self.origin {
            Origin::File { editor, .. } => {
                let mark = if editor.is_changed() { "*" } else { "" };
                let name = editor
                    .path
                    .file_name()
                    .unwrap_or_default()
                    .to_string_lossy();
                format!("{mark}{name} – Geotrace")
            }
            Origin::Attached { uri, .. } if uri.is_empty() => "Geotrace".to_owned(),
            Origin::Attached { uri, .. } => {
                let name = uri.rsplit('/').next().unwrap_or(uri);
                format!("{name} – Geotrace")
            }
        }
    }

    /// Whether closing the window would lose something that was written.
    pub(crate) fn has_unsaved(&self) -> bool {
        matches!(&self.origin, Origin::File { editor, .. } if editor.is_changed())
    }
}
