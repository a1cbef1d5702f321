//! Worlds that nobody means: an answer within bounded time and memory, on a small stack.

use expr::ops::Unary;
use glam::{DAffine3, DMat3, DVec3};
use tracer::{BuildError, Ray, SetStep, WorldBuilder};

use crate::formula::{Formula, variables};
use crate::scenes::Random;

fn ray(x: f64) -> Ray {
    Ray {
        origin: DVec3::new(x, 0.05, -9.0),
        direction: DVec3::new(0.01, 0.02, 1.0),
        leaving: None,
    }
}

/// The numbers of crossings of some rays.
fn crossings(formula: &Formula) -> Vec<usize> {
    let graph = formula.graph().clone();
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
    let shape = builder.shape(formula.node(), [None; 3]).unwrap();
    builder
        .solid([SetStep::Leaf(shape, DAffine3::IDENTITY)])
        .unwrap();
    let world = builder.build().unwrap();
    let mut caster = world.caster();
    let rays = (0..4).map(|k| caster.cast(&ray(0.3 * f64::from(k))).len());
    rays.collect()
}

#[test]
fn fields_that_are_undefined_or_constant_or_jump_have_answers() {
    let [x, y, z] = &variables();
    let log = |f: &Formula| f.unary(Unary::Log);
    let nan = x.number(f64::NAN);
    let r2 = &(x.squared() + y.squared() + z.squared());
    assert_eq!(crossings(&nan), [0; 4]);
    assert_eq!(crossings(&(x * &nan)), [0; 4]);
    assert_eq!(crossings(&x.number(1.0)), [0; 4]);
    // Everything: inside from the start, never left.
    assert_eq!(crossings(&x.number(-1.0)), [0; 4]);
    assert_eq!(crossings(&(r2.sqrt() * 0.0 + 1.0)), [0; 4]);
    // Undefined inside the unit ball, outside otherwise.
    assert_eq!(crossings(&(log(&(r2 - 1.0)) * 0.0 + 1.0)), [0; 4]);
    // Inside beyond z = 0, where the root is defined: a surface without a zero.
    assert_eq!(crossings(&((z.sqrt() - 100.0).sin() * 0.001 - 1.0)), [1; 4]);
    // A jump: the sign of z.
    let jump = (z.unary(Unary::Sign) + 0.5).max(&(r2 - 4.0));
    assert_eq!(crossings(&jump)[0], 2);
    // A pole: 1/z is −∞ below zero.
    let pole = (x.number(1.0) / z).max(&(r2 - 4.0));
    assert_eq!(crossings(&pole)[0], 2);
    // Infinitely many crossings: bounded work.
    let wild = (x.number(1.0) / (z - 0.5)).sin().max(&(r2 - 4.0));
    assert!(crossings(&wild)[0] < 100_000);
    let wild = (1e9 * z).sin().max(&(r2 - 4.0));
    assert!(crossings(&wild)[0] < 100_000);
    // Overflow on the way.
    assert_eq!(crossings(&((r2 * 1e200).exp() - 1.0)), [0; 4]);
    let _ = crossings(&(r2.powi(12) * 1e-300 - 1e-310));
}

#[test]
fn a_factor_of_any_size_changes_no_crossing_and_no_normal() {
    let [x, y, z] = &variables();
    let sum = |n: i32| x.powi(n) + y.powi(n) + z.powi(n) - 1.0;
    // The last one is evaluated by its factors.
    let twelfth = (x.squared() + y.squared() + z.squared() - 1.0).powi(3) * sum(6);
    let faces = |formula: &Formula| -> Vec<(f64, DVec3)> {
        let graph = formula.graph().clone();
        let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
        let shape = builder.shape(formula.node(), [None; 3]).unwrap();
        builder
            .solid([SetStep::Leaf(shape, DAffine3::IDENTITY)])
            .unwrap();
        let world = builder.build().unwrap();
        let mut caster = world.caster();
        let crossings = caster.cast(&ray(0.1));
        crossings.iter().map(|it| (it.t, it.normal)).collect()
    };
    for f in [sum(2), sum(4), sum(6), twelfth] {
        let expected = faces(&f);
        assert!(!expected.is_empty());
        for exponent in [-300, -200, -160, -100, 100, 160, 200, 300] {
            let found = faces(&(&f * 10f64.powi(exponent)));
            assert_eq!(found.len(), expected.len(), "10^{exponent}");
            for ((t, normal), (known, direction)) in found.iter().zip(&expected) {
                assert!((t - known).abs() < 1e-14, "10^{exponent}: {t}");
                assert!(
                    (*normal - *direction).length() < 1e-13,
                    "10^{exponent}: {normal}"
                );
            }
        }
    }
}

