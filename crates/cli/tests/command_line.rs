//! The binary from outside: exit statuses, what goes to which stream, and files that are whole or absent.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

const SPHERE: &str = "\
function f(u, v) = (sin v cos u, sin v sin u, cos v);
surface s(u, v) = f(u, v), u : [0, 2pi], v : [0, pi];
";

struct Run {
    status: i32,
    stdout: String,
    stderr: String,
}

impl Run {
    fn of(output: Output) -> Self {
        Self {
            status: output.status.code().unwrap_or(-1),
            stdout: String::from_utf8(output.stdout).expect("UTF-8"),
            stderr: String::from_utf8(output.stderr).expect("UTF-8"),
        }
    }

    fn json(&self) -> Value {
        serde_json::from_str(&self.stdout)
            .unwrap_or_else(|error| panic!("{error}: {}", self.stdout))
    }
}

/// Runs the binary in a directory, with a text on its standard input.
fn run(folder: &Path, arguments: &[&str], input: &str) -> Run {
    let mut child = Command::new(env!("CARGO_BIN_EXE_geotrace"))
        .current_dir(folder)
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    // A command that reads no input may have ended already.
    let _ = child
        .stdin
        .take()
        .map(|mut stdin| stdin.write_all(input.as_bytes()));
    Run::of(child.wait_with_output().expect("the binary ends"))
}

fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = TempDir::new().expect("a temporary directory");
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("writing");
    }
    folder
}

