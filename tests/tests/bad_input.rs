//! Bad and extreme input through the binary: each gets the right answer or a clear error, within bounded memory,
//! with no panic and no half-written file. Statuses: 0 fine, 1 the program has errors, 2 wrong usage or files.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;
use testing::binary::{Run, geotrace};

/// No check of a small program may need more, in bytes of address space.
const MEMORY: u64 = 1 << 30;
/// No check may need more resident memory.
const RESIDENT: u64 = 400 << 20;

/// Checks a program given on standard input, as JSON.
#[track_caller]
fn check(program: impl Into<Vec<u8>>) -> Run {
    let run = geotrace(["check", "-", "--format", "json"])
        .input(program)
        .memory(MEMORY)
        .run();
    assert!(run.peak < RESIDENT, "{}: {} MB", run.what, run.peak >> 20);
    run
}

/// The first diagnostic of a run.
#[track_caller]
fn first(run: &Run) -> Value {
    let json = run.json();
    let first = &json["diagnostics"][0];
    assert!(first.is_object(), "no diagnostic in {json}");
    first.clone()
}

/// Checks that a program has an error of this code at this place.
#[track_caller]
fn error_at(program: impl Into<Vec<u8>>, code: &str, line: u64, column: u64) {
    let run = check(program);
    let found = first(run.expect_status(1));
    assert_eq!(found["code"], code, "{found}");
    assert_eq!(
        (found["line"].as_u64(), found["column"].as_u64()),
        (Some(line), Some(column)),
        "{found}"
    );
    assert!(
        found["message"]
            .as_str()
            .is_some_and(|text| text.len() > 10),
        "{found}"
    );
}

const SPHERE: &str =
    "surface s(u,v) = (cos v cos u, cos v sin u, sin v), u : [0, 2pi], v : [-pi/2, pi/2];\n";

#[test]
fn an_empty_program_and_comments_are_valid() {
    for program in ["", "\n", "  \t\r\n\n", "# nothing", "# é\n# ∂\n"] {
        let run = check(program);
        assert_eq!(
            run.expect_status(0).json()["diagnostics"],
            Value::Array(vec![])
        );
    }
    geotrace(["check", "-"]).run().expect_status(0);
}

#[test]
fn an_empty_program_gives_an_empty_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let picture = folder.path().join("empty.png");
    geotrace([
        "render",
        "-",
        "--backend",
        "software",
        "--size",
        "32x32",
        "-o",
    ])
    .argument(&picture)
    .run()
    .expect_status(0);
    let image = image::open(&picture).expect("a picture").to_rgba8();
    assert_eq!(image.dimensions(), (32, 32));
}

#[test]
fn bytes_that_are_no_text_have_a_place() {
    error_at("define a = 1;\ndefine b = \0;", "bad-character", 2, 12);
    error_at(b"define a = 1;\n# \xC3\xA9 \xFF\n", "invalid-utf8", 2, 5);
    error_at(b"\xFF\xFE\x00", "invalid-utf8", 1, 1);
    error_at(b"define a = 1;\n# \xE2\x82", "invalid-utf8", 2, 3);
    // All NUL, and a lot of it.
    check(vec![0; 1 << 20]).expect_status(1);
}

#[test]
fn ten_megabytes_on_one_line_are_read() {
    let mut sum = String::from("define a = 1");
    while sum.len() < 10_000_000 {
        sum.push_str("+1");
    }
    // Too large an expression may be refused, but with a sentence.
    let run = check(sum.clone() + ";\n");
    match run.status {
        Some(0) => {}
        _ => assert_eq!(first(run.expect_status(1))["code"], "expression-too-large"),
    }
    error_at(
        format!("# {}\nfoo", "x".repeat(10_000_000)),
        "expected-declaration",
        2,
        1,
    );
    let run = check("x".repeat(10_000_000));
    run.expect_status(1);
    let run = check("(".repeat(10_000_000));
    run.expect_status(1);
    let run = check(";".repeat(10_000_000));
    run.expect_status(1);
    let run = check("9".repeat(10_000_000));
    run.expect_status(1);
    // An error at the end of a long line has its column, and the terminal is spared the line.
    let run = geotrace(["check", "-"])
        .input(sum + "+;")
        .memory(MEMORY)
        .run();
    run.expect_status(1);
    assert!(
        run.stdout.len() < 20_000,
        "{} bytes of output",
        run.stdout.len()
    );
}

#[test]
fn deep_nesting_is_an_error_and_no_crash() {
    let deep = 100_000;
    for (open, middle, close) in [
        ("(", "1", ")"),
        ("[", "1", "]"),
        ("-", "1", ""),
        ("*", "1", ""),
        ("/", "1", ""),
        ("sin ", "1", ""),
        ("sin", "1", ""),
        ("sin(", "1", ")"),
        ("2^", "1", ""),
        ("2^-", "1", ""),
        ("sin^", "1", " 1"),
        ("(1,", "1", ")"),
    ] {
        let text = format!(
            "define a = {}{middle}{};",
            open.repeat(deep),
            close.repeat(deep)
        );
        let run = check(text);
        let found = first(run.expect_status(1));
        assert_eq!(found["code"], "too-deep", "{open}: {found}");
        assert_eq!(
            run.json()["diagnostics"].as_array().map(Vec::len),
            Some(1),
            "{open}"
        );
    }
    // What is long but not deep is no error.
    let flat = format!("define a = {}1;", "1*".repeat(100_000));
    check(flat).expect_status(0);
    let flat = format!("define a = ({}1);", "1,".repeat(10_000));
    check(flat).expect_status(0);
    // Primes and partial derivatives in a row.
    let primes = format!("define a = sin{} 1;", "'".repeat(100_000));
    let run = check(primes);
    assert!(run.status == Some(0) || run.status == Some(1), "{run:?}");
}

