// The geodesic view: a table of polynomials → colours. One invocation per pixel, a workgroup per block of the table; no
// light and no gamma change. crates/geodesic/src/piecewise/table.rs describes the layout of the table.

const STATUS_COMPLETE: u32 = 0u;
// Words of the table; a test compares these numbers with those of the writer.
const APEXES: u32 = 8u;
const APEX_WORDS: u32 = 8u;
const PATCH_WORDS: u32 = 106u;
const SINGLE_WORDS: u32 = 512u;
const DEGREE: u32 = 6u;
// Kinds of cover.
const COVER_PATCH: u32 = 0u;
const COVER_SINGLE: u32 = 1u;
// The word at which the edges' offsets begin, and the coordinates of a patch that an edge passes through.
const BOUNDS: u32 = 40u;
const PLAIN_WITH_EDGE: u32 = 5u;
const STATUS_LEFT_DOMAIN: u32 = 1u;

@group(0) @binding(0) var<uniform> resolve: Resolve;
@group(0) @binding(1) var<storage, read> table: array<u32>;
@group(0) @binding(2) var<storage, read_write> colours: array<u32>;
// The number of pixels of each status, over all dispatches.
@group(0) @binding(3) var<storage, read_write> counts: array<atomic<u32>, 6>;
@group(0) @binding(4) var image: texture_2d<f32>;
@group(0) @binding(5) var image_sampler: sampler;

fn number(word: u32) -> f32 {
    return bitcast<f32>(table[word]);
}

fn cover_at(x: i32, y: i32) -> u32 {
    return table[table[4] + (u32(y) / 8u) * table[2] + u32(x) / 8u];
}

// Returns the first word of a pixel of a single.
fn single_at(cover: u32, x: i32, y: i32) -> u32 {
    let index = cover & 0x3fffffffu;
    return table[6] + index * SINGLE_WORDS + 8u * ((u32(y) % 8u) * 8u + u32(x) % 8u);
}

fn patch_at(cover: u32) -> u32 {
    return table[5] + (cover & 0x3fffffffu) * PATCH_WORDS;
}

fn status_at(x: i32, y: i32) -> u32 {
    let cover = cover_at(x, y);
    let kind = cover >> 30u;
    if kind == COVER_PATCH {
        let patch_word = patch_at(cover);
        if table[patch_word + 4u] != PLAIN_WITH_EDGE {
            return STATUS_COMPLETE;
        }
        let at = in_patch(patch_word, x, y).offset;
        let low = vec2f(number(BOUNDS), number(BOUNDS + 2u));
        let high = vec2f(number(BOUNDS + 1u), number(BOUNDS + 3u));
        let left = any(at < low) || any(at > high);
        return select(STATUS_COMPLETE, STATUS_LEFT_DOMAIN, left);
    }
    if kind == COVER_SINGLE {
        return min(table[single_at(cover, x, y) + 6u], 5u);
    }
    return min(cover & 0x3fffffffu, 5u);
}

fn is_seen(x: i32, y: i32) -> bool {
    let inside = x >= 0 && x < i32(resolve.size.x) && y >= 0 && y < i32(resolve.size.y);
    return inside && status_at(x, y) == STATUS_COMPLETE;
}

// The end of a pixel's geodesic, with its derivatives by one pixel to the right and down.
struct End {
    offset: vec2f,
    right: vec2f,
    down: vec2f,
}

// Evaluates the polynomial of a patch.
fn in_patch(patch_word: u32, x: i32, y: i32) -> End {
    let corner = vec2f(f32(table[patch_word]), f32(table[patch_word + 1u]));
    let extent = vec2f(f32(table[patch_word + 2u]), f32(table[patch_word + 3u]));
    let at = (2.0 * (vec2f(f32(x), f32(y)) - corner) + 1.0) / extent - 1.0;
    var value = vec2f();
    var by_x = vec2f();
    var by_y = vec2f();
    for (var row = DEGREE + 1u; row > 0u; row--) {
        let word = patch_word + 8u + (row - 1u) * (DEGREE + 1u);
        var line = vec2f();
        var slope = vec2f();
        for (var column = DEGREE + 1u; column > 0u; column--) {
            slope = slope * at.x + line;
            let first = number(word + column - 1u);
            let second = number(word + column - 1u + (DEGREE + 1u) * (DEGREE + 1u));
            line = line * at.x + vec2f(first, second);
        }
        by_y = by_y * at.y + value;
        value = value * at.y + line;
        by_x = by_x * at.y + slope;
    }
    let centre = vec2f(number(patch_word + 6u), number(patch_word + 7u));
    return End(centre + value, by_x * 2.0 / extent.x, by_y * 2.0 / extent.y);
}

