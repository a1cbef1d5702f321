//! What programs mean: values of expressions, and the mistakes in meaning with their places.

use scene::geotrace::{Compilation, compile};
use scene::{Outcome, ParamValues, Value};
use syntax::diagnostic::{Diagnostic, Severity};

/// Compiles a program that has no errors.
fn sound(source: &str) -> Compilation {
    let compilation = compile(source);
    assert!(
        !compilation.has_errors(),
        "{source}: {:?}",
        compilation.diagnostics
    );
    compilation
}

fn outcome(source: &str, expression: &str) -> Outcome {
    let compilation = sound(source);
    let params = ParamValues::initial(compilation.scene.as_ref().unwrap());
    match compilation.evaluate(expression, &params) {
        Ok(evaluation) => evaluation.outcome,
        Err(diagnostics) => panic!("{source} {expression}: {diagnostics:?}"),
    }
}

/// The components of an expression's value; NaN for what is undefined.
fn components(source: &str, expression: &str) -> Vec<f64> {
    match outcome(source, expression) {
        Outcome::Single(Value::Number(number)) => vec![number.unwrap_or(f64::NAN)],
        Outcome::Single(Value::Vector(vector)) => {
            let numbers = vector.into_iter();
            numbers.map(|number| number.unwrap_or(f64::NAN)).collect()
        }
        other => panic!("{expression}: {other:?}"),
    }
}

fn assert_value(source: &str, expression: &str, expected: &[f64]) {
    let found = components(source, expression);
    let close = found.len() == expected.len()
        && found
            .iter()
            .zip(expected)
            .all(|(found, expected)| (found - expected).abs() <= 1e-14 * expected.abs().max(1.0));
    assert!(close, "{source} {expression}: {found:?}, not {expected:?}");
}

/// The errors of a program.
fn errors(source: &str) -> Vec<Diagnostic> {
    let mut diagnostics = compile(source).diagnostics;
    diagnostics.retain(|diagnostic| diagnostic.severity == Severity::Error);
    diagnostics
}

/// The one error of a program, held to its code, the text that it marks and its sentence.
#[track_caller]
fn assert_error(source: &str, code: &str, marked: &str, sentence: &str) -> Diagnostic {
    let errors = errors(source);
    assert_eq!(errors.len(), 1, "{source}: {errors:?}");
    let error = errors.into_iter().next().unwrap();
    assert_eq!(error.code.0, code, "{source}: {error:?}");
    assert_eq!(error.span.text(source), marked, "{source}: {error:?}");
    assert_eq!(error.message, sentence, "{source}");
    error
}

#[test]
fn operators_on_numbers_and_vectors_are_those_of_the_table() {
    let source = "define a = (1,2,3); define b = (4,5,6);";
    assert_value(source, "a + b", &[5.0, 7.0, 9.0]);
    assert_value(source, "a - b", &[-3.0, -3.0, -3.0]);
    assert_value(source, "-a", &[-1.0, -2.0, -3.0]);
    assert_value(source, "+a", &[1.0, 2.0, 3.0]);
    assert_value(source, "a b", &[32.0]);
    assert_value(source, "a * b", &[-3.0, 6.0, -3.0]);
    assert_value(source, "2a", &[2.0, 4.0, 6.0]);
    assert_value(source, "a*2", &[2.0, 4.0, 6.0]);
    assert_value(source, "a/2", &[0.5, 1.0, 1.5]);
    assert_value(source, "*a", &[14.0]);
    assert_value(source, "*3", &[9.0]);
    assert_value(source, "/4", &[0.25]);
    assert_value(source, "a_2", &[2.0]);
    assert_value(source, "(-2)^3", &[-8.0]);
    assert_value(source, "(1,2)(3,4)", &[11.0]);
    assert_value(source, "1/2 3", &[1.5]);
}

#[test]
fn functions_take_numbers_vectors_and_lists() {
    let source = "function N(x) = x/sqrt*x; function f(u,v) = (u, v, u v); function d(x,y) = x y;
                  function s(x) = x_1 + x_2;";
    assert_value(source, "N(3,4)", &[0.6, 0.8]);
    assert_value(source, "N(0,3,4)", &[0.0, 0.6, 0.8]);
    assert_value(source, "N(-5)", &[-1.0]);
    assert_value(source, "f(2,3)", &[2.0, 3.0, 6.0]);
    // One vector of dimension n.
    assert_value(
        &format!("{source} define a = (2,3);"),
        "f a",
        &[2.0, 3.0, 6.0],
    );
    // A list whose items are vectors.
    assert_value(source, "d((1,2,3),(4,5,6))", &[32.0]);
    assert_value(source, "d(((1,2,3),(4,5,6)))", &[32.0]);
    assert_value(source, "(d((1,2),3))_1", &[3.0]);
    assert_value(source, "s(3,4)", &[7.0]);
    assert_value(source, "sin^2 1 + cos^2 1", &[1.0]);
    assert_value(source, "d^2(3,4)", &[144.0]);
    assert_value(source, "id(1,2)", &[1.0, 2.0]);
}

