//! The path of a geodesic camera: its trail is drawn, and a recording replays its motions.
//!
//! In: motions from the camera's controller. Out: the trail with its length, and any part of the motions.

use std::sync::Arc;

use geodesic::metric::Metric;
use geodesic::surface::Surface;
use render::trail::Trail;
use scene::ObjectId;

use crate::ChartCamera;
use crate::motion::{Motion, push};

/// The maximum number of motions that are stored: a path with more can no longer be replayed.
const MOST: usize = 1 << 16;
/// The number of points along a trail at which two surfaces are compared.
const SAMPLES: usize = 64;

/// A path from the start of its trail.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPath {
    /// The trail and its length.
    pub trail: Arc<Trail>,
    /// The camera at the start.
    pub start: ChartCamera,
    /// The motions since then, in order; empty if there were too many to store.
    motions: Vec<Motion>,
    full: bool,
}

impl CameraPath {
    /// Begins a path at a camera's position.
    pub fn begin(surface: ObjectId, camera: ChartCamera) -> Self {
        Self {
            trail: Arc::new(Trail::new(surface, camera.at)),
            start: camera,
            motions: Vec::new(),
            full: false,
        }
    }

    /// Records a completed motion.
    pub(crate) fn note(&mut self, motion: Motion) {
        if self.full {
            return;
        }
        push(&mut self.motions, motion);
        if self.motions.len() > MOST {
            self.motions = Vec::new();
            self.full = true;
        }
    }

    /// Returns the motions in order; empty if there were too many to store.
    pub fn motions(&self) -> &[Motion] {
        &self.motions
    }

    /// Returns whether the trail ends at a chart point.
    pub fn ends_at(&self, uv: [f64; 2]) -> bool {
        self.trail.points.last() == Some(&uv)
    }

    /// Returns whether the trail is the same path of the same length on both surfaces, up to rounding.
    pub(crate) fn fits(&self, before: &dyn Surface, after: &dyn Surface) -> bool {
        let points = &self.trail.points;
        let step = points.len().div_ceil(SAMPLES).max(1);
        let mut samples = points.iter().step_by(step).chain(points.last());
        before.domain() == after.domain()
            && before.sides() == after.sides()
            && samples.all(|&uv| close(form(before, uv), form(after, uv)))
    }
}

/// Returns the first fundamental form: E, F, G.
fn form(surface: &dyn Surface, uv: [f64; 2]) -> [f64; 3] {
    let Metric { e, f, g, r: _ } = Metric::of(&surface.jet(uv.into()));
    [e, f, g]
}

fn close(a: [f64; 3], b: [f64; 3]) -> bool {
    let size = a[0].abs().max(a[2].abs());
    // Coefficients that are undefined on both surfaces count as equal.
    a.iter()
        .zip(b)
        .all(|(a, b)| (a - b).abs() <= 1e-9 * size || a.is_nan() && b.is_nan())
}

/// Returns the contribution of a motion to a path: lengths of X, radians and logarithms count alike, so that turns take
/// time too.
fn weight(motion: &Motion) -> f64 {
    match motion {
        Motion::Walk([x, y]) => x.hypot(*y),
        Motion::Turn(angle) => angle.abs(),
        Motion::Zoom(factor) => factor.ln().abs(),
    }
}

/// Returns a fraction, from 0 to 1, of a motion.
fn part(motion: &Motion, share: f64) -> Motion {
    match motion {
        Motion::Walk(step) => Motion::Walk(step.map(|x| share * x)),
        Motion::Turn(angle) => Motion::Turn(share * angle),
        Motion::Zoom(factor) => Motion::Zoom(factor.powf(share)),
    }
}

/// Returns the part of some motions between two fractions of the whole: 0 is its start and 1 its end.
pub fn between(motions: &[Motion], [from, to]: [f64; 2]) -> Vec<Motion> {
    let whole: f64 = motions.iter().map(weight).sum();
    let (from, to) = (from * whole, to * whole);
    let mut done = 0.0;
    let mut parts = Vec::new();
    for motion in motions {
        let weight = weight(motion);
        let (first, last) = ((from - done).max(0.0), (to - done).min(weight));
        if last > first {
            parts.push(part(motion, (last - first) / weight));
        }
        done += weight;
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::{between, weight};
    use crate::motion::Motion;

    #[test]
    fn the_parts_of_a_path_are_the_path() {
        let motions = [
            Motion::Walk([0.0, 2.0]),
            Motion::Turn(-0.5),
            Motion::Zoom(0.25),
            Motion::Walk([-1.0, 0.0]),
        ];
        let whole: f64 = motions.iter().map(weight).sum();
        let (mut walked, mut turned, mut zoomed, mut weights) = ([0.0; 2], 0.0, 0.0, 0.0);
        for k in 0..7 {
            let shares = [f64::from(k) / 7.0, f64::from(k + 1) / 7.0];
            let parts = between(&motions, shares);
            weights += parts.iter().map(weight).sum::<f64>();
            for part in parts {
                match part {
                    Motion::Walk([x, y]) => walked = [walked[0] + x, walked[1] + y],
                    Motion::Turn(angle) => turned += angle,
                    Motion::Zoom(factor) => zoomed += factor.ln(),
                }
            }
        }
        assert!((weights - whole).abs() < 1e-12, "{weights} of {whole}");
        assert!((walked[0] + 1.0).abs() < 1e-12 && (walked[1] - 2.0).abs() < 1e-12);
        assert!((turned + 0.5).abs() < 1e-12, "{turned}");
        assert!((zoomed - 0.25f64.ln()).abs() < 1e-12, "{zoomed}");
        assert!(between(&motions, [0.0, 0.0]).is_empty());
        assert_eq!(
            between(&motions[..1], [0.25, 1.0]),
            [Motion::Walk([0.0, 1.5])]
        );
    }
}
