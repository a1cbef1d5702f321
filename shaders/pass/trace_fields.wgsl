// The part of the pass of traced pictures for pieces that fields bound, which are not polynomials or have a high degree: the
// points where a field changes its sign along a ray, found as in crates/tracer/src/field.rs. A part of the ray on which the
// field's range excludes 0 has none, one on which that of its slope does has at most one, and any other is halved. A part
// that stays open marks the sample.
//
// The words of a field: the number of its function; in its coordinates the centre of its frame, and half the sides; its
// numbers.

const FIELD_HEAD: u32 = 7u;
const MOST_HALVINGS: u32 = 22u;
// The maximum number of evaluations for a sample.
const MOST_EVALUATIONS: u32 = 12000u;
// The relative error of a gradient, and the error of a change as a fraction of half the frame.
const GRADIENT_ERROR: f32 = 2e-3;
const CHANGE_ERROR: f32 = 1e-3;

// The next step of the search: the sign of the field at the start of the ray, its range on a part of the ray, its value at
// the centre of a part whose slopes are known, its value at a point between the ends of a part on which it changes once.
const FIELD_BEGIN: u32 = 0u;
const FIELD_PART: u32 = 1u;
const FIELD_MIDDLE: u32 = 2u;
const FIELD_ROOT: u32 = 3u;

// A line in the coordinates of a field.
struct FieldLine {
    word: u32,
    point: vec3f,
    direction: vec3f,
    // The magnitudes of the summands of the point.
    size: vec3f,
}

var<private> evaluations: u32;

fn field_vector(word: u32) -> vec3f {
    return vec3f(bitcast<f32>(words[word]), bitcast<f32>(words[word + 1u]), bitcast<f32>(words[word + 2u]));
}

fn field_line(piece: u32, line: FrameLine) -> FieldLine {
    let word = pieces[piece].terms;
    let middle = field_vector(word + 1u);
    let half = field_vector(word + 4u);
    let size = abs(middle) + abs(half * line.point);
    return FieldLine(word, middle + half * line.point, half * line.direction, size);
}

// Returns the values between two points of a line, and the slopes along it.
fn field_along(line: FieldLine, a: f32, b: f32) -> Range {
    let at_a = line.point + a * line.direction;
    let at_b = line.point + b * line.direction;
    let slack = RANGE_ROUNDING * abs(line.direction);
    let error = RANGE_ROUNDING * line.size + max(abs(a), abs(b)) * slack;
    let low = min(at_a, at_b) - error;
    let high = max(at_a, at_b) + error;
    let least = line.direction - slack;
    let most = line.direction + slack;
    return field_range(
        words[line.word],
        Range(vec2f(low.x, high.x), vec2f(least.x, most.x)),
        Range(vec2f(low.y, high.y), vec2f(least.y, most.y)),
        Range(vec2f(low.z, high.z), vec2f(least.z, most.z)),
        line.word + FIELD_HEAD,
    );
}

