fn surface_tangents(u: f32, v: f32, instance: u32) -> Tangents {
    let t0 = uniform_value(instance, 0u);
    let t1 = cos(u);
    let t2 = t0 * cos(v);
    let t3 = 1.0 + t2;
    let t4 = t1 * t3;
    let t5 = sin(u);
    let t6 = t3 * t5;
    let t7 = t0 * sin(v);
    return Tangents(
        vec3f(t4, t6, t7),
        vec3f(-t6, t4, 0.0),
        vec3f(-(t1 * t7), -(t5 * t7), t2),
    );
}
