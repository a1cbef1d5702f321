// A traced picture: rays are followed through solids, mirrors and glass as in crates/tracer/src/shade.rs. The scene is data,
// written by crates/render/src/gpu/trace/tables.rs; crates/wgsl/src/traced.rs writes the functions of its expressions. There
// is one invocation per pixel. A sample for which f32 may decide differently from f64, or which exceeds the lists below, is
// marked and adds nothing.

const NONE: u32 = 0xffffffffu;
// The maximum sizes of the lists of a ray.
const MOST_NODES: u32 = 128u;
const MOST_EVENTS: u32 = 64u;
const MOST_TOGETHER: u32 = 8u;
const MOST_AT_START: u32 = 16u;
const MOST_MEDIA: u32 = 4u;
const MOST_PATHS: u32 = 16u;
const MOST_BOXES: u32 = 40u;
// The maximum number of points at which a ray crosses a component, but no visible face.
const MOST_PASSED: u32 = 64u;
// The error of a point, as a fraction of its distances.
const PLACE_ERROR: f32 = 1e-6;
// In the look `crt`, faces block parallel light up to this distance.
const PARALLEL_REACH: f32 = 1e4;

const LOOK_CRT: u32 = 1u;
const SIDES_BOTH: u32 = 0u;
const SIDES_OUTER: u32 = 1u;
// The kind of a piece that a field bounds, in place of the degree.
const FIELD_PIECE: u32 = 255u;
// What a material lets through depends on the place, or its colour does.
const VARIES_THROUGH: u32 = 0x10000u;
const VARIES_COLOR: u32 = 0x20000u;

struct Trace {
    lens: Lens,
    first_row: u32,
    rows: u32,
    sample: u32,
    // The bit that marks the sample; the sums begin with the first bit.
    bit: u32,
    light_count: u32,
    endless: u32,
    boxes: u32,
    bounces: u32,
    look: u32,
    least_weight: f32,
    order_at: u32,
    terms_at: u32,
    sky_at: u32,
    sky_cells: u32,
    // The first row of the picture in the sums.
    slab_row: u32,
    // The value 1, unknown to the compiler.
    one: u32,
}

struct BoxNode {
    lower: vec3f,
    place: u32,
    upper: vec3f,
    count: u32,
}

struct Component {
    solid: u32,
    first_leaf: u32,
    leaf_count: u32,
    first_node: u32,
    node_count: u32,
    // The material of the leaf whose glass its solid is of, or NONE.
    glass: u32,
    ior: f32,
    depth: f32,
}

struct Leaf {
    // The rows of the map into its frame, from positions relative to its centre.
    row_x: vec4f,
    row_y: vec4f,
    row_z: vec4f,
    centre: vec3f,
    first_piece: u32,
    lower: vec3f,
    piece_count: u32,
    upper: vec3f,
    gate: u32,
    material: u32,
    sides: u32,
    padding: vec2u,
}

struct Piece {
    squares: vec3f,
    constant: f32,
    mixed: vec3f,
    literal: u32,
    linear: vec3f,
    frame: u32,
    equation: u32,
    leaf: u32,
    // The degree, or FIELD_PIECE; plus 256 if the piece is inside where the polynomial or the field is positive.
    kind: u32,
    // 64 times the first term, plus their number; for a field its first word.
    terms: u32,
}

struct Material {
    color: vec3f,
    scattered: f32,
    mirror: vec3f,
    glass: f32,
    specular: f32,
    shininess: f32,
    // The first word of the lists of attributes that are expressions, and the number of lists, with VARIES_THROUGH and
    // VARIES_COLOR.
    lists: u32,
    varies: u32,
}

// The look of a face at a point: its material there, and the gradient of the height along the outward normal.
struct VariedLook {
    material: Material,
    bump: vec3f,
}

@group(0) @binding(0) var<uniform> trace: Trace;
@group(0) @binding(1) var<storage, read> boxes: array<BoxNode>;
@group(0) @binding(2) var<storage, read> components: array<Component>;
@group(0) @binding(3) var<storage, read> leaves: array<Leaf>;
@group(0) @binding(4) var<storage, read> pieces: array<Piece>;
// Nodes of trees, the order of components, terms of polynomials, the sky, attributes and fields.
@group(0) @binding(5) var<storage, read> words: array<u32>;
@group(0) @binding(6) var<storage, read> materials: array<Material>;
@group(0) @binding(7) var<storage, read> lights: array<Light>;
// For each pixel the light of its samples, and the bits of the marked ones.
@group(0) @binding(8) var<storage, read_write> sums: array<vec4f>;