// Reads a piece: its membership where the ray reaches it after `behind_t`, and its events after that. The results do not
// depend on `behind_t`, so that no event is found twice.
fn read_field(piece: u32, line: FrameLine, ray: Ray, part: vec2f, behind_t: f32) -> bool {
    let field = field_line(piece, line);
    let opposite = pieces[piece].kind >= OPPOSITE_PIECE;
    let begin = max(part.x, behind_t);
    // True until the surface that the ray leaves is known to be behind it.
    var is_leaving = pieces[piece].equation == ray.leaving && part.x <= ray.slack;
    let starts_within = behind_t == 0.0 && part.x <= 0.0;
    let first = place_of(line, select(max(part.x, 0.0), 0.0, is_leaving));
    var width = place_of(line, part.y) - first;
    var index = 0u;
    var halvings = 0u;
    // The membership immediately after the finished part, and immediately after `begin`.
    var inside = false;
    var inside_first = false;
    var found = 0u;
    var next = FIELD_BEGIN;
    var a = first;
    var b = first;
    if is_leaving {
        next = FIELD_PART;
        b = first + width;
    } else if starts_within {
        a -= ray.slack * line.speed;
        b += ray.slack * line.speed;
    }
    // The part, then the bracket of the change in it.
    var low = first;
    var high = first + width;
    var tries = 0u;
    // The maximum difference of the field on a part from its value at the centre.
    var reach = 0.0;
    loop {
        evaluations++;
        if evaluations > MOST_EVALUATIONS {
            is_marked = true;
        }
        if is_marked {
            break;
        }
        let range = field_along(field, a, b);
        let value = 0.5 * (range.value.x + range.value.y);
        var change = ENDLESS;
        if next == FIELD_BEGIN {
            inside = value <= 0.0;
            inside_first = inside;
            if starts_within && has_zero(range.value) {
                // This close to the start, only f64 determines the side of the surface.
                is_marked = true;
            }
            next = FIELD_PART;
            a = low;
            b = high;
            continue;
        } else if next != FIELD_ROOT {
            let values = range.value + vec2f(-reach, reach);
            let is_part = next == FIELD_PART;
            let is_monotone = is_part && !has_zero(range.slope);
            if is_leaving && is_monotone {
                inside = range.slope.y < 0.0;
                inside_first = inside;
                is_leaving = false;
            } else if !is_leaving && !has_zero(values) {
                if (value <= 0.0) != inside {
                    // The common point of this part and the previous one.
                    change = low;
                }
            } else if is_monotone {
                next = FIELD_ROOT;
                a = b;
                tries = 0u;
                continue;
            } else {
                reach = 0.5000001 * width * max(-range.slope.x, range.slope.y);
                if is_part && !is_leaving && 2.0 * reach < range.value.y - range.value.x {
                    // This narrows the range of values.
                    next = FIELD_MIDDLE;
                    a = 0.5 * (low + high);
                    b = a;
                    continue;
                }
                if halvings == MOST_HALVINGS {
                    is_marked = true;
                }
                index *= 2u;
                halvings++;
                width *= 0.5;
                low = first + width * f32(index);
                high = first + width * f32(index + 1u);
                next = FIELD_PART;
                a = low;
                b = high;
                reach = 0.0;
                continue;
            }
        } else if tries > 0u || (value <= 0.0) != inside {
            // Newton's method within the bracket.
            if (value <= 0.0) == inside {
                low = a;
            } else {
                high = a;
            }
            var place = a - 2.0 * value / (range.slope.x + range.slope.y);
            if !(place > low && place < high) {
                place = 0.5 * (low + high);
            }
            let moved = abs(place - a);
            tries++;
            if moved > 1.2e-7 * max(abs(place), 1e-2) && tries < NEWTON_STEPS {
                a = place;
                b = place;
                continue;
            }
            if !(range.value.y - range.value.x <= CHANGE_ERROR * abs(range.slope.x + range.slope.y)) {
                is_marked = true;
            }
            change = place;
        }
        // The part is finished.
        if change < ENDLESS {
            inside = !inside;
            let t = t_of(line, change);
            if t <= begin {
                inside_first = inside;
            } else if t <= part.y {
                add_event(piece, t, inside != opposite);
                found++;
                if found == wanted {
                    known_until = min(known_until, t);
                    break;
                }
            }
        }
        index++;
        let up = min(countTrailingZeros(index), halvings);
        index >>= up;
        halvings -= up;
        width *= f32(1u << up);
        next = FIELD_PART;
        low = first + width * f32(index);
        high = first + width * f32(index + 1u);
        a = low;
        b = high;
        reach = 0.0;
        if halvings == 0u || t_of(line, a) > known_until {
            break;
        }
    }
    return inside_first != opposite;
}

// Returns the gradient at a point of the frame.
fn field_gradient(piece: u32, at: vec3f) -> vec3f {
    let word = pieces[piece].terms;
    let middle = field_vector(word + 1u);
    let half = field_vector(word + 4u);
    let place = middle + half * at;
    let error = RANGE_ROUNDING * (abs(middle) + abs(half * at));
    var gradient = vec3f(0.0);
    var spread = vec3f(0.0);
    for (var k = 0u; k < 3u; k++) {
        let slope = vec3f(f32(k == 0u), f32(k == 1u), f32(k == 2u));
        let range = field_range(
            words[word],
            Range(vec2f(place.x - error.x, place.x + error.x), vec2f(slope.x)),
            Range(vec2f(place.y - error.y, place.y + error.y), vec2f(slope.y)),
            Range(vec2f(place.z - error.z, place.z + error.z), vec2f(slope.z)),
            word + FIELD_HEAD,
        );
        gradient[k] = 0.5 * (range.slope.x + range.slope.y) * half[k];
        spread[k] = 0.5 * (range.slope.y - range.slope.x) * half[k];
    }
    if !(length(spread) <= GRADIENT_ERROR * length(gradient)) {
        is_marked = true;
    }
    return gradient;
}
