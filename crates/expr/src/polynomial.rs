//! Polynomials in x, y, z, and sets bounded by them.
//!
//! In: an expression, and its inputs as polynomials. Out: a [`Region`], the set where the expression is not positive, as
//! unions and intersections of sets where polynomials are not positive (`polynomial/region.rs`). Coefficients that are
//! only rounding errors are set to zero.

use std::cmp::Ordering;

mod lattice;
mod planes;
mod region;
pub use region::{LARGEST_DEGREE, MOST_PIECES, Region, region};

/// A polynomial: its terms by exponents, in ascending order, none of them zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polynomial {
    terms: Vec<([u8; 3], f64)>,
}

/// A sum that is smaller than its largest summand by this factor is zero: about eight roundings.
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

    /// Returns the sum of terms, each given by the exponents of x, y and z.
    pub fn from_terms(terms: impl IntoIterator<Item = ([u8; 3], f64)>) -> Self {
        let mut sum = Self::default();
        for (exponents, coefficient) in terms {
            sum.add_term(exponents, coefficient);
        }
        sum
    }

    /// Returns the terms in the order of their exponents, x first.
    pub fn terms(&self) -> impl ExactSizeIterator<Item = ([u8; 3], f64)> + '_ {
        self.terms.iter().copied()
    }

    /// Returns the highest sum of exponents; 0 for a constant.
    pub fn degree(&self) -> usize {
        let sum = |(e, _): ([u8; 3], f64)| e.iter().map(|&e| usize::from(e)).sum();
        self.terms().map(sum).max().unwrap_or(0)
    }

    /// Returns the value of a constant; `None` for any other polynomial.
    pub fn value(&self) -> Option<f64> {
        match self.degree() {
            0 => Some(self.terms().map(|(_, c)| c).sum()),
            _ => None,
        }
    }

    /// Returns the largest absolute value of a coefficient.
    pub fn largest(&self) -> f64 {
        self.terms().fold(0.0, |most, (_, c)| most.max(c.abs()))
    }

    /// Returns true if all coefficients are finite.
    pub fn is_finite(&self) -> bool {
        self.terms().all(|(_, c)| c.is_finite())
    }

    /// Returns the value at a point.
    pub fn at(&self, [x, y, z]: [f64; 3]) -> f64 {
        let powers = |e: [u8; 3]| {
            let [a, b, c] = e.map(i32::from);
            x.powi(a) * y.powi(b) * z.powi(c)
        };
        self.terms().map(|(e, c)| c * powers(e)).sum()
    }

    /// Returns the derivative by the variable `k`.
    pub fn derivative(&self, k: usize) -> Self {
        let terms = self.terms().filter(|(e, _)| e[k] > 0);
        Self::from_terms(terms.map(|(mut e, c)| {
            let factor = f64::from(e[k]);
            e[k] -= 1;
            (e, c * factor)
        }))
    }

    /// Returns the product with a number.
    pub fn scaled(&self, factor: f64) -> Self {
        let terms = self.terms().map(|(e, c)| (e, c * factor));
        Self {
            terms: terms.filter(|(_, c)| *c != 0.0).collect(),
        }
    }

    /// Returns the sum.
    pub fn plus(&self, other: &Self) -> Self {
        let mut terms = Vec::with_capacity(self.terms.len() + other.terms.len());
        let (mut own, mut others) = (self.terms().peekable(), other.terms().peekable());
        while let (Some((e, c)), Some((f, d))) = (own.peek().copied(), others.peek().copied()) {
            match e.cmp(&f) {
                Ordering::Less => terms.extend(own.next()),
                Ordering::Greater => terms.extend(others.next()),
                Ordering::Equal => {
                    terms.extend(sum_of(c, d).map(|sum| (e, sum)));
                    own.next();
                    others.next();
                }
            }
        }
        terms.extend(own.chain(others));
        Self { terms }
    }

    /// Returns the product.
    ///
    /// Allocates memory for all exponents up to the highest of each variable; the sum of two exponents must be less
    /// than 256.
    pub fn times(&self, other: &Self) -> Self {
        let of = |k: usize, p: &Self| p.terms().map(|(e, _)| usize::from(e[k])).max().unwrap_or(0);
        let [_, ny, nz] = [0, 1, 2].map(|k| of(k, self) + of(k, other) + 1);
        let place = |e: [u8; 3]| {
            let [x, y, z] = e.map(usize::from);
            (x * ny + y) * nz + z
        };
        // Accumulate each exponent's sum together with its largest summand, so that cancellation is detected in any
        // order.
        let mut sums: Vec<(f64, f64)> = Vec::new();
        for (e, c) in self.terms() {
            for (f, d) in other.terms() {
                let k = place(e) + place(f);
                if sums.len() <= k {
                    sums.resize(k + 1, (0.0, 0.0));
                }
                let (sum, largest) = &mut sums[k];
                *sum += c * d;
                *largest = largest.max((c * d).abs());
            }
        }
        let exponents = |k: usize| [k / (ny * nz), k / nz % ny, k % nz].map(|e| e as u8);
        let sums = sums.into_iter().enumerate();
        let kept = sums.filter(|&(_, (sum, largest))| !is_rounding(sum, largest));
        Self {
            terms: kept.map(|(k, (sum, _))| (exponents(k), sum)).collect(),
        }
    }

    /// Substitutes polynomials for x, y and z.
    pub fn compose(&self, inner: &[Self; 3]) -> Self {
        let powers = [0, 1, 2].map(|k| {
            let most = self.terms().map(|(e, _)| e[k]).max().unwrap_or(0);
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
        match self.terms.binary_search_by_key(&exponents, |(e, _)| *e) {
            Ok(place) => match sum_of(self.terms[place].1, coefficient) {
                Some(sum) => self.terms[place].1 = sum,
                None => {
                    self.terms.remove(place);
                }
            },
            Err(place) if coefficient != 0.0 => self.terms.insert(place, (exponents, coefficient)),
            Err(_) => {}
        }
    }
}

/// Returns the sum; `None` if it is zero up to rounding.
fn sum_of(a: f64, b: f64) -> Option<f64> {
    (!is_rounding(a + b, a.abs().max(b.abs()))).then_some(a + b)
}

/// Returns true for a sum that is zero up to the rounding of its summands, the largest of which has this magnitude.
fn is_rounding(sum: f64, largest: f64) -> bool {
    sum.abs() <= CANCELLATION * largest
}
