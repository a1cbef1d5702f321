//! The window on the desktop: eframe on wgpu.

use std::any::Any;
use std::cell::RefCell;
use std::panic::resume_unwind;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetupCreateNew};
use eframe::wgpu::Backends;
use eframe::{App, CreationContext, Frame, NativeOptions};
use egui::{Ui, ViewportCommand};
use render::gpu::Gpu;
use session::StatusMessage;

use crate::io::report::Report;
use crate::ui::event_loop::{EndSignal, WindowEnd, WindowLoop};
use crate::ui::gpu_surface::GpuSurface;
use crate::ui::window::{Next, Window};
use crate::{Ending, Failure, Faults, Options, Source};

/// The drivers that are tried first. OpenGL's takes a third of the time until the first frame to load, and serves
/// machines that have no other.
const FIRST_DRIVERS: Backends = Backends::PRIMARY;

/// The number of times that a lost GPU is replaced before the window gives up.
const REVIVALS: u32 = 3;

/// Opens the window and runs it until it is closed. If its GPU is lost, it is opened again on a new one, in the same
/// state.
///
/// # Errors
/// See [`Failure`].
pub fn run(options: Options) -> Result<(), Failure> {
    open(options, &Faults::default())
}

/// Like [`run`], but with faults of the window's GPU, for tests.
///
/// # Errors
/// See [`Failure`].
pub fn run_with_faults(options: Options, faults: &Faults) -> Result<(), Failure> {
    open(options, faults)
}

fn open(options: Options, faults: &Faults) -> Result<(), Failure> {
    // Read before anything is opened: a missing file needs no window.
    if let Source::File(path) = &options.source {
        crate::io::watch::read(path).map_err(|reason| Failure::Unreadable {
            path: path.clone(),
            reason: reason.to_string(),
        })?;
    }
    if options.source == Source::Attached {
        // Before the search for a display and a device, which may be slow: the server waits for the greeting.
        crate::io::link::greet(&mut std::io::stdout());
        crate::platform::lower_priority();
    }
    // Its threads read and compile the text while the display and its driver are opened.
    let window = first(&egui::Context::default(), &options)?;
    let options = Rc::new(options);
    let mut event_loop = WindowLoop::connect().map_err(|reason| Failure::NoDisplay {
        reason: in_words(&reason).to_owned(),
    })?;
    let mut drivers = FIRST_DRIVERS;
    on_screens(&Rc::new(RefCell::new(Some(window))), |screen, slot| {
        let mut faults = faults.clone();
        faults.loses_gpu = faults.loses_gpu.filter(|_| screen < faults.losses);
        let mut show = |drivers| {
            let size = slot
                .borrow()
                .as_ref()
                .and_then(|window| window.display.size);
            event_loop.show(native(size, drivers), |context, end| {
                let kept = Rc::clone(slot);
                Box::new(Preview::new(
                    context,
                    &options,
                    kept,
                    screen > 0,
                    &faults,
                    end,
                ))
            })
        };
        let mut shown = show(drivers);
        if matches!(shown, WindowEnd::Refused) && drivers == FIRST_DRIVERS {
            drivers = Backends::PRIMARY | Backends::GL;
            shown = show(drivers);
        }
        let mut window = slot.borrow_mut();
        let lost = window.as_mut().is_some_and(Window::has_lost_its_screen);
        match shown {
            WindowEnd::Refused => Ended::Refused(refusal()),
            // The code that draws the controls may notice the loss first, and panic: the window continues.
            WindowEnd::Ended | WindowEnd::Panicked { .. } if lost => Ended::Lost,
            WindowEnd::Ended => Ended::Closed,
            WindowEnd::Panicked { panic, message } => {
                eprintln!("{message}");
                Ended::Broken(panic)
            }
        }
    })
}

