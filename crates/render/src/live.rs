//! What a window draws with: views of a scene again and again, while the scene is edited, its params move and its
//! cameras walk.
//!
//! ```text
//! Scene + ParamValues ──content.rs──▶ a key for each object ──samples.rs──▶ samples ─┐
//!                  ──place.rs────▶ drawing units that stay ───────────────────────┼──▶ software/ or gpu/ ──▶ Shot
//! surface + Frame  ──inside.rs───▶ geodesics ─────────────────────────────────────┘
//! ```
//!
//! A [`Stage`] keeps from one picture to the next what both need: samples, pipelines, textures, geodesics. What is kept
//! is known by its content, so that an edit of one object leaves those of all others alone. A stage belongs to one
//! thread at a time; it never draws a picture by itself.

pub(crate) mod content;
pub(crate) mod inside;
pub(crate) mod kept;
mod place;
pub(crate) mod samples;

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use geodesic::ends::{Estimate, Work};
use image::RgbaImage;
use scene::ParamValues;
use scene::{ObjectId, Range, Sampling, Scene, Shape};

use crate::bounds::{Bounds, Placement};
use crate::camera::Camera;
use crate::gpu::studio::{Space, Studio};
use crate::gpu::{Canvas, Gpu};
use crate::overlay::{self, Extra, Overlays, Standpoint};
use crate::request::{RenderError, Request, View};
use crate::software::{self, Painted};
use content::{Content, Structures};
use inside::{Look, Looks};
use place::{Place, Placed};
use samples::SampleStore;

/// Draws the views of one window.
#[derive(Debug, Default)]
pub struct Stage {
    pictures: u64,
    structures: Structures,
    place: Place,
    samples: SampleStore,
    looks: Looks,
    extras: Option<(ExtrasKey, Arc<[Extra]>)>,
    /// The last pictures of space and from inside.
    last: [Option<Last>; 2],
    /// What draws on a GPU; without it the software path does.
    studio: Option<Box<Studio>>,
}

/// A picture that has been drawn, and what it was drawn of.
#[derive(Debug)]
struct Last {
    scene: Arc<Scene>,
    settings: ParamValues,
    request: Request,
    bounds: Option<Arc<Bounds>>,
    shot: Shot,
}

/// A picture of a view.
#[derive(Clone, Debug)]
pub struct Shot {
    /// The picture.
    pub pixels: Pixels,
    /// What a reader of the picture should know, as in [`crate::Picture`].
    pub notes: Vec<String>,
    /// What has been drawn over it, as in [`crate::Picture`].
    pub overlays: Vec<&'static str>,
    /// Of a geodesic view: what following its geodesics has cost, and how far off they are at most, in pixels.
    pub inside: Option<(Work, Option<Estimate>)>,
    /// From the request to the picture (on a GPU: until it was handed over).
    pub took: Duration,
}

/// Where a picture's pixels are.
#[derive(Clone, Debug)]
pub enum Pixels {
    /// sRGB, top row first, in memory: drawn by the software path.
    Image(RgbaImage),
    /// On the stage's device.
    Texture(Canvas),
}

/// What has been made so far, counted; nothing is ever taken back.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Counters {
    /// Pictures that have been drawn.
    pub pictures: u64,
    /// Pipelines of painters and passes, and kernels: whatever a driver compiles.
    pub pipelines: u64,
    /// Objects whose samples were computed.
    pub sampled: u64,
    /// Geodesic views whose geodesics were followed.
    pub looks: u64,
    /// Their pixels whose ends were computed here, for colours or for what lies over them.
    pub ends: u64,
    /// Rows of up to eight pixels of which the distances to a straight piece of a line over a geodesic view were
    /// computed.
    pub distances: u64,
}

/// What is under a pixel of the 3D view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The object.
    pub object: ObjectId,
    /// The place, in the scene's units.
    pub position: [f64; 3],
    /// (u, v) of a surface, (t, 0) of a curve, zero otherwise.
    pub parameters: [f64; 2],
    /// Which of the object's instances, counted from 0.
    pub instance: u64,
}

/// What the picture of a geodesic camera in space depends on.
#[derive(Clone, Debug, PartialEq)]
struct ExtrasKey {
    ground: Option<Content>,
    standpoint: Option<Standpoint>,
    overlays: Overlays,
    size: [u32; 2],
    placement: Placement,
}

impl Stage {
    /// A stage that draws by the software path.
    pub fn software() -> Self {
        Self::default()
    }

