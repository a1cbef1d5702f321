//! The zero set of a polynomial in a leaf's own frame.
//!
//! In: a polynomial in coordinates in which the leaf is about [−1, 1]³, then rays in the same coordinates. Out: the
//! polynomial along the ray, and gradients.

use expr::polynomial::Polynomial;
use glam::DVec3;

use crate::program::PolynomialProgram;
use crate::roots::{Coefficients, LARGEST_DEGREE};

/// Polynomials of a higher degree bound one surface only if they are identical and under one map.
pub(crate) const HIGHEST_SHARED: usize = 4;

/// The polynomial, prepared for rays.
#[derive(Clone, Debug)]
pub(crate) struct PolynomialSurface {
    form: SurfaceForm,
    degree: usize,
    size: f64,
    /// The scaled polynomial: its largest coefficient is between 1 and 2.
    pub(crate) polynomial: Polynomial,
    /// The factor from the given polynomial to it.
    scale: f64,
}

#[derive(Clone, Debug)]
enum SurfaceForm {
    Low(QuadraticForm),
    Higher {
        /// Sorted by the exponent of x, then of y, then of z.
        terms: Vec<([u8; 3], f64)>,
        /// The expression of the given polynomial, if it takes less work than the terms.
        program: Option<PolynomialProgram>,
    },
}

/// A polynomial of degree at most two.
#[derive(Clone, Copy, Debug)]
pub(crate) enum QuadraticForm {
    Plane {
        normal: DVec3,
        offset: f64,
    },
    Quadric {
        /// The coefficients of x², y², z².
        squares: DVec3,
        /// The coefficients of yz, xz, xy.
        mixed: DVec3,
        linear: DVec3,
        constant: f64,
    },
}

impl PolynomialSurface {
    /// Prepares a polynomial of degree at most [`LARGEST_DEGREE`]. It is scaled by a power of two, so that the squares of its
    /// coefficients are in the range of numbers, and every other rounding stays as it is.
    pub(crate) fn new(given: Polynomial) -> Self {
        let scale = normalizing(given.largest());
        let polynomial = given.scaled(scale);
        let term = |e: [u8; 3]| {
            let mut terms = polynomial.terms();
            terms.find(|(f, _)| *f == e).map_or(0.0, |(_, c)| c)
        };
        let linear = DVec3::new(term([1, 0, 0]), term([0, 1, 0]), term([0, 0, 1]));
        let constant = term([0, 0, 0]);
        let form = match polynomial.degree() {
            0 | 1 => SurfaceForm::Low(QuadraticForm::Plane {
                normal: linear,
                offset: constant,
            }),
            2 => SurfaceForm::Low(QuadraticForm::Quadric {
                squares: DVec3::new(term([2, 0, 0]), term([0, 2, 0]), term([0, 0, 2])),
                mixed: DVec3::new(term([0, 1, 1]), term([1, 0, 1]), term([1, 1, 0])),
                linear,
                constant,
            }),
            _ => SurfaceForm::Higher {
                terms: polynomial.terms().collect(),
                program: None,
            },
        };
        Self {
            form,
            degree: polynomial.degree(),
            size: polynomial.terms().map(|(_, c)| c.abs()).sum(),
            polynomial,
            scale,
        }
    }

    /// Uses the expression of the polynomial if the terms take more work.
    pub(crate) fn with_program(mut self, found: PolynomialProgram) -> Self {
        if let SurfaceForm::Higher { terms, program } = &mut self.form {
            // About one product of polynomials for each pair of exponents of x and y.
            let cost = |(e, _): &([u8; 3], f64)| usize::from(e[1] + 1) * usize::from(e[2] + 1);
            let cost: usize = terms.iter().map(cost).sum();
            // If factors are left out, the expression has a higher degree.
            let is_it = found.degree() == self.degree;
            if is_it && self.degree > HIGHEST_SHARED && found.cost() < cost {
                *program = Some(found);
            }
        }
        self
    }

    pub(crate) fn degree(&self) -> usize {
        self.degree
    }

    /// Returns the sum of the magnitudes of its coefficients, the bound of its values in the frame.
    pub(crate) fn size(&self) -> f64 {
        self.size
    }

    /// Returns the approximate work of finding its sign changes on a ray, in operations.
    pub(crate) fn operations(&self) -> u64 {
        8 * (self.degree * self.degree) as u64
    }

    /// Returns the polynomial, if its degree is at most two.
    #[inline]
    pub(crate) fn quadratic(&self) -> Option<QuadraticForm> {
        match self.form {
            SurfaceForm::Low(form) => Some(form),
            SurfaceForm::Higher { .. } => None,
        }
    }

    /// Returns the polynomial at `point` + s·`direction`, in s.
    pub(crate) fn along(&self, point: DVec3, direction: DVec3) -> Coefficients {
        let mut sum = [0.0; LARGEST_DEGREE + 1];
        let terms = match &self.form {
            SurfaceForm::Low(form) => {
                sum[..3].copy_from_slice(&form.along(point, direction));
                return sum;
            }
            SurfaceForm::Higher {
                program: Some(program),
                ..
            } => {
                let given = program.along(point, direction);
                let mut p = given.map(|c| self.scale * c);
                p[self.degree + 1..].fill(0.0);
                return p;
            }
            SurfaceForm::Higher { terms, .. } => terms,
        };
        let (p, d) = (point.to_array(), direction.to_array());
        match self.degree {
            ..=4 => add_terms::<5>(&mut sum, terms, p, d),
            5 | 6 => add_terms::<7>(&mut sum, terms, p, d),
            _ => add_terms::<{ LARGEST_DEGREE + 1 }>(&mut sum, terms, p, d),
        }
        sum
    }

