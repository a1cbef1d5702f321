// The conversion of what a pixel sees to its bytes.

struct Resolve {
    // The surface's colour in linear light; multiplies the image.
    colour: vec4f,
    // The map of the ends' offsets to widths of the image: uv = place + offset * per_width.
    place: vec2f,
    per_width: vec2f,
    // 1 along an axis in which the image repeats, otherwise 0.
    repeats: vec2f,
    // The whole picture in pixels.
    size: vec2u,
    // The first row to colour, and the number of rows.
    rows: vec2u,
    padding: vec2u,
    // Half the hatching's period, and the width of its dark border, in pixels.
    hatch: f32,
    reach: i32,
    // The ring at the centre: radius (0: none) and half its width, in pixels.
    ring: f32,
    ring_half: f32,
    // The number of pixels from one row of the output to the next, padding included.
    stride: vec4u,
    // The background and stripe colours of the hatching for each status, in linear light.
    hatching: array<vec4f, 12>,
}

// Stripes at 45°; `half_period` in pixels.
fn stripes(x: i32, y: i32, half_period: f32, paper: vec3f, stripe: vec3f) -> vec3f {
    let period = 2.0 * half_period;
    let along = f32(x + y + 1) * 0.70710678;
    let phase = fract(along / period);
    let to_middle = abs(phase - 0.5) * period;
    let share = clamp(0.5 * half_period - to_middle + 0.5, 0.0, 1.0);
    return mix(paper, stripe, share);
}

// An open ring around the centre, white with a dark rim; none if `radius` is 0.
fn marked_centre(colour: vec3f, x: i32, y: i32, size: vec2u, radius: f32, half_width: f32) -> vec3f {
    if radius == 0.0 {
        return colour;
    }
    let from_centre = vec2f(f32(x), f32(y)) + 0.5 - 0.5 * vec2f(size);
    let off = abs(length(from_centre) - radius);
    let white = clamp(half_width - off + 0.5, 0.0, 1.0);
    let dark = 0.6 * clamp(2.2 * half_width - off + 0.5, 0.0, 1.0);
    let darkened = colour * (1.0 - dark);
    return darkened + white * (vec3f(1.0) - darkened);
}

// Converts linear light to sRGB (IEC 61966-2-1), rounded to bytes.
fn encoded(light: vec3f) -> u32 {
    let c = clamp(light, vec3f(0.0), vec3f(1.0));
    let curved = 1.055 * pow(max(c, vec3f(1e-6)), vec3f(1.0 / 2.4)) - 0.055;
    let srgb = select(curved, 12.92 * c, c <= vec3f(0.0031308));
    return pack4x8unorm(vec4f(srgb, 1.0));
}
