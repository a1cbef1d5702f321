//! Random trees of set operations against the membership of points, which the tree gives directly.

use glam::DVec3;
use tracer::{Crossing, Ray, SetStep, World, WorldBuilder};

use crate::formula::variables;
use crate::scenes::{LeafValue, Random, shapes};

/// The distance from tangency within which an answer may be either.
const NEAR: f64 = 1e-5;

/// True if all points within [`NEAR`] are inside, or all outside.
fn decided(world: &World, solid: usize, point: DVec3, scale: f64) -> bool {
    let here = world.contains(solid, point);
    let steps = [-1.0, 0.0, 1.0];
    steps.iter().all(|&x| {
        steps.iter().all(|&y| {
            steps.iter().all(|&z| {
                let offset = DVec3::new(x, y, z) * NEAR * scale;
                world.contains(solid, point + offset) == here
            })
        })
    })
}

/// The number of samples of the ray whose membership is not what the crossings say.
fn disagreements(
    world: &World,
    ray: &Ray,
    crossings: &[Crossing],
    starts_inside: bool,
    reach: f64,
) -> usize {
    let samples = 60;
    let mut wrong = 0;
    let mut places: Vec<f64> = (0..samples)
        .map(|k| (k as f64 + 0.5) * reach / samples as f64)
        .collect();
    let mut ts: Vec<f64> = vec![0.0];
    ts.extend(crossings.iter().map(|crossing| crossing.t));
    ts.push(reach);
    places.extend(ts.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])));
    for t in places {
        if ts.iter().any(|other| (t - other).abs() < 1e-9 * (1.0 + t)) {
            continue;
        }
        let next = crossings.iter().find(|crossing| crossing.t > t);
        let last = crossings.iter().rev().find(|crossing| crossing.t < t);
        let said = match (last, next) {
            (Some(last), _) => last.entering,
            (None, Some(next)) => !next.entering,
            (None, None) => starts_inside,
        };
        let point = ray.origin + t * ray.direction;
        if said != world.contains(0, point) && decided(world, 0, point, 1.0) {
            wrong += 1;
        }
    }
    wrong
}

#[test]
fn every_crossing_of_random_trees_is_where_membership_changes() {
    let trees = 250;
    let rays = 40;
    let mut random = Random(7);
    let variables = variables();
    let formulas = shapes(&variables);
    let graph = formulas[0].graph().clone();
    let mut crossings_seen = 0;
    for tree in 0..trees {
        let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
        let ids: Vec<_> = formulas
            .iter()
            .map(|f| builder.shape(f.node(), [None; 3]).unwrap())
            .collect();
        let steps = random.tree(&ids, 12, 1.2);
        builder.solid(&steps).unwrap();
        let world = builder.build().unwrap();
        let leaves = steps.iter().filter_map(|step| match step {
            SetStep::Leaf(id, map) => {
                let k = ids.iter().position(|other| other == id).unwrap();
                Some(LeafValue::new(&graph, formulas[k].node(), map))
            }
            _ => None,
        });
        let mut leaves: Vec<LeafValue> = leaves.collect();
        let mut caster = world.caster();
        for k in 0..rays {
            // From outside, from inside, and along the axes.
            let target = random.vector(1.2);
            let direction = match k % 4 {
                0 => [DVec3::X, -DVec3::Y, DVec3::Z][random.below(3)],
                _ => random.direction(),
            };
            let back = if k % 3 == 0 { 0.0 } else { 6.0 };
            let ray = Ray {
                origin: target - back * direction,
                direction: direction * if k % 5 == 0 { 3.0 } else { 1.0 },
                leaving: None,
            };
            let crossings = caster.cast(&ray).to_vec();
            let inside = !caster.solids_at_start().is_empty();
            // Nothing of one ray is left for the next: the bits do not depend on how rays are dealt out to threads.
            assert_eq!(world.caster().cast(&ray), crossings, "tree {tree}, ray {k}");
            assert_eq!(
                caster.first(&ray),
                crossings.first().copied(),
                "tree {tree}, ray {k}"
            );
            crossings_seen += crossings.len();
            let wrong = disagreements(&world, &ray, &crossings, inside, 14.0);
            assert_eq!(
                wrong, 0,
                "tree {tree}, ray {k}: {ray:?}\n{crossings:#?}\n{steps:?}"
            );
            for crossing in &crossings {
                let (value, gradient) = leaves[crossing.leaf].at(crossing.position);
                let slope = gradient.dot(ray.direction);
                let sine = (slope / gradient.length() / ray.direction.length()).abs();
                let cosine = crossing.normal.dot(gradient) / gradient.length();
                // At a kink of a leaf its gradient is one of several; at a grazing ray t is ill-conditioned.
                if sine > 1e-3 && gradient.is_finite() && cosine.abs() > 0.999 {
                    let error = (value / slope).abs();
                    assert!(
                        error <= 1e-9 * (1.0 + crossing.t),
                        "tree {tree}, ray {k}: {error:e} at {crossing:?}, {value:e} {gradient} {:?}",
                        steps
                    );
                    assert!(
                        cosine.abs() > 1.0 - 1e-12,
                        "{crossing:?} has the gradient {gradient:?}"
                    );
                }
                let outward = crossing.normal.dot(ray.direction) < 0.0;
                assert_eq!(outward, crossing.entering);
                assert!((crossing.normal.length() - 1.0).abs() < 1e-12);
            }
        }
    }
    assert!(crossings_seen > 7_000, "{crossings_seen}");
}

