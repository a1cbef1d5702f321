//! Where a geodesic camera is: it is moved where its pictures are drawn, so that no motion is lost or made twice.

use std::sync::Arc;

use geodesic::frame::Frame;
use geodesic::surface::Surface;
use geodesic::trace::{Options, Status, Trace, TraceError};
use geometry::{Manifold, ManifoldError};
use render::geodesic_view::Inside;
use render::overlay::Trail;
use render::{RenderError, Request};
use scene::ParamValues;
use scene::{ObjectId, Scene};

use crate::state::InsideCamera;
use crate::state::motion::Motion;
use crate::state::path::CameraPath;

/// A camera on its surface.
#[derive(Debug, Default)]
pub(crate) struct CameraController {
    /// The count of placings that it has heeded.
    placed: Option<u64>,
    camera: Option<InsideCamera>,
    stand: Option<Stand>,
    /// The number of the trail that is left, and the way since it began; nothing where none is wanted.
    trail: Option<u64>,
    walked: Option<Arc<CameraPath>>,
}

/// What the camera stands on.
#[derive(Debug)]
struct Stand {
    scene: Arc<Scene>,
    settings: Arc<ParamValues>,
    surface: ObjectId,
    ground: Manifold,
}

/// What is asked of a pilot.
#[derive(Debug)]
pub(crate) struct Flight<'a> {
    pub(crate) scene: &'a Arc<Scene>,
    pub(crate) settings: &'a Arc<ParamValues>,
    pub(crate) surface: ObjectId,
    /// Counts placings; where it has changed, `camera` is taken over.
    pub(crate) placed: u64,
    pub(crate) camera: Option<InsideCamera>,
    pub(crate) motions: &'a [Motion],
    /// The way that leads to `camera`, if there is one: taken over with it.
    pub(crate) way: Option<&'a Arc<CameraPath>>,
    /// The number of the trail that is to be left, if one is: another number begins another trail.
    pub(crate) trail: Option<u64>,
}

impl CameraController {
    /// Carries out motions, on the surface as it is now; where the camera is then.
    ///
    /// # Errors
    /// [`RenderError`] where there is no place to stand.
    pub(crate) fn fly(&mut self, flight: &Flight<'_>) -> Result<InsideCamera, RenderError> {
        let placed = self.placed.replace(flight.placed) != Some(flight.placed);
        if placed {
            self.camera = flight.camera;
            self.walked = flight.way.cloned();
        }
        if self.trail != flight.trail {
            self.trail = flight.trail;
            self.walked = None;
        }
        let changed = match self.step_on(flight)? {
            // One that was put somewhere may be of another time, and not fit the surface as it is.
            Changed::Nothing if placed => Changed::Values,
            changed => changed,
        };
        let Some(stand) = &self.stand else {
            return Err(ManifoldError::NoSurface { name: None }.into());
        };
        let surface = stand.ground.surface();
        let mut camera = match self.camera {
            Some(camera) if changed == Changed::Scene && !camera.moved => first(flight)?,
            Some(camera) if changed != Changed::Nothing => match settled(surface, &camera) {
                Some(camera) => camera,
                None => first(flight)?,
            },
            Some(camera) => camera,
            None => first(flight)?,
        };
        let mut way = self.trail.map(|_| {
            let begun = self.walked.take().filter(|way| way.ends_at(camera.at));
            begun.unwrap_or_else(|| {
                Arc::new(CameraPath::new(
                    Trail::new(flight.surface, camera.at),
                    camera,
                ))
            })
        });
        if let Some(way) = &mut way
            && way.trail.surface != flight.surface
        {
            // Other declarations stand above its own now.
            Arc::make_mut(&mut Arc::make_mut(way).trail).surface = flight.surface;
        }
        for motion in flight.motions {
            camera = moved(&stand.ground, camera, *motion, way.as_mut());
        }
        self.walked = way;
        self.camera = Some(camera);
        Ok(camera)
    }

    /// The number of the trail that is left, if one is.
    pub(crate) fn trail(&self) -> Option<u64> {
        self.trail
    }

    /// The way since the trail began, if one is left.
    pub(crate) fn walked(&self) -> Option<&Arc<CameraPath>> {
        self.walked.as_ref()
    }

    /// Where the camera is.
    pub(crate) fn camera(&self) -> Option<InsideCamera> {
        self.camera
    }

