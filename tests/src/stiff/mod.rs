//! The stiff list: geodesics that are hard to follow, each with what is measured and the bound that it has to keep.
//!
//! What flows in: options for the tracer. What flows out: [`Row`]s: our figure, its bound, the evaluations, and the
//! figure of the thesis' method (the classical Runge–Kutta method with 512 steps in (u,v)) for the same case. The
//! tests of `geodesic` hold every row, and `cargo run --release -p geotrace-benches stiff` prints them.

mod hyperbolic;
mod polar;
mod revolution;
mod rough;
#[path = "../../../crates/geodesic/tests/suite/shapes/mod.rs"]
pub(crate) mod shapes;
pub mod spheroids;
mod whole;

use geodesic::surface::Surface;
use geodesic::trace::{MOST_OF_ONE, Options, Status, Trace, TraceMethod, trace};

/// What one run of a case gave.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// The quantity that the bound is for; NaN where the ray did not do what it should.
    pub value: f64,
    /// Evaluations of the surface: of the dearest ray, where there are many.
    pub evaluations: usize,
}

/// A case of the list.
pub struct Case {
    /// The row's name in the list.
    pub id: &'static str,
    /// What is traced.
    pub case: String,
    /// What is measured.
    pub quantity: &'static str,
    /// What the quantity may be at most.
    pub bound: f64,
    /// What the evaluations of one ray may be at most.
    pub most: usize,
    /// Runs it.
    pub run: Box<dyn Fn(&Options) -> Measured>,
}

/// A case with its figures.
#[derive(Clone, Debug)]
pub struct Row {
    /// The row's name in the list.
    pub id: &'static str,
    /// What was traced.
    pub case: String,
    /// What was measured.
    pub quantity: &'static str,
    /// Our figure.
    pub ours: f64,
    /// What it may be at most.
    pub bound: f64,
    /// Our evaluations, of the dearest ray.
    pub evaluations: usize,
    /// What they may be at most.
    pub most: usize,
    /// The figure of the thesis' method; NaN where it gives none.
    pub thesis: f64,
}

impl Row {
    /// Whether our figures keep their bounds.
    pub fn holds(&self) -> bool {
        self.ours <= self.bound && self.evaluations <= self.most
    }
}

/// The most evaluations of a ray (row V4).
pub const LIMIT: usize = 20_000;

/// All cases, in the list's order.
pub fn cases() -> Vec<Case> {
    let mut cases = polar::cases();
    cases.extend(revolution::cases());
    cases.extend(hyperbolic::cases());
    cases.extend(spheroids::cases());
    cases.extend(rough::cases());
    cases.extend(whole::cases());
    cases
}

impl Case {
    fn new(
        id: &'static str,
        case: impl Into<String>,
        quantity: &'static str,
        bound: f64,
        run: impl Fn(&Options) -> Measured + 'static,
    ) -> Self {
        Self {
            id,
            case: case.into(),
            quantity,
            bound,
            most: LIMIT,
            run: Box::new(run),
        }
    }

    /// The same with fewer evaluations allowed.
    fn within(self, most: usize) -> Self {
        Self { most, ..self }
    }

    /// Runs the case, with our method and with the thesis'.
    pub fn row(&self) -> Row {
        let ours = (self.run)(&Options::default());
        let thesis = (self.run)(&thesis());
        Row {
            id: self.id,
            case: self.case.clone(),
            quantity: self.quantity,
            ours: ours.value,
            bound: self.bound,
            evaluations: ours.evaluations,
            most: self.most,
            thesis: thesis.value,
        }
    }
}

/// The same options with the evaluations that `geotrace trace` allows unless it is told otherwise.
fn with_more_work(options: &Options) -> Options {
    Options {
        max_evaluations: MOST_OF_ONE,
        ..*options
    }
}

/// The thesis' method.
pub fn thesis() -> Options {
    Options {
        method: TraceMethod::Rk4 { steps: 512 },
        ..Options::default()
    }
}

/// One ray.
fn go(
    surface: &dyn Surface,
    from: [f64; 2],
    direction: [f64; 2],
    length: f64,
    options: &Options,
) -> Trace {
    trace(surface, from, direction, length, options).unwrap_or_else(|_| Trace {
        status: Status::Undefined,
        ..Trace::default()
    })
}

/// A quantity of a ray that got where it should.
fn complete(end: &Trace, value: impl FnOnce(&Trace) -> f64) -> Measured {
    Measured {
        value: if end.status == Status::Complete {
            value(end)
        } else {
            f64::NAN
        },
        evaluations: end.evaluations,
    }
}

/// The worst of several runs; NaN where any is.
fn worst(runs: impl IntoIterator<Item = Measured>) -> Measured {
    let none = Measured {
        value: 0.0,
        evaluations: 0,
    };
    runs.into_iter().fold(none, |a, b| Measured {
        value: if a.value.is_nan() || b.value.is_nan() {
            f64::NAN
        } else {
            a.value.max(b.value)
        },
        evaluations: a.evaluations.max(b.evaluations),
    })
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// The distance of an end in space from where it should be.
fn off(end: &Trace, expected: [f64; 3]) -> f64 {
    end.position.map_or(f64::NAN, |at| distance(at, expected))
}

/// SplitMix64: the same numbers on every machine.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A number whose logarithm is uniform.
    fn size(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }
}
