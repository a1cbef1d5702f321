// Generated: returns a vector's direction in the given instance; its length is the arrow's.
fn vector_direction(instance: u32) -> vec3f {
    return vec3f();
}

// Generated: returns the start of the arrow.
fn vector_origin(instance: u32) -> vec3f {
    return vec3f();
}
