//! A ray with dense output. In: knots of an integration. Out: position, Jacobi field and their derivatives at any arc
//! length.

use super::coordinates::FanChart;
use super::sectors::{BINS, Profile, most};
use crate::chart::ChartLayout;
use crate::interpolate::quintic;
use crate::status::Status;
use crate::step_path::range;

/// A ray's state at the end of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Knot<const D: usize = 2> {
    pub(crate) s: f64,
    pub(crate) at: [f64; D],
    pub(crate) velocity: [f64; D],
    pub(crate) acceleration: [f64; D],
    /// The Jacobi field m and its derivative.
    pub(crate) m: [f64; 2],
    /// The unit normal and its derivative.
    pub(crate) normal: [[f64; D]; 2],
}

impl<const D: usize> Knot<D> {
    /// Returns the k-th component of the field J = m·N, and of J'.
    fn jacobi(&self, k: usize) -> [f64; 2] {
        let [m, m1] = self.m;
        let ([n, n1], k) = ([self.normal[0], self.normal[1]], k);
        [m * n[k], m1 * n[k] + m * n1[k]]
    }
}

/// Knots in common coordinates.
#[derive(Clone, Debug)]
pub(crate) struct Segment<const D: usize = 2> {
    pub(crate) chart: FanChart,
    pub(crate) knots: Vec<Knot<D>>,
}

/// The end of a ray before its full length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stop {
    pub(crate) s: f64,
    pub(crate) status: Status,
    /// The edge through which it leaves.
    pub(crate) edge: Option<(usize, usize)>,
    /// ds/dθ along the edge; NaN where unknown.
    pub(crate) slope: f64,
    /// True if the slope follows from the ray itself, not from its neighbours.
    pub(crate) has_own_slope: bool,
}

/// A crease that a ray has passed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CreasePassage {
    /// The arc lengths of its last point before the crease and its first one behind.
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// The smooth piece behind.
    pub(crate) piece: u64,
}

/// The interpolation between two knots: polynomials in the fraction x ∈ [0,1].
#[derive(Clone, Debug)]
struct Interval<const D: usize> {
    from: f64,
    length: f64,
    chart: FanChart,
    /// `[power][γ, J]`: the coefficients of position and Jacobi field.
    main: [[[f64; D]; 2]; 6],
    /// `[power]`: the coefficients of the normal N.
    normal: [[f64; D]; 4],
}

/// A complete ray.
#[derive(Clone, Debug)]
pub(crate) struct Ray<const D: usize = 2> {
    /// The angle in the frame's plane, from X towards Y.
    pub(crate) angle: f64,
    /// The arc lengths at which the intervals begin.
    starts: Vec<f64>,
    intervals: Vec<Interval<D>>,
    /// For each of equal parts of the length, the last interval that begins before it.
    parts: Vec<u32>,
    by_part: f64,
    /// The arc length at the end of the last interval.
    pub(crate) end: f64,
    /// The length beyond that up to which the intervals are reliable.
    pub(crate) slack: f64,
    pub(crate) stop: Option<Stop>,
    /// The creases that it has passed, in order.
    pub(crate) passages: Vec<CreasePassage>,
    /// The estimated error of its position in each range of radius, up to a factor that is nearly the same for all rays
    /// of a fan.
    pub(crate) off: Profile,
    /// The fraction of the usual error that it was allowed.
    pub(crate) tolerance_share: f64,
}

/// A ray at an arc length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample<const D: usize = 2> {
    pub(crate) chart: FanChart,
    pub(crate) at: [f64; D],
    pub(crate) along: [f64; D],
    /// J and J'.
    pub(crate) jacobi: [[f64; D]; 2],
    pub(crate) normal: [f64; D],
}

/// The maximum number of a ray's steps in which it is compared with others.
const PROBES: usize = 24;
/// The number of parts of each interval beyond an edge at which a ray may be back inside.
const PARTS_BEYOND: u32 = 16;

impl<const D: usize> Ray<D> {
    pub(crate) fn new(angle: f64, segments: &[Segment<D>], stop: Option<Stop>) -> Self {
        let count = segments.iter().map(|segment| segment.knots.len()).sum();
        let mut starts = Vec::with_capacity(count);
        let mut intervals = Vec::with_capacity(count);
        for segment in segments {
            let knots = &segment.knots;
            let seconds: Vec<[f64; D]> = (0..knots.len()).map(|n| second(knots, n)).collect();
            for (n, pair) in knots.windows(2).enumerate() {
                let [a, b] = [&pair[0], &pair[1]];
                starts.push(a.s);
                intervals.push(Interval::between(
                    segment.chart,
                    a,
                    b,
                    seconds[n],
                    seconds[n + 1],
                ));
            }
        }
        let last = intervals.last();
        let end = last.map_or(0.0, |last| last.from + last.length);
        // A step that was cut short does not indicate how far it may be extrapolated.
        let slack = 0.05 * last.map_or(0.0, |last| last.length);
        let count = 2 * intervals.len();
        let by_part = count as f64 / end.max(f64::MIN_POSITIVE);
        let mut parts = Vec::with_capacity(count + 1);
        let mut n = 0;
        for part in 0..count {
            let from = part as f64 / by_part;
            while starts.get(n + 1).is_some_and(|next| *next <= from) {
                n += 1;
            }
            parts.push(n as u32);
        }
        parts.push(intervals.len().saturating_sub(1) as u32);
        Self {
            parts,
            by_part,
            angle,
            starts,
            intervals,
            end,
            slack,
            stop,
            passages: Vec::new(),
            off: [0.0; BINS],
            tolerance_share: 1.0,
        }
    }

