//! The sign changes of a polynomial of one variable.
//!
//! In: coefficients, the constant first. Out: the points of sign change in ascending order. Between two of them the sign is
//! constant, and at each of them it changes, whatever the rounding. Quadratics are solved in closed form. For higher
//! degrees, coefficients in the Bernstein basis isolate the roots (G. E. Collins and A. G. Akritas, SYMSAC 1976); near
//! multiple roots the critical points do so, from those of the derivatives in turn. Newton's method finds each root inside
//! its bracket. The closed forms of the crates `roots` and `kurbo` are faster for quartics, but near double roots their
//! number of roots may be odd although the signs at the ends agree, which turns a solid inside out.

/// The highest supported degree.
pub(crate) const LARGEST_DEGREE: usize = expr::polynomial::LARGEST_DEGREE;

/// Coefficients, the constant first; those above the degree are 0.
pub(crate) type Coefficients = [f64; LARGEST_DEGREE + 1];

/// The points where the sign of a polynomial changes, at most `MOST`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SignChanges<const MOST: usize = { LARGEST_DEGREE + 2 }> {
    places: [f64; MOST],
    count: usize,
    /// True if the polynomial is not positive before the first point.
    pub(crate) inside_first: bool,
}

/// The sign changes of a polynomial of degree at most two.
pub(crate) type QuadraticChanges = SignChanges<2>;

/// The number of bisection steps with Bernstein coefficients.
const HALVINGS: usize = 6;
/// Beyond this value, the reciprocal of the variable is solved for.
const FAR: f64 = 2.0;

impl<const MOST: usize> Default for SignChanges<MOST> {
    fn default() -> Self {
        Self {
            places: [0.0; MOST],
            count: 0,
            inside_first: false,
        }
    }
}

impl<const MOST: usize> SignChanges<MOST> {
    /// Returns the change of c + b·s.
    #[inline]
    pub(crate) fn of_linear([c, b]: [f64; 2]) -> Self {
        let mut changes = Self::default();
        if b == 0.0 {
            changes.inside_first = c <= 0.0;
        } else {
            changes.inside_first = b > 0.0;
            changes.push(-c / b);
        }
        changes
    }

    /// Returns the changes of c + b·s + a·s²; `MOST` is at least 2.
    #[inline]
    pub(crate) fn of_quadratic([c, b, a]: [f64; 3]) -> Self {
        if a == 0.0 {
            return Self::of_linear([c, b]);
        }
        let mut changes = Self {
            inside_first: a < 0.0,
            ..Self::default()
        };
        let discriminant = b * b - 4.0 * a * c;
        if discriminant > 0.0 {
            let q = -0.5 * (b + discriminant.sqrt().copysign(b));
            // Both are numbers: q is not 0 if the discriminant is positive.
            let [s, r] = [q / a, c / q];
            changes.push(s.min(r));
            changes.push(s.max(r));
        }
        changes
    }

    /// Returns the points in ascending order.
    pub(crate) fn places(&self) -> &[f64] {
        &self.places[..self.count]
    }

    /// Returns true if the polynomial is not positive immediately after `place`.
    pub(crate) fn inside_after(&self, place: f64) -> bool {
        let before = self.places().iter().filter(|&&s| s <= place).count();
        self.inside_first != (before % 2 == 1)
    }

    /// Returns true if the polynomial is not positive after the last point.
    fn inside_last(&self) -> bool {
        self.inside_first != (self.count % 2 == 1)
    }

    /// Replaces the points by others in the same order.
    pub(crate) fn map(&mut self, f: impl Fn(f64) -> f64) {
        for place in &mut self.places[..self.count] {
            *place = f(*place);
        }
    }

    fn push(&mut self, place: f64) {
        if self.count < self.places.len() {
            self.places[self.count] = place;
            self.count += 1;
        }
    }
}

