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
        let printed = [run.stdout, run.stderr].concat();
        assert!(
            !printed.contains("warning") && !printed.contains("hint"),
            "{printed}"
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
        .map(|(light, colour)| (255.0_f64 * (light * 0.25 + colour * 0.5 * light * 0.4)) as u8);
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
fn geodesics_on_a_solid_have_the_coordinates_of_the_script() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "ball = Sphere { center -> vec3(0, 1, 5) radius -> 1 } Scene { ball }";
    let script = written(folder.path(), text);
    let name = script.display().to_string();
    // From the top a quarter of the way around, towards the front.
    let quarter = std::f64::consts::FRAC_PI_2.to_string();
    let words = ["trace", &name, "--surface", "ball", "--from", "0,2,5"];
    let more = ["--direction", "0,0,-1", "--length", &quarter];
    let words = words.into_iter().chain(more).chain(["--format", "json"]);
    let run = geotrace(words).run();
    run.expect_status(0);
    let position = run.json()["position"].clone();
    for (k, expected) in [0.0, 1.0, 4.0].into_iter().enumerate() {
        let found = position[k].as_f64().expect("a number");
        assert!((found - expected).abs() < 1e-9, "{position}");
    }
    let picture = folder.path().join("inside.png").display().to_string();
    let words = ["render", &name, "-o", &picture, "--size", "8x8"];
    let at = |place| {
        words
            .into_iter()
            .chain(["--view", "geodesic:ball", "--at", place])
    };
    geotrace(at("0,2,5")).run().expect_status(0);
    // The middle of the ball lies on no surface.
    geotrace(at("0,1,5")).run().expect_status(2);
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
fn the_errors_of_a_run_at_another_t_are_those_of_every_command() {
    let folder = tempfile::tempdir().expect("a folder");
    let script = written(
        folder.path(),
        "a = [1, 2, 3]\nx = a[floor(t)]\nScene { Sphere { center -> vec3(0, 0, 3) radius -> x } }",
    );
    let name = script.display().to_string();
    let out = |name: &str| folder.path().join(name).display().to_string();
    let [picture, film, program, mesh] = ["a.png", "a.gif", "a.gtr", "a.obj"].map(out);
    let commands: [&[&str]; 6] = [
        &["render", &name, "-o", &picture, "--set", "t=3"],
        &[
            "render",
            &name,
            "-o",
            &film,
            "--animate",
            "t=0:3",
            "--frames",
            "4",
            "--size",
            "40x30",
        ],
        &["convert", &name, "-o", &program, "--set", "t=3"],
        &[
            "cast",
            &name,
            "--from",
            "0,0,-5",
            "--direction",
            "0,0,1",
            "--set",
            "t=3",
        ],
        &["eval", &name, "x", "--set", "t=3"],
        &["export", &name, "-o", &mesh, "--set", "t=3"],
    ];
    for command in commands {
        let run = geotrace(command).run();
        run.expect_status(1);
        run.expect_text("2:5: error[index-out-of-range]");
        run.expect_text("there is no element 3: the last one is 2 (at t = 3)");
    }
    for file in [picture, film, program, mesh] {
        assert!(!Path::new(&file).exists(), "{file}");
    }
    geotrace(["eval", &name, "x", "--set", "t=2"])
        .run()
        .expect_text("3");
    // A loop that ends at t = 0 only.
    let script = written(folder.path(), "Scene { i = 0 while (i < t) { } }");
    let name = script.display().to_string();
    let run = geotrace(["eval", &name, "i", "--set", "t=1"]).run();
    run.expect_status(1).expect_text("error[work-limit]");
}

#[test]
fn an_error_at_t_0_refuses_no_other_t() {
    let folder = tempfile::tempdir().expect("a folder");
    let script = written(
        folder.path(),
        "Scene { Sphere { center -> vec3(1, 0, 3) radius -> t / 10 } }",
    );
    let name = script.display().to_string();
    let sentence = "`radius` must be > 0, but this is 0 (at t = 0)";
    for command in [
        &["check", &name][..],
        &["explain", &name],
        &["eval", &name, "t"],
    ] {
        geotrace(command)
            .run()
            .expect_status(1)
            .expect_text(sentence);
    }
    draw(&script, &["--set", "t=5", "--size", "40x30"]);
    let out = folder.path().join("a.gtr").display().to_string();
    let convert = ["convert", &name, "-o", &out, "--set", "t=5"];
    geotrace(convert).run().expect_status(0);
    let out = folder.path().join("a.gif").display().to_string();
    let animated = [
        "render", &name, "-o", &out, "--size", "40x30", "--frames", "3",
    ];
    let animated = |range| geotrace(animated.into_iter().chain(["--animate", range])).run();
    animated("t=1:3").expect_status(0);
    animated("t=3:0").expect_status(1).expect_text(sentence);
    let run = geotrace(["eval", &name, "t / 10", "--set", "t=5"]).run();
    run.expect_status(0).expect_text("0.5");
    // An error of the text remains one.
    let script = written(folder.path(), "Scene { } x = 1");
    let name = script.display().to_string();
    let run = geotrace(["eval", &name, "t", "--set", "t=5"]).run();
    run.expect_status(1).expect_text("error[after-scene]");
}

#[test]
fn a_script_on_standard_input_is_recognised() {
    let note = "`--language crt`";
    let script = "s = Sphere { center -> vec3(0, 0, 3) radius -> 1 }\nScene { s }\n";
    let run = geotrace(["check", "-"]).input(script).run();
    run.expect_status(1).expect_text(note);
    // A program with errors is none.
    let run = geotrace(["check", "-"]).input("point p = (1, 2;").run();
    assert!(!run.stderr.contains(note), "{}", run.stderr);
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

/// The bytes of a pixel of a script that is drawn at 81×61 samples in the default camera: from (0, 0, −1) along z, with 60
/// degrees from top to bottom.
fn pixel_of(script: &str, [x, y]: [u32; 2]) -> [u8; 3] {
    let folder = tempfile::tempdir().expect("a folder");
    let script = written(folder.path(), script);
    draw(&script, &["--size", "81x61"]).get_pixel(x, y).0
}

const MIDDLE: [u32; 2] = [40, 30];
/// tan of half the field of view.
const F: f64 = 0.577_350_269_189_625_8;

/// The horizontal and vertical numbers X and Y of a pixel's middle.
fn in_picture([x, y]: [u32; 2]) -> [f64; 2] {
    [
        2.0 * (f64::from(x) + 0.5) / 81.0 - 1.0,
        1.0 - 2.0 * (f64::from(y) + 0.5) / 61.0,
    ]
}

/// Light as bytes; the cut may fall on either side of a whole number.
fn expect(found: [u8; 3], light: [f64; 3]) {
    let near = found.iter().zip(light).all(|(byte, light)| {
        let exact = 255.0 * light.min(1.0);
        exact - 1.0 - 1e-6 <= f64::from(*byte) && f64::from(*byte) <= exact + 1e-6
    });
    assert!(near, "{found:?}, {:?}", light.map(|it| 255.0 * it));
}

/// A white wall from z = 2 on, with black around, under one light.
fn wall(light: &str) -> String {
    format!(
        "Settings {{ lights -> [{light}] background -> Background {{ color -> rgb(0, 0, 0) }} }}
        Scene {{ Box {{ cornerA -> vec3(-9, -9, 2) cornerB -> vec3(9, 9, 5) material -> Material {{ color -> rgb(1, 0.5, 0.25) }} }} }}"
    )
}

/// 1 − smoothstep over the part of an edge that fades.
fn soft(x: f64, edge: f64, softness: f64) -> f64 {
    let s = ((x - (1.0 - softness) * edge) / (softness * edge)).clamp(0.0, 1.0);
    1.0 - s * s * (3.0 - 2.0 * s)
}

#[test]
fn a_point_light_and_a_parallel_light_shine_by_the_angle() {
    // The middle ray meets the wall at (0, 0, 2), with n = (0, 0, −1): n·l is 4/5 of the light from (3, 0, −2).
    let lit = |light: &str| pixel_of(&wall(light), MIDDLE);
    let lambert = [0.8, 0.4, 0.2];
    let point = "PointLight { origin -> vec3(3, 0, -2) color -> rgb(1, 1, 1) }";
    expect(lit(point), lambert);
    let parallel =
        "ParallelLight { from -> vec3(3, 7, -4) pointing -> vec3(0, 7, 0) color -> rgb(1, 1, 1) }";
    expect(lit(parallel), lambert);
    // Falloff: 16/(5 + 3)², by the distance to the light and that to the eye.
    let fading = "PointLight { origin -> vec3(3, 0, -2) color -> rgb(1, 1, 1) falloff -> 16 }";
    expect(lit(fading), lambert.map(|it| it * 0.25));
    // Light from behind the wall: the ambient share alone.
    let behind = "PointLight { origin -> vec3(0, 0, 9) color -> rgb(1, 1, 1) ambient -> 0.25 }";
    expect(lit(behind), [0.25; 3]);
}

#[test]
fn a_spot_fades_at_the_edge_of_its_cone() {
    // From (0, 0, −2) to (1, 0, 2) the axis is off by atan(1/4), 14.04 degrees; the half opening is 16 degrees.
    let off = 0.25_f64.atan().to_degrees();
    let lit = |angle: f64, softness: f64| {
        let light = format!(
            "SpotLight {{ origin -> vec3(0, 0, -2) pointing -> vec3(1, 0, 2) color -> rgb(1, 1, 1) angle -> {angle:?} softness -> {softness:?} }}"
        );
        pixel_of(&wall(&light), MIDDLE)
    };
    let share = soft(off, 16.0, 0.5);
    assert!(share > 0.05 && share < 0.5);
    expect(lit(32.0, 0.5), [1.0, 0.5, 0.25].map(|it| it * share));
    expect(lit(32.0, 0.0), [1.0, 0.5, 0.25]);
    expect(lit(28.0, 0.5), [0.0; 3]);
}

#[test]
fn a_cylinder_light_fades_at_the_edge_of_its_beam() {
    let lit = |z: f64, radius: f64| {
        let light = format!(
            "CylinderLight {{ origin -> vec3(0.75, 0, {z:?}) pointing -> vec3(0.75, 0, {:?}) radius -> {radius:?} softness -> 0.5 color -> rgb(1, 1, 1) falloff -> 100 }}",
            z + 1.0
        );
        pixel_of(&wall(&light), MIDDLE)
    };
    // The middle of the picture is 0.75 off the axis; the wall is 4 behind the light, the eye 3 from there: 100/49 is cut.
    let share = soft(0.75, 1.0, 0.5) * 100.0 / 49.0;
    expect(lit(-2.0, 1.0), [1.0, 0.5, 0.25].map(|it| it * share));
    expect(lit(-2.0, 0.7), [0.0; 3]);
    // Behind the light's place it is dark.
    expect(lit(3.0, 1.0), [0.0; 3]);
}

#[test]
fn two_mirrors_give_a_geometric_series() {
    // Each face gives (1 − ρ)·a of the ambient light: out = a·(1 − ρ^(depth + 1)).
    for depth in 0..4 {
        let script = format!(
            "mirror = Material {{ color -> rgb(0, 0, 0) reflectivity -> 0.5 }}
            Settings {{
                recursiondepth -> {depth}
                lights -> [PointLight {{ origin -> vec3(0, 0, 0) color -> rgb(1, 1, 1) ambient -> 0.5 }}]
                background -> Background {{ color -> rgb(0, 0, 0) }}
            }}
            Scene {{
                Box {{ cornerA -> vec3(-9, -9, 2) cornerB -> vec3(9, 9, 5) material -> mirror }}
                Box {{ cornerA -> vec3(-9, -9, -2) cornerB -> vec3(9, 9, -5) material -> mirror }}
            }}"
        );
        let light = 0.5 * (1.0 - 0.5_f64.powi(depth + 1));
        expect(pixel_of(&script, MIDDLE), [light; 3]);
    }
}

#[test]
fn glass_reflects_and_lets_through_by_fresnel() {
    // A pane in a white room, looked at straight: F = ((n − 1)/(n + 1))², and beyond the last depth there is nothing.
    let (g, fresnel) = (0.5, 0.04);
    let through = g * (1.0 - fresnel);
    let expected = [
        (0, 0.0),
        (1, g * fresnel),
        (2, g * (fresnel + (1.0 - fresnel) * through)),
    ];
    for (depth, light) in expected {
        let script = format!(
            "Settings {{ recursiondepth -> {depth} }}
            Scene {{
                Box {{ cornerA -> vec3(-9, -9, 2) cornerB -> vec3(9, 9, 5) material -> Material {{ color -> rgb(1, 1, 1) transparency -> {g:?} diffuse -> 0 }} }}
            }}"
        );
        expect(pixel_of(&script, MIDDLE), [light; 3]);
    }
}

#[test]
fn a_highlight_is_of_the_light_and_the_face() {
    // l = (0.6, 0, −0.8) is reflected to (0.6, 0, 0.8): r·d is 0.8 along z.
    let script = "Settings {
            lights -> [PointLight { origin -> vec3(3, 0, -2) color -> rgb(1, 0.5, 1) }]
            background -> Background { color -> rgb(0, 0, 0) }
        }
        Scene { Box { cornerA -> vec3(-9, -9, 2) cornerB -> vec3(9, 9, 5)
            material -> Material { color -> rgb(0.5, 0.5, 0.25) diffuse -> 0 specularity -> 0.75 shininess -> 2 } } }";
    let bright = 0.75 * 0.64;
    expect(
        pixel_of(script, MIDDLE),
        [0.5, 0.25, 0.25].map(|it| it * bright),
    );
}

#[test]
fn each_face_of_a_set_has_the_material_of_its_own_leaf() {
    let script = "red = Material { color -> rgb(1, 0, 0) }
        green = Material { color -> rgb(0, 1, 0) }
        blue = Material { color -> rgb(0, 0, 1) }
        Settings {
            lights -> [ParallelLight { from -> vec3(0, 0, -1) pointing -> vec3(0, 0, 0) color -> rgb(1, 1, 1) }]
            background -> Background { color -> rgb(0, 0, 0) }
        }
        Scene {
            Box { cornerA -> vec3(-9, -9, 2) cornerB -> vec3(9, 9, 6) material -> red }
                - (Sphere { center -> vec3(0, 0, 2) radius -> 1 material -> green }
                    + Box { cornerA -> vec3(1.5, -0.5, 1) cornerB -> vec3(3, 0.5, 3) material -> blue })
        }";
    expect(pixel_of(script, MIDDLE), [0.0, 1.0, 0.0]);
    // The bottom of the other hole, at z = 3: x is X·f·W/H·4.
    let at = [73, 30];
    let x = in_picture(at)[0] * F * 81.0 / 61.0 * 4.0;
    assert!(2.2 < x && x < 2.8, "{x}");
    expect(pixel_of(script, at), [0.0, 0.0, 1.0]);
    expect(pixel_of(script, [5, 30]), [1.0, 0.0, 0.0]);
}

#[test]
fn a_lone_plane_is_seen_and_casts_shadow_from_its_front() {
    let seen = |normal: &str| {
        pixel_of(
            &format!(
                "Settings {{ lights -> [PointLight {{ origin -> vec3(0, 0, -1) color -> rgb(1, 1, 1) ambient -> 0.5 }}] background -> Background {{ color -> rgb(0, 0, 1) }} }}
                Scene {{ Plane {{ normal -> {normal} position -> vec3(0, 0, 2) material -> Material {{ color -> rgb(0, 0, 0) }} }} }}"
            ),
            MIDDLE,
        )
    };
    expect(seen("vec3(0, 0, -1)"), [0.5; 3]);
    expect(seen("vec3(0, 0, 1)"), [0.0, 0.0, 1.0]);
    // A wall at z = 4 under light that comes down through the plane y = 1. What the wall sees of the plane, on the way to
    // the light, is its front or its back.
    let shadow = |normal: &str, set: &str| {
        pixel_of(
            &format!(
                "Settings {{ lights -> [ParallelLight {{ from -> vec3(0, 3, -4) pointing -> vec3(0, 0, 0) color -> rgb(1, 1, 1) }}] background -> Background {{ color -> rgb(0, 0, 0) }} }}
                Scene {{
                    Box {{ cornerA -> vec3(-9, -9, 4) cornerB -> vec3(9, 9, 5) material -> Material {{ color -> rgb(1, 1, 1) }} }}
                    Plane {{ normal -> {normal} position -> vec3(0, 1, 0) }} {set}
                }}"
            ),
            MIDDLE,
        )
    };
    let in_a_set = "^ Box { cornerA -> vec3(-99, 1, -99) cornerB -> vec3(99, 0.5, 3) }";
    expect(shadow("vec3(0, -1, 0)", ""), [0.0; 3]);
    expect(shadow("vec3(0, 1, 0)", ""), [0.8; 3]);
    // In a set it is a half-space.
    expect(shadow("vec3(0, 1, 0)", in_a_set), [0.0; 3]);
}

#[test]
fn horizon_and_sky_are_mixed_by_the_height_of_the_ray() {
    let sky = |camera: &str| {
        format!(
            "Settings {{ {camera} background -> Background {{ horizon -> rgb(1, 0, 0) sky -> rgb(0, 0, 1) }} }} Scene {{ }}"
        )
    };
    let camera = |more: &str| {
        format!(
            "camera -> Camera {{ position -> vec3(0, 0, 0) pointing -> vec3(0, 0, 1) fov -> 60 {more} }}"
        )
    };
    let wide = F * 81.0 / 61.0;
    let half = std::f64::consts::FRAC_PI_6;
    for at in [MIDDLE, [40, 0], [80, 10], [3, 60]] {
        let [x, y] = in_picture(at);
        let mixed = |right: f64, up: f64| {
            let height = up.abs() / (1.0 + right * right + up * up).sqrt();
            [1.0 - height, 0.0, height]
        };
        expect(pixel_of(&sky(""), at), mixed(x * wide, y * F));
        // Up is the scene's right: the height is that of the way to the left.
        let rolled = pixel_of(&sky(&camera("roll -> 90")), at);
        expect(rolled, {
            let [red, _, blue] = mixed(y * F, x * wide);
            [red, 0.0, blue]
        });
        let turn = (x * half * 81.0 / 61.0).sin();
        let spherical = pixel_of(&sky(&camera("projection -> \"spherical\"")), at);
        expect(spherical, mixed(turn, (y * half).sin()));
        let cylindrical = pixel_of(&sky(&camera("projection -> \"cylindrical\"")), at);
        expect(cylindrical, mixed(turn, y * F));
    }
}

#[test]
fn roll_turns_up_towards_the_right() {
    // With u = (1, 0, 0): right is (0, −1, 0), up is (1, 0, 0).
    let script = "Settings {
            camera -> Camera { position -> vec3(0, 0, 0) pointing -> vec3(0, 0, 1) fov -> 60 roll -> 90 }
            lights -> [PointLight { origin -> vec3(0, 0, 0) color -> rgb(1, 1, 1) ambient -> 1 }]
            background -> Background { color -> rgb(0, 0, 0) }
        }
        Scene {
            Sphere { center -> vec3(0, -2, 4) radius -> 0.5 material -> Material { color -> rgb(0, 0, 0) reflectivity -> 0.5 } }
            Sphere { center -> vec3(1, 0, 4) radius -> 0.5 material -> Material { color -> rgb(0, 0, 0) } }
        }";
    // X·f·W/H·4 = 2, and Y·f·4 = 1.
    let column = 81.0 * (1.0 + 2.0 / (4.0 * F * 81.0 / 61.0)) / 2.0;
    let row = 61.0 * (1.0 - 1.0 / (4.0 * F)) / 2.0;
    expect(pixel_of(script, [column as u32, 30]), [0.5; 3]);
    expect(pixel_of(script, [40, row as u32]), [1.0; 3]);
    expect(pixel_of(script, [81 - column as u32, 30]), [0.0; 3]);
    expect(pixel_of(script, [40, 61 - row as u32]), [0.0; 3]);
}

