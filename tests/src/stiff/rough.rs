//! Chaos, creases and edges that are cusps: B1, K1, K2.

use std::f64::consts::TAU;

use super::shapes::{bent_plane, bumps, cubed_plane, cuspidal, folded_plane, ripple, roof};
use super::{Case, MOST_OF_ONE, Measured, complete, distance, go, with_more_work, worst};
use geodesic::trace::{Options, Status};

pub(super) fn cases() -> Vec<Case> {
    // Lines that a change of direction dθ moves by some 10³ dθ at their ends.
    let starts = [(0.1, 0.2, 2.85), (0.1, 0.2, 2.8501), (0.1, 0.2, 2.8499)];
    let mut cases = Vec::new();
    cases.push(Case::new(
        "B1",
        "bumps 0.1 sin 20u sin 20v, L=3",
        "energy",
        1e-10,
        move |options| {
            let s = bumps();
            worst(starts.map(|(u, v, angle): (f64, f64, f64)| {
                let end = go(&s, [u, v], [angle.cos(), angle.sin()], 3.0, options);
                complete(&end, |end| end.speed_drift.abs())
            }))
        },
    ));
    cases.push(Case::new(
        "B1",
        "bumps 0.1 sin 20u sin 20v, L=3",
        "endpoint",
        1e-6,
        move |options| {
            let s = bumps();
            let exact = Options {
                tolerance: 1e-13,
                max_evaluations: 400_000,
                ..Options::default()
            };
            worst(starts.map(|(u, v, angle): (f64, f64, f64)| {
                let run = |options| go(&s, [u, v], [angle.cos(), angle.sin()], 3.0, options);
                let (end, truth) = (run(options), run(&exact));
                complete(&end, |end| match (end.position, truth.position) {
                    (Some(a), Some(b)) => distance(a, b),
                    _ => f64::NAN,
                })
            }))
        },
    ));
    let directions = [0.0, 0.4, -0.9, 1.3, 1.5];
    for slope in [0.5, 2.0] {
        let case = format!("crease: slope {slope} on one side of u = 0");
        cases.push(Case::new(
            "K1",
            case,
            "refracted endpoint",
            1e-9,
            move |options| {
                let s = bent_plane(slope);
                // Unrolled, u > 0 is stretched by the root of 1 + slope².
                let stretch = f64::hypot(1.0, slope);
                worst(directions.map(|angle: f64| {
                    let end = go(&s, [-0.3, 0.1], [angle.cos(), angle.sin()], 2.0, options);
                    let x = 2.0 * angle.cos() - 0.3;
                    let u = if x > 0.0 { x / stretch } else { x };
                    let expected = [u, 0.1 + 2.0 * angle.sin(), slope * u.max(0.0)];
                    complete(&end, |end| super::off(end, expected))
                }))
            },
        ));
    }
    cases.push(Case::new(
        "K1",
        "crease along a slanted line",
        "refracted endpoint",
        1e-9,
        move |options| {
            // The plane z = 0 for u < c v, folded up along u = c v.
            let (tilt, slope) = (0.6_f64, 1.5);
            let s = folded_plane(tilt, slope);
            let norm = f64::hypot(1.0, tilt);
            let stretch = f64::hypot(1.0, slope * norm);
            worst(directions.map(|angle: f64| {
                let end = go(&s, [-0.5, 0.1], [angle.cos(), angle.sin()], 2.0, options);
                // Along the crease and across it.
                let (x, y) = (-0.5 + 2.0 * angle.cos(), 0.1 + 2.0 * angle.sin());
                let (across, along) = ((x - tilt * y) / norm, (tilt * x + y) / norm);
                let flat = if across > 0.0 {
                    across / stretch
                } else {
                    across
                };
                let (u, v) = ((flat + tilt * along) / norm, (along - tilt * flat) / norm);
                let height = slope * norm * flat.max(0.0);
                complete(&end, |end| super::off(end, [u, v, height]))
            }))
        },
    ));
    cases.push(Case::new(
        "K1",
        "crease: slope |u|",
        "energy jump",
        1e-10,
        move |options| {
            let s = roof(1.0);
            worst(directions.map(|angle: f64| {
                let end = go(&s, [-0.3, 0.1], [angle.cos(), angle.sin()], 2.0, options);
                complete(&end, |end| end.speed_drift.abs())
            }))
        },
    ));
    cases.push(
        Case::new(
            "K2",
            "cuspidal edge (u², u³, v)",
            "short of the edge",
            2e-6,
            |options| {
                let s = cuspidal();
                let arc = |u: f64| (f64::powf(4.0 + 9.0 * u * u, 1.5) - 8.0) / 27.0;
                worst(
                    [(0.5, 0.0), (-0.5, 0.5), (0.2, 1.5)].map(|(start, across): (f64, f64)| {
                        let along = start * f64::sqrt(4.0 + 9.0 * start * start);
                        let direction = [-start.signum(), across * along.abs()];
                        let end = go(&s, [start, -0.5], direction, 3.0, options);
                        let expected = arc(start) * across.hypot(1.0);
                        Measured {
                            value: if end.status == Status::Degenerate && end.length <= expected {
                                expected - end.length
                            } else {
                                f64::NAN
                            },
                            evaluations: end.evaluations,
                        }
                    }),
                )
            },
        )
        .within(2_000),
    );
    cases.push(Case::new(
        "K3",
        "the plane as (u³, v), run into u=0",
        "short of the line",
        1e-11,
        |options| {
            let s = cubed_plane();
            worst(
                [[-1.0, 0.3], [-1.0, 0.0], [-1.0, -2.0]].map(|[u, v]: [f64; 2]| {
                    // σu = (3/4, 0) and σv = (0, 1) at (1/2, 0); the line is 1/8 away.
                    let expected = 0.125 * (0.75 * u).hypot(v) / (0.75 * u).abs();
                    let end = go(&s, [0.5, 0.0], [u, v], 1.0, options);
                    Measured {
                        value: if end.status == Status::Degenerate {
                            (expected - end.length).abs()
                        } else {
                            f64::NAN
                        },
                        evaluations: end.evaluations,
                    }
                }),
            )
        },
    ));
    cases.push(
        Case::new(
            "B2",
            "ripple of 200 waves, L=7, tolerance 10⁻¹³",
            "straight line, unrolled",
            1e-10,
            |options| {
                let s = ripple();
                let options = Options {
                    tolerance: 1e-13,
                    ..with_more_work(options)
                };
                let slope = 0.01 * 200.0 * TAU * f64::cos(200.0 * TAU * 0.01);
                let speed = (1.0 + slope * slope + 0.01).sqrt();
                let end = go(&s, [0.01, 0.2], [1.0, 0.1], 7.0, &options);
                // v grows evenly: the sheet is bent across it alone.
                complete(&end, |end| (end.uv[1] - (0.2 + 0.7 / speed)).abs())
            },
        )
        .within(MOST_OF_ONE),
    );
    cases
}
