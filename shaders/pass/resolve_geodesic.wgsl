// The geodesic view's second half: a map of geodesics' ends → colours. One invocation a pixel, one packed sRGB
// colour each; no light and no gamma change.

const STATUS_COMPLETE: u32 = 0u;

@group(0) @binding(0) var<uniform> resolve: Resolve;
// For each pixel: offset from the camera, as bits; status; steps.
@group(0) @binding(1) var<storage, read> map: array<vec4u>;
@group(0) @binding(2) var<storage, read_write> colours: array<u32>;
// How many pixels have each status, over all dispatches.
@group(0) @binding(3) var<storage, read_write> counts: array<atomic<u32>, 6>;
@group(0) @binding(4) var image: texture_2d<f32>;
@group(0) @binding(5) var image_sampler: sampler;

fn place_in_map(x: i32, y: i32) -> u32 {
    return u32(y - i32(resolve.map_rows.x)) * resolve.size.x + u32(x);
}

fn is_seen(x: i32, y: i32) -> bool {
    let inside = x >= 0 && x < i32(resolve.size.x) && y >= i32(resolve.map_rows.x)
        && y < i32(resolve.map_rows.x + resolve.map_rows.y);
    if !inside {
        return false;
    }
    return map[place_in_map(x, y)].z == STATUS_COMPLETE;
}

fn offset_at(x: i32, y: i32) -> vec2f {
    return bitcast<vec2f>(map[place_in_map(x, y)].xy) * resolve.per_width;
}

// The shorter of the differences to the pixels on both sides, to the image's nearest repetition: a seam, where the
// chart jumps, is no edge of the picture.
fn footprint(x: i32, y: i32, dx: i32, dy: i32) -> vec2f {
    let here = offset_at(x, y);
    var step = vec2f();
    var found = false;
    if is_seen(x - dx, y - dy) {
        step = offset_at(x - dx, y - dy) - here;
        step -= resolve.repeats * round(step);
        found = true;
    }
    if is_seen(x + dx, y + dy) {
        var other = offset_at(x + dx, y + dy) - here;
        other -= resolve.repeats * round(other);
        if !found || dot(other, other) < dot(step, step) {
            step = other;
        }
    }
    return step;
}

@compute @workgroup_size(8, 8)
fn resolve_geodesics(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= resolve.size.x || id.y >= resolve.rows.y {
        return;
    }
    let x = i32(id.x);
    let y = i32(id.y + resolve.rows.x);
    let status = min(map[place_in_map(x, y)].z, 5u);
    if status != STATUS_COMPLETE {
        atomicAdd(&counts[status], 1u);
    }
    var colour: vec3f;
    if status == STATUS_COMPLETE {
        let uv = resolve.place + offset_at(x, y);
        let texel = filtered(image, image_sampler, uv, footprint(x, y, 1, 0), footprint(x, y, 0, 1));
        colour = resolve.colour.rgb * texel;
    } else {
        colour = hatched(x, y, resolve.hatching[2u * status].rgb, resolve.hatching[2u * status + 1u].rgb,
            resolve.hatch, resolve.reach);
    }
    colours[id.y * resolve.stride.x + id.x] = encoded(
        marked_centre(colour, x, y, resolve.size, resolve.ring, resolve.ring_half));
}
