// NaN and infinities. WGSL lets a compiler assume that they never occur, so they are made from bits at run time and
// recognised by their bits, never by a comparison.

// Returns a quiet NaN. The bits pass through a variable: as a constant expression they would be refused.
fn undefined() -> f32 {
    var bits = 0x7fc00000u;
    return bitcast<f32>(bits);
}

// Returns infinity with the sign of its argument: the value of an f64 constant beyond the range of f32.
fn infinite(sign_of: f32) -> f32 {
    var bits = 0x7f800000u;
    if sign_of < 0.0 {
        bits = 0xff800000u;
    }
    return bitcast<f32>(bits);
}

// Returns true for numbers, false for NaN and the infinities: their exponent bits are all set.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

// Returns true for NaN only.
fn is_undefined(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7fffffffu) > 0x7f800000u;
}

fn is_finite3(x: vec3f) -> bool {
    return is_finite(x.x) && is_finite(x.y) && is_finite(x.z);
}
