//! Figures on a surface: each becomes rows of names and values, and lines to be drawn.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use geodesic::frame::Frame;
use geodesic::measure::{self, Connection, MeasureError};
use geodesic::surface::Surface;
use geodesic::trace::{Options, Status};
use geometry::{GeodesicStart, knots_at};
use render::trail::{Mark, Trail, TrailKind};
use scene::ObjectId;

use crate::state::measuring::{Figure, MeasureTool, Measured, Quantity, angle, number, place};

/// The points of a geodesic that is drawn.
const POINTS: u32 = 96;
/// The points of a circle that is drawn.
const RIM: u32 = 180;
/// The radius of the mark at a place, as a share of the surface's size.
const MARK: f64 = 0.012;
/// The most geodesics that are listed.
const MOST_LISTED: usize = 8;

/// Measures a figure. What cannot be measured is a note; of a figure that lacks places, these are marked.
pub(crate) fn measured(surface: &dyn Surface, id: ObjectId, figure: &Figure) -> Measured {
    let drawing = Drawing { surface, id };
    let found = match (figure.tool, &figure.places[..]) {
        (MeasureTool::Place, [at]) => drawing.place(*at),
        (MeasureTool::Distance, [from, to]) => drawing.distance(*from, *to),
        (MeasureTool::Circle, [centre, rim]) => drawing.circle(*centre, *rim, figure.radius),
        (MeasureTool::Triangle, [a, b, c]) => drawing.triangle([*a, *b, *c]),
        _ => Ok(Measured::default()),
    };
    let mut found = found.unwrap_or_else(|error| Measured {
        note: Some(error.to_string()),
        ..Measured::default()
    });
    for (letter, at) in figure.lettered() {
        let rings = drawing.rim(at, MARK * surface.scale().size);
        let mark = Some(Mark { letter, at });
        // A ring that the border of the surface cuts in pieces has its letter once.
        let marks = std::iter::once(mark).chain(std::iter::repeat(None));
        let rings = rings.into_iter().zip(marks);
        found
            .lines
            .extend(rings.map(|(ring, mark)| Arc::new(Trail { mark, ..ring })));
    }
    found
}

/// A surface on which figures are drawn.
struct Drawing<'a> {
    surface: &'a dyn Surface,
    id: ObjectId,
}

