//! The thread that draws: orders flow in, the latest of each pane wins; pictures flow out. How one is drawn is in
//! `easel.rs`.

mod easel;

use std::collections::{BTreeMap, VecDeque};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

use geodesic::ends::{Estimate, Work};
use render::gpu::Canvas;
use render::live::{Counters, Hit, Stage};
use scene::Scene;

use crate::mail::{Letter, Mail};
use crate::model::{InsideCamera, Model, SpaceCamera};
use crate::motion::{Motion, push};
use crate::orders::{Order, PaneKey};
use crate::walked::Walked;
use easel::Easel;

/// What the artist has finished.
#[derive(Debug)]
pub(crate) enum Answer {
    /// A picture, or the sentence that says why there is none.
    Drawn {
        pane: PaneKey,
        picture: Result<Box<Drawing>, String>,
        order: Box<Order>,
        counters: Counters,
    },
    /// What is under a place of the 3D view.
    Picked {
        scene: Arc<Scene>,
        hit: Option<Hit>,
        purpose: Purpose,
        /// Where a geodesic camera stands there, if it can.
        camera: Option<InsideCamera>,
    },
    /// Where everything is seen from.
    Framed(SpaceCamera),
}

/// A finished picture.
#[derive(Debug)]
pub(crate) struct Drawing {
    pub(crate) pixels: Painted,
    pub(crate) notes: Vec<String>,
    pub(crate) overlays: Vec<&'static str>,
    /// Of a geodesic view: its cost and how exact it is.
    pub(crate) inside: Option<(Work, Option<Estimate>)>,
    /// Where the 3D view is seen from.
    pub(crate) space_camera: Option<SpaceCamera>,
    /// The surface and the place of the geodesic camera that it is seen with or that it shows, and the count of placings
    /// that it has heeded.
    pub(crate) inside_camera: Option<(String, InsideCamera, u64)>,
    /// The way that the geodesic camera has gone, where it leaves a trail.
    pub(crate) walked: Option<Arc<Walked>>,
    pub(crate) took: Duration,
}

impl Drawing {
    /// Whether the geodesic camera in it is where the model has put it last.
    pub(crate) fn heeds(&self, model: &Model) -> bool {
        let camera = self.inside_camera.as_ref();
        camera.is_some_and(|(name, _, heeded)| *heeded == model.placed(name))
    }
}

/// Where a finished picture is.
#[derive(Debug)]
pub(crate) enum Painted {
    /// In memory.
    Image(image::RgbaImage),
    /// On the window's own GPU.
    Canvas(Canvas),
}

impl Painted {
    /// How many pixels it has.
    pub(crate) fn pixels(&self) -> usize {
        match self {
            Self::Image(image) => image.width() as usize * image.height() as usize,
            Self::Canvas(canvas) => canvas.size().iter().map(|side| *side as usize).product(),
        }
    }
}

/// Why someone asks what is under a place.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Purpose {
    /// The geodesic camera is to go there; the number of the click that says so.
    Place(u64),
    /// Its declaration is to be shown.
    Open,
}

/// The longest time for which a finished picture waits for another one, so that the window draws itself once for both.
const TOGETHER: Duration = Duration::from_millis(16);

/// Hands orders to the thread.
#[derive(Debug)]
pub(crate) struct Artist {
    desk: Arc<(Mutex<Desk>, Condvar)>,
}

#[derive(Debug, Default)]
struct Desk {
    /// By pane, each with the turn in which it came.
    orders: BTreeMap<PaneKey, (u64, Order)>,
    motions: BTreeMap<String, Vec<Motion>>,
    picks: VecDeque<(Order, [f64; 2], Purpose)>,
    framings: VecDeque<Order>,
    stage: Option<Stage>,
    turn: u64,
    closed: bool,
}

/// What there is to do.
enum Job {
    Move(Box<Stage>),
    Draw(PaneKey, Order, Vec<Motion>),
    Pick(Order, [f64; 2], Purpose),
    Frame(Order),
}

impl Artist {
    /// Starts the thread, which draws on a stage. If that is on the window's own GPU, pictures stay there.
    pub(crate) fn start(mail: Mail, stage: Stage) -> Self {
        let desk = Arc::new((Mutex::new(Desk::default()), Condvar::new()));
        let own = Arc::clone(&desk);
        std::thread::spawn(move || work(&own, &mail, stage));
        Self { desk }
    }

    /// Draws on another stage from now on.
    pub(crate) fn take_stage(&self, stage: Stage) {
        self.with(|desk| desk.stage = Some(stage));
    }