#[test]
fn derivatives_are_exact_and_nest() {
    let source =
        "function f(u,v) = (sin u cos v, u^2v, v); function g(x) = x^3; function h(x) = (x, x^2);
                  curve c(t) = (cost, sint, t), t : [0, 1];";
    assert_value(source, "f_u(0,0)", &[1.0, 0.0, 0.0]);
    assert_value(source, "f_v(2,3)", &[-2_f64.sin() * 3_f64.sin(), 4.0, 1.0]);
    assert_value(
        source,
        "f_u_v(2,3)",
        &[-2_f64.cos() * 3_f64.sin(), 4.0, 0.0],
    );
    assert_value(source, "g'2", &[12.0]);
    assert_value(source, "g''2", &[12.0]);
    assert_value(source, "g_x 2", &[12.0]);
    assert_value(source, "g_x' 2", &[12.0]);
    assert_value(source, "h'3", &[1.0, 6.0]);
    assert_value(source, "c'0", &[0.0, 1.0, 1.0]);
    assert_value(source, "sin'0", &[1.0]);
    assert_value(source, "sin''2", &[-2_f64.sin()]);
    assert_value(source, "id'7", &[1.0]);
    assert_value(source, "g'^2 2", &[144.0]);
    // Domains do not bound functions.
    assert_value(source, "c 5", &[5_f64.cos(), 5_f64.sin(), 5.0]);
    // By the parameter first, then the argument: not the chain rule.
    assert_value(source, "g'(2 3)", &[108.0]);
    // The derivative of a body that applies a function is the chain rule.
    assert_value(
        "function g(x) = x^3; function k(x) = g(x^2);",
        "k'2",
        &[192.0],
    );
    assert_value("function p(x) = x^2;", "p'0", &[0.0]);
}

#[test]
fn arguments_are_substituted_all_at_once() {
    let source = "function f(x,y) = x - 2y; function g(x,y) = f(y,x);";
    assert_value(source, "g(1,10)", &[8.0]);
}

#[test]
fn what_is_undefined_has_no_value() {
    assert_eq!(outcome("", "0/0"), Outcome::Single(Value::Number(None)));
    assert_eq!(outcome("", "/0"), Outcome::Single(Value::Number(None)));
    assert_eq!(
        outcome("", "(1, log(-1))"),
        Outcome::Single(Value::Vector(vec![Some(1.0), None]))
    );
    assert_value("", "0^0", &[1.0]);
}

#[test]
fn params_open_at_their_minimum_and_grids_give_instances() {
    let source =
        "param a : [2, 3]; param T : [0,1],[5,6]; grid k : [0, 1, 3]; grid m : [0,1,2],[7,8,2];
                  define b = a + k;";
    assert_value(source, "a", &[2.0]);
    assert_value(source, "T", &[0.0, 5.0]);
    let Outcome::Instances(instances) = outcome(source, "2b") else {
        panic!("one value")
    };
    let values: Vec<_> = instances.iter().map(|instance| &instance.value).collect();
    assert_eq!(
        values,
        [4.0, 5.0, 6.0]
            .map(|number| Value::Number(Some(number)))
            .iter()
            .collect::<Vec<_>>()
    );
    assert_eq!(instances[1].grids, [("k".to_owned(), vec![0.5])]);
    let Outcome::Instances(instances) = outcome(source, "(k, m_2)") else {
        panic!("one value")
    };
    assert_eq!(instances.len(), 12);
    assert_eq!(
        instances[11].grids,
        [
            ("k".to_owned(), vec![1.0]),
            ("m".to_owned(), vec![1.0, 8.0])
        ]
    );

    let compilation = sound(source);
    let mut params = ParamValues::initial(compilation.scene.as_ref().unwrap());
    params
        .set(compilation.scene.as_ref().unwrap(), "k", &[0.5])
        .unwrap();
    let evaluation = compilation.evaluate("b", &params).unwrap();
    assert_eq!(
        evaluation.outcome,
        Outcome::Single(Value::Number(Some(2.5)))
    );
}

