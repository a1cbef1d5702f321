//! The window: its state, and its work in each frame.
//!
//! ```text
//! event.rs   the events of all parts          input.rs  shortcuts, keys, animation
//! events.rs  handles them └──────────▶ model ◀──────────────┘
//! menu.rs, status.rs, panes.rs draw it; pictures.rs requests the pictures that have changed; server_events.rs reports
//! to the server; text.rs holds, compiles and saves the text; programs.rs switches to another program
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
mod programs;
mod records;
mod server_events;
mod text;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use egui::Ui;
use export::command_line::MOST_PLACES;
use ide::Languages;
use render::{Renderer, ViewId, Views};
use session::layout::Layout;
use session::model::Emphasis;
use session::{CameraPath, Model, StatusMessage};

use crate::Failure;
use crate::engine::compiler::Compiler;
use crate::engine::render_thread::RenderThread;
use crate::engine::textures::{ImageFiles, Library, turn_to};
use crate::io::link::Link;
use crate::io::persistence::{Drawn, DrawnFigure};
use crate::io::report::{Counters, Report};
use crate::ui::camera_input::held;
use crate::ui::dialogs::Dialogs;
use crate::ui::gpu_surface::GpuSurface;
use crate::ui::panes::Panes;
use active::Focus;
use display::Display;
use event::{WindowEvent, WindowEvents};
use input::InputState;
pub(crate) use pictures::Pictures;
pub(crate) use programs::{Next, UNTITLED};
use records::Records;
pub(crate) use text::{TextSource, WindowText};

/// The window: its session, its panes, and the threads that work for it.
pub struct Window {
    pub(crate) model: Model,
    /// The views that it offers.
    pub(crate) views: Views,
    /// The text.
    pub(crate) text: WindowText,
    pub(crate) pictures: Pictures,
    pub(crate) panes: Panes,
    pub(crate) focus: Focus,
    pub(crate) display: Display,
    pub(crate) dialogs: Dialogs,
    pub(crate) status_message: Option<StatusMessage>,
    pub(crate) input: InputState,
    pub(crate) records: Records,
    pub(crate) events: WindowEvents,
}

impl Window {
    /// Returns a window for an editor's text. Commands are read from `input`; events are written to `output`.
    ///
    /// # Errors
    /// [`Failure::NoThread`].
    pub fn attached(
        context: &egui::Context,
        languages: Languages,
        views: Views,
        input: impl std::io::Read + Send + 'static,
        output: impl std::io::Write + Send + 'static,
    ) -> Result<Self, Failure> {
        let events = WindowEvents::new(context.clone());
        let sender = &events.sender;
        let compiler = Compiler::start(sender.for_part(WindowEvent::Compiler))?;
        let (own, known) = (compiler.clone(), languages.clone());
        let compile = move |place: &Path, version, text, changes| {
            let language = Arc::clone(languages.for_path(place));
            own.compile(language, version, text, changes);
        };
        let commands = sender.for_part(WindowEvent::Link);
        let link = Link::start(commands, compile, input, output)?;
        let source = TextSource::Attached {
            link,
            uri: String::new(),
            path: None,
            disconnected: None,
        };
        Self::new(views, events, WindowText::new(source, compiler, known))
    }

    fn new(views: Views, events: WindowEvents, text: WindowText) -> Result<Self, Failure> {
        let first = ViewId::of_scene(views.first().name());
        let sender = &events.sender;
        Ok(Self {
            model: Model::default(),
            pictures: Pictures {
                render_thread: RenderThread::start(
                    sender.for_part(|event| WindowEvent::Render(Box::new(event))),
                    Renderer::software().with_views(views.clone()),
                )?,
                library: Library::new(ImageFiles::new(sender.for_part(WindowEvent::Texture))),
                of_views: BTreeMap::new(),
            },
            panes: Panes::new(first.clone(), text.is_own()),
            focus: Focus {
                view: first,
                surface: None,
                pointed: None,
                pointer: None,
            },
            display: Display::default(),
            dialogs: Dialogs::default(),
            status_message: None,
            input: InputState::default(),
            records: Records::default(),
            views,
            text,
            events,
        })
    }

    /// Writes counters after each frame.
    pub(crate) fn report_to(&mut self, report: Report) {
        self.records.report = Some(report);
    }

    /// Reports the positions of the controls of a screen, if there is a report.
    pub(crate) fn report_from(&self, context: &egui::Context) {
        if let Some(report) = &self.records.report {
            report.report_places(context);
        }
    }

    /// Moves the window to a screen, and draws on its GPU if that is wanted. All pictures are requested again.
    pub(crate) fn move_to(
        &mut self,
        screen: GpuSurface,
        backend: crate::Backend,
        context: &egui::Context,
    ) {
        self.events.sender.readdress(context.clone());
        self.display.clock.restart();
        self.forget_click();
        let (renderer, words) = screen.renderer(backend);
        self.set_frame_wait_budget(screen.frame_wait_budget());
        self.pictures
            .draw_by(renderer.with_views(self.views.clone()));
        self.display.replace(screen, words);
    }

    /// Returns whether the GPU that displays it is lost.
    pub(crate) fn has_lost_its_screen(&mut self) -> bool {
        let surface = self.display.surface.as_ref();
        surface.is_some_and(GpuSurface::is_lost)
    }

    /// Gives up the GPU that displays it, for a test.
    pub(crate) fn lose_screen(&self) {
        if let Some(surface) = &self.display.surface {
            surface.lose();
        }
    }

