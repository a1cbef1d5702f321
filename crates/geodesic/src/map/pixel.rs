//! The methods that integrate a geodesic for each pixel. In: one row of a picture. Out: its ends.

use super::{MOST_FOR_PIXEL, MapMethod, MapOptions, pixel_place, rk4};
use crate::chart::{Atlas, State};
use crate::ends::{Coordinates, End, GeodesicWork};
use crate::frame::Frame;
use crate::integrate::{self, IntegrationPlan, Observed, Start};
use crate::metric::Metric;
use crate::point::{PicturePoint, Uv};
use crate::runge_kutta::{DOP853, DOPRI5};
use crate::status::Status;
use crate::surface::{Side, Surface, affordable_evaluations};
use crate::trace;

/// One row of a map; its fields are those of [`Map`](super::Map).
#[derive(Clone, Debug, Default)]
pub(super) struct Row {
    pub(super) offset: Vec<[f32; 2]>,
    pub(super) by_pixel: Vec<[[f32; 2]; 2]>,
    pub(super) status: Vec<Status>,
    /// The estimated errors of the complete pixels, in pixels, if the method estimates them.
    pub(super) errors: Vec<f32>,
    pub(super) work: GeodesicWork,
}

/// The data that the pixels of a row share.
struct Line<'a, 's> {
    surface: &'s dyn Surface,
    atlas: &'a Atlas<'s>,
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

/// The data that one pixel's geodesic passes to the next.
#[derive(Clone, Copy, Debug)]
struct Neighbour {
    /// The first step.
    step: Option<f64>,
    /// The fraction of the error allowed at the end that the steps may cause.
    share: f64,
}

impl Default for Neighbour {
    fn default() -> Self {
        Self {
            step: None,
            share: 1.0,
        }
    }
}

/// The maximum number of repetitions of a geodesic whose estimated error exceeds the allowed one.
const REPETITIONS: u32 = 2;
/// The fraction of the allowed error that the next geodesic's estimate aims at.
const AIM: f64 = 0.3;
/// The factor on the estimate for a few long steps: each is as long as its own estimate just allows, so estimates that
/// are too small by chance dominate.
const CAUTION: f64 = 6.0;
/// The maximum error of a step over its length, however coarse the pixels: beyond it, a pair's two orders agree only by
/// chance, and its estimate is meaningless.
const LOOSEST: f64 = 1e-3;
/// The minimum of the same, because of rounding.
const TIGHTEST: f64 = 1e-13;

/// Computes a row, counted from the top. It does not depend on any other row.
pub(super) fn row(
    surface: &dyn Surface,
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
        MapMethod::Rk4 { steps } => {
            // A fixed number of steps is its own limit, within reason.
            let affordable = share.max(MOST_FOR_PIXEL) / 4;
            let steps = u64::from(steps.max(1));
            let limited = steps > affordable;
            let steps = steps.min(affordable) as u32;
            line.rk4(places, steps, limited, &mut out);
        }
        _ => {
            let share = affordable_evaluations(surface, share);
            let share = usize::try_from(share).unwrap_or(usize::MAX);
            line.adaptive(places, share, options, &mut out);
            out.work.evaluations = atlas.evaluations() as u64;
        }
    }
    out
}

