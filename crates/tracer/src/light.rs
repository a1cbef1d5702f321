//! Lights.
//!
//! In: a light and a point. Out: the direction towards the light, its distance, and the fraction of its light that arrives
//! there, without shadows.

use expr::processor::Processor;
use expr::vectors::{Instructions, Lanes, MOST_LANES, Vector, VectorWork};
use glam::DVec3;

/// A light; all its numbers are linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// The kind of the light.
    pub kind: LightKind,
    /// Colour times power.
    pub colour: DVec3,
    /// The fraction that reaches every point, even in shadow.
    pub ambient: f64,
    /// The distance at which the light has full strength; without it, the light does not fade.
    pub falloff: Option<f64>,
    /// The radius of the emitting ball, for a light that has a position.
    pub size: f64,
    /// The colour of its highlights.
    pub highlight: DVec3,
    /// True if faces block it.
    pub casts_shadows: bool,
}

/// The kinds of lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// From a point in all directions.
    Point(DVec3),
    /// Parallel along a direction, from infinity.
    Parallel(DVec3),
    /// From a point along a direction, within a cone.
    Spot {
        /// The position.
        position: DVec3,
        /// The axis.
        direction: DVec3,
        /// The full opening angle in radians.
        angle: f64,
        /// The fraction of the opening over which the light fades, 0 to 1.
        soft: f64,
    },
    /// Parallel rays along an axis, within a cylinder that begins at a point.
    Beam {
        /// The point.
        position: DVec3,
        /// The axis.
        direction: DVec3,
        /// The cylinder's radius.
        radius: f64,
        /// The fraction of the radius over which the light fades, 0 to 1.
        soft: f64,
    },
}

/// A light as seen from a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenLight {
    /// The unit direction towards the light.
    pub towards: DVec3,
    /// The distance; infinite for a parallel light.
    pub distance: f64,
    /// The fraction of its colour that arrives, without shadows: S·(falloff/(r + path))².
    pub share: f64,
}

/// Points on faces that see a light, one for each lane of the widest vectors.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FaceBlock {
    pub(crate) position: [[f64; MOST_LANES]; 3],
    normal: [[f64; MOST_LANES]; 3],
    /// The length of the path from there to the eye.
    path: [f64; MOST_LANES],
    /// The sample point on an emitting ball.
    sample: [[f64; 2]; MOST_LANES],
}

/// A light as seen from these points, with the numbers of [`SeenLight`].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SeenBlock {
    pub(crate) towards: [[f64; MOST_LANES]; 3],
    pub(crate) distance: [f64; MOST_LANES],
    pub(crate) share: [f64; MOST_LANES],
    /// The cosines of the angles between the direction towards the light and the normals.
    pub(crate) height: [f64; MOST_LANES],
}

impl FaceBlock {
    #[inline]
    pub(crate) fn set(
        &mut self,
        lane: usize,
        position: DVec3,
        normal: DVec3,
        path: f64,
        sample: [f64; 2],
    ) {
        for axis in 0..3 {
            self.position[axis][lane] = position[axis];
            self.normal[axis][lane] = normal[axis];
        }
        self.path[lane] = path;
        self.sample[lane] = sample;
    }
}

impl SeenBlock {
    /// Returns the points that some of the light reaches, without shadows.
    #[inline]
    pub(crate) fn lit(&self) -> Lanes {
        Lanes::of(|lane| self.height[lane] > 0.0 && self.share[lane] > 0.0)
    }

    #[inline]
    pub(crate) fn light(&self, lane: usize) -> SeenLight {
        let [x, y, z] = &self.towards;
        SeenLight {
            towards: DVec3::new(x[lane], y[lane], z[lane]),
            distance: self.distance[lane],
            share: self.share[lane],
        }
    }
}

/// [`Light::from`] for a light that has a position and no size.
struct PointSeenFrom<'a> {
    position: DVec3,
    falloff: Option<f64>,
    faces: &'a [FaceBlock],
    seen: &'a mut [SeenBlock],
}

