//! Reflection and refraction at a face.
//!
//! In: unit directions and refractive indices. Out: the reflected and the refracted direction, and the fraction of
//! unpolarised light that is reflected (Born and Wolf, *Principles of Optics*, section 1.5).

use glam::DVec3;

/// Returns the direction after reflection at a face with this unit normal.
pub fn reflected(direction: DVec3, normal: DVec3) -> DVec3 {
    direction - 2.0 * normal.dot(direction) * normal
}

/// Returns the direction after refraction (Snell's law) from index `n1` into `n2`; the unit normal is on the side of the
/// incoming ray. `None` for total reflection.
pub fn refracted(direction: DVec3, normal: DVec3, n1: f64, n2: f64) -> Option<DVec3> {
    if n1 == n2 {
        return Some(direction);
    }
    let ratio = n1 / n2;
    let cosine = -normal.dot(direction);
    let sine2 = ratio * ratio * (1.0 - cosine * cosine);
    (sine2 <= 1.0).then(|| ratio * direction + (ratio * cosine - (1.0 - sine2).sqrt()) * normal)
}

/// Returns the fraction of unpolarised light that is reflected at this cosine of incidence from index `n1` to `n2`: 1 for
/// total reflection, 0 between equal indices.
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