impl QuadraticChanges {
    /// Returns the part of the line, perhaps unbounded, on which the polynomial is not positive, or with `opposite`
    /// positive; `None` if there is none. The part is that of a convex set: if rounding has bent the polynomial the other
    /// way, the farther one of two parts does not count.
    #[inline]
    pub(crate) fn convex_part(&self, opposite: bool) -> Option<[f64; 2]> {
        let inside_first = self.inside_first != opposite;
        match (self.places(), inside_first) {
            (&[s, t], false) => Some([s, t]),
            (&[s, t], true) if s.abs() < t.abs() => Some([f64::NEG_INFINITY, s]),
            (&[s], false) | (&[_, s], true) => Some([s, f64::INFINITY]),
            (&[s], true) => Some([f64::NEG_INFINITY, s]),
            (_, true) => Some([f64::NEG_INFINITY, f64::INFINITY]),
            (_, false) => None,
        }
    }
}

impl SignChanges {
    /// Returns all changes on the whole line.
    pub(crate) fn everywhere(p: &Coefficients) -> Self {
        let degree = degree(p);
        if degree <= 2 {
            return Self::of_quadratic([p[0], p[1], p[2]]);
        }
        let [mut above, mut below] = [[0.0; LARGEST_DEGREE + 1]; 2];
        for k in 0..=degree {
            above[k] = p[degree - k];
            below[k] = if k % 2 == 0 { above[k] } else { -above[k] };
        }
        // Beyond `FAR` the variable is the reciprocal, and before −`FAR` its opposite, so that infinity is at 0, where the
        // leading coefficient is the value without rounding.
        let below = Self::between(&below, 0.0, 1.0 / FAR);
        let near = Self::between(p, -FAR, FAR);
        let above = Self::between(&above, 0.0, 1.0 / FAR);
        let mut changes = Self {
            inside_first: below.inside_first != (degree % 2 == 1),
            ..Self::default()
        };
        for &u in below.places() {
            changes.push(-1.0 / u);
        }
        // Rounding may move a change at a common end of two parts to either side.
        if changes.inside_last() != near.inside_first {
            changes.push(-FAR);
        }
        for &s in near.places() {
            changes.push(s);
        }
        if changes.inside_last() != above.inside_last() {
            changes.push(FAR);
        }
        for &u in above.places().iter().rev() {
            changes.push(1.0 / u);
        }
        changes
    }

    /// Returns the changes between two points.
    pub(crate) fn between(p: &Coefficients, from: f64, to: f64) -> Self {
        let degree = degree(p);
        if degree <= 2 {
            let all = Self::of_quadratic([p[0], p[1], p[2]]);
            let mut changes = Self {
                inside_first: all.inside_after(from),
                ..Self::default()
            };
            for &s in all.places().iter().filter(|&&s| s > from && s <= to) {
                changes.push(s);
            }
            return changes;
        }
        let mut changes = Self::default();
        // Loops of constant length are unrolled.
        let isolate = match degree {
            3 => isolate::<4>,
            4 => isolate::<5>,
            5 => isolate::<6>,
            6 => isolate::<7>,
            7 => isolate::<8>,
            8 => isolate::<9>,
            9 => isolate::<10>,
            10 => isolate::<11>,
            11 => isolate::<12>,
            _ => isolate::<{ LARGEST_DEGREE + 1 }>,
        };
        isolate(p, [from, to], &mut changes);
        changes
    }

    /// Returns the changes between two points, from those of the derivatives: each is between two critical points.
    fn between_critical(p: &Coefficients, degree: usize, from: f64, to: f64) -> Self {
        let mut critical = Self::between(&derivative(p, degree, degree - 2), from, to);
        for k in (0..degree - 2).rev() {
            let p = &derivative(p, degree, k);
            let count = degree - k;
            let mut changes = Self::default();
            let mut a = from;
            let mut inside = value(p, count, a) <= 0.0;
            changes.inside_first = inside;
            for index in 0..=critical.count {
                let b = if index < critical.count {
                    critical.places[index]
                } else {
                    to
                };
                let at_b = value(p, count, b);
                // An extremum that is only rounding has no sign: a triple root is one change, a double root none.
                if k == 0 && index < critical.count && at_b.abs() <= rounding(p, count, b) {
                    continue;
                }
                let inside_b = at_b <= 0.0;
                if inside != inside_b {
                    changes.push(root(p, count, [a, b], 0.5 * (a + b), inside));
                }
                (a, inside) = (b, inside_b);
            }
            critical = changes;
        }
        critical
    }
}

