//! Rays on their way, eight at a time: runners in, runners out that have ended or that go on in another group.
//!
//! A group shares its coordinates and its steps' lengths; the error of a step is that of its worst lane. A lane that
//! asks for much shorter steps than the others, or that comes to other coordinates, leaves the group, so that it does
//! not hold it up.

use super::coordinates::{Chart, Kind, Space};
use super::lanes::{Field, Local, STAGES, State, Trial, normals};
use super::ray::{Knot, Ray, Segment, Stop};
use expr::processor::{Processor, Work};

use crate::chart::{Atlas, Motion};
use crate::follow;
use crate::integrate::DOPRI5;
use crate::surface::{LANES, Lanes, Surface};
use crate::trace::Status;

/// How rays are to be integrated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    /// The error allowed per arc length.
    pub(super) rate: f64,
    /// A step shorter than this is allowed the error of one of this length: few are.
    pub(super) least: f64,
    /// What an error of direction is multiplied by to be one of position.
    pub(super) lever: f64,
    /// What a relative error of the Jacobi field matters.
    pub(super) field: f64,
    /// Steps below this length lead nowhere.
    pub(super) shortest: f64,
    /// The first step.
    pub(super) first: f64,
    /// The most evaluations for one ray.
    pub(super) limit: u64,
}

/// A ray on its way.
#[derive(Clone, Debug)]
pub(super) struct Runner {
    /// Its place among those that were asked for.
    pub(super) id: usize,
    pub(super) angle: f64,
    pub(super) length: f64,
    pub(super) chart: Chart,
    pub(super) at: [f64; 2],
    pub(super) velocity: [f64; 2],
    /// +1 where the frame's Y lies to the left of X in the plain coordinates, −1 where to the right.
    pub(super) side: f64,
    m: [f64; 2],
    s: f64,
    pub(super) h: f64,
    /// The step before; 0 before the first.
    last: f64,
    /// The angle about an apex, going on over more than a turn.
    turned: f64,
    pub(super) steps: u64,
    pub(super) rejected: u64,
    pub(super) evaluations: u64,
    segments: Vec<Segment>,
    stop: Option<Stop>,
    pub(super) done: bool,
    /// The covariance of the steps' errors, carried on by the Jacobi fields: of position, mixed, of direction.
    errors: [f64; 3],
    /// The largest variance of the position on the way.
    worst: f64,
}

/// The most evaluations to find out why steps lead nowhere.
const CAREFUL: u64 = 4000;
/// A lane within this share of its radius of a cone's tip has hit it.
const HIT: f64 = 1e-9;
/// A cone is unrolled anew when a ray has turned about its tip by this angle.
const TURN: f64 = 2.0;

impl Runner {
    pub(super) fn new(
        angle: f64,
        length: f64,
        chart: Chart,
        at: [f64; 2],
        velocity: [f64; 2],
        side: f64,
        h: f64,
    ) -> Self {
        Self {
            id: 0,
            angle,
            length,
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
            errors: [0.0; 3],
            worst: 0.0,
        }
    }

    /// The estimated error of its position where it is the largest, but for a factor that is much the same for all
    /// rays of a fan.
    fn error(&self) -> f64 {
        self.worst.max(0.0).sqrt()
    }

    /// The ray, once it is done.
    pub(super) fn finish(self) -> Ray {
        let mut ray = Ray::new(self.angle, &self.segments, self.stop);
        ray.error = self.error();
        ray
    }