/// The way in which a window on a screen has ended.
enum Ended {
    /// Closed by its user or its server.
    Closed,
    /// Its GPU is lost.
    Lost,
    /// The system has refused to open it.
    Refused(Failure),
    /// By a bug in this program.
    Broken(Box<dyn Any + Send>),
}

/// Runs the window until it is closed; when the GPU is lost, opens it again on a new one. If it ends otherwise, unsaved
/// text is rescued.
fn on_screens(slot: &Slot, mut show: impl FnMut(u32, &Slot) -> Ended) -> Result<(), Failure> {
    let rescued = || {
        let window = slot.borrow();
        window.as_ref().and_then(|window| window.text.rescue())
    };
    for screen in 0..=REVIVALS {
        match show(screen, slot) {
            Ended::Closed => return Ok(()),
            Ended::Lost => {}
            Ended::Refused(failure) => return Err(failure.and(rescued())),
            Ended::Broken(panic) => {
                if let Some(sentence) = rescued() {
                    eprintln!("{sentence}");
                }
                resume_unwind(panic)
            }
        }
    }
    let lost = Failure::NoGraphics {
        reason: format!("the GPU was lost {} times", REVIVALS + 1),
    };
    Err(lost.and(rescued()))
}

/// The slot of the window, which outlives its screens.
type Slot = Rc<RefCell<Option<Window>>>;

/// Returns the options of the desktop's window; a reopened one keeps its size.
fn native(size: Option<egui::Vec2>, drivers: Backends) -> NativeOptions {
    let mut setup = WgpuSetupCreateNew::without_display_handle();
    setup.instance_descriptor.backends = Backends::from_env().unwrap_or(drivers);
    NativeOptions {
        wgpu_options: WgpuConfiguration {
            wgpu_setup: setup.into(),
            ..WgpuConfiguration::default()
        },
        viewport: egui::ViewportBuilder::default()
            .with_title("Geotrace")
            .with_app_id("geotrace")
            .with_inner_size(size.unwrap_or(egui::vec2(1280.0, 800.0)))
            .with_min_inner_size([480.0, 320.0])
            .with_drag_and_drop(true),
        // Pictures are shown exactly as they were drawn.
        dithering: false,
        ..NativeOptions::default()
    }
}

/// Returns the reason why an existing display shows no window.
fn refusal() -> Failure {
    let reason = match Gpu::shared() {
        Err(error) => error.to_string(),
        Ok(gpu) => format!(
            "the display rejects it, or {} cannot draw on it",
            gpu.name()
        ),
    };
    Failure::NoGraphics { reason }
}

/// Returns the system's message, without the source location that some libraries put before it.
fn in_words(reason: &str) -> &str {
    let behind_place = reason
        .rsplit_once(".rs:")
        .and_then(|(_, rest)| rest.split_once(": "));
    behind_place
        .map_or(reason, |(_, words)| words)
        .trim_end_matches('.')
}

/// The window on a screen.
struct Preview {
    slot: Slot,
    title: String,
    /// Set when the GPU is to be given up, for a test.
    loses: Arc<AtomicBool>,
    /// True if it is given up after the frame's layout, not before it.
    loses_in_frame: bool,
    ending: Ending,
    end: EndSignal,
}

impl Preview {
    fn new(
        creation: &CreationContext<'_>,
        options: &Options,
        slot: Slot,
        was_lost: bool,
        faults: &Faults,
        end: EndSignal,
    ) -> Self {
        let context = &creation.egui_ctx;
        if let Some(window) = &mut *slot.borrow_mut() {
            if was_lost {
                let sentence = "the GPU was lost; the window was opened again";
                window.status_message = Some(StatusMessage::error(sentence.to_owned()));
            }
            window.report_from(context);
            if let Some(state) = creation.wgpu_render_state.clone() {
                let screen = GpuSurface::new(state, context);
                if faults.refuses_samples {
                    screen.refuse_samples();
                }
                window.move_to(screen, options.backend, context);
            }
        }
        options.ending.opened(context);
        let loses = Arc::new(AtomicBool::new(false));
        if let Some(sign) = faults.loses_gpu.clone() {
            let (waker, loses) = (context.clone(), Arc::clone(&loses));
            std::thread::spawn(move || {
                while !sign.exists() {
                    std::thread::sleep(Duration::from_millis(20));
                }
                loses.store(true, Ordering::Relaxed);
                waker.request_repaint();
            });
        }
        Self {
            slot,
            title: String::new(),
            loses,
            loses_in_frame: faults.loses_in_frame,
            ending: options.ending.clone(),
            end,
        }
    }
}

