//! Worlds as tables: what is a component, and what has no place in them.

use expr::ops::{Binary, Unary};
use expr::{Graph, Input, NodeId};
use glam::{DAffine3, DVec3};
use tracer::tables::{PieceRow, SurfaceRow, TableError};
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
        let world = world(2, postfix);
        let (tables, _) = world.tables().expect("polynomials");
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
    let mut graph = Graph::default();
    let (round, x) = (round(&mut graph, 6), graph.input(Input::Variable(0)));
    let half = graph.binary(Binary::Max, round, x);
    let error = one(&graph, half)
        .tables()
        .map(|_| ())
        .expect_err("too high");
    assert_eq!(
        error,
        TableError::Degree {
            solid: 0,
            degree: 6
        }
    );
    let many = format!("z{}", "a\\".repeat(200));
    let many = world(2, &many);
    let error = many.tables().map(|_| ()).expect_err("too much");
    assert_eq!(error, TableError::TooManyNodes { solid: 0 });
}

/// A world of one leaf, in its place.
fn one(graph: &Graph, field: NodeId) -> World {
    let uniforms = |input| match input {
        Input::Uniform(k) => f64::from(k) + 0.5,
        Input::Variable(_) => f64::NAN,
    };
    let mut builder = WorldBuilder::new(graph, &uniforms);
    let shape = builder.shape(field, [None; 3]).expect("small");
    let leaf = SetStep::Leaf(shape, DAffine3::IDENTITY);
    builder.solid([leaf]).expect("a set");
    builder.build().expect("small")
}

#[test]
fn what_is_no_polynomial_of_low_degree_is_a_field() {
    let mut graph = Graph::default();
    let round = round(&mut graph, 6);
    let world_of_six = one(&graph, round);
    let (tables, fields) = world_of_six.tables().expect("a field");
    assert!(matches!(tables.pieces[0].surface, SurfaceRow::Field(0)));
    // The frame is a box that the set is in, hardly larger.
    let (half, middle) = (fields[0].half, fields[0].middle.abs());
    assert!((half - middle).min_element() >= 1.0, "{fields:?}");
    assert!((half + middle).max_element() < 1.2, "{fields:?}");
    // sin(x) − u₀ ≥ 0 within the ball: a polynomial and a negated field.
    let ball = self::round(&mut graph, 2);
    let [x, u] = [Input::Variable(0), Input::Uniform(0)].map(|input| graph.input(input));
    let wave = graph.unary(Unary::Sin, x);
    let wave = graph.sub(wave, u);
    let opposite = graph.unary(Unary::Neg, wave);
    let both = graph.binary(Binary::Max, ball, opposite);
    let cut = one(&graph, both);
    let (tables, fields) = cut.tables().expect("a field");
    let is_field = |row: &PieceRow| matches!(row.surface, SurfaceRow::Field(_));
    let pieces: Vec<&PieceRow> = tables.pieces.iter().filter(|row| is_field(row)).collect();
    assert_eq!((tables.pieces.len(), pieces.len(), fields.len()), (2, 1, 1));
    assert!(pieces[0].opposite);
    assert_eq!(fields[0].uniform(0), 0.5);
    let (own, root) = fields[0].expression();
    assert_eq!(own.inputs(&[root]).len(), 2);
}
