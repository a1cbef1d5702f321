//! Inside a solid's surface, through the binary: `trace` against closed forms, pictures against what they must show, and
//! errors for people.

use std::f64::consts::PI;

use image::RgbaImage;
use serde_json::Value;
use testing::binary::geotrace;

const BALL: &str = "solid ball(x,y,z) = x^2 + y^2 + z^2 - 4;";
const CUBE: &str = "function f(x,y,z) = x^2 + y^2 + z^2 - 3; solid cube(x,y,z) = max(abs x, abs y, abs z) - 1; solid all = cube & f;";

/// Traces a geodesic of the first solid.
#[track_caller]
fn trace(program: &str, more: &[&str]) -> Value {
    let words = [&["trace", "-", "--format", "json"], more].concat();
    geotrace(words).input(program).run().expect_status(0).json()
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().expect("a list").iter();
    list.map(|number| number.as_f64().expect("a number"))
        .collect()
}

#[track_caller]
fn close(found: &[f64], expected: &[f64], within: f64) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() < within, "{found:?} instead of {expected:?}");
    }
}

#[test]
fn a_trace_on_a_ball_is_a_great_circle() {
    let end = trace(
        BALL,
        &["--from", "7,0,0", "--direction", "3,3,4", "--length", "pi"],
    );
    assert!(end["u"].is_null() && end["v"].is_null());
    assert_eq!(end["status"], "complete");
    close(&numbers(&end["position"]), &[0.0, 1.2, 1.6], 1e-9);
    close(&numbers(&end["direction"]), &[-1.0, 0.0, 0.0], 1e-9);
    assert_eq!(end["length"].as_f64(), Some(PI));
    let error = end["error_estimate"].as_f64().expect("an estimate");
    assert!(error < 1e-8, "{error}");
    // A heading counts from ẑ×n.
    let end = trace(
        BALL,
        &["--from", "2,0,0", "--heading", "90", "--length", "pi"],
    );
    close(&numbers(&end["position"]), &[0.0, 0.0, 2.0], 1e-9);
}

#[test]
fn a_trace_on_a_set_ends_at_its_edge() {
    let end = trace(
        CUBE,
        &[
            "--surface",
            "all",
            "--from",
            "0,0,2",
            "--direction",
            "1,0.5,0",
            "--length",
            "9",
        ],
    );
    assert_eq!(end["status"], "left_domain");
    close(&numbers(&end["position"]), &[1.0, 0.5, 1.0], 1e-9);
}

#[test]
fn what_cannot_be_traced_is_refused_in_words() {
    let refused = |program: &str, words: &[&str]| {
        let words = [&["trace", "-"], words].concat();
        let run = geotrace(words).input(program).run();
        run.expect_status(2);
        run.stderr
    };
    let on = |from: &str| {
        refused(
            BALL,
            &["--from", from, "--direction", "1,0,0", "--length", "1"],
        )
    };
    assert!(on("0,0,0").contains("gradient"), "{}", on("0,0,0"));
    assert!(on("1,0").contains("three numbers"), "{}", on("1,0"));
    assert!(
        on("2,0,0").contains("normal to the surface"),
        "{}",
        on("2,0,0")
    );
    let part = refused(
        CUBE,
        &[
            "--surface",
            "cube",
            "--from",
            "0,0,1",
            "--heading",
            "0",
            "--length",
            "1",
        ],
    );
    assert!(part.contains("part of another solid"), "{part}");
    let steps = refused(
        BALL,
        &[
            "--from",
            "2,0,0",
            "--heading",
            "0",
            "--length",
            "1",
            "--method",
            "rk4-pixel",
        ],
    );
    assert!(steps.contains("no parameters"), "{steps}");
    // A surface still takes two numbers.
    let surface = "surface s(u,v) = (u, v, 0), u : [0, 1], v : [0, 1];";
    let three = refused(
        surface,
        &["--from", "0,0,0", "--heading", "0", "--length", "1"],
    );
    assert!(three.contains("two numbers"), "{three}");
}

/// Draws a picture of 80×80 pixels and returns it with the text on standard error.
#[track_caller]
fn picture(program: &str, more: &[&str]) -> (RgbaImage, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("out.png");
    let out = path.display().to_string();
    let words = [
        "render",
        "-",
        "-o",
        &out,
        "--size",
        "80x80",
        "--backend",
        "software",
    ];
    let words = [&words[..], more].concat();
    let run = geotrace(words).input(program).run();
    run.expect_status(0);
    let image = image::open(&path).expect("a picture").to_rgba8();
    (image, run.stderr)
}

