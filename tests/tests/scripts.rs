//! CRT scripts through the binary: the examples, settings and options, coordinates, `t`.

use std::path::{Path, PathBuf};

use image::RgbImage;
use testing::binary::geotrace;
use testing::examples::repository;

fn scripts() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(repository().join("examples")).expect("readable");
    let paths = entries.map(|entry| entry.expect("readable").path());
    let mut scripts: Vec<PathBuf> = paths
        .filter(|path| path.extension().is_some_and(|ending| ending == "crt"))
        .collect();
    scripts.sort();
    assert!(scripts.len() >= 6, "{scripts:?}");
    scripts
}

/// Draws a script, and returns the picture.
fn draw(script: &Path, options: &[&str]) -> RgbImage {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out.png");
    let run = geotrace(["render"])
        .argument(script)
        .argument("-o")
        .argument(&out)
        .arguments(options)
        .run();
    run.expect_status(0);
    image::open(&out).expect("a picture").to_rgb8()
}

fn written(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("a.crt");
    std::fs::write(&path, text).expect("written");
    path
}

#[test]
fn every_example_runs_without_a_word_in_the_canonical_layout_and_is_seen() {
    for script in scripts() {
        let name = script.display().to_string();
        let run = geotrace(["check", &name]).run();
        run.expect_status(0);
        let said = [run.stdout, run.stderr].concat();
        assert!(
            !said.contains("warning") && !said.contains("hint"),
            "{said}"
        );
        geotrace(["format", "--check", &name])
            .run()
            .expect_status(0);
        let picture = draw(&script, &["--size", "40x30", "--samples", "1"]);
        let first = *picture.get_pixel(0, 0);
        let others = picture.pixels().filter(|pixel| **pixel != first).count();
        assert!(
            others > 300,
            "{name}: {others} pixels differ from the first"
        );
    }
}

#[test]
fn a_script_without_lights_shows_what_is_ambient_and_its_own_size() {
    let folder = tempfile::tempdir().expect("a folder");
    // Nothing shines but the background: by the formula of the look, a face is black and its reflection is the background's.
    let script = written(
        folder.path(),
        "Settings { background -> Background { color -> rgb(1.0, 0.5, 0.25) } }
        Scene {
            Sphere {
                center -> vec3(0, 0, 3)
                radius -> 1
                material -> Material { reflectivity -> 0.5 }
            }
        }",
    );
    let picture = draw(&script, &[]);
    assert_eq!(picture.dimensions(), (800, 600));
    assert_eq!(picture.get_pixel(0, 0).0, [255, 127, 63]);
    assert_eq!(picture.get_pixel(400, 300).0, [127, 63, 31]);
    let picture = draw(&script, &["--bounces", "0", "--size", "80x60"]);
    assert_eq!(picture.get_pixel(40, 30).0, [0; 3]);
    // Gamma: 255·0.25^(1/2), cut.
    let picture = draw(&script, &["--gamma", "2", "--size", "80x60"]);
    assert_eq!(picture.get_pixel(0, 0).0, [255, 180, 127]);
}

#[test]
fn a_lit_face_has_the_light_of_the_formula() {
    let folder = tempfile::tempdir().expect("a folder");
    // The middle ray meets the ball at (0, 0, 2), where n·l is 1 and the path to the eye 3: falloff/(2 + 3)².
    let script = written(
        folder.path(),
        "Settings {
            lights -> [PointLight { origin -> vec3(0, 0, 0) color -> rgb(1, 0.5, 1) ambient -> 0.25 falloff -> 10 }]
            background -> Background { color -> rgb(0, 0, 0) }
        }
        Scene {
            Sphere {
                center -> vec3(0, 0, 3)
                radius -> 1
                material -> Material { color -> rgb(0.8, 0.8, 0.4) diffuse -> 0.5 }
            }
        }",
    );
    let picture = draw(&script, &["--size", "81x61"]);
    // C·ambient + c·k·C·falloff/25.
    let expected = [(1.0, 0.8), (0.5, 0.8), (1.0, 0.4)]
        .map(|(light, color)| (255.0_f64 * (light * 0.25 + color * 0.5 * light * 0.4)) as u8);
    assert_eq!(picture.get_pixel(40, 30).0, expected);
}

#[test]
fn casting_and_evaluating_have_the_coordinates_of_the_script() {
    let folder = tempfile::tempdir().expect("a folder");
    let script = written(
        folder.path(),
        "up = 2
        ball = Sphere { center -> vec3(0, up, 5) radius -> 1 }
        Scene { whole = ball - Box { cornerA -> vec3(-2, 2, 0) cornerB -> vec3(2, 9, 9) }
            whole
        }",
    );
    let name = script.display().to_string();
    let words = ["cast", &name, "--from", "0,0,5", "--direction", "0,1,0"];
    let words = words.into_iter().chain(["--format", "json"]);
    let run = geotrace(words).run();
    run.expect_status(0);
    let document = run.json();
    let crossings = document["crossings"].as_array().expect("a list");
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    let times: Vec<f64> = crossings.iter().map(|it| number(&it["t"])).collect();
    assert!(times.len() == 2 && (times[0] - 1.0).abs() < 1e-9 && (times[1] - 2.0).abs() < 1e-9);
    assert_eq!(crossings[0]["solid"], "whole");
    assert_eq!(crossings[0]["leaf"], "ball");
    let normal: Vec<f64> = (0..3).map(|k| number(&crossings[0]["normal"][k])).collect();
    assert!((normal[1] + 1.0).abs() < 1e-9, "{normal:?}");
    let run = geotrace(["eval", &name, "up * vec3(1, 0, 3)"]).run();
    assert_eq!((run.status, &*run.stdout), (Some(0), "(2, 0, 6)\n"));
}

#[test]
fn each_value_of_t_runs_the_script_anew() {
    let folder = tempfile::tempdir().expect("a folder");
    let script = written(
        folder.path(),
        "Settings { background -> Background { color -> rgb(0, 0, 0) }
            lights -> [ParallelLight { from -> vec3(0, 0, -1) pointing -> vec3(0, 0, 0) color -> rgb(1, 1, 1) }] }
        Scene {
            k = 0
            while (k < t) {
                Sphere { center -> vec3(k * 2 - 2, 0, 6) radius -> 0.5 }
                k = k + 1
            }
        }",
    );
    // The number of lit stretches along the middle row.
    let balls = |t: &str| {
        let picture = draw(&script, &["--set", t, "--size", "120x61"]);
        let lit: Vec<bool> = (0..120)
            .map(|x| picture.get_pixel(x, 30).0[0] > 0)
            .collect();
        lit.windows(2).filter(|pair| !pair[0] && pair[1]).count()
    };
    assert_eq!(["t=0", "t=1", "t=3"].map(balls), [0, 1, 3]);
}

#[test]
fn a_colour_may_be_brighter_than_white() {
    let folder = tempfile::tempdir().expect("a folder");
    let script = written(
        folder.path(),
        "Settings { lights -> [PointLight { origin -> vec3(0, 0, 0) color -> rgb(0.1, 0.1, 0.1) ambient -> 1 }] }
        Scene {
            Sphere { center -> vec3(0, 0, 3) radius -> 1 material -> Material { color -> rgb(5.0, 1.0, 1.0) } }
        }",
    );
    let picture = draw(&script, &["--size", "81x61"]);
    // C·ambient + c·C at the middle.
    assert_eq!(picture.get_pixel(40, 30).0, [153, 51, 51]);
}
