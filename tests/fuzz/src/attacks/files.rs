//! Files that are written while something goes wrong.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};
use tempfile::TempDir;
use testing::binary::{binary, geotrace};

use crate::mutation::Random;
use crate::run::Report;

/// A program with a surface and a param, laid out otherwise than `format` does.
const PROGRAM: &str = "param r:[0.3,0.6];\nsurface  s(u,v)=((1+r cosv)cosu,(1+r cosv)sinu,r sinv),u:[0,2pi,90],v:[0,2pi,40];\n";
/// The content of a file that is written over.
const OLD: &[u8] = b"an older file";

/// The ways to write a file: its name, and the arguments.
const WAYS: &[(&str, &[&str])] = &[
    (
        "o.png",
        &[
            "render",
            "p.gtr",
            "-o",
            "o.png",
            "--size=400x300",
            "--backend=software",
        ],
    ),
    (
        "o.png",
        &[
            "render",
            "p.gtr",
            "-o",
            "o.png",
            "--size=64x64",
            "--backend=software",
            "--view=geodesic",
        ],
    ),
    (
        "o.gif",
        &[
            "render",
            "p.gtr",
            "-o",
            "o.gif",
            "--size=64x48",
            "--backend=software",
            "--animate=r=0.3:0.6",
            "--frames=8",
        ],
    ),
    (
        "o.apng",
        &[
            "render",
            "p.gtr",
            "-o",
            "o.apng",
            "--size=64x48",
            "--backend=software",
            "--turntable",
            "--frames=8",
        ],
    ),
    (
        "o.svg",
        &["render", "p.gtr", "-o", "o.svg", "--size=200x150"],
    ),
    (
        "o.pdf",
        &["render", "p.gtr", "-o", "o.pdf", "--size=200x150"],
    ),
    ("o.obj", &["export", "p.gtr", "-o", "o.obj"]),
    ("o.ply", &["export", "p.gtr", "-o", "o.ply"]),
    ("o.glb", &["export", "p.gtr", "-o", "o.glb"]),
    ("p.gtr", &["format", "p.gtr"]),
];

/// A folder with a program and, where another file is written, an older one.
fn folder(target: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join(target), OLD).expect("written");
    std::fs::write(folder.path().join("p.gtr"), PROGRAM).expect("written");
    folder
}

fn content(folder: &TempDir, target: &str) -> Vec<u8> {
    std::fs::read(folder.path().join(target)).expect("the file is there")
}

fn names(folder: &TempDir) -> usize {
    std::fs::read_dir(folder.path()).expect("a folder").count()
}

/// A way with the file that it writes.
struct Prepared {
    target: &'static str,
    arguments: &'static [&'static str],
    old: Vec<u8>,
    new: Vec<u8>,
    files: usize,
    took: Duration,
    peak: u64,
}

/// All ways, each run once without a disturbance.
fn prepared() -> Vec<Prepared> {
    let one = |&(target, arguments): &(&'static str, &'static [&'static str])| {
        let folder = folder(target);
        let old = content(&folder, target);
        let files = names(&folder);
        let start = Instant::now();
        let run = geotrace(arguments).folder(folder.path()).run();
        let took = start.elapsed();
        run.expect_status(0);
        Prepared {
            target,
            arguments,
            old,
            new: content(&folder, target),
            files,
            took,
            peak: run.peak,
        }
    };
    WAYS.iter().map(one).collect()
}

fn start(folder: &Path, arguments: &[&str]) -> Child {
    let mut command = Command::new(binary());
    command.args(arguments).current_dir(folder);
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    command.spawn().expect("the binary starts")
}

/// Ends processes that write at random times, by signals that they can hear and one that they cannot.
pub(super) fn kills(seed: u64, count: u64) -> Report {
    let all = prepared();
    let mut random = Random::new(seed);
    let mut report = Report::default();
    for k in 0..count {
        let way = &all[k as usize % all.len()];
        let signal = [Signal::KILL, Signal::KILL, Signal::TERM, Signal::INT][random.below(4)];
        let delay = way.took.mul_f64(random.below(1200) as f64 / 1000.0);
        let input = format!("{:?}: {signal:?} after {delay:?}", way.arguments);
        report.attempt(input.as_bytes(), || {
            let folder = folder(way.target);
            let mut child = start(folder.path(), way.arguments);
            std::thread::sleep(delay);
            // It may have ended.
            let _ = kill_process(Pid::from_child(&child), signal);
            child.wait().expect("it ends");
            let left = content(&folder, way.target);
            assert!(left == way.old || left == way.new, "{input}: a torn file");
            assert!(
                signal == Signal::KILL || names(&folder) == way.files,
                "{input}: a file is left"
            );
            // What a kill leaves is not in the way of the next run.
            if names(&folder) > way.files || k % 8 == 0 {
                geotrace(way.arguments)
                    .folder(folder.path())
                    .run()
                    .expect_status(0);
                assert!(
                    content(&folder, way.target) == way.new,
                    "{input}: the next run"
                );
            }
            way.peak
        });
    }
    report
}

/// Lets two processes write one file at a time.
pub(super) fn writers(seed: u64, count: u64) -> Report {
    let sizes = [
        ["--size=64x48", "--size=300x200"],
        ["--size=200x150", "--size=200x152"],
    ];
    let mut random = Random::new(seed);
    let mut report = Report::default();
    for k in 0..count {
        let sizes = sizes[random.below(2)];
        let delay = Duration::from_millis(random.below(60) as u64);
        report.attempt(format!("{k}: {sizes:?}, {delay:?}").as_bytes(), || {
            let write = ["render", "p.gtr", "-o", "o.png", "--backend=software"];
            let arguments = sizes.map(|size| [&write[..], &[size]].concat());
            let folder = folder("o.png");
            let mut first = start(folder.path(), &arguments[0]);
            std::thread::sleep(delay);
            let mut second = start(folder.path(), &arguments[1]);
            for child in [&mut first, &mut second] {
                assert!(child.wait().expect("it ends").success(), "both write");
            }
            let written = content(&folder, "o.png");
            assert_eq!(names(&folder), 2, "nothing else is left");
            let mut peak = 0;
            let is_one = arguments.iter().any(|arguments| {
                let run = geotrace(arguments).folder(folder.path()).run();
                peak = peak.max(run.peak);
                content(&folder, "o.png") == written
            });
            assert!(is_one, "the file is that of one of them");
            peak
        });
    }
    report
}

/// Lets writing fail behind a random byte.
pub(super) fn full_disks(seed: u64, count: u64) -> Report {
    let all = prepared();
    let mut random = Random::new(seed);
    let mut report = Report::default();
    for k in 0..count {
        let way = &all[k as usize % all.len()];
        let most = random.below(way.new.len() + 600) as u64;
        let input = format!("{:?}: {most} bytes", way.arguments);
        report.attempt(input.as_bytes(), || {
            let folder = folder(way.target);
            let run = geotrace(way.arguments)
                .folder(folder.path())
                .largest_file(most)
                .run();
            if most / 512 * 512 >= way.new.len() as u64 {
                run.expect_status(0);
                assert!(
                    content(&folder, way.target) == way.new,
                    "{input}: the new file"
                );
            } else {
                run.expect_status(2);
                assert!(
                    run.stderr.contains("cannot write"),
                    "{input}: {}",
                    run.stderr
                );
                assert!(
                    content(&folder, way.target) == way.old,
                    "{input}: the old file"
                );
            }
            assert_eq!(names(&folder), way.files, "{input}: a file is left");
            run.peak
        });
    }
    report
}