/// Finds the changes between two points by the signs of Bernstein coefficients: no sign change in the sequence means no
/// root, one means one root; otherwise the part is halved. Parts that stay open, near multiple roots, are left to the
/// derivatives. The degree is N − 1.
fn isolate<const N: usize>(p: &Coefficients, [from, to]: [f64; 2], changes: &mut SignChanges) {
    let degree = N - 1;
    let mut stack = [([0.0; N], from, to, 0); HALVINGS + 1];
    stack[0].0 = bernstein(p, from, to);
    let mut count = 1;
    changes.inside_first = stack[0].0[0] <= 0.0;
    let mut inside = changes.inside_first;
    while count > 0 {
        let (part, a, b, depth) = stack[count - 1];
        count -= 1;
        let mut variations = 0;
        let mut before = part[0] <= 0.0;
        for &c in &part[1..] {
            variations += usize::from((c <= 0.0) != before);
            before = c <= 0.0;
        }
        if variations > 1 && depth < HALVINGS {
            // De Casteljau's algorithm.
            let (mut left, mut right) = (part, part);
            for (k, first) in left.iter_mut().enumerate().skip(1) {
                for j in 0..N - k {
                    right[j] = 0.5 * (right[j] + right[j + 1]);
                }
                *first = right[0];
            }
            let middle = 0.5 * (a + b);
            stack[count] = (right, middle, b, depth + 1);
            stack[count + 1] = (left, a, middle, depth + 1);
            count += 2;
            continue;
        }
        let critical;
        let only;
        let (inside_first, places) = match variations {
            0 => (part[0] <= 0.0, &[][..]),
            1 => {
                let inside_first = part[0] <= 0.0;
                let start = a + (b - a) * polygon_root(&part);
                only = [root(p, degree, [a, b], start, inside_first)];
                (inside_first, &only[..])
            }
            _ => {
                critical = SignChanges::between_critical(p, degree, a, b);
                (critical.inside_first, critical.places())
            }
        };
        // Rounding may move the sign change at a common point of two parts to either side.
        if inside_first != inside {
            changes.push(a);
            inside = inside_first;
        }
        for &s in places {
            changes.push(s);
            inside = !inside;
        }
    }
}

/// Returns the point from 0 to 1, near the root, where the polygon of Bernstein coefficients changes its sign, which it does
/// once.
fn polygon_root<const N: usize>(part: &[f64; N]) -> f64 {
    let before = part
        .windows(2)
        .position(|pair| (pair[0] <= 0.0) != (pair[1] <= 0.0));
    let Some(k) = before else { return 0.5 };
    let share = part[k] / (part[k] - part[k + 1]);
    (k as f64 + share) / (N - 1) as f64
}

/// Returns the Bernstein coefficients between two points, for the degree N − 1.
fn bernstein<const N: usize>(p: &Coefficients, from: f64, to: f64) -> [f64; N] {
    let degree = N - 1;
    let mut q = [0.0; N];
    q.copy_from_slice(&p[..N]);
    for k in 0..degree {
        for j in (k..degree).rev() {
            q[j] += from * q[j + 1];
        }
    }
    // In the part's own variable from 0 to 1, divided by the binomial coefficients.
    let (mut power, mut binomial) = (1.0, 1.0);
    for (k, q) in q.iter_mut().enumerate() {
        *q *= power / binomial;
        power *= to - from;
        binomial = binomial * (degree - k) as f64 / (k + 1) as f64;
    }
    for k in 1..=degree {
        for j in (k..=degree).rev() {
            q[j] += q[j - 1];
        }
    }
    q
}

/// Returns the polynomial divided by s − `root` without the remainder; the division starts at the end that is stable.
pub(crate) fn deflated<const N: usize>(p: &[f64; N], root: f64) -> [f64; N] {
    let degree = degree(p);
    let mut quotient = [0.0; N];
    if degree == 0 {
        return quotient;
    }
    if root.abs() <= 1.0 {
        let mut carried = 0.0;
        for k in (1..=degree).rev() {
            carried = p[k] + carried * root;
            quotient[k - 1] = carried;
        }
    } else {
        let mut carried = 0.0;
        for k in 0..degree {
            carried = (carried - p[k]) / root;
            quotient[k] = carried;
        }
    }
    quotient
}

