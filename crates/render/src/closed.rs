//! The sides of surfaces, from a coarse grid of points: which are glued to each other; of closed surfaces their outside, and
//! the direction that the centre of the domain faces.

use glam::DVec3;

/// Points closer than this fraction of the surface's size count as equal.
const SAME: f64 = 1e-6;
/// A surface that encloses less than this fraction of its size cubed has no outside.
const FLAT: f64 = 1e-6;

/// A surface whose sides are glued to each other, or shrink to points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ClosedSurface {
    /// True if σu×σv points outwards.
    pub(crate) points_outwards: bool,
    /// The outward unit normal, averaged over the centre of the domain.
    pub(crate) facing: [f64; 3],
}

impl ClosedSurface {
    /// Returns the closed surface of a grid of points (row by row, the smallest v first); `None` if the grid is not closed,
    /// or its sides are glued with a flip, so that it has no outside.
    pub(crate) fn from_grid(grid: &[[f64; 3]], [columns, rows]: [usize; 2]) -> Option<Self> {
        if columns < 3 || rows < 3 || grid.len() < columns * rows {
            return None;
        }
        let grid = &grid[..columns * rows];
        if grid.iter().flatten().any(|x| !x.is_finite()) {
            return None;
        }
        let is_closed =
            |sides: [Vec<DVec3>; 2]| is_glued(&sides) || sides.iter().all(|side| is_point(side));
        if !sides(grid, [columns, rows])?.into_iter().all(is_closed) {
            return None;
        }
        let (middle, size) = extent(grid);
        let at = |i: usize, j: usize| (DVec3::from(grid[j * columns + i]) - middle) / size;
        let (mut volume, mut normal) = (0.0, DVec3::ZERO);
        let is_central = |k: usize, count: usize| (count / 4..count - count / 4 - 1).contains(&k);
        for j in 0..rows - 1 {
            for i in 0..columns - 1 {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                volume += (a.cross(b).dot(c) + a.cross(c).dot(d)) / 6.0;
                if is_central(i, columns) && is_central(j, rows) {
                    normal += (c - a).cross(d - b);
                }
            }
        }
        if volume.abs() <= FLAT {
            return None;
        }
        let facing = normal.normalize_or_zero() * volume.signum();
        Some(Self {
            points_outwards: volume > 0.0,
            facing: facing.to_array(),
        })
    }
}

/// Returns true for u, and for v, if the two sides of the first instance of a grid of points, as that of
/// [`ClosedSurface::from_grid`], are one line: a surface is closed across them. Undefined points are on no side.
pub(crate) fn glued_sides(grid: &[[f64; 3]], counts: [usize; 2]) -> [bool; 2] {
    let whole = counts.iter().all(|count| *count > 1) && grid.len() >= counts[0] * counts[1];
    let sides = whole.then(|| sides(&grid[..counts[0] * counts[1]], counts));
    let is_seam =
        |sides: [Vec<DVec3>; 2]| !sides.iter().any(|side| is_point(side)) && is_glued(&sides);
    sides.flatten().map_or([false; 2], |it| it.map(is_seam))
}

/// Returns the sides of a grid at the minimum and the maximum of u, then of v, relative to its centre and in units of its
/// size, so that no product overflows; `None` without a finite size.
fn sides(grid: &[[f64; 3]], [columns, rows]: [usize; 2]) -> Option<[[Vec<DVec3>; 2]; 2]> {
    let (middle, size) = extent(grid);
    if !(size > 0.0 && size.is_finite()) {
        return None;
    }
    let at = |i: usize, j: usize| (DVec3::from(grid[j * columns + i]) - middle) / size;
    let of_u = [0, columns - 1].map(|i| (0..rows).map(|j| at(i, j)).collect());
    let of_v = [0, rows - 1].map(|j| (0..columns).map(|i| at(i, j)).collect());
    Some([of_u, of_v])
}

/// Returns the middle and the longest side of the box of the finite points.
fn extent(grid: &[[f64; 3]]) -> (DVec3, f64) {
    let places = || grid.iter().copied().map(DVec3::from);
    let finite = || places().filter(|place| place.is_finite());
    let low = finite().fold(DVec3::INFINITY, DVec3::min);
    let high = finite().fold(DVec3::NEG_INFINITY, DVec3::max);
    (0.5 * low + 0.5 * high, (high - low).max_element())
}

fn same(a: DVec3, b: DVec3) -> bool {
    a.distance(b) <= SAME
}

fn is_point(side: &[DVec3]) -> bool {
    let mut finite = side.iter().filter(|place| place.is_finite());
    finite
        .next()
        .is_none_or(|first| finite.all(|place| same(*place, *first)))
}

