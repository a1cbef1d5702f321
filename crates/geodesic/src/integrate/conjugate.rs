//! Conjugate points: the zeros of the Jacobi field of a ray's start, found within the steps on the way (do Carmo,
//! *Differential Geometry of Curves and Surfaces*, 1976, section 5-5).

use super::ray::Ray;
use super::step::RayStep;
use crate::interpolate::cubic;
use crate::runge_kutta::StepParameter;
use crate::surface::Surface;

/// A conjugate point is located to this share of its step.
const SHARP: f64 = 1e-14;

impl<S: Surface + ?Sized> Ray<'_, '_, S> {
    /// Adds the arc lengths of the conjugate points within a step of length `h` that is about to be taken, by
    /// Newton's method on the step's length, kept within a bracket: as exact as the steps are.
    pub(super) fn note_conjugates(&mut self, step: &RayStep, h: f64, pace: StepParameter) {
        let before = self.field;
        let carried = |step: &RayStep| step.propagator.map(|[n, k]| n * before[0] + k * before[1]);
        let after = carried(step);
        // The cubic through both ends tells where to look.
        let m = |share: f64| cubic(share, h, before, after);
        const LOOKS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
        for pair in LOOKS.windows(2) {
            let (from, to) = (m(pair[0]), m(pair[1]));
            // The start itself, where m = 0, is none.
            if from == 0.0 || (from > 0.0) == (to > 0.0) {
                continue;
            }
            let (mut low, mut high) = (pair[0] * h, pair[1] * h);
            let mut at = low + (high - low) * from / (from - to);
            let mut length = self.s;
            for _ in 0..40 {
                if !self.affords_step() {
                    return;
                }
                let Some(part) = self.step(at, pace) else {
                    return;
                };
                let [value, rate] = carried(&part);
                length = self.s + part.length;
                if (value > 0.0) == (from > 0.0) {
                    low = at;
                } else {
                    high = at;
                }
                let newton = at - value / rate;
                let next = if newton >= low && newton <= high {
                    newton
                } else {
                    0.5 * (low + high)
                };
                let moved = (next - at).abs();
                at = next;
                if moved <= SHARP * h || value == 0.0 {
                    break;
                }
            }
            if let Some(found) = &mut self.observers.conjugates {
                found.push(length);
            }
        }
    }
}