#[test]
fn a_ball_of_one_colour_is_a_checker() {
    let (image, printed) = picture(BALL, &["--view", "geodesic:ball", "--zoom", "3"]);
    assert!(
        printed.contains("rays") && !printed.contains("hatched"),
        "{printed}"
    );
    let mut colours: Vec<[u8; 4]> = image.pixels().map(|pixel| pixel.0).collect();
    colours.sort_unstable();
    let before = colours.len();
    let count = |colour: [u8; 4]| colours.iter().filter(|&&it| it == colour).count();
    let [dark, light] = [colours[before / 5], colours[before - before / 5]];
    // Nearly all pixels have one of two colours.
    assert!(
        dark != light && count(dark) + count(light) > before * 7 / 10,
        "{dark:?} {light:?}"
    );
}

#[test]
fn a_coloured_ball_shows_its_colour_at_the_ends_of_its_geodesics() {
    // Red above, blue below; from the side, as far as the poles.
    let program =
        "solid ball(x,y,z) = x^2 + y^2 + z^2 - 1, color : (max(0, z/abs z), 0, max(0, -z/abs z));";
    let (image, _) = picture(
        program,
        &["--view", "geodesic", "--at", "1,0,0", "--zoom", "pi/2"],
    );
    for (x, y, colour) in [
        (40, 10, [255, 0, 0]),
        (10, 20, [255, 0, 0]),
        (40, 70, [0, 0, 255]),
    ] {
        let [r, g, b, a] = image.get_pixel(x, y).0;
        assert_eq!(([r, g, b], a), (colour, 255), "{x}, {y}");
    }
}

#[test]
fn beyond_an_edge_a_picture_is_hatched() {
    let (_, printed) = picture(
        CUBE,
        &["--view", "geodesic:all", "--at", "0,0,1", "--zoom", "2"],
    );
    // A quarter of the picture is the face.
    assert!(
        printed.contains("75.") && printed.contains("hatched"),
        "{printed}"
    );
}

#[test]
fn geodesics_on_solids_are_drawn_in_space_and_traced() {
    let with = format!("{BALL} geodesic g(t) : ball = (0, 1, 1) @ (2, 0, 0), t : [0, 3];");
    for view in [&[][..], &["--view", "traced", "--samples", "1"]] {
        let (without, _) = picture(BALL, view);
        let (drawn, _) = picture(&with, view);
        let differ = without
            .pixels()
            .zip(drawn.pixels())
            .filter(|(a, b)| a != b)
            .count();
        assert!(differ > 8, "{view:?}: {differ}");
    }
}

#[test]
fn a_camera_that_has_no_place_is_refused_in_words() {
    let folder = tempfile::tempdir().expect("a folder");
    let refused = |program: &str, words: &[&str]| {
        let words = [
            &["render", "-", "-o", "never.png", "--view", "geodesic"],
            words,
        ]
        .concat();
        let run = geotrace(words).folder(folder.path()).input(program).run();
        run.expect_status(2);
        run.stderr
    };
    let two_balls =
        "solid two(x,y,z) = min((x-20)^2+(y-7)^2+(z-3)^2, (x+20)^2+(y+7)^2+(z+3)^2) - 0.01;";
    let beside = refused(two_balls, &[]);
    assert!(beside.contains("needs a position"), "{beside}");
    let empty = geotrace(["render", "-", "-o", "never.png", "--view", "geodesic"])
        .folder(folder.path())
        .input("solid none(x,y,z) = x^2 + 1;")
        .run();
    empty.expect_status(1);
    empty.expect_text("`none` has no surface: it contains no point");
    let middle = refused(BALL, &["--at", "0,0,0"]);
    assert!(middle.contains("cannot be projected onto"), "{middle}");
    let two = refused(BALL, &["--at", "0,0"]);
    assert!(two.contains("three numbers"), "{two}");
    let mirrored = refused(BALL, &["--mirrored"]);
    assert!(mirrored.contains("no other side"), "{mirrored}");
    let written = std::fs::read_dir(folder.path()).expect("the folder");
    assert_eq!(written.count(), 0);
}

#[test]
fn messages_about_a_script_have_its_coordinates() {
    let folder = tempfile::tempdir().expect("a folder");
    let script = "Scene { Sphere { center -> vec3(1, 2, 3)  radius -> 0.5 } }";
    std::fs::write(folder.path().join("a.crt"), script).expect("written");
    for words in [
        "trace a.crt --from 1,2,3 --direction 0,1,0 --length 1",
        "trace a.crt --from 1,2,3 --heading 0 --length 1",
        "render a.crt -o a.png --view geodesic --at 1,2,3",
    ] {
        let run = geotrace(words.split(' ')).folder(folder.path()).run();
        run.expect_status(2);
        assert!(run.stderr.contains("(1, 2, 3)"), "{words}: {}", run.stderr);
    }
}
