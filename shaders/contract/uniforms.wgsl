// Called by generated functions, written in each pass that joins one: the number that slot `slot` (numbered from 0
// over the uniforms in use, in the order of their numbers in the scene) has in the given instance.
fn uniform_value(instance: u32, slot: u32) -> f32 {
    return 0.0;
}
