//! Surfaces given by a metric alone. In: E du² + 2F du dv + G dv². Out: jets.
//!
//! Without an embedding there is no σ. Geodesics need only inner products of the derivatives of σ at one point, which
//! follow from E, F, G and their derivatives. So a jet is given in an orthonormal frame specific to its point: the
//! tangential parts by the Christoffel symbols, and normal parts chosen so that Gauss's equation gives the curvature.
//! Jets at different points must not be compared: [`Surface::is_embedded`] returns false.

use std::cell::RefCell;

use expr::graph::TooLarge;
use expr::interval::Interval;
use expr::jets::{Fixed, JetRegisters, JetTape, Order};
use expr::processor::{Processor, Work};
use expr::tape::{Registers, Tape};
use expr::{Graph, Input, NodeId};

use crate::jet::{Jet, JetBlock, LANES, Lanes};
use crate::metric::Form;
use crate::point::Uv;
use crate::scale::{Scale, at};
use crate::smooth_pieces::SmoothPieces;
use crate::step_path::{Borders, PathPart};
use crate::surface::{ChartData, Surface};
use crate::topology::Topology;
use crate::vector::norm;

/// A metric E du² + 2F du dv + G dv² given by expressions in `Variable(0)` = u and `Variable(1)` = v, with the
/// uniforms' values fixed.
///
/// Opposite sides of the domain at which E, F, G and their first derivatives agree are glued: the metric du² + dv² of
/// a rectangle is a flat torus. If they agree only with one side reversed (E and G even, F odd), they are glued
/// with a flip. A side along which the length is zero is the tip of a cone, or a smooth point where its angle is 2π.
/// It is degenerate where E ≤ 0 or EG − F² ≤ 0. The position of its jets is (u, v, 0), which is not a point in space.
#[derive(Clone, Debug)]
pub struct MetricSurface {
    tape: Tape,
    inputs: Vec<Source>,
    /// E, F, G with their derivatives, for several points at once.
    jets: JetTape,
    fixed: Fixed,
    pieces: Option<SmoothPieces>,
    chart_data: ChartData,
}

/// The source of an input of the tape.
#[derive(Clone, Copy, Debug)]
enum Source {
    U,
    V,
    Fixed(f64),
}

thread_local! {
    /// Registers and inputs of the evaluation, one set per thread, to avoid allocations.
    static SCRATCH: RefCell<(Registers, Vec<f64>)> = RefCell::default();
    /// The same for several points at once.
    static BLOCK: RefCell<JetRegisters> = RefCell::default();
}

impl MetricSurface {
    /// Differentiates the form [E, F, G], compiles it, and determines the kinds of the sides. A uniform without a value
    /// is NaN, which makes the metric undefined.
    ///
    /// # Errors
    /// [`TooLarge`] where the derivatives do not fit into the graph's limit.
    pub fn new(
        graph: &Graph,
        form: [NodeId; 3],
        domain: [[f64; 2]; 2],
        uniforms: &[f64],
    ) -> Result<Self, TooLarge> {
        let (mut graph, form) = graph.extract(&form);
        let variables = [Input::Variable(0), Input::Variable(1)];
        let jets = JetTape::new(&graph, &form, variables, Order::Second)?;
        let value = |input: &Input| input.value(&[], uniforms);
        let values: Vec<f64> = jets.uniforms().iter().map(value).collect();
        let fixed = jets.fix(&values);
        let pieces = SmoothPieces::of(&graph, &form, value)?;
        let by_u = graph.derivatives(&form, Input::Variable(0))?;
        let by_v = graph.derivatives(&form, Input::Variable(1))?;
        let seconds = [
            (by_v[0], Input::Variable(1)),
            (by_u[1], Input::Variable(1)),
            (by_u[2], Input::Variable(0)),
        ];
        let mut roots = [form, by_u, by_v].concat();
        for (root, variable) in seconds {
            roots.extend(graph.derivatives(&[root], variable)?);
        }
        let tape = Tape::new(&graph, &roots);
        let inputs = tape
            .inputs()
            .iter()
            .map(|input| match *input {
                Input::Variable(0) => Source::U,
                Input::Variable(1) => Source::V,
                _ => Source::Fixed(value(input)),
            })
            .collect();
        let mut surface = Self {
            tape,
            inputs,
            jets,
            fixed,
            pieces,
            chart_data: ChartData::of(domain),
        };
        surface.chart_data.scale = measure(&|uv| surface.jet(uv), domain);
        surface.chart_data.topology = Topology::of_metric(
            &|uv| surface.form(uv),
            &|uv| surface.jet(uv),
            domain,
            surface.chart_data.scale,
        );
        Ok(surface)
    }

