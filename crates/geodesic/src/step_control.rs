//! The control of a ray's steps, for one ray or each of several side by side: the lengths of steps from their errors, and
//! the total of the errors.

/// The choice of each step's length from the errors of the steps before it.
///
/// The next length is 0.9 h e^(−1/q) for the error e of this step over the one allowed and the order q (Hairer, Nørsett,
/// Wanner, *Solving Ordinary Differential Equations I*, 2nd edition, section II.4), or less where the errors have been
/// growing from step to step (Gustafsson, ACM TOMS 20, 1994, pages 496–517).
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepControl {
    /// The size of the previous step; 0 before the first.
    last_step: f64,
    /// e^(−1/q) of the previous step.
    last_root: f64,
    /// e^(−1/q) of the step being tried.
    this_root: f64,
}

impl Default for StepControl {
    fn default() -> Self {
        Self {
            last_step: 0.0,
            last_root: 1.0,
            this_root: 1.0,
        }
    }
}

impl StepControl {
    /// Judges a step by `root`, which is e^(−1/q). Returns the factor from its size to that of the next one, at most
    /// `most`; or, as an error, the factor to that of another attempt.
    #[inline(always)]
    pub(crate) fn judge(&mut self, root: f64, most: f64) -> Result<f64, f64> {
        if root.is_nan() {
            return Err(UNDEFINED);
        }
        let factor = 0.9 * root;
        if root < 1.0 {
            return Err(factor.max(0.1));
        }
        self.this_root = root;
        Ok(factor.min(most).min(GROWTH))
    }

    /// Returns an additional factor for steps below `short`, which indicate a nearby singularity: steps that have been
    /// shrinking towards it will continue to shrink.
    pub(crate) fn trend(&self, h: f64, short: f64) -> f64 {
        if h < self.last_step && h < short {
            (h / self.last_step).max(0.5)
        } else {
            1.0
        }
    }

    /// Returns the largest factor that is expected to succeed: an error that has been growing from step to step will
    /// continue to grow.
    pub(crate) fn foreseen(&self, h: f64, root: f64) -> f64 {
        let factor = 0.9 * root;
        if self.last_step > 0.0 {
            (factor * (h / self.last_step) * (root / self.last_root)).max(0.5 * factor)
        } else {
            factor
        }
    }

    /// Records an accepted step.
    pub(crate) fn accept(&mut self, h: f64) {
        self.last_step = h;
        self.last_root = self.this_root;
    }

    /// Forgets the previous step: it does not predict the following ones.
    pub(crate) fn forget(&mut self) {
        self.last_step = 0.0;
    }
}

/// The minimum length of a step, as a fraction of the ray's own scale.
pub(crate) const SHORTEST: f64 = 1e-13;
/// The tolerance applies to steps no shorter than this fraction of the ray's scale.
pub(crate) const SMALL_STEP: f64 = 0.005;
/// A step shorter than this fraction of the ray's scale indicates a nearby singularity.
pub(crate) const SHORT: f64 = 0.01;
/// The relative error that an evaluation's rounding may add to a step: the floor of the tolerance.
pub(crate) const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// The factor on a step that reaches where the surface is undefined.
pub(crate) const UNDEFINED: f64 = 0.25;
/// The largest factor from one step to the next.
const GROWTH: f64 = 5.0;

/// Returns the length to try where a step may be `h` long and `remaining` is left: two steps of equal length rather than
/// a long one and a sliver.
pub(crate) fn step_to_try(h: f64, remaining: f64) -> f64 {
    if h >= remaining {
        remaining
    } else if 2.0 * h > remaining {
        0.5 * remaining
    } else {
        h
    }
}

/// Returns the length of the next step, where `h` was allowed, `tried` was taken, and its error suggests `next`: a step cut
/// short by the end predicts little about the next.
pub(crate) fn step_after(h: f64, tried: f64, next: f64) -> f64 {
    if tried < h {
        next.max(h.min(2.0 * next))
    } else {
        next
    }
}

/// The covariance of the errors in position and in direction: the steps' errors, propagated by the Jacobi fields.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ErrorSum {
    position: f64,
    mixed: f64,
    direction: f64,
    terms: f64,
}

impl ErrorSum {
    /// Adds a step's errors to the earlier ones, which its fields, [[n, m], [n', m']], propagate.
    pub(crate) fn add(&mut self, [[n, m], [n1, m1]]: [[f64; 2]; 2], position: f64, direction: f64) {
        let (p, x, d) = (self.position, self.mixed, self.direction);
        self.position = n * n * p + 2.0 * n * m * x + m * m * d + position * position;
        self.mixed = n * n1 * p + (n * m1 + m * n1) * x + m * m1 * d;
        self.direction = n1 * n1 * p + 2.0 * n1 * m1 * x + m1 * m1 * d + direction * direction;
        self.terms += 1.0;
    }

    /// Returns the standard deviation of the position if the steps' errors are independent.
    pub(crate) fn deviation(&self) -> f64 {
        self.position.max(0.0).sqrt()
    }

    /// Returns a bound for errors that may all have the same sign (Cauchy–Schwarz).
    pub(crate) fn bound(&self) -> f64 {
        if self.position.is_nan() {
            return f64::INFINITY;
        }
        (self.terms * self.position.max(0.0)).sqrt()
    }
}
