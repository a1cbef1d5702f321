//! Cubes outside which a polynomial is positive.
//!
//! Input: a polynomial. Output: half the side of a cube about the origin outside which it is positive. Intervals of its terms
//! on endless boxes say nothing, since large terms cancel; so the outside is seen from infinity: a point is s·w, w on the
//! surface of the cube [−1, 1]³, and the polynomial divided by s^degree is one in w and 1/s, which is small there.

use expr::interval::Interval;
use expr::ops::Binary;
use expr::polynomial::{Polynomial, Region};

use crate::bounds::BoundingBox;

/// The number of boxes on the cube that are tested for one size.
const BOXES: usize = 4096;
/// Cubes are looked for between 2^−LARGEST and 2^LARGEST.
const LARGEST: i32 = 40;

/// A box that contains the region, as far as its polynomials say so.
pub(crate) fn reach(region: &Region) -> Option<BoundingBox> {
    match region {
        Region::Polynomial(p) => {
            let size = glam::DVec3::splat(cube(p)?);
            Some(BoundingBox {
                lower: -size,
                upper: size,
            })
        }
        Region::Field(..) => None,
        Region::All(parts) => parts.iter().filter_map(reach).reduce(|a, b| BoundingBox {
            lower: a.lower.max(b.lower),
            upper: a.upper.min(b.upper),
        }),
        Region::Any(parts) => {
            let mut all = BoundingBox::EMPTY;
            for part in parts {
                all = all.union(&reach(part)?);
            }
            Some(all)
        }
    }
}

fn cube(p: &Polynomial) -> Option<f64> {
    if p.degree() < 2 || p.degree() % 2 == 1 {
        return None;
    }
    // Beyond the largest size nothing is left but the leading terms: where they have a zero, no cube will do.
    let mut least = None;
    for k in (-LARGEST..=LARGEST).rev().step_by(2) {
        let size = f64::from(k).exp2();
        if !positive_outside(p, size) {
            break;
        }
        least = Some(size);
    }
    least
}

fn positive_outside(p: &Polynomial, size: f64) -> bool {
    let small = Interval::new(0.0, 1.0 / size);
    let whole = Interval::new(-1.0, 1.0);
    let mut budget = BOXES;
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            // The two coordinates on the face, and the reciprocal of the size.
            let mut rest = vec![[whole, whole, small]];
            while let Some(part) = rest.pop() {
                if budget == 0 {
                    return false;
                }
                budget -= 1;
                let mut point = [Interval::point(sign); 3];
                point[(axis + 1) % 3] = part[0];
                point[(axis + 2) % 3] = part[1];
                if leading(p, point, part[2]).lower() > 0.0 {
                    continue;
                }
                let share = [part[0].width(), part[1].width(), part[2].width() * size];
                let longest = (0..3)
                    .max_by(|&j, &k| share[j].total_cmp(&share[k]))
                    .unwrap_or(0);
                let [a, b] = [part[longest].lower(), part[longest].upper()];
                for [a, b] in [[a, 0.5 * (a + b)], [0.5 * (a + b), b]] {
                    let mut half = part;
                    half[longest] = Interval::new(a, b);
                    rest.push(half);
                }
            }
        }
    }
    true
}

/// The polynomial at s·`point`, divided by s^degree, where 1/s is `small`.
fn leading(p: &Polynomial, point: [Interval; 3], small: Interval) -> Interval {
    let degree = p.degree() as i32;
    let product = |a, b| Interval::binary(Binary::Mul, a, b);
    let mut sum = Interval::point(0.0);
    for (e, c) in p.terms() {
        let mut term = Interval::point(c);
        let mut order = degree;
        for (e, x) in e.into_iter().zip(point) {
            if e > 0 {
                term = product(term, x.integer_power(i32::from(e)));
            }
            order -= i32::from(e);
        }
        if order > 0 {
            term = product(term, small.integer_power(order));
        }
        sum = Interval::binary(Binary::Add, sum, term);
    }
    sum
}
