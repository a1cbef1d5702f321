//! The surfaces and solids in front of a point of the 3D view, for labels. In: coarse grids of the surfaces' points, solids
//! and a camera. Out: whether a point is hidden.
//!
//! The grids are those that frame the scene, so that both backends have them without reading the picture. Their error is a
//! few thousandths of the surface's size, and only objects clearly in front of a point hide it.

use std::sync::Arc;

use glam::DVec3;
use scene::ObjectId;
use tracer::Ray;

use crate::bounds::ObjectCloud;
use crate::camera::Camera;
use crate::placement::Placement;
use crate::point::{DrawingPoint, WorldPoint};
use crate::solids::SolidScene;

/// A surface hides points that are behind it by more than this, in drawing units.
const CLEAR: f64 = 0.02;

/// The surfaces and solids of a scene, as seen by a camera.
pub(crate) struct Occlusion {
    eye: DVec3,
    /// The direction to the eye of a camera with parallel lines of sight.
    parallel: Option<DVec3>,
    strips: Vec<RowPair>,
    solids: Option<Arc<SolidScene>>,
    placement: Placement,
}

/// The cells between two rows of a grid.
struct RowPair {
    object: ObjectId,
    rows: [Vec<DVec3>; 2],
    /// The box around them: the smallest and the largest coordinates.
    corners: [DVec3; 2],
}

/// A part of a line of sight, from a point towards the eye.
struct Sight {
    from: DVec3,
    /// A unit vector.
    towards: DVec3,
    length: f64,
}

impl Occlusion {
    /// Creates the occlusion by the surfaces among some objects, with their coarse points.
    pub(crate) fn new<'c>(
        camera: &Camera,
        objects: impl Iterator<Item = (ObjectId, &'c ObjectCloud)>,
    ) -> Self {
        let mut strips = Vec::new();
        for (object, cloud) in objects {
            let [columns, rows] = cloud.counts;
            if columns < 2 || rows < 2 {
                continue;
            }
            let local =
                |&place: &[f64; 3]| DVec3::from(camera.placement.local(WorldPoint(place)).0);
            for instance in cloud.grid.chunks_exact(columns * rows) {
                let lines: Vec<Vec<DVec3>> = instance
                    .chunks_exact(columns)
                    .map(|row| row.iter().map(local).collect())
                    .collect();
                strips.extend(lines.windows(2).map(|pair| RowPair::new(object, pair)));
            }
        }
        Self {
            eye: camera.eye,
            parallel: camera.parallel.map(|_| camera.axes[2]),
            strips,
            solids: None,
            placement: camera.placement,
        }
    }

    /// Returns it with solids, which also hide the points behind them.
    #[must_use]
    pub(crate) fn with_solids(self, solids: Option<Arc<SolidScene>>) -> Self {
        Self { solids, ..self }
    }

    /// Returns true if a surface or a solid is between a point and the eye, except the object whose edge the point is on.
    pub(crate) fn hides(&self, place: DrawingPoint, except: Option<ObjectId>) -> bool {
        let place = DVec3::from(place.0);
        let to_eye = self.eye - place;
        let (towards, length) = match self.parallel {
            Some(towards) => (towards, f64::INFINITY),
            None => (to_eye.normalize_or_zero(), to_eye.length()),
        };
        if towards == DVec3::ZERO || length <= CLEAR {
            return false;
        }
        let sight = Sight {
            from: place + towards * CLEAR,
            towards,
            length: length - CLEAR,
        };
        let others = |strip: &&RowPair| Some(strip.object) != except;
        let mut strips = self.strips.iter().filter(others);
        strips.any(|strip| sight.meets_box(strip.corners) && strip.meets(&sight))
            || self.is_behind_solid(&sight, except)
    }

    /// Returns true if another solid is on a line of sight.
    fn is_behind_solid(&self, sight: &Sight, except: Option<ObjectId>) -> bool {
        let Some(solids) = &self.solids else {
            return false;
        };
        let WorldPoint(origin) = self.placement.world(DrawingPoint(sight.from.to_array()));
        let ray = Ray {
            origin: origin.into(),
            direction: self.placement.radius * sight.towards,
            leaving: None,
        };
        let mut caster = solids.world().caster();
        let met = caster.cast(&ray).iter();
        let mut others = met.filter(|it| solids.objects().get(it.solid).copied() != except);
        others.any(|crossing| crossing.t < sight.length)
    }
}

