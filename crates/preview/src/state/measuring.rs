//! Measuring: the places that were clicked on, the figure that they make, and what was found of it.

use std::sync::Arc;

use render::trail::Trail;

/// The kind of figure that clicks make.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub(crate) enum MeasureTool {
    /// A place: its curvatures.
    #[default]
    Place,
    /// Two places: the geodesics between them.
    Distance,
    /// A circle about the geodesic camera, through the place that is clicked on.
    Circle,
    /// Three places: a triangle of shortest geodesics.
    Triangle,
}

impl MeasureTool {
    /// All of them, in the order in which they are offered.
    pub(crate) const ALL: [Self; 4] = [Self::Place, Self::Distance, Self::Circle, Self::Triangle];

    /// Its title.
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Place => "Place",
            Self::Distance => "Distance",
            Self::Circle => "Circle",
            Self::Triangle => "Triangle",
        }
    }

    /// The clicks that it takes, in words.
    pub(crate) fn hint(self) -> &'static str {
        match self {
            Self::Place => "Click on a place of a surface, in any view.",
            Self::Distance => "Click on two places of a surface, in any view.",
            Self::Circle => {
                "Click on a place: the circle about the geodesic camera goes through it."
            }
            Self::Triangle => "Click on the three corners, in any view.",
        }
    }

    /// The number of clicks that it takes.
    pub(crate) fn clicks(self) -> usize {
        match self {
            Self::Place | Self::Circle => 1,
            Self::Distance => 2,
            Self::Triangle => 3,
        }
    }
}

/// A figure on a surface.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Figure {
    /// Its kind.
    pub(crate) tool: MeasureTool,
    /// The surface's name.
    pub(crate) surface: String,
    /// The places that were clicked on, (u, v); of a circle the camera's place comes first.
    pub(crate) places: Vec<[f64; 2]>,
    /// The radius of a circle, where it was entered; else it goes through its second place.
    pub(crate) radius: Option<f64>,
}

impl Figure {
    /// Its places in order, each with its letter.
    pub(crate) fn lettered(&self) -> impl Iterator<Item = (char, [f64; 2])> + '_ {
        ('A'..='Z').zip(self.places.iter().copied())
    }
}

/// The answer for a figure.
#[derive(Clone, Debug, Default)]
pub(crate) struct Measured {
    /// Names with values, in the order in which they are shown.
    pub(crate) rows: Vec<Quantity>,
    /// A sentence on what is missing.
    pub(crate) note: Option<String>,
    /// Its lines, to be drawn on the surface.
    pub(crate) lines: Vec<Arc<Trail>>,
    /// The radius of a circle.
    pub(crate) radius: Option<f64>,
}

/// A quantity of the answer.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) struct Quantity {
    /// The name of the quantity.
    pub(crate) name: String,
    /// Its value, in words.
    pub(crate) value: String,
}

impl Quantity {
    /// Makes a quantity.
    pub(crate) fn new(name: impl Into<String>, value: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            value: value.into(),
        }
    }
}

/// Formats a number with at most eight significant digits.
pub(crate) fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.7e}").parse().unwrap_or(value);
    let size = rounded.abs();
    if rounded == 0.0 {
        "0".to_owned()
    } else if !rounded.is_finite() {
        "undefined".to_owned()
    } else if (1e-5..1e9).contains(&size) {
        format!("{rounded}")
    } else {
        format!("{rounded:e}")
    }
}

/// Formats an angle in radians, with its degrees.
pub(crate) fn angle(radians: f64) -> String {
    format!("{} ({:.4}°)", number(radians), radians.to_degrees())
}

/// Formats a place of a surface.
pub(crate) fn place([u, v]: [f64; 2]) -> String {
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