    /// Returns the radii at which to compare it with others: these fractions of its steps, and its end.
    pub(crate) fn probes(&self, shares: &[f64]) -> impl Iterator<Item = f64> {
        let reach = self.stop.map_or(self.end, |stop| stop.s.min(self.end));
        let stride = self.intervals.len().div_ceil(PROBES).max(1);
        let steps = self.intervals.iter().skip(stride - 1).step_by(stride);
        let of = |interval: &Interval<D>| (interval.from, interval.length);
        let inside = steps
            .map(of)
            .flat_map(move |(from, length)| shares.iter().map(move |share| from + share * length));
        inside.filter(move |s| *s < reach).chain([reach])
    }

    /// Returns the largest estimated error of its position, up to the factor.
    pub(crate) fn error(&self) -> f64 {
        f64::from(most(&self.off))
    }

    /// Returns the arc length for which it is on the surface.
    #[inline(always)]
    pub(crate) fn limit(&self) -> f64 {
        self.stop.map_or(f64::INFINITY, |stop| stop.s)
    }

    /// Returns the arc length up to which points next to it follow from it: beyond an edge as far as it was continued.
    pub(crate) fn reach(&self) -> f64 {
        match &self.stop {
            None => f64::INFINITY,
            Some(stop) if stop.status == Status::LeftDomain => stop.s.max(self.end),
            Some(stop) => stop.s,
        }
    }

    /// Returns the ranges between two arc lengths of each component of the position γ, and of γ + `angle`·J; `None` where they
    /// are not known, or not in the plain coordinates alone.
    pub(super) fn ranges(&self, [from, to]: [f64; 2], angle: f64) -> Option<[[[f64; 2]; 2]; D]> {
        let first = self.starts.partition_point(|start| *start <= from);
        let last = self.starts.partition_point(|start| *start < to);
        let intervals = self.intervals.get(first.saturating_sub(1)..last)?;
        let mut ranges = [[[f64::INFINITY, f64::NEG_INFINITY]; 2]; D];
        for interval in intervals {
            if !interval.chart.is_plain() {
                return None;
            }
            let share = |s: f64| ((s - interval.from) / interval.length).max(0.0);
            let shares = [share(from), share(to.min(interval.from + interval.length))];
            for (k, both) in ranges.iter_mut().enumerate() {
                for ([low, high], angle) in both.iter_mut().zip([0.0, angle]) {
                    let path = interval.main.map(|[at, field]| at[k] + angle * field[k]);
                    let within = range(&path, shares);
                    (*low, *high) = (low.min(within.lower()), high.max(within.upper()));
                }
            }
        }
        (!intervals.is_empty()).then_some(ranges)
    }

    /// Returns the ray at an arc length; `None` where it is not known.
    #[inline(always)]
    pub(crate) fn at(&self, s: f64) -> Option<Sample<D>> {
        if s > self.end + self.slack {
            return None;
        }
        let part = ((s * self.by_part) as usize).min(self.parts.len().saturating_sub(2));
        let (first, last) = (
            *self.parts.get(part)? as usize,
            *self.parts.get(part + 1)? as usize,
        );
        let mut n = first;
        if last > first + 3 {
            n += self
                .starts
                .get(first + 1..=last)?
                .partition_point(|from| *from <= s);
        } else {
            while n < last && self.starts[n + 1] <= s {
                n += 1;
            }
        }
        Some(self.intervals.get(n)?.at(s))
    }
}

impl<const D: usize> Interval<D> {
    fn between(chart: FanChart, a: &Knot<D>, b: &Knot<D>, j2: [f64; D], k2: [f64; D]) -> Self {
        let h = b.s - a.s;
        let mut main = [[[0.0; D]; 2]; 6];
        let mut normal = [[0.0; D]; 4];
        for k in 0..D {
            let from = [a.at[k], a.velocity[k], a.acceleration[k]];
            let to = [b.at[k], b.velocity[k], b.acceleration[k]];
            let [j, j1] = a.jacobi(k);
            let [l, l1] = b.jacobi(k);
            let gamma = quintic(h, from, to);
            let field = quintic(h, [j, j1, j2[k]], [l, l1, k2[k]]);
            for power in 0..6 {
                main[power][0][k] = gamma[power];
                main[power][1][k] = field[power];
            }
            let (n, n1) = (a.normal[0][k], h * a.normal[1][k]);
            let rise = b.normal[0][k] - n - n1;
            let turn = h * b.normal[1][k] - n1;
            for (power, c) in [n, n1, 3.0 * rise - turn, turn - 2.0 * rise]
                .into_iter()
                .enumerate()
            {
                normal[power][k] = c;
            }
        }
        Self {
            from: a.s,
            length: h,
            chart,
            main,
            normal,
        }
    }