#[test]
fn objects_know_what_they_depend_on_directly_or_not() {
    let compilation = sound(
        "param r : [/2, 1]; param o : [0, 2pi]; param unused : [0, 1];
         curve c(t) = r(cost, sint, 0), t : [0, 2pi];
         grid k : [0, 2pi, 8];
         define k2 = k + o;
         point p = ck2;
         vector v = c'k2 @ p;
         surface s(u,v2) = (u, v2, 0), v2 : [2, 3, 7], u : [0, 1];",
    );
    let scene = compilation.scene.as_ref().unwrap();
    let of = |name: &str| {
        let object = scene.objects.iter().find(|object| object.name == name);
        let object = object.unwrap();
        let params = object
            .params
            .iter()
            .map(|id| &*scene.params[id.0 as usize].name);
        let grids = object
            .grids
            .iter()
            .map(|id| &*scene.grids[id.0 as usize].name);
        params.chain(grids).collect::<Vec<_>>()
    };
    assert_eq!(of("c"), ["r"]);
    assert_eq!(of("p"), ["r", "o", "k"]);
    assert_eq!(of("v"), ["r", "o", "k"]);
    assert_eq!(of("s"), [""; 0]);
    let scene::Shape::Surface {
        domain, parameters, ..
    } = &scene.objects[3].shape
    else {
        panic!("no surface")
    };
    assert_eq!(parameters, &["u", "v2"]);
    assert_eq!((domain[0].range.max, domain[0].count), (1.0, 100));
    assert_eq!((domain[1].range.max, domain[1].count), (3.0, 7));
    let params = ParamValues::initial(scene);
    assert_eq!(params.instance_count(scene, &scene.objects[1]), 8);
}

#[test]
fn what_is_read_counts_whether_or_not_the_value_changes_with_it() {
    let source = "grid k : [0, 1, 3]; param a : [0, 1]; function f(x) = 7; define z = 0k;
                  point p = (z, f(a), 0);";
    for expression in ["z", "k - k", "f k", "p"] {
        let Outcome::Instances(instances) = outcome(source, expression) else {
            panic!("{expression} has one value")
        };
        assert_eq!(instances.len(), 3, "{expression}");
    }
    assert_value(source, "f a", &[7.0]);
    // A derivative is what is left once it has been taken.
    assert_value("grid k : [0, 1, 3]; function g(x) = x + k;", "g'5", &[1.0]);
    let scene = sound(source).scene.unwrap();
    assert_eq!(
        (scene.objects[0].params.len(), scene.objects[0].grids.len()),
        (1, 1)
    );
}

#[test]
fn params_and_grids_are_capped() {
    let intervals = vec!["[0, 1]"; 10_000].join(",");
    assert_error(
        &format!("param a : {intervals}; param b : {intervals};"),
        "too-many-params",
        "b",
        "with `b` the params and grids have 20000 components, and the limit is 16384",
    );
}

#[test]
fn a_vector_stands_for_its_direction() {
    assert_value("vector v = (1,2,3) @ (4,5,6);", "v", &[1.0, 2.0, 3.0]);
}

#[test]
fn dimension_errors_mark_the_whole_operation() {
    let code = "dimension-mismatch";
    let marked = |source: &str, marked: &str| {
        let errors = errors(source);
        assert_eq!(errors.len(), 1, "{source}: {errors:?}");
        assert_eq!(errors[0].code.0, code);
        assert_eq!(errors[0].span.text(source), marked, "{source}");
        errors[0].message.clone()
    };
    let message = marked("define a = 1 + (1,2,3) + (1,2);", "1 + (1,2,3)");
    assert!(message.contains('3'), "{message}");
    let message = marked("define a = (1,2,3) - (1,2);", "(1,2,3) - (1,2)");
    assert!(message.contains('3') && message.contains('2'), "{message}");
    marked("define a = (1,2)*(3,4);", "(1,2)*(3,4)");
    marked("define a = 1/(3,4);", "1/(3,4)");
    marked("define a = /(3,4);", "/(3,4)");
    marked("define a = (3,4)^2;", "(3,4)^2");
    marked("define a = 2^(3,4);", "2^(3,4)");
    marked("define a = sin(3,4);", "sin(3,4)");
    marked("define a = sin'(3,4);", "sin'(3,4)");
    marked("define a = ((1,2),3);", "((1,2),3)");
    marked("define a = sin((1,2),3);", "((1,2),3)");
    marked("define a = (1,2) + ((1,2),3);", "((1,2),3)");
    marked("function f(x) = x; define a = f^(1,2) 3;", "f^(1,2) 3");
    let source = "define a = (1,2)_3;";
    let errors = errors(source);
    assert_eq!(errors[0].span.text(source), "(1,2)_3");
}

