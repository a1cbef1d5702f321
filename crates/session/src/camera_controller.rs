//! The camera of a geodesic view: it moves on its surface, and keeps its position when the surface changes.
//!
//! In: the surface with the params' values, the camera as the model has it, motions. Out: the camera on that surface. A
//! motion is one geodesic and takes microseconds, so it is computed on the frame's thread, where the model is: each
//! request for a picture has the current camera, and no picture returns one.

use std::sync::Arc;

use geodesic::frame::Frame;
use geodesic::implicit::SpaceFrame;
use geodesic::point::TangentVector;
use geodesic::surface::Surface;
use geodesic::trace::{Options, Status, Trace, TraceError};
use geometry::{Manifold, ManifoldError, SolidSurface};
use render::RenderError;
use render::geodesic_view::{PlacedCamera, PlacedSolidCamera};
use render::view::Hit;
use render::viewpoint::{GeodesicCamera, Pose};
use scene::{ObjectId, ParamValues, Scene};

use super::inside_camera::{ChartCamera, InsideCamera, SolidCamera};
use super::motion::Motion;
use super::path::CameraPath;

/// Moves the camera of one surface.
#[derive(Debug, Default)]
pub struct CameraController {
    instance: Option<Instance>,
    /// The camera that was last settled on the instance, and the result.
    settled: Option<(Option<InsideCamera>, Result<InsideCamera, RenderError>)>,
}

/// A surface, metric or solid of a scene with the params' values.
#[derive(Clone, Debug)]
pub struct Subject {
    /// The scene.
    pub scene: Arc<Scene>,
    /// The params' values.
    pub param_values: Arc<ParamValues>,
    /// The surface, metric or solid.
    pub surface: ObjectId,
}

/// A subject that is ready for geodesics.
#[derive(Debug)]
struct Instance {
    subject: Subject,
    ground: Result<Ground, ManifoldError>,
}

/// An object on which a camera is, ready for geodesics.
#[derive(Debug)]
pub(crate) enum Ground {
    Manifold(Arc<Manifold>),
    Solid(Arc<SolidSurface>),
}

/// The difference between two subjects.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum SubjectChange {
    None,
    /// The params have changed.
    Values,
    Scene,
}

impl CameraController {
    /// Settles a camera on a surface in its current form. The camera keeps its position as far as the surface allows: X
    /// and Y become orthogonal and keep their length. The initial camera takes over if there is none, if it cannot be
    /// there, or if the scene has changed and the user has not moved it. The path that led to the camera ends if it is
    /// no longer a path of this length on the surface.
    ///
    /// # Errors
    /// [`RenderError`] if no camera can be on the surface.
    pub fn settle(
        &mut self,
        subject: &Subject,
        camera: Option<InsideCamera>,
        path: &mut Option<Arc<CameraPath>>,
    ) -> Result<InsideCamera, RenderError> {
        let change = self.change_to(subject, path);
        if let Some((known, result)) = &self.settled
            && change == SubjectChange::None
            && *known == camera
        {
            return result.clone();
        }
        let ground = match self.instance.as_ref().map(|instance| &instance.ground) {
            Some(Ok(ground)) => ground,
            Some(Err(error)) => return Err(error.clone().into()),
            None => return Err(ManifoldError::NoSurface { name: None }.into()),
        };
        // A camera that was placed by other means may be outdated, and not fit the surface in its current form.
        let kept = camera.filter(|camera| camera.is_moved() || change != SubjectChange::Scene);
        let kept = kept.and_then(|camera| ground.settled(camera));
        let result = kept.map_or_else(|| ground.first_place(subject), Ok);
        let known = result.as_ref().ok().copied().or(camera);
        self.settled = Some((known, result.clone()));
        result
    }

