// Painter of vectors: samples → a strip for the shaft, a disc at its start, a cone for the head.

const START_SEGMENTS: u32 = 12u;
const HEAD_SEGMENTS: u32 = 16u;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> glyph: Glyph;
// Two for each arrow: origin (w: 1 where defined), direction.
@group(0) @binding(2) var<storage, read> samples: array<vec4f>;

struct ArrowVertex {
    @builtin(position) position: vec4f,
    // On the shaft, as of any glyph.
    @location(0) across: vec2f,
    // On the head: the cone's normal; 0 on the shaft.
    @location(1) normal: vec3f,
    @location(2) world: vec3f,
}

fn on_shaft(vertex: GlyphVertex) -> ArrowVertex {
    return ArrowVertex(vertex.position, vertex.across, vec3f(), vec3f());
}

@vertex
fn place_vectors(@builtin(vertex_index) vertex: u32) -> ArrowVertex {
    let shaft_corners = 6u + 3u * START_SEGMENTS;
    let per_arrow = shaft_corners + 6u * HEAD_SEGMENTS;
    let index = glyph.first + vertex / per_arrow;
    let corner = vertex % per_arrow;
    let nothing = on_shaft(GlyphVertex(nowhere(), vec2f()));
    let origin = samples[2u * index];
    let arrow = samples[2u * index + 1u].xyz;
    let size = length(arrow);
    if origin.w == 0.0 || size == 0.0 {
        return nothing;
    }
    let direction = arrow / size;
    let tip = origin.xyz + arrow;
    let full_half = half_width(glyph, distance_ahead(tip, view), view);
    // A short arrow is drawn thinner, so that its head leaves some of its shaft.
    let scale = min(1.0, glyph.head_share * size / (glyph.head_length * full_half));
    let head_half = scale * full_half;
    let base = tip - direction * (glyph.head_length * head_half);
    let start_half = scale * half_width(glyph, distance_ahead(origin.xyz, view), view);
    if corner < 6u {
        return on_shaft(strip_corner(corner, origin.xyz, base, start_half, head_half, glyph.lift, view));
    }
    if corner < shaft_corners {
        return on_shaft(disc_corner(corner - 6u, START_SEGMENTS, origin.xyz, start_half, glyph.join_lift, view));
    }
    let other = select(vec3f(0.0, 0.0, 1.0), vec3f(1.0, 0.0, 0.0), abs(direction.z) > 0.9);
    let x = normalize(cross(other, direction));
    let y = cross(direction, x);
    let side = (corner - shaft_corners) / 3u;
    let place = (corner - shaft_corners) % 3u;
    let is_base = side >= HEAD_SEGMENTS;
    let segment = f32(side % HEAD_SEGMENTS) + select(f32(place) - 1.0, 0.5, place == 0u);
    let angle = 6.2831855 * segment / f32(HEAD_SEGMENTS);
    let outwards = cos(angle) * x + sin(angle) * y;
    var position = base + outwards * (glyph.head_radius * head_half);
    if place == 0u {
        position = select(tip, base, is_base);
    }
    var normal = normalize(outwards * glyph.head_length + direction * glyph.head_radius);
    if is_base {
        normal = -direction;
    }
    return ArrowVertex(tile_position(position, glyph.lift * head_half, view), vec2f(), normal, position);
}

@fragment
fn shade_vectors(vertex: ArrowVertex) -> @location(0) vec4f {
    if dot(vertex.normal, vertex.normal) > 1e-6 {
        let facing = dot(normalize(vertex.normal), normalize(view.eye - vertex.world));
        return vec4f(glyph.colour * glyph_light(facing, view), 1.0);
    }
    return glyph_colour(glyph, vertex.across, view);
}
