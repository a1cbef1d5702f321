//! Metrics and geodesics on the command line: what is traced on them, told of them, and refused.

use serde_json::Value;
use testing::binary::geotrace;
use testing::close::assert_close;

/// The document of a trace.
fn traced(program: &str, arguments: &[&str]) -> Value {
    let common = ["trace", "-", "--format", "json"];
    let run = geotrace(common.iter().chain(arguments))
        .input(program)
        .run();
    run.expect_status(0).json()
}

#[track_caller]
fn expect_end(document: &Value, expected: [f64; 2], tolerance: f64) {
    assert_eq!(document["status"], "complete");
    assert_eq!(document["position"], Value::Null);
    for (name, expected) in ["u", "v"].into_iter().zip(expected) {
        let found = document[name].as_f64().expect("a number");
        assert_close(name, found, expected, tolerance);
    }
}

const HALF_PLANE: &str = "metric h(x,y) = (1,0,1)/y^2, x : [-9,9], y : [0.001,50];";

#[test]
fn lines_of_the_half_plane_run_up_exponentially_and_along_half_circles() {
    let up = ["--from", "0,1", "--direction", "0,1", "--length", "3"];
    expect_end(&traced(HALF_PLANE, &up), [0.0, 3_f64.exp()], 1e-9);
    // From the top of the unit circle: (tanh t, sech t).
    let along = ["--from", "0,1", "--heading", "0", "--length", "2"];
    let expected = [2_f64.tanh(), 1.0 / 2_f64.cosh()];
    expect_end(&traced(HALF_PLANE, &along), expected, 1e-9);
}

#[test]
fn a_flat_torus_closes_in_both_directions() {
    let flat = "metric f(u,v) = (1,0,1), u : [0,1], v : [0,2];";
    let way = ["--from", "0.25,0.5", "--direction", "3,4", "--length", "5"];
    expect_end(&traced(flat, &way), [0.25, 0.5], 1e-9);
}

#[test]
fn every_line_of_zoll_s_surface_is_back_after_two_pi() {
    let zoll = "metric z(u,v) = ((1+(cosu)/2)^2, 0, sin^2u), u : [0,pi], v : [0,2pi];";
    for heading in ["10", "45", "80", "137"] {
        let way = ["--from", "1.2,3", "--heading", heading, "--length", "2pi"];
        expect_end(&traced(zoll, &way), [1.2, 3.0], 1e-8);
    }
}

#[test]
fn a_metric_is_found_by_its_name_and_a_geodesic_is_none() {
    let program = format!("{HALF_PLANE} geodesic g(t) : h = (1,0) @ (0,1), t : [0,1];");
    let way = ["--from", "0,1", "--heading", "90", "--length", "1"];
    let named = |name: &'static str| {
        let front = ["trace", "-", "--surface", name];
        geotrace(front.iter().chain(&way))
            .input(program.as_str())
            .run()
    };
    named("h").expect_status(0);
    let run = named("g");
    run.expect_status(2);
    run.expect_text("is a geodesic, not a surface, metric or solid");
    run.expect_text("its metric is `h`");
}

#[test]
fn explain_describes_metrics_and_geodesics() {
    let program = format!(
        "param o : [0,1]; grid k : [0,1,3];
         {HALF_PLANE} geodesic g(t) : h = (k,1) @ (o,1), t : [0,1,50];"
    );
    let run = geotrace(["explain", "-"]).input(program.as_str()).run();
    run.expect_status(0);
    run.expect_text("View geodesic:h");
    run.expect_text("metric h: ends of geodesics");
    run.expect_text("metric h: 1 instance");
    run.expect_text("geodesic g on h: 3 instances, 150 samples");
    run.expect_text("depends on o, k");
    let run = geotrace(["explain", "-", "--format", "json"]).input(program.as_str());
    let document = run.run().json();
    assert_eq!(document["views"][1]["geodesic"]["kind"], "metric");
    let derivatives = &document["views"][1]["geodesic"]["derivative_operations"];
    assert!(derivatives.as_u64().is_some_and(|count| count > 3));
    assert_eq!(document["intrinsic"][1]["on"], "h");
    assert_eq!(document["intrinsic"][1]["samples"], 150);
    assert_eq!(document["intrinsic"][0]["kind"], "metric");
}

#[test]
fn eval_gives_the_values_of_a_metric_and_of_a_geodesic() {
    let program = format!("{HALF_PLANE} geodesic g(t) : h = (1,0) @ (0,1), t : [0,1];");
    let run = geotrace(["eval", "-", "h(1,2)"])
        .input(program.as_str())
        .run();
    run.expect_status(0);
    run.expect_text("(0.25, 0, 0.25)");
    // The unit half-circle (tanh t, 1/cosh t).
    let run = geotrace(["eval", "-", "g(1)"])
        .input(program.as_str())
        .run();
    run.expect_status(0);
    let place = run.stdout.trim().trim_matches(['(', ')']);
    let place: Vec<f64> = place
        .split(", ")
        .map(|number| number.parse().expect("a number"))
        .collect();
    let wanted = [1_f64.tanh(), 1.0 / 1_f64.cosh()];
    assert_eq!(place.len(), 2);
    for (found, wanted) in place.iter().zip(wanted) {
        assert!((found - wanted).abs() < 1e-9, "{found} is not {wanted}");
    }
}

#[test]
fn a_degenerate_metric_is_warned_of_and_still_checks() {
    let program = "metric h(u,v) = (u, 0, 1), u : [-1, 1], v : [0, 1];\n";
    let run = geotrace(["check", "-"]).input(program).run();
    run.expect_status(0);
    run.expect_text("warning[degenerate-metric]");
}