    /// Moves a camera that [`CameraController::settle`] has put on the surface, and extends the path that leads to it.
    /// Returns the camera unchanged if the motion is impossible.
    pub fn apply(
        &mut self,
        camera: InsideCamera,
        motion: Motion,
        path: Option<&mut Arc<CameraPath>>,
    ) -> InsideCamera {
        let Some(Instance {
            ground: Ok(ground), ..
        }) = &self.instance
        else {
            return camera;
        };
        let next = ground.moved(camera, motion, path).unwrap_or(camera);
        self.settled = Some((Some(next), Ok(next)));
        next
    }

    fn change_to(
        &mut self,
        subject: &Subject,
        path: &mut Option<Arc<CameraPath>>,
    ) -> SubjectChange {
        let change = match self.instance.as_ref().map(|instance| &instance.subject) {
            // A remembered camera is where the user left it.
            None => SubjectChange::Values,
            Some(before) if !before.is_of_scene(subject) => SubjectChange::Scene,
            Some(before) if before.param_values != subject.param_values => SubjectChange::Values,
            Some(_) => return SubjectChange::None,
        };
        let ground = subject.ground();
        if let (
            Some(Instance {
                ground: Ok(Ground::Manifold(before)),
                ..
            }),
            Ok(Ground::Manifold(after)),
        ) = (&self.instance, &ground)
            && let Some(walked) = &path
            && !walked.fits(before.surface(), after.surface())
        {
            *path = None;
        }
        self.instance = Some(Instance {
            subject: subject.clone(),
            ground,
        });
        change
    }
}

impl Subject {
    fn is_of_scene(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.scene, &other.scene) && self.surface == other.surface
    }

    /// Returns whether both are the same surface with the same params' values.
    pub fn is_same(&self, other: &Self) -> bool {
        self.is_of_scene(other) && self.param_values == other.param_values
    }

    /// Returns the names of its parameters in the notation of a point: "(u, v)".
    pub(crate) fn chart_label(&self) -> String {
        let object = self.scene.get(self.surface);
        object.map_or_else(String::new, |object| object.shape.chart_label())
    }

    /// Returns the surface, ready for geodesics.
    ///
    /// # Errors
    /// [`ManifoldError`] if it is not a surface or metric.
    pub fn manifold(&self) -> Result<Manifold, ManifoldError> {
        Manifold::first(&self.scene, &self.param_values, self.surface)
    }

    /// Returns the surface, metric or solid, ready for geodesics.
    pub(crate) fn ground(&self) -> Result<Ground, ManifoldError> {
        if self.scene.is_solid(self.surface) {
            let solid = SolidSurface::new(&self.scene, &self.param_values, self.surface)?;
            return Ok(Ground::Solid(Arc::new(solid)));
        }
        Ok(Ground::Manifold(Arc::new(self.manifold()?)))
    }

    /// Returns the camera at a point that was found in a picture, with a zoom if one is given.
    ///
    /// # Errors
    /// [`RenderError`] if no camera can be there.
    pub fn camera_at(&self, hit: &Hit, zoom: Option<f64>) -> Result<InsideCamera, RenderError> {
        let first = GeodesicCamera::new(self.surface);
        let ground = self.ground()?;
        let camera = match &ground {
            Ground::Manifold(_) => first.at(hit.parameters),
            Ground::Solid(_) => {
                let at = hit.position.map(|position| position.0);
                let pose = Pose::InSpace { at, angle: 0.0 };
                GeodesicCamera { pose, ..first }
            }
        };
        ground.camera(self, camera, zoom, true)
    }
}

