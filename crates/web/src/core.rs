//! The core: it answers the page's messages, and determines what is drawn next.
//!
//! [`Core::step`] compiles the text, moves the cameras and draws the pictures, between messages. Of the texts and
//! motions that arrive during drawing, only the combined effect is shown.

mod describe;
mod motion;
mod pick;
mod pictures;
mod save;
mod settings;

pub use pictures::{DrawnPicture, StepOutcome};
pub use save::Saved;

use std::path::PathBuf;
use std::sync::Arc;

use ide::Languages;
use render::texture::Texture;
use render::{Renderer, ViewId, Views};
use serde_json::{Value, json};
use session::attention::Attention;
use session::clicks::Clicks;
use session::framing::Framing;
use session::questions::Measurer;
use session::reader::Read;
use session::snapping::SnapTargets;
use session::textures::{ImageState, Library};
use session::{Choices, Model};

use crate::editing::Editing;
use crate::images::GivenImages;
use crate::message::{Call, CoreEvent, Notice, SceneInfo};
use motion::Motions;
use pictures::PanePictures;

/// The state of the page's program. Points in time are in seconds, of any clock.
#[derive(Debug)]
pub struct Core {
    languages: Languages,
    views: Views,
    editing: Editing,
    model: Model,
    library: Library<GivenImages>,
    renderer: Renderer,
    framing: Framing,
    measurer: Measurer,
    /// The points to which clicks snap while something is measured.
    targets: Option<SnapTargets>,
    pictures: PanePictures,
    clicks: Clicks,
    motions: Motions,
    /// The time of the last call.
    now: f64,
    attention: Attention,
    /// True if the text has changed since it was compiled.
    is_unread: bool,
    sent: SentState,
    events: Vec<CoreEvent>,
}

/// The last state that was sent to the page.
#[derive(Debug, Default)]
struct SentState {
    /// True if the scene may differ from the one that was sent.
    is_stale: bool,
    scene: Option<SceneInfo>,
    settings: Choices,
}

impl Core {
    /// Returns a core with an empty program.
    pub fn new() -> Self {
        let languages = Languages::standard();
        let editing = Editing::open(&languages, "", String::new(), 0);
        Self {
            editing: editing.expect("an empty text is not too large"),
            languages,
            views: Views::standard(),
            model: Model::default(),
            library: Library::new(GivenImages::default()),
            renderer: Renderer::software(),
            framing: Framing::default(),
            measurer: Measurer::default(),
            targets: None,
            pictures: PanePictures::default(),
            clicks: Clicks::default(),
            motions: Motions::default(),
            now: 0.0,
            attention: Attention::default(),
            is_unread: false,
            sent: SentState::default(),
            events: Vec::new(),
        }
    }

    /// Returns the open text.
    pub fn editing(&self) -> &Editing {
        &self.editing
    }

    /// Returns the events since the last call.
    pub fn take_events(&mut self) -> Vec<CoreEvent> {
        std::mem::take(&mut self.events)
    }

