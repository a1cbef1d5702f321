// Equally spaced values and the flat numbering of samples.

// The numbering of the samples of one object: those of an instance are contiguous, a surface's row by row (the first
// parameter fastest).
struct Sampling {
    // The first and the last value of each parameter.
    minimum: vec2f,
    maximum: vec2f,
    // Samples along each parameter; 1 for a missing parameter.
    count: vec2u,
    // Samples in all.
    total: u32,
    // Numbers per instance in the uniforms' buffer.
    slots: u32,
    // The origin of the drawing units.
    centre: vec3f,
    // Drawing units per unit of the scene.
    per_length: f32,
    // Points farther from the centre than this, in drawing units, count as undefined.
    horizon: f32,
    // The distance inwards, as a fraction of the domain, at which a normal is evaluated if it does not exist at its point.
    nudge: f32,
    padding: vec2f,
}

// Both ends are exact.
fn sample_value(minimum: f32, maximum: f32, index: u32, count: u32) -> f32 {
    if index + 1u == count {
        return maximum;
    }
    return minimum + (maximum - minimum) * (f32(index) / f32(max(count, 2u) - 1u));
}

// Returns the number of an invocation in a two-dimensional dispatch of workgroups of 64.
fn flat_index(workgroup: vec3u, workgroups: vec3u, local: u32) -> u32 {
    return (workgroup.y * workgroups.x + workgroup.x) * 64u + local;
}

// Returns a position in drawing units, with w = 1 if it is defined, otherwise 0.
fn placed(position: vec3f, sampling: Sampling) -> vec4f {
    let at = (position - sampling.centre) * sampling.per_length;
    if is_finite3(at) && all(abs(at) <= vec3f(sampling.horizon)) {
        return vec4f(at, 1.0);
    }
    return vec4f(0.0);
}
