//! The parameters of an object's samples, and a tape that is evaluated at all of them, on all cores.

use expr::Input;
use expr::NodeId;
use expr::tape::{Block, LANES, Registers, Tape};
use rayon::prelude::*;
use scene::{Object, ParamValues, Sampling, Scene, Shape};

/// The number of samples of an object that are evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Resolution {
    /// All.
    Full,
    /// At most about this number of samples, evenly distributed, including the ends of the domains.
    Coarse(usize),
}

/// An object's tape with all points at which it is evaluated.
pub(crate) struct Sampler {
    tape: Tape,
    columns: Vec<Column>,
    /// The uniforms that the tape reads, for each instance.
    uniforms: Vec<f64>,
    uniforms_per_instance: usize,
    instances: usize,
    /// The values of the variables; a single unused value for a missing variable.
    axes: [Vec<f64>; 2],
    /// For each point of a curve along geodesics, the variables beyond its parameter.
    followed: Vec<f64>,
    /// The number of those variables for each point.
    followed_per_place: usize,
}

/// The source of an input of the tape.
#[derive(Clone, Copy)]
enum Column {
    Variable(usize),
    /// A position among a point's variables beyond the parameter of a curve.
    Followed(usize),
    /// A position among an instance's uniforms.
    Uniform(usize),
}

/// The number of lanes that one task of the thread pool evaluates.
pub(super) const CHUNK: usize = 16 * LANES;

impl Sampler {
    pub(super) fn full(
        scene: &Scene,
        params: &ParamValues,
        object: &Object,
        roots: &[NodeId],
    ) -> Self {
        Self::new(
            scene,
            params,
            object,
            Tape::new(&scene.graph, roots),
            Resolution::Full,
        )
    }

    pub(crate) fn new(
        scene: &Scene,
        params: &ParamValues,
        object: &Object,
        tape: Tape,
        resolution: Resolution,
    ) -> Self {
        let mut used = Vec::new();
        let values = object.shape.followed().iter();
        let followed_per_place: usize = values.map(|value| value.width() as usize).sum();
        let columns = tape.inputs().iter().map(|input| match *input {
            Input::Variable(k) if followed_per_place > 0 && k > 0 => {
                Column::Followed(k as usize - 1)
            }
            Input::Variable(k) => Column::Variable(k as usize),
            Input::Uniform(k) => {
                used.push(k as usize);
                Column::Uniform(used.len() - 1)
            }
        });
        let columns = columns.collect();
        let (budget, cap) = match resolution {
            Resolution::Full => (usize::MAX, usize::MAX),
            Resolution::Coarse(samples) => (samples, if is_surface(object) { 49 } else { 193 }),
        };
        let axis = |sampling: &Sampling| {
            let picked = pick(sampling.count as usize, cap);
            picked
                .into_iter()
                .map(|i| sampling.value(i as u32))
                .collect::<Vec<f64>>()
        };
        let axes = match &object.shape {
            Shape::Point { .. }
            | Shape::Vector { .. }
            | Shape::Solid(_)
            | Shape::Light(_)
            | Shape::Camera(_)
            | Shape::Background(_) => [vec![0.0], vec![0.0]],
            Shape::Curve { domain, .. } => [axis(domain), vec![0.0]],
            Shape::Surface { domain, .. } | Shape::Metric { domain, .. } => {
                [axis(&domain[0]), axis(&domain[1])]
            }
            Shape::Geodesic { domain, .. } => [axis(domain), vec![0.0]],
        };
        let per_instance = axes[0].len() * axes[1].len();
        let all = params.instance_count(scene, object) as usize;
        let picked = pick(all, (budget / per_instance).max(64));
        let mut uniforms = Vec::with_capacity(picked.len().saturating_mul(used.len()));
        let mut followed = Vec::new();
        let (mut index, mut next) = (0, 0);
        params.for_each_instance(scene, object, |values| {
            if picked.get(next) == Some(&index) {
                uniforms.extend(used.iter().map(|&k| values[k]));
                if followed_per_place > 0 {
                    let places: Vec<Vec<f64>> = axes[0]
                        .par_iter()
                        .map(|&t| scene.curve_variables(&object.shape, values, t))
                        .collect();
                    followed.extend(places.iter().flat_map(|variables| &variables[1..]));
                }
                next += 1;
            }
            index += 1;
        });
        Self {
            tape,
            columns,
            uniforms,
            uniforms_per_instance: used.len(),
            instances: next,
            axes,
            followed,
            followed_per_place,
        }
    }

