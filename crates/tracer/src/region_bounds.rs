//! Boxes outside which a polynomial is positive.
//!
//! In: a polynomial. Out: if it is of degree 2 and bounds an ellipsoid, the ellipsoid's box in closed form; otherwise half
//! the side of a cube about the origin outside which it is positive. Intervals of its terms on unbounded boxes are useless,
//! since large terms cancel; so the outside is seen from infinity: a point is s·w, with w on the surface of the cube [−1,
//! 1]³, and the polynomial divided by s^degree is one in w and 1/s, which is small there.

use expr::interval::Interval;
use expr::ops::Binary;
use expr::polynomial::{Polynomial, Region};
use glam::{DMat3, DVec3};

use crate::bounds::{BoundingBox, LARGEST_EXPONENT, SMALLEST_EXPONENT, USUAL_EXPONENT, WorkBudget};

/// The maximum number of boxes on the cube that are tested for one size.
const BOXES: usize = 4096;
/// The number of operations for a term on intervals.
const TERM: u64 = 6;
/// The steps of the exponents of cubes' sizes: of large ones, and of usual ones.
const COARSE: i32 = 40;
const FINE: i32 = 2;

/// A pivot of a quadratic form below this fraction of the largest coefficient counts as 0.
const FLATTEST: f64 = 1e-9;
/// The box of an ellipsoid is enlarged by this fraction of its size and distance.
const MARGIN: f64 = 1e-9;

/// Returns the box of the ellipsoid whose interior is the region; `None` for other regions.
///
/// With f = xᵀAx + 2bᵀx + c, A positive definite, the centre is m = −A⁻¹b, and with r = bᵀA⁻¹b − c half the side along axis
/// k is √(r (A⁻¹)ₖₖ), where the gradient of f is along that axis.
pub(crate) fn ellipsoid(region: &Region) -> Option<BoundingBox> {
    let Region::Polynomial(p) = region else {
        return None;
    };
    if p.degree() != 2 {
        return None;
    }
    let mut form = DMat3::ZERO;
    let (mut linear, mut constant) = (DVec3::ZERO, 0.0);
    for (exponents, coefficient) in p.terms() {
        let axes: Vec<usize> = (0..3)
            .flat_map(|k| std::iter::repeat_n(k, usize::from(exponents[k])))
            .collect();
        match axes[..] {
            [] => constant += coefficient,
            [j] => linear[j] += 0.5 * coefficient,
            [j, k] => {
                form.col_mut(j)[k] += 0.5 * coefficient;
                form.col_mut(k)[j] += 0.5 * coefficient;
            }
            _ => return None,
        }
    }
    let largest = form
        .to_cols_array()
        .into_iter()
        .fold(0.0, |a: f64, b| a.max(b.abs()));
    let least = FLATTEST * largest;
    // Pivots of the elimination: the form is positive definite exactly if all are positive.
    let [a, b, c] = [form.x_axis, form.y_axis, form.z_axis];
    let second = a.x * b.y - a.y * a.y;
    let is_definite = a.x > least && second > least * a.x && form.determinant() > least * second;
    if !(is_definite && b.y > least && c.z > least) {
        return None;
    }
    let inverse = form.inverse();
    let centre = -(inverse * linear);
    let square = -linear.dot(centre) - constant;
    let sides = DVec3::new(inverse.x_axis.x, inverse.y_axis.y, inverse.z_axis.z) * square;
    if !(square > 0.0 && sides.min_element() > 0.0 && sides.is_finite() && centre.is_finite()) {
        return None;
    }
    let half = DVec3::from_array(sides.to_array().map(f64::sqrt));
    let half = half + MARGIN * (half + centre.abs());
    Some(BoundingBox {
        lower: centre - half,
        upper: centre + half,
    })
}

/// Parts of the cube are halved down to this size if several polynomials bound a set together.
const FINEST: f64 = 1.0 / 128.0;

/// Returns a box that contains the region, as far as its polynomials show, each by itself or all together; `None` once
/// `work` is used up.
pub(crate) fn region_bounds(region: &Region, work: &WorkBudget) -> Option<BoundingBox> {
    let found = bounds_of_each(region, work);
    found.or_else(|| match region {
        Region::All(_) | Region::Any(_) => joint_bounds(region, work),
        _ => None,
    })
}

/// Returns a box that contains the region, outside of which each point is outside of one of the intersected sets.
/// Half-spaces bound a polyhedron in this way, though none of them is bounded.
pub(crate) fn joint_bounds(region: &Region, work: &WorkBudget) -> Option<BoundingBox> {
    let size = DVec3::splat(smallest_size(|size| is_outside(region, size, work))?);
    Some(BoundingBox {
        lower: -size,
        upper: size,
    })
}