struct Ray {
    origin: vec3f,
    direction: vec3f,
    // The equation of the surface on which it starts, or NONE.
    leaving: u32,
    // The error of its start.
    slack: f32,
}

// The first crossing of a component.
struct Met {
    t: f32,
    piece: u32,
    entering: bool,
    inside_before: bool,
}

struct Medium {
    component: u32,
    color: vec3f,
}

struct Path {
    ray: Ray,
    share: vec3f,
    weight: f32,
    // The length of the path from the eye.
    length: f32,
    bounces: u32,
    media_count: u32,
    media: array<Medium, MOST_MEDIA>,
}

struct Face {
    t: f32,
    piece: u32,
    position: vec3f,
    // On the side of the ray's start.
    normal: vec3f,
    // The normal for lighting: a height may turn it.
    lit_normal: vec3f,
}

// True if the sample is left to f64.
var<private> is_marked: bool;
// The state of a component's tree: for each node the number of parts that hold.
var<private> holding: array<u32, MOST_NODES>;
// The events of a component: t, and the piece, plus 2³¹ if the ray enters it.
var<private> event_t: array<f32, MOST_EVENTS>;
var<private> event_piece: array<u32, MOST_EVENTS>;
var<private> event_count: u32;
// All events up to here are known. A field yields only the events that are needed, since finding each takes long.
var<private> known_until: f32;
var<private> wanted: u32;
// The components that contain the ray before its first crossing, by their numbers.
var<private> start: array<u32, MOST_AT_START>;
var<private> start_count: u32;
// The first crossings of components, by their numbers, then those of solids among them.
var<private> together: array<u32, MOST_TOGETHER>;
var<private> together_piece: array<u32, MOST_TOGETHER>;
var<private> together_enters: array<bool, MOST_TOGETHER>;
var<private> together_count: u32;
var<private> together_t: f32;
var<private> paths: array<Path, MOST_PATHS>;
var<private> path_count: u32;

// Returns the membership of a node of which `count` parts hold.
fn node_holds(node: u32, count: u32) -> bool {
    if (node & 0x80000000u) != 0u {
        return count > 0u;
    }
    return count == (node & 0xffffu);
}

fn root_holds(first_node: u32) -> bool {
    return node_holds(words[2u * first_node], holding[0]);
}

// Changes a literal, which must differ, and everything that depends on it.
fn set_literal(first_node: u32, literal: u32, inside: bool) {
    var rises = inside != ((literal & 0x80000000u) != 0u);
    var id = literal & 0x7fffffffu;
    for (var step = 0u; step < MOST_NODES; step++) {
        let node = words[2u * (first_node + id)];
        let count = holding[id];
        let now = select(count - 1u, count + 1u, rises);
        holding[id] = now;
        let after = node_holds(node, now);
        if node_holds(node, count) == after {
            return;
        }
        let parent = (node >> 16u) & 0x7fffu;
        if parent == 0x7fffu {
            return;
        }
        rises = after;
        id = parent;
    }
}

fn toggle(first_node: u32, event: u32, forward: bool) {
    let inside = (event_piece[event] & 0x80000000u) != 0u;
    let literal = pieces[event_piece[event] & 0x7fffffffu].literal;
    set_literal(first_node, literal, inside == forward);
}

fn add_event(piece: u32, t: f32, inside: bool) {
    if event_count == MOST_EVENTS {
        is_marked = true;
        return;
    }
    event_t[event_count] = t;
    event_piece[event_count] = piece | select(0u, 0x80000000u, inside);
    event_count++;
}

// Returns a number that a generated function reads.
fn uniform_value(instance: u32, slot: u32) -> f32 {
    return bitcast<f32>(words[instance + slot]);
}

// Returns the part of a line within a box, slightly enlarged; empty if the first bound exceeds the second.
fn part_within(lower: vec3f, upper: vec3f, origin: vec3f, reciprocal: vec3f) -> vec2f {
    let a = (lower - origin) * reciprocal;
    let b = (upper - origin) * reciprocal;
    let low = min(a, b);
    let high = max(a, b);
    let near = max(max(low.x, low.y), low.z);
    let far = min(min(high.x, high.y), high.z);
    return vec2f(near - PLACE_ERROR * abs(near), far + PLACE_ERROR * abs(far));
}

fn reciprocal_of(direction: vec3f) -> vec3f {
    let least = vec3f(1e-20);
    let far = select(least, -least, direction < vec3f(0.0));
    return 1.0 / select(direction, far, abs(direction) < least);
}

