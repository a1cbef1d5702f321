//! Endless leaves: the digits of their crossings, whatever else is in the world.

use glam::{DAffine3, DVec3};
use tracer::{Ray, SetStep, WorldBuilder};

use crate::formula::{Formula, variables};
use crate::scenes::Random;

const BOTH: SetStep = SetStep::Intersection;

/// The greatest absolute value of the coordinates less those of a place.
fn cube([x, y, z]: &[Formula; 3], at: [f64; 3]) -> Formula {
    let [x, y, z] = [x - at[0], y - at[1], z - at[2]];
    x.abs().max(&y.abs()).max(&z.abs())
}

/// The crossings of the first of some solids, each of which is the join of its parts, with true where the ray enters.
fn crossings(join: SetStep, solids: &[Vec<&Formula>], rays: &[Ray]) -> Vec<Vec<(f64, bool)>> {
    let graph = solids[0][0].graph().clone();
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
    for parts in solids {
        let mut steps = Vec::new();
        for (k, part) in parts.iter().enumerate() {
            let shape = builder.shape(part.node(), [None; 3]).unwrap();
            steps.push(SetStep::Leaf(shape, DAffine3::IDENTITY));
            if k > 0 {
                steps.push(join);
            }
        }
        builder.solid(steps).unwrap();
    }
    let world = builder.build().unwrap();
    let mut caster = world.caster();
    let mut cast = |ray: &Ray| {
        let all = caster.cast(ray).iter();
        let of_first = all.filter(|crossing| crossing.solid == 0);
        of_first
            .map(|crossing| (crossing.t, crossing.entering))
            .collect()
    };
    rays.iter().map(&mut cast).collect()
}

fn ray(origin: [f64; 3], direction: [f64; 3]) -> Ray {
    Ray {
        origin: DVec3::from_array(origin),
        direction: DVec3::from_array(direction),
        leaving: None,
    }
}

#[test]
fn other_solids_take_no_digits_from_endless_ones() {
    let variables = variables();
    let [x, y, _] = &variables;
    let cubic = y.squared() - x.powi(3) + x;
    let column = x.squared() + y.squared() - 1.0;
    let fourth = x.powi(4) + y.powi(4) - 1.0;
    let mut random = Random(7);
    let through: Vec<Ray> = (0..40)
        .map(|_| {
            let d = random.vector(0.1);
            ray([-3.0, 0.3, 0.2], [1.0, d.y, d.z])
        })
        .collect();
    for solid in [&cubic, &column, &fourth] {
        let alone = crossings(BOTH, &[vec![solid]], &through);
        assert!(alone.iter().all(|found| !found.is_empty()));
        for size in [50.0, 500.0, 5e3, 5e4, 5e5] {
            let far = cube(&variables, [size, 0.0, 0.0]) - size;
            let beside = crossings(BOTH, &[vec![solid], vec![&far]], &through);
            for (alone, beside) in alone.iter().zip(&beside) {
                assert_eq!(alone.len(), beside.len(), "beside {size}");
                for ((t, _), (other, _)) in alone.iter().zip(beside) {
                    assert!(
                        (t - other).abs() <= 1e-14 * (1.0 + t),
                        "{t}, {other}: {size}"
                    );
                }
            }
        }
    }
    // y² = x³ − x along (1, 0.05, 0.02) from (−3, 0.3, 0.2), to 16 digits.
    let mut known = ray([-3.0, 0.3, 0.2], [1.0, 0.05, 0.02]);
    known.direction = known.direction.normalize();
    let found = &crossings(BOTH, &[vec![&cubic]], &[known])[0];
    let expected = [
        2.098_063_962_452_479_7,
        2.802_320_981_943_097_4,
        4.115_159_230_424_103,
    ];
    assert_eq!(found.len(), 3);
    for ((t, _), expected) in found.iter().zip(expected) {
        assert!((t - expected).abs() < 1e-14, "{t}, not {expected}");
    }
}

/// Rays through places near the origin, from some way before.
fn through(random: &mut Random, count: usize) -> Vec<Ray> {
    let mut ray = || {
        let origin = 9.0 * random.direction();
        Ray {
            origin,
            direction: random.vector(1.5) - origin,
            leaving: None,
        }
    };
    (0..count).map(|_| ray()).collect()
}

/// The rays whose crossings do not alternate, or that are inside a bounded solid at the start or at the end.
fn unpaired(found: &[Vec<(f64, bool)>]) -> usize {
    let is_paired = |crossings: &&Vec<(f64, bool)>| {
        let enters = crossings.iter().map(|(_, enters)| *enters);
        let alternates = enters
            .enumerate()
            .all(|(k, enters)| enters == k.is_multiple_of(2));
        alternates && crossings.len().is_multiple_of(2)
    };
    found.len() - found.iter().filter(is_paired).count()
}