fn names(folder: &TempDir) -> Vec<String> {
    let entries = std::fs::read_dir(folder.path()).expect("the directory");
    let mut names: Vec<String> = entries
        .map(|entry| {
            entry
                .expect("an entry")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    names.sort();
    names
}

#[test]
fn a_fine_program_prints_nothing_and_ends_with_0() {
    let folder = folder(&[("a.gtr", SPHERE), ("b.gtr", "")]);
    let run = run(folder.path(), &["check", "a.gtr", "b.gtr"], "");
    assert_eq!((run.status, run.stdout.as_str()), (0, ""));
    assert_eq!(run.stderr, "2 files checked: no errors\n");
}

#[test]
fn errors_have_a_place_a_code_and_a_sentence() {
    let folder = folder(&[]);
    let run = run(
        folder.path(),
        &["check", "-"],
        "# π\npoint p = (foo, 1, 2);\n",
    );
    assert_eq!(run.status, 1);
    let first = run.stdout.lines().next();
    assert_eq!(
        first,
        Some("-:2:12: error[undefined-name]: `foo` is not defined")
    );
}

#[test]
fn json_has_every_error_of_every_readable_file() {
    let folder = folder(&[("a.gtr", "point p = (foo, 1, 2);\npoint q = (bar, 1, 2);\n")]);
    let run = run(
        folder.path(),
        &["check", "a.gtr", "missing.gtr", "--format", "json"],
        "",
    );
    assert_eq!(run.status, 2);
    assert!(run.stderr.contains("missing.gtr"), "{}", run.stderr);
    let document = run.json();
    let lines: Vec<_> = document["diagnostics"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|one| {
            (
                one["file"].as_str(),
                one["line"].as_u64(),
                one["end_column"].as_u64(),
            )
        })
        .collect();
    assert_eq!(
        lines,
        [
            (Some("a.gtr"), Some(1), Some(15)),
            (Some("a.gtr"), Some(2), Some(15))
        ]
    );
}

#[test]
fn what_a_script_s_mesh_lacks_is_reported_with_what_a_script_can_state() {
    let folder = folder(&[
        (
            "plane.crt",
            "Scene { Plane { normal -> vec3(0,1,0) position -> vec3(0,-1,0) } \
            Sphere { center -> vec3(0,0,0) radius -> 1 } }",
        ),
        (
            "cut.crt",
            "Scene { Plane { normal -> vec3(0,1,0) position -> vec3(0,-1,0) } \
            ^ Box { cornerA -> vec3(-3, -3, -3) cornerB -> vec3(3, 3, 3) } }",
        ),
        (
            "thin.crt",
            "Scene { Box { cornerA -> vec3(0,0,0) cornerB -> vec3(4,0.01,2) } + \
            Sphere { center -> vec3(0,0,0) radius -> 0.5 } }",
        ),
    ]);
    let noted = |script: &str| {
        let run = run(folder.path(), &["export", script, "-o", "a.stl"], "");
        assert_eq!(run.status, 0, "{}", run.stderr);
        let lines = run.stderr.lines().map(str::to_owned);
        let notes: Vec<String> = lines.filter(|line| line.starts_with("note: ")).collect();
        notes
    };
    assert_eq!(
        noted("plane.crt"),
        [
            "note: `1:9` has no mesh, because it may be unbounded: no bound was found along x, y and z; intersect it with a \
             box: `^ Box { cornerA -> vec3(-3, -3, -3) cornerB -> vec3(3, 3, 3) }`"
        ]
    );
    assert_eq!(noted("cut.crt"), [""; 0]);
    assert_eq!(
        noted("thin.crt"),
        [
            "note: parts of `1:9` are thinner than a cell (0.035) and may be missing; `geotrace convert` makes a program of \
             the script, where counts make the cells smaller: `x : [-0.5, 4, 512]`"
        ]
    );
}

#[test]
fn a_part_is_no_object_that_is_drawn() {
    let folder = folder(&[(
        "a.gtr",
        "solid b(x,y,z) = x^2+y^2+z^2-1; solid q = b @ (1,0,0);",
    )]);
    for arguments in [
        &["render", "a.gtr", "-o", "a.png", "--hide", "b"][..],
        &["render", "a.gtr", "-o", "a.png", "--colour", "b=#ff0000"],
        &["export", "a.gtr", "-o", "a.stl", "--object", "b"],
    ] {
        let run = run(folder.path(), arguments, "");
        assert_eq!(run.status, 2, "{arguments:?}");
        let message = "`b` is a part of another solid, and is not drawn itself";
        assert!(run.stderr.contains(message), "{}", run.stderr);
    }
}

#[test]
fn explain_tells_empty_solids_from_unbounded_ones() {
    let folder = folder(&[(
        "a.gtr",
        "solid ball(x,y,z) = x^2+y^2+z^2-1; solid d = ball & ball @ (5,0,0); solid n(x,y,z) = sqrt(-1-x^2);
         solid u(x,y,z) = x; param s = 0 : [0,1]; solid f = ball @ scale s;",
    )]);
    let text = run(folder.path(), &["explain", "a.gtr"], "").stdout;
    for (solid, end) in [
        ("ball", "1.0000000010010002]"),
        ("d", "; empty"),
        ("n", "; empty"),
        ("u", "; unbounded"),
        ("f", "; `f` is not drawn: the map of `ball` is singular"),
    ] {
        let start = format!("  {solid}: ");
        let line = text.lines().find(|line| line.starts_with(&start));
        let line = line.unwrap_or_else(|| panic!("no {solid}: {text}"));
        assert!(line.ends_with(end), "{line}");
    }
    let json = run(folder.path(), &["explain", "a.gtr", "--format", "json"], "").json();
    let solids = json["solids"].as_array().expect("solids");
    for solid in solids {
        let is_empty = solid["empty"].as_bool().unwrap_or_default();
        assert_eq!(
            is_empty,
            ["d", "n"].contains(&solid["name"].as_str().expect("a name"))
        );
    }
}

#[test]
fn values_have_the_form_of_the_contract() {
    let folder = folder(&[]);
    let eval = |program: &str, rest: &[&str]| {
        run(
            folder.path(),
            &[&["eval", "-"], rest, &["--format", "json"]].concat(),
            program,
        )
        .json()
    };
    assert_eq!(eval("", &["-2^2"]), serde_json::json!({"value": -4.0}));
    assert_eq!(
        eval("param r : [-2, 1];", &["r(1, 2)", "--set", "r=-1"]),
        serde_json::json!({"value": [-1.0, -2.0]})
    );
    assert_eq!(eval("", &["0/0"]), serde_json::json!({"value": null}));
    assert_eq!(
        eval("grid k : [0, 1, 2];", &["2k"]),
        serde_json::json!({"instances": [
            {"grids": {"k": 0.0}, "value": 0.0},
            {"grids": {"k": 1.0}, "value": 2.0},
        ]})
    );
}

#[test]
fn an_expression_with_an_error_is_no_value() {
    let folder = folder(&[]);
    let run = run(folder.path(), &["eval", "-", "1 + foo"], "");
    assert_eq!((run.status, run.stdout.as_str()), (1, ""));
    assert!(
        run.stderr
            .starts_with("<expression>:1:5: error[undefined-name]"),
        "{}",
        run.stderr
    );
}

#[test]
fn an_error_in_an_expression_shows_no_place_of_the_program_in_it() {
    let folder = folder(&[]);
    let program = "\n\nfunction f(x, y) = x^2 y;\n";
    let run = run(
        folder.path(),
        &["eval", "-", "f_z(1, 2) + 3 + 4 + 5"],
        program,
    );
    assert_eq!(run.status, 1, "{}", run.stderr);
    assert!(
        run.stderr.starts_with("<expression>:1:3: error"),
        "{}",
        run.stderr
    );
    assert!(!run.stderr.contains("note: "), "{}", run.stderr);
}

#[test]
fn wrong_arguments_end_with_2_and_say_what_there_is() {
    let folder = folder(&[("a.gtr", SPHERE), ("b.gtr", "param r : [1, 2];")]);
    for (arguments, part) in [
        (&["eval", "b.gtr", "r", "--set", "r=3"][..], "[1, 2]"),
        (&["eval", "b.gtr", "r", "--set", "q=3"], "`r`"),
        (&["eval", "none.gtr", "1"], "no such file"),
        (&["eval", ".", "1"], "it is a directory"),
        (&["render", "a.gtr", "-o", "no/a.png"], "does not exist"),
        (&["render", "a.gtr", "-o", "a.jpg"], "PNG"),
        (
            &["render", "a.gtr", "-o", "a.png", "--size", "0x0"],
            "at least one pixel",
        ),
        (
            &["render", "a.gtr", "-o", "a.png", "--view", "geodesic:t"],
            "`s`",
        ),
        (
            &["render", "a.gtr", "-o", "a.png", "--texture", "s=none.png"],
            "none.png",
        ),
        (
            &[
                "trace",
                "a.gtr",
                "--surface",
                "t",
                "--from",
                "0,0",
                "--heading",
                "0",
                "--length",
                "1",
            ],
            "`s`",
        ),
    ] {
        let run = run(folder.path(), arguments, "");
        assert_eq!(
            (run.status, run.stdout.as_str()),
            (2, ""),
            "{arguments:?}: {}",
            run.stderr
        );
        assert!(run.stderr.contains(part), "{arguments:?}: {}", run.stderr);
    }
    assert_eq!(names(&folder), ["a.gtr", "b.gtr"]);
}

#[test]
fn a_great_circle_closes() {
    let folder = folder(&[("a.gtr", SPHERE)]);
    let run = run(
        folder.path(),
        &[
            "trace",
            "a.gtr",
            "--surface",
            "s",
            "--from",
            "1,1",
            "--heading",
            "30",
            "--length",
            "6.283185307179586",
            "--format",
            "json",
        ],
        "",
    );
    assert_eq!(run.status, 0, "{}", run.stderr);
    let end = run.json();
    assert_eq!(end["status"], "complete");
    for coordinate in ["u", "v"] {
        let value = end[coordinate].as_f64().expect("a number");
        assert!((value - 1.0).abs() < 1e-8, "{coordinate} = {value}");
    }
    let keys: Vec<&String> = end.as_object().expect("an object").keys().collect();
    assert_eq!(
        keys,
        [
            "direction",
            "error_estimate",
            "evaluations",
            "length",
            "position",
            "speed_drift",
            "status",
            "steps",
            "u",
            "v"
        ]
    );
}

#[test]
fn a_picture_is_written_whole_and_alone() {
    let folder = folder(&[("a.gtr", SPHERE)]);
    let arguments = [
        "render",
        "a.gtr",
        "-o",
        "a.png",
        "--size",
        "40x30",
        "--backend",
        "software",
    ];
    let run = run(folder.path(), &arguments, "");
    assert_eq!((run.status, run.stdout.as_str()), (0, ""), "{}", run.stderr);
    assert!(run.stderr.contains("software"), "{}", run.stderr);
    assert_eq!(names(&folder), ["a.gtr", "a.png"]);
    let image = std::fs::read(folder.path().join("a.png")).expect("the picture");
    assert_eq!(&image[1..4], b"PNG");
    // Width and height, from the image header.
    assert_eq!(image[16..24], [0, 0, 0, 40, 0, 0, 0, 30]);
}

#[test]
fn a_program_of_points_builds_nothing_for_surfaces() {
    let folder = folder(&[("a.gtr", "point p = (1, 2, 3);")]);
    let run = run(folder.path(), &["explain", "a.gtr", "--format", "json"], "");
    assert_eq!(run.status, 0, "{}", run.stderr);
    let document = run.json();
    let views = document["views"].as_array().expect("a list");
    assert_eq!(views.len(), 1);
    assert_eq!(views[0]["painters"], serde_json::json!(["points"]));
    assert_eq!(
        views[0]["built"],
        serde_json::json!({
            "draw_pipelines": 1, "sample_kernels": 0, "geodesic_kernels": 0,
            "resolve_pipelines": 0, "textures": 0, "samplers": 0,
        })
    );
}

#[test]
fn meshes_are_written_by_the_extension_or_the_format() {
    let folder = folder(&[("a.gtr", SPHERE)]);
    for (name, start) in [
        ("a.obj", &b"# written"[..]),
        ("a.ply", b"ply\nformat binary"),
        ("a.stl", &[0; 80]),
        ("a.gltf", b"{"),
        ("a.GLB", b"glTF"),
    ] {
        let run = run(folder.path(), &["export", "a.gtr", "-o", name], "");
        assert_eq!((run.status, run.stdout.as_str()), (0, ""), "{}", run.stderr);
        let bytes = std::fs::read(folder.path().join(name)).expect("the file");
        assert!(bytes.starts_with(start), "{name}");
    }
    let obj = [
        "export", "a.gtr", "-o", "-", "--format", "obj", "--object", "s",
    ];
    let run = run(folder.path(), &obj, "");
    assert_eq!(run.status, 0, "{}", run.stderr);
    let file = std::fs::read_to_string(folder.path().join("a.obj")).expect("the file");
    assert_eq!(run.stdout, file);
}

#[test]
fn a_mesh_that_cannot_be_made_is_reported_and_leaves_no_file() {
    let folder = folder(&[("a.gtr", "curve c(t) = (t,0,0), t : [0,1];")]);
    for (arguments, status, words) in [
        (&["-o", "a.dxf"][..], 2, "does not determine a format"),
        (&["-o", "."], 2, "write to `./out.glb`"),
        (&["-o", "-"], 2, "--format"),
        (
            &["-o", "a.obj", "--object", "d"],
            2,
            "its only object is `c`",
        ),
        (&["-o", "a.stl"], 1, "`c` is left out"),
        (&["-o", "no/a.obj"], 2, "does not exist"),
        (&["-o", "a.obj", "--set", "r=1"], 2, "no param"),
    ] {
        let run = run(
            folder.path(),
            &[&["export", "a.gtr"], arguments].concat(),
            "",
        );
        assert_eq!(run.status, status, "{arguments:?}: {}", run.stderr);
        assert!(run.stderr.contains(words), "{arguments:?}: {}", run.stderr);
        assert_eq!(names(&folder), ["a.gtr"]);
    }
}

#[test]
fn animations_are_written_whole_or_not_at_all() {
    let program = "param r : [1,2]; curve c(t) = r(cost, sint, 0), t : [0,2pi]; \
        surface s(u,v) = (u, v, 0), u : [-1,1], v : [-1,1];";
    let folder = folder(&[("a.gtr", program)]);
    let render = |arguments: &[&str]| {
        let first = [
            "render",
            "a.gtr",
            "--size",
            "24x16",
            "--backend",
            "software",
        ];
        run(folder.path(), &[&first[..], arguments].concat(), "")
    };
    for (arguments, words) in [
        (&["-o", "a.gif"][..], "nothing moves"),
        (&["-o", "a.png", "--animate", "r=1:2"], "--frames N"),
        (&["-o", "a.gif", "--animate", "r=1:3"], "lies outside"),
        (&["-o", "a.gif", "--animate", "q=1:3"], "no param"),
        (
            &["-o", "a.gif", "--animate", "r=1:2", "--fps", "1e300"],
            "between 0.01 and 1000",
        ),
        (
            &["-o", "a.gif", "--animate", "r=1:2", "--fps", "-3"],
            "it must be greater than 0",
        ),
        (&["-o", "a.png", "--turntable"], "--frames N"),
        (
            &["-o", "a.gif", "--turntable", "--view", "geodesic"],
            "--view 3d",
        ),
        (
            &["-o", "a.gif", "--turntable", "--course", "twice"],
            "back-and-forth",
        ),
        (&["-o", "a.gif", "--walk", "1"], "--view geodesic"),
        (
            &["-o", "-", "--animate", "r=1:2", "--frames", "3"],
            "needs a file",
        ),
        (&["-o", "a.jpg"], "would not be a .jpg file"),
        (&["-o", "a.eps"], "would not be a .eps file"),
        (&["-o", "a.sgv"], "write to `a.png`"),
        (&["-o", "a.glb"], "`geotrace export` writes meshes"),
        (&["-o", "a.CRT"], "would not be a .crt file"),
        (
            &["-o", "a.gif", "--animate", "r=1:2", "--animate", "r=2:1"],
            "given twice",
        ),
        (&["-o", "a.png", "--partial"], "no part of this picture"),
        (
            &["-o", "a.svg", "--partial", "--view", "traced"],
            "no part of this picture",
        ),
    ] {
        let run = render(arguments);
        assert_eq!(run.status, 2, "{arguments:?}: {}", run.stderr);
        assert!(run.stderr.contains(words), "{arguments:?}: {}", run.stderr);
        assert_eq!(names(&folder), ["a.gtr"]);
    }
    for arguments in [
        &["-o", "a.gif", "--animate", "r=1:2", "--frames", "3"][..],
        &[
            "-o",
            "a.apng",
            "--animate",
            "r=1:2",
            "--frames",
            "3",
            "--background",
            "transparent",
        ],
        &["-o", "b.png", "--animate", "r=2:1", "--frames", "3"],
        &[
            "-o", "w.apng", "--view", "geodesic", "--walk", "-1/2", "--trail", "--frames", "2",
        ],
    ] {
        let run = render(arguments);
        assert_eq!(run.status, 0, "{arguments:?}: {}", run.stderr);
    }
    assert_eq!(
        names(&folder),
        [
            "a.apng",
            "a.gif",
            "a.gtr",
            "b-0001.png",
            "b-0002.png",
            "b-0003.png",
            "w.apng"
        ]
    );
}

#[test]
fn notes_of_all_frames_are_told_once() {
    let folder = folder(&[(
        "a.gtr",
        "param r : [0, 1]; point p = (1/r, 0, 0); point q = (sqrt(0.4 - r), 0, 0); point w = (sqrt(-1), 0, 0); \
         point o = (0, 0, 0);",
    )]);
    for change in ["r=0:1", "r=1:0"] {
        let words = "render a.gtr --size 20x20 --frames 3 -o a.gif --animate";
        let words: Vec<&str> = words.split(' ').chain([change]).collect();
        let run = run(folder.path(), &words, "");
        let lines = run.stderr.lines().filter(|line| line.starts_with("note: "));
        let mut notes: Vec<&str> = lines.collect();
        notes.sort_unstable();
        assert_eq!(
            notes,
            [
                "note: `w` is undefined at the current params and is not drawn",
                "note: in 1 of 3 frames: `p` is undefined at the current params and is not drawn",
                "note: in 2 of 3 frames: `q` is undefined at the current params and is not drawn",
            ]
        );
        assert!(run.stderr.contains("; 3 frames, "), "{}", run.stderr);
    }
}

#[test]
fn a_background_is_seen_where_nothing_is_drawn() {
    let folder = folder(&[("a.gtr", "point p = (0,0,0);")]);
    for (colour, alpha) in [("transparent", 0), ("#10203080", 128), ("white", 255)] {
        let arguments = [
            "render",
            "a.gtr",
            "-o",
            "a.png",
            "--size",
            "9x9",
            "--backend",
            "software",
            "--background",
            colour,
        ];
        let run = run(folder.path(), &arguments, "");
        assert_eq!(run.status, 0, "{}", run.stderr);
        let image = image::open(folder.path().join("a.png")).expect("the picture");
        assert_eq!(image.into_rgba8().get_pixel(0, 0).0[3], alpha);
    }
}

/// A box that is there from t = 5 on, before a ball.
const BOX_AND_BALL: &str = "Scene {
    if (t > 5) {
        Box { cornerA -> vec3(-4, -1, 7) cornerB -> vec3(-2, 1, 9) }
    }
    Sphere { center -> vec3(2, 0, 8) radius -> 1 }
}";

#[test]
fn names_of_a_script_are_those_of_the_scene_of_its_params() {
    let only_box = BOX_AND_BALL.replace("Sphere {", "unused = Sphere {");
    let only_ball = BOX_AND_BALL.replace("t > 5", "t > 50");
    let folder = folder(&[
        ("both.crt", BOX_AND_BALL),
        ("box.crt", &only_box),
        ("ball.crt", &only_ball),
    ]);
    let draw = |script: &str, options: &[&str]| {
        let common = [
            "render",
            script,
            "-o",
            "a.png",
            "--size",
            "60x40",
            "--backend",
            "software",
            "--set",
            "t=7",
        ];
        let run = run(folder.path(), &[&common[..], options].concat(), "");
        assert_eq!(run.status, 0, "{options:?}: {}", run.stderr);
        let picture = std::fs::read(folder.path().join("a.png")).expect("a picture");
        (picture, run.stderr.contains("note:"))
    };
    let space = ["--view", "3d", "--eye", "0,0,0", "--target", "0,0,8"];
    let without = |name| [&space[..], &["--hide", name]].concat();
    assert!(
        draw("both.crt", &without("5:5")) == draw("box.crt", &space),
        "the ball is hidden"
    );
    assert!(
        draw("both.crt", &without("3:9")) == draw("ball.crt", &space),
        "the box is hidden"
    );
    assert!(
        draw("box.crt", &space) != draw("ball.crt", &space),
        "both are seen"
    );
    let inside = ["--view", "geodesic:5:5"];
    assert!(
        draw("both.crt", &inside) == draw("ball.crt", &inside),
        "on the ball"
    );
    let camera = [&space[..], &["--show-camera", "5:5", "--hide", "3:9"]].concat();
    assert!(
        draw("both.crt", &camera) == draw("ball.crt", &camera[..8]),
        "on the ball"
    );
    // In an animation, names are those of each frame's scene.
    let arguments = [
        "render",
        "both.crt",
        "-o",
        "a.png",
        "--size",
        "60x40",
        "--backend",
        "software",
        "--view",
        "3d",
        "--eye",
        "0,0,0",
        "--target",
        "0,0,8",
        "--hide",
        "5:5",
        "--animate",
        "t=0:7",
        "--frames",
        "2",
    ];
    let run = run(folder.path(), &arguments, "");
    assert_eq!(run.status, 0, "{}", run.stderr);
    let last = std::fs::read(folder.path().join("a-0002.png")).expect("a picture");
    assert!(
        last == draw("box.crt", &space).0,
        "the ball is hidden at the end"
    );
}

#[test]
fn a_name_that_objects_share_stands_for_all_of_them() {
    let script = "Scene {
    k = 0
    while (k <= 2) {
        Sphere { center -> vec3(3*k - 3, 0, 8) radius -> 1 }
        k = k + 1
    }
}";
    let folder = folder(&[("d.crt", script)]);
    let export = |options: &[&str]| {
        let common = ["export", "d.crt", "-o", "d.obj"];
        run(folder.path(), &[&common[..], options].concat(), "")
    };
    let objects = |options: &[&str]| {
        let run = export(options);
        assert_eq!(run.status, 0, "{}", run.stderr);
        let text = std::fs::read_to_string(folder.path().join("d.obj")).expect("a file");
        text.lines().filter(|line| line.starts_with("o ")).count()
    };
    assert_eq!(objects(&[]), 3);
    assert_eq!(objects(&["--object", "4:9"]), 3);
    let wrong = export(&["--object", "4:8"]);
    assert!(
        wrong.stderr.contains("its only object is `4:9`"),
        "{}",
        wrong.stderr
    );
    let arguments = [
        "render", "d.crt", "-o", "d.png", "--size", "40x30", "--view", "3d", "--hide", "4:9",
    ];
    let hidden = run(folder.path(), &arguments, "");
    assert!(
        hidden.stderr.contains("shows no object"),
        "{}",
        hidden.stderr
    );
}

