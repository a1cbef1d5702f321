//! Sets that polynomials bound against the sign of the expression that they are read from.

use expr::Input;
use expr::ops::Binary;
use expr::polynomial::{MOST_PIECES, Polynomial, Region, region};
use expr::tape::{Registers, Tape};

use crate::formula::{Formula, variables};

fn meaning(input: Input) -> Polynomial {
    match input {
        Input::Variable(k) => {
            let mut slopes = [0.0; 3];
            slopes[k as usize] = 1.0;
            Polynomial::linear(0.0, slopes)
        }
        Input::Uniform(_) => Polynomial::constant(0.75),
    }
}

fn read(f: &Formula) -> Region {
    region(&f.graph(), f.node(), &meaning).0
}

fn value(f: &Formula, node: expr::NodeId, at: [f64; 3]) -> f64 {
    let tape = Tape::new(&f.graph(), &[node]);
    let inputs: Vec<f64> = tape
        .inputs()
        .iter()
        .map(|input| match input {
            Input::Variable(k) => at[*k as usize],
            Input::Uniform(_) => 0.75,
        })
        .collect();
    let mut out = [0.0];
    tape.eval(&mut Registers::default(), &inputs, &mut out);
    out[0]
}

/// Membership, and the least distance of a value from zero that decided it.
fn contains(f: &Formula, region: &Region, at: [f64; 3]) -> (bool, f64) {
    match region {
        Region::Polynomial(p) => (p.at(at) <= 0.0, p.at(at).abs()),
        Region::Field(node, negated) => {
            let value = value(f, *node, at);
            let value = if *negated { -value } else { value };
            // What is undefined is far from any surface.
            let distance = if value.is_nan() {
                f64::INFINITY
            } else {
                value.abs()
            };
            (value <= 0.0, distance)
        }
        Region::All(parts) => parts
            .iter()
            .fold((true, f64::INFINITY), |(all, least), part| {
                let (inside, distance) = contains(f, part, at);
                (all && inside, least.min(distance))
            }),
        Region::Any(parts) => parts
            .iter()
            .fold((false, f64::INFINITY), |(any, least), part| {
                let (inside, distance) = contains(f, part, at);
                (any || inside, least.min(distance))
            }),
    }
}

/// Degrees of the polynomials, and the number of other expressions.
fn class(region: &Region, degrees: &mut Vec<usize>) -> usize {
    match region {
        Region::Polynomial(p) => {
            degrees.push(p.degree());
            0
        }
        Region::Field(..) => 1,
        Region::All(parts) | Region::Any(parts) => {
            parts.iter().map(|part| class(part, degrees)).sum()
        }
    }
}

