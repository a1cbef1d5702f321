// Glyphs: points, curves and arrows as strips and discs that face the eye, with a width in space that is kept
// between bounds in pixels.

struct Glyph {
    // Linear light.
    colour: vec3f,
    // Half a line's width, or a point's radius, in drawing units.
    nominal: f32,
    // Its bounds, in pixel units of the view, and the least in true pixels.
    min_pixels: f32,
    max_pixels: f32,
    least: f32,
    // Glyphs and joins come forward by this many of their half widths.
    lift: f32,
    join_lift: f32,
    // Arrowheads, in half widths of the shaft, and the largest share of an arrow.
    head_length: f32,
    head_radius: f32,
    head_share: f32,
    // Samples per instance.
    count: u32,
    // Samples in all.
    total: u32,
    // The first sample of this draw.
    first: u32,
    padding: u32,
}

struct GlyphVertex {
    @builtin(position) position: vec4f,
    // Where on the glyph: distance from the axis (or centre) is its length, 1 at the rim.
    @location(0) across: vec2f,
}

// Half a width at a distance along the view direction.
fn half_width(glyph: Glyph, distance: f32, view: View) -> f32 {
    let pixel = max(distance, view.near) / view.pixels_per_unit;
    let low = max(glyph.min_pixels * view.pixel_unit, glyph.least);
    let high = max(glyph.max_pixels * view.pixel_unit, low);
    return clamp(glyph.nominal, low * pixel, high * pixel);
}

// One of the 6 corners of a strip from a to b. The direction across is the same at both ends: a line and an eye
// span one plane.
fn strip_corner(corner: u32, a: vec3f, b: vec3f, half_a: f32, half_b: f32, lift: f32, view: View) -> GlyphVertex {
    let across = cross(b - a, view.eye - a);
    let size = length(across);
    if size < 1e-12 {
        return GlyphVertex(nowhere(), vec2f());
    }
    let at_b = corner == 2u || corner == 4u || corner == 5u;
    let side = select(-1.0, 1.0, corner == 1u || corner == 3u || corner == 4u);
    let half_here = select(half_a, half_b, at_b);
    let position = select(a, b, at_b) + across * (side * half_here / size);
    return GlyphVertex(tile_position(position, lift * half_here, view), vec2f(side, 0.0));
}

// One of the 3 · segments corners of a disc that faces the eye.
fn disc_corner(corner: u32, segments: u32, centre: vec3f, radius: f32, lift: f32, view: View) -> GlyphVertex {
    if distance_ahead(centre, view) < view.near {
        return GlyphVertex(nowhere(), vec2f());
    }
    let to_eye = normalize(view.eye - centre);
    // Any two unit vectors across the line of sight.
    let other = select(vec3f(0.0, 0.0, 1.0), vec3f(1.0, 0.0, 0.0), abs(to_eye.z) > 0.9);
    let x = normalize(cross(other, to_eye));
    let y = cross(to_eye, x);
    let triangle = corner / 3u;
    let place = corner % 3u;
    var on_disc = vec2f();
    if place != 0u {
        let angle = 6.2831855 * f32((triangle + place - 1u) % segments) / f32(segments);
        on_disc = vec2f(cos(angle), sin(angle));
    }
    let position = centre + radius * (on_disc.x * x + on_disc.y * y);
    return GlyphVertex(tile_position(position, lift * radius, view), on_disc);
}

// The colour of a glyph at a place on it.
fn glyph_colour(glyph: Glyph, across: vec2f, view: View) -> vec4f {
    let facing = sqrt(max(1.0 - dot(across, across), 0.0));
    return vec4f(glyph.colour * glyph_light(facing, view), 1.0);
}
