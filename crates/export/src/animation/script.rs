//! Scripts: the changes from one frame of an animation to the next.

use std::f64::consts::TAU;
use std::fmt;
use std::sync::Arc;

use glam::{DQuat, DVec2, DVec3};
use render::bounds::Bounds;
use render::geodesic_view::{PlacedCamera, PlacedSolidCamera};
use render::point::{DrawingPoint, WorldPoint};
use render::trail::Trail;
use render::view::space;
use render::viewpoint::Viewpoint;
use render::{PictureRequest, RenderError};
use scene::{FailedRun, SetError, Shape};

/// The changes of an animation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Script {
    /// Params and grids that change from one value to another.
    pub changes: Vec<ParamChange>,
    /// The distance that the geodesic camera moves along its X axis, backwards if negative. The camera is that of a
    /// geodesic view, or the one that a 3D view shows.
    pub walk: Option<f64>,
    /// Draws the path of the camera.
    pub trail: bool,
    /// Turns the camera of a 3D view once about the vertical line through its target, counterclockwise as seen from above.
    pub turntable: bool,
}

/// The course of an animation between its start and its end.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Course {
    /// From the start to the end; the first frame shows the start and the last one the end.
    #[default]
    Once,
    /// From the start towards the end. The frame after the last one would show the end, so an animation whose start and
    /// end look the same repeats without a pause.
    Loop,
    /// To the end and back. The frame after the last one would show the start.
    BackAndForth,
}

impl Course {
    /// Every course with its name, in the order of a menu.
    pub const ALL: [(Self, &'static str); 3] = [
        (Self::Once, "once"),
        (Self::Loop, "loop"),
        (Self::BackAndForth, "back and forth"),
    ];

    /// Returns the fraction of the animation at frame `frame` of `frames`, counted from 0: from 0 to 1.
    pub fn share(self, frame: u32, frames: u32) -> f64 {
        let of = |count: u32| f64::from(frame) / f64::from(count.max(1));
        match self {
            Self::Once => of(frames.saturating_sub(1)),
            Self::Loop => of(frames),
            Self::BackAndForth => 1.0 - (1.0 - 2.0 * of(frames)).abs(),
        }
    }
}

/// The number of frames whose bounds determine a fixed camera.
const LOOKS: u32 = 9;
/// A walk that is shorter by this fraction is a whole one.
const ROUNDING: f64 = 1e-9;

/// A param or grid that changes from one value to another.
#[derive(Clone, Debug, PartialEq)]
pub struct ParamChange {
    /// Its name.
    pub name: String,
    /// The first value: one number per component.
    pub from: Vec<f64>,
    /// The last value.
    pub to: Vec<f64>,
}

/// The reason why a frame cannot be drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum ScriptError {
    /// A param or grid cannot have that value.
    Set(SetError),
    /// The camera cannot be placed or moved there.
    Camera(RenderError),
    /// The program has errors for the values of its params.
    Run(FailedRun),
}

impl Script {
    /// Returns the request of a frame. `share` is the fraction of the animation that has passed: 0 at its start, 1 at
    /// its end. The script changes nothing else in `request`.
    ///
    /// # Errors
    /// See [`ScriptError`].
    pub fn frame_at(
        &self,
        request: &PictureRequest,
        share: f64,
    ) -> Result<PictureRequest, ScriptError> {
        let frame = self.moved(request, share)?;
        let made = frame.scene.made_anew(&frame.params);
        let scene = made.as_ref().unwrap_or(frame.scene.arc());
        scene.check_run().map_err(ScriptError::Run)?;
        Ok(frame)
    }

    /// As [`Self::frame_at`], also for values for which the program has errors.
    fn moved(&self, request: &PictureRequest, share: f64) -> Result<PictureRequest, ScriptError> {
        let mut request = request.clone();
        for ParamChange { name, from, to } in &self.changes {
            let between = |(from, to): (&f64, &f64)| {
                // Rounding must not change the values at either end.
                if share <= 0.0 {
                    *from
                } else if share >= 1.0 {
                    *to
                } else {
                    let way = to - from;
                    match way.is_finite() {
                        true => from + share * way,
                        false => (1.0 - share) * from + share * to,
                    }
                }
            };
            let values: Vec<f64> = from.iter().zip(to).map(between).collect();
            Arc::make_mut(&mut request.params)
                .set(&request.scene, name, &values)
                .map_err(ScriptError::Set)?;
        }
        if let Some(length) = self.walk {
            self.move_camera(&mut request, share * length)
                .map_err(ScriptError::Camera)?;
        }
        if self.turntable
            && let Some(space) = request.view.space_mut()
            && let (Some(eye), Some(target)) = (space.camera.eye, space.camera.target)
        {
            let [eye, centre] = [eye, target].map(|place| DVec3::from(place.0));
            let turned = centre + DQuat::from_rotation_z(share * TAU) * (eye - centre);
            space.camera.eye = Some(WorldPoint(turned.to_array()));
        }
        Ok(request)
    }

    /// Returns the distance after which the walk ends at an edge, if that is before its end.
    ///
    /// # Errors
    /// See [`ScriptError`].
    pub fn walk_ends_after(&self, request: &PictureRequest) -> Result<Option<f64>, ScriptError> {
        let Some(length) = self.walk else {
            return Ok(None);
        };
        let still = Self {
            walk: None,
            ..self.clone()
        };
        let mut end = still.moved(request, 1.0)?;
        let reached = self.move_camera(&mut end, length);
        let reached = reached.map_err(ScriptError::Camera)?;
        Ok(reached.filter(|reached| *reached < length.abs() * (1.0 - ROUNDING)))
    }

