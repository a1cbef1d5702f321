//! Tori and other surfaces of revolution, and what their symmetry conserves: T1–T5, H3, E1, E2, I1, Z1.

use std::f64::consts::{PI, TAU};

use super::shapes::{catenoid, helicoid, pseudosphere, spheroid, torus, triaxial, zoll};
use super::{Case, MOST_OF_ONE, Measured, complete, go, with_more_work, worst};
use geodesic::surface::Surface;
use geodesic::trace::{Options, Status, Trace};

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (id, case, r, from, direction, length, bound) in [
        (
            "T1",
            "torus r=0.4, L=50",
            0.4,
            [0.0, 0.0],
            [1.0, 1.0],
            50.0,
            1e-10,
        ),
        (
            "T3",
            "torus, inner equator + 10⁻⁶, L=10",
            0.4,
            [1.0, PI + 1e-6],
            [1.0, 0.0],
            10.0,
            1e-11,
        ),
        (
            "T4",
            "thin torus r=0.02, 67 windings",
            0.02,
            [0.0, 0.0],
            [0.1, 1.0],
            67.0 * 0.02 * TAU,
            1e-10,
        ),
        (
            "T5",
            "near-horn torus r=0.999, L=20",
            0.999,
            [0.0, 0.0],
            [0.3, 1.0],
            20.0,
            1e-10,
        ),
    ] {
        cases.push(Case::new(id, case, "Clairaut", bound, move |options| {
            let s = torus(r);
            let end = go(&s, from, direction, length, options);
            complete(&end, |end| clairaut_change(&s, from, direction, end))
        }));
    }
    cases.insert(
        1,
        Case::new(
            "T2",
            "torus, inner equator exactly, L=10",
            "v − π",
            1e-14 * f64::exp(2.04 * 10.0),
            |options| {
                let end = go(&torus(0.4), [1.0, PI], [1.0, 0.0], 10.0, options);
                complete(&end, |end| (end.uv[1] - PI).abs())
            },
        ),
    );
    cases.push(Case::new(
        "T6",
        "torus, outer equator: conjugate point",
        "π√(r(R+r))",
        1e-10,
        |options| {
            worst([0.4, 0.1, 0.9].map(|r| {
                let expected = PI * f64::sqrt(r * (1.0 + r));
                let options = Options {
                    conjugates: true,
                    ..*options
                };
                let end = go(&torus(r), [1.0, 0.0], [1.0, 0.0], 1.3 * expected, &options);
                complete(&end, |end| match end.conjugates[..] {
                    [at] => (at - expected).abs(),
                    _ => f64::NAN,
                })
            }))
        },
    ));
    cases.push(Case::new(
        "H3",
        "pseudosphere up the cusp and back, L=20",
        "Clairaut, relative",
        1e-6,
        |options| {
            let s = pseudosphere();
            // In the half-plane y = cosh v: a half-circle of a radius that takes 20 to go round.
            let start = 2.0_f64;
            let top = start * 10.0_f64.cosh();
            let t = -f64::acosh(top / start);
            let (right, up) = (1.0 / t.cosh(), -t.tanh());
            let from = [1.0, f64::acosh(start)];
            let direction = [right * start, up * start / from[1].sinh()];
            let end = go(&s, from, direction, 20.0, options);
            let constant = |uv: [f64; 2], d: [f64; 2]| d[0] / uv[1].cosh().powi(2);
            complete(&end, |end| {
                (constant(end.uv.0, end.direction.0) / (right / start) - 1.0).abs()
            })
        },
    ));
    cases.push(
        Case::new(
            "T7",
            "near-horn torus r=0.9999, L=200, tolerance 10⁻¹³",
            "Clairaut",
            1e-10,
            |options| {
                let (s, options) = (torus(0.9999), exacting(options));
                let (from, direction) = ([0.0, 0.0], [0.3, 1.0]);
                let end = go(&s, from, direction, 200.0, &options);
                complete(&end, |end| clairaut_change(&s, from, direction, end))
            },
        )
        .within(MOST_OF_ONE),
    );
    cases.push(
        Case::new(
            "E5",
            "spheroid b=0.01, L=20, tolerance 10⁻¹³",
            "Clairaut",
            1e-11,
            |options| {
                let (s, options) = (spheroid(1.0, 0.01), exacting(options));
                let (from, direction) = ([0.3, 0.2], [0.05, 1.0]);
                let end = go(&s, from, direction, 20.0, &options);
                complete(&end, |end| clairaut_change(&s, from, direction, end))
            },
        )
        .within(MOST_OF_ONE),
    );
    for (b, what, length, bound) in [
        (0.01, "10 times over the rim, L=20", 20.0, 1e-10),
        (100.0, "L=300", 300.0, 1e-11),
    ] {
        let case = format!("spheroid b={b}, {what}");
        cases.push(Case::new("E1", case, "Clairaut", bound, move |options| {
            let s = spheroid(1.0, b);
            let (from, direction) = ([0.3, 0.2], if b > 1.0 { [0.3, 0.01] } else { [0.05, 1.0] });
            let end = go(&s, from, direction, length, options);
            complete(&end, |end| clairaut_change(&s, from, direction, end))
        }));
    }
    cases.push(Case::new(
        "E2",
        "ellipsoid 1:2:3, L=100",
        "Joachimsthal, relative",
        1e-9,
        |options| {
            let s = triaxial(1.0, 2.0, 3.0);
            let (from, direction) = ([0.4, 0.3], [1.0, 0.7]);
            let constant = |uv: [f64; 2], d: [f64; 2]| {
                let jet = s.jet(uv.into());
                let squares = [1.0, 4.0, 9.0];
                let v = [0, 1, 2].map(|k| jet.du[k] * d[0] + jet.dv[k] * d[1]);
                let unit: f64 = v.iter().map(|x| x * x).sum();
                let p: f64 = (0..3)
                    .map(|k| jet.position[k].powi(2) / f64::powi(squares[k], 2))
                    .sum();
                let q: f64 = (0..3).map(|k| v[k].powi(2) / squares[k]).sum();
                p * q / unit
            };
            let end = go(&s, from, direction, 100.0, options);
            let before = constant(from, direction);
            complete(&end, |end| {
                (constant(end.uv.0, end.direction.0) / before - 1.0).abs()
            })
        },
    ));
    cases.push(Case::new(
        "E4",
        "ellipsoid √2:1:1/√2, umbilic to opposite umbilic",
        "3.42538371796…",
        1e-10,
        umbilic,
    ));
    cases.push(Case::new(
        "I1",
        "catenoid and helicoid, L=5",
        "coordinate difference",
        1e-11,
        |options| {
            let (catenoid, helicoid) = (catenoid(), helicoid());
            worst((0..12).map(|n| {
                let angle = 0.1 + 0.5 * f64::from(n);
                let (from, direction) = ([1.0, 0.5], [angle.cos(), angle.sin()]);
                let a = go(&catenoid, from, direction, 5.0, options);
                let b = go(&helicoid, from, direction, 5.0, options);
                if a.status != Status::Complete {
                    return complete(&a, |_| 0.0);
                }
                let around = (a.uv[0] - b.uv[0] + PI).rem_euclid(TAU) - PI;
                complete(&b, |b| around.abs().max((a.uv[1] - b.uv[1]).abs()))
            }))
        },
    ));
    for (quantity, which) in [("closes after 2π", 0), ("m = 0, m' = 1 after 2π", 1)] {
        cases.push(Case::new(
            "Z1",
            "Zoll, h(x) = x/2",
            quantity,
            1e-11,
            move |options| {
                let s = zoll();
                let options = Options {
                    conjugates: which == 1,
                    ..*options
                };
                let starts = [
                    (1.0, 0.3),
                    (0.4, 1.3),
                    (2.0, 1.0),
                    (PI / 2.0, 1.4),
                    (1.2, 0.0),
                ];
                worst(starts.map(|(u, angle): (f64, f64)| {
                    let direction = [angle.sin() / (1.0 + 0.5 * u.cos()), angle.cos() / u.sin()];
                    let end = go(&s, [u, 1.0], direction, TAU, &options);
                    complete(&end, |end| match which {
                        0 => (end.uv[0] - u).abs().max((end.uv[1] - 1.0).abs() * u.sin()),
                        _ => end.jacobi[0].abs().max((end.jacobi[1] - 1.0).abs()),
                    })
                }))
            },
        ));
    }
    cases
}

