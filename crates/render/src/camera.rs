//! The camera of the 3D view, and its initial position.
//!
//! Spaces: *world* (the scene's units, f64), *drawing units* ([`Placement`]), *view* (x right, y up, z towards the eye; the
//! eye at 0), *clip* (greater depth is nearer), pixels. The depth of a perspective camera is `near / w`: 1 at the near
//! plane, 0 at infinity. The w of an orthographic camera is constant, the distance of its target's plane, and its depth is
//! linear: 1/2 in that plane.

use glam::{DMat4, DVec3, Mat4};
use tracer::camera::LensCamera;

use crate::bounds::{Bounds, flat_axis};
use crate::error::RenderError;
use crate::placement::Placement;
use crate::point::{DrawingPoint, PixelPoint, WorldPoint};
use crate::style;
use crate::viewpoint::{Projection, Viewpoint};

/// A camera without a far plane. Positions are in drawing units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The drawing units.
    pub placement: Placement,
    /// Its position.
    pub eye: DVec3,
    /// Unit vectors: right, up, back (towards the eye) in the scene.
    pub axes: [DVec3; 3],
    /// The distance of the near plane.
    pub near: f64,
    /// The picture in pixels.
    pub size: [u32; 2],
    /// The projection of an orthographic camera; `None` for a perspective one.
    pub parallel: Option<Parallel>,
    /// The vertical field of view in radians; [`style::FIELD_OF_VIEW`] along the shorter side if not given.
    pub opening: Option<f64>,
}

/// The projection of an orthographic camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parallel {
    /// The distance from the eye to the plane of the target, in which lengths are as large as in perspective.
    pub distance: f64,
    /// The depth that is drawn on either side of that plane.
    pub reach: f64,
}

/// The number of steps back that bring labels into the picture; their size is in pixels.
const STEPS_BACK: usize = 4;

/// The depth range of an orthographic camera, as a multiple of that of the scene's points: samples may be beyond them.
const REACH: f64 = 8.0;

/// Returns true if this unit vector points straight up or down.
pub fn is_vertical(direction: DVec3) -> bool {
    direction.x.hypot(direction.y) < 1e-6
}

/// Returns the unit vectors to the right, up, and towards the eye, `back`, of a picture without a roll: z points up; straight
/// from above or below, y points up.
pub fn upright(back: DVec3) -> [DVec3; 3] {
    let up = if is_vertical(back) {
        DVec3::Y
    } else {
        DVec3::Z
    };
    let right = up.cross(back).normalize();
    [right, back.cross(right), back]
}

impl Camera {
    /// Creates a camera that shows the whole scene, or one with the eye and target of a viewpoint.
    ///
    /// By default it looks from azimuth [`style::AZIMUTH`] and elevation [`style::ELEVATION`], from the smallest distance at
    /// which the scene's points fit, or from another side if the centre of a closed surface's domain is more visible from
    /// there. A scene in a coordinate plane is seen face on.
    ///
    /// # Errors
    /// [`RenderError::Camera`] if eye and target coincide at the scene's size.
    pub fn new(
        bounds: &Bounds,
        viewpoint: &Viewpoint,
        size: [u32; 2],
    ) -> Result<Self, RenderError> {
        let Viewpoint {
            eye,
            target,
            projection,
        } = *viewpoint;
        let placement = bounds.placement;
        let local = |place: WorldPoint| DVec3::from(placement.local(place).0);
        let mut camera = Self {
            placement,
            eye: DVec3::ZERO,
            axes: [DVec3::X, DVec3::Y, DVec3::Z],
            near: 1e-3,
            size,
            parallel: (projection == Projection::Orthographic).then_some(Parallel {
                distance: 1.0,
                reach: 1.0,
            }),
            opening: None,
        };
        let back = match (eye, target) {
            // In the scene's units, which a large scene takes no digits from.
            (Some(eye), Some(target)) => {
                (DVec3::from(eye.0) - DVec3::from(target.0)) / placement.radius
            }
            (Some(eye), None) => local(eye),
            (None, _) => first_direction(bounds),
        };
        let distance = back.length();
        if !distance.is_finite() {
            let sentence = "the camera is too far from its target";
            return Err(RenderError::Camera(sentence.to_owned()));
        }
        // Without a target it is the scene's centre, which is exact to rounding.
        if distance <= if target.is_some() { 0.0 } else { 1e-9 } {
            let sentence = "the camera is at its target and has no direction";
            return Err(RenderError::Camera(sentence.to_owned()));
        }
        camera.look(back / distance);
        match eye {
            Some(eye) => {
                camera.eye = local(eye);
                camera.put_plane(distance);
            }
            None => camera.frame(bounds, &[], target.map(local)),
        }
        camera.keep_clear_of(&bounds.cloud);
        Ok(camera)
    }