    /// Returns the gradient at a point.
    pub(crate) fn gradient(&self, at: DVec3) -> DVec3 {
        match &self.form {
            SurfaceForm::Low(form) => form.gradient(at),
            SurfaceForm::Higher { terms, .. } => {
                let powers = at.to_array().map(|x| {
                    let mut powers = [1.0; LARGEST_DEGREE + 1];
                    for k in 1..=self.degree {
                        powers[k] = powers[k - 1] * x;
                    }
                    powers
                });
                let mut gradient = DVec3::ZERO;
                for &(e, c) in terms {
                    let [x, y, z] = [0, 1, 2].map(|k| powers[k][usize::from(e[k])]);
                    let slope = |k: usize| match usize::from(e[k]) {
                        0 => 0.0,
                        n => n as f64 * powers[k][n - 1],
                    };
                    gradient +=
                        c * DVec3::new(slope(0) * y * z, slope(1) * x * z, slope(2) * x * y);
                }
                gradient
            }
        }
    }
}

/// Returns the power of two that scales a number into [1, 2); 1 for 0 and what is not finite.
fn normalizing(x: f64) -> f64 {
    // Smaller numbers are scaled as far as the range of numbers allows.
    const MOST: f64 = 1000.0;
    match x > 0.0 && x.is_finite() {
        true => (-x.log2().floor().clamp(-MOST, MOST)).exp2(),
        false => 1.0,
    }
}

impl QuadraticForm {
    /// Returns the polynomial at `point` + s·`direction`, in s.
    #[inline]
    pub(crate) fn along(&self, point: DVec3, direction: DVec3) -> [f64; 3] {
        let (p, d) = (point, direction);
        match self {
            Self::Plane { normal, offset } => [normal.dot(p) + offset, normal.dot(d), 0.0],
            Self::Quadric {
                squares,
                mixed,
                linear,
                constant,
            } => {
                // Half of the gradient of the part of degree two.
                let half = |v: DVec3| {
                    let (x, y, z) = (mixed.x, mixed.y, mixed.z);
                    let mixed = DVec3::new(z * v.y + y * v.z, z * v.x + x * v.z, y * v.x + x * v.y);
                    *squares * v + 0.5 * mixed
                };
                let (at, along) = (half(p), half(d));
                [
                    (at + *linear).dot(p) + constant,
                    (2.0 * at + *linear).dot(d),
                    along.dot(d),
                ]
            }
        }
    }

    /// Returns the gradient at a point.
    #[inline]
    pub(crate) fn gradient(&self, at: DVec3) -> DVec3 {
        match self {
            Self::Plane { normal, .. } => *normal,
            Self::Quadric {
                squares,
                mixed,
                linear,
                ..
            } => {
                let (x, y, z) = (mixed.x, mixed.y, mixed.z);
                let mixed = DVec3::new(
                    z * at.y + y * at.z,
                    z * at.x + x * at.z,
                    y * at.x + x * at.y,
                );
                2.0 * *squares * at + mixed + *linear
            }
        }
    }

    /// Returns the maximum change of the gradient where the point changes by at most `half`.
    pub(crate) fn gradient_spread(&self, half: DVec3) -> DVec3 {
        match self {
            Self::Plane { .. } => DVec3::ZERO,
            Self::Quadric { squares, mixed, .. } => {
                let size = Self::Quadric {
                    squares: squares.abs(),
                    mixed: mixed.abs(),
                    linear: DVec3::ZERO,
                    constant: 0.0,
                };
                size.gradient(half)
            }
        }
    }

    /// Returns true if it has no mixed terms, and no negative coefficients of squares.
    pub(crate) fn is_convex(&self) -> bool {
        match self {
            Self::Plane { .. } => true,
            Self::Quadric { squares, mixed, .. } => {
                *mixed == DVec3::ZERO && squares.cmpge(DVec3::ZERO).all()
            }
        }
    }
}

/// Adds a polynomial of a degree below `N` along a line: inner sums by z, then by y, then by x.
fn add_terms<const N: usize>(
    sum: &mut Coefficients,
    terms: &[([u8; 3], f64)],
    p: [f64; 3],
    d: [f64; 3],
) {
    let mut powers = [[[0.0; N]; N]; 3];
    for (k, powers) in powers.iter_mut().enumerate() {
        powers[0][0] = 1.0;
        let most = terms.iter().map(|(e, _)| e[k]).max().unwrap_or(0);
        for n in 1..=usize::from(most) {
            for j in 0..n {
                let c = powers[n - 1][j];
                powers[n][j] += c * p[k];
                powers[n][j + 1] += c * d[k];
            }
        }
    }
    let mut at = 0;
    while at < terms.len() {
        let ex = usize::from(terms[at].0[0]);
        let mut inner = [0.0; N];
        let mut inner_degree = 0;
        while at < terms.len() && usize::from(terms[at].0[0]) == ex {
            let ey = usize::from(terms[at].0[1]);
            let mut innermost = [0.0; N];
            let mut degree = 0;
            while at < terms.len() && terms[at].0[..2] == [ex as u8, ey as u8] {
                let (e, c) = terms[at];
                let ez = usize::from(e[2]);
                for j in 0..=ez {
                    innermost[j] += c * powers[2][ez][j];
                }
                degree = degree.max(ez);
                at += 1;
            }
            add_product(&mut inner, &powers[1][ey][..=ey], &innermost[..=degree]);
            inner_degree = inner_degree.max(ey + degree);
        }
        add_product(sum, &powers[0][ex][..=ex], &inner[..=inner_degree]);
    }
}

fn add_product(sum: &mut [f64], a: &[f64], b: &[f64]) {
    for (i, a) in a.iter().enumerate() {
        for (sum, b) in sum[i..].iter_mut().zip(b) {
            *sum += a * b;
        }
    }
}
