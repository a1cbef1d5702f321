//! The window on the desktop: eframe on wgpu.

use eframe::{App, CreationContext, Frame, NativeOptions};
use egui::{Ui, ViewportCommand};

use crate::report::Report;
use crate::window::Window;
use crate::{Failure, Options, Source};

/// Opens the window and runs it until it is closed.
///
/// # Errors
/// See [`Failure`].
pub fn run(options: Options) -> Result<(), Failure> {
    // Read before anything is opened: a file that is not there needs no window.
    if let Source::File(path) = &options.source {
        crate::watch::read(path).map_err(|reason| Failure::Unreadable {
            path: path.clone(),
            reason,
        })?;
    }
    let native = NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Geotrace")
            .with_app_id("geotrace")
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([480.0, 320.0])
            .with_drag_and_drop(true),
        ..NativeOptions::default()
    };
    let create = move |context: &CreationContext<'_>| -> Result<Box<dyn App>, Box<dyn std::error::Error + Send + Sync>> {
        Ok(Box::new(Preview::new(&context.egui_ctx, options)?))
    };
    eframe::run_native("geotrace", native, Box::new(create)).map_err(failure)
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
    window: Window,
    title: String,
}

impl Preview {
    fn new(context: &egui::Context, options: Options) -> Result<Self, Failure> {
        let mut window = match options.source {
            Source::File(path) => Window::of_file(context, path, true)?,
            Source::Attached => Window::attached(context, std::io::stdin(), std::io::stdout()),
        };
        if let Some(path) = &options.report {
            let report = Report::create(path).map_err(|error| Failure::Unreadable {
                path: path.clone(),
                reason: error.to_string(),
            })?;
            window.report_to(report);
        }
        Ok(Self {
            window,
            title: String::new(),
        })
    }
}

impl App for Preview {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut Frame) {
        self.window.show(ui);
        let context = ui.ctx();
        let title = self.window.title();
        if title != self.title {
            self.title.clone_from(&title);
            context.send_viewport_cmd(ViewportCommand::Title(title));
        }
        if std::mem::take(&mut self.window.raise) {
            context.send_viewport_cmd(ViewportCommand::Minimized(false));
            context.send_viewport_cmd(ViewportCommand::Focus);
        }
        let asked = ui.input(|input| input.viewport().close_requested());
        if asked && !self.window.closing && self.window.has_unsaved() {
            context.send_viewport_cmd(ViewportCommand::CancelClose);
            self.window.dialogs.leaving = true;
            context.request_repaint();
        } else if self.window.closing && !asked {
            context.send_viewport_cmd(ViewportCommand::Close);
        }
    }

    fn on_exit(&mut self) {
        if !self.window.closing {
            self.window.say(protocol::Event::Closed);
        }
    }
}
