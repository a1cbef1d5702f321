//! The methods that are measured, and their settings.

use geodesic::map::{MapMethod, MapOptions};

/// The names of the methods, in the order of the tables; the thesis' method is the first.
pub(super) const NAMES: [&str; 4] = ["rk4-pixel f64", "adaptive", "fan-linear", "fan"];
/// The numbers of steps of the thesis' method.
pub(super) const STEPS: [u32; 10] = [4, 6, 8, 12, 16, 32, 64, 128, 256, 512];
/// The tolerances of the other methods, in pixels.
const TOLERANCES: [f64; 5] = [1.0, 0.3, 0.1, 0.01, 0.001];

/// A method with one of its settings.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setting {
    method: MapMethod,
    /// The requested error in pixels; `None` for the thesis' method, which has a number of steps instead.
    pub(super) tolerance: Option<f64>,
}

impl Setting {
    /// All methods with all their settings.
    pub(super) fn all() -> Vec<Self> {
        let by_steps = STEPS.map(Self::with_steps);
        let adaptive = [MapMethod::Adaptive, MapMethod::FanLinear, MapMethod::Fan];
        let by_tolerance = adaptive
            .map(|method| TOLERANCES.map(|tolerance| Self::with_tolerance(method, tolerance)));
        by_steps
            .into_iter()
            .chain(by_tolerance.into_iter().flatten())
            .collect()
    }

    /// The thesis' method with a number of steps.
    pub(super) fn with_steps(steps: u32) -> Self {
        Self {
            method: MapMethod::Rk4 { steps },
            tolerance: None,
        }
    }

    /// Another method with a tolerance in pixels.
    pub(super) fn with_tolerance(method: MapMethod, tolerance: f64) -> Self {
        Self {
            method,
            tolerance: Some(tolerance),
        }
    }

    /// The name of the method, one of [`NAMES`].
    pub(super) fn name(&self) -> &'static str {
        match self.method {
            MapMethod::Rk4 { .. } => NAMES[0],
            MapMethod::Adaptive => NAMES[1],
            MapMethod::FanLinear => NAMES[2],
            MapMethod::Fan => NAMES[3],
        }
    }

    /// The number of steps of the thesis' method.
    pub(super) fn steps(&self) -> Option<u32> {
        match self.method {
            MapMethod::Rk4 { steps } => Some(steps),
            _ => None,
        }
    }

    /// Reports whether the cost of a pixel is independent of the number of pixels.
    pub(super) fn is_pixel_by_pixel(&self) -> bool {
        matches!(self.method, MapMethod::Rk4 { .. } | MapMethod::Adaptive)
    }

    /// The options of a map.
    pub(super) fn options(&self) -> MapOptions {
        MapOptions {
            method: self.method,
            tolerance: self.tolerance.unwrap_or(0.1),
            by_pixel: false,
            ..MapOptions::default()
        }
    }

    /// The setting in words.
    pub(super) fn text(&self) -> String {
        match (self.steps(), self.tolerance) {
            (Some(steps), _) => format!("{steps} steps"),
            (None, Some(tolerance)) => format!("{tolerance} px"),
            (None, None) => String::new(),
        }
    }
}
