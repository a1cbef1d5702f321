//! Commands: random options, random geodesics, and programs without bounds.

use std::time::Duration;

use testing::binary::{Run, geotrace};
use testing::examples::repository;

use super::hostile::{HUGE, program};
use crate::mutation::Random;
use crate::run::Report;

/// The longest time of a command, far more than each should need.
const PATIENCE: Duration = Duration::from_secs(120);

/// What holds of every run: a status that is known, no panic, and a sentence where it is not 0.
fn check(run: &Run) -> u64 {
    let status = run.status;
    assert!(
        matches!(status, Some(0..=2)),
        "{}: {status:?}\n{}",
        run.what,
        run.stderr
    );
    assert!(!run.stderr.contains("panicked"), "{}", run.stderr);
    let printed = run.stdout.len() + run.stderr.len();
    assert!(
        status == Some(0) || printed > 10,
        "{}: no sentence",
        run.what
    );
    run.peak
}

/// Traces random geodesics of random metrics and surfaces.
pub(super) fn traces(seed: u64, count: u64) -> Report {
    let places = ["0,0", "0.5,0.5", "1,1", "1e-3,0.1", "1e308,0", "-1,0.3"];
    let lengths = ["1", "0", "5", "1e-300", "1e300", "-2", "20"];
    let mut random = Random::new(seed);
    let mut report = Report::default();
    for _ in 0..count {
        if report.is_hopeless() {
            break;
        }
        let program = program(&mut random, true);
        let from = format!("--from={}", random.choose(&places));
        let heading = format!("--heading={}", random.below(360));
        let length = format!("--length={}", random.choose(&lengths));
        let input = format!("{program}# {from} {heading} {length}\n");
        report.attempt(input.as_bytes(), || {
            let run = geotrace(["trace", "-", "--format", "json"])
                .arguments(&[&from, &heading, &length])
                .argument("--max-evaluations=20000")
                .input(program.as_str())
                .within(PATIENCE)
                .run();
            if run.status == Some(0) {
                assert!(run.json()["status"].is_string(), "{}", run.stdout);
            }
            check(&run)
        });
    }
    report
}

/// Options with values, of which most are wrong.
const OPTIONS: &[(&str, &[&str])] = &[
    (
        "--size",
        &[
            "64x48",
            "1x1",
            "0x0",
            "-1x5",
            "70000x70000",
            "99999999999x1",
            "x",
            "5",
            "200x2",
        ],
    ),
    (
        "--view",
        &[
            "3d",
            "geodesic",
            "geodesic:s",
            "traced",
            "geodesic:zz",
            "traced:zz",
            "4d",
            "",
        ],
    ),
    (
        "--set",
        &[
            "r=0.5",
            "r=1e300",
            "r=-1e-300",
            "q=1",
            "r",
            "=",
            "r=1/0",
            "r=zz",
            "o=3",
        ],
    ),
    (
        "--zoom",
        &[
            "1", "0", "-1", "1e308", "1e-308", "1/0", "pi/2", "zz", "100",
        ],
    ),
    (
        "--at",
        &["0,0", "1,2", "1e308,1e308", "1/0,0", ",", "0", "1,2,3"],
    ),
    ("--angle", &["0", "1e300", "-45", "zz"]),
    (
        "--eye",
        &[
            "3,2,1",
            "0,0,0",
            "1e308,0,0",
            "1e-308,0,0",
            "1,2",
            "1/0,0,0",
        ],
    ),
    ("--target", &["0,0,0", "3,2,1", "1e308,1e308,1e308", "zz"]),
    (
        "--texture",
        &[
            "s=/dev/zero",
            "s=/dev/null",
            "s=.",
            "s=none.png",
            "s=curvature",
            "s=plain",
            "zz=plain",
            "s",
        ],
    ),
    ("--colour", &["s=#1a2b3c", "s=#1", "zz=white", "s="]),
    ("--scale", &["1", "0", "-1", "1e308", "50"]),
    ("--background", &["transparent", "#12345678", "#1", "zz"]),
    ("--theme", &["print", "screen", "zz"]),
    (
        "--method",
        &["fan", "fan-linear", "adaptive", "rk4-pixel", "zz"],
    ),
    ("--wavefronts", &["1", "0", "1e-300", "1e300", "-1"]),
    ("--walk", &["1", "-1", "1e9", "1e308", "1/0"]),
    (
        "--animate",
        &["r=0.4:0.6", "r=1:1e308", "r=zz", "zz=0:1", "r", "o=0:1"],
    ),
    ("--frames", &["2", "3", "0", "1", "-1", "x", "1e9"]),
    ("--fps", &["25", "1e300", "1e-300", "0", "-1"]),
    ("--course", &["once", "loop", "back-and-forth", "zz"]),
    ("--samples", &["1", "2", "0", "1e99", "-1"]),
    ("--bounces", &["0", "1", "99999999", "-1"]),
    (
        "--figure",
        &[
            "s=distance:0,0:1,1",
            "s=circle:0,0:1e308",
            "s=triangle:0,0:0,0:0,0",
            "s=zz:0",
            "zz=place:0,0",
        ],
    ),
    ("--path", &["s=0,0:1,1", "s=1e308,0:0,1e308", "s=", "s=0,0"]),
    ("--setting", &["centre=off", "centre=zz", "zz=on"]),
    ("--flip", &["s", "zz"]),
    ("--hide", &["s", "zz"]),
    ("--show-camera", &["s", "zz"]),
    ("--look", &["geotrace", "crt", "zz"]),
    ("--gamma", &["1", "0", "1e308", "-1"]),
    ("--images", &[".", "/no/such", "/dev/zero"]),
    ("--format", &["json", "human", "obj", "zz"]),
    ("--object", &["s", "zz"]),
    ("--from", &["0,0", "1e308,0", "1,2,3", "zz"]),
    ("--heading", &["30", "1e300", "1/0"]),
    ("--length", &["1", "-1", "1e300", "0", "zz"]),
    ("--tolerance", &["1e-6", "1e300", "0", "-1", "1e-300"]),
    ("--max-evaluations", &["1000", "0", "-1", "1e99"]),
    ("--steps", &["10", "0", "-1", "99999999999999999999"]),
    ("--circle", &["0.1", "0", "-1", "1e308"]),
];
/// Options without values.
const FLAGS: &[&str] = &[
    "--legend",
    "--labels",
    "--conjugate",
    "--cut-locus",
    "--error",
    "--axes",
    "--orthographic",
    "--mirrored",
    "--trail",
    "--turntable",
    "--like-window",
    "--partial",
    "--no-such-option",
];
const OUTPUTS: &[&str] = &[
    "o.png",
    "o.gif",
    "o.apng",
    "o.svg",
    "o.pdf",
    "o.obj",
    "o.glb",
    "o.ply",
    "o.stl",
    "o.xyz",
    "no/o.png",
    ".",
    "-",
    "/dev/full",
    "/proc/o.png",
    "p.gtr",
    "o\n.png",
];
const PROGRAMS: &[&str] = &[
    "torus.gtr",
    "sphere.gtr",
    "halfplane.gtr",
    "circle.gtr",
    "cone.gtr",
    "dice.gtr",
    "field.gtr",
    "bokeh.crt",
];

