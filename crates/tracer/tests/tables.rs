//! Worlds as tables: what is a component, and what has no place in them.

use expr::{Graph, Input, NodeId};
use glam::{DAffine3, DVec3};
use tracer::tables::TableError;
use tracer::{SetStep, World, WorldBuilder};

/// Σ xⁿ − 1.
fn round(graph: &mut Graph, power: u32) -> NodeId {
    let mut sum = graph.constant(-1.0);
    let power = graph.constant(power.into());
    for k in 0..3 {
        let x = graph.input(Input::Variable(k));
        let x = graph.power(x, power);
        sum = graph.add(sum, x);
    }
    sum
}

/// A world of one solid; a letter stands for a ball at its place in the alphabet.
fn world(power: u32, postfix: &str) -> World {
    let mut graph = Graph::default();
    let round = round(&mut graph, power);
    let no_uniforms = |_| f64::NAN;
    let mut builder = WorldBuilder::new(&graph, &no_uniforms);
    let ball = builder.shape(round, [None; 3]).expect("small");
    let steps: Vec<SetStep> = postfix
        .chars()
        .map(|letter| match letter {
            '|' => SetStep::Union,
            '&' => SetStep::Intersection,
            '\\' => SetStep::Difference,
            letter => {
                let x = f64::from(letter as u32 - 'a' as u32);
                SetStep::Leaf(ball, DAffine3::from_translation(x * DVec3::X))
            }
        })
        .collect();
    builder.solid(&steps).expect("a set");
    builder.build().expect("small")
}

#[test]
fn the_parts_of_a_union_are_components() {
    for (postfix, leaves) in [
        ("a", &[1][..]),
        ("ab|c|", &[1, 1, 1]),
        ("abc||", &[1, 1, 1]),
        ("ab|c\\", &[3]),
        ("abc|&", &[3]),
        ("ab&cd\\|", &[2, 2]),
        ("ab|cd|&e|", &[4, 1]),
        ("abc\\\\", &[3]),
    ] {
        let tables = world(2, postfix).tables().expect("polynomials");
        let counts: Vec<u32> = tables.components.iter().map(|it| it.leaf_count).collect();
        assert_eq!(counts, leaves, "{postfix}");
        assert_eq!(tables.endless, 0, "{postfix}");
        assert_eq!(tables.order.len(), leaves.len(), "{postfix}");
        for (component, nodes) in tables.components.iter().zip(1..) {
            let first = component.first_node as usize;
            assert!(tables.nodes[first].parent.is_none(), "{postfix}, {nodes}");
        }
        let all: u32 = tables.components.iter().map(|it| it.node_count).sum();
        assert_eq!(all as usize, tables.nodes.len(), "{postfix}");
    }
}

#[test]
fn what_is_too_high_or_too_much_has_no_tables() {
    assert!(world(4, "a").tables().is_ok());
    let error = world(6, "a").tables().expect_err("too high");
    assert_eq!(
        error,
        TableError::Degree {
            solid: 0,
            degree: 6
        }
    );
    let many = format!("z{}", "a\\".repeat(200));
    let error = world(2, &many).tables().expect_err("too much");
    assert_eq!(error, TableError::TooManyNodes { solid: 0 });
}
