//! Measuring: the points that were clicked, their figure, and its measured quantities.

use std::ops::Range;
use std::sync::Arc;

use render::figure::{Figure, FigureKind};
use render::trail::Trail;

/// Returns the title of a kind of figure.
pub fn title(kind: FigureKind) -> &'static str {
    match kind {
        FigureKind::Place => "Place",
        FigureKind::Distance => "Distance",
        FigureKind::Circle => "Circle",
        FigureKind::Triangle => "Triangle",
    }
}

/// Returns the clicks that a kind of figure requires, in words.
pub fn hint(kind: FigureKind) -> &'static str {
    match kind {
        FigureKind::Place => "Click on a point of a surface, in any view.",
        FigureKind::Distance => "Click on two points of a surface, in any view.",
        FigureKind::Circle => {
            "Click on a point: the circle about the geodesic camera passes through it."
        }
        FigureKind::Triangle => "Click on the three corners, in any view.",
    }
}

/// A figure on a surface. The first point of a circle is the camera's.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedFigure {
    /// The surface's name.
    pub surface: String,
    /// The points that were clicked, and the kind of figure.
    pub figure: Figure,
}

impl PlacedFigure {
    /// Returns the figure with a further point. A figure that is complete, of another kind or on another surface is
    /// replaced by a new one; a circle begins at `centre`, the camera's position.
    #[must_use]
    pub fn with_place(
        begun: Option<Self>,
        kind: FigureKind,
        surface: &str,
        centre: Option<[f64; 2]>,
        place: [f64; 2],
    ) -> Self {
        let begun = begun.filter(|placed| {
            let figure = &placed.figure;
            let goes_on = figure.kind == kind && placed.surface == surface;
            goes_on && figure.places.len() < kind.places()
        });
        let mut placed = begun.unwrap_or_else(|| {
            let centre = centre.filter(|_| kind == FigureKind::Circle);
            Self {
                surface: surface.to_owned(),
                figure: Figure {
                    kind,
                    places: centre.into_iter().collect(),
                    radius: None,
                },
            }
        });
        placed.figure.places.push(place);
        placed
    }
}

/// The measured quantities of a figure.
#[derive(Clone, Debug, Default)]
pub struct Measured {
    /// The quantities, in the order in which they are shown.
    pub rows: Vec<Quantity>,
    /// A sentence on what is missing.
    pub note: Option<String>,
    /// Its lines, to be drawn on the surface.
    pub lines: Vec<Arc<Trail>>,
    /// The radius of a circle.
    pub radius: Option<f64>,
}

/// A measured quantity.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Quantity {
    /// The name of the quantity.
    pub name: String,
    /// Its value, in words.
    pub value: String,
}

impl Quantity {
    /// Returns a quantity.
    pub fn new(name: impl Into<String>, value: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            value: value.into(),
        }
    }
}

/// The sizes of numbers that are displayed without an exponent.
pub const PLAIN: Range<f64> = 1e-5..1e9;

/// Formats a number with at most eight significant digits.
pub fn number(value: f64) -> String {
    let rounded = expr::number::rounded(value, 8);
    let size = rounded.abs();
    if rounded == 0.0 {
        "0".to_owned()
    } else if !rounded.is_finite() {
        "undefined".to_owned()
    } else if PLAIN.contains(&size) {
        format!("{rounded}")
    } else {
        format!("{rounded:e}")
    }
}

/// Formats an angle in radians, with its degrees.
pub fn angle(radians: f64) -> String {
    format!("{} ({:.4}°)", number(radians), radians.to_degrees())
}

/// Formats a point of a surface.
pub fn place([u, v]: [f64; 2]) -> String {
    format!("({}, {})", number(u), number(v))
}

#[cfg(test)]
mod tests {
    use super::{angle, number};

    #[test]
    fn measured_numbers_have_eight_digits() {
        let shown = [1.0 / 3.0, -2.0, 0.0, 1e-9, 12345678901.0, f64::NAN].map(number);
        let wanted = ["0.33333333", "-2", "0", "1e-9", "1.2345679e10", "undefined"];
        assert_eq!(shown, wanted);
        assert_eq!(angle(std::f64::consts::FRAC_PI_2), "1.5707963 (90.0000°)");
    }
}