impl RowPair {
    fn new(object: ObjectId, rows: &[Vec<DVec3>]) -> Self {
        let places = || rows.iter().flatten().filter(|place| place.is_finite());
        Self {
            object,
            rows: [rows[0].clone(), rows[1].clone()],
            corners: [
                places().fold(DVec3::INFINITY, |a, &b| a.min(b)),
                places().fold(DVec3::NEG_INFINITY, |a, &b| a.max(b)),
            ],
        }
    }

    fn meets(&self, sight: &Sight) -> bool {
        let [below, above] = &self.rows;
        let mut cells = below.windows(2).zip(above.windows(2));
        cells.any(|(low, high)| {
            sight.meets([low[0], low[1], high[1]]) || sight.meets([low[0], high[1], high[0]])
        })
    }
}

impl Sight {
    /// Returns true if it may pass through a box.
    fn meets_box(&self, [low, high]: [DVec3; 2]) -> bool {
        let (mut near, mut far) = (0.0_f64, self.length);
        for k in 0..3 {
            let (from, towards) = (self.from[k], self.towards[k]);
            if towards.abs() < f64::MIN_POSITIVE {
                if from < low[k] || from > high[k] {
                    return false;
                }
                continue;
            }
            let (a, b) = ((low[k] - from) / towards, (high[k] - from) / towards);
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
        near <= far
    }

    /// Returns true if it passes through a triangle (T. Möller and B. Trumbore, "Fast, minimum storage ray-triangle
    /// intersection", 1997); false if a corner is undefined.
    fn meets(&self, [a, b, c]: [DVec3; 3]) -> bool {
        let (ab, ac) = (b - a, c - a);
        let across = self.towards.cross(ac);
        let determinant = ab.dot(across);
        let from = self.from - a;
        let u = from.dot(across) / determinant;
        let along = from.cross(ab);
        let v = self.towards.dot(along) / determinant;
        let distance = ac.dot(along) / determinant;
        u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance >= 0.0 && distance <= self.length
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::Bounds;
    use crate::viewpoint::{Projection, Viewpoint};

    /// The plane z = 0 over the square with corners (±1, ±1), with a hole about its middle.
    fn plane() -> ObjectCloud {
        let places = (0..9).flat_map(|j| (0..9).map(move |i| [i, j]));
        let place = |[i, j]: [i32; 2]| match [i, j] {
            [4, 4] => [f64::NAN; 3],
            _ => [f64::from(i - 4) / 4.0, f64::from(j - 4) / 4.0, 0.0],
        };
        ObjectCloud {
            grid: places.map(place).collect(),
            counts: [9, 9],
            ..ObjectCloud::default()
        }
    }

    #[test]
    fn a_plane_hides_what_is_behind_it_and_nothing_beside_before_or_on_it() {
        let bounds = Bounds::around(vec![[-1.0; 3], [1.0; 3]]);
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let viewpoint = Viewpoint {
                projection,
                ..Viewpoint::new([0.0, 0.1, 9.0], [0.0; 3])
            };
            let camera = Camera::new(&bounds, &viewpoint, [64, 64]).expect("a camera");
            let plane = plane();
            let occlusion = Occlusion::new(&camera, [(ObjectId::new(3), &plane)].into_iter());
            let hides = |place: [f64; 3], except| {
                let place = camera.placement.local(WorldPoint(place));
                occlusion.hides(place, except)
            };
            assert!(hides([0.6, 0.6, -0.5], None), "{projection:?}: behind");
            assert!(!hides([0.6, 0.6, -0.5], Some(ObjectId::new(3))), "its own");
            assert!(!hides([0.6, 0.6, 0.5], None), "{projection:?}: before");
            assert!(!hides([0.6, 0.6, 0.0], None), "{projection:?}: on it");
            assert!(!hides([1.5, 0.6, -0.5], None), "{projection:?}: beside");
            assert!(
                !hides([0.0, 0.0, -0.2], None),
                "{projection:?}: in the hole"
            );
        }
    }
}
