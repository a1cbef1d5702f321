//! Questions about a surface, and their answers: a point, a figure, a walk, the way back.
//!
//! In: a surface with the params' values, and a question. Out: rows of names and values, and the lines of figures. A
//! search for geodesics may take seconds.

use geodesic::frame::Frame;
use geodesic::measure;
use geodesic::surface::Surface;
use geometry::{ManifoldError, SolidSurface};
use scene::Scene;

use crate::camera_controller::{Ground, Subject};
use crate::clicks::ClickedObject;
use crate::figures;
use crate::measuring::{Measured, PlacedFigure, Quantity, angle, number, place};
use crate::motion::Motion;
use crate::{CameraPath, ChartCamera, InsideCamera};

/// A question about a surface.
#[derive(Clone, Debug)]
pub enum MeasureQuestion {
    /// The point under the pointer, with its distance and direction (radians) from the camera, if known.
    Pointer(PointedPlace, Option<[f64; 2]>),
    /// A figure.
    Figure(PlacedFigure),
    /// A walk from one frame to another.
    Walk {
        /// The frame at the start.
        start: Frame,
        /// The frame at the end.
        end: Frame,
        /// The sum of the turns along the walk, in radians.
        turned: f64,
        /// The length of the walk.
        length: f64,
    },
    /// The way back from a frame to a point.
    WayBack {
        /// The frame.
        from: Frame,
        /// The point (u, v).
        to: [f64; 2],
    },
}

/// The point under the pointer.
#[derive(Clone, Copy, Debug)]
pub enum PointedPlace {
    /// On a surface or metric: (u, v), and the camera of the surface.
    InChart([f64; 2], Option<Frame>),
    /// On a solid: a point in space.
    InSpace([f64; 3]),
}

impl MeasureQuestion {
    /// Returns the question about the point under the pointer; `None` if the object is not a surface, metric or solid.
    /// `camera` is the object's own.
    pub fn pointer(clicked: &ClickedObject<'_>, camera: Option<&InsideCamera>) -> Option<Self> {
        let shape = &clicked.object.shape;
        let place = if shape.manifold().is_some() {
            let camera = camera.and_then(InsideCamera::chart);
            PointedPlace::InChart(clicked.hit.parameters, camera.map(ChartCamera::frame))
        } else {
            shape.solid()?;
            PointedPlace::InSpace(clicked.hit.position?.0)
        };
        Some(Self::Pointer(place, clicked.hit.polar))
    }

    /// Returns the question about a walk along a path, to the camera's current position.
    pub fn walk(path: &CameraPath, camera: &ChartCamera) -> Self {
        let turns = path.motions().iter().map(|motion| match motion {
            Motion::Turn(angle) => *angle,
            _ => 0.0,
        });
        Self::Walk {
            start: path.start.frame(),
            end: camera.frame(),
            turned: turns.sum(),
            length: path.trail.length,
        }
    }

    /// Returns the question about the way back from the camera's current position to the start of a path.
    pub fn way_back(path: &CameraPath, camera: &ChartCamera) -> Self {
        Self::WayBack {
            from: camera.frame(),
            to: path.start.at,
        }
    }
}

/// The sentence for the user where [`MeasureAnswer::WayBack`] has no step.
pub const NO_WAY_BACK: &str = "No geodesic back to the start of the trail was found.";

/// The sentence for the user where the camera has moved since it was asked for the way back.
pub const OLD_WAY_BACK: &str = "The camera has moved since: request the way back again.";

/// An answer.
#[derive(Debug)]
pub enum MeasureAnswer {
    /// About the point under the pointer: its rows, and a short form.
    Pointer(Vec<Quantity>, String),
    /// About a figure.
    Figure(PlacedFigure, Measured),
    /// About a walk.
    Walk(Vec<Quantity>),
    /// The way back.
    WayBack {
        /// The surface's name.
        surface: String,
        /// The frame of the camera in the question.
        from: Frame,
        /// The step of the camera that leads back, in units of that frame; `None` if no geodesic was found.
        step: Option<[f64; 2]>,
    },
}

/// Answers questions, and keeps the surface of the last one.
#[derive(Debug, Default)]
pub struct Measurer {
    known: Option<(Subject, Result<Ground, ManifoldError>)>,
}