#[test]
fn derivatives_that_explode_are_an_error_and_no_hang() {
    let primes = "'".repeat(40);
    for body in [
        "exp sin(x^2)",
        "sin cos tan x",
        "x^x^x",
        "/(1+x^2)",
        "sqrt(1+sin^2 x)/(2+cos x)",
    ] {
        let program = format!("function f(x) = {body};\ndefine a = f{primes} 0.5;\n");
        let run = check(program);
        match run.status {
            Some(0) => {}
            _ => assert_eq!(
                first(run.expect_status(1))["code"],
                "expression-too-large",
                "{body}"
            ),
        }
    }
    // Functions that double what they take: the expression as a tree has 2^60 leaves.
    let mut program = String::from("function f0(x) = sin x;\n");
    for k in 1..60 {
        let _ = writeln!(
            program,
            "function f{k}(x) = f{}(x)f{}(x + 1);",
            k - 1,
            k - 1
        );
    }
    program.push_str("define a = f59 1;\n");
    let run = check(program);
    assert!(run.status == Some(0) || run.status == Some(1), "{run:?}");
    let mut program = String::from("function f0(x) = x + x;\n");
    for k in 1..60 {
        let _ = writeln!(program, "function f{k}(x) = f{}(f{}(x));", k - 1, k - 1);
    }
    program.push_str("define a = f59 1;\n");
    let run = check(program);
    assert!(run.status == Some(0) || run.status == Some(1), "{run:?}");
}

#[test]
fn solids_that_multiply_are_an_error_and_no_hang() {
    let ball = "solid s0(x,y,z) = x^2 + y^2 + z^2 - 1;\n";
    // Twice the leaves of the one above, in places of their own and in one place.
    for place in ["({k}, 0, 0)", "scale 1"] {
        let mut program = ball.to_owned();
        for k in 1..64 {
            let place = place.replace("{k}", &k.to_string());
            let _ = writeln!(program, "solid s{k} = s{} | s{} @ {place};", k - 1, k - 1);
        }
        let run = check(program);
        let found = first(run.expect_status(1));
        let code = found["code"].as_str();
        let expected = ["too-many-leaves", "expression-too-large"];
        assert!(code.is_some_and(|code| expected.contains(&code)), "{found}");
    }
    // One leaf more than the one above, ten thousand times.
    let mut program = ball.to_owned();
    for k in 1..10_000 {
        let _ = writeln!(program, "solid s{k} = s{} | s0 @ ({k}, 0, 0);", k - 1);
    }
    let run = check(program);
    assert_eq!(first(run.expect_status(1))["code"], "too-many-leaves");
    // Grids around grids.
    let mut program = format!("grid k : [0, 1, 100];\n{ball}");
    for k in 1..12 {
        let _ = writeln!(program, "solid s{k} = s{} @ (k, {k}, 0);", k - 1);
    }
    let run = check(program);
    assert_eq!(first(run.expect_status(1))["code"], "too-many-leaves");
    // As a function, a set is as large as its text.
    let mut program = ball.to_owned();
    for k in 1..14 {
        let _ = writeln!(
            program,
            "solid s{k} = s{} & s{} @ rotate ({k}, 1, 2);",
            k - 1,
            k - 1
        );
    }
    program.push_str("define a = s13_x_y_z_x_y_z(1, 2, 3);");
    let run = check(program);
    assert!(matches!(run.status, Some(0 | 1)), "{:?}", run.status);
}

#[test]
fn a_word_as_long_as_a_text_is_formatted_in_memory_that_grows_with_it() {
    let program = format!("define a = {};\n", "pi".repeat(200_000));
    let run = geotrace(["format", "-"])
        .input(program.as_str())
        .memory(MEMORY)
        .run();
    let run = run.expect_status(0);
    assert!(run.stdout == program, "it is laid out already");
    assert!(run.peak < RESIDENT, "{} MB", run.peak >> 20);
}

#[test]
fn a_text_of_tokens_alone_is_formatted_with_one_analysis_in_memory() {
    let run = geotrace(["format", "-"])
        .input(";".repeat(1_000_000))
        .memory(MEMORY)
        .run();
    let run = run.expect_status(0);
    // It holds no declaration, and stays as it is.
    assert!(run.stdout == format!("{}\n", ";".repeat(1_000_000)));
    assert!(run.peak < 2 * RESIDENT, "{} MB", run.peak >> 20);
}

