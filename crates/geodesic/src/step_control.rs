//! The control of a ray's steps, of one ray as of each of several side by side: their lengths from their errors, and what
//! the errors of all of them come to.

/// The choice of each step's length from the errors of the steps before it.
///
/// The next length is 0.9 h e^(−1/q) for the error e of this step over the one allowed and the order q (Hairer, Nørsett,
/// Wanner, *Solving Ordinary Differential Equations I*, 2nd edition, section II.4), or less where the errors have been
/// growing from step to step (Gustafsson, ACM TOMS 20, 1994, pages 496–517).
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepControl {
    /// The size of the step before; 0 before the first.
    last_step: f64,
    /// e^(−1/q) of the step before.
    last_root: f64,
    /// The same of the step that is being tried.
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
    /// Judges a step by `root`, which is e^(−1/q): the factor to the size of the next one, `most` at most, or, as an error,
    /// to that of another attempt.
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

    /// The factor beside that, where steps below `short` have something singular near by: steps that have been shrinking
    /// towards it will go on to shrink.
    pub(crate) fn trend(&self, h: f64, short: f64) -> f64 {
        if h < self.last_step && h < short {
            (h / self.last_step).max(0.5)
        } else {
            1.0
        }
    }

    /// The largest factor that is to be expected to do: as the error has been growing from step to step, it will go on to
    /// grow.
    pub(crate) fn foreseen(&self, h: f64, root: f64) -> f64 {
        let factor = 0.9 * root;
        if self.last_step > 0.0 {
            (factor * (h / self.last_step) * (root / self.last_root)).max(0.5 * factor)
        } else {
            factor
        }
    }

    /// Takes note of a step that has been taken.
    pub(crate) fn accept(&mut self, h: f64) {
        self.last_step = h;
        self.last_root = self.this_root;
    }

    /// Forgets the step before: it says nothing about those to come.
    pub(crate) fn forget(&mut self) {
        self.last_step = 0.0;
    }
}

/// A step shorter than this share of the ray's own scale is not worth taking.
pub(crate) const SHORTEST: f64 = 1e-13;
/// The tolerance is for steps no shorter than this share of the ray's scale.
pub(crate) const SMALL_STEP: f64 = 0.005;
/// A step shorter than this share of the ray's scale means that a singularity is near.
pub(crate) const SHORT: f64 = 0.01;
/// The relative error that an evaluation's rounding may add to a step: the floor of the tolerance.
pub(crate) const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// The factor to a step that runs where the surface is undefined.
pub(crate) const UNDEFINED: f64 = 0.25;
/// The largest factor from one step to the next.
const GROWTH: f64 = 5.0;

/// The length to try where a step may be `h` long and so much of the way remains: two steps of equal length rather than a
/// long one and a sliver.
pub(crate) fn step_to_try(h: f64, remaining: f64) -> f64 {
    if h >= remaining {
        remaining
    } else if 2.0 * h > remaining {
        0.5 * remaining
    } else {
        h
    }
}

/// The length of the next step, where `h` was allowed, `tried` was taken, and the error of that suggests `next`: a step cut
/// short by the end says little about the next.
pub(crate) fn step_after(h: f64, tried: f64, next: f64) -> f64 {
    if tried < h {
        next.max(h.min(2.0 * next))
    } else {
        next
    }
}

/// The covariance of the error sideways and in direction: errors of the steps, carried on by the Jacobi fields.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ErrorSum {
    position: f64,
    mixed: f64,
    direction: f64,
    terms: f64,
}

impl ErrorSum {
    /// Adds a step's errors to those before it, which its fields, [[n, m], [n', m']], carry on.
    pub(crate) fn add(&mut self, [[n, m], [n1, m1]]: [[f64; 2]; 2], position: f64, direction: f64) {
        let (p, x, d) = (self.position, self.mixed, self.direction);
        self.position = n * n * p + 2.0 * n * m * x + m * m * d + position * position;
        self.mixed = n * n1 * p + (n * m1 + m * n1) * x + m * m1 * d;
        self.direction = n1 * n1 * p + 2.0 * n1 * m1 * x + m1 * m1 * d + direction * direction;
        self.terms += 1.0;
    }

    /// The standard deviation of the position, were the steps' errors independent.
    pub(crate) fn deviation(&self) -> f64 {
        self.position.max(0.0).sqrt()
    }

    /// A bound for errors that may all have one sign (Cauchy and Schwarz).
    pub(crate) fn bound(&self) -> f64 {
        if self.position.is_nan() {
            return f64::INFINITY;
        }
        (self.terms * self.position.max(0.0)).sqrt()
    }
}
