//! A ray in space, step by step.
//!
//! In: a piece of a field, a start on it at unit speed, a length. Out: [`SpaceRayEnd`]. A step uses the same Runge–Kutta pairs
//! as in a chart. After it, one step of Newton's method returns to the surface, and the velocity is projected onto the tangent
//! plane and normalised; both corrections count as error. Every ray ends within its limit on evaluations.

use std::cell::Cell;

use super::{FieldPiece, ImplicitSurface, LocalShape};

use crate::conjugate_search::{ROUNDS, brackets};
use crate::fan::coordinates::FanChart;
use crate::fan::ray::{Knot, Segment};
use crate::jacobi::{self, JacobiKnot};
use crate::runge_kutta::{
    self, GeodesicEquation, RatesOfChange, States, Step, StepParameter, Tableau,
};
use crate::status::Status;
use crate::step_control::{
    ErrorSum, ROUNDING, SHORT, SHORTEST, SMALL_STEP, StepControl, UNDEFINED, step_after,
    step_to_try,
};
use crate::step_path::{Borders, PathPart, StepPath};
use crate::vector::{combine, dot, norm};

/// The components of a state in space.
const COMPONENTS: usize = 10;
/// The maximum number of a pair's evaluations in a step, including the one at its start.
const SLOPES: usize = 13;
/// The cosine of the largest angle by which the normal may turn in one step.
const LEAST_TURN: f64 = 0.3;
/// The maximum length of a step on a surface that has edges, as a fraction of its size.
const BESIDE_EDGES: f64 = 0.05;
/// A step whose error is below this fraction of the ray's scale leaves only rounding after its correction.
const GOOD: f64 = 1e-9;
/// Evaluations that are reserved for the end.
const AT_END: usize = 8;

/// A point on a surface in space with its velocity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpaceState {
    pub(crate) at: [f64; 3],
    pub(crate) velocity: [f64; 3],
}

/// The parameters of an integration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpacePlan {
    pub(crate) tableau: &'static Tableau,
    /// The error allowed, per length.
    pub(crate) tolerance: f64,
    /// The error allowed to a step however short it is, over its size and the tolerance.
    pub(crate) step: f64,
    /// The maximum number of evaluations.
    pub(crate) limit: usize,
    /// True if the Jacobi fields are to be as accurate as the ray.
    pub(crate) accurate_jacobi: bool,
    /// True if conjugate points are located.
    pub(crate) conjugates: bool,
    /// True if the Jacobi field is stored after each step, and steps are short compared with 1/√|K|.
    pub(crate) jacobi_knots: bool,
    /// True if the ends of the steps are stored, for dense output.
    pub(crate) knots: bool,
    /// True if the ray continues beyond edges, on the piece on which it started.
    pub(crate) beyond: bool,
}

/// The end of a ray.
#[derive(Clone, Debug)]
pub(crate) struct SpaceRayEnd {
    pub(crate) state: SpaceState,
    pub(crate) length: f64,
    pub(crate) speed_drift: f64,
    pub(crate) error: f64,
    pub(crate) steps: usize,
    pub(crate) rejected: usize,
    pub(crate) evaluations: usize,
    pub(crate) status: Status,
    pub(crate) field: [f64; 2],
    pub(crate) conjugates: Vec<f64>,
    pub(crate) jacobi_knots: Vec<JacobiKnot>,
    pub(crate) segment: Segment<3>,
    /// The arc length at which it first met an edge, if it continued beyond.
    pub(crate) edge: Option<f64>,
}

/// The local data of a ray.
#[derive(Clone, Copy, Debug, Default)]
struct SpaceLocal(Option<LocalShape>);

struct SpaceEquation<'a> {
    piece: &'a FieldPiece,
    evaluations: &'a Cell<usize>,
}

/// The field is undefined at a stage of a step.
struct UndefinedField;

impl SpaceEquation<'_> {
    fn shape(&self, at: [f64; 3]) -> Option<LocalShape> {
        self.evaluations.set(self.evaluations.get() + 1);
        self.piece.shape(at)
    }
}

impl GeodesicEquation<1, COMPONENTS> for SpaceEquation<'_> {
    type Local = SpaceLocal;
    type Undefined = UndefinedField;

    fn evaluate(
        &self,
        [[x], [y], [z], ..]: &States<1, COMPONENTS>,
        local: &mut SpaceLocal,
    ) -> Result<(), UndefinedField> {
        *local = SpaceLocal(Some(self.shape([*x, *y, *z]).ok_or(UndefinedField)?));
        Ok(())
    }
}

