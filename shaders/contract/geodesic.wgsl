// Generated: a surface's first and second partial derivatives at (u, v).
fn surface_jet(u: f32, v: f32, instance: u32) -> Jet {
    return Jet(vec3f(), vec3f(), vec3f(), vec3f(), vec3f());
}
