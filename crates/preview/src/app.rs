//! The window on the desktop: eframe on wgpu.

use std::cell::RefCell;
use std::rc::Rc;
use std::time::{Duration, Instant};

use eframe::{App, CreationContext, Frame, NativeOptions};
use egui::{Ui, ViewportCommand};

use crate::report::Report;
use crate::screen::Screen;
use crate::window::Window;
use crate::{Failure, Options, Source};

/// How often a lost GPU is replaced before the window gives up.
const REVIVALS: u32 = 3;

/// Opens the window and runs it until it is closed. Where its GPU is lost, it is opened again on a new one, as it was.
///
/// # Errors
/// See [`Failure`].
pub fn run(options: Options) -> Result<(), Failure> {
    open(options, None)
}

/// As [`run`], but the window's GPU is given up after some time, as though it were lost: for tests of what happens then.
///
/// # Errors
/// See [`Failure`].
pub fn run_and_lose_gpu(options: Options, after: Duration) -> Result<(), Failure> {
    open(options, Some(after))
}

fn open(options: Options, loses: Option<Duration>) -> Result<(), Failure> {
    // Read before anything is opened: a file that is not there needs no window.
    if let Source::File(path) = &options.source {
        crate::watch::read(path).map_err(|reason| Failure::Unreadable {
            path: path.clone(),
            reason,
        })?;
    }
    let options = Rc::new(options);
    // A window that has lost its screen waits here for the next.
    let waiting: Rc<RefCell<Option<Window>>> = Rc::default();
    for revival in 0..=REVIVALS {
        let (own, slot) = (Rc::clone(&options), Rc::clone(&waiting));
        let create = move |context: &CreationContext<'_>| -> Result<Box<dyn App>, Box<dyn std::error::Error + Send + Sync>> {
            let first = revival == 0;
            let mut preview = Preview::new(context, &own, slot, first)?;
            if let Some(after) = loses.filter(|_| first) {
                let waker = context.egui_ctx.clone();
                std::thread::spawn(move || {
                    std::thread::sleep(after);
                    waker.request_repaint();
                });
                preview.loses = Some(Instant::now() + after);
            }
            Ok(Box::new(preview))
        };
        eframe::run_native("geotrace", native(), Box::new(create)).map_err(failure)?;
        if waiting.borrow().is_none() {
            break;
        }
    }
    Ok(())
}

fn native() -> NativeOptions {
    NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Geotrace")
            .with_app_id("geotrace")
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([480.0, 320.0])
            .with_drag_and_drop(true),
        ..NativeOptions::default()
    }
}

fn failure(error: eframe::Error) -> Failure {
    match error {
        eframe::Error::AppCreation(error) => match error.downcast::<Failure>() {
            Ok(failure) => *failure,
            Err(error) => Failure::NoDisplay {
                reason: error.to_string(),
            },
        },
        eframe::Error::Wgpu(error) => Failure::NoGraphics {
            reason: error.to_string(),
        },
        other => Failure::NoDisplay {
            reason: other.to_string(),
        },
    }
}

/// The window and its title.
struct Preview {
    /// Until it is handed on.
    window: Option<Window>,
    title: String,
    waiting: Rc<RefCell<Option<Window>>>,
    /// When the GPU is to be given up, for a test.
    loses: Option<Instant>,
}

impl Preview {
    fn new(
        context: &CreationContext<'_>,
        options: &Options,
        waiting: Rc<RefCell<Option<Window>>>,
        first: bool,
    ) -> Result<Self, Failure> {
        let screen = context.wgpu_render_state.clone().map(Screen::new);
        let context = &context.egui_ctx;
        let mut window = match (waiting.take(), &options.source) {
            (Some(mut window), _) => {
                let sentence = "the GPU was lost; the window was opened again";
                window.said = Some((true, sentence.to_owned()));
                window
            }
            (None, Source::File(path)) => Window::of_file(context, path.clone(), true)?,
            (None, Source::Attached) => {
                Window::attached(context, std::io::stdin(), std::io::stdout())
            }
        };
        if first && let Some(path) = &options.report {
            let report = Report::create(path).map_err(|error| Failure::Unreadable {
                path: path.clone(),
                reason: error.to_string(),
            })?;
            window.report_to(report);
        }
        if let Some(screen) = screen {
            window.move_to(screen, options.backend, context);
        }
        Ok(Self {
            window: Some(window),
            title: String::new(),
            waiting,
            loses: None,
        })
    }
}

impl App for Preview {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut Frame) {
        let Some(window) = &mut self.window else {
            return;
        };
        let context = ui.ctx().clone();
        if let Some(screen) = &window.screen {
            if self.loses.is_some_and(|at| Instant::now() >= at) {
                screen.lose();
                self.loses = None;
            }
            if screen.is_lost() {
                // Nothing can be drawn here any more.
                window.screen = None;
                self.waiting.replace(self.window.take());
                context.send_viewport_cmd(ViewportCommand::Close);
                return;
            }
        }
        window.show(ui);
        let title = window.title();
        if title != self.title {
            self.title.clone_from(&title);
            context.send_viewport_cmd(ViewportCommand::Title(title));
        }
        if std::mem::take(&mut window.raise) {
            context.send_viewport_cmd(ViewportCommand::Minimized(false));
            context.send_viewport_cmd(ViewportCommand::Focus);
        }
        let asked = ui.input(|input| input.viewport().close_requested());
        if asked && !window.closing && window.has_unsaved() {
            context.send_viewport_cmd(ViewportCommand::CancelClose);
            window.dialogs.leaving = true;
            context.request_repaint();
        } else if window.closing && !asked {
            context.send_viewport_cmd(ViewportCommand::Close);
        }
    }

    fn on_exit(&mut self) {
        if let Some(window) = &self.window
            && !window.closing
        {
            window.say(protocol::Event::Closed);
        }
    }
}