    /// Asks for a picture, in the place of any of this pane that has not been begun.
    pub(crate) fn draw(&self, pane: PaneKey, order: Order) {
        self.with(|desk| {
            desk.turn += 1;
            let turn = desk.turn;
            // What is overtaken keeps its turn, so that no pane waits for ever.
            let turn = desk.orders.remove(&pane).map_or(turn, |(turn, _)| turn);
            desk.orders.insert(pane, (turn, order));
        });
    }

    /// Moves a geodesic camera with its next picture.
    pub(crate) fn walk(&self, surface: &str, motion: Motion) {
        self.with(|desk| {
            let motions = desk.motions.entry(surface.to_owned()).or_default();
            push(motions, motion);
        });
    }

    /// Whether motions of a camera wait for a picture.
    pub(crate) fn has_motions(&self, surface: &str) -> bool {
        let (desk, _) = &*self.desk;
        let desk = desk.lock().unwrap_or_else(PoisonError::into_inner);
        desk.motions.get(surface).is_some_and(|it| !it.is_empty())
    }

    /// A geodesic camera stays where it is: it has been put elsewhere since it was asked to move.
    pub(crate) fn stay(&self, surface: &str) {
        self.with(|desk| {
            desk.motions.remove(surface);
        });
    }

    /// No picture of this pane is wanted any more. Motions without one would be made when it is wanted again.
    pub(crate) fn forget(&self, pane: &PaneKey) {
        self.with(|desk| {
            desk.orders.remove(pane);
            if let PaneKey::Inside(surface) = pane {
                desk.motions.remove(surface);
            }
        });
    }

    /// Asks what is under a pixel of the 3D view that an order describes.
    pub(crate) fn pick(&self, order: Order, at: [f64; 2], purpose: Purpose) {
        self.with(|desk| desk.picks.push_back((order, at, purpose)));
    }

    /// Asks where everything that an order shows is seen from.
    pub(crate) fn frame(&self, order: Order) {
        self.with(|desk| desk.framings.push_back(order));
    }

    fn with(&self, edit: impl FnOnce(&mut Desk)) {
        let (desk, bell) = &*self.desk;
        edit(&mut desk.lock().unwrap_or_else(PoisonError::into_inner));
        bell.notify_one();
    }
}

impl Drop for Artist {
    fn drop(&mut self) {
        self.with(|desk| desk.closed = true);
    }
}

impl Desk {
    fn next(&mut self) -> Option<Job> {
        if let Some(stage) = self.stage.take() {
            return Some(Job::Move(Box::new(stage)));
        }
        if let Some((order, at, purpose)) = self.picks.pop_front() {
            return Some(Job::Pick(order, at, purpose));
        }
        if let Some(order) = self.framings.pop_front() {
            return Some(Job::Frame(order));
        }
        let pane = self.next_pane()?.clone();
        let (_, order) = self.orders.remove(&pane)?;
        let motions = match &pane {
            PaneKey::Inside(name) => self.motions.remove(name).unwrap_or_default(),
            PaneKey::Space => Vec::new(),
        };
        Some(Job::Draw(pane, order, motions))
    }

    /// The pane whose order has waited longest.
    fn next_pane(&self) -> Option<&PaneKey> {
        let oldest = self.orders.iter().min_by_key(|(_, (turn, _))| *turn);
        Some(oldest?.0)
    }
}

fn work(desk: &(Mutex<Desk>, Condvar), mail: &Mail, stage: Stage) {
    let (desk, bell) = desk;
    let mut easel = Easel::new(stage);
    loop {
        let job = {
            let mut desk = desk.lock().unwrap_or_else(PoisonError::into_inner);
            loop {
                if desk.closed {
                    return;
                }
                if let Some(job) = desk.next() {
                    break job;
                }
                desk = bell.wait(desk).unwrap_or_else(PoisonError::into_inner);
            }
        };
        let job = match job {
            Job::Move(stage) => {
                easel.move_to(*stage);
                continue;
            }
            job => job,
        };
        // A fault of ours must not take the window with it: it becomes a sentence.
        let answer = match catch_unwind(AssertUnwindSafe(|| easel.answer(&job))) {
            Ok(Some(answer)) => answer,
            Ok(None) => continue,
            Err(_) => {
                easel.move_to(Stage::software());
                let Job::Draw(pane, order, _) = job else {
                    continue;
                };
                Answer::Drawn {
                    pane,
                    picture: Err("internal error: the picture could not be drawn".to_owned()),
                    order: Box::new(order),
                    counters: easel.counters(),
                }
            }
        };
        let wakes = {
            let desk = desk.lock().unwrap_or_else(PoisonError::into_inner);
            let next = desk.next_pane().and_then(|pane| easel.took(pane));
            next.is_none_or(|took| took >= TOGETHER)
        };
        let letter = Letter::Artist(Box::new(answer));
        let sent = if wakes {
            mail.send(letter)
        } else {
            mail.leave(letter)
        };
        if !sent {
            return;
        }
    }
}
