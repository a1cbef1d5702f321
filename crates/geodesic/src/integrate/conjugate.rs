//! Conjugate points: the zeros of the Jacobi field of a ray's start, located within the steps (do Carmo, *Differential
//! Geometry of Curves and Surfaces*, 1976, section 5-5).

use super::ray::Ray;
use super::step::RayStep;
use crate::conjugate_search::{ROUNDS, brackets};
use crate::runge_kutta::StepParameter;

impl Ray<'_, '_> {
    /// Adds the arc lengths of the conjugate points within a step of length `h` that is about to be accepted, by
    /// bracketed Newton's method on the step's length. They are as accurate as the steps.
    pub(super) fn note_conjugates(&mut self, step: &RayStep, h: f64, pace: StepParameter) {
        let before = self.field;
        let carried = |step: &RayStep| step.propagator.map(|[n, k]| n * before[0] + k * before[1]);
        let after = carried(step);
        for mut zero in brackets(h, before, after) {
            let mut length = self.s;
            for _ in 0..ROUNDS {
                if !self.affords_step() {
                    return;
                }
                let Some(part) = self.step(zero.at, pace) else {
                    return;
                };
                length = self.s + part.length;
                if zero.narrow(carried(&part), h) {
                    break;
                }
            }
            if let Some(found) = &mut self.observers.conjugates {
                found.push(length);
            }
        }
    }
}
