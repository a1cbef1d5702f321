// Partial derivatives of a surface.

// First order, with the position.
struct Tangents {
    position: vec3f,
    du: vec3f,
    dv: vec3f,
}
