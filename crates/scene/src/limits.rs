//! Limits on the size of a scene, so that no text can exhaust the machine. Exceeding a limit is a diagnostic that names
//! it.

/// The maximum number of values of one axis of a grid.
pub const MAX_AXIS: u32 = 1_000_000;

/// The maximum number of instances of one object: the product of the grids it depends on. Also the maximum number of
/// instances in the evaluation of an expression.
pub const MAX_INSTANCES: u64 = 1_000_000;

/// The maximum number of samples of all objects together: instances times samples.
pub const MAX_SAMPLES: u64 = 20_000_000;

/// The number of samples of a curve, and of a surface along each parameter, unless its interval states a count.
pub(crate) const DEFAULT_SAMPLES: u32 = 100;

/// The maximum number of components of all params and grids together: every GPU supports this many uniforms (64 KiB of
/// f32).
pub const MAX_UNIFORMS: u32 = 16_384;

/// The maximum number of leaves of all solids together, including all instances of each.
pub const MAX_LEAVES: u64 = 1_000_000;