    /// Restores the saved state of a program, and starts to save it.
    fn remember(&mut self, program: PathBuf) {
        turn_to(&mut self.pictures.library, program.parent());
        if !self.remembers_views() {
            return;
        }
        let (known, mut trouble) = crate::io::persistence::load(&program);
        self.model.turn_to(known.choices.clone());
        self.choose_params();
        if let Some(layout) = known.layouts.get(self.kind()) {
            let layout = serde_json::from_value::<Layout>(layout.clone());
            if !layout.is_ok_and(|layout| self.panes.arrange(&layout)) {
                let sentence = "the saved layout of the panes is invalid and is not used";
                trouble.get_or_insert_with(|| sentence.to_owned());
            }
        }
        if let Some(sentence) = trouble {
            self.status_message = Some(StatusMessage::error(sentence));
        }
        self.keep_view_of(program, known);
    }

    /// Tells the compiler for which values of the params scripts are run.
    fn choose_params(&self) {
        let params = &self.model.choices.params;
        self.text.compiler.choose(params.clone());
    }

    /// Returns the kind of window, by which the layouts of panes are saved.
    fn kind(&self) -> &'static str {
        match self.text.is_own() {
            true => "alone",
            false => "attached",
        }
    }

    /// Returns the state that is shown, for tests and assistive tools.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Returns the lines that are drawn on surfaces besides those of the program.
    fn drawn(&self) -> Drawn {
        let shown = self.model.paths.iter().filter(|(_, path)| {
            let places = path.trail.points.len();
            self.model.choices.preferences.marks.trail && (2..=MOST_PLACES).contains(&places)
        });
        let places =
            |(name, path): (&String, &Arc<CameraPath>)| (name.clone(), path.trail.points.clone());
        Drawn {
            figure: self.dialogs.measuring.figure().map(DrawnFigure::from),
            paths: shown.map(places).collect(),
        }
    }

    /// Returns whether a click at the pointer would snap to a point, an end or a corner nearby.
    pub fn snaps(&self) -> bool {
        self.dialogs.measuring.snaps()
    }

    /// Returns the counters of this window.
    pub fn counters(&self) -> &Counters {
        &self.records.counters
    }

    /// Returns whether every view on the screen shows its newest picture and nothing is pending: no text to be
    /// compiled, no script to be run, no fault to be shown, no pick to be answered, no click that may become a double click.
    pub fn is_settled(&self) -> bool {
        !self.pictures.is_waiting()
            && !self.pictures.render_thread.is_asked()
            && self.model.read
            && self.records.counters.compiled > 0
            && self.clicked_until().is_none()
            && !self.model.faults.are_waiting()
            && self.model.emphasis == Emphasis::Off
            && !self.model.awaits_rerun()
            && !self.text.is_ahead_of(self.model.program.version)
    }

    /// Draws the window.
    pub fn show(&mut self, ui: &mut Ui) {
        let context = ui.ctx().clone();
        self.keep_appearance();
        let preferences = &self.model.choices.preferences;
        self.display.apply_style(&context, preferences);
        self.model.is_light = !ui.visuals().dark_mode;
        self.handle_events();
        let is_first_pass = context.current_pass_index() == 0;
        if is_first_pass {
            self.display.clock.waited = Duration::ZERO;
            self.await_first_text();
        }
        self.show_faults(ui);
        // A frame that is laid out again has already handled the input.
        if is_first_pass {
            if ui.input(|input| input.pointer.any_pressed()) {
                self.model.history.settle();
            }
            self.end_old_click(ui);
            self.hold_keys(ui);
            self.shortcuts(ui);
            self.take_drops(ui);
            self.animate(ui);
            crate::ui::navigation::advance(self, ui);
            self.keys(ui);
        }
        crate::ui::menu::bar(self, ui);
        crate::ui::status::banners(self, ui);
        crate::ui::number_field::report(&mut self.status_message, ui);
        crate::ui::status::line(self, ui);
        for view in self.pictures.of_views.values_mut() {
            view.on_screen = false;
        }
        crate::ui::panes::show(self, ui);
        crate::ui::dialogs::show(self, ui);
        if self.model.awaits_rerun() {
            self.choose_params();
        }
        self.request_pictures(ui);
        self.await_pictures(&context);
        if !context.will_discard() {
            self.after(ui);
        }
    }

    /// Shows the faults of the text after a pause in typing, and emphasises the object at the cursor for a while.
    fn show_faults(&mut self, ui: &Ui) {
        let now = ui.input(|input| input.time);
        let clock = &mut self.display.clock;
        if clock.advance_attention(&mut self.model, now) {
            self.text.painter.mark(self.model.faults.findings());
        }
    }

    /// Does the work after a frame: drops requests of panes that are not on the screen, saves the view, reports.
    fn after(&mut self, ui: &Ui) {
        if self.pictures.forget_hidden() {
            // A finished picture may have waited for one of these, which now does not wake the window.
            ui.ctx().request_repaint();
        }
        let arrows = self.has_arrows(ui);
        let rests = ui.input(|input| {
            let is_held = input.pointer.any_down() || held(input, &self.input.held, arrows).any();
            !is_held && input.time >= self.display.clock.gesture_until
        });
        if rests {
            self.model.history.settle();
        }
        let kind = self.kind();
        let drawn = self.drawn();
        if let Some(store) = &mut self.records.view_store {
            let layout = self.panes.layout();
            store.keep(&self.model.choices, drawn, kind, layout.as_ref());
        }
        self.wake_in_time(ui);
        self.report_shown();
        let is_settled = self.is_settled();
        self.records.note_frame(&mut self.model, is_settled);
    }
}
