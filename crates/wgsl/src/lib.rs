//! Expressions to WGSL functions, joined with the hand-written passes of `/shaders` and validated.
