// Painter of curves: samples → a strip from each to the next, a disc at each.

const JOIN_SEGMENTS: u32 = 12u;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> glyph: Glyph;
// Position, and in w 1 where it is defined.
@group(0) @binding(2) var<storage, read> samples: array<vec4f>;

@vertex
fn place_curves(@builtin(vertex_index) vertex: u32) -> GlyphVertex {
    let per_sample = 6u + 3u * JOIN_SEGMENTS;
    let index = glyph.first + vertex / per_sample;
    let corner = vertex % per_sample;
    let sample = samples[index];
    let last_of_instance = index % glyph.count + 1u == glyph.count;
    if sample.w == 0.0 {
        return GlyphVertex(nowhere(), vec2f());
    }
    let half_here = half_width(glyph, distance_ahead(sample.xyz, view), view);
    if corner >= 6u {
        return disc_corner(corner - 6u, JOIN_SEGMENTS, sample.xyz, half_here, glyph.join_lift, view);
    }
    if last_of_instance {
        return GlyphVertex(nowhere(), vec2f());
    }
    let next = samples[index + 1u];
    if next.w == 0.0 {
        return GlyphVertex(nowhere(), vec2f());
    }
    let half_next = half_width(glyph, distance_ahead(next.xyz, view), view);
    return strip_corner(corner, sample.xyz, next.xyz, half_here, half_next, glyph.lift, view);
}

@fragment
fn shade_curves(vertex: GlyphVertex) -> @location(0) vec4f {
    return glyph_colour(glyph, vertex.across, view);
}
