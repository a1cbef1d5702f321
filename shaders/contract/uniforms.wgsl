// Called by generated functions, defined in each pass that joins one: returns the number of slot `slot` (numbered from 0
// over the uniforms in use, in the order of their numbers in the scene) in the given instance.
fn uniform_value(instance: u32, slot: u32) -> f32 {
    return 0.0;
}