#[test]
fn numbers_out_of_range_are_named() {
    error_at("define a = 1e999;", "number-out-of-range", 1, 12);
    error_at(
        format!("define a = {};", "9".repeat(400)),
        "number-out-of-range",
        1,
        12,
    );
    check("define a = 1e-999;").expect_status(0);
    error_at("param a : [0, 10^400];", "interval-undefined", 1, 11);
    error_at(
        "grid k : [0, 1, 10^9];\npoint p = (k, 0, 0);",
        "interval-count",
        1,
        10,
    );
    error_at(
        "grid a : [0, 1, 5000];\ngrid b : [0, 1, 5000];\npoint p = (a, b, 0);",
        "too-many-instances",
        3,
        7,
    );
    error_at(
        "surface s(u,v) = (u,v,0), u : [0,1,10^5], v : [0,1,10^5];",
        "too-many-samples",
        1,
        9,
    );
}

#[test]
fn a_name_and_a_list_of_params_have_a_greatest_length() {
    let name = "z".repeat(256);
    error_at(format!("define {name} = 1;"), "name-too-long", 1, 8);
    check(format!("define {} = 1;", &name[1..])).expect_status(0);
    let intervals = vec!["[0, 1]"; 10_000].join(",");
    error_at(
        format!("param a : {intervals};\nparam b : {intervals};"),
        "too-many-params",
        2,
        7,
    );
}

#[test]
fn the_last_of_too_many_errors_says_that_others_are_left_out() {
    let run = check("\0 ".repeat(100_001));
    let json = run.expect_status(1).json();
    let found = json["diagnostics"].as_array().expect("a list");
    assert_eq!(found.len(), 100_000);
    let (last, others) = found.split_last().expect("a diagnostic");
    assert_eq!(last["code"], "too-many-errors");
    assert!(others.iter().all(|it| it["code"] == "bad-character"));
}

#[test]
fn many_errors_are_all_counted_and_end() {
    let program = "define a = ;\n".repeat(20_000);
    let run = check(program.clone());
    let json = run.expect_status(1).json();
    assert!(
        json["diagnostics"]
            .as_array()
            .is_some_and(|list| list.len() >= 1000)
    );
    let run = geotrace(["check", "-"]).input(program).memory(MEMORY).run();
    run.expect_status(1);
    assert!(
        run.stdout.len() < 4_000_000,
        "{} bytes of output",
        run.stdout.len()
    );
}

#[test]
fn many_declarations_are_no_trouble() {
    let mut program = String::new();
    for k in 0..20_000 {
        let _ = writeln!(
            program,
            "define a{k} = {k} + {};",
            if k > 0 {
                format!("a{}", k - 1)
            } else {
                "0".into()
            }
        );
    }
    check(program).expect_status(0);
}

#[test]
fn files_that_cannot_be_read_are_wrong_usage() {
    let folder = tempfile::tempdir().expect("a folder");
    let missing = folder.path().join("missing.gtr");
    for command in ["check", "explain"] {
        let run = geotrace([command]).argument(&missing).run();
        run.expect_status(2).expect_text("missing.gtr");
    }
    geotrace(["check"])
        .argument(folder.path())
        .run()
        .expect_status(2);
    geotrace(["eval"])
        .argument(&missing)
        .argument("1")
        .run()
        .expect_status(2);
    geotrace(["render"])
        .argument(&missing)
        .argument("-o")
        .argument(folder.path().join("a.png"))
        .run()
        .expect_status(2);
    assert!(!folder.path().join("a.png").exists());
    // One bad file of several: the others are still checked.
    let good = folder.path().join("good.gtr");
    std::fs::write(&good, "define a = ;").expect("writable");
    let run = geotrace(["check"]).argument(&good).argument(&missing).run();
    run.expect_status(2).expect_text("good.gtr:1:12");
}

#[test]
fn a_file_that_is_longer_than_64_mb_is_not_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("long.gtr");
    // A sparse file: its bytes take no space.
    let file = std::fs::File::create(&path).expect("writable");
    file.set_len((64 << 20) + 1).expect("a long file");
    let long = geotrace(["check"]).argument(&path).memory(MEMORY).run();
    long.expect_status(2).expect_text("longer than 64 MB");
    let input = vec![b' '; (64 << 20) + 1];
    let long = geotrace(["check", "-"]).input(input).memory(MEMORY).run();
    long.expect_status(2).expect_text("longer than 64 MB");
    // One byte less is read.
    file.set_len(64 << 20).expect("a file");
    let run = geotrace(["check"]).argument(&path).memory(MEMORY).run();
    run.expect_status(1).expect_text("bad-character");
}

#[test]
fn wrong_usage_is_distinguished_from_errors_of_the_program() {
    geotrace(["paint"]).run().expect_status(2);
    geotrace(["check"]).run().expect_status(2);
    geotrace(["check", "-", "--format", "xml"])
        .run()
        .expect_status(2);
    geotrace(["render", "-"]).run().expect_status(2);
    geotrace(["--version"])
        .run()
        .expect_status(0)
        .expect_text("geotrace");
    for command in ["check", "render", "trace", "eval", "explain"] {
        geotrace([command, "--help"])
            .run()
            .expect_status(0)
            .expect_text(command);
    }
    geotrace(["--help"])
        .run()
        .expect_status(0)
        .expect_text("render");
}