impl Ground {
    /// Returns a camera on this object, which is that of the subject.
    fn camera(
        &self,
        subject: &Subject,
        camera: GeodesicCamera,
        zoom: Option<f64>,
        moved: bool,
    ) -> Result<InsideCamera, RenderError> {
        // The camera does not depend on the picture's size.
        const SIZE: [u32; 2] = [256; 2];
        let wanted = GeodesicCamera { zoom, ..camera };
        match self {
            Self::Manifold(manifold) => {
                let (scene, params) = (&subject.scene, &subject.param_values);
                let known = |_, _: &[f64]| Ok(Arc::clone(manifold));
                let placed = PlacedCamera::on(scene, params, &wanted, SIZE, known)?;
                let camera = ChartCamera::of(&placed.frame, placed.zoom, moved);
                Ok(InsideCamera::Chart(camera))
            }
            Self::Solid(solid) => {
                let solid = Arc::clone(solid);
                let placed = PlacedSolidCamera::on(solid, &subject.scene, &wanted, SIZE)?;
                let camera = SolidCamera::of(&placed.frame, moved);
                Ok(InsideCamera::Solid(camera))
            }
        }
    }

    /// Returns the camera's initial position.
    fn first_place(&self, subject: &Subject) -> Result<InsideCamera, RenderError> {
        let first = GeodesicCamera::new(subject.surface);
        self.camera(subject, first, None, false)
    }

    /// Returns the camera with X and Y orthogonal and as long as before, on the changed object. Returns a camera that
    /// already fits unchanged, and `None` if no camera can be there.
    fn settled(&self, camera: InsideCamera) -> Option<InsideCamera> {
        match (self, camera) {
            (Self::Manifold(manifold), InsideCamera::Chart(camera)) => {
                settled(manifold.surface(), &camera).map(InsideCamera::Chart)
            }
            (Self::Solid(solid), InsideCamera::Solid(camera)) => {
                let frame = camera.frame().brought_onto(solid.surface()).ok()?;
                let settled = InsideCamera::Solid(SolidCamera::of(&frame, camera.moved));
                settled.is_sane().then_some(settled)
            }
            _ => None,
        }
    }

    /// Returns the camera after a motion, or `None` if the motion is impossible. A successful motion extends the path.
    fn moved(
        &self,
        camera: InsideCamera,
        motion: Motion,
        path: Option<&mut Arc<CameraPath>>,
    ) -> Option<InsideCamera> {
        match (self, camera) {
            (Self::Manifold(manifold), InsideCamera::Chart(camera)) => {
                moved(manifold, camera, motion, path).map(InsideCamera::Chart)
            }
            (Self::Solid(solid), InsideCamera::Solid(camera)) => {
                let frame = moved_on_solid(solid, &camera.frame(), motion)?;
                let next = InsideCamera::Solid(SolidCamera::of(&frame, true));
                next.is_sane().then_some(next)
            }
            _ => None,
        }
    }
}

/// The maximum relative error of X and Y that counts as rounding: a long walk leaves this much.
const FITS: f64 = 1e-9;

/// Returns the camera with X and Y orthogonal and as long as before, on the changed surface. Returns a camera that
/// already fits unchanged, and `None` where the surface is degenerate.
fn settled(surface: &dyn Surface, camera: &ChartCamera) -> Option<ChartCamera> {
    let mut frame = camera.frame().within_domain(surface);
    let metric = frame.metric(surface);
    let length = metric.inner(frame.x, frame.x).sqrt();
    if !(length > 0.0 && length.is_finite()) {
        return None;
    }
    let (x, y) = (frame.x, frame.y);
    let mirrored = frame.x[0] * frame.y[1] - frame.x[1] * frame.y[0] < 0.0;
    let hand = if mirrored { -1.0 } else { 1.0 };
    frame.x = frame.x.map(|a| a / length * camera.zoom);
    frame.y = metric.turn_left(frame.x).map(|a| hand * a);
    let fits = |a: TangentVector, b: TangentVector| {
        let off = metric.inner(a - b, a - b);
        off.sqrt() <= FITS * camera.zoom
    };
    if fits(x, frame.x) && fits(y, frame.y) {
        // A camera that fits stays exactly as it is: rounding again would change it.
        (frame.x, frame.y) = (x, y);
    }
    let settled = ChartCamera::of(&frame, camera.zoom, camera.moved);
    let works = frame.trace(surface, [1.0, 0.0], 0.0, &Options::default());
    (settled.is_sane() && works.is_ok()).then_some(settled)
}

