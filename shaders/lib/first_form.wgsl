// The first fundamental form and the geodesic equation, in the surface's tangent plane.

// Derivatives by scaled chart coordinates (a, b) with u = u0 + scale.x a, v = v0 + scale.y b, lengths in units of
// 1 / per_length: what keeps a chart in units of 1e-10, or a surface of size 1e6, within f32.
fn scaled_jet(jet: Jet, scale: vec2f, per_length: f32) -> Jet {
    let by_u = scale.x;
    let by_v = scale.y;
    return Jet(
        jet.du * (by_u * per_length),
        jet.dv * (by_v * per_length),
        jet.duu * (by_u * per_length) * by_u,
        jet.duv * (by_u * per_length) * by_v,
        jet.dvv * (by_v * per_length) * by_v,
    );
}

// The second directional derivative along a velocity: A = σuu u'² + 2 σuv u'v' + σvv v'².
fn second_along(jet: Jet, velocity: vec2f) -> vec3f {
    return jet.duu * (velocity.x * velocity.x)
        + jet.duv * (2.0 * velocity.x * velocity.y)
        + jet.dvv * (velocity.y * velocity.y);
}

// The components (x, y) of a vector's projection to the tangent plane, x σu + y σv. With n = σu × σv they are
// (w × σv)·n / n·n and (σu × w)·n / n·n: no difference of products of E, F, G, which loses all digits in a
// sheared chart.
fn tangent_components(jet: Jet, w: vec3f) -> vec2f {
    let n = cross(jet.du, jet.dv);
    let r = 1.0 / dot(n, n);
    return vec2f(dot(cross(w, jet.dv), n) * r, dot(cross(jet.du, w), n) * r);
}
