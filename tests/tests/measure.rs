//! `geotrace measure` by the binary: its documents against closed forms, its texts, its errors.

use std::f64::consts::{PI, TAU};

use serde_json::Value;
use testing::binary::{Run, geotrace};
use testing::close::assert_close;

const SPHERE: &str =
    "surface s(u,v) = (cos v cos u, cos v sin u, sin v), u : [0, 2pi], v : [-pi/2, pi/2];";
const HALF_PLANE: &str = "metric h(x,y) = (1, 0, 1)/y^2, x : [-20, 20], y : [1/10, 10];";
const TORUS: &str = "param r : [0.4, 1];
surface s(u,v) = ((2 + r cos v) cos u, (2 + r cos v) sin u, r sin v), u : [0, 2pi], v : [0, 2pi];";

fn measure(program: &str, arguments: &str) -> Run {
    geotrace(["measure", "-"])
        .arguments(&arguments.split_whitespace().collect::<Vec<_>>())
        .input(program)
        .run()
}

#[track_caller]
fn document(program: &str, arguments: &str) -> Value {
    let run = measure(program, &format!("{arguments} --format json"));
    run.expect_status(0).json()
}

#[track_caller]
fn number(document: &Value, key: &str) -> f64 {
    document[key]
        .as_f64()
        .unwrap_or_else(|| panic!("no number `{key}` in {document}"))
}

fn keys(document: &Value) -> Vec<&String> {
    document
        .as_object()
        .map(|object| object.keys().collect())
        .unwrap_or_default()
}

#[test]
fn a_point_is_at_the_distance_0_from_itself_without_a_loop() {
    let plane = "surface s(u,v) = (u, v, 0), u : [0, 1], v : [0, 1];";
    let run = measure(plane, "--between 0.5,0.5 0.5,0.5");
    run.expect_status(0)
        .expect_text("distance 0\nno loop of length at most");
    let found = document(plane, "--between 0.5,0.5 0.5,0.5");
    assert_close("distance", number(&found, "distance"), 0.0, 0.0);
}

#[test]
fn a_place_has_its_curvatures_and_its_first_form() {
    let found = document(TORUS, "--at 0,pi/3 --set r=1");
    assert_eq!(keys(&found), ["E", "F", "G", "H", "K", "principal"]);
    // The tube's own curvature, and that of the circles about the axis.
    for (k, (curvature, direction)) in [(-0.5 / 2.5, [0.4, 0.0]), (-1.0, [0.0, 1.0])]
        .into_iter()
        .enumerate()
    {
        let found = &found["principal"][k];
        assert_close("k", number(found, "curvature"), curvature, 1e-14);
        for (n, expected) in direction.into_iter().enumerate() {
            let found = found["direction"][n].as_f64().expect("a number");
            assert_close("along", found.abs(), expected, 1e-14);
        }
    }
    // K = cos v/(r(2 + r cos v)); the normal σu × σv points outwards.
    assert_close("K", number(&found, "K"), 0.5 / 2.5, 1e-14);
    assert_close(
        "H",
        number(&found, "H"),
        -(2.0 + 2.0 * 0.5) / (2.0 * 2.5),
        1e-14,
    );
    assert_close("E", number(&found, "E"), 6.25, 1e-14);
    assert_close("F", number(&found, "F"), 0.0, 1e-14);
    assert_close("G", number(&found, "G"), 1.0, 1e-14);
    let metric = document(HALF_PLANE, "--at 0,2 --surface h");
    assert_close("K", number(&metric, "K"), -1.0, 1e-13);
    assert_eq!(metric["H"], Value::Null);
    let pole = document(SPHERE, "--at 0,pi/2");
    assert_close("K", number(&pole, "K"), 1.0, 1e-9);
}