    fn step_on(&mut self, flight: &Flight<'_>) -> Result<Changed, RenderError> {
        let (same_scene, same_settings) = self.stand.as_ref().map_or((false, false), |stand| {
            (
                Arc::ptr_eq(&stand.scene, flight.scene) && stand.surface == flight.surface,
                stand.settings == *flight.settings,
            )
        });
        if same_scene && same_settings {
            return Ok(Changed::Nothing);
        }
        let objects = &flight.scene.objects;
        let Some(object) = objects.get(flight.surface.0 as usize) else {
            return Err(ManifoldError::NoSurface { name: None }.into());
        };
        let uniforms = flight.settings.first_instance(flight.scene, object);
        let ground = Manifold::new(flight.scene, flight.surface, &uniforms)?;
        let first = self.stand.is_none();
        if let (Some(stand), Some(walked)) = (&self.stand, &self.walked)
            && !walked.fits(stand.ground.surface(), ground.surface())
        {
            // It is no geodesic's path any more, and has another length.
            self.walked = None;
        }
        self.stand = Some(Stand {
            scene: Arc::clone(flight.scene),
            settings: Arc::clone(flight.settings),
            surface: flight.surface,
            ground,
        });
        Ok(match (first, same_scene) {
            // What was remembered is where the user left it.
            (true, _) => Changed::Values,
            (false, true) => Changed::Values,
            (false, false) => Changed::Scene,
        })
    }
}

/// The share of their length by which X and Y may miss what they should be: what rounding leaves of a long walk.
const FITS: f64 = 1e-9;

/// What has changed under a camera.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Changed {
    Nothing,
    Values,
    Scene,
}

/// The camera's first place on a surface.
fn first(flight: &Flight<'_>) -> Result<InsideCamera, RenderError> {
    let request = Request::geodesic(flight.surface, [256, 256]);
    let inside = Inside::new(flight.scene, flight.settings, &request)?;
    Ok(InsideCamera::of(&inside.frame, inside.zoom, false))
}

/// The camera with X and Y orthogonal and as long as before, on a surface that has changed; as it is where they are so
/// already, and none where it cannot stand there.
fn settled(surface: &dyn Surface, camera: &InsideCamera) -> Option<InsideCamera> {
    let mut frame = camera.frame();
    for (at, [low, high]) in frame.uv.iter_mut().zip(surface.domain()) {
        *at = at.clamp(low, high);
    }
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
    let fits = |a: [f64; 2], b: [f64; 2]| {
        let off = metric.inner([a[0] - b[0], a[1] - b[1]], [a[0] - b[0], a[1] - b[1]]);
        off.sqrt() <= FITS * camera.zoom
    };
    if fits(x, frame.x) && fits(y, frame.y) {
        // Rounded once more, it would be another one.
        (frame.x, frame.y) = (x, y);
    }
    let settled = InsideCamera::of(&frame, camera.zoom, camera.moved);
    let works = frame.trace(surface, [1.0, 0.0], 0.0, &Options::default());
    (settled.is_sane() && works.is_ok()).then_some(settled)
}

/// The camera after a motion; where it cannot be made, as it was. What was made is noted in the way.
fn moved(
    ground: &Manifold,
    camera: InsideCamera,
    motion: Motion,
    way: Option<&mut Arc<CameraPath>>,
) -> InsideCamera {
    let frame = camera.frame();
    let mut way = way.map(Arc::make_mut);
    let (frame, zoom): (Frame, f64) = match motion {
        Motion::Turn(angle) => (frame.turned(angle), camera.zoom),
        Motion::Zoom(factor) => (frame.zoomed(factor), camera.zoom * factor),
        Motion::Walk(step) => match walk(ground, &frame, step, way.as_deref_mut()) {
            Ok((frame, trace)) if trace.status == Status::Complete || trace.length > 0.0 => {
                (frame, camera.zoom)
            }
            _ => return camera,
        },
    };
    let next = InsideCamera::of(&frame, zoom, true);
    if !next.is_sane() {
        return camera;
    }
    if let Some(way) = way {
        way.note(motion);
    }
    next
}

/// Moves a frame, and draws its trail where one is left.
fn walk(
    ground: &Manifold,
    frame: &Frame,
    step: [f64; 2],
    way: Option<&mut CameraPath>,
) -> Result<(Frame, Trace), TraceError> {
    match way {
        Some(way) => Arc::make_mut(&mut way.trail).walk(ground, frame, step),
        None => frame.advance(ground.surface(), step, &Options::default()),
    }
}

#[cfg(test)]
mod tests {
    use super::{CameraController, Flight};
    use crate::state::motion::Motion;
    use crate::state::path::between;
    use scene::ParamValues;
    use scene::{ObjectId, Scene};
    use std::sync::Arc;

    const SPHERE: &str = "param r : [1, 3];
        surface s(u,v) = r(cos v cos u, cos v sin u, sin v), u : [0, 2pi], v : [-pi/2, pi/2];";

    fn scene(text: &str) -> (Arc<Scene>, Arc<ParamValues>) {
        let scene = scene::geotrace::compile(text).scene.expect("no errors");
        let settings = ParamValues::initial(&scene);
        (Arc::new(scene), Arc::new(settings))
    }

