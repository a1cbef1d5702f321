//! Where a fan starts: a frame and a picture's size in, runners for any direction out.

use std::f64::consts::TAU;

use super::coordinates::{Chart, Kind, Space};
use super::march::Runner;
use crate::chart::{self, Atlas, Motion};
use crate::ends::{Coordinates, End};
use crate::frame::Frame;
use crate::metric::{Metric, speed};
use crate::surface::Surface;
use crate::trace::{self, Status};

/// The start of all rays.
#[derive(Clone, Debug)]
pub(super) struct Start {
    pub(super) frame: Frame,
    pub(super) zoom: f64,
    /// A pixel's width on the surface, at the centre.
    pub(super) pixel: f64,
    /// The distance to the picture's corners on the surface.
    pub(super) reach: f64,
    /// The picture's half width and half height on the surface.
    half: [f64; 2],
    /// +1 where Y lies to the left of X, −1 where to the right.
    pub(super) side: f64,
    chart: Chart,
    at: [f64; 2],
    /// The unit vectors along X and Y.
    axes: [[f64; 2]; 2],
}

impl Start {
    /// `None` where no geodesic can start.
    pub(super) fn of<S: Surface + ?Sized>(
        surface: &S,
        space: &Space,
        frame: &Frame,
        size: [u32; 2],
    ) -> Option<Self> {
        let atlas = Atlas::new(surface);
        let metric = Metric::of(&atlas.jet(frame.uv));
        let (x, _) = trace::unit_start(&atlas, frame.uv, frame.x).ok()?;
        let (y, _) = trace::unit_start(&atlas, frame.uv, frame.y).ok()?;
        let zoom = speed(&atlas.jet(x.at), frame.x);
        let least = f64::from(size[0].min(size[1]).max(1));
        let half = size.map(|n| zoom * f64::from(n.max(1)) / least);
        let side = if metric.inner(metric.turn_left(frame.x), frame.y) < 0.0 {
            -1.0
        } else {
            1.0
        };
        if !(zoom.is_finite() && zoom > 0.0) {
            return None;
        }
        let mut start = Self {
            frame: *frame,
            zoom,
            pixel: 2.0 * zoom / least,
            reach: half[0].hypot(half[1]),
            half,
            side,
            chart: Chart::PLAIN,
            at: x.at,
            axes: [x.velocity, y.velocity],
        };
        if let (Some(chart), chart::Chart::Apex(near)) =
            (space.chart_near(x.at), atlas.chart_for(x.at))
            && let Some(tip) = space.tip(chart.kind)
        {
            // Near a pole directions in space are kept; the coordinates found have the start on their a-axis.
            let enter = |motion: Motion| atlas.enter(&near, motion).map(|(motion, _)| motion);
            let (x, y) = (enter(x)?, enter(y)?);
            let (sin, cos) = (tip.apex.rate * (start.at[1 - tip.axis] - chart.reference)).sin_cos();
            let turn = |[a, b]: [f64; 2]| [cos * a - sin * b, sin * a + cos * b];
            start.at = turn(x.at);
            start.axes = [turn(x.velocity), turn(y.velocity)];
            start.chart = chart;
        }
        Some(start)
    }

    /// A ray from X towards Y by an angle, at least as long as the picture is wide within `around` of it.
    pub(super) fn runner(&self, angle: f64, around: f64, first: f64) -> Runner {
        let (sin, cos) = angle.sin_cos();
        let velocity = [0, 1].map(|k| cos * self.axes[0][k] + sin * self.axes[1][k]);
        let length = self.border(angle, around) + 2.0 * self.pixel;
        Runner::new(
            angle, length, self.chart, self.at, velocity, self.side, first,
        )
    }

    /// The farthest that the picture reaches within `around` of an angle.
    pub(super) fn border(&self, angle: f64, around: f64) -> f64 {
        let corner = self.half[1].atan2(self.half[0]);
        let [right, up] = self.half;
        let border = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            (right / cos.abs()).min(up / sin.abs())
        };
        let holds_corner = [corner, TAU / 2.0 - corner, TAU / 2.0 + corner, TAU - corner]
            .into_iter()
            .any(|corner| {
                let off = (angle - corner).rem_euclid(TAU);
                off.min(TAU - off) <= around
            });
        if holds_corner {
            self.reach
        } else {
            border(angle - around).max(border(angle + around))
        }
    }

    /// The end of the ray of no length.
    pub(super) fn centre(&self, space: &Space) -> End {
        let smooth = space
            .tip(self.chart.kind)
            .is_some_and(|tip| tip.apex.smooth);
        let (coordinates, at, [along, across]) = match self.chart.kind {
            Kind::Apex { axis, end } if smooth => {
                (Coordinates::Apex { axis, end }, self.at, self.axes)
            }
            _ => {
                let unit = [self.frame.x, self.frame.y].map(|v| v.map(|x| x / self.zoom));
                (Coordinates::Plain, self.frame.uv, unit)
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
