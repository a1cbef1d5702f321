// Called by pass/trace_scene.wgsl, defined in pass/trace_fields.wgsl if fields bound pieces of the scene.
fn read_field(piece: u32, line: FrameLine, ray: Ray, part: vec2f, behind_t: f32) -> bool {
    return false;
}
fn field_gradient(piece: u32, at: vec3f) -> vec3f {
    return vec3f(0.0);
}
