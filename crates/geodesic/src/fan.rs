//! The fan: all pixels on one line through the centre are on one geodesic, and neighbouring lines are interpolated.
//!
//! In: a surface, a frame, a picture's size, a tolerance. Out: [`Ends`] for every point of the picture, interpolated
//! between a few rays.
//!
//! ```text
//! frame ──start.rs──▶ active rays ──driver.rs (lanes.rs, event.rs)──▶ rays (ray.rs)
//! rays ──build.rs, refine.rs, verify.rs (error_indicator.rs, creases.rs, missed.rs)──▶ sectors
//! points of the picture ──polar.rs, sectors.rs, cell.rs──▶ their ends
//! ```

mod active_ray;
mod border;
mod build;
pub(crate) mod cell;
pub(crate) mod coordinates;
mod creases;
mod driver;
mod error_indicator;
mod event;
mod group;
mod lanes;
mod missed;
mod polar;
pub(crate) mod ray;
mod refine;
mod sectors;
mod start;
mod unknown;
mod verify;

use std::sync::atomic::{AtomicU64, Ordering};

use expr::processor::{self, Processor};

use crate::chart::{Atlas, ChartLayout, State};
use crate::ends::{Coordinates, End, Ends, Estimate, GeodesicWork, Polar};
use crate::frame::Frame;
use crate::metric::Metric;
use crate::point::PicturePoint;
use crate::status::Status;
use crate::surface::{Surface, affordable_evaluations};
pub use build::MOST_FOR_RAYS;
pub(crate) use build::{ACROSS, BASE, ONE_RAY};
use cell::Found;
use polar::{PLACES, polar};
use sectors::{Sector, Sectors};
use start::FanStart;

/// The interpolation of ends between two rays.
#[derive(Clone, Copy, Debug, Default, Eq, Hash, PartialEq)]
pub enum Interpolation {
    /// From the ends and Jacobi fields of both rays.
    #[default]
    Hermite,
    /// From the ends of both rays alone, for comparison.
    Linear,
}

/// The options of a fan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FanOptions {
    /// The error allowed at a pixel, in pixels.
    pub tolerance: f64,
    /// The interpolation between rays.
    pub interpolation: Interpolation,
    /// The maximum number of evaluations of all rays together, with a reserve for the pixels that must be integrated
    /// one by one; lower for a surface that is expensive to evaluate ([`affordable_evaluations`]). Where it does not
    /// suffice, unknown ends have [`Status::WorkLimit`].
    pub max_evaluations: u64,
    /// True if the number of ends requested is not that of a picture's pixels: each is integrated on its own where the rays do
    /// not determine it, and the caller observes [`Fan::work`].
    pub follows_each: bool,
}

impl Default for FanOptions {
    fn default() -> Self {
        Self {
            tolerance: 0.1,
            interpolation: Interpolation::Hermite,
            max_evaluations: 40_000_000,
            follows_each: false,
        }
    }
}

/// A fan of rays and the sectors between them.
pub struct Fan<'s> {
    surface: &'s dyn Surface,
    layout: ChartLayout,
    /// [`ChartLayout::periods`].
    periods: [f64; 2],
    options: FanOptions,
    /// `None` where no ray can start.
    start: Option<FanStart>,
    sectors: Sectors,
    /// Pixels integrated one by one, and their evaluations.
    followed: AtomicU64,
    evaluations: AtomicU64,
}

impl<'s> Fan<'s> {
    /// Integrates as many rays as the tolerance requires, on all threads of the current rayon pool. The result does not
    /// depend on the number of threads.
    pub fn build(
        surface: &'s dyn Surface,
        frame: &Frame,
        size: [u32; 2],
        options: &FanOptions,
    ) -> Self {
        let options = &FanOptions {
            max_evaluations: affordable_evaluations(surface, options.max_evaluations),
            ..*options
        };
        let layout = ChartLayout::of(surface);
        let start = FanStart::of(surface, &layout, frame, size);
        let sectors = match &start {
            Some(start) => build::build(surface, &layout, start, options),
            None => Sectors::default(),
        };
        Self {
            surface,
            periods: layout.periods(),
            layout,
            options: *options,
            start,
            sectors,
            followed: AtomicU64::new(0),
            evaluations: AtomicU64::new(0),
        }
    }

