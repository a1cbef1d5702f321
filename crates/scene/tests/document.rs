//! The incremental document: diagnostics and scene are those of compiling the whole text after every edit,
//! and no more is checked than can notice it.

use std::fmt::Write as _;

use scene::{Document, Settings, compile};
use syntax::span::Span;

/// What can be told of a scene, in full.
fn describe(scene: &scene::Scene) -> String {
    let mut text = format!(
        "{:?}\n{:?}\n{:?}\n{}\n",
        scene.params, scene.grids, scene.objects, scene.uniform_count
    );
    let mut roots = Vec::new();
    for object in &scene.objects {
        roots.extend(object.shape.roots());
    }
    for id in scene.graph.order(&roots) {
        let _ = write!(text, "{id:?} {:?}; ", scene.graph.node(id));
    }
    text
}

/// Holds a document to what compiling its whole text gives.
fn check(document: &Document, text: &str) {
    let whole = compile(text);
    assert_eq!(document.diagnostics(), whole.diagnostics, "{text}");
    let own = &document.compilation();
    assert_eq!(own.diagnostics, whole.diagnostics, "{text}");
    let described = own.scene.as_ref().map(describe);
    assert_eq!(described, whole.scene.as_ref().map(describe), "{text}");
    if let Some(scene) = &whole.scene {
        let settings = Settings::opening(scene);
        for name in ["a", "f(1)", "g(1, 2)", "b + c"] {
            let evaluate = |compilation: &scene::Compilation| {
                format!("{:?}", compilation.evaluate(name, &settings))
            };
            assert_eq!(evaluate(own), evaluate(&whole), "{name} in {text}");
        }
    }
}

/// A generator of numbers that is the same on every machine.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % bound.max(1) as u64) as usize
    }

    fn pick<'t>(&mut self, of: &[&'t str]) -> &'t str {
        of[self.below(of.len())]
    }
}

const NUMBERS: &[&str] = &[
    "a", "b", "c", "d", "2", "3a", "bc", "f(2)", "g(a, 1)", "k", "q", "v_1",
];
const NAMES: &[&str] = &[
    "a", "b", "c", "d", "f", "g", "k", "v", "s", "m", "q", "w", "ab",
];

fn declaration(random: &mut Random) -> String {
    let name = random.pick(NAMES);
    let x = random.pick(NUMBERS);
    let y = random.pick(NUMBERS);
    let other = random.pick(NAMES);
    match random.below(18) {
        0 => format!("param {name} : [0, {}];\n", 1 + random.below(3)),
        1 => format!("param {name} : [0, {x}], [1, 2];\n"),
        2 => format!("grid {name} : [0, 1, {}];\n", 2 + random.below(4)),
        3 => format!("grid {name} : [0, {x}, 3], [0, 1, 900];\n"),
        4 | 5 => format!("define {name} = {x} + {y};\n"),
        6 => format!("define {name} = ({x}, {y}, 1);\n"),
        7 => format!("function {name}(x) = {x} x^2 - {y};\n"),
        8 => format!("function {name}(x, y) = {other}' x {x} + {y};\n"),
        9 => format!("function {name}(x) = {other} x; # {y}\n"),
        10 => format!("point {name} = ({x}, {y}, 0);\n"),
        11 => format!("vector {name} = ({x}, 1, {y}) @ {other};\n"),
        12 => format!("curve {name}(t) = (t, {x}, {other} t), t : [0, {y}, 9];\n"),
        13 => format!(
            "surface {name}(u, w) = (u, w, {x} u w), u : [0, {y}, 4], w : [0, 1, 300{}];\n",
            random.below(10)
        ),
        14 => format!("metric {name}(u, w) = (1 + {x}^2, 0, {y}), u : [0, 1], w : [0, 2];\n"),
        15 => format!("geodesic {name}(t) : {other} = (1, {x}) @ (0, {y}), t : [0, 1];\n"),
        16 => format!("define {name} = {other}_u(1, {x}) {other}'2;\n"),
        _ => format!("define {name} = {other};"),
    }
}

const PIECES: &[&str] = &[
    ";", "#", "\n", " ", "(", ")", ",", "1", "2", "9", "0", "a", "b", "f", "g", "x", "'", "_u",
    "+ a", "- 1", "define ", "param ", "# 𝔘\n", "e", "k",
];

