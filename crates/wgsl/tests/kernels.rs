//! Generated kernels: the text is pinned, everything validates, what is too large is refused.

use expr::ops::Operation;
use expr::{Graph, Input, NodeId};
use wgsl::{GenerateError, kernel};

fn sphere(graph: &mut Graph) -> [NodeId; 3] {
    let u = graph.input(Input::Variable(0));
    let v = graph.input(Input::Variable(1));
    let r = graph.input(Input::Uniform(7));
    let unary = |graph: &mut Graph, name: &str, x: NodeId| {
        let op = Operation::all()
            .find(|op| op.name() == name)
            .expect("in the table");
        op.build(graph, &[x]).expect("one operand")
    };
    let (cos_u, sin_u) = (unary(graph, "cos", u), unary(graph, "sin", u));
    let (cos_v, sin_v) = (unary(graph, "cos", v), unary(graph, "sin", v));
    let ring = graph.mul(r, cos_v);
    [
        graph.mul(ring, cos_u),
        graph.mul(ring, sin_u),
        graph.mul(r, sin_v),
    ]
}

#[test]
fn a_sphere_is_written_with_shared_subexpressions_once() {
    let mut graph = Graph::default();
    let position = sphere(&mut graph);
    let kernel = kernel::sample_surface(&graph, position).expect("a kernel");
    assert_eq!(kernel.uniforms(), [7]);
    assert_eq!(
        kernel.generated(),
        "\
fn surface_tangents(u: f32, v: f32, instance: u32) -> Tangents {
    let t0 = uniform_value(instance, 0u);
    let t1 = cos(u);
    let t2 = sin(u);
    let t3 = t0 * cos(v);
    let t4 = t1 * t3;
    let t5 = t2 * t3;
    let t6 = t0 * sin(v);
    return Tangents(
        vec3f(t4, t5, t6),
        vec3f(-t5, t4, 0.0),
        vec3f(-(t1 * t6), -(t2 * t6), t3),
    );
}
"
    );
}

#[test]
fn every_kind_of_kernel_of_a_sphere_validates() {
    let mut graph = Graph::default();
    let position = sphere(&mut graph);
    let v = graph.input(Input::Variable(1));
    let u = graph.input(Input::Variable(0));
    let zero = graph.constant(0.0);
    let fixed = graph
        .substitute(&position, &|input| {
            (input == Input::Variable(1)).then_some(zero)
        })
        .expect("small");
    let fixed = <[NodeId; 3]>::try_from(fixed).expect("three");
    kernel::sample_curve(&graph, fixed).expect("curve");
    let constant = graph
        .substitute(&fixed, &|input| {
            (input == Input::Variable(0)).then_some(zero)
        })
        .expect("small");
    let constant = <[NodeId; 3]>::try_from(constant).expect("three");
    kernel::sample_point(&graph, constant).expect("point");
    kernel::sample_vector(&graph, constant, constant).expect("vector");
    let surface = kernel::sample_surface(&graph, position).expect("surface");
    assert_eq!(surface.entry_point(), "sample_surface");
    kernel::evaluate(&graph, &[u, v, position[0]]).expect("evaluate");
}

#[test]
fn every_operation_of_the_table_validates_with_every_kind_of_operand() {
    let mut graph = Graph::default();
    let x = graph.input(Input::Variable(0));
    let y = graph.input(Input::Uniform(3));
    let sum = graph.add(x, y);
    let difference = graph.sub(x, y);
    let negative = graph.neg(x);
    let constant = graph.constant(-2.5);
    let huge = graph.constant(1e300);
    let undefined = graph.constant(f64::NAN);
    let operands = [x, sum, difference, negative, constant, huge, undefined];
    let mut roots = Vec::new();
    for operation in Operation::all().chain([-7, -3, 3, 4, 5, 1000].map(Operation::Power)) {
        for a in operands {
            for b in operands {
                let given = if operation.arity() == 1 {
                    vec![a]
                } else {
                    vec![a, b]
                };
                roots.extend(operation.build(&mut graph, &given));
            }
        }
    }
    let kernel = kernel::evaluate(&graph, &roots).unwrap_or_else(|error| panic!("{error}"));
    assert!(kernel.operations() > 100);
}

#[test]
fn subtraction_and_division_are_not_reassociated() {
    let mut graph = Graph::default();
    let [a, b, c] = [0, 1, 2].map(|k| graph.input(Input::Variable(k)));
    let right = graph.sub(b, c);
    let difference = graph.sub(a, right);
    let product = graph.mul(b, c);
    let quotient = graph.div(a, product);
    let negative = graph.neg(difference);
    let kernel = kernel::evaluate(&graph, &[quotient, negative]).expect("a kernel");
    let text = kernel.generated();
    assert!(text.contains("let t0 = input_value(row, 0u);"), "{text}");
    assert!(text.contains("t0 / (t1 * t2)"), "{text}");
    assert!(text.contains("-(t0 - (t1 - t2))"), "{text}");
}

#[test]
fn a_deep_expression_is_broken_up_and_a_huge_one_refused() {
    let mut graph = Graph::default();
    let mut x = graph.input(Input::Variable(0));
    for k in 0..10_000 {
        let c = graph.constant(f64::from(k) + 0.5);
        let shifted = graph.add(x, c);
        x = Operation::all()
            .find(|op| op.name() == "sin")
            .and_then(|op| op.build(&mut graph, &[shifted]))
            .expect("one operand");
    }
    let kernel = kernel::evaluate(&graph, &[x]).unwrap_or_else(|error| panic!("{error}"));
    assert!(kernel.source().lines().all(|line| line.len() < 400));
    for k in 0..20_000 {
        let c = graph.constant(f64::from(k) + 0.25);
        x = graph.sub(c, x);
    }
    let refused = kernel::evaluate(&graph, &[x]).unwrap_err();
    assert!(
        matches!(
            refused,
            GenerateError::TooLarge {
                operations: Some(_)
            }
        ),
        "{refused}"
    );
}
