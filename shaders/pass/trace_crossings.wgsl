// The crossings of a ray with the solids of a traced scene, as in crates/tracer/src/cast.rs: those that come first, and what
// contains the start of the ray.

// The maximum sizes of the lists of a ray.
const MOST_NODES: u32 = 128u;
const MOST_EVENTS: u32 = 64u;
const MOST_TOGETHER: u32 = 8u;
const MOST_AT_START: u32 = 16u;
const MOST_BOXES: u32 = 40u;
// The error of a point, as a fraction of its distances.
const PLACE_ERROR: f32 = 1e-6;

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
    let is_inside = inside_after(changes, begin) != (pieces[piece].kind >= OPPOSITE_PIECE);
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