    /// A stage that draws on a GPU. The device may be a window's own: then [`Pixels::Texture`] can be shown as it is.
    pub fn on(gpu: Arc<Gpu>) -> Self {
        Self {
            studio: Some(Box::new(Studio::new(gpu))),
            ..Self::default()
        }
    }

    /// The same, but an object's samples are asked of a kernel from so many operations on, instead of
    /// [`crate::plan::KERNEL_PAYS`]: for tests, which have no time for objects as large as that.
    #[must_use]
    pub fn with_kernels_from(mut self, operations: u64) -> Self {
        if let Some(studio) = &mut self.studio {
            studio.kernels_pay_from(operations);
        }
        self
    }

    /// Whether kernels are being built, behind the pictures.
    pub fn is_building(&self) -> bool {
        self.studio.as_ref().is_some_and(|it| it.is_building())
    }

    /// The GPU that it draws on, if it does.
    pub fn gpu(&self) -> Option<&Arc<Gpu>> {
        self.studio.as_ref().map(|studio| &studio.gpu)
    }

    /// Whether its GPU is gone for good: then a new stage is needed, on another device or by the software path.
    pub fn is_lost(&self) -> bool {
        self.gpu().is_some_and(|gpu| gpu.is_lost())
    }

    /// Draws a view. The request's backend is not heeded: a stage has its own.
    ///
    /// Unlike [`crate::render`], which measures each scene anew, a stage draws in the bounds of the first scene that it
    /// was given until a scene has outgrown them (see [`Stage::bounds`]): while params move and declarations change, the
    /// first camera stays where it is.
    ///
    /// What has been drawn last of space, or from inside, is not drawn again: who asks for it gets the same pixels.
    ///
    /// # Errors
    /// As [`crate::render`].
    pub fn draw(
        &mut self,
        scene: &Arc<Scene>,
        settings: &ParamValues,
        request: &Request,
    ) -> Result<Shot, RenderError> {
        let start = Instant::now();
        request.check(scene)?;
        if self.is_lost() {
            return Err(RenderError::Gpu("the device was lost".to_owned()));
        }
        let last = usize::from(matches!(request.view, View::Geodesic { .. }));
        if let Some(last) = &self.last[last]
            && last.is_of(scene, settings, request, self.bounds().as_ref())
        {
            let mut shot = last.shot.clone();
            if let Some(gpu) = self.gpu() {
                gpu.answers()?;
            }
            shot.took = start.elapsed();
            return Ok(shot);
        }
        let mut shot = match request.view {
            View::Space { eye, target } => self.space(scene, settings, request, [eye, target])?,
            View::Geodesic { .. } => self.inside(scene, settings, request)?,
        };
        self.pictures += 1;
        self.last[last] = Some(Last {
            scene: scene.clone(),
            settings: settings.clone(),
            request: request.clone(),
            bounds: self.bounds(),
            shot: self.copied(last, &shot),
        });
        shot.took = start.elapsed();
        Ok(shot)
    }

    /// A copy of a picture, in the memory of the one that was kept before.
    fn copied(&mut self, last: usize, shot: &Shot) -> Shot {
        let before = self.last[last].take().map(|last| last.shot.pixels);
        let pixels = match (before, &shot.pixels) {
            (Some(Pixels::Image(mut before)), Pixels::Image(image))
                if before.dimensions() == image.dimensions() =>
            {
                before.copy_from_slice(image);
                Pixels::Image(before)
            }
            (_, pixels) => pixels.clone(),
        };
        Shot {
            pixels,
            notes: shot.notes.clone(),
            overlays: shot.overlays.clone(),
            ..*shot
        }
    }

    /// A picture of this stage in memory. Waits for the GPU if it is there.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device is lost, or the picture is another stage's.
    pub fn read(&self, pixels: Pixels) -> Result<RgbaImage, RenderError> {
        match (pixels, self.gpu()) {
            (Pixels::Image(image), _) => Ok(image),
            (Pixels::Texture(canvas), Some(gpu)) => canvas.read(gpu),
            (Pixels::Texture(_), None) => Err(RenderError::Gpu(
                "the picture is another stage's".to_owned(),
            )),
        }
    }