    /// Steps back until points beside the scene, which depend on the camera's position, are visible too. Cameras with a
    /// given position do not move.
    #[must_use]
    pub(crate) fn with_room_for(
        mut self,
        bounds: &Bounds,
        viewpoint: &Viewpoint,
        places: impl Fn(&Self) -> Vec<DVec3>,
    ) -> Self {
        if viewpoint.eye.is_some() {
            return self;
        }
        let target = viewpoint.target;
        let target = target.map(|place| DVec3::from(self.placement.local(place).0));
        for _ in 0..STEPS_BACK {
            let beside = places(&self);
            self.frame(bounds, &beside, target);
        }
        self.keep_clear_of(&bounds.cloud);
        self
    }

    /// Sets the distance of the plane of an orthographic camera's target.
    fn put_plane(&mut self, distance: f64) {
        if let Some(parallel) = &mut self.parallel {
            parallel.distance = distance;
        }
    }

    /// Moves the near plane half the distance to the nearest of the points, which are in drawing units. An orthographic
    /// camera has no near plane; its depth range becomes that of the points.
    pub(crate) fn keep_clear_of(&mut self, cloud: &[[f64; 3]]) {
        if let Some(parallel) = &mut self.parallel {
            let plane = self.axes[2].dot(self.eye) - parallel.distance;
            let depths = cloud.iter();
            let depths = depths.map(|&p| (self.axes[2].dot(DVec3::from(p)) - plane).abs());
            parallel.reach = REACH * depths.fold(1.0, f64::max);
            self.near = 1e-3 * parallel.distance;
            return;
        }
        let reach = cloud
            .iter()
            .map(|&p| self.axes[2].dot(self.eye - DVec3::from(p)));
        let nearest = reach.fold(f64::INFINITY, f64::min);
        let far = self.eye.length() + 1.0;
        // Limit the ratio of distances, so that f32 depths still separate surfaces.
        self.near = if nearest.is_finite() {
            (0.5 * nearest).clamp(1e-4 * far, far)
        } else {
            1e-3 * far
        };
    }

    /// Returns the matrix from drawing units to view space.
    pub(crate) fn view_from_world(&self) -> Mat4 {
        self.view().as_mat4()
    }

    /// Returns the position in the picture of a point in drawing units, in pixels; `None` if the point is behind the eye.
    pub fn pixel_of(&self, place: DrawingPoint) -> Option<PixelPoint> {
        let at = self.view().transform_point3(DVec3::from(place.0));
        let w = self.parallel.map_or(-at.z, |parallel| parallel.distance);
        if w <= 1e-9 {
            return None;
        }
        let [x, y] = self.half_tangents();
        let [width, height] = self.size.map(f64::from);
        Some(PixelPoint([
            0.5 * width * (1.0 + at.x / (w * x)),
            0.5 * height * (1.0 - at.y / (w * y)),
        ]))
    }

    /// Returns true if a point in drawing units is inside the picture.
    pub(crate) fn sees(&self, place: DrawingPoint) -> bool {
        let pixel = self.pixel_of(place);
        let [width, height] = self.size.map(f64::from);
        pixel.is_some_and(|PixelPoint([x, y])| {
            (0.0..=width).contains(&x) && (0.0..=height).contains(&y)
        })
    }

    /// Returns the depth in clip space of a point in drawing units; 1 if it is in front of the near plane or behind the eye.
    pub(crate) fn depth_of(&self, place: DrawingPoint) -> f32 {
        let at = self.view().transform_point3(DVec3::from(place.0));
        let depth = match self.parallel {
            None if -at.z > self.near => self.near / -at.z,
            None => 1.0,
            Some(parallel) => 0.5 + 0.5 * (at.z + parallel.distance) / parallel.reach,
        };
        depth as f32
    }

    /// Returns the tangents of half the field of view, horizontally and vertically.
    pub fn half_tangents(&self) -> [f64; 2] {
        let (opening, side) = match self.opening {
            Some(opening) => (opening, self.size[1]),
            None => (style::FIELD_OF_VIEW, self.size[0].min(self.size[1])),
        };
        let tangent = (0.5 * opening).tan();
        self.size
            .map(|other| tangent * f64::from(other) / f64::from(side))
    }

