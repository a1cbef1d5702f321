// The painter of vectors: samples → a strip for the shaft, a disc at its start, a cone for the head.

const START_SEGMENTS: u32 = 12u;
const HEAD_SEGMENTS: u32 = 16u;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> glyph: Glyph;
// Two vectors for each arrow: origin (w: 1 if defined), direction.
@group(0) @binding(2) var<storage, read> samples: array<vec4f>;
// The colours of the instances in linear light; the last one is that of all further instances.
@group(0) @binding(3) var<storage, read> colours: array<vec4f>;

struct ArrowVertex {
    @builtin(position) position: vec4f,
    // The position on the shaft, as for any glyph.
    @location(0) across: vec2f,
    // On the head: the cone's normal; 0 on the shaft.
    @location(1) normal: vec3f,
    // In view space.
    @location(2) place: vec3f,
    // The linear light of the instance.
    @location(3) @interpolate(flat) colour: vec3f,
}

fn on_shaft(vertex: GlyphVertex) -> ArrowVertex {
    return ArrowVertex(vertex.position, vertex.across, vec3f(), vec3f(), vertex.colour);
}

@vertex
fn place_vectors(@builtin(vertex_index) vertex: u32) -> ArrowVertex {
    let shaft_corners = 6u + 3u * START_SEGMENTS;
    let per_arrow = shaft_corners + 6u * HEAD_SEGMENTS;
    let index = glyph.first + vertex / per_arrow;
    let corner = vertex % per_arrow;
    let sample = samples[2u * index];
    if sample.w == 0.0 {
        return on_shaft(NO_VERTEX);
    }
    let colour = colours[min(index, arrayLength(&colours) - 1u)].rgb;
    let origin = seen(sample.xyz, view);
    let along = (view.view_from_world * vec4f(samples[2u * index + 1u].xyz, 0.0)).xyz;
    let tip = origin + along;
    let size = length(along);
    let half_origin = half_width(glyph, origin, view);
    let half_tip = half_width(glyph, tip, view);
    if size < 1e-3 * half_origin {
        // A zero vector has no direction, but is drawn.
        if corner < 6u || corner >= shaft_corners || !is_in_front(origin, view) {
            return on_shaft(NO_VERTEX);
        }
        return on_shaft(disc_corner(
            corner - 6u, START_SEGMENTS, origin, half_origin, glyph.lift * half_origin, colour, view));
    }
    let axis = along / size;
    let full = glyph.head_length * half_tip;
    // A short arrow is scaled down, so that some of its shaft remains visible behind the head.
    let scale = min(glyph.head_share * size / full, 1.0);
    let base = tip - axis * (full * scale);
    if corner < shaft_corners {
        if !is_in_front(origin, view) && !is_in_front(base, view) {
            return on_shaft(NO_VERTEX);
        }
        // A scaled shaft keeps a width that four samples per pixel can resolve.
        let least_origin = min(glyph.least * pixel_at(origin, view), half_origin);
        let least_tip = min(glyph.least * pixel_at(tip, view), half_tip);
        let start_half = max(half_origin * scale, least_origin);
        let base_half = max(half_tip * scale, least_tip);
        let a = cut_at_near(origin, base, view);
        let b = cut_at_near(base, origin, view);
        if corner >= 6u {
            return on_shaft(disc_corner(
                corner - 6u, START_SEGMENTS, a, start_half, glyph.join_lift * start_half, colour, view));
        }
        var across = across_piece(a, b, view);
        if all(across == vec2f()) {
            across = vec2f(1.0, 0.0);
        }
        let far = corner_is_far(corner);
        let at = select(a, b, far);
        let half_here = select(start_half, base_half, far);
        return on_shaft(edge_corner(at, across, corner_side(corner), half_here, glyph.lift, colour, view));
    }
    let other = select(vec3f(0.0, 0.0, 1.0), vec3f(1.0, 0.0, 0.0), abs(axis.z) > 0.9);
    let x = normalize(cross(other, axis));
    let y = cross(axis, x);
    let side = (corner - shaft_corners) / 3u;
    let place = (corner - shaft_corners) % 3u;
    let is_base = side >= HEAD_SEGMENTS;
    let segment = f32(side % HEAD_SEGMENTS) + select(f32(place) - 1.0, 0.5, place == 0u);
    let angle = 6.2831855 * segment / f32(HEAD_SEGMENTS);
    let outwards = cos(angle) * x + sin(angle) * y;
    let radius = glyph.head_radius * half_tip * scale;
    var position = base + outwards * radius;
    if place == 0u {
        position = select(tip, base, is_base);
    }
    // The normal of the side leans forward by the slope of the cone.
    let normal = select(normalize(outwards * (full * scale) + axis * radius), -axis, is_base);
    let seen_at = tile_position(position, glyph.lift * half_tip * scale, view);
    return ArrowVertex(seen_at, vec2f(), normal, position, colour);
}

@fragment
fn shade_vectors(vertex: ArrowVertex) -> @location(0) vec4f {
    if dot(vertex.normal, vertex.normal) > 1e-6 {
        let facing = abs(dot(normalize(vertex.normal), to_eye_from(vertex.place, view)));
        return vec4f(emphasised(vertex.colour * glyph_light(facing, view), glyph.emphasis, view), 1.0);
    }
    return glyph_colour(glyph, vertex.colour, vertex.across, view);
}
