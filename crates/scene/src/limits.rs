//! Limits on the size of a scene. Each limit is there so that no text can take the machine down, and each ends in a
//! diagnostic that names it.

/// The largest number of values of one axis of a grid.
pub const MAX_AXIS: u32 = 1_000_000;

/// The largest number of instances of one object: the product of the grids it depends on. Also the most
/// instances that the evaluation of one expression gives.
pub const MAX_INSTANCES: u64 = 1_000_000;

/// The largest number of samples of all objects together: instances times samples.
pub const MAX_SAMPLES: u64 = 20_000_000;

/// The number of samples of a curve, and of a surface along each parameter, unless its interval states a count.
pub const DEFAULT_SAMPLES: u32 = 100;

/// The largest number of components of all params and grids together: what every GPU takes as uniforms (64 KiB of
/// f32).
pub const MAX_UNIFORMS: u32 = 16_384;

/// The largest number of leaves of all solids together, with all instances of each.
pub const MAX_LEAVES: u64 = 1_000_000;
