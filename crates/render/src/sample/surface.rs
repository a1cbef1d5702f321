//! Samples of surfaces: positions with their normals.
//!
//! In: a surface and the param values. Out: samples, in the order that [`super`] defines. Positions and σu, σv come from
//! jets of first order, a block of points at a time, each block within one instance, whose uniforms are fixed. With many
//! small instances, blocks would be partly empty: then symbolic derivatives are evaluated, each lane with its own uniforms.

use std::cell::RefCell;

use expr::jets::{Fixed, JetRegisters, JetTape, Order};
use expr::tape::{Block, LANES, Registers, Tape};
use expr::{Input, NodeId};
use glam::Vec3;
use rayon::prelude::*;
use scene::ParamValues;
use scene::{Object, Sampling, Scene};

use super::sampler::CHUNK;
use super::{
    DEGENERATE, NORMAL_NUDGE, PositionSample, Resolution, Sampler, Samples, SurfaceSample, placed,
    surface_roots,
};
use crate::placement::Placement;

/// The number of samples from which on an instance has blocks of its own.
const WORTHWHILE: usize = 4 * LANES;

thread_local! {
    /// One set for each thread, so that small instances need not allocate their own.
    static REGISTERS: RefCell<JetRegisters> = RefCell::default();
}

/// Evaluates all samples of a surface.
pub(super) fn surface(
    scene: &Scene,
    params: &ParamValues,
    object: &Object,
    placement: &Placement,
    position: &[NodeId; 3],
    domain: &[Sampling; 2],
) -> Samples {
    let count = [domain[0].count, domain[1].count];
    let per_instance = count[0] as usize * count[1] as usize;
    let samples = if per_instance >= WORTHWHILE {
        by_jets(scene, params, object, placement, position, domain)
    } else {
        symbolically(scene, params, object, placement, position, domain)
    };
    // Without derivatives there are no normals; the shape is still visible, lit only from the eye.
    let samples = samples.unwrap_or_else(|| {
        let sampler = Sampler::full(scene, params, object, position);
        sampler.map(|_, out: &[f64; 3]| {
            let PositionSample { position, defined } = placed(placement, out);
            SurfaceSample {
                position,
                defined,
                ..SurfaceSample::default()
            }
        })
    });
    Samples::Surfaces { count, samples }
}

/// Replaces undefined samples of an instance by their limits, with normals between those of their neighbours.
pub(super) fn fill_gaps(
    samples: &mut [SurfaceSample],
    count: [u32; 2],
    placement: &Placement,
    limits: &[(usize, [f64; 3])],
) {
    let [columns, rows] = count.map(|n| n as usize);
    for (index, limit) in limits {
        let PositionSample { position, defined } = placed(placement, limit);
        samples[*index] = SurfaceSample {
            position,
            defined,
            ..SurfaceSample::default()
        };
    }
    for (index, _) in limits {
        let [i, j] = [index % columns, index / columns];
        let around = [(-1, 0), (1, 0), (0, -1), (0, 1)].map(|(di, dj)| {
            let i = i.checked_add_signed(di).filter(|i| *i < columns)?;
            let j = j.checked_add_signed(dj).filter(|j| *j < rows)?;
            Some(Vec3::from(samples[j * columns + i].normal))
        });
        let sum: Vec3 = around.into_iter().flatten().sum();
        samples[*index].normal = sum.normalize_or_zero().to_array();
    }
}

/// Samples with jets; returns `None` if the derivatives are too large.
fn by_jets(
    scene: &Scene,
    params: &ParamValues,
    object: &Object,
    placement: &Placement,
    position: &[NodeId; 3],
    domain: &[Sampling; 2],
) -> Option<Vec<SurfaceSample>> {
    let variables = [Input::Variable(0), Input::Variable(1)];
    let tape = JetTape::new(&scene.graph, position, variables, Order::First).ok()?;
    let mut instances = Vec::new();
    params.for_each_instance(scene, object, |values| {
        let uniforms: Vec<f64> = tape
            .uniforms()
            .iter()
            .map(|input| input.value(&[], values))
            .collect();
        instances.push(tape.fix(&uniforms));
    });
    let axes = [0, 1].map(|k| {
        (0..domain[k].count)
            .map(|i| domain[k].value(i))
            .collect::<Vec<f64>>()
    });
    let jets = Jets {
        tape: &tape,
        axes: &axes,
        domain: NormalDomain::of(domain),
        placement,
    };
    let per_instance = axes[0].len() * axes[1].len();
    let mut samples = vec![SurfaceSample::default(); instances.len() * per_instance];
    samples
        .par_chunks_mut(per_instance)
        .zip(&instances)
        .for_each(|(samples, fixed)| {
            let chunks = samples.par_chunks_mut(CHUNK).enumerate();
            chunks.for_each(|(chunk, samples)| {
                REGISTERS.with_borrow_mut(|registers| {
                    jets.fill(registers, fixed, chunk * CHUNK, samples);
                });
            });
        });
    Some(samples)
}

/// The samples of a surface's instances, from jets.
struct Jets<'a> {
    tape: &'a JetTape,
    axes: &'a [Vec<f64>; 2],
    domain: NormalDomain,
    placement: &'a Placement,
}