impl Line<'_, '_> {
    /// Returns the pixel at a point of the picture; a pixel that needs no geodesic is stored at once.
    fn pixel(&self, place: PicturePoint, by_pixel: bool, out: &mut Row) -> Option<Pixel> {
        let length = self.zoom * place[0].hypot(place[1]);
        if length == 0.0 || length.is_nan() {
            // At a pole (u,v) has no directions.
            let by_place = match self.frame.coordinates {
                Coordinates::Plain => [self.frame.x.0, self.frame.y.0],
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

    /// Integrates the pixels with at most `share` evaluations on average: each is guaranteed half of it, and may use what
    /// earlier pixels have left.
    fn adaptive(
        &self,
        places: impl ExactSizeIterator<Item = PicturePoint>,
        share: usize,
        options: &MapOptions,
        out: &mut Row,
    ) {
        let mirrored = self.frame.is_mirrored(self.surface);
        let mut pace = Neighbour::default();
        let mut to_come = places.len();
        let limit = self.atlas.evaluations() + share.saturating_mul(to_come);
        for place in places {
            to_come -= 1;
            let Some(pixel) = self.pixel(place, options.by_pixel, out) else {
                continue;
            };
            out.work.followed += 1;
            let length = pixel.length;
            let left = limit.saturating_sub(self.atlas.evaluations() + share / 2 * to_come);
            let most = left.min(MOST_FOR_PIXEL as usize);
            let end = self.follow(pixel, options.tolerance * self.pixel, most, &mut pace, out);
            let (offset, lifted) = nearest_repetition(self.atlas, self.frame.uv.0, end.state.at);
            let mut by_place = [[0.0; 2]; 2];
            if end.status == Status::Complete {
                out.errors.push((end.error / self.pixel) as f32);
                if options.by_pixel {
                    let metric = Metric::of(&self.surface.jet(Uv(end.state.at)));
                    let side = if end.flipped != mirrored { -1.0 } else { 1.0 };
                    let left = metric.turn_left(end.state.velocity);
                    let known = End {
                        coordinates: Coordinates::Plain,
                        at: end.state.at,
                        along: [0, 1].map(|k| lifted[k] * end.state.velocity[k]),
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

    /// Integrates one pixel's geodesic, and repeats it with a smaller error per step where its end may be off by more
    /// than `allowed`. The Jacobi field propagates each step's error, by an amount unknown until the end.
    fn follow(
        &self,
        pixel: Pixel,
        allowed: f64,
        share: usize,
        pace: &mut Neighbour,
        out: &mut Row,
    ) -> integrate::RayEnd {
        let limit = self.atlas.evaluations().saturating_add(share);
        let mut best = self.attempt(&pixel, allowed, limit, pace, out);
        for _ in 0..REPETITIONS {
            if best.status != Status::Complete || best.error <= allowed {
                break;
            }
            let end = self.attempt(&pixel, allowed, limit, pace, out);
            // Where the evaluations are used up, the earlier result is better.
            if end.status == Status::Complete && end.error < best.error {
                best = end;
            }
        }
        best
    }

    /// Integrates it once.
    fn attempt(
        &self,
        pixel: &Pixel,
        allowed: f64,
        limit: usize,
        pace: &mut Neighbour,
        out: &mut Row,
    ) -> integrate::RayEnd {
        let length = pixel.length;
        let tolerance = (pace.share * allowed / length).clamp(TIGHTEST, LOOSEST);
        let first_step = || trace::first_step(self.atlas, length);
        let plan = IntegrationPlan {
            tableau: if tolerance < trace::LOOSE {
                &DOP853
            } else {
                &DOPRI5
            },
            tolerance: Some(tolerance),
            step: pace.step.unwrap_or_else(first_step),
            limit,
            charts: true,
            keep_path: false,
        };
        // Jacobi fields reveal the curvature between a step's stages, which the point alone does not.
        let noting = Observed {
            accurate_jacobi: true,
            ..Observed::default()
        };
        let mut end = integrate::integrate_observed(self.atlas, pixel.start, length, plan, noting);
        end.error *= CAUTION;
        out.work.steps += end.steps as u64;
        out.work.rejected += end.rejected as u64;
        // The neighbour's geodesic is similar.
        pace.step = None;
        if end.status == Status::Complete {
            pace.step = Some(end.step);
            let change = (AIM * allowed / end.error).clamp(1e-3, 2.0);
            pace.share = (pace.share * change).min(1.0);
        }
        end
    }

    fn rk4(
        &self,
        places: impl Iterator<Item = PicturePoint>,
        steps: u32,
        limited: bool,
        out: &mut Row,
    ) {
        for place in places {
            if let Some(start) = self.whole(place, out) {
                let end = rk4::follow(self.atlas, self.surface, start, steps);
                self.put(end, limited, out);
            }
        }
    }

    /// Returns a pixel's start in (u,v), with a velocity that leads to its end in unit time.
    fn whole(&self, place: PicturePoint, out: &mut Row) -> Option<State> {
        if self.frame.coordinates == Coordinates::Plain && self.zoom > 0.0 && place != [0.0; 2] {
            return Some(State {
                at: self.frame.uv.0,
                velocity: self.frame.velocity(place).0,
            });
        }
        let pixel = self.pixel(place, false, out)?;
        let mut start = match pixel.start {
            Start::Plain(state) => state,
            Start::About(chart, state) => chart.leave(state),
        };
        start.velocity = start.velocity.map(|x| x * pixel.length);
        Some(start)
    }

    fn put(&self, end: rk4::PixelEnd, limited: bool, out: &mut Row) {
        out.work.followed += 1;
        out.work.steps += end.evaluations / 4;
        out.work.evaluations += end.evaluations;
        let (offset, _) = nearest_repetition(self.atlas, self.frame.uv.0, end.at);
        let status = match end.status {
            Status::Complete if limited => Status::WorkLimit,
            status => status,
        };
        out.push(offset, None, self.per_place, status);
    }
}

impl Row {
    /// Stores a pixel, with ∂(u,v) by the point of the picture where requested.
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
            let by_pixel = [x, y.map(|c| -c)];
            let finite = by_pixel.iter().flatten().all(|x| x.is_finite());
            self.by_pixel
                .push(if finite { by_pixel } else { [[0.0; 2]; 2] });
        }
        self.status.push(status);
    }
}

/// Returns a point of the domain as an offset from the camera, the shorter way through the sides that wrap: single
/// precision preserves nearby points. Also returns the signs by which the components of a vector at the point change.
fn nearest_repetition(atlas: &Atlas<'_>, origin: [f64; 2], at: [f64; 2]) -> ([f64; 2], [f64; 2]) {
    let domain = atlas.layout.domain;
    let mut lifted = at;
    // The flip first, since it changes the other coordinate.
    for flip in [true, false] {
        for axis in 0..2 {
            let side = atlas.layout.sides.of(axis)[0];
            let wanted = if flip { Side::WrapFlip } else { Side::Wrap };
            if side != wanted {
                continue;
            }
            let width = atlas.layout.width(axis);
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
    let mut back = lifted;
    let signs = atlas.layout.sides.wrap(domain, &mut back).signs;
    ([0, 1].map(|k| lifted[k] - origin[k]), signs)
}
