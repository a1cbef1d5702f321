//! Frames of unbounded shapes: the centre and the scale for their polynomials.
//!
//! In: the region of a shape in its own coordinates. Out: a box. A frame only translates and scales coordinates, so that any
//! box is correct; but a polynomial that is written about a point far from its own centre has large terms that cancel, and
//! its roots lose as many digits. A shape's frame depends on the shape alone: other parts of a world do not move its roots.

use expr::polynomial::{Polynomial, Region};
use glam::{DMat3, DVec3};

use crate::bounds::BoundingBox;

/// A pivot below this fraction of the largest one counts as 0.
const FLATTEST: f64 = 1e-9;

/// Returns the box around the centres of the polynomials that bound a region, enlarged to their size: of the polynomials of
/// degree two or higher, or of the planes if there are no others. The box is a point if no polynomial determines a size.
pub(crate) fn centres(region: &Region) -> BoundingBox {
    let [mut flat, mut curved] = [BoundingBox::EMPTY; 2];
    let mut rest = vec![region];
    while let Some(region) = rest.pop() {
        match region {
            Region::Polynomial(p) => {
                let (centre, half) = (centre(p), size(p));
                if centre.is_finite() && half.is_finite() {
                    let all = if p.degree() > 1 {
                        &mut curved
                    } else {
                        &mut flat
                    };
                    all.include(centre - half);
                    all.include(centre + half);
                }
            }
            Region::Field(..) => {}
            Region::All(parts) | Region::Any(parts) => rest.extend(parts),
        }
    }
    let found = [curved, flat].into_iter().find(|found| !found.is_empty());
    found.unwrap_or(BoundingBox {
        lower: DVec3::ZERO,
        upper: DVec3::ZERO,
    })
}

/// Returns the frame of a shape whose polynomials have these centres. Along axes on which the extent is finite, it is the
/// extent. `size` is half its side if nothing else determines one.
pub(crate) fn frame(centres: &BoundingBox, extent: &BoundingBox, size: f64) -> BoundingBox {
    let ends = |k: usize| extent.lower[k].is_finite() && extent.upper[k].is_finite();
    let [mut centre, mut half] = centres.middle();
    let [own_centre, own_half] = extent.middle();
    let most = |half: DVec3, on: bool| {
        let sides = (0..3).filter(|&k| ends(k) == on).map(|k| half[k]);
        sides.fold(0.0, f64::max)
    };
    let sizes = [most(half, false), most(own_half, true), size];
    let endless = sizes.into_iter().find(|&size| size > 0.0).unwrap_or(1.0);
    for k in 0..3 {
        (centre[k], half[k]) = match ends(k) {
            true => (own_centre[k], own_half[k]),
            false => (centre[k], endless),
        };
    }
    BoundingBox {
        lower: centre - half,
        upper: centre + half,
    }
}

/// Returns the power of two nearest to a size: scaling by it is exact.
pub(crate) fn power_of_two(size: f64) -> f64 {
    size.log2().round().exp2()
}

/// Returns the point about which the terms of degree n − 1 are smallest: the centre of a quadric that has one, or the point
/// of a plane nearest to the origin.
fn centre(p: &Polynomial) -> DVec3 {
    let degree = p.degree();
    let of_degree = |degree: usize| {
        let sum = |e: [u8; 3]| e.iter().map(|&e| usize::from(e)).sum::<usize>();
        Polynomial::from_terms(p.terms().filter(|(e, _)| sum(*e) == degree))
    };
    if degree == 0 {
        return DVec3::ZERO;
    }
    let (first, second) = (of_degree(degree), of_degree(degree - 1));
    let slopes = [0, 1, 2].map(|k| first.derivative(k));
    let product = |a: &Polynomial, b: &Polynomial| {
        let other = |e: [u8; 3]| b.terms().find(|(f, _)| *f == e).map_or(0.0, |(_, c)| c);
        a.terms().map(|(e, c)| c * other(e)).sum::<f64>()
    };
    // About c those terms are `second` + c·`slopes`: a least-squares problem in their coefficients.
    let right = DVec3::from_array([0, 1, 2].map(|k| -product(&slopes[k], &second)));
    let columns = [0, 1, 2].map(|j| [0, 1, 2].map(|k| product(&slopes[j], &slopes[k])));
    if degree == 1 {
        let square = columns[0][0] + columns[1][1] + columns[2][2];
        return right / square;
    }
    solved(DMat3::from_cols_array_2d(&columns), right)
}