#[test]
fn regions_are_where_the_expression_is_not_positive() {
    let [x, y, z] = &variables();
    let rr = &(x.squared() + y.squared());
    let gyroid = &(x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos());
    // A formula, the degrees of its polynomials, and the number of other expressions.
    let cases: Vec<(Formula, Vec<usize>, usize)> = vec![
        (rr + z.squared() - 1.0, vec![2], 0),
        (x.abs().max(&y.abs()).max(&z.abs()) - 0.5, vec![1; 6], 0),
        (x.abs() + y.abs() + z.abs() - 1.0, vec![1; 8], 0),
        // A torus by a root, and expanded.
        (
            (rr.sqrt() - 1.0).squared() + z.squared() - 0.1,
            vec![4, 2],
            0,
        ),
        ((rr + z.squared() + 0.9).squared() - 4.0 * rr, vec![4], 0),
        ((rr + z.squared()).sqrt() - 1.0, vec![2], 0),
        (rr.sqrt() + z.abs() - 1.0, vec![1, 1, 2, 2], 0),
        // Defined only where z ≥ 0.
        (z.sqrt() - x, vec![1, 1, 2], 0),
        (
            (x * y).sqrt() * x - 0.2 + z,
            [vec![1; 8], vec![4; 2]].concat(),
            0,
        ),
        (x.abs().squared() + y.squared() - 1.0, vec![2], 0),
        (
            x.abs().powi(3) + y.abs().powi(3) + z.abs() - 1.0,
            vec![3; 8],
            0,
        ),
        (x * y * z * 8.0, vec![3], 0),
        (rr.powi(6) - z.powi(5) - 0.5, vec![12], 0),
        (gyroid.clone(), vec![], 1),
        (gyroid.max(&(x.abs() - 2.0)), vec![1, 1], 1),
        (gyroid.min(&(rr - 1.0)), vec![2], 1),
        (gyroid * (rr - 1.0), vec![2, 2], 2),
        (-gyroid.max(&(z - 1.0)), vec![1], 1),
        // A number that is negative makes the greatest of a least.
        (x.min(y) * x.uniform() * -2.0 + 0.3, vec![1, 1], 0),
        (x.max(y) * x.uniform() * -2.0 - 0.3, vec![1, 1], 0),
        (x.min(y) * x.uniform() * 2.0 + 0.3, vec![1, 1], 0),
        (x.max(y) * x.uniform() * 2.0 - 0.3, vec![1, 1], 0),
        // Powers by a param, which is 0.75: a root where what is below it may be negative, a square, and one that is neither.
        (
            (rr + 0.0).binary(Binary::Pow, &(x.uniform() - 0.25)) - 1.0,
            vec![2, 2],
            0,
        ),
        (
            rr.binary(Binary::Pow, &(x.uniform() + 1.25)) - z,
            vec![4],
            0,
        ),
        (rr.binary(Binary::Pow, &x.uniform()) - z, vec![], 1),
        // min of what is not defined everywhere is left as it is.
        (x.sqrt().sin().min(&(rr - 1.0)), vec![], 1),
        (x.number(-1.0), vec![], 0),
        (x.number(f64::NAN), vec![], 0),
        // What holds nowhere, or everywhere, decides whatever is beside it.
        (x.max(&x.number(1.0)), vec![], 0),
        (x.max(&x.number(-1.0)), vec![1], 0),
        (x.min(&x.number(-1.0)), vec![], 0),
        (x.min(&x.number(1.0)), vec![1], 0),
        ((x - 1000.0).squared() - 999_000.0, vec![1, 1], 0),
        // Parallel planes, crossing ones, and quadrics that are neither.
        (x.squared() - 1.0, vec![1, 1], 0),
        (1.0 - x.squared(), vec![1, 1], 0),
        ((x - 1.0) * (x + 0.5), vec![1, 1], 0),
        ((x - 1.0) * (-0.5 - x), vec![1, 1], 0),
        (
            (0.6 * x + 0.8 * y + 0.1 * z - 0.3).squared() - 0.25,
            vec![1, 1],
            0,
        ),
        (x.squared() - y.squared(), vec![1; 4], 0),
        (0.25 * (y - 0.5).squared() - x.squared(), vec![1; 4], 0),
        (x * y, vec![1; 4], 0),
        (-0.5 * x * (y + z), vec![1; 4], 0),
        ((1e-6 * x + y) * x, vec![1; 4], 0),
        (x.squared() + 1.0, vec![2], 0),
        (-1.0 - x.squared(), vec![2], 0),
        (x.squared() + 2.0 * x * y + y.squared(), vec![2], 0),
        (x.squared() + y.squared(), vec![2], 0),
        (x.squared() - z, vec![2], 0),
        (x.squared() - y.squared() - 1e-9, vec![2], 0),
        (x.squared() - y.squared() + z.squared(), vec![2], 0),
        (x * y - z, vec![2], 0),
        ((x - 0.5).squared() - 1e-10, vec![2], 0),
        // Twice as many planes would be too many pieces.
        (
            (0..40)
                .map(|k| (x - 0.01 * f64::from(k)).squared() - 1.0)
                .reduce(|all, slab| all.max(&slab))
                .unwrap(),
            vec![2; 40],
            0,
        ),
    ];
    let mut state = 1u64;
    let mut random = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        ((state >> 11) as f64 / (1u64 << 53) as f64) * 4.0 - 2.0
    };
    for (k, (f, expected, others)) in cases.iter().enumerate() {
        let region = read(f);
        let mut degrees = Vec::new();
        assert_eq!(
            class(&region, &mut degrees),
            *others,
            "case {k}: {region:?}"
        );
        degrees.sort_unstable();
        let mut expected = expected.clone();
        expected.sort_unstable();
        assert_eq!(degrees, expected, "case {k}: {region:?}");
        let mut decided = 0;
        for _ in 0..2000 {
            let at = [random(), random(), random()];
            let (inside, distance) = contains(f, &region, at);
            if distance > 1e-9 {
                decided += 1;
                assert_eq!(inside, value(f, f.node(), at) <= 0.0, "case {k} at {at:?}");
            }
        }
        assert!(decided > 1900, "case {k}: {decided}");
    }
}

