// The sign changes of polynomials along a line: crates/tracer/src/line.rs, surface.rs and roots.rs in f32.

// A line in the frame of a leaf, from its point nearest to the frame's centre.
struct FrameLine {
    point: vec3f,
    direction: vec3f,
    // The t of that point.
    middle: f32,
    // The length in the frame of one unit of t.
    speed: f32,
}

// Coefficients, the constant first.
struct Coefficients {
    terms: array<f32, 5>,
    degree: u32,
}

struct SignChanges {
    // In ascending order, in the order of t.
    places: array<f32, 4>,
    count: u32,
    // True if the polynomial is not positive before the first of them.
    inside_first: bool,
}

// Polynomials of degree three or higher are evaluated within this distance of the centre of their frame.
const FRAME_REACH: f32 = 2.0;
const NEWTON_STEPS: u32 = 40u;

fn place_of(line: FrameLine, t: f32) -> f32 {
    return (t - line.middle) * line.speed;
}

fn t_of(line: FrameLine, place: f32) -> f32 {
    return line.middle + place / line.speed;
}

fn push_place(changes: ptr<function, SignChanges>, place: f32) {
    let count = (*changes).count;
    if count < 4u {
        (*changes).places[count] = place;
        (*changes).count = count + 1u;
    }
}

// Returns the changes of c + b·s + a·s².
fn quadratic_changes(c: f32, b: f32, a: f32) -> SignChanges {
    var changes: SignChanges;
    changes.count = 0u;
    var lead = a;
    if lead == 0.0 {
        lead = -b;
    }
    if lead == 0.0 {
        lead = c;
    }
    changes.inside_first = lead < 0.0 || (a == 0.0 && b == 0.0 && c == 0.0);
    if a == 0.0 {
        if b != 0.0 {
            push_place(&changes, -c / b);
        }
        return changes;
    }
    let discriminant = b * b - 4.0 * a * c;
    if discriminant > 0.0 {
        let root = sqrt(discriminant);
        let q = -0.5 * (b + select(root, -root, b < 0.0));
        let s = q / a;
        let r = c / q;
        push_place(&changes, min(s, r));
        push_place(&changes, max(s, r));
    }
    return changes;
}

// Returns the polynomial divided by s − root without the remainder; the division starts at the end that is stable.
fn deflated(p: Coefficients, root: f32) -> Coefficients {
    var quotient: Coefficients;
    quotient.degree = max(p.degree, 1u) - 1u;
    var carried = 0.0;
    if abs(root) <= 1.0 {
        for (var k = p.degree; k >= 1u; k--) {
            carried = p.terms[k] + carried * root;
            quotient.terms[k - 1u] = carried;
        }
    } else {
        for (var k = 0u; k < p.degree; k++) {
            carried = (carried - p.terms[k]) / root;
            quotient.terms[k] = carried;
        }
    }
    return quotient;
}

fn derivative_of(p: Coefficients, order: u32) -> Coefficients {
    var slope = p;
    for (var n = 0u; n < order; n++) {
        for (var k = 1u; k <= slope.degree; k++) {
            slope.terms[k - 1u] = f32(k) * slope.terms[k];
        }
        slope.terms[slope.degree] = 0.0;
        slope.degree--;
    }
    return slope;
}

fn value_at(p: Coefficients, s: f32) -> f32 {
    var sum = 0.0;
    for (var k = 0u; k <= p.degree; k++) {
        sum = sum * s + p.terms[p.degree - k];
    }
    return sum;
}

// Returns the root between two points with different signs: Newton's method within the bracket.
fn root_between(p: Coefficients, low: f32, to: f32, inside_from: bool) -> f32 {
    var a = low;
    var b = to;
    var s = 0.5 * (a + b);
    for (var step = 0u; step < NEWTON_STEPS; step++) {
        var y = 0.0;
        var slope = 0.0;
        for (var k = 0u; k <= p.degree; k++) {
            slope = slope * s + y;
            y = y * s + p.terms[p.degree - k];
        }
        if (y <= 0.0) == inside_from {
            a = s;
        } else {
            b = s;
        }
        var next = s - y / slope;
        if !(next > a && next < b) {
            next = 0.5 * (a + b);
        }
        let moved = abs(next - s);
        s = next;
        if moved <= 1.2e-7 * max(abs(s), 1e-2) {
            break;
        }
    }
    return s;
}

// Returns the changes of a polynomial within the frame's reach, from the changes of its derivative there.
fn changes_from(p: Coefficients, critical: SignChanges) -> SignChanges {
    var changes: SignChanges;
    changes.count = 0u;
    var a = -FRAME_REACH;
    var inside = value_at(p, a) <= 0.0;
    changes.inside_first = inside;
    for (var k = 0u; k <= critical.count; k++) {
        var b = FRAME_REACH;
        if k < critical.count {
            b = critical.places[k];
            if !(b > -FRAME_REACH && b < FRAME_REACH) {
                continue;
            }
        }
        let inside_b = value_at(p, b) <= 0.0;
        if inside != inside_b {
            push_place(&changes, root_between(p, a, b, inside));
        }
        a = b;
        inside = inside_b;
    }
    return changes;
}

// Returns the changes of a quadratic polynomial anywhere, of a higher one within the frame's reach: each is between two of
// its derivative's.
fn sign_changes(p: Coefficients) -> SignChanges {
    let above = max(p.degree, 2u) - 2u;
    let low = derivative_of(p, above);
    var changes = quadratic_changes(low.terms[0], low.terms[1], low.terms[2]);
    for (var k = 1u; k <= above; k++) {
        changes = changes_from(derivative_of(p, above - k), changes);
    }
    return changes;
}

// Returns true if the polynomial is not positive immediately after `place`.
fn inside_after(changes: SignChanges, place: f32) -> bool {
    var inside = changes.inside_first;
    for (var k = 0u; k < changes.count; k++) {
        if changes.places[k] <= place {
            inside = !inside;
        }
    }
    return inside;
}