/// The change of Clairaut's constant ⟨γ', σu⟩ at unit speed, on a surface of revolution about the third axis.
fn clairaut_change(s: &dyn Surface, from: [f64; 2], direction: [f64; 2], end: &Trace) -> f64 {
    let constant = |uv: [f64; 2], d: [f64; 2]| {
        let jet = s.jet(uv.into());
        let v = [0, 1, 2].map(|k| jet.du[k] * d[0] + jet.dv[k] * d[1]);
        let speed = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        (0..3).map(|k| v[k] * jet.du[k]).sum::<f64>() / speed
    };
    (constant(end.uv.0, end.direction.0) - constant(from, direction)).abs()
}

/// All geodesics from an umbilic meet at the opposite one, after half the length of the ellipse through them.
fn umbilic(options: &Options) -> Measured {
    let axes = [2.0_f64.sqrt(), 1.0, 0.5_f64.sqrt()];
    let s = triaxial(axes[0], axes[1], axes[2]);
    // x² = a²(a²−b²)/(a²−c²), z² = c²(b²−c²)/(a²−c²).
    let [x, z] = [f64::sqrt(4.0 / 3.0), f64::sqrt(1.0 / 6.0)];
    let from = [0.0, (z / axes[2]).asin()];
    worst((0..16).map(|n| {
        let angle = 0.05 + TAU * f64::from(n) / 16.0;
        let end = go(
            &s,
            from,
            [angle.cos(), angle.sin()],
            3.425_383_717_962_000_7,
            options,
        );
        complete(&end, |end| super::off(end, [-x, 0.0, -z]))
    }))
}

/// Steps as exact as they can be, and the work that they take.
fn exacting(options: &Options) -> Options {
    Options {
        tolerance: 1e-13,
        ..with_more_work(options)
    }
}
