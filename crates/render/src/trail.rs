//! Trails: paths that a geodesic camera has walked or that were measured, drawn in both views with their length.
//!
//! In: a camera's steps. Out: points of the chart, dense enough to be joined by straight lines.

use std::sync::Arc;

use geodesic::frame::Frame;
use geodesic::metric::Metric;
use geodesic::surface::{Side, Surface};
use geodesic::trace::{Options, Trace, TraceError};
use geometry::{GeodesicStart, Knot, MAX_LINE_EVALUATIONS, Manifold, knots_at};
use scene::ParamValues;
use scene::{ObjectId, Scene};

use crate::figure::Figure;
use crate::point::WorldPoint;

/// The number of points for each zoom that is walked.
const POINTS: f64 = 48.0;
/// The maximum number of points of one step.
const MOST_FOR_STEP: f64 = 512.0;
/// The maximum number of points of a trail: beyond it, every other one is removed.
const MOST_POINTS: usize = 1 << 16;

/// The origin of a trail, which determines its look.
#[derive(Clone, Debug, PartialEq)]
pub enum TrailKind {
    /// A camera has walked it.
    Walked,
    /// It is a line of a figure: a side, a circle, the mark at a point.
    Measured(Arc<Figure>),
}

/// A point of a figure with its letter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaceMark {
    /// The letter, which is written beside it.
    pub letter: char,
    /// The point (u, v).
    pub at: [f64; 2],
}

/// A path on a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Trail {
    /// Its origin.
    pub kind: TrailKind,
    /// The surface or metric.
    pub surface: ObjectId,
    /// Its points (u, v) in the order of the walk; neighbours are joined, across sides that are glued too.
    pub points: Vec<[f64; 2]>,
    /// Its length, in the surface's units.
    pub length: f64,
    /// The point that it encircles, if it is a mark.
    pub mark: Option<PlaceMark>,
}

impl Trail {
    /// Creates an empty trail.
    pub fn new(surface: ObjectId, at: [f64; 2]) -> Self {
        Self {
            kind: TrailKind::Walked,
            surface,
            points: vec![at],
            length: 0.0,
            mark: None,
        }
    }

    /// Creates a trail through points of a surface, joined by straight lines of the chart, across sides that wrap. Its
    /// length is that of these lines; if a line crosses a pole or a side with a flip, that of the chord.
    pub fn through(surface: &dyn Surface, id: ObjectId, points: Vec<[f64; 2]>) -> Self {
        let length = points
            .windows(2)
            .map(|ends| ChartLine::new(surface, [ends[0], ends[1]]).length());
        Self {
            kind: TrailKind::Walked,
            surface: id,
            length: length.sum(),
            points,
            mark: None,
        }
    }

    /// Moves a camera as [`Frame::advance`] does, and records the path.
    ///
    /// # Errors
    /// Those of [`Frame::advance`]; the trail is then unchanged.
    pub fn walk(
        &mut self,
        manifold: &Manifold,
        frame: &Frame,
        step: [f64; 2],
    ) -> Result<(Frame, Trace), TraceError> {
        let surface = manifold.surface();
        let (moved, trace) = frame.advance(surface, step, &Options::default())?;
        let share = step[0].hypot(step[1]);
        if share > 0.0 {
            let pieces = (POINTS * share).ceil().clamp(1.0, MOST_FOR_STEP) as u32;
            // The last point is the camera's current position.
            let lengths: Vec<f64> = (1..pieces)
                .map(|k| trace.length * f64::from(k) / f64::from(pieces))
                .collect();
            let start = GeodesicStart::Frame(frame, step);
            let line = knots_at(surface, &start, &lengths, MAX_LINE_EVALUATIONS);
            self.points
                .extend(line.knots.into_iter().flatten().map(|k| k.uv));
            self.points.push(trace.uv.0);
            self.length += trace.length;
            if self.points.len() > MOST_POINTS {
                self.thin_out();
            }
        }
        Ok((moved, trace))
    }

    /// Removes every other point, except the first and the last.
    fn thin_out(&mut self) {
        let last = self.points.len() - 1;
        let mut index = 0;
        self.points.retain(|_| {
            index += 1;
            (index - 1) % 2 == 0 || index - 1 == last
        });
    }
}

/// A step by more than this fraction of one axis, between points this near to a pole of the other one, passes through the pole.
const TURNS: f64 = 0.2;
/// The sum of both points' distances from the pole, as a fraction of the axis that ends there.
const NEAR_POLE: f64 = 0.1;
/// The fraction of a side that is glued with a flip beyond which a step passes through the flip.
const FLIPS: f64 = 0.5;

