//! The thread that draws. In: requests, of which the latest of each pane wins. Out: pictures, which `worker.rs` draws.

mod worker;

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread::JoinHandle;
use std::time::Duration;

use render::counters::WorkCounters;
use render::rendered::RenderedImage;
use render::view::{Hit, Interrupt};
use render::{PictureRequest, Renderer, ViewId};
use session::SpaceCamera;
use session::snapping::Snapping;

use crate::channel::{EventSender, start_thread};
use crate::queue::LatestQueue;
use worker::Worker;

/// An event of the render thread.
#[derive(Debug)]
pub(crate) enum RenderEvent {
    /// A picture was drawn, or failed with a sentence.
    Drawn {
        pane: ViewId,
        /// The picture, with the time from the request to displayable pixels.
        picture: Result<Box<RenderedImage>, String>,
        /// The camera of a view in space, if its request specifies none.
        space_camera: Option<SpaceCamera>,
        request: Box<VersionedRequest>,
        counters: WorkCounters,
    },
    /// An object was found at a point of a picture, or none.
    Picked {
        request: Box<PictureRequest>,
        hit: Option<Hit>,
        /// The pixel that was snapped to.
        snapped: Option<[f64; 2]>,
        purpose: Purpose,
    },
    /// The camera that sees everything was found, or could not be.
    Framed(Option<SpaceCamera>),
}

/// A request with the version of its scene's text. The picture does not depend on the version.
#[derive(Clone, Debug)]
pub(crate) struct VersionedRequest {
    pub(crate) picture: PictureRequest,
    pub(crate) version: i32,
}

/// The purpose of a pick.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Purpose {
    /// To place the geodesic camera there; with the number of the click.
    Place(u64),
    /// To show its declaration.
    Open,
    /// To add the point to a figure that is measured.
    Measure(Snapping),
    /// To show the point under the pointer while it rests or moves.
    Pointer(Snapping),
}

impl Purpose {
    /// Returns the snapping of a point that is measured; `None` for another purpose.
    pub(crate) fn snapping(self) -> Option<Snapping> {
        match self {
            Self::Measure(snapping) | Self::Pointer(snapping) => Some(snapping),
            Self::Place(_) | Self::Open => None,
        }
    }
}

/// The maximum time for which a finished picture waits for another one, so that the window draws itself once for both.
const TOGETHER: Duration = Duration::from_millis(16);

/// Sends requests to the thread.
#[derive(Debug)]
pub(crate) struct RenderThread {
    queue: LatestQueue<JobKey, Job>,
    /// The number of requests that are not for pictures: each has its own key.
    questions: u64,
    /// The number of them that have been answered.
    answers: u64,
    thread: Option<JoinHandle<()>>,
    /// True once the thread has had a renderer on a GPU.
    has_used_gpu: bool,
}

/// The key of a job: a newer job replaces a waiting one with the same key.
#[derive(Clone, Debug, Eq, Ord, PartialEq, PartialOrd)]
enum JobKey {
    Renderer,
    Program,
    Question(u64),
    Pointer,
    Pane(ViewId),
}

/// The rank of a job: jobs of a lower rank are done first.
#[derive(Clone, Copy, Debug)]
enum Rank {
    Renderer,
    Pick,
    Frame,
    Draw,
    Pointer,
    Refine,
}

/// A job for the thread.
#[derive(Debug)]
enum Job {
    Move(Box<Renderer>),
    BeginProgram,
    Draw(Box<VersionedRequest>),
    Pick(Box<PictureRequest>, [f64; 2], Purpose),
    Frame(Box<PictureRequest>),
}

impl RenderThread {
    /// Starts the thread, which draws with a renderer. The pictures of a renderer on the window's own GPU stay there.
    ///
    /// # Errors
    /// The system's error.
    pub(crate) fn start(events: EventSender<RenderEvent>, renderer: Renderer) -> io::Result<Self> {
        let queue = LatestQueue::default();
        let own = queue.clone();
        let has_used_gpu = renderer.gpu().is_some();
        let thread = start_thread("render", move || work(&own, &events, renderer))?;
        Ok(Self {
            queue,
            questions: 0,
            answers: 0,
            thread: Some(thread),
            has_used_gpu,
        })
    }

    /// Switches to another renderer.
    pub(crate) fn set_renderer(&mut self, renderer: Renderer) {
        self.has_used_gpu |= renderer.gpu().is_some();
        let job = Job::Move(Box::new(renderer));
        self.queue.push(Rank::Renderer as u8, JobKey::Renderer, job);
    }

    /// Begins with another program, whose pictures have bounds of their own.
    pub(crate) fn begin_program(&self) {
        let rank = Rank::Renderer as u8;
        self.queue.push(rank, JobKey::Program, Job::BeginProgram);
    }

    /// Requests a picture, replacing a request of the same pane that has not been started.
    pub(crate) fn draw(&self, pane: ViewId, request: VersionedRequest) {
        let refines = request.picture.view.samples().is_some_and(|it| it > 1);
        let rank = if refines { Rank::Refine } else { Rank::Draw };
        let job = Job::Draw(Box::new(request));
        self.queue.push(rank as u8, JobKey::Pane(pane), job);
    }