#[test]
fn supersampling_begins_at_the_pixel_and_goes_by_fractions_of_it() {
    // Rows j + b/n below the horizon, where the height is Y·f/√(1 + (X·f·W/H)² + (Y·f)²), with f = tan 75°.
    let script = "Settings {
            supersampling -> 4
            camera -> Camera { position -> vec3(0, 0, 0) pointing -> vec3(0, 0, 1) fov -> 150 }
            background -> Background { horizon -> rgb(1, 0, 0) sky -> rgb(0, 0, 1) }
        }
        Scene { }";
    let (column, row) = (40.0, 31.0);
    let f = 75.0_f64.to_radians().tan();
    // The mean over samples that begin at a share of the pixel.
    let mean = |begin: f64| {
        let mut sum = 0.0;
        for k in 0..16 {
            let [a, b] = [k / 4, k % 4].map(|it| begin + f64::from(it) / 4.0);
            let right = (2.0 * (column + a) / 81.0 - 1.0) * f * 81.0 / 61.0;
            let up = (1.0 - 2.0 * (row + b) / 61.0) * f;
            sum += up.abs() / (1.0 + right * right + up * up).sqrt();
        }
        sum / 16.0
    };
    let height = mean(0.0);
    assert!(255.0 * (mean(0.125) - height).abs() > 2.5);
    expect(pixel_of(script, [40, 31]), [1.0 - height, 0.0, height]);
}