    fn stop(&mut self, s: f64, status: Status) {
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
    fn aim(&mut self, axis: usize, end: usize) {
        let knots = self
            .segments
            .last()
            .map(|segment| (segment.chart.kind, segment.knots.as_slice()));
        let (Some(stop), Some((Kind::Plain, [.., a, b]))) = (&mut self.stop, knots) else {
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
    fn plain(&self, space: &Space) -> ([f64; 2], [f64; 2]) {
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
    fn enter(&mut self, space: &Space, chart: Chart) {
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

/// Follows all runners to their ends, on the threads of the current pool; they come back in the order of their ids.
pub(super) fn march_all<S: Surface + ?Sized>(
    surface: &S,
    space: &Space,
    plan: &Plan,
    runners: Vec<Runner>,
) -> Vec<Runner> {
    use rayon::prelude::*;
    let mut done = Vec::with_capacity(runners.len());
    let mut pending = runners;
    while !pending.is_empty() {
        // Rays in the same coordinates, with steps of like lengths, go together.
        pending
            .sort_by(|a, b| (a.chart.kind.cmp(&b.chart.kind)).then(octave(a.h).cmp(&octave(b.h))));
        let mut groups: Vec<Vec<Runner>> = Vec::new();
        for runner in pending {
            match groups.last_mut() {
                Some(group) if group.len() < LANES && group[0].chart.kind == runner.chart.kind => {
                    group.push(runner);
                }
                _ => groups.push(vec![runner]),
            }
        }
        if groups.len() == 1 {
            groups
                .iter_mut()
                .for_each(|group| march(surface, space, plan, group));
        } else {
            groups
                .par_iter_mut()
                .for_each(|group| march(surface, space, plan, group));
        }
        let (ended, going): (Vec<_>, Vec<_>) =
            groups.into_iter().flatten().partition(|runner| runner.done);
        done.extend(ended);
        pending = going;
    }
    done.sort_by_key(|runner| runner.id);
    done
}

fn octave(h: f64) -> i32 {
    // A NaN or an infinity has some octave, too.
    h.log2().floor() as i32
}

/// A group of lanes.
struct Group<'a, S: Surface + ?Sized> {
    field: Field<'a, S>,
    plan: &'a Plan,
    state: State,
    local: Local,
    sides: Lanes,
    active: [bool; LANES],
    processor: Processor,
}

/// A step of all lanes, compiled for the processor's vectors.
struct Step<'a, 'f, S: Surface + ?Sized> {
    field: &'a Field<'f, S>,
    state: &'a State,
    local: &'a Local,
    h: f64,
}

impl<S: Surface + ?Sized> Work for Step<'_, '_, S> {
    type Output = Trial;
    #[inline(always)]
    fn run(self) -> Trial {
        self.field.step(self.state, self.local, self.h)
    }
}

/// Takes a group as far as it goes together.
fn march<S: Surface + ?Sized>(surface: &S, space: &Space, plan: &Plan, runners: &mut [Runner]) {
    let count = runners.len().min(LANES);
    let runners = &mut runners[..count];
    let Some(kind) = runners.first().map(|runner| runner.chart.kind) else {
        return;
    };
    let handedness = space.tip(kind).map_or(1.0, |tip| tip.handedness());
    let lane = |of: &dyn Fn(&Runner) -> f64| -> Lanes {
        std::array::from_fn(|lane| of(&runners[lane.min(count - 1)]))
    };
    let zero = [0.0; LANES];
    let one = [1.0; LANES];
    let mut group = Group {
        field: Field {
            surface,
            space,
            kind,
            reference: lane(&|r| r.chart.reference),
        },
        plan,
        state: [
            lane(&|r| r.at[0]),
            lane(&|r| r.at[1]),
            lane(&|r| r.velocity[0]),
            lane(&|r| r.velocity[1]),
            zero,
            one,
            one,
            zero,
        ],
        local: Local::default(),
        sides: lane(&|r| r.side * handedness),
        active: std::array::from_fn(|lane| lane < count),
        processor: Processor::here(),
    };
    let mut h = runners
        .iter()
        .fold(f64::INFINITY, |h, runner| h.min(runner.h));
    group.begin(runners);
    while group.active.contains(&true) {
        let remaining = runners
            .iter()
            .zip(group.active)
            .filter(|(_, active)| *active)
            .fold(0.0_f64, |most, (runner, _)| {
                most.max(runner.length - runner.s)
            });
        // Two steps of equal length rather than a long one and a sliver.
        let tried = if h >= remaining {
            remaining
        } else if 2.0 * h > remaining {
            0.5 * remaining
        } else {
            h
        };
        let next = group.attempt(runners, tried);
        // A step cut short by the end says little about the next.
        h = if tried < h && next >= tried {
            next.max(h.min(2.0 * next))
        } else {
            next
        };
    }
}

impl<S: Surface + ?Sized> Group<'_, S> {
    /// Evaluates at the start, and puts the first knots.
    fn begin(&mut self, runners: &mut [Runner]) {
        self.field.local(&self.state, &mut self.local);
        let knots = self.knots(&self.state, &self.local);
        for (lane, runner) in runners.iter_mut().enumerate() {
            runner.evaluations += 1;
            let [x, y] = self.local.acceleration;
            if !(x[lane].is_finite() && y[lane].is_finite()) {
                self.active[lane] = false;
                self.stall(runner);
                continue;
            }
            let mut knot = knots[lane];
            knot.s = runner.s;
            knot.m = runner.m;
            let chart = runner.chart;
            let goes_on = runner.segments.last().is_some_and(|last| {
                super::ray::same(&last.chart, &chart)
                    && last.knots.last().is_some_and(|last| last.s == knot.s)
            });
            if !goes_on {
                runner.segments.push(Segment {
                    chart,
                    knots: Vec::with_capacity(32),
                });
                if let Some(segment) = runner.segments.last_mut() {
                    segment.knots.push(knot);
                }
            }
        }
    }

    /// The lanes' knots, their arc lengths and Jacobi fields apart.
    #[inline(always)]
    fn knots(&self, state: &State, local: &Local) -> [Knot; LANES] {
        let velocity = [state[2], state[3]];
        let [n, n1] = normals(&local.jets, &velocity, &self.sides);
        std::array::from_fn(|l| Knot {
            s: 0.0,
            at: [state[0][l], state[1][l]],
            velocity: [state[2][l], state[3][l]],
            acceleration: [local.acceleration[0][l], local.acceleration[1][l]],
            m: [0.0; 2],
            normal: [[n[0][l], n[1][l]], [n1[0][l], n1[1][l]]],
        })
    }

    /// Tries a step; gives the length of the next one.
    fn attempt(&mut self, runners: &mut [Runner], h: f64) -> f64 {
        let trial = self.processor.run(Step {
            field: &self.field,
            state: &self.state,
            local: &self.local,
            h,
        });
        let mut factors = [f64::INFINITY; LANES];
        let mut failed = [false; LANES];
        let (mut good, mut bad) = (0, 0);
        for (lane, runner) in runners.iter_mut().enumerate() {
            if !self.active[lane] {
                continue;
            }
            runner.evaluations += STAGES;
            let excess = self.excess(runner, &trial, lane, h);
            // Single precision is enough for a factor.
            let factor = 0.9 * f64::from((excess as f32).powf(-0.2));
            // NaN is a failure, too.
            failed[lane] = !(excess <= 1.0);
            factors[lane] = if failed[lane] {
                factor.clamp(0.1, 0.9)
            } else {
                factor.clamp(0.2, 5.0)
            };
            if failed[lane] {
                bad += 1;
            } else {
                good += 1;
            }
        }
        let least = factors.iter().fold(f64::INFINITY, |least, x| least.min(*x));
        if bad > 0 && (good < bad || least > 0.5) {
            for (lane, runner) in runners.iter_mut().enumerate() {
                if self.active[lane] {
                    runner.rejected += 1;
                    runner.h = h * least;
                    if h * factors[lane] < self.plan.shortest
                        || runner.evaluations + STAGES > self.plan.limit
                    {
                        self.active[lane] = false;
                        self.stall(runner);
                    }
                }
            }
            return h * least;
        }
        // The few that failed go on in another group.
        let knots = self.knots(&trial.end, &trial.local);
        let mut next = f64::INFINITY;
        for (lane, runner) in runners.iter_mut().enumerate() {
            if !self.active[lane] {
                continue;
            }
            runner.h = h * factors[lane];
            if failed[lane] {
                runner.rejected += 1;
                self.active[lane] = false;
                if runner.h < self.plan.shortest || runner.evaluations + STAGES > self.plan.limit {
                    self.stall(runner);
                }
                continue;
            }
            self.accept(runner, &trial, lane, h, knots[lane]);
            if self.active[lane] {
                next = next.min(runner.h);
            }
        }
        // So do those that would hold up the others.
        let going = self.active.iter().filter(|active| **active).count();
        let slow = |runner: &Runner| runner.h < 1.5 * next;
        let slower = (0..runners.len())
            .filter(|&lane| self.active[lane] && slow(&runners[lane]))
            .count();
        let others = runners
            .iter()
            .zip(self.active)
            .filter(|(runner, active)| *active && !slow(runner))
            .fold(f64::INFINITY, |least, (runner, _)| least.min(runner.h));
        if slower * 2 <= going && others > 2.5 * next {
            for (lane, runner) in runners.iter().enumerate() {
                if self.active[lane] && slow(runner) {
                    self.active[lane] = false;
                }
            }
            next = others;
        }
        self.state = trial.end;
        self.state[4] = [0.0; LANES];
        self.state[5] = [1.0; LANES];
        self.state[6] = [1.0; LANES];
        self.state[7] = [0.0; LANES];
        self.local = trial.local;
        if next.is_finite() { next } else { h }
    }

    /// A lane's error over what is allowed; NaN where anything is undefined.
    fn excess(&self, runner: &Runner, trial: &Trial, lane: usize, h: f64) -> f64 {
        let [n, m] = [trial.fields[0][lane], trial.fields[1][lane]];
        let field = (n * runner.m[0] + m * runner.m[1]).abs();
        let error = trial.position[lane]
            + self.plan.lever * trial.direction[lane]
            + self.plan.field * field;
        let mut excess = error / (self.plan.rate * h.max(self.plan.least));
        let [x, y] = trial.local.acceleration;
        if !(x[lane].is_finite() && y[lane].is_finite() && trial.local.curvature[lane].is_finite())
        {
            return f64::NAN;
        }
        let end = [trial.end[0][lane], trial.end[1][lane]];
        let space = self.field.space;
        match space.tip(self.field.kind) {
            None => {
                if space.needs_apex(end) {
                    excess = excess.max(20.0);
                }
            }
            Some(tip) => {
                if tip.oversteps(end) {
                    excess = excess.max(20.0);
                }
                if !tip.apex.smooth {
                    // Towards the tip of a cone so that it stays ahead, away from it twice the distance.
                    let ([a, b], [x, y]) = (runner.at, runner.velocity);
                    let r = a.hypot(b).max(HIT * tip.radius);
                    let longest = if a * x + b * y < 0.0 {
                        0.75 * r
                    } else {
                        2.0 * r
                    } / x.hypot(y);
                    excess = excess.max((h / longest).powi(5) * 0.999);
                }
            }
        }
        excess
    }

    fn accept(&mut self, runner: &mut Runner, trial: &Trial, lane: usize, h: f64, mut knot: Knot) {
        let space = self.field.space;
        let from = Motion {
            at: runner.at,
            velocity: runner.velocity,
        };
        let before = [
            self.local.acceleration[0][lane],
            self.local.acceleration[1][lane],
        ];
        let s = runner.s;
        let [[n, m], [n1, m1]] = [
            [trial.end[6][lane], trial.end[4][lane]],
            [trial.end[7][lane], trial.end[5][lane]],
        ];
        runner.m = [
            n * runner.m[0] + m * runner.m[1],
            n1 * runner.m[0] + m1 * runner.m[1],
        ];
        let [p, x, d] = runner.errors;
        let direction = trial.direction[lane];
        let position = trial.position[lane].max(h * direction);
        runner.errors = [
            n * n * p + 2.0 * n * m * x + m * m * d + position * position,
            n * n1 * p + (n * m1 + m * n1) * x + m * m1 * d,
            n1 * n1 * p + 2.0 * n1 * m1 * x + m1 * m1 * d + direction * direction,
        ];
        runner.worst = runner.worst.max(runner.errors[0]);
        // Steps that have been shrinking, towards something singular, will go on to shrink.
        if h < runner.last && h < 3.0 * self.plan.least {
            runner.h *= (h / runner.last).max(0.5);
        }
        runner.last = h;
        runner.steps += 1;
        runner.s += h;
        runner.at = knot.at;
        runner.velocity = knot.velocity;
        knot.s = runner.s;
        knot.m = runner.m;
        if let Some(segment) = runner.segments.last_mut() {
            segment.knots.push(knot);
        }
        match space.tip(self.field.kind) {
            None => {
                if let Some((share, edge)) = leaves(space, &from, before, &knot, h) {
                    self.active[lane] = false;
                    self.leave(runner, s + share * h, edge);
                    return;
                }
            }
            Some(tip) => {
                let principal = knot.at[1].atan2(knot.at[0]);
                let turn = principal - runner.turned;
                runner.turned +=
                    turn - std::f64::consts::TAU * (turn / std::f64::consts::TAU).round();
                if !tip.apex.smooth && hits(&from, &knot, tip.radius) {
                    self.active[lane] = false;
                    runner.stop(runner.s, Status::ConePoint);
                    return;
                }
            }
        }
        if runner.s >= runner.length * (1.0 - 1e-14) {
            runner.done = true;
            self.active[lane] = false;
            return;
        }
        if runner.evaluations + STAGES > self.plan.limit {
            runner.stop(runner.s, Status::WorkLimit);
            self.active[lane] = false;
            return;
        }
        if runner.h < self.plan.shortest {
            self.active[lane] = false;
            self.stall(runner);
            return;
        }
        let chart = match space.tip(self.field.kind) {
            None => space.chart_near(knot.at),
            Some(tip) if tip.is_left_at(knot.at) => Some(Chart::PLAIN),
            Some(tip) if !tip.apex.smooth && runner.turned.abs() > TURN => Some(Chart {
                kind: self.field.kind,
                reference: runner.chart.reference + runner.turned / tip.apex.rate,
            }),
            Some(_) => None,
        };
        if let Some(chart) = chart {
            runner.enter(space, chart);
            self.active[lane] = false;
        }
    }

    /// Ends a ray at an edge.
    fn leave(&self, runner: &mut Runner, s: f64, (axis, end): (usize, usize)) {
        let collapsed = self.field.space.is_collapsed(axis, end);
        runner.stop(
            s,
            if collapsed {
                Status::ConePoint
            } else {
                Status::LeftDomain
            },
        );
        runner.aim(axis, end);
    }

    /// Where steps lead nowhere, one careful integration says why, and where it ends.
    fn stall(&self, runner: &mut Runner) {
        let space = self.field.space;
        let (at, velocity) = runner.plain(space);
        let (at, signs) = space.bring_back(at);
        let velocity = [0, 1].map(|k| velocity[k] * signs[k]);
        let atlas = Atlas::new(self.field.surface);
        let way = (runner.length - runner.s).min(1e2 * self.plan.shortest);
        let left = self
            .plan
            .limit
            .saturating_sub(runner.evaluations)
            .min(CAREFUL);
        let plan = follow::Plan {
            tableau: &DOPRI5,
            tolerance: Some(self.plan.rate.clamp(1e-9, 1e-3)),
            step: self.plan.shortest,
            limit: left as usize,
            charts: true,
            keep_path: false,
        };
        let end = follow::follow(&atlas, Motion { at, velocity }, way, plan);
        runner.evaluations += atlas.evaluations() as u64;
        let status = match end.status {
            // It passes what stopped the group: not known from here on.
            Status::Complete => Status::WorkLimit,
            status => status,
        };
        let s = if status == Status::WorkLimit {
            runner.s
        } else {
            runner.s + end.length
        };
        runner.stop(s, status);
        if status == Status::LeftDomain {
            let off = |axis: usize, side: usize| {
                (end.motion.at[axis] - space.domain[axis][side]).abs() / space.width(axis)
            };
            let nearest = (0..4)
                .map(|n| (n / 2, n % 2))
                .min_by(|a, b| off(a.0, a.1).total_cmp(&off(b.0, b.1)));
            if let Some((axis, side)) = nearest {
                runner.aim(axis, side);
            }
        }
    }
}

/// Whether a step in the plain coordinates leaves through an edge: the share of it, and which.
fn leaves(
    space: &Space,
    from: &Motion,
    before: [f64; 2],
    to: &Knot,
    h: f64,
) -> Option<(f64, (usize, usize))> {
    if !space.has_edges() {
        return None;
    }
    let point = |x: f64| {
        [0, 1].map(|k| {
            let (c1, c2) = (h * from.velocity[k], 0.5 * h * h * before[k]);
            let a = to.at[k] - from.at[k] - c1 - c2;
            let b = h * to.velocity[k] - c1 - 2.0 * c2;
            let c = h * h * to.acceleration[k] - 2.0 * c2;
            let high = [
                10.0 * a - 4.0 * b + 0.5 * c,
                -15.0 * a + 7.0 * b - c,
                6.0 * a - 3.0 * b + 0.5 * c,
            ];
            from.at[k] + x * (c1 + x * (c2 + x * (high[0] + x * (high[1] + x * high[2]))))
        })
    };
    let shares = [0.25, 0.5, 0.75, 1.0];
    let first = shares.into_iter().find(|&x| {
        let at = if x == 1.0 { to.at } else { point(x) };
        space.beyond_edge(at).is_some()
    })?;
    let edge = space.beyond_edge(if first == 1.0 { to.at } else { point(first) })?;
    let (axis, end) = edge;
    let sign = if end == 0 { -1.0 } else { 1.0 };
    let beyond = |x: f64| sign * (point(x)[axis] - space.domain[axis][end]);
    let (mut low, mut high) = (first - 0.25, first);
    for _ in 0..48 {
        let middle = 0.5 * (low + high);
        if beyond(middle) > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    Some((high, edge))
}

/// Whether a step goes through the tip of a cone.
fn hits(from: &Motion, to: &Knot, radius: f64) -> bool {
    let way = [0, 1].map(|k| to.at[k] - from.at[k]);
    let square = way[0] * way[0] + way[1] * way[1];
    let share = if square > 0.0 {
        (-(from.at[0] * way[0] + from.at[1] * way[1]) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let nearest = [0, 1].map(|k| from.at[k] + share * way[k]);
    nearest[0].hypot(nearest[1]) <= HIT * radius
}