    /// Drops the request of a pane if it has not been started.
    pub(crate) fn forget(&self, pane: &ViewId) {
        self.queue.remove(&JobKey::Pane(pane.clone()));
    }

    /// Requests the object at a pixel of the picture that a request describes.
    pub(crate) fn pick(&mut self, request: PictureRequest, at: [f64; 2], purpose: Purpose) {
        self.ask(Rank::Pick, Job::Pick(Box::new(request), at, purpose));
    }

    /// Requests the object under the pointer, replacing such a request that has not been started.
    pub(crate) fn point(&self, request: PictureRequest, at: [f64; 2], snapping: Snapping) {
        let job = Job::Pick(Box::new(request), at, Purpose::Pointer(snapping));
        self.queue.push(Rank::Pointer as u8, JobKey::Pointer, job);
    }

    /// Requests the camera that sees everything that a request shows.
    pub(crate) fn frame(&mut self, request: PictureRequest) {
        self.ask(Rank::Frame, Job::Frame(Box::new(request)));
    }

    /// Counts the answer to a pick (other than under the pointer) or to a request for a camera. Each has exactly one
    /// answer.
    pub(crate) fn note_answer(&mut self) {
        self.answers += 1;
    }

    /// Returns whether a pick or a request for a camera is unanswered.
    pub(crate) fn is_asked(&self) -> bool {
        self.answers < self.questions
    }

    fn ask(&mut self, rank: Rank, job: Job) {
        self.questions += 1;
        self.queue
            .push(rank as u8, JobKey::Question(self.questions), job);
    }
}

impl Drop for RenderThread {
    fn drop(&mut self) {
        self.queue.abandon();
        // The process may end next, which unloads the GPU's driver; a thread that still uses the driver would then
        // crash. A picture drawn by the processor needs no such care, and may take long: it is not waited for.
        if self.has_used_gpu
            && let Some(thread) = self.thread.take()
        {
            // A panic of the thread has already been reported.
            let _ = thread.join();
        }
    }
}

fn work(queue: &LatestQueue<JobKey, Job>, events: &EventSender<RenderEvent>, renderer: Renderer) {
    let waiting = queue.clone();
    // A picture that is being drawn is abandoned for waiting jobs, and when the window ends.
    let interrupt = Interrupt::new(move || waiting.is_closed() || waiting.next_key().is_some());
    let mut worker = Worker::new(renderer, interrupt);
    while let Some((key, job)) = queue.take() {
        // A panic must not end the window: it becomes a sentence.
        let answer = catch_unwind(AssertUnwindSafe(|| match (&key, &job) {
            (JobKey::Pane(pane), Job::Draw(request)) => worker.draw(pane, request),
            (_, Job::Pick(request, at, purpose)) => Some(worker.pick(request, *at, *purpose)),
            (_, Job::Frame(request)) => Some(RenderEvent::Framed(worker.frame(request))),
            _ => None,
        }));
        let event = match (answer, key, job) {
            (_, _, Job::Move(renderer)) => {
                worker.move_to(*renderer);
                continue;
            }
            (_, _, Job::BeginProgram) => {
                worker.begin_program();
                continue;
            }
            (Ok(Some(event)), ..) => event,
            // Abandoned for waiting jobs: it is drawn later, unless a newer one is requested.
            (Ok(None), key @ JobKey::Pane(_), job) => {
                queue.restore(Rank::Refine as u8, key, job);
                continue;
            }
            (Err(_), JobKey::Pane(pane), Job::Draw(request)) => {
                worker.leave_gpu();
                RenderEvent::Drawn {
                    pane,
                    picture: Err("internal error: the picture could not be drawn".to_owned()),
                    space_camera: None,
                    request,
                    counters: worker.counters(),
                }
            }
            (Err(_), _, Job::Pick(request, _, purpose)) => {
                worker.leave_gpu();
                RenderEvent::Picked {
                    request,
                    hit: None,
                    snapped: None,
                    purpose,
                }
            }
            (Err(_), _, Job::Frame(_)) => {
                worker.leave_gpu();
                RenderEvent::Framed(None)
            }
            // Only pictures have the key of a pane.
            (Ok(None) | Err(_), ..) => continue,
        };
        // The next picture wakes the window for this one too, if it is expected soon.
        let follows = match queue.next_key() {
            Some(JobKey::Pane(pane)) => worker.took(&pane).is_some_and(|took| took < TOGETHER),
            _ => false,
        };
        let sent = if follows {
            events.send_quietly(event)
        } else {
            events.send(event)
        };
        if !sent {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use render::gpu::Gpu;

    use super::*;

    #[test]
    fn a_thread_that_is_dropped_has_left_its_gpu() {
        let gpu = Arc::new(Gpu::open().expect("a GPU or software Vulkan"));
        let left = Arc::downgrade(&gpu);
        let (events, _received) = EventSender::new(egui::Context::default());
        let thread = RenderThread::start(events, Renderer::on_gpu(gpu)).expect("a thread");
        drop(thread);
        assert!(left.upgrade().is_none());
    }
}
