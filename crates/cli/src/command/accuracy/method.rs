//! The methods that are measured, and their settings.

use geodesic::map::{MapOptions, Method};

/// A method with one of its settings.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setting {
    /// The index into [`SERIES`].
    pub(super) series: usize,
    /// The requested error in pixels, for methods with a tolerance.
    pub(super) tolerance: Option<f64>,
    /// The number of steps, for methods with fixed steps.
    pub(super) steps: Option<u32>,
}

/// A method and its name in the table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Series {
    pub(super) name: &'static str,
    pub(super) kind: Kind,
}

/// How a method gets from pixels to ends.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Kind {
    /// The thesis' Runge–Kutta method for each pixel.
    Rk4,
    /// Adaptive steps for each pixel.
    Adaptive,
    /// Shared rays, linear between them.
    FanLinear,
    /// Shared rays with their Jacobi fields.
    Fan,
}

/// All methods, the thesis' first.
pub(super) const SERIES: [Series; 4] = [
    Series {
        name: "rk4-pixel f64",
        kind: Kind::Rk4,
    },
    Series {
        name: "adaptive",
        kind: Kind::Adaptive,
    },
    Series {
        name: "fan-linear",
        kind: Kind::FanLinear,
    },
    Series {
        name: "fan",
        kind: Kind::Fan,
    },
];

/// The steps of the thesis' method.
pub(super) const STEPS: [u32; 10] = [4, 6, 8, 12, 16, 32, 64, 128, 256, 512];
/// The tolerances, in pixels.
pub(super) const TOLERANCES: [f64; 5] = [1.0, 0.3, 0.1, 0.01, 0.001];

impl Kind {
    /// Whether the cost of a pixel does not depend on how many there are.
    pub(super) fn is_pixel_by_pixel(self) -> bool {
        matches!(self, Self::Rk4 | Self::Adaptive)
    }

    /// The options of a map; without a number of steps or a tolerance the method's usual ones.
    pub(super) fn options(self, steps: Option<u32>, tolerance: Option<f64>) -> MapOptions {
        let method = match self {
            Self::Rk4 => Method::Rk4 {
                steps: steps.unwrap_or(128),
            },
            Self::Adaptive => Method::Adaptive,
            Self::FanLinear => Method::FanLinear,
            Self::Fan => Method::Fan,
        };
        MapOptions {
            method,
            tolerance: tolerance.unwrap_or(0.1),
            by_pixel: false,
            ..MapOptions::default()
        }
    }
}

impl Setting {
    /// Every method with every setting.
    pub(super) fn all() -> Vec<Self> {
        let settings = SERIES.iter().enumerate().map(|(series, method)| {
            let by_steps = STEPS.map(|steps| Self {
                series,
                tolerance: None,
                steps: Some(steps),
            });
            let by_tolerance = TOLERANCES.map(|tolerance| Self {
                series,
                tolerance: Some(tolerance),
                steps: None,
            });
            match method.kind {
                Kind::Rk4 => by_steps.to_vec(),
                _ => by_tolerance.to_vec(),
            }
        });
        settings.flatten().collect()
    }

    pub(super) fn method(&self) -> Series {
        SERIES[self.series]
    }

    /// The setting in words.
    pub(super) fn text(&self) -> String {
        match (self.steps, self.tolerance) {
            (Some(steps), _) => format!("{steps} steps"),
            (None, Some(tolerance)) => format!("{tolerance} px"),
            (None, None) => String::new(),
        }
    }
}
