//! Spheres, cones and planes about the point where their coordinates meet: S1–S3, C1–C3, P1, R1, R2.

use std::f64::consts::{PI, TAU};

use super::shapes::{cone, log_polar, sphere_in_units, spheroid, spheroid_metric, stereographic};
use super::{Case, Measured, complete, distance, go, off, worst};
use geodesic::surface::Surface;
use geodesic::trace::{Options, Status};

/// The end of a great circle of the unit sphere, from (longitude, latitude) with a direction in these.
pub(super) fn great_circle(from: [f64; 2], direction: [f64; 2], length: f64) -> [f64; 3] {
    let ((su, cu), (sv, cv)) = (from[0].sin_cos(), from[1].sin_cos());
    let [a, b] = direction;
    let tangent = [
        -a * cv * su - b * sv * cu,
        a * cv * cu - b * sv * su,
        b * cv,
    ];
    let norm = (a * a * cv * cv + b * b).sqrt();
    let (sin, cos) = length.sin_cos();
    let p = [cv * cu, cv * su, sv];
    [0, 1, 2].map(|k| p[k] * cos + tangent[k] / norm * sin)
}

pub(super) fn cases() -> Vec<Case> {
    let mut cases = vec![Case::new(
        "S1",
        "sphere, 16 turns, L=100",
        "endpoint",
        1e-8,
        |options| {
            let (from, direction) = ([0.3, 0.2], [1.0, 0.5]);
            let end = go(&spheroid(1.0, 1.0), from, direction, 100.0, options);
            complete(&end, |end| off(end, great_circle(from, direction, 100.0)))
        },
    )];
    for miss in [1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8_f64] {
        let case = format!("sphere, pole missed by {miss:.0e}");
        let run = move |options: &Options| {
            let from = [0.7, PI / 2.0 - 1.0];
            let sine = miss.sin() / 1.0_f64.sin();
            let direction = [sine / from[1].cos(), (1.0 - sine * sine).sqrt()];
            let end = go(&spheroid(1.0, 1.0), from, direction, 2.5, options);
            complete(&end, |end| off(end, great_circle(from, direction, 2.5)))
        };
        cases.push(Case::new("S2", case, "endpoint", 1e-9, run).within(200));
    }
    cases.push(Case::new(
        "S3",
        "sphere, meridian through the pole",
        "endpoint",
        1e-12,
        |options| {
            let (from, direction) = ([0.7, PI / 2.0 - 1.0], [0.0, 1.0]);
            let end = go(&spheroid(1.0, 1.0), from, direction, 2.5, options);
            complete(&end, |end| off(end, great_circle(from, direction, 2.5)))
        },
    ));
    for (id, slope, what) in [
        ("C1", 1.0, "cone, apex"),
        ("C2", 0.0, "polar plane, origin"),
    ] {
        for miss in [1e-1, 1e-3, 1e-6] {
            let case = format!("{what} missed by {miss:.0e}");
            cases.push(Case::new(id, case, "unrolled endpoint", 1e-11, move |o| {
                past_apex(slope, miss, o)
            }));
        }
    }
    for miss in [1e-1, 1e-3, 1e-6] {
        let case = format!("log-polar plane, origin missed by {miss:.0e}");
        cases.push(Case::new("C3", case, "straight line", 1e-11, move |o| {
            past_origin(miss, o)
        }));
    }
    for miss in [1e-1, 1e-2, 1e-4_f64] {
        let case = format!("stereographic sphere, infinity missed by {miss:.0e}");
        cases.push(Case::new("P1", case, "energy", 1e-10, move |options| {
            // Through the point of longitude 0 on the equator, past the pole at infinity.
            let end = go(
                &stereographic(),
                [1.0, 0.0],
                [miss.cos(), miss.sin()],
                2.5,
                options,
            );
            complete(&end, |end| end.speed_drift.abs())
        }));
    }
    for shear in [1e2, 1e3, 1e4] {
        let case = format!("sphere sheared by {shear:.0e}");
        let (quantity, bound) = if shear <= 1e3 {
            ("endpoint", 1e-9)
        } else {
            ("error over estimate", 3.0)
        };
        cases.push(Case::new("R1", case, quantity, bound, move |options| {
            sheared(shear, shear > 1e3, options)
        }));
    }
    for (unit, size) in [
        (1e-10, 1.0),
        (1e6, 1.0),
        (1.0, 1e-6),
        (1.0, 1e6),
        (1e-10, 1e6),
        (1.0, 1e-150),
        (1.0, 1e150),
        (1e-150, 1.0),
        (1e150, 1.0),
    ] {
        let case = format!("sphere of radius {size:.0e} in units of {unit:.0e}");
        cases.push(Case::new(
            "R2",
            case,
            "change/rounding",
            // There the chart's own extent is at the end of what numbers can be.
            if (1e-100..1e100).contains(&unit) {
                10.0
            } else {
                1e3
            },
            move |options| invariance(unit, size, options),
        ));
    }
    for size in [1e-6, 1e6, 1e-150, 1e150] {
        let case = format!("metric of a sphere of radius {size:.0e}");
        let quantity = "change/rounding";
        cases.push(Case::new("R3", case, quantity, 10.0, move |options| {
            metric_invariance(size, options)
        }));
    }
    cases
}