    fn flight<'a>(
        (scene, settings): &'a (Arc<Scene>, Arc<ParamValues>),
        motions: &'a [Motion],
        trail: Option<u64>,
    ) -> Flight<'a> {
        Flight {
            scene,
            settings,
            surface: ObjectId(0),
            placed: 0,
            camera: None,
            way: None,
            motions,
            trail,
        }
    }

    fn fly(
        pilot: &mut CameraController,
        world: &(Arc<Scene>, Arc<ParamValues>),
        motions: &[Motion],
    ) -> crate::state::InsideCamera {
        let flight = flight(world, motions, None);
        pilot.fly(&flight).expect("a place to stand")
    }

    #[test]
    fn a_walk_around_the_sphere_comes_back() {
        let world = scene(SPHERE);
        let mut pilot = CameraController::default();
        let start = fly(&mut pilot, &world, &[Motion::Turn(0.4)]);
        let around = 2.0 * std::f64::consts::PI / start.zoom;
        let step = Motion::Walk([0.0, around / 8.0]);
        let end = fly(&mut pilot, &world, &[step; 8]);
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
    fn a_way_that_is_walked_again_in_parts_ends_where_it_ended() {
        let world = scene(SPHERE);
        let motions = [
            Motion::Walk([0.3, 0.4]),
            Motion::Turn(0.7),
            Motion::Zoom(1.5),
            Motion::Walk([0.0, -0.6]),
        ];
        let mut pilot = CameraController::default();
        let end = pilot
            .fly(&flight(&world, &motions, Some(0)))
            .expect("a place to stand");
        let way = pilot.walked().expect("a trail").clone();
        // A walk is as long as its step times the length of X and Y: 1.5 times as long behind the zoom.
        let expected = way.start.zoom * (0.5 + 1.5 * 0.6);
        assert!((way.trail.length - expected).abs() < 1e-9 * expected);
        let mut again = CameraController::default();
        let mut flown = end;
        for k in 0..5 {
            let shares = [f64::from(k) / 5.0, f64::from(k + 1) / 5.0];
            let parts = between(way.motions(), shares);
            let flight = Flight {
                camera: Some(way.start),
                ..flight(&world, &parts, Some(0))
            };
            flown = again.fly(&flight).expect("a place to stand");
        }
        let close = |a: [f64; 2], b: [f64; 2]| (0..2).all(|k| (a[k] - b[k]).abs() < 1e-7);
        assert!(
            close(flown.at, end.at) && close(flown.x, end.x) && close(flown.y, end.y),
            "{flown:?} is not {end:?}"
        );
        let length = again.walked().expect("a trail").trail.length;
        assert!((length - way.trail.length).abs() < 1e-8, "{length}");
        // Without a trail nothing is kept.
        let mut pilot = CameraController::default();
        fly(&mut pilot, &world, &motions);
        assert!(pilot.walked().is_none());
    }

    #[test]
    fn a_camera_keeps_its_length_and_its_place_when_a_param_moves() {
        let (scene, settings) = scene(SPHERE);
        let mut pilot = CameraController::default();
        let before = fly(
            &mut pilot,
            &(scene.clone(), settings.clone()),
            &[Motion::Walk([0.3, 0.2])],
        );
        let mut larger = (*settings).clone();
        larger.set(&scene, "r", &[2.0]).expect("in range");
        let after = fly(&mut pilot, &(scene, Arc::new(larger)), &[]);
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
        let (scene, settings) = scene(SPHERE);
        let mut pilot = CameraController::default();
        let old = fly(
            &mut pilot,
            &(scene.clone(), settings.clone()),
            &[Motion::Walk([0.3, 0.2])],
        );
        let mut larger = (*settings).clone();
        larger.set(&scene, "r", &[2.0]).expect("in range");
        let world = (scene, Arc::new(larger));
        fly(&mut pilot, &world, &[Motion::Walk([0.1, 0.0])]);
        let back = |pilot: &mut CameraController, placed, camera| {
            let flight = Flight {
                placed,
                camera: Some(camera),
                ..flight(&world, &[], None)
            };
            pilot.fly(&flight).expect("a place to stand")
        };
        let after = back(&mut pilot, 1, old);
        assert_eq!(after.at, old.at);
        for k in 0..2 {
            assert!((after.x[k] - 0.5 * old.x[k]).abs() < 1e-9, "{after:?}");
            assert!((after.y[k] - 0.5 * old.y[k]).abs() < 1e-9, "{after:?}");
        }
        // One that fits comes back as it was, to the last digit.
        assert_eq!(back(&mut pilot, 2, after), after);
    }

    #[test]
    fn a_camera_that_was_not_moved_stands_anew_on_another_surface() {
        let mut pilot = CameraController::default();
        fly(&mut pilot, &scene(SPHERE), &[]);
        let plane = scene("surface s(u,v) = (u,v,0), u : [4, 6], v : [4, 6];");
        let camera = fly(&mut pilot, &plane, &[]);
        assert_eq!(camera.at, [5.0, 5.0]);
        fly(&mut pilot, &plane, &[Motion::Walk([0.1, 0.0])]);
        let wider = scene("surface s(u,v) = (u,v,0), u : [3, 6], v : [4, 6];");
        let kept = fly(&mut pilot, &wider, &[]);
        assert!(
            kept.at[0] > 5.0 && (kept.at[1] - 5.0).abs() < 1e-9,
            "{kept:?}"
        );
    }
}