/// Renders a program in an own folder, and checks that a failed run leaves nothing behind.
#[track_caller]
fn render(program: &str, more: &[&str], status: i32) -> Run {
    let folder = tempfile::tempdir().expect("a folder");
    let run = geotrace([
        "render",
        "-",
        "--backend",
        "software",
        "-o",
        "out.png",
        "--size",
        "16x16",
    ])
    .arguments(more)
    .folder(folder.path())
    .input(program)
    .run();
    run.expect_status(status);
    let left: Vec<_> = std::fs::read_dir(folder.path())
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name())
        .collect();
    if status == 0 {
        assert_eq!(left, ["out.png"], "{}", run.what);
        image::open(folder.path().join("out.png")).expect("a whole picture");
    } else {
        assert!(left.is_empty(), "{} leaves {left:?}", run.what);
        assert!(run.stderr.len() > 10, "{}: no sentence", run.what);
    }
    run
}

#[test]
fn a_program_with_errors_is_not_drawn() {
    let run = render("define a = ;", &[], 1);
    run.expect_text("1:12");
    render(SPHERE, &[], 0);
}

#[test]
fn wrong_options_of_render_are_named() {
    render(SPHERE, &["--size", "0x0"], 2);
    render(SPHERE, &["--size", "100"], 2);
    render(SPHERE, &["--size", "100000x100000"], 2);
    render(SPHERE, &["--view", "sideways"], 2);
    render(SPHERE, &["--view", "geodesic:t"], 2).expect_text("t");
    render("point p = (1,2,3);", &["--view", "geodesic"], 2).expect_text("surface");
    render(SPHERE, &["--set", "r=1"], 2).expect_text("r");
    render(SPHERE, &["--set", "r"], 2);
    render("param r : [0,1]; point p = (r,r,r);", &["--set", "r=2"], 2).expect_text("r");
    render("param r : [0,1]; point p = (r,r,r);", &["--set", "r=x"], 2);
    render(
        "param r : [0,1]; point p = (r,r,r);",
        &["--set", "r=nan"],
        2,
    );
    render(
        "param r : [0,1]; point p = (r,r,r);",
        &["--set", "r=0.5,0.5"],
        2,
    );
    render(
        "param r : [-1,1]; point p = (r,r,r);",
        &["--set", "r=-0.5"],
        0,
    );
    render(SPHERE, &["--texture", "s=missing.png"], 2).expect_text("missing.png");
    render(SPHERE, &["--texture", "t=missing.png"], 2);
    render(SPHERE, &["--view", "geodesic", "--at", "nan,0"], 2);
    render(SPHERE, &["--view", "geodesic", "--zoom", "-1"], 2);
    render(SPHERE, &["--view", "geodesic", "--zoom", "1e300"], 2).expect_text("1e30");
    render(SPHERE, &["--eye", "1,2"], 2);
    render(SPHERE, &["--eye", "1e308,0,0"], 2).expect_text("too far from its target");
    let beyond = ["--set", "r=1e300"];
    render("param r : [0,1]; point p = (r,r,r);", &beyond, 2).expect_text("`r` = 1e300 lies");
}

#[test]
fn a_value_that_an_animation_gives_has_a_note() {
    let folder = tempfile::tempdir().expect("a folder");
    let words = "render - --backend software -o q.gif --size 16x16 --frames 2 --animate r=0:1";
    let run = geotrace(words.split(' ').chain(["--set", "r=0.5", "--set", "a=2"]))
        .folder(folder.path())
        .input("param r : [0, 1]; param a : [0, 2]; point p = (r, a, 0);")
        .run();
    run.expect_status(0);
    let notes: Vec<&str> = run
        .stderr
        .lines()
        .filter(|line| line.contains("--set"))
        .collect();
    assert_eq!(
        notes,
        ["note: --set r has no effect: `--animate r` gives the value in each frame"]
    );
}

#[test]
fn a_file_that_is_no_picture_is_no_texture() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("bad.png"), b"no picture").expect("writable");
    let run = geotrace([
        "render",
        "-",
        "--backend",
        "software",
        "-o",
        "out.png",
        "--texture",
        "s=bad.png",
    ])
    .folder(folder.path())
    .input(SPHERE)
    .run();
    run.expect_status(1).expect_text("bad.png");
    assert!(!folder.path().join("out.png").exists());
}

#[test]
fn an_image_without_bounds_is_no_texture() {
    let folder = tempfile::tempdir().expect("a folder");
    // Some hundred kilobytes that decode to more pixels than a texture may have.
    let (width, height) = (8_192, 8_200);
    let black = image::GrayImage::new(width, height);
    let file = std::fs::File::create(folder.path().join("black.png")).expect("writable");
    let fast = image::codecs::png::CompressionType::Fast;
    let plain = image::codecs::png::FilterType::NoFilter;
    let encoder = image::codecs::png::PngEncoder::new_with_quality(file, fast, plain);
    black.write_with_encoder(encoder).expect("a picture");
    let render = |texture: &str| {
        geotrace(["render", "-", "--backend", "software", "-o", "out.png"])
            .arguments(&["--texture", &format!("s={texture}")])
            .folder(folder.path())
            .input(SPHERE)
            .run()
    };
    render("black.png")
        .expect_status(1)
        .expect_text("67 million pixels");
    render(".").expect_text("it is not a regular file");
    #[cfg(unix)]
    render("/dev/zero").expect_text("it is not a regular file");
    assert!(!folder.path().join("out.png").exists());
}

