//! A ray during integration, step by step, and the finished ray that it becomes.

use super::coordinates::FanChart;
use super::ray::{CreasePassage, Knot, Ray, Segment, Stop};
use super::sectors::{BINS, Profile, bin};
use crate::chart::{ChartLayout, State};
use crate::status::Status;
use crate::step_control::{ErrorSum, StepControl};

/// A ray during integration.
#[derive(Clone, Debug)]
pub(super) struct ActiveRay {
    /// Its index in the request.
    pub(super) id: usize,
    pub(super) angle: f64,
    pub(super) length: f64,
    /// The fraction of the group's allowed error that this ray is allowed.
    pub(super) tolerance_share: f64,
    pub(super) chart: FanChart,
    pub(super) at: [f64; 2],
    pub(super) velocity: [f64; 2],
    /// +1 where the frame's Y is to the left of X in the plain coordinates, −1 where to the right.
    pub(super) side: f64,
    pub(super) m: [f64; 2],
    pub(super) s: f64,
    pub(super) h: f64,
    pub(super) control: StepControl,
    /// The angle about an apex, continuous over more than a turn.
    pub(super) turned: f64,
    pub(super) steps: u64,
    pub(super) rejected: u64,
    pub(super) evaluations: u64,
    pub(super) segments: Vec<Segment>,
    pub(super) stop: Option<Stop>,
    /// The smooth piece that it is in.
    pub(super) piece: u64,
    /// The creases passed so far.
    pub(super) passages: Vec<CreasePassage>,
    pub(super) done: bool,
    /// The number of steps beyond an edge.
    pub(super) beyond: u32,
    /// The sum of the steps' errors so far.
    pub(super) errors: ErrorSum,
    /// The largest standard deviation of the position so far, in each range of radius.
    pub(super) off: Profile,
}

impl ActiveRay {
    pub(super) fn new(
        angle: f64,
        length: f64,
        chart: FanChart,
        at: [f64; 2],
        velocity: [f64; 2],
        side: f64,
        h: f64,
    ) -> Self {
        Self {
            id: 0,
            angle,
            length,
            tolerance_share: 1.0,
            chart,
            at,
            velocity,
            side,
            m: [0.0, 1.0],
            s: 0.0,
            h,
            control: StepControl::default(),
            turned: at[1].atan2(at[0]),
            steps: 0,
            rejected: 0,
            evaluations: 0,
            segments: Vec::new(),
            stop: None,
            piece: 0,
            passages: Vec::new(),
            done: false,
            beyond: 0,
            errors: ErrorSum::default(),
            off: [0.0; BINS],
        }
    }

    /// The arc length to integrate in total: the ray's length, or `beyond` past the edge through which it has left.
    pub(super) fn way(&self, beyond: f64) -> f64 {
        let end = match &self.stop {
            None => self.length,
            Some(stop) => self.length.min(stop.s + beyond),
        };
        end - self.s
    }

    /// Takes a step of length `h` to a knot; `fields` is the image of (1, 0) and (0, 1), [(n, m), (n', m')].
    pub(super) fn step(&mut self, h: f64, fields: [[f64; 2]; 2], mut knot: Knot) {
        let [value, rate] = self.m;
        self.m = fields.map(|[n, m]| n * value + m * rate);
        self.steps += 1;
        self.s += h;
        self.at = knot.at;
        self.velocity = knot.velocity;
        knot.s = self.s;
        knot.m = self.m;
        if let Some(segment) = self.segments.last_mut() {
            segment.knots.push(knot);
        }
    }

    /// Records the error between two arc lengths, in the ranges of radius within `reach`.
    pub(super) fn note_error(&mut self, from: f64, to: f64, reach: f64) {
        let error = self.errors.deviation() as f32;
        for off in &mut self.off[bin(from, reach)..=bin(to, reach)] {
            *off = off.max(error);
        }
    }

    /// Returns the finished ray.
    pub(super) fn finish(self, layout: &ChartLayout) -> Ray {
        let mut ray = Ray::new(self.angle, &self.segments, self.stop);
        ray.end_at_return(layout);
        ray.passages = self.passages;
        ray.off = self.off;
        ray.tolerance_share = self.tolerance_share;
        ray
    }

    pub(super) fn stop(&mut self, s: f64, status: Status) {
        self.done = true;
        self.stop = Some(Stop {
            s,
            status,
            edge: None,
            slope: f64::NAN,
            has_own_slope: false,
        });
    }

    /// Records the edge through which the ray has left, and the derivative of the exit point by the angle.
    pub(super) fn aim(&mut self, axis: usize, end: usize) {
        let knots = self
            .segments
            .last()
            .map(|segment| (segment.chart.is_plain(), segment.knots.as_slice()));
        let (Some(stop), Some((true, [.., a, b]))) = (&mut self.stop, knots) else {
            return;
        };
        stop.edge = Some((axis, end));
        // Between the knots the field and the velocity vary slowly enough to determine a slope.
        let share = ((stop.s - a.s) / (b.s - a.s)).clamp(0.0, 1.0);
        let jacobi = |knot: &Knot| knot.m[0] * knot.normal[0][axis];
        let mix = |x: f64, y: f64| x + share * (y - x);
        stop.slope = -mix(jacobi(a), jacobi(b)) / mix(a.velocity[axis], b.velocity[axis]);
        stop.has_own_slope = stop.slope.is_finite();
    }

    /// Returns the point and velocity.
    pub(super) fn state(&self) -> State {
        State {
            at: self.at,
            velocity: self.velocity,
        }
    }

    /// Returns the point and velocity in the plain coordinates.
    pub(super) fn plain(&self, layout: &ChartLayout) -> State {
        let (at, velocity) = (self.at, self.velocity);
        match self.chart.apex_chart(layout) {
            None => State { at, velocity },
            Some(chart) => {
                let velocity = chart.plain_vector(at, velocity);
                let at = chart.plain_polar(at[0].hypot(at[1]), self.turned);
                State { at, velocity }
            }
        }
    }

    /// Changes to other coordinates.
    pub(super) fn enter(&mut self, layout: &ChartLayout, chart: FanChart) {
        let mut state = self.plain(layout);
        if let Some(chart) = chart.apex_chart(layout) {
            self.turned = chart.angle(state.at);
            state = chart.enter(state);
        }
        State {
            at: self.at,
            velocity: self.velocity,
        } = state;
        self.chart = chart;
    }
}
