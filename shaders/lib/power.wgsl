// Powers, products, comparisons and functions that WGSL lacks in f32, with the semantics of expressions.

// Returns x^n for an integer n by repeated squaring, with the same multiplications as in every other evaluator; 0^0 is 1, a
// negative exponent is the reciprocal of the positive power.
fn integer_power(x: f32, n: i32) -> f32 {
    var remaining = u32(abs(n));
    var square = x;
    var result = 1.0;
    while remaining != 0u {
        if (remaining & 1u) != 0u {
            result *= square;
        }
        square *= square;
        remaining >>= 1u;
    }
    if n < 0 {
        return 1.0 / result;
    }
    return result;
}

// Returns x^y. A negative base requires an exponent with an integer value; WGSL's own pow is undefined there. Integer
// exponents multiply up to 2^24, the limit to which f32 distinguishes them; beyond, f32 has even numbers only.
fn power(x: f32, y: f32) -> f32 {
    let is_integer = y == trunc(y);
    if is_integer && abs(y) <= 16777216.0 {
        return integer_power(x, i32(y));
    }
    if x > 0.0 {
        return pow(x, y);
    }
    if x == 0.0 {
        return select(infinite(1.0), 0.0, y > 0.0);
    }
    if is_integer {
        return pow(-x, y);
    }
    return undefined();
}

// Returns 1/cosh(x), without an infinity on the way.
fn sech(x: f32) -> f32 {
    let part = exp(-abs(x));
    return 2.0 * part / (1.0 + part * part);
}

// Returns the product that a zero first factor annihilates: 0 if a is 0, whatever b is.
fn zmul(a: f32, b: f32) -> f32 {
    if a == 0.0 {
        return 0.0;
    }
    return a * b;
}

// Returns the smaller of two numbers, the first if they are equal; undefined if one of them is.
fn least(a: f32, b: f32) -> f32 {
    if is_undefined(a) || is_undefined(b) {
        return undefined();
    }
    return select(b, a, a <= b);
}

// Returns the larger of two numbers, the first if they are equal; undefined if one of them is.
fn greatest(a: f32, b: f32) -> f32 {
    if is_undefined(a) || is_undefined(b) {
        return undefined();
    }
    return select(b, a, a >= b);
}

// Returns 1 if a <= b, otherwise 0; undefined if one of them is.
fn at_most(a: f32, b: f32) -> f32 {
    if is_undefined(a) || is_undefined(b) {
        return undefined();
    }
    return select(0.0, 1.0, a <= b);
}
