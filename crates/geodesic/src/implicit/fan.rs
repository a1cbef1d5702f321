//! The fan in space: rays from the camera that all pixels share, interpolated by their Jacobi fields.
//!
//! In: a surface, a frame, a picture's size, a tolerance. Out: [`Ends`] with three coordinates. Rays and the interpolation
//! between them are those of a fan in a chart (`fan/ray.rs`, `fan/cell.rs`). Without charts, sides and poles, choosing them
//! is simple: a sector is halved until its two rays predict the ray in its middle. A ray continues beyond an edge, on the
//! piece of the field on which it started, and records where it met the edge.

use std::f64::consts::TAU;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::ray::{self, SpacePlan, SpaceRayEnd};
use super::{FieldPiece, ImplicitSurface, SpaceFrame};
use crate::ends::{Coordinates, End, Ends, Estimate, GeodesicWork};
use crate::fan::cell::{Point, hermite};
use crate::fan::ray::{Ray, Stop};
use crate::fan::{ACROSS, BASE, FanOptions, Interpolation, ONE_RAY};
use crate::point::PicturePoint;
use crate::runge_kutta::{DOP853, DOPRI5};
use crate::status::Status;
use crate::vector::{combine, dot, norm};

/// The fraction of the tolerance that a ray's own steps may use. It is less than in a chart, where the fan measures rays by
/// more accurate ones.
const ALONG: f64 = 0.03;
/// A sector narrower than this many pixels at the border is not halved.
const NARROWEST: f64 = 0.25;
/// Sectors next to edges are at most this many pixels wide.
const BESIDE_EDGES: f64 = 24.0;
/// The number of points at which rays are compared.
const PROBES: usize = 48;
/// The number of points, between the edges of two rays, at which the way to a point is checked.
const ON_THE_WAY: usize = 8;

/// A fan of rays and the sectors between them.
pub struct SpaceFan<'s> {
    surface: &'s ImplicitSurface,
    piece: Arc<FieldPiece>,
    frame: SpaceFrame,
    zoom: f64,
    pixel: f64,
    options: FanOptions,
    /// By angle, the first at 0; the last is the first again, after a full turn.
    rays: Vec<Arc<FollowedRay>>,
    /// The sector after each ray except the last.
    sectors: Vec<SpaceSector>,
    work: GeodesicWork,
    estimate: Estimate,
    followed: AtomicU64,
    evaluations: AtomicU64,
}

/// A ray with the reason and the position of its end.
struct FollowedRay {
    angle: f64,
    ray: Ray<3>,
    evaluations: u64,
    steps: u64,
    rejected: u64,
    /// The arc length at which it met an edge.
    edge: f64,
    /// The arc length at which it ended for another reason, and the reason.
    end: f64,
    status: Status,
}

/// The sector between two neighbouring rays.
#[derive(Clone, Copy, Debug)]
struct SpaceSector {
    /// The estimated error in pixels.
    error: f64,
    /// The arc length from which its rays do not determine where geodesics end.
    unknown_from: f64,
    /// True if its error is known to be small enough, or it is too narrow to be halved.
    settled: bool,
}

impl<'s> SpaceFan<'s> {
    /// Integrates as many rays as the tolerance requires, on all threads of the current rayon pool. The result does not
    /// depend on the number of threads.
    pub fn build(
        surface: &'s ImplicitSurface,
        frame: &SpaceFrame,
        size: [u32; 2],
        options: &FanOptions,
    ) -> Option<Self> {
        let zoom = frame.zoom();
        let piece = surface.piece_at(frame.at).ok()?;
        piece.shape(frame.at)?;
        if !(zoom > 0.0 && zoom.is_finite()) {
            return None;
        }
        let least = f64::from(size[0].min(size[1]).max(1));
        let half = size.map(|n| zoom * f64::from(n.max(1)) / least);
        let options = FanOptions {
            tolerance: options.tolerance.clamp(1e-6, 100.0),
            ..*options
        };
        let mut fan = Self {
            surface,
            piece,
            frame: *frame,
            zoom,
            pixel: 2.0 * zoom / least,
            options,
            rays: Vec::new(),
            sectors: Vec::new(),
            work: GeodesicWork::default(),
            estimate: Estimate::default(),
            followed: AtomicU64::new(0),
            evaluations: AtomicU64::new(0),
        };
        fan.fill(half[0].hypot(half[1]) + 2.0 * fan.pixel);
        Some(fan)
    }