#[test]
fn a_circle_has_its_circumference_and_area() {
    let found = document(SPHERE, "--at 1,0.5 --circle 1");
    assert_eq!(
        keys(&found),
        [
            "area",
            "circumference",
            "error_estimate",
            "error_estimates",
            "overlaps"
        ]
    );
    let bound = number(&found, "error_estimate");
    assert!(bound < 1e-8, "{found}");
    let errors = &found["error_estimates"];
    let larger = number(errors, "area").max(number(errors, "circumference"));
    assert_eq!(larger, bound);
    assert_close(
        "length",
        number(&found, "circumference"),
        TAU * 1.0_f64.sin(),
        bound,
    );
    assert_close(
        "area",
        number(&found, "area"),
        TAU * (1.0 - 1.0_f64.cos()),
        bound,
    );
    assert_eq!(found["overlaps"], false);
    assert_eq!(document(SPHERE, "--at 1,0.5 --circle 4")["overlaps"], true);
    // Rays that end.
    let ended = document(HALF_PLANE, "--at 0,1 --circle 5");
    for key in [
        "area",
        "circumference",
        "error_estimate",
        "error_estimates",
        "overlaps",
    ] {
        assert_eq!(ended[key], Value::Null, "{ended}");
    }
    let note = ended["note"].as_str().unwrap_or_default();
    assert!(note.contains("leaves the domain"), "{ended}");
    // The angle is that of the ray with the stated length: it meets the edge at a distance of 0.1.
    let square = "surface s(u, v) = (u, v, 0), u : [-1, 1], v : [-1, 1];";
    let ended = document(square, "--at 0.9,0 --circle 0.5");
    let note = ended["note"].as_str().unwrap_or_default();
    let between = |before: &str, behind: &str| -> f64 {
        let rest = note.split_once(before).expect(note).1;
        rest.split_once(behind).expect(note).0.parse().expect(note)
    };
    let (angle, length) = (between("the ray ", "°"), note.rsplit(' ').next());
    let length: f64 = length.and_then(|it| it.parse().ok()).expect(note);
    assert_close("length", length * angle.to_radians().cos(), 0.1, 1e-6);
}

#[test]
fn two_places_have_their_geodesics() {
    let found = document(SPHERE, "--between 0,0 1,0 --within 2pi");
    assert_eq!(keys(&found), ["distance", "geodesics", "within"]);
    assert_close("distance", number(&found, "distance"), 1.0, 1e-9);
    assert_close("within", number(&found, "within"), TAU, 1e-12);
    let geodesics = found["geodesics"].as_array().expect("a list");
    assert_eq!(geodesics.len(), 2, "{found}");
    assert_eq!(keys(&geodesics[0]), ["direction", "length"]);
    assert_close("length", number(&geodesics[0], "length"), 1.0, 1e-9);
    assert_close("length", number(&geodesics[1], "length"), TAU - 1.0, 1e-9);
    let direction: Vec<f64> =
        serde_json::from_value(geodesics[0]["direction"].clone()).expect("two");
    assert_close("a", direction[0], 1.0, 1e-9);
    assert_close("b", direction[1], 0.0, 1e-9);
    // Twice the shortest, unless told otherwise.
    let found = document(SPHERE, "--between 0,0 1,0");
    assert_eq!(
        found["geodesics"].as_array().map(Vec::len),
        Some(1),
        "{found}"
    );
    let family = document(SPHERE, "--between 0,0.3 pi,-0.3");
    assert_eq!(
        family["geodesics"].as_array().map(Vec::len),
        Some(1),
        "{family}"
    );
    assert_eq!(family["geodesics"][0]["conjugate"], true);
    assert_close(
        "length",
        number(&family["geodesics"][0], "length"),
        PI,
        1e-8,
    );
    // A torus that lies flat, by its lattice.
    let flat = "metric t(u,v) = (1, 0, 1), u : [0, 1], v : [0, 1];";
    let found = document(flat, "--between 0.1,0.1 0.6,0.6 --within 1.6");
    let lengths: Vec<f64> = found["geodesics"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|it| number(it, "length"))
        .collect();
    let [near, far] = [0.5_f64.sqrt(), 2.5_f64.sqrt()];
    assert_eq!(lengths.len(), 12, "{lengths:?}");
    for (n, length) in lengths.iter().enumerate() {
        assert_close("length", *length, if n < 4 { near } else { far }, 1e-9);
    }
    let none = document(HALF_PLANE, "--between -19,0.2 19,0.2 --within 3");
    assert_eq!(
        none["geodesics"].as_array().map(Vec::len),
        Some(0),
        "{none}"
    );
    assert!(
        none["note"]
            .as_str()
            .is_some_and(|it| it.contains("no geodesic")),
        "{none}"
    );
}

