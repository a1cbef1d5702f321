//! A surface's position with all its derivatives up to order two: what a geodesic asks for at every point. Jets in
//! blocks of several sizes, symbolic derivatives on two evaluators, and Rust written by hand, in one run.

use std::f64::consts::{PI, TAU};
use std::hint::black_box;
use std::marker::PhantomData;
use std::time::{Duration, Instant};

use expr::elementary::{sin_cos, sinh_cosh};
use expr::jets::{JetRegisters, JetTape, LANES, Order};
use expr::processor::{Processor, Work};
use expr::tape::{self, Registers, Tape};
use expr::{Graph, Input, NodeId};
use scene::ParamValues;
use scene::Shape;
use testing::examples;

/// How many points a run takes; a multiple of all block sizes.
const POINTS: usize = 4096;
/// How often a run is repeated; the best counts.
const RUNS: usize = 25;

const U: Input = Input::Variable(0);
const V: Input = Input::Variable(1);

/// Six vectors, component by component: what is filled at each block of points.
type Vectors<const N: usize> = [[[f64; N]; 3]; 6];

/// An example's surface, written by hand.
trait Hand {
    const NAME: &'static str;
    /// With the library's functions, at one point.
    fn plain(u: f64, v: f64) -> [[f64; 3]; 6];
    /// With this project's functions, over lanes.
    fn lanes(at: &[[f64; LANES]; 2], out: &mut Vectors<LANES>);
}

struct Torus;
struct Sphere;
struct Klein;
struct Pseudosphere;

impl Hand for Torus {
    const NAME: &'static str = "torus";

    fn plain(u: f64, v: f64) -> [[f64; 3]; 6] {
        torus(u.sin_cos(), v.sin_cos())
    }

    #[inline(always)]
    fn lanes(at: &[[f64; LANES]; 2], out: &mut Vectors<LANES>) {
        let ((su, cu), (sv, cv)) = (sin_cos(&at[0]), sin_cos(&at[1]));
        for lane in 0..LANES {
            put(out, lane, torus((su[lane], cu[lane]), (sv[lane], cv[lane])));
        }
    }
}

impl Hand for Sphere {
    const NAME: &'static str = "sphere";

    fn plain(u: f64, v: f64) -> [[f64; 3]; 6] {
        sphere((TAU * u).sin_cos(), (PI * v).sin_cos())
    }

    #[inline(always)]
    fn lanes(at: &[[f64; LANES]; 2], out: &mut Vectors<LANES>) {
        let angles = [at[0].map(|u| TAU * u), at[1].map(|v| PI * v)];
        let ((su, cu), (sv, cv)) = (sin_cos(&angles[0]), sin_cos(&angles[1]));
        for lane in 0..LANES {
            put(
                out,
                lane,
                sphere((su[lane], cu[lane]), (sv[lane], cv[lane])),
            );
        }
    }
}

impl Hand for Klein {
    const NAME: &'static str = "klein";

    fn plain(u: f64, v: f64) -> [[f64; 3]; 6] {
        klein(u.sin_cos(), v.sin_cos())
    }

    #[inline(always)]
    fn lanes(at: &[[f64; LANES]; 2], out: &mut Vectors<LANES>) {
        let ((su, cu), (sv, cv)) = (sin_cos(&at[0]), sin_cos(&at[1]));
        for lane in 0..LANES {
            put(out, lane, klein((su[lane], cu[lane]), (sv[lane], cv[lane])));
        }
    }
}

impl Hand for Pseudosphere {
    const NAME: &'static str = "pseudosphere";

    fn plain(u: f64, v: f64) -> [[f64; 3]; 6] {
        pseudosphere(u.sin_cos(), (v.sinh(), v.cosh()), v)
    }

    #[inline(always)]
    fn lanes(at: &[[f64; LANES]; 2], out: &mut Vectors<LANES>) {
        let ((su, cu), (sv, cv)) = (sin_cos(&at[0]), sinh_cosh(&at[1]));
        for lane in 0..LANES {
            let vectors = pseudosphere((su[lane], cu[lane]), (sv[lane], cv[lane]), at[1][lane]);
            put(out, lane, vectors);
        }
    }
}

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

#[inline(always)]
fn put(out: &mut Vectors<LANES>, lane: usize, vectors: [[f64; 3]; 6]) {
    for (out, vector) in out.iter_mut().zip(vectors) {
        for (out, component) in out.iter_mut().zip(vector) {
            out[lane] = component;
        }
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
        let scene = scene::geotrace::compile(&examples::one(name).source).scene?;
        let settings = ParamValues::initial(&scene);
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
            tape.eval(
                &mut registers,
                &fixed,
                black_box(at),
                out.as_flattened_mut(),
            );
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
            tape.eval(&mut registers, &fixed, black_box(at), out);
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

/// A block by hand: one call, as for jets.
struct Block<'a, H> {
    at: &'a [[f64; LANES]; 2],
    out: &'a mut Vectors<LANES>,
    hand: PhantomData<H>,
}

impl<H: Hand> Work for Block<'_, H> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        H::lanes(self.at, self.out);
    }
}

