// Positions and normals over a surface's instances: uniforms and parameters → samples, two vectors for each: position (w: 1
// if defined), normal (unit length, or zero if there is none).

@group(0) @binding(0) var<uniform> sampling: Sampling;
@group(0) @binding(1) var<storage, read> uniforms: array<f32>;
@group(0) @binding(2) var<storage, read_write> samples: array<vec4f>;

fn uniform_value(instance: u32, slot: u32) -> f32 {
    return uniforms[instance * sampling.slots + slot];
}

// Returns the unit normal, or zero if the tangents are parallel or undefined. Each tangent is scaled to the whole width of
// the domain, and divided by the length of the longer one, so that no chart and no size of a surface leaves the range of
// f32.
fn normal_of(tangents: Tangents) -> vec3f {
    let du = tangents.du * (sampling.maximum.x - sampling.minimum.x);
    let dv = tangents.dv * (sampling.maximum.y - sampling.minimum.y);
    let longest = max(max(abs(du.x), max(abs(du.y), abs(du.z))), max(abs(dv.x), max(abs(dv.y), abs(dv.z))));
    if !is_finite3(du) || !is_finite3(dv) || longest == 0.0 {
        return vec3f();
    }
    let normal = cross(du / longest, dv / longest);
    let size = length(normal);
    if size <= 1e-5 {
        return vec3f();
    }
    return normal / size;
}

@compute @workgroup_size(64)
fn sample_surface(
    @builtin(workgroup_id) workgroup: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = flat_index(workgroup, workgroups, local);
    if index >= sampling.total {
        return;
    }
    let per_instance = sampling.count.x * sampling.count.y;
    let instance = index / per_instance;
    let cell = index % per_instance;
    let along = vec2u(cell % sampling.count.x, cell / sampling.count.x);
    let u = sample_value(sampling.minimum.x, sampling.maximum.x, along.x, sampling.count.x);
    let v = sample_value(sampling.minimum.y, sampling.maximum.y, along.y, sampling.count.y);
    let tangents = surface_tangents(u, v, instance);
    var normal = normal_of(tangents);
    if dot(normal, normal) == 0.0 {
        // At a pole the tangents are parallel: slightly further in they are not.
        let middle = 0.5 * (sampling.minimum + sampling.maximum);
        let step = sampling.nudge * (sampling.maximum - sampling.minimum);
        let inward = vec2f(u, v) + select(step, -step, vec2f(u, v) > middle);
        normal = normal_of(surface_tangents(inward.x, inward.y, instance));
    }
    samples[2u * index] = placed(tangents.position, sampling);
    samples[2u * index + 1u] = vec4f(normal, 0.0);
}
