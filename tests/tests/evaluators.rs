//! Every evaluator against the same cases: the f64 tape, its blocks of lanes, the samples that the software path
//! draws, and the generated WGSL on a GPU.

use expr::conformance::{Operation, cases};
use expr::tape::{Block, LANES, Registers, Tape};
use expr::{Graph, Input, NodeId};
use render::bounds::Bounds;
use render::point::WorldPoint;
use render::sample::{Samples, sample};
use scene::{ObjectId, Range, Scene, Shape};
use testing::close::{assert_close, close};
use testing::draw::{middle, scene};
use testing::examples;

/// Blocks and tape run the same operations: the same results to the last bit.
fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

/// The expression of a case over two variables.
fn expression(operation: Operation) -> (Graph, NodeId) {
    let mut graph = Graph::default();
    let a = graph.input(Input::Variable(0));
    let b = graph.input(Input::Variable(1));
    let root = operation.node(&mut graph, a, b);
    (graph, root)
}

/// The operands that the expression takes.
fn operands(graph: &Graph, root: NodeId, operands: [f64; 2]) -> Vec<f64> {
    let inputs = graph.inputs(&[root]);
    let pick = inputs.iter().map(|input| match input {
        Input::Variable(k) => operands[*k as usize],
        Input::Uniform(_) => f64::NAN,
    });
    pick.collect()
}

#[test]
fn tape_and_blocks_give_the_value_of_every_case() {
    let cases = cases();
    assert!(cases.len() > 500, "only {} cases", cases.len());
    let mut registers = Registers::default();
    for case in cases {
        let (graph, root) = expression(case.operation);
        let tape = Tape::new(&graph, &[root]);
        let row = operands(&graph, root, case.operands);
        let mut out = [0.0];
        tape.eval(&mut registers, &row, &mut out);
        assert!(
            same(out[0], case.expected) || close(out[0], case.expected, 1e-15),
            "{case:?}: the tape gives {:?}",
            out[0]
        );
        let columns: Vec<Block> = row.iter().map(|number| [*number; LANES]).collect();
        let mut blocks = [[0.0; LANES]];
        tape.eval_block(&mut registers, &columns, &mut blocks);
        for lane in blocks[0] {
            assert!(
                same(lane, out[0]),
                "{case:?}: a lane gives {lane:?}, the tape {:?}",
                out[0]
            );
        }
    }
}

/// WGSL promises sin and cos to 2⁻¹¹ only, so that is what is asked for: relative, absolute below 1.
const WGSL_TOLERANCE: f64 = 1.0 / 2048.0;