    /// Returns the values of the variables; a single unused value for a missing variable.
    pub(crate) fn axes(&self) -> &[Vec<f64>; 2] {
        &self.axes
    }

    /// Returns the numbers of values that the variables have.
    pub(crate) fn counts(&self) -> [usize; 2] {
        [self.axes[0].len(), self.axes[1].len()]
    }

    /// Returns the number of points.
    pub(crate) fn len(&self) -> usize {
        self.instances * self.axes[0].len() * self.axes[1].len()
    }

    /// Returns the instance and the variables of a point.
    pub(super) fn locate(&self, index: usize) -> (usize, [f64; 2]) {
        let (u, v) = (self.axes[0].len(), self.axes[1].len());
        (
            index / (u * v),
            [self.axes[0][index % u], self.axes[1][index / u % v]],
        )
    }

    fn column(&self, column: Column, index: usize, instance: usize, at: [f64; 2]) -> f64 {
        match column {
            Column::Variable(k) => at[k],
            Column::Followed(k) => self.followed[index * self.followed_per_place + k],
            Column::Uniform(k) => self.uniforms[instance * self.uniforms_per_instance + k],
        }
    }

    /// Evaluates at variables that the caller chooses, with the uniforms of a point.
    pub(super) fn eval(
        &self,
        registers: &mut Registers,
        index: usize,
        at: [f64; 2],
        out: &mut [f64],
    ) {
        let (instance, _) = self.locate(index);
        let inputs: Vec<f64> = self
            .columns
            .iter()
            .map(|&column| self.column(column, index, instance, at))
            .collect();
        self.tape.eval(registers, &inputs, out);
    }

    /// Evaluates everywhere and converts each point's N results to a sample, in order, on all cores.
    pub(crate) fn map<T, const N: usize>(
        &self,
        make: impl Fn(usize, &[f64; N]) -> T + Sync,
    ) -> Vec<T>
    where
        T: Clone + Default + Send,
    {
        let mut all = vec![T::default(); self.len()];
        let zero: Block = [0.0; LANES];
        all.par_chunks_mut(CHUNK).enumerate().for_each_init(
            || {
                (
                    Registers::default(),
                    vec![zero; self.columns.len()],
                    [zero; N],
                )
            },
            |(registers, inputs, out), (chunk, samples)| {
                for (block, samples) in samples.chunks_mut(LANES).enumerate() {
                    let first = chunk * CHUNK + block * LANES;
                    // A partial last block repeats its last point.
                    for lane in 0..LANES {
                        let index = first + lane.min(samples.len() - 1);
                        let (instance, at) = self.locate(index);
                        for (input, &column) in inputs.iter_mut().zip(&self.columns) {
                            input[lane] = self.column(column, index, instance, at);
                        }
                    }
                    self.tape.eval_block(registers, inputs, out);
                    for (lane, sample) in samples.iter_mut().enumerate() {
                        *sample = make(first + lane, &std::array::from_fn(|k| out[k][lane]));
                    }
                }
            },
        );
        all
    }
}

fn is_surface(object: &Object) -> bool {
    matches!(object.shape, Shape::Surface { .. })
}

/// Returns at most `cap` indices from 0 to `count` − 1, evenly distributed, including both ends.
fn pick(count: usize, cap: usize) -> Vec<usize> {
    if count <= cap {
        return (0..count).collect();
    }
    let last = (count - 1) as f64;
    (0..cap)
        .map(|k| (last * (k as f64 / (cap - 1) as f64)).round() as usize)
        .collect()
}