#[test]
fn the_work_on_functions_is_limited_and_said_to_be() {
    const LIMIT: u64 = 1 << 20;
    let [x, y, z] = &variables();
    let r2 = &(x.squared() + y.squared() + z.squared());
    // The operations, the rays that are cut short, and the crossings of some rays.
    let cast = |formula: &Formula, limit: u64| {
        let graph = formula.graph().clone();
        let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
        let shape = builder.shape(formula.node(), [None; 3]).unwrap();
        let leaf = [SetStep::Leaf(shape, DAffine3::IDENTITY)];
        builder.solid(leaf).unwrap();
        let world = builder.build().unwrap();
        let mut caster = world.caster();
        caster.limit_fields(limit);
        let rays = (0..64).map(|k| caster.cast(&ray(0.03 * f64::from(k))).len());
        let crossings: Vec<usize> = rays.collect();
        (caster.operations(), caster.rays_cut_short(), crossings)
    };
    let ball = r2.sqrt() - 2.0;
    let (operations, cut_short, crossings) = cast(&ball, LIMIT);
    assert!(operations > 64 && operations < LIMIT, "{operations}");
    assert_eq!(cut_short, 0);
    assert_eq!(crossings, [2; 64]);
    let wild = (1e9 * z).sin().max(&(r2 - 4.0));
    let (operations, cut_short, crossings) = cast(&wild, LIMIT);
    // A ray that is under way when the work is used up ends soon.
    assert!(operations < 3 * LIMIT, "{operations}");
    assert!(cut_short > 32, "{cut_short}");
    assert!(crossings[63] < crossings[0], "{crossings:?}");
    assert_eq!(cast(&wild, LIMIT), (operations, cut_short, crossings));
}

#[test]
fn rays_that_are_none_meet_nothing() {
    let [x, y, z] = &variables();
    let ball = x.squared() + y.squared() + z.squared() - 1.0;
    let graph = ball.graph().clone();
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
    let shape = builder.shape(ball.node(), [None; 3]).unwrap();
    builder
        .solid([SetStep::Leaf(shape, DAffine3::IDENTITY)])
        .unwrap();
    let world = builder.build().unwrap();
    let mut caster = world.caster();
    for bad in [f64::NAN, f64::INFINITY] {
        let from = Ray {
            origin: DVec3::splat(bad),
            ..ray(0.0)
        };
        assert!(caster.cast(&from).is_empty());
        let along = Ray {
            direction: DVec3::new(0.0, bad, 1.0),
            ..ray(0.0)
        };
        assert!(caster.cast(&along).is_empty());
    }
    let still = Ray {
        direction: DVec3::ZERO,
        ..ray(0.0)
    };
    assert!(caster.cast(&still).is_empty());
    assert_eq!(caster.cast(&ray(0.0)).len(), 2);
}

#[test]
fn what_is_no_world_is_refused() {
    let [x, _, _] = &variables();
    let graph = x.graph().clone();
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
    let shape = builder.shape(x.node(), [None; 3]).unwrap();
    let leaf = SetStep::Leaf(shape, DAffine3::IDENTITY);
    let flat = SetStep::Leaf(shape, DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.0)));
    let nan = SetStep::Leaf(shape, DAffine3::from_translation(DVec3::NAN));
    for steps in [
        vec![],
        vec![leaf, leaf],
        vec![SetStep::Union],
        vec![leaf, SetStep::Union],
    ] {
        assert_eq!(builder.solid(&steps), Err(BuildError::Unbalanced(0)));
    }
    assert_eq!(builder.solid([flat]), Err(BuildError::SingularMap(0)));
    assert_eq!(builder.solid([nan]), Err(BuildError::SingularMap(0)));
    assert_eq!(builder.solid([leaf]), Ok(0));
}

