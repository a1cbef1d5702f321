//! The geodesic view: its camera ([`PlacedCamera`]), the ends of its geodesics ([`RayEnds`]), and the conversion of ends to
//! colours ([`resolve`]).

mod camera;
mod ends;
mod resolve;
mod solid;

pub(crate) use camera::Positions;
pub use camera::{MOVING_TOLERANCE, PlacedCamera, TOLERANCE};
pub use ends::RayEnds;
pub(crate) use ends::{EndsOfRows, Layer};
pub(crate) use resolve::{Cover, Ring, hatch, stripes};
pub use resolve::{Paint, resolve};
pub use solid::PlacedSolidCamera;

use geodesic::ends::{Estimate, GeodesicWork};
use geodesic::fan::Interpolation;
use geodesic::trace::Status;
use rayon::prelude::*;

use crate::note::Note;

/// Beyond this error in pixels at 1 % of the pixels, a picture is useless.
const USELESS: f64 = 100.0;

/// The method by which the geodesics of a geodesic view are integrated.
#[derive(Clone, Copy, Debug, Default, Eq, Hash, PartialEq)]
pub enum PictureMethod {
    /// Rays in f64 that all pixels share, interpolated by their Jacobi fields: the best method, on both backends.
    #[default]
    Fan,
    /// The fan, interpolated linearly between rays, for comparison.
    FanLinear,
    /// Fixed steps of the classical Runge–Kutta method for each pixel, as in the thesis (equations 4.2).
    Rk4Pixel,
    /// Adaptive steps in f64 for each pixel.
    Adaptive,
}

impl PictureMethod {
    /// Returns its name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fan => "fan",
            Self::FanLinear => "fan-linear",
            Self::Rk4Pixel => "rk4-pixel",
            Self::Adaptive => "adaptive",
        }
    }

    /// Returns the interpolation between rays that all pixels share; `None` if each pixel is followed separately.
    fn interpolation(self) -> Option<Interpolation> {
        match self {
            Self::Fan => Some(Interpolation::Hermite),
            Self::FanLinear => Some(Interpolation::Linear),
            Self::Rk4Pixel | Self::Adaptive => None,
        }
    }

    /// Returns true if rays are shared by all pixels, so that the ends are a table of polynomials.
    pub(crate) fn is_fan(self) -> bool {
        self.interpolation().is_some()
    }
}

/// Half the period of the hatching of unseen areas, in [`crate::style::pixel_unit`]s.
pub(crate) const HATCH: f32 = 5.0;
/// The radius of the ring around the centre, in [`crate::style::pixel_unit`]s; at least [`LEAST_RING`] pixels.
pub const RING: f32 = 7.0;
/// The minimum radius of the ring in pixels.
pub const LEAST_RING: f32 = 3.5;

/// The statuses of pixels that show nothing of the surface.
pub(crate) const UNSEEN: [Status; 5] = [
    Status::LeftDomain,
    Status::ConePoint,
    Status::Degenerate,
    Status::Undefined,
    Status::WorkLimit,
];

/// Rounds an angle in radians so that `--angle`, in degrees, reproduces it exactly.
fn as_written(angle: f64) -> f64 {
    angle.to_degrees().to_radians()
}

/// Counts the pixels that show nothing of the surface, by reason.
pub(crate) fn count(status: &[Status]) -> impl Fn(Status) -> usize + use<> {
    const PART: usize = 1 << 14;
    let none = || [0_usize; UNSEEN.len()];
    let counted = status.par_chunks(PART).map(|part| {
        let mut counts = none();
        // Most parts are entirely visible; this is tested a vector at a time.
        let seen = part
            .iter()
            .fold(true, |all, status| all & (*status == Status::Complete));
        if !seen {
            for (count, reason) in counts.iter_mut().zip(UNSEEN) {
                *count = part.iter().filter(|&&status| status == reason).count();
            }
        }
        counts
    });
    let counts = counted.reduce(none, |a, b| std::array::from_fn(|k| a[k] + b[k]));
    move |reason| {
        let known = UNSEEN.iter().position(|&unseen| unseen == reason);
        known.map_or(0, |k| counts[k])
    }
}

/// Returns the background and stripe colours of the hatching of pixels without a colour, sRGB: light, never black, one pair
/// for each reason.
pub fn hatching(status: Status) -> [[u8; 3]; 2] {
    match status {
        Status::Complete | Status::LeftDomain => [[232, 234, 238], [205, 209, 217]],
        Status::ConePoint => [[245, 235, 214], [226, 208, 172]],
        Status::Degenerate => [[240, 226, 240], [216, 192, 219]],
        Status::Undefined => [[244, 226, 224], [224, 192, 189]],
        Status::WorkLimit => [[222, 236, 238], [187, 211, 215]],
    }
}

/// The hatched fraction of a picture from which on another camera is suggested.
const MOSTLY: f64 = 0.9;

/// Returns notes for the reader of a picture of `pixels` pixels: the number that show nothing of the surface (`count`
/// returns the number for each status), the cost of the picture and its estimated error.
pub fn notes(
    pixels: usize,
    count: impl Fn(Status) -> usize,
    work: &GeodesicWork,
    estimate: Option<Estimate>,
) -> Vec<Note> {
    let kinds = [
        (Status::LeftDomain, "lie beyond the surface's edge"),
        (Status::ConePoint, "end at the tip of a cone"),
        (
            Status::Degenerate,
            "end where the surface has no tangent plane",
        ),
        (Status::Undefined, "end where the surface is undefined"),
        (
            Status::WorkLimit,
            "could not be traced within the work limit",
        ),
    ];
    let hatched: usize = UNSEEN.into_iter().map(&count).sum();
    let note = |(status, what): (Status, &str)| {
        let count = count(status);
        let share = 100.0 * count as f64 / pixels as f64;
        let text = || format!("{share:.2} % of the pixels {what}; they are hatched");
        (count > 0).then(|| Note::Remark(text()))
    };
    let mut notes: Vec<Note> = kinds.into_iter().filter_map(note).collect();
    if hatched as f64 > MOSTLY * pixels as f64 {
        let advice = "`--at` moves the camera, and `--zoom` shows a nearer view";
        notes.push(Note::Remark(advice.to_owned()));
    }
    if *work != GeodesicWork::default() {
        notes.push(Note::Cost(cost(work, pixels)));
    }
    let error = estimate.map(|Estimate { max, p99 }| match max > pixels as f64 {
        // Beside a place where the surface is singular, an estimate has no meaning.
        true => "the error could not be estimated: at some pixels it may be arbitrarily large".to_owned(),
        false => {
            let warning = match p99 > USELESS {
                true => ": the picture is not reliable",
                false => "",
            };
            format!(
                "the error is estimated to be at most {max:.2} pixels, and below {p99:.2} for 99 % of them{warning}"
            )
        }
    });
    notes.extend(error.map(Note::Cost));
    notes
}

fn cost(work: &GeodesicWork, pixels: usize) -> String {
    let mut parts = Vec::new();
    if work.rays > 0 {
        parts.push(format!("{} rays", work.rays));
    }
    if work.followed > 0 {
        parts.push(format!("{} geodesics traced one by one", work.followed));
    }
    let evaluations = work.evaluations;
    let share = evaluations as f64 / pixels as f64;
    parts.push(format!(
        "{evaluations} evaluations of the surface, {share:.3} a pixel"
    ));
    parts.join(", ")
}
