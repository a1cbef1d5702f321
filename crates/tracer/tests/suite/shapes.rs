//! Each shape alone.

use glam::{DAffine3, DVec3};
use tracer::{Ray, SetStep, WorldBuilder};

use crate::formula::{Formula, variables};
use crate::scenes::{LeafValue, Random, shapes};

#[test]
fn every_shape_has_its_class_its_box_and_exact_crossings() {
    let variables = variables();
    let formulas = shapes(&variables);
    let graph = formulas[0].graph().clone();
    let degrees = [2, 1, 2, 4, 4, 1, 4, 2, 2, 0, 6, 4].map(|d| (d > 0).then_some(d));
    let mut random = Random(3);
    for (k, formula) in formulas.iter().enumerate() {
        let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
        let id = builder.shape(formula.node(), [None; 3]).unwrap();
        let map = DAffine3::IDENTITY;
        builder.solid([SetStep::Leaf(id, map)]).unwrap();
        let world = builder.build().unwrap();
        assert_eq!(world.degree(0), degrees[k], "shape {k}");
        let bounds = world.bounds(0).expect("a box");
        assert!(
            bounds.lower.min_element() > -1.6 && bounds.upper.max_element() < 1.6,
            "shape {k}: {bounds:?}"
        );
        let mut value = LeafValue::new(&graph, formula.node(), &map);
        let mut caster = world.caster();
        let mut worst: f64 = 0.0;
        for _ in 0..2000 {
            let direction = random.direction();
            let origin = random.vector(1.0) - 5.0 * direction;
            let ray = Ray {
                origin,
                direction,
                leaving: None,
            };
            for crossing in caster.cast(&ray) {
                let (f, gradient) = value.at(crossing.position);
                let sine = (gradient.dot(direction) / gradient.length()).abs();
                if sine > 1e-2 && gradient.length() > 1e-3 {
                    let error = (f / gradient.dot(direction)).abs();
                    worst = worst.max(error);
                }
            }
        }
        // The sextic is nearly a double root along many rays.
        let most = if degrees[k] == Some(6) { 1e-10 } else { 1e-12 };
        assert!(worst < most, "shape {k}: {worst:e}");
    }
}

#[test]
fn a_solid_is_as_large_as_its_set() {
    let [x, y, z] = variables();
    let ball = x.squared() + y.squared() + z.squared() - 1.0;
    let cylinder = x.squared() + y.squared() - 0.25;
    let half = &z - 0.5;
    let graph = x.graph().clone();
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
    let leaves = [ball, cylinder, half].map(|formula| {
        let id = builder.shape(formula.node(), [None; 3]).unwrap();
        SetStep::Leaf(id, DAffine3::IDENTITY)
    });
    let [ball, cylinder, half] = leaves;
    let solids = [
        [ball, cylinder, SetStep::Difference],
        [half, ball, SetStep::Intersection],
        [ball, cylinder, SetStep::Union],
        [cylinder, ball, SetStep::Difference],
        [cylinder, half, SetStep::Intersection],
    ];
    for steps in &solids {
        builder.solid(steps).unwrap();
    }
    let world = builder.build().unwrap();
    for solid in 0..2 {
        let bounds = world.bounds(solid).expect("a box");
        assert!(bounds.lower.min_element() < -0.99 && bounds.upper.max_element() < 1.1);
    }
    for solid in 2..5 {
        assert_eq!(world.bounds(solid), None, "{solid}");
    }
}