#[test]
fn independent_mistakes_of_one_expression_are_all_reported() {
    let errors = errors("define a = ((1,2)^2, 3 + (1,2), 4);");
    assert_eq!(errors.len(), 2, "{errors:?}");
}

#[test]
fn mistakes_in_a_body_mark_the_application_and_relate_the_body() {
    let source =
        "function f(x) = x + (1,2); function g(y) = 2f y; define a = 3 g(1); define b = f(3,4);";
    let errors = errors(source);
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert_eq!(errors[0].span.text(source), "g(1)");
    assert!(
        errors[0].message.starts_with("in `g`: "),
        "{}",
        errors[0].message
    );
    let related: Vec<_> = errors[0]
        .related
        .iter()
        .map(|place| place.span.text(source))
        .collect();
    assert_eq!(related, ["x + (1,2)", "f y"]);
}

#[test]
fn a_wrong_number_of_arguments_names_both_numbers() {
    let source = "function f(x,y) = x; define a = f(1,2,3);";
    let error = assert_error(
        source,
        "argument-count",
        "f(1,2,3)",
        "`f` takes 2 arguments, but 3 are given",
    );
    assert!(error.hint.unwrap().contains("`f(x,y)`"));
    assert_error(
        "function f(x,y) = x; define a = f 1;",
        "argument-count",
        "f 1",
        "`f` takes 2 arguments, but 1 is given",
    );
}

#[test]
fn ambiguous_derivatives_name_the_remedy() {
    let error = assert_error(
        "function f(x,y) = x; define a = f'(1,2);",
        "ambiguous-derivative",
        "f'",
        "`f'` does not specify by which of the 2 parameters of `f` to differentiate",
    );
    assert_eq!(
        error.hint.unwrap(),
        "write a partial derivative: `f_x` or `f_y`"
    );
    // Known whatever the function is applied to, so also reported if it never is.
    assert_error(
        "function f(x,y) = x; function g(t) = 2f'(t,t); define b = g 1;",
        "ambiguous-derivative",
        "f'",
        "`f'` does not specify by which of the 2 parameters of `f` to differentiate",
    );
    let error = assert_error(
        "function f(x) = *x; define a = f'(1,2);",
        "vector-derivative",
        "f'(1,2)",
        "a derivative is taken with respect to a number, but the parameter `x` of `f` is a vector of dimension 2 here",
    );
    assert!(error.hint.unwrap().contains("component"));
    assert_error(
        "function f(x, y) = x y; define a = f_y((1,2),(3,4));",
        "vector-derivative",
        "f_y((1,2),(3,4))",
        "a derivative is taken with respect to a number, but the parameter `y` of `f` is a vector of dimension 2 here",
    );
    // By the other parameter, which is a number.
    assert_value("function f(x, y) = x y^2;", "f_y((1,2),3)", &[6.0, 12.0]);
    errors("define a = id'(1,2);").pop().unwrap();
}