impl VectorWork for PointSeenFrom<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Instructions>(self, s: S) {
        let (zero, one) = (Vector::splat(s, 0.0), Vector::splat(s, 1.0));
        let endless = Vector::splat(s, f64::INFINITY);
        for (face, seen) in self.faces.iter().zip(self.seen) {
            for part in 0..Vector::<S>::PARTS {
                let [x, y, z] = &face.position;
                let x = Vector::splat(s, self.position.x) - Vector::load(s, x, part);
                let y = Vector::splat(s, self.position.y) - Vector::load(s, y, part);
                let z = Vector::splat(s, self.position.z) - Vector::load(s, z, part);
                let distance = (x * x + y * y + z * z).sqrt();
                let reciprocal = one / distance;
                let is_apart = zero.lt(reciprocal) & reciprocal.lt(endless);
                let x = is_apart.choose(x * reciprocal, zero);
                let y = is_apart.choose(y * reciprocal, zero);
                let z = is_apart.choose(z * reciprocal, zero);
                let share = if let Some(falloff) = self.falloff {
                    let path = distance + Vector::load(s, &face.path, part);
                    let ratio = Vector::splat(s, falloff) / path;
                    distance.lt(endless).choose(ratio * ratio, one)
                } else {
                    one
                };
                let [nx, ny, nz] = &face.normal;
                let height = Vector::load(s, nx, part) * x
                    + Vector::load(s, ny, part) * y
                    + Vector::load(s, nz, part) * z;
                x.store(&mut seen.towards[0], part);
                y.store(&mut seen.towards[1], part);
                z.store(&mut seen.towards[2], part);
                distance.store(&mut seen.distance, part);
                share.store(&mut seen.share, part);
                height.store(&mut seen.height, part);
            }
        }
    }
}

impl Light {
    /// Returns the light as seen from all these points.
    pub(crate) fn seen_from(
        &self,
        processor: Processor,
        faces: &[FaceBlock],
        seen: &mut [SeenBlock],
    ) {
        if let LightKind::Point(position) = self.kind
            && self.size <= 0.0
        {
            return processor.run_vectors(PointSeenFrom {
                position,
                falloff: self.falloff,
                faces,
                seen,
            });
        }
        // It is the same from everywhere.
        let parallel = match self.kind {
            LightKind::Parallel(_) => Some(self.from(DVec3::ZERO, [0.5; 2], 0.0)),
            _ => None,
        };
        for (face, seen) in faces.iter().zip(seen) {
            for lane in 0..MOST_LANES {
                let [position, normal] = [&face.position, &face.normal]
                    .map(|[x, y, z]| DVec3::new(x[lane], y[lane], z[lane]));
                let light = parallel
                    .unwrap_or_else(|| self.from(position, face.sample[lane], face.path[lane]));
                let [x, y, z] = &mut seen.towards;
                (x[lane], y[lane], z[lane]) = light.towards.into();
                seen.distance[lane] = light.distance;
                seen.share[lane] = light.share;
                seen.height[lane] = normal.dot(light.towards);
            }
        }
    }

    /// Creates a light of this colour that has no size and casts shadows.
    pub fn new(kind: LightKind, colour: DVec3) -> Self {
        Self {
            kind,
            colour,
            ambient: 0.0,
            falloff: None,
            size: 0.0,
            highlight: colour,
            casts_shadows: true,
        }
    }