#[test]
fn products_are_met_where_their_factors_are() {
    let [x, y, z] = &variables();
    let ball = &(x.squared() + y.squared() + z.squared() - 1.0);
    let cast = |formula: &Formula, cuts, from: [f64; 3], to: [f64; 3]| -> Vec<[f64; 4]> {
        let graph = formula.graph().clone();
        let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
        let shape = builder.shape(formula.node(), cuts).unwrap();
        let leaf = SetStep::Leaf(shape, DAffine3::IDENTITY);
        builder.solid([leaf]).unwrap();
        let world = builder.build().unwrap();
        let (origin, direction) = (DVec3::from_array(from), DVec3::from_array(to));
        let ray = Ray {
            origin,
            direction,
            leaving: None,
        };
        let mut caster = world.caster();
        let found = caster.cast(&ray).iter();
        found
            .map(|found| {
                let normal = found.normal;
                [found.t, normal.x, normal.y, normal.z]
            })
            .collect()
    };
    let free = [None; 3];
    let (from, along) = (
        [0.2, -0.3, 2.493_950_846_374_102_2],
        [0.85, 0.2, -3.011_892_059_694_605_3],
    );
    let expected = -from[2] / along[2];
    let minus = z * -1.0;
    for odd in [
        minus.powi(3),
        minus.powi(5),
        (2.0 * z).squared() * &minus,
        z.squared() * minus.min(&(z * -2.0)),
    ] {
        let found = cast(&odd, free, from, along);
        let [[t, ..]] = found[..] else {
            panic!("{found:?}")
        };
        assert!((t - expected).abs() <= 4e-16, "{t}, not {expected}");
    }
    assert_eq!(
        cast(&(ball * ball), free, from, along),
        Vec::<[f64; 4]>::new()
    );
    let cuts = [Some([-2.0, 2.0]), Some([-2.5, 1.5]), Some([-1.0, 3.0])];
    let rooted = (ball * -1.0) * (0.5 * z + 0.1) * (0.1 * y).sqrt();
    let found = cast(&rooted, cuts, [-1.235, 1.424, -0.951], [0.0, 0.0, 1.0]);
    let [t, x_slope, y_slope, z_slope] = found[0];
    assert!((t - 0.751).abs() < 1e-15, "{t}");
    let normal = DVec3::new(x_slope, y_slope, z_slope);
    assert!((normal + DVec3::Z).length() < 1e-15, "{normal}");
    let film = (1.5 * x + 2.0).sqrt() * (0.1 * y).squared();
    let (from, along) = (
        [
            -2.752_643_581_542_54,
            -3.897_035_132_923_405_4,
            0.096_882_413_174_596_67,
        ],
        [
            2.289_049_479_043_237,
            3.628_908_701_701_214_5,
            0.156_342_670_487_442_21,
        ],
    );
    assert_eq!(cast(&film, cuts, from, along), Vec::<[f64; 4]>::new());
}

#[test]
fn normals_are_those_of_the_surface_where_the_gradient_is_only_rounding() {
    // The heart is where A³ ≤ c·z³, so that its gradient is 0 at z = 0, and its surface is that of A − z·∛c.
    let [x, y, z] = &variables();
    let (xx, yy, zz) = (&x.squared(), &y.squared(), &z.squared());
    let heart = (xx + 2.25 * yy + zz - 1.0).powi(3) - (xx + 9.0 / 80.0 * yy) * z.powi(3);
    let graph = heart.graph().clone();
    for map in [
        DAffine3::IDENTITY,
        DAffine3::from_axis_angle(DVec3::new(1.0, 2.0, 0.5).normalize(), 0.7),
    ] {
        let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
        let shape = builder.shape(heart.node(), [None; 3]).unwrap();
        builder.solid([SetStep::Leaf(shape, map)]).unwrap();
        let world = builder.build().unwrap();
        let mut caster = world.caster();
        let heights = (0..100).map(|k| 10f64.powf(-8.0 + 0.07 * f64::from(k)));
        for height in heights.chain([0.0]).flat_map(|z| [-z, z]) {
            for across in [0.3, -0.5, 0.77, 0.01, -0.9] {
                let ray = Ray {
                    origin: map.transform_point3(DVec3::new(across, -4.0, height)),
                    direction: map.transform_vector3(DVec3::Y),
                    leaving: None,
                };
                let crossings = caster.cast(&ray);
                assert_eq!(crossings.len(), 2, "at {height}, {across}");
                for crossing in crossings {
                    let DVec3 { x, y, z } = map.inverse().transform_point3(crossing.position);
                    let root = (x * x + 9.0 / 80.0 * y * y).cbrt();
                    let slope = z / (3.0 * root * root);
                    let gradient = DVec3::new(
                        2.0 * x - slope * 2.0 * x,
                        4.5 * y - slope * 9.0 / 40.0 * y,
                        2.0 * z - root,
                    );
                    let expected = map.transform_vector3(gradient.normalize());
                    let off = crossing.normal.distance(expected);
                    assert!(off < 1e-5, "{off} at {height}, {across}: {crossing:?}");
                }
            }
        }
    }
}
