//! The Earth's spheroid against an independent program, `geographiclib-rs`: E3.

use std::f64::consts::PI;

use geographiclib_rs::{DirectGeodesic, Geodesic};

use super::shapes::spheroid;
use super::{Case, Measured, Random, complete, go, worst};
use geodesic::trace::Options;

/// Semi-axes in metres.
const A: f64 = 6_378_137.0;
const FLATTENING: f64 = 1.0 / 298.257_223_563;
/// The longest line, in metres.
const LONGEST: f64 = 2e7;
/// How many lines of each kind the list has; the tests trace thousands.
const LINES: usize = 60;

/// Which lines.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Starts {
    /// Lines that stay off the poles by a degree and more.
    OffPoles,
    /// Past a pole, on to it, and from it.
    Poles,
}

/// A line's errors against the independent program, in metres.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// Of the endpoint.
    pub end: f64,
    /// Of m against the program's reduced length.
    pub jacobi: f64,
    /// What the tracer estimated of the endpoint.
    pub estimate: f64,
    /// What it cost.
    pub evaluations: usize,
}

pub(super) fn cases() -> Vec<Case> {
    let case = |name: &'static str, quantity, bound, starts, which: fn(&Line) -> f64| {
        Case::new("E3", name, quantity, bound, move |options| {
            worst(
                lines(starts, LINES, 7, options)
                    .iter()
                    .map(|line| Measured {
                        value: which(line),
                        evaluations: line.evaluations,
                    }),
            )
        })
    };
    vec![
        case(
            "WGS84, to 20,000 km",
            "endpoint, m",
            1e-6,
            Starts::OffPoles,
            |l| l.end,
        ),
        case(
            "WGS84, to 20,000 km",
            "m against m12, m",
            1e-6,
            Starts::OffPoles,
            |l| l.jacobi,
        ),
        case("WGS84, poles", "endpoint, m", 1e-3, Starts::Poles, |l| {
            l.end
        }),
    ]
}

/// Seeded lines of the spheroid, traced to the last digit that rounding leaves.
pub fn lines(starts: Starts, count: usize, seed: u64, options: &Options) -> Vec<Line> {
    let surface = spheroid(A, A * (1.0 - FLATTENING));
    let program = Geodesic::wgs84();
    let mut random = Random(seed);
    let options = Options {
        tolerance: 1e-14,
        // Along a meridian steps are long: m is to be as exact.
        conjugates: true,
        ..*options
    };
    (0..count)
        .map(|n| {
            let (latitude, azimuth): (f64, f64) = match starts {
                Starts::OffPoles => loop {
                    let latitude = random.between(-1.0, 1.0).asin().to_degrees();
                    let azimuth = random.between(-180.0, 180.0);
                    // Clairaut's constant is the sine of the least distance from a pole.
                    let nearest = parametric(latitude).cos() * azimuth.to_radians().sin();
                    if nearest.abs() > f64::sin(PI / 180.0) {
                        break (latitude, azimuth);
                    }
                },
                Starts::Poles => match n % 3 {
                    0 => (random.between(-80.0, 80.0), random.size(1e-10, 1.0)),
                    1 => (90.0 - random.size(1e-9, 1.0), random.between(-180.0, 180.0)),
                    _ => (random.between(-80.0, 80.0), 180.0),
                },
            };
            let longitude = random.between(0.0, 360.0);
            let length = random.between(1e4, LONGEST);
            let (to_latitude, to_longitude, _, reduced, ..): (
                f64,
                f64,
                f64,
                f64,
                f64,
                f64,
                f64,
                f64,
            ) = program.direct(latitude, longitude, azimuth, length);
            let from = [longitude.to_radians(), parametric(latitude)];
            let (east, north) = azimuth.to_radians().sin_cos();
            let (sin, cos) = from[1].sin_cos();
            let along = (sin * sin + ((1.0 - FLATTENING) * cos).powi(2)).sqrt();
            let end = go(
                &surface,
                from,
                [east / cos, north / along],
                length,
                &options,
            );
            let (su, cu) = to_longitude.to_radians().sin_cos();
            let (sv, cv) = parametric(to_latitude).sin_cos();
            let expected = [A * cv * cu, A * cv * su, A * (1.0 - FLATTENING) * sv];
            let measured = complete(&end, |end| super::off(end, expected));
            Line {
                end: measured.value,
                jacobi: (end.jacobi[0] - reduced).abs(),
                estimate: end.error_estimate,
                evaluations: end.evaluations,
            }
        })
        .collect()
}

/// The parametric latitude in radians of a geodetic one in degrees.
fn parametric(latitude: f64) -> f64 {
    let (sin, cos) = latitude.to_radians().sin_cos();
    ((1.0 - FLATTENING) * sin).atan2(cos)
}