#[test]
fn a_ray_that_leaves_a_surface_meets_the_rest_of_the_solid_and_nothing_else() {
    let mut random = Random(11);
    let variables = variables();
    let formulas = shapes(&variables);
    let graph = formulas[0].graph().clone();
    let mut left = 0;
    for tree in 0..60 {
        let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
        let ids: Vec<_> = formulas
            .iter()
            .map(|f| builder.shape(f.node(), [None; 3]).unwrap())
            .collect();
        let steps = random.tree(&ids, 6, 0.8);
        builder.solid(&steps).unwrap();
        let world = builder.build().unwrap();
        let mut caster = world.caster();
        for k in 0..40 {
            let direction = random.direction();
            let ray = Ray {
                origin: random.vector(1.0) - 5.0 * direction,
                direction,
                leaving: None,
            };
            let Some(hit) = caster.first(&ray) else {
                continue;
            };
            for _ in 0..4 {
                let onward = random.direction();
                // Nearly tangent rays stay near the surface, where rounding decides.
                let side = hit.normal.dot(onward);
                if side.abs() < 0.05 {
                    continue;
                }
                let ray = Ray {
                    origin: hit.position,
                    direction: onward,
                    leaving: Some(hit.surface),
                };
                let crossings = caster.cast(&ray).to_vec();
                left += 1;
                // Shortly after the start, membership is that of the side.
                let soon = crossings.first().map_or(1.0, |crossing| crossing.t);
                assert!(soon > 0.0);
                let inside = !caster.solids_at_start().is_empty();
                let point = ray.origin + 0.5 * soon * onward;
                assert!(
                    inside == world.contains(0, point) || !decided(&world, 0, point, 1.0),
                    "tree {tree}, ray {k}: {ray:?} {crossings:#?}"
                );
                let wrong = disagreements(&world, &ray, &crossings, inside, 8.0);
                assert_eq!(wrong, 0, "tree {tree}, ray {k}: {ray:?} {crossings:#?}");
            }
        }
    }
    assert!(left > 1000, "{left}");
}

/// A ray at a place near the origin: one of three begins there, the others before it.
fn ray_by(random: &mut Random, k: usize) -> Ray {
    let direction = random.direction();
    let back = if k.is_multiple_of(3) { 0.0 } else { 6.0 };
    Ray {
        origin: random.vector(1.2) - back * direction,
        direction,
        leaving: None,
    }
}

