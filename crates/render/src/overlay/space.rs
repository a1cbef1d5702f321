//! A geodesic camera in the 3D view: its frame as arrows, and geodesics of its picture as curves on its surface or solid; and the
//! trails that cameras have walked.

use std::sync::Arc;

use geodesic::trace::{Options, Status};
use geometry::{GeodesicStart, Knot, MAX_LINE_EVALUATIONS, knots_at};
use rayon::prelude::*;
use scene::{ObjectId, Scene};

use super::ink::Inks;
use super::legend::Legend;
use crate::camera::Camera;
use crate::error::RenderError;
use crate::geodesic_view::{PlacedCamera, PlacedSolidCamera, Positions};
use crate::placement::Placement;
use crate::point::DrawingPoint;
use crate::request::PictureRequest;
use crate::sample::{Painter, Samples, line_samples, vector};
use crate::style::{self, LineStyle, Look, Theme};
use crate::trail::SpaceTrail;
use crate::viewpoint::GeodesicCamera;

/// Something to be drawn in space that is no object of the scene.
#[derive(Clone, Debug)]
pub(crate) struct OverlayObject {
    /// The owner's name: the camera, a trail.
    pub(crate) name: &'static str,
    /// The painter that draws it.
    pub(crate) painter: Painter,
    /// Its samples.
    pub(crate) samples: Arc<Samples>,
    /// Its colour in linear light.
    pub(crate) colour: [f32; 3],
    /// The look of its lines.
    pub(crate) line: LineStyle,
    /// A letter, beside a place.
    pub(crate) letter: Option<(char, DrawingPoint)>,
}

impl OverlayObject {
    /// Its look in a picture whose lines are `scale` times as wide as usual.
    pub(crate) fn look(&self, scale: f32) -> Look {
        Look {
            colours: Arc::from([self.colour]),
            emphasis: 0.0,
            line: LineStyle {
                width: scale * self.line.width,
                ..self.line
            },
        }
    }
}

/// Declared lines are seen over those of a camera where they coincide, and these over each other in this order.
const fn under(lift: f32) -> LineStyle {
    LineStyle { width: 1.0, lift }
}

const WAVES: LineStyle = under(-0.6);
const CAMERA_AXES: LineStyle = under(-0.45);
const BORDERS: LineStyle = under(-0.3);
const CONJUGATES: LineStyle = under(-0.15);
const TRAILS: LineStyle = under(-0.2);
/// The mark at a point on paper is a small ring: lines without light fill it unless they are thin.
const MARKS_ON_PAPER: LineStyle = LineStyle {
    width: 0.4,
    ..TRAILS
};
const FRAME: LineStyle = under(0.0);

/// Points of a line of the picture.
const POINTS: u32 = 64;
/// Directions in which wavefronts and conjugate points are looked for.
const DIRECTIONS: u32 = 180;
/// The most wavefronts.
const MOST_WAVES: f64 = 64.0;
/// Arrows are no longer than this share of the scene's radius.
const LONGEST_ARROW: f64 = 0.5;
/// The distance between the points that determine a direction, as a share of the zoom.
const NUDGE: f64 = 1e-4;

/// Returns the objects that show a request's trails.
pub(crate) fn trail_objects(request: &PictureRequest, placement: &Placement) -> Vec<OverlayObject> {
    let lines = request.trails.iter().filter_map(|trail| {
        let trail_in_space = crate::trail::in_space(&request.scene, &request.params, trail)?;
        Some((&trail.kind, trail_in_space))
    });
    lines
        .filter(|(_, trail)| trail.line.len() > 1)
        .map(|(kind, SpaceTrail { line, mark })| OverlayObject {
            name: kind.name(),
            painter: Painter::Curves,
            samples: line_samples(placement, line.len() as u32, &[line]).into(),
            colour: style::linear(Inks::of(request.theme).trail(kind)),
            line: match (request.theme, &mark) {
                (Theme::Print, Some(_)) => MARKS_ON_PAPER,
                _ => TRAILS,
            },
            letter: mark.map(|(letter, place)| (letter, placement.local(place))),
        })
        .collect()
}

