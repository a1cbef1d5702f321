// Ranges of expressions in f32: bounds of an expression's values on a part of a line, and of its slopes along it. They
// contain the results of f64: each operation widens its result by more than its rounding error, and a value that is
// undefined somewhere, or too large, becomes the range of everything. The operations have the names of those of expressions.

struct Range {
    // The minimum and the maximum.
    value: vec2f,
    slope: vec2f,
}

// The bound of the range of everything: products of two such numbers are still finite.
const RANGE_MOST: f32 = 1e18;
// The rounding errors of sums and products, and of quotients and roots; the error of angles.
const RANGE_ROUNDING: f32 = 2.4e-7;
const RANGE_QUOTIENT: f32 = 6e-7;
const RANGE_ANGLE: f32 = 4e-6;
const RANGE_LEAST: f32 = 1e-30;
// Sine and cosine of larger arguments may have any value.
const RANGE_WAVES: f32 = 1500.0;

fn everything() -> vec2f {
    return vec2f(-RANGE_MOST, RANGE_MOST);
}

fn has_zero(a: vec2f) -> bool {
    return a.x <= 0.0 && a.y >= 0.0;
}

fn is_point(a: vec2f) -> bool {
    return a.x == a.y;
}

// Returns the range, widened by a fraction of its ends.
fn widened(a: vec2f, share: f32) -> vec2f {
    let wide = a + vec2f(-1.0, 1.0) * (share * abs(a) + RANGE_LEAST);
    if wide.x > -RANGE_MOST && wide.y < RANGE_MOST {
        return wide;
    }
    return everything();
}

fn sum_of(a: vec2f, b: vec2f) -> vec2f {
    // As a fraction of the summands: they may cancel.
    let wide = RANGE_ROUNDING * max(abs(a), abs(b));
    return widened(a + b + vec2f(-wide.x, wide.y), RANGE_ROUNDING);
}

// Zero annihilates everything.
fn product_of(a: vec2f, b: vec2f) -> vec2f {
    let p = vec4f(a.x * b, a.y * b);
    return widened(vec2f(min(min(p.x, p.y), min(p.z, p.w)), max(max(p.x, p.y), max(p.z, p.w))), RANGE_ROUNDING);
}

fn square_of(a: vec2f) -> vec2f {
    let size = abs(a);
    let most = max(size.x, size.y);
    let least = select(min(size.x, size.y), 0.0, has_zero(a));
    return max(widened(vec2f(least * least, most * most), RANGE_ROUNDING), vec2f(0.0));
}

fn reciprocal_range(a: vec2f) -> vec2f {
    if a.x > 1.0 / RANGE_MOST || a.y < -1.0 / RANGE_MOST {
        return widened(1.0 / a.yx, RANGE_QUOTIENT);
    }
    return everything();
}

// Returns the slope of a function with these first derivatives.
fn chained(value: vec2f, first: vec2f, x: Range) -> Range {
    return Range(value, product_of(first, x.slope));
}

fn range_number(x: f32) -> Range {
    return Range(widened(vec2f(x), RANGE_ROUNDING), vec2f(0.0));
}

fn range_neg(a: Range) -> Range {
    return Range(-a.value.yx, -a.slope.yx);
}

fn range_add(a: Range, b: Range) -> Range {
    return Range(sum_of(a.value, b.value), sum_of(a.slope, b.slope));
}

fn range_sub(a: Range, b: Range) -> Range {
    return range_add(a, range_neg(b));
}

fn range_mul(a: Range, b: Range) -> Range {
    let slope = sum_of(product_of(a.slope, b.value), product_of(a.value, b.slope));
    return Range(product_of(a.value, b.value), slope);
}

fn range_square(a: Range) -> Range {
    return Range(square_of(a.value), 2.0 * product_of(a.value, a.slope));
}

fn range_zmul(a: Range, b: Range) -> Range {
    return range_mul(a, b);
}

