//! Types for pairs of numbers: a point of the chart, a tangent vector there, a point of the picture.
//!
//! Signatures between modules use these types, so that a point cannot be passed as a vector. Inner loops unwrap them
//! once and work on arrays. `glam` is not used because it has one type for all three.

use std::ops::{Add, Index, IndexMut, Mul, Neg, Sub};

macro_rules! pair {
    ($(#[doc = $doc:literal])+ $name:ident) => {
        $(#[doc = $doc])+
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        #[repr(transparent)]
        pub struct $name(pub [f64; 2]);

        impl $name {
            /// Returns whether neither number is NaN or infinite.
            #[inline(always)]
            pub fn is_finite(self) -> bool {
                self.0[0].is_finite() && self.0[1].is_finite()
            }

            /// Applies a function to both numbers.
            #[inline(always)]
            pub fn map(self, f: impl FnMut(f64) -> f64) -> Self {
                Self(self.0.map(f))
            }
        }

        impl From<[f64; 2]> for $name {
            #[inline(always)]
            fn from(numbers: [f64; 2]) -> Self {
                Self(numbers)
            }
        }

        impl From<$name> for [f64; 2] {
            #[inline(always)]
            fn from($name(numbers): $name) -> Self {
                numbers
            }
        }

        impl PartialEq<[f64; 2]> for $name {
            fn eq(&self, other: &[f64; 2]) -> bool {
                self.0 == *other
            }
        }

        impl Index<usize> for $name {
            type Output = f64;

            #[inline(always)]
            fn index(&self, axis: usize) -> &f64 {
                &self.0[axis]
            }
        }

        impl IndexMut<usize> for $name {
            #[inline(always)]
            fn index_mut(&mut self, axis: usize) -> &mut f64 {
                &mut self.0[axis]
            }
        }
    };
}

pair! {
    /// A point of the chart: the parameters (u, v), in the chart's own units.
    Uv
}

pair! {
    /// A tangent vector at a point of the chart, by its components along σu and σv: (u', v').
    TangentVector
}

pair! {
    /// A point of the picture: [−1, 1] spans the shorter side, x to the right, y up.
    PicturePoint
}

impl Sub for Uv {
    type Output = TangentVector;

    #[inline(always)]
    fn sub(self, from: Self) -> TangentVector {
        TangentVector([self[0] - from[0], self[1] - from[1]])
    }
}

impl Add<TangentVector> for Uv {
    type Output = Self;

    #[inline(always)]
    fn add(self, way: TangentVector) -> Self {
        Self([self[0] + way[0], self[1] + way[1]])
    }
}

impl Add for TangentVector {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self([self[0] + other[0], self[1] + other[1]])
    }
}

impl Sub for TangentVector {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self([self[0] - other[0], self[1] - other[1]])
    }
}

impl Mul<TangentVector> for f64 {
    type Output = TangentVector;

    #[inline(always)]
    fn mul(self, vector: TangentVector) -> TangentVector {
        vector.map(|x| self * x)
    }
}

impl Neg for TangentVector {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|x| -x)
    }
}