    #[inline(always)]
    fn at(&self, s: f64) -> Sample<D> {
        let x = (s - self.from) / self.length;
        let mut value = self.main[5];
        let mut rate = [[0.0; D]; 2];
        for power in (0..5).rev() {
            for of in 0..2 {
                for k in 0..D {
                    rate[of][k] = rate[of][k] * x + value[of][k];
                    value[of][k] = value[of][k] * x + self.main[power][of][k];
                }
            }
        }
        let mut normal = self.normal[3];
        for power in (0..3).rev() {
            for (sum, c) in normal.iter_mut().zip(self.normal[power]) {
                *sum = *sum * x + c;
            }
        }
        let by_s = 1.0 / self.length;
        Sample {
            chart: self.chart,
            at: value[0],
            along: rate[0].map(|x| x * by_s),
            jacobi: [value[1], rate[1].map(|x| x * by_s)],
            normal,
        }
    }
}

impl Ray {
    /// Ends a ray that was continued beyond an edge before it comes back inside: there its end would be taken for that of a
    /// geodesic, which ended at the edge.
    pub(super) fn end_at_return(&mut self, layout: &ChartLayout) {
        let Some(stop) = self.stop.filter(|stop| stop.status == Status::LeftDomain) else {
            return;
        };
        let mut known = stop.s;
        for interval in &self.intervals {
            let to = interval.from + interval.length;
            if to <= stop.s {
                continue;
            }
            let from = interval.from.max(stop.s);
            for part in 1..=PARTS_BEYOND {
                let s = from + (to - from) * f64::from(part) / f64::from(PARTS_BEYOND);
                let sample = interval.at(s);
                if !sample.chart.is_plain() || layout.beyond_edge(sample.at).is_none() {
                    (self.end, self.slack) = (known, 0.0);
                    return;
                }
                known = s;
            }
        }
        let beyond = |sample: Sample| layout.beyond_edge(sample.at).is_some();
        if !self.at(self.end + self.slack).is_some_and(beyond) {
            self.slack = 0.0;
        }
    }
}

/// Returns J'' at a knot. At the centre m'' = 0, so that it is 2N'; elsewhere it is that of the quintic through J and
/// J' at three knots, since it involves the derivative of the curvature.
fn second<const D: usize>(knots: &[Knot<D>], n: usize) -> [f64; D] {
    let knot = &knots[n];
    if knot.s == 0.0 {
        return knot.normal[1].map(|x| 2.0 * x);
    }
    let last = knots.len() - 1;
    let others = match n {
        0 => [1, 2],
        n if n == last => [last.saturating_sub(1), last.saturating_sub(2)],
        n => [n - 1, n + 1],
    };
    std::array::from_fn(|k| {
        let node = |n: usize| {
            let knot = &knots[n.min(last)];
            let [value, rate] = knot.jacobi(k);
            (knot.s, value, rate)
        };
        let (p, q) = (node(others[0]), node(others[1]));
        let t = node(n);
        if last == 0 {
            0.0
        } else if last == 1 {
            // From the cubic through both knots.
            let h = p.0 - t.0;
            (6.0 * (p.1 - t.1) / h - 4.0 * t.2 - 2.0 * p.2) / h
        } else {
            confluent(t, p, q)
        }
    })
}

/// Returns the second derivative at t of the quintic through (node, value, derivative) of t, p, q, by divided
/// differences with double nodes (Stoer, Bulirsch, *Introduction to Numerical Analysis*, section 2.1.5).
fn confluent(t: (f64, f64, f64), p: (f64, f64, f64), q: (f64, f64, f64)) -> f64 {
    let (tp, pq, tq) = (p.0 - t.0, q.0 - p.0, q.0 - t.0);
    let first = [t.2, (p.1 - t.1) / tp, p.2, (q.1 - p.1) / pq, q.2];
    let second = [
        (first[1] - first[0]) / tp,
        (first[2] - first[1]) / tp,
        (first[3] - first[2]) / pq,
        (first[4] - first[3]) / pq,
    ];
    let third = [
        (second[1] - second[0]) / tp,
        (second[2] - second[1]) / tq,
        (second[3] - second[2]) / pq,
    ];
    let fourth = [(third[1] - third[0]) / tq, (third[2] - third[1]) / tq];
    let fifth = (fourth[1] - fourth[0]) / tq;
    2.0 * (second[0] - third[0] * tp + fourth[0] * tp * tp - fifth * tp * tp * tq)
}
