//! Parametric surfaces against closed forms and their implicit twins.

use std::f64::consts::{PI, TAU};

use expr::{Graph, Input, NodeId};
use glam::{DAffine3, DVec3};
use tracer::{Ray, SetStep, Sheet, SheetScratch, WorldBuilder};

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

/// The distances at which the implicit surface is crossed.
fn implicit(formula: &Formula, rays: &[Ray]) -> Vec<Vec<f64>> {
    let graph = formula.graph().clone();
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
    let shape = builder.shape(formula.node(), [None; 3]).unwrap();
    builder
        .solid(&[SetStep::Leaf(shape, DAffine3::IDENTITY)])
        .unwrap();
    let world = builder.build().unwrap();
    let mut caster = world.caster();
    let all = rays.iter();
    all.map(|ray| caster.cast(ray).iter().map(|crossing| crossing.t).collect())
        .collect()
}

fn rays(count: usize) -> Vec<Ray> {
    let mut random = Random(21);
    let rays = (0..count).map(|_| {
        let direction = random.direction();
        Ray {
            origin: random.vector(1.2) - 5.0 * direction,
            direction,
            leaving: None,
        }
    });
    rays.collect()
}

/// Compares where tangency does not decide: two crossings closer than 10⁻³ may be missed by one of both.
fn compare(sheet: &Sheet, formula: &Formula, rays: &[Ray]) {
    let expected = implicit(formula, rays);
    let mut scratch = SheetScratch::default();
    let mut hits = 0;
    for (ray, expected) in rays.iter().zip(&expected) {
        if expected.windows(2).any(|pair| pair[1] - pair[0] < 1e-3) {
            continue;
        }
        let found = sheet.cast(&mut scratch, ray.origin, ray.direction, None);
        let found: Vec<f64> = found.iter().map(|hit| hit.t).collect();
        let close = found.len() == expected.len()
            && found
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() <= 1e-9 * (1.0 + b));
        assert!(close, "{ray:?}: {found:?}, not {expected:?}");
        hits += found.len();
    }
    assert!(hits > 500, "{hits}");
}

#[test]
fn torus_and_ball_are_hit_where_their_implicit_twins_are() {
    let [u, v, z] = &variables();
    let tube = &(1.0 + 0.4 * v.cos());
    let torus = [tube * u.cos(), tube * u.sin(), 0.4 * v.sin()];
    let (x, y) = (u, v);
    let twin = ((x.squared() + y.squared()).sqrt() - 1.0).squared() + z.squared() - 0.16;
    compare(&sheet(&torus, [[0.0, TAU]; 2]), &twin, &rays(1500));
    // Two poles and a seam.
    let ball = [u.sin() * v.cos(), u.sin() * v.sin(), u.cos()];
    let twin = x.squared() + y.squared() + z.squared() - 1.0;
    compare(&sheet(&ball, [[0.0, PI], [0.0, TAU]]), &twin, &rays(1500));
}

#[test]
fn hits_lie_on_ray_and_surface_and_rays_leave_it() {
    let [u, v, _] = &variables();
    let helicoid = [v * u.cos(), v * u.sin(), 0.3 * u];
    let domain = [[-6.0, 6.0], [-1.5, 1.5]];
    let sheet = sheet(&helicoid, domain);
    let bounds = sheet.bounds();
    assert!(bounds.lower.z <= -1.8 && bounds.upper.z < 1.81 && bounds.upper.x < 1.6);
    let mut scratch = SheetScratch::default();
    let mut seen = 0;
    for ray in rays(1000) {
        let hits = sheet
            .cast(&mut scratch, ray.origin, ray.direction, None)
            .to_vec();
        for hit in &hits {
            let [u, v] = hit.uv;
            let place = DVec3::new(v * u.cos(), v * u.sin(), 0.3 * u);
            assert!(place.distance(ray.origin + hit.t * ray.direction) < 1e-10);
            let normal = DVec3::new(-0.3 * u.sin(), 0.3 * u.cos(), -v).normalize();
            assert!((normal.dot(hit.normal).abs() - 1.0).abs() < 1e-12);
            assert!(hit.normal.dot(ray.direction) <= 0.0);
            seen += 1;
        }
        // On from the first hit: the others, and not this one.
        if let [first, rest @ ..] = &hits[..] {
            if first.normal.dot(ray.direction).abs() < 1e-3 {
                continue;
            }
            let onward = sheet.cast(&mut scratch, first.position, ray.direction, Some(first.uv));
            assert_eq!(onward.len(), rest.len(), "{ray:?}: {onward:?} and {hits:?}");
            for (a, b) in onward.iter().zip(rest) {
                assert!((a.t + first.t - b.t).abs() < 1e-9);
            }
        }
    }
    assert!(seen > 1000, "{seen}");
}

#[test]
fn a_sheet_that_is_undefined_or_degenerate_has_an_answer() {
    let [u, v, _] = &variables();
    let nan = u.number(f64::NAN);
    let mut scratch = SheetScratch::default();
    let ray = &rays(1)[0];
    let nowhere = sheet(&[u.clone(), v.clone(), nan], [[0.0, 1.0]; 2]);
    assert!(nowhere.bounds().is_empty());
    assert!(
        nowhere
            .cast(&mut scratch, ray.origin, ray.direction, None)
            .is_empty()
    );
    let line = sheet(&[u.clone(), u.clone(), u.clone()], [[0.0, 1.0]; 2]);
    assert!(
        line.cast(&mut scratch, DVec3::new(0.5, 0.5, -3.0), DVec3::Z, None)
            .is_empty()
    );
    let half = sheet(&[u.clone(), v.sqrt(), u * v], [[-1.0, 1.0]; 2]);
    let hits = half.cast(&mut scratch, DVec3::new(0.25, 0.5, -3.0), DVec3::Z, None);
    assert_eq!(hits.len(), 1);
    assert!((hits[0].t - 3.0625).abs() < 1e-12);
}
