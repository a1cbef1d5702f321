//! A ray on its way from step to step, and what remains of it in the end.

use super::coordinates::FanChart;
use super::ray::{Knot, Ray, Segment, Stop};
use super::sectors::{BINS, Profile, bin};
use crate::chart::{ChartLayout, State};
use crate::status::Status;
use crate::step_control::{ErrorSum, StepControl};

/// A ray on its way.
#[derive(Clone, Debug)]
pub(super) struct ActiveRay {
    /// Its place in the request.
    pub(super) id: usize,
    pub(super) angle: f64,
    pub(super) length: f64,
    /// The share of the group's allowed error that it is allowed itself.
    pub(super) tolerance_share: f64,
    pub(super) chart: FanChart,
    pub(super) at: [f64; 2],
    pub(super) velocity: [f64; 2],
    /// +1 where the frame's Y lies to the left of X in the plain coordinates, −1 where to the right.
    pub(super) side: f64,
    pub(super) m: [f64; 2],
    pub(super) s: f64,
    pub(super) h: f64,
    pub(super) control: StepControl,
    /// The angle about an apex, going on over more than a turn.
    pub(super) turned: f64,
    pub(super) steps: u64,
    pub(super) rejected: u64,
    pub(super) evaluations: u64,
    pub(super) segments: Vec<Segment>,
    pub(super) stop: Option<Stop>,
    pub(super) done: bool,
    /// Steps beyond an edge.
    pub(super) beyond: u32,
    /// The steps' errors so far.
    pub(super) errors: ErrorSum,
    /// The largest standard deviation of the position on the way, in each range of radius.
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
            done: false,
            beyond: 0,
            errors: ErrorSum::default(),
            off: [0.0; BINS],
        }
    }

    /// The arc length for which it is still to be followed: to its length, or so far `beyond` the edge through which it has left.
    pub(super) fn way(&self, beyond: f64) -> f64 {
        let end = match &self.stop {
            None => self.length,
            Some(stop) => self.length.min(stop.s + beyond),
        };
        end - self.s
    }

    /// Takes a step of the length `h` to a knot; `fields` is what (1, 0) and (0, 1) have become, [(n, m), (n', m')].
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

    /// Takes note of the error between two arc lengths, the ranges of radius being those within `reach`.
    pub(super) fn note_error(&mut self, from: f64, to: f64, reach: f64) {
        let error = self.errors.deviation() as f32;
        for off in &mut self.off[bin(from, reach)..=bin(to, reach)] {
            *off = off.max(error);
        }
    }

    /// The ray, once it is done.
    pub(super) fn finish(self) -> Ray {
        let mut ray = Ray::new(self.angle, &self.segments, self.stop);
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
            told: false,
        });
    }

    /// Notes the edge that it has left through, and the change of its place with the angle.
    pub(super) fn aim(&mut self, axis: usize, end: usize) {
        let knots = self
            .segments
            .last()
            .map(|segment| (segment.chart.is_plain(), segment.knots.as_slice()));
        let (Some(stop), Some((true, [.., a, b]))) = (&mut self.stop, knots) else {
            return;
        };
        stop.edge = Some((axis, end));
        // Between the knots the field and the velocity change little enough for a slope.
        let share = ((stop.s - a.s) / (b.s - a.s)).clamp(0.0, 1.0);
        let jacobi = |knot: &Knot| knot.m[0] * knot.normal[0][axis];
        let mix = |x: f64, y: f64| x + share * (y - x);
        stop.slope = -mix(jacobi(a), jacobi(b)) / mix(a.velocity[axis], b.velocity[axis]);
        stop.told = stop.slope.is_finite();
    }

    /// Its point and velocity.
    pub(super) fn state(&self) -> State {
        State {
            at: self.at,
            velocity: self.velocity,
        }
    }

    /// Its point and velocity in the plain coordinates.
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

    /// Goes over to other coordinates.
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
