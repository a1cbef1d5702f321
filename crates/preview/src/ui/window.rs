//! The window: what it knows, and what it does each time it draws itself.
//!
//! ```text
//! event.rs   the events of all parts          input.rs  shortcuts, keys, animation
//! events.rs  takes them   └──────────▶ model ◀──────────────┘
//! menu.rs, status.rs, panes.rs draw it; pictures.rs requests the pictures that have changed; server_events.rs
//! reports to
//! the server; text.rs has the text of the window's own pane compiled, saved, rescued
//! ```

mod active;
mod clicks;
mod display;
mod event;
mod events;
mod frame_clock;
mod input;
mod pane_view;
mod pictures;
mod server_events;
mod text;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::Receiver;

use egui::Ui;
use ide::Languages;
use render::{Renderer, ViewId, Views};

use crate::channel::EventSender;
use crate::engine::compiler::Compiler;
use crate::engine::editor::Editor;
use crate::engine::render_thread::RenderThread;
use crate::engine::textures::Library;
use crate::io::file_dialogs::FileChoice;
use crate::io::link::{DisconnectReason, Link};
use crate::io::persistence::ViewStore;
use crate::io::report::{Counters, Report};
use crate::io::watch::Watch;
use crate::state::layout::Layout;
use crate::state::{Model, StatusMessage};
use crate::ui::camera_control::Held;
use crate::ui::dialogs::Dialogs;
use crate::ui::gpu_surface::GpuSurface;
use crate::ui::highlighting;
use crate::ui::panes::Panes;
use display::Display;
use event::WindowEvent;
use frame_clock::FrameClock;
use input::InputState;
use pane_view::PaneView;
use server_events::ServerReports;

/// Everything that the window is.
pub struct Window {
    pub(crate) model: Model,
    /// The views that it offers.
    pub(crate) views: Views,
    sender: EventSender<WindowEvent>,
    events: Receiver<WindowEvent>,
    compiler: Compiler,
    pub(crate) render_thread: RenderThread,
    pub(crate) library: Library,
    pub(crate) source: TextSource,
    pub(crate) panes: Panes,
    /// The pane that keys move.
    pub(crate) active: ViewId,
    /// The surface whose camera is shown in 3D.
    pub(crate) active_surface: Option<String>,
    /// The panes with pictures that have been on the screen.
    pub(crate) pane_views: BTreeMap<ViewId, PaneView>,
    pub(crate) clock: FrameClock,
    pub(crate) display: Display,
    pub(crate) status_message: Option<StatusMessage>,
    pub(crate) painter: highlighting::Painter,
    pub(crate) dialogs: Dialogs,
    view_store: Option<ViewStore>,
    reports: ServerReports,
    pub(crate) counters: Counters,
    report: Option<Report>,
    pub(crate) input: InputState,
    /// The window is to come to the front.
    pub(crate) raise: bool,
    /// The window is to close.
    pub(crate) closing: bool,
}

/// The source of the text.
pub(crate) enum TextSource {
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
        /// Nothing more comes from there.
        disconnected: Option<DisconnectReason>,
    },
}

impl Window {
    /// A window for a file's text, which it edits and, with `watched`, follows on disk.
    ///
    /// # Errors
    /// [`crate::Failure::Unreadable`].
    pub fn of_file(
        context: &egui::Context,
        languages: &Languages,
        views: Views,
        path: PathBuf,
        watched: bool,
    ) -> Result<Self, crate::Failure> {
        let text = crate::io::watch::read(&path).map_err(|reason| crate::Failure::Unreadable {
            path: path.clone(),
            reason: reason.to_string(),
        })?;
        let (sender, events) = EventSender::new(context.clone());
        let mut message = None;
        let watch = if watched {
            match Watch::start(&path, text.clone(), sender.for_part(WindowEvent::File)) {
                Ok(watch) => Some(watch),
                Err(reason) => {
                    let sentence = format!("the file is not watched: {reason}");
                    message = Some(StatusMessage::error(sentence));
                    None
                }
            }
        } else {
            None
        };
        let source = TextSource::File {
            editor: Box::new(Editor::new(
                Arc::clone(languages.for_path(&path)),
                path.clone(),
                text.clone(),
            )),
            _watch: watch,
        };
        let compiler = Compiler::start(sender.for_part(WindowEvent::Compiled));
        let mut window = Self::new(views, sender, events, compiler, source);
        window.remember(path);
        window.status_message = message.or(window.status_message);
        window.compile(text.into());
        Ok(window)
    }

    /// A window for an editor's text, which comes from `input`; events go to `output`.
    pub fn attached(
        context: &egui::Context,
        languages: Languages,
        views: Views,
        input: impl std::io::Read + Send + 'static,
        output: impl std::io::Write + Send + 'static,
    ) -> Self {
        let (sender, events) = EventSender::new(context.clone());
        let compiler = Compiler::start(sender.for_part(WindowEvent::Compiled));
        let own = compiler.clone();
        let compile = move |place: &Path, version, text, changes| {
            let language = Arc::clone(languages.for_path(place));
            own.compile(language, version, text, changes);
        };
        let commands = sender.for_part(WindowEvent::Link);
        let link = Link::start(commands, compile, input, output);
        let source = TextSource::Attached {
            link,
            uri: String::new(),
            path: None,
            disconnected: None,
        };
        Self::new(views, sender, events, compiler, source)
    }

