// Generated: returns a curve's position at parameter u.
fn curve_position(u: f32, instance: u32) -> vec3f {
    return vec3f();
}
