// Called by pass/trace_scene.wgsl, written in pass/trace_fields.wgsl where a scene has pieces that fields bound.
fn read_field(piece: u32, line: FrameLine, ray: Ray, part: vec2f, behind_t: f32) -> bool {
    return false;
}
fn field_gradient(piece: u32, at: vec3f) -> vec3f {
    return vec3f(0.0);
}
