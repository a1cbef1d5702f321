fn surface_tangents(u: f32, v: f32, instance: u32) -> Tangents {
    let t0 = 3.0 * u;
    let t1 = v * v;
    return Tangents(
        vec3f(u, v, u * (u * u) - t0 * t1),
        vec3f(1.0, 0.0, 3.0 * (u * u) - 3.0 * t1),
        vec3f(0.0, 1.0, -(t0 * (2.0 * v))),
    );
}
