// Partial derivatives of a surface.

// The first derivatives, with the position.
struct Tangents {
    position: vec3f,
    du: vec3f,
    dv: vec3f,
}