#[test]
fn a_triangle_has_sides_angles_and_an_area() {
    let found = document(SPHERE, "--triangle 0,pi/2 0,0 pi/2,0");
    assert_eq!(
        keys(&found),
        [
            "angles",
            "area",
            "error_estimate",
            "error_estimates",
            "excess",
            "integral_K",
            "sides"
        ]
    );
    for k in 0..3 {
        assert_close(
            "side",
            found["sides"][k].as_f64().expect("a side"),
            PI / 2.0,
            1e-9,
        );
        assert_close(
            "angle",
            found["angles"][k].as_f64().expect("an angle"),
            PI / 2.0,
            1e-9,
        );
    }
    let bound = number(&found, "error_estimate");
    assert!(bound < 1e-7, "{found}");
    for key in ["area", "excess", "integral_K"] {
        assert_close(key, number(&found, key), PI / 2.0, bound);
    }
    // Side k lies opposite corner k.
    let plane = "surface s(u,v) = (u, v, 0), u : [-5, 5], v : [-5, 5];";
    let found = document(plane, "--triangle 0,0 3,0 0,4");
    for (k, side) in [5.0, 4.0, 3.0].into_iter().enumerate() {
        assert_close(
            "side",
            found["sides"][k].as_f64().expect("a side"),
            side,
            1e-9,
        );
    }
    assert_close("area", number(&found, "area"), 6.0, 1e-7);
    let around = document(TORUS, "--triangle 0,0 0,2 0,4");
    assert_eq!(around["area"], Value::Null, "{around}");
    assert_eq!(around["integral_K"], Value::Null, "{around}");
    assert!(
        around["note"]
            .as_str()
            .is_some_and(|it| it.contains("handle")),
        "{around}"
    );
}

#[test]
fn human_output_is_in_sentences() {
    for (arguments, words) in [
        ("--at 0,0", "Gaussian curvature  K = 1"),
        ("--at 0,0 --circle 1", "it does not overlap itself"),
        ("--between 0,0 1,0", "distance 1"),
        // Geodesics from a place to itself are loops.
        ("--between 1,0 1,0", "distance 0; 2 loops"),
        // Both names are those of one place.
        ("--between 0,0 2pi,0", "distance 0; 2 loops"),
        ("--between 0,pi/2 1,pi/2", "distance 0; "),
        // A pole lies on all meridians.
        ("--between 0,pi/2 1,0", "in (u, v) from (1, "),
        ("--triangle 0,0 1,0 0,1", "angle excess"),
    ] {
        measure(SPHERE, arguments)
            .expect_status(0)
            .expect_text(words);
    }
    let smallest = measure(SPHERE, "--at 0,0 --circle 1e-300");
    assert!(!smallest.stdout.contains("NaN"), "{}", smallest.stdout);
    measure(HALF_PLANE, "--at 0,1").expect_text("a metric has no embedding");
    measure(HALF_PLANE, "--at 0,1 --circle 5")
        .expect_status(0)
        .expect_text("circle of this radius is not complete");
}

#[test]
fn a_measure_that_is_not_to_be_had_is_an_error_with_a_reason() {
    for (program, arguments, status, words) in [
        (HALF_PLANE, "--at 0,0", 2, "outside the domain"),
        (HALF_PLANE, "--between 0,1 0,11", 2, "outside the domain"),
        (
            HALF_PLANE,
            "--triangle 0,1 0,2 1,99",
            2,
            "outside the domain",
        ),
        (
            SPHERE,
            "--at 0,0 --surface q",
            2,
            "declares no surface or metric `q`",
        ),
        (
            "curve c(t) = (t, 0, 0), t : [0, 1];",
            "--at 0,0",
            2,
            "declares no surface",
        ),
        (
            "curve c(t) = (t, 0, 0), t : [0, 1];",
            "--at 0,0 --surface c",
            2,
            "not a surface",
        ),
        (SPHERE, "--at 0,0 --circle -1", 2, "not greater than 0"),
        (SPHERE, "--circle 1", 2, "--at"),
        (SPHERE, "--between 0,0 1,1 --circle 1", 2, "--circle"),
        (SPHERE, "--within 1 --at 0,0", 2, "cannot be used with"),
        (SPHERE, "--within 1", 2, "--between"),
        (
            SPHERE,
            "--at 0,0 --between 0,0 1,1",
            2,
            "cannot be used with",
        ),
        (SPHERE, "--between 0,0", 2, "2 values"),
        (SPHERE, "", 2, "--at"),
        (SPHERE, "--at 0,q", 2, "`q`"),
        (
            "surface s(u,v) = (sqrt u, v, 0), u : [-1, 1], v : [0, 1];",
            "--at -1,0",
            1,
            "undefined",
        ),
    ] {
        measure(program, arguments)
            .expect_status(status)
            .expect_text(words);
    }
}

#[test]
fn the_help_has_examples() {
    let run = geotrace(["measure", "--help"]).run();
    run.expect_status(0)
        .expect_text("geotrace measure torus.gtr --between 0,0 1,2")
        .expect_text("σu × σv");
}