/// Returns the window before it is on a screen.
fn first(context: &egui::Context, options: &Options) -> Result<Window, Failure> {
    let mut window = match &options.source {
        Source::File(path) => {
            let views = options.views.clone();
            Window::of_file(context, &options.languages, views, path.clone(), true)?
        }
        Source::Welcome => Window::welcome(context, &options.languages, options.views.clone())?,
        Source::Attached => Window::attached(
            context,
            options.languages.clone(),
            options.views.clone(),
            std::io::stdin(),
            std::io::stdout(),
        )?,
    };
    if let Some(folder) = crate::platform::state_folder() {
        window.remember_paths_in(&folder);
    }
    if let Some(path) = &options.report {
        let report = Report::create(path).map_err(|error| Failure::Unreadable {
            path: path.clone(),
            reason: error.to_string(),
        })?;
        window.report_to(report);
    }
    Ok(window)
}

impl App for Preview {
    fn ui(&mut self, ui: &mut Ui, frame: &mut Frame) {
        let mut slot = self.slot.borrow_mut();
        let Some(window) = &mut *slot else {
            return;
        };
        let context = ui.ctx().clone();
        let loses = self.loses.swap(false, Ordering::Relaxed);
        if loses && !self.loses_in_frame {
            window.lose_screen();
        }
        if window.has_lost_its_screen() {
            // Nothing can be drawn on this screen any more.
            self.end.send();
            return;
        }
        let painting = f64::from(frame.info().cpu_usage.unwrap_or_default());
        let painting = Duration::try_from_secs_f64(painting).unwrap_or_default();
        let clock = &mut window.display.clock;
        clock.painting = painting.saturating_sub(clock.waited);
        let room = ui.input(|input| input.viewport().inner_rect);
        window.display.size = room.map(|room| room.size() * context.zoom_factor());
        window.show(ui);
        if loses {
            window.lose_screen();
        }
        let title = window.title();
        if title != self.title {
            self.title.clone_from(&title);
            context.send_viewport_cmd(ViewportCommand::Title(title));
        }
        if std::mem::take(&mut window.display.raise) {
            context.send_viewport_cmd(ViewportCommand::Minimized(false));
            context.send_viewport_cmd(ViewportCommand::Focus);
        }
        let asked = ui.input(|input| input.viewport().close_requested());
        let must_end = window.display.closing || self.ending.is_asked();
        if asked && !must_end && window.text.has_unsaved() {
            context.send_viewport_cmd(ViewportCommand::CancelClose);
            window.dialogs.leaving = Some(Next::Close);
            context.request_repaint();
        } else if must_end && !asked {
            context.send_viewport_cmd(ViewportCommand::Close);
        }
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        // The background of the panes: no rectangle is painted for it.
        visuals.panel_fill.to_normalized_gamma_f32()
    }