#[test]
fn repeated_factors_and_roots_alone_leave_simple_zeros() {
    let [x, y, z] = &variables();
    let ball = &(x.squared() + y.squared() + z.squared() - 1.0);
    let tilted = &(0.5 * z + 0.1);
    // A formula, and the degrees of its polynomials.
    let cases: Vec<(Formula, Vec<usize>)> = vec![
        (z.powi(3), vec![1]),
        (z.powi(3) * -1.0, vec![1]),
        (z.powi(5), vec![1]),
        (z * z * z, vec![1]),
        ((2.0 * z).squared() * (z * -1.0), vec![1]),
        (z.squared() * ((z * -1.0).min(&(z * -2.0))), vec![1; 2]),
        (ball.powi(3), vec![2]),
        (ball * ball, vec![]),
        ((ball * -1.0) * ball, vec![]),
        (ball * tilted * tilted * tilted, vec![3]),
        ((ball * -1.0) * tilted * (0.1 * y).sqrt(), vec![1, 3]),
        ((1.5 * x + 2.0).sqrt() * (0.1 * y).squared(), vec![]),
        (z * z.sqrt(), vec![1, 1]),
        // A sum is no product.
        (z.powi(3) + 0.001 * z, vec![3]),
        (z.powi(3) - 0.001, vec![3]),
    ];
    for (k, (formula, degrees)) in cases.iter().enumerate() {
        let region = read(formula);
        let mut found = Vec::new();
        assert_eq!(class(&region, &mut found), 0, "case {k}");
        assert_eq!(found, *degrees, "case {k}: {region:?}");
        for point in 0..400 {
            let at = [0, 1, 2].map(|axis| ((point * (axis * 2 + 7)) as f64 * 0.618).sin() * 2.0);
            let expected = value(formula, formula.node(), at);
            // Surfaces on which an even power is 0 are left out.
            let (inside, distance) = contains(formula, &region, at);
            let is_near = distance < 1e-9 || expected.abs() < 1e-12;
            assert!(is_near || inside == (expected <= 0.0), "case {k} at {at:?}");
        }
    }
}

#[test]
fn a_shape_far_away_is_read_about_its_place_without_loss() {
    // (x − 1000)⁴ + y⁴ + z⁴ − 1 about (1000, 0, 0), at a quarter of the scale.
    let [x, y, z] = &variables();
    let f = (x - 1000.0).powi(4) + y.powi(4) + z.powi(4) - 1.0;
    let place = |input| match input {
        Input::Variable(0) => Polynomial::linear(1000.0, [0.25, 0.0, 0.0]),
        Input::Variable(1) => Polynomial::linear(0.0, [0.0, 0.25, 0.0]),
        _ => Polynomial::linear(0.0, [0.0, 0.0, 0.25]),
    };
    let (Region::Polynomial(p), _) = region(&f.graph(), f.node(), &place) else {
        panic!("a polynomial");
    };
    let q = 0.25f64.powi(4);
    let expected = [
        ([0, 0, 0], -1.0),
        ([0, 0, 4], q),
        ([0, 4, 0], q),
        ([4, 0, 0], q),
    ];
    assert_eq!(p, Polynomial::from_terms(expected));
}

#[test]
fn products_are_expanded_as_far_as_the_work_is_bounded() {
    let [x, y, z] = &variables();
    let products = |count: u32| {
        (0..count).map(f64::from).fold(x - 0.5, |sum, k| {
            sum + (x + k * y + z + 1.0).powi(6) * (x - k * z + y + 2.0).powi(6)
        })
    };
    assert!(matches!(read(&products(10)), Region::Polynomial(p) if p.degree() == 12));
    assert!(matches!(read(&products(400)), Region::Field(..)));
}

