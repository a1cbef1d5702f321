//! The methods that follow a geodesic for each pixel: one row of a picture in, its ends out.

use super::{MapOptions, Method, bring_back, pixel_place};
use crate::chart::Atlas;
use crate::ends::{Coordinates, End, Work};
use crate::follow::{self, Plan};
use crate::frame::Frame;
use crate::integrate::{DOPRI5, RK4};
use crate::metric::Metric;
use crate::surface::{Side, Surface};
use crate::trace::{self, Status};

/// One row of a map; what its parts mean is told by [`Map`](super::Map).
#[derive(Clone, Debug, Default)]
pub(super) struct Row {
    pub(super) offset: Vec<[f32; 2]>,
    pub(super) by_pixel: Vec<[f32; 4]>,
    pub(super) status: Vec<Status>,
    /// The estimated errors of the complete pixels, in pixels, where the method has them.
    pub(super) errors: Vec<f32>,
    pub(super) work: Work,
}

/// A row, counted from the top. It depends on no other row.
pub(super) fn row<S: Surface + ?Sized>(
    surface: &S,
    frame: &Frame,
    size: [u32; 2],
    row: u32,
    options: &MapOptions,
) -> Row {
    let atlas = Atlas::new(surface);
    let mut out = Row::default();
    let zoom = frame.zoom(surface);
    let per_place = 2.0 / f64::from(size[0].min(size[1]).max(1));
    // A pixel's width on the surface, at the centre; per length, over the longest ray of the row's pixels.
    let pixel = zoom * per_place;
    let share = usize::try_from(options.evaluations_per_pixel(size)).unwrap_or(usize::MAX);
    let mirrored = frame.is_mirrored(surface);
    let mut step = None;
    for column in 0..size[0] {
        let place = pixel_place(size, column, row);
        let length = zoom * place[0].hypot(place[1]);
        if length == 0.0 || length.is_nan() {
            out.push([0.0; 2], [frame.x, frame.y], per_place, Status::Complete);
            continue;
        }
        out.work.followed += 1;
        let limit = atlas.evaluations().saturating_add(share);
        let start = match frame.start(&atlas, place) {
            Ok(start) => start,
            Err(_) => {
                out.push([0.0; 2], [[0.0; 2]; 2], per_place, Status::Undefined);
                continue;
            }
        };
        let common = Plan {
            tableau: &DOPRI5,
            tolerance: Some((options.tolerance * pixel / length).clamp(1e-13, 1e-2)),
            step: step.unwrap_or_else(|| trace::first_step(&atlas, length)),
            limit,
            charts: true,
            keep_path: false,
        };
        let plan = match options.method {
            Method::Rk4 { steps, .. } => Plan {
                tableau: &RK4,
                tolerance: None,
                step: length / f64::from(steps.max(1)),
                charts: false,
                ..common
            },
            _ => common,
        };
        let end = follow::follow(&atlas, start, length, plan);
        // The neighbour's geodesic is much the same.
        step = (end.status == Status::Complete).then_some(end.step);
        out.work.steps += end.steps as u64;
        out.work.rejected += end.rejected as u64;
        let adaptive = plan.tolerance.is_some();
        let (offset, lifted) = nearest_repetition(&atlas, frame.uv, end.motion.at);
        let mut by_place = [[0.0; 2]; 2];
        if adaptive && end.status == Status::Complete {
            out.errors.push((end.error / pixel) as f32);
            let metric = Metric::of(&surface.jet(end.motion.at));
            let side = if end.flipped != mirrored { -1.0 } else { 1.0 };
            let left = metric.turn_left(end.motion.velocity);
            let known = End {
                coordinates: Coordinates::Plain,
                at: end.motion.at,
                along: [0, 1].map(|k| lifted[k] * end.motion.velocity[k]),
                across: [0, 1].map(|k| lifted[k] * side * left[k]),
                stretch: end.field / length,
                status: end.status,
                error: end.error / pixel,
            };
            by_place = known.by_place(place, zoom);
        }
        out.push(offset, by_place, per_place, end.status);
    }
    if !(options.by_pixel && matches!(options.method, Method::Adaptive)) {
        out.by_pixel.clear();
    }
    out.work.evaluations = atlas.evaluations() as u64;
    out
}

impl Row {
    fn push(&mut self, offset: [f64; 2], by_place: [[f64; 2]; 2], per_place: f64, status: Status) {
        let finite = offset.iter().all(|x| x.is_finite());
        let offset = if finite { offset } else { [0.0; 2] };
        self.offset.push(offset.map(|x| x as f32));
        let [x, y] = by_place.map(|d| d.map(|c| (c * per_place) as f32));
        let by_pixel = [x[0], x[1], -y[0], -y[1]];
        let finite = by_pixel.iter().all(|x| x.is_finite());
        self.by_pixel.push(if finite { by_pixel } else { [0.0; 4] });
        self.status.push(status);
    }
}

/// A point of the domain as an offset from the camera, through the sides that wrap by the shorter way: single
/// precision keeps what is near. Gives the signs by which the components of a vector at the point change, too.
fn nearest_repetition<S: Surface + ?Sized>(
    atlas: &Atlas<'_, S>,
    origin: [f64; 2],
    at: [f64; 2],
) -> ([f64; 2], [f64; 2]) {
    let domain = atlas.domain;
    let mut lifted = at;
    // First the flip, which changes the other coordinate.
    for flip in [true, false] {
        for axis in 0..2 {
            let side = atlas.sides.of(axis)[0];
            let wanted = if flip { Side::WrapFlip } else { Side::Wrap };
            if side != wanted {
                continue;
            }
            let width = atlas.width(axis);
            let turns = ((origin[axis] - lifted[axis]) / width).round();
            if turns == 0.0 || !turns.is_finite() {
                continue;
            }
            lifted[axis] += turns * width;
            if flip && turns.rem_euclid(2.0) == 1.0 {
                let [low, high] = domain[1 - axis];
                lifted[1 - axis] = low + high - lifted[1 - axis];
            }
        }
    }
    let (_, signs) = bring_back(domain, atlas.sides, lifted);
    ([0, 1].map(|k| lifted[k] - origin[k]), signs)
}