fn line_in(leaf: u32, ray: Ray) -> FrameLine {
    let x = leaves[leaf].row_x;
    let y = leaves[leaf].row_y;
    let z = leaves[leaf].row_z;
    let offset = ray.origin - leaves[leaf].centre;
    let origin = vec3f(dot(x.xyz, offset), dot(y.xyz, offset), dot(z.xyz, offset)) + vec3f(x.w, y.w, z.w);
    let d = ray.direction;
    let velocity = vec3f(dot(x.xyz, d), dot(y.xyz, d), dot(z.xyz, d));
    let speed = length(velocity);
    let direction = velocity / speed;
    let middle = -dot(origin, direction);
    return FrameLine(origin + middle * direction, direction, middle / speed, speed);
}

// Returns half of the gradient of a quadric's part of degree two.
fn half_gradient(squares: vec3f, mixed: vec3f, at: vec3f) -> vec3f {
    let m = mixed;
    return squares * at
        + 0.5 * vec3f(m.z * at.y + m.y * at.z, m.z * at.x + m.x * at.z, m.y * at.x + m.x * at.y);
}

fn term_at(piece: u32, k: u32) -> u32 {
    return trace.terms_at + 2u * ((pieces[piece].terms >> 6u) + k);
}

// Returns the polynomial of a piece along a line in its frame.
fn along_line(piece: u32, line: FrameLine) -> Coefficients {
    var p: Coefficients;
    p.degree = pieces[piece].kind & 0xffu;
    if p.degree <= 2u {
        let squares = pieces[piece].squares;
        let mixed = pieces[piece].mixed;
        let linear = pieces[piece].linear;
        let at = half_gradient(squares, mixed, line.point);
        let along = half_gradient(squares, mixed, line.direction);
        p.terms[0] = dot(at + linear, line.point) + pieces[piece].constant;
        p.terms[1] = dot(2.0 * at + linear, line.direction);
        p.terms[2] = dot(along, line.direction);
        return p;
    }
    let count = pieces[piece].terms & 63u;
    for (var k = 0u; k < count; k++) {
        let word = term_at(piece, k);
        var term: array<f32, 5>;
        term[0] = bitcast<f32>(words[word + 1u]);
        var degree = 0u;
        for (var axis = 0u; axis < 3u; axis++) {
            let exponent = (words[word] >> (8u * axis)) & 0xffu;
            for (var n = 0u; n < exponent; n++) {
                degree++;
                for (var j = degree; j >= 1u; j--) {
                    term[j] = term[j] * line.point[axis] + term[j - 1u] * line.direction[axis];
                }
                term[0] *= line.point[axis];
            }
        }
        for (var j = 0u; j <= degree; j++) {
            p.terms[j] += term[j];
        }
    }
    return p;
}

fn gradient_at(piece: u32, at: vec3f) -> vec3f {
    if (pieces[piece].kind & 0xffu) == FIELD_PIECE {
        return field_gradient(piece, at);
    }
    if (pieces[piece].kind & 0xffu) <= 2u {
        let half = half_gradient(pieces[piece].squares, pieces[piece].mixed, at);
        return 2.0 * half + pieces[piece].linear;
    }
    var gradient = vec3f(0.0);
    let count = pieces[piece].terms & 63u;
    for (var k = 0u; k < count; k++) {
        let word = term_at(piece, k);
        let e = vec3u(words[word] & 0xffu, (words[word] >> 8u) & 0xffu, (words[word] >> 16u) & 0xffu);
        let p = vec3f(whole_power(at.x, e.x), whole_power(at.y, e.y), whole_power(at.z, e.z));
        let slope = vec3f(slope_power(at.x, e.x), slope_power(at.y, e.y), slope_power(at.z, e.z));
        gradient += bitcast<f32>(words[word + 1u])
            * vec3f(slope.x * p.y * p.z, p.x * slope.y * p.z, p.x * p.y * slope.z);
    }
    return gradient;
}

fn whole_power(x: f32, n: u32) -> f32 {
    var product = 1.0;
    for (var k = 0u; k < n; k++) {
        product *= x;
    }
    return product;
}

fn slope_power(x: f32, n: u32) -> f32 {
    if n == 0u {
        return 0.0;
    }
    return f32(n) * whole_power(x, n - 1u);
}

// Returns the sign changes of a piece in t, without the one that the ray leaves.
fn piece_changes(piece: u32, line: FrameLine, leaving: bool) -> SignChanges {
    var p = along_line(piece, line);
    if leaving {
        p = deflated(p, place_of(line, 0.0));
    }
    var changes = sign_changes(p);
    for (var k = 0u; k < changes.count; k++) {
        changes.places[k] = t_of(line, changes.places[k]);
    }
    return changes;
}

