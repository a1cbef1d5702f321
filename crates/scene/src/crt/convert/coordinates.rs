//! Places and maps of a script in Geotrace's coordinates, in which y and z are exchanged.

use geodesic::vector::{cross, dot, norm};

use crate::crt::entity::{Map, UnitShape};
use crate::crt::vector;

/// A half-space in Geotrace's coordinates: the points p with normal·p ≤ offset.
pub(super) struct HalfSpace {
    pub(super) normal: [f64; 3],
    pub(super) offset: f64,
}

/// Returns the Geotrace coordinates of a point of the script.
pub(super) fn geotrace([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x, z, y]
}

/// Returns the map in Geotrace's coordinates.
pub(super) fn swapped(map: &Map) -> Map {
    let Map([x, y, z]) = *map;
    Map([x, z, y])
}

/// Returns the half-space into which a map takes z ≤ 0; `None` if the map has no inverse.
pub(super) fn half_space(map: &Map) -> Option<HalfSpace> {
    let column = |k: usize| map.0.map(|row| row[k]);
    let [x, y, z] = [0, 1, 2].map(column);
    // The normal is perpendicular to the images of x and y, on the side of z.
    let normal = vector::unit(cross(x, y))?;
    let height = dot(normal, z);
    let normal = vector::scaled(normal, height.signum());
    let offset = dot(normal, column(3));
    (height != 0.0 && offset.is_finite()).then_some(HalfSpace { normal, offset })
}

/// Returns a map with the same image of a shape, without a rotation about the shape's own axis, if it has one.
pub(super) fn upright(shape: UnitShape, map: &Map) -> Map {
    let column = |k: usize| map.0.map(|row| row[k]);
    let [x, y, z, at] = [0, 1, 2, 3].map(column);
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-14 * (a.abs() + b.abs());
    let [a, b, c] = [x, y, z].map(norm);
    let is_flat = |v: [f64; 3]| near(v[2] + a, a);
    let are_across = near(dot(x, y) + a * b, a * b);
    let is_round = near(a, b) && are_across;
    match shape {
        UnitShape::Ball
            if is_round
                && near(b, c)
                && near(dot(x, z) + a * c, a * c)
                && near(dot(y, z) + b * c, b * c) =>
        {
            Map::columns([[a, 0.0, 0.0], [0.0, a, 0.0], [0.0, 0.0, a]], at)
        }
        UnitShape::Cylinder | UnitShape::Cone | UnitShape::Torus(_)
            if is_round && is_flat(x) && is_flat(y) && z[0] == 0.0 && z[1] == 0.0 && z[2] > 0.0 =>
        {
            Map::columns([[a, 0.0, 0.0], [0.0, a, 0.0], z], at)
        }
        // Its centre and its faces remain.
        UnitShape::Cube => {
            let columns = [x, y, z];
            let along = |k: usize| {
                let own = columns.iter().find(|column| column[k] != 0.0)?;
                let alone = (0..3).all(|j| j == k || own[j] == 0.0);
                let single = columns.iter().filter(|column| column[k] != 0.0).count() == 1;
                (alone && single).then_some(own[k].abs())
            };
            match [along(0), along(1), along(2)] {
                [Some(a), Some(b), Some(c)] => {
                    Map::columns([[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]], at)
                }
                _ => *map,
            }
        }
        _ => *map,
    }
}
