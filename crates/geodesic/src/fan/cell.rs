//! Interpolation between two rays. In: two rays and a point between them. Out: the end of the geodesic there.

use std::f64::consts::PI;

use super::border::{Stretch, edge, is_stretched};
use super::coordinates::FanChart;
use super::creases;
use super::ray::{Ray, Sample};
use crate::chart::{ChartLayout, turned};
use crate::ends::{Coordinates, End};
use crate::fan::Interpolation;
use crate::status::Status;

/// The result for a point between two rays.
#[derive(Clone, Copy, Debug)]
pub(super) enum Found {
    /// The geodesic's end.
    Point(Point),
    /// The geodesic ended earlier.
    Ended(Status),
    /// The geodesic left through an edge; its continuation would end here.
    Beyond(Point),
    /// The rays do not determine it.
    Unknown,
}

/// An end with its derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point<const D: usize = 2> {
    pub(crate) chart: FanChart,
    pub(crate) at: [f64; D],
    /// The unit tangent.
    pub(crate) along: [f64; D],
    /// The derivative by the angle.
    pub(crate) turning: [f64; D],
    /// The unit normal, approximately.
    pub(crate) normal: [f64; D],
}

impl Point {
    /// m: the component of the derivative by the angle along the normal.
    #[inline(always)]
    pub(super) fn m(&self) -> f64 {
        determinant(self.along, self.turning) / determinant(self.along, self.normal)
    }

    #[inline(always)]
    fn is_finite(&self) -> bool {
        (self.at[0] + self.at[1] + self.along[0] + self.turning[0]).is_finite()
    }

    /// Returns whether the point is in the plain coordinates.
    fn is_plain(&self) -> bool {
        self.chart.is_plain() && self.is_finite()
    }

    /// Converts to an [`End`] at the arc length `s` > 0.
    #[inline(always)]
    pub(super) fn end(&self, layout: &ChartLayout, s: f64, error: f64) -> End {
        let m = self.m();
        let stretch = m / s;
        let across = if stretch.abs() > 0.1 {
            [self.turning[0] / m, self.turning[1] / m]
        } else {
            self.normal
        };
        let end = End {
            coordinates: Coordinates::Plain,
            at: self.at,
            along: self.along,
            across,
            stretch,
            status: Status::Complete,
            error,
        };
        if self.chart.is_plain() {
            return end;
        }
        match self.chart.apex_chart(layout) {
            Some(chart) if !chart.apex.smooth => End {
                at: chart.plain_point(self.at),
                along: chart.plain_vector(self.at, self.along),
                across: chart.plain_vector(self.at, across),
                ..end
            },
            _ => End {
                coordinates: self.chart.kind,
                ..end
            },
        }
    }
}