/// A line past the apex of a cone, unrolled.
fn past_apex(slope: f64, miss: f64, options: &Options) -> Measured {
    let root = f64::hypot(1.0, slope);
    let v = 1.0 / root;
    let cosine = (1.0 - miss * miss).sqrt();
    let end = go(
        &cone(slope),
        [1.0, v],
        [miss / v, -cosine / root],
        2.5,
        options,
    );
    let (x, y) = (1.0 - 2.5 * cosine, 2.5 * miss);
    let u = 1.0 + y.atan2(x) * root;
    let r = x.hypot(y) / root;
    complete(&end, |end| off(end, [r * u.cos(), r * u.sin(), slope * r]))
}

/// A line past the origin of the plane (eᵛ cos u, eᵛ sin u).
fn past_origin(miss: f64, options: &Options) -> Measured {
    let cosine = (1.0 - miss * miss).sqrt();
    let end = go(&log_polar(), [1.0, 0.0], [miss, -cosine], 2.5, options);
    let (x, y) = (1.0 - 2.5 * cosine, 2.5 * miss);
    let (su, cu) = 1.0_f64.sin_cos();
    complete(&end, |end| {
        off(end, [x * cu - y * su, x * su + y * cu, 0.0])
    })
}

/// How much the end depends on the size of a sphere that is given by its metric, in roundings of its length.
fn metric_invariance(size: f64, options: &Options) -> Measured {
    let [plain, other] = [1.0, size].map(|size| spheroid_metric(size, size, 0.0));
    let sphere = sphere_in_units(1.0, 1.0, 0.0);
    let runs = [
        ([0.3, 0.2], [1.0, 0.5], 3.0),
        ([2.0, -0.9], [0.2, -1.0], 0.5),
        ([5.0, 1.0], [-1.0, 0.1], 2.0),
    ];
    worst(runs.map(|(from, direction, length)| {
        let a = go(&plain, from, direction, length, options);
        let b = go(&other, from, direction, length * size, options);
        if a.status != Status::Complete {
            return complete(&a, |_| 0.0);
        }
        complete(&b, |b| {
            let rounding = f64::EPSILON * length * a.steps as f64;
            let [a, b] = [a.uv, b.uv].map(|uv| sphere.jet(uv).position);
            distance(a, b) / rounding
        })
    }))
}

/// Great circles in a sheared chart: their error, or, where rounding eats it up, how far beyond its estimate.
fn sheared(shear: f64, against_estimate: bool, options: &Options) -> Measured {
    let s = sphere_in_units(1.0, 1.0, shear);
    let runs = [
        (0.3, 0.2, 0.4, 2.0),
        (1.0, -0.5, -0.7, 3.0),
        (4.0, 0.8, 0.05, 2.5),
    ];
    worst(runs.map(|(u, v, angle, length): (f64, f64, f64, f64)| {
        let (north, east) = angle.sin_cos();
        let start = [u + shear * v, v];
        let direction = [east / v.cos(), north];
        let end = go(
            &s,
            [u, v],
            [direction[0] - shear * north, north],
            length,
            options,
        );
        let error = off(&end, great_circle(start, direction, length));
        if against_estimate {
            // Where it stopped short it says so.
            let is_incomplete = end.status != Status::Complete;
            return Measured {
                value: if is_incomplete {
                    0.0
                } else {
                    error / end.error_estimate
                },
                evaluations: end.evaluations,
            };
        }
        complete(&end, |_| error)
    }))
}

/// How much the end depends on the chart's unit and the surface's size, in roundings of its length.
fn invariance(unit: f64, size: f64, options: &Options) -> Measured {
    let (plain, other) = (
        sphere_in_units(1.0, 1.0, 0.0),
        sphere_in_units(unit, size, 0.0),
    );
    let length = TAU;
    let runs = [
        ([0.3, 0.2], [1.0, 0.5]),
        ([2.0, -0.9], [0.2, -1.0]),
        ([5.0, 1.0], [-1.0, 0.1]),
    ];
    worst(runs.map(|(from, direction)| {
        let a = go(&plain, from, direction, length, options);
        let b = go(
            &other,
            from.map(|x| x * unit),
            direction,
            length * size,
            options,
        );
        if a.status != Status::Complete {
            return complete(&a, |_| 0.0);
        }
        let back = |uv: [f64; 2]| plain.jet(uv.map(|x| x / unit).into()).position;
        complete(&b, |b| {
            // Each step rounds.
            let rounding = f64::EPSILON * length * a.steps as f64;
            distance(plain.jet(a.uv).position, back(b.uv.0)) / rounding
        })
    }))
}
