//! Gradients of polynomials where they may be only rounding.
//!
//! In: a polynomial of degree three or higher, and a point of its surface on a line. Out: a vector along its normal there.
//! The gradient is 0 where several sheets of the surface meet, and also on curves of a smooth surface, as on x³ + y³ = 0,
//! where the normal is that of the surface beside them.

use glam::DVec3;

use crate::line::UnitLine;
use crate::roots::SignChanges;
use crate::surface::PolynomialSurface;

/// The rounding error of a value, as a fraction of the sum of the coefficients' magnitudes: 2⁻⁵⁰.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// The maximum error of the direction of a gradient that is used as it is.
const LARGEST_ERROR: f64 = 5e-6;
/// The distance over which the change of a gradient is measured, in the frame.
const STEP: f64 = 1e-4;
/// The distances of the nearer points beside, in the frame; the other ones are twice as far away.
const BESIDE: [f64; 3] = [1e-3, 3e-3, 1e-2];
/// A line beside is searched for the surface this many times as far along as it is away.
const REACH: f64 = 16.0;

/// Returns the gradient at a place of a line; where it is only rounding, its direction as that of points beside tells it.
pub(super) fn gradient_on(surface: &PolynomialSurface, line: &UnitLine, place: f64) -> DVec3 {
    let at = line.point + place * line.direction;
    let gradient = surface.gradient(at);
    if is_exact(surface, at, gradient) {
        return gradient;
    }
    let (u, v) = line.direction.any_orthonormal_pair();
    let steps = BESIDE.into_iter().flat_map(|step| [step * u, step * v]);
    // The mean of the directions on both sides differs from the direction between them by a multiple of the squared distance,
    // and by higher powers: two means tell the multiple.
    let mean = |step: DVec3| {
        let one = direction_beside(surface, at - step, line.direction, step.length())?;
        let other = direction_beside(surface, at + step, line.direction, step.length())?;
        (one.dot(other) > 0.5).then(|| 0.5 * (one + other))
    };
    let mut directions = steps.filter_map(|step| {
        let [near, far] = [mean(step)?, mean(2.0 * step)?];
        Some(near + (near - far) / 3.0)
    });
    directions.next().unwrap_or(gradient)
}

/// Returns true if rounding hardly changes the direction of the gradient. With values exact to ε, the surface is exact to
/// ε/|∇f|, over which the direction changes by ε|H|/|∇f|².
fn is_exact(surface: &PolynomialSurface, at: DVec3, gradient: DVec3) -> bool {
    let square = gradient.length_squared();
    let size = surface.size();
    let rounding = ROUNDING / LARGEST_ERROR * size;
    // In the frame |H| is at most about n² times the sum of the coefficients.
    let degree = surface.degree() as f64;
    if square > rounding * degree * degree * size {
        return true;
    }
    let changes = DVec3::AXES.map(|axis| surface.gradient(at + STEP * axis) - gradient);
    let largest = changes.map(DVec3::length).into_iter().fold(0.0, f64::max);
    square > rounding * largest / STEP
}

/// Returns the direction of the gradient where a line through a point near the surface meets it.
fn direction_beside(
    surface: &PolynomialSurface,
    point: DVec3,
    direction: DVec3,
    distance: f64,
) -> Option<DVec3> {
    let reach = REACH * distance;
    let changes = SignChanges::between(&surface.along(point, direction), -reach, reach);
    let nearest = |a: &f64, b: &f64| a.abs().total_cmp(&b.abs());
    let place = changes.places().iter().copied().min_by(nearest)?;
    let at = point + place * direction;
    let gradient = surface.gradient(at);
    is_exact(surface, at, gradient).then(|| gradient.try_normalize())?
}
