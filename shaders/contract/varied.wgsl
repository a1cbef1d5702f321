// Called by pass/trace_scene.wgsl, defined in pass/trace_varied.wgsl if attributes of the scene are expressions: returns the
// look of a face at a point that is known to within `slack`.
fn varied_look(material: Material, position: vec3f, slack: f32, weight: f32) -> VariedLook {
    return VariedLook(material, vec3f(0.0), 0.0);
}
