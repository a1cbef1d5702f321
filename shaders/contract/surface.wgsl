// Generated: returns a surface's position and first partial derivatives at (u, v).
fn surface_tangents(u: f32, v: f32, instance: u32) -> Tangents {
    return Tangents(vec3f(), vec3f(), vec3f());
}
