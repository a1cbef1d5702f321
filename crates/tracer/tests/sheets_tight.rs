//! Rays do not pass through parametric surfaces.

use std::f64::consts::{PI, TAU};

use expr::{Graph, Input, NodeId};
use glam::DVec3;
use tracer::{Sheet, SheetScratch};

#[path = "../../expr/tests/formula/mod.rs"]
mod formula;
mod scenes;
use formula::{Formula, variables};
use scenes::Random;

fn sheet(components: &[Formula; 3], domain: [[f64; 2]; 2]) -> Sheet {
    let nodes: [NodeId; 3] = [0, 1, 2].map(|k| components[k].node());
    let graph: Graph = components[0].graph().clone();
    Sheet::new(&graph, nodes, domain, &|_: Input| f64::NAN).unwrap()
}

/// True if the ray from `origin` meets the surface at `target`, but for rounding.
fn meets(sheet: &Sheet, scratch: &mut SheetScratch, origin: DVec3, target: DVec3) -> bool {
    let direction = (target - origin).normalize();
    let distance = (target - origin).length();
    let slack = 1e-9 + 1e3 * f64::EPSILON * (origin.length() + target.length());
    let hits = sheet.cast(scratch, origin, direction, None);
    hits.iter().any(|hit| (hit.t - distance).abs() <= slack)
}

#[test]
fn rays_through_the_middles_of_cells_meet_them_from_near_and_far() {
    let [u, v, _] = &variables();
    let mut scratch = SheetScratch::default();
    type Height = fn(f64) -> f64;
    let surfaces: [(Formula, Height); 3] = [
        (u.number(0.0), |_| 0.0),
        (0.3 * u, |x| 0.3 * x),
        (0.3 * u.abs(), |x| 0.3 * x.abs()),
    ];
    for (z, height) in surfaces {
        let surface = sheet(&[u.clone(), v.clone(), z], [[-32.0, 32.0]; 2]);
        for power in 0..8 {
            let distance = 10.0f64.powi(power);
            let mut random = Random(5);
            for _ in 0..500 {
                // The cells are squares between whole numbers.
                let [x, y] = [0, 1].map(|_| random.below(64) as f64 - 31.5);
                let target = DVec3::new(x, y, height(x));
                let up = random.direction() + 1.5 * DVec3::Z;
                for origin in [target + distance * up, target - distance * up] {
                    let is_met = meets(&surface, &mut scratch, origin, target);
                    assert!(is_met, "{target} from {origin}");
                }
            }
        }
    }
}

#[test]
fn rays_in_the_plane_of_a_seam_meet_a_closed_surface_from_inside() {
    let [u, v, _] = &variables();
    let mut scratch = SheetScratch::default();
    let ball = [u.cos() * v.sin(), u.sin() * v.sin(), v.cos()];
    let tube = &(2.0 + v.cos());
    let torus = [tube * u.cos(), tube * u.sin(), v.sin()];
    let cylinder = [u.cos(), u.sin(), v.clone()];
    // A point inside, the surface, its domain, and how far away it is in the direction at this angle. It closes where y = 0.
    type Distance = fn(f64) -> f64;
    let surfaces: [(f64, [Formula; 3], [[f64; 2]; 2], Distance); 4] = [
        (0.0, ball.clone(), [[-PI, PI], [0.0, PI]], |_| 1.0),
        (0.0, ball, [[0.0, TAU], [0.0, PI]], |_| 1.0),
        (-2.0, torus, [[-PI, PI]; 2], |_| 1.0),
        (0.0, cylinder, [[-PI, PI], [-9.0, 9.0]], |angle| {
            1.0 / angle.cos().abs()
        }),
    ];
    for (x, components, domain, distance) in surfaces {
        let surface = sheet(&components, domain);
        for k in 0..360 {
            let angle = f64::from(k).to_radians();
            let direction = DVec3::new(angle.cos(), 0.0, angle.sin());
            let distance = distance(angle);
            // Beyond the ends of the cylinder.
            if distance > 9.0 {
                continue;
            }
            let hits = surface.cast(&mut scratch, x * DVec3::X, direction, None);
            let first = hits.first().map(|hit| hit.t);
            let is_met = first.is_some_and(|t| (t - distance).abs() < 1e-12);
            assert!(is_met, "{x}, {direction}: {first:?}");
        }
    }
}