#[test]
fn many_pieces_high_degrees_and_deep_expressions_are_fields_in_bounded_time() {
    let [x, y, _] = &variables();
    let mut many = x.abs();
    for k in 0..7 {
        many = many + (x - f64::from(k)).abs();
    }
    assert!(matches!(read(&(many - 3.0)), Region::Field(..)));
    assert!(matches!(read(&(x.powi(13) - y)), Region::Field(..)));
    let mut deep = x + y;
    for _ in 0..100_000 {
        deep = (deep.clone() * &deep).max(y);
    }
    assert!(read(&deep).pieces() <= MOST_PIECES);
    let mut chain = x.sin();
    for k in 0..100_000 {
        chain = chain.max(&(y - f64::from(k)));
    }
    assert!(read(&chain).pieces() <= MOST_PIECES);
}

#[test]
fn arithmetic_of_polynomials_is_that_of_their_values() {
    let p = Polynomial::linear(1.0, [2.0, -1.0, 0.5]);
    let q = Polynomial::from_terms([([2, 1, 0], 3.0), ([0, 0, 3], -1.0), ([0, 0, 0], 0.25)]);
    let at = [0.3, -0.7, 1.1];
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-14, "{a}, not {b}");
    close(p.plus(&q).at(at), p.at(at) + q.at(at));
    close(p.times(&q).at(at), p.at(at) * q.at(at));
    let inner = [p.clone(), q.clone(), Polynomial::constant(2.0)];
    close(q.compose(&inner).at(at), q.at([p.at(at), q.at(at), 2.0]));
    close(q.derivative(0).at(at), 6.0 * at[0] * at[1]);
    assert_eq!(q.degree(), 3);
    assert_eq!(p.plus(&p.scaled(-1.0)), Polynomial::default());
    // What is left of 0.1 + 0.2 − 0.3 is rounding.
    let rest = [0.1, 0.2, -0.3].map(|c| ([1, 0, 0], c));
    assert_eq!(Polynomial::from_terms(rest), Polynomial::default());
}

#[test]
fn products_of_two_planes_are_half_spaces_with_their_equations() {
    let [x, y, z] = &variables();
    let mut state = 7u64;
    let mut random = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        let value = (state >> 11) as f64 / (1u64 << 53) as f64 * 4.0 - 2.0;
        // Every other coefficient is a small number, or 0.
        if state >> 10 & 1 == 0 {
            value.round()
        } else {
            value
        }
    };
    for _ in 0..2000 {
        let [first, second] = [0, 1].map(|_| [0, 1, 2, 3].map(|_| random()));
        let affine = |[a, b, c, d]: [f64; 4]| a * x + b * y + c * z + d;
        let degree = |[a, b, c, _]: [f64; 4]| u32::from([a, b, c] != [0.0; 3]);
        if degree(first) + degree(second) < 2 {
            continue;
        }
        let mut planes = Vec::new();
        half_spaces(&read(&(affine(first) * affine(second))), &mut planes);
        assert!(planes.len() == 2 || planes.len() == 4, "{planes:?}");
        for plane in planes {
            let scaled = |[a, b, c, d]: [f64; 4]| {
                let plane = Polynomial::linear(d, [a, b, c]);
                plane.scaled(1.0 / plane.largest())
            };
            let is = |expected: [f64; 4]| {
                let (one, other) = (plane.scaled(1.0 / plane.largest()), scaled(expected));
                let distance = |sign| one.plus(&other.scaled(sign)).largest();
                distance(1.0).min(distance(-1.0)) < 1e-12
            };
            assert!(is(first) || is(second), "{first:?} {second:?} {plane:?}");
        }
    }
}

/// Collects polynomials of a region, which must be of degree 1.
fn half_spaces(region: &Region, found: &mut Vec<Polynomial>) {
    match region {
        Region::Polynomial(p) if p.degree() == 1 => found.push(p.clone()),
        Region::All(parts) | Region::Any(parts) => {
            parts.iter().for_each(|part| half_spaces(part, found));
        }
        other => panic!("{other:?}"),
    }
}
