//! The holonomy of walks. In: a frame transported along a closed walk. Out: the angle by which it returns turned.
//!
//! By the Gauss–Bonnet theorem that angle is ∫K over the enclosed region, up to full turns (do Carmo, *Differential Geometry
//! of Curves and Surfaces*, 1976, section 4-4).

use std::f64::consts::TAU;

use super::gap::AimedPlace;
use super::quadrature;
use super::source::RaySource;
use crate::frame::Frame;
use crate::metric::{Metric, christoffel, speed};
use crate::point::{TangentVector, Uv};
use crate::surface::Surface;

/// The end of a walk relative to its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closing {
    /// The distance from the end to the start by the metric at the start, which is valid only where they are close.
    pub gap: f64,
    /// The angle in (−π, π] by which parallel transport along the walk has turned the frame; `None` where the walk has not
    /// closed, or has returned mirrored.
    pub holonomy: Option<f64>,
    /// True if left and right are exchanged.
    pub mirrored: bool,
}

/// Compares the frame at the end of a walk with the one at its start. The walk has closed if the end is within
/// `tolerance` of the start. `turned` is the sum of the angles by which the frame was turned on the way, from X towards
/// Y, other than by parallel transport. `None` where the surface has no tangent plane at the start.
pub fn closing(
    surface: &dyn Surface,
    start: &Frame,
    end: &Frame,
    turned: f64,
    tolerance: f64,
) -> Option<Closing> {
    let source = RaySource::at(surface, start.uv).ok()?;
    let target = AimedPlace::new(surface, start.uv).ok()?;
    let [first, last] = [start, end].map(|frame| frame.plain(surface));
    let gap = target.distance_from(last.uv)?;
    let [before, after] = [start, end].map(|frame| frame.is_mirrored(surface));
    let mirrored = before != after;
    let closed = gap <= tolerance && !mirrored;
    let angle = |frame: &Frame| source.angle_of(frame.uv, frame.x);
    let hand = if before { -1.0 } else { 1.0 };
    let holonomy = match (angle(&first), angle(&last)) {
        (Some(first), Some(last)) if closed => Some(wrapped(last - first - hand * turned)),
        _ => None,
    };
    Some(Closing {
        gap,
        holonomy,
        mirrored,
    })
}

/// The length of a curve of the chart, and the parallel transport of a vector along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transport {
    /// The curve's length.
    pub length: f64,
    /// The angle by which parallel transport turns a vector against σu; for a closed curve its holonomy, except for the
    /// turns of σu itself around a pole.
    pub angle: f64,
    /// The estimated error of the length.
    pub length_error: f64,
    /// The estimated error of the angle.
    pub angle_error: f64,
}

/// The relative accuracy aimed at, and the maximum number of the quadrature's intervals.
const TOLERANCE: f64 = 1e-11;
const MOST: usize = 200;

/// Transports a vector along a curve t ↦ (u, v), (u', v'), smooth between neighbouring `breaks`. `None` where σu has no
/// direction, or the surface is undefined.
pub fn transport(
    surface: &dyn Surface,
    curve: &dyn Fn(f64) -> (Uv, TangentVector),
    breaks: &[f64],
) -> Option<Transport> {
    let mut rates = |t: f64| {
        let (given, velocity) = curve(t);
        let mut at = given.0;
        let signs = surface.sides().bring_back(surface.domain(), &mut at).signs;
        let [u, v] = [0, 1].map(|k| signs[k] * velocity[k]);
        let jet = surface.jet(Uv(at));
        let Metric { e, r, .. } = Metric::of(&jet);
        // The connection form of the frame whose first vector is along σu.
        let [uu, uv, _] = christoffel(&jet)[1];
        let turn = -r / e * (uu * u + uv * v) * signs[0] * signs[1];
        let pace = speed(&jet, [u, v]);
        let finite = turn.is_finite() && pace.is_finite();
        finite.then_some([pace, turn]).ok_or(())
    };
    let found = quadrature::integrate(breaks, TOLERANCE, MOST, &mut rates).ok()?;
    Some(Transport {
        length: found.values[0],
        angle: found.values[1],
        length_error: found.errors[0],
        angle_error: found.errors[1],
    })
}

/// Returns an angle reduced to (−π, π].
fn wrapped(angle: f64) -> f64 {
    let turns = angle / TAU;
    (turns - (turns - 0.5).ceil()) * TAU
}
