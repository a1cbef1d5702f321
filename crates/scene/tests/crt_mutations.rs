//! Scripts that are changed at random: whatever comes out is read, run and built, and ends.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, mpsc};
use std::time::Duration;

use scene::crt::run_unless;
use syntax::crt::document::Document;
use syntax::diagnostic::Severity;

/// Scripts that mutations begin with: each kind of value, object and statement.
const SCRIPTS: &[&str] = &[
    "n = 3 s = Sphere { center -> vec3(0, n, 0.5) radius -> 1 + n / 2 }\nb = s <scale 2, rotate vec3(0, 90, 0)> - s\nScene { b ^ s [s, b] }\n",
    "m = Macro (a, b) {\n    c = a + b\n    a\n    if (c == 2) { b } else if (!true) { } else { a b }\n}\ns = Box { cornerA -> vec3(0, 0, 0) cornerB -> vec3(1, 2, 3) }\nScene { m(s, s) row = m(s, s) row <translate vec3(1, 0, 0)> }\n",
    "r = rand(0, 1) * 3 c = rgb(r, .5, 1.) / 2\nmat = Material { color -> c reflectivity -> 0.5 transparency -> 0.25 }\nScene { Torus { center -> vec3(0, 0, 0) radius -> 2 tube -> 1 material -> mat } Cone { base -> vec3(0, 0, 0) apex -> vec3(0, 1, 0) radius -> 1 } }\n",
    "Settings {\n    gamma -> 2.2\n    camera -> Camera { position -> vec3(0, 0, -4) pointing -> vec3(0, 0, 0) fov -> 60 apertureshape -> \"star\" }\n    lights -> [PointLight { origin -> vec3(1, 2, 3) color -> rgb(1, 1, 1) falloff -> 3 }, SpotLight { origin -> vec3(1, 2, 3) pointing -> vec3(0, 0, 0) color -> rgb(1, 1, 1) }]\n    background -> Background { horizon -> rgb(1, 1, 1) sky -> rgb(0, 0, 1) }\n    supersampling -> 2\n}\nScene { Plane { normal -> vec3(0, 1, 0) position -> vec3(0, 0, 0) } }\n",
    "i = 0 t2 = \"a\" * 3 + i\nwhile (i < 4) { l = [i, [i, t2], l2 = i] i = i + 1 }\nk = l[1][0] > 2 ? -k2 : +i % 2\nk2 = k\nScene { Cylinder { base -> vec3(0, 0, 0) top -> vec3(0, i, 0) radius -> abs(-1) } }\n",
];

/// Pieces that are put in.
const PIECES: &[&str] = &[
    "",
    "{",
    "}",
    "(",
    ")",
    "[",
    "]",
    "<scale ",
    ">",
    ",",
    "->",
    "=",
    "==",
    "?",
    ":",
    "+",
    "-",
    "^",
    "*",
    "/",
    "%",
    "!",
    "&&",
    "||",
    "0",
    "1",
    "-1",
    "2147483647",
    "1e9",
    ".5",
    "0.0",
    "\"a\"",
    "\"",
    "true",
    "s",
    "m",
    "t",
    "s()",
    "m(s, s)",
    "vec3(0, 0, 0)",
    "Sphere",
    "Material { }",
    "Scene {",
    "Settings {",
    "Macro () {",
    "if (true) {",
    "else",
    "translate",
    "-- ",
    "\n",
    "é",
    "s = s + s ",
    "m(m, m)",
    "rand(0, 0)",
    "[[]]",
    "a = b = ",
];

/// A generator of random numbers (splitmix64).
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((mixed ^ (mixed >> 31)) % bound as u64) as usize
    }

    /// A place between two characters, not before `from`.
    fn place(&mut self, text: &str, from: usize) -> usize {
        let mut at = from + self.below(text.len() - from + 1);
        while !text.is_char_boundary(at) {
            at += 1;
        }
        at
    }
}

