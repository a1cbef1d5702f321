//! The start of a fan. In: a frame and a picture's size. Out: active rays in any direction.

use std::f64::consts::{FRAC_PI_2, PI};

use super::FanOptions;
use super::active_ray::ActiveRay;
use super::coordinates::FanChart;
use super::sectors::{BINS, Profile};
use crate::chart::{Atlas, ChartLayout};
use crate::ends::{Coordinates, End};
use crate::frame::Frame;
use crate::integrate::{self, RayEnd};
use crate::point::PicturePoint;
use crate::runge_kutta::{DOP853, DOPRI5};
use crate::status::Status;
use crate::surface::Surface;
use crate::trace;

/// The start of all rays.
#[derive(Clone, Debug)]
pub(super) struct FanStart {
    pub(super) frame: Frame,
    pub(super) zoom: f64,
    /// The width of a pixel at the centre, measured on the surface.
    pub(super) pixel: f64,
    /// The distance to the picture's corners on the surface.
    pub(super) reach: f64,
    /// The picture's half width and half height on the surface.
    half: [f64; 2],
    /// +1 where Y is to the left of X, −1 where to the right.
    pub(super) side: f64,
    chart: FanChart,
    at: [f64; 2],
    /// The unit vectors along X and Y.
    axes: [[f64; 2]; 2],
}

impl FanStart {
    /// Returns `None` where no geodesic can start.
    pub(super) fn of(
        surface: &dyn Surface,
        layout: &ChartLayout,
        frame: &Frame,
        size: [u32; 2],
    ) -> Option<Self> {
        let atlas = Atlas::new(surface);
        let zoom = frame.zoom(surface);
        if !(zoom.is_finite() && zoom > 0.0) {
            return None;
        }
        let [x, y] = [[1.0, 0.0], [0.0, 1.0]].map(|place| frame.start(&atlas, place.into()).ok());
        let (x, y) = (x?, y?);
        let least = f64::from(size[0].min(size[1]).max(1));
        let half = size.map(|n| zoom * f64::from(n.max(1)) / least);
        let mut start = Self {
            frame: *frame,
            zoom,
            pixel: 2.0 * zoom / least,
            reach: half[0].hypot(half[1]),
            half,
            side: if frame.is_mirrored(surface) {
                -1.0
            } else {
                1.0
            },
            chart: FanChart::PLAIN,
            at: frame.uv.0,
            axes: [[0.0; 2]; 2],
        };
        let state = |start: &integrate::Start| match start {
            integrate::Start::Plain(state) | integrate::Start::About(_, state) => *state,
        };
        start.at = state(&x).at;
        start.axes = [state(&x).velocity, state(&y).velocity];
        match x {
            integrate::Start::About(chart, _) => start.chart = FanChart::of(&chart),
            integrate::Start::Plain(_) => {
                if let Some(chart) = layout.chart_near(start.at) {
                    let at = start.at;
                    start.at = chart.point(at);
                    start.axes = start.axes.map(|v| chart.vector(at, v));
                    start.chart = FanChart::of(&chart);
                }
            }
        }
        Some(start)
    }

    /// Creates the ray at an angle from X towards Y, at least as long as the picture extends within `around` of it.
    pub(super) fn ray(&self, angle: f64, around: f64, first: f64) -> ActiveRay {
        let (sin, cos) = angle.sin_cos();
        let velocity = [0, 1].map(|k| cos * self.axes[0][k] + sin * self.axes[1][k]);
        let length = self.border(angle, around) + 2.0 * self.pixel;
        ActiveRay::new(
            angle, length, self.chart, self.at, velocity, self.side, first,
        )
    }

    /// Returns the farthest extent of the picture within `around` of an angle.
    pub(super) fn border(&self, angle: f64, around: f64) -> f64 {
        let [right, up] = self.half;
        let (corner, here) = (up.atan2(right), fold(angle));
        if (here - corner).abs() <= around || here - around <= 0.0 && around >= corner {
            return self.reach;
        }
        // The nearer to a corner, the farther.
        let toward = if here < corner {
            here + around
        } else {
            here - around
        };
        let (sin, cos) = toward.sin_cos();
        (right / cos.abs()).min(up / sin.abs()).min(self.reach)
    }

