//! Surfaces that several leaves share.
//!
//! In: the leaves of a world. Out: groups of pieces with one common zero set. Rays meet all pieces of a group at the same t,
//! to the last bit, so that flush faces leave no film between them. Polynomials are one surface if, scaled to the largest
//! coefficient 1 in the frame of the first leaf, they agree to [`AGREEMENT`], or to the resolution of f64 at the leaf's
//! position; other expressions if they are one node under one map.

use expr::polynomial::Polynomial;
use glam::{DAffine3, DVec3};
use rustc_hash::FxHashMap;

use crate::bounds::BoundingBox;
use crate::leaf::Leaf;
use crate::shape::LeafSurface;
use crate::surface::{HIGHEST_SHARED, PolynomialSurface};

/// The maximum difference of coefficients of one surface: 2⁻³⁸.
const AGREEMENT: f64 = 1.0 / (1u64 << 38) as f64;
/// The same far from the origin, in ulps of a leaf's coordinates.
const ULPS: f64 = 16.0;
/// The maximum difference of keys of surfaces that are compared.
const NEAR: f64 = 1e-6;
/// The change of coefficients that a key must tolerate, as a multiple of the agreement: each of two surfaces is rounded, and
/// so is the key.
const REACH: f64 = 16.0;
/// The number of groups with the nearest keys that a surface is compared with.
const MOST_COMPARED: usize = 8;

/// The groups.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surfaces {
    /// The group of each piece, if it has one; pieces are numbered over all leaves.
    groups: Vec<Option<Member>>,
    /// For each group, the leaf and the piece whose equation is solved.
    pub(crate) first: Vec<(u32, u32)>,
}

/// A piece in a group.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Member {
    pub(crate) group: u32,
    /// True if it is on the opposite side of the surface to the group's first piece.
    pub(crate) opposite: bool,
}

impl Surfaces {
    /// Returns the group of a piece, numbered over all leaves.
    pub(crate) fn group(&self, piece: usize) -> Option<Member> {
        self.groups[piece]
    }
}

/// The name of a surface that is shared only if it is identical: the polynomials of a shape and the position among them, or
/// no shape and the node; the bits of the map, and those of the uniforms that the node reads.
type Name = (usize, usize, [u64; 12], Vec<u64>);

/// A surface with a number that does not depend on the scale of its equation.
struct Keyed {
    key: f64,
    /// The maximum difference between the keys of surfaces that are one with it.
    reach: f64,
    leaf: u32,
    piece: u32,
}

impl Keyed {
    /// Creates a key: the angle of (a₁, a₀), the values at two points. If coefficients change by d, the values change by at
    /// most d·s, where s = (1 + |x| + |y| + |z|)ⁿ, and the angle by d (s₀|a₁| + s₁|a₀|)/(a₀² + a₁²).
    fn new(leaf: &Leaf, surface: &PolynomialSurface, places: &[DVec3; 2], at: (u32, u32)) -> Self {
        let polynomial = &surface.polynomial;
        let places = places.map(|place| leaf.unit_from_world.transform_point3(place));
        let [a, b] = places.map(|place| polynomial.at(place.to_array()));
        let [of_a, of_b] = places.map(|place| {
            let sum = 1.0 + place.abs().element_sum();
            sum.powi(surface.degree() as i32)
        });
        let change = REACH * agreement(leaf) * polynomial.largest();
        Self {
            key: (a / b).atan(),
            reach: change * (of_a * b.abs() + of_b * a.abs()) / (a * a + b * b),
            leaf: at.0,
            piece: at.1,
        }
    }
}

/// Returns the maximum difference of coefficients, scaled to the largest coefficient 1, of one surface in a leaf's frame.
fn agreement(leaf: &Leaf) -> f64 {
    AGREEMENT.max(ULPS * f64::EPSILON * leaf.unit_from_world.translation.length())
}