/// Runs commands with random options.
pub(super) fn options(seed: u64, count: u64) -> Report {
    let mut random = Random::new(seed);
    let mut report = Report::default();
    for _ in 0..count {
        if report.is_hopeless() {
            break;
        }
        let name = random.choose(PROGRAMS);
        let command = random.choose(&[
            "render", "render", "render", "export", "trace", "measure", "eval", "explain",
        ]);
        let output = random.choose(OUTPUTS);
        let mut arguments = vec![command.to_owned(), "p.gtr".to_owned()];
        match command {
            "render" => arguments.extend([
                "--backend=software".to_owned(),
                "-o".to_owned(),
                output.to_owned(),
            ]),
            "export" => arguments.extend(["-o".to_owned(), output.to_owned()]),
            "trace" => {
                arguments.extend(["--from=0,0", "--heading=30", "--length=1"].map(str::to_owned))
            }
            "measure" => arguments.push("--at=0,0".to_owned()),
            "eval" => arguments.push("1/0".to_owned()),
            _ => {}
        }
        if command == "render" && random.below(8) > 0 {
            arguments.push("--size=40x30".to_owned());
        }
        for _ in 0..random.below(5) {
            let (option, values) = OPTIONS[random.below(OPTIONS.len())];
            arguments.push(format!("{option}={}", random.choose(values)));
            if random.below(3) == 0 {
                arguments.push(random.choose(FLAGS).to_owned());
            }
        }
        let input = format!("{name}: {arguments:?}");
        report.attempt(input.as_bytes(), || {
            let folder = tempfile::tempdir().expect("a folder");
            let program = folder.path().join("p.gtr");
            let text = std::fs::read(repository().join("examples").join(name));
            let text = text.expect("an example");
            std::fs::write(&program, &text).expect("written");
            let run = geotrace(&arguments)
                .folder(folder.path())
                .within(PATIENCE)
                .run();
            let peak = check(&run);
            assert_eq!(
                std::fs::read(&program).expect("it is there"),
                text,
                "the program is as it was"
            );
            let files = std::fs::read_dir(folder.path()).expect("a folder").count();
            assert!(
                run.status == Some(0) || files == 1,
                "{}: a file is left",
                run.what
            );
            peak
        });
    }
    report
}

/// The commands that programs without bounds are given to.
pub(super) const HUGE_COMMANDS: &[&[&str]] = &[
    &["check", "-"],
    &["explain", "-"],
    &["eval", "-", "1 + 1"],
    &["format", "-"],
    &[
        "render",
        "-",
        "--backend=software",
        "--size=64x64",
        "-o",
        "o.png",
    ],
    &[
        "render",
        "-",
        "--backend=software",
        "--size=64x64",
        "--view=geodesic",
        "-o",
        "o.png",
    ],
    &[
        "render",
        "-",
        "--backend=software",
        "--size=640x480",
        "--view=traced",
        "--samples=1",
        "-o",
        "o.png",
    ],
    &["export", "-", "-o", "o.glb"],
    &[
        "trace",
        "-",
        "--from=0.1,0.1",
        "--heading=30",
        "--length=5",
        "--format=json",
    ],
];

/// Gives each program without bounds to each command.
pub(super) fn huge(_seed: u64, count: u64) -> Report {
    let all = HUGE
        .iter()
        .flat_map(|it| HUGE_COMMANDS.iter().map(move |command| (it, command)));
    let mut report = Report::default();
    for ((name, text), command) in all.take(count as usize) {
        let text = text();
        report.attempt(format!("{name}: {command:?}").as_bytes(), || {
            let folder = tempfile::tempdir().expect("a folder");
            let run = geotrace(*command)
                .input(text)
                .folder(folder.path())
                .within(PATIENCE)
                .run();
            check(&run)
        });
    }
    report
}