/// Puts another operand in place of a digit, or changes any place.
fn mutate(random: &mut Random, text: &mut String) {
    const OPERANDS: &[&str] = &[
        "-1",
        "0",
        "t",
        "2147483647",
        ".5",
        "\"a\"",
        "s",
        "[1]",
        "1 / 0",
        "rgb(0, 0, 1)",
        "m",
        "(s + s)",
    ];
    let digits: Vec<usize> = text
        .match_indices(|c: char| c.is_ascii_digit())
        .map(|it| it.0)
        .collect();
    if random.below(4) > 0 && !digits.is_empty() {
        let at = digits[random.below(digits.len())];
        text.replace_range(at..=at, OPERANDS[random.below(OPERANDS.len())]);
        return;
    }
    let start = random.place(text, 0);
    let end = match random.below(3) {
        0 => start,
        1 => random.place(text, start).min(start + 12),
        _ => start + text[start..].find([' ', '\n']).unwrap_or(0),
    };
    let end = (end..=text.len())
        .find(|at| text.is_char_boundary(*at))
        .unwrap_or(start);
    let piece = match random.below(4) {
        // A piece of the text itself.
        0 => {
            let from = random.place(text, 0);
            let to = random.place(text, from);
            text[from..to].chars().take(40).collect()
        }
        _ => PIECES[random.below(PIECES.len())].to_owned(),
    };
    text.replace_range(start..end, &piece);
}

/// The number of scripts: `MUTATIONS=1000000` makes as many.
fn mutations() -> usize {
    let wanted = std::env::var("MUTATIONS").ok();
    wanted.and_then(|text| text.parse().ok()).unwrap_or(20_000)
}

#[test]
fn scripts_that_are_changed_at_random_are_read_run_and_built() {
    let mut random = Random(5);
    let (mut sound, mut faulty, mut given_up_runs) = (0, 0, 0);
    // A loop that never ends goes round a million times; one that goes on for long is given up, as an editor's next key does.
    let given_up = Arc::new(AtomicBool::new(false));
    let (begun, runs) = mpsc::channel::<()>();
    let (ended, ends) = mpsc::channel::<()>();
    let flag = given_up.clone();
    let watch = std::thread::spawn(move || {
        while runs.recv().is_ok() {
            if ends.recv_timeout(Duration::from_millis(50)).is_err() {
                flag.store(true, Ordering::Relaxed);
                if ends.recv().is_err() {
                    return;
                }
            }
        }
    });
    for k in 0..mutations() {
        let mut text = SCRIPTS[k % SCRIPTS.len()].to_owned();
        for _ in 0..1 + random.below(4) {
            mutate(&mut random, &mut text);
        }
        let document = Document::new(&text, &()).expect("small");
        let diagnostics = document.all_diagnostics();
        for found in &diagnostics {
            let [start, end] = [found.span.start, found.span.end].map(|at| at as usize);
            assert!(text.get(start..end).is_some(), "{text}\n{found:?}");
        }
        // What `eval` does with a script that has errors.
        match diagnostics.iter().any(|it| it.severity == Severity::Error) {
            true => faulty += 1,
            false => sound += 1,
        }
        let script = document.snapshot().script();
        given_up.store(false, Ordering::Relaxed);
        begun.send(()).expect("the watch");
        let run = run_unless(&script, &text, &Arc::default(), &given_up);
        ended.send(()).expect("the watch");
        let Some(run) = run else {
            given_up_runs += 1;
            continue;
        };
        for found in &run.diagnostics {
            let [start, end] = [found.span.start, found.span.end].map(|at| at as usize);
            assert!(text.get(start..end).is_some(), "{text}\n{found:?}");
        }
        for assignment in &run.assignments {
            assert!(assignment.text().chars().count() <= 201, "{text}");
            let _ = assignment.entity();
        }
    }
    drop(begun);
    watch.join().expect("the watch ends");
    println!("{sound} were sound to read, {faulty} were not");
    assert!(sound * 20 > mutations() && faulty * 20 > mutations());
    assert!(
        given_up_runs * 2 < mutations(),
        "{given_up_runs} runs did not end"
    );
}