    /// Returns the work so far, including the pixels that have been integrated one by one until now.
    pub fn work(&self) -> GeodesicWork {
        let mut work = self.sectors.work;
        work.followed = self.followed.load(Ordering::Relaxed);
        work.evaluations += self.evaluations.load(Ordering::Relaxed);
        work
    }

    /// Returns the estimated errors, measured by rays that are not part of the fan.
    pub fn estimate(&self) -> Estimate {
        self.sectors.estimate
    }

    /// Returns the place in space at which the geodesic of a point of the picture ends; `None` where it ends earlier, or where
    /// the surface is not defined.
    pub fn position(&self, place: PicturePoint) -> Option<[f64; 3]> {
        let end = self.end(place);
        if end.status != Status::Complete {
            return None;
        }
        let mut at = match self.layout.apex_chart(end.coordinates) {
            Some(chart) => chart.plain_point(end.at),
            None => end.at,
        };
        self.layout.bring_back(&mut at);
        let position = self.surface.jet(at.into()).position;
        position.iter().all(|x| x.is_finite()).then_some(position)
    }

    /// Returns the end at a point that is at this angle and distance in the picture.
    #[inline(always)]
    fn end_at(&self, start: &FanStart, place: PicturePoint, angle: f64, distance: f64) -> End {
        let s = start.zoom * distance;
        if s == 0.0 {
            return start.centre(&self.layout);
        }
        if !s.is_finite() {
            return self.ended(Status::Undefined);
        }
        let Some((sector, t)) = self.sectors.find(angle) else {
            return self.follow(start, place, s);
        };
        let rays = self.sectors.rays(sector);
        if s < sector.free_until
            && self.options.interpolation == Interpolation::Hermite
            && let Some(point) =
                cell::free_end_between(&self.layout, self.periods, rays, sector.width, t, s)
        {
            return point.end(&self.layout, s, sector.error_at(s, start.reach));
        }
        self.end_between_rays(start, place, s, sector, t)
    }

    /// Returns the end at a point between two rays, at the arc length `s`.
    #[inline(always)]
    fn end_between_rays(
        &self,
        start: &FanStart,
        place: PicturePoint,
        s: f64,
        sector: &Sector,
        t: f64,
    ) -> End {
        let rays = self.sectors.rays(sector);
        if sector.hides(s) {
            return self.follow(start, place, s);
        }
        if s >= sector.unknown_from {
            // Both rays end before `s`: the status is known.
            if let Some(status) = border::both_ended(rays, t, s) {
                return self.ended(status);
            }
            return self.follow(start, place, s);
        }
        match cell::end_between(
            &self.layout,
            self.options.interpolation,
            rays,
            sector.width,
            t,
            s,
        ) {
            Found::Point(point) => point.end(&self.layout, s, sector.error_at(s, start.reach)),
            Found::Ended(status) => self.ended(status),
            Found::Beyond(point) => End {
                status: Status::LeftDomain,
                ..point.end(&self.layout, s, 0.0)
            },
            Found::Unknown => self.follow(start, place, s),
        }
    }

    fn ended(&self, status: Status) -> End {
        End {
            coordinates: Coordinates::Plain,
            at: [f64::NAN; 2],
            along: [f64::NAN; 2],
            across: [f64::NAN; 2],
            stretch: f64::NAN,
            status,
            error: 0.0,
        }
    }