/// Returns the camera after a motion, or `None` if the motion is impossible. A successful motion extends the path.
fn moved(
    manifold: &Manifold,
    camera: ChartCamera,
    motion: Motion,
    path: Option<&mut Arc<CameraPath>>,
) -> Option<ChartCamera> {
    let frame = camera.frame();
    let mut path = path.map(Arc::make_mut);
    let (frame, zoom): (Frame, f64) = match motion {
        Motion::Turn(angle) => (frame.turned(angle), camera.zoom),
        Motion::Zoom(factor) => (frame.zoomed(factor), camera.zoom * factor),
        Motion::Walk(step) => match walk(manifold, &frame, step, path.as_deref_mut()) {
            Ok((frame, trace)) if trace.status == Status::Complete || trace.length > 0.0 => {
                (frame, camera.zoom)
            }
            _ => return None,
        },
    };
    let next = ChartCamera::of(&frame, zoom, true);
    if !next.is_sane() {
        return None;
    }
    if let Some(path) = path {
        path.note(motion);
    }
    Some(next)
}

/// Returns a frame on a solid after a motion, or `None` if the motion is impossible.
fn moved_on_solid(solid: &SolidSurface, frame: &SpaceFrame, motion: Motion) -> Option<SpaceFrame> {
    match motion {
        Motion::Turn(angle) => Some(frame.turned(angle)),
        Motion::Zoom(factor) => Some(frame.zoomed(factor * frame.zoom())),
        Motion::Walk(step) => {
            let walked = frame.advance(solid.surface(), step, &Options::default());
            let (frame, trace) = walked.ok()?;
            (trace.status == Status::Complete || trace.length > 0.0).then_some(frame)
        }
    }
}

/// Moves a frame, and extends its trail.
fn walk(
    manifold: &Manifold,
    frame: &Frame,
    step: [f64; 2],
    path: Option<&mut CameraPath>,
) -> Result<(Frame, Trace), TraceError> {
    match path {
        Some(path) => Arc::make_mut(&mut path.trail).walk(manifold, frame, step),
        None => frame.advance(manifold.surface(), step, &Options::default()),
    }
}

#[cfg(test)]
mod tests {
    use super::{CameraController, Subject};
    use crate::motion::Motion;
    use crate::path::{CameraPath, between};
    use crate::{ChartCamera, InsideCamera, SolidCamera};
    use scene::{ObjectId, ParamValues};
    use std::sync::Arc;

    const SPHERE: &str = "param r : [1, 3];
        surface s(u,v) = r(cos v cos u, cos v sin u, sin v), u : [0, 2pi], v : [-pi/2, pi/2];";

    fn subject(text: &str) -> Subject {
        let scene = scene::geotrace::compile(text).scene.expect("no errors");
        Subject {
            param_values: Arc::new(ParamValues::initial(&scene)),
            scene: Arc::new(scene),
            surface: ObjectId::new(0),
        }
    }

    /// The same surface with another radius.
    fn with_radius(subject: &Subject, radius: f64) -> Subject {
        let mut param_values = (*subject.param_values).clone();
        param_values
            .set(&subject.scene, "r", &[radius])
            .expect("in range");
        Subject {
            param_values: Arc::new(param_values),
            ..subject.clone()
        }
    }

    /// A camera with its controller, and its path where it leaves a trail.
    #[derive(Default)]
    struct Walker {
        controller: CameraController,
        camera: Option<InsideCamera>,
        path: Option<Arc<CameraPath>>,
    }

    impl Walker {
        /// Walks on a surface.
        fn walk(&mut self, subject: &Subject, motions: &[Motion]) -> ChartCamera {
            let walked = self.go(subject, motions);
            *walked.chart().expect("a surface")
        }

