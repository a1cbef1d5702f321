//! A surface's position with all its derivatives up to order two: what a geodesic asks for at every point. Jets in
//! blocks of several sizes, symbolic derivatives on two evaluators, and Rust written by hand, in one run.

use std::hint::black_box;
use std::time::{Duration, Instant};

use expr::elementary::{sin_cos, sinh_cosh};
use expr::jets::{JetRegisters, JetTape, LANES, Order};
use expr::processor::{Processor, Work};
use expr::tape::{self, Registers, Tape};
use expr::{Graph, Input, NodeId};
use scene::Settings;
use scene::scene::Shape;
use testing::examples;

/// How many points a run takes; a multiple of all block sizes.
const POINTS: usize = 4096;
/// How often a run is repeated; the best counts.
const RUNS: usize = 25;

const U: Input = Input::Variable(0);
const V: Input = Input::Variable(1);

/// Six vectors, component by component: what is filled at each block of points.
type Vectors<const N: usize> = [[[f64; N]; 3]; 6];

/// The same by hand, at the points of a block: positions in, six vectors out.
type ByHand = fn(&[[f64; LANES]; 2], &mut Vectors<LANES>);

/// A surface of an example, and the hand that writes it; `None` without one.
struct Case {
    name: &'static str,
    /// Written by hand with the library's sines, one point after the other.
    plain: ByHand,
    /// Written by hand over lanes, with this project's sines.
    lanes: ByHand,
}

const CASES: [Case; 4] = [
    Case {
        name: "torus",
        plain: |at, out| each(at, out, |u, v| torus(u.sin_cos(), v.sin_cos())),
        lanes: |at, out| {
            let ([su, sv], [cu, cv]) = sines(at);
            for lane in 0..LANES {
                put(out, lane, torus((su[lane], cu[lane]), (sv[lane], cv[lane])));
            }
        },
    },
    Case {
        name: "sphere",
        plain: |at, out| {
            each(at, out, |u, v| {
                sphere((TAU * u).sin_cos(), (PI * v).sin_cos())
            });
        },
        lanes: |at, out| {
            let ([su, sv], [cu, cv]) = sines(&[at[0].map(|u| TAU * u), at[1].map(|v| PI * v)]);
            for lane in 0..LANES {
                put(
                    out,
                    lane,
                    sphere((su[lane], cu[lane]), (sv[lane], cv[lane])),
                );
            }
        },
    },
    Case {
        name: "klein",
        plain: |at, out| each(at, out, |u, v| klein(u.sin_cos(), v.sin_cos())),
        lanes: |at, out| {
            let ([su, sv], [cu, cv]) = sines(at);
            for lane in 0..LANES {
                put(out, lane, klein((su[lane], cu[lane]), (sv[lane], cv[lane])));
            }
        },
    },
    Case {
        name: "pseudosphere",
        plain: |at, out| {
            each(at, out, |u, v| {
                pseudosphere(u.sin_cos(), (v.sinh(), v.cosh()), v)
            });
        },
        lanes: |at, out| {
            let (su, cu) = sin_cos(&at[0]);
            let (sv, cv) = sinh_cosh(&at[1]);
            for lane in 0..LANES {
                let hyperbolic = (sv[lane], cv[lane]);
                put(
                    out,
                    lane,
                    pseudosphere((su[lane], cu[lane]), hyperbolic, at[1][lane]),
                );
            }
        },
    },
];

use std::f64::consts::{PI, TAU};

/// The torus' smaller radius: its param as the example opens.
const TUBE: f64 = 0.4;

#[inline(always)]
fn torus((su, cu): (f64, f64), (sv, cv): (f64, f64)) -> [[f64; 3]; 6] {
    let (rc, rs) = (TUBE * cv, TUBE * sv);
    let radius = 1.0 + rc;
    let (x, y) = (radius * cu, radius * su);
    [
        [x, y, rs],
        [-y, x, 0.0],
        [-rs * cu, -rs * su, rc],
        [-x, -y, 0.0],
        [rs * su, -rs * cu, 0.0],
        [-rc * cu, -rc * su, -rs],
    ]
}

/// The thesis' sphere: longitude 2πu, the angle from the pole πv, radius 0.99.
#[inline(always)]
fn sphere((su, cu): (f64, f64), (sv, cv): (f64, f64)) -> [[f64; 3]; 6] {
    const R: f64 = 0.99;
    let (rs, rc) = (R * sv, R * cv);
    let (x, y) = (rs * cu, rs * su);
    let (cx, cy) = (rc * cu, rc * su);
    [
        [x, y, rc],
        [-TAU * y, TAU * x, 0.0],
        [PI * cx, PI * cy, -PI * rs],
        [-TAU * TAU * x, -TAU * TAU * y, 0.0],
        [-TAU * PI * cy, TAU * PI * cx, 0.0],
        [-PI * PI * x, -PI * PI * y, -PI * PI * rc],
    ]
}

