//! The thread that draws: requests flow in, the latest of each pane wins; pictures flow out. How one is drawn is in
//! `worker.rs`.

mod worker;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

use geodesic::ends::{Estimate, Work};
use render::Renderer;
use render::counters::Counters;
use render::gpu::Canvas;
use render::view::Hit;

use crate::channel::EventSender;
use crate::engine::request::Order;
use crate::queue::LatestQueue;
use crate::state::SpaceCamera;
use crate::state::pane::PaneKey;
use worker::Worker;

/// An event of the render thread.
#[derive(Debug)]
pub(crate) enum RenderEvent {
    /// A picture was drawn, or failed with a sentence.
    Drawn {
        pane: PaneKey,
        picture: Result<Box<Drawing>, String>,
        order: Box<Order>,
        counters: Counters,
    },
    /// An object was found under a place of the 3D view, or none.
    Picked {
        order: Box<Order>,
        hit: Option<Hit>,
        purpose: Purpose,
    },
    /// Where everything is seen from.
    Framed(SpaceCamera),
}

/// A finished picture.
#[derive(Debug)]
pub(crate) struct Drawing {
    pub(crate) pixels: Painted,
    pub(crate) notes: Vec<String>,
    /// Of a geodesic view: its cost and how exact it is.
    pub(crate) inside: Option<(Work, Option<Estimate>)>,
    /// The camera of the 3D view.
    pub(crate) space_camera: Option<SpaceCamera>,
    pub(crate) took: Duration,
}

/// The pixels of a finished picture.
#[derive(Debug)]
pub(crate) enum Painted {
    /// In memory.
    Image(image::RgbaImage),
    /// On the window's own GPU.
    Canvas(Canvas),
}

impl Painted {
    /// Returns the number of pixels.
    pub(crate) fn pixels(&self) -> usize {
        match self {
            Self::Image(image) => image.width() as usize * image.height() as usize,
            Self::Canvas(canvas) => canvas.size().iter().map(|side| *side as usize).product(),
        }
    }
}

/// The purpose of a pick.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Purpose {
    /// The geodesic camera is to go there; the number of the click that says so.
    Place(u64),
    /// Its declaration is to be shown.
    Open,
}

/// The longest time for which a finished picture waits for another one, so that the window draws itself once for both.
const TOGETHER: Duration = Duration::from_millis(16);

/// Hands requests to the thread.
#[derive(Debug)]
pub(crate) struct RenderThread {
    queue: LatestQueue<Key, Job>,
    /// The number of requests that are no pictures: each has a key of its own.
    asked: u64,
}

/// The key of a job: a newer job takes the place of a waiting one with the same key.
#[derive(Clone, Debug, Eq, Ord, PartialEq, PartialOrd)]
enum Key {
    Stage,
    Question(u64),
    Pane(PaneKey),
}

/// The rank of a job: those of a lower rank are done first.
#[derive(Clone, Copy, Debug)]
enum Rank {
    Stage,
    Pick,
    Frame,
    Draw,
}

/// A job for the thread.
#[derive(Debug)]
enum Job {
    Move(Box<Renderer>),
    Draw(Box<Order>),
    Pick(Box<Order>, [f64; 2], Purpose),
    Frame(Box<Order>),
}

impl RenderThread {
    /// Starts the thread, which draws on a stage. The pictures of a stage on the window's own GPU stay there.
    pub(crate) fn start(events: EventSender<RenderEvent>, stage: Renderer) -> Self {
        let queue = LatestQueue::default();
        let own = queue.clone();
        std::thread::spawn(move || work(&own, &events, stage));
        Self { queue, asked: 0 }
    }

    /// Draws on another stage from now on.
    pub(crate) fn set_stage(&self, stage: Renderer) {
        let job = Job::Move(Box::new(stage));
        self.queue.push(Rank::Stage as u8, Key::Stage, job);
    }

    /// Asks for a picture, in the place of one of the same pane that has not been begun.
    pub(crate) fn draw(&self, pane: PaneKey, order: Order) {
        let job = Job::Draw(Box::new(order));
        self.queue.push(Rank::Draw as u8, Key::Pane(pane), job);
    }

    /// Drops the request of a pane that has not been begun.
    pub(crate) fn forget(&self, pane: &PaneKey) {
        self.queue.remove(&Key::Pane(pane.clone()));
    }

    /// Asks what is under a pixel of the 3D view that a request describes.
    pub(crate) fn pick(&mut self, order: Order, at: [f64; 2], purpose: Purpose) {
        self.ask(Rank::Pick, Job::Pick(Box::new(order), at, purpose));
    }

    /// Asks for the camera that sees everything that a request shows.
    pub(crate) fn frame(&mut self, order: Order) {
        self.ask(Rank::Frame, Job::Frame(Box::new(order)));
    }

    fn ask(&mut self, rank: Rank, job: Job) {
        self.asked += 1;
        self.queue.push(rank as u8, Key::Question(self.asked), job);
    }
}

impl Drop for RenderThread {
    fn drop(&mut self) {
        self.queue.abandon();
    }
}

fn work(queue: &LatestQueue<Key, Job>, events: &EventSender<RenderEvent>, stage: Renderer) {
    let mut worker = Worker::new(stage);
    while let Some((key, job)) = queue.take() {
        // A panic must not take the window with it: it becomes a sentence.
        let answer = catch_unwind(AssertUnwindSafe(|| match (&key, &job) {
            (Key::Pane(pane), Job::Draw(order)) => Some(worker.draw(pane, order)),
            (_, Job::Pick(order, at, purpose)) => Some(worker.pick(order, *at, *purpose)),
            (_, Job::Frame(order)) => worker.frame(order),
            _ => None,
        }));
        let event = match (answer, key, job) {
            (_, _, Job::Move(stage)) => {
                worker.move_to(*stage);
                continue;
            }
            (Ok(Some(event)), ..) => event,
            (Ok(None), ..) => continue,
            (Err(_), Key::Pane(pane), Job::Draw(order)) => {
                worker.move_to(Renderer::software());
                RenderEvent::Drawn {
                    pane,
                    picture: Err("internal error: the picture could not be drawn".to_owned()),
                    order,
                    counters: worker.counters(),
                }
            }
            (Err(_), ..) => {
                worker.move_to(Renderer::software());
                continue;
            }
        };
        // The next picture wakes the window for this one too, if it is expected soon.
        let follows = match queue.next_key() {
            Some(Key::Pane(pane)) => worker.took(&pane).is_some_and(|took| took < TOGETHER),
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