#[test]
fn intervals_are_constant_finite_and_in_order() {
    let not_constant = "interval-not-constant";
    assert_error(
        "param a : [0, 1]; param b : [a, 2];",
        not_constant,
        "[a, 2]",
        "an interval is constant, but the minimum of this one depends on the param `a`",
    );
    // Also where it goes through a define, and where the value does not depend on it.
    assert_error(
        "grid k : [0, 1, 3]; define a = 0k; grid b : [0, 2, 5 + a];",
        not_constant,
        "[0, 2, 5 + a]",
        "an interval is constant, but the count of this one depends on the grid `k`",
    );
    assert_error(
        "param a : [0, 1]; function f(x) = a x; param b : [0, f 1];",
        not_constant,
        "[0, f 1]",
        "an interval is constant, but the maximum of this one depends on the param `a`",
    );
    assert_error(
        "param a : [0/0, 1];",
        "interval-undefined",
        "[0/0, 1]",
        "the minimum of this interval is undefined",
    );
    assert_error(
        "param a : [0, /0];",
        "interval-undefined",
        "[0, /0]",
        "the maximum of this interval is infinite",
    );
    assert_error(
        "param a : [2, 1];",
        "interval-empty",
        "[2, 1]",
        "the minimum of this interval, 2, is not below its maximum, 1",
    );
    assert_error(
        "param a : [1, 1];",
        "interval-empty",
        "[1, 1]",
        "the minimum of this interval, 1, is not below its maximum, 1",
    );
    assert_error(
        "param a : [0, (1,2)];",
        "interval-not-number",
        "[0, (1,2)]",
        "the maximum of an interval is a number, not a vector of dimension 2",
    );
    assert_error(
        "grid k : [0, 1, 1.9];",
        "interval-count",
        "[0, 1, 1.9]",
        "an interval has at least 2 values, but the count of this one is 1.9",
    );
    assert_error(
        "grid k : [0, 1, 1e9];",
        "interval-count",
        "[0, 1, 1e9]",
        "the count of this interval is 1000000000, and the limit is 1000000",
    );
    // Each interval is checked, and a mistake inside an expression has its own place.
    let source = "param a : [2, 1], [0, 1 + (1,2)], [0, 1];";
    let marked: Vec<_> = errors(source)
        .iter()
        .map(|error| error.span.text(source))
        .collect();
    assert_eq!(marked, ["[2, 1]", "1 + (1,2)"]);
    let scene = sound("grid k : [0, 1, 2.9];").scene.unwrap();
    assert_eq!(scene.grids[0].axes[0].count, 2);
}

#[test]
fn tags_name_each_parameter_once() {
    let error = assert_error(
        "surface s(u,v) = (u,v,0), u : [0,1], u : [2,3], v : [0,1];",
        "duplicate-tag",
        "u",
        "the parameter `u` has two intervals",
    );
    assert_eq!(error.span.start, 37);
    assert_eq!(error.related[0].span.start, 26);
    assert_error(
        "surface s(u,v) = (u,v,0), u : [0,1];",
        "missing-interval",
        "v",
        "the parameter `v` has no interval",
    );
    // An unknown tag is one mistake, not two.
    let found = errors("surface s(u,v) = (u,v,0), u : [0,1], w : [0,1];");
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].code.0, "unknown-tag");
}

#[test]
fn curves_have_one_parameter_and_surfaces_two() {
    assert_error(
        "curve c(s,t) = (s,t,0), s : [0,1], t : [0,1];",
        "parameter-count",
        "s,t",
        "a curve has one parameter, but `c` has 2",
    );
    assert_error(
        "surface c(t) = (t,t,0), t : [0,1];",
        "parameter-count",
        "t",
        "a surface has two parameters, but `c` has 1",
    );
}

#[test]
fn what_is_drawn_lies_in_space() {
    let code = "not-in-space";
    assert_error(
        "point p = (1,2);",
        code,
        "(1,2)",
        "a point lies in space and needs 3 components, but this is a vector of dimension 2",
    );
    assert_error(
        "vector v = 1 @ (1,2,3);",
        code,
        "1",
        "a vector's direction lies in space and needs 3 components, but this is a number",
    );
    assert_error(
        "vector v = (1,2,3) @ (1,2,3,4);",
        code,
        "(1,2,3,4)",
        "a vector's origin lies in space and needs 3 components, but this is a vector of dimension 4",
    );
    assert_error(
        "curve c(t) = t, t : [0,1];",
        code,
        "t",
        "a curve lies in space and needs 3 components, but this is a number",
    );
    assert_error(
        "surface s(u,v) = (u,v), u : [0,1], v : [0,1];",
        code,
        "(u,v)",
        "a surface lies in space and needs 3 components, but this is a vector of dimension 2",
    );
}

#[test]
fn mistakes_in_a_curve_mark_the_operation_in_its_own_body() {
    let source = "curve c(t) = (t,t,t) + t, t : [0,1]; point p = c 1;";
    let errors = errors(source);
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert_eq!(errors[0].span.text(source), "(t,t,t) + t");
}

#[test]
fn uses_of_what_failed_are_silent() {
    for source in [
        "define a = 1 + (1,2); define b = a + 1; point p = (b, 0, a);",
        "define a = 1 + ; define b = a + (1,2); param c : [a, 2];",
        "function f(x = x; define b = f(1,2,3) + f'(2);",
        "param a : [2, 1]; param b : [a, 2]; define c = a + (1,2) + b;",
        "function f(x) = y; function g(x) = f x; define b = g 2;",
    ] {
        let errors = errors(source);
        assert_eq!(errors.len(), 1, "{source}: {errors:?}");
    }
}

