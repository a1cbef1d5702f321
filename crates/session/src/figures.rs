//! Figures on a surface: each becomes rows of names and values, and lines to be drawn.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use geodesic::measure::{Circle, Connections, FAMILY_REMARK, PlaceMeasures, RayStop, Triangle};
use geodesic::surface::Surface;
use render::figure::Figure;
use render::measured::{FigureMeasures, lines, measure};

use crate::camera_controller::Subject;
use crate::measuring::{Measured, Quantity, angle, number, place};

/// The maximum number of geodesics that are listed.
const MOST_LISTED: usize = 8;

/// Measures a figure. A quantity that cannot be measured becomes a note; the points of an incomplete figure are marked.
pub fn measured(surface: &dyn Surface, subject: &Subject, figure: &Figure) -> Measured {
    let figure = Arc::new(figure.clone());
    let finding = measure(surface, &figure);
    let lines = lines(surface, subject.surface, &figure, finding.as_ref().ok());
    let measured = match &finding {
        Ok(FigureMeasures::Place(found)) => place_rows(surface, subject.chart_label(), found),
        Ok(FigureMeasures::Distance(all)) => distance_rows(all),
        Ok(FigureMeasures::Circle(radius, found)) => circle_rows(*radius, found),
        Ok(FigureMeasures::Triangle(found)) => triangle_rows(found),
        Ok(FigureMeasures::Nothing) => Measured {
            note: (figure.places.len() == figure.kind.places())
                .then(|| "no geodesic from the camera to that point was found".to_owned()),
            ..Measured::default()
        },
        Err(error) => Measured {
            note: Some(error.to_string()),
            ..Measured::default()
        },
    };
    Measured { lines, ..measured }
}

fn place_rows(surface: &dyn Surface, chart: String, found: &PlaceMeasures) -> Measured {
    let value = |value: Option<f64>| value.map_or_else(|| "undefined".to_owned(), number);
    let mut rows = vec![
        Quantity::new(chart, place(found.uv.0)),
        Quantity::new("K", value(found.gaussian)),
    ];
    if surface.is_embedded() {
        rows.push(Quantity::new("H", value(found.mean)));
        if let (Some(k), Some(h)) = (found.gaussian, found.mean) {
            // At an umbilic and at a pole, where there are no directions; rounding may leave less than 0.
            let half = (h * h - k).max(0.0).sqrt();
            let curvatures = found.principal.map_or([h + half, h - half], |all| {
                all.map(|principal| principal.curvature)
            });
            rows.push(Quantity::new("principal", place(curvatures)));
        }
        if let Some(all) = found.principal {
            let directions = all.map(|it| place(it.direction)).join(", ");
            rows.push(Quantity::new("directions", directions));
        }
    }
    let form = found.form.map(number).join(", ");
    rows.push(Quantity::new("E, F, G", form));
    Measured {
        rows,
        ..Measured::default()
    }
}

fn distance_rows(all: &Connections) -> Measured {
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
        rows.push(Quantity::new("conjugate", FAMILY_REMARK));
    }
    let note = match (all.found.is_empty(), all.complete) {
        (true, _) => Some("no geodesic between the two points was found"),
        (false, false) => Some("there may be more: the search reached its limit"),
        (false, true) => None,
    };
    Measured {
        rows,
        note: note.map(str::to_owned),
        ..Measured::default()
    }
}

fn circle_rows(radius: f64, found: &Result<Circle, RayStop>) -> Measured {
    let mut answer = Measured {
        rows: vec![Quantity::new("radius", number(radius))],
        radius: Some(radius),
        ..Measured::default()
    };
    let beside = |value: f64, flat: f64, name: &str| {
        let [shown, flat_shown] = [value, flat].map(number);
        format!(
            "{shown}; {name} = {flat_shown}; ratio {}",
            number(value / flat)
        )
    };
    match found {
        Ok(found) => {
            let rows = &mut answer.rows;
            let [length, area] = [TAU * radius, PI * radius * radius];
            rows.push(Quantity::new(
                "circumference",
                beside(found.circumference, length, "2πr"),
            ));
            rows.push(Quantity::new("area", beside(found.area, area, "πr²")));
            rows.push(errors(found.circumference_error, found.area_error));
            let note = match found.overlaps {
                Some(true) => Some("the circle overlaps itself: regions swept twice count twice"),
                Some(false) => None,
                None => Some("whether the circle overlaps itself is not known"),
            };
            answer.note = note.map(str::to_owned);
        }
        Err(stop) => {
            let why = stop.clause(&number(stop.length));
            answer.note = Some(format!("the circle is not complete: {why}"));
        }
    }
    answer
}

/// The error estimates of two numbers, in the order of their rows.
fn errors(first: f64, second: f64) -> Quantity {
    Quantity::new("errors", format!("≤ {first:.1e}, {second:.1e}"))
}

fn triangle_rows(found: &Triangle) -> Measured {
    let mut rows = Vec::new();
    let ends = ["B to C", "C to A", "A to B"];
    for (k, (name, ends)) in ["a", "b", "c"].iter().zip(ends).enumerate() {
        let side = found.sides[k];
        let length = side.map_or_else(|| "none found".to_owned(), |side| number(side.length));
        let mut shown = format!("{length}; {ends}");
        if let Some(remark) = found.remark(k) {
            shown.push_str(&format!("; {remark}"));
        }
        rows.push(Quantity::new(format!("side {name}"), shown));
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
            rows.push(errors(region.curvature_error, region.area_error));
        }
        Err(error) => note = Some(error.to_string()),
    }
    Measured {
        rows,
        note,
        ..Measured::default()
    }
}
