//! The numbers that lanes are made of: f64, or f32, to compare how fast and how exact single precision is.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

use expr::{elementary, ops};

use super::single;

/// A number that expressions can be evaluated in. Functions over lanes are those of [`expr::elementary`], or
/// their counterparts in this precision.
pub(super) trait Real:
    Copy
    + Debug
    + Default
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Into<f64>
    + Send
    + Sync
    + 'static
{
    /// 1.
    const ONE: Self;
    /// The nearest number of this precision.
    fn nearest(x: f64) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
    /// The absolute value.
    fn abs(self) -> Self;
    /// The inverse sine.
    fn asin(self) -> Self;
    /// The inverse cosine.
    fn acos(self) -> Self;
    /// The inverse tangent.
    fn atan(self) -> Self;
    /// A power, as the table of operations defines it.
    fn power(self, exponent: Self) -> Self;
    /// Sine and cosine.
    fn sin_cos<const W: usize>(x: &[Self; W]) -> ([Self; W], [Self; W]);
    /// Tangent.
    fn tan<const W: usize>(x: &[Self; W]) -> [Self; W];
    /// The exponential function.
    fn exp<const W: usize>(x: &[Self; W]) -> [Self; W];
    /// Natural logarithm.
    fn log<const W: usize>(x: &[Self; W]) -> [Self; W];
    /// Hyperbolic sine and cosine.
    fn sinh_cosh<const W: usize>(x: &[Self; W]) -> ([Self; W], [Self; W]);
    /// Hyperbolic tangent.
    fn tanh<const W: usize>(x: &[Self; W]) -> [Self; W];
}

macro_rules! real {
    ($number:ident, $functions:path, |$x:ident| $nearest:expr, |$base:ident, $exponent:ident| $power:expr) => {
        impl Real for $number {
            const ONE: Self = 1.0;

            #[inline(always)]
            fn nearest($x: f64) -> Self {
                $nearest
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                self.sqrt()
            }

            #[inline(always)]
            fn abs(self) -> Self {
                self.abs()
            }

            #[inline(always)]
            fn asin(self) -> Self {
                self.asin()
            }

            #[inline(always)]
            fn acos(self) -> Self {
                self.acos()
            }

            #[inline(always)]
            fn atan(self) -> Self {
                self.atan()
            }

            #[inline(always)]
            fn power(self, $exponent: Self) -> Self {
                let $base = self;
                $power
            }

            #[inline(always)]
            fn sin_cos<const W: usize>(x: &[Self; W]) -> ([Self; W], [Self; W]) {
                use $functions as functions;
                functions::sin_cos(x)
            }

            #[inline(always)]
            fn tan<const W: usize>(x: &[Self; W]) -> [Self; W] {
                use $functions as functions;
                functions::tan(x)
            }

            #[inline(always)]
            fn exp<const W: usize>(x: &[Self; W]) -> [Self; W] {
                use $functions as functions;
                functions::exp(x)
            }

            #[inline(always)]
            fn log<const W: usize>(x: &[Self; W]) -> [Self; W] {
                use $functions as functions;
                functions::log(x)
            }

            #[inline(always)]
            fn sinh_cosh<const W: usize>(x: &[Self; W]) -> ([Self; W], [Self; W]) {
                use $functions as functions;
                functions::sinh_cosh(x)
            }

            #[inline(always)]
            fn tanh<const W: usize>(x: &[Self; W]) -> [Self; W] {
                use $functions as functions;
                functions::tanh(x)
            }
        }
    };
}

real!(f64, elementary, |x| x, |x, y| ops::power(x, y));
real!(f32, single, |x| x as f32, |x, y| {
    // Rare: by way of f64.
    ops::power(f64::from(x), f64::from(y)) as f32
});