    /// What the 3D view that a request describes shows at the place (x, y), in pixels from its top left corner: a point,
    /// vector or curve that is seen within [`software::NEAR`] pixels, else the surface there. Metrics are not seen in
    /// space, and what lies behind something else is not seen either.
    ///
    /// # Errors
    /// As [`Stage::draw`]; also where the request is for a geodesic view.
    pub fn pick(
        &mut self,
        scene: &Arc<Scene>,
        settings: &ParamValues,
        request: &Request,
        at: [f64; 2],
    ) -> Result<Option<Hit>, RenderError> {
        let camera = self.camera(scene, settings, request)?;
        let structures = self.structures.of(scene);
        let placed = self.place.of(scene, settings, &structures, request);
        let (painted, _) = self.painted(scene, settings, request, &placed);
        let picked = software::pick(&camera, &painted, at);
        Ok(picked.map(|picked| Hit {
            object: ObjectId(picked.object as u32),
            position: camera.placement.world(picked.position),
            parameters: parameters(&scene.objects[picked.object].shape, picked.shares),
            instance: picked.instance,
        }))
    }

    /// The camera that a request for the 3D view has, in the drawing units of the stage's bounds.
    ///
    /// # Errors
    /// [`RenderError::Camera`]; also where the request is for a geodesic view.
    pub fn camera(
        &mut self,
        scene: &Arc<Scene>,
        settings: &ParamValues,
        request: &Request,
    ) -> Result<Camera, RenderError> {
        request.check(scene)?;
        let View::Space { eye, target } = request.view else {
            let sentence = "a geodesic view has no camera in space";
            return Err(RenderError::Camera(sentence.to_owned()));
        };
        let structures = self.structures.of(scene);
        let placed = self.place.of(scene, settings, &structures, request);
        placed.camera(eye, target, request.size)
    }

    /// The bounds in which 3D views are drawn: those of the first scene, until a scene no longer fits them. A camera
    /// that is not told where to stand frames them.
    pub fn bounds(&self) -> Option<Arc<Bounds>> {
        self.place.kept().cloned()
    }

    /// Draws in other bounds from now on; `None` stands for those of the scene that is drawn next, as when all of it is
    /// to be seen.
    pub fn set_bounds(&mut self, bounds: Option<Arc<Bounds>>) {
        self.place.keep(bounds);
    }

    /// What has been made so far.
    pub fn counters(&self) -> Counters {
        let studio = self.studio.as_ref();
        let tally = &self.looks.tally;
        let pipelines = studio.map_or(0, |studio| studio.pipelines());
        Counters {
            pictures: self.pictures,
            pipelines,
            sampled: self.samples.sampled + studio.map_or(0, |studio| studio.sampled()),
            looks: self.looks.followed,
            ends: tally.ends.load(Ordering::Relaxed),
            distances: tally.distances.load(Ordering::Relaxed),
        }
    }

    fn space(
        &mut self,
        scene: &Arc<Scene>,
        settings: &ParamValues,
        request: &Request,
        [eye, target]: [Option<[f64; 3]>; 2],
    ) -> Result<Shot, RenderError> {
        let structures = self.structures.of(scene);
        let placed = self.place.of(scene, settings, &structures, request);
        let camera = placed.camera(eye, target, request.size)?;
        let mut extras = self.extras(scene, settings, request, &camera.placement)?;
        let trails = overlay::trail_extras(scene, settings, request, &camera.placement);
        if !trails.is_empty() {
            extras = extras.iter().cloned().chain(trails).collect();
        }
        let (mut pixels, notes) = if let Some(studio) = &mut self.studio {
            let space = Space {
                scene,
                settings,
                request,
                structures: &structures,
                contents: placed.contents(),
                camera: &camera,
                extras: &extras,
            };
            let (canvas, notes) = studio.space(&mut self.samples, &space)?;
            (Pixels::Texture(canvas), notes)
        } else {
            let (mut painted, notes) = self.painted(scene, settings, request, &placed);
            painted.extend(extras.iter().map(|extra| Painted {
                samples: extra.samples.clone(),
                colour: extra.colour,
                emphasis: 0.0,
                texture: None,
            }));
            let behind = request.background_light();
            let image = software::draw(&camera, &painted, behind, &|_| {});
            (Pixels::Image(image), notes)
        };
        self.samples.next();
        let mut overlays = overlay::names(extras.iter());
        if overlay::any_space(request) {
            // Words are written over pictures in memory.
            let mut image = self.read(pixels)?;
            overlays.extend(overlay::over_space(&mut image, scene, settings, request)?);
            pixels = Pixels::Image(image);
        }
        Ok(Shot::new(pixels, notes, overlays))
    }