/// A geodesic camera that a picture shows, with the objects that show it.
pub(crate) struct KeyedCamera<'a> {
    pub(crate) camera: &'a GeodesicCamera,
    /// The camera of the picture.
    pub(crate) view: &'a Camera,
    /// The objects, among others.
    pub(crate) objects: &'a [OverlayObject],
}

impl KeyedCamera<'_> {
    /// Returns true if curves of this colour are in the picture.
    fn has_curves(&self, colour: [u8; 3]) -> bool {
        let colour = style::linear(colour);
        let mut curves = self.objects.iter().filter(|it| it.colour == colour);
        curves.any(|it| match &*it.samples {
            Samples::Curves { samples, .. } => samples.iter().any(|sample| {
                let place = DrawingPoint(sample.position.map(f64::from));
                sample.defined > 0.0 && self.view.sees(place)
            }),
            _ => false,
        })
    }
}

/// Adds the lines of the key for a camera that is shown; of curves, those that are in the picture.
///
/// # Errors
/// Those of the camera.
pub(super) fn key(
    key: &mut Legend,
    request: &PictureRequest,
    keyed: &KeyedCamera<'_>,
) -> Result<(), RenderError> {
    let camera = keyed.camera;
    if !is_shown(&request.scene, camera.surface) {
        return Ok(());
    }
    let inks = Inks::of(request.theme);
    let [right, up] = inks.axes;
    key.line(right, "camera: right (X)");
    key.line(up, "camera: up (Y)");
    if keyed.has_curves(inks.border) {
        key.line(inks.border, "edge of its geodesic view");
    }
    if request.scene.is_solid(camera.surface) {
        return Ok(());
    }
    if let Some(spacing) = request.overlays.wavefronts
        && keyed.has_curves(inks.wave)
    {
        let spacing = spacing.distance(place(request, camera)?.zoom);
        key.line(inks.wave, &super::wave_words(spacing));
    }
    if request.overlays.conjugate_points && keyed.has_curves(inks.conjugate) {
        key.line(inks.conjugate, "conjugate points");
    }
    Ok(())
}

/// The error allowed at the places of curves, in pixels of the camera's picture.
const TOLERANCE: f64 = 0.02;

/// Returns the objects that show a geodesic camera: its frame as arrows, geodesics of its picture as curves.
///
/// # Errors
/// Those of the camera.
pub(crate) fn camera_objects(
    request: &PictureRequest,
    camera: &GeodesicCamera,
    placement: &Placement,
) -> Result<Vec<OverlayObject>, RenderError> {
    if request.scene.is_solid(camera.surface) {
        return solid_camera_objects(request, camera, placement);
    }
    let placed = place(request, camera)?;
    if !placed.manifold().surface().is_embedded() {
        return Ok(Vec::new());
    }
    Ok(placed.with_positions(TOLERANCE, |at| {
        chart_camera_objects(request, placement, &placed, at)
    }))
}