    fn form(&self, uv: Uv) -> Form {
        let mut out = [0.0; 12];
        SCRATCH.with_borrow_mut(|(registers, values)| {
            values.clear();
            values.extend(self.inputs.iter().map(|source| match *source {
                Source::U => uv[0],
                Source::V => uv[1],
                Source::Fixed(value) => value,
            }));
            self.tape.eval(registers, values, &mut out);
        });
        let triple = |k: usize| [out[k], out[k + 1], out[k + 2]];
        Form {
            efg: triple(0),
            by_u: triple(3),
            by_v: triple(6),
            bent: -0.5 * out[9] + out[10] - 0.5 * out[11],
        }
    }
}

impl Surface for MetricSurface {
    fn jet(&self, uv: Uv) -> Jet {
        jet_of(&self.form(uv), uv.0)
    }

    fn jets(&self, at: &[Lanes; 2], out: &mut JetBlock) {
        let mut forms = JetBlock::default();
        BLOCK.with_borrow_mut(|registers| {
            let forms: &mut [Lanes; 18] = bytemuck::cast_mut(&mut forms);
            self.jets.eval(registers, &self.fixed, at, forms);
        });
        let regular = Processor::here().run(RegularJets {
            forms: &forms,
            at,
            out: &mut *out,
        });
        if !regular {
            for (lane, (&u, &v)) in at[0].iter().zip(&at[1]).enumerate() {
                out.set(lane, &jet_of(&Form::of_lane(&forms, lane), [u, v]));
            }
        }
    }

    fn smooth_piece(&self, uv: Uv) -> u64 {
        self.pieces.as_ref().map_or(0, |pieces| pieces.at(uv))
    }

    fn is_one_piece(&self, within: [Interval; 2]) -> bool {
        self.pieces
            .as_ref()
            .is_none_or(|pieces| pieces.is_one(within))
    }

    fn creases_along(&self, part: &PathPart<2>) -> Borders {
        let pieces = self.pieces.as_ref();
        pieces.map_or(Borders::None, |pieces| pieces.along(part))
    }

    fn is_embedded(&self) -> bool {
        false
    }

    fn instruction_count(&self) -> usize {
        self.tape
            .operation_count()
            .max(self.jets.instruction_count())
    }

    fn chart_data(&self) -> &ChartData {
        &self.chart_data
    }
}

/// √(EG − F²), a difference of products with its rounding error compensated.
#[inline(always)]
fn area_element([e, f, g]: [f64; 3]) -> f64 {
    if f == 0.0 {
        return e.sqrt() * g.sqrt();
    }
    let square = f * f;
    let lost = f.mul_add(-f, square);
    (e.mul_add(g, -square) + lost).sqrt()
}

