// Images on surfaces: filtering over a footprint.

// The maximum ratio of a footprint's length to its width before it is blurred across.
const MAX_ANISOTROPY: f32 = 8.0;

// Returns the colour in linear light at `uv` (1 is the image's width or height; the sampler repeats), averaged over the
// parallelogram that `across` and `along` (in the same units) span around it: up to eight trilinear probes along the longer
// axis of its ellipse.
fn filtered(image: texture_2d<f32>, image_sampler: sampler, uv: vec2f, across: vec2f, along: vec2f) -> vec3f {
    let size = vec2f(textureDimensions(image, 0));
    let a = across * size;
    let b = along * size;
    // The ellipse's axes are the singular vectors of (a b).
    let xx = a.x * a.x + b.x * b.x;
    let xy = a.x * a.y + b.x * b.y;
    let yy = a.y * a.y + b.y * b.y;
    let mean = 0.5 * (xx + yy);
    let half_difference = 0.5 * (xx - yy);
    let spread = length(vec2f(half_difference, xy));
    let major = sqrt(max(mean + spread, 0.0));
    if !is_finite(major) {
        return textureSampleLevel(image, image_sampler, uv, f32(textureNumLevels(image))).rgb;
    }
    let minor = max(max(sqrt(max(mean - spread, 0.0)), major / MAX_ANISOTROPY), 1.0);
    // A nearly round footprint has one probe; probes overlap.
    let probes = max(floor(major / minor + 0.5), 1.0);
    // Neighbouring levels blend only over the middle half of the interval between them: outside it one of them suffices.
    let exact = log2(max(minor, 0.8 * major / probes));
    let level = floor(exact) + clamp(2.0 * fract(exact) - 0.5, 0.0, 1.0);
    if probes == 1.0 {
        return textureSampleLevel(image, image_sampler, uv, level).rgb;
    }
    // Half the angle of (half_difference, xy), without an arc tangent: the axis of the larger singular value.
    var axis = vec2f(spread + half_difference, xy);
    if half_difference < 0.0 {
        axis = vec2f(xy, spread - half_difference);
    }
    let step = normalize(axis + vec2f(1e-30, 0.0)) * major / size;
    var sum = vec3f();
    for (var k = 0u; k < u32(probes); k++) {
        let t = (f32(k) + 0.5) / probes - 0.5;
        sum += textureSampleLevel(image, image_sampler, uv + t * step, level).rgb;
    }
    return sum / probes;
}
