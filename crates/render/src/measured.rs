//! The measures of figures, and the lines that show them.
//!
//! In: a surface and a [`Figure`]. Out: the measures, and trails for a picture. A window and a command line thus measure and
//! draw the same.

use std::f64::consts::TAU;
use std::sync::Arc;

use geodesic::frame::Frame;
use geodesic::measure::{
    self, Circle, Connection, Connections, MeasureError, PlaceMeasures, RayStop, Triangle,
};
use geodesic::surface::Surface;
use geodesic::trace::{Options, Status};
use geometry::{GeodesicStart, MAX_LINE_EVALUATIONS, knots_at};
use scene::ObjectId;

use crate::figure::{Figure, FigureKind};
use crate::trail::{PlaceMark, Trail, TrailKind};

/// The number of points of a geodesic that is drawn.
const POINTS: u32 = 96;
/// The number of points of a circle that is drawn.
const RIM: u32 = 180;
/// The radius of the mark at a point, as a fraction of the surface's size.
const MARK: f64 = 0.012;

/// The measures of a figure.
#[derive(Clone, Debug)]
pub enum FigureMeasures {
    /// Of a point.
    Place(PlaceMeasures),
    /// The geodesics between two points.
    Distance(Connections),
    /// A circle with its radius, or the ray that ends before it.
    Circle(f64, Result<Circle, RayStop>),
    /// A triangle.
    Triangle(Box<Triangle>),
    /// Points are missing, or no geodesic leads to the rim of a circle.
    Nothing,
}

/// Measures a figure.
///
/// # Errors
/// Those of [`geodesic::measure`].
pub fn measure(surface: &dyn Surface, figure: &Figure) -> Result<FigureMeasures, MeasureError> {
    Ok(match (figure.kind, &figure.places[..], figure.radius) {
        (FigureKind::Place, [at], _) => FigureMeasures::Place(measure::place(surface, *at)?),
        (FigureKind::Distance, [from, to], _) => {
            FigureMeasures::Distance(measure::between(surface, *from, *to, None)?)
        }
        (FigureKind::Circle, [centre, ..], Some(radius)) => {
            FigureMeasures::Circle(radius, measure::circle(surface, *centre, radius)?)
        }
        (FigureKind::Circle, [centre, rim], None) => {
            match measure::distance(surface, *centre, *rim)? {
                Some(Connection { length, .. }) => {
                    FigureMeasures::Circle(length, measure::circle(surface, *centre, length)?)
                }
                None => FigureMeasures::Nothing,
            }
        }
        (FigureKind::Triangle, [a, b, c], _) => {
            FigureMeasures::Triangle(Box::new(measure::triangle(surface, [*a, *b, *c])?))
        }
        _ => FigureMeasures::Nothing,
    })
}

/// Returns the lines that show a figure on the surface of an object, and the marks at its points. `finding` is the result of
/// [`measure()`], if there is one.
pub fn lines(
    surface: &dyn Surface,
    id: ObjectId,
    figure: &Arc<Figure>,
    finding: Option<&FigureMeasures>,
) -> Vec<Arc<Trail>> {
    let drawing = Drawing {
        surface,
        id,
        figure,
    };
    let mut lines: Vec<Trail> = match (finding, &figure.places[..]) {
        (Some(FigureMeasures::Distance(all)), _) => {
            all.found.iter().flat_map(|it| drawing.line(it)).collect()
        }
        (Some(FigureMeasures::Circle(radius, _)), [centre, ..]) => drawing.rim(*centre, *radius),
        (Some(FigureMeasures::Triangle(found)), _) => {
            let sides = found.sides.iter().flatten();
            sides.flat_map(|side| drawing.line(side)).collect()
        }
        _ => Vec::new(),
    };
    for (letter, at) in figure.lettered() {
        let mut rings = drawing.rim(at, MARK * surface.scale().size);
        // If the border of the surface cuts a ring into pieces, the letter is written once.
        if let Some(ring) = rings.first_mut() {
            ring.mark = Some(PlaceMark { letter, at });
        }
        lines.extend(rings);
    }
    lines.into_iter().map(Arc::new).collect()
}

/// A surface on which a figure is drawn.
struct Drawing<'a> {
    surface: &'a dyn Surface,
    id: ObjectId,
    figure: &'a Arc<Figure>,
}

impl Drawing<'_> {
    /// Returns a geodesic as a line.
    fn line(&self, it: &Connection) -> Option<Trail> {
        let lengths: Vec<f64> = (0..=POINTS)
            .map(|k| it.length * f64::from(k) / f64::from(POINTS))
            .collect();
        let start = GeodesicStart::Chart(it.from.0, it.direction.0);
        let line = knots_at(self.surface, &start, &lengths, MAX_LINE_EVALUATIONS);
        let points: Vec<_> = line.knots.into_iter().map_while(|k| Some(k?.uv)).collect();
        self.trail(points, it.length)
    }

    /// Returns a circle as lines, with gaps where rays end.
    fn rim(&self, centre: [f64; 2], radius: f64) -> Vec<Trail> {
        let Ok(frame) = Frame::new(self.surface, centre, 0.0, 1.0) else {
            return Vec::new();
        };
        let point = |k: u32| {
            let (sin, cos) = (TAU * f64::from(k) / f64::from(RIM)).sin_cos();
            let options = Options::default();
            let ray = frame.trace(self.surface, [cos, sin], radius, &options);
            let ray = ray.ok().filter(|it| it.status == Status::Complete)?;
            Some(ray.uv.0)
        };
        let mut all: Vec<Option<[f64; 2]>> = (0..=RIM).map(point).collect();
        if let Some(gap) = all.iter().position(Option::is_none) {
            // What is between two gaps is one piece, wherever the circle begins.
            all.pop();
            all.rotate_left(gap);
        }
        let pieces = all.split(Option::is_none);
        let pieces = pieces.map(|piece| piece.iter().flatten().copied().collect());
        pieces
            .filter_map(|piece| self.trail(piece, TAU * radius))
            .collect()
    }

    fn trail(&self, points: Vec<[f64; 2]>, length: f64) -> Option<Trail> {
        (points.len() > 1).then(|| Trail {
            kind: TrailKind::Measured(Arc::clone(self.figure)),
            surface: self.id,
            points,
            length,
            mark: None,
        })
    }
}
