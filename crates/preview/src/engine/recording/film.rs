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
use render::figure::Figure;
use render::shared::Shared;
use render::trail::{Trail, TrailKind};
use render::{PictureRequest, Renderer, Views};
use scene::ObjectId;
use session::InsideCamera;
use session::camera_controller::{CameraController, Subject};
use session::figures::measured;
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
    /// The figure whose lines are among those of the request, with its surface.
    pub(crate) figure: Option<(ObjectId, Figure)>,
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

impl Film {
    /// The lines that the view shows on its surfaces, as they are for the params of a picture. The path of the camera that walks
    /// is not among them: it grows.
    fn lines(&self, request: &PictureRequest) -> Vec<Shared<Trail>> {
        let walks = self.camera.filter(|_| !self.motions.is_empty());
        let is_own = |trail: &Trail| {
            let is_walked = trail.kind == TrailKind::Walked;
            is_walked && walks.is_some_and(|(surface, _)| surface == trail.surface)
        };
        let shown = self.request.trails.iter().filter(|trail| !is_own(trail));
        if request.params == self.request.params {
            return shown.cloned().collect();
        }
        let subject = |surface| Subject {
            scene: Arc::clone(request.scene.arc()),
            param_values: Arc::clone(&request.params),
            surface,
        };
        let walked = shown.filter(|trail| trail.kind == TrailKind::Walked);
        let walked = walked.filter_map(|trail| {
            let manifold = subject(trail.surface).manifold().ok()?;
            let points = trail.points.clone();
            Some(Trail::through(manifold.surface(), trail.surface, points).into())
        });
        let mut lines: Vec<Shared<Trail>> = walked.collect();
        if let Some((surface, figure)) = &self.figure {
            let subject = subject(*surface);
            if let Ok(manifold) = subject.manifold() {
                let measured = measured(manifold.surface(), &subject, figure);
                lines.extend(measured.lines.into_iter().map(Shared::from));
            }
        }
        lines
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
                param_values: Arc::clone(&request.params),
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
        request.trails = film.lines(&request);
        let trail = self.path.iter().map(|path| Shared::from(&path.trail));
        request.trails.extend(trail);
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

#[cfg(test)]
mod tests {
    use render::figure::FigureKind;
    use scene::ParamValues;

    use super::*;

    #[test]
    fn a_recording_has_the_lines_of_the_view_as_they_are_for_its_params() {
        let text = "param r = 1 : [1, 2]; surface s(u, v) = (r u, r v, 0), u : [0, 1], v : [0, 1];";
        let scene = Arc::new(scene::geotrace::compile(text).scene.expect("no errors"));
        let surface = ObjectId::new(0);
        let at = |r: f64| {
            let mut params = ParamValues::initial(&scene);
            params.set(&scene, "r", &[r]).expect("within its interval");
            Arc::new(params)
        };
        let subject = Subject {
            scene: scene.clone(),
            param_values: at(1.0),
            surface,
        };
        let manifold = subject.manifold().expect("a surface");
        let figure = Figure {
            kind: FigureKind::Distance,
            places: vec![[0.25, 0.25], [0.75, 0.25]],
            radius: None,
        };
        let walked = Trail::through(manifold.surface(), surface, vec![[0.0, 0.0], [0.0, 1.0]]);
        let side = measured(manifold.surface(), &subject, &figure).lines;
        let views = Views::standard();
        let mut request = PictureRequest::new(&scene, at(1.0), views.first().options(None), [8, 8]);
        request.trails = std::iter::once(Arc::new(walked))
            .chain(side)
            .map(Shared::from)
            .collect();
        let film = Film {
            request: request.clone(),
            views,
            camera: None,
            change: None,
            turntable: false,
            course: Course::Once,
            motions: Vec::new(),
            trail: false,
            figure: Some((surface, figure)),
            transparent: false,
            clip: Clip {
                frames: 2,
                size: [8, 8],
                rate: 25.0,
            },
        };
        assert_eq!(film.lines(&request), request.trails);
        let lengths = |request: &PictureRequest| {
            let lines = film.lines(request);
            let longest = |is_walked: bool| {
                let of_kind = lines
                    .iter()
                    .filter(|line| (line.kind == TrailKind::Walked) == is_walked);
                of_kind.map(|line| line.length).fold(0.0, f64::max)
            };
            [true, false].map(longest)
        };
        let near = |found: [f64; 2], expected: [f64; 2]| {
            assert!(
                (0..2).all(|k| (found[k] - expected[k]).abs() < 1e-6),
                "{found:?}"
            );
        };
        near(lengths(&request), [1.0, 0.5]);
        request.params = at(2.0);
        near(lengths(&request), [2.0, 1.0]);
    }
}
