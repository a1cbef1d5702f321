//! The pictures of a recording, one after the other, and the file to which they are written.
//!
//! ```text
//! Film: request, camera, motion ──fraction of the whole──▶ settings, camera ──software path──▶ picture ──▶ AnimationFile
//! ```
//!
//! The processor draws, so that a recording is independent of the window's GPU and its loss.

use std::path::Path;
use std::sync::Arc;

use export::animation::{self, Clip, Course, ParamChange, Script};
use export::animation_file::{AnimationError, AnimationFile};
use image::RgbaImage;
use render::shared::Shared;
use render::{PictureRequest, Renderer, Views};
use scene::ObjectId;
use session::InsideCamera;
use session::camera_controller::{CameraController, Subject};
use session::motion::Motion;
use session::path::{CameraPath, between};

/// The content of a recording.
#[derive(Debug)]
pub(crate) struct Film {
    /// The picture of the view in its current state.
    pub(crate) request: PictureRequest,
    /// The views that can be drawn.
    pub(crate) views: Views,
    /// The geodesic camera of the view, or the one that a view in space shows.
    pub(crate) camera: Option<(ObjectId, InsideCamera)>,
    /// A param that changes from one value to another.
    pub(crate) change: Option<ParamChange>,
    /// True if the camera of the 3D view turns about its target.
    pub(crate) turntable: bool,
    /// The course from the first picture to the last.
    pub(crate) course: Course,
    /// The motions of the geodesic camera.
    pub(crate) motions: Vec<Motion>,
    /// True if its path is drawn.
    pub(crate) trail: bool,
    pub(crate) transparent: bool,
    pub(crate) clip: Clip,
}

/// The reason why a recording has no file.
#[derive(Debug)]
pub(crate) enum Ended {
    /// It was cancelled.
    Cancelled,
    /// A picture could not be drawn, or the file's name is invalid: a sentence.
    Failed(String),
}

impl Film {
    /// Draws all pictures and writes them; `next` is called before each with its number, and returns whether to
    /// continue.
    ///
    /// # Errors
    /// See [`Ended`]; no file is left.
    pub(crate) fn shoot(self, path: &Path, next: &dyn Fn(u32) -> bool) -> Result<String, Ended> {
        let file = AnimationFile::of_path(path).ok_or_else(|| {
            Ended::Failed(format!(
                "`{}` does not end in gif, apng, mp4, webm or png",
                path.display()
            ))
        })?;
        let clip = self.clip;
        let frames = clip.frames;
        let mut pictures = Pictures::new(self)?;
        let mut picture = |number: u32| {
            if !next(number) {
                return Err(Ended::Cancelled);
            }
            pictures.draw(number).map(Some)
        };
        let written = file.write(path, clip, &mut picture);
        written.map_err(|error| ended(error, path))?;
        Ok(match file.seconds(clip) {
            Some(seconds) => format!(
                "{frames} frames, {seconds:.2} s long, were saved in `{}`",
                path.display()
            ),
            None => {
                let first = animation::numbered(path, 0, frames);
                format!(
                    "{frames} frames were saved: `{}` and so on",
                    first.display()
                )
            }
        })
    }
}

fn ended(error: AnimationError<Ended>, path: &Path) -> Ended {
    let unwritten =
        |path: &Path, reason: String| format!("cannot write `{}`: {reason}", path.display());
    Ended::Failed(match error {
        AnimationError::Picture(ended) => return ended,
        AnimationError::Unwritable { file, error } => {
            unwritten(file.as_deref().unwrap_or(path), error.to_string())
        }
        AnimationError::Format(error) => unwritten(path, error.to_string()),
        AnimationError::Video(error) => error.to_string(),
        AnimationError::Encoding(error) => error.to_string(),
    })
}

/// Draws pictures in order.
struct Pictures {
    film: Film,
    script: Script,
    /// The request of the first picture, whose view is that of the whole animation.
    base: PictureRequest,
    controller: CameraController,
    /// The geodesic camera in the last picture, and its path if it is drawn.
    camera: Option<InsideCamera>,
    path: Option<Arc<CameraPath>>,
    renderer: Renderer,
    done: f64,
}

impl Pictures {
    fn new(film: Film) -> Result<Self, Ended> {
        let script = Script {
            changes: film.change.iter().cloned().collect(),
            turntable: film.turntable,
            ..Script::default()
        };
        let mut request = film.request.clone();
        request.size = film.clip.size;
        let base = script
            .steady(&request)
            .map_err(|error| Ended::Failed(error.to_string()))?;
        Ok(Self {
            renderer: Renderer::software().with_views(film.views.clone()),
            film,
            script,
            base,
            controller: CameraController::default(),
            camera: None,
            path: None,
            done: 0.0,
        })
    }

    fn draw(&mut self, number: u32) -> Result<RgbaImage, Ended> {
        let failed = |error: String| Ended::Failed(error);
        let film = &self.film;
        let share = film.course.share(number, film.clip.frames);
        let at = self.script.frame_at(&self.base, share);
        let at = at.map_err(|error| failed(error.to_string()))?;
        let mut request = film.request.clone();
        request.params = at.params;
        let turned = at.view.space().map(|space| space.camera);
        if let Some((surface, start)) = film.camera {
            let subject = Subject {
                scene: Arc::clone(request.scene.arc()),
                settings: Arc::clone(&request.params),
                surface,
            };
            let before = self.camera.unwrap_or(start);
            let settled = self
                .controller
                .settle(&subject, Some(before), &mut self.path);
            let mut camera = settled.map_err(|error| failed(error.to_string()))?;
            if film.trail
                && let Some(camera) = camera.chart()
                && !self
                    .path
                    .as_ref()
                    .is_some_and(|path| path.ends_at(camera.at))
            {
                self.path = Some(Arc::new(CameraPath::begin(surface, *camera)));
            }
            for motion in between(&film.motions, [self.done, share]) {
                camera = self.controller.apply(camera, motion, self.path.as_mut());
            }
            self.done = share;
            self.camera = Some(camera);
            request.view.show_camera(camera.on(surface));
        }
        request.size = film.clip.size;
        let trail = self.path.iter().map(|path| Shared::from(&path.trail));
        request.trails = trail.collect();
        if let (Some(space), Some(camera)) = (request.view.space_mut(), turned) {
            space.camera = camera;
            if film.transparent {
                space.background = Some([0; 4]);
            }
        }
        let drawn = self.renderer.draw(&request);
        let image = drawn.and_then(|drawn| self.renderer.read(drawn.image));
        image.map_err(|error| failed(error.to_string()))
    }
}