impl Measurer {
    /// Answers a question; `None` if it does not apply to its subject.
    pub fn answer(
        &mut self,
        subject: &Subject,
        question: &MeasureQuestion,
    ) -> Option<MeasureAnswer> {
        let known = self.known.take();
        let known = known.filter(|(before, _)| before.is_same(subject));
        let (_, ground) = self
            .known
            .insert(known.unwrap_or_else(|| (subject.clone(), subject.ground())));
        match ground.as_ref().ok()? {
            Ground::Manifold(manifold) => answer(subject, manifold.surface(), question),
            Ground::Solid(solid) => answer_on_solid(&subject.scene, solid, question),
        }
    }
}

fn answer(
    subject: &Subject,
    surface: &dyn Surface,
    question: &MeasureQuestion,
) -> Option<MeasureAnswer> {
    Some(match question {
        MeasureQuestion::Pointer(pointed, polar) => {
            let PointedPlace::InChart(uv, camera) = pointed else {
                return None;
            };
            let [u, v] = uv.map(short);
            let curvature = measure::place(surface, *uv).ok();
            let curvature = curvature.and_then(|found| found.gaussian);
            let chart = subject.chart_label();
            let shown = format!("{chart} = ({u}, {v})");
            let mut rows = vec![Quantity::new(chart, place(*uv))];
            rows.extend(curvature.map(|k| Quantity::new("K", number(k))));
            let (way, distance) = way_to(surface, *uv, *polar, camera.as_ref());
            rows.extend(way);
            MeasureAnswer::Pointer(rows, in_short(shown, curvature, distance))
        }
        MeasureQuestion::Figure(figure) => {
            let measured = figures::measured(surface, subject, &figure.figure);
            MeasureAnswer::Figure(figure.clone(), measured)
        }
        MeasureQuestion::Walk {
            start,
            end,
            turned,
            length,
        } => MeasureAnswer::Walk(walk(surface, start, end, *turned, *length)),
        MeasureQuestion::WayBack { from, to } => {
            let name = subject.scene.get(subject.surface);
            MeasureAnswer::WayBack {
                surface: name.map_or_else(String::new, |object| object.name.clone()),
                from: *from,
                step: way_back(surface, from, *to),
            }
        }
    })
}

/// Answers a question about a solid. Only the point under the pointer has an answer: figures and walks are measured in
/// charts.
fn answer_on_solid(
    scene: &Scene,
    solid: &SolidSurface,
    question: &MeasureQuestion,
) -> Option<MeasureAnswer> {
    let MeasureQuestion::Pointer(PointedPlace::InSpace(at), polar) = question else {
        return None;
    };
    let stated = scene.stated(*at);
    let curvature = solid.surface().curvature(*at);
    let [x, y, z] = stated.map(number);
    let mut rows = vec![Quantity::new("(x, y, z)", format!("({x}, {y}, {z})"))];
    rows.extend(curvature.map(|k| Quantity::new("K", number(k))));
    if let Some([distance, direction]) = polar {
        rows.push(Quantity::new(SEEN, number(*distance)));
        rows.push(Quantity::new("direction", angle(*direction)));
    }
    let [x, y, z] = stated.map(short);
    let place = format!("(x, y, z) = ({x}, {y}, {z})");
    let distance = polar.map(|[distance, _]| distance);
    Some(MeasureAnswer::Pointer(
        rows,
        in_short(place, curvature, distance),
    ))
}

/// The name of the distance of what is seen in a geodesic view, which shows each place at the end of a geodesic: it need not be
/// the shortest.
const SEEN: &str = "length of the geodesic seen";

/// Returns a point with its curvature and its distance from the camera, for the status line.
fn in_short(place: String, curvature: Option<f64>, distance: Option<f64>) -> String {
    let curvature = curvature.map_or(String::new(), |k| format!(", K = {}", short(k)));
    let distance = distance.map(|length| format!(", {} from the geodesic camera", short(length)));
    format!("{place}{curvature}{}", distance.unwrap_or_default())
}

/// Formats a number with at most four significant digits.
fn short(value: f64) -> String {
    number(expr::number::rounded(value, 4))
}

/// Returns the distance and direction of a point from the camera, as quantities, and the distance itself. In a geodesic
/// view it is the length of the geodesic that is seen there, otherwise that of the shortest one.
fn way_to(
    surface: &dyn Surface,
    uv: [f64; 2],
    polar: Option<[f64; 2]>,
    camera: Option<&Frame>,
) -> (Vec<Quantity>, Option<f64>) {
    let mut rows = Vec::new();
    let name = match polar {
        Some(_) => SEEN,
        None => "distance from the camera",
    };
    if polar.is_none() && camera.is_some_and(|camera| is_here(surface, camera, uv)) {
        // Geodesics from a point to itself are loops.
        rows.push(Quantity::new(name, number(0.0)));
        return (rows, Some(0.0));
    }
    let seen = polar.or_else(|| {
        let camera = camera?;
        let it = measure::distance(surface, camera.uv, uv).ok().flatten()?;
        let [x, y] = in_frame(surface, camera, it.direction.0)?;
        Some([it.length, y.atan2(x)])
    });
    if let Some([distance, direction]) = seen {
        rows.push(Quantity::new(name, number(distance)));
        rows.push(Quantity::new("direction", angle(direction)));
    }
    (rows, seen.map(|[distance, _]| distance))
}