        fn go(&mut self, subject: &Subject, motions: &[Motion]) -> InsideCamera {
            let settled = self.controller.settle(subject, self.camera, &mut self.path);
            let mut camera = settled.expect("a place for a camera");
            for motion in motions {
                camera = self.controller.apply(camera, *motion, self.path.as_mut());
            }
            self.camera = Some(camera);
            camera
        }

        /// Begins a path where the camera is.
        fn leave_trail(&mut self, subject: &Subject) {
            let camera = self.walk(subject, &[]);
            self.path = Some(Arc::new(CameraPath::begin(subject.surface, camera)));
        }
    }

    #[test]
    fn a_walk_around_the_sphere_comes_back() {
        let world = subject(SPHERE);
        let mut walker = Walker::default();
        let start = walker.walk(&world, &[Motion::Turn(0.4)]);
        let around = 2.0 * std::f64::consts::PI / start.zoom;
        let step = Motion::Walk([0.0, around / 8.0]);
        let end = walker.walk(&world, &[step; 8]);
        for k in 0..2 {
            assert!(
                (end.at[k] - start.at[k]).abs() < 1e-6,
                "{end:?} is not {start:?}"
            );
            assert!(
                (end.x[k] - start.x[k]).abs() < 1e-6,
                "{end:?} is not {start:?}"
            );
        }
    }

    #[test]
    fn a_path_that_is_walked_again_in_parts_ends_where_it_ended() {
        let world = subject(SPHERE);
        let motions = [
            Motion::Walk([0.3, 0.4]),
            Motion::Turn(0.7),
            Motion::Zoom(1.5),
            Motion::Walk([0.0, -0.6]),
        ];
        let mut walker = Walker::default();
        walker.leave_trail(&world);
        let end = walker.walk(&world, &motions);
        let path = walker.path.clone().expect("a path");
        assert!(path.ends_at(end.at));
        // A walk is as long as its step times the length of X and Y: 1.5 times as long behind the zoom.
        let expected = path.start.zoom * (0.5 + 1.5 * 0.6);
        assert!((path.trail.length - expected).abs() < 1e-9 * expected);
        let mut again = Walker {
            camera: Some(InsideCamera::Chart(path.start)),
            ..Walker::default()
        };
        again.leave_trail(&world);
        for k in 0..5 {
            let shares = [f64::from(k) / 5.0, f64::from(k + 1) / 5.0];
            again.walk(&world, &between(path.motions(), shares));
        }
        let close = |a: [f64; 2], b: [f64; 2]| (0..2).all(|k| (a[k] - b[k]).abs() < 1e-7);
        let walked = again.walk(&world, &[]);
        assert!(
            close(walked.at, end.at) && close(walked.x, end.x) && close(walked.y, end.y),
            "{walked:?} is not {end:?}"
        );
        let length = again.path.expect("a path").trail.length;
        assert!((length - path.trail.length).abs() < 1e-8, "{length}");
    }

    #[test]
    fn a_path_ends_where_its_surface_has_another_shape() {
        let world = subject(SPHERE);
        let mut walker = Walker::default();
        walker.leave_trail(&world);
        walker.walk(&world, &[Motion::Walk([0.3, 0.2])]);
        walker.walk(&subject(SPHERE), &[]);
        assert!(walker.path.is_some(), "the same surface in another scene");
        walker.walk(&with_radius(&world, 2.0), &[]);
        assert!(walker.path.is_none());
    }

    #[test]
    fn a_camera_keeps_its_length_and_its_place_when_a_param_moves() {
        let world = subject(SPHERE);
        let mut walker = Walker::default();
        let before = walker.walk(&world, &[Motion::Walk([0.3, 0.2])]);
        let after = walker.walk(&with_radius(&world, 2.0), &[]);
        assert_eq!(before.at, after.at);
        assert_eq!(before.zoom, after.zoom);
        // Twice the radius: half as long in (u, v), still at right angles.
        for k in 0..2 {
            assert!((after.x[k] - 0.5 * before.x[k]).abs() < 1e-9);
            assert!((after.y[k] - 0.5 * before.y[k]).abs() < 1e-9);
        }
    }