#[test]
fn an_output_that_cannot_be_written_is_named_and_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    for target in ["no/such/folder/out.png", ".", "/proc/out.png"] {
        let run = geotrace([
            "render",
            "-",
            "--backend",
            "software",
            "--size",
            "16x16",
            "-o",
            target,
        ])
        .folder(folder.path())
        .input(SPHERE)
        .run();
        run.expect_status(2);
        assert!(run.stderr.len() > 10, "{}: no sentence", run.what);
    }
    assert_eq!(
        std::fs::read_dir(folder.path()).expect("a folder").count(),
        0
    );
}

#[test]
fn a_failed_render_keeps_the_older_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let picture = folder.path().join("out.png");
    std::fs::write(&picture, b"older").expect("writable");
    geotrace(["render", "-", "--backend", "software", "-o"])
        .argument(&picture)
        .input("define a = ;")
        .run()
        .expect_status(1);
    assert_eq!(std::fs::read(&picture).expect("still there"), b"older");
}

#[test]
fn a_program_is_not_written_over_by_what_is_made_of_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = folder.path().join("s.gtr");
    std::fs::write(&program, SPHERE).expect("writable");
    let run = geotrace(["export", "--format", "obj", "s.gtr", "-o", "./s.gtr"])
        .folder(folder.path())
        .run();
    run.expect_status(2).expect_text("it is the program itself");
    assert_eq!(std::fs::read_to_string(&program).expect("there"), SPHERE);
}

#[test]
fn a_tolerance_that_follows_nothing_is_refused() {
    let run = geotrace(["trace", "-", "--tolerance", "1e300"])
        .input(SPHERE)
        .run();
    run.expect_status(2).expect_text("it must be at most 0.01");
}

#[test]
fn a_trace_asks_for_what_it_needs() {
    let trace = |more: &[&str]| {
        geotrace(["trace", "-", "--format", "json"])
            .arguments(more)
            .input(SPHERE)
            .run()
    };
    let good = [
        "--surface",
        "s",
        "--from",
        "1,0",
        "--direction",
        "1,0",
        "--length",
        "1",
    ];
    trace(&good).expect_status(0);
    trace(&[
        "--surface",
        "t",
        "--from",
        "1,0",
        "--direction",
        "1,0",
        "--length",
        "1",
    ])
    .expect_status(2)
    .expect_text("t");
    trace(&["--surface", "s", "--from", "1,0", "--length", "1"]).expect_status(2);
    trace(&[
        "--surface",
        "s",
        "--from",
        "1,0",
        "--direction",
        "0,0",
        "--length",
        "1",
    ])
    .expect_status(2);
    trace(&[
        "--surface",
        "s",
        "--from",
        "1",
        "--direction",
        "1,0",
        "--length",
        "1",
    ])
    .expect_status(2);
    trace(&[
        "--surface",
        "s",
        "--from",
        "nan,0",
        "--direction",
        "1,0",
        "--length",
        "1",
    ])
    .expect_status(2);
    trace(&[
        "--surface",
        "s",
        "--from",
        "1,0",
        "--direction",
        "1,0",
        "--length",
        "inf",
    ])
    .expect_status(2);
    let zero = trace(&[
        "--surface",
        "s",
        "--from",
        "-2,-0.3",
        "--direction",
        "1,0",
        "--length",
        "0",
    ]);
    assert_eq!(zero.expect_status(0).json()["status"], "complete");
    // A length without end is cut by the limit of work, and says so.
    let long = trace(&[
        "--surface",
        "s",
        "--from",
        "1,0",
        "--direction",
        "1,0.5",
        "--length",
        "1e9",
    ]);
    assert_eq!(long.expect_status(0).json()["status"], "work_limit");
}

#[test]
fn eval_reports_in_the_expression() {
    let eval = |expression: &str| {
        geotrace(["eval", "-", "--format", "json"])
            .argument(expression)
            .input(SPHERE)
            .run()
    };
    assert_eq!(eval("1/2").expect_status(0).json()["value"], 0.5);
    assert_eq!(eval("-1").expect_status(0).json()["value"], -1.0);
    assert_eq!(eval("0/0").expect_status(0).json()["value"], Value::Null);
    assert_eq!(
        eval("(1,0/0)").expect_status(0).json()["value"],
        serde_json::json!([1.0, null])
    );
    for wrong in ["", "1 +", "foo", "1; define a = 2", "(1,2) + 1", "s"] {
        eval(wrong).expect_status(1);
    }
    eval(&"(".repeat(50_000)).expect_status(1);
    // A geodesic that ends before has none there.
    let run = geotrace(["eval", "-", "g(2)"])
        .input(
            "surface s(u, v) = (u, v, 0), u : [0, 1], v : [0, 1];\n\
             geodesic g(t) : s = (1, 0) @ (0.25, 0.5), t : [0, 2];\n",
        )
        .run();
    run.expect_status(0).expect_text("[geodesic-undefined]");
    // A program with errors has no values.
    let run = geotrace(["eval", "-", "1"]).input("define a = ;").run();
    run.expect_status(1).expect_text("1:12");
}