    /// Answers a call.
    ///
    /// # Errors
    /// A sentence for the reader of the page.
    pub fn call(&mut self, call: Call, now: f64) -> Result<Value, String> {
        self.now = now;
        let editing = &self.editing;
        Ok(match call {
            Call::Open {
                name,
                text,
                version,
                settings,
            } => {
                self.open(&name, text, version, settings.unwrap_or_default())?;
                let language = self.editing.language();
                json!({ "language": language.name(), "lineComment": language.line_comment() })
            }
            Call::Hover { at } => editing.hover(at),
            Call::Complete { at } => editing.complete(at),
            Call::Describe { at, label } => editing.describe(at, &label),
            Call::Signature { at } => editing.signature(at),
            Call::Definition { at } => editing.definition(at),
            Call::Occurrences { at } => editing.occurrences(at),
            Call::PrepareRename { at } => editing.prepare_rename(at)?,
            Call::Rename { at, name } => editing.rename(at, &name)?,
            Call::Format { range } => editing.format(range),
            Call::Fixes(range) => editing.fixes(range),
            Call::FixAll {} => editing.fix_all(),
            Call::Declaration { name } => {
                self.read();
                json!(self.declaration(&name))
            }
            Call::WriteParam { param } => self.write_param(&param)?,
            Call::WriteCamera { name } => self.write_camera(&name)?,
            Call::WriteColour { object, rgb } => editing.write_colour(&object, rgb)?,
            Call::Settings {} => self.settings(),
            Call::Undo {} => self.travel(Model::undo),
            Call::Redo {} => self.travel(Model::redo),
            Call::Pick { view, at, measures } => {
                let found = self.pick(&ViewId::from(&*view), at, measures)?;
                json!(found.map(|found| found.pick))
            }
            Call::Click { view, at } => self.click(&ViewId::from(&*view), at)?,
            Call::DoubleClick { view, at } => self.double_click(&ViewId::from(&*view), at)?,
            Call::Measure { figure } => self.measure(figure)?,
            Call::MeasureWalk {} => self.measure_walk(),
            Call::WalkBack {} => self.walk_back()?,
        })
    }

    /// Handles a notice of the page.
    pub fn notice(&mut self, notice: Notice, now: f64) {
        self.now = now;
        match notice {
            Notice::Edit { version, changes } => match self.editing.edit(version, &changes) {
                Ok(()) => self.note_text(),
                Err(_) => self.resync(),
            },
            Notice::Text { version, text } => match self.editing.replace(text, version) {
                Ok(()) => self.note_text(),
                Err(_) => self.resync(),
            },
            Notice::Cursor { at } => {
                let at = at.map(|at| self.editing.source().byte(at));
                let name = at.and_then(|at| self.model.declared_at(at));
                let name = name.map(str::to_owned);
                self.model.highlight(name);
            }
            Notice::ReplaceSettings { settings } => self.replace_settings(settings),
            Notice::Change { patch, step } => self.change_settings(&patch, step),
            Notice::Light { is_light } => self.model.is_light = is_light,
            Notice::Panes { panes } => self.set_panes(panes),
            Notice::Shown { view } => self.pictures.note_shown(&ViewId::from(&*view)),
            Notice::Focus { view } => {
                let id = view.map(|view| ViewId::from(&*view));
                self.pictures.focus(id.and_then(|id| id.object));
            }
            Notice::Drag { view, grip, by } => self.drag(&ViewId::from(&*view), grip, by),
            Notice::Zoom { view, at, factor } => self.zoom(&ViewId::from(&*view), at, factor),
            Notice::Twist { view, angle } => self.twist(&ViewId::from(&*view), angle),
            Notice::Hold {
                view,
                keys,
                shift,
                alt,
            } => self.hold(ViewId::from(&*view), keys, [shift, alt]),
            Notice::Camera { view, to } => self.put_camera(&ViewId::from(&*view), to),
            Notice::Release {} => self.model.history.settle(),
        }
    }

    /// Adds an image under a name, replacing another one. Returns its size as a texture.
    ///
    /// # Errors
    /// The sentence about an image that cannot be read.
    pub fn texture(&mut self, name: &str, bytes: &[u8]) -> Result<Value, String> {
        let path = PathBuf::from(name);
        let texture = Texture::decode(bytes, &path, &self.library.source.budget)
            .map_err(|error| error.to_string())?;
        let size = texture.levels().first().map_or([0; 2], |level| level.size);
        let texture = Arc::new(texture);
        self.library.source.give(path.clone(), Arc::clone(&texture));
        self.library.put(path, ImageState::Ready(texture));
        self.library.look_again();
        self.sent.is_stale = true;
        Ok(json!({ "width": size[0], "height": size[1] }))
    }

