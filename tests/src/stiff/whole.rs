//! What is to hold on all of these surfaces alike: V1 to V4.

use super::shapes::*;
use super::{Case, Measured, Random, complete, go, worst};
use geodesic::frame::Frame;
use geodesic::map::{MapMethod, MapOptions, exponential_map, pixel_place};
use geodesic::metric::{acceleration, speed};
use geodesic::surface::Surface;
use geodesic::trace::{Options, Status, TraceMethod};

pub(super) fn cases() -> Vec<Case> {
    vec![
        Case::new(
            "V1",
            "there and back, tight",
            "return/(condition · 10⁻¹³)",
            1.0,
            return_home,
        ),
        Case::new(
            "V2",
            "pictures of 512 pixels, z=10⁻⁶",
            "px",
            0.02,
            |options| deep(1e-6, options),
        ),
        Case::new(
            "V2",
            "pictures of 512 pixels, z=10⁻¹²",
            "px",
            0.02,
            |options| deep(1e-12, options),
        ),
        Case::new(
            "V3",
            "zoom 0, and a picture's centre",
            "finite and exact",
            0.0,
            centre,
        ),
        Case::new(
            "V4",
            "random surfaces, L=10⁴",
            "rays beyond 20,000 evaluations",
            0.0,
            budget,
        ),
    ]
}

/// Rays of every surface of the list, followed and followed back.
fn return_home(options: &Options) -> Measured {
    let options = Options {
        tolerance: 1e-14,
        ..*options
    };
    let surfaces: Vec<(Box<dyn Surface>, [f64; 2], f64)> = vec![
        (Box::new(spheroid(1.0, 1.0)), [0.3, 0.2], 20.0),
        (Box::new(torus(0.4)), [0.1, 0.3], 10.0),
        (Box::new(torus(0.02)), [0.1, 0.3], 3.0),
        (Box::new(torus(0.999)), [0.1, 0.3], 6.0),
        (Box::new(cone(1.0)), [1.0, 2.0], 5.0),
        (Box::new(log_polar()), [1.0, 0.5], 5.0),
        (Box::new(half_plane()), [0.0, 1.0], 5.0),
        (Box::new(poincare_disc()), [0.1, 0.2], 5.0),
        (Box::new(pseudosphere()), [1.0, 2.0], 1.2),
        (Box::new(triaxial(1.0, 2.0, 3.0)), [0.4, 0.3], 20.0),
        (Box::new(bumps()), [0.1, 0.2], 1.0),
        (Box::new(catenoid()), [1.0, 0.5], 5.0),
        (Box::new(zoll()), [1.3, 0.5], 6.0),
        (Box::new(klein(TAU)), [1.0, 1.5], 10.0),
    ];
    worst(surfaces.iter().flat_map(|(surface, from, length)| {
        let surface = surface.as_ref();
        [0.3, 1.2, 2.4, 4.0].map(|angle: f64| {
            let jet = surface.jet((*from).into());
            let size = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
            let direction = [angle.cos() / size(jet.du), angle.sin() / size(jet.dv)];
            let there = go(surface, *from, direction, *length, &options);
            if there.status != Status::Complete {
                return complete(&there, |_| 0.0);
            }
            let back = go(
                surface,
                there.uv.0,
                there.direction.0.map(|x| -x),
                *length,
                &options,
            );
            // Wrapping sides may give the start back one period off.
            let domain = surface.domain();
            let gap = [0, 1].map(|k| {
                let width = domain[k][1] - domain[k][0];
                let gap = back.uv[k] - from[k];
                if surface.sides().of(k)[0] == geodesic::surface::Side::Wrap {
                    gap - width * (gap / width).round()
                } else {
                    gap
                }
            });
            let gap = size([0, 1, 2].map(|k| gap[0] * jet.du[k] + gap[1] * jet.dv[k]));
            let [m, m1] = there.jacobi;
            let condition = (1.0 + length) * m.abs().max(m1.abs()).max(1.0);
            complete(&back, |_| gap / (condition * 1e-13))
        })
    }))
}