/// Returns the objects that show the camera of a surface with parameters, whose exponential map is `at`.
fn chart_camera_objects(
    request: &PictureRequest,
    placement: &Placement,
    placed: &PlacedCamera,
    at: Positions<'_>,
) -> Vec<OverlayObject> {
    let (surface, frame, zoom) = (placed.manifold().surface(), &placed.frame, placed.zoom);
    let origin = surface.jet(frame.uv).position;
    let direction_of = |place: [f64; 2]| -> Option<[f64; 3]> {
        let end = frame.trace(surface, place, NUDGE * zoom, &Options::default());
        let end = end.ok().filter(|it| it.status == Status::Complete)?;
        let end = end.position?;
        Some([0, 1, 2].map(|k| (end[k] - origin[k]) / (NUDGE * zoom)))
    };
    let camera_frame = CameraFrame {
        origin,
        zoom,
        directions: [[1.0, 0.0], [0.0, 1.0]].map(direction_of),
    };
    let axis = |end: [f64; 2]| -> Vec<Option<Knot>> {
        let length = zoom * end[0].hypot(end[1]);
        let lengths: Vec<f64> = (0..=POINTS)
            .map(|k| length * f64::from(k) / f64::from(POINTS))
            .collect();
        let start = GeodesicStart::Frame(frame, end);
        knots_at(surface, &start, &lengths, MAX_LINE_EVALUATIONS).knots
    };
    let mut all = frame_objects(request, placement, &camera_frame, at, &axis);
    let inks = Inks::of(request.theme);
    let [right, up] = half_extent(request.size);
    if let Some(spacing) = request.overlays.wavefronts {
        let spacing = spacing.distance(zoom) / zoom;
        let rings: Vec<Vec<Option<Knot>>> = (1..=wave_count(request, spacing))
            .map(|ring| {
                let radius = spacing * f64::from(ring);
                (0..=DIRECTIONS)
                    .map(|k| at(direction(k).map(|x| radius * x)).map(knot))
                    .collect()
            })
            .collect();
        if !rings.is_empty() {
            all.push(curves(placement, &rings, inks.wave, WAVES));
        }
    }
    if request.overlays.conjugate_points {
        let options = Options {
            conjugates: true,
            ..Options::default()
        };
        let first: Vec<Option<Knot>> = (0..=DIRECTIONS)
            .into_par_iter()
            .map(|k| {
                let towards = direction(k);
                let farthest = zoom * reach_in(towards, [right, up]);
                let trace = frame.trace(surface, towards, farthest, &options).ok()?;
                let first = *trace.conjugates.first()?;
                at(towards.map(|x| x * first / zoom)).map(knot)
            })
            .collect();
        all.push(curves(placement, &[first], inks.conjugate, CONJUGATES));
    }
    all
}

/// Returns the number of wavefronts in the picture at a spacing in the units of its plane.
fn wave_count(request: &PictureRequest, spacing: f64) -> u32 {
    let [right, up] = half_extent(request.size);
    (right.min(up) / spacing).floor().min(MOST_WAVES) as u32
}

/// Returns the objects that show the camera of a solid.
fn solid_camera_objects(
    request: &PictureRequest,
    camera: &GeodesicCamera,
    placement: &Placement,
) -> Result<Vec<OverlayObject>, RenderError> {
    camera.check(&request.scene)?;
    let (scene, params) = (&request.scene, &request.params);
    let placed = PlacedSolidCamera::new(scene, params, camera, request.size)?;
    let frame = &placed.frame;
    let zoom = frame.zoom();
    let camera_frame = CameraFrame {
        origin: frame.at,
        zoom,
        directions: [frame.x, frame.y].map(|side| Some(side.map(|x| x / zoom))),
    };
    Ok(placed.with_positions(TOLERANCE, |at| {
        let axis = |end: [f64; 2]| -> Vec<Option<Knot>> {
            let shares = (0..=POINTS).map(|k| f64::from(k) / f64::from(POINTS));
            shares
                .map(|share| at(end.map(|x| share * x)).map(knot))
                .collect()
        };
        frame_objects(request, placement, &camera_frame, at, &axis)
    }))
}

/// A camera's frame in space.
struct CameraFrame {
    origin: [f64; 3],
    zoom: f64,
    /// The unit vectors of X and Y, where they are defined.
    directions: [Option<[f64; 3]>; 2],
}