    /// Opens a program. Only images and panes are kept from the previous one.
    fn open(
        &mut self,
        name: &str,
        text: String,
        version: i32,
        settings: Value,
    ) -> Result<(), String> {
        let settings_of = |name: &str| settings.get("preferences")?.get(name);
        let is_chosen = settings_of("traced").is_some();
        // What cannot be opened changes nothing.
        let view = settings::read(settings)?;
        self.editing = Editing::open(&self.languages, name, text, version)?;
        self.model.forget_program();
        self.model.turn_to(view);
        self.sent.settings.clone_from(&self.model.choices);
        self.sent.scene = None;
        // Other bounds, other samples: nothing of another program's pictures can be reused.
        self.renderer = Renderer::software().with_views(self.views.clone());
        self.pictures.forget();
        self.clicks = Clicks::default();
        self.motions = Motions::default();
        self.compile();
        let scene = self.model.scene.as_ref();
        let default = scene.map(|scene| self.views.default_of(scene));
        if !is_chosen && default.is_some_and(|view| view.instead_of().is_some()) {
            self.model
                .adjust(|choices| choices.preferences.traced = true);
        }
        Ok(())
    }

    fn resync(&mut self) {
        let version = self.editing.version();
        self.events.push(CoreEvent::Resync { version });
    }

    /// Notes that the text has changed.
    fn note_text(&mut self) {
        self.is_unread = true;
        self.attention.note_text(self.now);
        self.note_motion();
    }

    /// Compiles the text if it has changed, and makes the scene of the chosen params.
    fn read(&mut self) {
        if std::mem::take(&mut self.is_unread) && self.compile() {
            // A camera that the reader has not moved sees everything of a new scene too.
            self.model.reframe();
        }
        self.rerun();
    }

    /// Makes the scene of the chosen params, and sends the findings of the run.
    fn rerun(&mut self) {
        if !self.model.awaits_rerun() {
            return;
        }
        self.model.rerun();
        if let Some(diagnostics) = self.model.run_diagnostics() {
            self.events.push(CoreEvent::Findings {
                version: self.editing.version(),
                findings: self.editing.findings(diagnostics),
            });
        }
    }

    /// Compiles the text. Returns whether the scene has changed.
    fn compile(&mut self) -> bool {
        self.is_unread = false;
        let start = web_time::Instant::now();
        let program = self.editing.program();
        let read = Read {
            diagnostics: program.diagnostics(),
            declarations: program.declarations(),
            program: program.scene(),
            analysis: Some(program.snapshot()),
        };
        let version = self.editing.version();
        self.events.push(CoreEvent::Findings {
            version,
            findings: self.editing.findings(&read.diagnostics),
        });
        let mut compiled = read.compiled(version, self.editing.source().as_str().into());
        compiled.program.took = start.elapsed();
        let is_fresh = compiled.scene.is_some();
        self.model.take(compiled);
        self.library.look_again();
        self.sent.is_stale = true;
        is_fresh
    }

    /// Ends temporary states whose time has come. Returns the next time at which one ends.
    fn let_end(&mut self) -> Option<f64> {
        if self.attention.advance(&mut self.model, self.now) {
            self.sent.is_stale = true;
        }
        self.attention.next_end(&self.model)
    }

    /// Sends the page what it does not know: the scene at once, settings when nothing moves.
    fn send_changes(&mut self) {
        if std::mem::take(&mut self.sent.is_stale) {
            let scene = self.scene_info();
            if self.sent.scene.as_ref() != Some(&scene) {
                self.sent.scene = Some(scene.clone());
                self.events.push(CoreEvent::Scene(Box::new(scene)));
            }
        }
        if !self.is_moving() && self.sent.settings != self.model.choices {
            self.sent.settings.clone_from(&self.model.choices);
            let settings = self.settings();
            self.events.push(CoreEvent::Settings { settings });
        }
    }

    /// Undoes a step, or redoes it.
    fn travel(&mut self, step: impl FnOnce(&mut Model) -> Option<&'static str>) -> Value {
        let title = step(&mut self.model);
        self.sent.is_stale = true;
        self.note_motion();
        json!(title)
    }
}

impl Default for Core {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests;