fn range_div(a: Range, b: Range) -> Range {
    return range_mul(a, chained(reciprocal_range(b.value), -square_of(reciprocal_range(b.value)).yx, b));
}

// Returns the larger of two ranges, or, if neither is always larger, their union.
fn range_max(a: Range, b: Range) -> Range {
    if a.value.x >= b.value.y {
        return a;
    }
    if b.value.x > a.value.y {
        return b;
    }
    let slope = vec2f(min(a.slope.x, b.slope.x), max(a.slope.y, b.slope.y));
    return Range(max(a.value, b.value), slope);
}

fn range_min(a: Range, b: Range) -> Range {
    return range_neg(range_max(range_neg(a), range_neg(b)));
}

fn range_at_most(a: Range, b: Range) -> Range {
    if a.value.y <= b.value.x {
        return Range(vec2f(1.0), vec2f(0.0));
    }
    if a.value.x > b.value.y {
        return Range(vec2f(0.0), vec2f(0.0));
    }
    return Range(vec2f(0.0, 1.0), everything());
}

fn range_sign(a: Range) -> Range {
    if has_zero(a.value) {
        return Range(vec2f(-1.0, 1.0), everything());
    }
    return Range(sign(a.value), vec2f(0.0));
}

fn range_abs(a: Range) -> Range {
    if a.value.x >= 0.0 {
        return a;
    }
    if a.value.y <= 0.0 {
        return range_neg(a);
    }
    let steepest = max(abs(a.slope.x), abs(a.slope.y));
    let most = max(-a.value.x, a.value.y);
    return Range(vec2f(0.0, most), vec2f(-steepest, steepest));
}

// The root of a non-negative value may be rounded below 0.
fn root_of(a: vec2f) -> vec2f {
    if a.x < -1e-20 {
        return everything();
    }
    return max(widened(sqrt(max(a, vec2f(0.0))), RANGE_QUOTIENT), vec2f(0.0));
}

fn range_sqrt(a: Range) -> Range {
    let value = root_of(a.value);
    return chained(value, 0.5 * reciprocal_range(value), a);
}

fn exponential_of(a: vec2f) -> vec2f {
    if a.y > 41.0 {
        return everything();
    }
    let at = max(a, vec2f(-80.0));
    let value = exp(at);
    let slack = 1.2e-7 * (4.0 + 2.0 * abs(at)) * value;
    return vec2f(select(value.x - slack.x, 0.0, a.x < -80.0), value.y + slack.y + RANGE_LEAST);
}

fn range_exp(a: Range) -> Range {
    let value = exponential_of(a.value);
    return chained(value, value, a);
}

fn logarithm_of(a: vec2f) -> vec2f {
    if a.x <= RANGE_LEAST {
        return everything();
    }
    let value = log(a);
    return value + vec2f(-1.0, 1.0) * (6e-7 + RANGE_QUOTIENT * abs(value));
}

fn range_log(a: Range) -> Range {
    return chained(logarithm_of(a.value), reciprocal_range(a.value), a);
}

// Returns sine and cosine of a number that is not too large, with the same result on all drivers: whole turns are subtracted
// first, in steps that are exact in f32.
fn waves_at(x: f32) -> vec2f {
    let turns = round(x * 0.15915494);
    let angle = (x - turns * 6.28125) - turns * 0.0019353072;
    return vec2f(half_wave(angle), half_wave((1.57079637 - abs(angle)) - 4.371139e-8));
}

// Returns the sine of an angle from −π to π, by its series.
fn half_wave(angle: f32) -> f32 {
    var x = angle;
    if abs(angle) > 1.57079637 {
        x = sign(angle) * ((3.14159274 - abs(angle)) - 8.742278e-8);
    }
    let s = x * x;
    let tail = 8.333333e-3 + s * (-1.984127e-4 + s * (2.7557319e-6 + s * -2.5052108e-8));
    return x + x * s * (-0.16666667 + s * tail);
}