    /// Integrates one geodesic on its own, where the rays do not determine it.
    #[cold]
    #[inline(never)]
    fn follow(&self, start: &FanStart, place: PicturePoint, s: f64) -> End {
        if s > self.sectors.follow_within {
            return self.ended(Status::WorkLimit);
        }
        self.followed.fetch_add(1, Ordering::Relaxed);
        let atlas = Atlas::new(self.surface);
        let limit = self.sectors.pixel_limit;
        let end = start.follow(&atlas, &self.options, place, s, limit);
        let evaluations = atlas.evaluations() as u64;
        self.evaluations.fetch_add(evaluations, Ordering::Relaxed);
        let Some(end) = end else {
            return self.ended(Status::Undefined);
        };
        if end.status != Status::Complete {
            return self.ended(end.status);
        }
        let State { at, velocity } = end.state;
        let metric = Metric::of(&atlas.jet(at));
        let left = metric.turn_left(velocity);
        let side = if end.flipped { -start.side } else { start.side };
        End {
            coordinates: Coordinates::Plain,
            at,
            along: velocity,
            across: left.map(|x| x * side).0,
            stretch: end.field / s,
            status: Status::Complete,
            error: end.error / start.pixel,
        }
    }
}

/// The ends of several points, compiled for the processor's vector instructions.
struct Several<'a, 's> {
    fan: &'a Fan<'s>,
    start: &'a FanStart,
    places: &'a [PicturePoint],
    out: &'a mut Vec<End>,
}

impl processor::Work for Several<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for places in self.places.chunks(PLACES) {
            let (mut x, mut y) = ([0.0; PLACES], [0.0; PLACES]);
            for ((x, y), place) in x.iter_mut().zip(&mut y).zip(places) {
                PicturePoint([*x, *y]) = *place;
            }
            let (angles, distances) = polar(&x, &y);
            for ((place, angle), distance) in places.iter().zip(angles).zip(distances) {
                let end = self.fan.end_at(self.start, *place, angle, distance);
                self.out.push(end);
            }
        }
    }
}

impl Ends for Fan<'_> {
    fn end(&self, place: PicturePoint) -> End {
        let Some(start) = &self.start else {
            return self.ended(Status::Undefined);
        };
        let ([angle], [distance]) = polar(&[place[0]], &[place[1]]);
        self.end_at(start, place, angle, distance)
    }

    fn ends(&self, places: &[PicturePoint], out: &mut Vec<End>) {
        let Some(start) = &self.start else {
            out.resize(out.len() + places.len(), self.ended(Status::Undefined));
            return;
        };
        out.reserve(places.len());
        Processor::here().run(Several {
            fan: self,
            start,
            places,
            out,
        });
    }

    fn zoom(&self) -> f64 {
        self.start.as_ref().map_or(f64::NAN, |start| start.zoom)
    }

    fn origin(&self) -> [f64; 2] {
        self.start
            .as_ref()
            .map_or([f64::NAN; 2], |start| start.frame.uv.0)
    }

    fn in_coordinates(&self, end: &End, coordinates: Coordinates) -> Option<End> {
        if end.coordinates == coordinates {
            return Some(*end);
        }
        let mut end = *end;
        if end.coordinates != Coordinates::Plain {
            let chart = self.layout.apex_chart(end.coordinates)?;
            let [along, across] = [end.along, end.across].map(|v| chart.plain_vector(end.at, v));
            end = End {
                coordinates: Coordinates::Plain,
                at: chart.plain_point(end.at),
                along,
                across,
                ..end
            };
        }
        if coordinates != Coordinates::Plain {
            let chart = self.layout.pole_chart(coordinates)?;
            if !chart.holds(end.at) {
                return None;
            }
            let [along, across] = [end.along, end.across].map(|v| chart.vector(end.at, v));
            end = End {
                coordinates,
                at: chart.point(end.at),
                along,
                across,
                ..end
            };
        }
        let finite = end
            .at
            .iter()
            .chain(&end.along)
            .chain(&end.across)
            .all(|x| x.is_finite());
        finite.then_some(end)
    }

    fn periods(&self) -> [f64; 2] {
        self.layout.periods()
    }

    fn bounds(&self) -> [[f64; 2]; 2] {
        self.layout.bounds()
    }

    fn polar(&self, axis: u8, end: u8) -> Option<Polar> {
        let chart = (self.layout).pole_chart(Coordinates::Apex { axis, end })?;
        Some(Polar {
            base: chart.base,
            sign: chart.sign,
            low: chart.reference,
            rate: chart.apex.rate,
            power: chart.apex.power,
        })
    }
}
