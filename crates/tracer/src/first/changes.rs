//! Sign changes of polynomials of degree at most two on vectors of rays.
//!
//! In: rays, and the equation of a plane, or of a quadric in a leaf's frame. Out: the parameters at which each ray passes
//! it. The operations are those of `line.rs`, `low.rs` and `roots.rs` in the same order, so that all results are the same.

use expr::vectors::{Instructions, Mask, Vector};
use glam::DVec3;

use crate::bundle::RayBlock;
use crate::leaf::Leaf;
use crate::low::WorldPlane;
use crate::surface::QuadraticForm;

/// The coordinates of points or directions.
type Place<S> = [Vector<S>; 3];

/// A vector of rays.
pub(super) struct Rays<S: Instructions> {
    pub(super) origin: Place<S>,
    pub(super) direction: Place<S>,
}

impl<S: Instructions> Rays<S> {
    #[inline(always)]
    pub(super) fn load(s: S, [x, y, z, dx, dy, dz]: &RayBlock, part: usize) -> Self {
        Self {
            origin: [
                Vector::load(s, x, part),
                Vector::load(s, y, part),
                Vector::load(s, z, part),
            ],
            direction: [
                Vector::load(s, dx, part),
                Vector::load(s, dy, part),
                Vector::load(s, dz, part),
            ],
        }
    }

    /// Returns true for half-lines, as `Ray::is_usable` does.
    #[inline(always)]
    pub(super) fn are_usable(&self, s: S) -> Mask<S> {
        let zero = Vector::splat(s, 0.0);
        let [x, y, z] = self.direction;
        let mut are_usable = !(x.equals(zero) & y.equals(zero) & z.equals(zero));
        for x in [self.origin, self.direction].as_flattened() {
            are_usable = are_usable & x.is_finite();
        }
        are_usable
    }
}

/// Rays in the frame of a leaf, as in `UnitLine`.
pub(super) struct FramedLines<S: Instructions> {
    point: Place<S>,
    direction: Place<S>,
    pub(super) middle: Vector<S>,
    pub(super) speed: Vector<S>,
    pub(super) slowness: Vector<S>,
}

impl<S: Instructions> FramedLines<S> {
    #[inline(always)]
    pub(super) fn new(s: S, leaf: &Leaf, rays: &Rays<S>) -> Self {
        let matrix = &leaf.unit_from_world.matrix3;
        let columns = [
            splat(s, matrix.x_axis),
            splat(s, matrix.y_axis),
            splat(s, matrix.z_axis),
        ];
        let centre = splat(s, leaf.unit_from_world.translation);
        let origin = sum(transformed(&columns, &rays.origin), centre);
        let velocity = transformed(&columns, &rays.direction);
        let speed = dot(&velocity, &velocity).sqrt();
        let slowness = Vector::splat(s, 1.0) / speed;
        let direction = scaled(slowness, velocity);
        let middle = -dot(&origin, &direction);
        let point = sum(origin, scaled(middle, direction));
        let off = dot(&point, &direction);
        Self {
            point: difference(point, scaled(off, direction)),
            direction,
            middle: middle * slowness,
            speed,
            slowness,
        }
    }

    /// Returns the coefficients along the lines, as [`QuadraticForm::along`] does.
    #[inline(always)]
    pub(super) fn along(&self, s: S, form: &QuadraticForm) -> [Vector<S>; 3] {
        let (p, d) = (&self.point, &self.direction);
        match form {
            QuadraticForm::Plane { normal, offset } => {
                let normal = splat(s, *normal);
                let value = dot(&normal, p) + Vector::splat(s, *offset);
                [value, dot(&normal, d), Vector::splat(s, 0.0)]
            }
            QuadraticForm::Quadric {
                squares,
                mixed,
                linear,
                constant,
            } => {
                let linear = splat(s, *linear);
                let (at, along) = if *mixed == DVec3::ZERO {
                    let squares = splat(s, *squares);
                    (product_of(squares, p), product_of(squares, d))
                } else {
                    let (squares, mixed) = (splat(s, *squares), splat(s, *mixed));
                    (
                        half_gradient(s, squares, mixed, p),
                        half_gradient(s, squares, mixed, d),
                    )
                };
                let twice = scaled(Vector::splat(s, 2.0), at);
                [
                    dot(&sum(at, linear), p) + Vector::splat(s, *constant),
                    dot(&sum(twice, linear), d),
                    dot(&along, d),
                ]
            }
        }
    }

    /// Returns the changes with parameters of the rays instead of those of the lines.
    #[inline(always)]
    pub(super) fn in_t(&self, changes: Changes<S>) -> Changes<S> {
        let Changes { first, second, .. } = changes;
        Changes {
            first: self.middle + first * self.slowness,
            second: self.middle + second * self.slowness,
            ..changes
        }
    }
}

/// The points where polynomials of degree at most two change their sign on rays: `first` and `second`, infinite if there is
/// no change.
#[derive(Clone, Copy)]
pub(super) struct Changes<S: Instructions> {
    pub(super) first: Vector<S>,
    pub(super) second: Vector<S>,
    /// True where the polynomial is not positive before the first change.
    pub(super) inside_first: Mask<S>,
}