/// Finds the groups.
pub(crate) fn share(leaves: &[Leaf], piece_count: usize, rest: &BoundingBox) -> Surfaces {
    let mut keyed = Vec::new();
    let mut exact: FxHashMap<Name, Vec<(u32, u32)>> = FxHashMap::default();
    // Two points without any symmetry.
    let half = 0.5 * (rest.upper - rest.lower);
    let places = [
        DVec3::new(0.339_816, -1.618_034, 0.732_051),
        DVec3::new(-1.141_593, 0.577_216, 1.324_718),
    ]
    .map(|place| rest.centre() + place * half);
    for (l, leaf) in leaves.iter().enumerate() {
        for (p, piece) in leaf.compiled.pieces.iter().enumerate() {
            let place = (l as u32, p as u32);
            match piece {
                LeafSurface::Polynomial(surface) if surface.degree() <= HIGHEST_SHARED => {
                    keyed.push(Keyed::new(leaf, surface, &places, place));
                }
                LeafSurface::Polynomial(_) => {
                    let name = std::sync::Arc::as_ptr(&leaf.compiled) as usize;
                    let map = leaf.unit_from_world.to_cols_array().map(f64::to_bits);
                    exact
                        .entry((name, p, map, Vec::new()))
                        .or_default()
                        .push(place);
                }
                LeafSurface::Field(field, node) => {
                    let map = leaf.shape_from_world.to_cols_array().map(f64::to_bits);
                    exact
                        .entry((usize::MAX, node.index(), map, field.uniform_bits()))
                        .or_default()
                        .push(place);
                }
            }
        }
    }
    let mut surfaces = Surfaces {
        groups: vec![None; piece_count],
        first: Vec::new(),
    };
    let mut exact: Vec<Vec<(u32, u32)>> = exact.into_values().filter(|all| all.len() > 1).collect();
    exact.sort_unstable();
    for members in exact {
        let first = members[0];
        for &member in &members {
            let opposite = side(leaves, first) != side(leaves, member);
            surfaces.join(leaves, first, member, opposite);
        }
    }
    share_polynomials(leaves, keyed, &mut surfaces);
    surfaces
}

/// Traverses the surfaces in the order of their keys; a surface without a matching group within reach begins one.
fn share_polynomials(leaves: &[Leaf], mut keyed: Vec<Keyed>, surfaces: &mut Surfaces) {
    keyed.retain(|surface| !surface.key.is_nan());
    // The last key is close to the first one: the arctangent is periodic.
    keyed.sort_by(|a, b| {
        a.key
            .total_cmp(&b.key)
            .then((a.leaf, a.piece).cmp(&(b.leaf, b.piece)))
    });
    let mut first: Vec<&Keyed> = Vec::new();
    for surface in &keyed {
        let place = (surface.leaf, surface.piece);
        let near = first.iter().rev().take(MOST_COMPARED).filter(|other| {
            let difference = surface.key - other.key;
            difference <= NEAR && difference <= surface.reach.max(other.reach)
        });
        let found = near
            .filter_map(|other| {
                let other = (other.leaf, other.piece);
                same(leaves, other, place).map(|opposite| (other, opposite))
            })
            .next();
        match found {
            Some((other, opposite)) => {
                surfaces.join(leaves, other, place, opposite);
            }
            None => first.push(surface),
        }
    }
}

impl Surfaces {
    fn join(&mut self, leaves: &[Leaf], first: (u32, u32), member: (u32, u32), opposite: bool) {
        let index = |(l, p): (u32, u32)| leaves[l as usize].first_piece + p as usize;
        let group = match self.groups[index(first)] {
            Some(known) => known.group,
            None => {
                let group = self.first.len() as u32;
                self.first.push(first);
                self.groups[index(first)] = Some(Member {
                    group,
                    opposite: false,
                });
                group
            }
        };
        self.groups[index(member)] = Some(Member { group, opposite });
    }
}

/// Returns true for the side on which the negated field is not positive.
fn side(leaves: &[Leaf], (l, p): (u32, u32)) -> bool {
    match &leaves[l as usize].compiled.pieces[p as usize] {
        LeafSurface::Field(field, _) => field.is_negated(),
        LeafSurface::Polynomial(_) => false,
    }
}

/// Returns a value if the surfaces are one: true if they are on opposite sides.
fn same(leaves: &[Leaf], a: (u32, u32), b: (u32, u32)) -> Option<bool> {
    let surface = |(l, p): (u32, u32)| -> Option<(&Leaf, &PolynomialSurface)> {
        let leaf = &leaves[l as usize];
        match &leaf.compiled.pieces[p as usize] {
            LeafSurface::Polynomial(surface) => Some((leaf, surface)),
            LeafSurface::Field(..) => None,
        }
    };
    let ((leaf_a, a), (leaf_b, b)) = (surface(a)?, surface(b)?);
    if a.degree() != b.degree() {
        return None;
    }
    let b_from_a = leaf_b.unit_from_world * leaf_a.unit_from_world.inverse();
    let other = b.polynomial.compose(&coordinates(&b_from_a));
    let one = a.polynomial.scaled(1.0 / a.polynomial.largest());
    let other = other.scaled(1.0 / other.largest());
    let agreement = agreement(leaf_a);
    [false, true].into_iter().find(|&opposite| {
        let sign = if opposite { 1.0 } else { -1.0 };
        one.plus(&other.scaled(sign)).largest() <= agreement
    })
}

/// Returns the coordinates of the image, as polynomials.
pub(crate) fn coordinates(map: &DAffine3) -> [Polynomial; 3] {
    let rows = map.matrix3.transpose();
    [rows.x_axis, rows.y_axis, rows.z_axis]
        .into_iter()
        .zip(map.translation.to_array())
        .map(|(row, constant)| Polynomial::linear(constant, row.to_array()))
        .collect::<Vec<_>>()
        .try_into()
        .unwrap_or_default()
}