/// (cos u/cosh v, sin u/cosh v, v − tanh v).
#[inline(always)]
fn pseudosphere((su, cu): (f64, f64), (sinh, cosh): (f64, f64), v: f64) -> [[f64; 3]; 6] {
    let sech = 1.0 / cosh;
    let tanh = sinh * sech;
    let square = sech * sech;
    let first = -sech * tanh;
    let second = sech * (tanh * tanh - square);
    let (x, y) = (sech * cu, sech * su);
    [
        [x, y, v - tanh],
        [-y, x, 0.0],
        [first * cu, first * su, tanh * tanh],
        [-x, -y, 0.0],
        [-first * su, first * cu, 0.0],
        [second * cu, second * su, 2.0 * tanh * square],
    ]
}

/// A function of one variable with its first and second derivative.
type Curve = [f64; 3];

/// The bottle: c(u) + r(u)(−cos u cos v, sin v, −q(u) sin u cos v/2). Everything in u is a polynomial in its sine and
/// cosine.
#[inline(always)]
fn klein((su, cu): (f64, f64), (sv, cv): (f64, f64)) -> [[f64; 3]; 6] {
    let product = |a: Curve, b: Curve| {
        [
            a[0] * b[0],
            a[1] * b[0] + a[0] * b[1],
            a[2] * b[0] + 2.0 * (a[1] * b[1]) + a[0] * b[2],
        ]
    };
    let sum = |a: Curve, b: Curve| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
    let scale = |s: f64, a: Curve| [s * a[0], s * a[1], s * a[2]];
    let plus = |s: f64, a: Curve| [s + a[0], a[1], a[2]];
    let (sin, cos): (Curve, Curve) = ([su, cu, -su], [cu, -su, -cu]);
    let both = product(cos, sin);
    let cos2 = product(cos, cos);
    let cos4 = product(cos2, cos2);
    let cos6 = product(cos4, cos2);
    let r = scale(2.0 / 15.0, plus(3.0, scale(5.0, both)));
    let q = sum(
        plus(1.0, scale(-1.0, cos2)),
        sum(scale(-16.0, cos4), scale(16.0, cos6)),
    );
    let cx = product(
        scale(4.0, both),
        plus(1.0, sum(scale(-3.0, cos4), scale(2.0, cos6))),
    );
    let cz = scale(4.0, product(sin, sin));
    let x = scale(-1.0, product(r, cos));
    let z = scale(-0.5, product(product(r, q), sin));
    let row = |k: usize, sv: f64, cv: f64, centre: f64| {
        [
            centre * cx[k] + x[k] * cv,
            r[k] * sv,
            centre * cz[k] + z[k] * cv,
        ]
    };
    [
        row(0, sv, cv, 1.0),
        row(1, sv, cv, 1.0),
        row(0, cv, -sv, 0.0),
        row(2, sv, cv, 1.0),
        row(1, cv, -sv, 0.0),
        row(0, -sv, -cv, 0.0),
    ]
}

/// Sines and cosines of both variables.
#[inline(always)]
fn sines(at: &[[f64; LANES]; 2]) -> ([[f64; LANES]; 2], [[f64; LANES]; 2]) {
    let (su, cu) = sin_cos(&at[0]);
    let (sv, cv) = sin_cos(&at[1]);
    ([su, sv], [cu, cv])
}

#[inline(always)]
fn put(out: &mut Vectors<LANES>, lane: usize, vectors: [[f64; 3]; 6]) {
    for (out, vector) in out.iter_mut().zip(vectors) {
        for (out, component) in out.iter_mut().zip(vector) {
            out[lane] = component;
        }
    }
}

#[inline(always)]
fn each(
    at: &[[f64; LANES]; 2],
    out: &mut Vectors<LANES>,
    f: impl Fn(f64, f64) -> [[f64; 3]; 6],
) {
    for lane in 0..LANES {
        put(out, lane, f(at[0][lane], at[1][lane]));
    }
}

/// The best of many runs over all points, in nanoseconds per point.
fn time(mut work: impl FnMut()) -> f64 {
    let mut best = Duration::MAX;
    for _ in 0..RUNS {
        let start = Instant::now();
        work();
        best = best.min(start.elapsed());
    }
    1e9 * best.as_secs_f64() / POINTS as f64
}

/// Points spread over a domain, in blocks.
fn points<const N: usize>(domain: [[f64; 2]; 2]) -> Vec<[[f64; N]; 2]> {
    let at = |k: usize| {
        let k = k as f64;
        // Two irrational steps: no direction of the chart is favoured.
        [
            (k * 0.754_877_666_246_693).fract(),
            (k * 0.569_840_290_998_053).fract(),
        ]
    };
    (0..POINTS / N)
        .map(|block| {
            [0, 1].map(|axis| {
                let [low, high] = domain[axis];
                std::array::from_fn(|lane| low + (high - low) * at(block * N + lane)[axis])
            })
        })
        .collect()
}

