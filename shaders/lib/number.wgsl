// Numbers that are none. WGSL lets a compiler assume that no NaN and no infinity ever occurs, so they are made
// from bits at run time and recognised by their bits, never by a comparison.

// A quiet NaN. The bits go through a variable: as a constant expression it would be refused.
fn undefined() -> f32 {
    var bits = 0x7fc00000u;
    return bitcast<f32>(bits);
}

// Infinity with the sign of its argument: what an f64 constant beyond the range of f32 stands for.
fn infinite(sign_of: f32) -> f32 {
    var bits = 0x7f800000u;
    if sign_of < 0.0 {
        bits = 0xff800000u;
    }
    return bitcast<f32>(bits);
}

// True for numbers, false for NaN and the infinities: their exponent bits are all set.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

// True for NaN alone.
fn is_undefined(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7fffffffu) > 0x7f800000u;
}

fn is_finite3(x: vec3f) -> bool {
    return is_finite(x.x) && is_finite(x.y) && is_finite(x.z);
}