// Reads a piece: its membership where the ray reaches it after `behind_t`, and its events after that.
fn read_polynomial(piece: u32, line: FrameLine, ray: Ray, part: vec2f, behind_t: f32) -> bool {
    let begin = max(part.x, behind_t);
    let leaving = pieces[piece].equation == ray.leaving;
    let changes = piece_changes(piece, line, leaving);
    let is_inside = inside_after(changes, begin) != (pieces[piece].kind >= 256u);
    var inside = is_inside;
    for (var j = 0u; j < changes.count; j++) {
        let t = changes.places[j];
        // This close to the start, only f64 determines the side of the surface.
        if !leaving && behind_t == 0.0 && abs(t) < ray.slack && t >= part.x {
            is_marked = true;
        }
        if t > begin && t <= part.y {
            inside = !inside;
            add_event(piece, t, inside);
        }
    }
    return is_inside;
}

// Reads a leaf: its membership where the ray reaches it, and its events after `behind_t`.
fn read_leaf(leaf: u32, first_node: u32, ray: Ray, reciprocal: vec3f, behind_t: f32) {
    let part = part_within(leaves[leaf].lower, leaves[leaf].upper, ray.origin, reciprocal);
    if part.x > part.y || part.y < behind_t {
        return;
    }
    let first = leaves[leaf].first_piece;
    var line: FrameLine;
    var frame = NONE;
    // The gate, then the pieces.
    for (var k = 0u; k <= leaves[leaf].piece_count; k++) {
        var literal = leaves[leaf].gate;
        var is_inside = true;
        if k > 0u {
            let piece = first + k - 1u;
            if pieces[piece].frame != frame {
                frame = pieces[piece].frame;
                line = line_in(frame, ray);
            }
            literal = pieces[piece].literal;
            if (pieces[piece].kind & 0xffu) == FIELD_PIECE {
                is_inside = read_field(piece, line, ray, part, behind_t);
            } else {
                is_inside = read_polynomial(piece, line, ray, part, behind_t);
            }
        }
        if is_inside {
            set_literal(first_node, literal, true);
        }
    }
}

// Returns the event of a group that by itself takes the ray across the component's surface, otherwise the first of them.
fn owner(first_node: u32, t: f32, after: bool) -> u32 {
    var first = NONE;
    var count = 0u;
    for (var k = 0u; k < event_count; k++) {
        if event_t[k] == t {
            first = min(first, k);
            count++;
        }
    }
    if count == 1u {
        return first;
    }
    // First all events backward, then each of them forward and backward.
    for (var step = 0u; step < 3u * event_count; step++) {
        var event = step;
        var forward = false;
        if step >= event_count {
            event = (step - event_count) / 2u;
            forward = (step - event_count) % 2u == 0u;
        }
        if event_t[event] == t {
            toggle(first_node, event, forward);
            if forward && root_holds(first_node) == after {
                return event;
            }
        }
    }
    return first;
}

// Returns the first crossing of a component after `behind_t` and not after `before`.
fn visit(component: u32, ray: Ray, reciprocal: vec3f, behind_t: f32, before: f32) -> Met {
    let first_node = components[component].first_node;
    let first_leaf = components[component].first_leaf;
    var met = Met(ENDLESS, NONE, false, false);
    var passed = behind_t;
    wanted = 1u;
    loop {
        for (var k = 0u; k < components[component].node_count; k++) {
            holding[k] = words[2u * (first_node + k) + 1u];
        }
        event_count = 0u;
        known_until = before;
        for (var k = 0u; k < components[component].leaf_count; k++) {
            read_leaf(first_leaf + k, first_node, ray, reciprocal, passed);
        }
        if wanted == 1u {
            met.inside_before = root_holds(first_node);
        }
        for (var step = 0u; step <= MOST_EVENTS; step++) {
            var t = ENDLESS;
            for (var k = 0u; k < event_count; k++) {
                if event_t[k] > passed {
                    t = min(t, event_t[k]);
                }
            }
            if t > known_until || t >= ENDLESS {
                break;
            }
            for (var k = 0u; k < event_count; k++) {
                if event_t[k] == t {
                    toggle(first_node, k, true);
                }
            }
            let after = root_holds(first_node);
            if after != met.inside_before {
                let found = owner(first_node, t, after);
                met.t = t;
                met.piece = event_piece[found] & 0x7fffffffu;
                met.entering = after;
                return met;
            }
            passed = t;
        }
        if is_marked || known_until >= before {
            return met;
        }
        passed = known_until;
        wanted *= 2u;
    }
    return met;
}

