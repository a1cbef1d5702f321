// A vector's instances: uniforms → samples, two vectors for each instance: origin (w: 1 if defined), direction.

@group(0) @binding(0) var<uniform> sampling: Sampling;
@group(0) @binding(1) var<storage, read> uniforms: array<f32>;
@group(0) @binding(2) var<storage, read_write> samples: array<vec4f>;

fn uniform_value(instance: u32, slot: u32) -> f32 {
    return uniforms[instance * sampling.slots + slot];
}

@compute @workgroup_size(64)
fn sample_vector(
    @builtin(workgroup_id) workgroup: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = flat_index(workgroup, workgroups, local);
    if index >= sampling.total {
        return;
    }
    let origin = placed(vector_origin(index), sampling);
    let direction = vector_direction(index) * sampling.per_length;
    if origin.w == 0.0 || !is_finite3(direction) || any(abs(direction) > vec3f(sampling.horizon)) {
        samples[2u * index] = vec4f(0.0);
        samples[2u * index + 1u] = vec4f(0.0);
        return;
    }
    samples[2u * index] = origin;
    samples[2u * index + 1u] = vec4f(direction, 0.0);
}