    /// Fixes a camera in space: if the request does not specify one, it is placed so that it sees every frame of the
    /// animation. Other requests are returned unchanged.
    ///
    /// # Errors
    /// See [`ScriptError`].
    pub fn steady(&self, request: &PictureRequest) -> Result<PictureRequest, ScriptError> {
        let mut request = request.clone();
        let Some(camera) = request.view.space().map(|space| space.camera) else {
            return Ok(request);
        };
        let moves = self.turntable || !self.changes.is_empty();
        let is_placed = camera.eye.is_some() && camera.target.is_some();
        if is_placed || !moves || self.follows_declared(&request) {
            return Ok(request);
        }
        let params = Self {
            walk: None,
            turntable: false,
            ..self.clone()
        };
        let plain = PictureRequest {
            trails: Vec::new(),
            ..request.clone()
        };
        let (mut cloud, mut facing) = (Vec::new(), None);
        for step in 0..LOOKS {
            let bounds = space::bounds(&params.moved(&plain, Course::Once.share(step, LOOKS))?);
            facing = facing.or(bounds.facing);
            let places = bounds.cloud.iter();
            cloud.extend(places.map(|&place| bounds.placement.world(DrawingPoint(place)).0));
        }
        if self.turntable {
            turn(&mut cloud);
        }
        let bounds = Bounds {
            facing,
            ..Bounds::around(cloud)
        };
        let projection = camera.projection;
        let camera =
            space::first_camera(&bounds, &camera, &request).map_err(ScriptError::Camera)?;
        let back = camera.axes[2];
        let distance = camera.parallel.map_or(1.0, |parallel| parallel.distance);
        let mut target = camera.eye - back * distance;
        let mut eye = camera.eye;
        if self.turntable && back.truncate() != DVec2::ZERO {
            // Move the target to the axis of the turn, which is the vertical line through the centre of the scene. The
            // size of an orthographic picture is determined by the distance between eye and target.
            let slope = back.truncate();
            target = eye - back * (eye.truncate().dot(slope) / slope.length_squared());
            if camera.parallel.is_some() {
                eye = target + back * distance;
            }
        }
        let [eye, target] =
            [eye, target].map(|place| bounds.placement.world(DrawingPoint(place.to_array())));
        if let Some(space) = request.view.space_mut() {
            space.camera = Viewpoint {
                projection,
                ..Viewpoint::new(eye, target)
            };
        }
        Ok(request)
    }

    /// True if the picture is seen from a camera that the program declares, which in each frame is where its
    /// expressions put it.
    fn follows_declared(&self, request: &PictureRequest) -> bool {
        let mut stage = request.scene.stage.iter();
        let is_free = request
            .view
            .space()
            .is_some_and(|space| space.camera.eye.is_none() && space.camera.target.is_none());
        is_free && !self.turntable && stage.any(|it| matches!(it.shape, Shape::Camera(_)))
    }

    /// Moves the camera; returns the distance for which it moves, which is shorter if it meets an edge; `None` on a solid.
    fn move_camera(
        &self,
        request: &mut PictureRequest,
        length: f64,
    ) -> Result<Option<f64>, RenderError> {
        let Some(camera) = request.view.shown_camera().copied() else {
            return Ok(None);
        };
        camera.check(&request.scene)?;
        if request.scene.is_solid(camera.surface) {
            let (scene, params) = (&request.scene, &request.params);
            let placed = PlacedSolidCamera::new(scene, params, &camera, request.size)?;
            let moved = placed.walked([length / placed.frame.zoom(), 0.0])?;
            request.view.show_camera(moved);
            return Ok(None);
        }
        let placed = PlacedCamera::new(&request.scene, &request.params, &camera, request.size)?;
        let start = placed.frame;
        let mut trail = Trail::new(camera.surface, start.uv.0);
        let (moved, trace) = trail
            .walk(placed.manifold(), &start, [length / placed.zoom, 0.0])
            .map_err(RenderError::cannot_walk)?;
        RenderError::check_walk(trace.status, trace.length)?;
        // Rounding may lead beyond an edge, where no camera can be.
        let moved = moved.within_domain(placed.manifold().surface());
        request.view.show_camera(camera.with_frame(moved));
        if self.trail {
            request.trails.push(trail.into());
        }
        Ok(Some(trace.length))
    }
}

/// Adds the points that a full turn about the vertical line through the cloud's centre maps its points to.
fn turn(cloud: &mut Vec<[f64; 3]>) {
    let Some(first) = cloud.first().map(|place| DVec3::from(*place)) else {
        return;
    };
    let ends = cloud.iter().fold([first; 2], |[lower, upper], place| {
        let place = DVec3::from(*place);
        [lower.min(place), upper.max(place)]
    });
    let middle = 0.5 * (ends[0] + ends[1]);
    let before = cloud.len();
    for step in 1..LOOKS {
        let rotation = DQuat::from_rotation_z(TAU * Course::Loop.share(step, LOOKS));
        for index in 0..before {
            let place = middle + rotation * (DVec3::from(cloud[index]) - middle);
            cloud.push(place.to_array());
        }
    }
}

impl fmt::Display for ScriptError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Set(error) => write!(f, "{error}"),
            Self::Camera(error) => write!(f, "{error}"),
            Self::Run(error) => write!(f, "{error}"),
        }
    }
}

impl std::error::Error for ScriptError {}