impl Drawing<'_> {
    fn place(&self, at: [f64; 2]) -> Result<Measured, MeasureError> {
        let found = measure::place(self.surface, at)?;
        let value = |value: Option<f64>| value.map_or_else(|| "undefined".to_owned(), number);
        let mut rows = vec![
            Quantity::new("(u, v)", place(found.uv.0)),
            Quantity::new("K", value(found.gaussian)),
        ];
        if self.surface.is_embedded() {
            rows.push(Quantity::new("H", value(found.mean)));
            if let (Some(k), Some(h)) = (found.gaussian, found.mean) {
                // Rounding may leave less than 0 at an umbilic.
                let half = (h * h - k).max(0.0).sqrt();
                rows.push(Quantity::new("principal", place([h + half, h - half])));
            }
        }
        let form = found.form.map(number).join(", ");
        rows.push(Quantity::new("E, F, G", form));
        Ok(Measured {
            rows,
            ..Measured::default()
        })
    }

    fn distance(&self, from: [f64; 2], to: [f64; 2]) -> Result<Measured, MeasureError> {
        let all = measure::between(self.surface, from, to, None)?;
        let mut rows = Vec::new();
        if let Some(first) = all.found.first() {
            rows.push(Quantity::new("distance", number(first.length)));
        }
        for (k, it) in all.found.iter().enumerate().take(MOST_LISTED).skip(1) {
            rows.push(Quantity::new(
                format!("geodesic {}", k + 1),
                number(it.length),
            ));
        }
        if all.found.len() > MOST_LISTED {
            let more = all.found.len() - MOST_LISTED;
            rows.push(Quantity::new("and", format!("{more} more")));
        }
        if all.found.iter().any(|it| it.conjugate) {
            rows.push(Quantity::new(
                "conjugate",
                "one of a family of the same length",
            ));
        }
        let note = match (all.found.is_empty(), all.complete) {
            (true, _) => Some("no geodesic between the two places was found"),
            (false, false) => Some("there may be more: the search reached its limit"),
            (false, true) => None,
        };
        Ok(Measured {
            rows,
            note: note.map(str::to_owned),
            lines: all.found.iter().flat_map(|it| self.line(it)).collect(),
            radius: None,
        })
    }

    fn circle(
        &self,
        centre: [f64; 2],
        rim: [f64; 2],
        radius: Option<f64>,
    ) -> Result<Measured, MeasureError> {
        let radius = match radius {
            Some(radius) => radius,
            None => match measure::distance(self.surface, centre, rim)? {
                Some(shortest) => shortest.length,
                None => {
                    let note = "no geodesic from the camera to that place was found";
                    return Ok(Measured {
                        note: Some(note.to_owned()),
                        ..Measured::default()
                    });
                }
            },
        };
        let mut answer = Measured {
            rows: vec![Quantity::new("radius", number(radius))],
            radius: Some(radius),
            lines: self.rim(centre, radius).into_iter().map(Arc::new).collect(),
            ..Measured::default()
        };
        let beside = |value: f64, flat: f64, name: &str| {
            let [shown, flat_shown] = [value, flat].map(number);
            format!(
                "{shown}; {name} = {flat_shown}; ratio {}",
                number(value / flat)
            )
        };
        match measure::circle(self.surface, centre, radius)? {
            Ok(found) => {
                let rows = &mut answer.rows;
                let [length, area] = [TAU * radius, PI * radius * radius];
                rows.push(Quantity::new(
                    "circumference",
                    beside(found.circumference, length, "2πr"),
                ));
                rows.push(Quantity::new("area", beside(found.area, area, "πr²")));
                rows.push(Quantity::new(
                    "error",
                    format!("≤ {:.1e}", found.error_estimate),
                ));
                if found.overlaps {
                    let note = "the circle overlaps itself: what is swept twice counts twice";
                    answer.note = Some(note.to_owned());
                }
            }
            Err(stop) => {
                let degrees = stop.angle.to_degrees().rem_euclid(360.0);
                answer.note = Some(format!(
                    "there is no whole circle: the ray at {degrees:.0}° ends after {}",
                    number(stop.length)
                ));
            }
        }
        Ok(answer)
    }

    fn triangle(&self, corners: [[f64; 2]; 3]) -> Result<Measured, MeasureError> {
        let found = measure::triangle(self.surface, corners)?;
        let mut rows = Vec::new();
        let ends = ["B to C", "C to A", "A to B"];
        for ((name, ends), side) in ["a", "b", "c"].iter().zip(ends).zip(&found.sides) {
            let length = side.map_or_else(|| "none found".to_owned(), |side| number(side.length));
            rows.push(Quantity::new(
                format!("side {name}"),
                format!("{length}; {ends}"),
            ));
        }
        for (name, at) in ["A", "B", "C"].iter().zip(found.angles) {
            let shown = at.map_or_else(|| "none".to_owned(), angle);
            rows.push(Quantity::new(format!("angle {name}"), shown));
        }
        if let Some(excess) = found.excess() {
            rows.push(Quantity::new("angle excess", angle(excess)));
        }
        let mut note = None;
        match &found.region {
            Ok(region) => {
                rows.push(Quantity::new("∫K", number(region.curvature)));
                rows.push(Quantity::new("area", number(region.area)));
                rows.push(Quantity::new(
                    "error",
                    format!("≤ {:.1e}", region.error_estimate),
                ));
            }
            Err(error) => note = Some(error.to_string()),
        }
        let sides = found.sides.iter().flatten();
        Ok(Measured {
            rows,
            note,
            lines: sides.flat_map(|side| self.line(side)).collect(),
            radius: None,
        })
    }

    /// A geodesic as a line.
    fn line(&self, it: &Connection) -> Option<Arc<Trail>> {
        let lengths: Vec<f64> = (0..=POINTS)
            .map(|k| it.length * f64::from(k) / f64::from(POINTS))
            .collect();
        let start = GeodesicStart::Chart(it.from.0, it.direction.0);
        let knots = knots_at(self.surface, &start, &lengths);
        let points: Vec<_> = knots.into_iter().map_while(|k| Some(k?.uv)).collect();
        self.trail(points, it.length).map(Arc::new)
    }

    /// A circle as lines: it has gaps where rays end.
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
        let all: Vec<Option<[f64; 2]>> = (0..=RIM).map(point).collect();
        let pieces = all.split(Option::is_none);
        let pieces = pieces.map(|piece| piece.iter().flatten().copied().collect());
        pieces
            .filter_map(|piece| self.trail(piece, TAU * radius))
            .collect()
    }

    fn trail(&self, points: Vec<[f64; 2]>, length: f64) -> Option<Trail> {
        (points.len() > 1).then(|| Trail {
            kind: TrailKind::Measured,
            surface: self.id,
            points,
            length,
            mark: None,
        })
    }
}