#[test]
fn a_hundred_thousand_leaves_and_deep_nesting_are_built_and_cast_on_a_small_stack() {
    let run = || {
        let [x, y, z] = &variables();
        let ball = x.squared() + y.squared() + z.squared() - 1.0;
        let graph = ball.graph().clone();
        let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
        let shape = builder.shape(ball.node(), [None; 3]).unwrap();
        let mut random = Random(1);
        let mut leaf = |place: f64, size: f64| {
            let map = DAffine3::from_mat3_translation(
                DMat3::from_diagonal(DVec3::splat(size)),
                random.vector(place),
            );
            SetStep::Leaf(shape, map)
        };
        let count = 100_000;
        let mut union = vec![leaf(10.0, 0.05)];
        for _ in 1..count {
            union.extend([leaf(10.0, 0.05), SetStep::Union]);
        }
        builder.solid(&union).unwrap();
        // By turns, and from the right: a tree as deep as it has leaves.
        let mut deep: Vec<SetStep> = (0..20_000).map(|_| leaf(2.0, 1.0)).collect();
        for k in 0..deep.len() - 1 {
            deep.push([SetStep::Union, SetStep::Intersection, SetStep::Difference][k % 3]);
        }
        builder.solid(&deep).unwrap();
        let world = builder.build().unwrap();
        assert_eq!(world.leaf_count(), 120_000);
        let mut caster = world.caster();
        let mut crossings = 0;
        for k in 0..100 {
            let found = caster.cast(&ray(f64::from(k) * 0.05)).to_vec();
            let of_union = found.iter().filter(|crossing| crossing.solid == 0).count();
            crossings += found.len();
            assert!(of_union % 2 == 0);
        }
        assert!(crossings > 300, "{crossings}");
    };
    let thread = std::thread::Builder::new().stack_size(512 << 10).spawn(run);
    thread.unwrap().join().unwrap();
}

/// The work of reading a shape.
fn reading(formula: &Formula, cuts: [Option<[f64; 2]>; 3]) -> u64 {
    let graph = formula.graph().clone();
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN).with_work(1 << 40);
    builder.shape(formula.node(), cuts).unwrap();
    (1 << 40) - builder.work_left()
}

#[test]
fn the_work_of_reading_a_shape_is_as_large_as_what_is_read() {
    let [x, y, z] = &variables();
    let r2 = &(x.squared() + y.squared() + z.squared());
    let one = [None; 3];
    // A quadric has its box from its coefficients, a wave from a search that ends where a point lies inside.
    let ball = reading(&(r2 - 1.0), one);
    assert!(ball < 500, "{ball}");
    let wave = reading(&(&(r2 + &((7.0 * &(x * y)).sin() * 0.5)) - 1.0), one);
    assert!(wave < 30_000, "{wave}");
    let cut = reading(&(x.sin() + y.sin() + z.sin()), [Some([-3.0, 3.0]); 3]);
    assert!(cut < 5_000, "{cut}");
    let endless = reading(
        &(&(x.squared() + y.squared()) + &(z.sin() * 0.1 - 1.0)),
        one,
    );
    assert!(endless < 20_000, "{endless}");
    // A power has many terms, however short it is.
    let line = x + &(y * 2.0) + z * 3.0 + 1.0;
    let fourth = &line.squared().squared();
    let power = reading(&(&(fourth * fourth) * fourth - 1.0), one);
    assert!(power > 20 * ball, "{power}");
    // What is read once the work is used up takes none.
    let formula = r2 - 1.0;
    let graph = formula.graph().clone();
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN).with_work(ball + 1);
    assert!(builder.shape(formula.node(), one).is_ok());
    for _ in 0..2 {
        let read = builder.shape(formula.node(), one);
        assert_eq!(read.err(), Some(BuildError::TooMuchWork));
        assert_eq!(builder.work_left(), 0);
    }
}

#[test]
fn leaves_behind_the_first_surface_are_not_looked_for() {
    let [x, y, z] = &variables();
    let ball = x.squared() + y.squared() + z.squared() - 0.1;
    let graph = ball.graph().clone();
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
    let shape = builder.shape(ball.node(), [None; 3]).unwrap();
    let leaf = |k: u32| {
        let place = DAffine3::from_translation(DVec3::new(0.0, 0.0, f64::from(k)));
        SetStep::Leaf(shape, place)
    };
    let rest = (1..4096).flat_map(|k| [leaf(k), SetStep::Union]);
    let steps = [leaf(0)].into_iter().chain(rest);
    builder.solid(steps).unwrap();
    let world = builder.build().unwrap();
    let mut caster = world.caster();
    let along = Ray {
        direction: DVec3::Z,
        ..ray(0.1)
    };
    let mut work = |all: bool| {
        let before = caster.operations();
        let count = match all {
            true => caster.cast(&along).len(),
            false => usize::from(caster.first(&along).is_some()),
        };
        (count, caster.operations() - before)
    };
    let ((all, of_all), (first, of_first)) = (work(true), work(false));
    assert_eq!((all, first), (2 * 4096, 1));
    assert!(of_first < of_all / 100, "{of_first} of {of_all}");
}
