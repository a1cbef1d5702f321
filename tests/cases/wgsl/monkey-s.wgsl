fn surface_jet(u: f32, v: f32, instance: u32) -> Jet {
    let t0 = 3.0 * u;
    let t1 = 2.0 * v;
    return Jet(
        vec3f(1.0, 0.0, 3.0 * (u * u) - 3.0 * (v * v)),
        vec3f(0.0, 1.0, -(t0 * t1)),
        vec3f(0.0, 0.0, 3.0 * (2.0 * u)),
        vec3f(0.0, 0.0, -3.0 * t1),
        vec3f(0.0, 0.0, -2.0 * t0),
    );
}
