// The painter of solids: the light and depth that rays have found, two words per pixel, into the target's samples.

struct SolidExtent {
    // The number of columns of pixels.
    columns: u32,
}

@group(0) @binding(0) var<uniform> extent: SolidExtent;
// For each pixel the bits of its depth, 0 if no solid is seen, and its sRGB colour; or SPLIT, and the index of the first of
// its four samples in `splits`.
@group(0) @binding(1) var<storage, read> pixels: array<vec2u>;
// The same for each sample of the pixels whose samples differ.
@group(0) @binding(2) var<storage, read> splits: array<vec2u>;

const SPLIT: u32 = 0xffffffffu;

struct SolidFragment {
    @location(0) colour: vec4f,
    @builtin(frag_depth) depth: f32,
}

// One triangle over the whole target.
@vertex
fn place_solids(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u));
    return vec4f(4.0 * corner - 1.0, 0.0, 1.0);
}

fn linear_light(encoded: vec3f) -> vec3f {
    let low = encoded / 12.92;
    let high = pow((encoded + 0.055) / 1.055, vec3f(2.4));
    return select(high, low, encoded <= vec3f(0.04045));
}

@fragment
fn shade_solids(@builtin(position) at: vec4f, @builtin(sample_index) sample: u32) -> SolidFragment {
    let place = vec2u(at.xy);
    var seen = pixels[place.y * extent.columns + place.x];
    if seen.x == SPLIT {
        seen = splits[seen.y + sample];
    }
    if seen.x == 0u {
        discard;
    }
    let colour = linear_light(unpack4x8unorm(seen.y).rgb);
    return SolidFragment(vec4f(colour, 1.0), bitcast<f32>(seen.x));
}
