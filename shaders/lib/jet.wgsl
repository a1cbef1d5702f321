// Partial derivatives of a surface.

// First order, with the position.
struct Tangents {
    position: vec3f,
    du: vec3f,
    dv: vec3f,
}

// First and second order: what the geodesic equation needs.
struct Jet {
    du: vec3f,
    dv: vec3f,
    duu: vec3f,
    duv: vec3f,
    dvv: vec3f,
}
