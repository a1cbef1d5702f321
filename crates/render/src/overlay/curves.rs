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

use super::ink::Inks;
use crate::geodesic_view::PlacedCamera;
use crate::request::PictureRequest;
use crate::style::Theme;
use crate::trail::{ChartLine, Trail};
use geometry::{GeodesicSegment, MAX_POINTS, cut_note, evaluations_per_line};

/// The most pieces of one line in a direction; what is longer is not drawn to its end.
const MOST_PIECES: u32 = 16_384;
/// Pieces are at most so many pixels long: then they are straight.
const STRAIGHT: f64 = 6.0;

/// The most colours that the lines of a declared geodesic have.
const MOST_COLOURS: usize = 64;

/// The lines of one colour of a declared geodesic.
pub(super) struct SurfaceCurve {
    /// Empty but for the first colour.
    pub(super) name: String,
    /// sRGB.
    pub(super) colour: [u8; 3],
    pub(super) notes: Vec<String>,
    /// True of a trail, which has a solid outline.
    is_outlined: bool,
    /// Straight pieces in the chart.
    pieces: Vec<[[f64; 2]; 2]>,
}

/// The colours of the lines of a declared geodesic, sRGB.
pub(super) struct LineColours {
    /// The different ones.
    pub(super) colours: Vec<[u8; 3]>,
    /// The number of the colour of each instance; the last one is that of all further instances.
    numbers: Vec<usize>,
}

impl LineColours {
    /// The colours of instances. Where they are very many, some instances have the colour of another that is nearly theirs.
    pub(super) fn new(instances: &[[u8; 3]]) -> Self {
        let mut colours: Vec<[u8; 3]> = Vec::new();
        let off = |a: &[u8; 3], b: &[u8; 3]| -> u32 {
            (0..3).map(|k| u32::from(a[k].abs_diff(b[k]))).sum()
        };
        let number = |colour: &[u8; 3]| {
            let known = (0..colours.len()).min_by_key(|k| off(&colours[*k], colour));
            match known {
                Some(known) if colours.len() == MOST_COLOURS || colours[known] == *colour => known,
                _ => {
                    colours.push(*colour);
                    colours.len() - 1
                }
            }
        };
        let numbers = instances.iter().map(number).collect();
        Self { colours, numbers }
    }

    /// The number of an instance's colour.
    pub(super) fn number(&self, instance: usize) -> usize {
        let own = self.numbers.get(instance).or(self.numbers.last());
        own.copied().unwrap_or(0)
    }
}

/// All geodesics declared on a surface, of those instances that lie on the one that is seen.
pub(super) fn lines(request: &PictureRequest, camera: &PlacedCamera) -> Vec<SurfaceCurve> {
    let (scene, params, seen) = (&*request.scene, &*request.params, camera.surface);
    let of_surface = scene
        .get(seen)
        .map(|object| params.first_instance(scene, object));
    let of_surface = of_surface.unwrap_or_default();
    let mut all = Vec::new();
    let colours = request.instance_colours();
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
        let colours = LineColours::new(&colours[id.index()]);
        let empty = |colour: &[u8; 3]| SurfaceCurve {
            name: String::new(),
            colour: *colour,
            notes: Vec::new(),
            is_outlined: false,
            pieces: Vec::new(),
        };
        let mut curves: Vec<SurfaceCurve> = colours.colours.iter().map(empty).collect();
        let instances = params
            .instance_count(scene, object)
            .min((MAX_POINTS / u64::from(pieces)).max(1));
        let max_evaluations = evaluations_per_line(scene, instances);
        let mut fault = None;
        let mut is_cut = false;
        let mut lines = Vec::new();
        let mut numbers = Vec::new();
        for instance in 0..instances {
            let uniforms = params.instance(scene, object, instance);
            if used.iter().any(|&k| uniforms.get(k) != of_surface.get(k)) {
                continue;
            }
            match evaluator.evaluate(&uniforms) {
                Ok(initial) => {
                    let whole = lengths.map(|t| t * initial.unit);
                    let lengths = drawn_range(whole, straight);
                    is_cut |= lengths != whole;
                    numbers.push(colours.number(instance as usize));
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
        for (line, number) in camera.manifold().polylines(&lines).iter().zip(numbers) {
            curves[number].add(&line.points, camera);
            is_cut |= line.is_cut;
        }
        let mut notes = Vec::new();
        let name = &object.name;
        if is_cut {
            notes.push(cut_note(name));
        }
        if let Some(fault) = fault {
            notes.push(format!(
                "`{name}` is not drawn in all its instances: {fault}"
            ));
        }
        // The first one that is drawn has the name.
        curves.retain(|curve| !curve.pieces.is_empty());
        if curves.is_empty() && !notes.is_empty() {
            curves.extend(colours.colours.first().map(empty));
        }
        if let Some(first) = curves.first_mut() {
            first.name.clone_from(name);
            first.notes = notes;
        }
        all.extend(curves);
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
pub(super) fn trail(trail: &Trail, camera: &PlacedCamera, theme: Theme) -> SurfaceCurve {
    let mut curve = SurfaceCurve {
        name: String::new(),
        colour: Inks::of(theme).trail(&trail.kind),
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
