//! Rays do not pass through parametric surfaces.

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