/// An example's first surface.
struct Chart {
    graph: Graph,
    position: [NodeId; 3],
    domain: [[f64; 2]; 2],
    uniforms: Vec<f64>,
}

impl Chart {
    fn of(name: &str) -> Option<Self> {
        let scene = scene::compile(&examples::one(name).source).scene?;
        let settings = Settings::opening(&scene);
        scene.objects.iter().find_map(|object| match &object.shape {
            Shape::Surface {
                position, domain, ..
            } => Some(Self {
                graph: scene.graph.clone(),
                position: *position,
                domain: domain
                    .each_ref()
                    .map(|axis| [axis.range.min, axis.range.max]),
                uniforms: settings.first_instance(&scene, object),
            }),
            _ => None,
        })
    }

    fn values(&self, uniforms: &[Input]) -> Vec<f64> {
        uniforms
            .iter()
            .map(|input| match *input {
                Input::Uniform(k) => self.uniforms[k as usize],
                Input::Variable(_) => f64::NAN,
            })
            .collect()
    }

    /// All six vectors by symbolic derivatives.
    fn symbolic(&self) -> Option<(Graph, Vec<NodeId>)> {
        let (mut graph, position) = self.graph.extract(&self.position);
        let du = graph.derivatives(&position, U).ok()?;
        let dv = graph.derivatives(&position, V).ok()?;
        let duu = graph.derivatives(&du, U).ok()?;
        let duv = graph.derivatives(&du, V).ok()?;
        let dvv = graph.derivatives(&dv, V).ok()?;
        Some((graph, [position, du, dv, duu, duv, dvv].concat()))
    }
}

/// Jets over blocks of `N`.
fn jets<const N: usize>(chart: &Chart, tape: &JetTape) -> f64 {
    let fixed = tape.fix(&chart.values(tape.uniforms()));
    let mut registers = JetRegisters::default();
    let blocks = points::<N>(chart.domain);
    let mut out: Vec<Vectors<N>> = vec![[[[0.0; N]; 3]; 6]; blocks.len()];
    time(|| {
        for (at, out) in blocks.iter().zip(&mut out) {
            let [position, du, dv, duu, duv, dvv] = out;
            let out = [
                &mut position[..],
                &mut du[..],
                &mut dv[..],
                &mut duu[..],
                &mut duv[..],
                &mut dvv[..],
            ];
            tape.eval(&mut registers, &fixed, black_box(at), out);
        }
        black_box(&mut out);
    })
}

/// Symbolic derivatives, evaluated like jets.
fn symbolic_in_lanes(chart: &Chart, graph: &Graph, roots: &[NodeId]) -> Option<(usize, f64)> {
    let tape = JetTape::new(graph, roots, [U, V], Order::Value).ok()?;
    let fixed = tape.fix(&chart.values(tape.uniforms()));
    let mut registers = JetRegisters::default();
    let blocks = points::<LANES>(chart.domain);
    let mut out = vec![[[0.0; LANES]; 18]; blocks.len()];
    let time = time(|| {
        for (at, out) in blocks.iter().zip(&mut out) {
            tape.eval(&mut registers, &fixed, black_box(at), [out]);
        }
        black_box(&mut out);
    });
    Some((tape.instruction_count(), time))
}

/// Symbolic derivatives on the plain tape, in blocks of its size.
fn symbolic_in_blocks(chart: &Chart, graph: &Graph, roots: &[NodeId]) -> f64 {
    let tape = Tape::new(graph, roots);
    let mut registers = Registers::default();
    let blocks: Vec<Vec<tape::Block>> = points::<{ tape::LANES }>(chart.domain)
        .into_iter()
        .map(|at| {
            let column = |input: &Input| match *input {
                U => at[0],
                V => at[1],
                input => [chart.values(&[input])[0]; tape::LANES],
            };
            tape.inputs().iter().map(column).collect()
        })
        .collect();
    let mut out = vec![[[0.0; tape::LANES]; 18]; blocks.len()];
    time(|| {
        for (inputs, out) in blocks.iter().zip(&mut out) {
            tape.eval_block(&mut registers, black_box(inputs), out);
        }
        black_box(&mut out);
    })
}

/// One block by hand, for the processor at hand.
struct Block<'a>(ByHand, &'a [[f64; LANES]; 2], &'a mut Vectors<LANES>);

/// What a case's hand is called by. One type for each case would be inlined; a pointer is not.
macro_rules! by_hand {
    ($name:ident, $case:literal) => {
        struct $name<'a>(&'a [[f64; LANES]; 2], &'a mut Vectors<LANES>);

        impl Work for $name<'_> {
            type Output = ();

            #[inline(always)]
            fn run(self) {
                (CASES[$case].lanes)(self.0, self.1);
            }
        }
    };
}