    /// Returns the light as seen from a point. `sample` is a point on the emitting ball, two numbers from 0 to 1; `path` is
    /// the length of the path from there to the eye, over which the light also fades.
    #[inline]
    pub fn from(&self, place: DVec3, sample: [f64; 2], path: f64) -> SeenLight {
        let (towards, distance, share) = match self.kind {
            LightKind::Point(position) => {
                let offset = self.shining(position - place, sample);
                (offset.normalize_or_zero(), offset.length(), 1.0)
            }
            LightKind::Parallel(direction) => (-direction.normalize_or_zero(), f64::INFINITY, 1.0),
            LightKind::Spot {
                position,
                direction,
                angle,
                soft,
            } => {
                let offset = self.shining(position - place, sample);
                let towards = offset.normalize_or_zero();
                let off = (-towards).angle_between(direction);
                (towards, offset.length(), within(off, 0.5 * angle, soft))
            }
            LightKind::Beam {
                position,
                direction,
                radius,
                soft,
            } => {
                let axis = direction.normalize_or_zero();
                let offset = place - position;
                let along = offset.dot(axis);
                let off = (offset - along * axis).length();
                // It is dark behind the light's position.
                let share = if along > 0.0 {
                    within(off, radius, soft)
                } else {
                    0.0
                };
                (-axis, along.max(0.0), share)
            }
        };
        let fading = match self.falloff {
            Some(falloff) if distance.is_finite() => (falloff / (distance + path)).powi(2),
            _ => 1.0,
        };
        SeenLight {
            towards,
            distance,
            share: if share > 0.0 { share * fading } else { 0.0 },
        }
    }

    /// Returns the vector to a point of the disc that the ball shows.
    fn shining(&self, centre: DVec3, [u, v]: [f64; 2]) -> DVec3 {
        if self.size <= 0.0 || centre == DVec3::ZERO {
            return centre;
        }
        let (across, along) = centre.normalize().any_orthonormal_pair();
        let (sin, cos) = (std::f64::consts::TAU * v).sin_cos();
        centre + self.size * u.sqrt() * (cos * across + sin * along)
    }
}

/// Returns 1 − smoothstep from (1 − soft)·edge to the edge.
fn within(x: f64, edge: f64, soft: f64) -> f64 {
    let inner = (1.0 - soft) * edge;
    if x >= edge {
        return 0.0;
    }
    if x <= inner {
        return 1.0;
    }
    let s = (x - inner) / (edge - inner);
    1.0 - s * s * (3.0 - 2.0 * s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_places_see_what_each_sees_alone() {
        let position = DVec3::new(0.3, -0.7, 2.0);
        let direction = DVec3::new(0.2, 0.4, -3.0);
        let kinds = [
            LightKind::Point(position),
            LightKind::Parallel(direction),
            LightKind::Parallel(DVec3::ZERO),
            LightKind::Spot {
                position,
                direction,
                angle: 1.0,
                soft: 0.5,
            },
            LightKind::Beam {
                position,
                direction,
                radius: 1.0,
                soft: 0.5,
            },
        ];
        let coordinates = [-2.0, -0.7, 0.3, 1.1, 2.0, f64::INFINITY];
        let places: Vec<DVec3> = (0..6usize.pow(3))
            .map(|k| DVec3::from_array([k % 6, k / 6 % 6, k / 36].map(|k| coordinates[k])))
            .collect();
        for kind in kinds {
            for (falloff, size) in [(None, 0.0), (Some(3.0), 0.0), (Some(0.5), 0.2)] {
                let light = Light {
                    falloff,
                    size,
                    ..Light::new(kind, DVec3::ONE)
                };
                for places in places.chunks(MOST_LANES) {
                    let sample = |lane: usize| [lane as f64 / 9.0, 0.4];
                    let path = |lane: usize| 0.5 * lane as f64;
                    let normal = |lane: usize| DVec3::new(0.6, 0.1 * lane as f64, 0.8);
                    let mut block = FaceBlock::default();
                    for (lane, place) in places.iter().enumerate() {
                        block.set(lane, *place, normal(lane), path(lane), sample(lane));
                    }
                    for processor in [Processor::here(), Processor::least()] {
                        let mut seen = [SeenBlock::default()];
                        light.seen_from(processor, &[block], &mut seen);
                        for (lane, place) in places.iter().enumerate() {
                            let alone = light.from(*place, sample(lane), path(lane));
                            let found = seen[0].light(lane);
                            // NaN differs from itself, and is written as one.
                            assert_eq!(format!("{found:?}"), format!("{alone:?}"), "{light:?}");
                            let height = normal(lane).dot(alone.towards);
                            let found = seen[0].height[lane];
                            assert_eq!(format!("{found:?}"), format!("{height:?}"));
                        }
                    }
                }
            }
        }
    }
}