    fn new(
        views: Views,
        sender: EventSender<WindowEvent>,
        events: Receiver<WindowEvent>,
        compiler: Compiler,
        source: TextSource,
    ) -> Self {
        let edits = matches!(source, TextSource::File { .. });
        let first = ViewId::of_scene(views.first().name());
        Self {
            model: Model::default(),
            compiler,
            render_thread: RenderThread::start(
                sender.for_part(|event| WindowEvent::Render(Box::new(event))),
                Renderer::software().with_views(views.clone()),
            ),
            library: Library::new(sender.for_part(WindowEvent::Texture)),
            panes: Panes::new(first.clone(), edits),
            active: first,
            views,
            active_surface: None,
            pane_views: BTreeMap::new(),
            clock: FrameClock::default(),
            display: Display::default(),
            status_message: None,
            painter: highlighting::Painter::default(),
            dialogs: Dialogs::default(),
            view_store: None,
            reports: ServerReports::default(),
            counters: Counters::default(),
            report: None,
            input: InputState::default(),
            raise: false,
            closing: false,
            sender,
            events,
            source,
        }
    }

    /// Returns a sender of sentences for the status line.
    pub(crate) fn status_sender(&self) -> EventSender<StatusMessage> {
        self.sender.for_part(WindowEvent::Status)
    }

    /// Returns a sender of what the user chooses in the desktop's dialogs.
    pub(crate) fn file_choices(&self) -> EventSender<FileChoice> {
        self.sender.for_part(WindowEvent::FileChoice)
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
        screen: GpuSurface,
        backend: crate::Backend,
        context: &egui::Context,
    ) {
        self.sender.readdress(context.clone());
        self.clock.restart();
        self.forget_click();
        for view in self.pane_views.values_mut() {
            view.forget_request();
            view.picture = None;
        }
        let (renderer, words) = screen.renderer(backend);
        self.set_frame_wait_budget(screen.frame_wait_budget());
        let renderer = renderer.with_views(self.views.clone());
        self.render_thread.set_renderer(renderer);
        self.display.replace(screen, words);
    }

    /// Returns whether the GPU that it is shown by is gone.
    pub(crate) fn has_lost_its_screen(&mut self) -> bool {
        let surface = self.display.surface.as_ref();
        surface.is_some_and(GpuSurface::is_lost)
    }

    /// Takes over what was remembered of a program, and remembers on.
    fn remember(&mut self, program: PathBuf) {
        let (known, mut trouble) = crate::io::persistence::load(&program);
        self.model.turn_to(known.view.clone());
        if let Some(layout) = known.layouts.get(self.kind()) {
            let layout = serde_json::from_value::<Layout>(layout.clone());
            if !layout.is_ok_and(|layout| self.panes.arrange(&layout)) {
                let sentence =
                    "the places of the panes that were remembered make no sense, and are not used";
                trouble.get_or_insert_with(|| sentence.to_owned());
            }
        }
        if let Some(sentence) = trouble {
            self.status_message = Some(StatusMessage::error(sentence));
        }
        self.view_store = Some(ViewStore::start(program, known, self.status_sender()));
    }

    /// The kind of window whose panes are remembered together.
    fn kind(&self) -> &'static str {
        match self.source {
            TextSource::File { .. } => "alone",
            TextSource::Attached { .. } => "attached",
        }
    }

    /// The state that is shown, for tests and assistive tools.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Returns the counters of this window.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// Returns whether every view on the screen shows its newest picture, no text waits to be compiled, and no click
    /// for another.
    pub fn is_settled(&self) -> bool {
        !self.is_waiting()
            && self.model.read
            && self.counters.compiled > 0
            && self.clicked_until().is_none()
            && !self.is_behind()
    }

    fn is_behind(&self) -> bool {
        match &self.source {
            TextSource::File { editor, .. } => editor.version != self.model.version,
            TextSource::Attached { .. } => false,
        }
    }

    /// Draws the window.
    pub fn show(&mut self, ui: &mut Ui) {
        let context = ui.ctx().clone();
        let preferences = &self.model.view.preferences;
        self.display.apply_style(&context, preferences);
        self.handle_events();
        // A frame that is laid out once more has taken the input already.
        if context.current_pass_index() == 0 {
            if ui.input(|input| input.pointer.any_pressed()) {
                self.model.history.settle();
            }
            self.end_old_click(ui);
            self.shortcuts(ui);
            self.take_drops(ui);
            self.animate(ui);
            self.keys(ui);
        }
        crate::ui::menu::bar(self, ui);
        crate::ui::status::banners(self, ui);
        crate::ui::status::line(self, ui);
        for view in self.pane_views.values_mut() {
            view.on_screen = false;
        }
        crate::ui::panes::show(self, ui);
        crate::ui::dialogs::show(self, ui);
        self.request_pictures(ui);
        self.await_pictures(&context);
        if !context.will_discard() {
            self.after(ui);
        }
    }

    /// Does the work behind a frame: drops requests of panes that are not on the screen, saves the view, reports.
    fn after(&mut self, ui: &Ui) {
        for (pane, view) in &mut self.pane_views {
            if view.on_screen || view.request.is_none() {
                continue;
            }
            self.render_thread.forget(pane);
            view.forget_request();
            // A finished picture may have waited for this one, which now does not wake the window.
            ui.ctx().request_repaint();
        }
        let arrows = self.has_arrows(ui);
        let rests = ui.input(|input| {
            let held = input.pointer.any_down() || Held::new(input, arrows).any();
            !held && input.time >= self.clock.gesture_until
        });
        if rests {
            self.model.history.settle();
        }
        let kind = self.kind();
        if let Some(store) = &mut self.view_store {
            let layout = self.panes.layout();
            store.keep(&self.model.view, kind, layout.as_ref());
        }
        self.wake_in_time(ui);
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
        let paths = model.paths.iter();
        self.counters.trails = paths
            .map(|(name, path)| (name.clone(), path.trail.length))
            .collect();
        self.counters.inside = inside.map(|(name, it)| (name.clone(), it.at)).collect();
    }
}