/// Returns the jet in the frame e₁ ∥ σu, e₂ to its left, e₃ the normal.
fn jet_of(form: &Form, uv: [f64; 2]) -> Jet {
    let [e, f, g] = form.efg;
    let position = [uv[0], uv[1], 0.0];
    let undefined = [f64::NAN; 3];
    if !(e.is_finite() && f.is_finite() && g.is_finite()) {
        return Jet {
            position: undefined,
            du: undefined,
            dv: undefined,
            duu: undefined,
            duv: undefined,
            dvv: undefined,
        };
    }
    let r = area_element(form.efg);
    if !(e > 0.0 && r > 0.0) {
        // Parallel tangents span no plane. Where the form is not even semidefinite, it has no tangents.
        let is_semidefinite = e >= 0.0 && g >= 0.0 && r == 0.0;
        let along = |x: f64| [if is_semidefinite { x } else { 0.0 }, 0.0, 0.0];
        return Jet {
            position,
            du: along(e.sqrt()),
            dv: along(g.sqrt().copysign(f)),
            duu: undefined,
            duv: undefined,
            dvv: undefined,
        };
    }
    regular_jet(form, r, uv)
}

/// The same where it is a metric; `r` is √(EG − F²).
#[inline(always)]
fn regular_jet(form: &Form, r: f64, uv: [f64; 2]) -> Jet {
    let [e, f, g] = form.efg;
    let root = e.sqrt();
    // The frame's components of a vector with these inner products with σu and σv.
    // The quotient first: E √E may overflow.
    let share = root / r;
    let vector = |by_u: f64, by_v: f64| [by_u / root, (by_v - f / e * by_u) * share];
    let [eu, fu, gu] = form.by_u;
    let [ev, fv, gv] = form.by_v;
    let uu = vector(0.5 * eu, fu - 0.5 * ev);
    let mixed = vector(0.5 * ev, 0.5 * gu);
    let vv = vector(fv - 0.5 * gu, 0.5 * gv);
    // Gauss's equation: LN − M² = ⟨σuu,σvv⟩ − ⟨σuv,σuv⟩ less the tangential parts, and K = (LN − M²)/R².
    let plane = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
    let second = form.bent - plane(uu, vv) + plane(mixed, mixed);
    // As on a sphere: L : N = E : G, M = 0.
    let ratio = (g / e).sqrt();
    let least = f64::MIN_POSITIVE;
    let l = (second.abs() / if ratio > least { ratio } else { least }).sqrt();
    let l = l / ratio.sqrt();
    let n = second / l;
    let n = if l > 0.0 { n } else { 0.0 };
    Jet {
        position: [uv[0], uv[1], 0.0],
        du: [root, 0.0, 0.0],
        dv: [f / root, r / root, 0.0],
        duu: [uu[0], uu[1], l],
        duv: [mixed[0], mixed[1], 0.0],
        dvv: [vv[0], vv[1], n],
    }
}

/// The jets of several points, in loops that the compiler vectorises. Returns false, and meaningless jets, unless it is a
/// metric at all of the points.
struct RegularJets<'a> {
    /// E, F, G with their derivatives.
    forms: &'a JetBlock,
    at: &'a [Lanes; 2],
    out: &'a mut JetBlock,
}

impl Work for RegularJets<'_> {
    type Output = bool;

    #[allow(clippy::needless_range_loop)] // Several arrays are traversed together, lane by lane.
    #[inline(always)]
    fn run(self) -> bool {
        let [e, f, g] = &self.forms.position;
        let mut r = [0.0; LANES];
        let mut sheared = false;
        for lane in 0..LANES {
            r[lane] = e[lane].sqrt() * g[lane].sqrt();
            sheared |= f[lane] != 0.0;
        }
        if sheared {
            for lane in 0..LANES {
                r[lane] = area_element([e[lane], f[lane], g[lane]]);
            }
        }
        let mut regular = true;
        for lane in 0..LANES {
            let finite = e[lane].is_finite() & f[lane].is_finite() & g[lane].is_finite();
            regular &= finite & (e[lane] > 0.0) & (r[lane] > 0.0);
        }
        if !regular {
            return false;
        }
        for lane in 0..LANES {
            let form = Form::of_lane(self.forms, lane);
            let jet = regular_jet(&form, r[lane], [self.at[0][lane], self.at[1][lane]]);
            for k in 0..3 {
                self.out.position[k][lane] = jet.position[k];
                self.out.du[k][lane] = jet.du[k];
                self.out.dv[k][lane] = jet.dv[k];
                self.out.duu[k][lane] = jet.duu[k];
                self.out.duv[k][lane] = jet.duv[k];
                self.out.dvv[k][lane] = jet.dvv[k];
            }
        }
        true
    }
}

