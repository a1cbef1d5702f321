//! Reflection and refraction at a face.
//!
//! Input: unit directions and refractive indices. Output: the reflected and the refracted direction, and the share of
//! unpolarised light that is reflected (Born and Wolf, *Principles of Optics*, section 1.5).

use glam::DVec3;

/// The direction after reflection at a face with this unit normal.
pub fn reflected(direction: DVec3, normal: DVec3) -> DVec3 {
    direction - 2.0 * normal.dot(direction) * normal
}

/// The direction after refraction (Snell), from index `n1` into `n2`, the unit normal on the side that the ray comes from;
/// `None` for total reflection.
pub fn refracted(direction: DVec3, normal: DVec3, n1: f64, n2: f64) -> Option<DVec3> {
    if n1 == n2 {
        return Some(direction);
    }
    let ratio = n1 / n2;
    let cosine = -normal.dot(direction);
    let sine2 = ratio * ratio * (1.0 - cosine * cosine);
    (sine2 <= 1.0).then(|| ratio * direction + (ratio * cosine - (1.0 - sine2).sqrt()) * normal)
}

/// The share of unpolarised light that is reflected where it comes at this cosine from index `n1` to `n2`: 1 at total
/// reflection, 0 between equal indices.
pub fn fresnel(cosine: f64, n1: f64, n2: f64) -> f64 {
    if n1 == n2 {
        return 0.0;
    }
    let sine2 = (n1 / n2) * (n1 / n2) * (1.0 - cosine * cosine);
    if sine2 >= 1.0 {
        return 1.0;
    }
    let inner = (1.0 - sine2).sqrt();
    let across = (n1 * cosine - n2 * inner) / (n1 * cosine + n2 * inner);
    let along = (n1 * inner - n2 * cosine) / (n1 * inner + n2 * cosine);
    0.5 * (across * across + along * along)
}