    /// Returns the work so far, including the pixels that have been integrated one by one until now.
    pub fn work(&self) -> GeodesicWork {
        let mut work = self.work;
        work.followed = self.followed.load(Ordering::Relaxed);
        work.evaluations += self.evaluations.load(Ordering::Relaxed);
        work
    }

    /// Returns the estimated errors, from rays between those of the fan.
    pub fn estimate(&self) -> Estimate {
        self.estimate
    }

    fn plan(&self, reach: f64) -> SpacePlan {
        let tolerance = ALONG * self.options.tolerance * self.pixel / reach;
        SpacePlan {
            tableau: &DOPRI5,
            tolerance: tolerance.clamp(1e-13, 1e-4),
            step: self.surface.first_step(self.frame.at, reach),
            limit: ONE_RAY as usize,
            accurate_jacobi: true,
            conjugates: false,
            jacobi_knots: false,
            knots: true,
            beyond: true,
        }
    }

    fn ray(&self, angle: f64, reach: f64) -> FollowedRay {
        let plan = self.plan(reach);
        let start = self.frame.start(angle);
        let SpaceRayEnd {
            length,
            steps,
            rejected,
            evaluations,
            status,
            segment,
            edge,
            ..
        } = ray::integrate(self.surface, &self.piece, start, reach, plan);
        let stop = (status != Status::Complete).then_some(Stop {
            s: length,
            status,
            edge: None,
            slope: f64::NAN,
            has_own_slope: false,
        });
        FollowedRay {
            angle,
            ray: Ray::new(angle, &[segment], stop),
            evaluations: evaluations as u64,
            steps: steps as u64,
            rejected: rejected as u64,
            edge: edge.unwrap_or(f64::INFINITY),
            end: if stop.is_some() {
                length
            } else {
                f64::INFINITY
            },
            status,
        }
    }

    /// Adds rays until the sectors between them are accurate enough, or the evaluations are used up.
    fn fill(&mut self, reach: f64) {
        let angles: Vec<f64> = (0..BASE).map(|n| n as f64 * TAU / BASE as f64).collect();
        let mut rays: Vec<Arc<FollowedRay>> = self.followed_rays(&angles, reach);
        rays.extend(rays.first().cloned());
        let unsettled = SpaceSector {
            error: f64::INFINITY,
            unknown_from: f64::INFINITY,
            settled: false,
        };
        let mut sectors = vec![unsettled; BASE];
        loop {
            let open: Vec<usize> = (0..sectors.len())
                .filter(|&n| !sectors[n].settled)
                .collect();
            let average = self.work.evaluations / self.work.rays.max(1);
            let needed = 2 * average * open.len() as u64;
            // The other half is reserved for pixels that must be integrated one by one.
            let most = self.options.max_evaluations / 2;
            if open.is_empty() || self.work.evaluations + needed > most {
                break;
            }
            let ends = |n: usize| (rays[n].angle, end_angle(&rays, n));
            let angles: Vec<f64> = open
                .iter()
                .map(|&n| {
                    let (from, to) = ends(n);
                    0.5 * (from + to)
                })
                .collect();
            let middles = self.followed_rays(&angles, reach);
            let mut next_rays = Vec::with_capacity(rays.len() + open.len());
            let mut next_sectors = Vec::with_capacity(sectors.len() + open.len());
            let mut middles = middles.into_iter();
            for (n, sector) in sectors.iter().enumerate() {
                next_rays.push(rays[n].clone());
                let middle = match sector.settled {
                    true => None,
                    false => middles.next(),
                };
                let Some(middle) = middle else {
                    next_sectors.push(*sector);
                    continue;
                };
                let (from, to) = ends(n);
                let halves = self.judge([&rays[n], &rays[n + 1]], to - from, &middle, reach);
                next_rays.push(middle);
                next_sectors.extend([halves, halves]);
            }
            next_rays.extend(rays.last().cloned());
            (rays, sectors) = (next_rays, next_sectors);
        }
        // A sector that was never compared is not known to be right.
        for sector in &mut sectors {
            if !sector.settled && sector.error.is_infinite() {
                sector.unknown_from = 0.0;
            }
        }
        let mut errors: Vec<f64> = sectors.iter().map(|it| it.error).collect();
        errors.retain(|error| error.is_finite());
        errors.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| {
            let last = errors.len().checked_sub(1);
            last.map_or(0.0, |last| errors[(share * last as f64).ceil() as usize])
        };
        self.estimate = Estimate {
            max: at(1.0),
            p99: at(0.99),
        };
        (self.rays, self.sectors) = (rays, sectors);
    }