fn edit(random: &mut Random, text: &str) -> (Span, String) {
    let boundary = |at: usize| {
        let mut at = at.min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    let at = boundary(random.below(text.len() + 1));
    // Numbers are changed, names are renamed, whole declarations come and go.
    let (start, end, inserted) = match random.below(10) {
        0..=2 => {
            let is_word = |byte: u8| byte.is_ascii_alphanumeric();
            let bytes = text.as_bytes();
            let mut start = at;
            while start > 0 && is_word(bytes[start - 1]) {
                start -= 1;
            }
            let mut end = at;
            while end < bytes.len() && is_word(bytes[end]) {
                end += 1;
            }
            let old = &text[start..end];
            let new = match old.bytes().next() {
                Some(b'0'..=b'9') => random.pick(&["1", "2", "3", "0", "40", "1000"]),
                _ => random.pick(NAMES),
            };
            (start, end, new.to_owned())
        }
        3 | 4 => {
            let start = text[..at].rfind('\n').map_or(0, |end| end + 1);
            let inserted = match text.len() > 1_200 {
                true => String::new(),
                false => declaration(random),
            };
            (start, start, inserted)
        }
        5 => {
            let start = text[..at].rfind('\n').map_or(0, |end| end + 1);
            let end = text[at..].find('\n').map_or(text.len(), |end| at + end + 1);
            (start, end, String::new())
        }
        6 => {
            let end = boundary(at + random.below(5)).max(at);
            (at, end, String::new())
        }
        _ => (at, at, random.pick(PIECES).to_owned()),
    };
    (Span::new(start as u32, end as u32), inserted)
}

/// How many random edits are made: `GEOTRACE_EDITS`, or twenty thousand.
fn edit_count() -> usize {
    let wanted = std::env::var("GEOTRACE_EDITS").ok();
    wanted
        .and_then(|count| count.parse().ok())
        .unwrap_or(20_000)
}

fn storm(seed: u64, edits: usize) {
    const EDITS_OF_ONE: usize = 100;
    let mut random = Random(seed);
    let mut done = 0;
    while done < edits {
        let count = random.below(14);
        let mut text: String = (0..count).map(|_| declaration(&mut random)).collect();
        let mut document = Document::new(&text).expect("a small text");
        check(&document, &text);
        for _ in 0..EDITS_OF_ONE {
            let (range, inserted) = edit(&mut random, &text);
            let before = text.clone();
            document.edit(range, &inserted).expect("an edit");
            text.replace_range(range.start as usize..range.end as usize, &inserted);
            let held = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                check(&document, &text);
            }));
            if held.is_err() {
                panic!("seed {seed}: after the edit {range:?} {inserted:?} of\n{before}");
            }
            done += 1;
        }
        assert_eq!(document.work().renewed, 1);
    }
}

#[test]
fn random_edits_give_what_compiling_the_whole_text_gives() {
    let threads = 4;
    let each = edit_count().div_ceil(threads);
    std::thread::scope(|scope| {
        for thread in 0..threads {
            scope.spawn(move || storm(thread as u64 + 11, each));
        }
    });
}

/// Makes one edit in the place of a text and says how many chunks were read, and how many checked.
fn redone(text: &str, old: &str, new: &str) -> (usize, u64) {
    let mut document = Document::new(text).expect("a small text");
    let start = text.find(old).expect("the place of the edit") as u32;
    let before = document.work().checked;
    let range = Span::new(start, start + old.len() as u32);
    let change = document.edit(range, new).expect("an edit");
    check(&document, &text.replacen(old, new, 1));
    (change.read.len(), document.work().checked - before)
}

#[test]
fn only_what_can_notice_an_edit_is_checked_again() {
    let text = "param p : [0, 2]; grid k : [0, 1, 3]; define a = 1 + 1; define b = a p; \
        function f(x) = b x; point q = (f 1, k, 0); metric m(u, v) = (1, 0, 1 + p), u : [0, 1], v : [0, 1]; \
        curve c(t) = (t, f t, b), t : [0, a]; define d = c_t 1;";
    // The same value, written otherwise: nobody else is checked.
    assert_eq!(redone(text, "1 + 1", "2"), (1, 1));
    assert_eq!(redone(text, "b x", "b  (x)"), (1, 3 + 1));
    // Another value: who reads it, who reads those, and so on; not the point's neighbours.
    assert_eq!(redone(text, "1 + 1", "3"), (1, 6));
    // A slider's end is seen by the metric alone, which is looked at where the params start.
    assert_eq!(redone(text, "[0, 2]", "[0, 3]"), (1, 2));
    // A grid's count is seen by what is drawn once for each of its values.
    assert_eq!(redone(text, "0, 1, 3", "0, 1, 4"), (1, 2));
    // A curve's interval is seen by nobody: its body is what it was.
    assert_eq!(redone(text, "[0, a]", "[0, 7a]"), (1, 1));
    // A comment moves the rest of its chunk, and nobody notices.
    assert_eq!(redone(text, " function", "# f\n function"), (1, 1));
}

#[test]
fn limits_of_the_whole_program_are_those_of_compiling_it() {
    let mut text = String::from("grid k : [0, 1, 900];\n");
    for name in ["r", "s", "t"] {
        let _ = writeln!(
            text,
            "surface {name}(u, v) = (u, v, k), u : [0, 1, 100], v : [0, 1, 100];"
        );
    }
    let mut document = Document::new(&text).expect("a small text");
    for (old, new) in [
        ("900]", "700]"),
        ("700]", "600]"),
        ("600]", "5000]"),
        ("5000]", "9]"),
    ] {
        check(&document, &text);
        let start = text.find(old).expect("it is there") as u32;
        let range = Span::new(start, start + old.len() as u32);
        document.edit(range, new).expect("an edit");
        text = text.replacen(old, new, 1);
    }
    check(&document, &text);
    let mut text = String::new();
    for k in 0..20 {
        let intervals = vec!["[0, 1]"; 900].join(", ");
        let _ = writeln!(text, "param p{k} : {intervals};");
    }
    let mut document = Document::new(&text).expect("a text");
    check(&document, &text);
    let third = text.match_indices("param").nth(3).expect("it is there").0;
    let range = Span::new(third as u32, text.len() as u32);
    document.edit(range, "").expect("an edit");
    text.truncate(third);
    check(&document, &text);
}