impl RatesOfChange<1, COMPONENTS> for SpaceLocal {
    fn slope(&self, states: &States<1, COMPONENTS>) -> States<1, COMPONENTS> {
        let [_, _, _, [x], [y], [z], [m], [m1], [n], [n1]] = *states;
        let Some(shape) = &self.0 else {
            return [[f64::NAN]; COMPONENTS];
        };
        let [a, b, c] = shape.acceleration([x, y, z]);
        let k = shape.curvature;
        [x, y, z, a, b, c, m1, -k * m, n1, -k * n].map(|x| [x])
    }

    fn way(&self, [[x], [y], [z], ..]: &States<1, COMPONENTS>) -> [f64; 1] {
        [norm([*x, *y, *z])]
    }

    fn speed(&self, [_, _, _, [x], [y], [z], ..]: &States<1, COMPONENTS>) -> [f64; 1] {
        [norm([*x, *y, *z])]
    }
}

/// A step that has been tried, after its correction.
struct Tried {
    end: SpaceState,
    shape: LocalShape,
    /// The estimated errors, including the corrections.
    position_error: f64,
    direction_error: f64,
    field_error: f64,
    /// The deviation of the speed.
    drift: f64,
    propagator: [[f64; 2]; 2],
}

struct SpaceRay<'a> {
    surface: &'a ImplicitSurface,
    equation: SpaceEquation<'a>,
    plan: SpacePlan,
    state: SpaceState,
    shape: LocalShape,
    s: f64,
    field: [f64; 2],
    errors: ErrorSum,
    drift: f64,
    /// The distance from the surface at which the field's rounding leaves a corrected point.
    noise: f64,
    control: StepControl,
    steps: usize,
    rejected: usize,
    conjugates: Vec<f64>,
    jacobi_knots: Vec<JacobiKnot>,
    segment: Segment<3>,
    edge: Option<f64>,
}

/// Integrates the geodesic from a start on a piece, at unit speed.
pub(crate) fn integrate(
    surface: &ImplicitSurface,
    piece: &FieldPiece,
    start: SpaceState,
    length: f64,
    plan: SpacePlan,
) -> SpaceRayEnd {
    let evaluations = Cell::new(0);
    let equation = SpaceEquation {
        piece,
        evaluations: &evaluations,
    };
    let segment = Segment {
        chart: FanChart::PLAIN,
        knots: Vec::new(),
    };
    let Some(shape) = equation.shape(start.at) else {
        return SpaceRayEnd {
            state: start,
            length: 0.0,
            speed_drift: 0.0,
            error: 0.0,
            steps: 0,
            rejected: 0,
            evaluations: evaluations.get(),
            status: why(&equation, start.at),
            field: [0.0, 1.0],
            conjugates: Vec::new(),
            jacobi_knots: Vec::new(),
            segment,
            edge: None,
        };
    };
    let mut ray = SpaceRay {
        surface,
        equation,
        plan,
        state: start,
        shape,
        s: 0.0,
        field: [0.0, 1.0],
        errors: ErrorSum::default(),
        drift: 0.0,
        noise: 0.0,
        control: StepControl::default(),
        steps: 0,
        rejected: 0,
        conjugates: Vec::new(),
        jacobi_knots: Vec::new(),
        segment,
        edge: None,
    };
    let status = ray.run(length);
    SpaceRayEnd {
        state: ray.state,
        length: if status == Status::Complete {
            length
        } else {
            ray.s
        },
        speed_drift: ray.drift,
        error: ray.errors.bound(),
        steps: ray.steps,
        rejected: ray.rejected,
        status,
        field: ray.field,
        conjugates: ray.conjugates,
        jacobi_knots: ray.jacobi_knots,
        segment: ray.segment,
        edge: ray.edge,
        evaluations: evaluations.get(),
    }
}

/// Returns the reason why a ray cannot continue at a point: the field is undefined, or has no gradient.
fn why(equation: &SpaceEquation<'_>, at: [f64; 3]) -> Status {
    if equation.piece.value(at).is_finite() {
        Status::Degenerate
    } else {
        Status::Undefined
    }
}