/// The maximum distance between a point and the camera's position at which the two count as equal, as a fraction of the
/// zoom.
const HERE: f64 = 1e-6;

/// Returns whether a point is a camera's position.
fn is_here(surface: &dyn Surface, camera: &Frame, uv: [f64; 2]) -> bool {
    let [du, dv] = measure::shortest_step(surface, uv, camera.uv).0;
    let form = measure::place(surface, uv).map(|found| found.form);
    form.is_ok_and(|[e, f, g]| {
        let length = (e * du * du + 2.0 * f * du * dv + g * dv * dv)
            .max(0.0)
            .sqrt();
        length <= HERE * camera.zoom(surface)
    })
}

/// The maximum distance between the ends of a walk that counts as closed, as a fraction of the zoom.
const CLOSED: f64 = 1e-3;

fn walk(
    surface: &dyn Surface,
    start: &Frame,
    end: &Frame,
    turned: f64,
    length: f64,
) -> Vec<Quantity> {
    let mut rows = vec![Quantity::new("length", number(length))];
    let tolerance = CLOSED * start.zoom(surface);
    let closing = measure::closing(surface, start, end, turned, tolerance);
    let Some(closing) = closing.filter(|_| length > tolerance) else {
        return rows;
    };
    match closing.holonomy {
        Some(holonomy) => rows.push(Quantity::new("holonomy", angle(holonomy))),
        None if closing.mirrored && closing.gap <= tolerance => {
            rows.push(Quantity::new(
                "holonomy",
                "none: left and right are exchanged",
            ));
        }
        // The way back is needed here: the gap is accurate only if the ends are near each other.
        None => {
            let shortest = measure::distance(surface, end.uv, start.uv);
            if let Some(shortest) = shortest.ok().flatten() {
                rows.push(Quantity::new("to the start", number(shortest.length)));
            }
        }
    }
    rows
}

/// Returns the step that leads a camera along the shortest geodesic to a point, in units of its frame.
fn way_back(surface: &dyn Surface, from: &Frame, to: [f64; 2]) -> Option<[f64; 2]> {
    let shortest = measure::distance(surface, from.uv, to).ok().flatten()?;
    let towards = in_frame(surface, from, shortest.direction.0)?;
    Some(towards.map(|x| x * shortest.length))
}

/// Returns the coordinates of a tangent vector in a frame at the same point; `None` if there are none.
fn in_frame(surface: &dyn Surface, frame: &Frame, vector: [f64; 2]) -> Option<[f64; 2]> {
    let plain = frame.plain(surface);
    measure::components(plain.x, plain.y, vector.into())
}

#[cfg(test)]
mod tests {
    use geodesic::frame::Frame;
    use geometry::Manifold;
    use scene::{ObjectId, ParamValues};

    use super::is_here;

    #[test]
    fn a_camera_on_a_seam_is_found_from_both_of_its_sides() {
        for (text, beyond) in [
            (
                "surface s(u, v) = (cos u, sin u, v), u : [0, 2pi], v : [-1, 1];",
                0.25,
            ),
            (
                "surface s(u, v) = ((1 + v cos(u/2)) cos u, (1 + v cos(u/2)) sin u, v sin(u/2)), \
                 u : [0, 2pi], v : [-1/2, 1/2];",
                -0.25,
            ),
        ] {
            let scene = scene::geotrace::compile(text).scene.expect("no errors");
            let uniforms = ParamValues::initial(&scene).first_instance(&scene, &scene.objects[0]);
            let manifold = Manifold::new(&scene, ObjectId::new(0), &uniforms).expect("a surface");
            let surface = manifold.surface();
            let camera = Frame::new(surface, [0.0, 0.25], 0.0, 1.0).expect("a camera");
            let end = surface.domain()[0][1];
            assert!(is_here(surface, &camera, [1e-9, 0.25]));
            assert!(is_here(surface, &camera, [end - 1e-9, beyond]));
            assert!(!is_here(surface, &camera, [end - 0.01, beyond]));
        }
    }
}
