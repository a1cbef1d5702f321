// Called by pass/trace_scene.wgsl, written in pass/trace_varied.wgsl where a scene has attributes that are expressions: the look
// of a face at a place that is known to within `slack`.
fn varied_look(material: Material, position: vec3f, slack: f32) -> VariedLook {
    return VariedLook(material, vec3f(0.0));
}
