//! Solids that are unions of products: bundles read them vector by vector, single rays by a sweep.

use std::collections::BTreeMap;

use glam::{DAffine3, DVec3};
use tracer::{Ray, SetStep, ShapeId, SurfaceId, World, WorldBuilder};

use crate::formula::{Formula, variables};
use crate::scenes::Random;

/// The number of simple shapes that are bounded, the first ones.
const BOUNDED: usize = 3;

/// Shapes that are convex or bounded by one quadric.
fn simple_shapes([x, y, z]: &[Formula; 3]) -> Vec<Formula> {
    let rr = &(x.squared() + y.squared());
    vec![
        rr + z.squared() - 1.0,
        x.abs().max(&y.abs()).max(&z.abs()) - 0.8,
        rr.max(&z.squared()) - 0.6,
        rr - 0.5,
        x - 0.3,
        x.squared() - 0.4,
        rr - z.squared(),
        rr - z.squared() - 0.2,
        z - x * y,
        rr - z,
    ]
}

/// A world of one to three solids, whose leaves lie often on each other.
fn world(random: &mut Random) -> World {
    let variables = variables();
    let formulas = simple_shapes(&variables);
    let graph = variables[0].graph().clone();
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
    let ids: Vec<_> = formulas
        .iter()
        .map(|f| builder.shape(f.node(), [None; 3]).unwrap())
        .collect();
    let mut maps = vec![DAffine3::IDENTITY];
    for _ in 0..1 + random.below(3) {
        let mut steps = if random.below(4) == 0 {
            random.tree(&ids, 6, 1.5)
        } else {
            products(random, &ids)
        };
        for step in &mut steps {
            if let SetStep::Leaf(_, map) = step {
                if random.below(3) == 0 {
                    *map = maps[random.below(maps.len())];
                }
                maps.push(*map);
            }
        }
        builder.solid(&steps).unwrap();
    }
    builder.build().unwrap()
}

/// A union of products, each of which begins with a bounded shape.
fn products(random: &mut Random, ids: &[ShapeId]) -> Vec<SetStep> {
    let mut steps = Vec::new();
    for product in 0..1 + random.below(3) {
        let bounded = ids[random.below(BOUNDED)];
        steps.push(SetStep::Leaf(bounded, random.map(1.5)));
        for _ in 0..random.below(4) {
            let shape = ids[random.below(ids.len())];
            steps.push(SetStep::Leaf(shape, random.map(1.5)));
            steps.push(match random.below(3) {
                0 => SetStep::Intersection,
                _ => SetStep::Difference,
            });
        }
        if product > 0 {
            steps.push(SetStep::Union);
        }
    }
    steps
}

/// Rays about an axis, often along one of the space.
fn rays(random: &mut Random) -> Vec<Ray> {
    let direction = match random.below(4) {
        0 => DVec3::AXES[random.below(3)],
        _ => random.direction(),
    };
    let origin = random.vector(1.5) - random.between(1.0, 8.0) * direction;
    let (start, spread) = (random.between(0.0, 0.2), random.between(0.0, 0.4));
    let count = 1 + random.below(70);
    let ray = |random: &mut Random| Ray {
        origin: origin + random.vector(start),
        direction: direction + random.vector(spread),
        leaving: None,
    };
    (0..count).map(|_| ray(random)).collect()
}

#[test]
fn a_bundle_finds_what_a_sweep_finds_to_the_last_bit() {
    let mut random = Random(11);
    let (mut cast, mut met, mut swept, mut left) = (0, 0, 0, 0);
    for _ in 0..500 {
        let world = world(&mut random);
        let (mut alone, mut together) = (world.caster(), world.caster());
        let mut bundles = vec![rays(&mut random)];
        while let Some(rays) = bundles.pop() {
            let before = together.sweeps();
            together.begin_bundle(&rays);
            let mut by_surface: BTreeMap<SurfaceId, Vec<Ray>> = BTreeMap::new();
            let turn = random.direction();
            for (k, ray) in rays.iter().enumerate() {
                let found = together.first_of_bundle(k);
                assert_eq!(found, alone.first(ray), "{ray:?} in {world:?}");
                let is_first = ray.leaving.is_none();
                cast += 1;
                left += usize::from(!is_first);
                let Some(hit) = found else { continue };
                met += 1;
                if is_first {
                    by_surface.entry(hit.surface).or_default().push(Ray {
                        origin: hit.position,
                        direction: turn + random.vector(0.2),
                        leaving: Some(hit.surface),
                    });
                }
            }
            swept += together.sweeps() - before;
            bundles.extend(by_surface.into_values());
        }
    }
    // Rays from nowhere that start inside take a sweep, and those that meet two surfaces at once or other solids.
    println!("{cast} rays, {left} of them from surfaces, {met} of which meet one; {swept} sweeps");
    assert!(left > 7_000 && met > 12_000, "{left}, {met}");
    assert!(swept < 2 * cast as u64 / 5, "{swept} of {cast}");
}