    fn inside(
        &mut self,
        scene: &Arc<Scene>,
        settings: &ParamValues,
        request: &Request,
    ) -> Result<Shot, RenderError> {
        let structures = self.structures.of(scene);
        let look = self.looks.look(scene, settings, &structures, request)?;
        self.looks.next();
        let cost = Some((look.seen.work(), look.seen.estimate()));
        if let Some(studio) = &mut self.studio {
            let gpu = studio.gpu.clone();
            let (insides, mut workshop, canvases) = studio.insides();
            let coloured = gpu.guarded(|| {
                insides.colour(&mut workshop, canvases, scene, settings, request, &look)
            });
            let built = workshop.built;
            studio.keep_count(built);
            if let Some(coloured) = coloured? {
                return Ok(Shot {
                    inside: cost,
                    ..Shot::new(coloured.pixels, coloured.notes, coloured.overlays)
                });
            }
        }
        let Look {
            inside,
            seen,
            tally,
        } = &*look;
        let picture = software::paint(scene, settings, request, inside, seen, tally)?;
        Ok(Shot {
            inside: cost,
            ..Shot::new(
                Pixels::Image(picture.image),
                picture.notes,
                picture.overlays,
            )
        })
    }

    /// The scene's objects with their samples, and what a reader should be told of them.
    fn painted(
        &mut self,
        scene: &Scene,
        settings: &ParamValues,
        request: &Request,
        placed: &Placed,
    ) -> (Vec<Painted>, Vec<String>) {
        let (mut painted, mut notes) = (Vec::new(), Vec::new());
        let placement = placed.bounds.placement;
        for ((index, object), content) in scene.objects.iter().enumerate().zip(placed.contents()) {
            let id = ObjectId(index as u32);
            if !request.shows(id) {
                // It keeps its number.
                painted.push(Painted::nothing());
                continue;
            }
            let sampled = self.samples.get(scene, settings, id, content, &placement);
            notes.extend(sampled.notes(object));
            let is_surface = matches!(object.shape, Shape::Surface { .. });
            painted.push(Painted {
                samples: sampled.samples,
                colour: request.colour(id, &object.shape),
                emphasis: request.emphasis(id),
                texture: is_surface.then(|| request.texture(id)),
            });
        }
        (painted, notes)
    }

    /// What shows the geodesic camera that a request asks for.
    fn extras(
        &mut self,
        scene: &Arc<Scene>,
        settings: &ParamValues,
        request: &Request,
        placement: &Placement,
    ) -> Result<Arc<[Extra]>, RenderError> {
        let structures = self.structures.of(scene);
        let ground = request.show_camera.as_ref().and_then(|standpoint| {
            Looks::standpoint_content(scene, settings, &structures, standpoint)
        });
        let key = ExtrasKey {
            ground,
            standpoint: request.show_camera,
            overlays: request.overlays,
            size: request.size,
            placement: *placement,
        };
        if let Some((known, extras)) = &self.extras
            && *known == key
        {
            return Ok(extras.clone());
        }
        let extras: Arc<[Extra]> =
            overlay::camera_extras(scene, settings, request, placement)?.into();
        self.extras = Some((key, extras.clone()));
        Ok(extras)
    }
}

impl Last {
    /// Whether the same is asked for: then the same would be drawn.
    fn is_of(
        &self,
        scene: &Arc<Scene>,
        settings: &ParamValues,
        request: &Request,
        bounds: Option<&Arc<Bounds>>,
    ) -> bool {
        let same_bounds = match (&self.bounds, bounds) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (None, None) => true,
            _ => false,
        };
        same_bounds
            && Arc::ptr_eq(&self.scene, scene)
            && self.settings == *settings
            && self.request.is_like(request)
    }
}

impl Shot {
    fn new(pixels: Pixels, notes: Vec<String>, overlays: Vec<&'static str>) -> Self {
        Self {
            pixels,
            notes,
            overlays,
            inside: None,
            took: Duration::ZERO,
        }
    }
}

/// Parameters from shares of the domain.
fn parameters(shape: &Shape, shares: [f64; 2]) -> [f64; 2] {
    let value = |sampling: &Sampling, share: f64| {
        let Range { min, max } = sampling.range;
        // As [`Sampling::value`], where the interval may be wider than the largest number.
        (min * (1.0 - share) + max * share).clamp(min, max)
    };
    match shape {
        Shape::Surface { domain, .. } => {
            [value(&domain[0], shares[0]), value(&domain[1], shares[1])]
        }
        Shape::Curve { domain, .. } | Shape::Geodesic { domain, .. } => {
            [value(domain, shares[0]), 0.0]
        }
        Shape::Point { .. } | Shape::Vector { .. } | Shape::Metric { .. } => [0.0; 2],
    }
}