/// Returns typical lengths of a metric, along the coordinate lines.
fn measure(jet: &dyn Fn(Uv) -> Jet, domain: [[f64; 2]; 2]) -> Scale {
    const LINES: u32 = 5;
    const PIECES: u32 = 8;
    let mut scale = Scale {
        size: 1.0,
        stretch: [1.0; 2],
    };
    let median = |values: &mut Vec<f64>| {
        values.sort_unstable_by(f64::total_cmp);
        values.get(values.len() / 2).copied()
    };
    let mut size = 0.0_f64;
    for axis in 0..2 {
        let width = domain[axis][1] - domain[axis][0];
        let (mut lengths, mut stretches) = (Vec::new(), Vec::new());
        for line in 0..LINES {
            let mut length = 0.0;
            let across = (f64::from(line) + 0.61) / f64::from(LINES);
            for piece in 0..PIECES {
                let along = (f64::from(piece) + 0.43) / f64::from(PIECES);
                let share = if axis == 0 {
                    [along, across]
                } else {
                    [across, along]
                };
                let jet = jet(at(domain, share));
                let stretch = norm(if axis == 0 { jet.du } else { jet.dv });
                if stretch.is_finite() && stretch > 0.0 {
                    length += stretch * width / f64::from(PIECES);
                    stretches.push(stretch);
                }
            }
            if length > 0.0 && length.is_finite() {
                lengths.push(length);
            }
        }
        size = size.max(median(&mut lengths).unwrap_or(0.0));
        scale.stretch[axis] = median(&mut stretches).unwrap_or(1.0);
    }
    // The extent of a closed surface is about half the length of its coordinate lines.
    if size > 0.0 && size.is_finite() {
        scale.size = 0.5 * size;
    }
    scale
}

#[cfg(test)]
mod tests {
    use super::*;

    /// E, F, G and their derivatives without a pattern: a metric, sheared or not.
    fn forms(seed: u64, sheared: bool) -> JetBlock {
        let mut state = seed;
        let mut number = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut forms = JetBlock::default();
        for lane in 0..LANES {
            let [e, g] = [0.1 + number(), 0.1 + number()];
            let f = if sheared { 0.9 * (e * g).sqrt() } else { 0.0 };
            let mut slopes = || [0; 3].map(|_| 4.0 * number() - 2.0);
            forms.set(
                lane,
                &Jet {
                    position: [e, f, g],
                    du: slopes(),
                    dv: slopes(),
                    duu: slopes(),
                    duv: slopes(),
                    dvv: slopes(),
                },
            );
        }
        forms
    }

    fn at_once(processor: Processor, forms: &JetBlock) -> Option<JetBlock> {
        let mut out = JetBlock::default();
        let at = &[[0.25; LANES], [-3.0; LANES]];
        let work = RegularJets {
            forms,
            at,
            out: &mut out,
        };
        processor.run(work).then_some(out)
    }

    #[test]
    fn several_jets_at_once_are_to_the_last_bit_those_of_one() {
        for seed in 0..200 {
            let mut forms = forms(seed, seed % 2 == 0);
            let mut alone = JetBlock::default();
            for lane in 0..LANES {
                alone.set(lane, &jet_of(&Form::of_lane(&forms, lane), [0.25, -3.0]));
            }
            for processor in [Processor::here(), Processor::least()] {
                assert_eq!(at_once(processor, &forms).as_ref(), Some(&alone));
            }
            // One that is no metric makes all of them a case for the careful.
            for broken in [-1.0, 0.0, f64::NAN, f64::INFINITY] {
                forms.position[0][seed as usize % LANES] = broken;
                let found = at_once(Processor::here(), &forms);
                assert_eq!(found, None, "E is {broken}");
            }
        }
    }
}
