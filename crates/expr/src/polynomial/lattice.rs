//! Piecewise polynomials: minima and maxima of polynomials, each with at most one square root.
//!
//! In: operands. Out: their sum, product, power or root as a lattice of pieces, or `None` if it does not have this form,
//! or has too many pieces.

use std::sync::Arc;

use crate::polynomial::Polynomial;
use crate::polynomial::region::{LARGEST_DEGREE, MOST_PIECES};

/// a + b·√p.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RootedPolynomial {
    pub(super) rational: Polynomial,
    /// b and p.
    pub(super) root: Option<(Polynomial, Arc<Polynomial>)>,
    /// For a product, polynomials whose product has the same sign, except on surfaces where the original is 0.
    pub(super) factors: Option<Factors>,
}

/// The factors of a product that occur an odd number of times: the others do not change its sign.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Factors {
    odd: Vec<Polynomial>,
    /// True if there are others.
    is_reduced: bool,
}

impl Factors {
    /// Returns the factors of a square root.
    fn of_root() -> Self {
        Self {
            odd: Vec::new(),
            is_reduced: true,
        }
    }

    fn scaled(mut self, factor: f64) -> Option<Self> {
        if factor == 0.0 || factor.is_nan() {
            return None;
        }
        if factor < 0.0 {
            let minus = Polynomial::constant(-1.0);
            match self.odd.first_mut() {
                Some(first) if *first == minus => {
                    self.odd.remove(0);
                }
                Some(first) => *first = first.scaled(-1.0),
                None => self.odd.push(minus),
            }
        }
        Some(self)
    }

    fn times(mut self, other: Self) -> Self {
        self.is_reduced |= other.is_reduced;
        let mut is_negative = false;
        for factor in other.odd {
            let minus = factor.scaled(-1.0);
            let same = self
                .odd
                .iter()
                .position(|own| *own == factor || *own == minus);
            match same {
                Some(place) => {
                    is_negative ^= self.odd.remove(place) == minus;
                    self.is_reduced = true;
                }
                None => self.odd.push(factor),
            }
        }
        match is_negative {
            true => self.scaled(-1.0).unwrap_or_else(Self::of_root),
            false => self,
        }
    }

    /// Returns a polynomial with the sign of the product; `None` if the product itself will do.
    pub(super) fn sign(&self) -> Option<Polynomial> {
        let one = Polynomial::constant(1.0);
        let product = || self.odd.iter().fold(one, |product, p| product.times(p));
        self.is_reduced.then(product)
    }
}

/// Nested minima and maxima.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Lattice {
    Piece(RootedPolynomial),
    Min(Vec<Lattice>),
    Max(Vec<Lattice>),
}

impl RootedPolynomial {
    pub(super) fn polynomial(rational: Polynomial) -> Self {
        Self {
            rational,
            root: None,
            factors: None,
        }
    }

    /// Returns the factors; `None` for a sum with a square root.
    fn factors(&self) -> Option<Factors> {
        let itself = || {
            self.root.is_none().then(|| Factors {
                odd: vec![self.rational.clone()],
                is_reduced: false,
            })
        };
        self.factors.clone().or_else(itself)
    }

    fn scaled(&self, factor: f64) -> Self {
        let root = self.root.as_ref();
        Self {
            rational: self.rational.scaled(factor),
            root: root.map(|(b, p)| (b.scaled(factor), p.clone())),
            factors: self.factors.clone().and_then(|all| all.scaled(factor)),
        }
    }

    fn plus(&self, other: &Self) -> Option<Self> {
        let root = match (&self.root, &other.root) {
            (Some((b, p)), Some((c, q))) => {
                (p == q).then_some(())?;
                let sum = b.plus(c);
                (sum.value() != Some(0.0)).then(|| (sum, p.clone()))
            }
            (one, other) => one.clone().or_else(|| other.clone()),
        };
        Some(Self {
            rational: self.rational.plus(&other.rational),
            root,
            factors: None,
        })
    }

    fn times(&self, other: &Self) -> Option<Self> {
        let (a, c) = (&self.rational, &other.rational);
        let product = |a: &Polynomial, b: &Polynomial| {
            (a.degree() + b.degree() <= LARGEST_DEGREE).then(|| a.times(b))
        };
        let rational = product(a, c)?;
        let (rational, root) = match (&self.root, &other.root) {
            (None, None) => (rational, None),
            (Some((b, p)), None) => (rational, Some((product(b, c)?, p.clone()))),
            (None, Some((d, p))) => (rational, Some((product(a, d)?, p.clone()))),
            (Some((b, p)), Some((d, q))) => {
                (p == q).then_some(())?;
                let outer = product(a, d)?.plus(&product(b, c)?);
                let inner = product(&product(b, d)?, p)?;
                (rational.plus(&inner), Some((outer, p.clone())))
            }
        };
        let root = root.filter(|(b, _)| b.value() != Some(0.0));
        let factors = self.factors().zip(other.factors());
        Some(Self {
            rational,
            root,
            factors: factors.map(|(own, other)| own.times(other)),
        })
    }
}

