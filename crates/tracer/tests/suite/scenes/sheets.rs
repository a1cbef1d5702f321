//! Parametric surfaces whose expressions have derivatives, roots and quotients in them.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::Formula;

/// A surface with its name and its domain.
pub type NamedSheet = (&'static str, [Formula; 3], [[f64; 2]; 2]);

type Vector = [Formula; 3];

/// A torus, tubes around curves, and two surfaces of textbooks, over u and v.
pub fn sheets([u, v, _]: &[Formula; 3]) -> Vec<NamedSheet> {
    let wide = &((3.0 * u).cos() + 2.0);
    let knot = [
        wide * (2.0 * u).cos(),
        wide * (2.0 * u).sin(),
        (3.0 * u).sin(),
    ];
    let helix = [u.cos(), u.sin(), 1.6 / TAU * u];
    let half = &(0.5 * u);
    let eight = &(half.cos() * v.sin() - half.sin() * (2.0 * v).sin() + 2.0);
    let root = &u.number(2.0f64.sqrt());
    let square = &v.cos().squared();
    let divisor = &(2.0 - root * (3.0 * u).sin() * (2.0 * v).sin());
    let around = &(0.4 * v.cos() + 1.0);
    vec![
        (
            "torus",
            [around * u.cos(), around * u.sin(), 0.4 * v.sin()],
            [[0.0, TAU]; 2],
        ),
        ("trefoil", tube(&knot, v, 0.4), [[0.0, TAU]; 2]),
        (
            "spring",
            tube(&helix, v, 0.25),
            [[0.0, 3.0 * TAU], [0.0, TAU]],
        ),
        (
            "Boy",
            [
                (root * (2.0 * u).cos() * square + u.cos() * (2.0 * v).sin()) / divisor,
                (root * (2.0 * u).sin() * square - u.sin() * (2.0 * v).sin()) / divisor,
                3.0 * square / divisor,
            ],
            [[-FRAC_PI_2, FRAC_PI_2], [0.0, PI]],
        ),
        (
            "figure-8 Klein bottle",
            [
                eight * u.cos(),
                eight * u.sin(),
                half.sin() * v.sin() + half.cos() * (2.0 * v).sin(),
            ],
            [[0.0, TAU]; 2],
        ),
    ]
}

/// The tube of a radius around a curve in u, by the curve's normal and binormal.
fn tube(curve: &Vector, v: &Formula, radius: f64) -> Vector {
    let slope = |of: &Vector| [0, 1, 2].map(|k: usize| of[k].derivative(0));
    let first = slope(curve);
    let tangent = unit(&first);
    let binormal = unit(&cross(&first, &slope(&first)));
    let normal = cross(&binormal, &tangent);
    let (cosine, sine) = (&(radius * v.cos()), &(radius * v.sin()));
    [0, 1, 2].map(|k: usize| &curve[k] + cosine * &normal[k] + sine * &binormal[k])
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    [0, 1, 2].map(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        &a[i] * &b[j] - &a[j] * &b[i]
    })
}

fn unit(of: &Vector) -> Vector {
    let [x, y, z] = of;
    let length = &(x.squared() + y.squared() + z.squared()).sqrt();
    [x / length, y / length, z / length]
}