#[inline(always)]
pub(super) fn determinant(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Converts a sample to other coordinates.
fn convert(layout: &ChartLayout, sample: &Sample, chart: FanChart) -> Sample {
    if sample.chart.is_same(&chart) {
        return *sample;
    }
    let (from, to) = (sample.chart.apex_chart(layout), chart.apex_chart(layout));
    if let (true, Some(apex)) = (sample.chart.kind == chart.kind, &to) {
        // A cone unrolled along another line.
        // `together` has checked that the tip is not between them.
        let (sin, cos) = (apex.apex.rate * (sample.chart.reference - chart.reference)).sin_cos();
        let turn = |vector| turned([cos, sin], vector);
        return Sample {
            chart,
            at: turn(sample.at),
            along: turn(sample.along),
            jacobi: sample.jacobi.map(turn),
            normal: turn(sample.normal),
        };
    }
    let plain = from.map_or(*sample, |from| {
        let vector = |v| from.plain_vector(sample.at, v);
        Sample {
            chart: FanChart::PLAIN,
            at: from.plain_point(sample.at),
            along: vector(sample.along),
            jacobi: [vector(sample.jacobi[0]), [f64::NAN; 2]],
            normal: vector(sample.normal),
        }
    });
    to.map_or(plain, |to| {
        let vector = |v| to.vector(plain.at, v);
        Sample {
            chart,
            at: to.point(plain.at),
            along: vector(plain.along),
            jacobi: [vector(plain.jacobi[0]), [f64::NAN; 2]],
            normal: vector(plain.normal),
        }
    })
}

/// Converts both samples to common coordinates: those of an apex where both are near it.
#[inline(never)]
fn together(layout: &ChartLayout, a: Sample, mut b: Sample) -> (Sample, Sample) {
    let charts = [a, b].map(|sample| layout.apex_chart(sample.chart.kind));
    if let (true, Some(apex)) = (a.chart.kind == b.chart.kind, charts[0])
        && !apex.apex.smooth
    {
        // The tip of a cone is between both: there is no surface there, only the cut along which it was unrolled.
        let angle = |sample: &Sample| {
            sample.at[1].atan2(sample.at[0]) + apex.apex.rate * sample.chart.reference
        };
        if (angle(&a) - angle(&b)).abs() > PI {
            b.at = [f64::NAN; 2];
        }
    }
    if a.chart.is_same(&b.chart) {
        return (a, b);
    }
    let chart = match charts {
        [Some(_), Some(_)] if a.chart.kind == b.chart.kind => a.chart,
        [Some(pole), None] if pole.apex.smooth && pole.holds(b.at) => a.chart,
        [None, Some(pole)] if pole.apex.smooth && pole.holds(a.at) => b.chart,
        _ => FanChart::PLAIN,
    };
    (convert(layout, &a, chart), convert(layout, &b, chart))
}

/// Returns both rays at an arc length, in common coordinates; `None` where they are not known there.
pub(super) fn pair(
    layout: &ChartLayout,
    [a, b]: [&Ray; 2],
    width: f64,
    s: f64,
) -> Option<(Sample, Sample)> {
    let (mut a, mut b) = (a.at(s)?, b.at(s)?);
    if !a.chart.is_plain() || !b.chart.is_plain() {
        (a, b) = together(layout, a, b);
    }
    if a.chart.is_plain() {
        lift(&a, &mut b, layout.periods(), width);
    }
    Some((a, b))
}

/// Interpolates at the arc length `s` and the fraction `t` of the way between rays that are `width` apart in angle.
#[inline(always)]
pub(super) fn between(
    layout: &ChartLayout,
    interpolation: Interpolation,
    [a, b]: [&Ray; 2],
    width: f64,
    t: f64,
    s: f64,
) -> Option<Point> {
    let stretched = Stretch::of([a, b], width, t);
    let (mut a, mut b) = match &stretched {
        None => (a.at(s)?, b.at(s)?),
        Some(stretch) => {
            let share = s / stretch.s;
            (
                a.at(share * stretch.ends[0])?,
                b.at(share * stretch.ends[1])?,
            )
        }
    };
    if !a.chart.is_plain() || !b.chart.is_plain() {
        (a, b) = together(layout, a, b);
    }
    if let Some(stretch) = &stretched {
        for (ray, slope) in [&mut a, &mut b].into_iter().zip(stretch.slopes) {
            let slope = slope * s / stretch.s;
            ray.jacobi[0] = [0, 1].map(|k| ray.jacobi[0][k] + slope * ray.along[k]);
            ray.jacobi[1] = [f64::NAN; 2];
        }
    }
    if a.chart.is_plain() {
        lift(&a, &mut b, layout.periods(), width);
    }
    let mut point = match interpolation {
        Interpolation::Hermite => hermite(&a, &b, width, t),
        Interpolation::Linear => Point {
            chart: a.chart,
            at: mix(a.at, b.at, t),
            along: mix(a.along, b.along, t),
            turning: [0, 1].map(|k| (b.at[k] - a.at[k]) / width),
            normal: mix(a.normal, b.normal, t),
        },
    };
    if let Some(stretch) = &stretched {
        // Convert from constant fractions of the way to the edge back to constant arc length.
        let slope = stretch.slope * s / stretch.s;
        for (turning, along) in point.turning.iter_mut().zip(point.along) {
            *turning -= slope * along;
        }
    }
    Some(point)
}

#[inline(always)]
fn mix<const D: usize>(x: [f64; D], y: [f64; D], t: f64) -> [f64; D] {
    let rest = 1.0 - t;
    std::array::from_fn(|k| rest * x[k] + t * y[k])
}

/// Interpolates between two samples in common coordinates, by their positions and Jacobi fields.
#[inline(always)]
pub(crate) fn hermite<const D: usize>(
    a: &Sample<D>,
    b: &Sample<D>,
    width: f64,
    t: f64,
) -> Point<D> {
    let rest = 1.0 - t;
    let (h00, h10) = ((1.0 + 2.0 * t) * rest * rest, width * t * rest * rest);
    let (h01, h11) = (t * t * (3.0 - 2.0 * t), -width * t * t * rest);
    let (d0, d1) = (6.0 * t * rest / width, 1.0 - t * (4.0 - 3.0 * t));
    let d2 = t * (3.0 * t - 2.0);
    let (j, k) = (&a.jacobi, &b.jacobi);
    let (mut at, mut along, mut turning) = ([0.0; D], [0.0; D], [0.0; D]);
    for n in 0..D {
        at[n] = h00 * a.at[n] + h01 * b.at[n] + h10 * j[0][n] + h11 * k[0][n];
        along[n] = h00 * a.along[n] + h01 * b.along[n] + h10 * j[1][n] + h11 * k[1][n];
        turning[n] = d0 * (b.at[n] - a.at[n]) + d1 * j[0][n] + d2 * k[0][n];
    }
    if !along.iter().sum::<f64>().is_finite() {
        along = mix(a.along, b.along, t);
    }
    Point {
        chart: a.chart,
        at,
        along,
        turning,
        normal: mix(a.normal, b.normal, t),
    }
}

/// Returns the point between two rays that are both known to continue at the arc length `s` and do not end at an
/// oblique edge: the same as [`end_between`] returns, at lower cost. `None` where they are not in the plain coordinates, or
/// where the general case applies.
#[inline(always)]
pub(super) fn free_end_between(
    layout: &ChartLayout,
    periods: [f64; 2],
    rays: [&Ray; 2],
    width: f64,
    t: f64,
    s: f64,
) -> Option<Point> {
    let (a, mut b) = (rays[0].at(s)?, rays[1].at(s)?);
    if !a.chart.is_plain() || !b.chart.is_plain() {
        return None;
    }
    lift(&a, &mut b, periods, width);
    let point = hermite(&a, &b, width, t);
    (point.is_finite() && layout.beyond_edge(point.at).is_none()).then_some(point)
}

/// Brings the second sample near the first one: behind a pole their lifts may be periods apart, and the field predicts
/// where the neighbour is.
#[inline(always)]
fn lift(a: &Sample, b: &mut Sample, periods: [f64; 2], width: f64) {
    for (k, period) in periods.into_iter().enumerate() {
        if period > 0.0 {
            let expected = 0.5 * width * (a.jacobi[0][k] + b.jacobi[0][k]);
            let off = b.at[k] - a.at[k] - expected;
            b.at[k] -= period * (off / period).round();
        }
    }
}

/// Returns the result at the fraction `t` of the way between two rays, at the arc length `s`.
#[inline(always)]
pub(super) fn end_between(
    layout: &ChartLayout,
    interpolation: Interpolation,
    rays: [&Ray; 2],
    width: f64,
    t: f64,
    s: f64,
) -> Found {
    if creases::is_hidden(rays, s) {
        return Found::Unknown;
    }
    let unknown = |ray: &Ray| {
        ray.stop
            .is_some_and(|stop| stop.status == Status::WorkLimit && s > stop.s)
    };
    if rays.into_iter().any(unknown) {
        return Found::Unknown;
    }
    let first = rays[0].limit().min(rays[1].limit());
    let stretched = is_stretched(rays);
    // A ray that has left through an edge continues slightly beyond it: there the end itself determines where it is.
    let leaves = |ray: &Ray| {
        ray.stop
            .is_none_or(|stop| stop.status == Status::LeftDomain)
    };
    let shows_its_end = !stretched && rays.into_iter().all(leaves);
    if s > first
        && !shows_its_end
        && let Some((edge, status)) = edge(rays, width, t)
        && s > edge
    {
        return match between(layout, interpolation, rays, width, t, s) {
            Some(point) if status == Status::LeftDomain && point.is_plain() => Found::Beyond(point),
            _ => Found::Ended(status),
        };
    }
    let Some(point) = between(layout, interpolation, rays, width, t, s) else {
        return match edge(rays, width, t) {
            Some((edge, status)) if s > edge => Found::Ended(status),
            _ => Found::Unknown,
        };
    };
    if !stretched
        && point.chart.is_plain()
        && let Some((axis, end)) = layout.beyond_edge(point.at)
    {
        return if layout.apexes[axis][end].is_some() {
            Found::Ended(Status::ConePoint)
        } else if point.is_plain() {
            Found::Beyond(point)
        } else {
            Found::Ended(Status::LeftDomain)
        };
    }
    if point.is_finite() {
        Found::Point(point)
    } else {
        Found::Unknown
    }
}

/// Returns the length on the surface between a third ray and the prediction of it from two rays, at an arc length, and
/// an estimate of the largest odd error, which does not appear in the middle. `None` where there is nothing to compare.
pub(super) fn discrepancy(
    layout: &ChartLayout,
    interpolation: Interpolation,
    rays: [&Ray; 2],
    width: f64,
    middle: &Ray,
    t: f64,
    s: f64,
) -> Option<f64> {
    let [a, b] = rays;
    if [[a, b], [a, middle], [b, middle]]
        .into_iter()
        .any(|pair| creases::is_hidden(pair, s))
    {
        return None;
    }
    let truth = middle.at(s)?;
    let guess = between(layout, interpolation, rays, width, t, s)?;
    let guess = Sample {
        chart: guess.chart,
        at: guess.at,
        along: guess.along,
        jacobi: [guess.turning, [f64::NAN; 2]],
        normal: guess.normal,
    };
    let (truth, guess) = together(layout, truth, guess);
    let mut off = [0, 1].map(|k| guess.at[k] - truth.at[k]);
    if truth.chart.is_plain() {
        let periods = layout.periods();
        for k in 0..2 {
            if periods[k] > 0.0 {
                off[k] -= periods[k] * (off[k] / periods[k]).round();
            }
        }
    }
    let area = determinant(truth.along, truth.normal);
    let length = |v: [f64; 2]| {
        let (x, y) = (determinant(v, truth.normal), determinant(truth.along, v));
        (x * x + y * y).sqrt() / area.abs()
    };
    let bend = match interpolation {
        // An error odd about the middle appears only in its slope there.
        Interpolation::Hermite if t == 0.5 => {
            0.143 * width * length([0, 1].map(|k| guess.jacobi[0][k] - truth.jacobi[0][k]))
        }
        _ => 0.0,
    };
    Some(length(off).max(bend))
}