// Adds the crossings of a component, if they are among the first.
fn consider(component: u32, ray: Ray, reciprocal: vec3f, behind_t: f32) {
    let met = visit(component, ray, reciprocal, behind_t, together_t);
    if met.inside_before {
        if start_count < MOST_AT_START {
            var at = start_count;
            for (; at > 0u; at--) {
                if start[at - 1u] < component {
                    break;
                }
                start[at] = start[at - 1u];
            }
            start[at] = component;
            start_count++;
        } else {
            is_marked = true;
        }
    }
    if met.t >= ENDLESS || met.t > together_t {
        return;
    }
    if met.t < together_t {
        together_t = met.t;
        together_count = 0u;
    }
    if together_count == MOST_TOGETHER {
        is_marked = true;
        return;
    }
    var at = together_count;
    for (; at > 0u; at--) {
        if together[at - 1u] < component {
            break;
        }
        together[at] = together[at - 1u];
        together_piece[at] = together_piece[at - 1u];
        together_enters[at] = together_enters[at - 1u];
    }
    together[at] = component;
    together_piece[at] = met.piece;
    together_enters[at] = met.entering;
    together_count++;
}

// Reduces the crossings of components to those of solids, one for each solid.
fn keep_solids() {
    var kept = 0u;
    var at = 0u;
    while at < together_count {
        let solid = components[together[at]].solid;
        var before = 0u;
        for (var k = 0u; k < start_count; k++) {
            before += select(0u, 1u, components[start[k]].solid == solid);
        }
        var after = before;
        var end = at;
        while end < together_count {
            if components[together[end]].solid != solid {
                break;
            }
            after = select(after - 1u, after + 1u, together_enters[end]);
            end++;
        }
        if (before > 0u) != (after > 0u) {
            let enters = after > 0u;
            var found = at;
            for (var k = end; k > at; k--) {
                if together_enters[k - 1u] == enters {
                    found = k - 1u;
                }
            }
            together[kept] = together[found];
            together_piece[kept] = together_piece[found];
            together_enters[kept] = enters;
            kept++;
        }
        at = end;
    }
    together_count = kept;
}

// Returns the first point after `behind_t` and before `before` at which the ray crosses components.
fn next_crossing(ray: Ray, behind_t: f32, before: f32) {
    let reciprocal = reciprocal_of(ray.direction);
    start_count = 0u;
    together_count = 0u;
    together_t = before;
    var waiting: array<u32, MOST_BOXES>;
    waiting[0] = 0u;
    var waiting_count = min(trace.boxes, 1u);
    // The components to be considered: first the unbounded ones, then those of one box after another.
    var place = trace.order_at;
    var end = trace.order_at + trace.endless;
    loop {
        if place < end {
            consider(words[place], ray, reciprocal, behind_t);
            place++;
            continue;
        }
        if waiting_count == 0u {
            break;
        }
        waiting_count--;
        let id = waiting[waiting_count];
        let part = part_within(boxes[id].lower, boxes[id].upper, ray.origin, reciprocal);
        if part.x > part.y || part.y < behind_t || part.x > together_t {
            continue;
        }
        if boxes[id].count > 0u {
            place = trace.order_at + boxes[id].place;
            end = place + boxes[id].count;
            continue;
        }
        if waiting_count + 2u > MOST_BOXES {
            is_marked = true;
            break;
        }
        // The child whose centre comes first is visited first.
        let first = id + 1u;
        let second = boxes[id].place;
        let apart = (boxes[second].lower + boxes[second].upper)
            - (boxes[first].lower + boxes[first].upper);
        let swapped = dot(apart, ray.direction) < 0.0;
        waiting[waiting_count] = select(second, first, swapped);
        waiting[waiting_count + 1u] = select(first, second, swapped);
        waiting_count += 2u;
    }
    // A crossing exactly at the end does not count.
    if together_t >= before {
        together_count = 0u;
        together_t = ENDLESS;
    }
    keep_solids();
}

fn is_seen(k: u32) -> bool {
    let sides = leaves[pieces[together_piece[k]].leaf].sides;
    return sides == SIDES_BOTH || (sides == SIDES_OUTER && together_enters[k]);
}

fn material_of(k: u32) -> u32 {
    return leaves[pieces[together_piece[k]].leaf].material;
}

// The first of the crossings that is opaque, else the first.
fn seen_first() -> u32 {
    var first = NONE;
    var opaque = NONE;
    var count = 0u;
    var varies = 0u;
    for (var k = 0u; k < together_count; k++) {
        if is_seen(k) {
            let material = material_of(k);
            first = min(first, k);
            if materials[material].glass == 0.0 {
                opaque = min(opaque, k);
            }
            count++;
            varies |= materials[material].varies & VARIES_THROUGH;
        }
    }
    if count > 1u && varies != 0u {
        is_marked = true;
    }
    return select(opaque, first, opaque == NONE);
}