// Returns true if an angle of this part is `at`, modulo whole turns.
fn meets_angle(a: vec2f, at: f32) -> bool {
    let turns = (a - at) * 0.15915494;
    return floor(turns.y + 2e-4) >= ceil(turns.x - 2e-4);
}

// Returns the sine and the cosine.
fn range_waves(a: Range) -> array<Range, 2> {
    var sine = vec2f(-1.0, 1.0);
    var cosine = vec2f(-1.0, 1.0);
    if a.value.x > -RANGE_WAVES && a.value.y < RANGE_WAVES && a.value.y - a.value.x < 6.2 {
        let low = waves_at(a.value.x);
        let high = waves_at(a.value.y);
        let least = min(low, high) - 1e-6;
        let most = max(low, high) + 1e-6;
        sine.x = select(max(least.x, -1.0), -1.0, meets_angle(a.value, -1.5707964));
        sine.y = select(min(most.x, 1.0), 1.0, meets_angle(a.value, 1.5707964));
        cosine.x = select(max(least.y, -1.0), -1.0, meets_angle(a.value, 3.1415927));
        cosine.y = select(min(most.y, 1.0), 1.0, meets_angle(a.value, 0.0));
    }
    return array<Range, 2>(chained(sine, cosine, a), chained(cosine, -sine.yx, a));
}

fn range_sin(a: Range) -> Range {
    return range_waves(a)[0];
}

fn range_cos(a: Range) -> Range {
    return range_waves(a)[1];
}

fn range_tan(a: Range) -> Range {
    let both = range_waves(a);
    return range_div(both[0], both[1]);
}

// Returns the angle of a tangent, with the same result on all drivers: a series up to 1 (Abramowitz and Stegun, 4.4.49), and
// beyond 1 that of the reciprocal.
fn angle_of(tangent: f32) -> f32 {
    let is_steep = abs(tangent) > 1.0;
    let x = select(tangent, 1.0 / select(tangent, 1.0, abs(tangent) <= 1.0), is_steep);
    let s = x * x;
    let low = 1.0 + s * (-0.3333314528 + s * (0.1999355085 + s * (-0.1420889944 + s * 0.1065626393)));
    let high = -0.07528964 + s * (0.0429096138 + s * (-0.0161657367 + s * 0.0028662257));
    let s2 = s * s;
    let angle = x * (low + s2 * s2 * s * high);
    return select(angle, sign(tangent) * 1.5707963 - angle, is_steep);
}

fn range_atan(a: Range) -> Range {
    let value = vec2f(angle_of(a.value.x) - RANGE_ANGLE, angle_of(a.value.y) + RANGE_ANGLE);
    let first = reciprocal_range(sum_of(vec2f(1.0), square_of(a.value)));
    return chained(value, first, a);
}

fn half_angle_of(sine: f32) -> f32 {
    return angle_of(sine / (1.0 + sqrt((1.0 - sine) * (1.0 + sine))));
}

fn range_asin(a: Range) -> Range {
    if a.value.x < -1.0 || a.value.y > 1.0 {
        return Range(everything(), everything());
    }
    let value = 2.0 * vec2f(half_angle_of(a.value.x) - RANGE_ANGLE, half_angle_of(a.value.y) + RANGE_ANGLE);
    let square = sum_of(vec2f(1.0), -square_of(a.value).yx);
    return chained(value, reciprocal_range(root_of(max(square, vec2f(0.0)))), a);
}

fn range_acos(a: Range) -> Range {
    return range_sub(range_number(1.5707963), range_asin(a));
}

fn halved(a: Range) -> Range {
    return Range(0.5 * a.value, 0.5 * a.slope);
}

fn range_sinh(a: Range) -> Range {
    return halved(range_sub(range_exp(a), range_exp(range_neg(a))));
}

fn range_cosh(a: Range) -> Range {
    return halved(range_add(range_exp(a), range_exp(range_neg(a))));
}