/// By hand: plain, over lanes.
fn by_hand<H: Hand>(chart: &Chart) -> [f64; 2] {
    let blocks = points::<LANES>(chart.domain);
    let mut out: Vec<Vectors<LANES>> = vec![[[[0.0; LANES]; 3]; 6]; blocks.len()];
    let plain = time(|| {
        for (at, out) in blocks.iter().zip(&mut out) {
            for (lane, (&u, &v)) in at[0].iter().zip(&at[1]).enumerate() {
                put(out, lane, H::plain(u, v));
            }
        }
        black_box(&mut out);
    });
    let processor = Processor::here();
    let lanes = time(|| {
        for (at, out) in blocks.iter().zip(&mut out) {
            processor.run(Block::<H> {
                at: black_box(at),
                out,
                hand: PhantomData,
            });
        }
        black_box(&mut out);
    });
    [plain, lanes]
}

/// The largest difference between the jets and the hand, over all points and vectors, relative to the vector of that
/// kind that is longest.
fn difference<H: Hand>(chart: &Chart, tape: &JetTape) -> f64 {
    let fixed = tape.fix(&chart.values(tape.uniforms()));
    let mut registers = JetRegisters::default();
    let (mut worst, mut longest) = ([0.0f64; 6], [0.0f64; 6]);
    for at in points::<1>(chart.domain) {
        let mut out = [[[0.0]; 3]; 6];
        tape.eval(&mut registers, &fixed, &at, out.as_flattened_mut());
        for (k, hand) in H::plain(at[0][0], at[1][0]).iter().enumerate() {
            for (component, [jet]) in hand.iter().zip(&out[k]) {
                worst[k] = worst[k].max((component - jet).abs());
                longest[k] = longest[k].max(component.abs());
            }
        }
    }
    let ratios = worst.iter().zip(&longest).filter(|(_, size)| **size > 0.0);
    ratios.map(|(error, size)| error / size).fold(0.0, f64::max)
}

fn row<H: Hand>() {
    let Some(chart) = Chart::of(H::NAME) else {
        println!("  {:13} has no surface", H::NAME);
        return;
    };
    let compile = || JetTape::new(&chart.graph, &chart.position, [U, V], Order::Second);
    let (Ok(tape), Some((graph, roots))) = (compile(), chart.symbolic()) else {
        println!("  {:13} is too large", H::NAME);
        return;
    };
    let construction = time(|| {
        for _ in 0..64 {
            black_box(compile().is_ok());
        }
    }) * POINTS as f64
        / 64.0;
    let Some((symbolic_count, symbolic)) = symbolic_in_lanes(&chart, &graph, &roots) else {
        return;
    };
    let [plain, lanes] = by_hand::<H>(&chart);
    let eight = jets::<LANES>(&chart, &tape);
    println!(
        "  {:13}{:8.1}{:8.2}{:8.2}{:8.2}{:9.2}{:9.2}{:9.2}{:8.2}{:9.1}{:6}/{:<5}{:7.0e}",
        H::NAME,
        jets::<1>(&chart, &tape),
        eight,
        jets::<64>(&chart, &tape),
        symbolic,
        symbolic_in_blocks(&chart, &graph, &roots),
        plain,
        lanes,
        eight / lanes,
        construction / 1e3,
        tape.instruction_count(),
        symbolic_count,
        difference::<H>(&chart, &tape),
    );
}

/// Prints the table.
pub(crate) fn run() {
    println!(
        "Position and all derivatives up to order two, ns per point (the best of {RUNS} runs over {POINTS} points)"
    );
    println!(
        "  jets in blocks of 1, 8, 64; symbolic derivatives in blocks of 8 on the same evaluator, and of 64 on the \
         plain tape;\n  Rust by hand with the library's functions point by point, and with our own over 8 lanes; µs to \
         make the jets' code;\n  instructions of jets and of symbolic derivatives; largest difference of jets and hand, \
         relative"
    );
    println!(
        "  {:13}{:>8}{:>8}{:>8}{:>8}{:>9}{:>9}{:>9}{:>8}{:>9}{:>12}{:>7}",
        "surface",
        "jets 1",
        "jets 8",
        "jets 64",
        "symb 8",
        "symb 64",
        "hand std",
        "hand 8",
        "8/hand",
        "make µs",
        "instructions",
        "differ"
    );
    row::<Torus>();
    row::<Sphere>();
    row::<Klein>();
    row::<Pseudosphere>();
}