    fn followed_rays(&mut self, angles: &[f64], reach: f64) -> Vec<Arc<FollowedRay>> {
        let this = &*self;
        let rays: Vec<Arc<FollowedRay>> = angles
            .par_iter()
            .map(|angle| Arc::new(this.ray(*angle, reach)))
            .collect();
        for ray in &rays {
            self.work.rays += 1;
            self.work.steps += ray.steps;
            self.work.rejected += ray.rejected;
            self.work.evaluations += ray.evaluations;
        }
        rays
    }

    /// Returns the state of a sector's halves, from the ray in its middle.
    fn judge(
        &self,
        rays: [&FollowedRay; 2],
        width: f64,
        middle: &FollowedRay,
        reach: f64,
    ) -> SpaceSector {
        let allowed = ACROSS * self.options.tolerance;
        let narrow = 0.5 * width * reach <= NARROWEST * self.pixel;
        let wide = self.surface.has_edges() && width * reach > 2.0 * BESIDE_EDGES * self.pixel;
        let known = rays[0].end.min(rays[1].end).min(middle.end).min(reach);
        let mut error = 0.0_f64;
        let mut unknown_from = known;
        // The ends of rays that stop for reasons other than edges are determined pixel by pixel.
        if known >= reach {
            unknown_from = f64::INFINITY;
        }
        for k in 1..=PROBES {
            let s = known * k as f64 / PROBES as f64;
            let off = match (rays[0].ray.at(s), rays[1].ray.at(s), middle.ray.at(s)) {
                (Some(a), Some(b), Some(truth)) => {
                    let guess = hermite(&a, &b, width, 0.5);
                    let off = norm(combine(1.0, guess.at, -1.0, truth.at));
                    // An error odd about the middle appears only in its slope there.
                    let slope = combine(1.0, guess.turning, -1.0, truth.jacobi[0]);
                    off.max(0.143 * width * norm(slope)) / self.pixel
                }
                _ => f64::INFINITY,
            };
            if off.is_nan() || off > 16.0 * allowed {
                unknown_from = unknown_from.min(s - known / PROBES as f64);
            }
            error = if off.is_nan() {
                f64::INFINITY
            } else {
                error.max(off)
            };
        }
        // The halves interpolate over half the width: the error is of fourth order.
        let halves = error / 16.0;
        SpaceSector {
            error: halves,
            unknown_from,
            settled: narrow || (halves <= allowed && !wide),
        }
    }

    /// Returns the sector that contains an angle in [0, 2π], and the fraction of the way from its first ray to its
    /// second.
    fn find(&self, angle: f64) -> Option<(usize, f64, f64)> {
        let n = self.rays.partition_point(|ray| ray.angle <= angle);
        // The last ray is the first one again.
        let n = n.saturating_sub(1).min(self.sectors.len().checked_sub(1)?);
        let (from, to) = (self.rays[n].angle, end_angle(&self.rays, n));
        let width = to - from;
        Some((n, width, ((angle - from) / width).clamp(0.0, 1.0)))
    }

    fn ended(&self, status: Status) -> End<3> {
        End {
            coordinates: Coordinates::Plain,
            at: [f64::NAN; 3],
            along: [f64::NAN; 3],
            across: [f64::NAN; 3],
            stretch: f64::NAN,
            status,
            error: 0.0,
        }
    }

    fn end_at(&self, place: PicturePoint) -> End<3> {
        let PicturePoint([x, y]) = place;
        let distance = x.hypot(y);
        let s = self.zoom * distance;
        if s == 0.0 {
            return End {
                coordinates: Coordinates::Plain,
                at: self.frame.at,
                along: self.frame.x.map(|x| x / self.zoom),
                across: self.frame.y.map(|y| y / self.zoom),
                stretch: 1.0,
                status: Status::Complete,
                error: 0.0,
            };
        }
        if !s.is_finite() {
            return self.ended(Status::Undefined);
        }
        let angle = y.atan2(x).rem_euclid(TAU);
        let Some((n, width, t)) = self.find(angle) else {
            return self.follow(angle, s);
        };
        let (sector, rays) = (&self.sectors[n], [&self.rays[n], &self.rays[n + 1]]);
        if s >= sector.unknown_from {
            let [a, b] = rays.map(|ray| ray.end);
            let like = rays[0].status == rays[1].status && rays[0].status != Status::WorkLimit;
            if like && s > a.max(b) {
                // Both met the edge, or both ended, earlier.
                let status = match rays[0].edge.max(rays[1].edge) < f64::INFINITY {
                    true => Status::LeftDomain,
                    false => rays[0].status,
                };
                return self.ended(status);
            }
            return self.follow(angle, s);
        }
        let Some(point) = self.between(rays, width, t, s) else {
            return self.follow(angle, s);
        };
        if self.surface.has_edges() && self.is_hidden(rays, width, t, s, point.at) {
            return self.ended(Status::LeftDomain);
        }
        end_of(&point, s, sector.error)
    }