/// Returns the derivative of order `order`.
fn derivative(p: &Coefficients, degree: usize, order: usize) -> Coefficients {
    let mut derivative = [0.0; LARGEST_DEGREE + 1];
    for k in order..=degree {
        let falling: usize = (k - order + 1..=k).product();
        derivative[k - order] = p[k] * falling as f64;
    }
    derivative
}

/// Returns the degree; a leading coefficient that is negligible beside the others counts as 0.
fn degree(p: &[f64]) -> usize {
    let largest = p.iter().fold(0.0f64, |most, c| most.max(c.abs()));
    p.iter()
        .rposition(|c| c.abs() > largest * 1e-17)
        .unwrap_or(0)
}

fn value(p: &Coefficients, degree: usize, s: f64) -> f64 {
    p[..=degree].iter().rev().fold(0.0, |sum, c| sum * s + c)
}

/// Returns a bound of the error of a value from rounding, that of the coefficients included.
fn rounding(p: &Coefficients, degree: usize, s: f64) -> f64 {
    let size = p[..=degree]
        .iter()
        .rev()
        .fold(0.0, |sum, c| sum * s.abs() + c.abs());
    16.0 * f64::EPSILON * size
}

/// Returns the root between `a` and `b`, where the signs differ, starting from a point between them.
fn root(
    p: &Coefficients,
    degree: usize,
    [mut a, mut b]: [f64; 2],
    start: f64,
    inside_a: bool,
) -> f64 {
    let mut s = start;
    for _ in 0..64 {
        let (mut y, mut slope) = (0.0, 0.0);
        for &c in p[..=degree].iter().rev() {
            slope = slope * s + y;
            y = y * s + c;
        }
        if (y <= 0.0) == inside_a {
            a = s;
        } else {
            b = s;
        }
        let next = s - y / slope;
        let (low, high) = (a.min(b), a.max(b));
        let next = if next > low && next < high {
            next
        } else {
            0.5 * (low + high)
        };
        let step = (next - s).abs();
        s = next;
        if step <= f64::EPSILON * s.abs().max(1e-3) {
            break;
        }
    }
    s
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Double roots, and leading coefficients that are nothing but rounding.
    #[test]
    fn the_signs_between_changes_are_those_of_the_values() {
        let mut state = 1_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for case in 0..20_000 {
            let a = match case % 3 {
                0 => 1.0,
                _ => (6.0 * random()).exp2() / 8.0,
            };
            let scale = [-1.0, 1.0][case % 2] * (0.1 + 2.0 * random());
            // scale·(t² − a²)², and with every other one the factor t − b.
            let mut p: Coefficients = [0.0; LARGEST_DEGREE + 1];
            (p[0], p[2], p[4]) = (scale * a.powi(4), -2.0 * scale * a * a, scale);
            if case % 4 < 2 {
                let b = 8.0 * random() - 4.0;
                for k in (0..=5).rev() {
                    p[k] = p[k.max(1) - 1] * f64::from(k > 0) - b * p[k];
                }
            }
            for coefficient in &mut p[..7] {
                if random() < 0.5 {
                    *coefficient += (random() - 0.5) * 4e-16;
                }
            }
            let changes = SignChanges::everywhere(&p);
            let places = changes.places();
            assert!(places.is_sorted(), "{p:?}: {places:?}");
            let sizes = p.map(f64::abs);
            for t in [
                -1e4, -30.0, -5.0, -1.5, -0.7, 0.0, 0.1, 0.99, 1.01, 2.5, 10.0, 1e4,
            ] {
                let [at, size] = [value(&p, 6, t), value(&sizes, 6, f64::abs(t))];
                if at.abs() > 1e-13 * size {
                    let inside = changes.inside_after(t);
                    assert_eq!(inside, at <= 0.0, "{p:?} at {t}: {places:?}");
                }
            }
        }
    }
}