#[test]
fn a_pole_of_the_expression_is_reported_and_not_drawn() {
    let run = render(
        "param a : [0, 1];\npoint p = (1/a, 0, 0);\npoint q = (1, 1, 1);\n",
        &[],
        0,
    );
    run.expect_text("p");
    render(
        "surface s(u,v) = (u, v, 0/0), u : [0,1], v : [0,1];",
        &[],
        0,
    );
    render("curve c(t) = (log t, 0, 0), t : [-1, 1];", &[], 0);
    render(
        "surface s(u,v) = (u, v, 1/u), u : [-1,1], v : [0,1];",
        &[],
        0,
    );
    render(
        "surface s(u,v) = (u, v, exp(1000u)), u : [-1,1], v : [0,1];",
        &[],
        0,
    );
    render(
        "surface s(u,v) = (0, 0, 0), u : [-1,1], v : [0,1];",
        &["--view", "geodesic"],
        1,
    );
}

#[test]
fn standard_input_and_files_give_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("s.gtr");
    std::fs::write(&file, SPHERE).expect("writable");
    let from_file = geotrace(["explain", "--format", "json"])
        .argument(&file)
        .run();
    let from_input = geotrace(["explain", "-", "--format", "json"])
        .input(SPHERE)
        .run();
    let strip = |run: &Run| {
        let mut json = run.expect_status(0).json();
        if let Some(object) = json.as_object_mut() {
            object.remove("file");
        }
        json
    };
    assert_eq!(strip(&from_file), strip(&from_input));
    assert!(Path::new(&file).exists());
}

#[test]
fn json_of_check_has_the_shape_of_the_contract() {
    let run = check("define a = 1;\ndefine b = foo;\n");
    let found = first(run.expect_status(1));
    assert_eq!(found["line"], 2);
    assert_eq!(found["column"], 12);
    assert_eq!(found["end_line"], 2);
    assert_eq!(found["end_column"], 15);
    assert_eq!(found["severity"], "error");
    assert_eq!(found["code"], "undefined-name");
    assert!(found["file"].is_string() && found["message"].is_string());
    assert!(found.get("hint").is_some(), "{found}");
    // Warnings do not change the status.
    let run = check("define x = 1;\ndefine a = sin 2x;\n");
    let found = first(run.expect_status(0));
    assert_eq!(found["severity"], "warning");
    // The form for people.
    let run = geotrace(["check", "-"]).input("define b = foo;\n").run();
    let line = run
        .expect_status(1)
        .stdout
        .lines()
        .next()
        .unwrap_or("")
        .to_owned();
    assert!(
        line.contains(":1:12: error[undefined-name]: `foo` is not defined"),
        "{line}"
    );
}

/// Ends a recording by a signal when this number of files is there; the names that are left, and the signal. The second
/// file is the one that a check of the folder creates, the others are pictures.
#[cfg(unix)]
fn interrupted(signal: &str, files: usize) -> (Vec<String>, Option<i32>) {
    use std::os::unix::process::ExitStatusExt;
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(
        folder.path().join("s.gtr"),
        "param o : [0, 1]; point p = (o, 0, 0);",
    )
    .expect("writable");
    let binary = testing::binary::binary();
    let mut render = std::process::Command::new(binary);
    if signal == "-HUP" {
        // Also where the tests themselves run under `nohup`.
        render = std::process::Command::new("env");
        render.arg("--default-signal=HUP").arg(binary);
    }
    render.args(["render", "s.gtr", "-o", "q.png", "--animate", "o=0:1"]);
    render.args([
        "--size",
        "16x16",
        "--frames",
        "100000",
        "--backend",
        "software",
    ]);
    let mut child = render
        .current_dir(folder.path())
        .stderr(std::process::Stdio::null())
        .spawn()
        .expect("the binary starts");
    let names = || {
        let entries = std::fs::read_dir(folder.path()).expect("a folder");
        let names = entries.map(|entry| entry.expect("an entry").file_name());
        names
            .map(|name| name.to_string_lossy().into_owned())
            .collect::<Vec<_>>()
    };
    while names().len() < files {
        std::thread::sleep(std::time::Duration::from_micros(100));
    }
    let id = child.id().to_string();
    let kill = std::process::Command::new("kill")
        .args([signal, &id])
        .status();
    assert!(kill.expect("it runs").success());
    let status = child.wait().expect("it ends");
    (names(), status.signal())
}

/// Interrupts the drawing of something that would take hours and is to be kept, once a part of it is done; what it has
/// printed.
#[cfg(unix)]
fn kept(folder: &Path, options: &str) -> String {
    let mut patience = std::time::Duration::from_millis(500);
    loop {
        let mut drawing = std::process::Command::new(testing::binary::binary())
            .current_dir(folder)
            .args(["render", "s.gtr", "--partial", "--view", "traced"])
            .args(options.split_whitespace())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .expect("the binary starts");
        std::thread::sleep(patience);
        let kill = std::process::Command::new("kill")
            .args(["-INT", &drawing.id().to_string()])
            .status();
        assert!(kill.expect("it runs").success());
        let mut printed = String::new();
        let mut errors = drawing.stderr.take().expect("it is piped");
        std::io::Read::read_to_string(&mut errors, &mut printed).expect("text");
        if drawing.wait().expect("it ends").success() {
            return printed;
        }
        // On a busy machine it has not begun yet.
        patience *= 2;
        assert!(patience.as_secs() < 60, "{printed}");
    }
}

