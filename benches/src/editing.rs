//! Editing: from an edit to its diagnostics, beside compiling the whole text and, as a yardstick, beside
//! tree-sitter's incremental parse of a text of the same size.

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use scene::geotrace::Document;
use syntax::span::Span;
use tree_sitter::{InputEdit, Parser, Point, Tree};

use crate::front::program;

/// How many edits of one kind are timed.
const EDITS: usize = 2_000;
/// For at most how long.
const ENOUGH: Duration = Duration::from_secs(4);

/// Times of edits.
struct Percentiles(Vec<Duration>);

impl Percentiles {
    fn of(mut edit: impl FnMut(usize) -> Duration) -> Self {
        // The first edits find nothing in the processor's caches.
        for k in 0..20 {
            edit(k);
        }
        let start = Instant::now();
        let mut times = Vec::new();
        while times.len() < EDITS && start.elapsed() < ENOUGH {
            times.push(edit(times.len()));
        }
        times.sort_unstable();
        Self(times)
    }

    fn at(&self, share: f64) -> f64 {
        let index = (self.0.len() as f64 * share) as usize;
        let time = self.0.get(index.min(self.0.len() - 1));
        1e6 * time.copied().unwrap_or_default().as_secs_f64()
    }

    fn print(&self, what: &str, note: &str) {
        println!(
            "    {what:<34} p50 {:>10.1} µs   p99 {:>10.1} µs   {note}",
            self.at(0.5),
            self.at(0.99)
        );
    }
}