/// The number of pieces of a line in space across a whole domain.
const PIECES: f64 = 128.0;

/// A straight line of the chart from one point to another, across sides that wrap.
pub(crate) struct ChartLine<'s> {
    surface: &'s dyn Surface,
    from: [f64; 2],
    to: [f64; 2],
    /// The difference from the first point to the second.
    pub(crate) step: [f64; 2],
    /// True if it passes through a pole or a flip, where the chart has no such line.
    pub(crate) turns: bool,
}

impl<'s> ChartLine<'s> {
    pub(crate) fn new(surface: &'s dyn Surface, [from, to]: [[f64; 2]; 2]) -> Self {
        let (domain, sides) = (surface.domain(), surface.sides());
        let mut turns = false;
        let step = [0, 1].map(|axis| {
            let period = domain[axis][1] - domain[axis][0];
            let mut step = to[axis] - from[axis];
            if sides.of(axis)[0] == Side::Wrap {
                step -= period * (step / period).round();
            }
            let flips = sides.of(axis)[0] == Side::WrapFlip && step.abs() > FLIPS * period;
            let [low, high] = domain[1 - axis];
            let is_near = |pole: f64| {
                let away = (from[1 - axis] - pole).abs() + (to[1 - axis] - pole).abs();
                away <= NEAR_POLE * (high - low)
            };
            let mut poles = [low, high].into_iter().zip(sides.of(1 - axis));
            let is_at_pole = poles.any(|(pole, side)| side == Side::Pole && is_near(pole));
            turns |= flips || is_at_pole && step.abs() > TURNS * period;
            step
        });
        Self {
            surface,
            from,
            to,
            step,
            turns,
        }
    }

    /// Returns the point at a fraction of it.
    fn at(&self, share: f64) -> [f64; 2] {
        let (domain, sides) = (self.surface.domain(), self.surface.sides());
        [0, 1].map(|axis| {
            let [low, high] = domain[axis];
            let at = self.from[axis] + share * self.step[axis];
            // Beyond a side that wraps, the chart begins again.
            match sides.of(axis)[0] {
                Side::Wrap => low + (at - low).rem_euclid(high - low),
                _ => at,
            }
        })
    }

    /// Returns the number of pieces in which it is drawn in space; one if it is not a line of the chart.
    fn pieces(&self) -> u32 {
        let domain = self.surface.domain();
        let shares = [0, 1].map(|axis| self.step[axis] / (domain[axis][1] - domain[axis][0]));
        let pieces = (PIECES * shares[0].abs().max(shares[1].abs())).ceil();
        if self.turns {
            1
        } else {
            pieces.clamp(1.0, PIECES) as u32
        }
    }

    /// Returns its length, ∫√(E du² + 2F du dv + G dv²), by Gaussian quadrature with three nodes for each of its pieces; that
    /// of the chord if it is not a line of the chart.
    fn length(&self) -> f64 {
        if self.turns && self.surface.is_embedded() {
            let [a, b] = [self.from, self.to].map(|uv| self.surface.jet(uv.into()).position);
            return (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
        }
        let node = 0.5 * 0.6_f64.sqrt();
        let nodes = [(0.5 - node, 5.0), (0.5, 8.0), (0.5 + node, 5.0)];
        let speed = |share: f64| {
            let Metric { e, f, g, .. } = Metric::of(&self.surface.jet(self.at(share).into()));
            let [u, v] = self.step;
            (e * u * u + 2.0 * f * u * v + g * v * v).max(0.0).sqrt()
        };
        let pieces = f64::from(self.pieces());
        let piece = |k: u32| -> f64 {
            let nodes = nodes.iter();
            nodes
                .map(|(share, weight)| weight * speed((f64::from(k) + share) / pieces))
                .sum()
        };
        let sum: f64 = (0..self.pieces()).map(piece).sum();
        sum / (18.0 * pieces)
    }
}

impl TrailKind {
    /// Returns whether the key shows its length: a measured length is written beside the trail.
    pub(crate) fn has_key(&self) -> bool {
        *self == Self::Walked
    }

    /// Returns its name in notes.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Walked => "trail",
            Self::Measured(_) => "measured",
        }
    }
}

/// A trail in space.
pub(crate) struct SpaceTrail {
    /// Its points; `None` where its surface is undefined.
    pub(crate) line: Vec<Option<Knot>>,
    /// The point that it encircles, with its letter.
    pub(crate) mark: Option<(char, WorldPoint)>,
}