// Returns the normal of a crossing, on the side of the ray's start.
fn normal_at(piece: u32, ray: Ray, t: f32) -> vec3f {
    let leaf = pieces[piece].frame;
    let line = line_in(leaf, ray);
    let gradient = gradient_at(piece, line.point + place_of(line, t) * line.direction);
    let normal = gradient.x * leaves[leaf].row_x.xyz
        + gradient.y * leaves[leaf].row_y.xyz
        + gradient.z * leaves[leaf].row_z.xyz;
    let size = length(normal);
    if !(size > 0.0) {
        return -ray.direction;
    }
    let unit = normal / size;
    return select(unit, -unit, dot(unit, ray.direction) > 0.0);
}

// Returns the normal of a face that is turned by a height with this gradient.
fn turned(normal: vec3f, bump: vec3f) -> vec3f {
    let slope = bump - dot(normal, bump) * normal;
    let lit = normal - slope;
    let size = length(lit);
    if !(size > 0.0) {
        return normal;
    }
    return lit / size;
}

// Returns the error of a face's point.
fn slack_at(face: Face) -> f32 {
    let place = abs(face.position);
    return 2.0 * PLACE_ERROR * max(max(max(place.x, place.y), place.z), face.t);
}

fn ray_from(face: Face, direction: vec3f) -> Ray {
    return Ray(face.position, direction, pieces[face.piece].equation, slack_at(face));
}

// Returns the light on a face that arrives even if something blocks the light source.
fn ambient_light(light: Light, material: Material) -> vec3f {
    if trace.look == LOOK_CRT {
        return light.ambient * light.color * (1.0 - material.mirror);
    }
    return material.scattered * light.ambient * material.color * light.color;
}

// Returns the light on a face from a light that it sees.
fn seen_share(
    light: Light, towards: vec3f, face: Face, material: Material, direction: vec3f,
) -> vec3f {
    let height = dot(face.lit_normal, towards);
    var along = 0.0;
    if trace.look == LOOK_CRT {
        along = dot(towards - 2.0 * height * face.lit_normal, direction);
    } else {
        let between = towards - direction;
        along = dot(face.lit_normal, between) / max(length(between), 1e-30);
    }
    let highlight = material.specular * share_power(max(along, 0.0), material.shininess);
    if trace.look == LOOK_CRT {
        return material.color
            * (material.scattered * height * light.color + highlight * light.highlight);
    }
    return material.scattered * height * material.color * light.color + highlight * light.highlight;
}

// Returns the light of the background: a table over the height of the direction, from −1 to 1.
fn sky(direction: vec3f) -> vec3f {
    let at = clamp(0.5 + 0.5 * direction.z, 0.0, 1.0) * f32(trace.sky_cells);
    let cell = min(u32(at), trace.sky_cells - 1u);
    let share = at - f32(cell);
    let word = trace.sky_at + 3u * cell;
    let a = vec3f(
        bitcast<f32>(words[word]), bitcast<f32>(words[word + 1u]), bitcast<f32>(words[word + 2u]),
    );
    let b = vec3f(
        bitcast<f32>(words[word + 3u]), bitcast<f32>(words[word + 4u]), bitcast<f32>(words[word + 5u]),
    );
    return a + share * (b - a);
}

fn index_of(path: Path) -> f32 {
    if path.media_count == 0u {
        return 1.0;
    }
    return components[path.media[path.media_count - 1u].component].ior;
}

// The path with the glass behind the crossings that are met; the face of one of them, or of none, has this colour.
fn beyond(path: Path, found: u32, found_color: vec3f) -> Path {
    var next = path;
    for (var k = 0u; k < together_count; k++) {
        let component = together[k];
        let solid = components[component].solid;
        var kept = 0u;
        for (var j = 0u; j < next.media_count; j++) {
            let medium = next.media[j];
            if components[medium.component].solid != solid {
                next.media[kept] = medium;
                kept++;
            }
        }
        next.media_count = kept;
        if together_enters[k] && components[component].glass != NONE {
            if kept == MOST_MEDIA {
                is_marked = true;
                return next;
            }
            var at = kept;
            for (; at > 0u; at--) {
                if components[next.media[at - 1u].component].solid < solid {
                    break;
                }
                next.media[at] = next.media[at - 1u];
            }
            var color = found_color;
            if k != found {
                let material = material_of(k);
                color = materials[material].color;
                if (materials[material].varies & VARIES_COLOR) != 0u {
                    is_marked = true;
                }
            }
            next.media[at] = Medium(component, color);
            next.media_count = kept + 1u;
        }
    }
    return next;
}