/// Where an edit is made, by the declaration's number.
fn places(declarations: usize) -> [(&'static str, usize); 3] {
    // Each is a function's body, of which a few declarations below hang.
    let near = |k: usize| k / 10 * 10 + 2;
    [
        ("top", 2),
        ("middle", near(declarations / 2)),
        ("end", near(declarations - 10)),
    ]
}

/// Inserts a text and takes it out again, in turn; times each with the diagnostics that follow.
fn toggle(document: &mut Document, at: u32, inserted: &str, k: usize) -> Duration {
    let start = now();
    let (range, text) = match k.is_multiple_of(2) {
        true => (Span::new(at, at), inserted),
        false => (Span::new(at, at + inserted.len() as u32), ""),
    };
    let edited = document.edit(range, text);
    let diagnostics = document.diagnostics();
    let time = now() - start;
    assert!(edited.is_ok());
    std::hint::black_box(diagnostics);
    time
}

/// The offset behind a piece of the text.
fn behind(text: &str, piece: &str) -> u32 {
    let at = text.find(piece).map_or(0, |at| at + piece.len());
    u32::try_from(at).unwrap_or_default()
}

/// A program of so many declarations that is drawn with few samples, so that it keeps to the limits.
fn sparse(declarations: usize) -> String {
    let text = program(declarations);
    let text = text.replace("2pi, 200]", "2pi, 9]");
    text.replace("[-1, 1]", "[-1, 1, 5]")
}

/// What this thread has spent on a processor: other processes do not disturb it.
fn now() -> Duration {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(now.tv_sec.unsigned_abs(), now.tv_nsec as u32)
}

/// Prints the table.
pub(crate) fn run() {
    println!("Editing: one keystroke, and all diagnostics after it, in processor time");
    for declarations in [100, 1_000, 10_000, 100_000] {
        let text = sparse(declarations);
        println!(
            "  {declarations} declarations, {:.2} MB",
            text.len() as f64 / 1e6
        );
        let start = now();
        let opened = Document::new(&text);
        let opening = now() - start;
        let Ok(mut document) = opened else {
            println!("    the text is too large");
            continue;
        };
        println!(
            "    opening {:.1} ms, then {} diagnostics",
            1e3 * opening.as_secs_f64(),
            document.diagnostics().len()
        );
        if let Some(first) = document.diagnostics().first() {
            println!("    the first is {first:?}");
        }
        for (place, k) in places(declarations) {
            let at = behind(&text, &format!("function f{k}(x, y) = "));
            let before = document.counters();
            let mut count = 0;
            let times = Percentiles::of(|k| {
                count += 1;
                toggle(&mut document, at, "1", k)
            });
            let after = document.counters();
            let per_edit = |after: u64, before: u64| (after - before) as f64 / f64::from(count);
            let note = format!(
                "{:.1} read, {:.1} checked",
                per_edit(
                    after.reading.edited + after.reading.reread,
                    before.reading.edited + before.reading.reread
                ),
                per_edit(after.checked, before.checked)
            );
            times.print(&format!("a number, {place}"), &note);
        }
        let comment = behind(&text, "# declaration 9 is");
        Percentiles::of(|k| toggle(&mut document, comment, "x", k)).print("a comment, top", "");
        for (place, k) in places(declarations) {
            let name = behind(&text, &format!("function f{k}"));
            let before = document.counters();
            let mut count = 0;
            let times = Percentiles::of(|k| {
                count += 1;
                toggle(&mut document, name, "q", k)
            });
            let after = document.counters();
            let read = after.reading.edited + after.reading.reread
                - before.reading.edited
                - before.reading.reread;
            let note = format!("{:.1} read", read as f64 / f64::from(count));
            times.print(&format!("a name used below, {place}"), &note);
        }
        let runs = if declarations > 10_000 { 3 } else { 15 };
        let scratch = (0..runs).map(|_| {
            let start = now();
            std::hint::black_box(scene::geotrace::compile(&text));
            now() - start
        });
        let mut scratch: Vec<Duration> = scratch.collect();
        scratch.sort_unstable();
        let scratch = Percentiles(scratch);
        scratch.print("compiling the whole text", "");
        yardstick(text.len());
    }
}

/// A program in JavaScript of this size that is not unlike ours.
fn javascript(bytes: usize) -> String {
    let mut text = String::new();
    let mut k = 0;
    while text.len() < bytes {
        let _ = match k % 4 {
            0 => writeln!(text, "const d{k} = 2*a{k} + Math.sin(Math.PI*{k})/3;"),
            1 => writeln!(
                text,
                "function f{k}(x, y) {{ return x**2*y + Math.cos(2*x) - d{}/(1 + y**2); }}",
                k - 1
            ),
            2 => writeln!(
                text,
                "// declaration {k} is a comment and a constant\nconst p{k} = [1, f{}(1/2, 2), {k}];",
                k - 1
            ),
            _ => writeln!(
                text,
                "const c{k} = t => [Math.cos(t), Math.sin(t), f{}(t, 1)];",
                k - 2
            ),
        };
        k += 1;
    }
    text
}

/// Tree-sitter on a keystroke in the middle.
fn yardstick(bytes: usize) {
    let mut text = javascript(bytes);
    let mut parser = Parser::new();
    let language = tree_sitter_javascript::LANGUAGE.into();
    if parser.set_language(&language).is_err() {
        println!("    tree-sitter does not take its grammar");
        return;
    }
    let Some(mut tree): Option<Tree> = parser.parse(&text, None) else {
        return;
    };
    if tree.root_node().has_error() {
        println!("    tree-sitter finds an error in its text");
    }
    let middle = text.len() / 2;
    // An exponent gets another digit.
    let found = text[middle..].find("x**");
    let at = found.map_or(middle, |found| middle + found + 3);
    let row = text[..at].matches('\n').count();
    let column = at - text[..at].rfind('\n').map_or(0, |end| end + 1);
    let times = Percentiles::of(|k| {
        let (old, new) = match k.is_multiple_of(2) {
            true => (0, 1),
            false => (1, 0),
        };
        text.replace_range(at..at + old, &"1"[..new]);
        let start = now();
        tree.edit(&InputEdit {
            start_byte: at,
            old_end_byte: at + old,
            new_end_byte: at + new,
            start_position: Point::new(row, column),
            old_end_position: Point::new(row, column + old),
            new_end_position: Point::new(row, column + new),
        });
        if let Some(next) = parser.parse(&text, Some(&tree)) {
            tree = next;
        }
        now() - start
    });
    times.print("tree-sitter, JavaScript, middle", "parsing alone");
}
