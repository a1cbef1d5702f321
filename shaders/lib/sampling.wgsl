// Equally spaced values and the flat numbering of samples.

// How the samples of one object are numbered: those of an instance stand together, a surface's row by row
// (the first parameter fastest).
struct Sampling {
    // First and last value of each parameter.
    minimum: vec2f,
    maximum: vec2f,
    // Samples along each parameter; 1 where there is no such parameter.
    count: vec2u,
    // Samples in all.
    total: u32,
    // Numbers per instance in the uniforms' buffer.
    slots: u32,
    // The place of the drawing units' origin.
    centre: vec3f,
    // Drawing units per unit of the scene.
    per_length: f32,
    // What lies further from the centre, in drawing units, is taken as undefined.
    horizon: f32,
    // How far inwards, as a share of the domain, a normal is looked for that does not exist in its place.
    nudge: f32,
    padding: vec2f,
}

// Both ends are hit exactly.
fn sample_value(minimum: f32, maximum: f32, index: u32, count: u32) -> f32 {
    if index + 1u == count {
        return maximum;
    }
    return minimum + (maximum - minimum) * (f32(index) / f32(max(count, 2u) - 1u));
}

// The number of an invocation in a two-dimensional dispatch of workgroups of 64.
fn flat_index(workgroup: vec3u, workgroups: vec3u, local: u32) -> u32 {
    return (workgroup.y * workgroups.x + workgroup.x) * 64u + local;
}

// A position in drawing units, and 1 in w where it is defined, else 0.
fn placed(position: vec3f, sampling: Sampling) -> vec4f {
    let at = (position - sampling.centre) * sampling.per_length;
    if is_finite3(at) && all(abs(at) <= vec3f(sampling.horizon)) {
        return vec4f(at, 1.0);
    }
    return vec4f(0.0);
}
