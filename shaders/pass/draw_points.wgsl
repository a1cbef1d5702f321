// The painter of points: samples → discs.

const POINT_SEGMENTS: u32 = 24u;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> glyph: Glyph;
// The position; w is 1 if it is defined.
@group(0) @binding(2) var<storage, read> samples: array<vec4f>;
// The colours of the instances in linear light; the last one is that of all further instances.
@group(0) @binding(3) var<storage, read> colours: array<vec4f>;

@vertex
fn place_points(@builtin(vertex_index) index: u32) -> GlyphVertex {
    let corners = 3u * POINT_SEGMENTS;
    let instance = glyph.first + index / corners;
    let sample = samples[instance];
    let at = seen(sample.xyz, view);
    if sample.w == 0.0 || !is_in_front(at, view) {
        return NO_VERTEX;
    }
    let radius = half_width(glyph, at, view);
    let colour = colours[min(instance, arrayLength(&colours) - 1u)].rgb;
    return disc_corner(index % corners, POINT_SEGMENTS, at, radius, glyph.lift * radius, colour, view);
}

@fragment
fn shade_points(vertex: GlyphVertex) -> @location(0) vec4f {
    return glyph_colour(glyph, vertex.colour, vertex.across, view);
}