    /// Returns the visible fractions of the errors in the middle of a sector, of its first and of its second ray, for each
    /// range of radius: towards a corner of the picture only the part near one of the rays is visible. `bulge` is the error's
    /// shape between them.
    pub(super) fn seen(&self, angle: f64, width: f64, bulge: fn(f64) -> f64) -> [Profile; 3] {
        let mut seen = [[1.0; BINS]; 3];
        let (a, b) = (fold(angle), fold(angle + width));
        if ((b - a).abs() - width).abs() > 1e-9 {
            // The sector spans an axis of the picture, and extends to the border there.
            return seen;
        }
        let [right, up] = self.half;
        for n in 0..BINS {
            let s = self.reach * n as f64 / BINS as f64;
            let low = if s > right { (right / s).acos() } else { 0.0 };
            let high = if s > up { (up / s).asin() } else { FRAC_PI_2 };
            let (x, y) = ((low - a) / (b - a), (high - a) / (b - a));
            let (first, last) = (x.min(y).max(0.0), x.max(y).min(1.0));
            let shares = if first > last {
                [0.0; 3]
            } else {
                let near = |t: f64| (1.0 + 2.0 * t) * (1.0 - t) * (1.0 - t);
                [
                    bulge(0.5_f64.clamp(first, last)),
                    near(first),
                    near(1.0 - last),
                ]
            };
            for (seen, share) in seen.iter_mut().zip(shares) {
                seen[n] = share as f32;
            }
        }
        seen
    }

    /// Integrates one geodesic on its own, to the arc length `s` in the direction of a place in the picture; `None` where it
    /// cannot start. Each of up to two integrations takes at most `limit` evaluations.
    pub(super) fn follow(
        &self,
        atlas: &Atlas<'_>,
        options: &FanOptions,
        place: PicturePoint,
        s: f64,
        limit: usize,
    ) -> Option<RayEnd> {
        let from = self.frame.start(atlas, place).ok()?;
        let tolerance = (0.1 * options.tolerance * self.pixel / self.reach).clamp(1e-13, 1e-3);
        let mut plan = integrate::IntegrationPlan {
            tableau: &DOPRI5,
            tolerance: Some(tolerance),
            step: trace::first_step(atlas, s),
            limit: atlas.evaluations() + limit,
            charts: true,
            keep_path: false,
        };
        let end = integrate::integrate(atlas, from, s, plan);
        let allowed = 0.5 * options.tolerance * self.pixel;
        if end.error <= allowed || end.status != Status::Complete {
            return Some(end);
        }
        // Errors have grown along the way, as they do in chaos: repeat with a correspondingly smaller tolerance.
        plan.tableau = &DOP853;
        plan.tolerance = Some((tolerance * allowed / end.error).max(1e-14));
        plan.limit = atlas.evaluations() + limit;
        Some(integrate::integrate(atlas, from, s, plan))
    }

    /// Returns the end of the ray of length zero.
    pub(super) fn centre(&self, layout: &ChartLayout) -> End {
        let (coordinates, at, [along, across]) = match layout.pole_chart(self.chart.kind) {
            Some(chart) => (chart.coordinates(), self.at, self.axes),
            None => {
                let unit = [self.frame.x, self.frame.y].map(|v| v.map(|x| x / self.zoom).0);
                (Coordinates::Plain, self.frame.uv.0, unit)
            }
        };
        End {
            coordinates,
            at,
            along,
            across,
            stretch: 1.0,
            status: Status::Complete,
            error: 0.0,
        }
    }
}

/// Maps a direction by symmetry to the quadrant between the right and the top.
fn fold(angle: f64) -> f64 {
    let turned = (angle / PI).fract().abs() * PI;
    turned.min(PI - turned)
}
