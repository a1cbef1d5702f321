//! Each shape alone.

use glam::DAffine3;
use tracer::{Ray, SetStep, WorldBuilder};

#[path = "../../expr/tests/formula/mod.rs"]
mod formula;
mod scenes;
use formula::variables;
use scenes::{LeafValue, Random, shapes};

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
