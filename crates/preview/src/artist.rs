//! The thread that draws: orders flow in, the latest of each pane wins; pictures flow out.

use std::collections::{BTreeMap, VecDeque};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

use geodesic::ends::{Estimate, Work};
use glam::DVec3;
use render::bounds::Bounds;
use render::camera::Camera;
use render::geodesic_view::Inside;
use render::gpu::Canvas;
use render::live::{Counters, Hit, Pixels, Shot, Stage};
use render::texture::Texture;
use render::{RenderError, Request, View};
use scene::scene::{ObjectId, Scene};
use scene::values::Settings;

use crate::mail::{Letter, Mail};
use crate::model::{InsideCamera, SpaceCamera};
use crate::motion::{Motion, push};
use crate::orders::{Look, Order, PaneKey, Standing};
use crate::pilot::{Flight, Pilot};
use crate::walked::Walked;

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

/// Where a finished picture is.
#[derive(Debug)]
pub(crate) enum Painted {
    /// In memory.
    Image(egui::ColorImage),
    /// On the window's own GPU.
    Canvas(Canvas),
}

impl Painted {
    /// How many pixels it has.
    pub(crate) fn pixels(&self) -> usize {
        match self {
            Self::Image(image) => image.size[0] * image.size[1],
            Self::Canvas(canvas) => canvas.size().iter().map(|side| *side as usize).product(),
        }
    }
}

