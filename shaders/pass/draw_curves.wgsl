// The painter of curves: samples → a strip from each sample to the next; round ends, and round joins at sharp turns.

const JOIN_SEGMENTS: u32 = 12u;
// The cosine of the turn up to which two pieces share their edge (a mitre).
const MITRE: f32 = 0.8;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> glyph: Glyph;
// The position; w is 0 if it is undefined, 2 if the curve breaks off after it, otherwise 1.
@group(0) @binding(2) var<storage, read> samples: array<vec4f>;
// The colours of the instances in linear light; the last one is that of all further instances.
@group(0) @binding(3) var<storage, read> colours: array<vec4f>;

// Returns a sample in view space, with its w.
fn sample_at(index: u32) -> vec4f {
    let sample = samples[index];
    return vec4f(seen(sample.xyz, view), sample.w);
}

// Returns whether the curve continues from a sample to the next.
fn has_piece(a: vec4f, b: vec4f) -> bool {
    return a.w == 1.0 && b.w != 0.0;
}

// Returns the unit vector across the piece from sample `index` to the next; 0 if there is no such piece.
fn across_from(index: u32) -> vec2f {
    if index % glyph.count + 1u >= glyph.count {
        return vec2f();
    }
    let a = sample_at(index);
    let b = sample_at(index + 1u);
    if !has_piece(a, b) || !is_in_front(a.xyz, view) || !is_in_front(b.xyz, view) {
        return vec2f();
    }
    return across_piece(a.xyz, b.xyz, view);
}

// Returns the vector across the piece before sample `index`; 0 if there is none.
fn across_to(index: u32) -> vec2f {
    if index % glyph.count == 0u {
        return vec2f();
    }
    return across_from(index - 1u);
}

@vertex
fn place_curves(@builtin(vertex_index) vertex: u32) -> GlyphVertex {
    let per_sample = 6u + 3u * JOIN_SEGMENTS;
    let index = glyph.first + vertex / per_sample;
    let corner = vertex % per_sample;
    let here = sample_at(index);
    if here.w == 0.0 {
        return NO_VERTEX;
    }
    let colour = colours[min(index / glyph.count, arrayLength(&colours) - 1u)].rgb;
    if corner >= 6u {
        if !is_in_front(here.xyz, view) {
            return NO_VERTEX;
        }
        let before = across_to(index);
        let after = across_from(index);
        if dot(before, after) >= MITRE {
            return NO_VERTEX;
        }
        let is_end = all(before == vec2f()) || all(after == vec2f());
        let half_here = half_width(glyph, here.xyz, view);
        let lift = select(glyph.join_lift, glyph.lift, is_end) * half_here;
        return disc_corner(corner - 6u, JOIN_SEGMENTS, here.xyz, half_here, lift, colour, view);
    }
    if index % glyph.count + 1u >= glyph.count {
        return NO_VERTEX;
    }
    let next = sample_at(index + 1u);
    if !has_piece(here, next) || (!is_in_front(here.xyz, view) && !is_in_front(next.xyz, view)) {
        return NO_VERTEX;
    }
    let a = cut_at_near(here.xyz, next.xyz, view);
    let b = cut_at_near(next.xyz, here.xyz, view);
    var across = across_piece(a, b, view);
    if all(across == vec2f()) {
        across = vec2f(1.0, 0.0);
    } else {
        // (p + q) / (1 + p·q) has component 1 along both p and q.
        var other: vec2f;
        if corner_is_far(corner) {
            other = across_from(index + 1u);
        } else {
            other = across_to(index);
        }
        let cosine = dot(across, other);
        if cosine >= MITRE {
            across = (across + other) / (1.0 + cosine);
        }
    }
    let at = select(a, b, corner_is_far(corner));
    return edge_corner(at, across, corner_side(corner), half_width(glyph, at, view), glyph.lift, colour, view);
}

@fragment
fn shade_curves(vertex: GlyphVertex) -> @location(0) vec4f {
    return glyph_colour(glyph, vertex.colour, vertex.across, view);
}