/// Returns the arrows of a frame, the axes and the border of its picture. `at` is the exponential map, and `axis` returns the
/// knots from the origin to a place of the picture.
fn frame_objects(
    request: &PictureRequest,
    placement: &Placement,
    frame: &CameraFrame,
    at: Positions<'_>,
    axis: &(dyn Fn([f64; 2]) -> Vec<Option<Knot>> + Sync),
) -> Vec<OverlayObject> {
    let mut all = Vec::new();
    let length = frame.zoom.min(LONGEST_ARROW * placement.radius);
    let inks = Inks::of(request.theme);
    let [to_right, to_top] = inks.axes;
    for (direction, colour) in frame.directions.into_iter().zip(inks.axes) {
        let Some(direction) = direction else { continue };
        let arrow = vector(placement, frame.origin, direction.map(|x| x * length));
        all.push(OverlayObject {
            name: "camera",
            painter: Painter::Vectors,
            samples: Arc::new(Samples::Vectors(vec![arrow])),
            colour: style::linear(colour),
            line: FRAME,
            letter: None,
        });
    }
    let [right, up] = half_extent(request.size);
    let axes: Vec<_> = [[right, 0.0], [-right, 0.0], [0.0, up], [0.0, -up]]
        .into_par_iter()
        .map(axis)
        .collect();
    // Each axis has the colour of its arrow.
    all.push(curves(placement, &axes[..2], to_right, CAMERA_AXES));
    all.push(curves(placement, &axes[2..], to_top, CAMERA_AXES));
    let corners = [[right, up], [-right, up], [-right, -up], [right, -up]];
    let border: Vec<Vec<Option<Knot>>> = (0..4)
        .map(|side| {
            let (from, to) = (corners[side], corners[(side + 1) % 4]);
            (0..=POINTS)
                .map(|k| {
                    let t = f64::from(k) / f64::from(POINTS);
                    at([0, 1].map(|k| from[k] + t * (to[k] - from[k]))).map(knot)
                })
                .collect()
        })
        .collect();
    all.push(curves(placement, &border, inks.border, BORDERS));
    all
}

/// Returns the curves of a camera.
fn curves(
    placement: &Placement,
    lines: &[Vec<Option<Knot>>],
    colour: [u8; 3],
    line: LineStyle,
) -> OverlayObject {
    OverlayObject {
        name: "camera",
        painter: Painter::Curves,
        samples: Arc::new(line_samples(placement, lines[0].len() as u32, lines)),
        colour: style::linear(colour),
        line,
        letter: None,
    }
}

/// Puts the camera on its surface, as the geodesic view would.
fn place(request: &PictureRequest, camera: &GeodesicCamera) -> Result<PlacedCamera, RenderError> {
    camera.check(&request.scene)?;
    PlacedCamera::new(&request.scene, &request.params, camera, request.size)
}

/// The painters that the camera needs beside the scene's.
pub(super) const PAINTERS: [Painter; 2] = [Painter::Vectors, Painter::Curves];

/// Returns true if an object is a surface in space or a solid, whose camera can be shown there.
pub(super) fn is_shown(scene: &Scene, object: ObjectId) -> bool {
    let is_surface = scene.get(object).is_some_and(|it| it.shape.is_surface());
    is_surface || scene.is_solid(object)
}

fn knot(position: [f64; 3]) -> Knot {
    Knot {
        uv: [f64::NAN; 2],
        position: Some(position),
    }
}

/// The k-th direction, a unit vector; the last is the first again.
fn direction(k: u32) -> [f64; 2] {
    let angle = std::f64::consts::TAU * f64::from(k % DIRECTIONS) / f64::from(DIRECTIONS);
    [angle.cos(), angle.sin()]
}

/// Half the picture's width and height; the shorter one is 1.
fn half_extent(size: [u32; 2]) -> [f64; 2] {
    let shorter = f64::from(size[0].min(size[1]).max(1));
    size.map(|side| f64::from(side) / shorter)
}

/// Returns the extent of the picture in a direction.
fn reach_in(direction: [f64; 2], half: [f64; 2]) -> f64 {
    let [x, y] = [0, 1].map(|k| half[k] / direction[k].abs());
    x.min(y)
}
