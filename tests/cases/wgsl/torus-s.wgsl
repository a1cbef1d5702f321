fn surface_jet(u: f32, v: f32, instance: u32) -> Jet {
    let t0 = uniform_value(instance, 0u);
    let t1 = cos(u);
    let t2 = t0 * cos(v);
    let t3 = 1.0 + t2;
    let t4 = t1 * t3;
    let t5 = sin(u);
    let t6 = t0 * sin(v);
    let t7 = -(t3 * t5);
    let t8 = -(t1 * t6);
    let t9 = t5 * t6;
    return Jet(
        vec3f(t7, t4, 0.0),
        vec3f(t8, -t9, t2),
        vec3f(-t4, t7, 0.0),
        vec3f(t9, t8, 0.0),
        vec3f(-(t1 * t2), -(t2 * t5), -t6),
    );
}
