// Glyphs: points, curves and arrows as strips and discs that face the eye, with a width in space that stays within limits in
// pixels. Positions are in view space.

struct Glyph {
    // Half a line's width, or a point's radius, in drawing units.
    nominal: f32,
    // Its limits, in pixel units of the view, and the minimum in true pixels.
    min_pixels: f32,
    max_pixels: f32,
    least: f32,
    // Glyphs and joins are moved towards the eye by this multiple of their half widths.
    lift: f32,
    join_lift: f32,
    // Arrowheads, in half widths of the shaft, and their maximum fraction of an arrow.
    head_length: f32,
    head_radius: f32,
    head_share: f32,
    // Samples per instance.
    count: u32,
    // Samples in all.
    total: u32,
    // The first sample of this draw.
    first: u32,
    // The fraction of the view's emphasis.
    emphasis: f32,
}

struct GlyphVertex {
    @builtin(position) position: vec4f,
    // The position on the glyph; its length is the distance from the axis (or centre), 1 at the rim.
    @location(0) across: vec2f,
    // The linear light of the instance.
    @location(1) @interpolate(flat) colour: vec3f,
}

const NO_VERTEX = GlyphVertex(vec4f(2.0, 2.0, 2.0, 1.0), vec2f(), vec3f());

// Returns half the width at a point.
fn half_width(glyph: Glyph, at: vec3f, view: View) -> f32 {
    let pixel = pixel_at(at, view);
    let low = max(glyph.min_pixels * view.pixel_unit, glyph.least);
    let high = max(glyph.max_pixels * view.pixel_unit, low);
    return clamp(glyph.nominal, low * pixel, high * pixel);
}

fn is_in_front(at: vec3f, view: View) -> bool {
    return distance_of(at, view) >= view.near;
}

// Returns the intersection with the near plane of a line from `at`, behind the plane, to `towards`; `at` itself if it is in
// front.
fn cut_at_near(at: vec3f, towards: vec3f, view: View) -> vec3f {
    if is_in_front(at, view) || !is_in_front(towards, view) {
        return at;
    }
    let t = (view.near + at.z) / (at.z - towards.z);
    return vec3f(mix(at.xy, towards.xy, t), -view.near);
}

// Returns the unit vector across a piece, as seen; 0 if the piece is seen as a point.
fn across_piece(a: vec3f, b: vec3f, view: View) -> vec2f {
    let along = b.xy / max(distance_of(b, view), view.near) - a.xy / max(distance_of(a, view), view.near);
    let size = length(along);
    if size * view.pixels_per_unit < 0.02 {
        return vec2f();
    }
    return vec2f(-along.y, along.x) / size;
}

// Returns a corner on the edge of a strip: `side` is 1 or -1.
fn edge_corner(
    at: vec3f, across: vec2f, side: f32, half_here: f32, lift: f32, colour: vec3f, view: View,
) -> GlyphVertex {
    let place = at + vec3f(side * half_here * across, 0.0);
    return GlyphVertex(tile_position(place, lift * half_here, view), vec2f(0.0, side), colour);
}

// The end and the side of a strip for each of its 6 corners: true for the far end.
fn corner_is_far(corner: u32) -> bool {
    return corner == 1u || corner == 2u || corner == 4u;
}

fn corner_side(corner: u32) -> f32 {
    return select(1.0, -1.0, corner == 2u || corner == 4u || corner == 5u);
}

// Returns one of the 3 · segments corners of a disc that faces the eye: a regular polygon of the disc's area.
fn disc_corner(
    corner: u32, segments: u32, centre: vec3f, radius: f32, lift: f32, colour: vec3f, view: View,
) -> GlyphVertex {
    let turn = 6.2831855 / f32(segments);
    let size = radius * sqrt(turn / sin(turn));
    let place = corner % 3u;
    var on_disc = vec2f();
    if place != 0u {
        let angle = turn * f32((corner / 3u + place - 1u) % segments);
        on_disc = vec2f(cos(angle), sin(angle));
    }
    return GlyphVertex(tile_position(centre + vec3f(size * on_disc, 0.0), lift, view), on_disc, colour);
}

// Returns the colour of a glyph at a position on it.
fn glyph_colour(glyph: Glyph, colour: vec3f, across: vec2f, view: View) -> vec4f {
    let facing = sqrt(max(1.0 - dot(across, across), 0.0));
    return vec4f(emphasised(colour * glyph_light(facing, view), glyph.emphasis, view), 1.0);
}