    fn between(
        &self,
        [a, b]: [&Arc<FollowedRay>; 2],
        width: f64,
        t: f64,
        s: f64,
    ) -> Option<Point<3>> {
        let (a, b) = (a.ray.at(s)?, b.ray.at(s)?);
        let point = match self.options.interpolation {
            Interpolation::Hermite => hermite(&a, &b, width, t),
            Interpolation::Linear => Point {
                chart: a.chart,
                at: combine(1.0 - t, a.at, t, b.at),
                along: combine(1.0 - t, a.along, t, b.along),
                turning: combine(-1.0 / width, a.at, 1.0 / width, b.at),
                normal: combine(1.0 - t, a.normal, t, b.normal),
            },
        };
        point.at.iter().all(|x| x.is_finite()).then_some(point)
    }

    /// Returns true if a point between two rays is beyond an edge that its geodesic has met.
    fn is_hidden(
        &self,
        rays: [&Arc<FollowedRay>; 2],
        width: f64,
        t: f64,
        s: f64,
        at: [f64; 3],
    ) -> bool {
        let (first, last) = (
            rays[0].edge.min(rays[1].edge),
            rays[0].edge.max(rays[1].edge),
        );
        let beyond = |at| self.surface.is_beyond(&self.piece, at);
        // A corner is farther out than the points where the rays on both sides meet the edges.
        let bulge = (last - first).max(width * last);
        if s > last + bulge || beyond(at) {
            return true;
        }
        if s <= first {
            return false;
        }
        (1..ON_THE_WAY).any(|k| {
            let s = first + (s - first) * k as f64 / ON_THE_WAY as f64;
            let point = self.between(rays, width, t, s);
            point.is_some_and(|point| beyond(point.at))
        })
    }

    /// Integrates one geodesic on its own, where the rays do not determine it.
    #[cold]
    fn follow(&self, angle: f64, s: f64) -> End<3> {
        let before = self.evaluations.load(Ordering::Relaxed) + self.work.evaluations;
        if before > self.options.max_evaluations {
            return self.ended(Status::WorkLimit);
        }
        let plan = SpacePlan {
            tableau: &DOP853,
            tolerance: (0.1 * self.options.tolerance * self.pixel / s).clamp(1e-13, 1e-4),
            step: self.surface.first_step(self.frame.at, s),
            accurate_jacobi: false,
            knots: false,
            beyond: false,
            ..self.plan(s)
        };
        let start = self.frame.start(angle);
        let end = ray::integrate(self.surface, &self.piece, start, s, plan);
        self.followed.fetch_add(1, Ordering::Relaxed);
        let evaluations = end.evaluations as u64;
        self.evaluations.fetch_add(evaluations, Ordering::Relaxed);
        let shape = self.piece.shape(end.state.at);
        let Some(shape) = shape.filter(|_| end.status == Status::Complete) else {
            return self.ended(end.status);
        };
        End {
            coordinates: Coordinates::Plain,
            at: end.state.at,
            along: end.state.velocity,
            across: shape.left(end.state.velocity),
            stretch: end.field[0] / s,
            status: Status::Complete,
            error: end.error / self.pixel,
        }
    }
}

/// Returns the angle at which the sector after a ray ends.
fn end_angle(rays: &[Arc<FollowedRay>], n: usize) -> f64 {
    if n + 2 == rays.len() {
        TAU
    } else {
        rays[n + 1].angle
    }
}

/// Converts a point between two rays to an end at the arc length `s` > 0.
fn end_of(point: &Point<3>, s: f64, error: f64) -> End<3> {
    let length = norm(point.along);
    let along = point.along.map(|x| x / length);
    let across = {
        let off = dot(point.normal, along);
        let normal = combine(1.0, point.normal, -off, along);
        let length = norm(normal);
        normal.map(|x| x / length)
    };
    End {
        coordinates: Coordinates::Plain,
        at: point.at,
        along,
        across,
        stretch: dot(point.turning, across) / s,
        status: Status::Complete,
        error,
    }
}

impl Ends<3> for SpaceFan<'_> {
    fn end(&self, place: PicturePoint) -> End<3> {
        self.end_at(place)
    }

    fn zoom(&self) -> f64 {
        self.zoom
    }

    fn origin(&self) -> [f64; 3] {
        self.frame.at
    }
}