/// Why someone asks what is under a place.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Purpose {
    /// The geodesic camera is to go there.
    Place,
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

    /// No picture of this pane is wanted any more.
    pub(crate) fn forget(&self, pane: &PaneKey) {
        self.with(|desk| {
            desk.orders.remove(pane);
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
    let mut easel = Easel {
        shares_gpu: stage.gpu().is_some(),
        stage,
        pilots: BTreeMap::new(),
        home: None,
        curvatures: None,
        took: BTreeMap::new(),
    };
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
                easel.shares_gpu = stage.gpu().is_some();
                easel.stage = *stage;
                continue;
            }
            job => job,
        };
        // A fault of ours must not take the window with it: it becomes a sentence.
        let answer = match catch_unwind(AssertUnwindSafe(|| easel.answer(&job))) {
            Ok(Some(answer)) => answer,
            Ok(None) => continue,
            Err(_) => {
                easel.stage = Stage::software();
                let Job::Draw(pane, order, _) = job else {
                    continue;
                };
                Answer::Drawn {
                    pane,
                    picture: Err("internal error: the picture could not be drawn".to_owned()),
                    order: Box::new(order),
                    counters: easel.stage.counters(),
                }
            }
        };
        let wakes = {
            let desk = desk.lock().unwrap_or_else(PoisonError::into_inner);
            let next = desk.next_pane().and_then(|pane| easel.took.get(pane));
            next.is_none_or(|took| *took >= TOGETHER)
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

/// What is kept from one picture to the next.
struct Easel {
    stage: Stage,
    /// Whether the stage's GPU is the window's.
    shares_gpu: bool,
    pilots: BTreeMap<String, Pilot>,
    /// Where everything of a scene is seen from, at the settings and size where it was asked for.
    home: Option<Home>,
    curvatures: Option<Curvatures>,
    /// How long the last picture of each pane took.
    took: BTreeMap<PaneKey, Duration>,
}

/// A scene with its params, the size of its picture, what is hidden, and the place from which all of the rest is seen.
type Home = (
    Arc<Scene>,
    Arc<Settings>,
    [u32; 2],
    Vec<ObjectId>,
    SpaceCamera,
);

/// Textures of curvature, of a scene with its params.
type Curvatures = (Arc<Scene>, Arc<Settings>, Vec<(ObjectId, Arc<Texture>)>);

impl Easel {
    fn answer(&mut self, job: &Job) -> Option<Answer> {
        Some(match job {
            Job::Move(_) => return None,
            Job::Draw(pane, order, motions) => {
                let start = Instant::now();
                let mut picture = self.draw(order, motions, start);
                if picture.is_err() && self.stage.is_lost() {
                    // The processor is never lost.
                    self.stage = Stage::software();
                    self.shares_gpu = false;
                    picture = self.draw(order, &[], start);
                }
                self.took.insert(pane.clone(), start.elapsed());
                Answer::Drawn {
                    pane: pane.clone(),
                    picture: picture.map(Box::new).map_err(|error| error.to_string()),
                    order: Box::new(order.clone()),
                    counters: self.stage.counters(),
                }
            }
            Job::Pick(order, at, purpose) => {
                let request = order.request(None);
                let hit = self
                    .stage
                    .pick(&order.scene, &order.settings, &request, *at);
                let hit = hit.ok().flatten();
                Answer::Picked {
                    scene: Arc::clone(&order.scene),
                    camera: hit.and_then(|hit| self.placed(order, &hit)),
                    hit,
                    purpose: *purpose,
                }
            }
            Job::Frame(order) => Answer::Framed(self.home(order).ok()?),
        })
    }

    fn draw(
        &mut self,
        order: &Order,
        motions: &[Motion],
        start: Instant,
    ) -> Result<Drawing, RenderError> {
        let mut space_camera = None;
        let inside_camera;
        let mut walked = None;
        let mut request: Request = match &order.look {
            Look::Space {
                camera, standpoint, ..
            } => {
                let seen_from = match camera {
                    Some(camera) => *camera,
                    None => self.home(order)?,
                };
                space_camera = Some(seen_from);
                // Where the scene is another one, so is the camera that stands in it: its own picture may come later.
                let shown = standpoint.as_ref().and_then(|it| self.standing(order, it));
                let mut order = order.clone();
                if let Look::Space {
                    camera, standpoint, ..
                } = &mut order.look
                {
                    *camera = Some(seen_from);
                    standpoint.clone_from(&shown);
                }
                inside_camera = shown.and_then(|it| Some((it.name, it.camera?, it.placed)));
                order.request(None)
            }
            Look::Inside {
                surface,
                name,
                placed,
                camera,
                trail,
            } => {
                let pilot = self.pilots.entry(name.clone()).or_default();
                let camera = pilot.fly(&Flight {
                    scene: &order.scene,
                    settings: &order.settings,
                    surface: *surface,
                    placed: *placed,
                    camera: *camera,
                    motions,
                    trail: *trail,
                })?;
                inside_camera = Some((name.clone(), camera, *placed));
                walked = pilot.walked().cloned();
                let mut request = order.request(Some(camera));
                let trail = walked.iter().map(|it| Arc::clone(&it.trail));
                request.trails.extend(trail);
                request
            }
        };
        request.textures.extend(self.curvatures(order));
        let shot: Shot = self.stage.draw(&order.scene, &order.settings, &request)?;
        let pixels = match shot.pixels {
            Pixels::Texture(canvas) if self.shares_gpu => Painted::Canvas(canvas),
            pixels => {
                let image = self.stage.read(pixels)?;
                let size = [image.width() as usize, image.height() as usize];
                // Opaque, so it does not matter whether alpha has been multiplied in; this way is the quick one.
                let image = egui::ColorImage::from_rgba_premultiplied(size, image.as_raw());
                Painted::Image(image)
            }
        };
        Ok(Drawing {
            pixels,
            notes: shot.notes,
            overlays: shot.overlays,
            inside: shot.inside,
            space_camera,
            inside_camera,
            walked,
            took: start.elapsed(),
        })
    }

    /// A geodesic camera as it is now.
    fn standing(&mut self, order: &Order, told: &Standing) -> Option<Standing> {
        let pilot = self.pilots.entry(told.name.clone()).or_default();
        let trail = pilot.trail();
        let camera = pilot.fly(&Flight {
            scene: &order.scene,
            settings: &order.settings,
            surface: told.surface,
            placed: told.placed,
            camera: told.camera,
            motions: &[],
            // It is left where it is seen from inside.
            trail,
        });
        Some(Standing {
            camera: Some(camera.ok()?),
            ..told.clone()
        })
    }

    /// Where everything is seen from.
    fn home(&mut self, order: &Order) -> Result<SpaceCamera, RenderError> {
        let request = order.request(None);
        if let Some((scene, settings, size, hidden, camera)) = &self.home
            && Arc::ptr_eq(scene, &order.scene)
            && *settings == order.settings
            && *size == order.size
            && *hidden == request.hidden
        {
            return Ok(*camera);
        }
        let bounds = Bounds::shown(&order.scene, &order.settings, &request);
        let camera = Camera::new(&bounds, None, None, order.size)?;
        let (centre, radius) = (
            DVec3::from(bounds.placement.centre),
            bounds.placement.radius,
        );
        let world = |place: DVec3| (centre + radius * place).to_array();
        let ahead = camera.eye.dot(camera.axes[2]);
        let camera = SpaceCamera {
            eye: world(camera.eye),
            target: world(camera.eye - camera.axes[2] * ahead),
            radius,
            moved: false,
        };
        self.home = Some((
            Arc::clone(&order.scene),
            Arc::clone(&order.settings),
            order.size,
            request.hidden,
            camera,
        ));
        Ok(camera)
    }

    /// The textures of curvature, made anew only where the scene or its params are others.
    fn curvatures(&mut self, order: &Order) -> Vec<(ObjectId, Arc<Texture>)> {
        if order.curved.is_empty() {
            return Vec::new();
        }
        if let Some((scene, settings, textures)) = &self.curvatures
            && Arc::ptr_eq(scene, &order.scene)
            && *settings == order.settings
            && order
                .curved
                .iter()
                .all(|id| textures.iter().any(|(it, _)| it == id))
        {
            let wanted = textures.iter().filter(|(id, _)| order.curved.contains(id));
            return wanted.cloned().collect();
        }
        let textures = order.curvatures();
        let (scene, settings) = (Arc::clone(&order.scene), Arc::clone(&order.settings));
        self.curvatures = Some((scene, settings, textures.clone()));
        textures
    }

    /// A geodesic camera where something was hit, as long as the one that is on that surface.
    fn placed(&self, order: &Order, hit: &Hit) -> Option<InsideCamera> {
        let object = order.scene.objects.get(hit.object.0 as usize)?;
        object.shape.patch()?;
        let camera = self.pilots.get(&object.name).and_then(Pilot::camera);
        let mut request = Request::geodesic(hit.object, order.size);
        if let View::Geodesic { at, zoom, .. } = &mut request.view {
            *at = Some(hit.parameters);
            *zoom = camera.map(|camera| camera.zoom);
        }
        let inside = Inside::new(&order.scene, &order.settings, &request).ok()?;
        Some(InsideCamera::of(&inside.frame, inside.zoom, true))
    }
}