#[test]
fn generated_wgsl_gives_the_value_of_every_case() {
    let cases = cases();
    let mut operations: Vec<Operation> = Vec::new();
    for case in &cases {
        if !operations.contains(&case.operation) {
            operations.push(case.operation);
        }
    }
    let mut wrong = Vec::new();
    for operation in operations {
        let (graph, root) = expression(operation);
        let own: Vec<_> = cases
            .iter()
            .filter(|case| case.operation == operation)
            .collect();
        let rows: Vec<Vec<f32>> = own
            .iter()
            .map(|case| {
                let row = operands(&graph, root, case.operands);
                row.into_iter().map(|number| number as f32).collect()
            })
            .collect();
        let values = render::gpu::evaluate(&graph, &[root], &rows).unwrap_or_else(|error| {
            panic!(
                "{operation:?}: {error}. The tests need a Vulkan driver; without a GPU: \
                 apt-get install mesa-vulkan-drivers libvulkan1"
            )
        });
        for (case, value) in own.iter().zip(values) {
            let value = f64::from(value[0]);
            // What overflows f32 is no fault of the shader.
            let expected = f64::from(case.expected as f32);
            if !close(value, expected, WGSL_TOLERANCE) {
                wrong.push(format!(
                    "{operation:?}{:?}: {value:?}, not {expected:?}",
                    case.operands
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{} cases differ: {wrong:#?}", wrong.len());
}

/// Points of an object's domain, and its first instance's uniforms: values for each input of its expressions.
fn rows(scene: &Scene, shape: &Shape, uniforms: &[f64]) -> Vec<Vec<f64>> {
    let inputs = scene.graph.inputs(&shape.roots());
    let space = Range {
        min: -2.0,
        max: 2.0,
    };
    let domains: Vec<Range> = match shape {
        Shape::Solid(_) | Shape::Background(_) => vec![space; 3],
        shape => shape.domain().iter().map(|axis| axis.range).collect(),
    };
    let count = if domains.is_empty() { 1 } else { 50 };
    let mut rows = Vec::new();
    for k in 0..count {
        let row = inputs.iter().map(|input| match *input {
            Input::Uniform(index) => uniforms[index as usize],
            Input::Variable(index) => {
                // A low-discrepancy sequence, another irrational step for each parameter.
                const STEPS: [f64; 3] = [
                    0.618_033_988_749_895,
                    0.414_213_562_373_095,
                    0.732_050_807_568_877,
                ];
                let step = STEPS[index as usize % 3];
                let share = (f64::from(k) * step + 0.1).fract();
                // A geodesic on a solid reads the solid's field, over places in space.
                let range = *domains.get(index as usize).unwrap_or(&space);
                f64::from((range.min + share * (range.max - range.min)) as f32)
            }
        });
        rows.push(row.collect());
    }
    rows
}

#[test]
fn generated_wgsl_agrees_with_f64_on_every_example() {
    for example in examples::all() {
        let scene = scene(&example.source);
        let settings = middle(&scene);
        for object in &scene.objects {
            let uniforms: Vec<f64> = settings
                .first_instance(&scene, object)
                .into_iter()
                .map(|number| f64::from(number as f32))
                .collect();
            let roots = object.shape.roots();
            let rows = rows(&scene, &object.shape, &uniforms);
            let single: Vec<Vec<f32>> = rows
                .iter()
                .map(|row| row.iter().map(|number| *number as f32).collect())
                .collect();
            let values = render::gpu::evaluate(&scene.graph, &roots, &single)
                .unwrap_or_else(|error| panic!("{}, {}: {error}", example.name, object.name));
            let tape = Tape::new(&scene.graph, &roots);
            let mut registers = Registers::default();
            let mut out = vec![0.0; roots.len()];
            for (row, values) in rows.iter().zip(values) {
                tape.eval(&mut registers, row, &mut out);
                for (value, expected) in values.iter().zip(&out) {
                    let what = format!("{}, {} at {row:?}", example.name, object.name);
                    assert_close(&what, f64::from(*value), *expected, 2.0 * WGSL_TOLERANCE);
                }
            }
        }
    }
}

#[test]
fn tape_and_blocks_agree_on_every_example() {
    for example in examples::all() {
        let scene = scene(&example.source);
        let settings = middle(&scene);
        for object in &scene.objects {
            let uniforms = settings.first_instance(&scene, object);
            let roots = object.shape.roots();
            let rows = rows(&scene, &object.shape, &uniforms);
            let tape = Tape::new(&scene.graph, &roots);
            let mut registers = Registers::default();
            let mut columns = vec![[0.0; LANES]; tape.inputs().len()];
            for (lane, row) in rows.iter().enumerate() {
                for (column, number) in columns.iter_mut().zip(row) {
                    column[lane] = *number;
                }
            }
            let mut blocks = vec![[0.0; LANES]; roots.len()];
            tape.eval_block(&mut registers, &columns, &mut blocks);
            let mut out = vec![0.0; roots.len()];
            for (lane, row) in rows.iter().enumerate() {
                tape.eval(&mut registers, row, &mut out);
                for (block, value) in blocks.iter().zip(&out) {
                    assert!(
                        same(block[lane], *value),
                        "{}, {}",
                        example.name,
                        object.name
                    );
                }
            }
        }
    }
}

#[test]
fn the_samples_that_are_drawn_are_the_values_of_the_tape() {
    for example in examples::all() {
        let scene = scene(&example.source);
        let settings = middle(&scene);
        let placement = Bounds::of(&scene, &settings).placement;
        for (index, object) in scene.objects.iter().enumerate() {
            let is_sampled = !matches!(
                object.shape,
                Shape::Metric { .. } | Shape::Geodesic { .. } | Shape::Solid(_)
            );
            if !is_sampled {
                continue;
            }
            let samples = sample(&scene, &settings, ObjectId::new(index), &placement);
            let uniforms = settings.first_instance(&scene, object);
            // A position comes first.
            let roots = match &object.shape {
                Shape::Vector { direction, origin } => [*origin, *direction].concat(),
                shape => shape.roots(),
            };
            let tape = Tape::new(&scene.graph, &roots);
            let mut registers = Registers::default();
            let mut out = vec![0.0; tape.root_count()];
            let mut at = |variables: &[f64]| {
                let number = |input: &Input| match *input {
                    Input::Variable(v) => variables[v as usize],
                    Input::Uniform(u) => uniforms[u as usize],
                };
                let row: Vec<f64> = tape.inputs().iter().map(number).collect();
                tape.eval(&mut registers, &row, &mut out);
            };
            // Of the first instance: sample 17 of a curve, and of a surface the one in its fourth row.
            let position = match (&object.shape, &samples) {
                (Shape::Point { .. }, Samples::Points(list)) => {
                    at(&[]);
                    list[0].position
                }
                (Shape::Vector { .. }, Samples::Vectors(list)) => {
                    at(&[]);
                    list[0].origin
                }
                (Shape::Curve { domain, .. }, Samples::Curves { samples, .. }) => {
                    at(&[domain.value(17)]);
                    samples[17].position
                }
                (Shape::Surface { domain, .. }, Samples::Surfaces { samples, .. }) => {
                    at(&[domain[0].value(17), domain[1].value(3)]);
                    samples[3 * domain[0].count as usize + 17].position
                }
                _ => panic!("{}: samples of another kind", object.name),
            };
            let expected = placement.local(WorldPoint([out[0], out[1], out[2]])).0;
            for (value, expected) in position.iter().zip(expected) {
                let what = format!("{}, {}", example.name, object.name);
                assert_close(&what, f64::from(*value), expected, 1e-6);
            }
        }
    }
}