impl Lattice {
    pub(super) fn constant(value: f64) -> Self {
        Self::Piece(RootedPolynomial::polynomial(Polynomial::constant(value)))
    }

    pub(super) fn pieces(&self) -> usize {
        match self {
            Self::Piece(_) => 1,
            Self::Min(parts) | Self::Max(parts) => parts.iter().map(Self::pieces).sum(),
        }
    }

    /// Returns the product with a number; a negative one exchanges minima and maxima.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        let all = |parts: &[Self]| parts.iter().map(|part| part.scaled(factor)).collect();
        match self {
            Self::Piece(piece) => Self::Piece(piece.scaled(factor)),
            Self::Min(parts) if factor < 0.0 => Self::Max(all(parts)),
            Self::Max(parts) if factor < 0.0 => Self::Min(all(parts)),
            Self::Min(parts) => Self::Min(all(parts)),
            Self::Max(parts) => Self::Max(all(parts)),
        }
    }

    pub(super) fn plus(&self, other: &Self) -> Option<Self> {
        if self.pieces() * other.pieces() > MOST_PIECES {
            return None;
        }
        let all = |parts: &[Self], other: &Self| -> Option<Vec<Self>> {
            parts.iter().map(|part| part.plus(other)).collect()
        };
        match (self, other) {
            (Self::Piece(a), Self::Piece(b)) => a.plus(b).map(Self::Piece),
            (Self::Min(parts), other) | (other, Self::Min(parts)) => {
                all(parts, other).map(Self::Min)
            }
            (Self::Max(parts), other) | (other, Self::Max(parts)) => {
                all(parts, other).map(Self::Max)
            }
        }
    }

    /// Returns the product, if both are single pieces, or both the same absolute value.
    pub(super) fn times(&self, other: &Self) -> Option<Self> {
        if let (Self::Piece(a), Self::Piece(b)) = (self, other) {
            return a.times(b).map(Self::Piece);
        }
        let size = self.absolute().filter(|_| self == other)?;
        size.times(size).map(Self::Piece)
    }

    pub(super) fn power(&self, n: u32) -> Option<Self> {
        match self {
            Self::Piece(piece) => {
                let mut power = piece.clone();
                for _ in 1..n {
                    power = power.times(piece)?;
                }
                Some(Self::Piece(power))
            }
            // An even power of |p| is that of p; odd powers are increasing.
            _ if n.is_multiple_of(2) => {
                let size = self.absolute()?.clone();
                Self::Piece(size).power(n)
            }
            Self::Min(parts) => {
                let powers: Option<_> = parts.iter().map(|part| part.power(n)).collect();
                powers.map(Self::Min)
            }
            Self::Max(parts) => {
                let powers: Option<_> = parts.iter().map(|part| part.power(n)).collect();
                powers.map(Self::Max)
            }
        }
    }

    pub(super) fn root(&self) -> Option<Self> {
        match self {
            Self::Piece(RootedPolynomial {
                rational,
                root: None,
                ..
            }) => Some(Self::Piece(RootedPolynomial {
                rational: Polynomial::default(),
                root: Some((Polynomial::constant(1.0), Arc::new(rational.clone()))),
                factors: Some(Factors::of_root()),
            })),
            _ => None,
        }
    }

    pub(super) fn min(&self, other: &Self) -> Option<Self> {
        let joined = join(self, other, |part| match part {
            Self::Min(parts) => Some(parts),
            _ => None,
        });
        joined.map(Self::Min)
    }

    pub(super) fn max(&self, other: &Self) -> Option<Self> {
        let joined = join(self, other, |part| match part {
            Self::Max(parts) => Some(parts),
            _ => None,
        });
        joined.map(Self::Max)
    }

    /// Returns the p of max(p, −p).
    fn absolute(&self) -> Option<&RootedPolynomial> {
        match self {
            Self::Max(parts) => match &parts[..] {
                [Self::Piece(a), Self::Piece(b)] if *b == a.scaled(-1.0) => Some(a),
                _ => None,
            },
            _ => None,
        }
    }
}

/// Joins the parts of two lattices of the same kind in one list.
fn join(
    a: &Lattice,
    b: &Lattice,
    parts: impl for<'a> Fn(&'a Lattice) -> Option<&'a Vec<Lattice>>,
) -> Option<Vec<Lattice>> {
    if a.pieces() + b.pieces() > MOST_PIECES {
        return None;
    }
    let mut all = Vec::new();
    for side in [a, b] {
        match parts(side) {
            Some(parts) => all.extend_from_slice(parts),
            None => all.push(side.clone()),
        }
    }
    Some(all)
}
