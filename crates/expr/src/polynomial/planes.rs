//! Pairs of planes.
//!
//! In: a polynomial of degree 2. Out: if it is the product of two real affine functions, the set where it is not
//! positive, as a combination of half-spaces, so that each plane has the equation that it has in other expressions.

use crate::polynomial::{Polynomial, Region};

/// The relative rounding error of a coefficient: 64 roundings.
const ROUNDING: f64 = 64.0 * f64::EPSILON;
/// A pair of planes is split if b² − ac is at least this fraction of b² + |ac| for some block ((a, b), (b, c)) of its
/// matrix. For planes that are closer together, the coefficients do not determine each of them: 2⁻²⁴.
const LEAST_SEPARATION: f64 = 1.0 / (1u64 << 24) as f64;

/// A function of x, y and z: their coefficients, and the constant.
#[derive(Clone, Copy, Default)]
struct AffineFactor {
    coefficients: [f64; 4],
    /// The maximum rounding error of each coefficient.
    errors: [f64; 4],
}

/// Returns the set where a product of two affine functions is not positive; `None` for other polynomials.
pub(super) fn pair_of_planes(polynomial: &Polynomial) -> Option<Region> {
    if polynomial.degree() != 2 {
        return None;
    }
    let [first, second] = factors(&symmetric(polynomial))?;
    let below = |plane: AffineFactor| Region::Polynomial(plane.polynomial());
    let above = |plane: AffineFactor| Region::Polynomial(plane.polynomial().scaled(-1.0));
    if !first.is_parallel(&second) {
        // Of different signs.
        return Some(Region::Any(vec![
            Region::All(vec![below(first), above(second)]),
            Region::All(vec![above(first), below(second)]),
        ]));
    }
    let along = first.dot(&second);
    let place = first.coefficients[3] / first.dot(&first);
    // The value of the second function where the first is 0.
    let beyond = second.coefficients[3] - along * place;
    Some(match (along > 0.0, beyond > 0.0) {
        (true, true) => Region::All(vec![below(first), above(second)]),
        (true, false) => Region::All(vec![above(first), below(second)]),
        (false, true) => Region::Any(vec![below(first), below(second)]),
        (false, false) => Region::Any(vec![above(first), above(second)]),
    })
}

/// Returns the symmetric matrix M with (x, y, z, 1) M (x, y, z, 1)ᵀ equal to the polynomial.
fn symmetric(polynomial: &Polynomial) -> [[f64; 4]; 4] {
    let mut matrix = [[0.0; 4]; 4];
    for (exponents, coefficient) in polynomial.terms() {
        let mut places = (0..3).flat_map(|k| std::iter::repeat_n(k, exponents[k].into()));
        let (j, k) = (places.next().unwrap_or(3), places.next().unwrap_or(3));
        matrix[j][k] += 0.5 * coefficient;
        matrix[k][j] += 0.5 * coefficient;
    }
    matrix
}

/// Returns two affine functions whose product is a positive multiple of a quadratic form.
///
/// With a block ((a, b), (b, c)) of the matrix, where r² = b² − ac is positive, and w = b ± r, the part of the form in those
/// two variables is (ws + ct)(as + wt)/w. The other coefficients follow from the rows of the block.
fn factors(matrix: &[[f64; 4]; 4]) -> Option<[AffineFactor; 2]> {
    let square_and_product = |(i, j): (usize, usize)| {
        let (a, b, c) = (matrix[i][i], matrix[i][j], matrix[j][j]);
        (b * b, a * c)
    };
    let difference = |block| {
        let (square, product) = square_and_product(block);
        square - product
    };
    let is_separate = |&block: &(usize, usize)| {
        let (square, product) = square_and_product(block);
        square - product > LEAST_SEPARATION * (square + product.abs())
    };
    let blocks = (0..3).flat_map(|i| (i + 1..4).map(move |j| (i, j)));
    let (i, j) = blocks
        .filter(is_separate)
        .max_by(|&one, &other| difference(one).total_cmp(&difference(other)))?;
    let (a, b, c) = (matrix[i][i], matrix[i][j], matrix[j][j]);
    let root = difference((i, j)).sqrt().copysign(b);
    let w = b + root;
    let (mut p, mut q) = (AffineFactor::default(), AffineFactor::default());
    p.set(i, [w, 0.0], 1.0);
    p.set(j, [c, 0.0], 1.0);
    q.set(i, [a, 0.0], 1.0);
    q.set(j, [w, 0.0], 1.0);
    for k in (0..4).filter(|&k| k != i && k != j) {
        let (first, second) = (matrix[i][k], matrix[j][k]);
        p.set(k, [w * second, c * first], root);
        q.set(k, [w * first, a * second], root);
    }
    // The form is the product only if each of its coefficients is.
    let mut entries = (0..4).flat_map(|j| (j..4).map(move |k| (j, k)));
    let is_product = entries.all(|(j, k)| {
        let [first, second] = [p.times(j, &q, k), p.times(k, &q, j)];
        let of_form = 2.0 * w * matrix[j][k];
        let error = first[1] + second[1] + ROUNDING * of_form.abs();
        (first[0] + second[0] - of_form).abs() <= error
    });
    let sign = w.signum();
    q.coefficients = q.coefficients.map(|coefficient| sign * coefficient);
    is_product.then_some([p, q])
}

impl AffineFactor {
    /// Sets a coefficient to (a − b)/divisor, or to 0 if that is only rounding.
    fn set(&mut self, k: usize, [a, b]: [f64; 2], divisor: f64) {
        let error = ROUNDING * a.abs().max(b.abs());
        let sum = a - b;
        self.coefficients[k] = if sum.abs() <= error {
            0.0
        } else {
            sum / divisor
        };
        self.errors[k] = error / divisor.abs();
    }

    fn polynomial(&self) -> Polynomial {
        let [x, y, z, constant] = self.coefficients;
        Polynomial::linear(constant, [x, y, z])
    }

    /// Returns the product of two coefficients, and its maximum error.
    fn times(&self, j: usize, other: &Self, k: usize) -> [f64; 2] {
        let (a, b) = (self.coefficients[j], other.coefficients[k]);
        let error = a.abs() * other.errors[k] + b.abs() * self.errors[j];
        [a * b, error + self.errors[j] * other.errors[k]]
    }

    /// Returns the scalar product of the gradients.
    fn dot(&self, other: &Self) -> f64 {
        let products = self.coefficients.iter().zip(&other.coefficients);
        products.take(3).map(|(a, b)| a * b).sum()
    }

    /// Returns true if the gradients are parallel.
    fn is_parallel(&self, other: &Self) -> bool {
        [(0, 1), (0, 2), (1, 2)].into_iter().all(|(j, k)| {
            let (first, second) = (self.times(j, other, k), self.times(k, other, j));
            (first[0] - second[0]).abs() <= first[1] + second[1]
        })
    }
}