impl Jets<'_> {
    /// Fills the samples of an instance, starting at `first`.
    fn fill(
        &self,
        registers: &mut JetRegisters,
        fixed: &Fixed,
        first: usize,
        samples: &mut [SurfaceSample],
    ) {
        let [us, vs] = self.axes;
        let mut out = [[[0.0; LANES]; 3]; 3];
        let (mut i, mut j) = (first % us.len(), first / us.len());
        for samples in samples.chunks_mut(LANES) {
            // A partial last block repeats its last point.
            let mut at: [Block; 2] = [[us[i]; LANES], [vs[j]; LANES]];
            let [at_u, at_v] = &mut at;
            for (u, v) in at_u.iter_mut().zip(at_v).take(samples.len()) {
                (*u, *v) = (us[i], vs[j]);
                i += 1;
                if i == us.len() {
                    // Past the last point, the first one fills the lane; its result is not used.
                    (i, j) = (0, (j + 1) % vs.len());
                }
            }
            self.tape
                .eval(registers, fixed, &at, out.as_flattened_mut());
            let [position, du, dv] = &out;
            for (lane, sample) in samples.iter_mut().enumerate() {
                let of = |vectors: &[Block; 3]| [0, 1, 2].map(|k| vectors[k][lane]);
                let PositionSample {
                    position: place,
                    defined,
                } = placed(self.placement, &of(position));
                *sample = SurfaceSample {
                    position: place,
                    defined,
                    normal: self.domain.normal(of(du), of(dv)).unwrap_or_default(),
                    padding: 0.0,
                };
            }
            for (lane, sample) in samples.iter_mut().enumerate() {
                if sample.defined != 0.0 && sample.normal == [0.0; 3] {
                    sample.normal = self.beside(fixed, [at[0][lane], at[1][lane]]);
                }
            }
        }
    }

    /// Returns the normal slightly further inside, or zero if it is undefined there too.
    fn beside(&self, fixed: &Fixed, at: [f64; 2]) -> [f32; 3] {
        let at = self.domain.nudged(at).map(|x| [x]);
        let mut out = [[[0.0]; 3]; 3];
        // Separate registers: those of the blocks keep their constants.
        let mut registers = JetRegisters::default();
        self.tape
            .eval(&mut registers, fixed, &at, out.as_flattened_mut());
        let [_, du, dv] = out.map(|vector| vector.map(|[x]| x));
        self.domain.normal(du, dv).unwrap_or_default()
    }
}

/// Samples as [`by_jets`] does, with symbolic derivatives.
fn symbolically(
    scene: &Scene,
    params: &ParamValues,
    object: &Object,
    placement: &Placement,
    position: &[NodeId; 3],
    domain: &[Sampling; 2],
) -> Option<Vec<SurfaceSample>> {
    let (graph, roots) = surface_roots(scene, position)?;
    let tape = Tape::new(&graph, &roots);
    let sampler = Sampler::new(scene, params, object, tape, Resolution::Full);
    let domain = NormalDomain::of(domain);
    let normal = |out: &[f64; 9]| {
        let [_, _, _, ux, uy, uz, vx, vy, vz] = *out;
        domain
            .normal([ux, uy, uz], [vx, vy, vz])
            .unwrap_or_default()
    };
    let mut samples = sampler.map(|_, out: &[f64; 9]| {
        let PositionSample { position, defined } = placed(placement, &[out[0], out[1], out[2]]);
        SurfaceSample {
            position,
            defined,
            normal: normal(out),
            padding: 0.0,
        }
    });
    samples.par_iter_mut().enumerate().for_each_init(
        Registers::default,
        |registers, (index, sample)| {
            if sample.defined == 0.0 || sample.normal != [0.0; 3] {
                return;
            }
            let (_, at) = sampler.locate(index);
            let mut out = [0.0; 9];
            sampler.eval(registers, index, domain.nudged(at), &mut out);
            sample.normal = normal(&out);
        },
    );
    Some(samples)
}

/// The data of the domain that normals need.
struct NormalDomain {
    middles: [f64; 2],
    widths: [f64; 2],
}

impl NormalDomain {
    fn of(domain: &[Sampling; 2]) -> Self {
        let ranges = domain.each_ref().map(|axis| axis.range);
        Self {
            middles: ranges.map(|range| 0.5 * (range.min + range.max)),
            widths: ranges.map(|range| range.max - range.min),
        }
    }

    /// Returns a point slightly further inside.
    fn nudged(&self, at: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| {
            let step = NORMAL_NUDGE * self.widths[k];
            if at[k] > self.middles[k] {
                at[k] - step
            } else {
                at[k] + step
            }
        })
    }

    /// Returns the unit normal, if σu and σv are defined and not parallel.
    fn normal(&self, du: [f64; 3], dv: [f64; 3]) -> Option<[f32; 3]> {
        let du = glam::DVec3::from(du) * self.widths[0];
        let dv = glam::DVec3::from(dv) * self.widths[1];
        let longest = du.abs().max_element().max(dv.abs().max_element());
        if !(longest > 0.0 && longest.is_finite()) {
            return None;
        }
        // Divide first, so that no square overflows or underflows.
        let cross = (du / longest).cross(dv / longest);
        let length = cross.length();
        (length > DEGENERATE).then(|| (cross / length).as_vec3().to_array())
    }
}
