//! Curves on the surface of a geodesic view: declared geodesics and trails, of which all images are seen.
//!
//! A scene's declarations and a camera flow in, straight pieces in the chart flow out; `layer.rs` draws them, and
//! `names.rs` finds where their names may be on the way.

mod layer;
mod names;
mod table;

pub(super) use layer::Lines;
pub(super) use names::{NamePlace, NamePlaces};

use scene::InitialConditionsEvaluator;

use super::ink;
use crate::geodesic_view::PlacedCamera;
use crate::request::PictureRequest;
use crate::trail::{ChartLine, Trail};
use geometry::{GeodesicSegment, MAX_POINTS, cut_note, evaluations_per_line};

/// The most pieces of one line in a direction; what is longer is not drawn to its end.
const MOST_PIECES: u32 = 16_384;
/// Pieces are at most so many pixels long: then they are straight.
const STRAIGHT: f64 = 6.0;

/// The lines of one declared geodesic.
pub(super) struct SurfaceCurve {
    pub(super) name: String,
    /// sRGB.
    pub(super) colour: [u8; 3],
    pub(super) notes: Vec<String>,
    /// True of a trail, which has a solid outline.
    is_outlined: bool,
    /// Straight pieces in the chart.
    pieces: Vec<[[f64; 2]; 2]>,
}

/// All geodesics declared on a surface, of those instances that lie on the one that is seen.
pub(super) fn lines(request: &PictureRequest, camera: &PlacedCamera) -> Vec<SurfaceCurve> {
    let (scene, params, seen) = (&*request.scene, &*request.params, camera.surface);
    let mut all = Vec::new();
    for (id, object) in scene.geodesics_on(seen) {
        let Some((_, domain)) = object.shape.geodesic() else {
            continue;
        };
        let Some(mut evaluator) = InitialConditionsEvaluator::new(scene, id) else {
            continue;
        };
        let straight = straight(camera.size(), camera.zoom);
        let lengths = [domain.range.min, domain.range.max];
        let pieces = piece_count(lengths[1] - lengths[0], domain.count, straight);
        let used = camera.uniforms_used(scene, seen);
        let mut curve = SurfaceCurve {
            name: object.name.clone(),
            colour: request.srgb(id),
            notes: Vec::new(),
            is_outlined: false,
            pieces: Vec::new(),
        };
        let instances = params
            .instance_count(scene, object)
            .min((MAX_POINTS / u64::from(pieces)).max(1));
        let max_evaluations = evaluations_per_line(scene, instances);
        let mut fault = None;
        let mut is_cut = false;
        let mut lines = Vec::new();
        for instance in 0..instances {
            let uniforms = params.instance(scene, object, instance);
            if used
                .iter()
                .any(|&k| uniforms.get(k) != camera.uniforms.get(k))
            {
                continue;
            }
            match evaluator.evaluate(&uniforms) {
                Ok(initial) => {
                    let whole = lengths.map(|t| t * initial.unit);
                    let lengths = drawn_range(whole, straight);
                    is_cut |= lengths != whole;
                    lines.push(GeodesicSegment {
                        start: initial.start,
                        direction: initial.direction,
                        lengths,
                        pieces: piece_count(lengths[1] - lengths[0], domain.count, straight),
                        max_evaluations,
                    });
                }
                Err(error) => fault = Some(error),
            }
        }
        for line in camera.manifold().polylines(&lines) {
            curve.add(&line.points, camera);
            is_cut |= line.is_cut;
        }
        if is_cut {
            curve.notes.push(cut_note(&curve.name));
        }
        if let Some(fault) = fault {
            let name = &curve.name;
            curve.notes.push(format!(
                "`{name}` is not drawn in all its instances: {fault}"
            ));
        }
        if !curve.pieces.is_empty() || !curve.notes.is_empty() {
            all.push(curve);
        }
    }
    all
}

/// The longest piece that is straight in a picture of a size whose camera has a zoom.
pub(super) fn straight(size: [u32; 2], zoom: f64) -> f64 {
    let [width, height] = size.map(f64::from);
    STRAIGHT * 2.0 * zoom / width.min(height).max(1.0)
}

/// The part of a line, an interval of arc lengths, that [`MOST_PIECES`] straight ones reach: that nearest to its start. It
/// changes only now and then while a camera zooms.
pub(super) fn drawn_range([low, high]: [f64; 2], straight: f64) -> [f64; 2] {
    let reach = (f64::from(MOST_PIECES) * straight).log2().floor().exp2();
    [
        low.max(high.min(0.0) - reach),
        high.min(low.max(0.0) + reach),
    ]
}

/// Returns the number of pieces of a line: more than are needed, so that a camera that zooms needs others only now and
/// then.
pub(super) fn piece_count(length: f64, samples: u32, straight: f64) -> u32 {
    let needed = (length / straight).ceil();
    let needed = needed.clamp(1.0, f64::from(2 * MOST_PIECES)) as u32;
    let samples = samples.clamp(1, 2 * MOST_PIECES);
    needed.next_power_of_two().max(samples)
}

/// A trail on the surface that is seen.
pub(super) fn trail(trail: &Trail, camera: &PlacedCamera) -> SurfaceCurve {
    let mut curve = SurfaceCurve {
        name: String::new(),
        colour: ink::trail(&trail.kind),
        notes: Vec::new(),
        is_outlined: true,
        pieces: Vec::new(),
    };
    let points: Vec<_> = trail.points.iter().copied().map(Some).collect();
    curve.add(&points, camera);
    curve
}

impl SurfaceCurve {
    /// Takes a polyline apart; at seams a piece is continued on both sides.
    fn add(&mut self, points: &[Option<[f64; 2]>], camera: &PlacedCamera) {
        let surface = camera.manifold().surface();
        for pair in points.windows(2) {
            let [Some(from), Some(to)] = [pair[0], pair[1]] else {
                continue;
            };
            // Through a flip or a pole the chart turns over: what lies between is less than a step.
            let ChartLine { step, turns, .. } = ChartLine::new(surface, [from, to]);
            if turns {
                continue;
            }
            self.pieces
                .push([from, [from[0] + step[0], from[1] + step[1]]]);
            if [0, 1]
                .iter()
                .any(|&k| (from[k] + step[k] - to[k]).abs() > 1e-12 * step[k].abs())
            {
                self.pieces.push([[to[0] - step[0], to[1] - step[1]], to]);
            }
        }
    }
}
