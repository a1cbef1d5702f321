//! A long script: read, run, and from a key to its diagnostics; beside the time in which POV-Ray reads the same scene.

use std::fmt::Write;
use std::process::Command;
use std::time::Duration;

use ide::crt::Crt;
use ide::{Language, Program};
use syntax::crt::document::Document;
use syntax::span::Span;

use crate::measure::Times;

/// The boxes of the script, and the lines of each.
const BOXES: usize = 360;
const RUNS: usize = 21;

/// The scene as a script of 2,300 lines, and in POV-Ray's language.
fn texts() -> [String; 2] {
    let mut ours = String::from("size = 0.4\nstep = 1.5\n");
    let mut theirs = String::from(
        "#version 3.7;\nglobal_settings { assumed_gamma 1 }\ncamera { location <0, 9, -30> look_at 0 }\nlight_source { <9, 9, -9> rgb 1 }\n#declare Size = 0.4;\n#declare Step = 1.5;\n",
    );
    for k in 0..BOXES {
        let [x, z] = [k % 20, k / 20];
        let shade = k as f64 / BOXES as f64;
        let _ = write!(
            ours,
            "mat{k} = Material {{\n    color -> rgb({shade:.3}, 0.5, 0.25)\n}}\nbox{k} = Box {{\n    cornerA -> vec3({x} * step - size, 0, {z} * step - size)  cornerB -> vec3({x} * step + size, 1 + {x} / 7, {z} * step + size)\n    material -> mat{k} }}\n"
        );
        let _ = writeln!(
            theirs,
            "box {{ <{x} * Step - Size, 0, {z} * Step - Size>, <{x} * Step + Size, 1 + int({x} / 7), {z} * Step + Size>\n    pigment {{ rgb <{shade:.3}, 0.5, 0.25> }} }}"
        );
    }
    ours.push_str("Scene {\n");
    for row in 0..BOXES / 3 {
        let _ = writeln!(
            ours,
            "    box{} box{} box{}",
            3 * row,
            3 * row + 1,
            3 * row + 2
        );
    }
    for _ in 0..16 {
        ours.push_str("    -- a line of words about the boxes\n");
    }
    ours.push_str("}\n");
    [ours, theirs]
}

/// The time of a POV-Ray process that draws one pixel of a scene, in ms; `None` without POV-Ray.
fn povray(scene: &str) -> Option<f64> {
    let name = format!("geotrace-scripts-{}.pov", std::process::id());
    let file = std::env::temp_dir().join(name);
    std::fs::write(&file, scene).ok()?;
    let start = std::time::Instant::now();
    let output = Command::new("povray")
        .arg(format!("+I{}", file.display()))
        .args(["-D", "-F", "+W1", "+H1", "-GA"])
        .output();
    let time = 1e3 * start.elapsed().as_secs_f64();
    let _ = std::fs::remove_file(&file);
    output.ok()?.status.success().then_some(time)
}

/// Prints the table.
pub(crate) fn run() {
    let [ours, theirs] = texts();
    println!(
        "## A script of {} lines and {BOXES} boxes",
        ours.lines().count()
    );
    let print = |what: &str, times: &Times| {
        println!("  {what:<44} {:>8.2} ms", milliseconds(times.median()));
    };
    print("read", &Times::of(RUNS, || Document::new(&ours, &())));
    let document = Document::new(&ours, &()).expect("a small script");
    let script = document.snapshot().script();
    print(
        "run and built",
        &Times::of(RUNS, || scene::crt::run(&script, &ours)),
    );
    let mut program = Crt.open(&ours).expect("a small script");
    assert_eq!(
        program.diagnostics().len(),
        0,
        "{:?}",
        program.diagnostics()
    );
    let place = ours.find("0.4").map_or(0, |at| at as u32 + 2);
    let mut digit = 0;
    let mut key = |program: &mut Box<dyn Program>| {
        digit = (digit + 1) % 10;
        let span = Span::new(place, place + 1);
        program.edit(span, &digit.to_string()).expect("in the text");
    };
    print(
        "a key, to the diagnostics of reading",
        &Times::of(RUNS, || {
            key(&mut program);
            program.diagnostics_of_reading()
        }),
    );
    print(
        "a key, to the diagnostics of running",
        &Times::of(RUNS, || {
            key(&mut program);
            program.diagnostics()
        }),
    );
    // The time of the process that draws one pixel of it, less that of one that draws one of an empty scene.
    let nothing = "#version 3.7;\nglobal_settings { assumed_gamma 1 }\ncamera { location <0, 0, -1> look_at 0 }\n";
    let times = |scene: &str| -> Option<f64> {
        let mut times: Vec<f64> = (0..RUNS).map_while(|_| povray(scene)).collect();
        times.sort_by(f64::total_cmp);
        times.get(RUNS / 2).copied()
    };
    match times(&theirs).zip(times(nothing)) {
        Some((all, empty)) => println!(
            "  {:<44} {:>8.2} ms",
            "POV-Ray, one pixel more than of nothing",
            all - empty
        ),
        None => println!("  there is no `povray` here"),
    }
}

fn milliseconds(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}
