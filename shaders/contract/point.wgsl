// Generated: returns a point's position in the given instance.
fn point_position(instance: u32) -> vec3f {
    return vec3f();
}