#[test]
fn a_colour_that_is_not_shown_is_reported() {
    let text = "solid b(x, y, z) = x^2 + y^2 + z^2 - 1, color : (0, 1, 0); \
        surface s(u, v) = (u, v, 2), u : [0, 1], v : [0, 1], color : (u, v, 0); \
        curve c(t) = (t, 0, 3), t : [0, 1], color : (1, 0, 0); point p = (0, 0, 2);";
    let folder = folder(&[("a.gtr", text)]);
    for (name, is_noted) in [("b", true), ("c", true), ("s", false), ("p", false)] {
        let colour = format!("{name}=#ff0000");
        let arguments = [
            "render", "a.gtr", "-o", "a.png", "--size", "40x30", "--colour", &colour,
        ];
        let run = run(folder.path(), &arguments, "");
        assert_eq!(run.status, 0, "{}", run.stderr);
        let note = format!("--colour {name}: the program states a `color`");
        assert_eq!(run.stderr.contains(&note), is_noted, "{}", run.stderr);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_path_of_standard_output_adds_to_what_the_file_has() {
    let folder = folder(&[("a.gtr", SPHERE), ("out.obj", "# before\n")]);
    let script = "{ \"$0\" export a.gtr -o /dev/stdout --format obj; echo '# after'; } >> out.obj";
    let ended = Command::new("sh")
        .args(["-c", script, env!("CARGO_BIN_EXE_geotrace")])
        .current_dir(folder.path())
        .output();
    let run = Run::of(ended.expect("sh runs"));
    assert_eq!(run.status, 0, "{}", run.stderr);
    let text = std::fs::read_to_string(folder.path().join("out.obj")).expect("a file");
    assert!(text.starts_with("# before\n"), "{text:.100}");
    assert!(text.contains("\nv ") && text.ends_with("\n# after\n"));
    let script = script.replace(">>", ">");
    let ended = Command::new("sh")
        .args(["-c", &script, env!("CARGO_BIN_EXE_geotrace")])
        .current_dir(folder.path())
        .output();
    assert_eq!(Run::of(ended.expect("sh runs")).status, 0);
    let again = std::fs::read_to_string(folder.path().join("out.obj")).expect("a file");
    assert_eq!(format!("# before\n{again}"), text);
    assert_eq!(names(&folder), ["a.gtr", "out.obj"]);
}

#[test]
fn standard_input_has_no_window_to_remember_it() {
    let folder = folder(&[]);
    let words = ["render", "-", "-o", "a.png", "--like-window"];
    let run = run(folder.path(), &words, SPHERE);
    assert_eq!(run.status, 1, "{}", run.stderr);
    assert!(run.stderr.contains("--like-window: "), "{}", run.stderr);
    assert!(!run.stderr.contains("help"), "{}", run.stderr);
}
