//! The methods that follow a geodesic for each pixel: one row of a picture in, its ends out.

use super::{Arithmetic, MOST_FOR_PIXEL, MapOptions, Method, bring_back, pixel_place, rk4};
use crate::chart::{Atlas, Motion};
use crate::ends::{Coordinates, End, Work};
use crate::follow::{self, Plan, Start};
use crate::frame::Frame;
use crate::integrate::DOPRI5;
use crate::metric::Metric;
use crate::surface::{LANES, Side, Surface};
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

/// What the pixels of a row share.
struct Line<'a, 's, S: Surface + ?Sized> {
    surface: &'s S,
    atlas: &'a Atlas<'s, S>,
    frame: &'a Frame,
    zoom: f64,
    /// A pixel's width in the picture, and on the surface at the centre.
    per_place: f64,
    pixel: f64,
}

/// A pixel whose geodesic has a length.
struct Pixel {
    length: f64,
    start: Start,
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
    let zoom = frame.zoom(surface);
    let per_place = 2.0 / f64::from(size[0].min(size[1]).max(1));
    let line = Line {
        surface,
        atlas: &atlas,
        frame,
        zoom,
        per_place,
        pixel: zoom * per_place,
    };
    let mut out = Row::default();
    let places = (0..size[0]).map(|column| pixel_place(size, column, row));
    let share = options.evaluations_per_pixel(size);
    match options.method {
        Method::Rk4 { steps, arithmetic } => {
            // A fixed number of steps is a limit by itself, within reason.
            let affordable = share.max(MOST_FOR_PIXEL) / 4;
            let steps = u64::from(steps.max(1));
            let limited = steps > affordable;
            let steps = steps.min(affordable) as u32;
            line.rk4(places, steps, arithmetic, limited, &mut out);
        }
        _ => {
            let share = usize::try_from(share).unwrap_or(usize::MAX);
            line.adaptive(places, share, options, &mut out);
            out.work.evaluations = atlas.evaluations() as u64;
        }
    }
    out
}

impl<S: Surface + ?Sized> Line<'_, '_, S> {
    /// The pixel at a place; what needs no geodesic is put down at once.
    fn pixel(&self, place: [f64; 2], by_pixel: bool, out: &mut Row) -> Option<Pixel> {
        let length = self.zoom * place[0].hypot(place[1]);
        if length == 0.0 || length.is_nan() {
            // At a pole (u,v) has no directions.
            let by_place = match self.frame.coordinates {
                Coordinates::Plain => [self.frame.x, self.frame.y],
                Coordinates::Apex { .. } => [[0.0; 2]; 2],
            };
            let by_place = by_pixel.then_some(by_place);
            out.push([0.0; 2], by_place, self.per_place, Status::Complete);
            return None;
        }
        match self.frame.start(self.atlas, place) {
            Ok(start) => Some(Pixel { length, start }),
            Err(_) => {
                let by_place = by_pixel.then_some([[0.0; 2]; 2]);
                out.push([0.0; 2], by_place, self.per_place, Status::Undefined);
                None
            }
        }
    }

