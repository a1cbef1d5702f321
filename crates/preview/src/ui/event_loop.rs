//! The process's event loop, which shows one window after the other. It ends with a window as soon as the window
//! requests it, and a panic in a window does not propagate through it.
//!
//! eframe's own `run_native` does neither: it waits for the display to report that the window was destroyed, and a
//! panic leaves the loop in a state in which the next window may never be opened. A process has only one event loop.

use std::any::Any;
use std::backtrace::Backtrace;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind};
use std::rc::Rc;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use eframe::{App, CreationContext, EframeWinitApplication, NativeOptions, UserEvent};
use winit::application::ApplicationHandler;
use winit::event::{DeviceEvent, DeviceId, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::platform::run_on_demand::EventLoopExtRunOnDemand;
use winit::window::WindowId;

/// The connection to the display.
pub(crate) struct WindowLoop {
    event_loop: EventLoop<UserEvent>,
}

/// The way in which a window has ended.
pub(crate) enum WindowEnd {
    /// It was closed, or has ended by itself.
    Ended,
    /// It was never opened: the display refuses it, or no driver can draw it. eframe does not report the reason.
    Refused,
    /// By a panic of its thread, which has not been printed yet.
    Panicked {
        panic: Box<dyn Any + Send>,
        message: String,
    },
}

/// Ends a window, from inside.
#[derive(Clone, Default)]
pub(crate) struct EndSignal(Rc<Cell<bool>>);

impl EndSignal {
    /// Ends the event loop once its current event has been handled.
    pub(crate) fn send(&self) {
        self.0.set(true);
    }
}

impl WindowLoop {
    /// Connects to the display, once per process.
    ///
    /// # Errors
    /// The display's message, if there is none.
    pub(crate) fn connect() -> Result<Self, String> {
        let event_loop = EventLoop::with_user_event().build();
        let event_loop = event_loop.map_err(|error| error.to_string())?;
        Ok(Self { event_loop })
    }

    /// Shows a window until it ends.
    pub(crate) fn show(
        &mut self,
        options: NativeOptions,
        create: impl FnOnce(&CreationContext<'_>, EndSignal) -> Box<dyn App>,
    ) -> WindowEnd {
        let end = EndSignal::default();
        let opened = Cell::new(false);
        let create = |context: &CreationContext<'_>| {
            opened.set(true);
            Ok(create(context, end.clone()))
        };
        let app = eframe::create_native("geotrace", options, Box::new(create), &self.event_loop);
        let mut guard = Guard {
            app,
            end: end.clone(),
            panic: None,
        };
        let (ended, message) = without_printing(|| {
            let run = || self.event_loop.run_app_on_demand(&mut guard);
            let ended = catch_unwind(AssertUnwindSafe(run))?;
            let panic = guard.panic.take();
            // This releases its screen.
            let dropped = catch_unwind(AssertUnwindSafe(|| drop(guard)));
            panic.or(dropped.err()).map_or(Ok(ended), Err)
        });
        match ended {
            Err(panic) => WindowEnd::Panicked { panic, message },
            Ok(Ok(())) if opened.get() => WindowEnd::Ended,
            Ok(_) => WindowEnd::Refused,
        }
    }
}

/// eframe's application, each of whose calls may panic.
struct Guard<'a> {
    app: EframeWinitApplication<'a>,
    end: EndSignal,
    panic: Option<Box<dyn Any + Send>>,
}

impl<'a> Guard<'a> {
    fn call(
        &mut self,
        event_loop: &ActiveEventLoop,
        call: impl FnOnce(&mut EframeWinitApplication<'a>, &ActiveEventLoop),
    ) {
        if self.panic.is_none() {
            let called = catch_unwind(AssertUnwindSafe(|| call(&mut self.app, event_loop)));
            self.panic = called.err();
        }
        if self.panic.is_some() || self.end.0.get() {
            event_loop.exit();
        }
    }
}

impl ApplicationHandler<UserEvent> for Guard<'_> {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        self.call(event_loop, |app, event_loop| app.resumed(event_loop));
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, window: WindowId, event: WindowEvent) {
        self.call(event_loop, |app, event_loop| {
            app.window_event(event_loop, window, event);
        });
    }

    fn new_events(&mut self, event_loop: &ActiveEventLoop, cause: StartCause) {
        self.call(event_loop, |app, event_loop| {
            app.new_events(event_loop, cause)
        });
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, event: UserEvent) {
        self.call(event_loop, |app, event_loop| {
            app.user_event(event_loop, event)
        });
    }

    fn device_event(&mut self, event_loop: &ActiveEventLoop, device: DeviceId, event: DeviceEvent) {
        self.call(event_loop, |app, event_loop| {
            app.device_event(event_loop, device, event);
        });
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        self.call(event_loop, |app, event_loop| app.about_to_wait(event_loop));
    }

    fn suspended(&mut self, event_loop: &ActiveEventLoop) {
        self.call(event_loop, |app, event_loop| app.suspended(event_loop));
    }

    fn exiting(&mut self, event_loop: &ActiveEventLoop) {
        self.call(event_loop, |app, event_loop| app.exiting(event_loop));
    }

    fn memory_warning(&mut self, event_loop: &ActiveEventLoop) {
        self.call(event_loop, |app, event_loop| app.memory_warning(event_loop));
    }
}

/// Runs work, and returns the message of its last panic on this thread, which is not printed. Panics of other threads
/// are printed as usual.
fn without_printing<T>(work: impl FnOnce() -> T) -> (T, String) {
    let message = Arc::new(Mutex::new(String::new()));
    let before: Arc<PanicHook> = std::panic::take_hook().into();
    let (own, kept, others) = (thread::current().id(), message.clone(), before.clone());
    std::panic::set_hook(Box::new(move |panic| {
        if thread::current().id() == own {
            let trace = Backtrace::capture();
            *kept.lock().unwrap_or_else(PoisonError::into_inner) = format!("{panic}\n{trace}");
        } else {
            others(panic);
        }
    }));
    let result = work();
    std::panic::set_hook(Box::new(move |panic| before(panic)));
    let message = std::mem::take(&mut *message.lock().unwrap_or_else(PoisonError::into_inner));
    (result, message)
}

/// The function that prints a panic.
type PanicHook = dyn Fn(&PanicHookInfo<'_>) + Send + Sync;