// Returns the angle of a point; a driver's atan2 may be off by 23 pixels. The polynomial is that of the CPU.
fn angle_of(p: vec2f) -> f32 {
    let size = abs(p);
    let larger = max(size.x, size.y);
    let z = min(size.x, size.y) / select(1.0, larger, larger > 0.0);
    let square = z * z;
    var sum = -0.0043554176;
    sum = sum * square + 0.023040181;
    sum = sum * square - 0.057773657;
    sum = sum * square + 0.0979424;
    sum = sum * square - 0.13976584;
    sum = sum * square + 0.19962704;
    sum = sum * square - 0.3333166;
    let first = z + z * (square * sum);
    let acute = select(first, 1.57079633 - first, size.y > size.x);
    let half = select(acute, 3.14159265 - acute, p.x < 0.0);
    return select(half, -half, p.y < 0.0);
}

// Converts (a, b) about an apex to offsets from the camera.
fn from_apex(end: End, side: u32) -> End {
    let word = APEXES + side * APEX_WORDS;
    let base = number(word);
    let sign = number(word + 1u);
    let low = number(word + 2u);
    let per_angle = number(word + 3u);
    let power = number(word + 4u);
    let axis = side / 2u;
    let p = end.offset;
    let largest = max(max(abs(p.x), abs(p.y)), 1e-30);
    let r = largest * length(p / largest);
    let unit = p / r;
    var depth = r;
    var slope = 1.0;
    if power == 2.0 {
        depth = r * r;
        slope = 2.0 * r;
    } else if power == 0.5 {
        depth = sqrt(r);
        slope = 0.5 / depth;
    } else if power != 1.0 {
        depth = pow(r, power);
        slope = power * depth / r;
    }
    var result: End;
    result.offset[axis] = base + sign * depth;
    result.offset[1u - axis] = low + angle_of(p) * per_angle;
    let across = vec2f(-unit.y, unit.x) * (per_angle / r);
    result.right[axis] = sign * slope * dot(unit, end.right);
    result.right[1u - axis] = dot(across, end.right);
    result.down[axis] = sign * slope * dot(unit, end.down);
    result.down[1u - axis] = dot(across, end.down);
    return result;
}

fn end_at(x: i32, y: i32) -> End {
    let cover = cover_at(x, y);
    if cover >> 30u == COVER_SINGLE {
        let word = single_at(cover, x, y);
        return End(
            vec2f(number(word), number(word + 1u)),
            vec2f(number(word + 2u), number(word + 3u)),
            vec2f(number(word + 4u), number(word + 5u)));
    }
    let patch_word = patch_at(cover);
    let end = in_patch(patch_word, x, y);
    let coordinates = table[patch_word + 4u];
    if coordinates == 0u || coordinates == PLAIN_WITH_EDGE {
        return end;
    }
    return from_apex(end, coordinates - 1u);
}

@compute @workgroup_size(8, 8)
fn resolve_piecewise(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= resolve.size.x || id.y >= resolve.rows.y {
        return;
    }
    let x = i32(id.x);
    let y = i32(id.y + resolve.rows.x);
    let status = status_at(x, y);
    var colour: vec3f;
    if status == STATUS_COMPLETE {
        let end = end_at(x, y);
        let uv = resolve.place + end.offset * resolve.per_width;
        let texel = filtered(image, image_sampler, uv, end.right * resolve.per_width, end.down * resolve.per_width);
        colour = resolve.colour.rgb * texel;
    } else {
        atomicAdd(&counts[status], 1u);
        colour = hatched(x, y, resolve.hatching[2u * status].rgb, resolve.hatching[2u * status + 1u].rgb,
            resolve.hatch, resolve.reach);
    }
    colours[id.y * resolve.stride.x + id.x] = encoded(
        marked_centre(colour, x, y, resolve.size, resolve.ring, resolve.ring_half));
}