    fn adaptive(
        &self,
        places: impl Iterator<Item = [f64; 2]>,
        share: usize,
        options: &MapOptions,
        out: &mut Row,
    ) {
        let mirrored = self.frame.is_mirrored(self.surface);
        let mut step = None;
        for place in places {
            let Some(pixel) = self.pixel(place, options.by_pixel, out) else {
                continue;
            };
            out.work.followed += 1;
            let length = pixel.length;
            let plan = Plan {
                tableau: &DOPRI5,
                tolerance: Some((options.tolerance * self.pixel / length).clamp(1e-13, 1e-2)),
                step: step.unwrap_or_else(|| trace::first_step(self.atlas, length)),
                limit: self.atlas.evaluations().saturating_add(share),
                charts: true,
                keep_path: false,
            };
            let end = follow::follow(self.atlas, pixel.start, length, plan);
            // The neighbour's geodesic is much the same.
            step = (end.status == Status::Complete).then_some(end.step);
            out.work.steps += end.steps as u64;
            out.work.rejected += end.rejected as u64;
            let (offset, lifted) = nearest_repetition(self.atlas, self.frame.uv, end.motion.at);
            let mut by_place = [[0.0; 2]; 2];
            if end.status == Status::Complete {
                out.errors.push((end.error / self.pixel) as f32);
                if options.by_pixel {
                    let metric = Metric::of(&self.surface.jet(end.motion.at));
                    let side = if end.flipped != mirrored { -1.0 } else { 1.0 };
                    let left = metric.turn_left(end.motion.velocity);
                    let known = End {
                        coordinates: Coordinates::Plain,
                        at: end.motion.at,
                        along: [0, 1].map(|k| lifted[k] * end.motion.velocity[k]),
                        across: [0, 1].map(|k| lifted[k] * side * left[k]),
                        stretch: end.field / length,
                        status: end.status,
                        error: end.error / self.pixel,
                    };
                    by_place = known.by_place(place, self.zoom);
                }
            }
            let by_place = options.by_pixel.then_some(by_place);
            out.push(offset, by_place, self.per_place, end.status);
        }
    }

    fn rk4(
        &self,
        places: impl Iterator<Item = [f64; 2]>,
        steps: u32,
        arithmetic: Arithmetic,
        limited: bool,
        out: &mut Row,
    ) {
        let finish = |end: rk4::End, out: &mut Row| {
            out.work.followed += 1;
            out.work.steps += end.evaluations / 4;
            out.work.evaluations += end.evaluations;
            let (offset, _) = nearest_repetition(self.atlas, self.frame.uv, end.at);
            let status = match end.status {
                Status::Complete if limited => Status::WorkLimit,
                status => status,
            };
            out.push(offset, None, self.per_place, status);
        };
        let mut waiting: Vec<Motion> = Vec::with_capacity(LANES);
        let eight = |waiting: &mut Vec<Motion>, out: &mut Row| {
            let count = waiting.len();
            if let Some(&last) = waiting.last() {
                waiting.resize(LANES, last);
                let starts = std::array::from_fn(|lane| waiting[lane]);
                let ends = rk4::eight(self.atlas, self.surface, starts, steps);
                ends.into_iter()
                    .take(count)
                    .for_each(|end| finish(end, out));
                waiting.clear();
            }
        };
        for place in places {
            // What needs no geodesic is put down at once: in its turn.
            if place == [0.0; 2] {
                eight(&mut waiting, out);
            }
            let Some(pixel) = self.pixel(place, false, out) else {
                continue;
            };
            let mut start = match pixel.start {
                Start::Plain(motion) => motion,
                Start::About(chart, motion) => chart.leave(motion),
            };
            start.velocity = start.velocity.map(|x| x * pixel.length);
            if arithmetic == Arithmetic::F64Lanes {
                waiting.push(start);
                if waiting.len() == LANES {
                    eight(&mut waiting, out);
                }
            } else {
                let single = arithmetic == Arithmetic::F32;
                finish(rk4::one(self.atlas, start, steps, single), out);
            }
        }
        eight(&mut waiting, out);
    }
}

impl Row {
    /// Puts a pixel down, with ∂(u,v) by the place where that is wanted.
    fn push(
        &mut self,
        offset: [f64; 2],
        by_place: Option<[[f64; 2]; 2]>,
        per_place: f64,
        status: Status,
    ) {
        let finite = offset.iter().all(|x| x.is_finite());
        let offset = if finite { offset } else { [0.0; 2] };
        self.offset.push(offset.map(|x| x as f32));
        if let Some(by_place) = by_place {
            let [x, y] = by_place.map(|d| d.map(|c| (c * per_place) as f32));
            let by_pixel = [x[0], x[1], -y[0], -y[1]];
            let finite = by_pixel.iter().all(|x| x.is_finite());
            self.by_pixel.push(if finite { by_pixel } else { [0.0; 4] });
        }
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