    #[test]
    fn a_camera_that_is_brought_back_fits_the_surface_as_it_is_now() {
        let world = subject(SPHERE);
        let larger = with_radius(&world, 2.0);
        let mut walker = Walker::default();
        let old = walker.walk(&world, &[Motion::Walk([0.3, 0.2])]);
        walker.walk(&larger, &[Motion::Walk([0.1, 0.0])]);
        walker.camera = Some(InsideCamera::Chart(old));
        let after = walker.walk(&larger, &[]);
        assert_eq!(after.at, old.at);
        for k in 0..2 {
            assert!((after.x[k] - 0.5 * old.x[k]).abs() < 1e-9, "{after:?}");
            assert!((after.y[k] - 0.5 * old.y[k]).abs() < 1e-9, "{after:?}");
        }
        // One that fits comes back as it was, to the last digit.
        walker.walk(&larger, &[Motion::Turn(0.1)]);
        walker.camera = Some(InsideCamera::Chart(after));
        assert_eq!(walker.walk(&larger, &[]), after);
    }

    #[test]
    fn a_camera_that_was_not_moved_stands_anew_on_another_surface() {
        let mut walker = Walker::default();
        walker.walk(&subject(SPHERE), &[]);
        let plane = subject("surface s(u,v) = (u,v,0), u : [4, 6], v : [4, 6];");
        let camera = walker.walk(&plane, &[]);
        assert_eq!(camera.at, [5.0, 5.0]);
        walker.walk(&plane, &[Motion::Walk([0.1, 0.0])]);
        let wider = subject("surface s(u,v) = (u,v,0), u : [3, 6], v : [4, 6];");
        let kept = walker.walk(&wider, &[]);
        assert!(
            kept.at[0] > 5.0 && (kept.at[1] - 5.0).abs() < 1e-9,
            "{kept:?}"
        );
    }

    const BALL: &str = "param r : [1, 3]; solid s(x,y,z) = x^2 + y^2 + z^2 - r^2;";

    fn on_solid(camera: InsideCamera) -> SolidCamera {
        match camera {
            InsideCamera::Solid(camera) => camera,
            InsideCamera::Chart(_) => panic!("it is on a chart"),
        }
    }

    #[test]
    fn a_walk_around_a_ball_comes_back() {
        let world = subject(BALL);
        let mut walker = Walker::default();
        let start = on_solid(walker.go(&world, &[Motion::Turn(0.4)]));
        let around = 2.0 * std::f64::consts::PI / start.zoom();
        let step = Motion::Walk([0.0, around / 8.0]);
        let end = on_solid(walker.go(&world, &[step; 8]));
        for k in 0..3 {
            assert!((end.at[k] - start.at[k]).abs() < 1e-6, "{end:?}, {start:?}");
            assert!((end.x[k] - start.x[k]).abs() < 1e-6, "{end:?}, {start:?}");
        }
    }

    #[test]
    fn a_camera_stays_on_a_ball_that_grows() {
        let world = subject(BALL);
        let mut walker = Walker::default();
        let before = on_solid(walker.go(&world, &[Motion::Walk([0.3, 0.2])]));
        assert_eq!(
            on_solid(walker.go(&world, &[])),
            before,
            "to the last digit"
        );
        let after = on_solid(walker.go(&with_radius(&world, 2.0), &[]));
        assert!((after.zoom() - before.zoom()).abs() < 1e-12);
        for k in 0..3 {
            assert!((after.at[k] - 2.0 * before.at[k]).abs() < 1e-9, "{after:?}");
            assert!((after.x[k] - before.x[k]).abs() < 1e-9, "{after:?}");
        }
        // A name that means a surface from now on has no place for it.
        walker.go(&subject(SPHERE), &[]).chart().expect("a surface");
    }
}