/// Pictures that are so deep that nothing is curved: against the exponential map to second order. Evaluations are a
/// whole picture's.
fn deep(zoom: f64, options: &Options) -> Measured {
    let surfaces: Vec<(Box<dyn Surface>, [f64; 2])> = vec![
        (Box::new(spheroid(1.0, 1.0)), [1.0, 0.9]),
        (Box::new(torus(0.4)), [5.3, 1.2]),
        // Across the seam.
        (Box::new(torus(0.4)), [1e-13, 1.2]),
        (Box::new(klein(TAU)), [1.0, 0.9]),
        (Box::new(half_plane()), [0.7, 1.0]),
    ];
    // Some rows of a square picture.
    let size = [512, 4];
    let unit = zoom * 4.0 / 512.0;
    let method = match options.method {
        TraceMethod::Adaptive => MapMethod::Fan,
        TraceMethod::Rk4 { steps } => MapMethod::Rk4 { steps },
    };
    let options = MapOptions {
        method,
        ..MapOptions::default()
    };
    worst(surfaces.iter().flat_map(|(surface, at)| {
        let surface = surface.as_ref();
        let frame = Frame::new(surface, *at, 0.3, unit).unwrap_or_else(|error| panic!("{error}"));
        let map = exponential_map(surface, &frame, size, &options, &|_| {});
        let jet = surface.jet((*at).into());
        let evaluations = map.work.evaluations as usize;
        (0..map.offset.len()).map(move |index| {
            let place = pixel_place(size, index as u32 % size[0], index as u32 / size[0]);
            let velocity = frame.velocity(place);
            let bend = acceleration(&jet, velocity);
            let off =
                [0, 1].map(|k| f64::from(map.offset[index][k]) - (velocity[k] + 0.5 * bend[k]));
            Measured {
                value: if map.status[index] == Status::Complete {
                    speed(&jet, off) / (2.0 * zoom / 512.0)
                } else {
                    f64::NAN
                },
                evaluations,
            }
        })
    }))
}

/// A frame of no size sees its own place everywhere, and the centre of any frame is its place exactly.
fn centre(options: &Options) -> Measured {
    let s = torus(0.4);
    let place = [0.3, 1.2];
    worst([0.0, 1e-300, 1.0].map(|zoom| {
        let frame = Frame::new(&s, place, 0.4, zoom);
        let ends = frame.ok().and_then(|frame| {
            let end = frame.trace(&s, [1.0, 0.5], 0.0, options);
            (zoom == 0.0 || end.is_ok()).then_some((frame, end))
        });
        Measured {
            value: match ends {
                Some((frame, end)) => {
                    let finite = frame.x.is_finite() && frame.y.is_finite();
                    let exact = frame.uv == place && end.map_or(true, |end| end.uv == place);
                    if finite && exact { 0.0 } else { 1.0 }
                }
                None => f64::NAN,
            },
            evaluations: 0,
        }
    }))
}

/// Long rays of random graphs z = Σ aₖ sin(bₖu + cₖv), some of them torn by a root: all end within the limit, without NaN.
fn budget(options: &Options) -> Measured {
    let mut random = Random(11);
    worst((0..12).map(|n| {
        let waves: Vec<[f64; 3]> = (0..3)
            .map(|_| {
                [
                    random.size(0.01, 3.0),
                    random.between(-20.0, 20.0),
                    random.between(-20.0, 20.0),
                ]
            })
            .collect();
        let s = waves_over_plane(&waves, n % 3 == 2, 50.0);
        let from = [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
        let angle = random.between(0.0, TAU);
        let end = go(&s, from, [angle.cos(), angle.sin()], 1e4, options);
        let finite = end.uv.is_finite() && end.error_estimate.is_finite();
        Measured {
            value: if finite && end.evaluations <= super::LIMIT {
                0.0
            } else {
                1.0
            },
            evaluations: end.evaluations,
        }
    }))
}
