//! Checking and parsing of large programs.

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use syntax::geotrace::actions::Actions;
use syntax::geotrace::symbols::Vocabulary;
use testing::binary::{binary, geotrace};

use crate::measure::{Times, megabytes};

/// A program of so many declarations, of all kinds, each using a few above it.
pub(crate) fn program(declarations: usize) -> String {
    let mut text = String::new();
    for k in 0..declarations {
        let below = k.saturating_sub(7);
        let _ = match k % 10 {
            0 => writeln!(text, "param a{k} : [0, {}];", k + 1),
            1 => writeln!(text, "define d{k} = 2a{} + sin(pi {k})/3;", k - 1),
            2 => writeln!(
                text,
                "function f{k}(x, y) = x^2 y + cos(2x) - d{}/(1 + y^2);",
                k - 1
            ),
            3 => writeln!(text, "function g{k}(t) = f{}(t, 2t) exp(-t^2/2);", k - 1),
            4 => writeln!(
                text,
                "curve c{k}(t) = (cos t, sin t, g{}(t)), t : [0, 2pi, 200];",
                k - 1
            ),
            5 => writeln!(text, "point p{k} = c{}(1/2) + (0, 0, {below});", k - 1),
            6 => writeln!(text, "vector w{k} = c{}'(1/2) @ p{};", k - 2, k - 1),
            7 => writeln!(
                text,
                "surface s{k}(u, v) = (u, v, f{}(u, v)), u : [-1, 1], v : [-1, 1];",
                k - 5
            ),
            8 => writeln!(text, "define n{k} = s{}_u(1, 2)*s{}_v(1, 2);", k - 1, k - 1),
            _ => writeln!(
                text,
                "# declaration {k} is a comment and a define\ndefine m{k} = n{}_1 + {below};",
                k - 1
            ),
        };
    }
    text
}

/// One expression: the thesis' sphere, so many times, in which nearly every word is split into names.
fn dense(terms: usize) -> String {
    let term = " + (sin(piv)cos(2piu), -sin(piv)sin(2piu), cos(piv))/2x^2";
    format!(
        "define u = 1/3; define v = 1/4; define x = 3; define sum = (0, 0, 0){};\n",
        term.repeat(terms)
    )
}

/// Hooks that do nothing: lexing and parsing alone.
struct Nothing;
impl Actions for Nothing {}

/// Prints the table.
pub(crate) fn run() {
    println!("Checking and parsing");
    let text = program(10_000);
    let size = megabytes(text.len() as u64);

    let start = Instant::now();
    let compilation = scene::geotrace::compile(&text);
    let cold = start.elapsed();
    if let Some(first) = compilation.diagnostics.first() {
        println!("  the generated program has a diagnostic: {first:?}");
    }
    println!(
        "  check, 10,000 declarations ({size:.2} MB), in this process, first run: {:.2} ms",
        1e3 * cold.as_secs_f64()
    );
    println!(
        "  check, 10,000 declarations, in this process: {}",
        Times::of(11, || scene::geotrace::compile(&text))
    );

    binary();
    let mut peak = 0;
    let times: Vec<Duration> = (0..7)
        .map(|_| {
            let start = Instant::now();
            let run = geotrace(["check", "-"]).input(text.as_bytes()).run();
            let time = start.elapsed();
            run.expect_status(0);
            peak = peak.max(run.peak);
            time
        })
        .collect();
    println!(
        "  check, 10,000 declarations, whole process: {}, peak memory {:.1} MB",
        Times::new(times),
        megabytes(peak)
    );

    let vocabulary = Vocabulary::new(
        &["pi", "e"],
        &[
            "sin", "cos", "tan", "exp", "log", "sqrt", "id", "asin", "acos", "atan", "sinh",
            "cosh", "tanh", "abs",
        ],
    );
    let names = program(100_000);
    let dense = dense(100_000);
    for (what, text) in [
        ("many short declarations", &names),
        ("dense expressions", &dense),
    ] {
        let size = megabytes(text.len() as u64);
        let times = Times::of(11, || {
            syntax::geotrace::parse_program(text, &vocabulary, &mut Nothing)
        });
        println!(
            "  lexing and parsing {what}, {size:.1} MB: {}, {:.0} MB/s",
            times,
            size / times.median().as_secs_f64()
        );
    }
}
