//! Elementary functions over lanes against `std`, whose results are within a unit in the last place of the truth.

use expr::elementary::{self, LARGEST_ANGLE};
use proptest::prelude::Rng;
use proptest::test_runner::{RngAlgorithm, TestRng};

/// How far apart two numbers are, in units in the last place of the second.
fn distance(a: f64, b: f64) -> f64 {
    if a == b || a.is_nan() && b.is_nan() {
        return 0.0;
    }
    let unit = (b.abs().next_up() - b.abs()).max(f64::from_bits(1));
    (a - b).abs() / unit
}

/// Seeded arguments: uniform in a range, or of every exponent.
struct Arguments(TestRng);

impl Arguments {
    fn new() -> Self {
        Self(TestRng::deterministic_rng(RngAlgorithm::ChaCha))
    }

    fn share(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    fn of_any_size(&mut self) -> f64 {
        f64::from_bits(self.0.next_u64())
    }
}

/// The greatest distance over many arguments, and a check that it is within bounds.
#[track_caller]
fn check(
    what: &str,
    bound: f64,
    arguments: &[f64],
    f: impl Fn(f64) -> f64,
    g: impl Fn(f64) -> f64,
) {
    let error = |x| {
        let error = distance(f(x), g(x));
        assert!(!error.is_nan(), "{what}({x:?}): {:?}, not {:?}", f(x), g(x));
        error
    };
    check_errors(what, bound, arguments, error);
}

/// The greatest of the errors at many arguments, and a check that it is within bounds.
#[track_caller]
fn check_errors(what: &str, bound: f64, arguments: &[f64], error: impl Fn(f64) -> f64) {
    let mut worst = (0.0, f64::NAN);
    for &x in arguments {
        let error = error(x);
        if error > worst.0 {
            worst = (error, x);
        }
    }
    println!("{what}: {worst:?}");
    assert!(
        worst.0 <= bound,
        "{what}({:?}) is off by {} units",
        worst.1,
        worst.0
    );
}

fn arguments(low: f64, high: f64) -> Vec<f64> {
    let mut random = Arguments::new();
    let mut all: Vec<f64> = (0..100_000).map(|_| random.within(low, high)).collect();
    all.extend((0..20_000).map(|_| random.within(-1.0, 1.0)));
    all.extend((0..50_000).map(|_| random.of_any_size()));
    all.extend([
        0.0,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
        f64::MAX,
        f64::MIN_POSITIVE,
        5e-324,
        1e-310,
        1.0,
        -1.0,
    ]);
    all
}

fn angles() -> Vec<f64> {
    let mut all = arguments(-40.0, 40.0);
    all.extend(arguments(-1.2 * LARGEST_ANGLE, 1.2 * LARGEST_ANGLE));
    // Beside multiples of a quarter turn, where almost nothing is left of the angle.
    for k in 0..65_000 {
        let x = f64::from(k) * std::f64::consts::FRAC_PI_2;
        all.extend([x, x.next_up(), x.next_down(), -x]);
    }
    all
}

#[test]
#[should_panic(expected = "off by")]
fn a_distance_can_be_too_large() {
    check(
        "bad",
        1.0,
        &[2.0],
        |x| x * (1.0 + 3.0 * f64::EPSILON),
        |x| x,
    );
}

#[test]
fn sine_and_cosine_are_those_of_std() {
    let angles = angles();
    check(
        "sin",
        1.0,
        &angles,
        |x| elementary::sin_cos(&[x]).0[0],
        f64::sin,
    );
    check(
        "cos",
        1.0,
        &angles,
        |x| elementary::sin_cos(&[x]).1[0],
        f64::cos,
    );
    check("tan", 3.0, &angles, |x| elementary::tan(&[x])[0], f64::tan);
}

#[test]
fn exponentials_are_those_of_std() {
    let mut all = arguments(-750.0, 720.0);
    all.extend([
        709.782712893384,
        709.7827128933841,
        -745.1332191019411,
        -745.2,
        -708.4,
    ]);
    check("exp", 1.0, &all, |x| elementary::exp(&[x])[0], f64::exp);
}

#[test]
fn logarithms_are_those_of_std() {
    let mut all = arguments(0.0, 4.0);
    all.extend(arguments(0.99, 1.01));
    check("log", 1.0, &all, |x| elementary::log(&[x])[0], f64::ln);
}

#[test]
fn hyperbolic_functions_are_those_of_std() {
    let mut all = arguments(-712.0, 712.0);
    all.extend(arguments(-25.0, 25.0));
    check(
        "sinh",
        2.0,
        &all,
        |x| elementary::sinh_cosh(&[x]).0[0],
        f64::sinh,
    );
    check(
        "cosh",
        2.0,
        &all,
        |x| elementary::sinh_cosh(&[x]).1[0],
        f64::cosh,
    );
    check("tanh", 3.0, &all, |x| elementary::tanh(&[x])[0], f64::tanh);
    let sech = |x: f64| 1.0 / x.cosh();
    check("sech", 3.0, &all, |x| elementary::sech(&[x])[0], sech);
}

#[test]
fn lanes_do_not_touch_each_other() {
    let x = [0.5, f64::NAN, 1e300, -3.0, f64::INFINITY, 0.0, -1e-320, 7e4];
    let (sin, cos) = elementary::sin_cos(&x);
    let (exp, log) = (elementary::exp(&x), elementary::log(&x));
    for lane in 0..x.len() {
        let one = [x[lane]];
        let same = |a: f64, b: f64| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan();
        assert!(same(sin[lane], elementary::sin_cos(&one).0[0]));
        assert!(same(cos[lane], elementary::sin_cos(&one).1[0]));
        assert!(same(exp[lane], elementary::exp(&one)[0]));
        assert!(same(log[lane], elementary::log(&one)[0]));
    }
}
