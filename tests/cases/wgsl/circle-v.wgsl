fn vector_direction(instance: u32) -> vec3f {
    let t0 = uniform_value(instance, 0u);
    let t1 = uniform_value(instance, 1u) + uniform_value(instance, 2u);
    return vec3f(t0 * cos(t1), t0 * sin(t1), 0.0);
}

fn vector_origin(instance: u32) -> vec3f {
    let t0 = uniform_value(instance, 0u);
    let t1 = uniform_value(instance, 1u) + uniform_value(instance, 2u);
    return vec3f(-(t0 * sin(t1)), t0 * cos(t1), 0.0);
}
