// Positions of a point's instances: uniforms → samples.

@group(0) @binding(0) var<uniform> sampling: Sampling;
@group(0) @binding(1) var<storage, read> uniforms: array<f32>;
@group(0) @binding(2) var<storage, read_write> samples: array<vec4f>;

fn uniform_value(instance: u32, slot: u32) -> f32 {
    return uniforms[instance * sampling.slots + slot];
}

@compute @workgroup_size(64)
fn sample_point(
    @builtin(workgroup_id) workgroup: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = flat_index(workgroup, workgroups, local);
    if index >= sampling.total {
        return;
    }
    samples[index] = placed(point_position(index), sampling);
}