    fn on_exit(&mut self) {
        self.end.send();
        let mut slot = self.slot.borrow_mut();
        if let Some(window) = &mut *slot
            && !window.display.closing
            && !window.has_lost_its_screen()
        {
            // A system that ends all programs, a signal, and a Mac's own menu do not ask first.
            if let Some(sentence) = window.text.rescue() {
                eprintln!("{sentence}");
            }
            window.text.send(protocol::Event::Closed);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{Ended, REVIVALS, Slot, in_words, on_screens};
    use crate::{Failure, Window};

    const MINE: &str = "point mine = (1, 2, 3);\n";

    /// A window on a file, with a text that is not saved.
    fn written(folder: &Path) -> Slot {
        let path = folder.join("a.gtr");
        std::fs::write(&path, "point p = (0, 0, 0);\n").expect("written");
        let window = Window::of_file(
            &egui::Context::default(),
            &ide::Languages::standard(),
            render::Views::standard(),
            path,
            false,
        );
        let mut window = window.expect("the file is there");
        window.set_text(MINE.to_owned());
        let slot = Slot::default();
        slot.replace(Some(window));
        slot
    }

    fn text(folder: &Path, name: &str) -> String {
        std::fs::read_to_string(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    #[test]
    fn a_gpu_that_is_lost_again_and_again_ends_the_window_but_not_its_text() {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path();
        let slot = written(folder);
        // Another one's has its name already.
        std::fs::write(folder.join("a.unsaved.gtr"), "theirs").expect("written");
        let mut screens = Vec::new();
        let ended = on_screens(&slot, |screen, _| {
            screens.push(screen);
            Ended::Lost
        });
        assert_eq!(screens, (0..=REVIVALS).collect::<Vec<_>>());
        let Err(Failure::NoGraphics { reason }) = ended else {
            panic!("{ended:?}");
        };
        let place = folder.join("a.unsaved-2.gtr");
        let wanted = format!(
            "the GPU was lost 4 times; the unsaved text is in `{}`",
            place.display()
        );
        assert_eq!(reason, wanted);
        assert_eq!(text(folder, "a.unsaved-2.gtr"), MINE);
        assert_eq!(text(folder, "a.unsaved.gtr"), "theirs");
        assert_eq!(text(folder, "a.gtr"), "point p = (0, 0, 0);\n");
    }

    #[test]
    fn a_display_that_refuses_the_window_anew_does_not_lose_its_text() {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path();
        let ended = on_screens(&written(folder), |screen, _| match screen {
            0 => Ended::Lost,
            _ => Ended::Refused(Failure::NoDisplay {
                reason: "no such display".to_owned(),
            }),
        });
        let message = ended.expect_err("it is refused").to_string();
        for part in ["no such display", "the unsaved text is in `"] {
            assert!(message.contains(part), "{message}");
        }
        assert_eq!(text(folder, "a.unsaved.gtr"), MINE);
    }

    #[test]
    fn a_fault_of_ours_does_not_lose_the_text() {
        let folder = tempfile::tempdir().expect("a folder");
        let slot = written(folder.path());
        let show = |_, _: &Slot| Ended::Broken(Box::new("a fault"));
        let run = std::panic::AssertUnwindSafe(|| on_screens(&slot, show));
        assert!(std::panic::catch_unwind(run).is_err(), "it goes on");
        assert_eq!(text(folder.path(), "a.unsaved.gtr"), MINE);
    }

    #[test]
    fn a_window_that_is_closed_writes_nothing() {
        let folder = tempfile::tempdir().expect("a folder");
        let ended = on_screens(&written(folder.path()), |_, _| Ended::Closed);
        assert_eq!(ended, Ok(()));
        assert!(!folder.path().join("a.unsaved.gtr").exists());
        let saved = written(folder.path());
        let text = "point p = (0, 0, 0);\n".to_owned();
        saved
            .borrow_mut()
            .as_mut()
            .expect("a window")
            .set_text(text);
        assert!(on_screens(&saved, |_, _| Ended::Lost).is_err());
        assert!(
            !folder.path().join("a.unsaved.gtr").exists(),
            "all is saved"
        );
    }

    #[test]
    fn what_the_system_says_is_reported_without_a_place_in_a_source() {
        let message = "os error at /a/winit-0.30.13/src/linux/mod.rs:788: Failed to connect.";
        assert_eq!(in_words(message), "Failed to connect");
        assert_eq!(in_words("no display: none"), "no display: none");
    }
}