fn is_glued([one, other]: &[Vec<DVec3>; 2]) -> bool {
    let mut pairs = one.iter().zip(other);
    pairs.all(|(&a, &b)| same(a, b) || !(a.is_finite() || b.is_finite()))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;

    const SIDE: usize = 25;

    fn grid(u: [f64; 2], v: [f64; 2], place: impl Fn(f64, f64) -> [f64; 3]) -> Vec<[f64; 3]> {
        let at =
            |[low, high]: [f64; 2], k: usize| low + (high - low) * k as f64 / (SIDE - 1) as f64;
        let places = (0..SIDE).flat_map(|j| (0..SIDE).map(move |i| (i, j)));
        places.map(|(i, j)| place(at(u, i), at(v, j))).collect()
    }

    fn closed(grid: &[[f64; 3]]) -> Option<ClosedSurface> {
        ClosedSurface::from_grid(grid, [SIDE; 2])
    }

    #[test]
    fn a_sphere_faces_the_middle_of_its_domain_whichever_way_its_normal_points() {
        let polar = |u: f64, v: f64| [v.sin() * u.cos(), v.sin() * u.sin(), v.cos()];
        let latitude = |u: f64, v: f64| [v.cos() * u.cos(), v.cos() * u.sin(), v.sin()];
        let inwards = closed(&grid([-PI, PI], [0.0, PI], polar)).expect("closed");
        let outwards = closed(&grid([-PI, PI], [-PI / 2.0, PI / 2.0], latitude)).expect("closed");
        assert!(!inwards.points_outwards && outwards.points_outwards);
        for sphere in [inwards, outwards] {
            assert!(
                DVec3::from(sphere.facing).distance(DVec3::X) < 1e-9,
                "{sphere:?}"
            );
        }
    }

    #[test]
    fn a_torus_faces_into_its_hole_and_open_or_turned_surfaces_face_nowhere() {
        let torus = |u: f64, v: f64| {
            let r = 2.0 + v.cos();
            [r * u.cos(), r * u.sin(), v.sin()]
        };
        let found = closed(&grid([0.0, TAU], [0.0, TAU], torus)).expect("closed");
        assert!(found.points_outwards);
        assert!(
            DVec3::from(found.facing).distance(DVec3::X) < 1e-9,
            "{found:?}"
        );
        let half = closed(&grid([0.0, PI], [0.0, TAU], torus));
        let plane = closed(&grid([0.0, 1.0], [0.0, 1.0], |u, v| [u, v, 0.0]));
        let moebius = closed(&grid([0.0, TAU], [-0.5, 0.5], |u, v| {
            let r = 1.0 + v * (u / 2.0).cos();
            [r * u.cos(), r * u.sin(), v * (u / 2.0).sin()]
        }));
        assert_eq!([half, plane, moebius], [None; 3]);
        let undefined = closed(&grid([0.0, TAU], [0.0, TAU], |_, _| [f64::NAN; 3]));
        assert_eq!(undefined, None);
    }

    #[test]
    fn sides_are_glued_where_they_are_one_line() {
        let glued = |grid: &[[f64; 3]]| glued_sides(grid, [SIDE; 2]);
        let sphere = |u: f64, v: f64| [v.cos() * u.cos(), v.cos() * u.sin(), v.sin()];
        let whole = grid([-PI, PI], [-PI / 2.0, PI / 2.0], sphere);
        assert_eq!(glued(&whole), [true, false], "a pole is a point");
        let open = grid([-PI, 3.0], [-PI / 2.0, PI / 2.0], sphere);
        assert_eq!(glued(&open), [false; 2]);
        // It touches itself in a point.
        let horn = |u: f64, v: f64| {
            let r = 1.0 + v.cos();
            [r * u.cos(), r * u.sin(), v.sin()]
        };
        assert_eq!(glued(&grid([0.0, TAU], [-PI, PI], horn)), [true, false]);
        assert_eq!(glued(&grid([0.0, TAU], [0.0, TAU], horn)), [true; 2]);
        let moebius = grid([0.0, TAU], [-0.5, 0.5], |u, v| {
            let r = 1.0 + v * (u / 2.0).cos();
            [r * u.cos(), r * u.sin(), v * (u / 2.0).sin()]
        });
        assert_eq!(glued(&moebius), [false; 2]);
        // Undefined for half of v.
        let bowl = |u: f64, v: f64| [v.sqrt() * u.cos(), v.sqrt() * u.sin(), v];
        assert_eq!(glued(&grid([0.0, TAU], [-1.0, 1.0], bowl)), [true, false]);
        assert_eq!(glued_sides(&[], [0; 2]), [false; 2]);
    }
}
