//! Polynomials in x, y, z, and sets that they bound.
//!
//! Input: an expression, and what its inputs are as polynomials. Output: a [`Region`], the set where the expression is not
//! positive, as unions and intersections of sets where polynomials are not positive (`polynomial/region.rs`).
//! Coefficients that are nothing but rounding are zero.

use std::collections::BTreeMap;

mod lattice;
mod region;
pub use region::{LARGEST_DEGREE, MOST_PIECES, Region, region};

/// A polynomial: its terms by their exponents, none of them zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polynomial {
    terms: BTreeMap<[u8; 3], f64>,
}

/// A sum that is smaller than its largest part by this factor is zero: about eight roundings.
const CANCELLATION: f64 = 8.0 * f64::EPSILON;

impl Polynomial {
    /// A constant.
    pub fn constant(value: f64) -> Self {
        Self::from_terms([([0; 3], value)])
    }

    /// The polynomial c + x·s₀ + y·s₁ + z·s₂.
    pub fn linear(constant: f64, slopes: [f64; 3]) -> Self {
        let units = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
        let linear = units.into_iter().zip(slopes);
        Self::from_terms(linear.chain([([0; 3], constant)]))
    }

    /// The sum of terms, each by the exponents of x, y and z.
    pub fn from_terms(terms: impl IntoIterator<Item = ([u8; 3], f64)>) -> Self {
        let mut sum = Self::default();
        for (exponents, coefficient) in terms {
            sum.add_term(exponents, coefficient);
        }
        sum
    }

    /// The terms in the order of their exponents, x first.
    pub fn terms(&self) -> impl ExactSizeIterator<Item = ([u8; 3], f64)> + '_ {
        self.terms.iter().map(|(&exponents, &c)| (exponents, c))
    }

    /// The highest sum of exponents; 0 for a constant.
    pub fn degree(&self) -> usize {
        let sum = |e: &[u8; 3]| e.iter().map(|&e| usize::from(e)).sum();
        self.terms.keys().map(sum).max().unwrap_or(0)
    }

    /// The value of a constant; `None` for any other polynomial.
    pub fn value(&self) -> Option<f64> {
        match self.degree() {
            0 => Some(self.terms.values().sum()),
            _ => None,
        }
    }

    /// The greatest absolute value of a coefficient.
    pub fn largest(&self) -> f64 {
        self.terms.values().fold(0.0, |most, c| most.max(c.abs()))
    }

    /// True if all coefficients are numbers.
    pub fn is_finite(&self) -> bool {
        self.terms.values().all(|c| c.is_finite())
    }

    /// The value at a point.
    pub fn at(&self, [x, y, z]: [f64; 3]) -> f64 {
        let powers = |e: [u8; 3]| {
            let [a, b, c] = e.map(i32::from);
            x.powi(a) * y.powi(b) * z.powi(c)
        };
        self.terms().map(|(e, c)| c * powers(e)).sum()
    }

    /// The derivative by the variable `k`.
    pub fn derivative(&self, k: usize) -> Self {
        let terms = self.terms().filter(|(e, _)| e[k] > 0);
        Self::from_terms(terms.map(|(mut e, c)| {
            let factor = f64::from(e[k]);
            e[k] -= 1;
            (e, c * factor)
        }))
    }

    /// The product with a number.
    pub fn scaled(&self, factor: f64) -> Self {
        Self::from_terms(self.terms().map(|(e, c)| (e, c * factor)))
    }

    /// The sum.
    pub fn plus(&self, other: &Self) -> Self {
        let mut sum = self.clone();
        for (e, c) in other.terms() {
            sum.add_term(e, c);
        }
        sum
    }

    /// The product.
    ///
    /// # Panics
    /// May panic if the degrees together exceed 255.
    pub fn times(&self, other: &Self) -> Self {
        // Largest parts are kept apart, so that cancellation is seen whatever the order.
        let mut sums: BTreeMap<[u8; 3], (f64, f64)> = BTreeMap::new();
        for (e, c) in self.terms() {
            for (f, d) in other.terms() {
                let exponents = [e[0] + f[0], e[1] + f[1], e[2] + f[2]];
                let (sum, largest) = sums.entry(exponents).or_insert((0.0, 0.0));
                *sum += c * d;
                *largest = largest.max((c * d).abs());
            }
        }
        let cancels = |sum: f64, largest: f64| sum.abs() <= CANCELLATION * largest;
        sums.retain(|_, (sum, largest)| !cancels(*sum, *largest));
        Self {
            terms: sums.into_iter().map(|(e, (sum, _))| (e, sum)).collect(),
        }
    }

    /// The polynomial of other polynomials in the places of x, y and z.
    pub fn compose(&self, inner: &[Self; 3]) -> Self {
        let powers = [0, 1, 2].map(|k| {
            let most = self.terms.keys().map(|e| e[k]).max().unwrap_or(0);
            let mut powers = vec![Self::constant(1.0)];
            for _ in 0..most {
                let next = powers.last().map(|power: &Self| power.times(&inner[k]));
                powers.extend(next);
            }
            powers
        });
        let mut sum = Self::default();
        for (e, c) in self.terms() {
            let [x, y, z] = [0, 1, 2].map(|k| &powers[k][usize::from(e[k])]);
            sum = sum.plus(&x.times(y).times(z).scaled(c));
        }
        sum
    }

    fn add_term(&mut self, exponents: [u8; 3], coefficient: f64) {
        let sum = self.terms.entry(exponents).or_insert(0.0);
        let largest = sum.abs().max(coefficient.abs());
        *sum += coefficient;
        if sum.abs() <= CANCELLATION * largest {
            self.terms.remove(&exponents);
        }
    }
}