#[test]
fn endless_leaves_matter_only_where_their_sets_reach() {
    let mut random = Random(19);
    let variables = variables();
    let [x, y, z] = &variables;
    let sheet = (2.0 * x).sin() * (2.0 * y).cos() + (2.0 * y).sin() * (2.0 * z).cos() - 0.1 * z;
    let endless = [
        x + 0.2,
        x.squared() + y.squared() - 0.3,
        z - 0.3 * (3.0 * x).sin(),
        sheet.abs() - 0.3,
    ];
    let formulas: Vec<_> = endless.into_iter().chain(shapes(&variables)).collect();
    let graph = formulas[0].graph().clone();
    let (mut seen, mut clipped) = (0, 0);
    for tree in 0..30 {
        let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
        let ids: Vec<_> = formulas
            .iter()
            .map(|formula| builder.shape(formula.node(), [None; 3]).unwrap())
            .collect();
        // As many endless leaves as others.
        let ids: Vec<_> = [&ids[..4], &ids[..4], &ids[4..12]].concat();
        builder.solid(random.tree(&ids, 10, 1.0)).unwrap();
        let world = builder.build().unwrap();
        clipped += usize::from(world.bounds(0).is_some());
        let mut caster = world.caster();
        for k in 0..12 {
            let ray = ray_by(&mut random, k);
            let crossings = caster.cast(&ray).to_vec();
            let inside = !caster.solids_at_start().is_empty();
            seen += crossings.len();
            let wrong = disagreements(&world, &ray, &crossings, inside, 12.0);
            assert_eq!(wrong, 0, "tree {tree}, ray {k}: {ray:?}");
            for crossing in crossings.iter().filter(|crossing| crossing.t < 12.0) {
                let after = Ray {
                    origin: crossing.position,
                    direction: ray.direction,
                    leaving: Some(crossing.surface),
                };
                let onward = caster.cast(&after).first().map(|next| next.t);
                let next = crossings.iter().find(|next| next.t > crossing.t);
                let expected = next.map(|next| next.t - crossing.t);
                if let (Some(found), Some(expected)) = (onward, expected) {
                    let near = (found - expected).abs() <= 1e-7 * (1.0 + expected);
                    assert!(near || expected < NEAR, "{found}, not {expected}");
                }
            }
        }
    }
    assert!(seen > 300 && clipped > 8, "{seen}, {clipped}");
}

#[test]
fn sets_of_endless_leaves_are_bounded_by_what_they_share() {
    let mut random = Random(23);
    let variables = variables();
    let [x, y, z] = &variables;
    let cylinder = x.squared() + y.squared() - 1.0;
    let slab = z.abs() - 0.5;
    let (crossed, half) = (y.squared() + z.squared() - 1.0, x - 0.25 * y);
    let graph = cylinder.graph().clone();
    let lean = glam::DMat3::from_rotation_y(0.4);
    let maps = [glam::DAffine3::IDENTITY, glam::DAffine3::from_mat3(lean)];
    for map in maps {
        let world = |formulas: [&crate::formula::Formula; 3], join: [SetStep; 2], cut| {
            let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
            let mut leaf = |k: usize, cuts| {
                let shape = builder.shape(formulas[k].node(), cuts).unwrap();
                SetStep::Leaf(shape, map)
            };
            let leaves = [
                leaf(0, [None, None, cut]),
                leaf(1, [None; 3]),
                leaf(2, [None; 3]),
            ];
            let [a, b, c] = leaves;
            builder.solid([a, b, join[0], c, join[1]]).unwrap();
            builder.build().unwrap()
        };
        let (both, without) = (SetStep::Intersection, SetStep::Difference);
        let drum = world([&cylinder, &slab, &half], [both, without], None);
        let pillow = world([&cylinder, &crossed, &half], [both, both], None);
        // An intersection is looked into only where all of its operands reach: the slab alone has no end.
        let cut = world(
            [&slab, &cylinder, &half],
            [without, without],
            Some([0.0, 0.2]),
        );
        assert!(cut.bounds(0).is_none());
        for (world, half) in [(drum, [1.0, 1.0, 0.5]), (pillow, [1.0, 1.0, 1.0])] {
            let bounds = world.bounds(0).expect("a box");
            if map == glam::DAffine3::IDENTITY {
                let error = (bounds.upper - DVec3::from_array(half)).abs().max_element();
                assert!(error < 0.02, "{bounds:?}");
            }
            let mut caster = world.caster();
            let mut seen = 0;
            for k in 0..400 {
                let ray = ray_by(&mut random, k);
                let crossings = caster.cast(&ray).to_vec();
                let inside = !caster.solids_at_start().is_empty();
                seen += crossings.len();
                let wrong = disagreements(&world, &ray, &crossings, inside, 12.0);
                assert_eq!(wrong, 0, "ray {k}: {ray:?}");
            }
            assert!(seen > 200, "{seen}");
        }
    }
}