impl<S: Instructions> Changes<S> {
    #[inline(always)]
    pub(super) fn of_linear(s: S, [c, b]: [Vector<S>; 2]) -> Self {
        let (zero, endless) = (Vector::splat(s, 0.0), Vector::splat(s, f64::INFINITY));
        let is_flat = b.equals(zero);
        Self {
            first: is_flat.choose(endless, -c / b),
            second: endless,
            inside_first: is_flat & c.le(zero) | !is_flat & zero.lt(b),
        }
    }

    #[inline(always)]
    pub(super) fn of_quadratic(s: S, [c, b, a]: [Vector<S>; 3]) -> Self {
        let (zero, endless) = (Vector::splat(s, 0.0), Vector::splat(s, f64::INFINITY));
        let discriminant = b * b - Vector::splat(s, 4.0) * a * c;
        let q = Vector::splat(s, -0.5) * (b + discriminant.sqrt().copysign(b));
        let (u, v) = (q / a, c / q);
        let is_linear = a.equals(zero);
        let has_places = zero.lt(discriminant);
        let first = has_places.choose(u.least(v), endless);
        let second = has_places.choose(u.greatest(v), endless);
        let curved = Self {
            first,
            second,
            inside_first: a.lt(zero),
        };
        if !is_linear.any() {
            return curved;
        }
        let linear = Self::of_linear(s, [c, b]);
        Self {
            first: is_linear.choose(linear.first, first),
            second: is_linear.choose(linear.second, second),
            inside_first: is_linear & linear.inside_first | !is_linear & curved.inside_first,
        }
    }

    /// Returns the changes without the root `root`, as `deflated` does; `false` marks polynomials of a lower degree.
    #[inline(always)]
    pub(super) fn of_deflated(s: S, [c, b, a]: [Vector<S>; 3], root: Vector<S>) -> (Self, Mask<S>) {
        let largest = c.abs().greatest(b.abs()).greatest(a.abs());
        let is_near = root.abs().le(Vector::splat(s, 1.0));
        let first = (Vector::splat(s, 0.0) - c) / root;
        let linear = [
            is_near.choose(b + a * root, first),
            is_near.choose(a, (first - b) / root),
        ];
        let is_quadratic = (largest * Vector::splat(s, 1e-17)).lt(a.abs());
        (Self::of_linear(s, linear), is_quadratic)
    }

    /// Returns the part of each line inside a convex set, as `QuadraticChanges::convex_part` does; it is empty if its
    /// beginning is not before its end.
    #[inline(always)]
    pub(super) fn convex_part(self, s: S, opposite: bool) -> [Vector<S>; 2] {
        let endless = Vector::splat(s, f64::INFINITY);
        let Self { first, second, .. } = self;
        let inside = self.inside_first.differs(Mask::splat(s, opposite));
        // The farther one of two parts does not count.
        let is_far = !second.equals(endless) & !first.abs().lt(second.abs());
        [
            inside.choose(is_far.choose(second, -endless), first),
            inside.choose(is_far.choose(endless, first), second),
        ]
    }
}

#[inline(always)]
pub(super) fn plane_changes<S: Instructions>(
    s: S,
    plane: &WorldPlane,
    rays: &Rays<S>,
    is_left: bool,
) -> Changes<S> {
    let normal = splat(s, plane.normal);
    let slope = dot(&normal, &rays.direction);
    if is_left {
        return Changes::of_linear(s, [slope, Vector::splat(s, 0.0)]);
    }
    let origin = difference(rays.origin, splat(s, plane.centre));
    let value = dot(&normal, &origin) + Vector::splat(s, plane.offset);
    Changes::of_linear(s, [value, slope])
}

/// Returns half of the gradient of the part of degree two, with these coefficients of squares and of mixed terms.
#[inline(always)]
fn half_gradient<S: Instructions>(
    s: S,
    squares: Place<S>,
    [x, y, z]: Place<S>,
    v: &Place<S>,
) -> Place<S> {
    let mixed = [
        z * v[1] + y * v[2],
        z * v[0] + x * v[2],
        y * v[0] + x * v[1],
    ];
    let half = scaled(Vector::splat(s, 0.5), mixed);
    sum(product_of(squares, v), half)
}

#[inline(always)]
fn product_of<S: Instructions>(a: Place<S>, b: &Place<S>) -> Place<S> {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

#[inline(always)]
fn splat<S: Instructions>(s: S, v: DVec3) -> Place<S> {
    [
        Vector::splat(s, v.x),
        Vector::splat(s, v.y),
        Vector::splat(s, v.z),
    ]
}

#[inline(always)]
fn dot<S: Instructions>(a: &Place<S>, b: &Place<S>) -> Vector<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn sum<S: Instructions>(a: Place<S>, b: Place<S>) -> Place<S> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn difference<S: Instructions>(a: Place<S>, b: Place<S>) -> Place<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn scaled<S: Instructions>(factor: Vector<S>, a: Place<S>) -> Place<S> {
    [factor * a[0], factor * a[1], factor * a[2]]
}

/// Returns the image under a matrix with these columns.
#[inline(always)]
fn transformed<S: Instructions>(columns: &[Place<S>; 3], v: &Place<S>) -> Place<S> {
    let [x, y, z] = columns;
    sum(sum(scaled(v[0], *x), scaled(v[1], *y)), scaled(v[2], *z))
}