#[test]
fn an_endless_field_is_searched_wherever_it_is_cut() {
    // Nothing bounds them along x and y: `rest` is the box of nothing, with the radius 1.
    let [x, y, z] = variables();
    let slab = |from: f64, to: f64| (&z - 0.5 * (from + to)).abs() - 0.5 * (to - from);
    let waves = |k: f64| (k * z.clone()).sin();
    let cases = [
        // 0.2 sin(1.5) sin(−1.5) − 0.1 < 0.
        (
            0.2 * (3.0 * x.clone()).sin() * (3.0 * y.clone()).sin() - 0.1,
            slab(200.0, 201.0),
            2,
        ),
        (waves(200.0), slab(20.0, 21.0), 64),
        (waves(100.0), slab(50.0, 51.0), 34),
        (&waves(1.0) + 0.5, slab(-1000.0, 1000.0), 638),
    ];
    for (k, (field, slab, count)) in cases.iter().enumerate() {
        let from = ray([0.5, -0.5, -2500.0], [0.0, 0.0, 1.0]);
        let found = crossings(BOTH, &[vec![field, slab]], &[from]);
        assert_eq!(unpaired(&found), 0, "{k}");
        assert_eq!(found[0].len(), *count, "{k}: {:?}", found[0].last());
    }
}

#[test]
fn cut_leaves_are_entered_and_left() {
    let variables = variables();
    let [x, y, z] = &variables;
    let mut random = Random(11);
    let slab = cube(&variables, [0.0; 3]) - 2.0;
    let down: Vec<Ray> = (0..500)
        .map(|_| {
            let (o, d) = (random.vector(0.6), random.vector(0.1));
            ray([o.x, o.y, 5.0], [d.x, d.y, -1.0])
        })
        .collect();
    let across: Vec<Ray> = (0..500)
        .map(|_| {
            let (o, d) = (random.vector(1.0), random.vector(0.1));
            ray([-5.0, 0.05 * o.y, o.z], [1.0, 0.1 * d.y, d.z])
        })
        .collect();
    let sheet = z * (x.squared() + y.squared() + 1.0);
    let bowl = x.squared() + y.squared() - z;
    for size in [30.0, 300.0, 1e4] {
        let ground = cube(&variables, [size, size, -20.0]) - size;
        let cases = [
            (sheet.clone(), &down),
            (bowl.clone(), &down),
            (x.powi(4) + y.powi(4) - 1.0, &across),
            (x.squared() + y.squared() - 1.0, &across),
        ];
        for (k, (leaf, rays)) in cases.iter().enumerate() {
            let found = crossings(BOTH, &[vec![leaf, &slab], vec![&ground]], rays);
            assert_eq!(unpaired(&found), 0, "{k}, {size}");
            assert!(found.iter().all(|crossings| crossings.len() == 2), "{k}");
        }
    }
    // Alone, at roots that are nearly multiple: none may be lost where rounding puts it outside of the leaf's box.
    let ball = x.squared() + y.squared() + z.squared() - 30.0;
    let thin = |half: f64| (y - 0.2).squared() - half * half;
    let leaves = [
        thin(1e-7),
        thin(1e-8),
        thin(1e-6),
        z.powi(3) + 1e-6 * z,
        z.powi(3),
        z.powi(3) * -1.0,
        z.squared() * z,
        z.powi(3) * (x.squared() + 1.0),
        z.powi(5),
        (0.5 * y - 0.2).squared(),
        z * z.sqrt(),
        z.squared() * z.sin(),
    ];
    let rays = through(&mut random, 500);
    for (k, leaf) in leaves.iter().enumerate() {
        let found = crossings(BOTH, &[vec![leaf, &ball]], &rays);
        assert_eq!(unpaired(&found), 0, "leaf {k}");
        let rest = crossings(SetStep::Difference, &[vec![&ball, leaf]], &rays);
        assert_eq!(unpaired(&rest), 0, "without leaf {k}");
    }
}

#[test]
fn large_solids_have_boxes() {
    let variables = variables();
    let [x, y, z] = &variables;
    for size in [1e3, 1e9, 3e12, 1e13, 1e15, 1e30] {
        let [a, b, c] = [x, y, z].map(|it| it * (1.0 / size));
        let field = a.squared() + b.squared().exp() + c.squared() - 2.0;
        let quartic = a.powi(4) + b.powi(4) + c.powi(4) - 1.0;
        let beside = cube(&variables, [0.0; 3]) - 0.5 * size;
        for solid in [&field, &quartic] {
            let rays = [ray([3.0 * size, 0.0, 0.0], [-1.0, 0.0, 0.0])];
            let found = crossings(BOTH, &[vec![solid], vec![&beside]], &rays);
            let [(enters, true), (leaves, false)] = found[0][..] else {
                panic!("{size}: {found:?}");
            };
            let [enters, leaves] = [enters, leaves].map(|t| t / size);
            assert!(
                (enters - 2.0).abs() + (leaves - 4.0).abs() < 1e-9,
                "{size}: {enters}, {leaves}"
            );
        }
    }
}
