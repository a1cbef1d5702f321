//! Evaluation of expressions on the GPU, for comparison with f64.

use std::fmt;

use expr::{Graph, Input, NodeId};
use wgsl::GenerateError;

use crate::error::RenderError;
use crate::gpu::device;
use crate::gpu::layout::Table;
use crate::gpu::pipelines::{PipelineFactory, dispatch_flat};

/// The reason why expressions could not be evaluated.
#[derive(Clone, Debug, PartialEq)]
pub enum EvaluateError {
    /// There is no GPU, or it failed.
    Render(RenderError),
    /// No shader could be generated.
    Generate(GenerateError),
    /// A row does not have one number for each input.
    Row {
        /// The row.
        row: usize,
        /// The expected number of values.
        expected: usize,
        /// The given number of values.
        given: usize,
    },
}

impl fmt::Display for EvaluateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Render(error) => error.fmt(f),
            Self::Generate(error) => error.fmt(f),
            Self::Row {
                row,
                expected,
                given,
            } => {
                write!(
                    f,
                    "row {row} has {given} numbers where the expressions take {expected}"
                )
            }
        }
    }
}

impl std::error::Error for EvaluateError {}

/// Evaluates the roots for each row of inputs on the GPU, by the generated code that pictures use. A row follows
/// [`Graph::inputs`] of the roots (sorted, as [`expr::tape::Tape::inputs`]); a row of the result has one number per root.
/// Undefined values are NaN if the driver preserves NaN.
///
/// # Errors
/// See [`EvaluateError`].
pub fn evaluate(
    graph: &Graph,
    roots: &[NodeId],
    rows: &[Vec<f32>],
) -> Result<Vec<Vec<f32>>, EvaluateError> {
    let inputs = graph.inputs(roots);
    for (row, numbers) in rows.iter().enumerate() {
        if numbers.len() != inputs.len() {
            return Err(EvaluateError::Row {
                row,
                expected: inputs.len(),
                given: numbers.len(),
            });
        }
    }
    if rows.is_empty() || roots.is_empty() {
        return Ok(vec![Vec::new(); rows.len()]);
    }
    let kernel = wgsl::kernel::evaluate(graph, roots).map_err(EvaluateError::Generate)?;
    let gpu = device::open().map_err(EvaluateError::Render)?;
    let variables = inputs
        .iter()
        .filter_map(|input| match input {
            Input::Variable(k) => Some(k + 1),
            Input::Uniform(_) => None,
        })
        .max()
        .unwrap_or(0);
    let width = variables as usize + kernel.uniforms().len();
    let mut table = vec![0.0f32; rows.len() * width];
    for (to, row) in table.chunks_mut(width.max(1)).zip(rows) {
        for (input, &number) in inputs.iter().zip(row) {
            match input {
                Input::Variable(k) => to[*k as usize] = number,
                Input::Uniform(k) => {
                    to[variables as usize
                        + kernel.uniforms().partition_point(|uniform| uniform < k)] = number;
                }
            }
        }
    }
    let size = 4 * rows.len() as u64 * roots.len() as u64;
    let numbers: Result<Vec<f32>, RenderError> = gpu.guarded(|| {
        let factory = PipelineFactory::new(gpu);
        let pipeline = factory.compute("evaluate", kernel.joined());
        let description = gpu.uniform(
            "table",
            &Table {
                rows: rows.len() as u32,
                variables,
                uniforms: kernel.uniforms().len() as u32,
                roots: roots.len() as u32,
            },
        );
        let inputs = gpu.storage("inputs", bytemuck::cast_slice(&table));
        let outputs = gpu.output("outputs", size)?;
        let mut bindings = vec![
            (0, description.as_entire_binding()),
            (2, outputs.as_entire_binding()),
        ];
        // Constants read no inputs: the pipeline then has no such binding.
        if width > 0 {
            bindings.push((1, inputs.as_entire_binding()));
        }
        let group = factory.bind_numbered(&pipeline.get_bind_group_layout(0), &bindings);
        gpu.submit(|encoder| dispatch_flat(encoder, &pipeline, &group, rows.len() as u64));
        gpu.read(&outputs, size, bytemuck::pod_collect_to_vec)
    });
    let numbers = numbers.map_err(EvaluateError::Render)?;
    Ok(numbers.chunks(roots.len()).map(<[f32]>::to_vec).collect())
}