#[test]
fn the_commands_of_the_page_run() {
    let root = testing::examples::repository();
    let page = std::fs::read_to_string(root.join("docs/measuring.md")).expect("a page");
    let commands = page
        .lines()
        .filter_map(|line| line.strip_prefix("geotrace "));
    let mut count = 0;
    for command in commands {
        let run = geotrace(command.split_whitespace()).folder(&root).run();
        run.expect_status(0);
        assert!(!run.stdout.contains("none"), "{}", run.stdout);
        count += 1;
    }
    assert_eq!(count, 8);
}

#[test]
fn a_place_is_named_by_the_parameters_of_its_surface() {
    let run = measure(HALF_PLANE, "--at 0,2");
    let text = &run.expect_status(0).stdout;
    assert!(text.contains("at (x, y) = (0, 2)"), "{text}");
    let run = measure(HALF_PLANE, "--between 0,1 1,1");
    let text = &run.expect_status(0).stdout;
    assert!(text.contains(" in (x, y)"), "{text}");
    let traced = geotrace([
        "trace",
        "-",
        "--from",
        "0,1",
        "--heading",
        "0",
        "--length",
        "1",
    ]);
    let run = traced.input(HALF_PLANE).run();
    let text = &run.expect_status(0).stdout;
    assert!(text.contains("from       (x, y) = (0, 1)"), "{text}");
    assert!(!text.contains("(u, v)"), "{text}");
}

#[test]
fn numbers_that_mean_little_say_so() {
    // A cyclide of Dupin, whose curvature is large on the inside.
    let cyclide = "param a = 2 : [1, 4];
define b = 1.9; define c = sqrt(a^2 - b^2); define d = 1;
function den(u,v) = a - c cosu cosv;
surface s(u, v) = (d (c - a cosu cosv) + b^2 cosu, b sinu (a - d cosv), b sinv (c cosu - d))/den(u,v), u : [0, 2pi, 120], v : [0, 2pi, 120];";
    measure(cyclide, "--at 0.3,2 --circle 20")
        .expect_status(0)
        .expect_text("these numbers are not reliable")
        .expect_text("area           15000,");
}

#[test]
fn a_crease_and_equal_corners_are_named() {
    let fold = "surface c(u,v) = (u, v, abs u), u : [-1, 1], v : [-1, 1];";
    measure(fold, "--at 0,0")
        .expect_status(1)
        .expect_text("lies on a crease");
    let one = document(SPHERE, "--triangle 0,0 0,0 1,1");
    assert_eq!(one["note"], "the corners 1 and 2 are the same point");
}

#[test]
fn a_start_on_another_meridian_is_given_in_parameters_of_any_unit() {
    for unit in ["1", "1e10", "1e-10"] {
        let sphere = format!(
            "surface s(u, v) = (cos({unit} u) cos v, sin({unit} u) cos v, sin v),
                u : [0, 2pi/{unit}], v : [-pi/2, pi/2];"
        );
        let found = document(&sphere, &format!("--between 1/{unit},pi/2 3/{unit},0.5"));
        let from = found["geodesics"][0]["from"][0].as_f64();
        let scale: f64 = unit.parse().expect("a number");
        assert_close("from", from.expect("another meridian") * scale, 3.0, 1e-9);
    }
}

#[test]
fn a_side_that_is_one_of_several_shortest_geodesics_has_a_remark() {
    let family = "opposite side 3.14159265359, one of a family: the ends are conjugate";
    measure(SPHERE, "--triangle 0,0 pi,0 1,1").expect_text(family);
    let found = document(SPHERE, "--triangle 0,0 pi,0 1,1");
    let note = found["note"].as_str().expect("a note");
    assert!(
        note.starts_with("side 3 is one of a family: the ends are conjugate; "),
        "{note}"
    );
    // Opposite points of the inner circle of a torus.
    let tie = measure(TORUS, "--triangle 0,pi pi,pi 1,2 --set r=1");
    tie.expect_text(", one of several of this length");
    let plain = measure(SPHERE, "--triangle 0,0 1,0 0,1");
    assert!(!plain.stdout.contains("one of"), "{}", plain.stdout);
}

#[test]
fn a_solid_is_not_measured_but_traced() {
    let refused = measure("solid q(x, y, z) = x^2 + y^2 + z^2 - 1;", "--at 1,1");
    refused
        .expect_status(2)
        .expect_text("`geotrace trace` and `--view geodesic` work on solids");
}