/// Returns a trail in space; `None` on a metric.
pub(crate) fn in_space(scene: &Scene, params: &ParamValues, trail: &Trail) -> Option<SpaceTrail> {
    let manifold = Manifold::first(scene, params, trail.surface).ok()?;
    let surface: &dyn Surface = manifold.surface();
    surface.is_embedded().then(|| {
        let place = |uv: [f64; 2]| {
            let position = surface.jet(uv.into()).position;
            let defined = position.iter().all(|x| x.is_finite());
            defined.then_some(position)
        };
        let knot = |uv: [f64; 2]| {
            let position = Some(place(uv)?);
            Some(Knot { uv, position })
        };
        let mut places: Vec<[f64; 2]> = trail.points.first().copied().into_iter().collect();
        for ends in trail.points.windows(2) {
            let line = ChartLine::new(surface, [ends[0], ends[1]]);
            let pieces = line.pieces();
            places.extend((1..pieces).map(|k| line.at(f64::from(k) / f64::from(pieces))));
            places.push(ends[1]);
        }
        let mark = trail.mark;
        SpaceTrail {
            line: places.into_iter().map(knot).collect(),
            mark: mark.and_then(|mark| Some((mark.letter, WorldPoint(place(mark.at)?)))),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_lies_on_its_surface_in_space() {
        let source = "surface s(u,v) = ((2 + cos v) cos u, (2 + cos v) sin u, sin v), \
            u : [0, 2pi], v : [0, 2pi];";
        let scene = scene::geotrace::compile(source).scene.expect("a scene");
        let params = ParamValues::initial(&scene);
        let id = ObjectId::new(0);
        let points = vec![[6.0, 0.0], [1.0, 1.0], [1.0, 2.0]];
        let manifold = Manifold::new(&scene, id, &[]).expect("a surface");
        let trail = Trail::through(manifold.surface(), id, points);
        let line = in_space(&scene, &params, &trail).expect("a surface").line;
        let places: Vec<[f64; 3]> = line
            .iter()
            .map(|knot| knot.expect("defined").position.expect("embedded"))
            .collect();
        let mut walked = 0.0;
        for ends in places.windows(2) {
            let middle = [0, 1, 2].map(|k| 0.5 * (ends[0][k] + ends[1][k]));
            let [x, y, z] = middle;
            let off = ((x.hypot(y) - 2.0).hypot(z) - 1.0).abs();
            // Less than the sag of 128 chords around the equator, and of the same number around the tube.
            assert!(off < 2e-3, "{off}");
            walked += (0..3)
                .map(|k| (ends[1][k] - ends[0][k]).powi(2))
                .sum::<f64>()
                .sqrt();
        }
        assert!(
            (walked / trail.length - 1.0).abs() < 1e-2,
            "{walked} {}",
            trail.length
        );
    }

    #[test]
    fn a_path_has_the_length_of_its_lines_in_the_chart() {
        let source =
            "surface s(u,v) = (cos u cos v, sin u cos v, sin v), u : [-pi, pi], v : [-pi/2, pi/2];
            surface p(u,v) = (u, v, u^2), u : [-2, 2], v : [-2, 2];";
        let scene = scene::geotrace::compile(source).scene.expect("a scene");
        let length = |surface: usize, ends: [[f64; 2]; 2]| {
            let id = ObjectId::new(surface);
            let manifold = Manifold::new(&scene, id, &[]).expect("a surface");
            Trail::through(manifold.surface(), id, ends.to_vec()).length
        };
        let pi = std::f64::consts::PI;
        // Along the equator, the shorter way around; along a parallel; through a pole, in a step of a walk.
        let parabola = 2.0 * 17f64.sqrt() + 0.5 * 4f64.asinh();
        for (surface, ends, expected) in [
            (0, [[0.0, 0.0], [1.3, 0.0]], 1.3),
            (0, [[0.0, 0.0], [3.0, 0.0]], 3.0),
            (0, [[0.0, 0.0], [4.0, 0.0]], 2.0 * pi - 4.0),
            (0, [[0.0, 1.0], [2.5, 1.0]], 2.5 * 1f64.cos()),
            (
                0,
                [[0.0, 1.55], [3.0, 1.55]],
                2.0 * 1.55f64.cos() * 1.5f64.sin(),
            ),
            (1, [[-2.0, 0.0], [2.0, 0.0]], parabola),
        ] {
            let found = length(surface, ends);
            assert!(
                (found - expected).abs() < 1e-9 * expected,
                "{ends:?}: {found}, {expected}"
            );
        }
    }
}
