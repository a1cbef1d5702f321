//! A ray on its way from step to step, and what remains of it in the end.

use super::coordinates::{CoordinateKind, FanChart, Space};
use super::ray::{Knot, Ray, Segment, Stop};
use super::sectors::{BINS, Profile, bin};
use crate::status::Status;

/// A ray on its way.
#[derive(Clone, Debug)]
pub(super) struct ActiveRay {
    /// Its place among those that were asked for.
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
    /// The step before; 0 before the first.
    pub(super) last: f64,
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
    /// The covariance of the steps' errors, carried on by the Jacobi fields: of position, mixed, of direction.
    pub(super) errors: [f64; 3],
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
            last: 0.0,
            turned: at[1].atan2(at[0]),
            steps: 0,
            rejected: 0,
            evaluations: 0,
            segments: Vec::new(),
            stop: None,
            done: false,
            beyond: 0,
            errors: [0.0; 3],
            off: [0.0; BINS],
        }
    }

    /// How far it is still to be followed: to its length, or so far `beyond` the edge through which it has left.
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
        let error = self.errors[0].max(0.0).sqrt() as f32;
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

    /// Says which edge it has left through, and how its place changes with the angle.
    pub(super) fn aim(&mut self, axis: usize, end: usize) {
        let knots = self
            .segments
            .last()
            .map(|segment| (segment.chart.kind, segment.knots.as_slice()));
        let (Some(stop), Some((CoordinateKind::Plain, [.., a, b]))) = (&mut self.stop, knots)
        else {
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

    /// Its point and velocity in the plain coordinates.
    pub(super) fn plain(&self, space: &Space) -> ([f64; 2], [f64; 2]) {
        match space.tip(self.chart.kind) {
            None => (self.at, self.velocity),
            Some(tip) => {
                let mut at = tip.plain_point(self.at, self.chart.reference);
                at[1 - tip.axis] = self.chart.reference + self.turned / tip.apex.rate;
                (at, tip.plain_vector(self.at, self.velocity))
            }
        }
    }

    /// Goes over to other coordinates.
    pub(super) fn enter(&mut self, space: &Space, chart: FanChart) {
        let (at, velocity) = self.plain(space);
        match space.tip(chart.kind) {
            None => (self.at, self.velocity) = (at, velocity),
            Some(tip) => {
                self.at = tip.point(at, chart.reference);
                self.velocity = tip.vector(at, chart.reference, velocity);
                self.turned = tip.apex.rate * (at[1 - tip.axis] - chart.reference);
            }
        }
        self.chart = chart;
    }
}
