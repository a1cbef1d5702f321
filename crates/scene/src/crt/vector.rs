//! Vectors of three numbers: differences, unit vectors and perpendicular vectors.

use geodesic::vector::{cross, norm};

/// Returns `a − b`.
pub(super) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Returns `by·a`.
pub(super) fn scaled(a: [f64; 3], by: f64) -> [f64; 3] {
    a.map(|x| x * by)
}

/// Returns the unit vector; `None` if it has no direction.
pub(super) fn unit(a: [f64; 3]) -> Option<[f64; 3]> {
    let length = norm(a);
    length.is_normal().then(|| scaled(a, 1.0 / length))
}

/// Returns two unit vectors perpendicular to a unit vector and to each other.
pub(super) fn across(z: [f64; 3]) -> [[f64; 3]; 2] {
    let least = (0..3).min_by(|&i, &j| z[i].abs().total_cmp(&z[j].abs()));
    let mut axis = [0.0; 3];
    axis[least.unwrap_or(0)] = 1.0;
    let x = unit(cross(axis, z)).unwrap_or([1.0, 0.0, 0.0]);
    [x, cross(z, x)]
}