fn range_tanh(a: Range) -> Range {
    let at = clamp(2.0 * a.value, vec2f(-40.0), vec2f(40.0));
    let part = 2.0 * reciprocal_range(sum_of(exponential_of(at), vec2f(1.0)));
    let value = sum_of(vec2f(1.0), -part.yx);
    let first = sum_of(vec2f(1.0), -square_of(value).yx);
    return chained(value, first, a);
}

fn range_sech(a: Range) -> Range {
    let size = abs(a.value);
    let most = max(size.x, size.y);
    let least = select(min(size.x, size.y), 0.0, has_zero(a.value));
    let part = exponential_of(vec2f(-most, -least));
    let value = widened(2.0 * part / (1.0 + part * part), 4.0 * RANGE_ROUNDING);
    let first = product_of(value, -range_tanh(a).value.yx);
    return chained(clamp(value, vec2f(0.0), vec2f(1.0)), first, a);
}

// Returns a^n for an integer n above 0.
fn whole_power_of(a: vec2f, n: u32) -> vec2f {
    let most = max(abs(a.x), abs(a.y));
    if most > 1.0 && f32(n) * log2(most) > 59.0 {
        return everything();
    }
    // Usually without a loop: drivers may count the iterations of all loops.
    let second = a * a;
    let fourth = second * second;
    let eighth = fourth * fourth;
    let one = vec2f(1.0);
    var power = select(one, a, (n & 1u) != 0u) * select(one, second, (n & 2u) != 0u);
    power *= select(one, fourth, (n & 4u) != 0u) * select(one, eighth, (n & 8u) != 0u);
    var square = eighth * eighth;
    var left = n >> 4u;
    while left != 0u {
        if (left & 1u) != 0u {
            power *= square;
        }
        square *= square;
        left >>= 1u;
    }
    var value = power;
    if (n & 1u) == 0u {
        value = vec2f(select(min(power.x, power.y), 0.0, has_zero(a)), max(power.x, power.y));
    }
    return widened(value, RANGE_ROUNDING * f32(n));
}

fn range_integer_power(a: Range, n: i32) -> Range {
    let size = u32(abs(n));
    if size == 0u {
        return Range(vec2f(1.0), vec2f(0.0));
    }
    var less = vec2f(1.0);
    if size > 1u {
        less = whole_power_of(a.value, size - 1u);
    }
    let first = product_of(vec2f(f32(size)), less);
    let power = chained(whole_power_of(a.value, size), first, a);
    if n > 0 {
        return power;
    }
    return range_div(Range(vec2f(1.0), vec2f(0.0)), power);
}

// Returns a^b for a non-negative a and a b above 0.
fn rising_power_of(a: vec2f, b: vec2f) -> vec2f {
    let least = vec2f(2.0 * RANGE_LEAST);
    let low = exponential_of(product_of(b, logarithm_of(max(a.xx, least))));
    let high = exponential_of(product_of(b, logarithm_of(max(a.yy, least))));
    return vec2f(select(low.x, 0.0, a.x <= least.x), high.y);
}

// Returns a power whose exponent is `exact` if it does not depend on the point.
fn range_power(a: Range, b: Range, exact: f32) -> Range {
    let is_exact = all(b.slope == vec2f(0.0));
    if is_exact && exact == trunc(exact) && abs(exact) <= 1000.0 {
        return range_integer_power(a, i32(exact));
    }
    if is_exact && exact > 0.0 && a.value.x >= 0.0 {
        // Also at 0, where the logarithm is undefined.
        let value = rising_power_of(a.value, b.value);
        var first = b.value;
        if exact > 1.0 {
            first = product_of(first, rising_power_of(a.value, sum_of(b.value, vec2f(-1.0))));
        } else {
            let less = sum_of(vec2f(1.0), -b.value.yx);
            first = product_of(first, reciprocal_range(rising_power_of(a.value, less)));
        }
        return chained(value, first, a);
    }
    return range_exp(range_mul(b, range_log(a)));
}