#[cfg(unix)]
#[test]
fn a_part_of_a_picture_is_kept_where_that_is_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "param a : [0, 1]; solid s(x,y,z) = x^2 + y^2 + z^2 - 1; light l = @ (a,-3,4);";
    std::fs::write(folder.path().join("s.gtr"), text).expect("written");
    let printed = kept(folder.path(), "-o out.png --size 64x48 --samples 65536");
    assert!(
        printed.contains("note: interrupted: each pixel has "),
        "{printed}"
    );
    assert!(printed.contains(" of its 65536 samples"), "{printed}");
    let picture = image::open(folder.path().join("out.png")).expect("a picture");
    assert_eq!((picture.width(), picture.height()), (64, 48));
    // A picture of the series is large, so that the signal comes before its first sample is done.
    let series = "-o f.png --size 1600x1200 --animate a=0:1 --frames 100000 --samples 1";
    let printed = kept(folder.path(), series);
    assert!(printed.contains(" of 100000 frames"), "{printed}");
    let files = std::fs::read_dir(folder.path()).expect("a folder").count();
    assert!(files > 2, "{printed}");
    let video = "render s.gtr -o f.apng --animate a=0:1 --partial";
    let refused = geotrace(video.split_whitespace())
        .folder(folder.path())
        .run();
    assert!(
        refused
            .expect_status(2)
            .stderr
            .contains("--partial cannot keep a part")
    );
}

/// A closed terminal ends what runs in it, unless it was begun by `nohup`.
#[cfg(target_os = "linux")]
#[test]
fn a_closed_terminal_leaves_nothing_behind() {
    assert_eq!(interrupted("-HUP", 20), (vec!["s.gtr".to_owned()], Some(1)));
}

#[cfg(unix)]
#[test]
fn a_file_that_may_not_grow_is_reported_and_leaves_nothing_behind() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(
        folder.path().join("s.gtr"),
        "surface s(u, v) = (u, v, u v), u : [0, 1], v : [0, 1];",
    )
    .expect("written");
    let export = format!(
        "ulimit -f 1; exec '{}' export s.gtr -o s.obj",
        testing::binary::binary().display()
    );
    let run = std::process::Command::new("sh")
        .args(["-c", &export])
        .current_dir(folder.path())
        .output()
        .expect("it runs");
    let printed = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.code().is_some_and(|code| code > 0), "{run:?}");
    assert!(printed.contains("s.obj"), "{printed}");
    let left = std::fs::read_dir(folder.path()).expect("a folder").count();
    assert_eq!(left, 1, "{printed}");
}

#[test]
fn a_spacing_and_angles_may_be_expressions_and_a_spacing_is_positive() {
    let folder = tempfile::tempdir().expect("a folder");
    let drawn = |spacing: &str, angle: &str| {
        let picture = folder.path().join("p.png");
        let run = geotrace([
            "render", "-", "-o", "p.png", "--size", "64x64", "--view", "geodesic", "--angle", angle,
        ])
        .argument(format!("--wavefronts={spacing}"))
        .folder(folder.path())
        .input(SPHERE)
        .run();
        (run, std::fs::read(picture).unwrap_or_default())
    };
    let (run, picture) = drawn("0.5", "45");
    run.expect_status(0);
    let (run, by_expressions) = drawn("1/2", "90/2");
    run.expect_status(0);
    assert!(picture == by_expressions);
    for spacing in ["0", "1 - 2"] {
        let (run, _) = drawn(spacing, "0");
        run.expect_status(2);
        assert!(
            run.stderr
                .contains("--wavefronts: it must be greater than 0"),
            "{}",
            run.stderr
        );
    }
    let traced = |heading: &str| {
        let arguments = ["trace", "-", "--from", "0,0", "--length", "1", "--heading"];
        geotrace(arguments).argument(heading).input(SPHERE).run()
    };
    assert_eq!(traced("45").stdout, traced("90/2").stdout);
    for heading in ["nan", "0/0", "(1, 2)"] {
        traced(heading).expect_status(2);
    }
}

#[test]
fn wavefronts_that_are_too_close_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    for (spacing, drawn) in [("0.5", true), ("0.001", false)] {
        let arguments = [
            "render", "-", "-o", "p.png", "--size", "64x64", "--view", "geodesic",
        ];
        let run = geotrace(arguments)
            .argument("--wavefronts")
            .argument(spacing)
            .folder(folder.path())
            .input(SPHERE)
            .run();
        run.expect_status(0);
        let is_noted = run
            .stderr
            .contains("are less than 3 pixels apart here: none is drawn");
        assert_eq!(is_noted, !drawn, "{run:?}");
    }
}

#[test]
fn no_picture_takes_the_place_of_an_image_that_it_shows() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let program =
        format!("{SPHERE} surface t(u, v) = 2s(u, v), u : [0, 1], v : [0, 1], image : map;");
    std::fs::write(path("a.gtr"), program).expect("written");
    for name in ["map.png", "q-0001.png"] {
        image::RgbaImage::new(2, 2)
            .save(path(name))
            .expect("written");
    }
    let images = ["map.png", "q-0001.png"].map(|name| std::fs::read(path(name)).expect("read"));
    for arguments in [
        "render a.gtr -o map.png",
        "render a.gtr -o ./map.png --frames 3 --turntable",
        "render a.gtr -o q-0001.png --texture s=q-0001.png",
        "render a.gtr -o q.png --frames 3 --turntable --texture s=q-0001.png",
        "export a.gtr --format obj -o map.png",
    ] {
        let run = geotrace(arguments.split(' ')).folder(folder.path()).run();
        if arguments.starts_with("render a.gtr -o ./map.png") {
            // The pictures of a series have numbers.
            run.expect_status(0);
        } else {
            run.expect_status(2)
                .expect_text("it is one of the images of the picture");
        }
        let left = ["map.png", "q-0001.png"].map(|name| std::fs::read(path(name)).expect("read"));
        assert!(left == images, "{arguments}");
    }
    // One that cannot be read is somebody's file too.
    std::fs::write(path("map.png"), "no image").expect("written");
    let run = geotrace("render a.gtr -o map.png".split(' '));
    let run = run.folder(folder.path()).run();
    run.expect_status(2)
        .expect_text("it is one of the images of the picture");
}