// The share of light that is left after a way of this length within the last glass around a path.
fn kept(path: Path, length: f32) -> vec3f {
    if path.media_count == 0u {
        return vec3f(1.0);
    }
    let medium = path.media[path.media_count - 1u];
    if all(medium.color == vec3f(1.0)) {
        return vec3f(1.0);
    }
    let exponent = length / components[medium.component].depth;
    return vec3f(
        share_power(medium.color.x, exponent),
        share_power(medium.color.y, exponent),
        share_power(medium.color.z, exponent),
    );
}

// The glass around the start of a ray from the eye.
fn media_at_start(path: ptr<function, Path>) {
    for (var k = 0u; k < start_count; k++) {
        let component = start[k];
        let glass = components[component].glass;
        if glass == NONE {
            continue;
        }
        let count = (*path).media_count;
        if count > 0u {
            let last = (*path).media[count - 1u].component;
            if components[last].solid == components[component].solid {
                continue;
            }
        }
        if count == MOST_MEDIA {
            is_marked = true;
            return;
        }
        if (materials[glass].varies & VARIES_COLOR) != 0u {
            is_marked = true;
            return;
        }
        (*path).media[count] = Medium(component, materials[glass].color);
        (*path).media_count = count + 1u;
    }
}

// Adds a path that continues another one, or the background if the path ends. Returns the light of the latter.
fn go_on(next: Path) -> vec3f {
    if next.weight < trace.least_weight {
        return vec3f(0.0);
    }
    if next.bounces == 0u {
        if trace.look == LOOK_CRT {
            return vec3f(0.0);
        }
        return next.share * sky(next.ray.direction);
    }
    if path_count == MOST_PATHS {
        is_marked = true;
        return vec3f(0.0);
    }
    paths[path_count] = next;
    paths[path_count].bounces--;
    path_count++;
    return vec3f(0.0);
}

// The face that a path meets.
fn meet(path: Path, found: u32) -> Face {
    var face: Face;
    face.t = together_t;
    face.piece = together_piece[found];
    face.position = path.ray.origin + face.t * path.ray.direction;
    face.normal = normal_at(face.piece, path.ray, face.t);
    face.lit_normal = face.normal;
    return face;
}

// Goes on from a face along what it reflects and what it lets through, with the glass behind it around `inner`.
fn part(path: Path, face: Face, material: Material, inner: Path) -> vec3f {
    var out = vec3f(0.0);
    var mirror = material.mirror;
    var next = path;
    next.length = path.length + face.t;
    if material.glass > 0.0 {
        var behind = inner;
        behind.length = next.length;
        let n1 = index_of(path);
        let n2 = index_of(behind);
        let cosine = clamp(-dot(face.lit_normal, path.ray.direction), 0.0, 1.0);
        let reflects = fresnel(cosine, n1, n2);
        mirror += material.glass * reflects;
        let bent = refracted(path.ray.direction, face.lit_normal, n1, n2);
        let through = material.glass * (1.0 - reflects);
        if bent.passes && through != 0.0 {
            behind.ray = ray_from(face, bent.direction);
            behind.share = path.share * through;
            behind.weight = path.weight * through;
            out += go_on(behind);
        }
    }
    if any(mirror != vec3f(0.0)) {
        let direction = path.ray.direction;
        var away = direction - 2.0 * dot(face.lit_normal, direction) * face.lit_normal;
        // It points into the true face: reflect it at that face, too.
        away -= 2.0 * min(dot(face.normal, away), 0.0) * face.normal;
        next.ray = ray_from(face, normalize(away));
        next.share = path.share * mirror;
        next.weight = path.weight * max(max(mirror.x, mirror.y), mirror.z);
        out += go_on(next);
    }
    return out;
}

