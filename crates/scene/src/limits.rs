//! How large a scene may be. Each limit is there so that no text can take the machine down, and each ends in
//! a diagnostic that names it.

/// The most values that one axis of a grid may have.
pub const MAX_AXIS: u32 = 1_000_000;

/// The most instances that one object may have: the product of the grids it depends on. Also the most
/// instances that the evaluation of one expression gives.
pub const MAX_INSTANCES: u64 = 1_000_000;

/// The most samples of all objects together: instances times samples.
pub const MAX_SAMPLES: u64 = 20_000_000;

/// How many samples a curve has, and a surface along each parameter, unless its interval says otherwise.
pub const DEFAULT_SAMPLES: u32 = 100;

/// The most components that all params and grids have together: what every GPU takes as uniforms (64 KiB of
/// f32).
pub const MAX_UNIFORMS: u32 = 16_384;