/// Returns the smallest size for which a cube contains a set, if all larger cubes do, too; `None` if none does. A size that
/// is too small takes the most work, so sizes are tested downward.
fn smallest_size(contains: impl Fn(f64) -> bool) -> Option<f64> {
    let mut least: Option<i32> = None;
    let (mut k, mut step) = (LARGEST_EXPONENT, COARSE);
    while k >= SMALLEST_EXPONENT {
        match (contains(f64::from(k).exp2()), least) {
            (true, _) => {
                least = Some(k);
                if k <= USUAL_EXPONENT {
                    step = FINE;
                }
            }
            (false, Some(last)) if step == COARSE => (k, step) = (last, FINE),
            (false, _) => break,
        }
        k -= step;
    }
    least.map(|k| f64::from(k).exp2())
}

/// Returns true if the region has no point outside of a cube.
fn is_outside(region: &Region, size: f64, work: &WorkBudget) -> bool {
    let operations = TERM * term_count(region) as u64;
    let mut budget = BOXES;
    let far = Interval::point(0.0);
    parts_of_faces(size, &mut |point, small, is_finest| {
        if budget == 0 || !work.take(2 * operations) {
            return PartOfCube::Open;
        }
        budget -= 1;
        if is_positive(region, point, small) {
            return PartOfCube::Outside;
        }
        // If one direction fails, no division helps.
        let middle = point.map(|side| Interval::point(0.5 * (side.lower() + side.upper())));
        match !is_finest && is_positive(region, middle, far) {
            true => PartOfCube::Halved,
            false => PartOfCube::Open,
        }
    })
}

/// Returns true if each point s·`point`, 1/s in `small`, is shown to be outside.
fn is_positive(region: &Region, point: [Interval; 3], small: Interval) -> bool {
    match region {
        Region::Polynomial(p) => leading(p, point, small).lower() > 0.0,
        Region::Field(..) => false,
        Region::All(parts) => parts.iter().any(|part| is_positive(part, point, small)),
        Region::Any(parts) => parts.iter().all(|part| is_positive(part, point, small)),
    }
}

fn term_count(region: &Region) -> usize {
    match region {
        Region::Polynomial(p) => p.terms().len(),
        Region::Field(..) => 1,
        Region::All(parts) | Region::Any(parts) => parts.iter().map(term_count).sum(),
    }
}

/// The decision about a part of the cube's surface.
enum PartOfCube {
    Outside,
    Halved,
    /// Not decided, and division does not help.
    Open,
}

/// Tests each face of the cube, with the reciprocal of the size as a third side, and divides it while `classify`
/// returns `Halved`; returns false once a part is open.
fn parts_of_faces(
    size: f64,
    classify: &mut dyn FnMut([Interval; 3], Interval, bool) -> PartOfCube,
) -> bool {
    let small = Interval::new(0.0, 1.0 / size);
    let whole = Interval::new(-1.0, 1.0);
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let mut rest = vec![[whole, whole, small]];
            while let Some(part) = rest.pop() {
                let mut point = [Interval::point(sign); 3];
                point[(axis + 1) % 3] = part[0];
                point[(axis + 2) % 3] = part[1];
                let share = [part[0].width(), part[1].width(), part[2].width() * size];
                let longest = (0..3)
                    .max_by(|&j, &k| share[j].total_cmp(&share[k]))
                    .unwrap_or(0);
                match classify(point, part[2], share[longest] < FINEST) {
                    PartOfCube::Outside => continue,
                    PartOfCube::Open => return false,
                    PartOfCube::Halved => {}
                }
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

/// Returns a box that contains the region, as far as each of its polynomials shows by itself.
fn bounds_of_each(region: &Region, work: &WorkBudget) -> Option<BoundingBox> {
    match region {
        Region::Polynomial(p) => {
            let size = DVec3::splat(cube(p, work)?);
            Some(BoundingBox {
                lower: -size,
                upper: size,
            })
        }
        Region::Field(..) => None,
        Region::All(parts) => parts
            .iter()
            .filter_map(|part| bounds_of_each(part, work))
            .reduce(|a, b| BoundingBox {
                lower: a.lower.max(b.lower),
                upper: a.upper.min(b.upper),
            }),
        Region::Any(parts) => {
            let mut all = BoundingBox::EMPTY;
            for part in parts {
                all = all.union(&bounds_of_each(part, work)?);
            }
            Some(all)
        }
    }
}

fn cube(p: &Polynomial, work: &WorkBudget) -> Option<f64> {
    if p.degree() < 2 || p.degree() % 2 == 1 {
        return None;
    }
    smallest_size(|size| positive_outside(p, size, work))
}

fn positive_outside(p: &Polynomial, size: f64, work: &WorkBudget) -> bool {
    let mut budget = BOXES;
    let operations = TERM * p.terms().len() as u64;
    parts_of_faces(size, &mut |point, small, _| {
        if budget == 0 || !work.take(operations) {
            return PartOfCube::Open;
        }
        budget -= 1;
        if leading(p, point, small).lower() > 0.0 {
            PartOfCube::Outside
        } else {
            PartOfCube::Halved
        }
    })
}

/// Returns the polynomial at s·`point`, divided by s^degree, where 1/s is `small`.
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