#[test]
fn bounded_sets_of_endless_leaves_have_boxes() {
    let variables = variables();
    let [x, y, z] = &variables;
    let graph_of = |f: &crate::formula::Formula| f.graph().clone();
    let turn = |axis: DVec3| glam::DAffine3::from_axis_angle(axis.normalize(), axis.length());
    let quarter = std::f64::consts::FRAC_PI_2;
    let identity = glam::DAffine3::IDENTITY;
    let (right, lean) = (turn(DVec3::X * quarter), turn(DVec3::X));
    let bar = x.abs().max(&y.abs()) - 1.0;
    let slab = x.abs() - 1.0;
    let disk = x.squared() + y.squared() - 1.0;
    let minus = |f: &crate::formula::Formula| f * -1.0;
    let everything = x.number(-1.0);
    let tilted = 1.7 * x;
    let triangle = minus(y).max(&(y - 1.0 + &tilted)).max(&(y - 1.0 - &tilted));
    let tetrahedron = (x + y + z - 1.0)
        .max(&(x - y - z - 1.0))
        .max(&(y - x - z - 1.0))
        .max(&(z - x - y - 1.0));
    let free = [None; 3];
    let cut = |k: usize, cut: [f64; 2]| {
        let mut cuts = free;
        cuts[k] = Some(cut);
        cuts
    };
    // The leaves of an intersection with their cuts and maps, and half the longest side of a box that is good enough.
    let cases = [
        (
            "a cone",
            vec![
                (x.squared() + y.squared() - z.squared(), free, identity),
                (everything.clone(), cut(2, [0.0, 1.0]), identity),
            ],
            1.1,
        ),
        (
            "bars",
            vec![(bar.clone(), free, identity), (bar.clone(), free, right)],
            1.1,
        ),
        (
            "slabs",
            vec![
                (slab.clone(), free, identity),
                (slab.clone(), free, turn(DVec3::Z * quarter)),
                (slab.clone(), free, turn(DVec3::Y * quarter)),
            ],
            1.1,
        ),
        (
            "cylinders",
            vec![(disk.clone(), free, identity), (disk.clone(), free, right)],
            1.1,
        ),
        (
            "leaning",
            vec![(disk.clone(), free, identity), (disk, free, lean)],
            2.0,
        ),
        (
            "a diamond",
            vec![
                ((x + y).abs() - 1.0, free, identity),
                ((x - y).abs() - 1.0, free, identity),
                (everything.clone(), cut(2, [0.0, 1.0]), identity),
            ],
            1.5,
        ),
        (
            "half-spaces",
            vec![
                (minus(x), free, identity),
                (minus(y), free, identity),
                (minus(z), free, identity),
                (x + y + z - 1.0, free, identity),
            ],
            1.0,
        ),
        (
            "a cap",
            vec![
                (x.squared() + y.squared() - z, free, identity),
                (z - 1.0 - 0.5 * x, free, identity),
            ],
            2.5,
        ),
        (
            "a cap in one",
            vec![(
                (x.squared() + y.squared() - z).max(&(z - 1.0 - 0.5 * x)),
                free,
                identity,
            )],
            2.5,
        ),
        (
            "a prism",
            vec![
                (triangle, free, right),
                (everything, cut(1, [-0.5, 0.5]), identity),
            ],
            1.0,
        ),
        ("a tetrahedron", vec![(tetrahedron, free, identity)], 1.5),
    ];
    let mut random = Random(29);
    for (name, leaves, most) in cases {
        let graph = graph_of(&leaves[0].0);
        let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
        let mut steps = Vec::new();
        for (k, (formula, cuts, map)) in leaves.iter().enumerate() {
            let shape = builder.shape(formula.node(), *cuts).unwrap();
            steps.push(SetStep::Leaf(shape, *map));
            if k > 0 {
                steps.push(SetStep::Intersection);
            }
        }
        builder.solid(steps).unwrap();
        let world = builder.build().unwrap();
        let Some(bounds) = world.bounds(0) else {
            panic!("{name} has no box")
        };
        let half = 0.5 * (bounds.upper - bounds.lower).max_element();
        assert!(half <= most, "{name}: {bounds:?}");
        // Nothing lies outside, and rays find what is inside.
        let mut caster = world.caster();
        for k in 0..200 {
            let at = random.vector(4.0);
            let is_in = at.cmpge(bounds.lower).all() && at.cmple(bounds.upper).all();
            assert!(is_in || !world.contains(0, at), "{name} at {at}");
            let ray = ray_by(&mut random, k);
            let crossings = caster.cast(&ray).to_vec();
            let inside = !caster.solids_at_start().is_empty();
            let wrong = disagreements(&world, &ray, &crossings, inside, 12.0);
            assert_eq!(wrong, 0, "{name}, ray {k}: {ray:?}");
        }
    }
}