// Returns the light of a sample: casts rays along paths and, from each face that a path meets, rays to the lights. Drivers
// inline a function wherever it is called, so all rays are cast at one point in the code.
fn sample_light(pixel: vec2u, sample: u32) -> vec3f {
    let place = sample_place(trace.lens, pixel, sample);
    let eye = lens_ray(trace.lens, pixel, place);
    path_count = 1u;
    paths[0].ray = Ray(eye.origin, eye.direction, NONE, 0.0);
    paths[0].share = vec3f(1.0);
    paths[0].weight = 1.0;
    paths[0].length = 0.0;
    paths[0].bounces = trace.bounces;
    paths[0].media_count = 0u;
    var out = vec3f(0.0);
    var path: Path;
    var face: Face;
    var material: Material;
    var ray: Ray;
    var before = ENDLESS;
    // The light to which the ray leads; NONE for a ray of the path itself.
    var light = NONE;
    var towards = vec3f(0.0);
    // The share of its light that comes there, and the glass on the way to it.
    var share = vec3f(0.0);
    var inner: Path;
    var behind_t = 0.0;
    var passed = 0u;
    var is_done = true;
    loop {
        if is_done {
            if path_count == 0u {
                break;
            }
            path_count--;
            path = paths[path_count];
            ray = path.ray;
            before = ENDLESS;
            light = NONE;
            behind_t = 0.0;
            passed = 0u;
            is_done = false;
        }
        together_t = ENDLESS;
        if before > 0.0 {
            next_crossing(ray, behind_t, before);
        }
        passed++;
        if passed > MOST_PASSED {
            is_marked = true;
        }
        if passed == 1u && ray.leaving == NONE {
            media_at_start(&path);
        }
        if is_marked {
            break;
        }
        let is_path = light == NONE;
        var found = NONE;
        if is_path && together_t < ENDLESS {
            found = seen_first();
            if found == NONE {
                behind_t = together_t;
                continue;
            }
        }
        if is_path {
            inner = path;
        }
        // What the glass on the way leaves.
        let way = min(together_t, before) - select(behind_t, 0.0, is_path);
        let left = kept(inner, way);
        behind_t = together_t;
        var enters = false;
        if is_path {
            path.share *= left;
            if together_t >= ENDLESS {
                out += path.share * sky(path.ray.direction);
                is_done = true;
                continue;
            }
            face = meet(path, found);
            material = materials[leaves[pieces[face.piece].leaf].material];
            if material.varies != 0u {
                let varied = varied_look(material, face.position, slack_at(face));
                material = varied.material;
                if any(varied.bump != vec3f(0.0)) {
                    let bump = select(-varied.bump, varied.bump, together_enters[found]);
                    face.lit_normal = turned(face.normal, bump);
                }
            }
            enters = material.glass > 0.0;
        } else {
            share *= left;
            if together_t < ENDLESS {
                for (var k = 0u; k < together_count; k++) {
                    if is_seen(k) {
                        let other = material_of(k);
                        share *= materials[other].glass;
                        if (materials[other].varies & VARIES_THROUGH) != 0u {
                            is_marked = true;
                        }
                    }
                }
                enters = any(share != vec3f(0.0));
            }
        }
        if enters {
            inner = beyond(inner, found, material.color);
        }
        if is_path {
            out += part(path, face, material, inner);
            light = 0u;
        } else {
            if enters {
                continue;
            }
            out += path.share * share
                * seen_share(lights[light], towards, face, material, path.ray.direction);
            light++;
        }
        // The next light from which something may shade the face.
        is_done = true;
        while light < trace.light_count {
            out += path.share * ambient_light(lights[light], material);
            let is_crt = trace.look == LOOK_CRT;
            let way = select(0.0, path.length + face.t, is_crt);
            let seen = seen_light(lights[light], face.position, place.light, way);
            if dot(face.lit_normal, seen.towards) > 0.0 && seen.share > 0.0 {
                towards = seen.towards;
                share = vec3f(seen.share);
                inner = path;
                before = seen.distance;
                if is_crt && before >= ENDLESS {
                    before = PARALLEL_REACH;
                }
                is_done = false;
                break;
            }
            light++;
        }
        if !is_done {
            ray = ray_from(face, towards);
            behind_t = 0.0;
            passed = 0u;
            if lights[light].casts_shadows == 0u {
                // Nothing can block it.
                before = 0.0;
            }
        }
    }
    return out;
}

// Returns true if loops have been cut short. A driver may end all loops of an invocation after a maximum number of
// iterations, including those of this function: lavapipe does after 65,535.
fn is_cut() -> bool {
    let rounds = 3u * trace.one;
    var passed = 0u;
    while passed < rounds {
        passed += trace.one;
    }
    return passed < rounds;
}

@compute @workgroup_size(8, 8)
fn trace_scene(@builtin(global_invocation_id) at: vec3u) {
    if at.x >= trace.lens.size.x || at.y >= trace.rows {
        return;
    }
    let pixel = vec2u(at.x, trace.first_row + at.y);
    let place = (pixel.y - trace.slab_row) * trace.lens.size.x + pixel.x;
    var sum = vec4f(0.0);
    if trace.bit != 1u {
        sum = sums[place];
    }
    is_marked = false;
    let light = sample_light(pixel, trace.sample);
    // False for NaN.
    let is_light = all(light >= vec3f(0.0)) && all(light < vec3f(ENDLESS));
    if is_marked || !is_light || is_cut() {
        // The bits as a number: their pattern could be a NaN.
        sum.w += f32(trace.bit);
    } else {
        sum += vec4f(light, 0.0);
    }
    sums[place] = sum;
}