impl SpaceRay<'_> {
    fn run(&mut self, length: f64) -> Status {
        self.note();
        let scale = self.surface.size().min(length);
        // The requested length does not bound how short a step may be.
        let own = self.size_here().min(length);
        let own = if own > 0.0 { own } else { length };
        let mut h = self.plan.step;
        loop {
            let remaining = length - self.s;
            if remaining <= 1e-15 * length {
                return Status::Complete;
            }
            let each = self.plan.tableau.stages.len() + 2;
            if self.equation.evaluations.get() + each + AT_END > self.plan.limit {
                return Status::WorkLimit;
            }
            h = h.min(self.longest());
            let tried = step_to_try(h, remaining);
            match self.attempt(tried, scale) {
                Ok((next, ended)) => {
                    h = step_after(h, tried, next);
                    self.note();
                    if let Some(status) = ended {
                        return status;
                    }
                }
                Err(shorter) => {
                    self.rejected += 1;
                    h = shorter;
                }
            }
            let shortest = SHORTEST * own.max(self.s);
            if h < shortest && length - self.s > shortest {
                return self.stalled(shortest);
            }
        }
    }

    /// Returns the reason why the steps have shrunk to nothing.
    fn stalled(&self, shortest: f64) -> Status {
        // Far enough ahead to be visible above rounding.
        let ahead =
            [1.0, 1e2, 1e4].map(|k| combine(1.0, self.state.at, k * shortest, self.state.velocity));
        let undefined = |at: &[f64; 3]| why(&self.equation, *at) == Status::Undefined;
        if ahead.iter().any(undefined) {
            Status::Undefined
        } else {
            Status::Degenerate
        }
    }

    /// Returns the surface's size; if that is unknown, an estimate from the point's coordinates and the curvature
    /// there.
    fn size_here(&self) -> f64 {
        let size = self.surface.size();
        if size.is_finite() {
            return size;
        }
        let radius = self.shape.radius();
        let reach = norm(self.state.at);
        if radius.is_finite() {
            radius.max(reach)
        } else {
            reach
        }
    }

    fn longest(&self) -> f64 {
        let mut longest = f64::INFINITY;
        if self.plan.jacobi_knots {
            longest = jacobi::longest_step(self.shape.curvature);
        }
        if self.surface.has_edges() {
            longest = longest.min(BESIDE_EDGES * self.size_here().max(1e-300));
        }
        longest
    }

    fn note(&mut self) {
        let [m, rate] = self.field;
        if self.plan.jacobi_knots {
            self.jacobi_knots.push(JacobiKnot {
                length: self.s,
                m,
                rate,
                curvature: self.shape.curvature,
            });
        }
        if self.plan.knots {
            self.segment
                .knots
                .push(self.knot(&self.state, &self.shape, self.s, self.field));
        }
    }

    fn knot(&self, state: &SpaceState, shape: &LocalShape, s: f64, m: [f64; 2]) -> Knot<3> {
        let velocity = state.velocity;
        let normal = shape.left(velocity);
        // The normal is parallel along the geodesic; only the surface's own bend turns it.
        let turn = dot(normal, shape.bent(velocity));
        Knot {
            s,
            at: state.at,
            velocity,
            acceleration: shape.acceleration(velocity),
            m,
            normal: [normal, shape.normal.map(|n| -turn * n)],
        }
    }

    /// Takes one step and corrects it; `None` where a stage is undefined.
    fn step(&self, h: f64) -> Option<Tried> {
        let SpaceState { at, velocity } = self.state;
        let [x, y, z] = at;
        let [a, b, c] = velocity;
        let start = [x, y, z, a, b, c, 0.0, 1.0, 1.0, 0.0].map(|x| [x]);
        let step: Step<1, SpaceLocal, COMPONENTS> = runge_kutta::step::<1, COMPONENTS, SLOPES, _>(
            &self.equation,
            self.plan.tableau,
            &start,
            &SpaceLocal(Some(self.shape)),
            h,
            StepParameter::Length,
        )
        .ok()?;
        if !step.end.as_flattened().iter().all(|x| x.is_finite()) {
            return None;
        }
        let [[x], [y], [z], [a], [b], [c], [m], [m1], [n], [n1]] = step.end;
        let (at, velocity) = ([x, y, z], [a, b, c]);
        let rough = match step.evaluated_end {
            true => step.local.0?,
            false => self.equation.shape(at)?,
        };
        // One step of Newton's method back onto the surface …
        let at = combine(1.0, at, -rough.distance, rough.normal);
        let shape = self.equation.shape(at)?;
        // … and the velocity projected onto its tangent plane, at unit length.
        let tangential = shape.tangential(velocity);
        let speed = norm(tangential);
        if !(speed > 0.0 && speed.is_finite()) {
            return None;
        }
        let velocity_now = tangential.map(|x| x / speed);
        let turned = norm(combine(1.0, velocity_now, -1.0, velocity));
        Some(Tried {
            end: SpaceState {
                at,
                velocity: velocity_now,
            },
            shape,
            position_error: step.position_error[0] + rough.distance.abs(),
            direction_error: step.direction_error[0] + turned,
            field_error: step.field_error(h),
            drift: norm(velocity) - 1.0,
            propagator: [[n, m], [n1, m1]],
        })
    }

    /// Tries a step. Returns the next step's length, with the status of a ray that has ended; or, as an error, the
    /// length of another attempt.
    fn attempt(&mut self, h: f64, scale: f64) -> Result<(f64, Option<Status>), f64> {
        let tried = self.step(h).ok_or(UNDEFINED * h)?;
        if dot(tried.shape.normal, self.shape.normal) < LEAST_TURN {
            return Err(0.5 * h);
        }
        // Where the step is accurate, the distance left after its correction is rounding.
        if tried.position_error < GOOD * scale {
            self.noise = self.noise.max(tried.shape.distance.abs());
        }
        let rounding = self.rounding();
        let tolerance = self.plan.tolerance;
        let turned = scale * rounding / tried.shape.radius();
        let floor = (2.0 * (rounding + turned)).max(SMALL_STEP * tolerance * scale);
        let allowed = (tolerance * h).max(floor);
        let mut excess = tried.position_error / allowed + scale * tried.direction_error / allowed;
        if self.plan.accurate_jacobi {
            excess = excess.max(scale * tried.field_error / allowed);
        }
        let root = excess.powf(-1.0 / self.plan.tableau.error_order);
        let most = self.control.foreseen(h, root);
        let next = match self.control.judge(root, most) {
            Ok(factor) => h * factor * self.control.trend(h, SHORT * scale),
            Err(factor) => return Err(h * factor),
        };
        if let Some(share) = self.edge_within(&tried, h) {
            match self.plan.beyond {
                true => self.edge = Some(self.s + share * h),
                false => return Ok((h, Some(self.end_at(share * h, scale)))),
            }
        }
        self.accept(&tried, h, scale, rounding);
        Ok((next, None))
    }

    /// Returns the distance that rounding causes without any step.
    fn rounding(&self) -> f64 {
        ROUNDING * norm(self.state.at) + 2.0 * self.noise
    }

    fn accept(&mut self, tried: &Tried, h: f64, scale: f64, rounding: f64) {
        if self.plan.conjugates {
            self.note_conjugates(tried, h);
        }
        self.steps += 1;
        self.control.accept(h);
        self.s += h;
        self.state = tried.end;
        self.shape = tried.shape;
        self.drift += tried.drift;
        let [m, m1] = self.field;
        self.field = tried.propagator.map(|[n, k]| n * m + k * m1);
        let position = tried.position_error.max(h * tried.direction_error);
        let turned = rounding / self.shape.radius();
        let direction = tried.direction_error + turned + ROUNDING * (1.0 + h / scale);
        self.errors
            .add(tried.propagator, position + rounding, direction);
    }

    /// Returns the fraction of a step at which it meets the first edge.
    fn edge_within(&self, tried: &Tried, h: f64) -> Option<f64> {
        if !self.surface.has_edges() || self.edge.is_some() {
            return None;
        }
        let of = |state: &SpaceState, shape: &LocalShape| {
            [state.at, state.velocity, shape.acceleration(state.velocity)]
        };
        let path = StepPath::new(
            h,
            of(&self.state, &self.shape),
            of(&tried.end, &tried.shape),
        );
        let piece = self.equation.piece;
        let borders =
            |part: &PathPart<3>| Borders::none_if(self.surface.stays_on(piece, part.within()));
        path.first_beyond(&borders, &|at| self.surface.is_beyond(piece, at))
    }

    /// Ends at an edge that a step of this length meets.
    fn end_at(&mut self, h: f64, scale: f64) -> Status {
        let rounding = self.rounding();
        if let Some(tried) = self.step(h) {
            self.accept(&tried, h, scale, rounding);
        }
        Status::LeftDomain
    }

    /// Adds the arc lengths of the conjugate points within a step that is about to be accepted, by bracketed Newton's method
    /// on the step's length. They are as accurate as the steps.
    fn note_conjugates(&mut self, tried: &Tried, h: f64) {
        let before = self.field;
        let carried = |tried: &Tried| tried.propagator.map(|[n, k]| n * before[0] + k * before[1]);
        let after = carried(tried);
        for mut zero in brackets(h, before, after) {
            for _ in 0..ROUNDS {
                let Some(part) = self.step(zero.at) else {
                    break;
                };
                if zero.narrow(carried(&part), h) {
                    break;
                }
            }
            self.conjugates.push(self.s + zero.at);
        }
    }
}