/// Returns a solution of a symmetric system without negative eigenvalues; undetermined components are 0.
fn solved(mut matrix: DMat3, mut right: DVec3) -> DVec3 {
    let largest = matrix.x_axis.x.max(matrix.y_axis.y).max(matrix.z_axis.z);
    let mut open = vec![0, 1, 2];
    let mut order = Vec::new();
    while let Some(&k) = open
        .iter()
        .max_by(|&&j, &&k| matrix.col(j)[j].total_cmp(&matrix.col(k)[k]))
    {
        let pivot = matrix.col(k)[k];
        if pivot.is_nan() || pivot <= FLATTEST * largest {
            break;
        }
        open.retain(|&other| other != k);
        order.push(k);
        for &j in &open {
            let factor = matrix.col(k)[j] / pivot;
            right[j] -= factor * right[k];
            for &i in &open {
                let part = factor * matrix.col(i)[k];
                matrix.col_mut(i)[j] -= part;
            }
        }
    }
    let mut solution = DVec3::ZERO;
    for &k in order.iter().rev() {
        // The row of a pivot does not change after its own step: the components after it are solved already.
        let known = (0..3)
            .filter(|&j| j != k)
            .map(|j| matrix.col(j)[k] * solution[j]);
        solution[k] = (right[k] - known.sum::<f64>()) / matrix.col(k)[k];
    }
    solution
}

/// Returns the size at which, about the centre, the terms of the highest degree outweigh those of each lower one; 0 if there
/// are no other terms.
fn size(p: &Polynomial) -> f64 {
    let centre = centre(p).to_array();
    let place = [0, 1, 2].map(|k| {
        let mut slopes = [0.0; 3];
        slopes[k] = 1.0;
        Polynomial::linear(centre[k], slopes)
    });
    let mut sums = vec![0.0; p.degree() + 1];
    for (e, c) in p.compose(&place).terms() {
        let degree: usize = e.iter().map(|&e| usize::from(e)).sum();
        if let Some(sum) = sums.get_mut(degree) {
            *sum += c.abs();
        }
    }
    let Some((first, lower)) = sums.split_last() else {
        return 0.0;
    };
    let degrees = lower.iter().enumerate();
    let sizes = degrees.map(|(k, sum)| (sum / first).powf(1.0 / (lower.len() - k) as f64));
    let most = sizes.fold(0.0, f64::max);
    if most > 0.0 && p.degree() > 1 {
        power_of_two(most)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polynomial(terms: &[([u8; 3], f64)]) -> Polynomial {
        Polynomial::from_terms(terms.iter().copied())
    }

    #[test]
    fn polynomials_have_their_centers() {
        // A cone with its tip at (1, 2, 3), turned and moved in its terms.
        let tip = [1.0, 2.0, 3.0];
        let at = [0, 1, 2].map(|k| {
            let mut slopes = [0.0; 3];
            slopes[k] = 1.0;
            Polynomial::linear(-tip[k], slopes)
        });
        let [x, y, z] = &at;
        let cone = x.times(y).plus(&z.times(z).scaled(-0.5));
        let cone = cone.plus(&x.times(z));
        assert!((centre(&cone) - DVec3::from_array(tip)).length() < 1e-12);
        // A paraboloid has none along its axis, and a cubic that of its triple term.
        let bowl = polynomial(&[([2, 0, 0], 1.0), ([1, 0, 0], -2000.0), ([0, 0, 1], -1.0)]);
        assert_eq!(centre(&bowl), DVec3::new(1000.0, 0.0, 0.0));
        let cubic = polynomial(&[([3, 0, 0], 1.0), ([2, 0, 0], -30.0), ([0, 2, 0], 1.0)]);
        assert!((centre(&cubic) - DVec3::new(10.0, 0.0, 0.0)).length() < 1e-12);
        let plane = polynomial(&[([1, 0, 0], 2.0), ([0, 0, 0], -3.0)]);
        assert_eq!(centre(&plane), DVec3::new(1.5, 0.0, 0.0));
        let sizes = [&cone, &bowl, &plane].map(size);
        assert_eq!(sizes[0], 0.0);
        assert_eq!(sizes[1], 1024.0);
        assert_eq!(sizes[2], 0.0);
    }
}