    /// Returns the number of pixels of one drawing unit at distance 1 along the view direction; at distance w it is 1/w of
    /// this.
    pub fn pixels_per_unit(&self) -> f32 {
        (f64::from(self.size[0]) / (2.0 * self.half_tangents()[0])) as f32
    }

    fn view(&self) -> DMat4 {
        let [right, up, back] = self.axes;
        let rows = DMat4::from_cols(
            right.extend(0.0),
            up.extend(0.0),
            back.extend(0.0),
            glam::DVec4::W,
        );
        rows.transpose() * DMat4::from_translation(-self.eye)
    }

    /// Turns the camera so that `back` points towards the eye, without a roll.
    fn look(&mut self, back: DVec3) {
        self.axes = upright(back);
    }

    /// Turns about its view direction, so that up is where it is for a lens that looks in the same direction.
    pub(crate) fn turn_as(&mut self, lens: &LensCamera) {
        let back = self.axes[2];
        let lens = LensCamera {
            direction: -back,
            ..*lens
        };
        let [right, up, _] = lens.axes();
        self.axes = [right, up, back];
    }

    /// Steps back until all points fit, those of the scene and those `beside` it, and aside until they are centred unless
    /// there is a target.
    ///
    /// A point at (x, y, z) in the camera's axes is inside the picture if |x − cx| ≤ (d − z)·tx: with A = max(x + z·tx) and
    /// B = max(−x + z·tx), d·tx ≥ A − cx and d·tx ≥ B + cx.
    fn frame(&mut self, bounds: &Bounds, beside: &[DVec3], target: Option<DVec3>) {
        let tangents = self.half_tangents().map(|t| t * (1.0 - style::MARGIN));
        // Parallel lines of sight do not diverge behind the target.
        let opening = tangents.map(|t| if self.parallel.is_some() { 0.0 } else { t });
        let origin = target.unwrap_or(DVec3::ZERO);
        let mut most = [[f64::NEG_INFINITY; 2]; 2];
        let mut front = f64::NEG_INFINITY;
        let corners = box_corners(bounds.half);
        let cloud: &[[f64; 3]] = if bounds.cloud.is_empty() {
            &corners
        } else {
            &bounds.cloud
        };
        for place in cloud
            .iter()
            .copied()
            .map(DVec3::from)
            .chain(beside.iter().copied())
        {
            let p = place - origin;
            let z = p.dot(self.axes[2]);
            front = front.max(z);
            for k in 0..2 {
                let x = p.dot(self.axes[k]);
                most[k][0] = most[k][0].max(x + z * opening[k]);
                most[k][1] = most[k][1].max(z * opening[k] - x);
            }
        }
        let mut distance = front + 0.2;
        let mut shift = [0.0; 2];
        for k in 0..2 {
            let [a, b] = most[k];
            if target.is_none() {
                shift[k] = 0.5 * (a - b);
            }
            distance = distance.max((a - shift[k]).max(b + shift[k]) / tangents[k]);
        }
        // Without this limit, the eye would be inside the disc of a single point.
        let distance = distance.max(0.5);
        self.put_plane(distance);
        self.eye =
            origin + self.axes[0] * shift[0] + self.axes[1] * shift[1] + self.axes[2] * distance;
    }
}

/// Returns the direction from the scene to the camera's initial position: that of [`style::AZIMUTH`], or one of the three at
/// right angles to it, whichever shows most of the centre of a closed surface's domain.
fn first_direction(bounds: &Bounds) -> DVec3 {
    match flat_axis(bounds.half) {
        Some(2) => DVec3::Z,
        Some(1) => DVec3::NEG_Y,
        Some(_) => DVec3::X,
        None => {
            let (azimuth_sin, azimuth_cos) = style::AZIMUTH.sin_cos();
            let (elevation_sin, elevation_cos) = style::ELEVATION.sin_cos();
            let mut direction = DVec3::new(
                elevation_cos * azimuth_cos,
                elevation_cos * azimuth_sin,
                elevation_sin,
            );
            let facing = bounds.facing.map_or(DVec3::ZERO, DVec3::from);
            let mut best = direction;
            for _ in 0..3 {
                direction = DVec3::new(-direction.y, direction.x, direction.z);
                if direction.dot(facing) > best.dot(facing) + 1e-9 {
                    best = direction;
                }
            }
            best
        }
    }
}

fn box_corners(half: [f64; 3]) -> [[f64; 3]; 8] {
    std::array::from_fn(|corner| {
        std::array::from_fn(|k| {
            if corner >> k & 1 == 0 {
                -half[k]
            } else {
                half[k]
            }
        })
    })
}