#[test]
fn no_picture_takes_the_place_of_its_own_program() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("own.png");
    std::fs::write(&file, "point p = (1, 2, 3);").expect("written");
    let run = geotrace(["render", "own.png", "-o", "./own.png"])
        .folder(folder.path())
        .run();
    assert_eq!(run.status, Some(2), "{run:?}");
    run.expect_text("it is the program itself");
    let text = std::fs::read_to_string(&file).expect("it is there");
    assert_eq!(text, "point p = (1, 2, 3);");
}

#[test]
fn a_walk_ends_on_an_edge_or_says_that_it_is_too_long() {
    let folder = tempfile::tempdir().expect("a folder");
    let draw = |program: &str, angle: &str, length: &str| {
        std::fs::write(folder.path().join("s.gtr"), program).expect("written");
        let options = "render s.gtr -o s.png --size 32x32 --view geodesic --angle";
        geotrace(options.split(' ').chain([angle, "--walk", length]))
            .folder(folder.path())
            .run()
    };
    let plane = "surface s(u, v) = (u, v, 0), u : [-1, 1], v : [-1, 1];";
    let note = "the walk ends at an edge of the surface, after 1\n";
    for (length, is_cut) in [("0.999", false), ("1", false), ("5", true), ("-5", true)] {
        let run = draw(plane, "0", length);
        run.expect_status(0);
        assert_eq!(
            run.stderr.contains(note),
            is_cut,
            "{length}: {}",
            run.stderr
        );
    }
    let sphere =
        "surface s(u, v) = (cosu cosv, sinu cosv, sinv), u : [-pi, pi], v : [-pi/2, pi/2];";
    let ball = "solid s(x, y, z) = x^2 + y^2 + z^2 - 1;";
    for program in [sphere, ball] {
        draw(program, "20", "30").expect_status(0);
        let run = draw(program, "20", "1e6");
        assert_eq!(run.status, Some(2), "{run:?}");
        run.expect_text("the camera cannot walk there: it exceeds the limit of steps at length");
    }
}

#[test]
fn thousands_of_solids_are_framed_within_memory() {
    let folder = tempfile::tempdir().expect("a folder");
    let script = "Scene { i = 0\nwhile (i < 5000) { Sphere { center -> vec3(i, 0, 0) radius -> 0.4 } i = i + 1 } }\n";
    std::fs::write(folder.path().join("many.crt"), script).expect("written");
    let run = geotrace(["render", "many.crt", "-o", "many.png", "--size", "20x20"])
        .folder(folder.path())
        .run();
    run.expect_status(0);
    assert!(run.peak < RESIDENT, "{} MB", run.peak >> 20);
}

#[test]
fn a_ray_through_a_thousand_leaves_is_cast_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = "grid k : [0, 1, 1000];\nfunction f(x, y, z) = x^2 + y^2 + z^2 - 1;\nsolid b = f @ (0.1k, 0, 0);\n";
    std::fs::write(folder.path().join("deep.gtr"), program).expect("written");
    let run = geotrace([
        "cast",
        "deep.gtr",
        "--from",
        "0,0,5",
        "--direction",
        "0,0,-1",
    ])
    .folder(folder.path())
    .run();
    run.expect_status(0).expect_text("enters");
}

#[test]
fn rays_are_read_line_by_line_and_a_line_without_end_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(
        folder.path().join("b.gtr"),
        "solid b(x, y, z) = x^2 + y^2 + z^2 - 1;",
    )
    .expect("written");
    let cast = |rays: String| {
        geotrace(["cast", "b.gtr", "--rays", "-"])
            .folder(folder.path())
            .input(rays)
            .run()
    };
    let run = cast(" ".repeat(20 << 20));
    assert_eq!(run.status, Some(2), "{:?}", run.stderr);
    run.expect_text("line 1 is longer than 4096 bytes");
    assert!(run.peak < 100 << 20, "{} MB", run.peak >> 20);
    // A mark at the beginning is none of the number.
    cast("\u{FEFF}3 0 0 -1 0 0\n".to_owned())
        .expect_status(0)
        .expect_text("enters");
}

#[cfg(unix)]
#[test]
fn an_interruption_leaves_nothing_behind() {
    for (name, number) in [("-INT", 2), ("-TERM", 15), ("-QUIT", 3)] {
        for files in [2, 20] {
            assert_eq!(
                interrupted(name, files),
                (vec!["s.gtr".to_owned()], Some(number)),
                "{name} {files}"
            );
        }
    }
}
