// Painter of points: samples → discs.

const POINT_SEGMENTS: u32 = 24u;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> glyph: Glyph;
// Position, and in w 1 where it is defined.
@group(0) @binding(2) var<storage, read> samples: array<vec4f>;

@vertex
fn place_points(@builtin(vertex_index) index: u32) -> GlyphVertex {
    let corners = 3u * POINT_SEGMENTS;
    let sample = samples[glyph.first + index / corners];
    if sample.w == 0.0 {
        return GlyphVertex(nowhere(), vec2f());
    }
    let radius = half_width(glyph, distance_ahead(sample.xyz, view), view);
    return disc_corner(index % corners, POINT_SEGMENTS, sample.xyz, radius, glyph.lift, view);
}

@fragment
fn shade_points(vertex: GlyphVertex) -> @location(0) vec4f {
    return glyph_colour(glyph, vertex.across, view);
}