#[test]
fn instances_and_samples_are_capped_at_the_object() {
    assert_error(
        "grid k : [0, 1, 10000], [0, 1, 10000]; point p = (k_1, k_2, 0);",
        "too-many-instances",
        "p",
        "`p` would be drawn 100000000 times, and the limit is 1000000: `k` has 100000000 values",
    );
    assert_error(
        "grid k : [0, 1, 300000]; curve c(t) = (t, k, 0), t : [0,1];",
        "too-many-samples",
        "c",
        "`c` has 30000000 samples; the limit is 20000000 in all",
    );
    assert_error(
        "surface s(u,v) = (u,v,0), u : [0,1,4000], v : [0,1,4000];
         surface r(u,v) = (u,v,1), u : [0,1,4000], v : [0,1,4000];",
        "too-many-samples",
        "r",
        "`r` has 16000000 samples, on top of the 16000000 of what is drawn above; the limit is 20000000 in all",
    );
    // What no grid reaches is drawn once.
    sound("grid k : [0, 1, 300000]; curve c(t) = (t, 0, 0), t : [0,1];");
}

#[test]
fn expressions_that_explode_are_one_clear_error() {
    let mut source = "function f0(x) = sin(x exp x) tan(x^2)/log x;".to_owned();
    for level in 1..=40 {
        source += &format!(
            "function f{level}(x) = f{}'(x) f{}(x^2 + 1);",
            level - 1,
            level - 1
        );
    }
    source += "define a = f40 2; define b = f40 3;";
    let errors = errors(&source);
    assert!(!errors.is_empty());
    assert!(
        errors
            .iter()
            .all(|error| error.code.0 == "expression-too-large"),
        "{errors:?}"
    );
}

#[test]
fn a_long_sum_of_numbers_takes_no_room() {
    let source = format!("define a = {};", vec!["1"; 1_100_000].join("+"));
    assert_value(&source, "a", &[1_100_000.0]);
}

#[test]
fn a_long_chain_of_functions_needs_no_recursion() {
    let mut source = "function f0(x) = x + 1;".to_owned();
    for level in 1..=3000 {
        source += &format!("function f{level}(x) = f{} x;", level - 1);
    }
    assert_value(&source, "f3000 1", &[2.0]);
}

#[test]
fn mistakes_in_an_evaluated_expression_have_places_in_its_own_text() {
    let compilation = sound("\nfunction f(x) = x + (1,2);");
    let params = ParamValues::initial(compilation.scene.as_ref().unwrap());
    let text = "2 f 1";
    let errors = compilation.evaluate(text, &params).unwrap_err();
    assert_eq!(errors.len(), 1);
    assert_eq!(errors[0].span.text(text), "f 1");
    assert_eq!(errors[0].related, []);
    assert_eq!(
        errors[0].hint.as_deref(),
        Some("line 2 of the program: here, in the body of `f`")
    );
    for text in ["", "1 +", "1 2)", "foo", "(1,2)+(1,2,3)", "t"] {
        assert!(compilation.evaluate(text, &params).is_err(), "{text}");
    }
    let warned = compilation.evaluate("sin 2 pi", &params).unwrap();
    assert!(
        warned
            .warnings
            .iter()
            .all(|warning| warning.severity != Severity::Error)
    );
}

#[test]
fn a_program_with_errors_has_no_scene_and_evaluates_nothing() {
    let compilation = compile("define a = 1 + (1,2); define b = 2;");
    assert!(compilation.scene.is_none());
    let params = ParamValues::initial(&scene::Scene::default());
    let errors = compilation.evaluate("b", &params).unwrap_err();
    assert_eq!(errors[0].code.0, "program-has-errors");
}

#[test]
fn an_empty_program_is_a_valid_one() {
    for source in ["", "  \n", "# nothing"] {
        let compilation = sound(source);
        let scene = compilation.scene.unwrap();
        assert_eq!(scene.objects.len(), 0);
        assert_eq!(scene.uniform_count, 0);
    }
}

#[test]
fn diagnostics_come_in_the_order_of_the_text() {
    let errors = errors("define a = 1 + (1,2); define b = ; define c = (1,2)^2; define d = foo;");
    let starts: Vec<_> = errors.iter().map(|error| error.span.start).collect();
    assert_eq!(errors.len(), 4);
    assert!(starts.is_sorted(), "{starts:?}");
}
